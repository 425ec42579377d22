"""A run that dies leaves the last complete result, never half of one."""

import json
import random
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
import xarray as xr
from lopsided_case import FEW_WHIRLS

from gearwhine.analyses.run_solution import RunSolution
from gearwhine.case import load_case
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.modes_and_responses import solve_system
from gearwhine.coupling.analyses.signature import solve_signature
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.from_case.machine import describe_machine
from gearwhine.output.dataset import arrays_of, labels_of
from gearwhine.results.operating_point import LOAD
from gearwhine.solve.gear_pairs import analyse_pairs
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import load_of_case, plan_of, reduce_housing
from gearwhine.solve.rotors import solve_rotors

SHORT = ("--set", "transient.revolutions=6", "--set", "transient.discard=4", "--set", "housing.box.mesh_size=50 mm")
COARSE = ("--set", "housing.box.mesh_size=50 mm")
MANY = (*COARSE, "--set", "transient.revolutions=14", "--set", FEW_WHIRLS)
NUMBERS = ("time", "sensor_acceleration", "bearing_force", "mesh_force", "gear_displacement", "sensor_spectrum")
# Gears at no torque: fewer files, and no search for the best relief.
FEW = ("gears", "gear-62-62", "-q", "-o", "out", "--set", "operation=")


def check_whole(folder: Path) -> None:
    """Every file that is there can be read to its end."""
    for path in folder.iterdir():
        if path.name.startswith(".partial-"):
            continue  # a killed run's staging: cleared by the next one
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif path.suffix == ".nc":
            with xr.open_dataset(path) as data:
                data.load()
        elif path.suffix == ".png":
            assert path.read_bytes().endswith(b"IEND\xaeB`\x82")


def write_whole(file: Path) -> set[str]:
    """The results of the case by the stages of a run that nobody interrupts, without its pictures.

    Returns the names of the arrays of its operating point.
    """
    case = load_case("small-gearbox", MANY[1::2]).case
    rotors, housing = solve_rotors(case), solve_housing(case)
    part = reduce_housing(case, housing)
    described = describe_machine(case, part)
    load, _ = load_of_case(case.parts, described)
    assert load is not None
    standing = load_machine(described, load.point)
    pairs, machine = standing.pairs, standing.coupled
    system = solve_system(machine)
    transient = solve_transient(machine, plan_of(case))
    signature = solve_signature(transient, system.modes, housing.modes.frequencies_hz)
    whole = RunSolution(
        rotors, analyse_pairs(case, pairs, load.point), housing, None, system, transient, signature, None, load
    )
    whole.arrays(labels_of(case)).write(file)
    return set(arrays_of(LOAD, load))


@pytest.mark.slow
def test_an_interrupted_run_goes_on_to_the_same_results(start_process, gearwhine, tmp_path: Path) -> None:
    """Of a case with a housing: its modes too are read again, to the same machine bit for bit."""
    arguments = ("run", "small-gearbox", *MANY, "-o")
    process = start_process(*arguments, "out")
    wait_for_a_block(process, tmp_path / "out")
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "the same command goes on from there" in errors
    (kept,) = (tmp_path / "out").glob(".resume-*")
    first = (kept / "block-00000000.npz").stat().st_mtime_ns

    # In this process: to start another takes longer than what is left to do.
    before, seen = len(list(kept.glob("block-*"))), set()

    def watch() -> None:
        limit = time.monotonic() + 300.0
        while len(list(kept.glob("block-*.npz"))) <= before and time.monotonic() < limit:
            time.sleep(2e-3)
        seen.add((kept / "block-00000000.npz").stat().st_mtime_ns)

    watcher = Thread(target=watch)
    watcher.start()
    outcome = gearwhine(*arguments, "out", "--no-pictures")
    watcher.join()
    assert outcome.code == 0, outcome.err
    assert seen == {first}
    # Without pictures the motion stays for them.
    assert sorted(path.name for path in (tmp_path / "out").glob(".*")) == [".gearwhine.json", kept.name]

    at_rest = write_whole(tmp_path / "whole.nc")
    with (
        xr.open_dataset(tmp_path / "out/results.nc") as resumed,
        xr.open_dataset(tmp_path / "whole.nc") as whole,
    ):
        assert set(resumed.variables) == set(whole.variables)
        for name, found in resumed.variables.items():
            if found.dtype.kind in "fc":
                # To rounding: sums of shapes turn on where in memory their arrays begin. Flanks of a box that is the
                # same on both sides are aligned to rounding alone.
                near = 1e-6 if name in at_rest else 1e-12
                least = near * float(np.nanmax(np.abs(found.values), initial=0.0)) + (1e-13 if name in at_rest else 0.0)
                np.testing.assert_allclose(found, whole[name], rtol=near, atol=least, err_msg=str(name))
            else:
                assert found.equals(whole[name].variable), name
        assert all(resumed[name].values.tobytes() == whole[name].values.tobytes() for name in NUMBERS)


def wait_for_a_block(process: "subprocess.Popen[str]", out: Path, count: int = 1) -> None:
    limit = time.monotonic() + 300.0
    while len(list(out.glob(".resume-*/block-*.npz"))) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < limit, "waited for too long"
        time.sleep(2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_a_killed_run_leaves_nothing_halved(start_process, tmp_path: Path, how: signal.Signals) -> None:
    chance = random.Random(int(how))
    process = start_process("run", "small-gearbox", "-q", "-o", "out", *SHORT)
    with suppress(subprocess.TimeoutExpired):
        process.wait(chance.uniform(1.0, 4.0))  # a fast machine may be done before
    process.send_signal(how)
    _, errors = process.communicate(timeout=60)
    out = tmp_path / "out"
    if out.exists():
        check_whole(out)
    if how != signal.SIGKILL:
        # -how: before the command began, or after it ended
        assert process.returncode in (0, 130, -how), errors
        assert "Traceback" not in errors
        assert not list(tmp_path.glob("out/.partial-*"))
    assert {path.name for path in tmp_path.iterdir()} <= {"out"}


def test_a_failed_run_keeps_the_last_results(gearwhine, tmp_path: Path) -> None:
    assert gearwhine(*FEW).code == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    (tmp_path / "out" / ".partial-stale").mkdir()
    assert gearwhine(*FEW, "--set", "gear.pinion.teeth=1").code == 2
    after = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir() if path.is_file()}
    assert after == before
    assert gearwhine(*FEW).code == 0
    assert not list((tmp_path / "out").glob(".partial-*"))
