#!/usr/bin/env python3
"""portable.py WHEEL OUT: makes from a wheel of this machine one for every Linux whose glibc is not older than its own.

What `auditwheel repair` does, which Debian 12 does not have: the libraries that the module links go into the wheel,
under names with a hash, so that no library of the same name that is loaded already takes their place; the module finds
them beside itself; the tag becomes manylinux_2_NN (PEP 600). Left to the system are the C and C++ runtime alone. The
licenses of what is inside go along; a library that packaging/licenses.txt does not name, or names as GPL, is refused.
"""
import hashlib
import os
import platform
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bindings/python/backend"))
sys.dont_write_bytecode = True
from soapfilm_build import Wheel  # noqa: E402

#: Every Linux with glibc has them (PEP 600 and auditwheel's policies); the dynamic linker has several names.
SYSTEM = re.compile(r"(lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+)|ld-linux[\w-]*)\.so\.\d+")


def output(*words):
    return subprocess.run([str(word) for word in words], check=True, text=True, stdout=subprocess.PIPE).stdout


def libraries(module):
    """Name and file of every library that the module needs, and that those need, but the system's.

    TBB's allocator, which TBB would load if it lay beside it, is not among them: runs take as long without it.
    """
    found = {}
    for line in output("ldd", module).splitlines():
        match = re.fullmatch(r"\s*(\S+) => (.*?)(?: \(0x\w+\))?", line)
        if match and not SYSTEM.fullmatch(match[1]):
            if match[2] == "not found":
                sys.exit(f"{module}: {match[1]} is not found")
            found[match[1]] = Path(match[2]).resolve()
    return found


def needed(file):
    return re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "-dW", file))


def debian_package(file):
    """Its name. The database may say /lib where the file is in /usr/lib."""
    for path in (str(file), str(file).removeprefix("/usr")):
        done = subprocess.run(["dpkg-query", "--search", path], text=True, capture_output=True, check=False)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    return sys.exit(f"{file}: belongs to no Debian package, so its license is not known")


def licenses():
    """Package, license and the kinds of packages that carry its notice, from packaging/licenses.txt."""
    rows = {}
    for line in (ROOT / "packaging/licenses.txt").read_text(encoding="utf-8").splitlines():
        match = re.fullmatch(r"([^#\s]\S*)\s+(.*?)(?: \[(.*)\])?", line)
        if match:
            rows[match[1]] = (match[2], (match[3] or "").split())
    return rows


def bundle(module, folder):
    """Copies the libraries into a folder and lets the module and them find each other. Returns file name: package."""
    packages, names = {}, {}
    for name, file in libraries(module).items():
        stem, end = name.split(".so", 1)
        names[name] = f"{stem}-{hashlib.sha256(file.read_bytes()).hexdigest()[:8]}.so{end}"
        packages[names[name]] = debian_package(file)
        (folder / names[name]).write_bytes(file.read_bytes())
    for file in (module, *(folder / name for name in packages)):
        for name in set(needed(file)) & set(names):
            output("patchelf", "--replace-needed", name, names[name], file)
        inside = file.parent == folder
        if inside:
            output("patchelf", "--set-soname", file.name, file)
        # RPATH, not RUNPATH: it comes before LD_LIBRARY_PATH, under which libraries of other versions may lie.
        output("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN" if inside else f"$ORIGIN/../{folder.name}", file)
    return packages


def check_glibc(files, limit):
    """No file may ask for a newer glibc than the tag says."""
    for file in files:
        versions = {tuple(map(int, v)) for v in re.findall(r"GLIBC_(\d+)\.(\d+)", output("readelf", "-VW", file))}
        newest = max(versions, default=(2, 0))
        if newest > limit:
            sys.exit(f"{file.name}: needs glibc {newest[0]}.{newest[1]}, the tag says {limit[0]}.{limit[1]}")


def notices(packages):
    """Files for the wheel's folder of licenses: what is inside, and the notice of each package."""
    known = licenses()
    for name, package in packages.items():
        license, _ = known.get(package, ("", []))
        if not license or "GPL" in license:
            sys.exit(f"{name}: {package} may not go into the wheel: {license or 'not in packaging/licenses.txt'}")
    compiled_in = [package for package, (_, kinds) in known.items() if "wheel" in kinds]
    version = {package: output("dpkg-query", "-W", "-f", "${Version}", package)
               for package in sorted({*packages.values(), *compiled_in})}
    lines = ["What this wheel has inside, from Debian's packages; their sources: https://sources.debian.org", ""]
    lines += [f"{name}: {package} {version[package]}, {known[package][0]}" for name, package in packages.items()]
    lines += [f"compiled in: {package} {version[package]}, {known[package][0]}" for package in compiled_in]
    files = {"CONTENT.txt": ("\n".join(lines) + "\n").encode(),
             "soapfilm.copyright": (ROOT / "packaging/debian/copyright").read_bytes()}
    for package in version:
        files[f"{package}.copyright"] = Path(f"/usr/share/doc/{package}/copyright").read_bytes()
    for license in ("Apache-2.0", "MPL-2.0"):  # which these name, without their text
        files[f"{license}.txt"] = Path(f"/usr/share/common-licenses/{license}").read_bytes()
    return files


def repair(source, out, work):
    limit = tuple(map(int, os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")))[:2]
    tag = f"manylinux_{limit[0]}_{limit[1]}_{platform.machine()}"
    with zipfile.ZipFile(source) as archive:
        archive.extractall(work)
        order = [name for name in archive.namelist() if not name.endswith("/RECORD")]
    folder = work / "soapfilm.libs"
    folder.mkdir()
    (module,) = work.glob("soapfilm/_core.*.so")
    packages = bundle(module, folder)
    check_glibc([module, *sorted(folder.iterdir())], limit)
    (info,) = work.glob("*.dist-info")

    def change(name, pattern, text):
        before = (info / name).read_text(encoding="utf-8")
        after, count = re.subn(pattern, text, before, count=1, flags=re.M)
        assert count == 1, f"{name} has no {pattern}"
        (info / name).write_text(after, encoding="utf-8")

    change("WHEEL", r"^(Tag: \w+-\w+)-\w+$", rf"\1-{tag}")
    # Who installs this wheel has pip, and mostly a registry: NumPy comes along.
    change("METADATA", r"^(Provides-Extra: )", r"Requires-Dist: numpy>=1.20\n\1")
    out.mkdir(parents=True, exist_ok=True)
    target = out / re.sub(r"[^-]+\.whl$", f"{tag}.whl", source.name)
    wheel = Wheel(target, info.name)
    for name in order:
        wheel.add(name, (work / name).read_bytes(), executable=name.endswith(".so"))
    for name in packages:
        wheel.add(f"{folder.name}/{name}", (folder / name).read_bytes(), executable=True)
    for name, data in notices(packages).items():
        wheel.add(f"{info.name}/licenses/{name}", data)
    wheel.close()
    print(f"{target}: {target.stat().st_size / 1e6:.1f} MB, inside are {', '.join(packages)}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    with tempfile.TemporaryDirectory() as temporary:
        repair(Path(sys.argv[1]), Path(sys.argv[2]), Path(temporary))
