"""What a scene's maker works with: a folder, random numbers, the virtual scanner."""
import json
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent / "accuracy"))  # of peers.py, which reads scans

import geometry
from peers import columns, posed_scans, read_vertices


@dataclass
class Made:
    """A scene's files and what is known of its samples."""
    inputs: list                     # names of files in the folder: what the programs get
    positions: np.ndarray            # all samples, as in the files
    normals: np.ndarray = None       # as in the files; zero: none
    sensors: np.ndarray = None       # where each sample's scanner stood, if the files say it
    good: np.ndarray = None          # mask: neither outlier nor ghost; None: all of them
    outward: np.ndarray = None       # true normal of each sample where the generator knows it
    towards: np.ndarray = None       # scanner of each sample, whether the files say it or not
    sided: np.ndarray = None         # mask: whose side is judged; None: all of them
    truth: str = ""                  # mesh in the folder
    trajectory: str = ""             # file in the folder: where the scanner was at each time

    def save(self, folder):
        arrays = {k: v for k, v in vars(self).items() if isinstance(v, np.ndarray)}
        np.savez(folder / "made.npz", **arrays)
        words = {"inputs": self.inputs, "truth": self.truth, "trajectory": self.trajectory}
        (folder / "made.json").write_text(json.dumps(words))

    @classmethod
    def load(cls, folder):
        with np.load(folder / "made.npz") as arrays:
            return cls(**json.loads((folder / "made.json").read_text()), **dict(arrays))


@dataclass
class Kit:
    folder: Path
    run: callable                    # words of the program, such as ["scan", "room"]
    seed: int = 1
    rng: np.random.Generator = field(init=False)

    def __post_init__(self):
        self.folder.mkdir(parents=True, exist_ok=True)
        self.rng = np.random.default_rng(self.seed)

    def even(self, thing, count, *words, outliers=0.0):
        """Even samples of a shape, a scene or a mesh: positions, true normals, whether each is no outlier."""
        self.run("scan", thing, "-o", self.folder, "--samples", count, "--seed", self.seed, "--outliers", outliers,
                 *words)
        vertices = read_vertices(self.folder / "samples.ply")
        (self.folder / "samples.ply").unlink()
        return columns(vertices, "x", "y", "z"), columns(vertices, "nx", "ny", "nz")

    def scan(self, thing, *words, mesh=None):
        """Range scans: what soapfilm scan writes, as Made. `thing` names a scene or shape, or a file for `mesh`."""
        if mesh is not None:
            geometry.write_mesh(self.folder / thing, mesh)
            thing = self.folder / thing
        self.run("scan", thing, "-o", self.folder, "--seed", self.seed, "--normals", *words)
        parts = [(columns(read_vertices(path), "x", "y", "z"), columns(read_vertices(path), "nx", "ny", "nz"), turn,
                  shift) for path, turn, shift in posed_scans(self.folder / "scans.conf")]
        positions = np.concatenate([p @ turn + shift for p, _, turn, shift in parts])
        normals = np.concatenate([n @ turn for _, n, turn, _ in parts])
        sensors = np.concatenate([np.broadcast_to(shift, p.shape) for p, _, _, shift in parts])
        self.run("scan", thing, "-o", self.folder, "--seed", self.seed, *words)  # without normals: what is read
        return Made(["scans.conf"], positions, sensors=sensors, good=np.any(normals != 0, axis=1), outward=normals,
                    towards=sensors, truth="truth.ply")

    def cloud(self, positions, normals=None, truth=None, **known):
        """One PLY; `truth` is a mesh, or the name of one in the folder."""
        weights = known.pop("weights", None)
        geometry.write_cloud(self.folder / "input.ply", positions, normals, known.get("sensors"), weights)
        return self.made(["input.ply"], positions, normals, truth, **known)

    def bare(self, positions, digits, truth=None, **known):
        """One XYZ without anything but positions."""
        np.savetxt(self.folder / "input.xyz", positions, f"%.{digits}f")
        return self.made(["input.xyz"], positions, None, truth, **known)

    def made(self, inputs, positions, normals=None, truth=None, **known):
        if truth is not None and not isinstance(truth, str):
            geometry.write_mesh(self.folder / "truth.ply", truth)
            truth = "truth.ply"
        return Made(inputs, positions, normals, truth=truth or "", **known)
