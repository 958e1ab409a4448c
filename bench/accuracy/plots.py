"""The two plots and the pictures of the worst cases."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from cases import FLAT, NOISE, SERIES, SERIES_CONDITIONS
from finer import write_finer
from results import order_of

COLORS = {"tv": "tab:blue", FLAT: "tab:gray", "tv unrefined": "tab:cyan", "poisson": "tab:green", "vrip": "tab:brown",
          "graph-cut-26": "tab:orange", "screened Poisson": "tab:red", "PoissonRecon": "tab:purple"}


def save(figure, lab, name):
    figure.savefig(lab.page / f"{name}.png", dpi=110)
    plt.close(figure)


def error_over_voxel(lab, results, shapes):
    """Error against voxel size, a panel for each shape and condition; the legend gives the slopes."""
    shown = [s for s in shapes if s.series]
    figure, axes = plt.subplots(len(SERIES_CONDITIONS), len(shown), figsize=(3.6 * len(shown), 6.4), squeeze=False)
    for line, condition in zip(axes, SERIES_CONDITIONS):
        for axis, shape in zip(line, shown):
            for method, color in COLORS.items():
                sizes = results.sizes(shape.name, condition, method)
                slope = order_of(sizes)
                if slope is None:
                    continue
                axis.loglog([1 / n for n, _ in sizes], [row.mean_voxels / n for n, row in sizes], "o-", color=color,
                            label=f"{method}: {slope:.2f}", markersize=4)
            axis.set_xticks([1 / n for n in SERIES], [f"1/{n}" for n in SERIES])
            axis.minorticks_off()
            axis.set_title(f"{shape.name}, {condition}", fontsize=9)
            axis.grid(True, alpha=0.3)
            if axis.get_legend_handles_labels()[0]:
                axis.legend(frameon=False, fontsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("voxel / longest side")
    for axis in axes[:, 0]:
        axis.set_ylabel("mean error / longest side")
    figure.tight_layout()
    save(figure, lab, "error-over-voxel")


def error_over_noise(lab, results, shapes, conditions, cells):
    noise = {c.name: c.noise for c in conditions if c.name in NOISE}
    columns = min(5, len(shapes))
    lines = -(-len(shapes) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(2.9 * columns, 2.7 * lines), squeeze=False, sharex=True)
    for axis in axes.flat[len(shapes):]:
        axis.set_visible(False)
    for axis, shape in zip(axes.flat, shapes):
        for method, color in COLORS.items():
            if method == FLAT:
                continue
            points = [(v, results.error(shape.name, name, method, cells)) for name, v in noise.items()]
            points = [p for p in points if p[1] is not None]
            if points:
                axis.plot(*zip(*points), "o-", color=color, label=method, markersize=3)
        axis.set_title(shape.name, fontsize=9)
        axis.set_ylim(bottom=0)
        axis.grid(True, alpha=0.3)
    for axis in axes[-1]:
        axis.set_xlabel("noise, voxels")
    for axis in axes[:, 0]:
        axis.set_ylabel("mean error, voxels")
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="lower center", ncols=7, frameon=False, fontsize=8)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    save(figure, lab, "error-over-noise")


def worst_case(results, method, cells):
    """The row of the method's largest mean error; None when it has no mesh."""
    rows = [results.get(*key) for key in results.rows if key[2:] == (method, cells)]
    return max((row for row in rows if row.mean is not None), key=lambda r: r.mean_voxels, default=None)


def worst_cases(lab, trial, results, cases, cells):
    """Two panels for each method's worst case: the truth, colored by its distance to the mesh, which is what the error
    measures, above the mesh, colored by its distance to the truth. Returns the Markdown."""
    case_of = {(c.shape.name, c.condition.name, c.method.name, c.cells, c.peer_voxel): c for c in cases}
    found = [row for row in (worst_case(results, method, cells) for method in results.methods(cells)) if row]
    for row in {row.shape: row for row in found}.values():
        write_finer(lab.work / f"{row.shape}-truth" / "truth.ply", lab.work / f"{row.shape}-truth-fine.ply",
                    2 * row.voxel)
    truths, meshes, captions = [], [], []
    for row in found:
        case = case_of[row.shape, row.condition, row.method, row.cells, row.peer_voxel]
        mesh, name = lab.work / f"{case.name}.ply", f"worst-{case.name}"
        truth = lab.work / f"{row.shape}-truth-fine.ply"
        truths.append(color_by_distance(lab, truth, mesh, f"{name}-truth", row.voxel))
        meshes.append(color_by_distance(lab, mesh, trial.truth_of(case.shape), f"{name}-mesh", row.voxel))
        captions.append(f"{row.method}: {row.shape}, {row.condition}, {row.mean_voxels:.2f} voxels")
    if not found:
        return ""
    return lab.render("worst", truths + meshes, captions + ["its mesh"] * len(found), "--framing", "fitted",
                      "--view", "iso", "--size", "420x420", "--columns", len(found))


def color_by_distance(lab, mesh, other, name, voxel):
    """The mesh colored by its distance to the other surface, bright from two voxels on."""
    colored = lab.work / f"{name}.ply"
    lab.output_of([lab.program, "evaluate", mesh, "--truth", other, "--points", 1000, "--error-ply", colored,
                   "--error-range", f"{2 * voxel:.9g}", "--threads", 1])
    return colored
