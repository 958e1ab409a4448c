"""The page of the kernels: kernels.py FOLDER PAGE

From kernels.json, kernels_refine.json and kernels_io.json of FOLDER, which Google Benchmark wrote with several
repetitions (bench/run.sh). Verdicts are those of the medians."""
import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from lab import commit, machine, markdown
from verdict import NOT_MEASURED, verdict

TITLES = {"kernels": "The solver's", "kernels_refine": "The refinement's passes", "kernels_io": "Everything else"}
NOTES = {
    "kernels": """A sweep reads u, p and f and writes u and p, 36 bytes per vertex. Each of eight sweeps per tile
counts as many, though most of them then come from the cache: these are bytes moved, not bytes of memory. The last
columns are the shares of the rows whose u and whose p the sweeps moved; at least as many were at work.""",
    "kernels_refine": """One thread. The band of a sphere with a radius of 50 voxels lies in the last cache, that of 250
beyond it. A row is one of eight vertices.""",
    "kernels_io": "One thread, 2 million samples, grid of 512. Files lie in the page cache."}
SHARE = 0.7  # of the copy's bytes per second, that a sweep is to reach
MARK_NS = 1.5  # per vertex and sweep
READING = {"read_binary_ply": 500e6, "read_ascii_ply": 80e6}  # bytes per second
COUNTERS = {"ns_per_vertex": "ns per vertex", "ns_per_row": "ns per row", "ns_per_load": "ns per load"}


def medians(report):
    """Of each benchmark by (name, arguments): its median, with the spread of its rate in per cent of the mean."""
    found = {}
    for entry in report["benchmarks"]:
        name, *words = entry["run_name"].split("/")
        key = (name, " ".join(w.replace(":", " ") for w in words if w not in ("process_time", "real_time")))
        kind = entry.get("aggregate_name")
        if kind == "median":
            found.setdefault(key, {}).update(entry)
        elif kind == "cv" and "bytes_per_second" in entry:
            found.setdefault(key, {})["spread"] = 100 * entry["bytes_per_second"]
    def order(key):
        return key[0], [int(w) for w in key[1].split() if w.isdigit()]
    return {key: found[key] for key in sorted(found, key=order)}


def share(found, key):
    """Of the bytes per second of the copy with the same arguments."""
    copy = found.get(("copy", key[1]), {}).get("bytes_per_second")
    return found[key]["bytes_per_second"] / copy if copy and "bytes_per_second" in found[key] else None


def table(found):
    times = [c for c in COUNTERS if any(c in e for e in found.values())]
    moved = [c for c in ("u_rows_moved", "p_rows_moved") if any(c in e for e in found.values())]
    header = ["kernel", "with", *(COUNTERS[c] for c in times), "GB/s", "spread, %", "share of the copy, %",
              *(c.replace("_", " ") + ", %" for c in moved)]
    rows = []
    for key, entry in found.items():
        rate, of_copy = entry.get("bytes_per_second"), share(found, key)
        seconds = [f"{entry[c]:.2f}" if c in entry else "" for c in times]
        rows.append([*key, *seconds, f"{rate / 1e9:.2f}" if rate else "", f"{entry['spread']:.0f}" if rate else "",
                     f"{100 * of_copy:.0f}" if of_copy and key[0] != "copy" else "",
                     *(f"{100 * entry[c]:.1f}" if c in entry else "" for c in moved)])
    return markdown(header, rows)


def verdicts(found):
    """Rows (target, measured, verdict), `found` by file."""
    rows = []
    sweeps = found.get("kernels", {})
    for name, shown in (("eight_sweeps", "eight sweeps per tile, bytes moved"), ("one_sweep", "one sweep at a time")):
        for threads in (1, 2):
            key = (name, f"threads {threads}")
            of_copy = share(sweeps, key) if key in sweeps else None
            rows.append([f"{shown}, {threads} thread{'s' * (threads > 1)}: >= {100 * SHARE:.0f} % of the copy",
                         *(["", NOT_MEASURED] if of_copy is None else
                           [f"{100 * of_copy:.0f} %", verdict(of_copy >= SHARE)])])
    eight = sweeps.get(("eight_sweeps", "threads 1"), {}).get("ns_per_vertex")
    rows.append([f"eight sweeps per tile, 1 thread: the mark of {MARK_NS} ns per vertex and sweep",
                 *(["", NOT_MEASURED] if eight is None else
                   [f"{eight:.2f} ns", verdict(eight <= MARK_NS)])])
    for name, least in READING.items():
        rate = found.get("kernels_io", {}).get((name, ""), {}).get("bytes_per_second")
        rows.append([f"{name.replace('_', ' ')}: >= {least / 1e6:.0f} MB/s",
                     *(["", NOT_MEASURED] if rate is None else [f"{rate / 1e6:.0f} MB/s", verdict(rate >= least)])])
    return rows


def page(reports):
    """Markdown, from the contents of the JSON files by name."""
    found = {name: medians(report) for name, report in reports.items()}
    loads = [load for report in reports.values() for load in report["context"].get("load_avg", [])[:1]]
    repetitions = {e["repetitions"] for report in reports.values() for e in report["benchmarks"] if "repetitions" in e}
    text = ["# Speed of the kernels",
            "`make bench`. Bytes per second of elapsed time beside a plain-store copy in the same run (GB: 10^9).\n"
            f"Medians of {' or '.join(map(str, sorted(repetitions)))} repetitions in random order; the spread is the "
            "standard deviation of the rate.",
            f"{machine()}; commit {commit()}; {time.strftime('%Y-%m-%d')}; load when they began "
            f"{', '.join(f'{load:.1f}' for load in loads)}.",
            "## Against the targets\n" + markdown(["target", "measured", "verdict"], verdicts(found))]
    text += [f"## {TITLES[name]}\n{NOTES[name]}\n\n{table(measured)}" for name, measured in found.items()]
    return "\n\n".join(text) + "\n"


def main():
    folder, target = map(Path, sys.argv[1:3])
    reports = {name: json.loads((folder / f"{name}.json").read_text()) for name in TITLES
               if (folder / f"{name}.json").exists()}
    if not reports:
        sys.exit(f"{folder}: none of {', '.join(f'{name}.json' for name in TITLES)}")
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(page(reports))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main()
