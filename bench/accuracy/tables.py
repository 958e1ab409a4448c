"""The tables of the page, as Markdown and CSV, and all runs as CSV."""
import csv

from results import Row, order_of


def number(value, form):
    return "-" if value is None else form.format(value)


def write_runs(lab, rows):
    with open(lab.page / "runs.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Row.names())
        for row in rows:
            writer.writerow(f"{v:.6g}" if isinstance(v, float) else "" if v is None else v for v in row.values())


def grid(lab, name, c, results, cells, cell, conditions=None):
    """Lines condition x method, columns shapes, entries cell(row); lines without any entry are left out."""
    lines = []
    for condition in c.conditions if conditions is None else conditions:
        for method in results.methods(cells):
            found = [results.get(s.name, condition.name, method, cells) for s in c.shapes]
            entries = [cell(row) if row else "-" for row in found]
            if any(e != "-" for e in entries):
                lines.append([condition.title, method, *entries])
    return lab.table(name, ["condition", "method", *(s.name for s in c.shapes)], lines)


def ratios(lab, name, c, results, cells):
    def cell(row):
        if row.mean is None:
            return "none"
        if row.method == c.reference:
            best = f" at {row.peer_voxel:g}x" if row.peer_voxel != 1 else ""
            return f"{row.mean_voxels:.4f}{best}"
        compared = results.get(row.shape, row.condition, c.reference, cells)
        ratio = results.ratio(row.shape, row.condition, row.method, cells)
        return "no ratio" if compared and ratio is None else number(ratio, "{:.2f}")
    return grid(lab, name, c, results, cells, cell)


def topology(lab, name, c, results, cells):
    return grid(lab, name, c, results, cells, lambda row: row.topology)


def spurious(lab, name, c, results, cells):
    """Mesh to truth: what the error of the other direction does not see."""
    return grid(lab, name, c, results, cells, lambda row: number(row.back_mean_voxels, "{:.2f}"),
                [k for k in c.conditions if k.outliers])


def cost(lab, name, c, results, cells):
    """Of the condition with viewing directions, which all methods run."""
    rows = []
    for method in results.methods(cells):
        found = [results.get(s.name, "views", method, cells) for s in c.shapes]
        found = [row for row in found if row]
        if found:
            seconds = sum(row.cpu for row in found) / len(found)
            rows.append([method, f"{seconds:.2f}", f"{max(row.peak_mb for row in found):.0f}"])
    return lab.table(name, ["method", "CPU seconds, mean", "peak MB, largest"], rows)


def of_all_sizes(lab, name, c, results, table):
    """table(lab, name, c, results, cells) for each voxel size of all conditions; NAME.csv is that of the first."""
    first, *others = c.sizes
    parts = [table(lab, name, c, results, first)]
    for cells in others:
        parts += [f"1/{cells} of the longest side:", table(lab, f"{name}-{cells}", c, results, cells)]
    return "\n\n".join(parts)


def order(lab, c, results):
    rows, columns = [], sorted({row.cells for row in c.rows})
    for shape in (s for s in c.shapes if s.series):
        for condition in c.conditions:
            for method in results.methods(c.sizes[0], series=True):
                sizes = dict(results.sizes(shape.name, condition.name, method))
                slope = order_of(list(sizes.items()))
                if slope is not None:
                    rows.append([shape.name, condition.title, method, f"{slope:.2f}",
                                 *(f"{sizes[n].mean_voxels:.4f}" if n in sizes else "-" for n in columns)])
    return lab.table("order", ["shape", "condition", "method", "order", *(f"1/{n}" for n in columns)], rows)


def better_peer(c, results, ours="tv"):
    """Where ours is not better than the reference: (condition, its ratios by shape) of the conditions with a ratio over
    1, or whose median ratio is over 0.9."""
    listed = []
    for condition in c.conditions:
        found = [(s.name, results.ratio(s.name, condition.name, ours, c.sizes[0])) for s in c.shapes]
        found = [(name, round(ratio, 2)) for name, ratio in found if ratio is not None]
        inside = sorted(ratio for _, ratio in found)
        if inside and (inside[-1] > 1 or inside[len(inside) // 2] > 0.9):
            listed.append((condition, found))
    return listed
