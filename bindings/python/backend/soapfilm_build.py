"""Builds wheels and sdists of soapfilm (PEP 517) with CMake and Python's standard library alone.

A wheel is built in build/python, or in the build folder that SOAPFILM_BUILD_DIR (or the config setting build-dir)
names: one of `cmake --preset release` is used again and compiles the module alone. SOAPFILM_CMAKE_ARGS (cmake-args):
further arguments of cmake.
"""
import base64
import hashlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
#: What an sdist has: enough for `pip install`, nothing of tests, measurements and documents.
SOURCES = ("CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "pyproject.toml", "bindings", "cli", "cmake",
           "include", "src", "tools")


def project():
    """The table of pyproject.toml, and the version of CMakeLists.txt, which is written nowhere else."""
    try:
        import tomllib
    except ImportError:  # before Python 3.11
        from pip._vendor import tomli as tomllib
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = re.search(r"^project\(soapfilm VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), flags=re.M)
    return {**table, "version": found[1]}


def metadata(table):
    """The file METADATA of a wheel, PKG-INFO of an sdist."""
    lines = ["Metadata-Version: 2.1", f"Name: {table['name']}", f"Version: {table['version']}",
             f"Summary: {table['description']}", f"License: {table['license']['text']}",
             f"Keywords: {','.join(table['keywords'])}", f"Requires-Python: {table['requires-python']}"]
    lines += [f"Classifier: {name}" for name in table["classifiers"]]
    lines += [f"Requires-Dist: {name}" for name in table["dependencies"]]
    for extra, names in table["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f'Requires-Dist: {name}; extra == "{extra}"' for name in names)]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / table["readme"]).read_text(encoding="utf-8")]
    return "\n".join(lines)


def setting(settings, name, variable):
    value = (settings or {}).get(name) or os.environ.get(variable)
    return value[-1] if isinstance(value, list) else value


def run(*words):
    print("+", shlex.join(map(str, words)), flush=True)
    try:
        subprocess.run([str(w) for w in words], cwd=ROOT, check=True)
    except FileNotFoundError:
        sys.exit(f"{words[0]}: not found; 'make packages-python' installs what the build needs")
    except subprocess.CalledProcessError as error:
        sys.exit(f"{words[0]}: exit code {error.returncode}")


def build(settings):
    """Builds the package; returns its folder."""
    given = setting(settings, "build-dir", "SOAPFILM_BUILD_DIR")
    folder = (ROOT / given) if given else ROOT / "build" / "python"
    python = os.path.realpath(sys.executable)  # not that of an environment that will be gone
    words = ["cmake", "-S", ROOT, "-B", folder, "-DSOAPFILM_BUILD_PYTHON=ON", f"-DPython_EXECUTABLE={python}"]
    if not (folder / "CMakeCache.txt").exists():
        if shutil.which("ninja"):
            words += ["-G", "Ninja"]
        words += ["-DCMAKE_BUILD_TYPE=Release"]
        if not given:  # nothing but the package
            words += [f"-DSOAPFILM_BUILD_{part}=OFF" for part in ("CLI", "TESTS", "EXAMPLES")]
    run(*words, *shlex.split(setting(settings, "cmake-args", "SOAPFILM_CMAKE_ARGS") or ""))
    run("cmake", "--build", folder, "--target", "soapfilm_python", "--parallel", str(os.cpu_count() or 1))
    return folder / "python" / "soapfilm"


def wheel_tag():
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


class Wheel:
    """A zip file that keeps the record of its members. Times are fixed: the same files give the same bytes."""

    def __init__(self, path, info):
        self.zip = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        self.info = info
        self.record = []

    def add(self, name, data, executable=False):
        entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
        entry.compress_type = zipfile.ZIP_DEFLATED
        entry.external_attr = (0o100755 if executable else 0o100644) << 16
        self.zip.writestr(entry, data)
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(data)}")

    def close(self):
        name = f"{self.info}/RECORD"
        self.zip.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), "\n".join([*self.record, f"{name},,"]) + "\n")
        self.zip.close()


def info_files(table):
    """Of the folder .dist-info, but RECORD; nothing is compiled for them."""
    return {
        "METADATA": metadata(table).encode(),
        "LICENSE": (ROOT / "LICENSE").read_bytes(),
        "WHEEL": f"Wheel-Version: 1.0\nGenerator: soapfilm_build\nRoot-Is-Purelib: false\n"
                 f"Tag: {wheel_tag()}\n".encode(),
    }


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """For pip, which asks before it builds: without this hook it would build a wheel to look into it."""
    table = project()
    name = f"{table['name']}-{table['version']}.dist-info"
    folder = Path(metadata_directory) / name
    folder.mkdir(parents=True, exist_ok=True)
    for file, data in info_files(table).items():
        (folder / file).write_bytes(data)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    table = project()
    package = build(config_settings)
    info = f"{table['name']}-{table['version']}.dist-info"
    name = f"{table['name']}-{table['version']}-{wheel_tag()}.whl"
    wheel = Wheel(Path(wheel_directory) / name, info)
    module = f"_core{sysconfig.get_config_var('EXT_SUFFIX')}"
    scripts = sorted(p.name for p in (ROOT / "bindings/python/soapfilm").iterdir() if p.suffix in (".py", ".pyi"))
    for file in [*scripts, "py.typed", module]:
        wheel.add(f"soapfilm/{file}", (package / file).read_bytes(), executable=file == module)
    for file, data in info_files(table).items():
        wheel.add(f"{info}/{file}", data)
    wheel.close()
    return name


def build_sdist(sdist_directory, config_settings=None):
    table = project()
    base = f"{table['name']}-{table['version']}"
    with tarfile.open(Path(sdist_directory) / f"{base}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:
        def clean(entry):
            entry.uid = entry.gid = 0
            entry.uname = entry.gname = ""
            return None if "__pycache__" in entry.name else entry

        for name in SOURCES:
            archive.add(ROOT / name, f"{base}/{name}", filter=clean)
        text = metadata(table).encode()
        entry = tarfile.TarInfo(f"{base}/PKG-INFO")
        entry.size = len(text)
        archive.addfile(entry, io.BytesIO(text))
    return f"{base}.tar.gz"
