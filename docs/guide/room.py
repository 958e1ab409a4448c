#!/usr/bin/env python3
"""room.py FILE.ply: a room of 5 x 4 x 2.5 m with a table block, scanned from two places inside of it.

Each sample has the position of its scanner in the columns sensor_x, sensor_y, sensor_z: a model for writing your own.
"""
import math
import random
import sys

ROOM = ((0, 0, 0), (5, 4, 2.5))
BLOCK = ((2, 1.5, 0), (3.2, 2.3, 0.8))  # stands on the floor
SCANNERS = ((1, 1, 1.4), (4, 3, 1.6))


def hit(origin, ray):
    """The distance at which a ray meets the block from outside, or else the room's walls from inside."""
    def slabs(box):
        near, far = -math.inf, math.inf
        for low, high, o, d in zip(*box, origin, ray):
            if abs(d) < 1e-12:
                d = 1e-12
            a, b = sorted(((low - o) / d, (high - o) / d))
            near, far = max(near, a), min(far, b)
        return near, far
    near, far = slabs(BLOCK)
    return near if 0 < near < far else slabs(ROOM)[1]


random.seed(1)
rows = []
for scanner in SCANNERS:
    for i in range(200):  # rings, from straight down to straight up
        for k in range(400):
            up, around = math.pi * (i + 0.5) / 200 - math.pi / 2, 2 * math.pi * k / 400
            ray = (math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up))
            distance = hit(scanner, ray) + random.gauss(0, 0.003)
            point = [o + distance * d for o, d in zip(scanner, ray)]
            rows.append(" ".join(f"{v:.4f}" for v in (*point, *scanner)))

with open(sys.argv[1], "w", encoding="ascii") as file:
    file.write(f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n")
    for name in ("x", "y", "z", "sensor_x", "sensor_y", "sensor_z"):
        file.write(f"property float {name}\n")
    file.write("end_header\n" + "\n".join(rows) + "\n")
