"""The gallery of real scans: gallery.py PROGRAM WORK PAGE [LIVE]

Reconstructs the scans that $SOAPFILM_DATA names, draws them into PAGE (docs/gallery) and writes its README.md. Meshes and
reports go to WORK; with LIVE a page of each to turn in the browser goes there, NAME.html: the site links to those that are
there when it is made.
"""
import json
import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from PIL import Image


@dataclass(frozen=True)
class Scan:
    name: str
    title: str
    file: str            # in the folder of the data
    options: tuple       # of soapfilm reconstruct
    view: tuple          # options of soapfilm render for both pictures
    source: str          # whose it is, and under what terms it may be shown


SCANS = (
    Scan("bunny", "Ten range scans of a clay bunny", "bunny/bun.conf", ("--resolution", "512"),
         ("--up", "y", "--view", "0.3,0.25,1", "--framing", "shared"),
         "Stanford Computer Graphics Laboratory; free for research, with this acknowledgment"),
    Scan("drill", "Twelve range scans of a drill bit 1.6 mm wide", "drill/drill_1.6mm_cyb.conf", (),
         ("--up", "y", "--view", "0.4,0.3,1", "--framing", "fitted"),
         "Stanford Computer Graphics Laboratory; free for research, with this acknowledgment"),
    Scan("survey", "Part of an airborne survey, LAZ with colors", "laz/autzen_trim.laz", (),
         ("--up", "z", "--view", "0.5,-1,0.9", "--framing", "shared"), "PDAL's test data, BSD license"),
)
WIDTH, HEIGHT = 620, 440


def run(*command):
    """CPU seconds of a command, which must succeed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(part) for part in command], stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def entry(scan, program, data, work, page, live):
    """The section of one scan."""
    mesh, report = work / f"{scan.name}.ply", work / f"{scan.name}.json"
    cpu = run(program, "reconstruct", data / scan.file, *scan.options, "-o", mesh, "--report", report, "-q",
              "--threads", 1)
    png = work / f"{scan.name}.png"
    run(program, "render", data / scan.file, mesh, "-o", png, *scan.view, "--size",
        f"{WIDTH}x{HEIGHT}", "--caption", "as scanned", "--caption", "soapfilm", "-q")
    Image.open(png).convert("RGB").save(page / f"{scan.name}.jpg", quality=85)
    if live:
        run(program, "view", mesh, "--report", report, "--title", scan.title, "--triangles", 300000, "--html",
            live / f"{scan.name}.html", "-q")
    facts = json.loads(report.read_text())
    command = " ".join(["soapfilm reconstruct", Path(scan.file).name, *scan.options])
    made, grid = facts["mesh"], facts["grid"]
    figures = [("samples", f"{facts['input']['samples']:,}"), ("voxel", f"{grid['voxel']:.3g}"),
               ("triangles", f"{made['triangles']:,}"),
               ("proved within", f"{100 * facts['certificate']['relative_gap_binary']:.2g} % of the global optimum"),
               ("parts", f"{made['components']:,}, {'closed' if made['closed'] else 'with borders'}"),
               ("samples farther than 3 voxels", f"{100 * facts['self_check']['lost']:.2g} %"),
               ("CPU seconds", f"{cpu:.1f}, its check of topology and distances included"),
               ("peak memory", f"{facts['memory']['peak_bytes'] / 2**20:.0f} MiB")]
    table = "\n".join(f"| {name} | {value} |" for name, value in figures)
    return (f"## {scan.title}\n\n![{scan.title}: samples and mesh]({scan.name}.jpg)\n\n    {command}\n\n"
            f"| what | figure |\n| --- | --- |\n{table}\n\n{scan.source}.\n\n<!-- live: {scan.name} -->\n")


def main():
    if "SOAPFILM_DATA" not in os.environ:
        sys.exit("gallery.py: SOAPFILM_DATA is not set, must name the folder of real scans")
    data = Path(os.environ["SOAPFILM_DATA"])
    program, work, page = (Path(path) for path in sys.argv[1:4])
    live = Path(sys.argv[4]) if len(sys.argv) > 4 else None
    for folder in (work, page, *([live] if live else [])):
        folder.mkdir(parents=True, exist_ok=True)
    sections = [entry(scan, program, data, work, page, live) for scan in SCANS]
    (page / "README.md").write_text(
        "# A gallery of real scans\n\n`make gallery` writes this page: scans as instruments recorded them, by defaults but for "
        "what the command says. The scans\nare not part of this project: `SOAPFILM_DATA` names the folder that has them. One "
        "thread each.\n\n" + "\n".join(sections), encoding="utf-8")


if __name__ == "__main__":
    main()
