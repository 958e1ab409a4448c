"""What the scenes' judge and verdicts say of meshes and results that are made up: test_judge.py"""
import sys
import unittest
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from geometry import ball, block, joined, rectangle, tube, turned
from judge import Judge, Surface, on_surface, topology, trimmed
from kit import Made


def welded(mesh):
    names, index = np.unique(mesh[0].round(9), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[mesh[1]]
    return names, triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]


class Judged(unittest.TestCase):
    rng = np.random.default_rng(1)

    def test_distances_are_those_to_the_triangles_whatever_their_size(self):
        plane = rectangle((0, 0, 0), (10, 0, 0), (0, 7, 0))
        points = self.rng.uniform((-2, -2, -2), (12, 9, 2), (500, 3))
        outside = np.maximum(0, np.maximum(-points[:, :2], points[:, :2] - (10, 7)))
        exact = np.sqrt((outside**2).sum(axis=1) + points[:, 2]**2)
        found, normal = Surface(*plane, 0.5).nearest(points)
        np.testing.assert_allclose(found, exact, atol=1e-9)
        self.assertTrue((normal[:, 2] > 0).all())

    def test_topology_counts_parts_borders_and_handles(self):
        a = np.arange(40) * np.pi / 20
        ring = tube(np.stack([3 * np.cos(a), 3 * np.sin(a), 0 * a], axis=1), 1, 16, closed=True)
        self.assertEqual(topology(ring[1]), (1, 0, 1))
        self.assertEqual(topology(welded(joined(ball((0, 0, 0), 1), ball((5, 0, 0), 1)))[1]), (2, 0, 0))
        self.assertEqual(topology(welded(block((0, 0, 0), (1, 1, 1), ("+z", "-z")))[1]), (1, 2, 0))
        self.assertEqual(topology(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]]))[2], None)

    def test_faces_of_makers_look_into_the_air(self):
        for mesh in (block((-1, -1, -1), (1, 1, 1)), ball((0, 0, 0), 1), tube([(0, 0, -1), (0, 0, 0), (0, 0, 1)], 1)):
            corners = mesh[0][mesh[1]]
            volume = np.einsum("ti,ti", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
            self.assertGreater(volume, 3)

    def test_what_is_not_there_is_lost_and_what_nobody_saw_invented(self):
        floor = rectangle((0, 0, 0), (40, 0, 0), (0, 40, 0))
        samples, _ = on_surface(*floor, 20000, self.rng)
        made = Made([], samples, outward=np.broadcast_to([0, 0, 1.0], samples.shape))
        judge = Judge(made, 1.0, truth=floor)
        half = rectangle((0, 0, 0), (20, 0, 0), (0, 40, 0))
        verdict = judge(*half)
        self.assertAlmostEqual(verdict.lost, 17 / 40, delta=0.01)
        self.assertEqual(verdict.invented, 0)
        verdict = judge(*joined(turned(floor), rectangle((0, 0, 9), (40, 0, 0), (0, 40, 0))))
        self.assertEqual((verdict.lost, verdict.wrong_side), (0, 1))
        self.assertAlmostEqual(verdict.invented, 0.5, delta=0.01)
        self.assertAlmostEqual(verdict.error, 0, delta=1e-9)

    def test_trimming_cuts_what_is_thin_but_loses_no_more_than_allowed(self):
        strips = joined(*[rectangle((x, 0, 0), (1, 0, 0), (0, 10, 0)) for x in range(40)])
        samples = strips[0][strips[0][:, 0] <= 20]
        judge = Judge(Made([], samples), 0.5)
        densities = np.repeat(np.arange(40, 0, -1.0), 4)  # falls along x; samples end at 20
        stays = trimmed(judge, *strips, densities, 0.0)
        end = strips[0][np.unique(stays)][:, 0].max()
        self.assertGreaterEqual(end, 18)
        self.assertLessEqual(end, 20)


if __name__ == "__main__":
    unittest.main()
