"""What the scenes' judge and verdicts say of meshes and results that are made up: test_scenes.py [PROGRAMS]

With the folder of the built programs a few scenes are made, too. ctest runs it where bench/ is built."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parent.parent)]

import verdicts
from catalog import SCENES
from geometry import ball, block, joined, read_mesh, rectangle, tube, turned, write_mesh
from judge import Judge, Surface, Verdict, on_surface, topology, trimmed
from kit import Kit, Made
from page import failing
from test_open import Files, Generators, Rays, RealFiles, Sides, welded  # unittest runs what it finds here
from trial import Entry, Result
from verdicts import MET, MISSED


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


def result(name, ours=None, peer=None, cut=None, **known):
    """Of a scene of the catalog; verdicts by what differs from a faultless one."""
    scene = next(s for s in SCENES if s.name == name)

    def entry(changed):
        right = {"lost": 0, "p95": 0, "invented": 0, "wrong_side": 0, "area": 1, "genus": scene.genus or 0,
                 "components": scene.components or 1}
        return Entry(Verdict(**right | changed)) if changed is not None else Entry(failure="none")
    return Result(scene, 1000, scene.spacing, scene.spacing, entry(ours if ours is not None else {}),
                  entry(peer if peer is not None else {}), entry(cut if cut is not None else {}), **known)


class Verdicts(unittest.TestCase):
    def verdict(self, row):
        return row[-1] if isinstance(row[-1], str) else [r[-1] for r in row]

    def test_each_is_met_by_what_just_holds_and_missed_by_more(self):
        for judge, good, bad in (
                (verdicts.lost, result("grazing", {"lost": 0.005}), result("grazing", {"lost": 0.0051})),
                (verdicts.lost_beside_peer, result("fence", {"lost": 0.012}, {"lost": 0.01}),
                 result("fence", {"lost": 0.0131}, {"lost": 0.01})),
                (verdicts.invented, result("street", {"invented": 0.05}, cut={"invented": 0.1}),
                 result("street", {"invented": 0.051}, cut={"invented": 0.1})),
                (verdicts.topology, result("hopf"), result("hopf", {"genus": 2})),
                (verdicts.topology, result("tunnel", {"curves": 2}), result("hopf", {"curves": 1})),
                (verdicts.copies, result("dup10", copy_distance=(0.01, 0.05)),
                 result("dup10", copy_distance=(0.01, 0.06)))):
            self.assertEqual(self.verdict(judge([good])), MET, judge)
            self.assertEqual(self.verdict(judge([good, bad])), MISSED, judge)

    def test_a_scene_without_a_surface_meets_nothing(self):
        none = result("grazing")
        none.ours = Entry(failure="empty result")
        for judge in (verdicts.lost, verdicts.lost_beside_peer, verdicts.invented):
            self.assertEqual(self.verdict(judge([none])), MISSED)

    def test_what_fails_is_said_first_and_nothing_else(self):
        rows = [["a", "b", "c", MET], ["what is bad", "1", "2", MISSED]]
        self.assertIn("what is bad", failing(rows))
        self.assertNotIn("**a**", failing(rows))


class Makers(unittest.TestCase):
    programs = None

    def test_meshes_are_read_as_they_were_written(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = ball((1e6, 2, 3), 1)
            write_mesh(Path(folder) / "ball.ply", mesh)
            again = read_mesh(Path(folder) / "ball.ply")
        self.assertTrue((again[0] == mesh[0]).all() and (again[1] == mesh[1]).all())

    def test_names_are_unique_and_there_are_enough(self):
        self.assertGreaterEqual(len({s.name for s in SCENES}), 30)
        self.assertEqual(len({s.name for s in SCENES}), len(SCENES))

    def test_scenes_are_the_same_each_time_and_most_samples_lie_on_the_truth(self):
        if not self.programs:
            self.skipTest("needs the folder of the built programs")
        def run(*words):
            subprocess.run([Path(self.programs) / "soapfilm", *map(str, words), "--quiet"], check=True)
        tried = ("drift", "thin_sheet_07", "ct_voxels", "glass_front", "sweep_16", "als_town_way")
        for scene in (s for s in SCENES if s.name in tried):
            with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
                made, again = (scene.make(Kit(Path(f), run)) for f in (one, two))
                for name in made.inputs + ([made.trajectory] if made.trajectory else []):
                    self.assertEqual((Path(one) / name).read_bytes(), (Path(two) / name).read_bytes(), scene.name)
                self.assertTrue((made.positions == again.positions).all())
                if made.truth:
                    good = np.ones(len(made.positions), bool) if made.good is None else made.good
                    chosen = made.positions[good][::50]
                    surface = Surface(*read_mesh(Path(one) / made.truth), scene.spacing)
                    self.assertLess(np.quantile(surface.nearest(chosen)[0], 0.95), 2 * scene.spacing, scene.name)


if __name__ == "__main__":
    Makers.programs = sys.argv[1] if len(sys.argv) > 1 else None
    unittest.main(argv=sys.argv[:1])
