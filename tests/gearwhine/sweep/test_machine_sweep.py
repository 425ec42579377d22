"""Sweep of a machine of Python over speed, beside that of the same machine in a case."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling import CouplingError, TransientError
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion
from gearwhine.sweep import machine_sweep
from gearwhine.sweep.solution import PointResult

SHORT = {"transient.revolutions": 4, "transient.discard": 2, "transient.tolerance": 1e-3}
# What a case says beside its machine, and what depends on the clock or on files.
OF_THE_CASE = {"seconds", "steps_per_second", "file", "warnings", "damping"}


def assert_alike(found: gw.Result[Any], expected: gw.Result[Any]) -> None:
    """Every point's numbers and every array are the same."""
    for one, other in zip(found.document["points"], expected.document["points"], strict=True):
        assert one["status"] == "done"
        assert other.keys() - one.keys() <= OF_THE_CASE
        for key in one.keys() - OF_THE_CASE:
            assert one[key] == other[key], key
    for key in ("axes", "missed_peaks"):
        assert found.document[key] == expected.document[key]
    assert set(found.dataset.variables) == set(expected.dataset.variables)
    for name, array in expected.dataset.variables.items():
        np.testing.assert_array_equal(found.dataset.variables[name], array)
        assert found.dataset.variables[name].attrs == array.attrs


@pytest.mark.slow
def test_a_sweep_of_a_machine_is_that_of_the_case(swept_here: None, tmp_path: Path) -> None:
    study = gw.load("spur-pair", SHORT | {"sweep.speed": ["2000 rpm", "3000 rpm"]})
    found = gw.Study(study.machine, study.settings).sweep()
    assert_alike(found, study.sweep(folder=tmp_path / "case", workers=1))
    assert [name for name, _ in found.figures()]
    files = found.write(tmp_path / "machine", pictures=False)
    assert {"sweep.nc", "sweep.json"} & set(files)


def test_a_speed_without_a_motion_has_its_failure_and_the_others_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def solve(machine: gw.Machine, *_: Any) -> PointResult:
        if machine.speed > 150.0:
            raise TransientError("the motion diverged")
        document = {"sensors": [], "gear_pairs": [], "speed_rpm": 1.0, "trusted_below_hz": 1.0}
        return PointResult(document | {"energy_error": 0.0, "steps": 1}, ReducedMotion(np.zeros(0)))

    monkeypatch.setattr(machine_sweep, "solve_motion_of_point", solve)
    machine = gw.Study(gw.load("spur-pair", SHORT).machine)
    plan = gw.TransientPlan(revolutions=4.0, discard=2.0)
    found = machine.sweep([100.0, 200.0], plan).document
    assert [point["status"] for point in found["points"]] == ["done", "failed"]
    assert "diverged" in found["points"][1]["failure"]
    assert (found["done"], found["failed"]) == (1, 1)
    for speeds in ([200.0, 0.0], [float("nan")], []):
        with pytest.raises(CouplingError, match=r"expected (finite speeds other|numbers, each a finite)"):
            machine.sweep(speeds, plan)
    with pytest.raises(CouplingError, match="sweep: expected how far to integrate"):
        machine.sweep([200.0])
