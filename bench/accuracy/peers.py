"""Peers: other programs, known by the command templates of peers.toml, and the clouds in the form they read."""
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}  # CPU seconds are work, not waiting


@dataclass(frozen=True)
class Peer:
    name: str
    command: str
    check: str = ""
    voxels: tuple = ()           # over ours, tried beside 1 where the samples are noisy
    conditions: tuple = ()

    def words(self, cloud, mesh, voxel, cells):
        known = {"in": cloud, "out": mesh, "voxel": f"{voxel:.9g}", "cells": cells, "here": HERE,
                 "python": sys.executable}
        return [word.format(**known) for word in shlex.split(self.command)]

    def available(self):
        if self.check:
            words = [w.format(here=HERE, python=sys.executable) for w in shlex.split(self.check)]
            return subprocess.run(words, capture_output=True).returncode == 0
        return shutil.which(shlex.split(self.command)[0]) is not None

    def scripts(self):
        """Files of this folder that the command runs: when they change the peer is another one."""
        return sorted(HERE / n for n in re.findall(r"\{here\}/(\S+)", self.command))


def read_peers(path):
    """All peers of the file: those that can run here, those that cannot."""
    with open(path, "rb") as file:
        entries = tomllib.load(file)["peer"]
    peers = [Peer(e["name"], e["command"], e.get("check", ""), tuple(e.get("voxels", ())),
                  tuple(e.get("conditions", ()))) for e in entries]
    able = [p for p in peers if p.available()]
    return able, [p for p in peers if p not in able]


def read_vertices(path):
    """Columns by name, of a binary PLY as soapfilm scan writes it: vertices first, floats and doubles only."""
    with open(path, "rb") as file:
        header = []
        while not header or header[-1] != "end_header":
            header.append(file.readline().decode("ascii").strip())
        first = next(i for i, line in enumerate(header) if line.startswith("element vertex "))
        layout = []
        for line in header[first + 1:]:
            words = line.split()
            if words[0] != "property":
                break
            layout.append((words[2], {"float": "<f4", "double": "<f8"}[words[1]]))
        return np.fromfile(file, np.dtype(layout), int(header[first].split()[2]))


def columns(vertices, *names):
    return np.stack([vertices[n].astype(float) for n in names], axis=1)


def towards(sensor, positions):
    ways = sensor - positions
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def read_samples(path):
    """Positions and unit directions of one cloud: true normals, else towards each sample's scanner."""
    vertices = read_vertices(path)
    positions = columns(vertices, "x", "y", "z")
    if "nx" in vertices.dtype.names:
        return positions, columns(vertices, "nx", "ny", "nz")
    return positions, towards(columns(vertices, "sensor_x", "sensor_y", "sensor_z"), positions)


def posed_scans(conf):
    """Of each scan of a set: its file, and the R and t of v @ R + t, which takes row vectors to the world."""
    for line in conf.read_text().splitlines():
        if not line.startswith("bmesh "):
            continue
        _, name, *numbers = line.split()
        shift, (x, y, z, w) = np.array(numbers[:3], float), np.array(numbers[3:], float)
        textbook = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                             [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                             [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        yield conf.parent / name, textbook, shift        # p_world = R p_scan + t, R the transpose of the textbook's


def read_scans(conf):
    """The same of all scans of a set, whose scanners sit at the origin of each scan's frame."""
    positions, directions = [], []
    for path, rotation, shift in posed_scans(conf):
        local = columns(read_vertices(path), "x", "y", "z")
        positions.append(local @ rotation + shift)
        directions.append(towards(np.zeros(3), local) @ rotation)
    return np.concatenate(positions), np.concatenate(directions)


def write_oriented(path, positions, directions):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(positions)}",
              *(f"property double {n}" for n in ("x", "y", "z", "nx", "ny", "nz")), "end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode("ascii"))
        file.write(np.hstack([positions, directions]).astype("<f8").tobytes())
