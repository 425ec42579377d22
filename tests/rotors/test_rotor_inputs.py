"""Wrong shafts, bearings and requests name what is wrong; right ones have the inertias of solid geometry."""

import math

import numpy as np
import pytest

import gearwhine as gw
from gearwhine import rotors
from gearwhine.coupling.gears import Gear
from gearwhine.rotors import (
    Bearing,
    Disc,
    RadialSupport,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.model.material import shear_coefficient
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
BAR = Segment(0.4, 0.03, 0.01, STEEL)
ZERO = np.zeros((2, 2))


def test_material_keeps_the_poisson_ratio() -> None:
    assert STEEL.poisson_ratio == pytest.approx(0.3, rel=1e-14)
    assert STEEL.shear_modulus == pytest.approx(207e9 / 2.6, rel=1e-15)


def test_segment_inertias_are_those_of_a_hollow_cylinder() -> None:
    outer, inner, mass = 0.015, 0.005, 7850.0 * math.pi * (0.015**2 - 0.005**2) * 0.4
    assert BAR.mass == pytest.approx(mass, rel=1e-14)
    assert BAR.polar_inertia == pytest.approx(mass * (outer**2 + inner**2) / 2, rel=1e-14)
    assert BAR.diametral_inertia == pytest.approx(mass * (3 * (outer**2 + inner**2) + 0.4**2) / 12, rel=1e-14)


@pytest.mark.parametrize(
    ("formula", "bore", "expected"),
    [
        # Solid circle: 6(1 + ν)/(7 + 6ν) and 6(1 + ν)²/(7 + 12ν + 4ν²).
        # Thin tube: 2(1 + ν)/(4 + 3ν) and (1 + ν)/(2 + ν).
        ("cowper", 0.0, 7.8 / 8.8),
        ("hutchinson", 0.0, 6 * 1.69 / (7 + 3.6 + 0.36)),
        ("cowper", 1.0 - 1e-9, 2.6 / 4.9),
        ("hutchinson", 1.0 - 1e-9, 1.3 / 2.3),
    ],
)
def test_shear_coefficient_limits(formula: str, bore: float, expected: float) -> None:
    assert shear_coefficient(formula, bore, 0.3) == pytest.approx(expected, rel=1e-8)  # type: ignore[arg-type]


def test_rotor_sums_its_parts_and_merges_its_stations() -> None:
    shaft = Rotor("shaft", [Segment(0.1, 0.03, 0.0, STEEL)] * 7, [Disc(0.3, 2.0, 0.01), Disc(0.35, 1.0)])
    # 0.1 + 0.1 + 0.1 is not 0.3 in binary: still one station.
    np.testing.assert_allclose(shaft.stations, [0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7], atol=1e-15)
    bar = 7850.0 * math.pi / 4 * 0.03**2 * 0.7
    assert shaft.mass == pytest.approx(bar + 3.0, rel=1e-14)
    assert shaft.centre_of_mass == pytest.approx((bar * 0.35 + 0.6 + 0.35) / (bar + 3.0), rel=1e-14)
    assert shaft.length == pytest.approx(0.7, rel=1e-15)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: ShaftMaterial(-1.0, 1.0, 1.0), "youngs_modulus is -1.0; expected a positive number"),
        (lambda: ShaftMaterial(1.0, 1.0, math.nan), "density is nan"),
        (lambda: ShaftMaterial.from_poisson_ratio(1.0, 0.6, 1.0), "poisson_ratio is 0.6"),
        (lambda: Segment(0.0, 0.03, 0.0, STEEL), "segment: length is 0; expected a finite number above 0 m"),
        (lambda: Segment(0.1, 0.03), "segment: material: expected a material"),
        (lambda: Segment(0.1, 0.03, 0.03, STEEL), "less than the outer diameter"),
        (lambda: Segment(0.1, 0.03, 0.0, ShaftMaterial(2e11, 2e10, 1.0)), "check the moduli"),
        (lambda: Segment(0.1, 0.03, 0.0, STEEL, "timoshenko"), "'cowper', 'hutchinson' or a number"),  # type: ignore[arg-type]
        (lambda: Disc(0.1, -1.0), "disc: mass is -1"),
        (lambda: Rotor("r", []), "expected at least one segment"),
        (lambda: Rotor("r", [BAR], [Disc(0.5, 1.0)]), "rotor 'r': discs[0].at is 0.5; expected a station on rotor"),
        (lambda: Rotor("r", [BAR], mass_model="point"), "'distributed' or 'lumped'"),  # type: ignore[arg-type]
        (lambda: Rotor("r", [Segment(1.0, 0.1, 0.0, ShaftMaterial(2e11, 8e10, 0.0))]), "a positive mass"),
        (lambda: RadialSupport(0.0, -1.0), "support stiffness is -1.0"),
        (lambda: RadialSupport(0.0, math.nan), "support stiffness is nan"),
        (lambda: rotors.AxisSpring(-1.0, 1.0), "axis spring position is -1.0"),
        (lambda: rotors.AxisSpring(0.0, math.nan), "axis spring stiffness is nan"),
        (lambda: Bearing("b", 0.0, np.eye(3), ZERO), "bearing 'b' stiffness shape"),
        (lambda: Bearing("b", 0.0, ZERO, np.full((2, 2), np.inf)), "damping"),
    ],
)
def test_wrong_input_is_named(build, message: str) -> None:
    with pytest.raises(RotorError) as caught:
        build()
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("request_modes", "message"),
    [
        (lambda r: rotors.solve_lateral_modes(r, [RadialSupport(9.0, 1.0)], count=1), "place on the shaft"),
        (lambda r: rotors.solve_lateral_modes(r, frequency_limit=1.0, count=1), "one of the two"),
        (lambda r: rotors.solve_lateral_modes(r, frequency_limit=-1.0), "frequency_limit is -1.0"),
        (lambda r: rotors.solve_lateral_modes(r, count=0), "count of modes is 0"),
        (lambda r: rotors.solve_lateral_modes(r, frequency_limit=1e12), "lower frequency limit"),
        (lambda r: rotors.solve_lateral_modes(r, count=2).evaluate([0.5]), "positions are [0.5]"),
        (lambda r: rotors.solve_whirl(r, [Bearing.isotropic("b", 1.0, 1.0)], 0.0), "bearing 'b' position"),
        (lambda r: rotors.solve_whirl(r, [], math.inf), "speed is inf"),
        (lambda _: solve_torsional_chain([1.0, 2.0], [1.0, 1.0]), "one spring between each two"),
        (lambda _: solve_torsional_chain([1.0, 2.0], [0.0]), "stiffnesses"),
        (lambda _: solve_torsional_chain([1.0, 2.0], [1.0], ground=[1.0]), "one stiffness for each inertia"),
        (lambda r: rotors.solve_torsional_modes(r, [rotors.AxisSpring(1.0, 1.0)]), "rotor 'r' spring position is 1.0"),
        (lambda r: rotors.rest_frequencies(r, [], frequency_limit=-1.0), "frequency_limit is -1.0"),
        (lambda r: rotors.rest_frequencies(r, [], frequency_limit=1.0, count=1), "one of the two"),
        (
            lambda _: rotors.solve_lateral_modes(Rotor("l", [BAR], mass_model="lumped"), count=5),
            "at most 4, all this lumped rotor has",
        ),
        (
            lambda _: rotors.solve_torsional_modes(
                Rotor("p", [Segment(1.0, 0.1, 0.0, ShaftMaterial(2e11, 8e10, 0.0))], [Disc(0.5, 1.0)])
            ),
            "polar inertia",
        ),
        (
            lambda _: rotors.solve_lateral_modes(
                Rotor("p", [Segment(1.0, 0.1, 0.0, ShaftMaterial(2e11, 8e10, 0.0))], [Disc(0.5, 1.0)])
            ),
            "moves no inertia",
        ),
    ],
)
def test_wrong_request_is_named(request_modes, message: str) -> None:
    with pytest.raises(RotorError) as caught:
        request_modes(Rotor("r", [BAR]))
    assert message in str(caught.value)


def test_bearings_are_values() -> None:
    one, same = (Bearing("b", 0.1, np.eye(2), ZERO) for _ in range(2))
    assert one == same
    assert hash(one) == hash(same)
    assert one != Bearing("b", 0.1, np.eye(2), np.eye(2))
    with pytest.raises(ValueError, match="read-only"):
        one.stiffness[0, 0] = 2.0


def test_a_segment_takes_the_material_of_a_housing() -> None:
    own, shared = Segment(0.4, 0.03, 0.01, STEEL), Segment(0.4, 0.03, 0.01, gw.STEEL)
    supports = [RadialSupport(0.05, 1e8), RadialSupport(0.35, 1e8)]
    frequencies = [
        solve_lateral_modes(Rotor("shaft", [segment]), supports, count=3).frequencies for segment in (own, shared)
    ]
    np.testing.assert_allclose(frequencies[1], frequencies[0], rtol=1e-12)
    twice = solve_torsional_modes(Rotor("shaft", [own, shared]), count=2).frequencies
    whole = solve_torsional_modes(Rotor("shaft", [own, own]), count=2).frequencies
    np.testing.assert_allclose(twice, whole, rtol=1e-12)


def test_gears_are_of_the_same_steel() -> None:
    gear = Gear("pinion", 28, 3.175e-3, math.radians(20.0), 6.35e-3)
    assert (gear.youngs_modulus, gear.poisson_ratio, gear.density) == (207e9, 0.3, 7850.0)
    assert gw.Material(gear.youngs_modulus, gear.poisson_ratio, gear.density) == gw.STEEL
