"""Deviations of flanks that a tooth can hardly hold: each is told by its own name and value."""

from typing import Any

import pytest

from gearwhine.coupling.gears import Gear, GearError
from gearwhine.numerics.findings import Finding

MODULE = 3e-3


def gear(**more: Any) -> Gear:
    return Gear("pinion", 23, MODULE, 0.349, 25e-3, **more)


def deviations(made: Gear) -> list[Finding]:
    return [finding for finding in made.findings if finding.attribute in ("eccentricity", "pitch_deviations")]


def test_a_deviation_beyond_a_twentieth_of_the_module_is_warned_of_by_its_name_and_value() -> None:
    pitches = (0.0, -0.21e-3, *(21 * [1e-5]))
    found = deviations(gear(eccentricity=0.18e-3, pitch_deviations=pitches))
    assert [(one.part, one.attribute, one.value, one.severity) for one in found] == [
        (("gear", "pinion"), "eccentricity", 0.18e-3, "warning"),
        (("gear", "pinion"), "pitch_deviations", -0.21e-3, "warning"),
    ]
    assert all(one.expected.startswith("at most 0.15 mm, a twentieth of the module") for one in found)
    assert deviations(gear(eccentricity=0.14e-3)) == []


def test_a_deviation_beyond_a_quarter_of_the_module_is_refused() -> None:
    with pytest.raises(GearError, match=r"eccentricity is 0\.0008; expected at most a quarter of the module, 0\.75 mm"):
        gear(eccentricity=0.8e-3)
