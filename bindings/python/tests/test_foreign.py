"""Clouds of other packages: the real ones where they are installed, else objects with the same attributes."""
import types

import numpy as np
import pytest
from conftest import mesh_bytes

import soapfilm


@pytest.fixture(scope="module")
def colors(ball):
    return np.rint(127.5 * (ball + 1)).astype(np.uint8)


@pytest.fixture(scope="module")
def oracle(ball, colors):
    return soapfilm.reconstruct(ball, ball, colors=colors, resolution=32)


def assert_cloud(given, ball, colors, oracle, exact=True):
    """`given` is the ball with its normals and colors, for all that takes clouds."""
    points = soapfilm.Points(given)
    assert np.allclose(points.positions, ball, atol=0 if exact else 1e-6)
    assert np.allclose(points.normals, ball, atol=1e-6) and np.array_equal(points.colors, colors)
    result = soapfilm.reconstruct(given, resolution=32)
    scanner = soapfilm.Reconstructor(resolution=32)
    scanner.add(given)
    assert mesh_bytes(scanner.reconstruct()) == mesh_bytes(result)
    if exact:
        assert mesh_bytes(result) == mesh_bytes(oracle)
    assert np.array_equal(result.colors, oracle.colors) or not exact
    assert soapfilm.evaluate(result, oracle, samples=given, points=100) == \
        soapfilm.evaluate(result, oracle, samples=points.positions, points=100)
    assert soapfilm.render(given, size=(20, 20), samples=1).shape == (20, 20, 4)


def test_open3d(ball, colors, oracle):
    o3d = pytest.importorskip("open3d")
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(ball))
    assert soapfilm.Points(cloud).normals is None and soapfilm.Points(cloud).colors is None
    cloud.normals = o3d.utility.Vector3dVector(ball)
    cloud.colors = o3d.utility.Vector3dVector(colors / 255)
    assert_cloud(cloud, ball, colors, oracle)


def test_open3d_reads_and_estimates(tmp_path, ball):
    """As people do: a file, normals, a surface; and the mesh back into Open3D."""
    o3d = pytest.importorskip("open3d")
    soapfilm.Points(ball).save(tmp_path / "scan.ply")
    cloud = o3d.io.read_point_cloud(str(tmp_path / "scan.ply"))
    cloud.estimate_normals()
    cloud.orient_normals_consistent_tangent_plane(12)
    result = soapfilm.reconstruct(cloud, resolution=32)
    assert abs(result.volume) == pytest.approx(4 / 3 * np.pi, rel=0.02)
    again = soapfilm.reconstruct(result.to_open3d(), resolution=32)
    assert again.volume == pytest.approx(result.volume, rel=0.01)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_open3d_tensors(ball, colors, oracle, kind):
    o3d = pytest.importorskip("open3d")
    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(ball.astype(kind)))
    cloud.point["normals"] = o3d.core.Tensor(ball.astype(kind))
    cloud.point["colors"] = o3d.core.Tensor(colors)
    cloud.point["intensity"] = o3d.core.Tensor(ball[:, 2:].astype(np.float32))
    assert_cloud(cloud, ball, colors, oracle, exact=kind is np.float64)
    points = soapfilm.Points(cloud)
    assert np.array_equal(points.values["intensity"], ball[:, 2].astype(np.float32))
    cloud.point["colors"] = o3d.core.Tensor((colors / 255).astype(np.float32))
    assert np.array_equal(soapfilm.Points(cloud).colors, colors)
    tensor = o3d.core.Tensor(ball)
    assert np.array_equal(soapfilm.Points(tensor, normals=tensor).positions, ball)
    with pytest.raises(soapfilm.ParameterError, match="without positions"):
        soapfilm.reconstruct(o3d.t.geometry.PointCloud())


def test_open3d_meshes(oracle):
    o3d = pytest.importorskip("open3d")
    points = soapfilm.Points(oracle.to_open3d())
    assert np.array_equal(points.positions, oracle.vertices) and np.array_equal(points.colors, oracle.colors)
    mesh = o3d.t.geometry.TriangleMesh.from_legacy(oracle.to_open3d())
    assert len(soapfilm.Points(mesh)) == len(oracle.vertices)
    assert soapfilm.evaluate(mesh, oracle, points=200)["mesh_to_truth"]["distance"]["maximum"] < 1e-6


class Tensors(dict):
    """As Open3D's TensorMap."""


class Open3d:
    def __init__(self, points, normals, colors):
        self.points, self.normals, self.colors = points, normals, colors

    def has_normals(self):
        return len(self.normals) > 0


class PyVistaData(dict):
    active_normals = None


def trimesh_cloud(ball, colors):
    alpha = np.full((len(ball), 1), 255, np.uint8)
    return types.SimpleNamespace(vertices=ball, colors=np.concatenate([colors, alpha], axis=1))


def test_stand_ins(ball, colors, oracle):
    assert_cloud(Open3d(ball, ball, colors / 255), ball, colors, oracle)
    bare = soapfilm.Points(Open3d(ball, [], []))
    assert bare.normals is None and bare.colors is None
    tensors = Tensors(positions=ball, normals=ball, colors=colors)
    assert_cloud(types.SimpleNamespace(point=tensors), ball, colors, oracle)
    data = PyVistaData(Normals=ball, RGB=colors, height=ball[:, 2], pairs=ball[:, :2])
    assert_cloud(types.SimpleNamespace(points=ball, point_data=data), ball, colors, oracle)
    assert list(soapfilm.Points(types.SimpleNamespace(points=ball, point_data=data)).values) == ["height"]


def test_trimesh_stand_ins(ball, colors, oracle):
    cloud = trimesh_cloud(ball, colors)
    points = soapfilm.Points(cloud)
    assert points.normals is None and np.array_equal(points.colors, colors)
    assert mesh_bytes(soapfilm.reconstruct(cloud, ball, resolution=32)) == mesh_bytes(oracle), "normals beside it"
    visual = types.SimpleNamespace(kind="vertex", vertex_colors=colors)
    mesh = types.SimpleNamespace(vertices=ball, faces=[[0, 1, 2]], vertex_normals=ball, visual=visual)
    assert mesh_bytes(soapfilm.reconstruct(mesh, resolution=32)) == mesh_bytes(oracle)
    visual.kind = "texture"
    assert soapfilm.Points(mesh).colors is None
    empty = types.SimpleNamespace(vertices=ball, colors=np.zeros((0, 4), np.uint8))
    assert soapfilm.Points(empty).colors is None


def test_trimesh(ball, colors, oracle):
    trimesh = pytest.importorskip("trimesh")
    cloud = trimesh.PointCloud(ball, colors=colors)
    assert np.array_equal(soapfilm.Points(cloud).colors, colors)
    assert mesh_bytes(soapfilm.reconstruct(cloud, ball, resolution=32)) == mesh_bytes(oracle)
    assert len(soapfilm.Points(oracle.to_trimesh())) == len(oracle.vertices)


def test_pyvista(ball, colors, oracle):
    pyvista = pytest.importorskip("pyvista")
    cloud = pyvista.PolyData(ball)
    cloud.point_data["Normals"], cloud.point_data["RGB"] = ball, colors
    assert_cloud(cloud, ball, colors, oracle)


def test_our_meshes(oracle):
    points = soapfilm.Points(oracle)
    assert np.array_equal(points.positions, oracle.vertices) and np.array_equal(points.normals, oracle.normals)
    assert np.array_equal(points.colors, oracle.colors)


def test_what_is_given_beside_it_wins(ball, colors):
    other = 255 - colors
    points = soapfilm.Points(Open3d(ball, ball, colors / 255), -ball, colors=other, values={"a": ball[:, 0]})
    assert np.array_equal(points.normals, -ball.astype(np.float32)) and np.array_equal(points.colors, other)
    assert list(points.values) == ["a"]


class Dlpack:
    """Nothing but DLPack, as of a package that NumPy does not know."""

    def __init__(self, array, device=1):
        self.array, self.device = array, device

    def __dlpack__(self, **given):
        return self.array.__dlpack__(**given)

    def __dlpack_device__(self):
        return self.device, 0


class Interface:
    def __init__(self, array):
        self.array = array
        self.__array_interface__ = array.__array_interface__


@pytest.mark.parametrize("wrap", [Dlpack, Interface, memoryview, lambda a: a[:, ::-1][:, ::-1]])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_arrays_of_any_package(ball, wrap, kind):
    array = np.ascontiguousarray(ball, dtype=kind)
    if wrap is Dlpack and not hasattr(np, "from_dlpack"):
        pytest.skip("NumPy is older than DLPack")
    points = soapfilm.Points(wrap(array), wrap(array), colors=wrap(np.abs(array)))
    assert np.array_equal(points.positions, array) and np.array_equal(points.normals, array.astype(np.float32))
    assert points.colors is not None


def test_arrays_on_a_device(ball):
    """A tensor of a GPU is copied where it knows how, else refused with a line that says why."""
    class Cuda(Dlpack):
        def __init__(self, array):
            super().__init__(array, device=2)

        def __array__(self):
            raise TypeError("can't convert cuda:0 device type tensor to numpy")

        def cpu(self):
            return self.array

    assert np.array_equal(soapfilm.Points(Cuda(ball)).positions, ball)
    class Jax(Dlpack):
        def __array__(self, dtype=None):
            return self.array

    assert np.array_equal(soapfilm.Points(Jax(ball, device=2)).positions, ball)
    del Cuda.cpu
    with pytest.raises(soapfilm.ParameterError, match="points: .*Cuda gives no array: can't convert cuda:0"):
        soapfilm.Points(Cuda(ball))
    with pytest.raises(soapfilm.ParameterError, match="points: .*Dlpack on a device, must be in the memory"):
        soapfilm.Points(Dlpack(ball, device=2))


def test_torch(ball):
    torch = pytest.importorskip("torch")
    tensor = torch.tensor(ball, requires_grad=True)
    assert np.array_equal(soapfilm.Points(tensor, tensor).positions, ball)
    assert np.array_equal(soapfilm.Points(tensor.float()).positions, ball.astype(np.float32))
    if torch.cuda.is_available():
        assert np.array_equal(soapfilm.Points(tensor.cuda()).positions, ball)


def test_a_tensor_that_records_gradients(ball):
    class Tensor:
        requires_grad = True

        def __array__(self):
            raise RuntimeError("Can't call numpy() on Tensor that requires grad")

        def detach(self):
            return ball

    assert np.array_equal(soapfilm.Points(Tensor()).positions, ball)


def test_what_is_no_cloud(ball):
    for given in (object(), 3, {"points": ball}, types.SimpleNamespace(x=1)):
        with pytest.raises((soapfilm.ParameterError, TypeError), match="points: "):
            soapfilm.reconstruct(given)
