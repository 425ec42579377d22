"""Optimisation as a user runs it: interrupted in the middle, by workers, and nothing found lost."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from gearwhine.case.load import bundled_case
from gearwhine.cli import run_command

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent.parent
OPTIMISATION = """
[optimisation]
evaluations = 7
verify = false
[optimisation.design]
"gear.*.tip_relief.amount" = { range = ["5 um", "40 um"] }
"gear.pinion.errors.helix.crowning" = { range = ["0 um", "12 um"] }
[optimisation.aim]
"gear_pair.pinion-wheel.transmission_error_peak_to_peak_m" = { sense = "least" }
[optimisation.limit]
"gear_pair.pinion-wheel.k_h_beta" = { at_most = 2.0 }
"""


def test_an_interrupted_search_goes_on_by_workers_to_the_designs_of_one_go(tmp_path: Path) -> None:
    bundled = bundled_case("helical-pair")
    assert bundled is not None
    case, out, whole = tmp_path / "pair.toml", tmp_path / "out", tmp_path / "whole"
    case.write_text(bundled.read_text() + OPTIMISATION)
    command = [sys.executable, "-m", "gearwhine", "optimise", str(case), "-o", str(out), "--workers", "1", "-q"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen(command, text=True, env=environment, start_new_session=True, **pipes)

    def kept() -> list[bytes]:
        return [line for record in out.glob("samples/*.jsonl") for line in record.read_bytes().splitlines()]

    until = time.monotonic() + 240.0
    while len(kept()) < 3:
        assert time.monotonic() < until
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=120.0)
    assert process.returncode == 130
    assert "Traceback" not in error
    before = kept()
    assert 3 <= len(before) < 8
    assert not (out / "summary.json").exists()
    assert run_command(["optimise", str(case), "-o", str(out), "-q", "--workers", "2"]) == 0
    document = json.loads((out / "summary.json").read_text())
    assert document["resumed"] >= len(before) - 1
    assert document["designs"] == 7
    assert kept()[: len(before) - 1] == before[: len(before) - 1]
    assert run_command(["optimise", str(case), "-o", str(whole), "-q", "--workers", "1"]) == 0
    with xr.open_dataset(out / "optimise.nc") as resumed, xr.open_dataset(whole / "optimise.nc") as alone:
        assert np.array_equal(resumed["aim_value"].values, alone["aim_value"].values)
        assert np.array_equal(resumed["input_value"].values, alone["input_value"].values)
