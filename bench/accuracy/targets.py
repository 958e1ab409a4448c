"""What must hold, each target judged by the rows of one run. Every function gives rows of the table:
(target, where, demanded, measured, verdict)."""
import numpy as np

from cases import FLAT

MISSING = "not measured"
LEAST_ORDER = 1.8  # of a slope that counts as second order: random samples scatter it


def verdict(holds):
    return "met" if holds else "**missed**"


def worst(pairs, demanded, form="{:.2f}"):
    """The largest of (value, name) and whether it stays below; values of None count as failures."""
    if not pairs:
        return MISSING, MISSING
    failed = [name for value, name in pairs if value is None]
    if failed:
        return f"no surface: {', '.join(failed)}", verdict(False)
    value, name = max(pairs)
    within = sum(v <= demanded for v, _ in pairs)
    count = f", {within} of {len(pairs)}" if len(pairs) > 1 else ""
    return f"{form.format(value)} ({name}{count})", verdict(value <= demanded)


class Targets:
    def __init__(self, results, shapes, conditions, cells):
        self.results, self.shapes, self.cells = results, shapes, cells
        self.conditions = {c.name: c for c in conditions}
        self.ours = "tv"

    def of_kind(self, *kinds):
        return [s for s in self.shapes if s.kind in kinds]

    def values(self, measure, condition, shapes):
        """(value, shape) by a method of Results, of the shapes for which all that it needs was run."""
        needed = [self.ours] if measure == self.results.error else [self.ours, self.results.reference]
        return [(measure(s.name, condition, self.ours, self.cells), s.name) for s in shapes
                if all(self.results.get(s.name, condition, m, self.cells) for m in needed)]

    def row(self, text, where, demanded, pairs, form="{:.2f}"):
        return [text, where, f"<= {demanded:g}", *worst(pairs, demanded, form)]

    def views(self):
        r, text = self.results, "viewing directions only"
        smooth, rounded, sharp = self.of_kind("smooth"), self.of_kind("smooth", "detailed"), self.of_kind("sharp")
        return [
            self.row(f"{text}: error over the peer's", "smooth", 0.12, self.values(r.ratio, "views", smooth)),
            self.row(f"{text}: error, voxels", "smooth", 0.01, self.values(r.error, "views", smooth), "{:.4f}"),
            self.row(f"{text}: error over the peer's", "without sharp edges", 0.25,
                     self.values(r.ratio, "views", rounded)),
            self.row(f"{text}: error over the peer's", "sharp-edged", 1, self.values(r.ratio, "views", sharp))]

    def normals(self):
        return [self.row("true normals: error over the peer's", where, 0.6,
                         self.values(self.results.ratio, "normals", self.of_kind(*kinds)))
                for where, kinds in (("without sharp edges", ("smooth", "detailed")), ("sharp-edged", ("sharp",)))]

    def noise(self):
        r, rows = self.results, []
        for condition in ("noise-0.33", "noise-0.5"):
            text = self.conditions[condition].title if condition in self.conditions else condition
            for kind, demanded in (("smooth", 0.6), ("detailed", 0.8)):
                rows.append(self.row(f"{text}: error over the peer's best", kind, demanded,
                                     self.values(r.ratio, condition, self.of_kind(kind))))
            rows.append(self.row(f"{text}: normal angle over that one's", "smooth, detailed", 1,
                                 self.values(r.angles, condition, self.of_kind("smooth", "detailed"))))
        return rows

    def right(self, condition, shapes):
        """Row of the table: is the topology right on all of these?"""
        rows = [(s.name, self.results.get(s.name, condition, self.ours, self.cells)) for s in shapes]
        rows = [(name, row) for name, row in rows if row]
        if not rows:
            return MISSING, MISSING
        wrong = [f"{name}: {topology(row)}" for name, row in rows if not row.right]
        which = f" ({'; '.join(wrong)})" if wrong else ""
        return f"{len(rows) - len(wrong)} of {len(rows)}{which}", verdict(not wrong)

    def outliers(self):
        def growth(shape):
            clean = self.results.error(shape, "views", self.ours, self.cells)
            spoilt = self.results.error(shape, "outliers-10", self.ours, self.cells)
            return spoilt / clean if spoilt is not None and clean else None
        both = [s for s in self.shapes if all(self.results.get(s.name, condition, self.ours, self.cells)
                                              for condition in ("views", "outliers-10"))]
        return [self.row("10 % outliers: error over that without", "all", 2, [(growth(s.name), s.name) for s in both]),
                ["10 % outliers: closed, components, genus", "all", "right", *self.right("outliers-10", self.shapes)]]

    def missing(self):
        rows = []
        for name, text, shapes in (("hole", "a hole", [s for s in self.shapes if s.hole_decides]),
                                   ("density", "density 50 to 1", [s for s in self.shapes if s.thin_decides])):
            rows.append([f"{text}: closed, components, genus", ", ".join(s.name for s in shapes), "right",
                         *self.right(name, shapes)])
        return rows

    def order(self):
        """Of triangles of one voxel: where edges are split, triangles are finer at some sizes than at others."""
        slopes, gains = [], []
        for shape in (s for s in self.of_kind("smooth") if s.series):
            for condition in ("normals", "views"):
                flat = self.results.sizes(shape.name, condition, FLAT)
                slope = order_of(flat)
                if slope is None:
                    continue
                slopes.append((slope, f"{shape.name}, {condition}"))
                split = dict(self.results.sizes(shape.name, condition, self.ours))
                gains += [(split[n].mean / row.mean, f"{shape.name}, {condition}, 1/{n}") for n, row in flat if n in split]
        head = ["order of the error in the voxel, edges not split", "smooth", f">= {LEAST_ORDER:g}"]
        if not slopes or not gains:
            return [[*head, MISSING, MISSING]]
        slope, name = min(slopes)
        gain, where = max(gains)
        within = sum(s >= LEAST_ORDER for s, _ in slopes)
        return [[*head, f"{slope:.2f} ({name}, {within} of {len(slopes)})", verdict(slope >= LEAST_ORDER)],
                ["at every voxel size: error with edges split over that without", "smooth", "<= 1.05",
                 f"{gain:.2f} ({where})", verdict(gain <= 1.05)]]

    def all(self):
        return self.views() + self.normals() + self.noise() + self.outliers() + self.missing() + self.order()


def order_of(sizes):
    """Slope of log(error) over log(voxel) by least squares; None with fewer than three voxel sizes."""
    if len(sizes) < 3:
        return None
    return float(np.polyfit([np.log(row.voxel) for _, row in sizes], [np.log(row.mean) for _, row in sizes], 1)[0])


def topology(row):
    """Short: what is wrong, or 'right'."""
    if row.failure:
        return "none"
    if row.right:
        return "right"
    words = [] if row.closed else ["open"]
    if row.components != row.true_components:
        words.append(f"{row.components} part{'s' * (row.components != 1)}")
    if row.genus is not None and row.genus != row.true_genus:
        words.append(f"genus {row.genus}")
    return ", ".join(words) or "not manifold"
