"""Scenes with one voxel and with levels that adapt: adapt.py PROGRAMS WORK PAGE [--scene NAME]...

PAGE is a Markdown file. One thread; CPU seconds are ratios taken one after the other.
"""
import argparse
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # of lab.py

import scanned
from catalog import SCENES
from kit import Kit
from lab import USAGE, commit, machine

HERE = Path(__file__).resolve().parent
DENSITY = "density1000"
EVEN = "even"  # as many samples as density1000, evenly spread
OBJECTS = ("knot", "part")
WAVES = {"carved": 0.3, "carved_finely": 0.05}  # meters
VOXEL = {"carved_finely": 0.005}  # of the run with --adapt on, where it is given
NAMES = (DENSITY, EVEN, *OBJECTS, *WAVES, "yard", "street", "falloff", "depth_image", "room_inside", "facade",
         "terrain_als", "sweep_16", "sweep_64_slope", "sweep_128_hollow")


@dataclass
class Figures:
    """Of one mesh; distances in voxels of the run without --adapt."""
    voxel: float
    to_truth: float      # mean, mesh to truth
    from_truth: float    # mean, truth to mesh
    normals: float       # mean, mesh to truth, degrees
    lost: float          # share of the samples
    within: float        # 95 % of the samples are nearer to the mesh
    parts: int
    triangles: int
    cpu: float
    gap: float           # proved to be at most so far from the optimum, of it
    face: float = None   # mean, truth to mesh, of the carved face alone


class Trial:
    def __init__(self, program, work):
        self.program, self.work = program, work
        self.cpu = {}  # of the runs with --adapt on, by scene

    def run(self, *words):
        subprocess.run([self.program, *map(str, words)], check=True, capture_output=True)

    def made(self, name):
        """Folder, inputs and truth of a scene."""
        folder = self.work / name
        if name == DENSITY:
            folder.mkdir(parents=True, exist_ok=True)
            subprocess.run([sys.executable, HERE.parents[1] / "docs/guide/sparse.py", folder / "input.xyz"], check=True)
            return folder, ["input.xyz"], ["sphere", "--size", 2]
        if name == EVEN:
            self.run("scan", "sphere", "--size", 2, "-o", folder, "--samples", 60000)
            return folder, ["samples.ply"], ["sphere", "--size", 2]
        if name in OBJECTS:
            self.run("scan", name, "-o", folder, "--samples", 100000)
            return folder, ["samples.ply"], [name]
        make = scanned.carved(WAVES[name]) if name in WAVES else next(s for s in SCENES if s.name == name).make
        scan = make(Kit(folder, self.run))
        return folder, scan.inputs, [folder / scan.truth]

    def evaluated(self, mesh, truth):
        out = mesh.with_suffix(".judged.json")
        self.run("evaluate", mesh, "--truth", *truth, "--json", out)
        return json.loads(out.read_text())

    def figures(self, folder, inputs, truth, adapt, unit=None, voxel=None):
        mesh = folder / f"{adapt}.ply"
        used, report = mesh.with_suffix(".used"), mesh.with_suffix(".json")
        words = [sys.executable, USAGE, used, self.program, "reconstruct", *(folder / i for i in inputs), "-o", mesh,
                 "--adapt", adapt, "--report", report, "--threads", 1, *(["--voxel", voxel] if voxel else [])]
        subprocess.run(list(map(str, words)), check=True, capture_output=True)
        r, j = json.loads(report.read_text()), self.evaluated(mesh, truth)
        unit = unit or r["grid"]["voxel"]
        face = folder / "face.ply"
        return Figures(unit, j["mesh_to_truth"]["distance"]["mean"] / unit,
                       j["truth_to_mesh"]["distance"]["mean"] / unit, j["mesh_to_truth"]["normal_angle_deg"]["mean"],
                       r["self_check"]["lost"], r["mesh"]["sample_distance"]["percentile95"] / unit,
                       r["mesh"]["components"], r["mesh"]["triangles"],
                       float(used.read_text().split()[1]), r["certificate"]["relative_gap_binary"],
                       self.evaluated(mesh, [face])["truth_to_mesh"]["distance"]["mean"] / unit if face.exists() else None)

    def row(self, name):
        folder, inputs, truth = self.made(name)
        off = self.figures(folder, inputs, truth, "off")
        on = self.figures(folder, inputs, truth, "on", off.voxel, VOXEL.get(name))
        self.cpu[name] = on.cpu
        both = lambda form, key: " / ".join(format(getattr(f, key), form) for f in (off, on))
        face = "" if off.face is None else f"; its face {off.face:.3f} / {on.face:.3f}"
        return (f"| {name} | {both('.3f', 'to_truth')} | {both('.3f', 'from_truth')}{face} | {both('.1f', 'normals')} | "
                f"{both('.2%', 'lost')} | {both('.3f', 'within')} | {both('d', 'parts')} | {on.triangles / off.triangles:.2f} | "
                f"{on.cpu / off.cpu:.2f} | {both('.1%', 'gap')} |")


HEAD = """# Levels that adapt, measured

`make adapt`: scenes of [the scenes' page](../scenes/README.md), `density1000` of the guide's
[page](../guide/sparse.md), a ball of as many samples evenly spread (`even`), two objects, and a stone 1.5 m
from the scanner, on a floor out to 20 m: `carved` with waves of 30 cm, `carved_finely` of 5 cm, with `--voxel 0.005` where levels adapt. Each pair is `--adapt off` / `--adapt on`; distances are
means in voxels of the run without. Truth that no scanner saw counts in the third column. The gap is the certificate's:
with levels that of all of them together.

| scene | mesh to truth | truth to mesh | normals, degrees | samples lost | 95 % of them within | parts | triangles | CPU | gap |
|---|---|---|---|---|---|---|---|---|---|
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "work", "page"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--scene", action="append", choices=NAMES)
    options = parser.parse_args()
    trial = Trial(options.programs.resolve() / "soapfilm", options.work.resolve())
    rows = []
    for name in options.scene or NAMES:
        rows.append(trial.row(name))
        print(rows[-1], flush=True)
    if not options.scene:
        ratio = trial.cpu[DENSITY] / trial.cpu[EVEN]
        rows.append(f"\nWith levels, {DENSITY} costs {ratio:.1f} times the CPU seconds of {EVEN}.")
        options.page.write_text(HEAD + "\n".join(rows) + f"\n\nMeasured on {machine()}; program of commit {commit()}.\n")


if __name__ == "__main__":
    main()
