"""The command `modes` with a solver that cannot be started: refused by its key, with what is missing."""

from typing import Any

import pytest

from gearwhine.housing.fem.slepc import COMMAND


@pytest.mark.slow
def test_slepc_that_cannot_be_started_is_refused_by_its_key(gearwhine: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(COMMAND, "no-such-mpiexec")
    outcome = gearwhine("modes", "small-gearbox", "--set", "housing.solver=slepc", "-o", "out")
    assert outcome.code == 2
    assert "housing.solver: expected one that can be started" in outcome.err
    assert "gearwhine[slepc]" in outcome.err
    assert "'no-such-mpiexec' fails" in outcome.err


def test_another_solver_is_refused_by_its_key(gearwhine: Any) -> None:
    outcome = gearwhine("check", "small-gearbox", "--set", "housing.solver=mumps")
    assert outcome.code == 2
    assert "housing.solver" in outcome.err
    assert "slepc" in outcome.err
