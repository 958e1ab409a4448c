"""The tools: a mesh beside the truth, a virtual scanner, pictures, pages."""
from __future__ import annotations

import json
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from . import _arrays, _core
from ._arrays import Array
from ._foreign import columns_of
from ._mesh import Mesh, Result, has_triangles, mesh_of, write_text
from ._params import signature_with
from ._points import Path, Points, is_path, thread_count
from ._progress import Progress, listener
from .errors import ParameterError
from .options import Axis, Scan, Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

_SHAPE = ("size", "center", "thickness", "gap")
_SCANNER = ("views", "orbit", "elevations", "distance", "positions", "target", "rays", "image", "step", "span",
            "rings", "max_range", "normals", "noise", "outliers", "outlier_kind", "drop_out", "max_incidence", "ghosts",
            "ghost_depth", "mixed_pixels", "misalignment", "misalignment_angle", "hole", "sparse_half", "seed",
            "samples", "directions")
_ORBIT = ("views", "orbit", "elevations", "distance")
#: Of range images alone, not of even samples.
_IMAGE = ("rays", "image", "step", "span", "rings", "max_range", "normals", "outlier_kind", "drop_out",
          "max_incidence", "ghosts", "ghost_depth", "mixed_pixels", "misalignment", "misalignment_angle")
_COLORS = {"white": (255, 255, 255), "black": (0, 0, 0)}


def evaluate(mesh: Any, truth: Any, *, samples: Any = None, voxel: float | None = None,
             f_score: float | Sequence[float] = (), points: int = 300_000, seed: int = 1, threads: int | None = None,
             progress: Progress = True, **shape: Unpack[Shape]) -> dict[str, Any]:
    """Compares a mesh with the truth: distances, normals, F-scores, volume, topology.

    Args:
        mesh: a result, a mesh, a file, (vertices, triangles), or a mesh of Open3D, trimesh or PyVista.
        truth: a built-in shape ("knot", ...) or scene ("room", ...), or anything that `mesh` may be.
        samples: (N, 3) or what :func:`read` gives: their distances to the mesh are measured, too.
        voxel: input units: distances are also given in it.
        f_score: distances of F-scores, input units.
        points: on each surface, even by area.
        seed: of where they lie.
        **shape: ``size``, ``center``, ``thickness``, ``gap`` of a built-in shape, as it was scanned.

    Returns:
        What ``soapfilm evaluate --json`` writes: docs/reference/evaluate.md, key by key. Lengths in input units.
    """
    _tool("evaluate")
    _known_names(shape, _SHAPE, "evaluate")
    core, mesh_name = mesh_of(mesh)
    object_, truth_name = _object(truth)
    given = {**_present(shape), "mesh_name": mesh_name, "truth_name": truth_name, "points": points, "seed": seed,
             "f_score": [f_score] if isinstance(f_score, (int, float)) else [float(d) for d in f_score]}
    if voxel is not None:
        if not voxel > 0:
            raise ParameterError(f"voxel = {voxel}, must be > 0 and finite")
        given["voxel"] = voxel
    if samples is not None:
        cloud = columns_of(samples)
        samples = cloud["positions"] if cloud else samples
        given["samples"] = samples.positions if isinstance(samples, Points) else _arrays.table("samples", samples, 3)
        given["samples_name"] = "samples"
    return json.loads(_core.evaluate(core, object_, given, thread_count(threads), listener(progress, 3)))


def measure(mesh: Any, *, above: Any = None, before: Any = None, sections: Sequence[Any] = (),
            within: Sequence[float] | None = None, cell: float | None = None, voxel: float | None = None,
            threads: int | None = None, progress: Progress = True) -> dict[str, Any]:
    """Area, volume, sections of a mesh; what changed between two.

    Args:
        mesh: a result, a mesh, a file, (vertices, triangles), or a mesh of Open3D, trimesh or PyVista.
        above: a height z, or (x, y, z, nx, ny, nz), a point and a normal: the volumes on both sides of that plane,
            exactly. Or anything that `mesh` may be: the volume above it.
        before: the same place earlier: what was added and taken away since.
        sections: planes as of `above`: the areas that they cut out.
        within: (x0, y0, x1, y1): only these volumes, straight down.
        cell: edge of the columns between two meshes, input units.
        voxel: input units: how the volume changes when the surface moves by it.

    Returns:
        What ``soapfilm measure --json`` writes: docs/reference/measure.md, key by key.
    """
    _tool("measure")
    core, mesh_name = mesh_of(mesh)
    given: dict[str, Any] = {"mesh_name": mesh_name, "sections": [_plane("sections", plane) for plane in sections]}
    base = earlier = None
    if _is_plane(above):
        given["above"] = _plane("above", above)
    elif above is not None:
        base, given["base_name"] = mesh_of(above)
    if before is not None:
        earlier, given["before_name"] = mesh_of(before)
    for name, value in (("cell", cell), ("voxel", voxel)):
        if value is not None:
            if not 0 < value < float("inf"):
                raise ParameterError(f"{name} = {value}, must be > 0 and finite")
            given[name] = value
    if within is not None:
        x0, y0, x1, y1 = (float(v) for v in within)
        if not (x0 < x1 and y0 < y1):
            raise ParameterError(f"within = {tuple(within)}, must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1")
        given["within"] = (x0, y0, x1, y1)
    return json.loads(_core.measure(core, base, earlier, given, thread_count(threads), listener(progress, 3)))


def compare(part: Any, model: Any, *, tolerance: float | None = None, least: float = 0.99, align: bool = False,
            points: int = 300_000, seed: int = 1, threads: int | None = None,
            progress: Progress = True) -> dict[str, Any]:
    """How far a scan or a mesh is from its design: signed distances, verdict.

    Args:
        part: points of :func:`read`, or a result, a mesh, a mesh file, (vertices, triangles), or a mesh of Open3D,
            trimesh or PyVista.
        model: a mesh in any of these forms.
        tolerance: distance that is allowed, input units: gives a verdict.
        least: share that must be within it.
        align: move the part onto the model first, by a rigid best fit from near its place.
        points: on each mesh, even by area.
        seed: of where they lie.

    Returns:
        What ``soapfilm compare --json`` writes: docs/reference/compare.md, key by key.
    """
    _tool("compare")
    core, part_name = (part._core, "points") if isinstance(part, Points) else mesh_of(part)
    model_core, model_name = mesh_of(model)
    given: dict[str, Any] = {"part_name": part_name, "model_name": model_name, "least": least, "align": align,
                             "points": points, "seed": seed}
    if tolerance is not None:
        if not 0 < tolerance < float("inf"):
            raise ParameterError(f"tolerance = {tolerance}, must be > 0 and finite")
        given["tolerance"] = tolerance
    return json.loads(_core.compare(core, model_core, given, thread_count(threads), listener(progress, 3)))


def scan(shape: Any, *, threads: int | None = None, progress: Progress = True,
         **options: Unpack[Scan]) -> Points:
    """Scans a surface that is known, with the errors of a real scanner: docs/reference/scanner.md.

    Args:
        shape: a built-in shape ("sphere", "torus", "part", "plate", "sheets", "knot", "arch"), a scene ("room",
            "yard", "street", "terrain", "tunnel", "facade"), a mesh or a mesh file.
        **options: the options of ``soapfilm scan``, with "_" for "-": ``views=18``, ``image=(300, 300)``,
            ``noise="0.1%"`` (of the longest side) or in units, ``position``\\ s as ``positions=[(x, y, z), ...]``,
            ``samples=N`` for even samples in place of scans, ``size``, ``center``, ...

    Returns:
        Scans in one frame, with range grids and scanner positions.
    """
    _tool("scan")
    _known_names(options, (*_SCANNER, *_SHAPE), "scan")
    given = _present(options)
    _check_scan(given)
    object_, name = _object(shape)
    return Points._of(_core.scan(object_, name, given, thread_count(threads), listener(progress, 3)))


scan.__signature__ = signature_with(scan, Scan)  # type: ignore[attr-defined]


def render(shapes: Any, path: Path | None = None, *, captions: str | Sequence[str] = (), columns: int = 0,
           size: tuple[int, int] = (800, 800), view: str | Sequence[float] = "front", up: Axis | Sequence[float] = "y",
           framing: Literal["shared", "centered", "fitted"] = "shared", zoom: Sequence[float] | None = None,
           shading: Literal["flat", "smooth"] = "flat",
           color_by: str | None = None, range: tuple[float, float] | None = None, points: bool = False,
           point_radius: float | None = None, background: str = "white", samples: int = 3, occlusion_rays: int = 5,
           threads: int | None = None) -> Array:
    """Draws meshes and clouds, a panel each: docs/reference/render.md.

    Args:
        shapes: one or a list of results, meshes, clouds, mesh files, (vertices, triangles).
        path: a .png to write, too.
        captions: text below each panel.
        columns: panels in a row; 0: chosen from their number.
        size: (width, height) of a panel, pixels.
        view: "front", "back", "left", "right", "top", "bottom", "iso", or the direction towards the viewer.
        up: "x", "y", "z", "-x", "-y", "-z", or a direction.
        framing: "shared", "centered" or "fitted".
        zoom: (x0, y0, x1, y1): only this part, fractions of the panel from its upper left corner.
        shading: "flat" or "smooth".
        color_by: name of a vertex attribute; `range` has its values at the ends of the colors.
        points: draw a mesh's vertices as points.
        point_radius: of points, input units.
        background: "white", "black", "#RRGGBB" or "transparent".
        samples: rays along each side of a pixel.
        occlusion_rays: for each sample; 0: no ambient occlusion.

    Returns:
        uint8 (height, width, 4): RGBA, rows from top to bottom.
    """
    _tool("render")
    import numpy as np

    if path is not None and not os.fspath(path).lower().endswith(".png"):
        raise ParameterError(f"path = {os.fspath(path)}, must end in .png")
    items = shapes if isinstance(shapes, list) else [shapes]
    texts = [captions] if isinstance(captions, str) else list(captions)
    if len(texts) > len(items):
        raise ParameterError(f"captions: {len(texts)}, must be at most one for each of the {len(items)} panels")
    texts += [""] * (len(items) - len(texts))
    given: dict[str, Any] = {"columns": columns, "size": tuple(size), "up": _axis(up), "framing": framing,
                             "shading": shading, "samples": samples, "occlusion_rays": occlusion_rays}
    given["view" if isinstance(view, str) else "direction"] = view if isinstance(view, str) else _three("view", view)
    if range is not None and color_by is None:
        raise ParameterError("range: only color_by has it")
    given.update(_present({"zoom": zoom and tuple(zoom), "color_by": color_by, "range": range and tuple(range),
                           "point_radius": point_radius}))
    if background == "transparent":
        given["transparent"] = True
    else:
        given["background"] = _color(background)
    entries = []
    for item, text in zip(items, texts):
        entries.append((_shape(item, points, 5), text))
    width, height, data = _core.render(entries, given, "" if path is None else os.fspath(path), thread_count(threads),
                                       listener(False, 3))
    return np.frombuffer(bytearray(data), dtype=np.uint8).reshape(height, width, 4)


def view(shapes: Any, path: Path | None = None, *, names: str | Sequence[str] = (), title: str = "", unit: str = "",
         up: Literal["y", "z"] = "y", triangles: int = 1_000_000, samples: int = 1_000_000,
         threads: int | None = None) -> pathlib.Path:
    """A page for any browser to turn, cut, color, compare and measure: docs/guide/viewer.md.

    Args:
        shapes: one or a list of results (their reports are shown beside them), meshes, clouds, files, objects of
            Open3D, trimesh and PyVista.
        path: an .html to write; None: a new file in the folder of temporary files, which stays.
        names: of the shapes, as the page shows them.
        title, unit: shown: the page's title, the unit of lengths.
        up: the upright axis at first, "y" or "z".
        triangles: larger meshes are simplified to about so many; 0: never.
        samples: of larger clouds at most so many are drawn, chosen evenly at random; 0: all.

    Returns:
        The page that was written, one file that asks no server for anything. Its text:
        ``soapfilm.view(result).read_text(encoding="utf-8")``.

    Raises:
        OutputError: an OSError: this package was built without the viewer, or `path` cannot be written.
    """
    _tool("view")
    page = page_of(shapes, names=names, title=title, unit=unit, up=up, triangles=triangles, samples=samples,
                   threads=threads, stacklevel=6)
    if path is None:
        return _temporary_page(page)
    write_text(os.fspath(path), page)
    return pathlib.Path(path)


def page_of(shapes: Any, *, names: str | Sequence[str] = (), title: str = "", unit: str = "",
            up: Literal["y", "z"] = "y", triangles: int = 1_000_000, samples: int = 1_000_000,
            threads: int | None = None, stacklevel: int = 5) -> str:
    """The page of view() as HTML."""
    items = shapes if isinstance(shapes, list) else [shapes]
    texts = [names] if isinstance(names, str) else list(names)
    if len(texts) > len(items):
        raise ParameterError(f"names: {len(texts)}, must be at most one for each of the {len(items)} shapes")
    texts += [_name(item) for item in items[len(texts):]]
    given = {"title": title, "unit": unit, "up": up, "triangles": triangles, "samples": samples}
    entries = []
    for item, text in zip(items, texts):
        report = {**item.report, "warnings": item.warnings} if isinstance(item, Result) else None
        entries.append((_shape(item, False, stacklevel), text, json.dumps(report) if report else ""))
    return _core.view(entries, given, thread_count(threads), listener(False, stacklevel - 2))


def _temporary_page(page: str) -> pathlib.Path:
    """A file that only its owner reads. It stays: a browser may open it after the program has ended."""
    import tempfile

    handle, path = tempfile.mkstemp(prefix="soapfilm-", suffix=".html")
    with open(handle, "w", encoding="utf-8") as file:
        file.write(page)
    return pathlib.Path(path)


def _name(item: Any) -> str:
    if is_path(item):
        return os.path.basename(os.fspath(item))
    return "cloud" if isinstance(item, Points) or _is_cloud(item) else "mesh"


def _tool(name: str) -> None:
    if not _core.has_tools:
        raise NotImplementedError(f"soapfilm.{name}: this package was built without the tools "
                                  "(SOAPFILM_BUILD_TOOLS=OFF)")


def _is_plane(value: Any) -> bool:
    if isinstance(value, (int, float)):
        return True
    return not isinstance(value, (str, os.PathLike)) and hasattr(value, "__len__") and len(value) == 6


def _plane(name: str, value: Any) -> tuple[float, ...]:
    """A point and a normal."""
    if isinstance(value, (int, float)):
        return 0.0, 0.0, float(value), 0.0, 0.0, 1.0
    numbers = tuple(float(v) for v in value)
    if len(numbers) != 6:
        raise ParameterError(f"{name} = {numbers}, must be a height z or (x, y, z, nx, ny, nz)")
    return numbers


def _known_names(given: Mapping[str, Any], known: Sequence[str], function: str) -> None:
    for name in given:
        if name not in known:
            import difflib

            near = difflib.get_close_matches(name, known, n=1, cutoff=0.0)[0]
            raise TypeError(f"{function}: unknown parameter '{name}'; the nearest is '{near}'")


def _check_scan(options: dict[str, Any]) -> None:
    """As the program: options that have no meaning together are refused."""
    def refuse(names: Sequence[str], why: str) -> None:
        for name in names:
            if name in options:
                raise ParameterError(f"{name}: {why}")

    if "samples" not in options:
        refuse(("directions",), "only samples=N has it, scans have their scanner")
    else:
        refuse(_IMAGE, "only scans have it, not samples=N")
        if options.get("directions", "normals") == "normals":
            refuse((*_ORBIT, "positions", "target"), "only scans, and samples=N with directions='views', have it")
    if "positions" in options:
        refuse(_ORBIT, "only an orbit has it, not positions")
    if options.get("orbit") != "ring":
        refuse(("elevations",), "only orbit='ring' has it")
    if options.get("rays") == "spinning":
        refuse(("step",), "a spinning scanner has image instead, rays of a turn and rings")
    else:
        refuse(("rings", "span"), "only rays='spinning' has it")
    if "step" in options:
        refuse(("image",), "only one of step and image may be given")


def _present(values: Mapping[str, Any]) -> dict[str, Any]:
    """Without None, arrays as lists."""
    return {name: value.tolist() if hasattr(value, "tolist") else value
            for name, value in values.items() if value is not None}


def _object(value: Any) -> tuple[Any, str]:
    """A mesh and its name, or None and the name of a shape or scene."""
    if isinstance(value, str) and not os.path.splitext(value)[1] and not os.path.exists(value):
        return None, value
    return mesh_of(value, 4)


def _shape(item: Any, as_points: bool, stacklevel: int) -> Any:
    """What is drawn. `stacklevel`: of warnings about a file, from where it is read."""
    if isinstance(item, Points):
        return item._core
    if is_path(item):
        from ._points import read_core

        try:
            return read_core(item, progress=False, stacklevel=stacklevel) if as_points else \
                mesh_of(item, stacklevel - 1)[0]
        except ValueError:
            if as_points:
                raise
            return read_core(item, progress=False, stacklevel=stacklevel)  # a cloud
    if _is_cloud(item):
        return Points(item)._core
    core = mesh_of(item)[0]
    return Points(Mesh._of(core).vertices)._core if as_points else core


def _is_cloud(item: Any) -> bool:
    """Of another package, without triangles."""
    return columns_of(item) is not None and not has_triangles(item)


def _axis(up: str | Sequence[float]) -> tuple[float, ...]:
    if not isinstance(up, str):
        return _three("up", up)
    sign, name = (-1.0, up[1:]) if up.startswith("-") else (1.0, up)
    if name not in ("x", "y", "z"):
        raise ParameterError(f"up = {up!r}, must be x, y, z, -x, -y, -z or three numbers")
    return tuple(sign if name == axis else 0.0 for axis in "xyz")


def _three(name: str, value: Sequence[float]) -> tuple[float, ...]:
    numbers = tuple(float(v) for v in value)
    if len(numbers) != 3:
        raise ParameterError(f"{name} = {value!r}, must be three numbers")
    return numbers


def _color(name: str) -> tuple[int, ...]:
    if name in _COLORS:
        return _COLORS[name]
    try:
        if len(name) == 7 and name[0] == "#":
            return tuple(int(name[i:i + 2], 16) for i in (1, 3, 5))
    except ValueError:
        pass
    raise ParameterError(f"background = {name!r}, must be white, black, transparent or #RRGGBB")
