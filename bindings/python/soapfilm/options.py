"""Types of parameters, for type checkers and completion: ``from soapfilm.options import Options, Solve``.

``Options`` has the keyword arguments of :func:`soapfilm.reconstruct`, ``Solve``, ``Place``, ... the groups of the
report, such as ``solve=dict(tolerance=1e-4)``. What each means, with its default, unit and range:
docs/reference/options.md.
"""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, List, Literal, Optional, TypedDict, Union

Method = Literal["tv", "tv-sor", "poisson", "graph-cut-6", "graph-cut-26", "vrip"]
Directions = Literal["auto", "normals", "sensor", "scan", "estimate"]
Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
Outside = Literal["auto", "air", "solid", "open"]
Norm = Literal["isotropic", "anisotropic"]
FoldSource = Literal["auto", "samples", "scans"]
SorOrder = Literal["lexicographic", "red-black"]
SorGradient = Literal["central", "forward"]
Holes = Literal["smooth", "flat"]
LinkWeights = Literal["edge-length", "cauchy-crofton"]
Weights = Literal["area", "samples"]
Switch = Union[bool, Literal["on", "off"]]
Auto = Literal["auto"]
Viewer = Literal["browser", "open3d", "pyvista"]
Vector = Any  # three numbers: a sequence or an array
Length = Union[float, str]  # input units, or text such as "0.5%"


class Solve(TypedDict, total=False):
    method: Method
    tolerance: float
    max_iterations: int
    settle: bool
    check_every: int
    step_balance: float


class Orient(TypedDict, total=False):
    directions: Directions
    sensor: Optional[Vector]
    up: Optional[Axis]
    neighbors: int
    radius: Optional[float]


class Place(TypedDict, total=False):
    voxel: Optional[float]
    resolution: Optional[int]
    samples_per_voxel2: float
    padding: int
    levels: int
    anchor: Optional[Vector]
    adapt: bool


Energy = TypedDict("Energy", {
    "lambda": Optional[float], "lambda_": Optional[float], "lambda_per_density": float, "cross_validate": bool,
    "by_area": bool, "norm": Norm}, total=False)


class Border(TypedDict, total=False):
    outside: Outside
    open_gain: float


class CrossValidation(TypedDict, total=False):
    folds: int
    source: FoldSource
    max_resolution: int
    indifference: float
    seed: int
    candidates: Sequence[float]


class Sor(TypedDict, total=False):
    epsilon: float
    omega: float
    renew_every: int
    levels: int
    tolerance: float
    max_iterations: int
    order: SorOrder
    gradient: SorGradient
    skip_empty: bool
    snap: float


class Poisson(TypedDict, total=False):
    tolerance: float
    max_iterations: int


class GraphCut(TypedDict, total=False):
    weights: LinkWeights


class Vrip(TypedDict, total=False):
    front: float
    behind: float
    max_edge: float
    max_incidence_deg: float
    taper: int


class Surface(TypedDict, total=False):
    threshold: float
    refine: Optional[bool]
    isovalue: Optional[float]
    drop_components: Optional[bool]
    split_tolerance: float
    distance: bool
    support: bool
    gap: bool
    volume_interval: Optional[float]
    attributes: List[str]


class Components(TypedDict, total=False):
    min_support: float
    few_samples: int
    many_samples: int
    sparse_support: float


class Refine(TypedDict, total=False):
    smoothing: Optional[float]
    normals: Optional[float]
    reach: float
    sparse: float
    holes: Holes


class Trim(TypedDict, total=False):
    on: Optional[bool]
    distance: Optional[float]
    holes: bool
    fill_holes: Optional[float]


class Simplify(TypedDict, total=False):
    tolerance: Optional[float]
    tolerance_vox: Optional[float]
    automatic: bool
    triangles: Optional[int]


class Memory(TypedDict, total=False):
    checked: bool


class Options(TypedDict, total=False):
    """Of :func:`soapfilm.reconstruct`, beside its arguments that have a name of their own."""

    padding: Optional[int]
    anchor: Optional[Vector]
    adapt: Optional[Switch]
    outside: Optional[Outside]
    directions: Optional[Directions]
    sensor: Optional[Vector]
    up: Optional[Axis]
    neighbors: Optional[int]
    radius: Optional[float]
    lambda_: Union[float, Auto, None]
    norm: Optional[Norm]
    tolerance: Optional[float]
    max_iterations: Optional[int]
    settle: Optional[Switch]
    method: Optional[Method]
    link_weights: Optional[LinkWeights]
    front: Optional[float]
    behind: Optional[float]
    folds: Optional[int]
    fold_source: Optional[FoldSource]
    threshold: Optional[float]
    isovalue: Union[float, Auto, None]
    refine: Union[Switch, Refine, None]
    drop_components: Optional[Switch]
    min_support: Optional[float]
    smoothing: Optional[float]
    holes: Optional[Holes]
    split_tolerance: Optional[float]
    trim: Union[float, Switch, Auto, Trim, None]
    trim_holes: Optional[Switch]
    fill_holes: Optional[float]
    simplify: Union[float, str, Switch, Auto, Simplify, None]
    triangles: Optional[int]
    attributes: Union[str, Sequence[str], None]
    distance: Optional[Switch]
    support: Optional[Switch]
    gap: Optional[Switch]
    volume_interval: Optional[float]
    solve: Solve
    orient: Orient
    place: Place
    energy: Energy
    border: Border
    cross_validation: CrossValidation
    sor: Sor
    poisson: Poisson
    graph_cut: GraphCut
    vrip: Vrip
    surface: Surface
    components: Components


class RunOptions(Options, total=False):
    """Of :class:`soapfilm.Reconstructor`."""

    voxel: Optional[float]
    resolution: Optional[int]
    memory: Union[int, str, Memory, None]
    weights: Optional[Weights]


class Shape(TypedDict, total=False):
    """A built-in shape of :func:`soapfilm.scan` and :func:`soapfilm.evaluate`."""

    size: Optional[float]
    center: Optional[Vector]
    thickness: Optional[float]
    gap: Optional[float]


class Scan(Shape, total=False):
    """Of :func:`soapfilm.scan`: docs/reference/scanner.md."""

    views: Optional[int]
    orbit: Optional[Literal["fibonacci", "ring"]]
    elevations: Optional[Sequence[float]]
    distance: Optional[float]
    positions: Any  # rows of three numbers
    target: Optional[Vector]
    rays: Optional[Literal["central", "parallel", "spinning"]]
    image: Any  # columns and rows
    step: Optional[Length]
    span: Any  # lowest and highest, degrees
    rings: Optional[Sequence[float]]
    max_range: Optional[Length]
    normals: Optional[bool]
    noise: Optional[Length]
    outliers: Optional[float]
    outlier_kind: Optional[Literal["ray", "box"]]
    drop_out: Optional[float]
    max_incidence: Optional[float]
    ghosts: Optional[float]
    ghost_depth: Any  # least and largest
    mixed_pixels: Optional[float]
    misalignment: Optional[Length]
    misalignment_angle: Optional[float]
    hole: Optional[float]
    sparse_half: Optional[float]
    seed: Optional[int]
    samples: Optional[int]
    directions: Optional[Literal["normals", "views"]]


#: The groups by their names in the report.
GROUPS: dict[str, Any] = {
    "solve": Solve, "orient": Orient, "place": Place, "energy": Energy, "border": Border,
    "cross_validation": CrossValidation, "sor": Sor, "poisson": Poisson, "graph_cut": GraphCut, "vrip": Vrip,
    "surface": Surface, "components": Components, "refine": Refine, "trim": Trim, "simplify": Simplify, "memory": Memory,
}
