"""try.py: uses the installed wheel, then looks where every library that it has inside was loaded from."""
import ctypes
import importlib.metadata
import re
from pathlib import Path

import numpy

import soapfilm

points = numpy.random.default_rng(1).normal(size=(20000, 3))
points /= numpy.linalg.norm(points, axis=1)[:, None]
result = soapfilm.reconstruct(points, points, voxel=0.05)
assert result.topology()["watertight"] and abs(result.volume - 4.19) < 0.05, result.volume
result.save("sphere.glb")
assert soapfilm.evaluate(result, "sphere")["topology"], "no topology"
assert soapfilm.render(result, Path("sphere.png"), size=(200, 200)).size
soapfilm.view(result, Path("sphere.html"))


def loaded():
    """The files of all libraries in this process, by the C library: a chroot need not have /proc."""
    class Info(ctypes.Structure):
        _fields_ = [("address", ctypes.c_void_p), ("name", ctypes.c_char_p)]

    files = set()
    visit = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(Info), ctypes.c_size_t, ctypes.c_void_p)
    ctypes.CDLL(None).dl_iterate_phdr(visit(lambda info, *_: files.add(Path(info[0].name.decode())) or 0), None)
    return files


# With the names that they had before, whatever their versions: nothing but zlib, which Python itself uses.
bundled = {file.name for file in importlib.metadata.files("soapfilm") if file.parts[0] == "soapfilm.libs"}
files = loaded()
inside = {file.name for file in files if file.parent.name == "soapfilm.libs"}
assert inside == bundled and len(inside) > 5, f"inside {bundled}, loaded {inside}"
names = {re.sub(r"-[0-9a-f]{8}\.so.*", "", name) for name in bundled} - {"libz"}
outside = {file for file in files if file.name.split(".so")[0] in names}
assert not outside, f"loaded from elsewhere: {outside}"
notices = {file.name for file in importlib.metadata.files("soapfilm") if file.parent.name == "licenses"}
content = importlib.metadata.distribution("soapfilm").read_text("licenses/CONTENT.txt")
for package in re.findall(r": (\S+) \S+, ", content):
    assert f"{package}.copyright" in notices, package
print(f"soapfilm {soapfilm.__version__}: {len(result.triangles)} triangles, {len(inside)} libraries from the wheel")
