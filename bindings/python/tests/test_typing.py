"""Types of parameters: they are the library's, and a type checker uses them."""
import importlib.util
import inspect
import json
import re
import subprocess
import sys
import typing
from pathlib import Path

import pytest

import soapfilm
from soapfilm import _core, _params, _tools, options

DEFAULTS = json.loads(_core.default_parameters())


def keys(group):
    return {name for name in group.__annotations__ if name != "lambda_"}  # beside lambda, the key of the report


def test_groups_are_the_librarys():
    assert {name: keys(group) for name, group in options.GROUPS.items()} == \
        {name: set(values) for name, values in DEFAULTS.items()}


def hints(group):
    return typing.get_type_hints(group, vars(options))


def kinds(hint):
    """The types that a hint allows, texts of a Literal as they are."""
    if typing.get_origin(hint) is typing.Union:
        return {kind for part in typing.get_args(hint) for kind in kinds(part)}
    if typing.get_origin(hint) is typing.Literal:
        return set(typing.get_args(hint))
    return {typing.get_origin(hint) or hint}


@pytest.mark.parametrize("group, key", [(group, key) for group, values in DEFAULTS.items() for key in values])
def test_types_are_the_librarys(group, key):
    """A default has one of the types, a wrong word of an enumeration names those of the Literal."""
    allowed = kinds(hints(options.GROUPS[group])[key])
    default = DEFAULTS[group][key]
    assert default in allowed if isinstance(default, str) else type(default) in allowed or \
        isinstance(default, list) and allowed & {list, typing.get_origin(typing.Sequence[int])}
    points = _core.points_of({**dict.fromkeys(("normals", "sensors", "weights", "colors", "order")),
                              "positions": soapfilm.Points([[0, 0, 0]]).positions}, [], [{"end": 1}], {})
    with pytest.raises(soapfilm.ParameterError) as caught:
        _core.reconstruct(points, False, json.dumps({group: {key: "?"}}), 1, None)
    words = re.search(r"must be one of (.*)$", str(caught.value))
    expected = {kind for kind in allowed if isinstance(kind, str)}
    assert (set(words[1].split(", ")) if words else set()) == expected


def test_options_are_those_of_the_program():
    named = {name if name != "lambda_" else "lambda" for name in options.RunOptions.__annotations__}
    assert named - set(options.GROUPS) == set(_params.OPTIONS) - {"refine", "trim", "simplify", "memory"}
    assert set(options.GROUPS) <= named
    for name, key in _params.OPTIONS.items():
        group, of_group = key.split(".")
        words = {kind for kind in kinds(hints(options.GROUPS[group])[of_group]) if isinstance(kind, str)}
        given = kinds(hints(options.RunOptions)["lambda_" if name == "lambda" else name])
        assert words <= given, name


def test_options_of_tools():
    assert set(options.Shape.__annotations__) == set(_tools._SHAPE)
    assert set(options.Scan.__annotations__) == {*_tools._SCANNER, *_tools._SHAPE}


def test_completion_sees_every_option():
    parameters = inspect.signature(soapfilm.reconstruct).parameters
    assert set(options.RunOptions.__annotations__) <= set(parameters)
    assert not any(p.kind is p.VAR_KEYWORD for p in parameters.values())
    for function in (soapfilm.Reconstructor, soapfilm.Reconstructor.reconstruct):
        assert set(options.RunOptions.__annotations__) <= set(inspect.signature(function).parameters)
    assert "orbit" in inspect.signature(soapfilm.scan).parameters


def test_jedi_completes_options():
    """What notebooks and many editors ask."""
    jedi = pytest.importorskip("jedi")
    for line, name in [("soapfilm.reconstruct(cloud, max_it", "max_iterations="),
                       ("soapfilm.scan('knot', orb", "orbit=")]:
        found = jedi.Interpreter(line, [{"soapfilm": soapfilm}]).complete()
        assert name in [completion.name for completion in found]


@pytest.mark.skipif(not (Path("/usr/bin/mypy").exists() or importlib.util.find_spec("mypy")), reason="no mypy")
def test_a_type_checker(tmp_path):
    good = ("import soapfilm\nfrom soapfilm.options import Options, Solve\n"
            "result = soapfilm.reconstruct([[0.0]], voxel=0.1, method='tv', lambda_='auto', trim=0.5, refine='off',\n"
            "                              solve=dict(tolerance=1e-4), energy={'lambda': 0.5}, attributes=['a'])\n"
            "path: str = str(soapfilm.view(result).resolve())\n"
            "solve: Solve = {'max_iterations': 3}\noptions: Options = {'outside': 'air', 'solve': solve}\n"
            "soapfilm.Reconstructor(resolution=64, weights='area').reconstruct(voxel=1)\n"
            "cloud = soapfilm.scan('knot', orbit='ring', noise='0.1%')\ncloud = cloud[::2] + cloud[3:]\n")
    bad = {"soapfilm.reconstruct([], methd='tv')": "Unexpected keyword",
           "soapfilm.reconstruct([], method='tw')": "Literal",
           "soapfilm.reconstruct([], solve={'tolerence': 1.0})": "tolerence",
           "soapfilm.scan('knot', orbit=3)": "Literal",
           "soapfilm.reconstruct([], outside='aer')": "Literal"}
    (tmp_path / "good.py").write_text(good)
    (tmp_path / "bad.py").write_text("import soapfilm\n" + "".join(f"{line}\n" for line in bad))
    (tmp_path / "mypy.ini").write_text("[mypy]\nenable_incomplete_feature = Unpack\n")

    def check(*words):
        python = [sys.executable] if importlib.util.find_spec("mypy") else ["/usr/bin/python3"]
        return subprocess.run([*python, "-m", "mypy", "--cache-dir", str(tmp_path / "cache"), "--python-executable",
                               sys.executable, *words], cwd=tmp_path, capture_output=True, text=True)

    done = check("good.py")
    assert done.returncode == 0, done.stdout
    found = check("bad.py").stdout.splitlines()
    for number, (line, message) in enumerate(bad.items(), 2):
        assert any(text.startswith(f"bad.py:{number}:") and message in text for text in found), (line, found)
    done = check("--ignore-missing-imports", "-p", "soapfilm")
    assert done.returncode == 0, done.stdout
