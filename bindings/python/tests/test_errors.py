"""What is refused, by which exception, in one line."""
import re
import subprocess
import sys

import numpy as np
import pytest

import soapfilm


@pytest.mark.parametrize("arguments, message", [
    (dict(points=np.zeros((5, 2))), "points: shape (5, 2), must be (N, 3)"),
    (dict(points=np.zeros((0, 3))), "points: no rows"),
    (dict(points=[["a", "b", "c"]]), "must be numbers"),
    (dict(points=[[1, 2, 3], [4, 5]]), "rows of different lengths"),
    (dict(points=np.zeros((5, 3), complex)), "must be numbers"),
    (dict(normals=np.zeros((5, 3))), "normals: 5 rows, must be one per sample or vertex (4000)"),
    (dict(weights=np.full(4000, -1.0)), "sample 0: weight = -1"),
    (dict(weights=np.zeros((4000, 2))), "weights: shape (4000, 2)"),
    (dict(colors=np.full((4000, 3), 2.0)), "colors: floats in [2, 2], must be in [0, 1]"),
    (dict(colors=np.full((4000, 3), 300)), "colors: in [300, 300]"),
    (dict(sensors=np.zeros((7, 3))), "sensors: 7 positions, must be one, one per scan (1) or one per sample (4000)"),
    (dict(sensors=[(np.nan, 0, 0)]), "sensors: not finite"),
    (dict(scans=[2000, 1999]), "make 4000 together, not 3999"),
    (dict(scans=[4000, 0]), "counts >= 1"),
    (dict(scans=np.zeros(4000)), "scans: float64"),
    (dict(values={"": np.zeros(4000)}), "values: ''"),
    (dict(values={"a": np.zeros(3)}), "values['a']: 3 rows"),
    (dict(threads=-1), "threads"),
])
def test_refused(ball, arguments, message):
    with pytest.raises(soapfilm.ParameterError, match=re.escape(message)) as caught:
        soapfilm.reconstruct(**{"points": ball, **arguments})
    assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)


def test_samples(ball):
    broken = ball.copy()
    broken[17, 1] = np.nan
    for points, message in [(broken, "sample 17: position is not finite"), (ball[:3], "must be at least 4"),
                            (ball * [1, 1, 0], "coplanar")]:
        with pytest.raises(soapfilm.SamplesError, match=message):
            soapfilm.reconstruct(points)


def test_files_bring_their_own(tmp_path, ball):
    soapfilm.Points(ball, ball).save(tmp_path / "a.ply")
    for points in (tmp_path / "a.ply", soapfilm.Points(ball)):
        with pytest.raises(soapfilm.ParameterError, match="normals: only arrays"):
            soapfilm.reconstruct(points, ball)
        with pytest.raises(soapfilm.ParameterError, match=r"sensors: shape \(2, 3\)"):
            soapfilm.reconstruct(points, sensors=np.zeros((2, 3)))
        assert soapfilm.reconstruct(points, sensors=(0, 0, 9), resolution=32).report["parameters"]["orient"]["sensor"]


def test_unreadable(tmp_path):
    (tmp_path / "bad.ply").write_text("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n")
    for path in (tmp_path / "bad.ply", tmp_path / "absent.ply"):
        for call in (soapfilm.read, soapfilm.reconstruct, soapfilm.read_mesh):
            with pytest.raises(soapfilm.InputError, match=path.name) as caught:
                call(path)
            assert isinstance(caught.value, ValueError) and "\n" not in str(caught.value)
    with pytest.raises(soapfilm.ParameterError):
        soapfilm.read([])


def test_unwritable(tmp_path, ball):
    result = soapfilm.reconstruct(ball, ball, resolution=32)
    for path in ("/no/such/folder/mesh.ply", tmp_path / "mesh.xyz"):
        with pytest.raises(soapfilm.OutputError) as caught:
            result.save(path)
        assert isinstance(caught.value, OSError)
    assert list(tmp_path.iterdir()) == []


def test_memory(ball):
    with pytest.raises(MemoryError, match="resolution") as caught:
        soapfilm.reconstruct(ball, ball, resolution=512, memory="1M")
    assert isinstance(caught.value, soapfilm.OutOfMemory)


def test_empty(ball):
    with pytest.raises(soapfilm.EmptyResult) as caught:
        soapfilm.reconstruct(ball, ball, resolution=32, lambda_=1e6)
    assert isinstance(caught.value, ValueError) and caught.value.largest_lambda >= 0


def test_warnings_are_pythons(ball):
    far = np.concatenate([ball, 1.5 * ball[::40]])
    with pytest.warns(soapfilm.SoapfilmWarning) as seen:
        result = soapfilm.reconstruct(far, np.concatenate([ball, ball[::40]]), resolution=64)
    assert [str(w.message) for w in seen] == result.warnings and result.warnings
    assert all(w.filename == __file__ for w in seen), "the line that called is named"
    import warnings
    warnings.simplefilter("error", soapfilm.SoapfilmWarning)
    with pytest.raises(soapfilm.SoapfilmWarning):
        soapfilm.reconstruct(far, np.concatenate([ball, ball[::40]]), resolution=64)


def test_warnings_of_reading(tmp_path):
    path = tmp_path / "cloud.xyz"
    path.write_text("0 0 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    with pytest.warns(soapfilm.SoapfilmWarning, match="1 of 5 samples dropped") as seen:
        points = soapfilm.read(path)
    assert len(points) == 4 and points.files[0]["dropped"] == 1
    assert seen[-1].filename == __file__


def test_nothing_is_printed_where_no_one_looks(tmp_path):
    code = ("import numpy, soapfilm; i = numpy.arange(2000) + .5; z = 1 - i / 1000; a = 2.4 * i; r = (1 - z * z) ** .5;"
            "p = numpy.column_stack([r * numpy.cos(a), r * numpy.sin(a), z]);"
            "soapfilm.reconstruct(p, p, resolution=32)")
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
