"""Arrays of a caller, checked and as they are where the library can read them: any strides, float32 or float64."""
from __future__ import annotations

from typing import Any

from ._foreign import as_array
from .errors import ParameterError, SamplesError

Array = Any  # numpy.ndarray; NumPy is loaded by who uses arrays


def table(name: str, value: Any, columns: int, rows: int | None = None) -> Array:
    """`value` as float32 or float64 of shape (rows, columns); without a copy where it is that already."""
    import numpy as np

    array = _numbers(name, value)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ParameterError(f"{name}: shape {array.shape}, must be (N, {columns})")
    _check_rows(name, array, rows)
    return array if array.dtype in (np.float32, np.float64) else array.astype(np.float64)


def column(name: str, value: Any, rows: int) -> Array:
    """`value` as float32 or float64 of shape (rows,)."""
    import numpy as np

    array = _numbers(name, value)
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim != 1:
        raise ParameterError(f"{name}: shape {array.shape}, must be ({rows},)")
    _check_rows(name, array, rows)
    return array if array.dtype in (np.float32, np.float64) else array.astype(np.float64)


def color_table(name: str, value: Any, rows: int) -> Array:
    """`value` as uint8 of shape (rows, 3): bytes, or floats in [0, 1]; a fourth column, alpha, is passed over."""
    import numpy as np

    array = _numbers(name, value)
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise ParameterError(f"{name}: shape {array.shape}, must be (N, 3) or (N, 4)")
    _check_rows(name, array, rows)
    array = array[:, :3]
    if array.dtype == np.uint8:
        return array
    if array.dtype.kind == "f":
        if array.size and not (np.nanmin(array) >= 0 and np.nanmax(array) <= 1):
            raise ParameterError(f"{name}: floats in [{array.min():g}, {array.max():g}], must be in [0, 1], or uint8")
        return np.rint(np.nan_to_num(array, nan=0.5) * 255).astype(np.uint8)
    if array.size and not (array.min() >= 0 and array.max() <= 255):
        raise ParameterError(f"{name}: in [{array.min()}, {array.max()}], must be in [0, 255]")
    return array.astype(np.uint8)


def indices(name: str, value: Any) -> Array:
    """`value` as uint32 or int64 of shape (N, 3)."""
    import numpy as np

    array = _numbers(name, value)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise ParameterError(f"{name}: {array.dtype} of shape {array.shape}, must be integers of shape (N, 3)")
    return array if array.dtype in (np.uint32, np.int64) else array.astype(np.int64)


def scan_counts(scans: Any, rows: int) -> tuple[Array | None, list[int]]:
    """The order that puts samples of one scan together (None: as they are) and how many each scan has.

    `scans`: None, an integer label for each sample, or the counts of samples that belong together.
    """
    import numpy as np

    if scans is None:
        return None, [rows]
    array = as_array("scans", scans)
    if array.ndim != 1 or array.dtype.kind not in "iub" or array.size == 0:
        raise ParameterError(f"scans: {array.dtype} of shape {array.shape}, must be integers: a label of each sample, "
                             "or counts")
    if len(array) == rows:
        _, counts = np.unique(array, return_counts=True)
        ordered = bool(np.all(array[1:] >= array[:-1]))
        order = None if ordered else np.argsort(array, kind="stable").astype(np.int64)
        return order, [int(count) for count in counts]
    if array.sum() != rows or array.min() < 1:
        raise ParameterError(f"scans: {len(array)} numbers, must be one label per sample ({rows}) or counts >= 1 that "
                             f"make {rows} together, not {array.sum()}")
    return None, [int(count) for count in array]


def matrix(name: str, value: Any) -> list[float]:
    """The 16 numbers of a 4 x 4 matrix, row by row; a 3 x 4 one gets its last row."""
    import numpy as np

    array = np.asarray(value, dtype=np.float64)
    if array.shape == (3, 4):
        array = np.vstack([array, [0, 0, 0, 1]])
    if array.shape != (4, 4):
        raise ParameterError(f"{name}: shape {array.shape}, must be (4, 4)")
    return [float(v) for v in array.ravel()]


def _numbers(name: str, value: Any) -> Array:
    try:
        array = as_array(name, value)
    except ParameterError:
        raise
    except ValueError as error:
        raise ParameterError(f"{name}: rows of different lengths") from error
    if array.dtype.kind not in "fiub":
        raise ParameterError(f"{name}: {array.dtype}, must be numbers")
    return array


def _check_rows(name: str, array: Array, rows: int | None) -> None:
    if rows is not None and len(array) != rows:
        raise ParameterError(f"{name}: {len(array)} rows, must be one per sample or vertex ({rows})")
    if rows is None and len(array) == 0:
        raise SamplesError(f"{name}: no rows, must have some")
