#!/usr/bin/env python3
"""terrain.py FILE.xyz: hills of 200 x 200 m as bare x y z lines, as many laser surveys are delivered."""
import math
import random
import sys


def height(x, y):
    return 8 * math.sin(x / 31) * math.cos(y / 27) + 3 * math.sin(x / 11 + 1) * math.sin(y / 13)


random.seed(1)
with open(sys.argv[1], "w", encoding="ascii") as file:
    for _ in range(40000):
        x, y = random.uniform(0, 200), random.uniform(0, 200)
        file.write(f"{x:.3f} {y:.3f} {height(x, y) + random.gauss(0, 0.05):.3f}\n")
