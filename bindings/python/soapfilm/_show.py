"""Meshes in notebooks and windows."""
from __future__ import annotations

import base64
import html
import struct
import sys
import zlib
from typing import TYPE_CHECKING, Any

from . import _core

if TYPE_CHECKING:
    from ._mesh import Mesh


#: Of the viewer in a notebook, which is saved with all it shows.
_NOTEBOOK_TRIANGLES = 60_000


def viewer_html(mesh: Mesh) -> str:
    """What a notebook shows of a mesh: the viewer, or pictures from three sides, and what is known."""
    rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>"
                   for name, value in _facts(mesh))
    return f'<div>{_viewer(mesh) or _picture(mesh)}<table>{rows}</table></div>'


def show(mesh: Mesh) -> Any:
    """In a notebook the page; else a window."""
    if "IPython" in sys.modules:
        from IPython import get_ipython
        from IPython.display import HTML, display

        if get_ipython() is not None and "ipykernel" in sys.modules:
            display(HTML(viewer_html(mesh)))
            return None
    try:
        import open3d
    except ImportError:
        pass
    else:
        window = mesh.to_open3d()
        window.compute_vertex_normals()
        open3d.visualization.draw_geometries([window], window_name="soapfilm")
        return None
    try:
        return mesh.to_pyvista().plot()
    except ImportError:
        raise ImportError("show() needs a notebook, Open3D or PyVista; render() and save() need none of them") from None


def png(image: Any) -> bytes:
    """A picture of render(), uint8 (height, width, 4), as the bytes of a PNG."""
    height, width, _ = image.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + image[row].tobytes() for row in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


def _viewer(mesh: Mesh) -> str:
    if not _core.has_tools or not _core.has_viewer or len(mesh.triangles) == 0:
        return ""
    from ._tools import view

    page = html.escape(view(mesh, triangles=_NOTEBOOK_TRIANGLES))
    return (f'<iframe srcdoc="{page}" sandbox="allow-scripts allow-downloads" style="width: 100%; height: 480px; '
            'border: 0"></iframe>')


def _picture(mesh: Mesh) -> str:
    if not _core.has_tools or len(mesh.triangles) == 0:
        return ""
    from ._tools import render

    sides = [render(mesh, size=(300, 300), view=view, samples=2, background="transparent")
             for view in ("front", "left", "top")]
    return "".join(f'<img width="300" height="300" alt="{side}" '
                   f'src="data:image/png;base64,{base64.b64encode(png(image)).decode()}">'
                   for side, image in zip(("front", "left", "top"), sides))


def _facts(mesh: Mesh) -> list[tuple[str, str]]:
    facts = [("vertices", f"{len(mesh.vertices):,}"), ("triangles", f"{len(mesh.triangles):,}")]
    report = getattr(mesh, "report", None)
    if report is None:
        return facts
    size = " x ".join(str(n) for n in report["grid"]["size"])
    facts.append(("grid", f"{size}, voxel {report['grid']['voxel']:.4g}"))
    certificate = report["certificate"]
    if certificate and certificate["relative_gap_binary"] is not None:
        facts.append(("proved", f"within {100 * certificate['relative_gap_binary']:.2g} % of the global optimum"))
    facts.append(("samples far from the mesh", f"{100 * report['self_check']['lost']:.2g} %"))
    facts.append(("mesh far from all samples", f"{100 * report['self_check']['invented']:.2g} %"))
    facts += [("warning", line) for line in report["warnings"]]
    return facts
