"""What a new user tries in the first hour, as a script that runs from top to bottom: test_first_hour.py runs it in an
empty folder. Argument: README.md."""
import copy
import multiprocessing
import pickle
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np

import soapfilm


def ball(samples=4000, seed=None):
    """Somebody's scan: no tool of ours makes it."""
    i = np.arange(samples) + 0.5
    z, angle = 1 - 2 * i / samples, 2.399963229728653 * i
    r = np.sqrt(1 - z * z)
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    return points if seed is None else points + np.random.default_rng(seed).normal(scale=0.002, size=points.shape)


def readme(page):
    """The lines of the README, as they are."""
    program = re.search(r"^```python\n(.*?)^```$", Path(page).read_text(encoding="utf-8"), flags=re.M | re.S)[1]
    assert len(program.splitlines()) <= 6
    names = {"points": ball()[ball()[:, 2] > -0.5]}
    exec(program, names)
    result = names["result"]
    assert Path("mesh.ply").stat().st_size > 10_000
    print("README:", result, f"proved within {100 * result.certificate['relative_gap_binary']:.2g} %")
    again = soapfilm.reconstruct("mesh.ply", resolution=32)  # a name of a file
    assert len(again.vertices) > 500


def other_packages():
    """A cloud as other packages have it, and the mesh back in them."""
    try:
        import open3d as o3d
    except ImportError:
        print("Open3D: not installed")
        return
    soapfilm.Points(ball()).save("scan.ply")
    cloud = o3d.io.read_point_cloud("scan.ply")
    cloud.paint_uniform_color([1, 0, 0])
    cloud.estimate_normals()
    cloud.orient_normals_consistent_tangent_plane(10)
    result = soapfilm.reconstruct(cloud, resolution=32)
    assert (result.colors == [255, 0, 0]).all()
    assert result.to_open3d().is_watertight()
    same = soapfilm.reconstruct(o3d.t.geometry.PointCloud.from_legacy(cloud), resolution=32)  # float32
    assert abs(same.volume - result.volume) < 1e-3
    near = np.asarray(cloud.points)[:, 2] > 0
    assert len(soapfilm.Points(cloud)[near]) == near.sum()
    print("Open3D:", result)


def work(points):
    """Of a pool of processes: what goes in and comes out is pickled."""
    return soapfilm.reconstruct(points, resolution=24, threads=1, progress=False)


def pickling():
    clouds = [soapfilm.Points(ball(2000, seed), ball(2000)) for seed in range(3)]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        results = pool.map(work, clouds)
    alone = [work(cloud) for cloud in clouds]
    for ours, theirs in zip(results, alone):
        assert np.array_equal(ours.vertices, theirs.vertices) and ours.certificate == theirs.certificate
    Path("result.pickle").write_bytes(pickle.dumps(results[0]))
    code = "import pickle; print(pickle.load(open('result.pickle', 'rb')))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == repr(copy.deepcopy(results[0]))
    print("pickled:", done.stdout.strip())


def parts():
    cloud = sum(soapfilm.Points(ball(1000, seed)) for seed in (1, 2))
    assert len(cloud) == 2000 and len(cloud.scans) == 2 and len(cloud[cloud.positions[:, 0] > 0][:10]) == 10
    print("parts:", cloud[::2])


def mistakes():
    """Each is one line in words that can be typed."""
    for call in (lambda: soapfilm.reconstruct(ball(), resolutoin=32), lambda: soapfilm.reconstruct(ball().ravel()),
                 lambda: soapfilm.reconstruct(ball(), method="tw"), lambda: soapfilm.reconstruct("nowhere.ply"),
                 lambda: soapfilm.reconstruct(ball(), resolution=600, memory="20M"),
                 lambda: soapfilm.Points(ball())[7]):
        try:
            call()
        except (TypeError, ValueError, MemoryError) as error:
            assert "--" not in str(error) and len(str(error).splitlines()) == 1
            print(f"{type(error).__name__}: {error}")
        else:
            raise AssertionError("a mistake was taken")
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        soapfilm.reconstruct(np.concatenate([ball(), 1.5 * ball(200)]), resolution=48, progress=False)
    assert seen and all(issubclass(w.category, soapfilm.SoapfilmWarning) for w in seen)
    assert all(w.filename == __file__ and "--" not in str(w.message) for w in seen)
    print("warned:", seen[0].message)


def looking():
    if not soapfilm._core.has_tools or not soapfilm._core.has_viewer:
        return
    result = soapfilm.reconstruct(ball(), ball(), resolution=32)
    page = soapfilm.view([soapfilm.Points(ball()), result], "page.html")
    assert page == Path("page.html") and page.read_text(encoding="utf-8").startswith("<!")
    print("page:", page)


if __name__ == "__main__":
    readme(sys.argv[1])
    other_packages()
    pickling()
    parts()
    mistakes()
    looking()
