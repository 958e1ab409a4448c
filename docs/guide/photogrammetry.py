#!/usr/bin/env python3
"""photogrammetry.py FILE.ply: a dense cloud as photogrammetry makes it, of a vase on paving stones.

The columns of COLMAP's fused.ply: positions, normals and colors as floats and bytes. Positions and normals are noisy, few
points lie on a patch of the vase without texture, and some hang in the air around it.
"""
import math
import random
import struct
import sys

random.seed(1)
rows = []


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def add(position, normal, color, noise):
    """A point with an error along its normal, and a normal that is some ten degrees off."""
    error = random.gauss(0, noise)
    tilted = unit(tuple(n + random.gauss(0, 0.18) for n in normal))
    rows.append((*(p + error * n for p, n in zip(position, normal)), *tilted,
                 *(min(255, max(0, round(c + random.gauss(0, 12)))) for c in color)))


def radius(z, angle):
    """Of the vase, 1.2 m high, with ribs."""
    return 0.28 + 0.13 * math.sin(3.4 * z + 0.4) + 0.012 * math.cos(12 * angle)


while len(rows) < 45000:
    z, angle = random.uniform(0, 1.2), random.uniform(0, 2 * math.pi)
    r = radius(z, angle)
    if random.random() > r / 0.43:
        continue  # as many per area everywhere
    if 0.55 < z < 0.75 and math.cos(angle - 1) > 0.7 and random.random() < 0.9:
        continue  # a smooth, white patch
    step = 1e-4
    outward = (math.cos(angle), math.sin(angle), -(radius(z + step, angle) - r) / step)
    add((r * math.cos(angle), r * math.sin(angle), z), unit(outward), (190, 160 + 40 * math.sin(9 * z), 130), 0.002)
while len(rows) < 75000:
    x, y = random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4)
    joint = min(abs((x / 0.4) % 1 - 0.5), abs((y / 0.4) % 1 - 0.5)) < 0.04
    if math.hypot(x, y) > radius(0, math.atan2(y, x)):
        add((x, y, -0.01 if joint else 0.0), (0, 0, 1), (90, 95, 85) if joint else (150, 150, 145), 0.003)
for _ in range(1500):
    x, y, z = random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2), random.uniform(0.1, 1.8)
    add((x, y, z), unit((x, y, 0.3)), (200, 215, 235), 0)

with open(sys.argv[1], "wb") as file:
    names = [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    names += [f"property uchar {name}" for name in ("red", "green", "blue")]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}", *names, "end_header"]
    file.write(("\n".join(head) + "\n").encode())
    for row in rows:
        file.write(struct.pack("<6f3B", *row))
