"""spread.py PROGRAM TABLE: whether cost follows the samples and not the box around them.

Reconstructs the same samples at the same voxel, nearer together and farther apart: two balls, and a ball with one far
sample. Writes a table of CPU seconds (medians; cases take turns) and memory, each beside the case it should equal.
"""
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

USAGE = str(Path(__file__).resolve().parent.parent / "usage.py")
SAMPLES, VOXEL, RUNS = 20000, 0.04, 5
DIRECTION = np.array([1, 0.9, 0.8]) / np.linalg.norm([1, 0.9, 0.8])


def ball(seed, place=0.0):
    """Points and normals of a unit ball, its center `place` diameters away."""
    normals = np.random.default_rng(seed).normal(size=(SAMPLES, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return np.hstack([normals + 2 * place * DIRECTION, normals])


def cases():
    """(name, what it should equal, samples)."""
    yield "one ball", None, ball(1)
    for place in (10, 1000, 100000):
        yield (f"and a sample {place} diameters away", "one ball",
               np.vstack([ball(1), [[*(2 * place * DIRECTION), 1, 0, 0]]]))
    yield "two balls 4 diameters apart", None, np.vstack([ball(1), ball(2, 4)])
    for place in (160, 10000):
        yield (f"two balls {place} diameters apart", "two balls 4 diameters apart",
               np.vstack([ball(1), ball(2, place)]))


def measure(program, cloud, folder):
    """CPU seconds and peak MB of one run, and its grid."""
    result = folder / "usage"
    words = [program, "reconstruct", cloud, "--voxel", VOXEL, "-o", folder / "mesh.ply"]
    run = subprocess.run([sys.executable, "-I", "-S", USAGE, result, *map(str, words)], stderr=subprocess.PIPE, text=True)
    code, cpu, _, peak, *_ = map(float, result.read_text().split())
    if code != 0:
        raise SystemExit(run.stderr)
    grid = next(line for line in run.stderr.splitlines() if line.startswith("grid "))
    return cpu, peak, grid.split(",")[0].removeprefix("grid ")


def main():
    program, table = sys.argv[1:]
    runs = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        clouds = list(cases())
        for k, (_, _, samples) in enumerate(clouds):
            np.savetxt(folder / f"{k}.xyz", samples, fmt="%.9g")
        for _ in range(RUNS):
            for k, (case, _, _) in enumerate(clouds):
                runs.setdefault(case, []).append(measure(program, folder / f"{k}.xyz", folder))
    figures = {case: (statistics.median(r[0] for r in of), max(r[1] for r in of), of[0][2]) for case, of in runs.items()}
    rows = ["| case | grid | CPU s | ratio | peak MB | ratio |", "|---|---|---|---|---|---|"]
    for case, like, _ in clouds:
        cpu, peak, grid = figures[case]
        ratios = [f"{a / b:.2f}" for a, b in zip((cpu, peak), figures[like])] if like else ["", ""]
        rows.append(f"| {case} | {grid} | {cpu:.2f} | {ratios[0]} | {peak:.0f} | {ratios[1]} |")
    text = (f"# Cost and the box around the samples\n\n{SAMPLES} samples on each unit ball, `--voxel {VOXEL}`, medians of "
            f"{RUNS} runs that take turns (`bench/speed/spread.py`).\n\n" + "\n".join(rows) + "\n")
    Path(table).write_text(text)
    print(text)


main()
