"""One sweep of a spinning scanner on a car, out to 100 m: rings are even in elevation, so that far ones lie many meters
apart on the ground while samples along a ring are decimeters apart. Cars, house fronts and posts stand about."""
import numpy as np

from geometry import block, grid_mesh, joined, tube, write_cloud
from writers import write_sweep

FAR = 100.0        # meters
MOUNTED = 1.73     # above the ground
FRONTS = ((12, 17, -40, -22), (13, 18, -12, 9), (12, 19, 20, 50), (-19, -13, -60, -30), (-18, -12.5, -5, 14),
          (-20, -14, 30, 62))                                  # of houses: x from and to, y from and to
CARS = ((3.2, 9), (-3.4, 14), (3.1, -12), (7.5, 21), (-7.6, -16), (3.3, 33), (-3.2, -31), (-7.4, 45), (3.4, 58),
        (7.2, -47), (-3.3, 74))                                # along y
TREES = ((10.5, 2), (-10.5, 8), (10.5, 22), (-10.5, -9), (10.5, -18), (-10.5, 40), (10.5, 66), (-11, -52), (10.8, -36))
POSTS = ((9.5, -3), (9.5, 15), (-9.5, 24), (9.5, 34), (-9.5, -24), (9.5, 53))


def things(heights):
    """All that stands on the ground, each at its height."""
    parts = []
    for x0, x1, y0, y1 in FRONTS:
        z = heights(np.array([x0, x1, x0, x1]), np.array([y0, y0, y1, y1]))
        parts.append(block((x0, y0, z.min() - 0.5), (x1, y1, z.max() + 6.5), ("-z",)))
    for x, y in CARS:
        z = float(heights(np.array([x]), np.array([y]))[0])
        parts += [block((x - 0.9, y - 2.2, z - 0.3), (x + 0.9, y + 2.2, z + 0.85), ("-z",)),
                  block((x - 0.75, y - 1.4, z + 0.85), (x + 0.75, y + 1.1, z + 1.45), ("-z",))]
    for x, y in POSTS:
        z = float(heights(np.array([x]), np.array([y]))[0])
        parts.append(tube([(x, y, z - 0.3), (x, y, z + 3), (x, y, z + 6)], 0.12, 16))
    return joined(*parts)


def tree(foot, rng, leaves=500):
    """A trunk, and leaves through which rays pass, all turned to the scanner at the origin."""
    middle = np.add(foot, (0, 0, 4.4))
    at = rng.normal(size=(leaves, 3))
    at = middle + at / np.linalg.norm(at, axis=1)[:, None] * rng.random((leaves, 1))**(1 / 3) * (1.7, 1.7, 2.3)
    ways = -at / np.linalg.norm(at, axis=1)[:, None] + rng.normal(0, 0.4, at.shape)
    side = np.cross(ways, rng.normal(size=at.shape))
    side *= 0.16 / np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(ways, side)
    up *= 0.16 / np.linalg.norm(up, axis=1)[:, None]
    corners = np.stack([at - side - up, at + side - up, at + side + up, at - side + up], axis=1)
    first = 4 * np.arange(leaves)[:, None, None]
    crown = corners.reshape(-1, 3), (first + [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)
    return joined(tube([np.subtract(foot, (0, 0, 0.3)), np.add(foot, (0, 0, 1.5)), middle], 0.15, 12), crown)


def swept(kit, heights, rings, around, trees=()):
    """`heights(x, y)`: the ground, as high as it likes at the origin; the scanner stands there."""
    at_zero = float(heights(np.zeros(1), np.zeros(1))[0]) + MOUNTED
    lowered = lambda x, y: heights(x, y) - at_zero
    x, y = np.meshgrid(np.linspace(-110, 110, 441), np.linspace(-110, 110, 441), indexing="ij")
    ground = grid_mesh(np.stack([x, y, lowered(x, y)], axis=-1))
    grown = [tree((x, y, float(lowered(np.array([x]), np.array([y]))[0])), kit.rng) for x, y in trees]
    made = kit.scan("place.ply", "--rays", "spinning", "--position=0,0,0",
                    "--rings=" + ",".join(f"{e:.4g}" for e in rings), "--image", f"{around}x1", "--max-range", FAR,
                    "--noise", 0.015, "--drop-out", 0.03, "--max-incidence", 89.2, "--mixed-pixels", 0.2,
                    mesh=joined(ground, things(lowered), *grown))
    made.sensors = np.zeros_like(made.positions)
    return made


def robot(kit):
    """16 rings, 2 degrees apart, on a flat yard with waves of a few centimeters."""
    made = swept(kit, lambda x, y: 0.03 * np.sin(x / 3) * np.cos(y / 4), np.linspace(15, -15, 16), 1800)
    return posed(kit, made)


def uphill(kit):
    """64 rings, those above 8 degrees below the horizon closer than the others, on a road that climbs by 8 %."""
    rings = np.concatenate([np.linspace(2, -8.33, 32), np.linspace(-8.83, -24.33, 32)])
    made = swept(kit, lambda x, y: 0.08 * y + 0.03 * x + 0.04 * np.sin(x / 5 + y / 7), rings, 2000,
                 TREES)
    made.positions, made.inputs = write_sweep(kit.folder / "input.bin", np.round(made.positions, 3)), ["input.bin"]
    return made


def hollow(kit):
    """128 rings where the ground rolls: a hollow before the car, a crest behind it, a bank on both sides."""
    def heights(x, y):
        return 2.5 * np.sin(y / 24 + 2.6) + 0.0022 * x**2 * (1 + 0.3 * np.sin(y / 17)) + 0.03 * np.sin(x + y / 2)
    return posed(kit, swept(kit, heights, np.linspace(22.5, -22.5, 128), 1024, TREES))


def posed(kit, made):
    """One PLY that says where the scanner stood."""
    write_cloud(kit.folder / "input.ply", made.positions, comments=["sensor 0 0 0"])
    made.inputs = ["input.ply"]
    return made
