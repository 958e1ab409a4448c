"""What the speed benchmark reads: the bunny's raw scans or virtual ones, and the same oriented for peers."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "accuracy"))

import clouds
from peers import posed_scans, towards, write_oriented

BUNNY_SAMPLES = 362272
BUNNY_EXTENT = 0.17565  # longest side of its samples' box, the file's units


def ascii_vertices(path):
    """x y z of an ASCII PLY whose rows begin with them."""
    with open(path) as file:
        count = 0
        for line in file:
            if line.startswith("element vertex "):
                count = int(line.split()[2])
            if line.strip() == "end_header":
                break
        return np.loadtxt(file, max_rows=count, usecols=(0, 1, 2))


def oriented_scans(conf):
    """Positions and viewing directions of a scan set without sensors: a scan's is its local +Z."""
    positions, directions = [], []
    for path, rotation, shift in posed_scans(conf):
        local = ascii_vertices(path)
        positions.append(local @ rotation + shift)
        directions.append(np.tile(np.array([0, 0, 1]) @ rotation, (len(local), 1)))
    return np.concatenate(positions), np.concatenate(directions)


def oriented_virtual(path, samples):
    with open(path, "rb") as file:
        while file.readline() != b"end_header\n":
            pass
        positions = np.fromfile(file, "<f4", 3 * samples).reshape(-1, 3).astype(float)
    counts = [samples * (k + 1) // clouds.SCANS - samples * k // clouds.SCANS for k in range(clouds.SCANS)]
    sensors = np.repeat(clouds.sensors(), counts, axis=0)
    return positions, towards(sensors, positions)


def made(path, make):
    """`path`, which `make` writes unless it is there. It gets its name when it is whole."""
    if not path.exists():
        partial = path.with_name(f"partial-{path.name}")
        make(partial)
        partial.replace(path)
    return path


class Input:
    """A cloud: its file, the file for peers (made when first asked for) and the voxel of a resolution.

    Files that are made are kept between runs. Their names say what they hold: samples, resolution (which sets the
    noise) and a digest of the code that makes them."""

    def __init__(self, lab, samples=None, resolution=None):
        self.lab = lab
        bunny = lab.real("bunny/bun.conf") if samples is None else None
        self.samples = samples or BUNNY_SAMPLES
        self.is_bunny = bunny is not None
        self.name = "bunny, raw scans" if self.is_bunny else f"{self.samples} virtual samples"
        self.file = bunny or self.virtual(resolution or 512)
        self.oriented = lab.work / f"oriented-{self.file.stem}-{lab.digest(__file__)[:8]}.ply"

    def virtual(self, resolution):
        path = self.lab.work / f"virtual-{self.samples}-{resolution}-{self.lab.digest(clouds.__file__)[:8]}.ply"
        if not path.exists():
            self.lab.say(self.name)
        return made(path, lambda partial: clouds.write(partial, self.samples, resolution))

    @property
    def files(self):
        return [path for path, _, _ in posed_scans(self.file)] if self.is_bunny else [self.file]

    @property
    def megabytes(self):
        return sum(path.stat().st_size for path in self.files) / 1e6

    def voxel(self, resolution):
        if not self.is_bunny:
            return clouds.voxel(resolution)
        return BUNNY_EXTENT / (resolution - 2 * clouds.PADDING)

    def for_peers(self):
        def oriented():
            return oriented_scans(self.file) if self.is_bunny else oriented_virtual(self.file, self.samples)
        return made(self.oriented, lambda partial: write_oriented(partial, *oriented()))

    def read_once(self):
        """So that every run finds its files in the page cache."""
        for path in [*self.files, *([self.oriented] if self.oriented.exists() else [])]:
            with open(path, "rb") as file:
                while file.read(1 << 24):
                    pass
