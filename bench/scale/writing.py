"""Ranks that write one mesh together: writing.py PROGRAMS WORK PAGE [RESOLUTION [RATE [RANKS...]]]

A torus is reconstructed by soapfilm-mpi of the folder PROGRAMS on so many ranks, with a file system that takes RATE
megabytes a second (20) from each process, as many machines that share one have it, and without a limit. PAGE gets the
seconds of the stage that writes the mesh, the least of three runs in turns."""
import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import marked

HERE = Path(__file__).resolve().parent
ROUNDS = 3


def written(words, environment):
    """Seconds of the stage that writes the mesh."""
    done = subprocess.run([str(w) for w in words], env={**os.environ, **environment}, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\nexit code {done.returncode}: {done.stderr}")
    return float(re.search(r"^write +([0-9.]+) s", done.stderr, re.M)[1])


def main():
    programs, work, page = (Path(a).resolve() for a in sys.argv[1:4])
    resolution = int(sys.argv[4]) if len(sys.argv) > 4 else 512
    rate = float(sys.argv[5]) if len(sys.argv) > 5 else 20
    counts = [int(a) for a in sys.argv[6:]] or [1, 2, 4]
    work.mkdir(parents=True, exist_ok=True)
    scans, output, faults, side = work / f"torus-{resolution}", work / "output", work / "faults.so", resolution * 25 // 32
    output.mkdir(exist_ok=True)
    if not scans.exists():
        subprocess.run([programs / "soapfilm", "--quiet", "scan", "torus", "-o", scans, "--image", f"{side}x{side}",
                        "--views", "12", "--seed", "1"], check=True)
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", faults, HERE / "faults.c", "-ldl"], check=True)
    slow = {"LD_PRELOAD": str(faults), "FAULT_UNDER": str(output), "FAULT_RATE": str(rate * 1e6)}
    mesh, best, bytes_of = output / "mesh.ply", {}, set()
    for _ in range(ROUNDS):
        for count in counts:
            words = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", count, programs / "soapfilm-mpi",
                     "reconstruct", scans / "scans.conf", "--resolution", resolution, "--threads", "1", "-o", mesh]
            for limited in (True, False):
                seconds = written(words, slow if limited else {})
                best[count, limited] = min(seconds, best.get((count, limited), seconds))
                bytes_of.add(hashlib.sha256(mesh.read_bytes()).hexdigest())
    size = mesh.stat().st_size / 1e6
    lines = [f"Mesh of {size:.0f} MB, torus of {resolution}.", "",
             f"| processes | s to write it, {rate:g} MB a second from each | without a limit |", "|---|---|---|"]
    lines += [f"| {n} | {best[n, True]:.2f} | {best[n, False]:.2f} |" for n in counts]
    lines += ["", "The same bytes in all runs." if len(bytes_of) == 1 else f"{len(bytes_of)} different meshes!"]
    print("\n".join(lines))
    marked.write(page, "writing.py", "\n".join(lines) + "\n")
    sys.exit(len(bytes_of) != 1)


if __name__ == "__main__":
    main()
