"""Meshes for other packages: with the real ones where they are installed, else with modules that stand in for them."""
import sys
import types

import numpy as np
import pytest

import soapfilm


@pytest.fixture(scope="module")
def result(ball):
    return soapfilm.reconstruct(ball, ball, colors=np.abs(ball), resolution=32, distance=True)


def test_open3d(result):
    o3d = pytest.importorskip("open3d")
    mesh = result.to_open3d()
    assert isinstance(mesh, o3d.geometry.TriangleMesh) and mesh.is_watertight() and mesh.is_orientable()
    assert np.array_equal(np.asarray(mesh.vertices), result.vertices)
    assert np.array_equal(np.asarray(mesh.triangles), result.triangles)
    assert np.allclose(np.asarray(mesh.vertex_colors) * 255, result.colors)
    assert mesh.get_volume() == pytest.approx(result.volume)
    assert soapfilm.evaluate(mesh, result, points=200)["mesh_to_truth"]["distance"]["maximum"] < 1e-9


def stand_in(monkeypatch, name, **members):
    module = types.ModuleType(name)
    vars(module).update(members)
    monkeypatch.setitem(sys.modules, name, module)


def test_open3d_stand_in(monkeypatch, result):
    class TriangleMesh:
        def __init__(self, vertices, triangles):
            self.vertices, self.triangles = vertices, triangles

    stand_in(monkeypatch, "open3d",
             utility=types.SimpleNamespace(Vector3dVector=np.float64, Vector3iVector=lambda a: a),
             geometry=types.SimpleNamespace(TriangleMesh=TriangleMesh))
    mesh = result.to_open3d()
    assert np.array_equal(mesh.vertices, result.vertices) and mesh.triangles.dtype == np.int32
    assert mesh.vertex_colors.max() <= 1


def test_trimesh_stand_in(monkeypatch, result):
    stand_in(monkeypatch, "trimesh", Trimesh=lambda **given: types.SimpleNamespace(**given))
    mesh = result.to_trimesh()
    assert np.array_equal(mesh.faces, result.triangles) and not mesh.process
    assert np.array_equal(mesh.vertex_attributes["distance"], result.attributes["distance"])
    mesh.vertices[0] = 0  # its own copy
    assert soapfilm.evaluate(result, result, points=200)["mesh_to_truth"]["distance"]["maximum"] < 1e-9


def test_pyvista_stand_in(monkeypatch, result):
    class PolyData:
        def __init__(self, points, faces):
            self.points, self.faces, self.point_data = points, faces, {}

    stand_in(monkeypatch, "pyvista", PolyData=PolyData)
    mesh = result.to_pyvista()
    faces = mesh.faces.reshape(-1, 4)
    assert (faces[:, 0] == 3).all() and np.array_equal(faces[:, 1:], result.triangles)
    assert set(mesh.point_data) == {"Normals", "RGB", "distance"}


@pytest.mark.parametrize("package, convert", [("trimesh", "to_trimesh"), ("pyvista", "to_pyvista")])
def test_real_packages(result, package, convert):
    pytest.importorskip(package)
    mesh = getattr(result, convert)()
    assert mesh.volume == pytest.approx(result.volume, rel=1e-6)


def test_windows_of_other_packages(monkeypatch, result, ball):
    """By name; without one only where there is no page, whichever is installed."""
    shown = []
    for shape in (result, soapfilm.Points(ball, ball, colors=np.abs(ball), values={"a": ball[:, 0]})):
        monkeypatch.setattr(type(shape), "to_open3d", lambda self: "mesh of Open3D")
        monkeypatch.setattr(type(shape), "to_pyvista", lambda self: types.SimpleNamespace(plot=lambda: shown.append(3)))
        stand_in(monkeypatch, "open3d", visualization=types.SimpleNamespace(
            draw_geometries=lambda shapes, window_name: shown.append(shapes)))
        assert shape.show("open3d") is None and shown.pop() == ["mesh of Open3D"]
        assert shape.show("pyvista") is None and shown.pop() == 3
        monkeypatch.setattr(soapfilm._core, "has_viewer", False)
        assert shape.show() is None and shown.pop() == ["mesh of Open3D"]
        monkeypatch.setitem(sys.modules, "open3d", None)
        stand_in(monkeypatch, "pyvista")
        assert shape.show() is None and shown.pop() == 3


def test_clouds_in_open3d(ball):
    o3d = pytest.importorskip("open3d")
    cloud = soapfilm.Points(ball, ball, colors=np.abs(ball)).to_open3d()
    assert isinstance(cloud, o3d.geometry.PointCloud) and cloud.has_normals() and cloud.has_colors()
    again = soapfilm.Points(cloud)
    assert np.array_equal(again.positions, ball) and np.array_equal(again.colors, np.rint(255 * np.abs(ball)))


def test_clouds_in_pyvista(monkeypatch, ball):
    class PolyData:
        def __init__(self, points):
            self.points, self.point_data = points, {}

    stand_in(monkeypatch, "pyvista", PolyData=PolyData)
    cloud = soapfilm.Points(ball, ball, values={"a": ball[:, 0]}).to_pyvista()
    assert set(cloud.point_data) == {"Normals", "a"} and len(cloud.points) == len(ball)


def test_show_without_anything(monkeypatch, result):
    for name in ("open3d", "pyvista"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setattr(soapfilm._core, "has_viewer", False)
    with pytest.raises(ImportError, match="show\\(\\) needs the viewer"):
        result.show()


def test_show_in_a_notebook(monkeypatch, result):
    """Below the cell: nothing is opened, nothing written."""
    shown = []
    stand_in(monkeypatch, "ipykernel")
    stand_in(monkeypatch, "IPython", get_ipython=lambda: "a shell")
    stand_in(monkeypatch, "IPython.display", HTML=lambda text: text, display=shown.append)
    assert result.show() is None
    assert len(shown) == 1 and "proved" in shown[0]
    soapfilm.Points(result.vertices).show()
    assert "samples" in shown[1] and ("<iframe" in shown[1] or "<img" in shown[1])
