#!/usr/bin/python3
"""remesh.py PROGRAM FOLDER [--only WORD]: remeshes shapes and scans, and gives the meshes to tetgen and gmsh.

Prints a table in Markdown: shares of even edges and of good angles, the proved distance, and what the two mesh
generators say where they are installed (apt-get install tetgen gmsh). Real scans and meshes are taken from the folder
that SOAPFILM_DATA names. Exit code 1 where one of them refuses a mesh.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

SHAPES = ["sphere", "torus", "part", "plate", "sheets", "knot", "arch"]
SCANS = ["torus", "part", "sheets", "knot", "arch", "room"]
SECONDS = 600


def run(words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=SECONDS, **more)


def soapfilm(program, *words):
    result = run([program, *words])
    if result.returncode != 0:
        sys.exit(f"{' '.join(str(w) for w in words)}: {result.stderr}")
    return result.stderr


def inputs(program, folder):
    """(name, mesh, edge in % of the longest side)"""
    for shape in SHAPES:
        soapfilm(program, "-q", "scan", shape, "-o", folder / shape, "--samples", 40000)
        for edge in (5, 2):
            yield f"{shape}, exact", folder / shape / "truth.ply", edge
    soapfilm(program, "-q", "scan", "room", "-o", folder / "room", "--samples", 40000)  # its truth intersects itself
    for shape in SCANS:
        mesh = folder / f"{shape}.ply"
        soapfilm(program, "-q", "reconstruct", folder / shape / "samples.ply", "-o", mesh, "--resolution", 128)
        yield f"{shape}, reconstructed", mesh, 3
    noisy = folder / "noisy"
    soapfilm(program, "-q", "scan", "knot", "-o", noisy, "--samples", 40000, "--noise", "0.4%")
    soapfilm(program, "-q", "reconstruct", noisy / "samples.ply", "-o", folder / "noisy.ply", "--resolution", 128)
    yield "knot, noisy scan", folder / "noisy.ply", 3
    data = os.environ.get("SOAPFILM_DATA")
    if not data:
        return
    for name, scans in (("bunny", "bunny/bun.conf"), ("drill", "drill/drill_1.6mm_cyb.conf")):
        mesh = folder / f"{name}.ply"
        soapfilm(program, "-q", "reconstruct", Path(data) / scans, "-o", mesh, "--resolution", 256)
        for edge in (12.5, 8, 3, 1.5):
            yield f"{name}, scans", mesh, edge
    for name in ("horse.ply", "anchor.off", "dancing_children.off", "bunny_hr.obj"):
        for edge in (10, 3, 1.5):
            yield name, Path(data) / "meshes" / name, edge


def write_stl(mesh):
    """The same triangles as text, for gmsh."""
    lines = [line.split() for line in mesh.read_text().splitlines()]  # OFF: colors and normals follow on the lines
    vertices, triangles = int(lines[1][0]), int(lines[1][1])
    with mesh.with_suffix(".stl").open("w") as file:
        file.write("solid mesh\n")
        for face in lines[2 + vertices:2 + vertices + triangles]:
            file.write("facet normal 0 0 0\nouter loop\n")
            for corner in face[1:4]:
                file.write(f"vertex {' '.join(lines[2 + int(corner)][:3])}\n")
            file.write("endloop\nendfacet\n")
        file.write("endsolid mesh\n")


def tetgen(mesh):
    """tetgen makes tetrahedra of what the surface encloses, all its triangles kept."""
    if not shutil.which("tetgen"):
        return "-", True
    result = run(["tetgen", "-pYNEF", mesh])
    text = result.stdout + result.stderr
    if result.returncode == 0 and not re.search(r"intersect|error|fail", text, re.I):
        return "yes", True
    return (text.strip().splitlines() or ["no"])[-1][:60], False


def gmsh(mesh):
    """gmsh does the same."""
    if not shutil.which("gmsh"):
        return "-", True
    script = mesh.with_suffix(".geo")
    script.write_text(f'Merge "{mesh.with_suffix(".stl")}";\nSurface Loop(1) = {{1}};\nVolume(1) = {{1}};\n')
    result = run(["gmsh", "-3", "-nt", "1", script, "-o", mesh.with_suffix(".msh")])
    text = result.stdout + result.stderr
    found = re.search(r"(\d+) nodes (\d+) elements", text)
    if result.returncode == 0 and found and not re.search(r"^Error", text, re.M):
        return "yes", True
    errors = [line for line in text.splitlines() if line.startswith("Error")]
    return (errors or ["no"])[0][:60], False


def main():
    options = argparse.ArgumentParser(usage=__doc__)
    options.add_argument("program", type=Path)
    options.add_argument("folder", type=Path)
    options.add_argument("--only", default="")
    given = options.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    print("| mesh | triangles | edge, % | triangles | even edges, % | good angles, % | smallest | proved / edge | s | tetgen | gmsh |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    good = True
    for number, (name, mesh, edge) in enumerate(inputs(given.program, given.folder)):
        if given.only not in name:
            continue
        out = given.folder / f"remeshed-{number}.off"
        begin = time.monotonic()
        result = run([given.program, "remesh", mesh, "--edge", f"{edge}%", "-o", out])
        seconds = time.monotonic() - begin
        if result.returncode != 0:
            print(f"| {name} | | {edge} | {result.stderr.strip()} |||||||||")
            continue
        after, before, proved = re.search(r": (\d+) triangles for (\d+), each mesh proved within (\S+) of", result.stderr).groups()
        even, length, angles, least = re.search(
            r"(\S+) % of edges are 0.7 to 1.4 times (\S+) long, (\S+) % of .* the smallest has (\S+)", result.stderr).groups()
        write_stl(out)
        verdicts = [tetgen(out), gmsh(out)]
        good = good and all(accepted for _, accepted in verdicts)
        print(f"| {name} | {before} | {edge} | {after} | {even} | {angles} | {least} | {float(proved) / float(length):.3f} "
              f"| {seconds:.1f} | {verdicts[0][0]} | {verdicts[1][0]} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
