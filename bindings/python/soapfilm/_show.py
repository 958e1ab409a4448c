"""Meshes and clouds in notebooks, browsers and windows."""
from __future__ import annotations

import base64
import html
import pathlib
import struct
import sys
import zlib
from typing import TYPE_CHECKING, Any

from . import _core
from .errors import ParameterError, warn

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._points import Points

#: Of the viewer in a notebook, which is saved with all it shows.
_NOTEBOOK_TRIANGLES = 60_000
_NOTEBOOK_SAMPLES = 60_000


def viewer_html(shape: Mesh | Points) -> str:
    """What a notebook shows of a mesh or cloud: the viewer, or pictures from three sides, and what is known."""
    rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>"
                   for name, value in _facts(shape))
    return f'<div>{_viewer(shape) or _picture(shape)}<table>{rows}</table></div>'


def show(shape: Mesh | Points, viewer: str | None = None) -> pathlib.Path | None:
    """In a notebook below the cell; else the page in a browser, or a window."""
    if viewer not in (None, "browser", "open3d", "pyvista"):
        raise ParameterError(f"viewer = {viewer!r}, must be 'browser', 'open3d', 'pyvista' or None")
    if viewer is None and _in_a_notebook():
        from IPython.display import HTML, display

        display(HTML(viewer_html(shape)))
        return None
    has_page = _core.has_tools and _core.has_viewer
    if viewer == "browser" or viewer is None and has_page:
        return _open_page(shape)
    for name, window in (("open3d", _open3d_window), ("pyvista", _pyvista_window)):
        if viewer == name or viewer is None and _is_installed(name):
            window(shape)
            return None
    raise ImportError("show() needs the viewer, which this package was built without, a notebook, Open3D or PyVista; "
                      "render() and save() need none of them")


def _in_a_notebook() -> bool:
    if sys.modules.get("IPython") is None or "ipykernel" not in sys.modules:
        return False
    from IPython import get_ipython

    return get_ipython() is not None


def _open_page(shape: Mesh | Points) -> pathlib.Path:
    import webbrowser

    from ._tools import view

    page = view(shape)
    if not webbrowser.open(page.as_uri()):
        warn(f"no browser was found: open {page} in one", 4)
    return page


def _is_installed(name: str) -> bool:
    try:
        __import__(name)
    except ImportError:
        return False
    return True


def _open3d_window(shape: Any) -> None:
    import open3d

    window = shape.to_open3d()
    open3d.visualization.draw_geometries([window], window_name="soapfilm")


def _pyvista_window(shape: Any) -> None:
    shape.to_pyvista().plot()


def png(image: Any) -> bytes:
    """A picture of render(), uint8 (height, width, 4), as the bytes of a PNG."""
    height, width, _ = image.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + image[row].tobytes() for row in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


def _viewer(shape: Mesh | Points) -> str:
    if not _core.has_tools or not _core.has_viewer or _is_empty(shape):
        return ""
    from ._tools import page_of

    page = html.escape(page_of(shape, triangles=_NOTEBOOK_TRIANGLES, samples=_NOTEBOOK_SAMPLES))
    return (f'<iframe srcdoc="{page}" sandbox="allow-scripts allow-downloads" style="width: 100%; height: 480px; '
            'border: 0"></iframe>')


def _picture(shape: Mesh | Points) -> str:
    if not _core.has_tools or _is_empty(shape):
        return ""
    from ._tools import render

    sides = [render(shape, size=(300, 300), view=view, samples=2, background="transparent")
             for view in ("front", "left", "top")]
    return "".join(f'<img width="300" height="300" alt="{side}" '
                   f'src="data:image/png;base64,{base64.b64encode(png(image)).decode()}">'
                   for side, image in zip(("front", "left", "top"), sides))


def _is_empty(shape: Any) -> bool:
    return len(shape.triangles if hasattr(shape, "triangles") else shape) == 0


def _facts(shape: Any) -> list[tuple[str, str]]:
    if not hasattr(shape, "triangles"):
        columns = [name for name in ("normals", "sensors", "weights", "colors") if getattr(shape, name) is not None]
        return [("samples", f"{len(shape):,}"), ("scans", f"{len(shape.scans):,}"),
                ("columns", ", ".join(["positions", *columns, *shape.values]))]
    facts = [("vertices", f"{len(shape.vertices):,}"), ("triangles", f"{len(shape.triangles):,}")]
    report = getattr(shape, "report", None)
    return facts if report is None else facts + _facts_of_run(report) + [("warning", line) for line in shape.warnings]


def _facts_of_run(report: dict[str, Any]) -> list[tuple[str, str]]:
    size = " x ".join(str(n) for n in report["grid"]["size"])
    facts = [("grid", f"{size}, voxel {report['grid']['voxel']:.4g}")]
    certificate = report["certificate"]
    if certificate and certificate["relative_gap_binary"] is not None:
        facts.append(("proved", f"within {100 * certificate['relative_gap_binary']:.2g} % of the global optimum"))
    facts.append(("samples far from the mesh", f"{100 * report['self_check']['lost']:.2g} %"))
    facts.append(("mesh far from all samples", f"{100 * report['self_check']['invented']:.2g} %"))
    return facts
