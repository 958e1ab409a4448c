"""What is installed, and what is built from it."""
import ast
import importlib.util
import json
import re
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import soapfilm

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = Path(soapfilm.__file__).parent


def test_the_installed_package_is_tested():
    assert ROOT not in PACKAGE.parents or "out" in PACKAGE.relative_to(ROOT).parts


def test_one_version():
    written = re.search(r"project\(soapfilm VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert soapfilm.__version__ == metadata.version("soapfilm") == written


def test_every_public_name_has_words():
    for name in soapfilm.__all__:
        thing = getattr(soapfilm, name)
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, (property, classmethod))):
                assert value.__doc__, f"{name}.{member}"


def test_stubs_name_what_the_module_has():
    assert (PACKAGE / "py.typed").exists()
    tree = ast.parse((PACKAGE / "_core.pyi").read_text())
    stubs = {node.name for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    stubs |= {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
    assert stubs == {name for name in dir(soapfilm._core) if not name.startswith("_")}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            members = {item.name if isinstance(item, ast.FunctionDef) else item.target.id for item in node.body
                       if isinstance(item, (ast.FunctionDef, ast.AnnAssign))} - {"__init__"}
            assert members == {name for name in dir(getattr(soapfilm._core, node.name)) if not name.startswith("_")}


def test_importing_needs_no_numpy():
    """NumPy is loaded by who uses arrays: from files to a file it would be a tenth of the memory."""
    code = "import sys, soapfilm; sys.exit('numpy' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_sdist_has_what_a_build_needs(tmp_path):
    import tarfile

    code = ("import sys; sys.path.insert(0, sys.argv[1]); import soapfilm_build; "
            "print(soapfilm_build.build_sdist(sys.argv[2]))")
    words = [sys.executable, "-c", code, str(ROOT / "bindings/python/backend"), str(tmp_path)]
    name = subprocess.run(words, check=True, capture_output=True, text=True).stdout.strip()
    with tarfile.open(tmp_path / name) as archive:
        names = archive.getnames()
    base = name[:-len(".tar.gz")]
    for file in ("CMakeLists.txt", "PKG-INFO", "pyproject.toml", "src/soapfilm/run/reconstruct.cpp",
                 "include/soapfilm/reconstruct.h", "cmake/version.h.in", "bindings/python/CMakeLists.txt",
                 "bindings/python/soapfilm/py.typed", "tools/render/render.cpp"):
        assert f"{base}/{file}" in names
    assert not any("build/" in n or "__pycache__" in n for n in names)


def test_metadata_is_made_without_building(tmp_path):
    """pip asks for it before it builds; where nothing can be compiled it is there all the same, as in the wheel."""
    import os

    code = ("import sys; sys.path.insert(0, sys.argv[1]); import soapfilm_build; "
            "print(soapfilm_build.prepare_metadata_for_build_wheel(sys.argv[2]))")
    words = [sys.executable, "-c", code, str(ROOT / "bindings/python/backend"), str(tmp_path)]
    nothing = {**os.environ, "PATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}
    name = subprocess.run(words, check=True, capture_output=True, text=True, env=nothing).stdout.strip()
    assert name == f"soapfilm-{soapfilm.__version__}.dist-info"
    installed = metadata.distribution("soapfilm")
    for file in ("METADATA", "LICENSE", "WHEEL"):
        assert (tmp_path / name / file).read_text(encoding="utf-8") == installed.read_text(file), file
    if importlib.util.find_spec("pip") is None:
        return
    words = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--no-index",
             "--no-build-isolation", "--no-deps", "--report", str(tmp_path / "report.json"), "--quiet", str(ROOT)]
    done = subprocess.run(words, capture_output=True, text=True, env=nothing)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "report.json").read_text())["install"][0]["metadata"]
    assert (found["name"], found["version"]) == ("soapfilm", soapfilm.__version__)
