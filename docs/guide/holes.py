#!/usr/bin/env python3
"""holes.py FILE: a hollow ball of radius 1, scanned from outside but for three round gaps: .25, .5 and 1 wide."""
import math
import random
import sys

GAPS = [((1.0, -0.35, 0.15), 0.25), ((0.55, -0.8, 0.1), 0.5), ((-0.1, -0.7, 0.75), 1.0)]  # towards, width


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


random.seed(1)
with open(sys.argv[1], "w", encoding="utf-8") as out:
    for _ in range(60000):
        p = unit([random.gauss(0, 1) for _ in range(3)])
        hole = any(math.dist(p, unit(to)) < width / 2 for to, width in GAPS)
        if not hole:
            out.write("%.6f %.6f %.6f %.4f %.4f %.4f\n" % (*p, *p))
