"""Check of designs: levels over the whole speed range, and the warning of resonances between the given speeds."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from sounding_gearbox import small_gearbox

from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.linear.lines_over_speed import sensor_rms
from gearwhine.optimisation.verification import Motion, Verification, motion_of, range_of
from gearwhine.results.optimisation import _warnings
from gearwhine.solutions import Failure
from gearwhine.variation.quantities import level_of


def _motion(levels: list[float]) -> Motion:
    speeds = np.linspace(100.0, 300.0, len(levels))
    return Motion({}, {}, {}, {}, speeds, {"top": np.array(levels)})


def test_a_range_has_the_given_speeds_and_none_that_are_further_apart_than_a_per_cent() -> None:
    found = range_of([-300.0, -100.0, -213.0])
    assert found[0] == 100.0
    assert found[-1] == 300.0
    assert 213.0 in found
    assert np.all(np.diff(found) > 0.0)
    assert np.max(found[1:] / found[:-1]) < 1.0101
    assert len(range_of([1.0, 1e6])) <= 402


def test_levels_over_the_range_are_those_of_the_machine_at_each_speed() -> None:
    """Its highest one, and where that is; the transient is of the speeds of the check alone."""
    machine = small_gearbox().machine
    speeds = [0.8 * machine.speed, 0.82 * machine.speed]
    plan = TransientPlan(revolutions=3.0, discard=1.0)
    found = motion_of(machine, plan, speeds[:1], speeds, needs_load=False)
    assert set(found.motion) == set(found.over_speed) == {"top", "right wall"}
    point, limit = machine.operating_point(), machine.housing_component.complete_below
    for place in (0, 1, len(found.speeds) - 1):
        there = replace(machine, speed=float(np.sign(machine.speed) * found.speeds[place]))
        levels = level_of(sensor_rms(load_machine(there, point).coupled, limit))
        for sensor, level in zip(("top", "right wall"), levels.tolist(), strict=True):
            assert found.over_speed[sensor][place] == pytest.approx(level, abs=1e-6)
    for sensor, (level, speed) in found.highest.items():
        assert level == max(found.over_speed[sensor])
        assert speed == found.speeds[np.argmax(found.over_speed[sensor])]
    alone = motion_of(machine, plan, speeds[:1], speeds[:1], needs_load=False)
    assert alone.over_speed == {}


def test_louder_between_the_speeds_of_a_study_is_warned_of() -> None:
    """At any of start and designs by more than 1 dB; not where one of them has no levels."""
    start, design = _motion([120.0, 131.5, 121.0]), _motion([110.0, 110.5, 111.0])
    checked = Verification((100.0,), start, (design,), {"top": (121.0, 111.0)})
    assert checked.passed_by == {"top": ((121.0, 131.5), (111.0, 111.0))}
    found = SimpleNamespace(designs=(), best=None, front=(), verification=checked, failures={})
    (told,) = [one for one in _warnings(found) if one["name"] == "resonances between speeds"]  # type: ignore[arg-type]
    assert "top" in told["message"]
    assert "131.5 dB in place of 121.0 dB" in told["message"]
    assert replace(checked, given={"top": (131.0, 111.0)}).passed_by == {}
    assert replace(checked, designs=(Failure("CouplingError", "no"),)).passed_by == {}
    assert replace(checked, given={"other": (1.0, 1.0)}).passed_by == {}
