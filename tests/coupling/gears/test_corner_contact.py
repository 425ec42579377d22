"""Corners beyond the path of contact: the gap against flanks turned until they touch, and the mesh that has them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.coupling.gears import (
    ConstantStiffness,
    Gear,
    GearError,
    GearPairGeometry,
    PotentialEnergyStiffness,
    SquareStiffness,
    TipRelief,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force
from gearwhine.coupling.gears.geometry.path_of_contact import corner_contact_range, flank_contact_points

ALPHA = math.radians(20.0)
PINION = Gear("pinion", 24, 3e-3, ALPHA, 10e-3)
WHEEL = Gear("wheel", 51, 3e-3, ALPHA, 10e-3)
PAIR = GearPairGeometry(PINION, WHEEL)
MODEL = PotentialEnergyStiffness()


def turn_until_touch(pair: GearPairGeometry, position: float) -> float:
    """The driver's turn until its flank passes through the driven tip's corner, by root finding.

    Centres at 0 and a on the real axis; the involute in its own parametric form, each flank where the nominal motion
    puts it.
    """
    driver, driven = pair.driver, pair.driven
    w, a = pair.working_pressure_angle, pair.working_centre_distance
    distance = float(pair.driver_roll_angle(position)) * driver.base_radius  # of the nominal contact
    mating = (driver.base_radius + driven.base_radius) * math.tan(w) - distance
    tangent = driver.base_radius * np.exp(1j * w)  # centres at 0 and a; the line of action leaves downwards
    # The flank's start on the base circle, when the flank passes through tangent + distance (along -i e^{iw}).
    start = w - distance / driver.base_radius

    def flank(roll: float, turned: float) -> complex:
        # Counter-clockwise unwinding mirrored: the string points to -i times the radius.
        angle = start + turned + roll
        return complex(driver.base_radius * np.exp(1j * angle) * (1.0 - 1j * roll))

    nominal = tangent - 1j * distance * np.exp(1j * w)
    assert abs(flank(distance / driver.base_radius, 0.0) - nominal) < 1e-12
    other_start = w - mating / driven.base_radius
    tip_roll = driven.roll_angle(driven.tip_radius)
    tip = a - driven.base_radius * np.exp(1j * (other_start + tip_roll)) * (1.0 - 1j * tip_roll)
    roll_there = math.sqrt((abs(tip) / driver.base_radius) ** 2 - 1.0)

    def miss(turned: float) -> float:
        return float(np.angle(tip / flank(roll_there, turned)))

    return abs(brentq(miss, -0.2, 0.2, xtol=1e-16))


@pytest.mark.parametrize("pair", [PAIR, GearPairGeometry(WHEEL, PINION), GearPairGeometry(PINION, PINION, 72.6e-3)])
@pytest.mark.parametrize("beyond", [0.01, 0.08, 0.2])
def test_gap_is_the_turn_that_brings_a_corner_to_the_flank(pair: GearPairGeometry, beyond: float) -> None:
    gap = float(flank_contact_points(pair, -beyond).gap[0])
    assert gap == pytest.approx(pair.driver.base_radius * turn_until_touch(pair, -beyond), rel=1e-6)
    # Leaving is entering with the gears exchanged.
    other = GearPairGeometry(pair.driven, pair.driver, pair.centre_distance)
    assert float(flank_contact_points(other, other.contact_ratio + beyond).gap[0]) == pytest.approx(gap, rel=1e-9)


def test_gap_begins_with_the_square_of_the_distance() -> None:
    gaps = flank_contact_points(PAIR, np.array([-2e-3, -1e-3, 0.0, PAIR.contact_ratio])).gap
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=1e-2)
    np.testing.assert_array_equal(gaps[2:], 0.0)


def test_reach_ends_where_no_load_closes_the_gap() -> None:
    before, beyond = corner_contact_range(PAIR)
    for position in (-before, PAIR.contact_ratio + beyond):
        assert float(flank_contact_points(PAIR, position).gap[0]) == pytest.approx(0.03 * PINION.module, rel=1e-6)


@pytest.mark.parametrize("relief", [None, TipRelief(12e-6, length=4e-3)])
def test_load_comes_and_goes_without_steps(relief: TipRelief | None) -> None:
    pair = GearPairGeometry(replace(PINION, tip_relief=relief), replace(WHEEL, tip_relief=relief))
    phases = np.linspace(0.0, 1.0, 4001)
    swings = []
    for corners in (False, True):
        contact = tooth_contact(pair, MODEL, corner_contact=corners)
        error = loaded_transmission_error(contact, 6000.0, phases).transmission_error
        swings.append(np.abs(np.diff(error)).max() / np.ptp(error))
    assert swings[1] < 0.03
    if relief is None:
        assert swings[0] > 0.3  # the sources' step


def test_contact_lasts_longer_under_more_load() -> None:
    contact = tooth_contact(PAIR, MODEL, corner_contact=True)
    phases = np.arange(2000) / 2000.0
    lasting = []
    for force in (1.0, 2000.0, 8000.0):
        mesh = loaded_transmission_error(contact, force, phases)
        lasting.append(float((mesh.pair_forces > 0.0).sum()) / phases.size)
    assert lasting[0] == pytest.approx(PAIR.contact_ratio, abs=0.01)
    assert lasting[0] + 0.05 < lasting[1] < lasting[2] - 0.05


def test_nothing_changes_where_the_corners_stand_clear() -> None:
    # Away from both ends of the path by more than corners reach, the law is the same.
    plain, corners = (tooth_contact(PAIR, MODEL, corner_contact=on).kernel_arguments for on in (False, True))
    for phase in (0.45, 0.9):
        here, there = (tooth_force(phase, 8e-6, 0.0, *law) for law in (plain, corners))
        assert here[5] > 0
        np.testing.assert_allclose(there, here, rtol=1e-9)


def test_models_of_whole_meshes_and_printed_ratios_have_no_corners() -> None:
    with pytest.raises(GearError, match="whole mesh"):
        tooth_contact(PAIR, ConstantStiffness(1e8), corner_contact=True)
    with pytest.raises(GearError, match="own contact ratio"):
        tooth_contact(PAIR, SquareStiffness(1e8, contact_ratio=1.6), corner_contact=True)
