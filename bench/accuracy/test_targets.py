"""What the page says of rows that are made up: python3 -B -m unittest discover -s bench/accuracy -p 'test_*.py'"""
import sys
import tempfile
import unittest
from collections import namedtuple
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent)]

import page
import scans
import tables
from cases import CONDITIONS, FLAT, METHODS, SERIES, SHAPES, plan, sizes_of
from lab import Lab
from results import Results, Row, order_of
from targets import BY_DEFAULT, MET, MISSED, NOT_MEASURED, NOT_SPLIT, SHARE, Found, Targets, judged, reasons

PEER = namedtuple("Peer", "name voxels conditions")("peer", (0.71, 1.41), ())  # peers.py wants numpy
SPHERE, KNOT = (next(s for s in SHAPES if s.name == name) for name in ("sphere", "knot"))


def row(shape="sphere", condition="views", method="tv", cells=128, mean=0.001, peer_voxel=1, **others):
    """A right one, of a sphere; errors in voxels. Without a mean: no mesh."""
    made = Row(shape, condition, method, cells, peer_voxel, 1 / cells, 1000, true_components=1, true_genus=0)
    if mean is None:
        made.failure = "no surface"
        return made
    made.mean, made.mean_voxels = mean / cells, mean
    made.back_mean_voxels, made.normal_angle, made.closed, made.components, made.genus = mean, 1, True, 1, 0
    made.self_intersections = 0
    for name, value in others.items():
        setattr(made, name, value)
    return made


def unwrapped(text):
    return " ".join(text.split())


def table(rows, shapes=(SPHERE,), share=None):
    """Verdicts by (target, where)."""
    found = Targets(Results(rows, PEER.name), shapes, CONDITIONS, 128, share).all()
    return {(line[0], line[1]): line[-1] for line in found}


class Judged(unittest.TestCase):
    def test_verdict_flips_at_the_bound(self):
        self.assertEqual(judged([Found("a", 0.6), Found("b", 0.1)], 0.6), ("0.60 (a, 2 of 2)", MET))
        self.assertEqual(judged([Found("a", 0.6001), Found("b", 0.1)], 0.6), ("0.60 (a, 1 of 2)", MISSED))
        self.assertEqual(judged([Found("a", 1.8)], 1.8, least=True), ("1.80 (a)", MET))
        self.assertEqual(judged([Found("a", 1.79), Found("b", 2)], 1.8, least=True), ("1.79 (a, 1 of 2)", MISSED))

    def test_nothing_known_is_never_met(self):
        self.assertEqual(judged([], 1), (NOT_MEASURED, NOT_MEASURED))
        self.assertEqual(judged([Found("a")], 1)[1], NOT_MEASURED)
        self.assertEqual(judged([Found("a"), Found("b", 0.5)], 1)[1], NOT_MEASURED)
        self.assertEqual(judged([Found("a"), Found("b", 2)], 1)[1], MISSED)

    def test_no_surface_of_ours_fails(self):
        self.assertEqual(judged([Found("a", lost=True), Found("b", 0.5)], 1), ("no surface: a", MISSED))


class Missing(unittest.TestCase):
    target = ("viewing directions only: error over the peer's", "smooth")
    angle = ("noise of 1/3 voxel: normal angle over that one's", "smooth, detailed")

    def test_ratio(self):
        key = ("sphere", "views", "tv", 128)
        self.assertEqual(Results([row(mean=0.2), row(method="peer", mean=0.5)], "peer").ratio(*key), 0.4)
        self.assertIsNone(Results([row(), row(method="peer", mean=None)], "peer").ratio(*key))
        self.assertIsNone(Results([row(mean=None), row(method="peer")], "peer").ratio(*key))
        self.assertIsNone(Results([row()], None).ratio(*key))

    def test_without_the_peers_mesh(self):
        verdicts = table([row(), row(method="peer", mean=None), row(condition="noise-0.33"),
                          row(condition="noise-0.33", method="peer", mean=None)])
        self.assertEqual(verdicts[self.target], NOT_MEASURED)
        self.assertEqual(verdicts[self.angle], NOT_MEASURED)
        self.assertEqual(verdicts["noise of 1/3 voxel: error over the peer's best", "smooth"], NOT_MEASURED)

    def test_without_ours(self):
        verdicts = table([row(mean=None), row(method="peer", mean=1)])
        self.assertEqual(verdicts[self.target], MISSED)
        self.assertEqual(verdicts["viewing directions only: error, voxels", "smooth"], MISSED)

    def test_without_any_run(self):
        self.assertEqual(set(table([]).values()), {NOT_MEASURED})

    def test_outliers(self):
        target = ("10 % outliers: error over that without", "all")
        clean = row(mean=0.5)
        self.assertEqual(table([clean, row(condition="outliers-10", mean=1)])[target], MET)
        self.assertEqual(table([clean, row(condition="outliers-10", mean=1.01)])[target], MISSED)
        self.assertEqual(table([clean, row(condition="outliers-10", mean=None)])[target], MISSED)
        self.assertEqual(table([clean])[target], NOT_MEASURED)


class Verdicts(unittest.TestCase):
    def test_ratio(self):
        for mean, verdict in ((0.12, MET), (0.1201, MISSED)):
            self.assertEqual(table([row(mean=mean), row(method="peer", mean=1)])[Missing.target], verdict)

    def test_best_voxel_of_the_peer(self):
        key = ("noise of 1/3 voxel: error over the peer's best", "smooth")
        rows = [row(condition="noise-0.33", mean=0.6), row(condition="noise-0.33", method="peer", mean=1)]
        self.assertEqual(table(rows)[key], MET)
        better = row(condition="noise-0.33", method="peer", mean=0.99, peer_voxel=0.71)
        self.assertEqual(table([*rows, better])[key], MISSED)

    def test_topology(self):
        key = ("a hole: closed, components, genus", "sphere")
        self.assertEqual(table([row(condition="hole")])[key], MET)
        self.assertEqual(table([row(condition="hole", genus=1)])[key], MISSED)
        self.assertEqual(table([row(condition="hole", mean=None)])[key], MISSED)

    def test_share_of_cpu_time(self):
        key = (SHARE, "the bunny's raw scans, 512")
        self.assertEqual(table([], share=0.5)[key], MET)
        self.assertEqual(table([], share=0.51)[key], MISSED)
        self.assertEqual(scans.share_of({"cpu_seconds": {"solve": 2, "refine": 3, "relax": 1}}), 2)
        self.assertEqual(scans.share_of({"cpu_seconds": {"solve": 2, "refine": 3}}), 1.5)

    def test_intersections(self):
        key = ("pairs of triangles that run through each other", "all runs of tv")
        self.assertEqual(table([row(), row(condition="hole")])[key], MET)
        self.assertEqual(table([row(), row(condition="hole", self_intersections=1)])[key], MISSED)
        self.assertEqual(table([row(), row(method="peer", self_intersections=1)])[key], MET)
        self.assertEqual(table([row(), row(condition="hole", self_intersections=None)])[key], NOT_MEASURED)

    def test_order(self):
        def series(method, order, scale=1.0):
            return [row(method=method, cells=n, mean=scale * n**(1 - order)) for n in SERIES]
        flat, default = ((text, "smooth") for text in (NOT_SPLIT, BY_DEFAULT))
        gain = ("at every voxel size: error by default over that with edges not split", "smooth")
        self.assertAlmostEqual(order_of([(r.cells, r) for r in series("tv", 2)]), 2)
        found = table(series(FLAT, 1.81) + series("tv", 1.79, 0.9))
        self.assertEqual([found[k] for k in (flat, default, gain)], [MET, MISSED, MET])
        found = table(series(FLAT, 1.79) + series("tv", 1.81, 1.3))
        self.assertEqual([found[k] for k in (flat, default, gain)], [MISSED, MET, MISSED])
        lost = series("tv", 2)[:-1] + [row(cells=SERIES[-1], mean=None)]
        self.assertEqual(table(series(FLAT, 2) + lost)[default], MISSED)

    def test_reasons_are_of_missed_targets(self):
        lines = [[SHARE, "", "", "", MISSED], [BY_DEFAULT, "", "", "", MET], ["else", "", "", "", MISSED]]
        self.assertEqual([line.split("*")[1] for line in reasons(lines)], [SHARE])


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.lab = Lab(folder.name, folder.name, folder.name)

    def contents(self, rows, sizes=(128,), shapes=(SPHERE, KNOT)):
        contents = page.Contents(rows, list(shapes), list(CONDITIONS), sizes, [PEER], ["nobody"])
        return contents, Results(rows, PEER.name)

    def text(self, *arguments, **named):
        return page.write(self.lab, *self.contents(*arguments, **named))

    def test_a_table_for_each_size(self):
        rows = [row(cells=n, method=m, mean=n * e) for n in (64, 128, 256) for m, e in (("tv", 0.001), ("peer", 0.004))]
        text = self.text(rows, (128, 64, 256))
        for name in ("ratios", "topology", "spurious", "cost"):
            for size in ("", "-64", "-256"):
                self.assertTrue((self.lab.page / f"{name}{size}.csv").exists(), f"{name}{size}")
        self.assertIn("| viewing directions only | peer | 0.2560 |", text)
        self.assertIn("| viewing directions only | peer | 1.0240 |", text)
        self.assertEqual(text.count("1/64 of the longest side:"), 4)
        self.assertNotIn("of the longest side:", self.text(rows))

    def test_where_the_peer_is_better(self):
        rows = [row(condition="hole", mean=3), row(condition="hole", method="peer", mean=1),
                row("knot", "hole", mean=0.5), row("knot", "hole", "peer", mean=1),
                row(condition="views", mean=0.5), row(condition="views", method="peer", mean=1),
                row(condition="misaligned", mean=0.95), row(condition="misaligned", method="peer", mean=1)]
        listed = {k.name: ratios for k, ratios in tables.better_peer(*self.contents(rows))}
        self.assertEqual(listed, {"hole": [("sphere", 3), ("knot", 0.5)], "misaligned": [("sphere", 0.95)]})
        text = self.text(rows)
        self.assertIn("**a hole of a tenth**: error over peer's up to 3.00: sphere 3.00.", unwrapped(text))
        self.assertIn("little or no gain, 0.95 to 0.95 of peer's error", unwrapped(text))

    def test_the_peers_voxels(self):
        noisy = [row(condition="noise-0.5", method="peer", mean=1, peer_voxel=v) for v in (1, 1.41)]
        self.assertIn("at 0.71, 1 and 1.41 of our voxels", unwrapped(self.text(noisy)))
        self.assertIn("The best lies at an end of these in 0 of 1 cases.", unwrapped(self.text(noisy)))
        noisy.append(row(condition="noise-0.5", method="peer", mean=0.9, peer_voxel=0.71))
        self.assertIn("in 1 of 1 cases: noise of 1/2 voxel (sphere).", unwrapped(self.text(noisy)))
        self.assertIn("| 0.9000 at 0.71x | - |", unwrapped(self.text(noisy)))

    def test_a_mesh_that_is_missing(self):
        text = self.text([row(), row(method="peer", mean=None)])
        self.assertIn("| viewing directions only | peer | none | - |", text)
        self.assertIn("| viewing directions only | tv | no ratio | - |", text)
        lines = (self.lab.page / "targets.csv").read_text().splitlines()
        self.assertTrue(all(line.endswith(f",{NOT_MEASURED}") for line in lines if "over the peer's" in line))

    def test_runs_keep_all_that_was_measured(self):
        self.text([row(self_intersections=7, p99_voxels=0.5, maximum_voxels=2.5, volume_error=-0.001)])
        names, values = ((self.lab.page / "runs.csv").read_text().splitlines()[i].split(",") for i in (0, 1))
        kept = dict(zip(names, values))
        self.assertEqual([kept[k] for k in ("self_intersections", "p99_voxels", "maximum_voxels", "volume_error")],
                         ["7", "0.5", "2.5", "-0.001"])


class Plan(unittest.TestCase):
    def test_sizes(self):
        self.assertEqual(sizes_of(128, False), (128,))
        self.assertEqual(sizes_of(128, True), (128, 64, 256))

    def test_no_case_twice(self):
        for full in (False, True):
            names = [c.name for c in plan(SHAPES, CONDITIONS, METHODS, [PEER], 128, full)]
            self.assertEqual(len(names), len(set(names)))

    def test_peers_voxels_under_noise_alone(self):
        cases = [c for c in plan([SPHERE], CONDITIONS, METHODS, [PEER], 128, False) if c.method == PEER]
        self.assertEqual({c.peer_voxel for c in cases if c.condition.noise}, {0.71, 1, 1.41})
        self.assertEqual({c.peer_voxel for c in cases if not c.condition.noise}, {1})


if __name__ == "__main__":
    unittest.main()
