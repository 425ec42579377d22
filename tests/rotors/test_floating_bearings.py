"""Floating bearings, whose outer ring slides along z: the least energy over its place, without axial force."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    RollingElements,
    SphericalRollerRow,
    TaperedRollerRow,
    linearised_bearing,
    paired,
    rolling_equilibrium,
    rolling_state,
)
from gearwhine.rotors.rolling_bearings.life import equivalent_load, reference_revolutions

BALLS = BallRow(9, 11.1e-3, 53.5e-3, clearance=8e-6)
SPHERICAL = SphericalRollerRow(18, 11e-3, 10e-3, 66e-3, angle=math.radians(11.0), clearance=8e-6)
LOCATING = {
    "deep groove": (RollingBearing([BALLS]), 0.0),
    "thrown deep groove": (RollingBearing([BALLS]), 900.0),
    "four-point": (RollingBearing([FourPointRow(13, 9.5e-3, 50e-3, math.radians(35.0), clearance=6e-6)]), 0.0),
    "double-row": (paired(BallRow(13, 8.1e-3, 38.5e-3, 0.4, clearance=6e-6), "back to back", 12e-3), 0.0),
    "preloaded double-row": (paired(BallRow(13, 8.1e-3, 38.5e-3, 0.4), "face to face", 12e-3, preload=200.0), 0.0),
    "spherical": (RollingBearing([SPHERICAL.facing(1), SPHERICAL.facing(-1)]), 0.0),
}
EACH = pytest.mark.parametrize("kind", LOCATING)
OTHERS = [0, 1, 3, 4]
# The tilt moves the free place of the ring away from the middle.
TILTED = np.array([12e-6, -16e-6, 0.0, 3e-4, -2e-4])


def both(kind: str) -> tuple[RollingElements, RollingElements]:
    """The elements between held rings, and with the outer one floating."""
    bearing, speed = LOCATING[kind]
    return RollingElements(bearing, speed, 0.2), RollingElements(replace(bearing, floating=True), speed, 0.2)


def moved(q: FloatArray, z: float) -> FloatArray:
    return np.array([q[0], q[1], z, q[3], q[4]])


@EACH
def test_energy_is_the_least_over_the_place_of_the_ring(kind: str) -> None:
    held, floating = both(kind)
    found = minimize_scalar(
        lambda z: 1e3 * held.at(moved(TILTED, 1e-6 * z)).value, bounds=(-300.0, 300.0), method="bounded"
    )
    here = floating.at(TILTED)
    assert here.value == pytest.approx(1e-3 * found.fun, rel=1e-9)
    place = float(floating.seated(TILTED)[2])
    assert place == pytest.approx(1e-6 * found.x, abs=2e-9)
    # Only spherical rollers turn in their outer ring, and stay in the middle.
    assert (abs(place) > 1e-7) == (kind != "spherical")


@EACH
def test_the_law_is_that_of_the_ring_held_where_it_has_no_axial_force(kind: str) -> None:
    held, floating = both(kind)
    here, ring = floating.at(TILTED), held.at(floating.seated(TILTED))
    assert abs(ring.gradient[2]) < 1e-9 * ring.force
    np.testing.assert_allclose(here.gradient[OTHERS], ring.gradient[OTHERS], rtol=1e-9, atol=1e-9)
    # A free coordinate takes no part in the compliance of the others.
    size = np.array([1.0, 1.0, 1.0, held.bearing.reach, held.bearing.reach])
    if kind != "spherical":  # which has no stiffness against rotation
        compliance = np.linalg.inv(ring.hessian / np.outer(size, size))[np.ix_(OTHERS, OTHERS)]
        own = np.linalg.inv((here.hessian / np.outer(size, size))[np.ix_(OTHERS, OTHERS)])
        np.testing.assert_allclose(own, compliance, rtol=1e-6, atol=1e-9 * np.abs(compliance).max())
    assert here.gradient[2] == 0.0
    assert not here.hessian[2].any()
    assert not here.hessian[:, 2].any()


@EACH
def test_the_shaft_moves_along_its_axis_without_force(kind: str) -> None:
    _, floating = both(kind)
    here, there = floating.at(TILTED), floating.at(moved(TILTED, 2e-3))
    assert there.value == here.value
    np.testing.assert_array_equal(there.gradient, here.gradient)
    np.testing.assert_array_equal(there.hessian, here.hessian)


def test_under_a_load_it_is_the_locating_bearing_without_thrust() -> None:
    """The same equilibrium as where the inner ring is free along z, tilted shaft and lives included."""
    load, tilt = np.array([1500.0, -800.0, 0.0, 0.0, 0.0]), {"rx": 4e-4, "ry": -1e-4}
    bearing = LOCATING["deep groove"][0]
    free = rolling_equilibrium(bearing, load, held=tilt)
    floating = rolling_equilibrium(replace(bearing, floating=True), load, held=tilt)
    np.testing.assert_allclose(floating.displacement, free.displacement, rtol=1e-8, atol=1e-13)
    np.testing.assert_allclose(floating.rows[0].inner_load, free.rows[0].inner_load, rtol=1e-7, atol=1e-6)
    assert floating.row_thrusts == pytest.approx((0.0,), abs=1e-9)
    assert floating.reaction[2] == 0.0
    assert equivalent_load(floating) == pytest.approx(1700.0)
    assert reference_revolutions(floating) == pytest.approx(reference_revolutions(free), rel=1e-7)
    # The same shaft held along z somewhere else is pressed axially.
    pushed = rolling_equilibrium(bearing, load, held={**tilt, "z": 80e-6})
    assert abs(pushed.load[2]) > 100.0


def test_without_tilt_its_radial_stiffness_is_that_of_the_ring_in_the_middle() -> None:
    load = [1500.0, -800.0, 0.0, 0.0, 0.0]
    bearing = LOCATING["deep groove"][0]
    held = rolling_equilibrium(bearing, load, held={"z": 0.0, "rx": 0.0, "ry": 0.0})
    floating = rolling_equilibrium(replace(bearing, floating=True), load, held={"rx": 0.0, "ry": 0.0})
    linear = linearised_bearing(floating, "bearing", 0.1).spatial_stiffness
    np.testing.assert_allclose(linear[:2, :2], held.stiffness[:2, :2], rtol=1e-9)
    assert not linear[2].any()
    # Against tilt it is softer: loaded balls on one side give way by the sliding of the ring.
    stiffest = np.linalg.eigvalsh(held.stiffness[3:, 3:])[-1]
    assert np.linalg.eigvalsh(linear[3:, 3:])[-1] < 0.5 * stiffest


def test_in_its_clearance_it_has_neither_force_nor_stiffness() -> None:
    state = rolling_state(RollingBearing([BALLS], floating=True), np.array([1e-6, 0.0, 0.5e-3, 0.0, 0.0]))
    assert not state.stiffness.any()
    assert not state.load.any()
    assert state.displacement[2] == 0.0
    assert set(state.loose) == {"x", "y", "z", "rx", "ry"}


def test_cylindrical_rollers_float_by_themselves() -> None:
    rollers = RollingBearing([RollerRow(14, 11e-3, 11e-3, 60e-3, clearance=5e-6)])
    q = np.array([20e-6, -5e-6, 3e-3, 1e-4, -2e-4])
    held, floating = rolling_state(rollers, q), rolling_state(replace(rollers, floating=True), q)
    np.testing.assert_array_equal(floating.load, held.load)
    np.testing.assert_array_equal(floating.stiffness, held.stiffness)


def test_it_takes_no_thrust() -> None:
    bearing = RollingBearing([BALLS], name="bearing 'a'", floating=True)
    assert bearing.thrust_senses == frozenset()
    assert not bearing.has_axial_stiffness
    with pytest.raises(RotorError, match=r"axial load on bearing 'a'.*10\.0.*none, or z held: its outer ring floats"):
        rolling_equilibrium(bearing, [500.0, 0.0, 10.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("bearing", "told"),
    [
        (
            RollingBearing([TaperedRollerRow(17, 9e-3, 14e-3, 61e-3, angle=0.25)]),
            "thrust one way only: they slide open",
        ),
        (RollingBearing([BallRow(13, 8.1e-3, 38.5e-3, 0.4)]), "thrust one way only: they slide open"),
        (paired(BallRow(13, 8.1e-3, 38.5e-3, 0.4), "tandem", 15e-3), "thrust one way only: they slide open"),
        (RollingBearing([BALLS], axial_preload=100.0), "axial preload of .*none: the outer ring"),
        (RollingBearing([replace(BALLS, axial_offset=1e-5)]), "axial offset of .*none: the outer ring"),
    ],
)
def test_rows_that_slide_open_or_are_preloaded_are_refused(bearing: RollingBearing, told: str) -> None:
    with pytest.raises(RotorError, match=told):
        replace(bearing, floating=True)
