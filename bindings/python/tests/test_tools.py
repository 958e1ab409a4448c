"""Evaluation, virtual scanner, pictures: what the program gives."""
import json
import re
import struct
import tempfile
import webbrowser
import zlib

import numpy as np
import pytest

import soapfilm
from soapfilm._show import png, viewer_html


@pytest.fixture(scope="module")
def result(knot):
    return soapfilm.reconstruct(*knot, resolution=48, distance=True)


def test_evaluate_is_the_programs(tmp_path, result, knot, program):
    mesh, cloud, out = tmp_path / "mesh.ply", tmp_path / "cloud.ply", tmp_path / "out.json"
    result.save(mesh)
    soapfilm.Points(knot[0]).save(cloud)
    program("evaluate", mesh, "--truth", "knot", "--samples", cloud, "--json", out, "--voxel", "0.02", "--f-score",
            "0.01,0.02", "--points", "1000", "--seed", "7")
    theirs = json.loads(out.read_text())
    ours = soapfilm.evaluate(mesh, "knot", samples=soapfilm.read(cloud), voxel=0.02, f_score=[0.01, 0.02], points=1000,
                             seed=7)
    ours["samples"] = theirs["samples"]
    assert ours == theirs


def test_evaluate_of_anything_that_is_a_mesh(result):
    class Trimesh:
        vertices, faces = result.vertices, result.triangles.astype(np.int64)

    class Open3d:
        vertices, triangles = result.vertices.tolist(), result.triangles.astype(np.int32)

    class PyVista:
        points, regular_faces = result.vertices, result.triangles.astype(np.int64)

    expected = soapfilm.evaluate(result, result, points=200)
    assert expected["mesh_to_truth"]["distance"]["maximum"] < 1e-9 and expected["topology"]["mesh"]["watertight"]
    for mesh in (Trimesh, Open3d, PyVista, (result.vertices, result.triangles)):
        assert soapfilm.evaluate(mesh, result, points=200) == expected


def test_measure_is_the_programs(tmp_path, result, program):
    mesh, out = tmp_path / "mesh.ply", tmp_path / "out.json"
    result.save(mesh)
    program("measure", mesh, "--above", "z=0.1", "--section", "z=0", "--section", "0,0,0,1,1,0", "--within",
            "-1,-1,0.2,1", "--before", mesh, "--cell", "0.05", "--voxel", "0.02", "--json", out)
    theirs = json.loads(out.read_text())
    ours = soapfilm.measure(mesh, above=0.1, sections=[0, (0, 0, 0, 1, 1, 0)], within=(-1, -1, 0.2, 1), before=mesh,
                            cell=0.05, voxel=0.02)
    assert ours == theirs and ours["at_plane"]["above"] > 0
    box = soapfilm.measure(result, above=result, cell=0.05)
    assert box["above_mesh"]["fill"]["volume"] == 0 and box["volume"] > 0


def test_simplify_is_the_programs(tmp_path, result, program):
    mesh, out = tmp_path / "mesh.ply", tmp_path / "small.ply"
    result.save(mesh)
    tolerance = 0.1 * result.voxel
    program("simplify", mesh, "--tolerance", repr(tolerance), "-o", out)
    ours, report = soapfilm.simplify(mesh, tolerance, threads=1)
    theirs = soapfilm.read_mesh(out)
    assert np.array_equal(ours.triangles, theirs.triangles)
    assert np.abs(ours.vertices - theirs.vertices).max() < 1e-3 * result.voxel
    assert report["triangles"] == len(ours.triangles) < report["triangles_before"] / 3
    assert 0 < report["proved"] <= report["tolerance"] == tolerance
    assert ours.topology()["watertight"] and ours.topology()["genus"] == result.topology()["genus"]
    few, report = soapfilm.simplify((result.vertices, result.triangles), triangles=500)
    assert len(few.triangles) <= 500 and report["proved"] > tolerance


@pytest.mark.parametrize("arguments, message", [
    ({}, "simplify: give a tolerance, or triangles = N"),
    ({"tolerance": 1.0, "triangles": 5}, "simplify: give a tolerance, or triangles = N"),
    ({"tolerance": -1.0}, "tolerance = -1.0, must be > 0 and finite"),
    ({"triangles": 0}, "triangles = 0, must be >= 1"),
])
def test_simplify_refuses(result, arguments, message):
    with pytest.raises(soapfilm.ParameterError, match="^" + re.escape(message) + "$"):
        soapfilm.simplify(result, **arguments)


def test_compare_is_the_programs(tmp_path, result, knot, program):
    mesh, cloud, out = tmp_path / "mesh.ply", tmp_path / "cloud.ply", tmp_path / "out.json"
    result.save(mesh)
    soapfilm.Points(knot[0]).save(cloud)
    options = {"tolerance": 0.02, "least": 0.9, "points": 1000, "seed": 3}
    for part, ours in ((mesh, mesh), (cloud, soapfilm.read(cloud))):
        program("compare", part, mesh, "--tolerance", "0.02", "--least", "0.9", "--points", "1000", "--seed", "3",
                "--align", "--json", out)
        theirs = json.loads(out.read_text())
        found = soapfilm.compare(ours, mesh, align=True, **options)
        theirs["part"] = found["part"]
        assert found == theirs and found["within_tolerance"]


def test_scan_is_the_programs(tmp_path, program):
    program("scan", "part", "-o", tmp_path / "s", "--views", "3", "--image", "30x20", "--noise", "0.5%", "--seed", "4",
            "--size", "2", "--center", "1,2,3", "--orbit", "ring", "--elevations", "10,50", "--quiet")
    theirs = soapfilm.read(tmp_path / "s" / "scans.conf")
    ours = soapfilm.scan("part", views=3, image=(30, 20), noise="0.5%", seed=4, size=2, center=(1, 2, 3), orbit="ring",
                         elevations=[10, 50])
    assert len(ours.scans) == 6 and ours.positions == pytest.approx(theirs.positions, abs=1e-9)
    program("scan", "torus", "-o", tmp_path / "e", "--samples", "500", "--noise", "0.01", "--hole", "0.2", "--quiet")
    even = soapfilm.scan("torus", samples=500, noise=0.01, hole=0.2)
    assert np.array_equal(even.positions, soapfilm.read(tmp_path / "e" / "samples.ply").positions)


def test_scan_of_a_mesh_and_of_a_scene(result):
    assert len(soapfilm.scan(result, views=2, image=(20, 20)).scans) == 2
    room = soapfilm.scan("room", image=(40, 20))
    assert room.scans[0]["sensor"] is not None and len(room) > 400


def test_render_is_the_programs(tmp_path, result, program):
    mesh, theirs, ours = tmp_path / "mesh.ply", tmp_path / "theirs.png", tmp_path / "ours.png"
    result.save(mesh)
    program("render", mesh, mesh, "-o", theirs, "--size", "60x40", "--view", "iso", "--up", "-z", "--color-by",
            "distance", "--range", "0,0.01", "--caption", "a", "--samples", "1", "--zoom", "0,0,0.5,0.5",
            "--background", "#102030", "--shading", "smooth")
    image = soapfilm.render([mesh, mesh], ours, size=(60, 40), view="iso", up="-z", color_by="distance",
                            range=(0, 0.01), captions="a", samples=1, zoom=(0, 0, 0.5, 0.5),
                            background="#102030", shading="smooth")
    assert ours.read_bytes() == theirs.read_bytes()
    assert image.dtype == np.uint8 and image.shape[2] == 4 and (image[0, 0] == [0x10, 0x20, 0x30, 255]).all()
    width, height = struct.unpack(">II", theirs.read_bytes()[16:24])
    assert image.shape[:2] == (height, width)


def test_render_of_points_and_results(result, knot):
    image = soapfilm.render([result, soapfilm.Points(*knot)], size=(50, 50), samples=1, background="transparent",
                            view=(1, 2, 3), up=(0, 0, 1), framing="fitted")
    assert image.shape == (50, 100, 4) or image.shape[1] >= 100
    assert 0 < (image[..., 3] > 0).mean() < 1
    assert (soapfilm.render(result, points=True, size=(40, 40), samples=1) < 255).any()


def test_a_picture_is_a_png():
    image = np.arange(6 * 5 * 4, dtype=np.uint8).reshape(6, 5, 4)
    data = png(image)
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", data[16:24]) == (5, 6)
    begin = data.index(b"IDAT") + 4
    length = struct.unpack(">I", data[begin - 8:begin - 4])[0]
    rows = np.frombuffer(zlib.decompress(data[begin:begin + length]), dtype=np.uint8).reshape(6, 21)
    assert (rows[:, 0] == 0).all() and np.array_equal(rows[:, 1:].reshape(6, 5, 4), image)


def test_the_page_of_a_notebook(result, monkeypatch):
    page = result._repr_html_()
    assert page == viewer_html(result) and "proved" in page
    if soapfilm._core.has_viewer:
        assert page.count("<iframe srcdoc=") == 1 and len(page) > 100_000
    monkeypatch.setattr(soapfilm._core, "has_viewer", False)
    assert result._repr_html_().count("data:image/png;base64,") == 3


@pytest.mark.skipif(not soapfilm._core.has_viewer, reason="built without the viewer (no node or npm)")
def test_a_page_for_the_browser(result, tmp_path, monkeypatch):
    path = soapfilm.view(result, tmp_path / "a.html", names="<one>", unit="mm")
    assert path == tmp_path / "a.html" and soapfilm.view(result, str(path), names="<one>", unit="mm") == path
    page = path.read_text(encoding="utf-8")
    assert page.startswith("<!") and "<one>" not in page and "http://" not in page.split("<body")[0]
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    other = soapfilm.view(result, names="<one>", unit="mm")
    assert other.parent == tmp_path and other.suffix == ".html" and other != path
    assert other.read_text(encoding="utf-8") == page and other.stat().st_mode & 0o077 == 0
    assert soapfilm.view(result, triangles=100).stat().st_size < len(page)
    with pytest.raises(soapfilm.OutputError):
        soapfilm.view(result, tmp_path / "no" / "a.html")


@pytest.mark.skipif(not soapfilm._core.has_viewer, reason="built without the viewer (no node or npm)")
def test_show_opens_the_page(result, knot, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or True)
    for shape in (result, soapfilm.Points(*knot)):
        path = shape.show()
        assert opened[-1] == path.as_uri() and path.read_text(encoding="utf-8").startswith("<!")
        assert shape.show("browser") is not None
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    with pytest.warns(soapfilm.SoapfilmWarning, match=r"no browser was found: open .*\.html") as seen:
        assert result.show().exists()
    assert seen[0].filename == __file__
    with pytest.raises(soapfilm.ParameterError, match="viewer = 'opened3d'"):
        result.show("opened3d")


@pytest.mark.parametrize("call, kind, message", [
    (lambda r: soapfilm.evaluate(r, "knoot"), ValueError, "must be one of sphere"),
    (lambda r: soapfilm.evaluate(r, "knot", sise=1), TypeError, "'size'"),
    (lambda r: soapfilm.evaluate(r, "room", size=1), ValueError, "only built-in shapes"),
    (lambda r: soapfilm.evaluate(r, "knot", voxel=0), ValueError, "voxel = 0"),
    (lambda r: soapfilm.measure(r, above=(0, 0, 0, 0, 0, 0)), ValueError, "normal that is not zero"),
    (lambda r: soapfilm.measure(r, sections=[(1, 2)]), ValueError, "sections = (1.0, 2.0), must be"),
    (lambda r: soapfilm.measure(r, above=0, within=(0, 0, 0, 1)), ValueError, "within = (0, 0, 0, 1), must be"),
    (lambda r: soapfilm.measure(r, cell=0), ValueError, "cell = 0, must be > 0"),
    (lambda r: soapfilm.compare(r, r, tolerance=0), ValueError, "tolerance = 0, must be > 0"),
    (lambda r: soapfilm.compare(r, r, least=2), ValueError, "least = 2, must be in (0, 1]"),
    (lambda r: soapfilm.evaluate(r, "knot", points=0), ValueError, "points"),
    (lambda r: soapfilm.evaluate(3, "knot"), TypeError, "mesh: int"),
    (lambda r: soapfilm.scan("knot", veiws=3), TypeError, "'views'"),
    (lambda r: soapfilm.scan("knot", views="many"), ValueError, "views = 'many', must be a whole number"),
    (lambda r: soapfilm.scan("knot", noise="much"), ValueError, "noise = 'much'"),
    (lambda r: soapfilm.scan("knot", orbit="round"), ValueError, "one of fibonacci, ring"),
    (lambda r: soapfilm.scan("knot", samples=0), ValueError, "samples = 0"),
    (lambda r: soapfilm.scan("knot", samples=9, image=(3, 3)), ValueError, "image: only scans have it"),
    (lambda r: soapfilm.scan("knot", elevations=[3]), ValueError, "only orbit='ring'"),
    (lambda r: soapfilm.render(r, "a.jpg"), ValueError, "must end in .png"),
    (lambda r: soapfilm.render(r, view="behind"), ValueError, "behind"),
    (lambda r: soapfilm.render(r, up="w"), ValueError, "up = 'w'"),
    (lambda r: soapfilm.render(r, color_by="none"), ValueError, "none"),
    (lambda r: soapfilm.render(r, background="puce"), ValueError, "background = 'puce'"),
    (lambda r: soapfilm.render([r], captions=["a", "b"]), ValueError, "captions: 2"),
    (lambda r: soapfilm.view(r, up="x"), ValueError, "up = 'x', must be one of y, z"),
    (lambda r: soapfilm.view(r, triangles="all"), ValueError, "triangles = 'all'"),
    (lambda r: soapfilm.view(r, names=["a", "b"]), ValueError, "names: 2"),
])
def test_refusals(result, call, kind, message):
    with pytest.raises(kind, match=re.escape(message)):
        call(result)
