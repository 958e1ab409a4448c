"""Every name that the documents have, and errors for all others."""
import json
import re
from pathlib import Path

import numpy as np
import pytest

import soapfilm
from soapfilm import _params

ROOT = Path(__file__).resolve().parents[3]


def documented():
    """(option, keys) of every row of docs/reference/options.md."""
    found = []
    for line in (ROOT / "docs/reference/options.md").read_text().splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)]
        if len(cells) == 8 and re.search(r"--[a-z]", cells[1]):
            option = re.search(r"--([a-z-]+)", cells[1])[1].replace("-", "_")
            found.append((option, re.findall(r"`([a-z_]+\.[a-z_0-9]+)`", cells[6])))
    assert len(found) > 40
    return found


def test_every_option_of_the_documents():
    for option, keys in documented():
        if option in ("threads", "memory", "params", "help", "version"):
            continue  # arguments of their own
        if keys and option not in _params.ELSEWHERE:  # --check has a key: the memory that it plans
            assert _params.OPTIONS[option] in keys or keys == ["energy.cross_validate"], option  # --lambda auto
        else:
            assert option in _params.ELSEWHERE, option


def test_every_key_is_the_librarys():
    for option, key in _params.OPTIONS.items():
        group, name = key.split(".")
        assert name in _params._known()[group], option


def test_groups_are_the_reports():
    defaults = json.loads(soapfilm._core.default_parameters())
    assert json.loads(_params.parameters_json(defaults))["solve"] == defaults["solve"]


@pytest.mark.parametrize("given, json_of", [
    ({"lambda_": "auto"}, {"energy": {"cross_validate": True, "lambda": None}}),
    ({"lambda": np.float32(0.5)}, {"energy": {"cross_validate": False, "lambda": 0.5}}),
    ({"trim": "auto"}, {"trim": {"on": True, "distance": None}}),
    ({"trim": "off"}, {"trim": {"on": False, "distance": None}}),
    ({"trim": False}, {"trim": {"on": False, "distance": None}}),
    ({"trim": 0.5}, {"trim": {"on": True, "distance": 0.5}}),
    ({"simplify": 0.5}, {"simplify": {"tolerance": 0.5}}),
    ({"simplify": "0.05vox"}, {"simplify": {"tolerance_vox": 0.05, "tolerance": None}}),
    ({"simplify": "auto"}, {"simplify": {"automatic": True, "tolerance": None}}),
    ({"simplify": "off"}, {"simplify": {"tolerance": None}}),
    ({"triangles": 5000}, {"simplify": {"triangles": 5000}}),
    ({"trim": {"on": True}}, {"trim": {"on": True}}),
    ({"memory": "1.5G"}, {}),
    ({"refine": "off"}, {"surface": {"refine": False}}),
    ({"refine": {"smoothing": 2}}, {"refine": {"smoothing": 2}}),
    ({"attributes": "none"}, {"surface": {"attributes": []}}),
    ({"attributes": "color,height"}, {"surface": {"attributes": ["color", "height"]}}),
    ({"weights": "samples"}, {"energy": {"by_area": False}}),
    ({"sensor": np.array([1, 2, 3.0])}, {"orient": {"sensor": [1, 2, 3]}}),
    ({"voxel": None, "smoothing": 3}, {"refine": {"smoothing": 3}}),
])
def test_meaning(given, json_of):
    assert json.loads(_params.parameters_json(given)) == json_of


@pytest.mark.parametrize("given, limit", [
    ("1.5G", 3 << 29), (1000, 1000), ({"limit": 7}, 7), ({"checked": True}, None), (None, None),
])
def test_memory_is_no_parameter(given, limit):
    assert _params.memory_limit(given) == limit


def test_the_limit_of_an_earlier_run_is_not_this_ones():
    assert json.loads(_params.parameters_json({}, {"memory": {"limit": 5, "checked": True}})) == {
        "memory": {"checked": True}}


@pytest.mark.parametrize("given, nearest", [
    ({"smooting": 1}, "'smoothing'"), ({"voxels": 1}, "'voxel'"), ({"lamda": 1}, "'lambda_'"),
    ({"outsid": "air"}, "'outside'"), ({"place": {"voxl": 1}}, "'place.voxel'"), ({"solv": {}}, "'solve'"),
    ({"sor": 3}, "epsilon"), ({"report": "a.json"}, "result.report"), ({"columns": "x"}, "soapfilm.read"),
])
def test_an_unknown_name_names_the_nearest(ball, given, nearest):
    with pytest.raises(TypeError, match=re.escape(nearest)):
        soapfilm.reconstruct(ball, **given)


@pytest.mark.parametrize("given, message", [
    ({"voxel": -1}, "voxel = -1, must be > 0"),
    ({"voxel": float("nan")}, "voxel = nan, must be finite"),
    ({"voxel": 1, "resolution": 32}, "only one of them"),
    ({"method": "best"}, "must be one of tv"),
    ({"outside": 3}, "outside = 3: must be a string"),
    ({"refine": "maybe"}, "must be True or False"),
    ({"memory": "much"}, "memory = 'much'"),
    ({"memory": -1}, "memory = -1, must be > 0"),
    ({"trim": "some"}, "trim = 'some'"),
    ({"simplify": "some"}, "simplify = 'some'"),
    ({"weights": "volume"}, "weights = 'volume'"),
    ({"front": 3}, "front: only method vrip has it"),
    ({"folds": 3}, "only lambda_='auto' has it"),
    ({"tolerance": 0.1, "method": "poisson"}, "tolerance: only method tv has it"),
    ({"weights": "samples", "lambda_": 0.1}, "weights: only a lambda that follows the samples"),
    ({"smoothing": 1, "refine": False}, "not refined"),
])
def test_a_wrong_value_is_one_line(ball, given, message):
    with pytest.raises(soapfilm.ParameterError, match=re.escape(message)) as caught:
        soapfilm.reconstruct(ball, ball, **given)
    assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)


def test_parameters_of_a_file(tmp_path, ball):
    path = tmp_path / "report.json"
    path.write_text(json.dumps(soapfilm.reconstruct(ball, ball, resolution=32).report))
    assert soapfilm.reconstruct(ball, ball, params=path).report["parameters"]["place"]["resolution"] == 32
    path.write_text("{")
    with pytest.raises(soapfilm.ParameterError, match="report.json: not JSON"):
        soapfilm.reconstruct(ball, ball, params=path)
    with pytest.raises(TypeError):
        soapfilm.reconstruct(ball, ball, params=3)
