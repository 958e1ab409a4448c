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


def test_show_without_anything(monkeypatch, result):
    for name in ("open3d", "pyvista", "IPython"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "IPython")
    with pytest.raises(ImportError, match="show\\(\\) needs"):
        result.show()
