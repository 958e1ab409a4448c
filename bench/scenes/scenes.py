"""Scenes as people scan them, beside a peer: scenes.py PROGRAMS WORK PAGE [--scene NAME]... [--jobs N]

PROGRAMS holds the built programs, WORK clouds and meshes (large), PAGE what is published. An interrupted run goes on
where it stopped. A selection goes to a folder of its own, WORK/selection, and is printed.
"""
import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # of lab.py, which all benchmarks share

import page
import pictures
import real
import verdicts
from catalog import SCENES
from geometry import area, read_mesh
from kit import Made
from lab import Lab, commit, machine
from trial import FACTOR, PEER, Trial


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "work", "page"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--scene", action="append", choices=[s.name for s in SCENES], help="only these")
    parser.add_argument("--jobs", type=int, default=1, help="scenes at a time, each on one thread")
    return parser.parse_args()


def bunny(lab, trial):
    """CPU seconds per active vertex of the bunny's raw scans at 512; None without SOAPFILM_DATA."""
    conf = lab.real("bunny/bun.conf")
    if conf is None:
        return None
    _, entry, _ = trial.reconstruct("bunny-512", [conf], "--resolution", 512)
    return None if entry.failure else entry.cpu / entry.active


def main():
    options = arguments()
    lab = Lab(options.programs, options.work, options.work / "selection" if options.scene else options.page)
    trial = Trial(lab)
    chosen = [s for s in SCENES if not options.scene or s.name in options.scene]
    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(trial.run, chosen))
        recorded = [] if options.scene else list(pool.map(lambda file: real.run(trial, file), real.REAL))
    areas, drawn = {}, {}
    for r in results:
        folder = lab.work / r.scene.name
        made = Made.load(folder)
        if made.truth:
            areas[r.scene.name] = area(read_mesh(folder / made.truth))
        name = pictures.draw(lab, r, pictures.box_of(made))
        if name:
            drawn[r.scene.name] = name
    rows = verdicts.all_rows(results, areas, bunny(lab, trial), recorded)
    minutes = sum(lab.cpu.values()) / 60
    measured = (f"Measured on {machine()}, one thread for each run, {minutes:.0f} minutes of CPU time in all; program "
                f"of commit {commit()}.")
    text = page.write(lab, results, rows, drawn, measured, PEER, FACTOR, recorded)
    if options.scene:
        print(text)
    lab.say(str(lab.page / "README.md"))


if __name__ == "__main__":
    main()
