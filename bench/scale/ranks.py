"""Runs on several processes of one machine: ranks.py PROGRAMS WORK PAGE [RESOLUTION [RANKS...]]

A torus is scanned and reconstructed by soapfilm and, under mpirun, by soapfilm-mpi, both in the folder PROGRAMS; one
thread each. PAGE gets the table. CPU seconds are those of rank 0, which has the most to do, without the report's check.
Memory is the largest resident set of a process. All are run in turns, the fastest of ROUNDS each is shown. Before each
run memory is touched: a virtual machine may have given it back to its host, and gets it again slowly. The control is
two runs of one process at once: what they take longer than one alone is the machine's, whose CPUs disturb each other.
So the speed-up is shown against one process alone, and against one that has another beside it, as each rank has.
Memory is looked at once in LOOK_EVERY seconds: a run should take longer."""
import hashlib
import json
import mmap
import os
import platform
import re
import subprocess
import sys
import time
from pathlib import Path

import marked

HERE = Path(__file__).resolve().parent
ROUNDS = 5
LOOK_EVERY = 1  # seconds; to look takes time of the CPUs that the processes need


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


def touch_memory():
    size = min(12 << 30, os.sysconf("SC_AVPHYS_PAGES") * mmap.PAGESIZE // 2)
    with mmap.mmap(-1, size) as memory:
        memory.madvise(mmap.MADV_HUGEPAGE)
        for at in range(0, size, mmap.PAGESIZE):
            memory[at] = 1


def totals(report):
    """Seconds, and CPU seconds by stage, without what is the report's own."""
    others = ("total", "check", "measure")
    return (sum(s for name, s in report["seconds"].items() if name not in others),
            {name: s for name, s in report["cpu_seconds"].items() if name not in others})


def measured(words, report):
    touch_memory()
    child = subprocess.Popen([str(w) for w in words], stderr=subprocess.PIPE, text=True)
    peaks = {}
    while child.poll() is None:
        peaks_below(child.pid, peaks)
        time.sleep(LOOK_EVERY)
    if child.returncode:
        sys.exit(f"{' '.join(map(str, words))}\nexit code {child.returncode}: {child.stderr.read()}")
    return {"peaks": sorted(peaks.values()), "report": json.loads(report.read_text())}


def words_of(scans, resolution, mesh, report):
    return ["--quiet", "reconstruct", scans / "scans.conf", "--resolution", str(resolution), "--threads", "1", "-o", mesh,
            "--report", report]


def reconstruct(programs, scans, resolution, count, mesh, report):
    """One run of some processes; what it measured, and what its mesh is."""
    words = words_of(scans, resolution, mesh, report)
    if count == 1:
        run = measured([programs / "soapfilm", *words], report)
    else:
        run = measured(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", count, programs / "soapfilm-mpi",
                        *words], report)
    run["seconds"], run["cpu"] = totals(run["report"])
    run["ranks"] = run["report"].get("ranks", [])
    # Rank 0 does all that one process does but what others do, and what it waits for.
    run["busy"] = sum(run["cpu"].values()) - (run["ranks"][0]["exchange_cpu_seconds"] if run["ranks"] else 0)
    run["mesh"] = digest(mesh)
    return run


def two_at_once(programs, scans, resolution, work):
    """Seconds of two runs of one process that know nothing of each other, the shorter one first."""
    reports = [work / f"alone-{k}.json" for k in range(2)]
    touch_memory()
    children = [subprocess.Popen([programs / "soapfilm", *words_of(scans, resolution, report.with_suffix(".ply"), report)])
                for report in reports]
    if any([child.wait() for child in children]):  # a list: all are waited for
        sys.exit("a run of the control failed")
    return sorted(totals(json.loads(report.read_text()))[0] for report in reports)


def row(count, run, alone, beside, same):
    """`beside`: seconds of one process that has another beside it."""
    shares = ", ".join(f"{100 * r['exchange_share']:.0f} %" for r in run["ranks"]) or "-"
    sent = sum(r["sent_bytes"] for r in run["ranks"]) / 1e6
    memory = ", ".join(f"{p / 1e6:.0f}" for p in run["peaks"] or [run["report"]["memory"]["peak_bytes"]])
    parts = ", ".join(f"{run['cpu'][s]:.1f}" for s in ("solve", "refine", "relax"))
    against = f"{beside / run['seconds']:.2f}" if count > 1 else "-"
    return (f"| {count} | {run['seconds']:.1f} | {alone['seconds'] / run['seconds']:.2f} | {against} "
            f"| {run['busy']:.1f} | {alone['busy'] / run['busy']:.2f} | {parts} | {shares} | {sent:.0f} | {memory} "
            f"| {'yes' if same else '**no**'} |")


def main():
    programs, work, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(sys.argv[3])
    resolution = int(sys.argv[4]) if len(sys.argv) > 4 else 1024
    counts = [int(a) for a in sys.argv[5:]] or [1, 2]
    scans = work / f"torus-{resolution}"
    work.mkdir(parents=True, exist_ok=True)
    side = resolution * 25 // 32
    if not scans.exists():
        subprocess.run([programs / "soapfilm", "--quiet", "scan", "torus", "-o", scans, "--image", f"{side}x{side}",
                        "--views", "12", "--seed", "1"], check=True)
    runs, controls = {count: [] for count in counts}, []
    for _ in range(ROUNDS):
        for count in counts:
            run = reconstruct(programs, scans, resolution, count, work / "mesh.ply", work / "report.json")
            runs[count].append(run)
            print(f"{count}: {run['seconds']:.1f} s, {run['busy']:.1f} CPU s", flush=True)
        controls.append(two_at_once(programs, scans, resolution, work))
    fastest = {count: min(runs[count], key=lambda run: run["seconds"]) for count in counts}
    alone = fastest[counts[0]]
    pair = min(controls)
    rows = [row(count, fastest[count], alone, pair[0], all(run["mesh"] == alone["mesh"] for run in runs[count]))
            for count in counts]
    control = (f"Two runs of one process at once, the control: {pair[0]:.1f} and {pair[1]:.1f} s, "
               f"{pair[0] / alone['seconds']:.2f} and {pair[1] / alone['seconds']:.2f} times as long as one alone.")
    commit = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True)
    facts = (f"Commit {commit.stdout.strip()}, torus of {resolution}, {os.cpu_count()} CPUs, "
             f"Linux {platform.release().split('-')[0]}; each the fastest of {ROUNDS} runs, taken in turns.")
    table = ["| processes | seconds | speed-up | against one beside another | CPU s of rank 0, without waiting | speed-up by "
             "these | of them and of waiting: solve, refine, relax | share of exchanging and waiting, each | MB sent "
             "| MB of memory, each | same bytes |",
             "|---|---|---|---|---|---|---|---|---|---|---|", *rows]
    print("\n".join([*rows, control]))
    marked.write(page, "ranks.py", facts + "\n\n" + "\n".join(table) + "\n\n" + control + "\n")


if __name__ == "__main__":
    main()
