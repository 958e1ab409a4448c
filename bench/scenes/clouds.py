"""Clouds with something wrong in them: outliers, copies, signs, units, noise. Most are of the knot, of genus 4."""
import numpy as np

import geometry
from judge import distances_to

KNOT = 40000


def knot(kit, count=KNOT, *words, **more):
    return kit.even("knot", count, *words, **more)


def outliers(share):
    def make(kit):
        positions, normals = knot(kit, round(KNOT / (1 - share)), outliers=share)
        good = near(kit, positions, 1e-3)
        return kit.cloud(positions, normals, "truth.ply", good=good, outward=normals)
    return make


def near(kit, positions, within):
    """Whether each sample lies on the truth: an outlier by chance does too, and is none then."""
    return distances_to(kit.folder / "truth.ply", positions, 0.05) < within


def flipped(share):
    """Single normals turned round by lot."""
    def make(kit):
        positions, normals = knot(kit)
        given = np.where(kit.rng.random(len(positions)) < share, -1, 1)[:, None] * normals
        return kit.cloud(positions, given, "truth.ply", outward=normals)
    return make


def flipped_patch(kit):
    """All normals beyond a plane look inward, as when two exports disagree."""
    positions, normals = knot(kit)
    given = np.where(positions[:, 0] > 0.15, -1, 1)[:, None] * normals
    return kit.cloud(positions, given, "truth.ply", outward=normals)


def copies(exact):
    """One scan merged from several exports: ten times the same, or six with other decimals."""
    def make(kit):
        positions, normals = knot(kit, 20000)
        positions = 100 + positions
        move_truth(kit, 1, np.full(3, 100.0))
        geometry.write_cloud(kit.folder / "one.ply", positions, normals)
        exports = [positions] * 10 if exact else [np.round(positions, d) for d in (4, 5, 6, 7)] + [
            positions.astype("f4").astype(float), positions + 3e-6]
        order = kit.rng.permutation(len(exports) * len(positions))
        merged = np.concatenate(exports)[order]
        normals = np.tile(normals, (len(exports), 1))[order]
        return kit.cloud(merged, normals, "truth.ply", outward=normals)
    return make


def move_truth(kit, scale, shift):
    vertices, triangles = geometry.read_mesh(kit.folder / "truth.ply")
    geometry.write_mesh(kit.folder / "truth.ply", (vertices * scale + shift, triangles))


def units(scale, shift):
    def make(kit):
        positions, normals = knot(kit, 20000)
        move_truth(kit, scale, np.array(shift))
        return kit.cloud(positions * scale + shift, normals, "truth.ply", outward=normals)
    return make


def weights(kit):
    """A second copy, grown by a few voxels, whose weights say not to trust it."""
    positions, normals = knot(kit, 30000)
    wrong = kit.rng.permutation(30000)[:5000]
    given = np.vstack([positions, positions[wrong] + 0.03 * normals[wrong]])
    outward = np.vstack([normals, normals[wrong]])
    weight = np.concatenate([kit.rng.uniform(0.6, 1, 30000), np.full(5000, 0.02)])
    return kit.cloud(given, outward, "truth.ply", weights=weight, good=np.arange(35000) < 30000, outward=outward)


def thick_noise(kit):
    """A map of very many samples: noise of four spacings, normals 11 degrees off."""
    positions, normals = knot(kit, 200000, "--noise", 0.012)
    given = normals + kit.rng.normal(0, 0.2, normals.shape)
    good = near(kit, positions, 0.03)
    return kit.cloud(positions, given / np.linalg.norm(given, axis=1)[:, None], "truth.ply", good=good, outward=normals)


def stereo(kit):
    """Errors of a stereo cloud: smooth over 8 spacings, in normals too, and 3 % mismatches along the normal."""
    positions, normals = knot(kit)
    spacing = 0.007
    waves = kit.rng.normal(size=(60, 3))
    waves *= (2 * np.pi / (8 * spacing) * kit.rng.uniform(0.5, 1.2, 60) / np.linalg.norm(waves, axis=1))[:, None]
    phases = positions @ waves.T + kit.rng.random(60) * 2 * np.pi
    error = 0.9 * spacing * np.cos(phases).sum(axis=1) / np.sqrt(30)
    slope = -0.9 * spacing * np.sin(phases) @ waves / np.sqrt(30)
    given = normals - 0.5 * (slope - normals * (slope * normals).sum(axis=1)[:, None])
    wrong = kit.rng.random(len(positions)) < 0.03
    error += kit.rng.normal(0, 0.3 * spacing, len(positions))
    error += np.where(wrong, spacing * kit.rng.uniform(2, 12, len(wrong)) * kit.rng.choice([-1, 1], len(wrong)), 0)
    return kit.cloud(positions + error[:, None] * normals, given / np.linalg.norm(given, axis=1)[:, None], "truth.ply",
                     good=~wrong, outward=normals)


def few(count):
    """On a spiral of equal areas around a ball of radius 1."""
    def make(kit):
        height = 1 - (2 * np.arange(count) + 1) / count
        angle = np.pi * (3 - np.sqrt(5)) * np.arange(count)
        level = np.sqrt(1 - height**2)
        positions = np.stack([level * np.cos(angle), level * np.sin(angle), height], axis=1)
        return kit.cloud(positions, positions, geometry.ball((0, 0, 0), 1, 64), outward=positions)
    return make


def bare(kit):
    positions, normals = knot(kit, 20000, "--noise", 0.002)
    return kit.bare(positions, 5, "truth.ply", outward=normals)


def zero_normals(kit):
    """The columns are there, but empty."""
    positions, normals = knot(kit, 20000)
    return kit.cloud(positions, 0 * normals, "truth.ply", outward=normals)


def ct_voxels(kit):
    """Integer coordinates of the border voxels of a segmented volume: a ball with three bores through its middle."""
    x, y, z = np.meshgrid(*[np.arange(-50, 51)] * 3, indexing="ij", sparse=True)
    solid = (x**2 + y**2 + z**2 < 45**2) & (np.minimum(np.minimum(x**2 + y**2, y**2 + z**2), x**2 + z**2) > 14**2)
    inner = solid.copy()
    for axis in range(3):
        inner &= np.roll(solid, 1, axis) & np.roll(solid, -1, axis)
    return kit.bare(np.argwhere(solid & ~inner).astype(float), 0)


def hopf(kit):
    """A tube around a three-lobed curve on a grid of 200 x 100 parameters: spacing up to 1:8, and no normals."""
    u, v = np.meshgrid(np.arange(200) * np.pi / 100, np.arange(100) * np.pi / 50, indexing="ij")
    polar, azimuth = np.pi / 2 - (np.pi / 2 - 0.44) * np.cos(3 * u), u + 0.44 * np.sin(6 * u)
    a, b, c = np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
    fiber = np.stack([1 + c, a, b], axis=-1) / np.sqrt(2 * (1 + c))[..., None]  # a point of the 3-sphere over (a, b, c)
    x, y, z, w = (np.cos(v) * fiber[..., 0], np.cos(v) * fiber[..., 1] + np.sin(v) * fiber[..., 2],
                  np.cos(v) * fiber[..., 2] - np.sin(v) * fiber[..., 1], np.sin(v) * fiber[..., 0])
    points = np.stack([x, y, z], axis=-1) / (1 - 0.97 * w)[..., None]           # nearly the stereographic projection
    return kit.bare(points.reshape(-1, 3), 5)


def lattice_part(kit):
    """A cube with a square hole, every face on the integers: nothing is ever between two voxels."""
    side, lo, hi = 60, 20, 40
    a, b = (m.ravel().astype(float) for m in np.meshgrid(np.arange(side + 1), np.arange(side + 1)))
    hole = (a > lo) & (a < hi) & (b > lo) & (b < hi)
    s, t = (m.ravel().astype(float) for m in np.meshgrid(np.arange(lo, hi + 1), np.arange(side + 1)))
    positions, normals = [], []

    def face(axis, at, sign, u, v):
        points, way = np.zeros((len(u), 3)), np.zeros(3)
        points[:, axis], points[:, (axis + 1) % 3], points[:, (axis + 2) % 3], way[axis] = at, u, v, sign
        positions.append(points)
        normals.append(np.broadcast_to(way, points.shape))

    for axis in range(3):
        keep = ~hole if axis == 2 else np.ones(len(a), bool)
        face(axis, 0, -1, a[keep], b[keep])
        face(axis, side, 1, a[keep], b[keep])
    face(0, lo, 1, s, t)
    face(0, hi, -1, s, t)
    face(1, lo, 1, t, s)
    face(1, hi, -1, t, s)
    positions, normals = np.concatenate(positions), np.concatenate(normals)
    return kit.cloud(positions, normals, outward=normals)
