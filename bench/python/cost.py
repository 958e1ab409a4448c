"""cost.py PROGRAM PYTHON SCANS [RESOLUTION] [RUNS]: what Python adds to the program.

The same scans by `PROGRAM reconstruct` and by soapfilm in PYTHON, one thread, in random order: CPU seconds (user
and system) and peak resident memory of the whole processes, and whether the meshes have the same bytes. Other work on
the machine and how its memory is scattered only add to CPU seconds, so the least of many runs is compared. Prints a
table.
"""
import random
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from lab import Lab, machine, markdown  # noqa: E402

FILES = ("import sys, soapfilm; soapfilm.reconstruct(sys.argv[1], resolution=int(sys.argv[2]), threads=1)"
         ".save(sys.argv[3])")
ARRAYS = ("import sys, numpy, soapfilm; p = soapfilm.read(sys.argv[1], threads=1); r = soapfilm.reconstruct(p, "
          "resolution=int(sys.argv[2]), threads=1); r.vertices, r.triangles; r.save(sys.argv[3])")


def main(program, python, scans, resolution="512", runs="15"):
    with tempfile.TemporaryDirectory() as work:
        lab = Lab(Path(program).parent, work, work)
        words = {
            "program": [program, "reconstruct", scans, "-o", f"{work}/0.ply", "--resolution", resolution, "--threads",
                        "1", "--quiet"],
            "Python, from files": [python, "-W", "ignore", "-c", FILES, scans, resolution, f"{work}/1.ply"],
            "Python, cloud and NumPy arrays kept": [python, "-W", "ignore", "-c", ARRAYS, scans, resolution,
                                                    f"{work}/2.ply"],
        }
        measured = {name: [] for name in words}
        order = random.Random(1)
        for _ in range(int(runs)):
            for name in order.sample(list(words), len(words)):
                found = lab.measure(words[name], f"{work}/run")
                if found["code"]:
                    sys.exit(found["errors"])
                measured[name].append(found)
        meshes = [Path(f"{work}/{k}.ply").read_bytes() for k in range(len(words))]
        cpu = {name: statistics.median(run["cpu"] for run in found) for name, found in measured.items()}
        peak = {name: statistics.median(run["peak_mb"] for run in found) for name, found in measured.items()}
        least = {name: min(run["cpu"] for run in found) for name, found in measured.items()}
    print(f"{Path(scans).name} at {resolution}, one thread, {runs} runs of each; {machine()}\n")
    print(markdown(["", "CPU s, least", "over the program", "median", "peak MB", "over the program"], [
        [name, f"{least[name]:.2f}", f"{100 * (least[name] / least['program'] - 1):+.1f} %", f"{cpu[name]:.2f}",
         f"{peak[name]:.1f}", f"{100 * (peak[name] / peak['program'] - 1):+.1f} %"] for name in words]))
    print("\nThe meshes have the same bytes." if len(set(meshes)) == 1 else "\nTHE MESHES DIFFER.")
    return len(set(meshes)) != 1


if __name__ == "__main__":
    if not 4 <= len(sys.argv) <= 6:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
