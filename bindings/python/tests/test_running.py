"""Threads, Ctrl-C, progress."""
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from conftest import mesh_bytes

import soapfilm


@pytest.fixture(scope="module")
def large(ball):
    """Takes long enough at a resolution of 400 to be stopped on the way."""
    rows = np.repeat(ball, 20, axis=0)
    return rows + np.random.default_rng(1).normal(scale=0.01, size=rows.shape)


def test_ctrl_c_stops_the_run(large):
    stages = []
    begun = threading.Event()

    def progress(stage, fraction, detail):
        stages.append(stage)
        if stage == "solve":
            begun.set()

    def press():
        begun.wait()
        os.kill(os.getpid(), signal.SIGINT)

    finger = threading.Thread(target=press)
    finger.start()
    with pytest.raises(KeyboardInterrupt):
        soapfilm.reconstruct(large, large, resolution=400, progress=progress)
    finger.join()
    assert stages[-1] == "solve", "nothing ran after Ctrl-C"
    assert soapfilm.reconstruct(large[::20], large[::20], resolution=32), "the next run is not spoiled"


def test_ctrl_c_of_a_script(tmp_path):
    code = ("import os, signal, threading, numpy, soapfilm\n"
            "p = numpy.random.default_rng(1).normal(size=(300000, 3))\n"
            "p /= numpy.linalg.norm(p, axis=1)[:, None]\n"
            "threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
            "soapfilm.reconstruct(p, p, resolution=1500, threads=1, progress=False)\n")
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == -signal.SIGINT and done.stderr.rstrip().endswith("KeyboardInterrupt")


def test_a_handler_of_the_caller_runs(large):
    class Stop(Exception):
        pass

    def handler(number, frame):
        raise Stop

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        with pytest.raises(Stop):
            soapfilm.reconstruct(large, large, resolution=400, progress=False)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_what_progress_raises_cancels(large):
    def progress(stage, fraction, detail):
        if stage == "solve":
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        soapfilm.reconstruct(large, large, resolution=400, progress=progress)


def test_progress_tells_stages_in_order(ball):
    told = []
    result = soapfilm.reconstruct(ball, ball, resolution=48, progress=lambda *event: told.append(event))
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    ran = [stage for stage in result.report["seconds"] if stage != "total"]
    assert stages == ran
    assert all(0 <= fraction <= 1 for _, fraction, _ in told)


def test_a_bar_is_drawn_where_someone_looks(ball, monkeypatch):
    class Terminal:
        text = ""

        def write(self, text):
            self.text += text

        def flush(self):
            pass

        def isatty(self):
            return True

    for modules in ({}, {"tqdm": None, "tqdm.auto": None}):
        terminal = Terminal()
        monkeypatch.setattr(sys, "stderr", terminal)
        for name, module in modules.items():
            monkeypatch.setitem(sys.modules, name, module)
        soapfilm.reconstruct(ball, ball, resolution=48)
        assert "solve" in terminal.text
        terminal.text = ""
        soapfilm.reconstruct(ball, ball, resolution=32, progress=False)
        assert terminal.text == ""


def test_two_threads_do_not_mix(ball):
    tasks = [dict(points=ball, resolution=40), dict(points=2 * ball + 5, voxel=0.11), dict(points=ball, resolution=33)]
    alone = [mesh_bytes(soapfilm.reconstruct(normals=ball, **task)) for task in tasks]
    found = [None] * len(tasks)
    stages = [[] for _ in tasks]

    def work(k):
        for _ in range(3):
            found[k] = mesh_bytes(soapfilm.reconstruct(
                normals=ball, progress=lambda stage, *_: stages[k].append(stage), **tasks[k]))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(tasks))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone
    assert all(seen.count("orient") >= 3 for seen in stages)


def test_python_runs_beside_it(large):
    """The interpreter's lock is released: another thread counts meanwhile."""
    count = 0
    done = threading.Event()

    def work():
        soapfilm.reconstruct(large, large, resolution=64, progress=False)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        count += 1
        done.wait(0.001)
    thread.join()
    assert count > 10
