"""An internal pair between two shafts, without any planet: speeds, forces on the bearings, modes."""

import math
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftGear
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import ConstantStiffness, Gear
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial

STEEL = ShaftMaterial.from_poisson_ratio(2.06e11, 0.3, 7850.0)
ALPHA, BETA = math.radians(20.0), math.radians(12.0)
DISTANCE = 20.0 * 2e-3 / math.cos(BETA)
TORQUE = 40.0


def machine(*, ring_drives: bool = False, speed: float = 200.0, hand: float = 1.0, **changes: Any) -> Machine:
    """Pinion at the end of one shaft in the ring at the beginning of the other; axes along x."""
    held, apart = np.diag([2e8, 2e8, 1e8, 0.0, 0.0]), DISTANCE if hand else 0.04
    shafts = [
        Shaft(Rotor("inner", [Segment(0.12, 0.025, 0.0, STEEL)]), axis=(apart, 0.0), start=0.0),
        Shaft(Rotor("outer", [Segment(0.15, 0.03, 0.0, STEEL)]), axis=(0.0, 0.0), start=0.11),
    ]
    places = {"inner": (0.02, 0.08), "outer": (0.05, 0.13)}
    bearings = [
        MountedBearing(Bearing(f"{name} {at}", at, held, np.zeros((5, 5))), name, None)
        for name in places
        for at in places[name]
    ]
    teeth = {"module": 2e-3, "pressure_angle": ALPHA, "face_width": 16e-3, "helix_angle": hand * BETA}
    gears = [
        ShaftGear(Gear("pinion", 20, **teeth), "inner", 0.11),
        ShaftGear(Gear("ring", -60, addendum=0.7, rim_thickness=8e-3, **teeth), "outer", 0.0),
    ]
    pair = ("ring", "pinion") if ring_drives else ("pinion", "ring")
    parts: dict[str, Any] = {
        "shafts": shafts,
        "bearings": bearings,
        "gears": gears,
        "gear_pairs": [GearPair(*pair, ConstantStiffness(3e8), misalignment=0.0)],
        "speed": speed,
        "torque": TORQUE,
    }
    return Machine(**parts | changes)


@pytest.mark.parametrize("hand", [1.0, -1.0])
@pytest.mark.parametrize("speed", [200.0, -200.0])
@pytest.mark.parametrize("ring_drives", [False, True])
def test_bearings_carry_the_forces_of_the_textbook(ring_drives: bool, speed: float, hand: float) -> None:
    one = machine(ring_drives=ring_drives, speed=speed, hand=hand)
    ratio = 1.0 / 3.0 if not ring_drives else 3.0
    driver, driven = ("outer", "inner") if ring_drives else ("inner", "outer")
    assert one.speeds == pytest.approx({driver: speed, driven: ratio * speed})
    point = one.operating_point()
    turning = math.copysign(1.0, speed)
    # Forces on the pinion, whose pitch point is at +x of its axis: tangential against the torque that it gives or with
    # the one that it takes, radially inward, axially by the helix.
    tangential = TORQUE / (abs(60.0 if ring_drives else 20.0) * 1e-3 / math.cos(BETA))
    transverse = math.atan(math.tan(ALPHA) / math.cos(BETA))
    along_y = turning * tangential * (1.0 if ring_drives else -1.0)
    pinion = np.array([-tangential * math.tan(transverse), along_y, -hand * along_y * math.tan(BETA)])
    for shaft, force in (("inner", pinion), ("outer", -pinion)):
        carried = sum(load.force[:3] for load in point.bearings if load.mounted.rotor == shaft)
        np.testing.assert_allclose(carried, force, rtol=1e-3, atol=0.5)


def test_torsion_of_rigid_gears_is_that_of_two_inertias() -> None:
    # Both gears on rigid shafts: w^2 = k (R_1^2 / J_1 + R_2^2 / J_2).
    stiff = ShaftMaterial.from_poisson_ratio(2.06e15, 0.3, 7.85)
    base = machine(hand=0.0)
    shafts = [
        Shaft(Rotor(s.rotor.name, [Segment(s.rotor.length, 0.03, 0.0, stiff)]), axis=axis, start=s.start)
        for s, axis in zip(base.shafts, ((0.04, 0.0), (0.0, 0.0)), strict=True)
    ]
    held = np.diag([1e13, 1e13, 1e13, 0.0, 0.0])
    bearings = [
        MountedBearing(Bearing(b.bearing.name, b.bearing.at, held, np.zeros((5, 5))), b.rotor, None)
        for b in base.bearings
    ]
    stiffness = 3e7
    pair = GearPair("pinion", "ring", ConstantStiffness(stiffness), misalignment=0.0, damping_ratio=0.0)
    one = machine(hand=0.0, shafts=shafts, bearings=bearings, gear_pairs=[pair], torque=0.0)
    inertias = [gear.gear.polar_inertia for gear in one.gears]
    radii = [gear.gear.base_radius for gear in one.gears]
    inertias[0] -= 0.5 * math.pi * one.gears[0].gear.density * 16e-3 * 0.015**4  # the shaft's core has no mass here
    expected = math.sqrt(stiffness * sum(r**2 / j for r, j in zip(radii, inertias, strict=True))) / (2.0 * math.pi)
    frequencies = one.modes().frequencies_hz
    assert np.abs(np.asarray(frequencies) / expected - 1.0).min() < 2e-3


def test_shaft_in_the_teeth_of_its_ring_is_refused_and_a_bell_is_not() -> None:
    base = machine()
    assert not any("hang off" in str(finding) for finding in base.findings)
    thick = Shaft(Rotor("outer", [Segment(0.15, 0.13, 0.0, STEEL)]), axis=(0.0, 0.0), start=0.11)
    with pytest.raises(
        CouplingError, match=r"expected a ring around its shaft; that has a diameter of 130 mm there, the"
    ):
        machine(shafts=[base.shafts[0], thick])
    # As a sleeve around the ring it is fine.
    sleeve = Shaft(Rotor("outer", [Segment(0.15, 0.16, 0.147, STEEL)]), axis=(0.0, 0.0), start=0.11)
    assert machine(shafts=[base.shafts[0], sleeve]).speeds["outer"] == pytest.approx(200.0 / 3.0)


def test_axes_that_do_not_fit_are_refused_with_lengths() -> None:
    base = machine()
    far = [base.shafts[0], Shaft(base.shafts[1].rotor, axis=(-1e-3, 0.0), start=0.11)]
    with pytest.raises((CouplingError, ValueError), match=r"teeth jam at a centre distance of 41\.8936 mm; they mesh"):
        machine(shafts=far)
