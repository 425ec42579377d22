"""The machine in motion by the command: methods of marching, friction's history, signatures of a run-up."""

from typing import Any

import numpy as np
import pytest
from coupled_cases import coupled

from gearwhine.case import load_case
from gearwhine.coupling.analyses.transient import solve_transient
from gearwhine.results.run import transient_document
from gearwhine.solve.machine import plan_of

FEW = ("--set", "rotor.input.modes=2", "--set", "rotor.output.modes=2")
SHORT = (*FEW, "--set", "transient.revolutions=3", "--set", "transient.discard=1")
RUN = (
    *("--set", "transient.run={ from = '1500 rpm', to = '4500 rpm', time = '0.6 s' }"),
    *("--set", "transient.revolutions=", "--set", "transient.discard=0"),
)


MARCHED = {"newmark": "newmark", "exact": "exact", "auto": "exact"}


@pytest.fixture(scope="module")
def documents() -> dict[str, dict[str, Any]]:
    """What a march by each method tells, by the stages of the run: what it draws of them is looked at below."""
    found = {}
    for method in MARCHED:
        case = load_case("spur-pair", (*SHORT[1::2], f"transient.method='{method}'")).case
        machine = coupled(case)
        found[method] = transient_document(solve_transient(machine, plan_of(case)))
    return found


@pytest.mark.parametrize("asked", MARCHED)
def test_the_method_that_the_case_asks_for(documents: dict[str, dict[str, Any]], asked: str) -> None:
    """By either method the same machine: forces whose mean is the torque over the base radius."""
    document = documents[asked]
    assert document["method"] == MARCHED[asked]
    assert document["energy_error"] < 1e-3
    expected = 71.77 / (0.5 * 28 * 3.175e-3 * np.cos(np.radians(20.0)))
    assert document["gear_pairs"][0]["mean_force_n"] == pytest.approx(expected, rel=2e-3)
    assert document["gear_pairs"][0]["contact_loss_fraction"] == 0.0
    # Newmark's steps resolve the modes, elements only what the teeth do.
    assert (document["steps"] < 5000) == (MARCHED[asked] == "exact")


def test_methods_agree(documents: dict[str, dict[str, Any]]) -> None:
    """Lines of the mesh force by the exact march and by Newmark's: as far as the latter's tolerance goes."""
    newmark, exact = (documents[method]["gear_pairs"][0] for method in ("newmark", "exact"))
    assert exact["peak_force_n"] == pytest.approx(newmark["peak_force_n"], rel=5e-3)
    lines = [[line["amplitude_n"] for line in pair["force_peaks"][:4]] for pair in (newmark, exact)]
    assert lines[1] == pytest.approx(lines[0], rel=2e-2)


def test_the_exact_march_says_why_it_does_not_apply(gearwhine: Any) -> None:
    exact = ("--set", "transient.method='exact'")
    for command in ("run", "check"):
        outcome = gearwhine(command, "spur-pair", *SHORT, *exact, "--set", "gear_pair.0.friction=0.05", "-q")
        assert outcome.code == 2
        assert "friction between the teeth (gear_pair[0])" in outcome.err
        outcome = gearwhine(command, "spur-pair", *FEW, *exact, *RUN, "-q")
        assert outcome.code == 2
        assert "a speed that varies" in outcome.err
