"""Scans as they come."""
import numpy as np
import pytest
from conftest import mesh_bytes

import soapfilm

TURN = np.array([[0, -1, 0, 2], [1, 0, 0, -4], [0, 0, 1, 8], [0, 0, 0, 1.0]])  # nothing is rounded


@pytest.fixture(scope="module")
def parts(ball):
    ball = np.round(ball * 2 ** 20) / 2 ** 20
    return [ball[k::3] for k in range(3)]


def test_at_any_time_the_bytes_of_all_at_once(parts):
    scans = soapfilm.Reconstructor(resolution=40)
    for k, part in enumerate(parts, 1):
        scans.add(part, part)
        together = np.concatenate(parts[:k])
        at_once = soapfilm.reconstruct(together, together, scans=[len(p) for p in parts[:k]], resolution=40)
        assert mesh_bytes(scans.reconstruct()) == mesh_bytes(at_once)
        assert scans.scans == k and len(scans) == len(together)


def test_poses(parts):
    rotation, shift = TURN[:3, :3], TURN[:3, 3]
    local = [(part - shift) @ rotation for part in parts]
    directions = [part @ rotation for part in parts]
    scans = soapfilm.Reconstructor(resolution=40, outside="air")
    for points, normals in zip(local, directions):
        scans.add(points, normals, pose=TURN)
    together = np.concatenate(parts)
    at_once = soapfilm.reconstruct(together, together, scans=[len(p) for p in parts], sensors=shift, resolution=40,
                                   outside="air")
    assert mesh_bytes(scans.reconstruct()) == mesh_bytes(at_once)
    assert scans.reconstruct(resolution=None, voxel=0.2).voxel == 0.2


def test_sensor_of_the_scans_frame(parts):
    scans = soapfilm.Reconstructor(outside="air", resolution=40)
    scans.add(parts[0], pose=TURN[:3], sensor=(1, 2, 3))
    at_once = soapfilm.reconstruct(parts[0] @ TURN[:3, :3].T + TURN[:3, 3], sensors=(0, -3, 11), outside="air",
                                   resolution=40)
    assert mesh_bytes(scans.reconstruct()) == mesh_bytes(at_once)


def test_files_and_clouds(parts, tmp_path):
    soapfilm.Points(parts[0], parts[0], name="first").save(tmp_path / "a.ply")
    scans = soapfilm.Reconstructor(resolution=40)
    scans.add(tmp_path / "a.ply")
    scans.add(soapfilm.Points(parts[1], parts[1]))
    together = np.concatenate(parts[:2])
    at_once = soapfilm.reconstruct(together, together, scans=[len(p) for p in parts[:2]], resolution=40)
    assert mesh_bytes(scans.reconstruct()) == mesh_bytes(at_once)
    assert repr(scans) == f"<soapfilm.Reconstructor: {len(together)} samples in 2 scans>"


def test_what_is_refused_is_not_added(parts):
    scans = soapfilm.Reconstructor()
    with pytest.raises(soapfilm.SamplesError):
        scans.reconstruct()
    scans.add(parts[0])
    for pose, message in [(2 * np.eye(3), r"shape \(3, 3\)"), (np.diag([2, 1, 1, 1]), "stretches"),
                          (np.diag([-1, 1, 1, 1]), "mirrors"), (np.full((4, 4), np.nan), "nan")]:
        with pytest.raises(soapfilm.ParameterError, match=message):
            scans.add(parts[1], pose=pose)
    with pytest.raises(soapfilm.ParameterError):
        scans.add(parts[1], parts[0][:-2])
    with pytest.raises(TypeError, match="'voxel'"):
        soapfilm.Reconstructor(voxl=1)
    with pytest.raises(TypeError, match="'voxel'"):
        scans.reconstruct(voxl=1)
    assert scans.scans == 1
