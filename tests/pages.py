#!/usr/bin/env python3
"""pages.py BUILD [PAGE...]: the commands and programs on the guide's pages run as they stand.

Each page has a folder of its own, in which `soapfilm` is that of BUILD, docs/ is this one, and HOME/soapfilm holds the
installed package. A block of `sh` runs, all of a page in their order; a block after the line <!-- file: NAME --> is
written to that file before; one after <!-- not run: WHY --> is passed over. Without PAGE also the pieces of C++ and C
that are no programs of their own, on all pages (page_programs.py).
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^(?:<!-- (file|not run): *([^\n]*?) -->\n+)?```(\w*)\n(.*?)^```$", flags=re.M | re.S)


def run_shell(text, folder, build, **variables):
    """Commands of a page, with the programs of the build."""
    environment = {**os.environ, "PATH": f"{build / 'bin'}:{os.environ['PATH']}", **variables}
    return subprocess.run(["sh", "-eu", "-c", text], cwd=folder, env=environment, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def run_page(page, build, home):
    """Returns what went wrong, or nothing."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "docs").symlink_to(ROOT / "docs")
        blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
        for order, argument, _, text in blocks:
            if order == "file":
                (Path(folder) / argument).write_text(text, encoding="utf-8")
        for order, _, language, text in blocks:
            if language == "sh" and not order:
                done = run_shell(text, folder, build, HOME=str(home))
                if done.returncode != 0:
                    return f"{page.relative_to(ROOT)}: exit code {done.returncode} of\n{text}{done.stdout[-2000:]}"
    return ""


# The pieces of C++ on the pages, after the files that they take as given.
PIECES = """soapfilm scan knot -q -o scans --image 60x60 --noise 0.2% && cp scans/* .
soapfilm scan torus -q -o torus --samples 5000 && soapfilm reconstruct -q torus/samples.ply -o hole.ply
soapfilm reconstruct -q scans.conf -o knot.ply --resolution 64 && cp knot.ply bunny.ply
page_programs
"""


def run_pieces(build):
    """Returns what went wrong, or nothing."""
    with tempfile.TemporaryDirectory() as folder:
        done = run_shell(PIECES, folder, build)
        made = {path.name for path in Path(folder).iterdir()}
    missing = {"mesh.ply", "bunny.png"} - made
    return f"the pieces of C++: exit code {done.returncode}, {missing or ''}\n{done.stdout[-2000:]}" \
        if done.returncode != 0 or missing else ""


def main():
    build = Path(sys.argv[1]).resolve()
    pages = [Path(p).resolve() for p in sys.argv[2:]] or sorted((ROOT / "docs/guide").glob("*.md"))
    with tempfile.TemporaryDirectory() as home:
        subprocess.run(["cmake", "--install", build, "--prefix", f"{home}/soapfilm"], check=True,
                       stdout=subprocess.DEVNULL)
        failures = [run_page(page, build, Path(home)) for page in pages]
    if not sys.argv[2:]:
        failures.append(run_pieces(build))
    failures = [failure for failure in failures if failure]
    print("\n".join(failures) or f"{len(pages)} pages: all commands run")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
