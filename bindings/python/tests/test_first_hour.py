"""A new user's first hour: the script, and a notebook with a kernel of its own where there is one."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

import soapfilm

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]


def test_the_script(tmp_path):
    done = subprocess.run([sys.executable, "-W", "default", str(HERE / "first_hour.py"), str(ROOT / "README.md")],
                          cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert [line.split(":")[0] for line in lines if line[0].islower()][:2] == ["pickled", "parts"]
    assert "the nearest is 'resolution'" in done.stdout and "must be (N, 3)" in done.stdout
    if soapfilm._core.has_tools and soapfilm._core.has_viewer:
        assert lines[-1] == "page: page.html"
    traces = [line for line in done.stderr.splitlines() if "site-packages/soapfilm" in line]
    assert not traces, "warnings name the line of the caller"


CELLS = [
    "import numpy as np\nimport soapfilm\n"
    "i = np.arange(4000) + 0.5\nz, angle = 1 - i / 2000, 2.399963 * i\nr = np.sqrt(1 - z * z)\n"
    "cloud = soapfilm.Points(np.column_stack([r * np.cos(angle), r * np.sin(angle), z]))\ncloud",
    "result = soapfilm.reconstruct(cloud, resolution=32)\nresult",
    "result.show()",
    "cloud[cloud.positions[:, 2] > 0].show()",
    "soapfilm.view(result, 'page.html')",
    "get_ipython().Completer.use_jedi = False  # which test_typing.py asks\n"
    "line = 'soapfilm.reconstruct(cloud, max_it'\nget_ipython().complete('max_it', line, len(line))[1]",
]


def test_a_notebook(tmp_path, monkeypatch):
    """As Jupyter runs it: below the cells are pages, and no cell has megabytes of text."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    if not soapfilm._core.has_tools:
        pytest.skip("built without the tools")
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path))
    kernel = tmp_path / "kernels" / "ours"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text(
        '{"argv": ["%s", "-m", "ipykernel_launcher", "-f", "{connection_file}"], "display_name": "ours", '
        '"language": "python"}' % sys.executable)
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    book = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(book, timeout=120, kernel_name="ours",
                            resources={"metadata": {"path": str(tmp_path)}}).execute()
    rich = [[output.get("data", {}) for output in cell.outputs] for cell in book.cells]
    assert "soapfilm.Points: 4000 samples" in rich[0][-1]["text/plain"]
    shown = "<iframe" if soapfilm._core.has_viewer else "<img"
    for number in (1, 2, 3):
        html = [data["text/html"] for data in rich[number] if "text/html" in data]
        assert len(html) == 1 and shown in html[0], number
    assert "samples" in rich[3][-1]["text/html"]
    if soapfilm._core.has_viewer:
        assert rich[4][-1]["text/plain"] == "PosixPath('page.html')" and os.path.exists(tmp_path / "page.html")
    assert "max_iterations=" in rich[5][-1]["text/plain"], "the options complete"
