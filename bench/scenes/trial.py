"""Runs one scene: makes it, reconstructs it by soapfilm and by the peer, judges both. All of it resumable."""
import json
import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

import geometry
from geometry import read_mesh
from judge import Judge, Surface, Verdict, on_surface, trimmed
from kit import Kit, Made

HERE = Path(__file__).resolve().parent
PEER = "Open3D's screened Poisson"
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}  # CPU seconds are work, not waiting
LIMITS = ("timeout", "600", "prlimit", f"--as={8 * 2**30}")           # of any run: ten minutes, 8 GiB
LOST_TO_NOISE = 0.005  # share of the samples from which on it is asked whether the truth loses them, too
MAKERS = ("airborne", "clouds", "depth_camera", "geometry", "kit", "rays", "scanned", "sweeps", "thin", "writers")
FACTOR = 3  # judged at our voxel, but at most so many times the scene's spacing, and at least that part of it


@dataclass
class Entry:
    """One program on one scene."""
    verdict: Verdict = None
    failure: str = ""
    cpu: float = 0
    peak_mb: float = 0
    warnings: list = field(default_factory=list)
    active: int = 0              # vertices of the finest level
    planned_mb: float = 0
    converged: bool = None
    gap: float = None            # of the thresholded solution


@dataclass
class Result:
    scene: object
    samples: int
    voxel: float = None          # the program's own choice
    judged_voxel: float = 0      # at which the peer ran and both are judged
    ours: Entry = None
    peer: Entry = None
    trimmed: Entry = None
    truth_lost: float = None     # samples farther than 3 voxels from the truth itself: noise; where we lose many
    copy_distance: tuple = None  # mean, 95 % of the distances to the surface of one copy, voxels
    files: tuple = ()            # meshes for the picture


class Trial:
    def __init__(self, lab):
        self.lab = lab
        self.makers = [HERE / f"{name}.py" for name in MAKERS]

    def prepare(self, scene):
        """The scene's folder; made anew when its makers or the program change."""
        folder = self.lab.work / scene.name
        stamp = folder / "stamp.txt"
        key = " ".join(self.lab.digest(p) for p in (*self.makers, self.lab.program))
        if stamp.exists() and stamp.read_text() == key:
            return folder
        self.lab.say(f"make {scene.name}")
        scene.make(Kit(folder, self.soapfilm)).save(folder)
        stamp.write_text(key)
        return folder

    def soapfilm(self, *words):
        subprocess.run([str(self.lab.program), *map(str, words), "--quiet", "--threads", "1"], check=True)

    def plain(self, text):
        """What the program says, without a path of this machine."""
        return text.replace(f"{self.lab.work}/", "").replace(f"{self.lab.data}/", "$SOAPFILM_DATA/")

    def reconstruct(self, name, inputs, *options):
        mesh, report = self.lab.work / f"{name}.ply", self.lab.work / f"{name}.json"
        words = [*LIMITS, self.lab.program, "reconstruct", *inputs, "-o", mesh, "--report", report, "--threads", 1,
                 "--quiet", *options]
        measured = self.lab.once(f"{name}.run", words, [self.lab.program, inputs[0].parent], mesh, label=name)
        entry = Entry(cpu=measured["cpu"], peak_mb=measured["peak_mb"])
        if measured["code"]:
            lines = measured["errors"].strip().splitlines()
            said = lines[-1].removeprefix("soapfilm: ") if lines else f"exit code {measured['code']}"
            entry.failure = self.plain(said)
            return mesh, entry, None
        facts = json.loads(report.read_text())
        levels, certificate = facts["grid"]["levels"], facts["certificate"] or {}
        entry.warnings = [self.plain(w) for w in facts["warnings"]]
        entry.planned_mb = facts["memory"]["planned_bytes"] / 1e6
        if levels:
            entry.active, entry.converged = levels[-1]["active_vertices"], all(k["converged"] for k in levels)
        entry.gap = certificate.get("relative_gap_binary")
        return mesh, entry, facts["grid"]["voxel"]

    def poisson(self, scene, made, voxel):
        cloud, mesh = self.lab.work / f"{scene.name}.cloud.npz", self.lab.work / f"{scene.name}.poisson.npz"
        known = {k: v for k in ("positions", "normals", "sensors") if (v := getattr(made, k)) is not None}
        np.savez(cloud, **known)
        words = [*LIMITS, sys.executable, "-B", HERE / "open3d_poisson.py", cloud, mesh, f"{voxel:.9g}"]
        measured = self.lab.once(f"{scene.name}.poisson.run", words, [HERE / "open3d_poisson.py", cloud], mesh,
                                 f"{scene.name}: {PEER}", ENVIRONMENT)
        entry = Entry(cpu=measured["cpu"], peak_mb=measured["peak_mb"])
        if measured["code"]:
            entry.failure = (measured["errors"].strip().splitlines() or [f"exit code {measured['code']}"])[-1]
            return None, entry
        with np.load(mesh) as found:
            return tuple(found[k] for k in ("vertices", "triangles", "densities")), entry

    def run(self, scene):
        folder = self.prepare(scene)
        made = Made.load(folder)
        told = ["--trajectory", folder / made.trajectory] if made.trajectory else []
        mesh, ours, voxel = self.reconstruct(f"{scene.name}.soapfilm", [folder / name for name in made.inputs], *told)
        judged_at = min(max(voxel or scene.spacing, scene.spacing / FACTOR), scene.spacing * FACTOR)
        result = Result(scene, len(made.positions), voxel, judged_at, ours)
        judged = scene.reach(made.positions, judged_at) if scene.reach else None
        judge = Judge(made, judged_at, judged, read_mesh(folder / made.truth) if made.truth else None)
        if not ours.failure:
            ours.verdict = judge(*read_mesh(mesh))
        poisson, result.peer = self.poisson(scene, made, judged_at)
        shown = [mesh if ours.verdict else None]
        if poisson:
            result.peer.verdict = judge(*poisson[:2])
            loss = ours.verdict.lost if ours.verdict else 0
            stays = trimmed(judge, *poisson, loss)
            result.trimmed = Entry(judge(poisson[0], stays))
            shown.append(self.lab.work / f"{scene.name}.trimmed.ply")
            geometry.write_mesh(shown[-1], (poisson[0], stays))
        whole = made.truth and made.sided is None  # a forest's truth is the ground alone
        if whole and ours.verdict and ours.verdict.lost > LOST_TO_NOISE:
            result.truth_lost = judge.lost(*read_mesh(folder / made.truth))
        result.files = tuple(shown)
        if scene.copy_of and ours.verdict:
            result.copy_distance = self.distance_to_one(scene, folder, mesh, judged_at)
        self.keep(result)
        return result

    def distance_to_one(self, scene, folder, mesh, voxel):
        """From the surface of the copies to that of one of them, both by defaults."""
        one = self.lab.work / f"{scene.name}-one"
        one.mkdir(exist_ok=True)
        (one / "one.ply").write_bytes((folder / scene.copy_of).read_bytes())
        single, entry, _ = self.reconstruct(f"{scene.name}.one", [one / "one.ply"])
        if entry.failure:
            return None
        points, _ = on_surface(*read_mesh(mesh), 100000, np.random.default_rng(2))
        distance = Surface(*read_mesh(single), voxel).nearest(points)[0] / voxel
        return float(distance.mean()), float(np.quantile(distance, 0.95))

    def keep(self, result):
        words = asdict(result) | {"scene": result.scene.name, "files": [str(f) for f in result.files]}
        (self.lab.work / f"{result.scene.name}.result.json").write_text(json.dumps(words, indent=1))
