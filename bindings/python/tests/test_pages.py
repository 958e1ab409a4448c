"""The programs in Python on the documents' pages run as they stand, those of a page in their order."""
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import soapfilm

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def beside(tmp_path, monkeypatch, ball):
    """What the pages take as given: files in the current folder, and names."""
    monkeypatch.chdir(tmp_path)
    if not hasattr(soapfilm, "evaluate"):
        pytest.skip("built without tools")
    soapfilm.scan("knot", samples=10000, noise="0.2%").save("scan.ply")
    Path("scans.conf").write_text("bmesh scan.ply 0 0 0 0 0 0 1\n")
    soapfilm.reconstruct(soapfilm.scan("torus", samples=5000)).save("truth.ply")
    subprocess.run([sys.executable, str(ROOT / "docs/guide/survey.py"), "a.las", "flight.txt"], check=True)
    (tmp_path / "b.las").write_bytes((tmp_path / "a.las").read_bytes())
    monkeypatch.setattr(soapfilm.Result, "show", lambda self: None)  # a window
    points = 0.1 * np.concatenate([ball, ball[:3000]])
    positions = np.array([(0, 0, 1.5), (0, 0, -1.5)])
    turn = np.eye(4)
    turn[0, 3] = 1.5
    in_frame = points - turn[:3, 3]
    half = in_frame[:, 0] > -1.5
    return {
        "points": points,
        "normals": points / 0.1,
        "rgb": np.full((len(points), 3), 200, np.uint8),
        "i": points[:, 2],
        "labels": np.where(np.arange(len(points)) < 4000, 0, 1),
        "positions": positions,
        "of_each_sample": 20 * points,
        "earlier_result": soapfilm.reconstruct(points, points, resolution=32),
        "stream": [(in_frame[half], turn)],
    }


def programs_of(page):
    """Those that need a package only where it is installed."""
    found = re.findall(r"^(?:<!-- not run: needs (\w+) -->\n+)?```python\n(.*?)^```$", page.read_text(),
                       flags=re.M | re.S)
    return [program for needs, program in found if not needs or importlib.util.find_spec(needs.lower())]


PAGES = [page for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))] if programs_of(page)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page(page, beside):
    for number, program in enumerate(programs_of(page)):
        exec(compile(program, f"{page}, program {number + 1}", "exec"), beside)
    assert Path("mesh.ply").exists()
