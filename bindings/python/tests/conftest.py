"""Small clouds, and the program to compare with (SOAPFILM_PROGRAM; tests that need it skip without)."""
import os
import subprocess

import numpy as np
import pytest

import soapfilm

RESOLUTION = 48


@pytest.fixture(scope="session")
def knot():
    """Even samples of a knot with their normals: positions float64 and normals float32, (N, 3)."""
    points = soapfilm.scan("knot", samples=12000, noise="0.1%", seed=3)
    return np.array(points.positions), np.array(points.normals)


@pytest.fixture(scope="session")
def ball():
    """Points of a sphere by formula; no tool is needed. Normals are the positions, radius 1."""
    i = np.arange(4000) + 0.5
    z = 1 - 2 * i / len(i)
    angle = 2.399963229728653 * i
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


@pytest.fixture(scope="session")
def program():
    """Runs the program; returns its standard output. Fails unless the exit code is `code`."""
    path = os.environ.get("SOAPFILM_PROGRAM")
    if not path:
        pytest.skip("SOAPFILM_PROGRAM names no program")

    def run(*words, code=0):
        done = subprocess.run([path, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done.stdout if code == 0 else done.stderr

    return run


@pytest.fixture(autouse=True)
def quiet(monkeypatch):
    """Nothing is drawn, and warnings of small clouds do not fill the screen."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", soapfilm.SoapfilmWarning)
        yield


def mesh_bytes(mesh):
    return mesh.vertices.tobytes() + mesh.triangles.tobytes()
