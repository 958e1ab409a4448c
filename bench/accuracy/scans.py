"""The Stanford bunny's raw scans, which have no truth: a picture to look at, and what the refinement costs."""
import statistics

# Fractions of the full panel: chest and face, then the tips of the ears.
DETAILS = (("chest and face", "0.10,0.28,0.62,0.80"), ("ears", "0.15,0.0,0.6,0.35"))
RUNS = 3


def share_of(report):
    """CPU time of the refinement, bending the mesh included, over the solve's."""
    seconds = report["cpu_seconds"]
    return (seconds["refine"] + seconds.get("relax", 0)) / seconds["solve"]


def bunny(lab):
    """(Markdown, share: the median of RUNS runs); nothing and None without the data."""
    conf, zipper = lab.real("bunny/bun.conf"), lab.real("bunny/bun_zipper.ply")
    if not (conf and zipper):
        return "", None
    ours = [lab.reconstruct(f"bunny-raw-{i}", conf, "--resolution", 512, refine=True) for i in range(RUNS)]
    paper = lab.reconstruct("bunny-raw-unrefined", conf, "--resolution", 512)
    meshes, captions = [zipper, ours[0].mesh, paper.mesh], ["zippered mesh", "tv", "tv unrefined"]
    pictures = [lab.render(f"bunny-{name.split()[0]}", meshes, captions, "--zoom", zoom, "--size", "620x620")
                for name, zoom in DETAILS]
    shares = sorted(share_of(run.report) for run in ours)
    return f"""## The bunny's raw scans

No truth is known, so this is looked at: 512 vertices along the longest side, the mesh that was zippered from the same
scans beside it. Refining took {shares[0]:.2f} to {shares[-1]:.2f} of the solve's CPU time in {RUNS} runs.

{chr(10).join(pictures)}
""", statistics.median(shares)
