"""Parts of clouds, and clouds as what a pickle holds."""
from __future__ import annotations

from typing import Any

from . import _core
from ._arrays import Array
from .errors import ParameterError, SamplesError

#: Of each sample.
_COLUMNS = ("positions", "normals", "sensors", "weights", "colors")


def selected(core: Any, which: Any) -> Any:
    """The samples of a slice, a mask or indices. Samples of a scan stay together, scans in their order."""
    import numpy as np

    rows: Array = _rows(core.size, which)
    scans = core.scans
    ends = np.array([scan["end"] for scan in scans], dtype=np.int64)
    scan_of_row: Array = np.searchsorted(ends, rows, side="right")
    if np.any(scan_of_row[1:] < scan_of_row[:-1]):
        order = np.argsort(scan_of_row, kind="stable")
        rows, scan_of_row = rows[order], scan_of_row[order]
    counts = np.bincount(scan_of_row, minlength=len(scans)).tolist()
    parts, end = [], 0
    for scan, count in zip(scans, counts):
        of_scan = rows[end:end + count]
        if len(of_scan):
            end += len(of_scan)
            grid = scan["range_grid"]
            parts.append({**scan, "end": end,
                          "range_grid": None if grid is None else _grid(np.asarray(grid), of_scan - scan["begin"])})
    columns = {name: _array(getattr(core, name)) for name in _COLUMNS}
    values = [(name, np.asarray(view), label) for name, view, label in core.columns]
    return _core.points_of({**columns, "order": rows}, values, parts, core.facts)


def state_of(core: Any) -> dict[str, Any]:
    """All of a cloud as arrays, numbers and text."""
    import numpy as np

    return {
        **{name: _array(getattr(core, name)) for name in _COLUMNS},
        "columns": [(name, np.asarray(view), label) for name, view, label in core.columns],
        "scans": [{**scan, "range_grid": _array(scan["range_grid"])} for scan in core.scans],
        "facts": core.facts,
    }


def restored(state: dict[str, Any]) -> Any:
    """The cloud of state_of()."""
    from ._points import Points

    columns = {name: state[name] for name in _COLUMNS}
    return Points._of(_core.points_of({**columns, "order": None}, state["columns"], state["scans"], state["facts"]))


def _rows(size: int, which: Any) -> Array:
    """Indices >= 0, int64."""
    import numpy as np

    if isinstance(which, slice):
        rows = np.arange(size)[which]
    else:
        given = np.asarray(which)
        if given.ndim != 1 or given.dtype.kind not in "iub" and given.size > 0:
            raise TypeError(f"points[{type(which).__name__}]: must be a slice, a mask or indices; rows are those of "
                            "points.positions")
        if given.dtype.kind == "b":
            if len(given) != size:
                raise ParameterError(f"points[mask]: {len(given)} values, must be one per sample ({size})")
            rows = np.flatnonzero(given)
        else:
            rows = given.astype(np.int64)
            outside = rows[(rows < -size) | (rows >= size)]
            if outside.size:
                raise IndexError(f"points[indices]: {outside[0]}, must be in [{-size}, {size})")
            rows = np.where(rows < 0, rows + size, rows)
    if rows.size == 0:
        raise SamplesError("points[...]: no samples remain, must be some")
    return rows.astype(np.int64)


def _grid(grid: Array, samples: Array) -> Array:
    """The range grid of those `samples` of its scan; -1 where a pixel's sample is not among them."""
    import numpy as np

    place = np.full(int(max(grid.max(initial=-1), samples.max())) + 2, -1, dtype=np.int32)  # the last one: of pixels -1
    place[samples] = np.arange(len(samples), dtype=np.int32)
    return place[grid]


def _array(view: Any) -> Any:
    import numpy as np

    return None if view is None else np.asarray(view)
