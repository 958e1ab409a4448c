"""Triangles of a mesh file cut into smaller ones on the same surface: colors at vertices then tell what is between."""
import numpy as np


def read_mesh(path):
    """(vertices, triangles) of a PLY as `soapfilm scan` writes truth.ply: binary, positions in float or double,
    triangles."""
    with open(path, "rb") as file:
        header = []
        while not header or header[-1] != "end_header":
            header.append(file.readline().decode("ascii").strip())
        counts = [int(line.split()[2]) for line in header if line.startswith("element ")]
        properties = [line for line in header if line.startswith("property ")]
        kinds = {kind: [*(f"property {kind} {n}" for n in "xyz"), "property list uchar int vertex_indices"]
                 for kind in ("float", "double")}
        if properties not in kinds.values():
            raise ValueError(f"{path}: properties {properties}, must be float or double x, y, z and triangles")
        kind = "<f4" if properties == kinds["float"] else "<f8"
        vertices = np.fromfile(file, kind, 3 * counts[0]).reshape(-1, 3).astype(float)
        faces = np.fromfile(file, np.dtype([("corners", "u1"), ("vertex", "<i4", 3)]), counts[1])
        return vertices, faces["vertex"].astype(np.int64)


def cut_once(vertices, triangles, longest):
    """Each triangle with a longer edge into two, by the middle of its longest: thin ones become less thin."""
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2)     # triangle x edge x end
    lengths = np.linalg.norm(vertices[edges[:, :, 0]] - vertices[edges[:, :, 1]], axis=2)
    long = lengths.max(axis=1) > longest
    which = lengths[long].argmax(axis=1)
    a, b, c = (np.take_along_axis(triangles[long], (which[:, None] + k) % 3, axis=1)[:, 0] for k in range(3))
    pairs, middle = np.unique(np.sort(np.stack([a, b], axis=1), axis=1), axis=0, return_inverse=True)
    middle = len(vertices) + middle.ravel()
    cut = [np.stack(corners, axis=1) for corners in ((a, middle, c), (middle, b, c))]
    vertices = np.concatenate([vertices, vertices[pairs].mean(axis=1)])
    return vertices, np.concatenate([triangles[~long], *cut]), long.any()


def finer(vertices, triangles, longest):
    """No edge is longer. Triangles beside one that is not cut keep an edge whole on which vertices lie then."""
    more = True
    while more:
        vertices, triangles, more = cut_once(vertices, triangles, longest)
    return vertices, triangles


def write(path, vertices, triangles):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}",
              *(f"property double {n}" for n in "xyz"), f"element face {len(triangles)}",
              "property list uchar int vertex_indices", "end_header", ""]
    faces = np.empty(len(triangles), np.dtype([("corners", "u1"), ("vertex", "<i4", 3)]))
    faces["corners"], faces["vertex"] = 3, triangles
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(vertices.astype("<f8").tobytes())
        file.write(faces.tobytes())


def write_finer(source, target, longest):
    write(target, *finer(*read_mesh(source), longest))
