#!/usr/bin/env python3
"""stockpile.py MAY.xyz JUNE.xyz: a yard of 60 x 60 m, scanned twice. In May there is one heap; by June a part of it has been
taken away and a second one stands there. Prints the true volumes. z = 100 is the paved ground.
"""
import math
import random
import sys

SIDE = 60.0


def cone(x, y, cx, cy, height, radius):
    return max(0.0, height * (1 - math.hypot(x - cx, y - cy) / radius))


def may(x, y):
    return 100 + cone(x, y, 22, 30, 6, 14)


def june(x, y):
    rest = min(cone(x, y, 22, 30, 6, 14), max(0.0, 0.9 * (26 - x)))  # an excavator came from the right
    return 100 + max(rest, cone(x, y, 45, 40, 4, 9))


def between(upper, lower, cells=400):
    """The volume above `lower` and below `upper`."""
    step = SIDE / cells
    places = [(i + 0.5) * step for i in range(cells)]
    return sum(max(0.0, upper(x, y) - lower(x, y)) for x in places for y in places) * step * step


random.seed(1)
for path, height in zip(sys.argv[1:3], (may, june)):
    with open(path, "w", encoding="ascii") as file:
        for _ in range(60000):
            x, y = random.uniform(0, SIDE), random.uniform(0, SIDE)
            file.write("%.3f %.3f %.3f\n" % (x, y, height(x, y) + random.gauss(0, 0.02)))
print("heaps in May %.1f, in June %.1f; added %.1f, taken away %.1f" % (
    between(may, lambda x, y: 100), between(june, lambda x, y: 100), between(june, may), between(may, june)))
