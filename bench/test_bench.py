"""Tests of what the benchmarks work out from what they measure: test_bench.py [PROGRAMS]

With the folder of the built programs a small run of speed.py, too. ctest runs it where bench/ is built."""
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "speed"), str(HERE / "accuracy"), str(HERE / "kernels")]

import clouds
import inputs
import kernels
import lab
import speed
import verdicts
from conditions import RESTED, WARMED, Memory
from verdicts import ON_TWO, OURS, Case


def figure(cpu=1.0, elapsed=1.0, peak_mb=100.0, planned_mb=None):
    return {"cpu": cpu, "user": cpu, "system": 0.0, "elapsed": elapsed, "peak_mb": peak_mb, "faults": 0.0,
            "planned_mb": planned_mb, "runs": 1}


def verdicts_of(rows, words):
    """The two verdicts of the one row whose target holds the words."""
    (found,) = [r for r in rows if words in r[1]]
    return found[3], found[5]


class Verdicts(unittest.TestCase):
    case = Case(None, 512, cpu=2.5, elapsed=2, peak_mb=350, ratio=5)

    def rows(self, imports={}, **changed):
        figures = {(OURS, c): figure(2.5, 2.6, 350, 400) for c in (WARMED, RESTED)}
        figures |= {(ON_TWO, c): figure(3.0, 2.0, 360, 400) for c in (WARMED, RESTED)}
        figures |= {("peer", c): figure(12.5, 13, 351) for c in (WARMED, RESTED)}
        figures |= {(program, RESTED): changed[name] for name, program in
                    (("ours", OURS), ("on_two", ON_TWO), ("peer", "peer")) if name in changed}
        return verdicts.of_case("case", self.case, figures, 0, imports)

    def test_what_reaches_a_target_has_met_it(self):
        for r in self.rows():
            self.assertEqual((r[3], r[5]), ("met", "met"), r)

    def test_each_target_is_missed_by_what_is_worse_and_only_in_its_condition(self):
        for words, changed in (("CPU s", {"ours": figure(2.51, 2, 350, 400)}),
                               ("elapsed", {"on_two": figure(3, 2.01, 360, 400)}),
                               ("peak MB, one thread", {"ours": figure(2.5, 2, 350.1, 400)}),
                               ("planned memory", {"on_two": figure(3, 2, 347, 400)}),
                               ("planned memory", {"on_two": figure(3, 2, 471, 400)}),
                               ("planned memory", {"ours": figure(2.5, 2, 350)}),
                               ("CPU time of peer", {"peer": figure(12.49, 13, 351)}),
                               ("peak MB of peer", {"peer": figure(12.5, 13, 350)})):
            self.assertEqual(verdicts_of(self.rows(**changed), words), ("met", "**missed**"), words)

    def test_a_peer_without_its_import_is_judged_too(self):
        rows = self.rows({"peer": figure(0.1, 0.1, 2)})
        self.assertEqual(verdicts_of(rows, "the same ratio"), ("**missed**", "**missed**"))
        self.assertEqual(verdicts_of(rows, "the same MB"), ("**missed**", "**missed**"))

    def test_what_was_not_measured_is_not_judged(self):
        rows = verdicts.of_case("case", self.case, {(OURS, WARMED): figure(2, 2, 300, 300)}, 0, {})
        self.assertEqual(verdicts_of(rows, "CPU s"), ("met", "not measured"))
        self.assertEqual(verdicts_of(rows, "elapsed"), ("not measured", "not measured"))
        self.assertFalse([r for r in rows if "peer" in r[1]])

    def test_memory_may_depend_on_the_file(self):
        case = Case(1, 8, beyond_file_mb=1500)
        for peak, expected in ((1740, "met"), (1741, "**missed**")):
            rows = verdicts.of_case("case", case, {(OURS, WARMED): figure(peak_mb=peak)}, 240, {})
            self.assertEqual(verdicts_of(rows, "peak MB")[0], expected)

    def test_flat_is_a_fifth_over_the_least(self):
        for largest, expected in ((360, "met"), (361, "**missed**")):
            rows = verdicts.of_scaling([256, 512, 1024], [301, 300, largest], [300, 300, 300], [figure(planned_mb=100)])
            self.assertEqual(verdicts_of(rows, "CPU time"), ("not measured", expected))
            self.assertEqual(verdicts_of(rows, "user time"), ("not measured", "met"))


class Speed(unittest.TestCase):
    def test_every_round_runs_all_and_begins_with_another(self):
        rounds = list(speed.turns(list("abcdef"), 3))
        self.assertEqual([sorted(r) for r in rounds], [list("abcdef")] * 3)
        self.assertEqual(len({r[0] for r in rounds}), 3)

    def test_the_plan_is_read_in_megabytes(self):
        self.assertAlmostEqual(speed.planned_mb("grid 8x8x8, memory 1.5 GiB\n"), 1.5 * 1024**3 / 1e6)
        self.assertIsNone(speed.planned_mb("nothing of that"))

    def test_figures_are_medians(self):
        runs = [{"cpu": c, "system": s, "elapsed": c, "peak_mb": 10, "faults": 1, "errors": "memory 10 MiB"}
                for c, s in ((3, 1), (1, 0), (2, 1.5))]
        found = speed.figure_of(runs)
        self.assertEqual((found["cpu"], found["user"], found["system"], found["runs"]), (2, 1, 1, 3))

    def test_callgrinds_count_or_a_clear_message(self):
        self.assertEqual(speed.counted("==1== Events    : Ir\n==1== Collected : 1234\n"), 1234)
        with self.assertRaisesRegex(speed.Failed, "Collected"):
            speed.counted("==1== it died")

    def test_a_peer_that_fails_ends_nothing_and_ours_does(self):
        with tempfile.TemporaryDirectory() as folder:
            place = lab.Lab(folder, folder, folder)
            place.say = lambda text: None
            measure = speed.Speed(place, Memory(warm_mb=1, rest=0), 2, []).measure_programs
            fails, works = ["sh", "-c", "echo no >&2; exit 1"], ["sh", "-c", "echo 'memory 1 MiB' >&2"]
            figures, failures = measure("case", {OURS: works, ON_TWO: works, "good": works, "bad": fails})
            self.assertEqual({p for p, _ in figures}, {OURS, ON_TWO, "good"})
            self.assertEqual({f["runs"] for f in figures.values()}, {2})
            self.assertRegex(failures["bad"], "exit code 1: no$")
            with self.assertRaises(speed.Failed):
                measure("case", {OURS: fails, ON_TWO: works})

    def test_a_failed_run_says_which_and_why(self):
        with tempfile.TemporaryDirectory() as folder:
            place = lab.Lab(folder, folder, folder)
            used = speed.run(place, [sys.executable, "-c", "print(1)"], "one")
            self.assertGreater(used["faults"], 0)
            with self.assertRaisesRegex(speed.Failed, "exit code 3: too bad"):
                speed.run(place, ["sh", "-c", "echo too bad >&2; exit 3"], "one")


class Inputs(unittest.TestCase):
    def test_a_file_has_its_name_when_it_is_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "cloud.ply"

            def broken(partial):
                partial.write_text("half")
                raise RuntimeError

            with self.assertRaises(RuntimeError):
                inputs.made(path, broken)
            self.assertFalse(path.exists())
            inputs.made(path, lambda partial: partial.write_text("whole"))
            self.assertEqual(inputs.made(path, broken).read_text(), "whole")

    def test_clouds_of_other_resolutions_are_other_files(self):
        with tempfile.TemporaryDirectory() as folder:
            place = lab.Lab(folder, folder, folder)
            place.say = lambda text: None
            found = [inputs.Input(place, 300, n) for n in (32, 64)]
            files = {path for cloud in found for path in (cloud.file, cloud.for_peers())}
            self.assertEqual(len(files), 4)
            self.assertTrue(all(path.exists() for path in files))

    def test_a_virtual_cloud_holds_samples_near_the_torus(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "cloud.ply"
            clouds.write(path, 1000, 64)
            head, data = path.read_bytes().split(b"end_header\n", 1)
            self.assertIn(b"element vertex 1000", head)
            self.assertEqual(len(data), 12 * 1000)
            for x, y, z in struct.iter_unpack("<3f", data):
                ring = (x * x + y * y)**0.5 - clouds.RADIUS
                self.assertLess(abs((ring * ring + z * z)**0.5 - clouds.TUBE), 6 * clouds.NOISE_VOX * clouds.voxel(64))


class Kernels(unittest.TestCase):
    def report(self, **rates):
        """Rates in GB/s by name; ns per vertex of 1.5 for all."""
        entries = [{"run_name": name.replace("__", "/threads:") + "/process_time/real_time", "aggregate_name": kind,
                    "bytes_per_second": rate * 1e9 if kind == "median" else 0.01, "ns_per_vertex": 1.5,
                    "repetitions": 9}
                   for name, rate in rates.items() for kind in ("mean", "median", "cv")]
        return {"context": {"load_avg": [0.5, 0, 0]}, "benchmarks": entries}

    def test_sweeps_are_judged_beside_the_copy_on_as_many_threads(self):
        found = {"kernels": kernels.medians(self.report(copy__1=10, copy__2=20, eight_sweeps__1=7, eight_sweeps__2=13.9,
                                                        one_sweep__1=6.9, one_sweep__2=14))}
        self.assertEqual([r[2] for r in kernels.verdicts(found)[:5]],
                         ["met", "**missed**", "**missed**", "met", "met"])

    def test_readers_are_judged_by_their_rates(self):
        found = {"kernels_io": kernels.medians(self.report(read_binary_ply=0.499, read_ascii_ply=0.08))}
        self.assertEqual([r[2] for r in kernels.verdicts(found)][-2:], ["**missed**", "met"])

    def test_the_page_has_a_row_for_each_kernel(self):
        text = kernels.page({"kernels": self.report(copy__1=10, copy__2=20, energy__2=5)})
        self.assertIn("| energy | threads 2 | 1.50 | 5.00 | 1 | 25 |", text)
        self.assertIn("not measured", text)
        self.assertIn("Medians of 9 repetitions", text)


class Smoke(unittest.TestCase):
    programs = None

    def test_a_small_run_writes_a_whole_page(self):
        if not self.programs:
            self.skipTest("needs the folder of the built programs")
        with tempfile.TemporaryDirectory() as folder:
            made = subprocess.run([sys.executable, "-B", HERE / "speed" / "speed.py", self.programs, folder, "--smoke"],
                                  capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
            text = (Path(folder) / "results" / "speed.md").read_text()
        for part in ("## Against the targets", "## Cases", "## Scaling"):
            self.assertIn(part, text)
        self.assertRegex(text, r"CPU s, one thread: <= 60 \| [\d.]+ \| \S+ \| [\d.]+ \| \S+ \|")
        self.assertRegex(text, r"planned memory within 15 % of the peak \| [+-][\d.]+ %")


if __name__ == "__main__":
    Smoke.programs = sys.argv[1] if len(sys.argv) > 1 else None
    unittest.main(argv=sys.argv[:1])
