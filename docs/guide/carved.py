"""Writes a stone with carved waves on a floor of 40 m, 1.5 m before the origin, for `soapfilm scan`: carved.py FILE.obj"""
import math
import sys

WAVE, SIDE, STEPS = 0.1, 1.2, 180  # meters; squares along each side of the carved face
vertices, faces = [], []


def quad(a, b, c, d):
    faces.append((a, b, c))
    faces.append((a, c, d))


def rectangle(*corners):
    first = len(vertices) + 1
    vertices.extend(corners)
    quad(first, first + 1, first + 2, first + 3)


rectangle((-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0))
x, near, far = SIDE / 2, 1.55, 1.9
rectangle((-x, near, 0), (-x, near, SIDE), (-x, far, SIDE), (-x, far, 0))
rectangle((x, near, 0), (x, far, 0), (x, far, SIDE), (x, near, SIDE))
rectangle((-x, near, SIDE), (x, near, SIDE), (x, far, SIDE), (-x, far, SIDE))
rectangle((-x, far, 0), (-x, far, SIDE), (x, far, SIDE), (x, far, 0))
first = len(vertices) + 1
for i in range(STEPS + 1):
    for k in range(STEPS + 1):
        u, v = SIDE * i / STEPS, SIDE * k / STEPS
        waves = WAVE / 8 * math.sin(2 * math.pi * u / WAVE) * math.sin(2 * math.pi * v / WAVE)
        vertices.append((u - x, 1.5 - waves, v))
for i in range(STEPS):
    for k in range(STEPS):
        at = first + i * (STEPS + 1) + k
        quad(at, at + STEPS + 1, at + STEPS + 2, at + 1)

with open(sys.argv[1], "w", encoding="ascii") as file:
    for p in vertices:
        file.write("v %.6g %.6g %.6g\n" % p)
    for f in faces:
        file.write("f %d %d %d\n" % f)
