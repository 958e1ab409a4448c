"""What must hold, judged by the results: rows (what, demanded, measured, verdict)."""

import limits
from limits import percent
from verdict import MET, MISSED, NOT_MEASURED

LOST_AT_MOST = 0.005
LOST_SCENES = ("grazing", "room_inside", "street", "falloff", "standstill", "terrain_als", "facade")
OVER_PEER = 0.003        # of the samples, that we may lose more than the peer
OF_TRIMMED = 0.5         # of the peer's invented share after trimming
LEAST_INVENTED = 0.005   # a share below this is none: half of nothing cannot be asked for
WRONG_SIDE = {"thin_sheet_10": 0.001, "thin_sheet_07": 0.02}
COPY_VOXELS = 0.05
VOXEL_FACTOR = 2         # our choice over the scene's spacing, either way
GENUS_OFF = 5            # of the room
ONE_SURFACE = (0.9, 1.1)  # the room's area over the truth's: each wall once


def judged(found, within):
    """`found`: (name, text, holds or None when not known). The worst first; met when all hold."""
    if not found:
        return NOT_MEASURED, NOT_MEASURED
    failed = [f"{name} {text}".strip() for name, text, holds in found if not holds]
    count = f"{len(found) - len(failed)} of {len(found)}"
    if failed:
        return f"{count}; not {', '.join(failed)}", MISSED
    return f"{count}{within}", MET


def has_mesh(result):
    return result.ours is not None and result.ours.verdict is not None


def lost(results):
    found = [(r.scene.name, percent(r.ours.verdict.lost) if has_mesh(r) else "no surface",
              has_mesh(r) and r.ours.verdict.lost <= LOST_AT_MOST) for r in results if r.scene.name in LOST_SCENES]
    return ["lost samples (farther than 3 voxels) on " + ", ".join(LOST_SCENES), f"<= {percent(LOST_AT_MOST)}",
            *judged(found, "")]


def lost_beside_peer(results):
    found = []
    for r in results:
        if r.peer.verdict is None:
            continue
        theirs = r.peer.verdict.lost
        mine = r.ours.verdict.lost if has_mesh(r) else 1
        text = f"{percent(mine)} to {percent(theirs)}" if has_mesh(r) else "no surface"
        if r.truth_lost is not None:
            text += f" (the true surface itself {percent(r.truth_lost)})"
        found.append((r.scene.name, text, mine <= theirs + OVER_PEER))
    return ["lost samples, any scene", "<= the peer's + 0.3 points", *judged(found, "")]


def invented(results):
    found = []
    for r in results:
        if r.trimmed is None or r.trimmed.verdict is None:
            continue
        theirs = r.trimmed.verdict.invented
        mine = r.ours.verdict.invented if has_mesh(r) else 1
        found.append((r.scene.name, f"{percent(mine)} to {percent(theirs)}" if has_mesh(r) else "no surface",
                      mine <= max(OF_TRIMMED * theirs, LEAST_INVENTED)))
    return ["invented surface (farther than 3 voxels from samples)",
            f"<= half of the peer's, trimmed at the same loss, or {percent(LEAST_INVENTED)}", *judged(found, "")]


def topology(results):
    """Components and genus, and a border only where there may be one."""
    found = []
    for r in results:
        if r.scene.components is None:
            continue
        if not has_mesh(r):
            found.append((r.scene.name, "no surface", False))
            continue
        v, text = r.ours.verdict, []
        if v.components != r.scene.components:
            text.append(f"{v.components} parts")
        if r.scene.genus is not None and v.genus != r.scene.genus:
            text.append(f"genus {v.genus} for {r.scene.genus}")
        if v.curves and not r.scene.open:
            text.append(f"{v.curves} boundary curves")
        found.append((r.scene.name, f"({', '.join(text)})", not text))
    return ["components and genus, where they are known", "the truth's", *judged(found, "")]


def room(results, areas):
    rows = []
    for r in results:
        if r.scene.name != "room_inside":
            continue
        if not has_mesh(r):
            return [["room_inside", "a surface", r.ours.failure, MISSED]]
        v = r.ours.verdict
        ratio = v.area / areas["room_inside"] if areas.get("room_inside") else None
        checks = [("one component", v.components == 1, f"{v.components}"),
                  (f"genus within {GENUS_OFF} of the truth's 3", v.genus is not None and abs(v.genus - 3) <= GENUS_OFF,
                   f"{v.genus}"),
                  ("faces towards the room: samples on the wrong side <= 1 %", v.wrong_side <= 0.01,
                   percent(v.wrong_side))]
        if ratio is not None:
            checks.append(("each wall once: area over the truth's 0.9 to 1.1",
                           ONE_SURFACE[0] <= ratio <= ONE_SURFACE[1], f"{ratio:.2f}"))
        rows += [["room_inside", what, text, MET if holds else MISSED] for what, holds, text in checks]
    return rows


def copies(results):
    found = []
    for r in results:
        if r.scene.copy_of:
            d = r.copy_distance
            found.append((r.scene.name, f"mean {d[0]:.3f}, 95 % {d[1]:.3f}" if d else "no surface",
                          d is not None and d[1] <= COPY_VOXELS))
    return ["copies give the surface of one: 95 % of it, voxels", f"<= {COPY_VOXELS:g}", *judged(found, "")]


def sheets(results):
    rows = []
    for r in results:
        most = WRONG_SIDE.get(r.scene.name)
        if most is not None:
            text = percent(r.ours.verdict.wrong_side) if has_mesh(r) else "no surface"
            holds = has_mesh(r) and r.ours.verdict.wrong_side < most
            rows.append([f"{r.scene.name}: samples on the wrong side", f"< {percent(most)}", text,
                         MET if holds else MISSED])
    return rows


def voxels(results):
    found = [(r.scene.name, f"{r.voxel / r.scene.spacing:.2g}" if r.voxel else "none",
              r.voxel is not None and 1 / VOXEL_FACTOR <= r.voxel / r.scene.spacing <= VOXEL_FACTOR) for r in results]
    return ["our voxel over the scene's spacing", f"{1 / VOXEL_FACTOR:g} to {VOXEL_FACTOR:g}", *judged(found, "")]


def cost(results, bunny):
    """`bunny`: CPU seconds per active vertex of the bunny's raw scans at 512, None when not measured."""
    what = "CPU seconds per active vertex over the bunny's raw scans at 512"
    if bunny is None:
        return [what, "<= 3", NOT_MEASURED, NOT_MEASURED]
    # Below this a run costs what starting does, whatever the scene.
    found = [(r.scene.name, f"{r.ours.cpu / r.ours.active / bunny:.1f}", r.ours.cpu / r.ours.active <= 3 * bunny)
             for r in results if has_mesh(r) and r.ours.active > 100000]
    return [what + " (scenes of 100,000 and more)", "<= 3", *judged(found, "")]


def memory(results):
    found = [(r.scene.name, f"{r.ours.planned_mb:.0f} for {r.ours.peak_mb:.0f} MB",
              abs(r.ours.planned_mb / r.ours.peak_mb - 1) <= 0.15)
             for r in results if has_mesh(r) and r.ours.peak_mb > 100]
    return ["planned memory over the peak (runs over 100 MB)", "within 15 %", *judged(found, "")]


def converged(results):
    found = [(r.scene.name, "", bool(r.ours.converged)) for r in results if has_mesh(r)]
    return ["the solve converged", "every scene", *judged(found, "")]


def kinds(results):
    """Each kind of open scan at its limits."""
    return limits.rows([(r.scene.name, r.scene.kind, r.ours.verdict if has_mesh(r) else None) for r in results])


def warned(results):
    """Where no surface can be right, what would help must be said."""
    found = [(r.scene.name, "not warned", any(r.scene.warned in w for w in r.ours.warnings)) for r in results
             if r.scene.warned]
    return ["what the cloud does not say is asked for by a warning", "every such scene", *judged(found, "")]


def real(found):
    """The files of real instruments; their figures stand in a section of their own."""
    measured = [(r.real.name, "", not r.entry.failure and not limits.over(r.real.kind, r.entry.verdict))
                for r in found if not r.skipped]
    return ["real files, each at the limits of its kind ([figures](#real-files))", "every file", *judged(measured, "")]


def all_rows(results, areas, bunny, found=()):
    """`found`: of the real files."""
    return [*kinds(results), real(found), warned(results), lost(results), lost_beside_peer(results),
            invented(results), *room(results, areas), copies(results), *sheets(results), topology(results),
            voxels(results), cost(results, bunny), memory(results), converged(results)]
