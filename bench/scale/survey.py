"""A survey larger than memory: survey.py PROGRAM WORK PAGE MILLIONS VOXEL MEMORY [LAZ_WRITER]

Tiles of a terrain with houses, 16 points per square meter, are written as LAS files, or as LAZ files by bench_laz_tiles,
and reconstructed from their folder with the voxel (meters) in a control group (as root) of so much memory (10^9 bytes),
its large arrays on disk. PAGE gets the row. The
error is that of the mesh's vertices from the terrain, along z, where no house is near."""
import json
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
import marked
import scratch

SPACING, TILE = 0.25, 250.0  # meters: of points; side of a tile
HOUSE, STREET, EAVES = 12.0, 50.0, 7.0  # side, distance of houses from each other, height
NOISE = 0.02


def ground(x, y):
    return (8 * np.sin(x / 170) * np.cos(y / 230) + 2.5 * np.sin(x / 41 + y / 67) + 0.3 * np.sin(x / 7) * np.sin(y / 9))


def beside_house(x, y):
    """Distance from the nearest house's middle, along the axis where it is larger, over half a house's side."""
    middle = [(np.floor(c / STREET) + 0.5) * STREET for c in (x, y)]
    return np.maximum(np.abs(x - middle[0]), np.abs(y - middle[1])) / (HOUSE / 2)


def write_las(path, points):
    """LAS 1.2, format 0: millimeters from the first point's kilometer."""
    offset = np.floor(points[0] / 1000) * 1000
    scaled = np.round((points - offset) / 0.001).astype("<i4")
    lo, hi = points.min(axis=0), points.max(axis=0)
    head = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I12d", b"LASF", 0, 0, 0, 0, 0, b"", 1, 2, b"survey", b"survey.py", 1,
                       2026, 227, 227, 0, 0, 20, len(points), len(points), 0, 0, 0, 0, 0.001, 0.001, 0.001, *offset,
                       hi[0], lo[0], hi[1], lo[1], hi[2], lo[2])
    rows = np.zeros(len(points), dtype=[("xyz", "<i4", 3), ("rest", "u1", 8)])
    rows["xyz"] = scaled
    rows["rest"][:, 2] = 0x09  # the only return of its pulse
    with open(path, "wb") as out:
        out.write(head)
        out.write(rows.tobytes())


def write_tiles(folder, per_side, laz_writer):
    folder.mkdir(parents=True)
    rng = np.random.default_rng(1)
    count = round(TILE / SPACING)
    for tile in range(per_side**2):
        corner = np.array([tile % per_side, tile // per_side]) * TILE
        place = np.stack(np.meshgrid(np.arange(count), np.arange(count)), -1).reshape(-1, 2)
        xy = corner + (place + rng.random(place.shape)) * SPACING
        x, y = xy.T
        z = ground(x, y) + np.where(beside_house(x, y) < 1, EAVES, 0) + rng.normal(0, NOISE, len(x))
        las = folder / f"tile_{tile}.las"
        write_las(las, np.column_stack([x, y, z]) + [400000, 5600000, 0])
        if laz_writer:
            subprocess.run([laz_writer, las], check=True)
            las.unlink()


def vertices_of(part):
    """Positions of a binary PLY of ours, without reading its faces."""
    with open(part, "rb") as f:
        head = b""
        while not head.endswith(b"end_header\n"):
            head += f.readline()
        lines = head.decode().splitlines()
        count = int(next(l for l in lines if l.startswith("element vertex")).split()[2])
        start = next(i for i, l in enumerate(lines) if l.startswith("element vertex"))
        end = next(i for i, l in enumerate(lines) if l.startswith("element face"))
        kinds = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}
        words = [line.split() for line in lines[start + 1:end]]
        row = np.dtype([(w[2], kinds[w[1]]) for w in words if w[0] == "property"])
        data = np.fromfile(f, dtype=row, count=count)
        return np.column_stack([data["x"], data["y"], data["z"]]).astype(float)


def errors(parts):
    found = []
    for part in parts:
        x, y, z = (vertices_of(part) - [400000, 5600000, 0]).T
        open_ground = beside_house(x, y) > 1.6
        found.append((z - ground(x, y))[open_ground])
    all_of = np.concatenate(found)
    return float(np.sqrt(np.mean(all_of**2))), float(np.mean(np.abs(all_of) > 0.25))


def main():
    program, work, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(sys.argv[3])
    millions, voxel, memory = float(sys.argv[4]), float(sys.argv[5]), float(sys.argv[6])
    laz_writer = Path(sys.argv[7]).resolve() if len(sys.argv) > 7 else None
    kind = "LAZ" if laz_writer else "LAS"
    tiles, disk = work / f"tiles-{kind}-{millions:g}", work / "scratch"
    per_side = max(1, round(np.sqrt(millions * 1e6) * SPACING / TILE))
    total = (per_side * round(TILE / SPACING)) ** 2
    if not tiles.exists():
        begun = tiles.with_name(tiles.name + "-begun")
        shutil.rmtree(begun, ignore_errors=True)
        write_tiles(begun, per_side, laz_writer)
        begun.rename(tiles)
    disk.mkdir(exist_ok=True)
    run = scratch.measured([program, "reconstruct", tiles, "-o", work / "mesh.ply", "--voxel", voxel, "--scratch", disk,
                            "--split", "auto", "--report", work / "report.json"], int(memory * 1e9))
    index = json.loads((work / "mesh.parts.json").read_text())
    vertices = json.loads((work / "report.json").read_text())["grid"]["levels"][-1]["active_vertices"]
    rms, off = errors(sorted(work.glob("mesh.part_*.ply")))
    print(run["said"], file=sys.stderr)
    on_disk = re.findall(r"([\d.]+ \w+) on disk in", run["said"])
    line = (f"| {total / 1e6:.0f} million points, {per_side**2} {kind} tiles | {voxel:g} | {memory:g} "
            f"| {on_disk[-1] if on_disk else '-'} | {run['user']:.0f} + {run['system']:.0f} "
            f"| {run['elapsed']:.0f} | {run['read'] / 1e9:.0f} | {run['written'] / 1e9:.0f} "
            f"| {index['triangles'] / 1e6:.1f} | {rms * 1000:.0f} | {off:.2%} | {vertices / 1e6:.0f} |")
    print(line)
    head = ("| points | voxel, m | GB of memory | planned on disk | CPU s, user + system | elapsed s | read GB "
            "| made dirty GB | million triangles | rms error of open ground, mm | vertices more than 25 cm off "
            "| million active vertices of the grid |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n")
    rows = [l for l in marked.read(page, "survey.py").splitlines() if l.startswith("| ") and "million points" in l]
    marked.write(page, "survey.py", head + "\n".join([*rows, line]) + "\n")


if __name__ == "__main__":
    main()
