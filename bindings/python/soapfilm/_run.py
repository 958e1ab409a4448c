"""Reconstructions: of one cloud, and of scans as they come."""
from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import _arrays, _core
from ._mesh import Result
from ._params import memory_limit, parameters_json, signature_with
from ._points import Points, is_paths, read_core, thread_count
from ._progress import Progress, listener
from .errors import ParameterError
from .options import Memory, Options, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack

_ARRAYS = ("normals", "colors", "weights", "scans", "values")


def reconstruct(points: Any, normals: Any = None, *, sensors: Any = None, colors: Any = None, weights: Any = None,
                scans: Any = None, values: Mapping[str, Any] | None = None, voxel: float | None = None,
                resolution: int | None = None, progress: Progress = True, memory: int | str | Memory | None = None,
                threads: int | None = None, params: Any = None, **options: Unpack[Options]) -> Result:
    """Reconstructs the surface from which samples were taken, with a proof of how near it is to the best one.

    The same samples and parameters give the same mesh, bit for bit, for any number of threads: the one that
    ``soapfilm reconstruct`` writes.

    Args:
        points: (N, 3) positions in any units, or what :func:`read` and :func:`scan` give, or files as :func:`read`
            takes them, or a cloud of Open3D, trimesh or PyVista, whose normals and colors are taken along. float32 and
            float64 of any strides are read where they are; other numbers are converted.
        normals: (N, 3) outward, any length; zero or not finite: none.
        sensors: scanner position: one (3,), one per scan (S, 3), or one per sample (N, 3).
        colors: (N, 3) or (N, 4): uint8, or floats in [0, 1].
        weights: (N,) >= 0: what each sample counts for. Or the option ``--weights``: "area" or "samples".
        scans: which samples belong together: (N,) integer labels, or the counts of consecutive samples.
        values: further columns by name, (N,) each; integers are labels. ``attributes="all"`` or their names carry
            them to the vertices.
        voxel: edge of a grid cell, input units. Default: one sample per voxel^2 of surface.
        resolution: instead: grid vertices along the longest axis, padding included.
        progress: True: a bar (tqdm, or a line on a terminal); False: none; or a function
            ``progress(stage, fraction, detail)``; what it raises cancels the run. Warnings come in any case.
        memory: refuse a run that needs more: bytes, or text such as "2G". Default: what the machine has free.
        threads: None for all that the process may use.
        params: all parameters of an earlier run: its result, report, or report file; what is given beside them wins.
        **options: the options of docs/reference/options.md: ``lambda_``, ``method``, ``outside``, ``trim``, ...; or the
            groups of the report: ``solve=dict(tolerance=1e-4)``. Their types: :class:`soapfilm.options.Options`.

    Raises:
        ParameterError: a value is refused (a ValueError; SamplesError for the samples).
        InputError: a file is refused (a ValueError).
        EmptyResult: the optimum is the empty surface (a ValueError).
        OutOfMemory: the run would not fit (a MemoryError); nothing large was allocated.
        KeyboardInterrupt: at once on Ctrl-C, when called from the main thread.
        TypeError: an unknown parameter; the message names the nearest one.
    """
    given: dict[str, Any] = {"voxel": voxel, "resolution": resolution, "memory": memory, **options}
    if isinstance(weights, str):
        given["weights"], weights = weights, None
    arrays = dict(normals=normals, colors=colors, weights=weights, scans=scans, values=values)
    core, ours, sensor = _cloud(points, sensors, arrays, voxel, threads, progress)
    if sensor is not None:
        given["sensor"] = sensor
    text = parameters_json(given, params)
    return Result._of_run(_core.reconstruct(core, ours, text, thread_count(threads), listener(progress, 3),
                                            memory_limit(memory)))


reconstruct.__signature__ = signature_with(reconstruct, Options)  # type: ignore[attr-defined]


def _cloud(points: Any, sensors: Any, arrays: dict[str, Any], voxel: Any, threads: int | None,
           progress: Progress) -> tuple[Any, bool, Any]:
    """The library's cloud, whether it is ours alone, and a scanner position for scans that do not have one."""
    of_files = is_paths(points)
    if not of_files and not isinstance(points, Points):
        return Points(points, sensors=sensors, **arrays)._core, True, None
    given = [name for name in _ARRAYS if arrays[name] is not None]
    if given:
        raise ParameterError(f"{given[0]}: only arrays of positions have it, files and clouds bring their own")
    if sensors is not None:
        import numpy as np

        sensors = np.asarray(sensors, dtype=np.float64)
        if sensors.shape != (3,):
            raise ParameterError(f"sensors: shape {sensors.shape}, must be (3,): files and clouds bring their own, one "
                                 "position is for scans that have none")
        sensors = sensors.tolist()
    if not of_files:
        return points._core, False, sensors
    # Of files with levels of detail, as the program: four samples for each voxel^2.
    spacing = voxel / 2 if isinstance(voxel, (int, float)) else 0
    return read_core(points, spacing=spacing, threads=threads, progress=progress, stacklevel=5), True, sensors


class Reconstructor:
    """Scans as they come; at any time the surface of those that are there, the same bytes as from all at once.

    ::

        scanner = soapfilm.Reconstructor(resolution=256)
        for points, pose in stream:
            scanner.add(points, pose=pose)
            preview = scanner.reconstruct(resolution=64)
        result = scanner.reconstruct()

    Args:
        **options: parameters of :func:`reconstruct` for all runs.
    """

    def __init__(self, *, threads: int | None = None, params: Any = None, **options: Unpack[RunOptions]) -> None:
        parameters_json(options, params)  # refuses what is wrong now, not after the first scan
        memory_limit(options.get("memory"))
        self._core = _core.Scans()
        self._threads = threads
        self._params = params
        self._options = options
        self._lock = threading.Lock()  # a scan is not added while a run looks at the cloud

    def add(self, points: Any, normals: Any = None, *, pose: Any = None, sensor: Any = None, colors: Any = None,
            weights: Any = None, values: Mapping[str, Any] | None = None, name: str = "",
            progress: Progress = True) -> None:
        """Adds one scan, or the scans of a file.

        Args:
            points: as of :func:`reconstruct`; so are normals, colors, weights and values.
            pose: (4, 4) or (3, 4): a rotation (with one scale) and a translation from the scan's frame to the common
                one. Moves positions, normals and sensors.
            sensor: (3,) scanner position in the scan's frame; or (N, 3), of each sample. Without one a scan with a
                pose was taken from the pose's origin.
            name: of the scan.

        Raises:
            ParameterError: the scan is refused, and not added.
        """
        core, ours = self._scan(points, sensor, progress,
                                dict(normals=normals, colors=colors, weights=weights, values=values, name=name))
        matrix = None if pose is None else _arrays.matrix("pose", pose)
        with self._lock:
            self._core.add(core, ours, matrix)

    def _scan(self, points: Any, sensor: Any, progress: Progress, arrays: dict[str, Any]) -> tuple[Any, bool]:
        of_files = is_paths(points)
        if not of_files and not isinstance(points, Points):
            return Points(points, sensors=sensor, **arrays)._core, True
        if sensor is not None or any(value is not None and value != "" for value in arrays.values()):
            raise ParameterError("add: only arrays of positions take further columns, files and clouds bring their own")
        if of_files:
            return read_core(points, threads=self._threads, progress=progress, stacklevel=5), True
        return points._core, False

    def reconstruct(self, *, progress: Progress = True, **options: Unpack[RunOptions]) -> Result:
        """The surface of all scans until now. `options` replace those of the constructor for this run."""
        given = dict(options)
        merged: dict[str, Any] = {**self._options, **given}
        for one, other in (("voxel", "resolution"), ("resolution", "voxel")):
            if given.get(one) is not None and other not in given:
                merged.pop(other, None)
        text = parameters_json(merged, self._params)
        with self._lock:
            return Result._of_run(self._core.reconstruct(text, thread_count(self._threads), listener(progress, 3),
                                                         memory_limit(merged.get("memory"))))

    def __len__(self) -> int:
        """Samples until now."""
        return self._core.size

    @property
    def scans(self) -> int:
        """How many scans there are."""
        return self._core.scans

    def __repr__(self) -> str:
        return f"<soapfilm.Reconstructor: {len(self)} samples in {self.scans} scans>"


for _function in (Reconstructor.__init__, Reconstructor.reconstruct):
    _function.__signature__ = signature_with(_function, RunOptions)  # type: ignore[attr-defined]
