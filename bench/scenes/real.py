"""Scans that real instruments recorded, by defaults: real.py PROGRAMS WORK [--file NAME]... [--mesh FILE [--voxel V]]

Prints one line for each file of $SOAPFILM_DATA/real. Shares are in percent, lengths in voxels, times in CPU seconds.
--mesh judges a mesh that is there already, with one --file: at --voxel, or at the voxel of the report beside the mesh
(same name, .json).
"""
import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent))  # of lab.py, which all benchmarks share

from geometry import read_mesh
from judge import Judge
from kit import Made
from lab import Lab
from readers import read_points
from trial import Trial

COLUMN = 2.0  # edge of the columns whose lowest sample is ground, in the unit of the file
GROUND = 2    # LAS class


@dataclass(frozen=True)
class Real:
    name: str                    # of the file, or of the folder of its frames
    title: str
    kind: str                    # of verdicts.LIMITS
    sensor: tuple = None         # where it was seen from when the file does not say; None: from above
    options: tuple = ()          # what a user must tell beside the file
    forest: bool = False         # only the ground's side is known


REAL = (
    Real("autzen-thin.las", "airborne survey of a town and a river", "airborne ground"),
    Real("hexbin-crop.las", "airborne survey of a slope", "airborne ground"),
    Real("outcrop.las", "a rock face from above and the side", "airborne ground"),
    Real("4_6_crop.las", "airborne survey of a forest", "airborne forest", forest=True),
    Real("MixedConifer.las", "airborne survey of conifers", "airborne forest", forest=True),
    Real("000094.bin", "one sweep of 64 rings in a street", "sweep", (0, 0, 0)),
    Real("target.ply", "one sweep of another scanner, positions alone", "sweep", (0, 0, 0), ("--sensor", "0,0,0")),
    Real("cloud_bin_0.ply", "50 fused depth frames of a room", "room with camera", (0, 0, 0), ("--sensor", "0,0,0")),
    Real("rgbd", "20 posed frames of a depth camera", "depth frames"),
    Real("five_people.pcd", "one depth image of five people", "depth frames", (0, 0, 0)),
)


def files_of(lab, real):
    """The input files, or none where SOAPFILM_DATA does not have them."""
    path = lab.real(f"real/{real.name}")
    if path is None:
        return []
    return sorted(path.glob("*.ply")) if path.is_dir() else [path]


def lowest(positions, edge=COLUMN):
    """Mask of the lowest sample of each column."""
    cell = np.floor((positions[:, :2] - positions[:, :2].min(axis=0)) / edge).astype(np.int64)
    order = np.lexsort((positions[:, 2], cell[:, 1], cell[:, 0]))
    first = np.ones(len(order), bool)
    first[1:] = (np.diff(cell[order], axis=0) != 0).any(axis=1)
    mask = np.zeros(len(order), bool)
    mask[order[first]] = True
    return mask


def ground(cloud):
    if cloud.classes is not None and (cloud.classes == GROUND).any():
        return cloud.classes == GROUND
    return lowest(cloud.positions)


def made_of(real, files):
    """What the judge needs to know of a file: where each sample was seen from, and whose side is known."""
    clouds = [read_points(path) for path in files]
    positions = np.concatenate([c.positions for c in clouds])
    towards = []
    for cloud in clouds:
        place = cloud.sensor if cloud.sensor is not None else real.sensor
        seen = cloud.positions + (0, 0, 1.0) if place is None else np.broadcast_to(place, cloud.positions.shape)
        towards.append(np.asarray(seen, float))
    sided = np.concatenate([ground(c) for c in clouds]) if real.forest else None
    return Made([], positions, towards=np.concatenate(towards), sided=sided)


@dataclass
class RealResult:
    """`skipped`: why there is no figure; `entry.failure`: that the program gave no surface."""
    real: Real
    samples: int = 0
    voxel: float = None
    entry: object = None
    skipped: str = ""


def run(trial, real):
    files = files_of(trial.lab, real)
    if not files:
        missing = "SOAPFILM_DATA is not set" if trial.lab.data is None else "SOAPFILM_DATA lacks it"
        return RealResult(real, skipped=missing)
    mesh, entry, voxel = trial.reconstruct(f"real-{Path(real.name).stem}", files, *real.options)
    made = made_of(real, files)
    if not entry.failure:
        entry.verdict = Judge(made, voxel)(*read_mesh(mesh))
    return RealResult(real, len(made.positions), voxel, entry)


HEADER = ("file", "lost", "wrong", "shells", "invented", "parts", "p95", "cpu", "MB", "planned", "voxel")


def line(name, verdict, voxel, entry=None):
    share = lambda v: "-" if v is None else f"{100 * v:.2f}"
    cost = ("-", "-", "-") if entry is None else (f"{entry.cpu:.1f}", f"{entry.peak_mb:.0f}",
                                                  f"{entry.planned_mb:.0f}")
    cells = (name, share(verdict.lost), share(verdict.wrong_side), share(verdict.shells), share(verdict.invented),
             str(verdict.components), f"{verdict.p95:.2f}", *cost, f"{voxel:.4g}")
    return aligned(cells)


def aligned(cells):
    return f"{cells[0]:<18}" + "".join(f"{c:>9}" for c in cells[1:])


def judge_mesh(lab, real, mesh, voxel):
    """A mesh that somebody else made of one file."""
    files = files_of(lab, real)
    if not files:
        sys.exit(f"real.py: there is no $SOAPFILM_DATA/real/{real.name}")
    report = mesh.with_suffix(".json")
    if voxel is None and not report.exists():
        sys.exit(f"real.py: --voxel is needed, or the mesh's report {report}")
    voxel = voxel or json.loads(report.read_text())["grid"]["voxel"]
    return line(real.name, Judge(made_of(real, files), voxel)(*read_mesh(mesh)), voxel)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("programs", "work"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--file", action="append", choices=[r.name for r in REAL], help="only these")
    parser.add_argument("--mesh", type=Path, help="judge this mesh of the one --file")
    parser.add_argument("--voxel", type=float, help="at which the mesh is judged")
    options = parser.parse_args()
    lab = Lab(options.programs, options.work, options.work)
    chosen = [r for r in REAL if not options.file or r.name in options.file]
    if options.mesh and len(chosen) != 1:
        parser.error("--mesh needs one --file")
    print(aligned(HEADER))
    if options.mesh:
        print(judge_mesh(lab, chosen[0], options.mesh, options.voxel))
        return
    trial = Trial(lab)
    for real in chosen:
        result = run(trial, real)
        entry = result.entry
        if result.skipped or entry.failure:
            print(f"{real.name:<18} {result.skipped or entry.failure}", flush=True)
        else:
            print(line(real.name, entry.verdict, result.voxel, entry), flush=True)


if __name__ == "__main__":
    main()
