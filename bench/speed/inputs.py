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


def virtual(lab, samples, resolution):
    path = lab.work / f"virtual-{samples}-{resolution}.ply"
    if not path.exists():
        lab.say(f"{samples} virtual samples")
        clouds.write(path, samples, resolution)
    return path


class Input:
    """A cloud: its file, the file for peers (made when first asked for) and the voxel of a resolution."""

    def __init__(self, lab, samples=None, resolution=None):
        self.lab = lab
        bunny = lab.real("bunny/bun.conf") if samples is None else None
        self.samples = samples or BUNNY_SAMPLES
        self.file = bunny or virtual(lab, self.samples, resolution or 512)
        self.is_bunny = bunny is not None
        self.name = "bunny, raw scans" if self.is_bunny else f"{self.samples} virtual samples"

    def voxel(self, resolution):
        if not self.is_bunny:
            return clouds.voxel(resolution)
        return BUNNY_EXTENT / (resolution - 2 * clouds.PADDING)

    def for_peers(self):
        path = self.lab.work / f"oriented-{self.samples}-{'bunny' if self.is_bunny else 'virtual'}.ply"
        if not path.exists():
            write_oriented(path, *(oriented_scans(self.file) if self.is_bunny
                                   else oriented_virtual(self.file, self.samples)))
        return path
