"""Runs on several processes of one machine: ranks.py PROGRAMS WORK PAGE [RESOLUTION [RANKS...]]

A torus is scanned and reconstructed by soapfilm and, under mpirun, by soapfilm-mpi, both in the folder PROGRAMS; one
thread each. PAGE gets the table. CPU seconds are those of rank 0, which has the most to do, without the report's check.
Memory is the largest resident set of a process."""
import hashlib
import json
import os
import platform
import re
import subprocess
import sys
import time
from pathlib import Path

import marked

HERE = Path(__file__).resolve().parent


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def children_of(process):
    """Processes below one, by their ids."""
    found = []
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            for child in task.read_text().split():
                found += [int(child), *children_of(int(child))]
        except OSError:
            pass
    return found


def peaks_below(process, peaks):
    """Keeps the largest resident set of each soapfilm-mpi below a process."""
    for child in children_of(process):
        try:
            status = Path(f"/proc/{child}/status").read_text()
        except OSError:
            continue
        peak = re.search(r"VmHWM:\s+(\d+)", status)
        if peak and status.startswith("Name:\tsoapfilm-mpi"):
            peaks[child] = int(peak[1]) * 1024


def measured(words, report):
    begin = time.monotonic()
    child = subprocess.Popen([str(w) for w in words], stderr=subprocess.PIPE, text=True)
    peaks = {}
    while child.poll() is None:
        peaks_below(child.pid, peaks)
        time.sleep(0.02)
    elapsed = time.monotonic() - begin
    if child.returncode:
        sys.exit(f"{' '.join(map(str, words))}\nexit code {child.returncode}: {child.stderr.read()}")
    return {"elapsed": elapsed, "peaks": sorted(peaks.values()), "report": json.loads(report.read_text())}


def main():
    programs, work, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(sys.argv[3])
    resolution = int(sys.argv[4]) if len(sys.argv) > 4 else 1024
    counts = [int(a) for a in sys.argv[5:]] or [1, 2]
    scans, mesh, report = work / f"torus-{resolution}", work / "mesh.ply", work / "report.json"
    work.mkdir(parents=True, exist_ok=True)
    side = resolution * 25 // 32
    if not scans.exists():
        subprocess.run([programs / "soapfilm", "--quiet", "scan", "torus", "-o", scans, "--image", f"{side}x{side}",
                        "--views", "12", "--seed", "1"], check=True)
    rows, expected, alone = [], None, None  # alone: seconds and CPU seconds of one process
    for count in counts:
        words = ["reconstruct", scans / "scans.conf", "--resolution", resolution, "--threads", "1", "-o", mesh, "--report",
                 report]
        if count == 1:
            run = measured([programs / "soapfilm", *words], report)
        else:
            run = measured(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", count, programs / "soapfilm-mpi",
                            *words], report)
        found = digest(mesh)
        expected = expected or found
        ranks = run["report"].get("ranks", [])
        report_cpu, seconds = run["report"]["cpu_seconds"], run["report"]["seconds"]
        others = ("total", "check", "measure")  # the report's own
        # Rank 0 does all that one process does but what others do, and what it waits for.
        waiting = ranks[0]["exchange_cpu_seconds"] if ranks else 0
        busy = sum(report_cpu[s] for s in report_cpu if s not in others) - waiting
        total = sum(seconds[s] for s in seconds if s not in others)
        alone = alone or (total, busy)
        shares = ", ".join(f"{100 * r['exchange_share']:.0f} %" for r in ranks) or "-"
        sent = sum(r["sent_bytes"] for r in ranks) / 1e6
        memory = ", ".join(f"{p / 1e6:.0f}" for p in run["peaks"] or [run["report"]["memory"]["peak_bytes"]])
        same = "yes" if found == expected else "**no**"
        parts = ", ".join(f"{report_cpu[s]:.1f}" for s in ("solve", "refine", "relax"))
        rows.append(f"| {count} | {total:.1f} | {alone[0] / total:.2f} | {busy:.1f} | {alone[1] / busy:.2f} | {parts} "
                    f"| {shares} | {sent:.0f} | {memory} | {same} |")
        print(rows[-1], flush=True)
    commit = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True)
    facts = (f"Commit {commit.stdout.strip()}, torus of {resolution}, {os.cpu_count()} CPUs, "
             f"Linux {platform.release().split('-')[0]}; load of the machine at the end {os.getloadavg()[1]:.1f}.")
    table = ["| processes | seconds | speed-up | CPU s of rank 0, without waiting | speed-up by these | of them and of waiting: "
             "solve, refine, relax | share of exchanging and waiting, each | MB sent | MB of memory, each | same bytes |",
             "|---|---|---|---|---|---|---|---|---|---|", *rows]
    marked.write(page, "ranks.py", facts + "\n\n" + "\n".join(table) + "\n")


if __name__ == "__main__":
    main()
