"""Planets alone on their pins, and lives of their bearings: at the speed relative to the carrier, by hand."""

from dataclasses import replace

import numpy as np
import pytest
from planetary_machines import set_parts, shaft

from gearwhine.coupling import Machine, MountedBearing
from gearwhine.coupling.analyses.shafts_alone import planet_warnings, shaft_settings, solve_shafts
from gearwhine.coupling.load_analysis.solved_load import solve_load
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.rotors.rolling_bearings import BallRow, RollingBearing

SPEED = 100.0
ON_PIN = -SPEED * 24 / 30 * 84 / 108
"""Speed of the planets of 30 teeth on the carrier, between a sun of 24 that drives and a ring of 84 that is held."""


@pytest.fixture(scope="module")
def machine() -> Machine:
    """A planet of the set on balls."""
    parts = set_parts()
    row = BallRow(12, 6e-3, 34e-3, clearance=-2e-6)
    parts["bearings"] = [
        MountedBearing.from_elements(one.bearing.name, one.bearing.at, one.rotor, None, RollingBearing((row,)))
        if one.rotor == "p 2"
        else one
        for one in parts["bearings"]
    ]
    return Machine(**parts)


def test_a_planet_alone_turns_at_its_speed_on_the_pin(machine: Machine) -> None:
    settings = shaft_settings(machine, "p 1", (), speeds=(50.0, 200.0))
    assert settings.operation == pytest.approx(ON_PIN)
    assert list(settings.whirl_speeds) == pytest.approx([0.5 * ON_PIN, 2.0 * ON_PIN])
    assert shaft_settings(machine, "c", ()).operation == pytest.approx(SPEED * 24 / 108)


def test_bearings_of_a_planet_live_by_its_speed_on_the_pin(machine: Machine) -> None:
    solved = solve_load(machine)
    lives = {bearing.load.name: bearing.rated for bearing in solved.bearings if bearing.rated is not None}
    assert sorted(lives) == ["p 0.01 2", "p 0.05 2"]
    assert [life.speed for life in lives.values()] == pytest.approx([ON_PIN] * 2)


def test_bearings_of_a_planet_live_by_their_loads_over_a_turn(machine: Machine) -> None:
    """Past a force on the carrier: at each angle sun and ring push both bearings with 2 F cos 20° of their meshes."""
    solved = solve_load(replace(machine, forces=[ShaftForce("c", 0.03, (0.0, -30000.0, 0.0))]))
    mesh = [(one.pair.driver.name, one.pair.driven.name) for one in solved.point.pairs].index(("s", "p 2"))
    mesh_force = np.array([point.pairs[mesh].force for point in solved.point.over_turn])
    assert np.ptp(mesh_force) > 0.2 * mesh_force.mean()
    rated = {bearing.load.name: bearing.rated for bearing in solved.bearings if bearing.rated is not None}
    names = [bearing.load.name for bearing in solved.bearings]
    forces = np.array([[point.bearings[names.index(name)].force for name in rated] for point in solved.point.over_turn])
    across = np.hypot(*forces.sum(axis=1)[:, :2].T)
    assert across == pytest.approx(2.0 * mesh_force * np.cos(np.radians(20.0)), rel=1e-3)
    radial = np.hypot(forces[..., 0], forces[..., 1])
    expected = np.mean(radial**3.0, axis=0) ** (1.0 / 3.0)
    assert np.all(np.abs(expected / radial[0] - 1.0) > 0.02)
    assert [life.equivalent_load for life in rated.values()] == pytest.approx(expected.tolist(), rel=1e-6)


def test_a_shaft_alone_in_another_one_lives_by_its_speed_against_that() -> None:
    """The sun, on balls in the carrier, which follows at 24/108 of its speed; as at the operating point."""
    parts = set_parts()
    longer = {"s": shaft("s", length=0.15), "c": shaft("c", start=0.1, bore=0.03)}
    parts["shafts"] = [longer.get(one.name, one) for one in parts["shafts"]]
    elements = RollingBearing((BallRow(16, 3e-3, 25e-3, clearance=-2e-6),))
    inside = MountedBearing.from_elements("inside", 0.13, "s", "c", elements)
    parts["bearings"] = [inside if one.bearing.name == "s 0.05" else one for one in parts["bearings"]]
    sun = next(one for one in solve_shafts(Machine(**parts), mode_count=2) if one.rotor.name == "s")
    assert sun.lives["inside"].speed == pytest.approx(SPEED * (1.0 - 24.0 / 108.0))


def test_what_a_planet_alone_leaves_out_is_told() -> None:
    (one,) = planet_warnings({"p 1": "c", "p 2": "c"})
    assert 'p 1, p 2: each alone on a pin that stands still, as if carrier "c" did' in one["message"]
    assert planet_warnings({}) == []
