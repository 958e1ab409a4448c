"""The same samples and parameters give the same bytes, however they arrive."""
import numpy as np
import pytest
from conftest import RESOLUTION, mesh_bytes

import soapfilm


@pytest.fixture(scope="module")
def oracle(knot):
    return mesh_bytes(soapfilm.reconstruct(*knot, resolution=RESOLUTION))


@pytest.mark.parametrize("words, parameters", [
    ("", {}),
    ("--lambda 0.05 --refine off --isovalue 0.4", dict(lambda_=0.05, refine="off", isovalue=0.4)),
    ("--method poisson", dict(method="poisson")),
    ("--lambda auto --folds 3", {"lambda": "auto", "folds": 3}),
    ("--weights samples --distance --support --attributes all",
     dict(weights="samples", distance=True, support="on", attributes="all")),
    ("--trim 0.05 --trim-holes --outside air --directions normals",
     dict(trim=0.05, trim_holes=True, outside="air", directions="normals")),
    ("--directions estimate --up=-y", dict(directions="estimate", up="-y")),
    ("--tolerance 0.01 --max-iterations 500 --settle off --norm anisotropic",
     dict(solve=dict(tolerance=0.01, max_iterations=500, settle=False), energy=dict(norm="anisotropic"))),
])
@pytest.mark.parametrize("suffix", [".ply", ".glb"])
def test_the_programs_file(tmp_path, knot, program, words, parameters, suffix):
    cloud, theirs, ours = tmp_path / "cloud.ply", tmp_path / f"theirs{suffix}", tmp_path / f"ours{suffix}"
    soapfilm.Points(*knot).save(cloud)
    program("reconstruct", cloud, "-o", theirs, "--resolution", RESOLUTION, "--quiet", *words.split())
    soapfilm.reconstruct(cloud, resolution=RESOLUTION, **parameters).save(ours)
    assert ours.read_bytes() == theirs.read_bytes()


def test_files_clouds_and_arrays(tmp_path, knot, oracle):
    cloud = tmp_path / "cloud.ply"
    soapfilm.Points(*knot).save(cloud)
    read = soapfilm.read(cloud)
    for given in (cloud, str(cloud), [cloud], read):
        assert mesh_bytes(soapfilm.reconstruct(given, resolution=RESOLUTION)) == oracle
    assert len(read) == len(knot[0]), "a cloud that was given is still there"
    assert mesh_bytes(soapfilm.reconstruct(read.positions, read.normals, resolution=RESOLUTION)) == oracle


def layouts(array):
    """The same values, differently in memory."""
    n = len(array)
    yield "fortran", np.asfortranarray(array)
    wide = np.zeros((n, 7), dtype=array.dtype)
    wide[:, 2:5] = array
    yield "columns of a table", wide[:, 2:5]
    sparse = np.zeros((2 * n, 3), dtype=array.dtype)
    sparse[::2] = array
    yield "every second row", sparse[::2]
    yield "backwards", np.ascontiguousarray(array[::-1])[::-1]
    yield "columns backwards", np.ascontiguousarray(array[:, ::-1])[:, ::-1]
    frozen = array.copy()
    frozen.flags.writeable = False
    yield "read-only", frozen
    record = np.zeros(n, dtype=[("flag", "u1"), ("xyz", array.dtype, 3)])  # unaligned
    record["xyz"] = array
    yield "unaligned field", record["xyz"]
    yield "big-endian", array.astype(array.dtype.newbyteorder(">"))
    yield "list", array.tolist()


def test_every_layout(knot, oracle):
    positions, normals = knot
    for (name, points), (_, directions) in zip(layouts(positions), layouts(normals)):
        assert mesh_bytes(soapfilm.reconstruct(points, directions, resolution=RESOLUTION)) == oracle, name


def test_float32_is_its_value(knot):
    single = knot[0].astype(np.float32)
    a = soapfilm.reconstruct(single, knot[1], resolution=RESOLUTION)
    b = soapfilm.reconstruct(single.astype(np.float64), knot[1].astype(np.float64), resolution=RESOLUTION)
    assert mesh_bytes(a) == mesh_bytes(b)


def test_whole_numbers(ball):
    whole = np.rint(1000 * ball).astype(np.int32)
    a = soapfilm.reconstruct(whole, ball, resolution=32)
    b = soapfilm.reconstruct(whole.astype(np.float64), ball, resolution=32)
    assert mesh_bytes(a) == mesh_bytes(b)


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_any_number_of_threads(knot, oracle, threads):
    assert mesh_bytes(soapfilm.reconstruct(*knot, resolution=RESOLUTION, threads=threads)) == oracle


def test_a_report_is_parameters(knot):
    first = soapfilm.reconstruct(*knot, voxel=0.04, lambda_=0.03, distance=True)
    again = soapfilm.reconstruct(*knot, params=first)
    assert mesh_bytes(again) == mesh_bytes(first)
    assert "distance" in again.attributes
    finer = soapfilm.reconstruct(*knot, params=first.report, resolution=64)
    assert max(finer.report["grid"]["size"]) == 64


def test_labels_and_counts_of_scans(ball):
    labels = np.where(ball[:, 2] > 0.2, 7, np.where(ball[:, 0] > 0, -3, 2))
    sensors = np.array([[3.0, 0, 0], [-3, 0, 0], [0, 0, 4]])  # by ascending label: -3, 2, 7
    given = soapfilm.reconstruct(ball, scans=labels, sensors=sensors, resolution=32, outside="air")
    order = np.argsort(labels, kind="stable")
    counts = [int((labels == label).sum()) for label in (-3, 2, 7)]
    sorted_ = soapfilm.reconstruct(ball[order], scans=counts, sensors=sensors, resolution=32, outside="air")
    assert mesh_bytes(given) == mesh_bytes(sorted_)
    assert given.report["input"]["scans"] == 3
    points = soapfilm.Points(ball, scans=labels, sensors=sensors)
    assert [scan["sensor"] for scan in points.scans] == [tuple(row) for row in sensors]
    assert np.array_equal(points.positions, ball[order])


def test_sensors_of_samples_of_scans_and_one(ball):
    one = soapfilm.reconstruct(ball, sensors=(0, 0, 5), resolution=32, outside="air")
    row = soapfilm.reconstruct(ball, sensors=[(0, 0, 5)], resolution=32, outside="air")
    each = soapfilm.reconstruct(ball, sensors=np.broadcast_to([0, 0, 5.0], ball.shape), resolution=32, outside="air")
    assert mesh_bytes(one) == mesh_bytes(row)
    assert one.report["input"]["directions"]["sensor"] == len(ball) == each.report["input"]["directions"]["sensor"]


def test_weights_count(ball):
    heavy = np.where(ball[:, 2] > 0, 2.0, 1.0)
    twice = np.concatenate([ball, ball[heavy == 2]])
    a = soapfilm.reconstruct(ball, ball, weights=heavy, resolution=32)
    b = soapfilm.reconstruct(twice, twice, resolution=32)
    assert a.volume == pytest.approx(b.volume, rel=1e-3)
    assert mesh_bytes(a) != mesh_bytes(soapfilm.reconstruct(ball, ball, resolution=32))
