"""Clouds of other packages, known by their attributes: none of the packages is imported.

Open3D (``PointCloud``, ``t.geometry.PointCloud``, meshes), trimesh (``PointCloud``, ``Trimesh``), PyVista
(``PolyData``) and arrays of any package that gives NumPy's interface or DLPack. Of a mesh its vertices are the samples.
"""
from __future__ import annotations

from typing import Any

from .errors import ParameterError

#: Names of PyVista's point data that are not a further column.
_NORMALS = ("Normals", "normals", "Normal")
_COLORS = ("RGB", "RGBA", "colors", "Colors", "rgb", "rgba")


def as_array(name: str, value: Any) -> Any:
    """A numpy.ndarray of whatever holds numbers, without a copy where its memory can be looked at.

    Tensors of a GPU are copied to the memory of the processor, those that record gradients are looked at without.
    """
    import numpy as np

    if isinstance(value, np.ndarray):
        return value
    if getattr(value, "requires_grad", False) and callable(getattr(value, "detach", None)):
        value = value.detach()
    value = _on_the_host(name, value)
    if any(hasattr(value, way) for way in ("__array_interface__", "__array_struct__", "__array__")):
        try:
            return np.asarray(value)
        except (RuntimeError, TypeError, ValueError) as error:
            raise ParameterError(f"{name}: {_type(value)} gives no array: {_line(error)}") from error
    if hasattr(value, "__dlpack__") and hasattr(np, "from_dlpack"):
        try:
            return np.from_dlpack(value)
        except (BufferError, RuntimeError, TypeError) as error:
            raise ParameterError(f"{name}: {_type(value)}, DLPack refuses it: {_line(error)}") from error
    if callable(getattr(value, "numpy", None)):  # tensors of Open3D, which NumPy would take number by number
        return value.numpy()
    return np.asarray(value)


def columns_of(value: Any) -> dict[str, Any] | None:
    """``positions`` and what else there is of ``normals``, ``colors`` and ``values``; None: no cloud of a package."""
    for known in (_ours, _open3d_tensors, _open3d, _trimesh, _pyvista):
        columns = known(value)
        if columns is not None:
            return {name: column for name, column in columns.items() if column is not None}
    return None


def _ours(value: Any) -> dict[str, Any] | None:
    from ._mesh import Mesh

    if not isinstance(value, Mesh):
        return None
    return {"positions": value.vertices, "normals": value.normals, "colors": value.colors, "values": value.attributes}


def _open3d_tensors(value: Any) -> dict[str, Any] | None:
    """t.geometry: ``point`` (of a mesh ``vertex``) maps names to tensors."""
    tensors = getattr(value, "point", None)
    if tensors is None:
        tensors = getattr(value, "vertex", None)
    if tensors is None or not hasattr(tensors, "items"):
        return None
    found = {str(name): tensor for name, tensor in tensors.items()}
    if "positions" not in found:
        raise ParameterError(f"points: {_type(value)} without positions")
    rows = len(found["positions"])
    others = {name: as_array(name, tensor) for name, tensor in found.items()
              if name not in ("positions", "normals", "colors")}
    return {"positions": as_array("points", found["positions"]), "normals": found.get("normals"),
            "colors": _colors(found.get("colors"), rows), "values": _single_columns(others, rows)}


def _open3d(value: Any) -> dict[str, Any] | None:
    """geometry.PointCloud, and TriangleMesh, whose vertices have longer names. Empty: absent."""
    if hasattr(value, "points") and callable(getattr(value, "has_normals", None)):
        positions, normals, colors = value.points, value.normals, value.colors
    elif hasattr(value, "vertices") and hasattr(value, "vertex_colors") and hasattr(value, "triangles"):
        positions, normals, colors = value.vertices, value.vertex_normals, value.vertex_colors
    else:
        return None
    rows = len(positions)
    return {"positions": as_array("points", positions), "normals": normals if len(normals) == rows else None,
            "colors": _colors(colors, rows)}


def _trimesh(value: Any) -> dict[str, Any] | None:
    """PointCloud has ``colors``, Trimesh ``faces``, normals of its faces, and colors if its visual is of vertices."""
    if not hasattr(value, "vertices") or not (hasattr(value, "faces") or hasattr(value, "colors")):
        return None
    rows = len(value.vertices)
    normals = getattr(value, "vertex_normals", None) if hasattr(value, "faces") else None
    colors = getattr(value, "colors", None)
    visual: Any = getattr(value, "visual", None)
    if colors is None and getattr(visual, "kind", None) == "vertex":
        colors = visual.vertex_colors
    attributes = getattr(value, "vertex_attributes", None) or {}
    return {"positions": as_array("points", value.vertices),
            "normals": normals if normals is not None and len(normals) == rows else None,
            "colors": _colors(colors, rows), "values": _single_columns(dict(attributes), rows)}


def _pyvista(value: Any) -> dict[str, Any] | None:
    data = getattr(value, "point_data", None)
    if data is None or not hasattr(value, "points") or not hasattr(data, "keys"):
        return None
    rows = len(value.points)
    found = {str(name): data[name] for name in data.keys()}
    normals = next((found[name] for name in _NORMALS if name in found), None)
    colors = next((found[name] for name in _COLORS if name in found), None)
    others = {name: column for name, column in found.items() if name not in (*_NORMALS, *_COLORS)}
    return {"positions": as_array("points", value.points), "normals": normals, "colors": _colors(colors, rows),
            "values": _single_columns(others, rows)}


def _colors(colors: Any, rows: int) -> Any:
    """uint8, or floats in [0, 1]; what tells no color of each sample is left out."""
    if colors is None or len(colors) != rows or rows == 0:
        return None
    array = as_array("colors", colors)
    return array if array.ndim == 2 and array.shape[1] in (3, 4) else None


def _single_columns(found: dict[str, Any], rows: int) -> dict[str, Any] | None:
    """Those with one number a sample."""
    import numpy as np

    columns = {}
    for name, column in found.items():
        array = np.asarray(column)
        if array.ndim == 2 and array.shape[1] == 1:
            array = array[:, 0]
        if name and array.shape == (rows,) and array.dtype.kind in "fiub":
            columns[name] = array
    return columns or None


def _on_the_host(name: str, value: Any) -> Any:
    """Where an array lies elsewhere, as CUDA, its copy in the memory of the processor."""
    if not hasattr(value, "__cuda_array_interface__") and not _on_a_device(value):
        return value
    for way in ("cpu", "get"):  # PyTorch and Open3D; CuPy
        if callable(getattr(value, way, None)):
            return getattr(value, way)()
    if hasattr(value, "__array__"):  # JAX copies by itself
        return value
    raise ParameterError(f"{name}: {_type(value)} on a device, must be in the memory of the processor")


def _on_a_device(value: Any) -> bool:
    if not callable(getattr(value, "__dlpack_device__", None)):
        return str(getattr(value, "device", "cpu")).lower().startswith(("cuda", "sycl")) and hasattr(value, "cpu")
    kind = int(value.__dlpack_device__()[0])
    return kind not in (1, 3, 11)  # DLPack: kDLCPU, and memory of the processor that CUDA or ROCm has pinned


def _type(value: Any) -> str:
    return f"{type(value).__module__}.{type(value).__qualname__}"


def _line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
