"""A run that dies leaves the last complete result, never half of one."""

import json
import random
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

import pytest
import xarray as xr

SHORT = ("--set", "transient.revolutions=6", "--set", "transient.discard=4", "--set", "housing.box.mesh_size=50 mm")
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


@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_killed_run_leaves_nothing_halved(start_process, tmp_path: Path, how: signal.Signals) -> None:
    chance = random.Random(int(how))
    process = start_process("run", "small-gearbox", "-q", "-o", "out", *SHORT)
    with suppress(subprocess.TimeoutExpired):
        process.wait(chance.uniform(1.0, 5.0))  # a fast machine may be done before
    process.send_signal(how)
    _, errors = process.communicate(timeout=60)
    out = tmp_path / "out"
    if out.exists():
        check_whole(out)
    if how != signal.SIGKILL:
        assert process.returncode in (0, 130, -how)  # -how: before the command began, or after it ended
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
