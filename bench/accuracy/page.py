"""The page that is published: targets, ratios, topology, plots, pictures."""
import platform
import textwrap
from dataclasses import dataclass
from pathlib import Path

import tables
from cases import FLAT
from targets import Targets, reasons

HEAD = """# Accuracy against the truth

`make accuracy` writes this page{data}; [runs.csv](runs.csv) holds every run. The error is the mean distance from the
truth to the mesh, by `soapfilm evaluate`: exact for the built-in shapes. Ratios are to {reference} within the
same run. [Smaller meshes](simplified.md) have a page of their own.

{machine}

- **Samples**: even and independent, {cells} voxels along the longest side, about one per voxel^2 of surface where the
  condition does not say otherwise. Density 50 to 1: the geometric mean of the two halves is one. *Range scans* are 18
  views with one ray per voxel, some six samples per voxel^2; `vrip`, which needs range images, always gets these, with
  the condition's errors.
- **Nothing is set by hand**: every run of ours gets the voxel and the method, no other option. (For the order of
  convergence `{FLAT}` draws triangles of one size at every voxel beside.)
{peers}
- **Kinds**: smooth {smooth}; detailed or creased {detailed}; sharp-edged {sharp}.
"""

PEERS = """**Peers** get exactly our voxel as the width of their finest cell, and true normals, or where there are
viewing directions only the unit vectors towards the scanner.{voxels}{absent}"""

# Why the peer is better, or as good, by condition.
BETTER = {
    "hole": "Ours bends over a hole as the surface around it does, and so does screened Poisson; what an edge or corner "
            "or the end of a limb was like that lies in it, neither can know. Most of either's mean error lies in the "
            "hole. What the samples determine of components and genus is judged above.",
    "misaligned": "Every scan is off by a shift of its own. A surface can lie at the mean of the scans that see a "
                  "place, as that of every method does, and that mean is off too.",
}


@dataclass
class Contents:
    rows: list
    shapes: list
    conditions: list
    sizes: tuple                 # cells along the longest side in all conditions; targets are of the first
    peers: list                  # that can run here; ratios refer to the first
    absent: list                 # names of those that cannot run here
    commit: str = ""
    worst: str = ""              # Markdown of the pictures of the worst cases
    scans: str = ""              # section on the bunny's raw scans
    share: float = None          # of Targets

    @property
    def reference(self):
        return self.peers[0].name if self.peers else None


def bullet(text):
    """Of Markdown, in lines as the documents have them."""
    return textwrap.fill(text, 118, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False,
                         break_long_words=False)


def tried_voxels(c, results):
    """The sentence on the voxels that peers try where samples are noisy, and where the best is at an end of them."""
    voxels = sorted({v for p in c.peers[:1] for v in (1, *p.voxels)})
    if len(voxels) < 2:
        return ""
    ends, at_end, count = [], 0, 0
    for condition in (k for k in c.conditions if k.noise):
        rows = [results.get(s.name, condition.name, c.reference, c.sizes[0]) for s in c.shapes]
        rows = [row for row in rows if row and row.mean is not None]
        count += len(rows)
        found = [row.shape for row in rows if row.peer_voxel in (voxels[0], voxels[-1])]
        at_end += len(found)
        if found:
            ends.append(f"{condition.title} ({', '.join(found)})")
    which = f": {'; '.join(ends)}" if ends else ""
    where = f" The best lies at an end of these in {at_end} of {count} cases{which}." if count else ""
    text = ", ".join(f"{v:g}" for v in voxels[:-1]) + f" and {voxels[-1]:g}"
    return f" Under noise they run at {text} of our voxels and enter with their best mean error.{where}"


def head(lab, c, results):
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    machine = (f"Measured on {model or platform.machine()}, one thread for each run, "
               f"{sum(lab.cpu.values()) / 60:.0f} minutes of CPU time in all.")
    kinds = {k: ", ".join(s.name for s in c.shapes if s.kind == k) or "none" for k in ("smooth", "detailed", "sharp")}
    absent = f" Not there and not run: {', '.join(c.absent)}." if c.absent else ""
    return HEAD.format(FLAT=FLAT, data="" if lab.data else "; without SOAPFILM_DATA, on built-in shapes only",
                       reference=c.reference or "nothing: no peer is there", cells=c.sizes[0],
                       peers=bullet(PEERS.format(voxels=tried_voxels(c, results), absent=absent)),
                       machine=machine + (f" Program of commit {c.commit}." if c.commit else ""), **kinds)


def must_hold(lab, c, results):
    targets = Targets(results, c.shapes, c.conditions, c.sizes[0], c.share).all()
    why = reasons(targets)
    missed = "\n\nOf what is missed:\n\n" + "\n".join(map(bullet, why)) if why else ""
    return f"""## What must hold

The largest value of all shapes of a kind, where it was, and how many of them keep the target. Topology is demanded
where the samples determine it: not where the hole goes around a tube or through a bore (caps fit as well), nor on
the meshes, whose limbs are thinner than the spacing of the thinned samples. "Not measured": not run, or something to
compare with is missing.

{lab.table("targets", ["target", "shapes", "demanded", "measured", "verdict"], targets)}{missed}
"""


def where_the_peer_is_better(c, results):
    lines = []
    for condition, found in tables.better_peer(c, results):
        over = sorted(((ratio, name) for name, ratio in found if ratio > 1), reverse=True)
        least, largest = min(r for _, r in found), max(r for _, r in found)
        what = (f"error over {c.reference}'s up to {largest:.2f}: {', '.join(f'{name} {r:.2f}' for r, name in over)}"
                if over else f"little or no gain, {least:.2f} to {largest:.2f} of {c.reference}'s error")
        why = BETTER.get(condition.name, "")
        lines.append(bullet(f"**{condition.title}**: {what}.{' ' + why if why else ''}"))
    text = "\n".join(lines) or "In none of the conditions of this run."
    return f"""## Where the peer is better

Conditions in which `tv` has a larger error than {c.reference} on some shape, or hardly a smaller one on most.

{text}
"""


def comparisons(lab, c, results):
    def per_size(name, table):
        return tables.of_all_sizes(lab, name, c, results, table)

    return f"""## Ratios

Error over that of {c.reference} in the same run; its own rows give its error in voxels, and under noise the voxel at
which it was best. "none": no surface; "no ratio": none of {c.reference}'s.

{per_size("ratios", tables.ratios)}

## Topology

What is wrong, or that closed, components and genus are right. vrip measures only what was seen and is open by design.

{per_size("topology", tables.topology)}

## What should not be there

Mean distance from the mesh to the truth in voxels, for the samples with outliers: surfaces that outliers made lie far
from the shape and do not count in the errors above.

{per_size("spurious", tables.spurious)}
"""


def order_noise_cost(lab, c, results):
    return f"""## Order

Error against the voxel on noise-free samples, about one per voxel^2 at every size: slope by least squares, then the
mean error in voxels.

![error against voxel size](error-over-voxel.png)

{tables.order(lab, c, results)}

## Noise

![error against noise](error-over-noise.png)

## Cost

Viewing directions only; the whole process, with reading and writing.

{tables.of_all_sizes(lab, "cost", c, results, tables.cost)}
"""


def worst(c):
    return f"""## The worst case of each method

By its error. Above the truth, colored by its distance to the mesh, whose mean is the error; below the mesh, colored
by its distance to the truth; bright from two voxels on.

{c.worst}
"""


def write(lab, c, results):
    """Writes README.md, the tables and runs.csv; plots and pictures are there. Returns README's text."""
    tables.write_runs(lab, c.rows)
    sections = [head(lab, c, results), must_hold(lab, c, results)]
    if c.reference:
        sections.append(where_the_peer_is_better(c, results))
    sections += [comparisons(lab, c, results), order_noise_cost(lab, c, results), worst(c)]
    text = "\n".join(sections + ([c.scans] if c.scans else []))
    (lab.page / "README.md").write_text(text)
    return text
