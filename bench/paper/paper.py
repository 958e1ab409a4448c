"""Every table and figure of the paper, made again: paper.py PROGRAMS WORK PAGE [ITEM...]

PROGRAMS holds the built programs, WORK the meshes (large), PAGE what is published: README.md, CSV tables, pictures.
An interrupted run goes on where it stopped. With ITEMs (such as figure_3) only these are made and printed.
"""
import platform
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # of lab.py, which all benchmarks share

import convergence
import figures
import tables
from lab import Lab

HEAD = """# The paper, made again

Pan and Skala, *Continuous Global Optimization in Surface Reconstruction from an Oriented Point Cloud* (2011):
every table and figure, with the paper's figures, ours, and the ratios between methods on one machine. `make paper`
writes this page{data}. What each method is: [methods](../reference/methods.md).

{machine}
"""


def machine():
    model = next((line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "")
    return f"Measured on one thread of {model or platform.machine()}."


def main():
    if "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__)
        return
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    lab = Lab(*sys.argv[1:4])
    chosen = sys.argv[4:]
    items = {f.__name__: f for f in tables.ALL + figures.ALL + convergence.ALL}
    for name in chosen:
        if name not in items:
            sys.exit(f"item = {name}, must be one of {', '.join(items)}")
    begin = time.monotonic()
    sections = []
    for number, (name, make) in enumerate(items.items(), 1):
        if chosen and name not in chosen:
            continue
        lab.say(f"{number} of {len(items)}: {name}")
        title, text = make(lab)
        sections.append(f"## {title}\n{text}")
        if chosen:
            print(sections[-1])
    if chosen:
        return
    data = "" if lab.data else "; without SOAPFILM_DATA, on built-in shapes"
    commit = subprocess.run(["git", "describe", "--always"], capture_output=True, text=True).stdout.strip()
    note = machine() + (f" Program of commit {commit}." if commit else "")
    (lab.page / "README.md").write_text(HEAD.format(data=data, machine=note) + "\n" + "\n".join(sections))
    lab.say(f"{lab.page / 'README.md'} in {(time.monotonic() - begin) / 60:.0f} minutes")


if __name__ == "__main__":
    main()
