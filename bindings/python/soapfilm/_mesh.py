"""Meshes, results, and the hand-over to other packages."""
from __future__ import annotations

import json
import os
import pathlib
from collections.abc import Mapping
from typing import Any

from . import _arrays, _core
from ._arrays import Array
from ._points import Path, _view
from ._words import in_python
from .options import Viewer
from .errors import OutputError, warn


class Mesh:
    """Triangles, counter-clockwise seen from outside, in the units and the frame of the input.

    Arrays are read-only views of the library's memory, alive as long as they are used: ``.copy()`` them to change them.
    ``Mesh(vertices, triangles)`` makes one of arrays. Meshes pickle and copy.
    """

    _core: Any
    _normals: Array | None = None  # computed

    def __init__(self, vertices: Any, triangles: Any, *, normals: Any = None, colors: Any = None,
                 attributes: Mapping[str, Any] | None = None) -> None:
        vertex = _arrays.table("vertices", vertices, 3)
        rows = len(vertex)
        self._core = _core.mesh_of(
            vertex, _arrays.indices("triangles", triangles),
            None if normals is None else _arrays.table("normals", normals, 3, rows),
            None if colors is None else _arrays.color_table("colors", colors, rows),
            [(name, _arrays.column(name, values, rows)) for name, values in (attributes or {}).items()], 0.0)

    @classmethod
    def _of(cls, core: Any) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._core = core
        return mesh

    @property
    def vertices(self) -> Array:
        """float64 (V, 3)."""
        return _view(self._core.vertices)

    @property
    def triangles(self) -> Array:
        """uint32 (T, 3): indices of vertices."""
        return _view(self._core.triangles)

    @property
    def normals(self) -> Array:
        """float32 (V, 3): unit, outward; where the mesh has none, of the triangles around each vertex, by their area.
        """
        if self._core.normals is not None:
            return _view(self._core.normals)
        if self._normals is None:
            self._normals = _vertex_normals(self.vertices, self.triangles)
        return self._normals

    @property
    def colors(self) -> Array | None:
        """uint8 (V, 3). None without any."""
        return _view(self._core.colors)

    @property
    def attributes(self) -> dict[str, Array]:
        """float32 (V,) by name, such as "distance" after ``distance=True``."""
        return {name: _view(view) for name, view in self._core.attributes}

    @property
    def area(self) -> float:
        """Input units^2."""
        return self._core.area

    @property
    def volume(self) -> float:
        """Enclosed, input units^3, by the divergence theorem; positive when the orientation is outward."""
        return self._core.volume

    def topology(self) -> dict[str, Any]:
        """Checks the mesh: ``closed``, ``manifold``, ``watertight``, ``components``, ``genus`` (None unless all
        components are closed), ``boundary_edges`` and more (docs/reference/topology.md)."""
        return self._core.topology()

    def save(self, path: Path, *, ascii: bool = False) -> None:
        """Writes the mesh, whole or not at all: .ply, .obj, .glb, .stl, or .vdb where built with OpenVDB.

        Raises:
            OutputError: an OSError: an unknown extension, or a file that cannot be written.
        """
        for line in self._core.save(os.fspath(path), ascii, self._up()):
            warn(line, 2)

    def _up(self) -> str:
        """The axis that a GLB turns upright."""
        return "z"

    def show(self, viewer: Viewer | None = None) -> pathlib.Path | None:
        """Shows the mesh: in a notebook below the cell, else as a page in the browser.

        Args:
            viewer: "browser", "open3d" or "pyvista" to choose; the last two open a window and wait for its end. By
                default the browser; where this package was built without the page, a window of what is installed.

        Returns:
            The page that was written (:func:`view`): where no browser is found a warning names it. None of a notebook
            or a window.
        """
        from ._show import show

        return show(self, viewer)

    def _repr_html_(self) -> str:
        from ._show import viewer_html

        return viewer_html(self)

    def to_open3d(self) -> Any:
        """As ``open3d.geometry.TriangleMesh``: copies of vertices, triangles, normals and colors."""
        import numpy as np
        import open3d as o3d

        vector = o3d.utility.Vector3dVector
        mesh = o3d.geometry.TriangleMesh(vector(np.array(self.vertices)),
                                         o3d.utility.Vector3iVector(self.triangles.astype(np.int32)))
        mesh.vertex_normals = vector(self.normals.astype(np.float64))
        if self.colors is not None:
            mesh.vertex_colors = vector(self.colors / 255.0)
        return mesh

    def to_trimesh(self) -> Any:
        """As ``trimesh.Trimesh``, vertices in the same order; attributes as ``vertex_attributes``."""
        import numpy as np
        import trimesh

        return trimesh.Trimesh(vertices=np.array(self.vertices), faces=self.triangles.astype(np.int64),
                               vertex_normals=np.array(self.normals),
                               vertex_colors=None if self.colors is None else np.array(self.colors),
                               vertex_attributes={name: np.array(v) for name, v in self.attributes.items()},
                               process=False)

    def to_pyvista(self) -> Any:
        """As ``pyvista.PolyData``: colors as the array "RGB", attributes by their names."""
        import numpy as np
        import pyvista

        faces = np.empty((len(self.triangles), 4), dtype=np.int64)
        faces[:, 0] = 3
        faces[:, 1:] = self.triangles
        mesh = pyvista.PolyData(np.array(self.vertices), faces.ravel())
        mesh.point_data["Normals"] = np.array(self.normals)
        if self.colors is not None:
            mesh.point_data["RGB"] = np.array(self.colors)
        for name, values in self.attributes.items():
            mesh.point_data[name] = np.array(values)
        return mesh

    def __copy__(self) -> Any:
        copied = type(self).__new__(type(self))
        copied.__dict__.update(self.__dict__)
        return copied

    def __deepcopy__(self, memo: Any) -> Any:
        return self.__copy__()  # nothing of it can be changed: copies share the memory

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), _state(self._core), getattr(self, "_report", None))

    def __repr__(self) -> str:
        return f"<soapfilm.{type(self).__name__}: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"


class Result(Mesh):
    """The mesh of a reconstruction, with its report and its proof."""

    _report: str

    @classmethod
    def _of_run(cls, run: tuple[Any, str]) -> Result:
        result = cls.__new__(cls)
        result._core, result._report = run
        return result

    @property
    def report(self) -> dict[str, Any]:
        """What was done and proved: docs/reference/report.md, key by key. A new dict each time."""
        return json.loads(self._report)

    @property
    def certificate(self) -> dict[str, Any] | None:
        """Energies and their bound: ``relative_gap_binary`` is how far from the global optimum at most. None for vrip.
        """
        return self.report["certificate"]

    @property
    def warnings(self) -> list[str]:
        """The lines that were shown as SoapfilmWarning. (In ``report`` they name options as the program does.)"""
        return [in_python(line) for line in self.report["warnings"]]

    @property
    def voxel(self) -> float:
        """Edge of a grid cell, input units."""
        return self.report["grid"]["voxel"]

    def _up(self) -> str:
        return self.report["parameters"]["orient"]["up"] or "z"

    def save(self, path: Path, *, ascii: bool = False) -> None:
        """As of Mesh; the coordinate system of a georeferenced input comes beside it as .prj."""
        super().save(path, ascii=ascii)
        system = self.report["input"]["coordinate_system"]
        if system:
            write_text(os.path.splitext(os.fspath(path))[0] + ".prj", system + "\n")


def read_mesh(path: Path) -> Mesh:
    """Reads a triangle mesh (.ply, .obj, .off, .stl, ...); polygons become fans of triangles.

    Raises:
        InputError: no mesh, or one that cannot be read to its end.
    """
    return Mesh._of(_read(path, 3))


def mesh_of(value: Any, stacklevel: int = 3) -> tuple[Any, str]:
    """The library's mesh and the name that messages use: of a Mesh, a file, (vertices, triangles), or an object of
    trimesh, Open3D or PyVista."""
    if isinstance(value, Mesh):
        return value._core, "mesh"
    if isinstance(value, (str, os.PathLike)):
        return _read(value, stacklevel + 1), os.fspath(value)
    if isinstance(value, tuple) and len(value) == 2:
        return Mesh(*value)._core, "mesh"
    arrays = _triangles_of(value)
    if arrays is not None:
        return Mesh(*arrays)._core, "mesh"
    raise TypeError(f"mesh: {type(value).__name__}, must be a Mesh, a file, (vertices, triangles), or a mesh of "
                    "Open3D, trimesh or PyVista")


def has_triangles(value: Any) -> bool:
    arrays = None if isinstance(value, Mesh) else _triangles_of(value)
    return isinstance(value, Mesh) or arrays is not None and len(arrays[1]) > 0


def _triangles_of(value: Any) -> tuple[Any, Any] | None:
    """Vertices and triangles of a mesh of another package."""
    if hasattr(value, "vertex") and hasattr(value, "triangle"):  # Open3D's tensors
        return value.vertex["positions"].cpu().numpy(), value.triangle["indices"].cpu().numpy()
    for vertices, triangles in (("vertices", "triangles"), ("vertices", "faces"), ("points", "regular_faces")):
        if hasattr(value, vertices) and hasattr(value, triangles):  # Open3D, trimesh, PyVista
            return getattr(value, vertices), getattr(value, triangles)
    return None


def _state(core: Any) -> tuple[Any, ...]:
    """The arguments of the module's mesh_of(), as arrays."""
    return (_view(core.vertices), _view(core.triangles), _view(core.normals), _view(core.colors),
            [(name, _view(values)) for name, values in core.attributes], core.voxel)


def _restored(kind: Any, state: tuple[Any, ...], report: str | None) -> Any:
    """A mesh or result of its pickle."""
    mesh = kind.__new__(kind)
    mesh._core = _core.mesh_of(*state)
    if report is not None:
        mesh._report = report
    return mesh


def _read(path: Path, stacklevel: int) -> Any:
    mesh, lines = _core.read_mesh(os.fspath(path))
    for line in lines:
        warn(line, stacklevel)
    return mesh


def _vertex_normals(vertices: Array, triangles: Array) -> Array:
    import numpy as np

    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    twice_area = np.cross(b - a, c - a)
    sums = np.empty_like(vertices)
    for axis in range(3):
        sums[:, axis] = np.bincount(triangles.ravel(), np.repeat(twice_area[:, axis], 3), len(vertices))
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    normals = np.divide(sums, length, out=np.zeros_like(sums), where=length > 0).astype(np.float32)
    normals.flags.writeable = False
    return normals


def write_text(path: str, text: str) -> None:
    """Whole or not at all."""
    partial = f"{path}.{os.getpid()}.partial"
    try:
        with open(partial, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(partial, path)
    except OSError as error:
        if os.path.exists(partial):
            os.remove(partial)
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from error
