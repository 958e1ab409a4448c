"""What fewer triangles cost: simplified.py PROGRAMS WORK PAGE

The shapes of accuracy.py, with noise and without: the full mesh, `soapfilm simplify` at 0.05 voxel, what `--simplify auto`
gives, and meshoptimizer's simplification to the same error, each judged against the truth. Writes PAGE/simplified.md.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))  # of lab.py, which all benchmarks share

from cases import BASE, CONDITIONS, METHODS, SHAPES, Case
from lab import Lab
from trial import Trial

HERE = Path(__file__).resolve().parent
TOLERANCE = 0.05  # voxels
CHOSEN = ("normals", "noise-0.33")

HEAD = f"""# Fewer triangles against the truth

`make accuracy` writes this page: [smaller meshes](../guide/smaller.md) of the [accuracy](README.md)'s shapes, at
{BASE} voxels along the longest side. Distances are from the truth to the mesh, in voxels; *at {TOLERANCE:g}* is `soapfilm
simplify` with a tolerance of {TOLERANCE:g} voxel, *auto* `reconstruct --simplify auto`, *meshoptimizer* its
simplification to an absolute error of {TOLERANCE:g} voxel. Faults: edges of more than two triangles, and pairs of triangles
that run through each other.

| shape | samples | mesh | triangles | share | mean error | maximum | non-manifold edges | intersecting pairs | CPU s |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""


class Smaller:
    """The meshes of one shape and condition."""

    def __init__(self, lab, trial, module):
        self.lab, self.trial, self.module = lab, trial, module

    def meshes(self, case, cloud):
        """(name, mesh, CPU seconds) each; the full one first."""
        lab, voxel = self.lab, self.trial.voxel(case)
        base = f"smaller-{case.shape.name}-{case.condition.name}"
        full, ours, auto, theirs = (lab.work / f"{base}-{kind}.obj" for kind in ("full", "ours", "auto", "theirs"))
        run = [lab.program, "reconstruct", cloud, "--voxel", f"{voxel:.9g}", "--threads", 1, "--quiet", "-o"]
        made = [("full", full, lab.once(f"{base}-full", [*run, full], [lab.program, cloud], full))]
        words = [lab.program, "simplify", full, "--tolerance", f"{TOLERANCE * voxel:.9g}", "--threads", 1, "--quiet", "-o",
                 ours]
        made.append((f"at {TOLERANCE:g}", ours, lab.once(f"{base}-ours", words, [lab.program, full], ours)))
        made.append(("auto", auto, lab.once(f"{base}-auto", [*run, auto, "--simplify", "auto"], [lab.program, cloud],
                                            auto)))
        if self.module.exists():
            words = ["node", HERE / "meshopt.mjs", self.module, full, f"{TOLERANCE * voxel:.9g}", theirs]
            made.append(("meshoptimizer", theirs, lab.once(f"{base}-theirs", words, [full, HERE / "meshopt.mjs"], theirs)))
        return made

    def lines(self, case):
        cloud, voxel = self.trial.scan(case), self.trial.voxel(case)
        whole = 0
        for name, mesh, measured in self.meshes(case, cloud):
            judged = self.trial.evaluate(f"{mesh.stem}", mesh, case.shape, voxel)
            topology, distance = judged["topology"]["mesh"], judged["truth_to_mesh"]["distance_voxels"]
            whole = whole or topology["triangles"]
            cpu = "in the run's" if name == "auto" else f"{measured['cpu']:.1f}"
            yield (f"| {case.shape.name} | {case.condition.title} | {name} | {topology['triangles']} | "
                   f"{100 * topology['triangles'] / whole:.1f} % | {distance['mean']:.4f} | {distance['maximum']:.2f} | "
                   f"{topology['non_manifold_edges']} | {judged['self_intersections']} | {cpu} |")


def main():
    programs, work, page = map(Path, sys.argv[1:4])
    lab = Lab(programs, work, page)
    trial = Trial(lab)
    module = programs.parent / "viewer" / "node_modules" / "meshoptimizer" / "meshopt_simplifier.js"
    smaller = Smaller(lab, trial, module)
    lines = []
    for shape in SHAPES:
        if shape.file and not lab.real(shape.file):
            continue
        trial.prepare(shape)
        for condition in CONDITIONS:
            if condition.name in CHOSEN:
                lines += smaller.lines(Case(shape, condition, METHODS[0], BASE))
    (page / "simplified.md").write_text(HEAD + "\n".join(lines) + "\n")
    lab.say(f"{page / 'simplified.md'}")


if __name__ == "__main__":
    main()
