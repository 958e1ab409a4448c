"""What the speed benchmark is to reach, and how it is judged: every verdict is a row of HEADER. Nothing runs here.

A figure is a dictionary of a program's medians in one condition: cpu, user, system, elapsed (seconds), peak_mb, faults,
and of ours planned_mb."""
from dataclasses import dataclass

from conditions import CONDITIONS, RESTED
from verdict import NOT_MEASURED, verdict

OURS, ON_TWO = "soapfilm", "soapfilm, two threads"
PLAN_WITHIN = 0.15
FLAT_WITHIN = 0.2
HEADER = ["case", "target", "warmed", "verdict", "rested", "verdict"]


@dataclass(frozen=True)
class Case:
    """Targets that are None are not asked for."""
    samples: int | None        # virtual ones; None: the bunny's raw scans
    resolution: int
    cpu: float | None = None       # seconds, one thread
    elapsed: float | None = None   # seconds, two threads
    peak_mb: float | None = None
    beyond_file_mb: float | None = None  # peak over the size of the file
    ratio: float | None = None     # of a peer's CPU time to ours; it is to take more memory, too
    with_peers: bool = True        # those that end within minutes

    def most_mb(self, file_mb):
        return self.peak_mb if self.beyond_file_mb is None else file_mb + self.beyond_file_mb


CASES = {"512": Case(None, 512, cpu=2.5, elapsed=2, peak_mb=350, ratio=5),
         "1024": Case(None, 1024, cpu=9, peak_mb=1200),
         "20M": Case(20_000_000, 1024, cpu=25, beyond_file_mb=1500, with_peers=False)}
SMOKE_CASES = {"smoke": Case(4000, 48, cpu=60, elapsed=60, beyond_file_mb=1500, ratio=1)}


def row(case, target, judge, conditions=CONDITIONS):
    """`judge(condition)`: what was measured, as text, and whether it is enough; None where that is not known."""
    cells = []
    for condition in CONDITIONS:
        judged = judge(condition) if condition in conditions else None
        cells += [judged[0], verdict(judged[1])] if judged else ["", NOT_MEASURED]
    return [case, target, *cells]


def at_most(figures, program, key, most, form):
    """A judge of one figure."""
    def judge(condition):
        figure = figures.get((program, condition))
        return figure and (form.format(figure[key]), figure[key] <= most)
    return judge


def plan_error(figure):
    """Relative, above zero where more was planned than used; None without a plan."""
    return figure["planned_mb"] / figure["peak_mb"] - 1 if figure.get("planned_mb") else None


def judge_plans(figures):
    """The worst of them."""
    errors = [plan_error(f) for f in figures]
    if not errors:
        return None
    if None in errors:
        return "no plan was printed", False
    worst = max(errors, key=abs)
    return f"{100 * worst:+.1f} %", abs(worst) <= PLAN_WITHIN


def against_peer(figures, peer, imported, least):
    """Rows without their case; `imported`: what the peer's interpreter and its imports take, as a figure or None."""
    def ratio(less):
        def judge(condition):
            ours, theirs = figures.get((OURS, condition)), figures.get((peer, condition))
            if ours and theirs:
                found = (theirs["cpu"] - less) / ours["cpu"]
                return f"{found:.1f}", found >= least
        return judge

    def memory(less):
        def judge(condition):
            ours, theirs = figures.get((OURS, condition)), figures.get((peer, condition))
            if ours and theirs:
                left = theirs["peak_mb"] - less
                return f"{left:.0f} and {ours['peak_mb']:.0f}", left > ours["peak_mb"]
        return judge

    rows = [(f"CPU time of {peer} over ours: >= {least:g}", ratio(0)),
            (f"peak MB of {peer} and ours: more than ours", memory(0))]
    if imported:
        rows += [("the same ratio without its import", ratio(imported["cpu"])),
                 ("the same MB without its import", memory(imported["peak_mb"]))]
    return rows


def of_case(name, case, figures, file_mb, imports):
    """Rows of a case: `figures` by (program, condition), `imports` figures by peer."""
    judged = []
    if case.cpu is not None:
        judged.append((f"CPU s, one thread: <= {case.cpu:g}", at_most(figures, OURS, "cpu", case.cpu, "{:.2f}")))
    if case.elapsed is not None:
        judged.append((f"elapsed s, two threads: <= {case.elapsed:g}",
                       at_most(figures, ON_TWO, "elapsed", case.elapsed, "{:.2f}")))
    if (most := case.most_mb(file_mb)) is not None:
        judged.append((f"peak MB, one thread: <= {most:.0f}", at_most(figures, OURS, "peak_mb", most, "{:.0f}")))
    judged.append((f"planned memory within {100 * PLAN_WITHIN:.0f} % of the peak", lambda condition: judge_plans(
        [figures[p, condition] for p in (OURS, ON_TWO) if (p, condition) in figures])))
    if case.ratio is not None:
        for peer in dict.fromkeys(p for p, _ in figures if p not in (OURS, ON_TWO)):
            judged += against_peer(figures, peer, imports.get(peer), case.ratio)
    return [row(name, target, judge) for target, judge in judged]


def over_least(values):
    """Of each value, relative."""
    return [v / min(values) - 1 for v in values]


def of_scaling(sizes, cpu, user, figures):
    """Rows of the series, rested alone: seconds per active vertex in the order of `sizes`."""
    def flat(values):
        worst = max(over_least(values))
        return lambda condition: (f"{100 * worst:.0f} %", worst <= FLAT_WITHIN)

    name = f"{min(sizes)} to {max(sizes)}"
    within = f"largest over least: within {100 * FLAT_WITHIN:.0f} %"
    return [row(name, f"CPU time per active vertex, {within}", flat(cpu), [RESTED]),
            row(name, f"user time alone, {within}", flat(user), [RESTED]),
            row(name, f"planned memory within {100 * PLAN_WITHIN:.0f} % of the peak, at every size",
                lambda condition: judge_plans(figures), [RESTED])]
