"""How far surfaces are from the truth: accuracy.py PROGRAMS WORK PAGE [--full] [--jobs N] [--shape S]...

PROGRAMS holds the built programs, WORK clouds and meshes (large), PAGE what is published: README.md, runs.csv, plots,
pictures. An interrupted run goes on where it stopped. A selection (--shape, --condition, --method, --cells, --kept)
goes to a folder of its own, WORK/selection, and is printed.
"""
import argparse
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # of lab.py, which all benchmarks share

import page
import plots
from cases import BASE, CONDITIONS, METHODS, SHAPES, plan, sizes_of
from lab import Lab
from peers import HERE, read_peers
from results import Results
from scans import bunny
from trial import Trial


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "work", "page"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--full", action="store_true", help="all conditions at all voxel sizes")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time, each on one thread")
    parser.add_argument("--cells", type=int, default=BASE, help="voxels along the longest side")
    parser.add_argument("--kept", action="store_true", help="run nothing: the page of what an interrupted run has made")
    for name, known in (("shape", SHAPES), ("condition", CONDITIONS)):
        parser.add_argument(f"--{name}", action="append", choices=[k.name for k in known], help="only these")
    parser.add_argument("--method", action="append", help="only these methods and peers")
    return parser.parse_args()


def chosen(entries, names):
    return [e for e in entries if not names or e.name in names]


def measure(lab, trial, cases, jobs):
    """Runs all cases, clouds before methods, so that no two of them write one file."""
    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(trial.prepare, dict.fromkeys(c.shape for c in cases)))
        first = {c.cloud: c for c in cases}
        clouds = dict(zip(first, pool.map(trial.scan, first.values())))
        has_peer = {c.cloud for c in cases if not hasattr(c.method, "ours")}
        list(pool.map(trial.oriented, (clouds[name] for name in has_peer)))
        lab.say(f"{len(clouds)} clouds, {len(cases)} runs")
        return [row for row in pool.map(lambda case: trial.run(case, clouds[case.cloud]), cases) if row]


def chosen_methods(names):
    """Ours, the peers that are there, and the names of those that are not."""
    peers, absent = read_peers(HERE / "peers.toml")
    known = [m.name for m in (*METHODS, *peers, *absent)]
    for name in names or ():
        if name not in known:
            sys.exit(f"method = {name}, must be one of {', '.join(known)}")
    return chosen(METHODS, names), peers, [p.name for p in absent]


def write_page(lab, trial, rows, cases, contents, whole):
    results, cells = Results(rows, contents.reference), contents.sizes[0]
    plots.error_over_voxel(lab, results, contents.shapes)
    plots.error_over_noise(lab, results, contents.shapes, contents.conditions, cells)
    contents.worst = plots.worst_cases(lab, trial, results, cases, cells)
    if whole:
        contents.scans, contents.share = bunny(lab)
    contents.commit = subprocess.run(["git", "describe", "--always"], capture_output=True, text=True).stdout.strip()
    return page.write(lab, contents, results)


def main():
    options = arguments()
    selection = options.shape or options.condition or options.method or options.cells != BASE or options.kept
    lab = Lab(options.programs, options.work, options.work / "selection" if selection else options.page)
    begin = time.monotonic()
    shapes = [s for s in chosen(SHAPES, options.shape) if not s.file or lab.real(s.file)]
    conditions = chosen(CONDITIONS, options.condition)
    own, peers, absent = chosen_methods(options.method)
    cases = plan(shapes, conditions, own, chosen(peers, options.method), options.cells, options.full)
    lab.runs_nothing = options.kept
    trial = Trial(lab)
    rows = measure(lab, trial, cases, options.jobs)
    contents = page.Contents(rows, shapes, conditions, sizes_of(options.cells, options.full), peers, absent)
    text = write_page(lab, trial, rows, cases, contents, whole=not selection)
    if selection:
        print(text)
    lab.say(f"{lab.page / 'README.md'} in {(time.monotonic() - begin) / 60:.0f} minutes")


if __name__ == "__main__":
    main()
