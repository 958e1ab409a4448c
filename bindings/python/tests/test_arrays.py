"""What comes back: views, exact and alive as long as they are used."""
import gc

import numpy as np
import pytest

import soapfilm


@pytest.fixture(scope="module")
def result(ball):
    colors = np.zeros((len(ball), 3), dtype=np.uint8)
    colors[:, 0] = 200
    values = {"height": ball[:, 2], "class": np.full(len(ball), 4)}
    return soapfilm.reconstruct(ball, ball, colors=colors, values=values, attributes="all", distance=True,
                                resolution=32)


def test_shapes_and_types(result):
    vertices, triangles = len(result.vertices), len(result.triangles)
    assert result.vertices.shape == (vertices, 3) and result.vertices.dtype == np.float64
    assert result.triangles.shape == (triangles, 3) and result.triangles.dtype == np.uint32
    assert result.normals.shape == (vertices, 3) and result.normals.dtype == np.float32
    assert result.colors.shape == (vertices, 3) and result.colors.dtype == np.uint8
    assert set(result.attributes) == {"height", "class", "distance"}
    for values in result.attributes.values():
        assert values.shape == (vertices,) and values.dtype == np.float32
    assert result.triangles.max() == vertices - 1


def test_values_are_those_of_the_samples(result):
    assert np.abs(np.linalg.norm(result.vertices, axis=1) - 1).max() < 0.02
    assert (result.colors == [200, 0, 0]).all()
    assert np.abs(result.attributes["height"] - result.vertices[:, 2]).max() < 0.1
    assert (result.attributes["class"] == 4).all()
    assert np.sum(result.normals * result.vertices, axis=1).min() > 0.9
    assert result.volume == pytest.approx(4 / 3 * np.pi, rel=0.01)


def test_views_share_memory_and_are_read_only(result):
    assert np.shares_memory(result.vertices, result.vertices)
    for array in (result.vertices, result.triangles, result.colors, result.attributes["height"]):
        assert not array.flags.owndata
    for array in (result.vertices, result.triangles, result.normals, result.colors, result.attributes["height"]):
        with pytest.raises(ValueError):
            array[0] = 0


def test_views_keep_their_result_alive(ball):
    result = soapfilm.reconstruct(ball, ball, resolution=32)
    vertices, expected = result.vertices, result.vertices.copy()
    points = soapfilm.Points(ball)
    positions = points.positions
    del result, points
    gc.collect()
    np.random.default_rng(1).random(4 * len(expected))  # what was freed would be used again
    assert np.array_equal(vertices, expected)
    assert np.array_equal(positions, ball)


def test_a_cloud_whose_arrays_are_in_use_is_kept(ball, tmp_path):
    points = soapfilm.Points(ball, ball)
    before = points.positions
    soapfilm.reconstruct(points, resolution=32)
    assert np.array_equal(before, ball) and len(points) == len(ball)


def test_a_saved_mesh_is_read_again(result, tmp_path):
    result.save(tmp_path / "mesh.ply")
    mesh = soapfilm.read_mesh(tmp_path / "mesh.ply")
    assert np.array_equal(mesh.triangles, result.triangles)
    assert np.abs(mesh.vertices - result.vertices).max() <= 1e-3 * result.voxel
    made = soapfilm.Mesh(mesh.vertices, mesh.triangles, colors=mesh.colors / 255.0, attributes=mesh.attributes)
    assert np.array_equal(made.vertices, mesh.vertices) and np.array_equal(made.colors, mesh.colors)
    assert made.topology() == result.topology()
    assert result.topology()["watertight"] and result.topology()["genus"] == 0


def test_report_and_certificate(result):
    report = result.report
    assert report["report_version"] == 1 and report["soapfilm"] == soapfilm.__version__
    assert report["mesh"]["vertices"] == len(result.vertices)
    assert 0 <= result.certificate["relative_gap_binary"] < 0.2
    assert result.warnings == report["warnings"]
    assert soapfilm.reconstruct(result.vertices, result.normals, method="poisson", resolution=32).certificate


def test_points_come_back(ball):
    weights, colors = np.linspace(0, 1, len(ball)), np.abs(ball)
    points = soapfilm.Points(ball, -ball, weights=weights, colors=colors, sensors=ball * 3, values={"a": ball[:, 0]})
    assert np.array_equal(points.positions, ball) and points.positions.dtype == np.float64
    assert np.array_equal(points.normals, (-ball).astype(np.float32))
    assert np.array_equal(points.weights, weights.astype(np.float32))
    assert np.array_equal(points.colors, np.rint(colors * 255).astype(np.uint8))
    assert np.array_equal(points.sensors, ball * 3)
    assert np.array_equal(points.values["a"], ball[:, 0].astype(np.float32))
    assert points.coordinate_system is None and points.warnings == [] and points.files == []
    assert repr(points) == "<soapfilm.Points: 4000 samples in 1 scan, normals, sensors, weights, colors, a>"


def test_what_is_absent_is_none(ball):
    points = soapfilm.Points(ball)
    assert points.normals is None and points.colors is None and points.weights is None and points.sensors is None
    assert points.values == {}
    mesh = soapfilm.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert mesh.colors is None and np.array_equal(mesh.normals, [(0, 0, 1)] * 3)
    assert np.array_equal(soapfilm.Mesh(mesh.vertices, mesh.triangles, normals=-mesh.normals).normals, -mesh.normals)
    assert mesh.volume == 0 and mesh.attributes == {} and mesh.area == 0.5


def test_range_grids(tmp_path):
    points = soapfilm.scan("sphere", views=2, image=(20, 12))
    scan = points.scans[1]
    grid = scan["range_grid"]
    assert grid.shape == (12, 20) and grid.dtype == np.int32 and grid.max() == scan["end"] - scan["begin"] - 1
    points.save(tmp_path / "scans.ply")
    again = soapfilm.read(tmp_path / "scans.ply")
    assert np.array_equal(again.scans[1]["range_grid"], grid) and np.array_equal(again.positions, points.positions)
    assert again.files[0]["samples"] == len(points)
