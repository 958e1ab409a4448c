#!/usr/bin/env python3
"""depth.py FOLDER: three frames of a depth camera around a closed tin, as PCD files of 240 x 180 pixels.

Points are in one frame for all, each by its frame's pose; VIEWPOINT says where the camera was. Pixels without a depth
are `nan`, as drivers write them.
"""
import math
import os
import random
import sys

WIDTH, HEIGHT, FOCAL = 240, 180, 220.0
RADIUS, TALL = 0.06, 0.12  # of the body, meters
DISTANCE = 0.5


def hit(origin, ray):
    """Where a ray meets a closed cylinder on the z axis; None if it does not."""
    best = math.inf
    a = ray[0] ** 2 + ray[1] ** 2
    b = origin[0] * ray[0] + origin[1] * ray[1]
    c = origin[0] ** 2 + origin[1] ** 2 - RADIUS ** 2
    if b * b > a * c > 0:
        t = (-b - math.sqrt(b * b - a * c)) / a
        if abs(origin[2] + t * ray[2]) <= TALL / 2:
            best = t
    for lid in (-TALL / 2, TALL / 2):
        t = (lid - origin[2]) / ray[2] if ray[2] else math.inf
        if 0 < t < best and (origin[0] + t * ray[0]) ** 2 + (origin[1] + t * ray[1]) ** 2 <= RADIUS ** 2:
            best = t
    return best if best < math.inf else None


random.seed(1)
os.makedirs(sys.argv[1], exist_ok=True)
for frame, (turn, up) in enumerate(((0, 30), (120, -30), (240, 30))):
    turn, up = math.radians(turn), math.radians(up)
    back = (math.cos(up) * math.cos(turn), math.cos(up) * math.sin(turn), math.sin(up))
    right = (-math.sin(turn), math.cos(turn), 0.0)
    # The camera looks along its z axis, x to the right, y down: the columns of its rotation.
    ahead = tuple(-v for v in back)
    down = tuple(ahead[(i + 1) % 3] * right[(i + 2) % 3] - ahead[(i + 2) % 3] * right[(i + 1) % 3] for i in range(3))
    place = tuple(DISTANCE * v for v in back)
    rows = []
    for v in range(HEIGHT):
        for u in range(WIDTH):
            x, y = (u - WIDTH / 2) / FOCAL, (v - HEIGHT / 2) / FOCAL
            ray = tuple(x * right[i] + y * down[i] + ahead[i] for i in range(3))
            depth = hit(place, ray)
            if depth is None:
                rows.append("nan nan nan")
            else:
                depth += random.gauss(0, 0.0007)
                rows.append(" ".join(f"{place[i] + depth * ray[i]:.5f}" for i in range(3)))
    with open(f"{sys.argv[1]}/frame{frame}.pcd", "w", encoding="ascii") as file:
        file.write("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                   f"WIDTH {WIDTH}\nHEIGHT {HEIGHT}\nVIEWPOINT {' '.join(f'{n:.6f}' for n in place)} 1 0 0 0\n"
                   f"POINTS {WIDTH * HEIGHT}\nDATA ascii\n" + "\n".join(rows) + "\n")
