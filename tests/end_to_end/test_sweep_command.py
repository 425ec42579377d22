"""The sweep as a user runs it: workers killed, interrupted and resumed, failed points, one labelled file."""

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import psutil
import pytest
import xarray as xr

from gearwhine.cli import run_command

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent.parent
TEETH, BASE_RADIUS, TORQUE = 28, 0.5 * 28 * 3.175e-3 * math.cos(math.radians(20.0)), 71.77
SPEEDS = (3000.0, 3600.0)
# A bearing that pushes its shaft around: the motion grows without bound.
UNSTABLE = "bearing.input-back.stiffness.xy=0,1e10 N/m"
# Teeth may be pressed flat before or after the motion itself is out of bounds.
DIVERGED = "pressed together by|motion diverged"
ROTORS = (
    *("sweep", "spur-pair", "-o", "out", "--json", "--no-pictures"),
    *("--over", "operation.speed=3000 rpm,3600 rpm", "--over", UNSTABLE),
    # Points that take half a second or so, so that there is something to interrupt.
    *("--set", "transient.revolutions=6", "--set", "transient.discard=5", "--set", "transient.tolerance=2e-4"),
)
HOUSED = (
    *("sweep", "small-gearbox", "-q", "--json", "--set", "housing.box.mesh_size=50 mm"),
    *("--set", "transient.revolutions=2", "--set", "transient.discard=1", "--set", "transient.tolerance=1e-3"),
)


def start(folder: Path, arguments: tuple[str, ...], workers: int) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "gearwhine", *arguments, "--workers", str(workers)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    # A shell has what it starts in the background ignore Ctrl-C, and children inherit that.
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, text=True, cwd=folder, env=environment, start_new_session=True, **pipes)


def said(process: "subprocess.Popen[str]", within: float) -> tuple[str, str]:
    """What a command writes until it ends; one that does not is killed, lest its pipes trouble other tests."""
    try:
        return process.communicate(timeout=within)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise


def workers_of(process: "subprocess.Popen[str]") -> list[psutil.Process]:
    workers = []
    for child in psutil.Process(process.pid).children(recursive=True):
        # What ends meanwhile, as a helper that looks something up does, is none.
        with suppress(psutil.NoSuchProcess):
            if "spawn_main" in " ".join(child.cmdline()):
                workers.append(child)
    return workers


def wait_for(what: Callable[[], object], process: "subprocess.Popen[str]") -> None:
    until = time.monotonic() + 240.0
    while not what():
        assert time.monotonic() < until
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)


@pytest.fixture(scope="module")
def interrupted_and_hurt(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:
    """A sweep interrupted by Ctrl-C after its first point, taken up again, and a worker of it killed.

    The first time by one worker: each takes seconds to start.
    """
    folder = tmp_path_factory.mktemp("rotors")
    points = folder / "out" / "points"
    process = start(folder, ROTORS, 1)
    wait_for(lambda: list(points.glob("*.nc")), process)
    hands = workers_of(process)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers too
    out, errors = said(process, 60.0)
    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in errors
    assert "interrupted" in errors
    _, alive = psutil.wait_procs(hands, timeout=10)
    assert not alive
    assert {path.name for path in (folder / "out").glob("[!.]*")} == {"points"}

    kept = {path.name: path.stat().st_mtime_ns for path in points.iterdir() if "xy-0" in path.name}
    process = start(folder, ROTORS, 2)
    before = len(list(points.iterdir()))
    wait_for(lambda: len(list(points.iterdir())) > before, process)
    workers_of(process)[0].send_signal(signal.SIGKILL)
    out, errors = said(process, 240.0)
    assert process.returncode == 1, errors
    assert "2 of 4 points failed" in errors
    assert "Traceback" not in errors
    after = {path.name: path.stat().st_mtime_ns for path in points.iterdir()}
    assert {name: after[name] for name in kept} == kept
    document = json.loads(out)
    assert document["resumed"] == len(kept)
    return folder / "out", document


def test_ctrl_c_while_workers_start_is_quiet_and_leaves_none(tmp_path: Path) -> None:
    process = start(tmp_path, ROTORS, 2)
    wait_for(lambda: workers_of(process), process)
    hands = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    out, errors = said(process, 60.0)
    assert (process.returncode, out) == (130, "")
    assert "Traceback" not in errors
    _, alive = psutil.wait_procs(hands, timeout=10)
    assert not alive
    assert list(tmp_path.iterdir()) == []


def test_every_point_is_there_and_the_failed_ones_say_why(interrupted_and_hurt: tuple[Path, dict]) -> None:
    folder, document = interrupted_and_hurt
    assert (document["done"], document["failed"]) == (2, 2)
    for point in document["points"]:
        stable = point["settings"]["bearing.input-back.stiffness.xy"] == "0"
        assert point["status"] == ("done" if stable else "failed")
        assert (folder / point["file"]).is_file()
        if not stable:
            assert re.search(DIVERGED, point["failure"])
            assert "traceback" not in point
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["points"] == document["points"]
    assert set(document["files"]) | {"points"} == {path.name for path in folder.glob("[!.]*")}


def test_the_gathered_file_is_labelled_and_holds_the_closed_forms(interrupted_and_hurt: tuple[Path, dict]) -> None:
    with xr.open_dataset(interrupted_and_hurt[0] / "sweep.nc") as data:
        assert data.mesh_force_mean.dims == ("speed", "bearing_input_back_stiffness_xy", "contact")
        assert data.speed.attrs == {"units": "rpm", "long_name": "operation.speed"}
        assert data.speed.values.tolist() == list(SPEEDS)
        stable = data.isel(bearing_input_back_stiffness_xy=0, contact=0)
        assert stable.done.all()
        # The mean mesh force is the torque over the base radius, at any speed.
        assert stable.mesh_force_mean.values == pytest.approx(np.full(2, TORQUE / BASE_RADIUS), rel=5e-3)
        assert stable.mesh_frequency.values == pytest.approx(TEETH * np.array(SPEEDS) / 60.0)
        assert stable.frequency.sel(speed=3600.0, order=TEETH) == pytest.approx(TEETH * 60.0)
        # The mesh leads its own force: the highest line is at a multiple of the number of teeth.
        spectrum = stable.mesh_force_spectrum.where(data.order > 0.0)
        leading = data.order.values[spectrum.fillna(0.0).argmax("order").values]
        assert np.all(leading % TEETH == 0.0)
        failed = data.isel(bearing_input_back_stiffness_xy=1)
        assert not failed.done.any()
        assert failed.mesh_force_mean.isnull().all()
        assert all(re.search(DIVERGED, str(text)) for text in failed.failure.values)


@contextmanager
def cluster(folder: Path) -> Iterator[str]:
    """A Dask scheduler and one worker of it, as somebody else runs them."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    file = folder / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment, "cwd": folder}
    module = (sys.executable, "-m", "distributed.cli")
    scheduler = [f"{module[2]}.dask_scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard"]
    worker = [f"{module[2]}.dask_worker", "--nthreads", "1", "--no-dashboard", "--no-nanny"]
    processes = []
    try:
        for arguments in (scheduler, worker):
            command = [*module[:2], *arguments, "--scheduler-file", str(file)]
            processes.append(subprocess.Popen(command, **quiet))
            # Not only there, but written to its end.
            wait_for(lambda: file.exists() and file.read_bytes().endswith(b"}"), processes[0])
        yield json.loads(file.read_text(encoding="utf-8"))["address"]
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(30)


@pytest.fixture(scope="module")
def housed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict, dict]:
    """Two speeds of the small gearbox by a cluster's worker, and its document; then the same again, its document."""
    folder = tmp_path_factory.mktemp("housed")
    arguments = (*HOUSED, "-o", str(folder / "out"), "--over", "operation.speed=3000 rpm,6000 rpm")
    summary = folder / "out" / "summary.json"
    with cluster(folder) as address:
        assert run_command([*arguments, "--scheduler", address]) == 0
    first = json.loads(summary.read_text(encoding="utf-8"))
    assert run_command(list(arguments)) == 0
    return folder / "out", first, json.loads(summary.read_text(encoding="utf-8"))


def test_sensors_and_pictures(housed: tuple[Path, dict, dict]) -> None:
    folder, document, _ = housed
    pictures = {"sweep-rms.png", "sweep-mesh-force.png", "waterfall-top.png", "waterfall-right-wall.png"}
    present = {path.name for path in folder.glob("[!.]*")}
    assert present == pictures | {"case.toml", "modes.nc", "points", "summary.json", "sweep.nc"}
    with xr.open_dataset(folder / "sweep.nc") as data:
        assert data.attrs["window"] == "uniform"
        # Parseval: the square of the rms is half the sum of the squared lines above 0.
        lines = data.sensor_spectrum.where(data.order > 0.0).fillna(0.0)
        assert np.sqrt(0.5 * (lines**2).sum("order")).values == pytest.approx(data.sensor_rms.values, rel=1e-9)
        # A peak is a line of the spectrum, up to the limit of the housing's modes.
        assert float(data.sensor_peak_frequency.max()) <= float(data.trusted_limit.max())
        top = data.sel(sensor="top", speed=6000.0)
        at = int(np.abs(top.frequency.values - float(top.sensor_peak_frequency[0])).argmin())
        assert float(top.sensor_spectrum[at]) == pytest.approx(float(top.sensor_peak_amplitude[0]))
    listed = [sensor["rms_m_per_s2"] for point in document["points"] for sensor in point["sensors"]]
    assert min(listed) > 0.0


def test_a_sweep_that_is_done_is_only_read(housed: tuple[Path, dict, dict]) -> None:
    _, first, again = housed
    assert (first["resumed"], again["resumed"], again["done"]) == (0, 2, 2)
    assert [point["sensors"] for point in again["points"]] == [point["sensors"] for point in first["points"]]


WRONG = {
    "nothing to go through": ((), "sweep: expected speeds"),
    "no range": (("--over", "operation.speed=1:2"), "key.path=from:to:n"),
    "a value that the case does not take": (("--over", "gear.pinion.teeth=1,28"), "sweep, gear.pinion.teeth=1"),
    "a speed of zero": (("--over", "operation.speed=0 rpm:10 rpm:2"), "other than zero"),
    "no workers": (("--over", "operation.torque=1,2", "--workers", "0"), "--workers"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_cannot_be_swept_is_said_before_anything_is_solved(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, said = WRONG[kind]
    assert run_command(["sweep", "spur-pair", "-q", "-o", "out", *arguments]) == 2
    assert said in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == []
