"""The same bytes however a scene is held: same_bytes.py PROGRAMS WORK PAGE [--scene NAME]... [--finer TIMES]

Scenes of bench/scenes, reconstructed in memory on one thread, on two, with arrays on disk in a half of the memory that
this plans and in little more than the least that is taken, and by 2, 3, 4 and 7 processes (as root), on one thread or
two. With a voxel so many times finer they are large enough for windows: in control groups of 1/2, 1/4 and 1/8 of what
they use in memory. Meshes must have the same bytes, reports the same values but for times, memory and ranks. PAGE gets
a line."""
import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path += [str(HERE), str(HERE.parent / "scenes")]

import marked
import scratch
from catalog import SCENES
from kit import Kit

RANKS = (2, 3, 4, 7)
PARTS = (2, 4, 8)
MIB = 1 << 20
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]
OF_THE_RUN = ("seconds", "cpu_seconds", "memory", "ranks", "command", "parameters")


class Differences:
    """Runs of one scene, beside the first."""

    def __init__(self, programs, folder, inputs):
        self.programs, self.folder = programs, folder
        self.inputs = [folder / name for name in inputs]
        self.scratch = folder / "scratch"
        self.scratch.mkdir(exist_ok=True)
        self.first, self.found = None, []
        self.least = self.planned = self.used = 0
        self.was_on_disk = False
        self.runs = self.refused = self.on_disk = 0

    def result(self, before, *words, group=None):
        """Digest of the mesh, and the report; None where it does not fit."""
        mesh, report = self.folder / "same.ply", self.folder / "same.json"
        mesh.unlink(missing_ok=True)
        program = self.programs / ("soapfilm-mpi" if before else "soapfilm")
        words = [*before, program, "reconstruct", *self.inputs, "-o", mesh, "--report", report, *words]
        run = subprocess.run(list(map(str, words)), capture_output=True, text=True,
                             preexec_fn=group.join if group else None)
        self.was_on_disk = "on disk in" in run.stderr
        needed = re.search(r"needs? about ([\d.]+) (MiB|GiB), (?:--memory|free memory) is", run.stderr)
        if needed and run.returncode == 2 and not mesh.exists():
            self.least = float(needed[1]) * (MIB if needed[2] == "MiB" else 1024 * MIB)
            return None
        if run.returncode:
            sys.exit(f"{' '.join(map(str, words))}\nexit code {run.returncode}: {run.stderr}")
        values = json.loads(report.read_text())
        self.planned, self.used = values["memory"]["planned_bytes"], values["memory"]["peak_bytes"]
        return scratch.digest(mesh), {k: v for k, v in values.items() if k not in OF_THE_RUN}

    def compare(self, name, before, *words, group=None):
        found = self.result(before, *words, group=group)
        self.runs += 1
        self.on_disk += found is not None and self.was_on_disk
        if found is None:
            self.refused += 1
        elif self.first is None:
            self.first = found
        else:
            self.found += [f"{name}: {what}" for k, what in enumerate(("mesh", "report")) if found[k] != self.first[k]]

    def all(self):
        self.compare("memory", [], "--threads", 1)
        whole = self.planned
        self.compare("2 threads", [], "--threads", 2)
        on_disk = lambda bytes: ["--memory", f"{bytes:.0f}", "--scratch", self.scratch]
        self.compare("half", [], *on_disk(whole / 2), "--threads", 1)
        self.least = MIB
        while self.result([], *on_disk(self.least)) is None:  # it says what it needs, once for the samples
            self.least *= 1.02
        self.compare("least", [], *on_disk(self.least), "--threads", 2)
        for k, count in enumerate(RANKS):
            self.compare(f"{count} ranks", [*MPIRUN, count], "--threads", 1 + k % 2)

    def windows(self, finer):
        """At a finer voxel, its arrays on disk, in control groups with parts of the memory that it uses without."""
        self.result([])
        report = json.loads((self.folder / "same.json").read_text())
        voxel = ["--voxel", repr(report["grid"]["voxel"] / finer)]
        self.first = None
        self.compare("finer", [], *voxel, "--threads", 1)
        whole = self.used
        for k, part in enumerate(PARTS):
            group = scratch.Group(whole // part)
            try:
                self.compare(f"finer, 1/{part}", [], *voxel, "--scratch", self.scratch, "--threads", 1 + k % 2, group=group)
            finally:
                group.remove()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "work", "page"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--scene", action="append", choices=[s.name for s in SCENES])
    parser.add_argument("--finer", type=float)
    options = parser.parse_args()
    programs = options.programs.resolve()
    run = lambda *words: subprocess.run([programs / "soapfilm", *map(str, words)], check=True, capture_output=True)
    names = options.scene or [s.name for s in SCENES]
    runs = refused = on_disk = 0
    found = []
    for scene in SCENES:
        if scene.name not in names:
            continue
        folder = options.work.resolve() / scene.name
        trial = Differences(programs, folder, scene.make(Kit(folder, run)).inputs)
        if options.finer:
            trial.windows(options.finer)
        else:
            trial.all()
        print(scene.name, trial.runs, "runs,", trial.refused, "refused,", trial.on_disk, "on disk;", trial.found or "same",
              flush=True)
        runs, refused, on_disk = runs + trial.runs, refused + trial.refused, on_disk + trial.on_disk
        found += [f"{scene.name}, {what}" for what in trial.found]
    line = (f"{len(names)} scenes, {runs} runs, {on_disk} of them on disk, {refused} refused as too large for the memory: "
            f"{'; '.join(found) or 'no other byte'}.")
    if options.finer:
        line = f"At a voxel {options.finer:g} times finer, in 1/2, 1/4 and 1/8 of what they use: {line}"
    marked.write(options.page, "same_bytes.py --finer" if options.finer else "same_bytes.py", line + "\n")


if __name__ == "__main__":
    main()
