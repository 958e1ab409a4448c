"""Errors and warnings speak Python: no option of the command line is left in them."""
import inspect
import re
from pathlib import Path

import numpy as np
import pytest

import soapfilm
from soapfilm._words import OPTIONS, READING, in_python

ROOT = Path(__file__).resolve().parents[3]


def lines_with_options():
    """Every text of the library and the tools that names an option, as the sources have it."""
    found = []
    for folder in ("src/soapfilm", "tools"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".cpp", ".h"):
                continue
            source = re.sub(r"^\s*//.*$", "", path.read_text(), flags=re.M)
            source = re.sub(r'"\s*\n\s*"', "", source)  # one text on several lines
            for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', source):
                if "reconstruct --report" in text or "--above z=Z" in text:  # of report files; of the program's page
                    continue
                if re.search(r"(?<![\w!-])--[a-z]", text):
                    found.append(text)
    return found


def test_the_sources_name_options():
    assert len(lines_with_options()) > 40


def known(keyword, of_reading):
    """Is it an argument of the function that is meant?"""
    if of_reading:
        return keyword in inspect.signature(soapfilm.read).parameters
    return keyword in OPTIONS or keyword == "lambda_" or keyword in inspect.signature(soapfilm.reconstruct).parameters


@pytest.mark.parametrize("line", lines_with_options())
def test_every_option_that_the_library_names(line):
    python = in_python(line.replace("{:.2g}", "0.25").replace("{}", "solid"))
    assert "--" not in python
    options = [name.replace("-", "_") for name in re.findall(r"(?<![\w-])--([a-z][a-z-]*)", line)]
    keywords = re.findall(r"(\w+)=(?!=)\S*( of soapfilm\.read)?", python)
    assert [name for name, _ in keywords] == [name if name != "lambda" else "lambda_" for name in options]
    for (keyword, of_reading), option in zip(keywords, options):
        assert bool(of_reading) == (option in READING) and known(keyword, of_reading), keyword


@pytest.mark.parametrize("option", sorted(OPTIONS) + sorted(READING))
def test_every_option(option):
    word = "lambda_" if option == "lambda" else option
    line = in_python(f"try --{option.replace('_', '-')}, or another")
    assert re.fullmatch(rf"try {word}=(True)?( of soapfilm\.read)?, or another", line), line


@pytest.mark.parametrize("line, python", [
    ("try --voxel 0.05.", "try voxel=0.05."), ("--voxel 1e-05 would fit", "voxel=1e-05 would fit"),
    ("--memory is 2 GB", "memory= is 2 GB"), ("--memory 2G", "memory='2G'"),
    ("try --outside solid", "try outside='solid'"), ("(if not: --up, or --sensor)", "(if not: up=, or sensor=)"),
    ("try --sensor X,Y,Z", "try sensor=(x, y, z)"), ("try --drop-components off", "try drop_components=False"),
    ("smaller --voxel or --lambda", "smaller voxel= or lambda_="), ("stay filled (--trim-holes)",
                                                                    "stay filled (trim_holes=True)"),
    ("(else: --columns time,x,y,z)", "(else: columns='time,x,y,z' of soapfilm.read)"),
    ("name them with --columns -,x,y,z", "name them with columns='-,x,y,z' of soapfilm.read"),
    ("lambda = 3, must be", "lambda_ = 3, must be"), ("energy.lambda = 3: must be", "lambda_ = 3: must be"),
    ("surface.refine = 3: must be true or false", "refine = 3: must be True or False"),
    ("sor.tolerance = 3: must be", "sor.tolerance = 3: must be"),
    ("a--b.ply: --- no option", "a--b.ply: --- no option"),
])
def test_meaning(line, python):
    assert in_python(line) == python
    assert str(soapfilm.ParameterError(line)) == str(soapfilm.SoapfilmWarning(line)) == python
    assert in_python(python) == python, "twice is once"


def test_an_error_of_a_run(ball):
    with pytest.raises(soapfilm.ParameterError, match=r"^lambda_ = auto: the surface of method vrip"):
        soapfilm.reconstruct(ball, ball, resolution=32, lambda_="auto", method="vrip")
    with pytest.raises(soapfilm.OutOfMemory, match="memory= is 1.00 MiB") as caught:
        soapfilm.reconstruct(ball, ball, voxel=0.005, memory="1M")
    assert "--" not in str(caught.value)


def noisy(ball):
    """Warned of: no normals, and outliers."""
    return np.concatenate([ball, 1.5 * ball[::40]])


@pytest.mark.parametrize("progress", [True, False, lambda *event: None])
def test_warnings_of_a_run(ball, progress):
    with pytest.warns(soapfilm.SoapfilmWarning) as seen:
        result = soapfilm.reconstruct(noisy(ball), resolution=64, progress=progress)
    lines = [str(w.message) for w in seen]
    assert lines == result.warnings and any("sensor=" in line for line in lines)
    assert not any("--" in line for line in lines) and any("--sensor" in line for line in result.report["warnings"])
    assert all(w.filename == __file__ for w in seen)
    assert "sensor=" in result._repr_html_() and "--sensor" not in result._repr_html_().split("<table>")[1]


@pytest.mark.parametrize("progress", [True, False])
def test_warnings_of_reading(tmp_path, ball, progress):
    path = tmp_path / "cloud.txt"
    path.write_text("".join(f"{k} {x:.4f} {y:.4f} {z:.4f}\n" for k, (x, y, z) in enumerate(ball)))
    for call in (lambda: soapfilm.read(path, progress=progress),
                 lambda: soapfilm.Reconstructor().add(path, progress=progress)):
        with pytest.warns(soapfilm.SoapfilmWarning) as seen:
            points = call()
        lines = [str(w.message) for w in seen]
        assert any("columns='x,y,z,...' of soapfilm.read" in line for line in lines), lines
        assert all(w.filename == __file__ for w in seen)
        assert points is None or points.warnings == lines
    with pytest.warns(soapfilm.SoapfilmWarning, match="of soapfilm.read") as seen:
        soapfilm.render(path, size=(20, 20), samples=1)
    assert seen[0].filename == __file__
