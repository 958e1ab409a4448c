"""What a mesh is worth as the surface of given samples: what is lost, what is invented, how it is connected.

Every mesh is judged in the same way, ours and the peer's, closed or open."""
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from geometry import read_mesh

LOST = INVENTED = 3     # voxels
MOST_SAMPLES = 100000   # that are measured, by lot


def length(v):
    return np.sqrt(np.einsum("...i,...i", v, v))


def to_segments(p, a, b):
    """Distances of points to segments, row by row."""
    ab, ap = b - a, p - a
    part = np.einsum("...i,...i", ap, ab) / np.maximum(np.einsum("...i,...i", ab, ab), 1e-300)
    return length(ap - np.clip(part, 0, 1)[..., None] * ab)


def to_triangles(p, corners):
    """Distances of points (..., 3) to triangles (..., 3, 3)."""
    a, b, c = (corners[..., k, :] for k in range(3))
    square = np.cross(b - a, c - a)
    over = [np.einsum("...i,...i", np.cross(v - u, p - u), square) >= 0 for u, v in ((a, b), (b, c), (c, a))]
    height = np.abs(np.einsum("...i,...i", p - a, square)) / np.maximum(length(square), 1e-300)
    rim = np.minimum(np.minimum(to_segments(p, a, b), to_segments(p, b, c)), to_segments(p, c, a))
    return np.where(over[0] & over[1] & over[2], height, rim)


def split(corners, longest, near=None, reach=0):
    """Triangles with no edge over `longest`, each cut into four until it has none; those farther than `reach` from all
    points of the tree `near` are left out, for a balloon of a peer may be as large as the sky."""
    done = []
    while len(corners):
        edges = length(corners - np.roll(corners, -1, axis=1)).max(axis=1)
        if near is not None:
            close = near.query(corners.mean(axis=1))[0] < reach + edges
            corners, edges = corners[close], edges[close]
        done.append(corners[edges <= longest])
        a, b, c = corners[edges > longest].transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        corners = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate(done)


class Surface:
    """A mesh to which distances are asked: to the nearest of the triangles with the CANDIDATES nearest middles, none
    longer than a few voxels, so that nothing nearer is overlooked by more than a few hundredths of one. With `near`,
    a tree of the points that will ask, only distances up to REACH voxels are exact; others are too large."""
    CANDIDATES, AT_ONCE, LONGEST, REACH = 12, 20000, 4, 20

    def __init__(self, vertices, triangles, voxel, near=None):
        self.corners = split(vertices[triangles], self.LONGEST * voxel, near, self.REACH * voxel)
        if not len(self.corners):
            self.corners = vertices[triangles[:1]]
        self.tree = cKDTree(self.corners.mean(axis=1))

    def nearest(self, points):
        """Distance of each point and the normal of the triangle that it is nearest to."""
        distance, normal = np.empty(len(points)), np.empty((len(points), 3))
        count = min(self.CANDIDATES, len(self.corners))
        for begin in range(0, len(points), self.AT_ONCE):
            part = slice(begin, begin + self.AT_ONCE)
            found = self.tree.query(points[part], count)[1].reshape(-1, count)
            apart = to_triangles(points[part, None], self.corners[found])
            best = apart.argmin(axis=1)
            rows = np.arange(len(best))
            distance[part] = apart[rows, best]
            a, b, c = self.corners[found[rows, best]].transpose(1, 0, 2)
            normal[part] = np.cross(b - a, c - a)
        return distance, normal


def distances_to(path, points, longest):
    """Of points to a mesh whose triangles are cut until no edge is over `longest`."""
    return Surface(*read_mesh(path), longest).nearest(points)[0]


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


def edges_of(triangles):
    """The vertices that are used, triangles by their rank, edges, and how many triangles each edge is in."""
    names, t = np.unique(triangles, return_inverse=True)
    t = t.reshape(-1, 3)
    edges = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    return names, t, *np.unique(edges, axis=0, return_counts=True)


def shells(vertices, triangles):
    """Share of the area in closed parts of negative volume: balloons that turn their inside to the air. (A room that
    was seen from inside is rightly one.)"""
    names, t, edges, uses = edges_of(triangles)
    part = parts(edges, len(names))
    count = part.max() + 1
    first = np.zeros((count, 3))
    first[part] = vertices[names]          # volumes are taken from a point of each part: coordinates may be large
    corners = vertices[names][t] - first[part[t[:, 0]]][:, None]
    a, b, c = corners.transpose(1, 0, 2)
    volume = np.bincount(part[t[:, 0]], np.einsum("ti,ti->t", a, np.cross(b, c)), count)
    areas = np.bincount(part[t[:, 0]], length(np.cross(b - a, c - a)), count)
    closed = np.ones(count, bool)
    closed[part[edges[uses == 1].ravel()]] = False
    return float(areas[closed & (volume < 0)].sum() / max(areas.sum(), 1e-300))


def topology(triangles):
    """Components, boundary curves (of edges in one triangle) and genus, by Euler's characteristic; None of what is not
    a manifold at its edges."""
    names, t, edges, uses = edges_of(triangles)
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
    error: float = None          # mean distance of the truth, where it was sampled and is not lost
    wrong_side: float = None     # share of those not lost whose nearest face looks away from where they were seen
    shells: float = None         # share of the area in closed parts of negative volume
    area: float = 0              # input units^2
    triangles: int = 0
    components: int = 0
    curves: int = 0              # of the boundary
    genus: int = None


class Judge:
    """The samples of one scene. `judged`: mask of those that may not be lost. Sides are judged from where a sample was
    seen, or by the true normal where nobody saw it."""

    def __init__(self, made, voxel, judged=None, truth=None):
        self.voxel, self.rng = voxel, np.random.default_rng(0)
        good = np.ones(len(made.positions), bool) if made.good is None else made.good
        self.samples = made.positions[good]
        self.tree = cKDTree(self.samples)
        chosen = np.flatnonzero(good if judged is None else good & judged)
        if len(chosen) > MOST_SAMPLES:
            chosen = np.sort(self.rng.choice(chosen, MOST_SAMPLES, replace=False))
        self.measured = made.positions[chosen]
        sides = made.outward if made.towards is None else made.towards - made.positions
        self.asking = cKDTree(self.measured)
        self.sides = None if sides is None else sides[chosen]
        self.sided = np.ones(len(chosen), bool) if made.sided is None else made.sided[chosen]
        self.truth = self.sampled_truth(truth) if truth is not None else None

    def sampled_truth(self, truth):
        """Points of the truth that have a sample within two voxels."""
        points, _ = on_surface(*truth, MOST_SAMPLES, self.rng)
        return points[self.tree.query(points)[0] < 2 * self.voxel]

    def lost(self, vertices, triangles):
        distance, _ = Surface(vertices, triangles, self.voxel, self.asking).nearest(self.measured)
        return float((distance > LOST * self.voxel).mean())

    def invented(self, vertices, triangles):
        points, area = on_surface(vertices, triangles, MOST_SAMPLES, np.random.default_rng(1))
        return float((self.tree.query(points)[0] > INVENTED * self.voxel).mean()), area

    def __call__(self, vertices, triangles):
        if not len(triangles):
            return None
        surface = Surface(vertices, triangles, self.voxel, self.tree)
        distance, normal = surface.nearest(self.measured)
        invented, area = self.invented(vertices, triangles)
        lost = distance > LOST * self.voxel
        verdict = Verdict(float(lost.mean()), float(np.quantile(distance, 0.95)) / self.voxel, invented,
                          shells=shells(vertices, triangles), area=area, triangles=len(triangles))
        asked = self.sided & ~lost
        if self.sides is not None and asked.any():
            verdict.wrong_side = float(((normal * self.sides)[asked].sum(axis=1) < 0).mean())
        if self.truth is not None and len(self.truth):
            apart = surface.nearest(self.truth)[0] / self.voxel
            verdict.error = float(apart[apart <= LOST].mean()) if (apart <= LOST).any() else None
        verdict.components, verdict.curves, verdict.genus = topology(triangles)
        return verdict


def trimmed(judge, vertices, triangles, densities, loss):
    """Poisson's surface without what its octree was thinly filled by: as much cut off as leaves no more samples lost
    than `loss`, or than its whole surface loses. Returns the triangles that stay."""
    allowed = max(loss, judge.lost(vertices, triangles)) + 1e-9
    least = densities[triangles].min(axis=1)
    order = np.sort(least)
    low, high = 0, len(order) - 1          # triangles cut off: `low` are allowed, more than `high` are not tried
    while high - low > max(1, len(order) // 1000):
        middle = (low + high) // 2
        stays = triangles[least >= order[middle]]
        if judge.lost(vertices, stays) <= allowed:
            low = middle
        else:
            high = middle
    return triangles[least >= order[low]]
