"""What the compiled module has: for the package itself. Users see soapfilm/*.py."""
from collections.abc import Callable, Sequence
from typing import Any, Optional

_Listener = Optional[Callable[[str, float, str], Any]]

version: str
has_tools: bool
has_viewer: bool  # only where there are tools

class View:
    """Memory of the library for numpy.asarray()."""

class Points:
    size: int
    positions: View
    normals: View | None
    sensors: View | None
    weights: View | None
    colors: View | None
    columns: list[tuple[str, View, bool]]
    scans: list[dict[str, Any]]
    files: list[dict[str, Any]]
    warnings: list[str]
    coordinate_system: str
    facts: dict[str, Any]
    def joined(self, other: Points) -> Points: ...
    def save(self, path: str, ascii: bool) -> None: ...

class Mesh:
    vertices: View
    triangles: View
    normals: View | None
    colors: View | None
    attributes: list[tuple[str, View]]
    area: float
    volume: float
    voxel: float
    def topology(self) -> dict[str, Any]: ...
    def save(self, path: str, ascii: bool, up: str) -> list[str]: ...

class Scans:
    size: int
    scans: int
    def __init__(self) -> None: ...
    def add(self, points: Points, use_up: bool, pose: Sequence[float] | None) -> None: ...
    def reconstruct(self, parameters: str, threads: int, on_event: _Listener,
                    memory_limit: int | None) -> tuple[Mesh, str]: ...

def points_of(columns: dict[str, Any], values: list[tuple[str, Any, bool]], scans: list[dict[str, Any]],
              facts: dict[str, Any]) -> Points: ...
def read(paths: list[str], columns: str, trajectory: str, trust_viewpoint: bool, spacing: float, threads: int,
         on_event: _Listener) -> Points: ...
def mesh_of(vertices: Any, triangles: Any, normals: Any, colors: Any, attributes: list[tuple[str, Any]],
            voxel: float) -> Mesh: ...
def read_mesh(path: str) -> tuple[Mesh, list[str]]: ...
def reconstruct(points: Points, use_up: bool, parameters: str, threads: int, on_event: _Listener,
                memory_limit: int | None) -> tuple[Mesh, str]: ...
def default_parameters() -> str: ...
def evaluate(mesh: Mesh, truth: Mesh | None, given: dict[str, Any], threads: int, on_event: _Listener) -> str: ...
def measure(mesh: Mesh, base: Mesh | None, before: Mesh | None, given: dict[str, Any], threads: int,
            on_event: _Listener) -> str: ...
def compare(part: Mesh | Points, model: Mesh, given: dict[str, Any], threads: int, on_event: _Listener) -> str: ...
def simplify(mesh: Mesh, tolerance: float, triangles: int, threads: int,
             on_event: _Listener) -> tuple[Mesh, dict[str, Any]]: ...
def scan(object: Mesh | None, name: str, given: dict[str, Any], threads: int, on_event: _Listener) -> Points: ...
def render(shapes: list[tuple[Any, str]], given: dict[str, Any], path: str, threads: int,
           on_event: _Listener) -> tuple[int, int, bytes]: ...
def view(shapes: list[tuple[Any, str, str]], given: dict[str, Any], threads: int, on_event: _Listener) -> str: ...
