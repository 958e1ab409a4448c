"""The Stanford bunny's raw scans, which have no truth: a picture to look at."""

# Fractions of the full panel: chest and face, then the tips of the ears.
DETAILS = (("chest and face", "0.10,0.28,0.62,0.80"), ("ears", "0.15,0.0,0.6,0.35"))


def bunny(lab):
    conf, zipper = lab.real("bunny/bun.conf"), lab.real("bunny/bun_zipper.ply")
    if not (conf and zipper):
        return ""
    ours = lab.reconstruct("bunny-raw", conf, "--resolution", 512, refine=True)
    paper = lab.reconstruct("bunny-raw-unrefined", conf, "--resolution", 512)
    meshes, captions = [zipper, ours.mesh, paper.mesh], ["zippered mesh", "tv", "tv unrefined"]
    pictures = [lab.render(f"bunny-{name.split()[0]}", meshes, captions, "--zoom", zoom, "--size", "620x620")
                for name, zoom in DETAILS]
    share = ours.report["seconds"].get("refine", 0) / ours.report["seconds"].get("solve", 1)
    return f"""
## The bunny's raw scans

No truth is known, so this is looked at: 512 vertices along the longest side, the mesh that was zippered from the same
scans beside it. Refining took {100 * share:.0f} % of the solve's time.

{chr(10).join(pictures)}
"""
