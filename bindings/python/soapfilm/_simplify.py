"""Fewer triangles, within a distance that is proved."""
from __future__ import annotations

from typing import Any

from . import _core
from ._mesh import Mesh, mesh_of
from ._points import thread_count
from ._progress import Progress, listener
from .errors import ParameterError


def simplify(mesh: Any, tolerance: float | None = None, *, triangles: int | None = None, threads: int | None = None,
             progress: Progress = True) -> tuple[Mesh, dict[str, Any]]:
    """The same surface with about a tenth of the triangles, by edge collapses: docs/guide/smaller.md.

    Components, genus and borders stay, no triangles come to intersect, colors and attributes come along. The same
    bytes for any number of threads::

        smaller, report = soapfilm.simplify(result, 0.05 * result.voxel)
        report["proved"]                    # no point of either mesh is farther than this from the other

    Args:
        mesh: a closed or open 2-manifold: a result, a mesh, a file, (vertices, triangles), or a mesh of Open3D,
            trimesh or PyVista.
        tolerance: greatest distance between old and new mesh, in both directions, input units.
        triangles: in place of it: at most so many, with the smallest tolerance that leaves no more.

    Returns:
        The mesh, and ``triangles_before``, ``triangles``, ``tolerance`` and ``proved`` (input units; at most
        ``tolerance``).

    Raises:
        ParameterError: neither or both of tolerance and triangles, a value that is not > 0, or a mesh that is not a
            2-manifold (names the edge).
    """
    if (tolerance is None) == (triangles is None):
        raise ParameterError("simplify: give a tolerance, or triangles = N")
    if tolerance is not None and not 0 < tolerance < float("inf"):
        raise ParameterError(f"tolerance = {tolerance}, must be > 0 and finite")
    if triangles is not None and not triangles >= 1:
        raise ParameterError(f"triangles = {triangles}, must be >= 1")
    core, _ = mesh_of(mesh)
    smaller, report = _core.simplify(core, tolerance or 0.0, triangles or 0, thread_count(threads),
                                     listener(progress, 3))
    return Mesh._of(smaller), report
