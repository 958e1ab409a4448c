"""Thin, long and open things, sampled evenly unless it says otherwise, with true normals unless it says otherwise."""
import numpy as np

from geometry import area, block, grid_mesh, joined, rectangle, sample, tube, turned


def sampled(kit, mesh, spacing, noise, keep=None):
    """One sample for each spacing^2 of a mesh."""
    positions, normals = sample(mesh, int(area(mesh) / spacing**2), kit.rng)
    if keep is not None:
        chosen = keep(positions)
        positions, normals = positions[chosen], normals[chosen]
    noisy = positions + normals * kit.rng.normal(0, noise, len(positions))[:, None]
    return kit.cloud(noisy, normals, mesh, outward=normals)


def bent_sheet(thickness, radius=80.0, length=200.0, width=120.0):
    """A visor: both sides, four edges."""
    a, y = np.meshgrid(np.linspace(-0.5, 0.5, 90) * length / radius, np.linspace(0, width, 2), indexing="ij")
    way = np.stack([np.sin(a), 0 * a, np.cos(a)], axis=-1)
    along = np.stack([0 * a, y, 0 * a], axis=-1)
    top, bottom = way * (radius + thickness / 2) + along, way * (radius - thickness / 2) + along
    return joined(grid_mesh(top), turned(grid_mesh(bottom)), *(edge(top, bottom, k) for k in (0, -1)),
                  *(end(top, bottom, k) for k in (0, -1)))


def edge(top, bottom, side):
    strip = grid_mesh(np.stack([top[:, side], bottom[:, side]], axis=1))
    return turned(strip) if side == 0 else strip


def end(top, bottom, side):
    strip = grid_mesh(np.stack([top[side], bottom[side]], axis=1))
    return strip if side == 0 else turned(strip)


def sheet(thickness):
    """Thickness in spacings of the samples on each side."""
    def make(kit):
        mesh = bent_sheet(thickness)
        sides = lambda p: abs(np.hypot(p[:, 0], p[:, 2]) - 80) > 0.4 * thickness  # the edges have no samples
        return sampled(kit, mesh, 1.0, 0.1, sides)
    return make


def blade(kit):
    """5 spacings thick at one edge, 0.6 at the other, twisted by 30 degrees."""
    u, z = np.linspace(0, 1, 50), np.linspace(0, 160, 90)
    half = (5 - 4.4 * u) / 2
    outline = np.concatenate([np.stack([90 * u, half], axis=1), np.stack([90 * u, -half], axis=1)[::-1]])
    a = np.radians(30) * z / 160
    turn = np.stack([np.stack([np.cos(a), -np.sin(a)], axis=1), np.stack([np.sin(a), np.cos(a)], axis=1)], axis=1)
    flat = np.einsum("kij,nj->kni", turn, outline)
    points = np.concatenate([flat, np.broadcast_to(z[:, None, None], (*flat.shape[:2], 1))], axis=2)
    side = grid_mesh(points, closed_v=True)
    n = len(u)
    lids = [grid_mesh(np.stack([points[k, :n], points[k, :n - 1:-1]], axis=1)) for k in (0, -1)]
    return sampled(kit, joined(side, lids[0], turned(lids[1])), 1.0, 0.05)


def fence(kit):
    """Bars three spacings thick, two rails, and three cables of two before it."""
    bars = [tube([(x, 0, z) for z in np.linspace(0, 100, 9)], 1.5, 16) for x in range(0, 200, 20)]
    rails = [tube([(x, 3.2, z) for x in np.linspace(-5, 185, 9)], 1.5, 16) for z in (15, 85)]
    cables = [tube([(x, -20 - 12 * k, 100 + 8 * k + 20 * ((x - 90) / 95)**2) for x in np.linspace(-5, 185, 60)], 1, 16)
              for k in range(3)]
    return sampled(kit, joined(*bars, *rails, *cables), 1.0, 0.1)


def garden_wall(kit):
    """100 m long, 2 m high, 0.2 m thick, both sides; its foot is not seen."""
    wall = block((0, -0.1, 0), (100, 0.1, 2), ("-z",))
    positions, normals = sample(wall, int(area(wall) / 0.035**2), kit.rng)
    noisy = positions + normals * kit.rng.normal(0, 0.004, len(positions))[:, None]
    return kit.cloud(noisy, normals, wall, outward=normals)


def uneven_wall(kit):
    """A wall 24 m long, both sides, sampled 100 times as densely at one end as at the other."""
    wall = block((0, -0.15, 0), (24, 0.15, 2.5), ("-z",))
    positions, normals = sample(wall, 400000, kit.rng)
    keep = kit.rng.random(len(positions)) < 100.0**(-positions[:, 0] / 24)
    positions, normals = positions[keep], normals[keep]
    noisy = positions + normals * kit.rng.normal(0, 0.003, len(positions))[:, None]
    return kit.cloud(noisy, normals, wall, outward=normals)


def flange(kit):
    """The upper side of a ring with 24 pockets and two circles of bolt holes: nearly all normals are vertical."""
    n = 90000
    r, a = np.sqrt(kit.rng.uniform(60**2, 100**2, n)), kit.rng.uniform(0, 2 * np.pi, n)
    z = np.where((np.cos(24 * a) > 0.5) & (abs(r - 80) < 8), -3.0, 0.0)
    keep = np.ones(n, bool)
    for circle in (66, 94):
        beside = np.abs((a * 30 / np.pi + 0.5) % 1 - 0.5) * 2 * np.pi * circle / 60
        keep &= np.hypot(beside, r - circle) > 1.5
    positions = np.stack([r * np.cos(a), r * np.sin(a), z + kit.rng.normal(0, 0.03, n)], axis=1)[keep]
    normals = np.broadcast_to([0, 0, 1.0], positions.shape)
    return kit.cloud(positions, normals, outward=normals)


def tin(kit):
    """The side of a cylinder, open at both ends, bare points."""
    n = 20000
    a, z = kit.rng.uniform(0, 2 * np.pi, n), kit.rng.uniform(0, 100, n)
    outward = np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
    positions = 30 * outward + np.stack([0 * a, 0 * a, z], axis=1)
    rim = np.linspace(0, 2 * np.pi, 128, endpoint=False)
    u, v = np.meshgrid(rim, [0.0, 100.0], indexing="ij")
    side = grid_mesh(np.stack([30 * np.cos(u), 30 * np.sin(u), v], axis=-1), closed_u=True)
    return kit.bare(positions + outward * kit.rng.normal(0, 0.1, n)[:, None], 3, side, outward=outward)


def falloff(kit):
    """The yard's floor and house front, density falling with the square of the distance, some 300 to 1 from 1.2 to
    12 m and more beyond; true normals."""
    r, a = 1.2 * (17 / 1.2)**kit.rng.random(160000), kit.rng.random(160000) * 2 * np.pi
    floor = np.stack([r * np.cos(a), r * np.sin(a), 0 * r], axis=1)
    floor = floor[np.abs(floor).max(axis=1) < 12]
    front, _ = sample(rectangle((-6, 12, 0), (12, 0, 0), (0, 0, 4)), 6000, kit.rng)
    outward = np.concatenate([np.broadcast_to([0, 0, 1.0], floor.shape), np.broadcast_to([0, -1.0, 0], front.shape)])
    positions = np.concatenate([floor, front])
    noisy = positions + outward * kit.rng.normal(0, 0.003, len(positions))[:, None]
    truth = joined(rectangle((-12, -12, 0), (24, 0, 0), (0, 24, 0)), rectangle((-6, 12, 0), (12, 0, 0), (0, 0, 4)))
    return kit.cloud(noisy, outward, truth, outward=outward)
