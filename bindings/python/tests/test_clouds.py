"""Clouds, meshes and results as values: parts, sums, copies, pickles."""
import copy
import pickle

import numpy as np
import pytest
from conftest import mesh_bytes

import soapfilm


def columns(cloud):
    """All of a cloud that can be compared."""
    found = {name: getattr(cloud, name) for name in ("positions", "normals", "sensors", "weights", "colors")}
    return {name: column for name, column in {**found, **cloud.values}.items() if column is not None}


def assert_same(ours, theirs):
    assert columns(ours).keys() == columns(theirs).keys()
    for name, column in columns(ours).items():
        assert np.array_equal(column, columns(theirs)[name], equal_nan=True), name
    for a, b in zip(ours.scans, theirs.scans):
        assert {**a, "range_grid": None} == {**b, "range_grid": None}
        assert np.array_equal(a["range_grid"], b["range_grid"])
    assert len(ours.scans) == len(theirs.scans)
    assert ours.files == theirs.files and ours.warnings == theirs.warnings
    assert ours.coordinate_system == theirs.coordinate_system


@pytest.fixture(scope="module")
def cloud(ball):
    """Three scans with all that arrays give."""
    labels = np.where(ball[:, 2] > 0.2, 7, np.where(ball[:, 0] > 0, -3, 2))
    return soapfilm.Points(ball, ball, scans=labels, sensors=[[3.0, 0, 0], [-3, 0, 0], [0, 0, 4]],
                           colors=np.abs(ball), weights=np.linspace(0, 1, len(ball)), name="part",
                           values={"height": ball[:, 2], "class": np.arange(len(ball)) % 3})


@pytest.fixture(scope="module")
def scans():
    """Two scans with range grids."""
    return soapfilm.scan("sphere", views=2, image=(30, 20))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_a_pickled_cloud_is_the_same(cloud, scans, protocol):
    for original in (cloud, scans, soapfilm.Points(cloud.positions)):
        again = pickle.loads(pickle.dumps(original, protocol))
        assert type(again) is soapfilm.Points and repr(again) == repr(original)
        assert_same(again, original)


def test_a_pickled_cloud_gives_the_same_bytes(cloud):
    """Labels stay labels, scans keep their scanners."""
    given = dict(resolution=32, attributes="all", outside="air")
    a, b = soapfilm.reconstruct(cloud, **given), soapfilm.reconstruct(pickle.loads(pickle.dumps(cloud)), **given)
    assert mesh_bytes(a) == mesh_bytes(b)
    assert np.array_equal(a.attributes["class"], b.attributes["class"])
    assert set(np.unique(a.attributes["class"])) <= {0, 1, 2}


def test_a_pickle_keeps_what_reading_found(tmp_path):
    (tmp_path / "cloud.xyz").write_text("0 0 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    cloud = soapfilm.read(tmp_path / "cloud.xyz")
    again = pickle.loads(pickle.dumps(cloud))
    assert_same(again, cloud)
    assert again.files[0]["dropped"] == 1


def test_copies(cloud):
    for again in (copy.copy(cloud), copy.deepcopy(cloud)):
        assert again is not cloud
        assert_same(again, cloud)
        assert np.shares_memory(again.positions, cloud.positions), "what cannot change is not copied"


def test_slices_and_masks(cloud):
    mask = cloud.positions[:, 1] > 0.3
    for which in (slice(10, 20), slice(None, None, 7), mask, mask.tolist(), np.flatnonzero(mask),
                  np.flatnonzero(mask) - len(cloud)):
        part = cloud[which]
        rows = which if isinstance(which, slice) else np.asarray(which)
        for name, column in columns(cloud).items():
            assert np.array_equal(columns(part)[name], column[rows]), name
    part = cloud[mask]
    assert [scan["sensor"] for scan in part.scans] == [scan["sensor"] for scan in cloud.scans]
    assert [scan["end"] - scan["begin"] for scan in part.scans] == \
        [int(mask[scan["begin"]:scan["end"]].sum()) for scan in cloud.scans]
    assert part.scans[0]["name"] == "part" and part.scans[-1]["end"] == len(part) == mask.sum()
    assert len(cloud[10:20].scans) == 1, "scans without samples are gone"


def test_indices_in_any_order_stay_in_their_scans(cloud):
    rows = np.random.default_rng(3).permutation(len(cloud))[:500]
    part = cloud[rows]
    ends = [scan["end"] for scan in cloud.scans]
    expected = rows[np.argsort(np.searchsorted(ends, rows, side="right"), kind="stable")]
    assert np.array_equal(part.positions, cloud.positions[expected])
    assert np.array_equal(cloud[[5, 5, 1]].positions, cloud.positions[[5, 5, 1]])


def test_range_grids_follow(scans):
    keep = scans.positions[:, 0] > 0
    part = scans[keep]
    for k, scan in enumerate(part.scans):
        grid, before = scan["range_grid"], scans.scans[k]["range_grid"]
        samples = part.positions[scan["begin"]:scan["end"]]
        seen = grid >= 0
        assert grid.shape == before.shape and seen.sum() == len(samples) < (before >= 0).sum()
        assert np.array_equal(samples[grid[seen]], scans.positions[scans.scans[k]["begin"] + before[seen]])
    assert_same(part, pickle.loads(pickle.dumps(part)))


def test_an_open_part_is_reconstructed(scans):
    assert len(soapfilm.reconstruct(scans[scans.positions[:, 2] > 0], resolution=32, outside="open").vertices) > 100


@pytest.mark.parametrize("which, kind, message", [
    (3, TypeError, "slice, a mask or indices"), ("height", TypeError, "slice, a mask or indices"),
    (np.zeros((2, 2), int), TypeError, "slice"), (np.array([0.5]), TypeError, "slice"),
    (np.zeros(3, bool), soapfilm.ParameterError, r"3 values, must be one per sample \(4000\)"),
    ([4000], IndexError, r"4000, must be in \[-4000, 4000\)"), ([], soapfilm.SamplesError, "no samples remain"),
    (slice(9, 3), soapfilm.SamplesError, "no samples remain"),
])
def test_parts_that_do_not_exist(cloud, which, kind, message):
    with pytest.raises(kind, match=message):
        cloud[which]


def test_a_cloud_is_no_sequence_of_rows_but_numpy_has_its_positions(cloud):
    with pytest.raises(TypeError):
        iter(cloud)
    assert np.array_equal(np.asarray(cloud), cloud.positions)
    assert np.asarray(cloud, dtype=np.float32).dtype == np.float32


def test_sums(ball, cloud):
    bare = soapfilm.Points(2 * ball[:100], name="bare")
    both = cloud + bare
    assert len(both) == len(cloud) + 100 and [scan["name"] for scan in both.scans] == ["part"] * 3 + ["bare"]
    assert np.array_equal(both.positions, np.concatenate([cloud.positions, bare.positions]))
    assert not both.normals[-100:].any() and (both.weights[-100:] == 1).all(), "neutral where there is none"
    assert np.isnan(both.values["height"][-100:]).all()
    assert_same(sum([cloud, bare, cloud]), cloud + bare + cloud)
    first = cloud.scans[0]["end"]
    assert_same(cloud[:first] + cloud[first:], cloud)
    with pytest.raises(TypeError):
        cloud + ball


def test_a_sum_is_the_files_together(tmp_path, ball):
    soapfilm.Points(ball[::2], ball[::2]).save(tmp_path / "a.ply")
    soapfilm.Points(ball[1::2], ball[1::2]).save(tmp_path / "b.ply")
    paths = [tmp_path / "a.ply", tmp_path / "b.ply"]
    assert_same(soapfilm.read(paths[0]) + soapfilm.read(paths[1]), soapfilm.read(paths))


def test_clouds_of_two_coordinate_systems_are_not_added(tmp_path, ball):
    systems = []
    for system in ("EPSG:25832", "EPSG:4978"):
        cloud = soapfilm.Points(ball)
        state = cloud.__reduce__()[1][0]
        state["facts"] = {**state["facts"], "coordinate_system": system}
        systems.append(cloud.__reduce__()[0](state))
    assert systems[0].coordinate_system == "EPSG:25832"
    with pytest.raises(soapfilm.ParameterError, match="coordinate systems"):
        systems[0] + systems[1]
    assert (systems[0] + soapfilm.Points(ball)).coordinate_system == "EPSG:25832"


def test_meshes_and_results(tmp_path, cloud):
    result = soapfilm.reconstruct(cloud, resolution=32, attributes="all", distance=True)
    mesh = soapfilm.Mesh(result.vertices, result.triangles, normals=result.normals)
    for original in (result, mesh, soapfilm.Mesh(result.vertices, result.triangles)):
        for again in (pickle.loads(pickle.dumps(original)), copy.copy(original), copy.deepcopy(original)):
            assert type(again) is type(original) and mesh_bytes(again) == mesh_bytes(original)
            assert np.array_equal(again.normals, original.normals) and repr(again) == repr(original)
            assert again.attributes.keys() == original.attributes.keys()
            for suffix in (".ply", ".glb"):
                again.save(tmp_path / f"again{suffix}")
                original.save(tmp_path / f"original{suffix}")
                assert (tmp_path / f"again{suffix}").read_bytes() == (tmp_path / f"original{suffix}").read_bytes()
    again = pickle.loads(pickle.dumps(result))
    assert again.report == result.report and again.voxel == result.voxel and again.warnings == result.warnings
    assert mesh_bytes(soapfilm.reconstruct(cloud, params=again)) == mesh_bytes(result)


def test_errors_pickle():
    """As from a worker of multiprocessing."""
    error = soapfilm.EmptyResult("nothing", 0.25)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.largest_lambda) == ("nothing", 0.25)
    for kind in (soapfilm.ParameterError, soapfilm.SamplesError, soapfilm.InputError, soapfilm.OutputError,
                 soapfilm.OutOfMemory):
        again = pickle.loads(pickle.dumps(kind("a = 1, must be 2")))
        assert type(again) is kind and str(again) == "a = 1, must be 2"
