"""Runs in less memory than they need, their arrays on disk: scratch.py PROGRAM WORK PAGE [RESOLUTION...]

A torus is scanned, reconstructed in memory, and again in a control group (v1 or v2; as root) that has 1/2, 1/4 and 1/8
of its peak. PAGE gets the table. Bytes are those of the process: read from the disk, and of mapped files made dirty."""
import hashlib
import os
import platform
import re
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import marked

SHARES = [Fraction(1, 2), Fraction(1, 4), Fraction(1, 8)]
NAME = f"soapfilm-scratch-{os.getpid()}"
HERE = Path(__file__).resolve().parent


class Group:
    """A control group with so many bytes of memory, page cache included."""

    def __init__(self, limit):
        v1, v2 = Path("/sys/fs/cgroup/memory"), Path("/sys/fs/cgroup")
        if v1.is_dir():
            self.folder, name = v1 / NAME, "memory.limit_in_bytes"
        elif "memory" in (v2 / "cgroup.controllers").read_text().split():
            (v2 / "cgroup.subtree_control").write_text("+memory")
            self.folder, name = v2 / NAME, "memory.max"
        else:
            sys.exit("no control group limits memory here")
        self.folder.mkdir()
        (self.folder / name).write_text(str(limit))

    def join(self):
        (self.folder / "cgroup.procs").write_text(str(os.getpid()))

    def remove(self):
        for _ in range(50):
            try:
                return self.folder.rmdir()
            except OSError:  # its last pages are still being written
                time.sleep(0.1)


def measured(words, limit=None):
    """What a command used: user and system seconds, elapsed, bytes, and what it said."""
    group = Group(limit) if limit else None
    begin = time.monotonic()
    child = subprocess.Popen([str(w) for w in words], stderr=subprocess.PIPE, text=True,
                             preexec_fn=group.join if group else None)
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    elapsed = time.monotonic() - begin
    if group:
        group.remove()
    code = os.waitstatus_to_exitcode(status)
    if code:
        sys.exit(f"{' '.join(map(str, words))}\nexit code {code}: {said}")
    return {"user": used.ru_utime, "system": used.ru_stime, "elapsed": elapsed, "peak": used.ru_maxrss * 1024,
            "read": used.ru_inblock * 512, "written": used.ru_oublock * 512, "said": said}


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def planned(said):
    """Bytes to be read and to be written, as the run has last said; zeros where it stays in memory."""
    units = {"B": 1, "KiB": 1 << 10, "MiB": 1 << 20, "GiB": 1 << 30, "TiB": 1 << 40}
    found = re.findall(r"about ([\d.]+) (\w+) to be read and ([\d.]+) (\w+) written", said)
    return [float(found[-1][k]) * units[found[-1][k + 1]] for k in (0, 2)] if found else [0, 0]


def row(resolution, where, limit, run, whole, same):
    plan = planned(run["said"])
    cpu = run["user"] + run["system"]
    return (f"| {resolution} | {where} | {limit / 1e6:.0f} | {run['user']:.1f} + {run['system']:.1f} "
            f"| {cpu / (whole['user'] + whole['system']):.2f} | {run['elapsed']:.0f} "
            f"| {run['read'] / 1e9:.1f} | {plan[0] / 1e9:.1f} | {run['written'] / 1e9:.1f} | {plan[1] / 1e9:.1f} "
            f"| {same} |")


def rows_of(program, work, resolution):
    scans, mesh, scratch = work / f"torus-{resolution}", work / "mesh.ply", work / "scratch"
    scratch.mkdir(exist_ok=True)
    side = resolution * 25 // 32
    if not scans.exists():
        subprocess.run([program, "--quiet", "scan", "torus", "-o", scans, "--image", f"{side}x{side}", "--views", "12",
                        "--seed", "1"], check=True)
    words = [program, "reconstruct", scans / "scans.conf", "--resolution", resolution, "--threads", "1", "-o", mesh]
    whole = measured(words)
    expected = digest(mesh)
    yield row(resolution, "memory", whole["peak"], whole, whole, "-")
    for share in SHARES:
        mesh.unlink()
        limit = int(whole["peak"] * share)
        run = measured([*words, "--scratch", scratch], limit)
        if not re.search("on disk in", run["said"]):
            sys.exit("nothing was on disk")
        if run["read"] > 1.3 * planned(run["said"])[0]:
            print(f"{resolution}, {share}: more was read than planned", file=sys.stderr)
        same = "yes" if digest(mesh) == expected else "**no**"
        yield row(resolution, f"{share} of it", limit, run, whole, same)
        print(run["said"], file=sys.stderr)


def main():
    program, work, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(sys.argv[3])
    resolutions = [int(a) for a in sys.argv[4:]] or [1024]
    work.mkdir(parents=True, exist_ok=True)
    commit = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True)
    rows = []
    for resolution in resolutions:
        for line in rows_of(program, work, resolution):
            print(line, flush=True)
            rows.append(line)
    facts = (f"Commit {commit.stdout.strip()}, {os.cpu_count()} CPUs, Linux {platform.release().split('-')[0]}; one "
             "thread.")
    table = ["| resolution | arrays in | MB of memory | CPU s, user + system | CPU over in memory | elapsed s | read GB "
             "| planned | made dirty GB | planned | same bytes |", "|---|---|---|---|---|---|---|---|---|---|---|", *rows]
    marked.write(page, "scratch.py", facts + "\n\n" + "\n".join(table) + "\n")


if __name__ == "__main__":
    main()
