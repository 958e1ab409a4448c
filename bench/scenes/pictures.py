"""A small picture of each scene: our surface and the peer's, from one side, a lid taken off where one looks inside."""
import subprocess

import numpy as np
from PIL import Image

import geometry
from geometry import read_mesh

PANEL = "330x240"


def opened(lab, scene, path, box):
    """The mesh without what lies beyond the cut."""
    if scene.cut is None:
        return path
    axis, share = scene.cut
    vertices, triangles = read_mesh(path)
    level = box[0][axis] + share * (box[1][axis] - box[0][axis])
    made = path.with_suffix(".cut.ply")
    geometry.write_mesh(made, (vertices, triangles[(vertices[triangles][:, :, axis] < level).all(axis=1)]))
    return made


def draw(lab, result, box):
    """Returns the picture's name; None when there is no surface at all."""
    captions = [c for f, c in zip(result.files, ("soapfilm", "Open3D, trimmed")) if f]
    files = [opened(lab, result.scene, f, box) for f in result.files if f]
    if not files:
        return None
    raw = lab.work / f"{result.scene.name}.png"
    look = ["--up", result.scene.up, f"--view={result.scene.view}", "--framing", "fitted", "--samples", 2]
    words = [lab.program, "render", *files, "-o", raw, "--quiet", *look, "--size", PANEL, "--columns", len(files),
             "--threads", 1]
    for caption in captions:
        words += ["--caption", caption]
    subprocess.run([str(w) for w in words], check=True)
    name = f"{result.scene.name}.jpg"
    Image.open(raw).convert("RGB").save(lab.page / name, quality=82, optimize=True)
    return name


def box_of(made):
    good = made.positions if made.good is None else made.positions[made.good]
    return np.min(good, axis=0), np.max(good, axis=0)
