"""Point clouds of one or several scans: from arrays or files."""
from __future__ import annotations

import itertools
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any, Union

from . import _arrays, _core
from ._arrays import Array
from ._foreign import as_array, columns_of
from ._progress import Progress, listener
from ._words import in_python
from .options import Viewer
from .errors import ParameterError

Path = Union[str, "os.PathLike[str]"]


class Points:
    """Samples of one or several scans, in the units and the frame of the input. Made by :func:`read`, :func:`scan` or
    ``Points(positions, ...)``; arrays are read-only views, alive as long as they are used.

    ``Points(positions, normals=None, *, sensors=None, colors=None, weights=None, scans=None, values=None)`` takes the
    arrays that :func:`reconstruct` takes, or a cloud of Open3D, trimesh or PyVista with what it has.

    ``cloud[mask]``, ``cloud[10:20]`` and ``cloud[indices]`` are clouds of these samples; ``cloud + other`` has the
    scans of both. Clouds do not change: copies share their memory, pickles hold all of it.
    """

    _core: Any

    def __init__(self, positions: Any, normals: Any = None, *, sensors: Any = None, colors: Any = None,
                 weights: Any = None, scans: Any = None, values: Mapping[str, Any] | None = None,
                 name: str = "") -> None:
        found = columns_of(positions)
        if found is not None:
            positions = found["positions"]
            normals = found.get("normals") if normals is None else normals
            colors = found.get("colors") if colors is None else colors
            values = {**found.get("values", {}), **(values or {})}
        position = _arrays.table("points", positions, 3)
        rows = len(position)
        order, counts = _arrays.scan_counts(scans, rows)
        of_samples, of_scans = _sensors(sensors, rows, len(counts))
        columns = {
            "positions": position,
            "normals": None if normals is None else _arrays.table("normals", normals, 3, rows),
            "sensors": of_samples,
            "weights": None if weights is None else _arrays.column("weights", weights, rows),
            "colors": None if colors is None else _arrays.color_table("colors", colors, rows),
            "order": order,
        }
        ends = itertools.accumulate(counts)
        runs = [{"name": name, "end": end, "sensor": sensor} for end, sensor in
                zip(ends, itertools.repeat(None) if of_scans is None else of_scans.tolist())]
        self._core = _core.points_of(columns, _value_columns(values or {}, rows), runs, {})

    @classmethod
    def _of(cls, core: Any) -> Points:
        points = cls.__new__(cls)
        points._core = core
        return points

    def __len__(self) -> int:
        return self._core.size

    def __getitem__(self, which: Any) -> Points:
        """The samples of a slice, a mask or indices, in the order of their scans; each keeps its scan and its columns.
        """
        from . import _select

        return Points._of(_select.selected(self._core, which))

    __iter__ = None  # a cloud is no sequence of rows: cloud.positions is
    __array_ufunc__ = None  # and no array: cloud + array is neither a sum of clouds nor of numbers

    def __add__(self, other: Any) -> Points:
        """Both clouds, as further scans; a column that one of them lacks is neutral there."""
        if not isinstance(other, Points):
            return NotImplemented
        ours, theirs = self.coordinate_system, other.coordinate_system
        if ours and theirs and ours != theirs:
            raise ParameterError("points: clouds of different coordinate systems, must be of one to be added")
        return Points._of(self._core.joined(other._core))

    def __radd__(self, other: Any) -> Any:
        """For sum(): 0 + cloud."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        """For NumPy a cloud is its positions."""
        import numpy as np

        return np.array(self.positions, dtype=dtype) if copy or dtype is not None else self.positions

    def __copy__(self) -> Points:
        return Points._of(self._core)

    def __deepcopy__(self, memo: Any) -> Points:
        return self.__copy__()  # nothing of it can be changed

    def __reduce__(self) -> tuple[Any, ...]:
        from . import _select

        return _select.restored, (_select.state_of(self._core),)

    @property
    def positions(self) -> Array:
        """float64 (N, 3)."""
        return _view(self._core.positions)

    @property
    def normals(self) -> Array | None:
        """float32 (N, 3), outward, any length; zero: none. None without any."""
        return _view(self._core.normals)

    @property
    def sensors(self) -> Array | None:
        """float64 (N, 3): scanner position of each sample, not-a-number where unknown. None without any."""
        return _view(self._core.sensors)

    @property
    def weights(self) -> Array | None:
        """float32 (N,), >= 0. None without any."""
        return _view(self._core.weights)

    @property
    def colors(self) -> Array | None:
        """uint8 (N, 3). None without any."""
        return _view(self._core.colors)

    @property
    def values(self) -> dict[str, Array]:
        """Whatever else the samples have, such as intensity: float32 (N,) by name."""
        return {name: _view(view) for name, view, _ in self._core.columns}

    @property
    def scans(self) -> list[dict[str, Any]]:
        """Of each scan: ``name``, ``begin`` and ``end`` among the samples, ``sensor`` and ``view_direction`` (three
        numbers or None), ``range_grid`` (int32 (rows, columns): the scan's sample of each pixel, -1: none; or None)."""
        return [{**scan, "range_grid": _view(scan["range_grid"])} for scan in self._core.scans]

    @property
    def files(self) -> list[dict[str, Any]]:
        """What was found in each file that was read: ``path``, ``format``, ``samples``, ``dropped``, ``no_return``,
        ``ignored_normals``, ``properties``."""
        return self._core.files

    @property
    def warnings(self) -> list[str]:
        """Lines that were shown while reading."""
        return [in_python(line) for line in self._core.warnings]

    @property
    def coordinate_system(self) -> str | None:
        """WKT or "EPSG:NUMBER" of a georeferenced file."""
        return self._core.coordinate_system or None

    def save(self, path: Path, *, ascii: bool = False) -> None:
        """Writes a PLY that keeps everything, whole or not at all."""
        self._core.save(os.fspath(path), ascii)

    def to_open3d(self) -> Any:
        """As ``open3d.geometry.PointCloud``: copies of positions, normals and colors."""
        import numpy as np
        import open3d as o3d

        vector = o3d.utility.Vector3dVector
        cloud = o3d.geometry.PointCloud(vector(np.array(self.positions)))
        if self.normals is not None:
            cloud.normals = vector(self.normals.astype(np.float64))
        if self.colors is not None:
            cloud.colors = vector(self.colors / 255.0)
        return cloud

    def to_pyvista(self) -> Any:
        """As ``pyvista.PolyData``: normals and colors as the arrays "Normals" and "RGB", values by their names."""
        import numpy as np
        import pyvista

        cloud = pyvista.PolyData(np.array(self.positions))
        for name, column in (("Normals", self.normals), ("RGB", self.colors), *self.values.items()):
            if column is not None:
                cloud.point_data[name] = np.array(column)
        return cloud

    def show(self, viewer: Viewer | None = None) -> pathlib.Path | None:
        """Shows the samples, as :meth:`Mesh.show` a mesh."""
        from ._show import show

        return show(self, viewer)

    def __repr__(self) -> str:
        scans = len(self._core.scans)
        has = [name for name in ("normals", "sensors", "weights", "colors") if getattr(self._core, name) is not None]
        has += [name for name, _, _ in self._core.columns]
        return f"<soapfilm.Points: {len(self)} samples in {scans} scan{'s' * (scans != 1)}" + \
            (f", {', '.join(has)}>" if has else ">")


def read(files: Path | Sequence[Path], *, columns: str | Sequence[str] = "", trajectory: Path = "",
         trust_viewpoint: bool = False, spacing: float = 0, threads: int | None = None,
         progress: Progress = True) -> Points:
    """Reads point clouds or scan sets of any format of docs/reference/formats.md.

    Args:
        files: one file or several, which are several scans; a folder is the scans in it, a pattern such as
            "tiles/*.laz" the files that it matches, in the order of their numbers. Each file is read once.
        columns: of text files: what their columns are, such as "x,y,z,-,nx,ny,nz" ("-": passed over).
        trajectory: of LAS files: where the scanner was, a text file of lines ``time x y z``.
        trust_viewpoint: of PCD and E57: a pose at the origin, the default, is the scanner's, too.
        spacing: of COPC: levels are read until points are this near, input units; 0: all.
        threads: None for all that the process may use.
        progress: as of :func:`reconstruct`.

    Raises:
        InputError: a file cannot be read to its end, or holds no finite sample.
        ParameterError: an option that none of the files takes.
    """
    return Points._of(read_core(files, columns=columns, trajectory=trajectory, trust_viewpoint=trust_viewpoint,
                                spacing=spacing, threads=threads, progress=progress, stacklevel=4))


def read_core(files: Any, *, columns: str | Sequence[str] = "", trajectory: Path = "", trust_viewpoint: bool = False,
              spacing: float = 0, threads: int | None = None, progress: Progress = True, stacklevel: int = 4) -> Any:
    paths = [os.fspath(files)] if is_path(files) else [os.fspath(file) for file in files]
    if not paths:
        raise ParameterError("files: none given, must be one or several")
    names = columns if isinstance(columns, str) else ",".join(columns)
    return _core.read(paths, names, os.fspath(trajectory), trust_viewpoint, spacing,
                      thread_count(threads), listener(progress, stacklevel))


def thread_count(threads: int | None) -> int:
    """0, as the library has it, for all that the process may use."""
    if threads is None:
        return 0
    if isinstance(threads, bool) or int(threads) != threads or not 0 <= threads < 1 << 31:
        raise ParameterError(f"threads = {threads!r}, must be a whole number >= 1, or None for all")
    return int(threads)


def is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike))


def is_paths(value: Any) -> bool:
    return is_path(value) or isinstance(value, (list, tuple)) and bool(value) and all(map(is_path, value))


def _view(core: Any) -> Any:
    if core is None:
        return None
    import numpy as np

    return np.asarray(core)


def _sensors(sensors: Any, rows: int, scans: int) -> tuple[Any, Any]:
    """Scanner positions of all samples, or of all scans. One position: of every scan."""
    if sensors is None:
        return None, None
    import numpy as np

    array = as_array("sensors", sensors)
    if array.shape == (3,):
        array = np.broadcast_to(array, (scans, 3))
    array = _arrays.table("sensors", array, 3)
    if len(array) == scans:
        if not np.isfinite(array).all():
            raise ParameterError("sensors: not finite, must be for whole scans")
        return None, array
    if len(array) != rows:
        raise ParameterError(f"sensors: {len(array)} positions, must be one, one per scan ({scans}) or one per sample "
                             f"({rows})")
    return array, None


def _value_columns(values: Mapping[str, Any], rows: int) -> list[tuple[str, Any, bool]]:
    """Integers are labels: of several samples the most frequent one counts."""
    columns = []
    for name, value in values.items():
        if not isinstance(name, str) or not name:
            raise ParameterError(f"values: {name!r}, must be a name")
        columns.append((name, _arrays.column(f"values['{name}']", value, rows),
                        as_array(name, value).dtype.kind in "iub"))
    return columns
