"""The rows of a benchmark, found by what they are, and the comparisons between them."""
import math
import statistics
from dataclasses import dataclass, fields

from cases import FLAT


@dataclass
class Row:
    """What is known of one case: a line of runs.csv. Errors are distances from the truth to the mesh."""
    shape: str
    condition: str
    method: str
    cells: int                   # along the shape's longest side
    peer_voxel: float            # a peer's voxel over ours
    voxel: float                 # ours, input units
    samples: int
    mean: float = None           # input units
    mean_voxels: float = None
    rms_voxels: float = None
    p95_voxels: float = None
    p99_voxels: float = None
    maximum_voxels: float = None
    back_mean_voxels: float = None  # mesh to truth: what should not be there
    normal_angle: float = None   # mean, degrees
    normal_angle_p95: float = None
    volume_error: float = None   # (mesh - truth) / truth; None for an open mesh
    closed: bool = None
    components: int = None
    genus: int = None
    true_components: int = None
    true_genus: int = None
    self_intersections: int = None  # pairs of triangles
    cpu: float = 0               # seconds of the whole process
    peak_mb: float = 0
    failure: str = ""            # the program's own line when there is no mesh

    @property
    def right(self):
        """Is the topology the truth's?"""
        return bool(self.closed) and (self.components, self.genus) == (self.true_components, self.true_genus)

    @property
    def topology(self):
        """Short: what is wrong, or 'right'."""
        if self.mean is None:
            return "none"
        if self.right:
            return "right"
        words = [] if self.closed else ["open"]
        if self.components != self.true_components:
            words.append(f"{self.components} part{'s' * (self.components != 1)}")
        if self.genus is not None and self.genus != self.true_genus:
            words.append(f"genus {self.genus}")
        return ", ".join(words) or "not manifold"

    @classmethod
    def names(cls):
        return [f.name for f in fields(cls)]

    def values(self):
        return [getattr(self, name) for name in self.names()]

    def take(self, judged):
        """What `soapfilm evaluate --json` says of the mesh."""
        there, back, topology = judged["truth_to_mesh"], judged["mesh_to_truth"], judged["topology"]["mesh"]
        self.mean = there["distance"]["mean"]
        self.mean_voxels, self.rms_voxels, self.p95_voxels, self.p99_voxels, self.maximum_voxels = (
            there["distance_voxels"][k] for k in ("mean", "rms", "percentile95", "percentile99", "maximum"))
        self.back_mean_voxels = back["distance_voxels"]["mean"]
        self.normal_angle, self.normal_angle_p95 = (there["normal_angle_deg"][k] for k in ("mean", "percentile95"))
        self.volume_error = judged["volume"]["relative_error"]
        self.closed, self.components, self.genus = (topology[k] for k in ("closed", "components", "genus"))
        self.self_intersections = judged["self_intersections"]


class Results:
    """`reference`: name of the peer that the ratios refer to, None without one."""

    def __init__(self, rows, reference):
        self.reference = reference
        self.rows = {}
        for row in rows:
            self.rows.setdefault((row.shape, row.condition, row.method, row.cells), []).append(row)

    def get(self, shape, condition, method, cells):
        """The row; of a peer's voxels the one with the least mean error (only noisy conditions have several). None
        when it was not run, a row with its `failure` when it gave nothing."""
        found = self.rows.get((shape, condition, method, cells), [])
        return min(found, key=lambda r: math.inf if r.mean is None else r.mean) if found else None

    def error(self, shape, condition, method, cells):
        """Mean distance, voxels; None when there is no mesh."""
        row = self.get(shape, condition, method, cells)
        return row.mean_voxels if row else None

    def angle(self, shape, condition, method, cells):
        """Mean normal angle, degrees; None when there is no mesh."""
        row = self.get(shape, condition, method, cells)
        return row.normal_angle if row else None

    def ratio(self, shape, condition, method, cells, measure=None):
        """Of mean errors, or of another measure of this class, to the reference's in the same run; None where one of
        the two has none."""
        measure = measure or self.error
        mine, theirs = (measure(shape, condition, name, cells) for name in (method, self.reference))
        return None if mine is None or not theirs else mine / theirs

    def methods(self, cells, series=False):
        """Names, in the order in which they were run; with `series` those too that only the order of convergence
        runs."""
        return list(dict.fromkeys(k[2] for k in self.rows if k[3] == cells and (series or k[2] != FLAT)))

    def of_method(self, method):
        return [row for key, rows in self.rows.items() if key[2] == method for row in rows]

    def sizes(self, shape, condition, method):
        """(cells, row), coarse to fine, of all voxel sizes that were run."""
        keys = sorted(k[3] for k in self.rows if k[:3] == (shape, condition, method))
        return [(n, self.get(shape, condition, method, n)) for n in keys]


def order_of(sizes):
    """Slope of log(error) over log(voxel) by least squares; None with fewer than three voxel sizes, or where one of
    them gave no mesh."""
    if len(sizes) < 3 or not all(row.mean for _, row in sizes):
        return None
    return statistics.linear_regression([math.log(row.voxel) for _, row in sizes],
                                        [math.log(row.mean) for _, row in sizes]).slope
