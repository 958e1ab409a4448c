"""How fast the whole program is, beside its peers: speed.py PROGRAMS WORK [--cases A,B] [--runs N] [--part PART]...

PROGRAMS holds the built programs, WORK the clouds and meshes (large). Results go to bench/results/: speed.md, speed.csv,
scaling.csv, scaling.png. PARTs are cases, scaling, instructions; all by default. Cases are 512, 1024 (the bunny's raw
scans with SOAPFILM_DATA, else as many virtual samples) and 20M.

Every program runs on one thread; runs of a case alternate between the programs and the medians are compared, in CPU
seconds: work, whatever else the machine does. For the elapsed time ours runs on two as well. Nothing is read back from
an earlier benchmark.

A virtual machine gives memory that was free for some seconds back to its host, and pays for each page of it again. So
another process uses memory, as much as any program will, right before each run, as its input was read before. What a
run takes with memory as it comes, after the peer's, is a row of its own.

Memory that is warm before a run stays so for some two seconds of it: a run at 256 gets all of its pages warm, one at 2048
hardly any. So that sizes compare like with like, nothing is warmed for the scaling series: before each of its runs the
machine rests until what is free has gone back, and every size pays for every page.
"""
import argparse
import json
import mmap
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "accuracy")]

import clouds
from inputs import Input
from lab import Lab
from peers import ENVIRONMENT, read_peers

# name: samples (None: the bunny's), resolution, what we aim at on one thread and on two; peers run where they can end
# within minutes
CASES = {"512": (None, 512, "2.5 CPU s, 350 MB", "2 s elapsed", True), "1024": (None, 1024, "9 CPU s, 1200 MB", "", True),
         "20M": (20_000_000, 1024, "25 CPU s, 1740 MB", "", False)}
SCALING = (256, 512, 1024, 2048)
SCALING_SAMPLES_PER_VOXEL2 = 1.0
WARM_MB = 2000  # more than any program has at its peak
REST = 10  # seconds, after which free memory has gone back: the kernel reports it every two
UNITS = {"KiB": 1024, "MiB": 1024**2, "GiB": 1024**3}


def warm_memory(megabytes):
    """In huge pages where there are any, lest it leaves none to the program that follows."""
    pages = megabytes * 1_000_000 // mmap.PAGESIZE
    use = f"""
import contextlib, mmap
memory = mmap.mmap(-1, {pages * mmap.PAGESIZE})
with contextlib.suppress(OSError):  # of a kernel without
    memory.madvise(mmap.MADV_HUGEPAGE)
memory[::{mmap.PAGESIZE}] = bytes({pages})
"""
    subprocess.run([sys.executable, "-I", "-S", "-c", use], check=True)


def run(lab, words, name, environment=None, warm_mb=WARM_MB):
    """`warm_mb`: of memory that another process uses just before; 0 for none."""
    if warm_mb:
        warm_memory(warm_mb)
    measured = lab.measure(words, lab.work / name, environment)
    if measured["code"]:
        sys.exit(f"{lab.shown(words)}\nexit code {measured['code']}: {measured['errors']}")
    return measured


def ours(lab, cloud, resolution, threads=1):
    return [lab.program, "reconstruct", cloud.file, "-o", lab.work / "ours.ply", "--resolution", resolution,
            "--threads", threads]


def medians(measured):
    return {k: statistics.median(m[k] for m in measured) for k in ("cpu", "system", "elapsed", "peak_mb")}


def planned_mb(errors):
    """From the line that a run prints before it begins."""
    found = re.search(r"memory ([\d.]+) ([KMG]iB)", errors)
    return float(found[1]) * UNITS[found[2]] / 1e6 if found else 0.0


def stages(lab, words, warm_mb=WARM_MB):
    """CPU seconds of each stage, from a run with --report, without the check that a report brings."""
    report = lab.work / "ours.json"
    run(lab, [*words, "--report", report], "ours", warm_mb=warm_mb)
    found = json.loads(report.read_text())
    found["cpu_seconds"]["total"] -= found["cpu_seconds"].pop("check", 0)
    return found


def measure_case(lab, name, runs, peers):
    samples, resolution, target, target_of_two, with_peers = CASES[name]
    cloud = Input(lab, samples, resolution)
    mine, on_two, as_it_comes = "soapfilm", "soapfilm, two threads", "soapfilm, memory as it comes"
    commands = {mine: ours(lab, cloud, resolution), on_two: ours(lab, cloud, resolution, threads=2)}
    for peer in peers if with_peers else []:
        commands[peer.name] = peer.words(cloud.for_peers(), lab.work / "peer.ply", cloud.voxel(resolution), resolution)
    commands[as_it_comes] = commands[mine]
    results = {program: [] for program in commands}
    for k in range(runs):
        for program, words in commands.items():
            lab.say(f"{cloud.name} at {resolution}, run {k + 1} of {runs}: {program}")
            results[program].append(run(lab, words, "speed", None if program.startswith(mine) else ENVIRONMENT,
                                        0 if program == as_it_comes else WARM_MB))
    rows = []
    for program, measured in results.items():
        median = medians(measured)
        ratio = median["cpu"] / rows[0][3] if rows else 1.0
        seconds = (round(median[k], 2) for k in ("cpu", "system", "elapsed"))
        rows.append([f"{cloud.name}, {resolution}", program, runs, *seconds, round(median["peak_mb"]),
                     round(planned_mb(measured[0]["errors"])) if program == mine else "",
                     round(ratio, 2), {mine: target, on_two: target_of_two}.get(program, "")])
    return rows, stages(lab, commands[mine])["cpu_seconds"]


def cases(lab, names, runs, peers):
    header = ["case", "program", "runs", "CPU s", "of these system", "elapsed s", "peak MB", "planned MB", "CPU ratio",
              "target"]
    rows, times = [], {}
    for name in names:
        found, times[name] = measure_case(lab, name, runs, peers)
        rows += found
    text = lab.table("speed", header, rows)
    keys = list(dict.fromkeys(stage for t in times.values() for stage in t))
    text += "\n\nCPU seconds by stage, one run each:\n\n"
    return text + lab.table("stages", ["case", *keys],
                            [[name, *(f"{t.get(k, 0):.2f}" for k in keys)] for name, t in times.items()])


def scaling(lab, sizes, runs):
    """Virtual scans with the same samples per voxel^2 at each size."""
    inputs = {n: Input(lab, clouds.samples_for(n, SCALING_SAMPLES_PER_VOXEL2), n) for n in sizes}
    measured = {n: [] for n in sizes}
    for k in range(runs):
        for resolution, cloud in inputs.items():
            for _ in range(max(1, 1024 // resolution)):  # less than a second tells little
                lab.say(f"scaling: {cloud.name} at {resolution}, run {k + 1} of {runs}")
                time.sleep(REST)
                measured[resolution].append(run(lab, ours(lab, cloud, resolution), "speed", warm_mb=0))
    rows = []
    for resolution, cloud in inputs.items():
        time.sleep(REST)
        report = stages(lab, ours(lab, cloud, resolution), warm_mb=0)
        vertices = report["grid"]["levels"][-1]["active_vertices"]
        median = medians(measured[resolution])
        spent = [median["cpu"], median["system"], report["cpu_seconds"]["solve"]]
        rows.append([resolution, cloud.samples, vertices, round(median["cpu"], 2), round(median["peak_mb"]),
                     round(planned_mb(measured[resolution][0]["errors"])),
                     *(round(1e9 * s / vertices, 1) for s in spent)])
    plot(lab, rows)
    header = ["resolution", "samples", "active vertices", "CPU s", "peak MB", "planned MB", "ns per active vertex",
              "of these system", "of one run solve"]
    return lab.table("scaling", header, rows) + "\n\n![CPU seconds against active vertices](scaling.png)"


def plot(lab, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axis = plt.subplots(figsize=(4.8, 3.4))
    vertices, cpu = [row[2] for row in rows], [row[3] for row in rows]
    axis.loglog(vertices, cpu, "o-", label="whole run")
    axis.loglog(vertices, [cpu[0] * v / vertices[0] for v in vertices], ":", color="gray", label="constant per vertex")
    for row in rows:
        axis.annotate(str(row[0]), (row[2], row[3]), textcoords="offset points", xytext=(4, -10), fontsize=8)
    axis.set_xlabel("active vertices of the finest level")
    axis.set_ylabel("CPU seconds, one thread")
    axis.grid(True, alpha=0.3)
    axis.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(lab.page / "scaling.png", dpi=110)


def instructions(lab):
    """A figure that does not depend on the machine's mood."""
    cloud = Input(lab, clouds.samples_for(96, 2.0), 96)
    words = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={lab.work / 'callgrind.out'}", *ours(lab, cloud, 96)]
    lab.say(f"callgrind: {cloud.name} at 96")
    found = re.search(r"Collected : (\d+)", run(lab, words, "speed")["errors"])
    return f"{int(found[1]) / 1e6:.0f} million instructions: {cloud.samples} virtual samples at 96, one thread (callgrind)."


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("work")
    parser.add_argument("--cases", default=",".join(CASES), help="of 512, 1024, 20M")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--sizes", default=",".join(map(str, SCALING)), help="of the scaling series")
    parser.add_argument("--part", action="append", choices=["cases", "scaling", "instructions"])
    options = parser.parse_args()
    names = options.cases.split(",")
    if unknown := [n for n in names if n not in CASES]:
        parser.error(f"case = {unknown[0]}, must be one of {', '.join(CASES)}")
    lab = Lab(options.programs, options.work, HERE.parent / "results")
    able, missing = read_peers(HERE.parent / "accuracy" / "peers.toml")
    peers = [p for p in able if not p.conditions]
    parts = options.part or ["cases", "scaling", "instructions"]
    made = {"cases": lambda: cases(lab, names, options.runs, peers),
            "scaling": lambda: scaling(lab, [int(n) for n in options.sizes.split(",")], options.runs),
            "instructions": lambda: instructions(lab)}
    page = ["# Speed of the whole program", "`make bench`; one thread unless it says two, medians, reading and writing files "
            "included. What the targets mean: `docs/performance.md`."]
    if missing:
        page.append(f"Not on this machine: {', '.join(p.name for p in missing)}.")
    titles = {"cases": "Cases", "scaling": "Scaling", "instructions": "Instructions"}
    for part in parts:
        page.append(f"## {titles[part]}\n{made[part]()}")
    text = "\n\n".join(page) + "\n"
    if options.part:
        print(text)
    else:
        (lab.page / "speed.md").write_text(text)


if __name__ == "__main__":
    main()
