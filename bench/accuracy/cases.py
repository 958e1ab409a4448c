"""What is measured: shapes, conditions, methods, voxel sizes, and which of their products a run takes."""
from dataclasses import dataclass

SEED = 1
BASE = 128                       # cells along the longest side of a shape, for all conditions
SERIES = (32, 64, 128, 256)      # for the order of convergence
FULL = (64, 128, 256)            # for all conditions with --full
SERIES_CONDITIONS = ("normals", "views")


@dataclass(frozen=True)
class Shape:
    """A built-in shape, or a mesh of SOAPFILM_DATA when there is a file."""
    name: str
    kind: str                    # smooth; detailed: has creases or detail near the voxel; sharp: convex sharp edges
    file: str = ""
    hole_decides: bool = True    # is the patch that --hole takes a disc, so that the rest tells the topology?
    thin_decides: bool = True    # is no part thinner than twice the spacing of the thinned half's samples?
    series: bool = False


# With this seed the hole goes around the knot's tube and through a bore of the part: there caps fit as well. On limbs
# and fingers of the meshes nobody knows.
SHAPES = (
    Shape("sphere", "smooth", series=True),
    Shape("torus", "smooth", series=True),
    Shape("plate", "smooth", series=True),
    Shape("sheets", "smooth", series=True),
    Shape("knot", "detailed", hole_decides=False, series=True),
    Shape("part", "sharp", hole_decides=False),
    Shape("horse", "detailed", "meshes/horse.ply", hole_decides=False, thin_decides=False),
    Shape("children", "detailed", "meshes/dancing_children.off", hole_decides=False, thin_decides=False, series=True),
    Shape("bunny", "detailed", "meshes/bunny_hr.obj", thin_decides=False),
    Shape("anchor", "sharp", "meshes/anchor.off", hole_decides=False, thin_decides=False),
)


@dataclass(frozen=True)
class Condition:
    """How a shape is measured. Even samples unless `scans`: then range images, one ray per voxel."""
    name: str
    title: str
    directions: str = "views"
    noise: float = 0             # standard deviation, voxels
    outliers: float = 0          # share of the samples
    hole: float = 0              # share of the surface
    sparse_half: float = 1         # one of so many samples stays on one half
    misalignment: float = 0      # standard deviation of each scan's shift along an axis, voxels
    density: float = 1           # of even samples, per voxel^2
    scans: bool = False
    seed: int = SEED             # of the samples, and of what spoils them: also of the hole's place
    baselines: bool = True       # run the older methods too

    def errors(self, voxel):
        """Arguments of soapfilm scan that spoil the samples."""
        words = ["--seed", self.seed]
        for option, value in (("--noise", self.noise * voxel), ("--misalignment", self.misalignment * voxel),
                              ("--outliers", self.outliers), ("--hole", self.hole)):
            words += [option, f"{value:.9g}"] if value else []
        return words + (["--sparse-half", f"{self.sparse_half:g}"] if self.sparse_half > 1 else [])

    @property
    def samples_per_voxel(self):
        """Of surface, voxel^2. Uneven density: the geometric mean of both halves is one."""
        return self.density * self.sparse_half**0.5


CONDITIONS = (
    Condition("normals", "true normals", directions="normals"),
    Condition("views", "viewing directions only"),
    Condition("noise-0.05", "noise of 1/20 voxel", noise=0.05, baselines=False),
    Condition("noise-0.25", "noise of 1/4 voxel", noise=0.25),
    Condition("noise-0.33", "noise of 1/3 voxel", noise=1 / 3, baselines=False),
    Condition("noise-0.5", "noise of 1/2 voxel", noise=0.5),
    Condition("noise-1", "noise of 1 voxel", noise=1),
    Condition("outliers-1", "1 % outliers", outliers=0.01),
    Condition("outliers-10", "10 % outliers", outliers=0.1),
    Condition("hole", "a hole of a tenth", hole=0.1),
    Condition("hole-2", "the hole in a second place", hole=0.1, seed=2, baselines=False),
    Condition("hole-3", "the hole in a third place", hole=0.1, seed=3, baselines=False),
    Condition("hole-noise", "the first hole, noise of 1/2 voxel", hole=0.1, noise=0.5, baselines=False),
    Condition("density", "density 50 to 1", sparse_half=50),
    Condition("sparse", "noise of 1/2 voxel, 1/5 sample per voxel^2", noise=0.5, density=0.2, baselines=False),
    Condition("scans", "range scans", scans=True),
    Condition("misaligned", "scans misaligned by 1/2 voxel", misalignment=0.5, scans=True),
)
NOISE = ("views", "noise-0.05", "noise-0.25", "noise-0.33", "noise-0.5", "noise-1")  # the axis of the plot


@dataclass(frozen=True)
class Method:
    """One of the program's methods, by the arguments that choose it. No other option is ever given but the voxel."""
    name: str
    arguments: tuple = ()
    ours: bool = False           # the method this project is about, not a baseline
    range_images: bool = False   # reads range scans only, whatever the condition gives the others
    series_only: bool = False    # run for the order of convergence alone


FLAT = "tv, edges not split"  # triangles of one voxel at every size
METHODS = (
    Method("tv", ours=True),
    Method("tv unrefined", ("--refine", "off"), ours=True),
    Method(FLAT, ("--split-tolerance", "0"), ours=True, series_only=True),
    Method("poisson", ("--method", "poisson")),
    Method("vrip", ("--method", "vrip"), range_images=True),
    Method("graph-cut-26", ("--method", "graph-cut-26")),
)


@dataclass(frozen=True)
class Case:
    shape: Shape
    condition: Condition
    method: object               # Method or Peer
    cells: int
    peer_voxel: float = 1        # a peer's voxel over ours

    @property
    def scans(self):
        return self.condition.scans or getattr(self.method, "range_images", False)

    @property
    def cloud(self):
        return f"{self.shape.name}-{self.condition.name}-{self.cells}" + ("-scans" if self.scans else "")

    @property
    def name(self):
        method = self.method.name.replace(" ", "-").replace(",", "")
        return f"{self.cloud}.{method}" + (f"-{self.peer_voxel:g}x" if self.peer_voxel != 1 else "")


def runs_here(method, shape, condition, full):
    """vrip fuses ranges and knows no normals. The cut needs minutes for each cloud with many outliers."""
    if getattr(method, "range_images", False) and condition.directions == "normals":
        return False
    if method.name == "graph-cut-26" and condition.name == "outliers-10" and not full:
        return shape.name in ("knot", "children")
    return getattr(method, "ours", True) or condition.baselines


def sizes_of(cells, full):
    """Voxel sizes of all conditions, the one that the targets are judged at first."""
    return (cells, *(n for n in FULL if n != cells)) if full else (cells,)


def plan(shapes, conditions, own, peers, cells, full):
    """All cases, in the order in which they run: ours, peers, baselines. `cells`: the size that all conditions have;
    the series has its own."""
    cases, order = [], [m.name for m in own if m.ours] + [p.name for p in peers] + [m.name for m in own if not m.ours]
    for shape in shapes:
        for condition in conditions:
            sizes = sizes_of(cells, full)
            for method in own:
                if not method.series_only and runs_here(method, shape, condition, full):
                    cases += [Case(shape, condition, method, n) for n in sizes]
            for peer in peers:
                if not peer.conditions or condition.name in peer.conditions:
                    factors = (1, *peer.voxels) if condition.noise else (1,)
                    cases += [Case(shape, condition, peer, n, f) for n in sizes for f in factors]
            if shape.series and condition.name in SERIES_CONDITIONS and cells == BASE:
                chosen = [m for m in own if m.ours] + [p for p in peers if not p.conditions]
                cases += [Case(shape, condition, m, n) for m in chosen for n in SERIES
                          if n not in sizes or getattr(m, "series_only", False)]
    return sorted(cases, key=lambda c: order.index(c.method.name))
