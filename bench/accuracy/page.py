"""The page that is published: targets, ratios, topology, plots, pictures, and every run as CSV."""
import csv
import platform
from dataclasses import dataclass, fields

import plots
from cases import FLAT
from results import Results
from scans import bunny
from targets import Targets, order_of, topology
from trial import Row

HEAD = """# Accuracy against the truth

`make accuracy` writes this page{data}; [runs.csv](runs.csv) holds every run. The error is the mean distance from the
truth to the mesh, by `soapfilm evaluate`: exact for the built-in shapes. Ratios are to {reference} within the
same run.

{machine}

- **Samples**: even and independent, {cells} voxels along the longest side, about one per voxel^2 of surface where the
  condition does not say otherwise. Density 50 to 1: the geometric mean of the two halves is one. *Range scans* are 18
  views with one ray per voxel, some six samples per voxel^2; `vrip`, which needs range images, always gets these, with
  the condition's errors.
- **Nothing is set by hand**: every run of ours gets the voxel and the method, no other option. (For the order of
  convergence `{FLAT}` draws triangles of one size at every voxel beside.)
- **Peers** get exactly our voxel as the width of their finest cell, and true normals, or where there are viewing
  directions only the unit vectors towards the scanner. Under noise they run at 1.41, 2 and 4 voxels too and enter with
  their best mean error.{absent}
- **Kinds**: smooth {smooth}; detailed or creased {detailed}; sharp-edged {sharp}.
"""


@dataclass
class Contents:
    rows: list
    cases: list
    shapes: list
    conditions: list
    cells: int
    reference: str
    absent: list
    commit: str
    whole: bool                  # not a selection


def head(lab, c):
    model = next((line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "")
    machine = (f"Measured on {model or platform.machine()}, one thread for each run, "
               f"{sum(lab.cpu.values()) / 60:.0f} minutes of CPU time in all.")
    kinds = {k: ", ".join(s.name for s in c.shapes if s.kind == k) or "none" for k in ("smooth", "detailed", "sharp")}
    absent = f" Not there and not run: {', '.join(c.absent)}." if c.absent else ""
    return HEAD.format(FLAT=FLAT, data="" if lab.data else "; without SOAPFILM_DATA, on built-in shapes only",
                       reference=c.reference or "nothing: no peer is there", cells=c.cells, absent=absent,
                       machine=machine + (f" Program of commit {c.commit}." if c.commit else ""), **kinds)


def number(value, form):
    return "-" if value is None else form.format(value)


def grid_of(c, results, cell):
    """Rows condition x method, columns shapes; lines without any entry are left out."""
    rows = []
    for condition in c.conditions:
        for method in results.methods(c.cells):
            entries = [cell(s.name, condition.name, method) for s in c.shapes]
            if any(e != "-" for e in entries):
                rows.append([condition.title, method, *entries])
    return rows


def ratio_table(lab, c, results):
    def cell(shape, condition, method):
        row = results.get(shape, condition, method, c.cells)
        if row is None:
            return "-"
        if row.mean is None:
            return "none"
        if method == c.reference:
            best = f" at {row.coarser:g}x" if row.coarser != 1 else ""
            return f"{row.mean_voxels:.4f}{best}"
        return number(results.ratio(shape, condition, method, c.cells), "{:.2f}")
    return lab.table("ratios", ["condition", "method", *(s.name for s in c.shapes)], grid_of(c, results, cell))


def topology_table(lab, c, results):
    def cell(shape, condition, method):
        row = results.get(shape, condition, method, c.cells)
        return topology(row) if row else "-"
    return lab.table("topology", ["condition", "method", *(s.name for s in c.shapes)], grid_of(c, results, cell))


def spurious_table(lab, c, results):
    """Mesh to truth: what the error of the other direction does not see."""
    rows = []
    for condition in (k for k in c.conditions if k.outliers):
        for method in results.methods(c.cells):
            found = [results.get(s.name, condition.name, method, c.cells) for s in c.shapes]
            if any(found):
                rows.append([condition.title, method,
                             *(number(r.back_mean_voxels, "{:.2f}") if r else "-" for r in found)])
    return lab.table("spurious", ["condition", "method", *(s.name for s in c.shapes)], rows)


def cost_table(lab, c, results):
    """Of the condition with viewing directions, which all methods run."""
    rows = []
    for method in results.methods(c.cells):
        found = [results.get(s.name, "views", method, c.cells) for s in c.shapes]
        found = [row for row in found if row]
        if found:
            seconds = sum(row.cpu for row in found) / len(found)
            rows.append([method, f"{seconds:.2f}", f"{max(row.peak_mb for row in found):.0f}"])
    return lab.table("cost", ["method", "CPU seconds, mean", "peak MB, largest"], rows)


def order_table(lab, c, results):
    rows = []
    for shape in (s for s in c.shapes if s.series):
        for condition in c.conditions:
            for method in results.methods(c.cells, series=True):
                sizes = results.sizes(shape.name, condition.name, method)
                slope = order_of(sizes)
                if slope is not None:
                    rows.append([shape.name, condition.title, method, f"{slope:.2f}",
                                 *(f"{row.mean_voxels:.4f}" for _, row in sizes)])
    cells = sorted({row.cells for row in c.rows})
    return lab.table("order", ["shape", "condition", "method", "order", *(f"1/{n}" for n in cells)], rows)


def write_runs(lab, rows):
    with open(lab.page / "runs.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([f.name for f in fields(Row)])
        for row in rows:
            values = [f"{v:.6g}" if isinstance(v, float) else "" if v is None else v for v in row.values()]
            writer.writerow(values)


def write(lab, trial, c):
    """Writes README.md and all it shows; returns its text."""
    results = Results(c.rows, c.reference)
    write_runs(lab, c.rows)
    targets = Targets(results, c.shapes, c.conditions, c.cells).all()
    plots.error_over_voxel(lab, results, c.shapes)
    plots.error_over_noise(lab, results, c.shapes, c.conditions, c.cells)
    worst = plots.worst_cases(lab, trial, results, c.cases, c.cells)
    text = f"""{head(lab, c)}
## What must hold

The largest value of all shapes of a kind, where it was, and how many of them keep the target. Topology is demanded
where the samples determine it: not where the hole goes around a tube or through a bore (caps fit as well), nor on
the meshes, whose limbs are thinner than the spacing of the thinned samples.

{lab.table("targets", ["target", "shapes", "demanded", "measured", "verdict"], targets)}

## Ratios

Error over that of {c.reference} in the same run; its own rows give its error in voxels, and under noise the voxel at
which it was best. "none": no surface.

{ratio_table(lab, c, results)}

## Topology

What is wrong, or that closed, components and genus are right. vrip measures only what was seen and is open by design.

{topology_table(lab, c, results)}

## What should not be there

Mean distance from the mesh to the truth in voxels, for the samples with outliers: surfaces that outliers made lie far
from the shape and do not count in the errors above.

{spurious_table(lab, c, results)}

## Order

Error against the voxel on noise-free samples, about one per voxel^2 at every size: slope by least squares, then the
mean error in voxels.

![error against voxel size](error-over-voxel.png)

{order_table(lab, c, results)}

## Noise

![error against noise](error-over-noise.png)

## Cost

Viewing directions only; the whole process, with reading and writing.

{cost_table(lab, c, results)}

## The worst case of each method

Coloured by the distance to the truth, bright from two voxels on.

{worst}
{bunny(lab) if c.whole else ""}"""
    (lab.page / "README.md").write_text(text)
    return text
