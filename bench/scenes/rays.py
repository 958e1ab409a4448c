"""Where rays meet convex solids, rooms and the ground: what an instrument sees in scenes that are known exactly."""
import numpy as np

from geometry import face_normals, grid_mesh


class Solid:
    """A closed convex mesh whose faces look outward, as the planes of its faces."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.normals, _ = face_normals(mesh)
        self.levels = np.einsum("ti,ti->t", self.normals, mesh[0][mesh[1][:, 0]])

    def crossings(self, origins, ways):
        """How far along each ray it enters and leaves the solid, and through which faces."""
        rate, gap = ways @ self.normals.T, self.levels - origins @ self.normals.T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = gap / rate
        into = np.where(rate < 0, at, np.where((rate == 0) & (gap < 0), np.inf, -np.inf))
        out = np.where(rate > 0, at, np.inf)
        return into.max(axis=1), out.min(axis=1), into.argmax(axis=1), out.argmin(axis=1)

    def hit(self, origins, ways):
        """From outside: distance (inf: none) and normal."""
        into, out, face, _ = self.crossings(origins, ways)
        return np.where((into > 0) & (into < out), into, np.inf), self.normals[face]

    def hit_inside(self, origins, ways):
        """The same from inside, as of a room's walls."""
        _, out, _, face = self.crossings(origins, ways)
        return out, -self.normals[face]


def first_hit(origins, ways, solids, background):
    """The nearest of what the solids and `background(origins, ways)` say: distance and normal."""
    best, normal = background(origins, ways)
    for solid in solids:
        reach, its = solid.hit(origins, ways)
        nearer = reach < best
        best, normal = np.where(nearer, reach, best), np.where(nearer[:, None], its, normal)
    return best, normal


def gabled(center, length, width, eaves, ridge):
    """A house as a convex mesh: `center` in its floor, the ridge along x."""
    x, y = length / 2, width / 2
    corners = [(sx * x, sy * y, z) for z in (0, eaves) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    points = np.array(corners + [(-x, 0, ridge), (x, 0, ridge)], float) + center
    faces = [(0, 2, 1), (0, 3, 2), (0, 1, 5), (0, 5, 4), (2, 3, 7), (2, 7, 6), (1, 2, 6), (1, 6, 9), (1, 9, 5),
             (3, 0, 4), (3, 4, 8), (3, 8, 7), (4, 5, 9), (4, 9, 8), (6, 7, 8), (6, 8, 9)]
    return points, np.array(faces)


class Ground:
    """z = heights(x, y) over a rectangle, seen from above."""
    STEPS, HALVINGS = 160, 24

    def __init__(self, heights, low, high):
        self.heights, self.low, self.high = heights, np.asarray(low, float), np.asarray(high, float)
        x, y = (np.linspace(low[k], high[k], 300) for k in (0, 1))
        z = heights(*np.meshgrid(x, y))
        self.bottom, self.top = z.min() - 1, z.max() + 1

    def over(self, points):
        return points[:, 2] - self.heights(points[:, 0], points[:, 1])

    def hit(self, origins, ways):
        """Marches from the highest to the lowest level, then halves. Only of rays that go down."""
        begin = np.maximum((self.top - origins[:, 2]) / ways[:, 2], 0)
        step = ((self.bottom - origins[:, 2]) / ways[:, 2] - begin) / self.STEPS
        near, found = begin.copy(), np.zeros(len(ways), bool)
        for _ in range(self.STEPS):
            below = self.over(origins + (near + step)[:, None] * ways) <= 0
            found |= below
            near = np.where(found, near, near + step)
        far = near + step
        for _ in range(self.HALVINGS):
            middle = (near + far) / 2
            below = self.over(origins + middle[:, None] * ways) <= 0
            near, far = np.where(below, near, middle), np.where(below, middle, far)
        points = origins + far[:, None] * ways
        inside = ((points[:, :2] >= self.low) & (points[:, :2] <= self.high)).all(axis=1)
        return np.where(found & inside, far, np.inf), self.normals(points)

    def normals(self, points, step=0.01):
        x, y = points[:, 0], points[:, 1]
        slope_x = (self.heights(x + step, y) - self.heights(x - step, y)) / (2 * step)
        slope_y = (self.heights(x, y + step) - self.heights(x, y - step)) / (2 * step)
        up = np.stack([-slope_x, -slope_y, np.ones(len(x))], axis=1)
        return up / np.linalg.norm(up, axis=1)[:, None]

    def mesh(self, spacing):
        """The truth: a grid of triangles that look up."""
        x, y = (np.linspace(self.low[k], self.high[k], int((self.high - self.low)[k] / spacing) + 1) for k in (0, 1))
        x, y = np.meshgrid(x, y, indexing="ij")
        return grid_mesh(np.stack([x, y, self.heights(x, y)], axis=-1))
