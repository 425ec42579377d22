"""Elastic pins of planets: closed forms of beams clamped in one wall or two, wind-up of the walls, face load."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from plane_planetary_set import BEARING_STIFFNESS, equal_angles, plane_set
from planetary_machines import STEEL, set_parts, shaft

from gearwhine.coupling import CouplingError, Machine, PinBeam, PinSprings
from gearwhine.rotors import Rotor, Segment, ShaftMaterial

FloatArray = npt.NDArray[np.float64]

DIAMETER, SPAN = 16e-3, 60e-3
AREA, INERTIA = math.pi / 4.0 * DIAMETER**2, math.pi / 64.0 * DIAMETER**4
SHEAR = 0.886 * STEEL.shear_modulus * AREA
"""κ G A, Cowper's κ = 6 (1 + ν) / (7 + 6 ν) at ν = 0.299."""


def compliance(pin: Any, bearings: tuple[float, ...]) -> FloatArray:
    """Motions of the seats under unit loads, the walls at rest, (5 s, 5 s)."""
    mounted = pin.mounted(bearings)
    rows = np.vstack([mounted.motions(z) for z in bearings])
    return np.asarray(rows @ np.linalg.inv(mounted.stiffness[: mounted.size, : mounted.size]) @ rows.T)


def test_a_beam_clamped_at_both_ends_bends_as_by_the_closed_form() -> None:
    pin = PinBeam((0.1, 0.1 + SPAN), DIAMETER, STEEL)
    found = compliance(pin, (0.1 + 0.5 * SPAN,))
    bending, shear = SPAN**3 / (192.0 * STEEL.youngs_modulus * INERTIA), SPAN / (4.0 * SHEAR)
    assert [found[0, 0], found[1, 1]] == pytest.approx([bending + shear] * 2, rel=2e-3)
    assert found[0, 0] - shear == pytest.approx(bending, rel=5e-3)
    assert found[2, 2] == pytest.approx(SPAN / (4.0 * STEEL.youngs_modulus * AREA), rel=1e-6)
    assert abs(found[0, 4]) < 1e-9 * found[4, 4]


def test_a_beam_clamped_at_one_end() -> None:
    """δ = F l³ / 3 E I + F l / κ G A, and the slope F l² / 2 E I, about +y for a force along +x beyond the wall."""
    reach = 0.04
    found = compliance(PinBeam((0.2,), DIAMETER, STEEL), (0.2 + reach,))
    stiffness = STEEL.youngs_modulus * INERTIA
    assert found[0, 0] == pytest.approx(reach**3 / (3.0 * stiffness) + reach / SHEAR, rel=2e-3)
    assert found[4, 0] == pytest.approx(reach**2 / (2.0 * stiffness), rel=1e-6)
    assert found[3, 1] == pytest.approx(-(reach**2) / (2.0 * stiffness), rel=1e-6)


def test_walls_that_move_as_one_body_take_the_pin_along_and_walls_that_do_not_tilt_it() -> None:
    bearings = (0.11, 0.15)
    mounted = PinBeam((0.1, 0.1 + SPAN), DIAMETER, STEEL).mounted(bearings)
    n, tilt = mounted.size, 1e-4
    walls = np.zeros(10)
    walls[[0, 5]] = tilt * 0.1, tilt * (0.1 + SPAN)
    walls[[4, 9]] = tilt
    stations = np.linalg.solve(mounted.stiffness[:n, :n], -mounted.stiffness[:n, n:] @ walls)
    assert stations[[0, 5]] == pytest.approx(tilt * np.array(bearings), rel=1e-6)
    # A wall that turns with the carrier displaces one end across: in the middle a clamped beam follows by half.
    walls[:] = 0.0
    walls[5] = 1e-5
    middle = PinBeam((0.1, 0.1 + SPAN), DIAMETER, STEEL).mounted((0.1 + 0.5 * SPAN,))
    moved = np.linalg.solve(middle.stiffness[:5, :5], -middle.stiffness[:5, 5:] @ walls)
    slope = 1.5 / SPAN / (1.0 + 12.0 * STEEL.youngs_modulus * INERTIA / (SHEAR * SPAN**2))
    assert moved[0] == pytest.approx(0.5e-5, rel=1e-6)
    assert moved[4] == pytest.approx(1e-5 * slope, rel=5e-3)


TUBE = (60e-3, 56e-3)  # m, around the sun: the webs between the walls
OFFSET = 0.5 * 2e-3 * 54
COUNT = 3


def two_walled(pin: Any, tilt: float = 1e-3) -> Machine:
    """Planets with one bearing in the middle between two walls, which a tube joins."""
    parts = set_parts(count=COUNT)
    carrier = Rotor("c", [Segment(0.16, *TUBE, STEEL)], [])
    shafts = []
    for one in parts["shafts"]:
        if one.name == "c":
            shafts.append(replace(one, rotor=carrier, start=-0.03))
        else:
            shafts.append(replace(one, pin=pin) if one.carrier else one)
    middle = np.diag([2e8, 2e8, 1e7, tilt, tilt])
    bearings = [
        replace(one, bearing=replace(one.bearing, at=0.03, stiffness=middle, damping=np.zeros((5, 5))))
        if one.rotor.startswith("p")
        else one
        for one in parts["bearings"]
        if not (one.rotor.startswith("p") and " 0.05" in one.bearing.name)
    ]
    return Machine(**(parts | {"shafts": shafts, "bearings": bearings}))


def test_the_walls_wind_up_and_the_pins_tilt() -> None:
    """By hand: each planet's force halves between the walls; the first half passes the shaft between them.

    Its torque N a F / 2 twists the tube, G J / L, and the clamped pins, N a² 12 E I / L³ (1 + φ). A pin whose ends are
    Δ apart has the slope 1.5 Δ / L (1 + φ) in the middle.
    """
    machine = two_walled(PinBeam((0.0, SPAN), DIAMETER, STEEL))
    point = machine.operating_point()
    torque = machine.torque * (1.0 + 84 / 24)
    bending = STEEL.youngs_modulus * INERTIA
    softer = 1.0 + 12.0 * bending / (SHEAR * SPAN**2)
    tube = STEEL.shear_modulus * math.pi / 32.0 * (TUBE[0] ** 4 - TUBE[1] ** 4) / SPAN
    pins = COUNT * OFFSET**2 * 12.0 * bending / (SPAN**3 * softer)
    wound = 0.5 * torque / (tube + pins)
    slope = 1.5 * OFFSET * wound / (SPAN * softer)
    for number in range(COUNT):
        seat = next(load for load in point.bearings if load.name == f"p 0.01 {number + 1}").seat_motion
        angle = 2.0 * math.pi * number / COUNT
        # A slope of the tangential motion along z is a rotation about the inward axis.
        tilt = -(seat[3] * math.cos(angle) + seat[4] * math.sin(angle))
        assert abs(tilt) == pytest.approx(slope, rel=5e-3)
        along = math.hypot(seat[0], seat[1])
        force = torque / (COUNT * OFFSET)
        bent = force * (SPAN**3 / (192.0 * bending) + SPAN / (4.0 * SHEAR))
        assert along > bent
        # The tilt of its pin is the carrier's part of the misalignment at sun and ring, along both planes of action.
        causes = [one.misalignment_by_cause for one in point.pairs if f"p {number + 1}" in one.pair.label]
        assert len(causes) == 2
        assert all(one["housing"] == 0.0 for one in causes)
        by_carrier = -0.5 * sum(one["carrier"] for one in causes)
        assert by_carrier == pytest.approx(slope * math.cos(math.radians(20.0)), rel=5e-3)


def test_thin_pins_raise_the_face_load_of_the_planets() -> None:
    pins = [PinBeam((0.0, SPAN), diameter, STEEL) for diameter in (12e-3, 18e-3)]
    loads = [two_walled(pin, tilt=1e6).operating_point() for pin in pins]
    slopes = [[abs(pair.misalignment) for pair in point.pairs] for point in loads]
    factors = [max(pair.k_h_beta for pair in point.pairs) for point in loads]
    assert min(slopes[0]) > max(slopes[1])
    assert factors[0] > factors[1]


def plane_set_of_steel(pin: Any = None, *, bearings: float = 1.0) -> Machine:
    """Planets on pins; ``bearings`` is the stiffness of theirs across the axis over that of the plane set."""
    parts = plane_set(equal_angles(3), pressure_angle=0.4, with_ring=True, material=STEEL, diameter=0.05, mode_count=1)
    # A carrier that does not bend has the pins' walls where the bearings are.
    stiff = Rotor("carrier", [Segment(0.1, 0.05, 0.0, ShaftMaterial(2e13, 8e12, 7810.0))], [])
    rotors = [replace(stiff, discs=one.rotor.discs) if one.name == "carrier" else one.rotor for one in parts["shafts"]]
    shafts = [
        replace(one, rotor=rotor, pin=pin if one.carrier else None)
        for one, rotor in zip(parts["shafts"], rotors, strict=True)
    ]
    softer = np.diag([bearings, bearings, 1.0, 1.0, 1.0])
    on_pins = [
        replace(one, bearing=replace(one.bearing, stiffness=softer @ one.bearing.stiffness))
        if one.rotor.startswith("planet")
        else one
        for one in parts["bearings"]
    ]
    return Machine(**(parts | {"shafts": shafts, "bearings": on_pins, "torque": 100.0}))


def test_a_pin_on_springs_is_in_series_with_the_bearings() -> None:
    """Across the axis 1e8 N/m on a pin of as much is half as much, for every mode in the plane that feels it."""
    found = plane_set_of_steel(PinSprings(0.05, BEARING_STIFFNESS, 1e9)).modes().frequencies_hz
    expected = plane_set_of_steel(bearings=0.5).modes().frequencies_hz
    rigid = plane_set_of_steel().modes().frequencies_hz
    softened = [one for one in found[(found > 1.0) & (found < 3e3)] if np.abs(rigid / one - 1.0).min() > 2e-2]
    assert len(softened) >= 8
    assert max(np.abs(expected / one - 1.0).min() for one in softened) < 2e-3


def test_a_stiff_pin_is_a_rigid_one() -> None:
    rigid, on_pins = plane_set_of_steel(), plane_set_of_steel(PinBeam((0.0, 0.1), 0.04, STEEL))
    frequencies = [machine.modes().frequencies_hz[1:20] for machine in (on_pins, rigid)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=3e-4)
    forces = [[pair.force for pair in machine.operating_point().pairs] for machine in (on_pins, rigid)]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)


@pytest.mark.parametrize(
    ("pin", "told"),
    [
        ({"walls": (), "diameter": 1e-2}, "one place along z or more"),
        ({"walls": (0.0, 0.0), "diameter": 1e-2}, "each once"),
        ({"walls": (0.0,), "diameter": 1e-2, "bore": 1e-2}, "less than the diameter"),
        ({"walls": (0.0,), "diameter": -1e-2}, "diameter"),
    ],
)
def test_no_such_pin(pin: dict[str, Any], told: str) -> None:
    with pytest.raises(CouplingError, match=told):
        PinBeam(material=STEEL, **pin)


def test_a_pin_is_of_a_planet_with_room_for_it() -> None:
    with pytest.raises(CouplingError, match="without a carrier"):
        shaft("s", pin=PinSprings(0.0, 1e8, 1e5))
    with pytest.raises(CouplingError, match="thinner than the bore of the planet around it, 10 mm"):
        shaft("p", bore=10e-3, carrier="c", pin=PinBeam((0.0,), 12e-3, STEEL))
