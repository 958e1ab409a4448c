"""How fast the whole program is, beside its peers:

    speed.py PROGRAMS WORK [--cases A,B] [--sizes A,B] [--runs N] [--part PART]... [--smoke]

PROGRAMS holds the built programs, WORK the clouds and meshes (large). A whole run writes bench/results/: speed.md,
speed.csv, stages.csv, scaling.csv, scaling.png; chosen PARTs (cases, scaling, instructions), cases or sizes and --smoke
(small ones, quick, to see that all works) write WORK/results/. Cases are 512, 1024 (the bunny's raw scans with
SOAPFILM_DATA, else as many virtual samples) and 20M.

Every program runs on one thread, ours on two as well, for the elapsed time; each with warmed and with rested memory
(conditions.py). Each round begins with another program, and the medians are compared, in CPU seconds: work, whatever
else the machine does. The scaling series is run with rested memory alone: warmth lasts for all of a run at 256 and for
little of one at 2048. Nothing is read back from an earlier benchmark.
"""
import argparse
import json
import os
import re
import shlex
import shutil
import statistics
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "accuracy")]

import clouds
import verdicts
from conditions import CONDITIONS, RESTED, WARMED, Memory
from inputs import Input
from lab import Lab, commit, machine, markdown
from peers import ENVIRONMENT, read_peers
from verdicts import CASES, ON_TWO, OURS, SMOKE_CASES, over_least, plan_error

SCALING = (256, 512, 1024, 2048)
SCALING_SAMPLES_PER_VOXEL2 = 1.0
SCALING_NOTE = f"""{SCALING_SAMPLES_PER_VOXEL2:g} sample per voxel^2, one thread, medians. Small sizes have more runs,
for less than a second tells little. Memory is rested before each run. What a run frees and asks for again within two
seconds comes warm all the same, and of a short run that is a larger part: system time is not strictly comparable
between sizes, user time is. A page fault is the first touch of a page, of 4 kB or of 2 MB."""
MEMORY_HEADER = ["page faults, 1000", "peak MB", "planned MB", "plan over peak, %"]
UNITS = {"KiB": 1024, "MiB": 1024**2, "GiB": 1024**3}
PARTS = ("cases", "scaling", "instructions")


class Failed(Exception):
    """A program's run; says which and why."""


def run(lab, words, name, environment=None):
    measured = lab.measure(words, lab.work / name, environment)
    if measured["code"]:
        said = measured["errors"].strip().splitlines() or ["(it said nothing)"]
        raise Failed(f"{lab.shown(words)}: exit code {measured['code']}: {said[-1]}")
    return measured


def ours(lab, cloud, resolution, threads=1):
    return [lab.program, "reconstruct", cloud.file, "-o", lab.work / "ours.ply", "--resolution", resolution,
            "--threads", threads]


def turns(things, rounds):
    """The same in each round, begun with another one."""
    for k in range(rounds):
        first = k * len(things) // rounds
        yield things[first:] + things[:first]


def planned_mb(errors):
    """From the line that a run prints before it begins; None without one."""
    found = re.search(r"memory ([\d.]+) ([KMG]iB)", errors)
    return float(found[1]) * UNITS[found[2]] / 1e6 if found else None


def figure_of(measured):
    """Medians of some runs, and the plan of the first."""
    for m in measured:
        m["user"] = m["cpu"] - m["system"]
    keys = ("cpu", "user", "system", "elapsed", "peak_mb", "faults")
    return {**{k: statistics.median(m[k] for m in measured) for k in keys},
            "planned_mb": planned_mb(measured[0]["errors"]), "runs": len(measured)}


def memory_cells(figure):
    error = plan_error(figure)
    plan = ["", ""] if error is None else [f"{figure['planned_mb']:.0f}", f"{100 * error:+.1f}"]
    return [f"{figure['faults'] / 1000:.0f}", f"{figure['peak_mb']:.0f}", *plan]


def stages(lab, words):
    """The report of a run, its CPU seconds without the check that a report brings."""
    report = lab.work / "ours.json"
    run(lab, [*words, "--report", report], "ours")
    found = json.loads(report.read_text())
    found["cpu_seconds"]["total"] -= found["cpu_seconds"].pop("check", 0)
    return found


def import_of(lab, peer, runs):
    """What a peer's interpreter and its imports take alone, where the peer's check is to load them; else None."""
    if not peer.check:
        return None
    words = [w.format(here=HERE.parent / "accuracy", python=sys.executable) for w in shlex.split(peer.check)]
    try:
        return figure_of([run(lab, words, "import", ENVIRONMENT) for _ in range(runs)])
    except Failed as failure:
        lab.say(str(failure))
        return None


class Speed:
    """The parts of the page; each returns its text, and adds its verdicts."""

    def __init__(self, lab, memory, runs, peers):
        self.lab, self.memory, self.runs, self.peers = lab, memory, runs, peers
        self.verdicts = []
        self.imports = {}

    def measure_programs(self, title, commands):
        """Figures by (program, condition), and why programs failed. One of ours that fails ends all; a peer that does
        is not run again."""
        measured, failures = {}, {}
        for k, turn in enumerate(turns([(p, c) for c in CONDITIONS for p in commands], self.runs)):
            for program, condition in turn:
                if program in failures:
                    continue
                self.lab.say(f"{title}, run {k + 1} of {self.runs}: {program}, {condition}")
                self.memory.prepare(condition)
                is_ours = program in (OURS, ON_TWO)
                try:
                    found = run(self.lab, commands[program], "speed", None if is_ours else ENVIRONMENT)
                except Failed as failure:
                    if is_ours:
                        raise
                    self.lab.say(str(failure))
                    failures[program] = str(failure)
                else:
                    measured.setdefault((program, condition), []).append(found)
        return {key: figure_of(m) for key, m in measured.items() if key[0] not in failures}, failures

    def case(self, name, case):
        lab = self.lab
        cloud = Input(lab, case.samples, case.resolution)
        commands = {OURS: ours(lab, cloud, case.resolution), ON_TWO: ours(lab, cloud, case.resolution, threads=2)}
        for peer in self.peers if case.with_peers else []:
            commands[peer.name] = peer.words(cloud.for_peers(), lab.work / "peer.ply", cloud.voxel(case.resolution),
                                             case.resolution)
        cloud.read_once()
        title = f"{cloud.name}, {case.resolution}"
        figures, failures = self.measure_programs(title, commands)
        self.verdicts += verdicts.of_case(title, case, figures, cloud.megabytes, self.imports)
        rows = []
        for condition in CONDITIONS:
            for program in commands:
                if program in failures:
                    rows.append([title, program, condition, 0, "failed", *[""] * 7])
                    continue
                f, mine = figures[program, condition], figures[OURS, condition]
                seconds = (f"{f[k]:.2f}" for k in ("cpu", "system", "elapsed"))
                rows.append([title, program, condition, f["runs"], *seconds, *memory_cells(f),
                             f"{f['cpu'] / mine['cpu']:.2f}"])
        self.memory.prepare(WARMED)
        return rows, stages(lab, commands[OURS])["cpu_seconds"], failures

    def cases(self, chosen):
        header = ["case", "program", "memory", "runs", "CPU s", "of these system", "elapsed s", *MEMORY_HEADER,
                  "CPU over ours"]
        rows, times, failures = [], {}, {}
        for peer in self.peers:
            self.lab.say(f"{peer.name}: its import alone")
            self.imports[peer.name] = import_of(self.lab, peer, self.runs)
        for name, case in chosen.items():
            found, times[name], failed = self.case(name, case)
            rows += found
            failures.update(failed)
        text = [self.lab.table("speed", header, rows)]
        text += [f"{peer}: Python and its import alone take {f['cpu']:.2f} CPU s and {f['peak_mb']:.0f} MB of these."
                 for peer, f in self.imports.items() if f]
        text += [f"{peer} failed: {why}" for peer, why in failures.items()]
        keys = list(dict.fromkeys(stage for t in times.values() for stage in t))
        text += ["CPU seconds by stage, one run each, memory warmed:",
                 self.lab.table("stages", ["case", *keys],
                                [[name, *(f"{t.get(k, 0):.2f}" for k in keys)] for name, t in times.items()])]
        return "\n\n".join(text)

    def scaling(self, sizes, plotted=True):
        """Virtual scans with the same samples per voxel^2 at each size."""
        lab = self.lab
        inputs = {n: Input(lab, clouds.samples_for(n, SCALING_SAMPLES_PER_VOXEL2), n) for n in sizes}
        measured = {n: [] for n in sizes}
        for cloud in inputs.values():
            cloud.read_once()
        for k, turn in enumerate(turns(list(inputs.items()), self.runs)):
            for resolution, cloud in turn:
                for _ in range(min(4, max(1, 1024 // resolution))):  # less than a second tells little
                    lab.say(f"scaling: {cloud.name} at {resolution}, round {k + 1} of {self.runs}")
                    self.memory.prepare(RESTED)
                    measured[resolution].append(run(lab, ours(lab, cloud, resolution), "speed"))
        figures = {n: figure_of(m) for n, m in measured.items()}
        vertices, solve = {}, {}
        for resolution, cloud in inputs.items():
            self.memory.prepare(RESTED)
            report = stages(lab, ours(lab, cloud, resolution))
            vertices[resolution] = report["grid"]["levels"][-1]["active_vertices"]
            solve[resolution] = report["cpu_seconds"]["solve"]
        cpu, user = ([1e9 * figures[n][k] / vertices[n] for n in sizes] for k in ("cpu", "user"))
        self.verdicts += verdicts.of_scaling(sizes, cpu, user, list(figures.values()))
        rows = []
        for n, c, u, over, user_over in zip(sizes, cpu, user, over_least(cpu), over_least(user)):
            f = figures[n]
            rows.append([n, inputs[n].samples, vertices[n], f["runs"], f"{f['cpu']:.2f}",
                         f"{c:.0f}", f"{100 * over:.0f}", f"{u:.0f}", f"{100 * user_over:.0f}",
                         f"{1e9 * solve[n] / vertices[n]:.0f}", *memory_cells(f)])
        header = ["resolution", "samples", "active vertices", "runs", "CPU s", "ns per active vertex",
                  "over the least, %", "user ns per active vertex", "over the least, %",
                  "solve ns per active vertex (one run)", *MEMORY_HEADER]
        text = SCALING_NOTE + "\n\n" + lab.table("scaling", header, rows)
        if plotted:
            plot(lab, [vertices[n] for n in sizes], [figures[n]["cpu"] for n in sizes], sizes)
            text += "\n\n![CPU seconds against active vertices](scaling.png)"
        return text

    def instructions(self):
        """A figure that does not depend on the machine's mood."""
        lab = self.lab
        cloud = Input(lab, clouds.samples_for(96, 2.0), 96)
        if not shutil.which("valgrind"):
            raise Failed("callgrind counts the instructions: valgrind is not installed")
        lab.say(f"callgrind: {cloud.name} at 96")
        count = counted(run(lab, ["valgrind", "--tool=callgrind", f"--callgrind-out-file={lab.work / 'callgrind.out'}",
                                  *ours(lab, cloud, 96)], "speed")["errors"])
        return f"{count / 1e6:.0f} million instructions: {cloud.samples} virtual samples at 96, one thread (callgrind)."


def counted(errors):
    """Instructions, from what callgrind says."""
    found = re.search(r"Collected\s*:\s*(\d+)", errors)
    if not found:
        raise Failed(f"callgrind did not say 'Collected : N' but: {errors.strip()[-300:]}")
    return int(found[1])


def plot(lab, vertices, cpu, sizes):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(4.8, 3.4))
    axis.loglog(vertices, cpu, "o-", label="whole run")
    axis.loglog(vertices, [cpu[0] * v / vertices[0] for v in vertices], ":", color="gray", label="constant per vertex")
    for size, v, seconds in zip(sizes, vertices, cpu):
        axis.annotate(str(size), (v, seconds), textcoords="offset points", xytext=(4, -10), fontsize=8)
    axis.set_xlabel("active vertices of the finest level")
    axis.set_ylabel("CPU seconds, one thread")
    axis.grid(True, alpha=0.3)
    axis.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(lab.page / "scaling.png", dpi=110)


def head(missing, runs, memory, load, begin):
    minutes = (time.monotonic() - begin) / 60
    text = ["# Speed of the whole program",
            f"""`make bench`: reading and writing files included, one thread unless it says two, medians of {runs}
rounds, each of which begins with another program. MB are 10^6 bytes of resident memory. "Warmed": another process used
{memory.warm_mb} MB right before. "Rested": the machine idled for {memory.rest} s before (`speed/conditions.py`).""",
            f"{machine()}; commit {commit()}; {time.strftime('%Y-%m-%d')}; {minutes:.0f} minutes; load when it began "
            f"{load:.1f}."]
    if missing:
        text.append(f"Not on this machine: {', '.join(p.name for p in missing)}.")
    return text


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("work")
    parser.add_argument("--cases", default=",".join(CASES), help="of 512, 1024, 20M")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--sizes", default=",".join(map(str, SCALING)), help="of the scaling series")
    parser.add_argument("--part", action="append", choices=PARTS)
    parser.add_argument("--smoke", action="store_true", help="small cases, once, without callgrind and plot")
    options = parser.parse_args()
    names = options.cases.split(",")
    if unknown := [n for n in names if n not in CASES]:
        parser.error(f"case = {unknown[0]}, must be one of {', '.join(CASES)}")
    if options.runs < 1:
        parser.error(f"runs = {options.runs}, must be at least 1")
    options.chosen = {n: CASES[n] for n in names}
    options.sizes = [int(n) for n in options.sizes.split(",")]
    options.whole = not options.part and options.sizes == list(SCALING) and list(options.chosen) == list(CASES)
    if options.smoke:
        options.chosen, options.sizes, options.runs, options.whole = SMOKE_CASES, [32, 64], 1, False
        options.part = options.part or ["cases", "scaling"]
    return options


def main():
    options = parsed()
    begin, load = time.monotonic(), os.getloadavg()[0]
    lab = Lab(options.programs, options.work,
              HERE.parent / "results" if options.whole else Path(options.work) / "results")
    able, missing = read_peers(HERE.parent / "accuracy" / "peers.toml")
    memory = Memory(warm_mb=50, rest=0) if options.smoke else Memory()
    speed = Speed(lab, memory, options.runs, [p for p in able if not p.conditions])
    made = {"cases": lambda: speed.cases(options.chosen),
            "scaling": lambda: speed.scaling(options.sizes, plotted=not options.smoke),
            "instructions": speed.instructions}
    sections = []
    try:
        for part in options.part or PARTS:
            sections.append(f"## {part.capitalize()}\n{made[part]()}")
            print(sections[-1], flush=True)
    except Failed as failure:
        sys.exit(str(failure))
    judged = "## Against the targets\n" + markdown(verdicts.HEADER, speed.verdicts)
    page = head(missing, options.runs, memory, load, begin) + [judged] * bool(speed.verdicts) + sections
    (lab.page / "speed.md").write_text("\n\n".join(page) + "\n")
    print(judged)
    lab.say(f"{lab.page / 'speed.md'} in {(time.monotonic() - begin) / 60:.0f} minutes")


if __name__ == "__main__":
    main()
