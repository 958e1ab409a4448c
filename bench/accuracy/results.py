"""The rows of a benchmark, found by what they are, and the comparisons between them."""
from cases import FLAT


class Results:
    """`reference`: name of the peer that the ratios refer to, None without one."""

    def __init__(self, rows, reference):
        self.reference = reference
        self.rows = {}
        for row in rows:
            self.rows.setdefault((row.shape, row.condition, row.method, row.cells), []).append(row)

    def get(self, shape, condition, method, cells):
        """The row; of a peer's voxels the one with the least mean error (only noisy conditions have several). None
        when it was not run, a row with its `failure` when it gave nothing."""
        found = self.rows.get((shape, condition, method, cells), [])
        return min(found, key=lambda r: float("inf") if r.mean is None else r.mean) if found else None

    def error(self, shape, condition, method, cells):
        """Mean distance, voxels; None when there is no mesh."""
        row = self.get(shape, condition, method, cells)
        return row.mean_voxels if row else None

    def ratio(self, shape, condition, method, cells):
        """Of mean errors, to the reference in the same run; 0 where that one has no surface, None where there is none
        of this method or the reference was not run."""
        mine = self.error(shape, condition, method, cells)
        theirs = self.get(shape, condition, self.reference, cells)
        if mine is None or theirs is None:
            return None
        return mine / theirs.mean_voxels if theirs.mean_voxels else 0.0

    def angles(self, shape, condition, method, cells):
        """The same of mean normal angles."""
        mine = self.get(shape, condition, method, cells)
        theirs = self.get(shape, condition, self.reference, cells)
        if mine is None or mine.mean is None or theirs is None:
            return None
        return mine.normal_angle / theirs.normal_angle if theirs.normal_angle else 0.0

    def methods(self, cells, series=False):
        """Names, in the order in which they were run; with `series` those too that only the order of convergence runs."""
        return list(dict.fromkeys(k[2] for k in self.rows if k[3] == cells and (series or k[2] != FLAT)))

    def sizes(self, shape, condition, method):
        """(cells, row) with a mesh, coarse to fine."""
        keys = sorted(k[3] for k in self.rows if k[:3] == (shape, condition, method))
        rows = [(n, self.get(shape, condition, method, n)) for n in keys]
        return [(n, row) for n, row in rows if row.mean is not None]
