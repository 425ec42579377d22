"""Mechanisms of lines in the documents of all motions: a linear machine has the sum of their parts in every line."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sounding_gearbox import sounding_gearbox

from gearwhine.results import sensor_line_estimates

LINEAR = {
    "gear_pair.0.stiffness": {"model": "constant", "value": "3e8 N/m"},
    "gear_pair.0.misalignment": 0.0,
    "gear_pair.0.damping_ratio": 0.5,
}
UNBALANCE = {"rotor.1.unbalance": [{"at": "100 mm", "moment": "7e-5 kg*m", "phase": "40 deg"}]}
RUNOUT = {"gear.0.errors": {"eccentricity": "6 um", "phase": "25 deg"}}
RIPPLE = {"operation.ripple": [{"amplitude": "0.5 N*m", "order": 3, "phase": "10 deg"}]}
BASE = {"operation.base": {"harmonic": [{"frequency": "1100 Hz", "y": "0.2 m/s^2", "phase": "70 deg"}]}}
NO_UNBALANCE = {"rotor.0.unbalance": []}
TURN = 5500.0 / 60.0


@cache
def lines_of(*names: str, sense: int = 1) -> dict[tuple[str, float], dict[str, Any]]:
    """Lines of the steady motion under some of the excitations, by sensor and order."""
    every = {"unbalance": UNBALANCE, "pitch_errors": RUNOUT, "torque_ripple": RIPPLE, "base_motion": BASE}
    changes = LINEAR | NO_UNBALANCE | {"operation.speed": f"{sense * 5500} rpm"}
    for name in names:
        changes |= every[name]
    document = sounding_gearbox(changes).steady().document
    (motion,) = document["motions"]
    return {
        (sensor["name"], round(line["frequency_hz"] / TURN, 6)): line
        for sensor in motion["sensors"]
        for line in sensor["lines"]
    }


ALL = ("unbalance", "pitch_errors", "torque_ripple", "base_motion")
ORDERS = {"unbalance": 1.0, "pitch_errors": 1.0, "torque_ripple": 3.0, "base_motion": 12.0}


@pytest.mark.parametrize("sense", [1, -1])
def test_every_line_of_a_linear_machine_is_the_sum_of_its_parts(sense: int) -> None:
    lines = lines_of(*ALL, sense=sense)
    told = {key: line for key, line in lines.items() if key[1] in ORDERS.values()}
    assert len(told) == 6
    for line in told.values():
        assert line["parts_together_m_per_s2"] == pytest.approx(line["amplitude_m_per_s2"], rel=1e-5)
        assert sum(line["part_shares"].values()) == pytest.approx(1.0)
    assert set(lines[("top", 1.0)]["parts"]) == {"pitch_errors", "unbalance"}
    assert set(lines[("top", 3.0)]["parts"]) == {"torque_ripple"}
    assert set(lines[("right wall", 12.0)]["parts"]) == {"base_motion"}


@pytest.mark.parametrize("name", ALL)
def test_a_part_is_the_line_of_the_machine_with_that_mechanism_alone(name: str) -> None:
    order = ORDERS[name]
    for sensor in ("top", "right wall"):
        alone = lines_of(name)[(sensor, order)]["amplitude_m_per_s2"]
        assert lines_of(*ALL)[(sensor, order)]["parts"][name] == pytest.approx(alone, rel=1e-5)


def test_a_line_that_nothing_excites_has_no_parts() -> None:
    for (_, order), line in lines_of(*ALL).items():
        if order not in ORDERS.values():
            assert "parts" not in line


def test_errors_of_the_basis_stand_in_their_bands() -> None:
    """An error that is the frequency in hertz: its median is a band's middle, its largest just below the band's end."""
    error: Any = SimpleNamespace(at=lambda w: {"top": w / (2.0 * np.pi)})
    for band in sensor_line_estimates._bands(error, 800.0):
        (top,) = band["sensors"]
        assert top["median"] == pytest.approx(0.5 * (band["from_hz"] + band["to_hz"]))
        assert 0.5 * (top["median"] + band["to_hz"]) < top["largest"] < band["to_hz"]
