"""Cases of test_scenes.py: open scans, made and real: readers and writers, rays, generators, limits, the page."""
import struct
import tempfile
import unittest
from pathlib import Path

import numpy as np

import airborne
import depth_camera
import limits
import page
import sweeps
from geometry import ball, block, joined, rectangle, turned
from judge import Judge, Verdict, on_surface, shells
from kit import Kit, Made
from lab import Lab
from rays import Ground, Solid, first_hit, gabled
from readers import read_las, read_pcd, read_ply, read_sweep, unpacked
from real import REAL, RealResult, lowest, made_of, run
from trial import Entry, Trial
from verdict import MET, MISSED
from writers import write_las, write_sweep


def welded(mesh):
    names, index = np.unique(mesh[0].round(9), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[mesh[1]]
    return names, triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]


class Sides(unittest.TestCase):
    rng = np.random.default_rng(3)

    def seen_from_outside(self, mesh):
        samples, _ = on_surface(*mesh, 4000, self.rng)
        return Judge(Made([], samples, towards=5 * samples), 0.1)

    def test_a_ball_that_is_inside_out_is_a_shell_and_all_wrong(self):
        outside = welded(ball((0, 0, 0), 1))
        judge = self.seen_from_outside(outside)
        right, wrong = judge(*outside), judge(*turned(outside))
        self.assertEqual((right.shells, right.wrong_side), (0, 0))
        self.assertEqual((wrong.shells, wrong.wrong_side), (1, 1))

    def test_only_closed_parts_are_shells_wherever_they_are(self):
        cube, far = block((0, 0, 0), (1, 1, 1)), np.array([4e5, 5e6, 300.0])
        cube = welded(cube)
        inward, floor = turned(cube), rectangle((4, 4, 0), (3, 0, 0), (0, 2, 0))
        both = joined(cube, (inward[0] + (9, 0, 0), inward[1]), turned(floor))  # areas 6, 6 and 6
        self.assertAlmostEqual(shells(both[0] + far, both[1]), 1 / 3, places=6)
        self.assertEqual(shells(inward[0], inward[1][1:]), 0)

    def test_sides_are_judged_where_samples_were_seen_of_those_not_lost_and_asked_for(self):
        floor = rectangle((0, 0, 0), (10, 0, 0), (0, 10, 0))
        near, _ = on_surface(*floor, 300, self.rng)
        samples = np.concatenate([near, near + (0, 0, 20), near + (0, 0, 0.5)])  # the second third is lost
        towards = samples + (0, 0, 1.0)
        towards[:100] -= (0, 0, 2)
        outward = np.broadcast_to([0, 0, -1.0], samples.shape)               # towards is told, and goes before it
        made = Made([], samples, outward=outward, towards=towards)
        self.assertAlmostEqual(Judge(made, 1.0)(*floor).wrong_side, 100 / 600)
        made.sided = np.arange(900) < 200
        self.assertAlmostEqual(Judge(made, 1.0)(*floor).wrong_side, 100 / 200)
        self.assertIsNone(Judge(Made([], samples), 1.0)(*floor).wrong_side)


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "cloud"
        self.points = np.random.default_rng(4).uniform(-50, 50, (40, 3)).astype("<f4").astype(float)

    def test_las_comes_back_as_it_was_written(self):
        points = self.points + (691000, 5334000, 400)
        number = np.arange(40) % 3 + 1
        written = write_las(self.path, points, np.arange(40) * 0.5, 7, number, 3, np.arange(40) % 6)
        np.testing.assert_allclose(written, points, atol=0.00501)
        cloud = read_las(self.path)
        np.testing.assert_array_equal(cloud.positions, written)
        np.testing.assert_array_equal(cloud.classes, np.arange(40) % 6)
        np.testing.assert_array_equal(cloud.returns, np.stack([number, np.full(40, 3)], axis=1))
        np.testing.assert_array_equal(cloud.times, np.arange(40) * 0.5)

    def test_las_of_other_formats_is_read_and_of_unknown_ones_refused(self):
        for form, size, time in ((0, 20, 0), (2, 26, 0), (3, 34, 20), (6, 30, 22), (7, 36, 22), (8, 38, 22)):
            rows = np.zeros((3, size + 2), np.uint8)                          # two bytes more than the format has
            rows[:, :12] = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9]], "<i4").view(np.uint8)
            rows[:, 16 if form >= 6 else 15] = 2
            rows[1, 15] |= 4 if form >= 6 else 128                            # withheld
            if time:
                rows[:, time:time + 8] = np.array([[7.5]], "<f8").view(np.uint8)
            new = form >= 6
            header = bytearray(375 if new else 227)
            header[:4], header[24:26] = b"LASF", bytes((1, 4 if new else 2))
            struct.pack_into("<IIBHI", header, 96, len(header), 0, form, size + 2, 0 if new else 3)
            struct.pack_into("<6d", header, 131, 0.5, 0.5, 0.5, 10, 20, 30)
            if new:
                struct.pack_into("<Q", header, 247, 3)
            self.path.write_bytes(bytes(header) + rows.tobytes())
            cloud = read_las(self.path)
            np.testing.assert_array_equal(cloud.positions, [[10.5, 21, 31.5], [13.5, 24, 34.5]])
            self.assertEqual(cloud.classes.tolist(), [2, 2])
            self.assertEqual(None if cloud.times is None else cloud.times.tolist(), [7.5, 7.5] if time else None)
            header[104] = form | 128                                          # compressed
            self.path.write_bytes(bytes(header) + rows.tobytes())
            self.assertRaises(ValueError, read_las, self.path)

    def test_sweeps_come_back_without_rays_that_nothing_returned(self):
        written = write_sweep(self.path, np.concatenate([self.points, np.zeros((2, 3))]))
        cloud = read_sweep(self.path)
        np.testing.assert_array_equal(cloud.positions, written[:-2])
        self.assertEqual(cloud.sensor.tolist(), [0, 0, 0])

    def test_ply_of_each_kind_says_where_the_sensor_was(self):
        head = "ply\nformat {} 1.0\ncomment sensor 1 2 -3\nelement vertex 40\nproperty uchar red\n" + "".join(
            f"property float {k}\n" for k in "xyz") + "element face 0\nproperty list uchar int vertex_indices\n"
        for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
            rows = np.zeros(40, [("red", "u1"), ("at", order + "f4", 3)])
            rows["at"] = self.points
            self.path.write_bytes(f"{head.format(kind)}end_header\n".encode() + rows.tobytes())
            np.testing.assert_array_equal(read_ply(self.path).positions, self.points)
        lines = "".join(f"7 {x!r} {y!r} {z!r}\n" for x, y, z in self.points.tolist())
        self.path.write_text(f"{head.format('ascii')}end_header\n{lines}")
        cloud = read_ply(self.path)
        np.testing.assert_array_equal(cloud.positions, self.points)
        self.assertEqual(cloud.sensor.tolist(), [1, 2, -3])

    def test_pcd_of_each_kind_leaves_out_pixels_without_depth(self):
        points = self.points.astype("<f4")
        points[7] = np.nan
        right = np.delete(self.points, 7, axis=0)
        head = ("# .PCD\nVERSION 0.7\nFIELDS x rgb y z\nSIZE 4 1 4 4\nTYPE F U F F\nCOUNT 1 3 1 1\nWIDTH 40\nHEIGHT 1\n"
                "VIEWPOINT {} 0 0 1 0 0 0\nPOINTS 40\nDATA {}\n")
        rows = np.zeros(40, [("x", "<f4"), ("rgb", "u1", 3), ("y", "<f4"), ("z", "<f4")])
        rows["x"], rows["y"], rows["z"] = points.T
        columns = b"".join(rows[k].tobytes() for k in rows.dtype.names)
        packed = b"".join(bytes([len(p) - 1]) + p for p in (columns[k:k + 32] for k in range(0, len(columns), 32)))
        text = "".join(f"{x!r} 1 2 3 {y!r} {z!r}\n" for x, y, z in points.tolist())
        for kind, data in (("binary", rows.tobytes()), ("ascii", text.encode()),
                           ("binary_compressed", struct.pack("<II", len(packed), len(columns)) + packed)):
            self.path.write_bytes(head.format(0, kind).encode() + data)
            cloud = read_pcd(self.path)
            np.testing.assert_array_equal(cloud.positions, right)
            self.assertIsNone(cloud.sensor)
        self.path.write_bytes(head.format(5, "binary").encode() + rows.tobytes())
        self.assertEqual(read_pcd(self.path).sensor.tolist(), [5, 0, 0])
        self.assertEqual(unpacked(b"\x02abc\x80\x02\xe0\x01\x00", 19), b"abc" * 3 + b"c" * 10)


class Rays(unittest.TestCase):
    def test_solids_are_met_where_they_are_and_rooms_from_inside(self):
        house = Solid(gabled((0, 0, 0), 10, 8, 5, 8))
        volume = 10 * 8 * 5 + 10 * 8 * 3 / 2
        corners = house.mesh[0][house.mesh[1]]
        self.assertAlmostEqual(np.einsum("ti,ti", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6, volume)
        origins, down = np.array([[0, 2.0, 20], [0, 9, 20], [3, 0.5, 20]]), np.array([[0, 0, -1.0]] * 3)
        reach, normal = house.hit(origins, down)
        np.testing.assert_allclose(reach, [20 - 6.5, np.inf, 20 - 8 + 3 / 8])
        self.assertTrue((normal[[0, 2], 2] > 0.7).all())
        walls = Solid(block((0, 0, 0), (4, 3, 2)))
        reach, normal = walls.hit_inside(np.array([[1.0, 1, 1]]), np.array([[1.0, 0, 0]]))
        self.assertEqual((reach[0], normal[0].tolist()), (3, [-1, 0, 0]))

    def test_the_ground_is_met_where_it_is_and_what_stands_on_it_first(self):
        ground = Ground(lambda x, y: 0.5 * x + np.sin(y), (0, 0), (10, 10))
        rng = np.random.default_rng(5)
        at = rng.uniform((1, 1), (9, 9), (200, 2))
        points = np.column_stack([at, ground.heights(*at.T)])
        ways = rng.normal(0, 0.05, (200, 3)) + (0, 0, -1)
        reach, normal = first_hit(points - 50 * ways, ways, (), ground.hit)
        np.testing.assert_allclose(reach, 50, atol=1e-4)
        np.testing.assert_allclose(normal[:, 0] / normal[:, 2], -0.5, atol=1e-6)
        reach, _ = first_hit(np.array([[5.0, 5, 50]]), np.array([[0, 0, -1.0]]), [Solid(block((4, 4, -9), (6, 6, 12)))],
                             ground.hit)
        self.assertEqual(reach[0], 38)
        self.assertTrue(np.isinf(ground.hit(np.array([[-5.0, 5, 50]]), np.array([[0, 0, -1.0]]))[0][0]))


class Generators(unittest.TestCase):
    def made(self, make):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return Path(folder.name), make(Kit(Path(folder.name), None))

    def test_strips_lie_on_the_ground_and_are_seen_from_the_aircraft(self):
        folder, made = self.made(airborne.relief(airborne.bowl, airborne.as_las, 40.0, 2.0))
        self.assertTrue(300 < len(made.positions) < 2000)
        at = made.positions - airborne.UTM
        self.assertLess(np.abs(at[:, 2] - airborne.bowl(at[:, 0], at[:, 1])).max(), 0.25)
        self.assertTrue((((made.towards - made.positions) * made.outward).sum(axis=1) > 0).all())
        cloud = read_las(folder / "input.las")
        np.testing.assert_array_equal(cloud.positions, made.positions)
        self.assertTrue((np.diff(cloud.times) >= 0).all())
        self.assertFalse(made.trajectory)

    def test_the_way_of_the_aircraft_is_where_the_samples_were_seen_from(self):
        folder, made = self.made(airborne.town_with_way)
        way, cloud = np.loadtxt(folder / made.trajectory), read_las(folder / "input.las")
        places = np.stack([np.interp(cloud.times, way[:, 0], way[:, k]) for k in (1, 2, 3)], axis=1)
        self.assertLess(np.abs(places - made.towards).max(), 0.1)

    def test_the_ground_of_a_forest_is_class_2_and_below_the_crowns(self):
        folder, made = self.made(airborne.forest)
        cloud = read_las(folder / "input.las")
        np.testing.assert_array_equal(made.sided, cloud.classes == 2)
        self.assertTrue(0.3 < made.sided.mean() < 0.9)
        at = made.positions - airborne.UTM
        above = at[:, 2] - airborne.wooded(at[:, 0], at[:, 1])
        self.assertLess(np.abs(above[made.sided]).max(), 0.3)
        self.assertGreater(np.quantile(above[~made.sided], 0.05), 3)
        number, of = cloud.returns.T
        self.assertTrue((number <= of).all() and of.max() >= 3)
        self.assertTrue((number[made.sided] == of[made.sided]).all())

    def test_the_error_of_a_depth_camera_grows_with_the_square_of_the_distance(self):
        points, normals = depth_camera.frame((2.0, 1.9, 1.4), (4.6, 1.9, 1.3), np.random.default_rng(6))
        on_wall = normals[:, 0] == -1
        depth = 2.6
        error = points[on_wall, 0] - 4.6
        error = error[np.abs(error) < 0.1]                                    # of the wall alone
        self.assertAlmostEqual(error.std() / depth**2, np.hypot(0.0015, 0.0028 / np.sqrt(12)), delta=3e-4)
        self.assertLess(len(points), depth_camera.WIDTH * depth_camera.HEIGHT)

    def test_leaves_look_to_the_scanner_and_things_stand_on_the_ground(self):
        leaves = sweeps.tree((10.0, 5, -1.7), np.random.default_rng(7), 200)
        corners = leaves[0][leaves[1][-400:]]
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.assertGreater(((faces * -corners.mean(axis=1)).sum(axis=1) > 0).mean(), 0.95)
        low = sweeps.things(lambda x, y: 0.1 * y)[0]
        self.assertGreater((low[:, 2] - 0.1 * low[:, 1]).min(), -5)


class RealFiles(unittest.TestCase):
    verdict = Verdict(0.001, 0.5, 0.01, wrong_side=0.01, shells=0, components=2)

    def result(self, real=REAL[0], skipped="", **changed):
        entry = Entry(Verdict(**vars(self.verdict) | changed), cpu=1, peak_mb=2, planned_mb=3)
        return RealResult(real, 1000, 0.5, None if skipped else entry, skipped)

    def test_every_limit_is_missed_by_more_and_by_no_figure(self):
        for kind, of_kind in limits.LIMITS.items():
            self.assertEqual(limits.failures(kind, self.verdict), [])
            for key, most in of_kind.items():
                for value, count in ((most, 0), (most * 1.01, 1), (None, 1)):
                    changed = Verdict(**vars(self.verdict) | {key: value})
                    self.assertEqual(len(limits.over(kind, changed)), count, (kind, key, value))
        rows = limits.rows([("a", "sweep", self.verdict), ("b", "sweep", None), ("c", "airborne ground", self.verdict)])
        self.assertEqual([r[3] for r in rows], [MISSED, MET])
        self.assertIn("1 of 2; not b (no surface)", rows[0][2])

    def test_the_page_says_first_what_fails_then_all_figures(self):
        with tempfile.TemporaryDirectory() as folder:
            lab = Lab(folder, folder, folder)
            text = page.real_section(lab, [self.result(), self.result(REAL[5], lost=0.02),
                                           self.result(REAL[1], "SOAPFILM_DATA lacks it")])
            fails = f"- **{REAL[5].name}** fails: lost 2.00 % for 0.70 %."
            self.assertIn(fails, text)
            self.assertLess(text.index(fails), text.index("| file |"))
            self.assertIn(f"Not measured, for SOAPFILM_DATA lacks it: {REAL[1].name}.", text)
            self.assertEqual(text.count(MISSED), 1)
            self.assertTrue((Path(folder) / "real.csv").exists())

    def test_a_file_that_is_not_there_is_skipped_with_a_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            trial = Trial(Lab(folder, folder, folder))
            for data, words in ((None, "not set"), (Path(folder), "lacks it")):
                trial.lab.data = data
                self.assertIn(words, run(trial, REAL[0]).skipped)

    def test_what_a_file_was_seen_from_and_its_ground(self):
        points = np.array([[0, 0, 5], [0.5, 0.5, 1], [0, 3, 9], [1, 1, 1.5], [5, 5, 0.0]])
        self.assertEqual(lowest(points, 2.0).tolist(), [False, True, True, False, True])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.las"
            write_las(path, points, np.arange(5), 1, classes=[2, 2, 5, 5, 2])
            made = made_of(next(r for r in REAL if r.forest), [path])
            self.assertEqual(made.sided.tolist(), [True, True, False, False, True])
            self.assertTrue((made.towards - made.positions == (0, 0, 1)).all())
