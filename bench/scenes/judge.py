"""What a mesh is worth as the surface of given samples: what is lost, what is invented, how it is connected.

Distances to a mesh are Open3D's, exact but for single precision, in a frame around the mesh. Every mesh is judged in
the same way, ours and the peer's, closed or open."""
from dataclasses import dataclass

import numpy as np
import open3d
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

LOST = INVENTED = 3     # voxels
MOST_SAMPLES = 100000   # that are measured, by lot


def read_mesh(path):
    mesh = open3d.io.read_triangle_mesh(str(path))
    return np.asarray(mesh.vertices), np.asarray(mesh.triangles)


class Surface:
    """A mesh to which distances are asked, about its middle and scaled, so that single precision is enough."""

    def __init__(self, vertices, triangles):
        used = vertices[np.unique(triangles)]
        self.middle, self.scale = (used.min(0) + used.max(0)) / 2, max(np.ptp(used, axis=0).max(), 1e-300)
        self.scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self.scene.add_triangles(self.local(vertices), open3d.core.Tensor(triangles.astype(np.uint32)))

    def local(self, points):
        return open3d.core.Tensor(((points - self.middle) / self.scale).astype(np.float32))

    def nearest(self, points):
        """Distance of each point and the unit normal of the triangle that it is nearest to."""
        found = self.scene.compute_closest_points(self.local(points))
        near = found["points"].numpy().astype(float) * self.scale + self.middle
        return np.linalg.norm(points - near, axis=1), found["primitive_normals"].numpy().astype(float)


def distances_to(path, points):
    return Surface(*read_mesh(path)).nearest(points)[0]


def on_surface(vertices, triangles, count, rng):
    """Points even by area."""
    corners = vertices[triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    face = rng.choice(len(triangles), count, p=areas / areas.sum())
    r, s = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    a, b, c = corners[face].transpose(1, 0, 2)
    return (1 - r) * a + r * (1 - s) * b + r * s * c, areas.sum()


def parts(pairs, count):
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def topology(triangles):
    """Components, boundary curves (of edges in one triangle) and genus, by Euler's characteristic; None of what is not
    a manifold at its edges."""
    names, t = np.unique(triangles, return_inverse=True)
    t = t.reshape(-1, 3)
    edges = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    components = len(np.unique(parts(edges, len(names))))
    border = edges[uses == 1]
    curves = len(np.unique(parts(border, len(names))[np.unique(border)])) if len(border) else 0
    if uses.max() > 2:
        return components, curves, None
    euler = len(names) - len(edges) + len(t)
    return components, curves, (2 * components - curves - euler) // 2


@dataclass
class Verdict:
    """Of one mesh; shares from 0 to 1, lengths in voxels."""
    lost: float                  # share of the samples farther than LOST
    p95: float                   # of the samples' distances
    invented: float              # share of the area farther than INVENTED from every sample
    error: float = None          # mean distance of the truth, where it was sampled
    wrong_side: float = None     # share of the samples whose nearest face looks the other way
    area: float = 0              # input units^2
    triangles: int = 0
    components: int = 0
    curves: int = 0              # of the boundary
    genus: int = None


class Judge:
    """The samples of one scene. `judged`: mask of those that may not be lost."""

    def __init__(self, made, voxel, judged=None, truth=None):
        self.voxel, self.rng = voxel, np.random.default_rng(0)
        good = np.ones(len(made.positions), bool) if made.good is None else made.good
        self.samples = made.positions[good]
        self.tree = cKDTree(self.samples)
        chosen = np.flatnonzero(good if judged is None else good & judged)
        if len(chosen) > MOST_SAMPLES:
            chosen = np.sort(self.rng.choice(chosen, MOST_SAMPLES, replace=False))
        self.measured = made.positions[chosen]
        towards = None if made.towards is None else made.towards - made.positions
        sides = made.outward if made.outward is not None else towards
        self.sides = None if sides is None else sides[chosen]
        self.truth = self.sampled_truth(truth) if truth is not None else None

    def sampled_truth(self, truth):
        """Points of the truth that have a sample within two voxels."""
        points, _ = on_surface(*truth, MOST_SAMPLES, self.rng)
        return points[self.tree.query(points)[0] < 2 * self.voxel]

    def lost(self, surface):
        return float((surface.nearest(self.measured)[0] > LOST * self.voxel).mean())

    def invented(self, vertices, triangles):
        points, area = on_surface(vertices, triangles, MOST_SAMPLES, np.random.default_rng(1))
        return float((self.tree.query(points)[0] > INVENTED * self.voxel).mean()), area

    def __call__(self, vertices, triangles):
        if not len(triangles):
            return None
        surface = Surface(vertices, triangles)
        distance, normal = surface.nearest(self.measured)
        invented, area = self.invented(vertices, triangles)
        verdict = Verdict(float((distance > LOST * self.voxel).mean()),
                          float(np.quantile(distance, 0.95)) / self.voxel, invented, area=area,
                          triangles=len(triangles))
        if self.sides is not None:
            verdict.wrong_side = float(((normal * self.sides).sum(axis=1) < 0).mean())
        if self.truth is not None and len(self.truth):
            verdict.error = float(surface.nearest(self.truth)[0].mean()) / self.voxel
        verdict.components, verdict.curves, verdict.genus = topology(triangles)
        return verdict


def trimmed(judge, vertices, triangles, densities, loss):
    """Poisson's surface without what its octree was thinly filled by: as much cut off as leaves no more samples lost
    than `loss`, or than its whole surface loses. Returns the triangles that stay."""
    allowed = max(loss, judge.lost(Surface(vertices, triangles))) + 1e-9
    least = densities[triangles].min(axis=1)
    order = np.sort(least)
    low, high = 0, len(order) - 1          # triangles cut off: `low` are allowed, more than `high` are not tried
    while high - low > max(1, len(order) // 1000):
        middle = (low + high) // 2
        stays = triangles[least >= order[middle]]
        if judge.lost(Surface(vertices, stays)) <= allowed:
            low = middle
        else:
            high = middle
    return triangles[least >= order[low]]
