#!/usr/bin/env python3
"""survey.py FILE.las TRAJECTORY.txt: hills as an airborne laser survey delivers them, as LAS 1.2 in a national grid.

Points have GPS times, intensities, classes and colors; the trajectory has the lines `time x y z` of the aircraft.
"""
import math
import random
import struct
import sys

EAST, NORTH = 691_000, 5_334_000
FLIGHT, SPEED = 600.0, 50.0  # meters above the ground, meters per second


def height(x, y):
    return 520 + 8 * math.sin(x / 31) * math.cos(y / 27) + 3 * math.sin(x / 11 + 1) * math.sin(y / 13)


random.seed(1)
rows, way = [], []
for strip in range(2):  # two strips of 200 m, side by side and overlapping
    center = 60 + 80 * strip
    for k in range(20000):
        along, across = 200 * k / 20000, random.uniform(-60, 60)
        x, y, time = center + across, along, 1000 + 100 * strip + along / SPEED
        z = height(x, y) + random.gauss(0, 0.03)
        rows.append((x, y, z, time))
    for along in range(-50, 251, 10):
        way.append((1000 + 100 * strip + along / SPEED, EAST + center, NORTH + along, 520 + FLIGHT))

SCALE = 0.001
low = [min(r[i] for r in rows) + o for i, o in enumerate((EAST, NORTH, 0))]
high = [max(r[i] for r in rows) + o for i, o in enumerate((EAST, NORTH, 0))]
# One record says the coordinate system: GeoTIFF keys, ETRS89 / UTM zone 32N.
keys = struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 25832)
record = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 34735, len(keys), b"GeoKeyDirectoryTag") + keys
with open(sys.argv[1], "wb") as file:
    file.write(struct.pack("<4sHH16sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, bytes(16), 1, 2, b"survey.py", b"survey.py", 1,
                           2026, 227, 227 + len(record), 1, 3, 34, len(rows), len(rows), 0, 0, 0, 0))
    file.write(struct.pack("<6d", SCALE, SCALE, SCALE, EAST, NORTH, 0))
    file.write(struct.pack("<6d", high[0], low[0], high[1], low[1], high[2], low[2]) + record)
    for x, y, z, time in rows:
        green = int(min(max(128 + 6 * (z - 520), 0), 255)) * 257
        file.write(struct.pack("<3iHBBbBHd3H", round(x / SCALE), round(y / SCALE), round(z / SCALE), 900, 0b1001, 2, 0, 0,
                               1, time, 20000, green, 15000))
with open(sys.argv[2], "w", encoding="ascii") as file:
    for row in way:
        file.write("%.3f %.2f %.2f %.2f\n" % row)
