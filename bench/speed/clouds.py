"""Virtual scans of a torus for the speed benchmark: samples x y z (float32), one sensor position for each scan.

    clouds.py FILE.ply SAMPLES RESOLUTION

No rays are cast: a sample is a random point of the surface that faces its scanner, moved by the scanner's noise. What
matters here is how many samples lie on how many voxels, and that they come row by row, as from a scanner."""
import math
import sys

import numpy

RADIUS, TUBE = 1.0, 0.4
AREA = 4 * math.pi**2 * RADIUS * TUBE
LONGEST = 2 * (RADIUS + TUBE)
PADDING = 6  # of soapfilm's grids
SCANS = 12
NOISE_VOX = 0.1


def voxel(resolution):
    """The voxel that `--resolution` gives."""
    return LONGEST / (resolution - 2 * PADDING)


def samples_for(resolution, per_voxel2):
    return round(per_voxel2 * AREA / voxel(resolution)**2)


def sensors():
    """Around the torus, in turn from above and from below."""
    angle = 2 * math.pi * numpy.arange(SCANS) / SCANS
    height = numpy.where(numpy.arange(SCANS) % 2 == 0, 2.5, -2.5)
    return numpy.stack([3 * numpy.cos(angle), 3 * numpy.sin(angle), height], axis=1)


def points_and_normals(count, random):
    """`count` points spread evenly by area."""
    u, v = 2 * math.pi * random.random((2, 2 * count))
    even = random.random(2 * count) * (RADIUS + TUBE) < RADIUS + TUBE * numpy.cos(v)
    u, v = u[even], v[even]
    normals = numpy.stack([numpy.cos(u) * numpy.cos(v), numpy.sin(u) * numpy.cos(v), numpy.sin(v)], axis=1)
    ring = numpy.stack([RADIUS * numpy.cos(u), RADIUS * numpy.sin(u), numpy.zeros_like(u)], axis=1)
    return ring + TUBE * normals, normals


def scan(sensor, count, noise, random):
    """`count` samples of the parts that face the sensor, row after row of its image."""
    kept, held = [], 0
    while held < count:
        points, normals = points_and_normals(count, random)
        towards = sensor - points
        facing = numpy.einsum("ij,ij->i", towards, normals) > 0
        kept.append(points[facing] + noise * random.standard_normal((facing.sum(), 1)) * normals[facing])
        held += len(kept[-1])
    points = numpy.concatenate(kept)[:count]
    side = numpy.cross([0, 0, 1], sensor)
    side /= numpy.linalg.norm(side)
    up = numpy.cross(sensor, side)
    up /= numpy.linalg.norm(up)
    pixel = math.sqrt(AREA / 2 / count)
    rows = numpy.floor(points @ up / pixel).astype(numpy.int32)
    return points[numpy.lexsort((points @ side, rows))].astype("<f4")


def write(path, samples, resolution):
    random = numpy.random.default_rng(1)
    counts = [samples * (k + 1) // SCANS - samples * k // SCANS for k in range(SCANS)]
    with open(path, "wb") as file:
        head = ["ply", "format binary_little_endian 1.0"]
        for sensor, count in zip(sensors(), counts):
            head += [f"obj_info scan_samples {count}", "comment sensor %.9g %.9g %.9g" % tuple(sensor)]
        head += [f"element vertex {samples}", *(f"property float {axis}" for axis in "xyz"), "end_header\n"]
        file.write("\n".join(head).encode())
        for sensor, count in zip(sensors(), counts):
            file.write(scan(sensor, count, NOISE_VOX * voxel(resolution), random).tobytes())


if __name__ == "__main__":
    write(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
