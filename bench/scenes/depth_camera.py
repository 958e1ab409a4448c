"""A depth camera in a furnished room, 320 x 240 pixels, its error growing with the square of the distance: posed
frames that overlap, and ten frames fused into one cloud near the first camera."""
import numpy as np

from geometry import block, joined, turned, write_cloud
from rays import Solid, first_hit

WIDTH, HEIGHT, FOCAL = 320, 240, 286.0  # pixels
NEAR, FAR = 0.5, 4.0                    # meters
NOISE, STEP = 0.0015, 0.0028            # 1/m, of the inverse distance: both grow with its square
ROOM = ((0, 0, 0), (4.6, 3.8, 2.5))
FURNITURE = (((0.2, 0.2, 0), (1.2, 0.7, 1.9)),
             ((1.9, 1.4, 0.68), (3.3, 2.2, 0.74)), ((2.1, 1.5, 0.74), (2.5, 1.8, 1.1)),
             ((1.95, 1.45, 0), (2.05, 1.55, 0.68)), ((3.15, 1.45, 0), (3.25, 1.55, 0.68)),
             ((1.95, 2.05, 0), (2.05, 2.15, 0.68)), ((3.15, 2.05, 0), (3.25, 2.15, 0.68)),
             ((3.7, 2.4, 0), (4.5, 3.7, 0.45)), ((4.25, 2.4, 0.45), (4.5, 3.7, 0.9)),
             ((2.5, 0.05, 0.9), (3.6, 0.3, 1.2)))


def solids():
    return Solid(block(*ROOM)), [Solid(block(*b)) for b in FURNITURE]


def truth():
    return joined(turned(block(*ROOM)), *(block(*b) for b in FURNITURE))


def looking(place, target):
    """Rows: the camera's axes x to the right, y down, z ahead."""
    ahead = np.subtract(target, place) / np.linalg.norm(np.subtract(target, place))
    right = np.cross(ahead, (0, 0, 1))
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def frame(place, target, rng, part=1.0):
    """Points that a camera measures and their true normals; `part`: the middle of the image, so much of each side."""
    walls, furniture = solids()
    u, v = np.meshgrid(*(np.arange(-part * side / 2, part * side / 2) for side in (WIDTH, HEIGHT)))
    pixel = np.stack([u.ravel() / FOCAL, v.ravel() / FOCAL, np.ones(u.size)], axis=1)
    ways = pixel @ looking(place, target)                      # a step of one along them is a depth of one
    origins = np.broadcast_to(np.asarray(place, float), ways.shape)
    depth, normals = first_hit(origins, ways, furniture, walls.hit_inside)
    facing = -(normals * ways).sum(axis=1) / np.linalg.norm(ways, axis=1)
    inverse = 1 / depth + rng.normal(0, NOISE, len(depth))
    measured = 1 / (np.round(inverse / STEP) * STEP)
    back = (measured > NEAR) & (measured < FAR) & (facing > 0.15) & (rng.random(len(depth)) > 0.02)
    return (origins + measured[:, None] * ways)[back], normals[back]


def walk(count):
    """A quarter around the table, all the time looking at it and at the wall behind it."""
    for a in np.linspace(0.3, 1.8, count):
        place = (2.5 + 1.9 * np.cos(a), 1.8 + 1.7 * np.sin(a), 1.4 + 0.15 * np.sin(3 * a))
        yield place, (2.4 - 0.6 * np.cos(a), 1.4 - 0.6 * np.sin(a), 0.9)


def frames(kit):
    """One PLY for each frame, the middle quarter of the image: there are many more samples than the noise is worth."""
    files, positions, outward, towards = [], [], [], []
    for place, target in walk(10):
        points, normals = frame(place, target, kit.rng, 0.5)
        files.append(f"frame_{len(files):02d}.ply")
        write_cloud(kit.folder / files[-1], points, comments=["sensor %.6f %.6f %.6f" % place])
        positions.append(points)
        outward.append(normals)
        towards.append(np.broadcast_to(place, points.shape))
    towards = np.concatenate(towards)
    made = kit.made(files, np.concatenate(positions), None, truth(), outward=np.concatenate(outward), towards=towards)
    made.sensors = towards
    return made


def fused(kit, cell=0.011):
    """Ten frames by a hand that turns, all within 20 cm of the first: what fell into one cell is one sample. As cameras
    have it: the first at the origin, y down, z ahead."""
    parts = []
    first = np.array((0.7, 2.9, 1.4))
    turn = looking(first, first + (0.93, -0.36, -0.1))
    for a in np.linspace(-0.65, 0.65, 10):
        place = first + kit.rng.uniform(-0.12, 0.12, 3)
        ahead = np.array([np.cos(a), np.sin(a), -0.12 + 0.1 * np.sin(5 * a)])
        points, normals = frame(place, place + ahead @ [(0.93, -0.36, 0), (0.36, 0.93, 0), (0, 0, 1)], kit.rng)
        parts.append((points, normals, np.broadcast_to(place, points.shape)))
    points, normals, places = (np.concatenate(p) for p in zip(*parts))
    _, of_cell, count = np.unique(np.floor(points / cell).astype(int), axis=0, return_inverse=True, return_counts=True)
    mean = lambda rows: np.stack([np.bincount(of_cell.ravel(), rows[:, k]) for k in range(3)], axis=1) / count[:, None]
    points, normals, places = ((mean(points) - first) @ turn.T, mean(normals) @ turn.T, (mean(places) - first) @ turn.T)
    known = count > 1                                          # a cell that one pixel alone saw is mostly an error
    vertices, triangles = truth()
    return points[known], normals[known], places[known], ((vertices - first) @ turn.T, triangles)


def fragment(kit):
    points, normals, places, surface = fused(kit)
    write_cloud(kit.folder / "input.ply", points, comments=["sensor 0 0 0"])
    made = kit.made(["input.ply"], points, None, surface, outward=normals, towards=places)
    made.sensors = np.zeros_like(points)
    return made


def fragment_bare(kit):
    """The same without the camera."""
    points, normals, places, surface = fused(kit)
    return kit.bare(points, 4, surface, outward=normals, towards=places)
