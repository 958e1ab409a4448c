"""What larger surveys will need: predict.py NOTES PAGE

NOTES has the rows that survey.py has measured, PAGE gets them and predictions: all grows with the points at the same
density and voxel, from the largest measured survey on, the memory from the least that one was measured with."""
import re
import sys
from pathlib import Path

import marked

MILLIONS = (100, 300, 1000)  # predicted
GIB = 2**30
HEAD = ("| points | | memory | disk | CPU | elapsed | read from disk | triangles |\n"
        "|---|---|---|---|---|---|---|---|\n")


def measured(notes):
    """Rows of survey.py: millions of points and what they took, GB, hours and millions."""
    found = []
    for line in Path(notes).read_text().splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if len(cells) < 11 or "million points" not in cells[0]:
            continue
        size, unit = cells[3].split()
        disk = float(size) * {"MiB": 2**20, "GiB": GIB}[unit] / 1e9
        cpu = sum(float(part) for part in cells[4].split("+"))
        found.append({"points": float(re.match(r"[\d.]+", cells[0]).group()), "memory": float(cells[2]), "disk": disk,
                      "cpu": cpu / 3600, "elapsed": float(cells[5]) / 3600, "read": float(cells[6]),
                      "triangles": float(cells[8])})
    return sorted(found, key=lambda row: row["points"])


def predicted(rows, millions):
    times = millions / rows[-1]["points"]
    row = {key: value * times for key, value in rows[-1].items()}
    row["memory"] = millions * min(r["memory"] / r["points"] for r in rows)
    return row


def gigabytes(value):
    return f"{value:.2g} GB" if value < 10 else f"{value:.0f} GB"


def line_of(row, kind):
    hours = lambda h: f"{h * 60:.0f} min" if h < 2 else f"{h:.0f} h"
    return (f"| {row['points']:.0f} million | {kind} | {gigabytes(row['memory'])} | {gigabytes(row['disk'])} "
            f"| {hours(row['cpu'])} | {hours(row['elapsed'])} | {row['read'] / 1000:.1f} TB "
            f"| {row['triangles']:.0f} million |")


def main():
    notes, page = sys.argv[1:3]
    rows = measured(notes)
    lines = [line_of(row, "measured") for row in rows]
    lines += [line_of(predicted(rows, millions), "predicted") for millions in MILLIONS if millions > rows[-1]["points"]]
    marked.write(page, "predict.py", HEAD + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
