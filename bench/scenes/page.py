"""The page that is published: what fails first, then the table, the pictures, all figures as CSV."""
import textwrap

import limits
from lab import markdown
from limits import percent
from verdict import MET, MISSED, NOT_MEASURED

HEAD = """# Scenes

`make scenes` writes this page; [scenes.csv](scenes.csv) holds every figure. {count} scenes as people scan them, made by
seeded generators (`bench/scenes/catalog.py`; scans by the [virtual scanner](../reference/scanner.md)), and below them
[files of real instruments](#real-files). Every run of ours is by defaults; only the way of the aircraft is told where a
scene has one. Beside it {peer} at the same voxel (ours, but at most {factor} times the scene's
spacing and at least a {factor}rd of it), with the normals of the file or its own best ones: estimated from 30 neighbors
and turned to the scanner where the file says where it stood. *Trimmed*: what its octree was thinly filled by is cut
off, as much as leaves no more samples lost than ours or than its whole surface.

- **lost**: share of the samples farther than 3 voxels from the surface; ghosts and outliers left out.
- **invented**: share of the surface farther than 3 voxels from every sample; what closes an unseen side counts too.
- **error**: mean distance of the truth from the mesh, voxels, where it was sampled and is not lost.
- **wrong side**: of the samples that are not lost, the share whose nearest face looks away from where they were seen
  (away from the true normal, where nobody saw them); in a forest only the ground's samples count.
- **shells**: share of the area in closed parts of negative volume: balloons inside out. A room seen from inside is one,
  and rightly.

{machine}
"""


def bullet(text):
    return textwrap.fill(text, 118, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False,
                         break_long_words=False)


def failing(rows):
    missed = [row for row in rows if row[3] == MISSED]
    if not missed:
        return "## What fails\n\nNothing of what must hold.\n"
    lines = [bullet(f"**{what}** (demanded: {demanded}): {measured}.") for what, demanded, measured, _ in missed]
    return "## What fails\n\n" + "\n".join(lines) + "\n"


def number(value, form="{:.2f}"):
    return "-" if value is None else form.format(value)


def shape_of(v):
    """Components, boundary curves, genus in a few words."""
    words = [f"{v.components} part{'s' * (v.components != 1)}"]
    words += [f"{v.curves} border{'s' * (v.curves != 1)}"] if v.curves else []
    words += [f"genus {v.genus}"] if v.genus is not None else ["not manifold"]
    return ", ".join(words)


def right_of(scene):
    words = [] if scene.components is None else [f"{scene.components} part{'s' * (scene.components != 1)}"]
    words += [] if scene.genus is None else [f"genus {scene.genus}"]
    return ", ".join(words + (["may have a border"] if scene.open else [])) or "-"


def table(lab, results):
    rows = []
    for r in results:
        cells = [f"[{r.scene.name}](#{r.scene.name})", f"{r.samples:,}", f"{r.judged_voxel:.3g}"]
        for key in ("lost", "invented"):
            mine = percent(getattr(r.ours.verdict, key)) if r.ours.verdict else "none"
            theirs = percent(getattr(r.peer.verdict, key)) if r.peer.verdict else "none"
            cells += [mine, theirs]
        cells.append(percent(r.trimmed.verdict.invented) if r.trimmed and r.trimmed.verdict else "-")
        cells += [percent(getattr(r.ours.verdict, key, None)) for key in ("wrong_side", "shells")]
        for entry in (r.ours, r.peer):
            cells.append(number(entry.verdict.error if entry.verdict else None))
        cells += [shape_of(r.ours.verdict) if r.ours.verdict else "none", right_of(r.scene)]
        cells += [f"{r.ours.cpu:.1f}", f"{r.peer.cpu:.1f}", f"{r.ours.peak_mb:.0f}", f"{r.peer.peak_mb:.0f}"]
        rows.append(cells)
    header = ["scene", "samples", "voxel", "lost", "peer", "invented", "peer", "trimmed", "wrong side", "shells",
              "error", "peer", "ours is", "right is", "CPU s", "peer", "MB", "peer"]
    return markdown(header, rows)


CSV = ("lost", "p95", "invented", "error", "wrong_side", "shells", "area", "triangles", "components", "curves", "genus")


def csv_rows(results):
    for r in results:
        for name, entry in (("soapfilm", r.ours), ("Open3D Poisson", r.peer), ("Open3D Poisson, trimmed", r.trimmed)):
            if entry is None:
                continue
            values = [getattr(entry.verdict, key) if entry.verdict else None for key in CSV]
            shown = ["" if v is None else f"{v:.6g}" if isinstance(v, float) else v for v in values]
            yield [r.scene.name, name, r.samples, f"{r.voxel:.6g}" if r.voxel else "", f"{r.judged_voxel:.6g}", *shown,
                   f"{entry.cpu:.2f}", f"{entry.peak_mb:.0f}", entry.failure]


def gallery(results, pictures):
    parts = []
    for r in results:
        told = [r.ours.failure] if r.ours.failure else [f"warned: {w}" for w in r.ours.warnings]
        lines = "\n".join(bullet(f"`{text}`") for text in told)
        picture = f"\n![{r.scene.name}]({pictures[r.scene.name]})\n" if r.scene.name in pictures else ""
        parts.append(f"### {r.scene.name}\n{r.scene.title[:1].upper()}{r.scene.title[1:]}.\n{picture}{lines}\n")
    return "\n".join(parts)


REAL = """## Real files

What instruments recorded, by defaults; an option beside a name says what its file does not. The files are read and
judged apart from the program, at the voxel that the program chose. Samples were seen from the scanner where it is
known, else from above. Of a forest, the ground's samples are those of class 2; without classes, the lowest of each
square of 2 m. The files are not part of this project: `SOAPFILM_DATA` names the folder that has them in `real/`.

"""


def real_cells(r):
    """One row of figures, with the verdict last."""
    named = f"{r.real.name} `{' '.join(r.real.options)}`" if r.real.options else r.real.name
    v, failed = r.entry.verdict, r.entry.failure
    figures = [limits.shown(k, getattr(v, k, None)) for k in limits.SHOWN]
    holds = MISSED if failed or limits.over(r.real.kind, v) else MET
    return [named, r.real.title, r.real.kind, f"{r.samples:,}", number(r.voxel, "{:.3g}"), *figures,
            failed or v.components, f"{r.entry.cpu:.1f}", f"{r.entry.peak_mb:.0f}", f"{r.entry.planned_mb:.0f}", holds]


def real_section(lab, found):
    """What fails first, then all figures and the limits."""
    run = [r for r in found if not r.skipped]
    text = REAL
    for why in sorted({r.skipped for r in found if r.skipped}):
        names = ", ".join(r.real.name for r in found if r.skipped == why)
        text += bullet(f"{NOT_MEASURED.capitalize()}, for {why}: {names}.") + "\n"
    if not run:
        return text
    failed = [(r, [r.entry.failure] if r.entry.failure else limits.failures(r.real.kind, r.entry.verdict)) for r in run]
    text += "".join(bullet(f"**{r.real.name}** fails: {', '.join(words)}.") + "\n" for r, words in failed if words)
    header = ["file", "what", "kind", "samples", "voxel", *limits.SHOWN.values(), "parts", "CPU s", "MB", "planned MB",
              "verdict"]
    kinds = [[kind, limits.demanded(kind)] for kind in limits.LIMITS]
    return "\n".join([text, lab.table("real", header, [real_cells(r) for r in run]), "",
                      markdown(["kind", "demanded"], kinds), ""])


def write(lab, results, rows, pictures, machine, peer, factor, real=()):
    lab.table("scenes", ["scene", "program", "samples", "own voxel", "judged voxel", *CSV, "cpu", "peak MB", "failure"],
              list(csv_rows(results)))
    head = HEAD.format(count=len(results), peer=peer, factor=factor, machine=machine)
    holds = "## What must hold\n\n" + lab.table("verdicts", ["what", "demanded", "measured", "verdict"], rows) + "\n"
    shown = "## The pictures\n\nLeft ours, right the peer's, trimmed. Red is a back side.\n\n"
    text = "\n".join([head, failing(rows), holds, *([real_section(lab, real)] if real else []),
                      "## All scenes\n\n" + table(lab, results) + "\n", shown + gallery(results, pictures)])
    (lab.page / "README.md").write_text(text)
    return text
