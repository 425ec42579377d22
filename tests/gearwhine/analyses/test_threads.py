"""Studies in several threads: the interpreter does not crash, and each thread's numbers are those of one thread."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

_HEAD = """
import threading
from concurrent.futures import ThreadPoolExecutor
import gearwhine as gw

COARSE = {"housing.box.mesh_size": "80 mm", "housing.frequency_limit": "", "housing.modes": 3}

def first_modes(wall):
    study = gw.load("steel-box", COARSE | {"housing.box.wall": wall})
    return study.modes().dataset["housing_frequency"].values[:3].tolist()

def in_a_thread_that_ends(wall):
    found = []
    thread = threading.Thread(target=lambda: found.append(first_modes(wall)))
    thread.start()
    thread.join()
    return found[0]
"""
_AT_ONCE = """
with ThreadPoolExecutor(2) as pool:
    together = list(pool.map(first_modes, ("10 mm", "12 mm")))
assert together == [first_modes("10 mm"), first_modes("12 mm")], together
study = gw.load("steel-box", COARSE)
with ThreadPoolExecutor(2) as pool:
    housings = list(pool.map(lambda _: study.housing, range(4)))
assert all(housing is housings[0] for housing in housings)
"""
_ONE_AFTER_ANOTHER = """
thin, thick = in_a_thread_that_ends("10 mm"), in_a_thread_that_ends("12 mm")
assert [first_modes("10 mm"), first_modes("12 mm")] == [thin, thick]
"""


@pytest.mark.slow
@pytest.mark.parametrize("work", [_AT_ONCE, _ONE_AFTER_ANOTHER])
def test_studies_in_threads_work_as_in_one(work: str) -> None:
    # A process of its own: what is tested is who loads the libraries first.
    done = _python(_HEAD + work)
    assert done.returncode == 0, done.stderr[-500:]


@pytest.mark.slow
def test_a_session_waits_for_that_of_another_thread() -> None:
    done = _python(
        """
import threading
from gearwhine.meshes.gmsh_meshing import gmsh_session
order, opened, ended = [], threading.Event(), threading.Event()

def other():
    opened.wait()
    with gmsh_session("second") as gmsh:
        order.append(gmsh.model.list())

thread = threading.Thread(target=other)
thread.start()
with gmsh_session("first") as gmsh:
    opened.set()
    thread.join(0.3)
    order.append(gmsh.model.list())
thread.join()
assert order == [["", "first"], ["", "second"]], order
"""
    )
    assert done.returncode == 0, done.stderr[-500:]


@pytest.mark.slow
def test_a_session_of_other_code_is_refused_and_keeps_its_models() -> None:
    done = _python(
        """
import gmsh
from gearwhine.meshes.errors import MesherUnavailableError
from gearwhine.meshes.gmsh_meshing import gmsh_session
gmsh.initialize()
gmsh.model.add("mine")
try:
    with gmsh_session("ours"):
        raise AssertionError("not refused")
except MesherUnavailableError as error:
    assert "gmsh.finalize()" in str(error), error
assert "mine" in gmsh.model.list()
"""
    )
    assert done.returncode == 0, done.stderr[-500:]


def _python(script: str) -> subprocess.CompletedProcess[str]:
    root = str(Path(__file__).parents[3])
    environment = os.environ | {"PYTHONPATH": root}
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment, timeout=300)
