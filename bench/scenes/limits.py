"""What a surface of each kind of open scan must hold, made or real: by defaults, shares of samples or of area."""
from verdict import MET, MISSED

P95 = "p95"  # in voxels; all other figures are shares

LIMITS = {
    "sweep": {"lost": 0.007, "wrong_side": 0.03, "shells": 0.01, "invented": 0.12},
    "airborne ground": {"lost": 0.015, "wrong_side": 0.05, "shells": 0.01, "invented": 0.1},
    "airborne forest": {"lost": 0.02, "wrong_side": 0.15, "shells": 0.01, "invented": 0.15},
    "room with camera": {"lost": 0.005, "wrong_side": 0.03, "invented": 0.05},
    "depth frames": {"lost": 0.03, "wrong_side": 0.03, "invented": 0.08, P95: 2.5},
}
SHOWN = {"lost": "lost", "wrong_side": "wrong side", "shells": "shells", "invented": "invented",
         P95: "95 % of the samples within"}


def percent(share):
    return "-" if share is None else f"{100 * share:.2f} %"


def shown(key, value):
    return percent(value) if key != P95 else "-" if value is None else f"{value:.2f} voxels"


def over(kind, verdict):
    """What of a verdict is beyond the limits of its kind: (key, value, limit). No figure is no proof, and beyond."""
    values = [(key, getattr(verdict, key), most) for key, most in LIMITS[kind].items()]
    return [(key, value, most) for key, value, most in values if value is None or value > most]


def failures(kind, verdict):
    """In words, such as `wrong side 99.94 % for 5.00 %`."""
    return [f"{SHOWN[key]} {shown(key, value)} for {shown(key, most)}" for key, value, most in over(kind, verdict)]


def demanded(kind):
    return ", ".join(f"{SHOWN[key]} <= {shown(key, most)}" for key, most in LIMITS[kind].items())


def rows(found):
    """One row for each kind: (what, demanded, measured, verdict). `found`: (name, kind, verdict or None)."""
    made = []
    for kind in LIMITS:
        of_kind = [(name, failures(kind, v) if v else ["no surface"]) for name, k, v in found if k == kind]
        failed = [f"{name} ({', '.join(words)})" for name, words in of_kind if words]
        if of_kind:
            count = f"{len(of_kind) - len(failed)} of {len(of_kind)}"
            made.append([kind, demanded(kind), count + (f"; not {', '.join(failed)}" if failed else ""),
                         MISSED if failed else MET])
    return made
