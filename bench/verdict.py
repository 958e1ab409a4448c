"""The verdicts of all benchmarks, as their pages write them."""
MET, MISSED, NOT_MEASURED = "met", "**missed**", "not measured"


def verdict(holds):
    """`holds`: True, False, or None when it is not known."""
    return NOT_MEASURED if holds is None else MET if holds else MISSED
