"""Meshes of scenes, samples on them, and the files that the programs read. Meshes are pairs (vertices, triangles); the
air is where a triangle's corners run counter-clockwise."""
import numpy as np


def joined(*meshes):
    """Several meshes as one."""
    starts = np.cumsum([0] + [len(v) for v, _ in meshes[:-1]])
    return np.concatenate([v for v, _ in meshes]), np.concatenate([t + s for (_, t), s in zip(meshes, starts)])


def turned(mesh):
    return mesh[0], mesh[1][:, ::-1]


def grid_mesh(points, closed_u=False, closed_v=False):
    """Over an array of points (rows u, columns v, 3); du x dv points into the air."""
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    if closed_u:
        index = np.vstack([index, index[:1]])
    if closed_v:
        index = np.hstack([index, index[:, :1]])
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    cells = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return points.reshape(-1, 3), cells


def rectangle(corner, u, v):
    corner, u, v = (np.asarray(w, float) for w in (corner, u, v))
    return np.stack([corner, corner + u, corner + u + v, corner + v]), np.array([[0, 1, 2], [0, 2, 3]])


def block(lo, hi, without=()):
    """A box; `without` names sides that are left out, such as "-z"."""
    lo, hi = np.asarray(lo, float), np.asarray(hi, float)
    sides = []
    for axis in range(3):
        u, v = np.zeros(3), np.zeros(3)
        u[(axis + 1) % 3], v[(axis + 2) % 3] = (hi - lo)[(axis + 1) % 3], (hi - lo)[(axis + 2) % 3]
        far = lo.copy()
        far[axis] = hi[axis]
        sides += [] if "-+"[0] + "xyz"[axis] in without else [rectangle(lo, v, u)]
        sides += [] if "-+"[1] + "xyz"[axis] in without else [rectangle(far, u, v)]
    return joined(*sides)


def frames(path, closed):
    """Two unit vectors square to the path at each of its points, turning as little as they can."""
    ways = np.roll(path, -1, 0) - np.roll(path, 1, 0) if closed else np.gradient(path, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    side = np.eye(3)[np.argmin(np.abs(ways[0]))]
    sides = []
    for way in ways:
        side = side - way * (side @ way)
        side = side / np.linalg.norm(side)
        sides.append(side)
    sides = np.array(sides)
    return sides, np.cross(ways, sides)


def tube(path, radius, facets=24, closed=False):
    """Round, along a path of points; with flat ends unless it is closed."""
    path = np.asarray(path, float)
    a, b = frames(path, closed)
    angles = np.arange(facets) * 2 * np.pi / facets
    rim = np.cos(angles)[None, :, None] * a[:, None] + np.sin(angles)[None, :, None] * b[:, None]
    side = turned(grid_mesh(path[:, None] + radius * rim, closed_u=closed, closed_v=True))
    if closed:
        return side
    first, last = side[0][:facets], side[0][-facets:]
    ring = np.arange(facets)
    fan = np.stack([np.full(facets, facets), ring, np.roll(ring, -1)], axis=1)
    return joined(side, turned((np.vstack([first, path[:1]]), fan)), (np.vstack([last, path[-1:]]), fan))


def ball(center, radius, n=24):
    theta, phi = np.linspace(0, np.pi, n + 1), np.arange(2 * n) * np.pi / n
    t, p = np.meshgrid(theta, phi, indexing="ij")
    points = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
    return grid_mesh(np.asarray(center, float) + radius * points, closed_v=True)


def face_normals(mesh):
    """Unit normals and areas."""
    v, t = mesh
    square = np.cross(v[t[:, 1]] - v[t[:, 0]], v[t[:, 2]] - v[t[:, 0]])
    length = np.linalg.norm(square, axis=1)
    return square / np.maximum(length, 1e-300)[:, None], length / 2


def area(mesh):
    return face_normals(mesh)[1].sum()


def sample(mesh, count, rng):
    """Independent points, even by area, with their face's normal."""
    v, t = mesh
    normals, areas = face_normals(mesh)
    face = rng.choice(len(t), count, p=areas / areas.sum())
    r, s = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    a, b, c = (v[t[face, k]] for k in range(3))
    return (1 - r) * a + r * (1 - s) * b + r * s * c, normals[face]


def write_cloud(path, positions, normals=None, sensor=None, weights=None, comments=()):
    """A binary PLY as soapfilm reads it; `sensor` is one position or one for each sample."""
    columns = [("x y z", positions)]
    if normals is not None:
        columns.append(("nx ny nz", normals))
    if sensor is not None:
        columns.append(("sensor_x sensor_y sensor_z", np.broadcast_to(sensor, positions.shape)))
    if weights is not None:
        columns.append(("weight", weights[:, None]))
    names = " ".join(n for n, _ in columns).split()
    header = ["ply", "format binary_little_endian 1.0", *(f"comment {c}" for c in comments),
              f"element vertex {len(positions)}", *(f"property double {n}" for n in names), "end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(np.hstack([np.asarray(c, "<f8") for _, c in columns]).astype("<f8").tobytes())


def write_mesh(path, mesh):
    vertices, triangles = mesh
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
              *(f"property double {n}" for n in "xyz"), f"element face {len(triangles)}",
              "property list uchar int vertex_indices", "end_header", ""]
    rows = np.zeros(len(triangles), [("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, triangles
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(np.asarray(vertices, "<f8").tobytes() + rows.tobytes())


def read_mesh(path):
    """A binary PLY of triangles as soapfilm and write_mesh() write it."""
    sizes = {"uchar": "u1", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}
    counts, layout = {}, {"vertex": []}
    with open(path, "rb") as file:
        while (line := file.readline().decode("ascii").strip()) != "end_header":
            words = line.split()
            if words[0] == "element":
                element, counts[words[1]] = words[1], int(words[2])
            elif words[0] == "property" and element == "vertex":
                layout["vertex"].append((words[2], sizes[words[1]]))
        vertices = np.fromfile(file, np.dtype(layout["vertex"]), counts["vertex"])
        faces = np.fromfile(file, np.dtype([("count", "u1"), ("corners", "<i4", 3)]), counts["face"])
    if len(faces) != counts["face"] or (faces["count"] != 3).any():
        raise ValueError(f"{path}: not a mesh of triangles alone")
    return np.stack([vertices[k].astype(float) for k in "xyz"], axis=1), faces["corners"].astype(np.int64)
