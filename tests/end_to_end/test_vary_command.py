"""Varied gearboxes as a user solves them: a worker killed, the whole killed, and nothing found lost."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import pytest
import xarray as xr

from gearwhine.case.load import bundled_case
from gearwhine.cli import run_command

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent.parent
VARIATION = """
[variation]
samples = 20
analyses = ["load"]
[variation.vary]
"gear.*.errors.helix.slope" = { class = 7, independent = true }
"operation.torque" = { uniform = ["100 N*m", "150 N*m"] }
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    bundled = bundled_case("helical-pair")
    assert bundled is not None
    path = tmp_path / "pair.toml"
    path.write_text(bundled.read_text() + VARIATION)
    return path


def _started(case: Path, out: Path) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "gearwhine", "vary", str(case), "-o", str(out), "--workers", "2", "-q"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, text=True, env=environment, start_new_session=True, **pipes)


def _wait_for(what: Callable[[], bool], process: "subprocess.Popen[str]") -> None:
    until = time.monotonic() + 240.0
    while not what():
        assert time.monotonic() < until
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)


def _found(out: Path) -> list[bytes]:
    return [line for record in out.glob("samples/*.jsonl") for line in record.read_bytes().splitlines()]


def test_neither_a_killed_worker_nor_a_killed_study_loses_a_gearbox(case: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = _started(case, out)
    _wait_for(lambda: len(_found(out)) > 3, process)
    for child in psutil.Process(process.pid).children(recursive=True):
        with suppress(psutil.NoSuchProcess):
            if "spawn_main" in " ".join(child.cmdline()):
                child.send_signal(signal.SIGKILL)
                break
    before = len(_found(out))
    _wait_for(lambda: len(_found(out)) > before + 3, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate(timeout=60.0)
    kept = _found(out)
    assert len(kept) < 20
    assert all("numbers" in json.loads(line) for line in kept[:-1])
    assert run_command(["vary", str(case), "-o", str(out), "-q", "--workers", "1"]) == 0
    document = json.loads((out / "summary.json").read_text())
    assert document["resumed"] >= len(kept) - 1
    assert (document["samples"], document["failed"]) == (20, [])
    assert _found(out)[: len(kept) - 1] == kept[: len(kept) - 1]
    # The same gearboxes, found in one go by one process.
    whole = tmp_path / "whole"
    assert run_command(["vary", str(case), "-n", "8", "-o", str(whole), "-q", "--workers", "1"]) == 0
    with xr.open_dataset(out / "vary.nc") as resumed, xr.open_dataset(whole / "vary.nc") as alone:
        assert np.array_equal(resumed["value"].values[:8], alone["value"].values)
