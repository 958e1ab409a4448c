"""Every format is read as the program reads it: the files that fuzzing begins with."""
import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

import soapfilm

ROOT = Path(__file__).resolve().parents[3]


def seeds():
    spec = importlib.util.spec_from_file_location("seeds", ROOT / "fuzz" / "seeds.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for extension, files in {**module.FILES, ".xyz": module.TABLES, ".csv": module.TABLES}.items():
        for k, data in enumerate(files):
            yield pytest.param(module, extension, data, id=f"{extension[1:]}-{k}")


@pytest.mark.parametrize("module, extension, data", seeds())
def test_as_the_program(tmp_path, program, module, extension, data):
    (tmp_path / "a.ply").write_bytes(module.ply("binary_little_endian"))
    (tmp_path / "b.xyz").write_bytes(module.table())
    path = tmp_path / f"seed{extension}"
    path.write_bytes(data)
    try:
        points = soapfilm.read(path, progress=False)
    except soapfilm.InputError as error:
        # `info` reads meshes, too: a cloud is what `reconstruct` reads.
        message = program("reconstruct", path, "-o", tmp_path / "mesh.ply", "--quiet", code=2)
        assert str(error) in message
        return
    assert len(points) >= 1 and np.isfinite(points.positions).all()
    assert sum(file["samples"] for file in points.files) == len(points)
    assert points.scans[-1]["end"] == len(points)
    assert re.search(rf"\b{len(points)}\b", program("info", path))


def test_options_of_reading(tmp_path):
    path = tmp_path / "cloud.txt"
    path.write_text("".join(f"{k} 9 {k * k} {k % 3}\n" for k in range(6)))
    points = soapfilm.read(path, columns=["x", "-", "y", "z"])
    assert np.array_equal(points.positions[2], [2, 4, 2])
    with pytest.raises(soapfilm.ParameterError):
        soapfilm.read(path, trust_viewpoint=True)
    assert len(soapfilm.read(path, columns="x,-,y,z", spacing=10)) == 6  # without levels all is read


def test_a_georeferenced_mesh_has_its_coordinate_system(tmp_path, ball, monkeypatch):
    result = soapfilm.reconstruct(ball, ball, resolution=32)
    report = result.report
    report["input"]["coordinate_system"] = "EPSG:25832"
    import json
    monkeypatch.setattr(result, "_report", json.dumps(report))
    result.save(tmp_path / "mesh.ply")
    assert (tmp_path / "mesh.prj").read_text() == "EPSG:25832\n"
