"""Rows whose outer ring turns, as in a planet on its pin: the same geometry with its inner ring moved the other way."""

import math
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.case.bearings import RollingGeometry
from gearwhine.coupling import RollingLaw
from gearwhine.coupling.connector_forces.bearing_kernels import bearing_force
from gearwhine.coupling.connector_forces.kernel_arrays import bearing_arrays
from gearwhine.coupling.description.axial_location import AxialLocation, axial_support
from gearwhine.coupling.machine.connectors import NonlinearConnector
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    Row,
    SphericalRollerRow,
    TaperedRollerRow,
    paired,
    rolling_state,
    standing_rows,
)

BALLS = BallRow(13, 10e-3, 60e-3, 0.5, clearance=4e-6, axial_offset=6e-6, position=7e-3)
ROLLERS = (17, 8e-3, 12e-3, 60e-3)
ROWS: list[Row] = [
    BALLS,
    FourPointRow(13, 10e-3, 60e-3, 0.6, clearance=4e-6),
    RollerRow(*ROLLERS, -4e-6, flanges="one", flange_stiffness=4e8, axial_clearance=36e-6),
    TaperedRollerRow(*ROLLERS, 2e-6, angle=0.25, position=-5e-3, axial_offset=6e-6),
    SphericalRollerRow(*ROLLERS, -4e-6, angle=0.2),
]
MOVED = np.array([9e-6, -5e-6, 20e-6, 1.5e-4, -2e-4])


@pytest.mark.parametrize("speed", [0.0, 400.0])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("row", ROWS, ids=lambda row: type(row).__name__)
def test_the_inner_ring_at_rest_moves_the_other_way_against_the_outer(row: Row, direction: int, speed: float) -> None:
    """Forces change their sign with the motion, stiffness does not; the cage's speed by γ of the ring that turns."""
    pin = RollingBearing([replace(row.facing(direction), outer_turns=True)])
    shaft = RollingBearing([row.facing(-direction)])
    turning = rolling_state(pin, MOVED, speed=speed, cage_angle=0.3)
    as_fast = speed * (1.0 + row.gamma) / (1.0 - row.gamma)
    still = rolling_state(shaft, -MOVED, speed=as_fast, cage_angle=0.3)
    np.testing.assert_allclose(turning.load, -still.load, rtol=1e-9, atol=1e-9 * np.abs(still.load).max())
    size = np.abs(still.stiffness).max()
    np.testing.assert_allclose(turning.stiffness, still.stiffness, rtol=1e-8, atol=1e-11 * size)
    if speed or isinstance(row, FourPointRow | RollerRow):
        return
    # The time-stepping kernel, with the same elements at the same places.
    made = [
        NonlinearConnector("pin", np.eye(5), np.arange(5), RollingLaw(state, 0.3, ()), state.stiffness, 0.0)
        for state in (turning, still)
    ]
    forces = np.zeros((2, 5))
    for number, moved in enumerate((MOVED, -MOVED)):
        bearing_force(bearing_arrays(made), number, 0.0, moved.copy(), forces[number], np.zeros((5, 5)))
    np.testing.assert_allclose(forces[0], -forces[1], rtol=1e-9, atol=1e-9 * np.abs(forces).max())


@pytest.mark.parametrize("on_pin", [False, True])
@pytest.mark.parametrize(("arrangement", "apart"), [("back to back", 1.0), ("face to face", -1.0)])
def test_tilting_stiffness_is_that_of_the_span_of_the_pressure_centres(
    arrangement: Literal["back to back", "face to face"], apart: float, on_pin: bool
) -> None:
    """With K of the rows at their pressure centres at ±b/2, k_θθ = (b/2)² k_xx; rollers add their own length."""
    given: dict[str, Any] = {
        "element": "tapered-roller",
        "count": 20,
        "element_diameter": 6e-3,
        "element_length": 8e-3,
        "pitch_diameter": 50e-3,
        "contact_angle": math.radians(16.0),
        "profile": "straight",
        "arrangement": arrangement,
        "spacing": 60e-3,
        "preload": 2000.0,
    }
    bearing = RollingGeometry.model_construct(**given).build("pin", on_pin=on_pin)
    stiffness = rolling_state(bearing, np.zeros(5)).stiffness
    row, angle = bearing.rows[0], math.radians(16.0)
    assert isinstance(row, TaperedRollerRow)
    # The outer normal at the roller's middle meets the axis there.
    half = 30e-3 + apart * (25e-3 * math.tan(angle) + 3e-3 * math.sin(row.roller_angle) / math.cos(angle))
    length = row.slice_places / math.cos(angle)
    assert stiffness[4, 4] / stiffness[0, 0] == pytest.approx(half**2 + (length**2).mean(), rel=1e-9)
    mounted = gw.MountedBearing.from_elements("pin", 0.0, "planet", None, bearing)
    assert axial_support(mounted).arrangement == ("O" if apart > 0.0 else "X")
    # The same rows as two bearings, by the thrust that each carries.
    singles = [
        axial_support(gw.MountedBearing.from_elements("pin", 1.0 + one.position, "planet", None, RollingBearing([one])))
        for one in bearing.rows
    ]
    assert AxialLocation("planet", singles).arrangement == ("O" if apart > 0.0 else "X")


def test_rows_of_whole_bearings_stand_on_a_pin_as_on_a_shaft() -> None:
    """Self-aligning balls tilt freely about the bearing's centre; rows in tandem carry the planet's thrust one way."""
    row = replace(BALLS, axial_offset=0.0, position=0.0, clearance=-8e-6, outer_turns=True)
    sphere = 0.5 + 30e-3 / (10e-3 * math.cos(0.5))
    aligning = RollingBearing(standing_rows("self-aligning-ball", replace(row, outer_groove=sphere), 20e-3))
    stiffness = rolling_state(aligning, np.zeros(5)).even_stiffness
    assert abs(stiffness[4, 4]) < 1e-3 * stiffness[0, 0]
    assert paired(row, "tandem", 20e-3).thrust_senses == {1}


def test_rows_that_turn_with_different_rings_are_refused() -> None:
    rows = [replace(BALLS, position=0.0), replace(BALLS, position=20e-3, outer_turns=True)]
    with pytest.raises(gw.RotorError, match=r"rings of rolling bearing that turn is .*; expected one"):
        RollingBearing(rows)


@pytest.mark.parametrize(("outer_turns", "quarter"), [(False, 1.0), (True, -1.0)])
def test_the_most_loaded_element_stands_where_the_rings_approach(outer_turns: bool, quarter: float) -> None:
    """A shaft pressed along y presses the ball there; a planet's bore the one on the other side of its pin."""
    bearing = RollingBearing([BallRow(12, 10e-3, 60e-3, outer_turns=outer_turns)])
    (loads,) = rolling_state(bearing, [0.0, 9e-6, 0.0, 0.0, 0.0]).rows
    most = loads.azimuths[int(loads.outer_load.argmax())]
    assert np.exp(1j * most) == pytest.approx(1j * quarter, abs=1e-9)
