"""Writes a ball of radius 1 whose samples are a thousand times denser at one pole than at the other: sparse.py FILE"""
import math
import random
import sys

rng = random.Random(1)
with open(sys.argv[1], "w", encoding="ascii") as file:
    count = 0
    while count < 60000:
        z, turn = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
        if rng.random() >= 10 ** (-1.5 * (1 - z)):
            continue
        r = math.sqrt(1 - z * z)
        file.write(f"{r * math.cos(turn):.6f} {r * math.sin(turn):.6f} {z:.6f} "
                   f"{r * math.cos(turn):.4f} {r * math.sin(turn):.4f} {z:.4f}\n")
        count += 1
