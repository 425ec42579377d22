"""Stiffness diameters of a rotor, against shafts written out by hand."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
    solve_whirl,
    static_deflection,
    write_ross,
)
from gearwhine.rotors.analyses.static_stiffness import static_shaft
from gearwhine.rotors.model.profile import StiffnessDiameter

STEEL = ShaftMaterial(2.1e11, 8.0e10, 7850.0)
BRASS = ShaftMaterial(1.0e11, 3.7e10, 8500.0)
UNIFORM = Segment(0.4, 0.03, 0.01, STEEL, 0.85)
STEPS = [UNIFORM, Segment(0.12, 0.05, 0.0, BRASS, 0.9), Segment(0.2, 0.04, 0.02, STEEL, 0.8)]
DISCS = [Disc(0.41, 2.0, 4e-3, 2e-3), Disc(0.2, 1.0, 2e-3, 1e-3)]
CONE = Segment(0.15, 0.03, 0.0, STEEL, "cowper", right_outer_diameter=0.06, right_inner_diameter=0.02)
JAW = Coupling(0.05, 2e7, 4e4, 9e3, 5e7, mass=1.2, polar_inertia=1e-3, diametral_inertia=8e-4)
BEARINGS = [Bearing.isotropic("left", 0.03, 4e7), Bearing.isotropic("right", 0.68, 9e7)]
SUPPORTS = [bearing.mean_support for bearing in BEARINGS]
# The first within a segment, the last reaches over the end of one and is thinner than the next.
STIFF = [StiffnessDiameter(0.1, 0.25, 0.045, 0.041), StiffnessDiameter(0.35, 0.5, 0.042, 0.038)]


def bent_and_twisted(part: Segment, length: float, bending: float, torsion: float) -> Segment:
    """Part of the same mass and inertia whose moduli and shear coefficient make it as stiff as two other diameters."""

    def ratio(outer: float, power: int) -> float:
        bore = part.inner_diameter**power
        return (outer**power - bore) / (part.outer_diameter**power - bore)

    old = part.material
    new = ShaftMaterial(old.youngs_modulus * ratio(bending, 4), old.shear_modulus * ratio(torsion, 4), old.density)
    assert isinstance(part.shear_coefficient, float)
    shear = part.shear_coefficient * ratio(bending, 2) * old.shear_modulus / new.shear_modulus
    return replace(part, length=length, material=new, shear_coefficient=shear)


def stretched(part: Segment, length: float, outer: float) -> Segment:
    """Part of the same mass that stretches as one of another diameter."""
    ratio = (outer**2 - part.inner_diameter**2) / (part.outer_diameter**2 - part.inner_diameter**2)
    return replace(part, length=length, material=ShaftMaterial(ratio * 2.1e11, 8.0e10, 7850.0))


BY_HAND = [
    replace(UNIFORM, length=0.1),
    bent_and_twisted(UNIFORM, 0.15, 0.045, 0.041),
    replace(UNIFORM, length=0.1),
    bent_and_twisted(UNIFORM, 0.05, 0.042, 0.038),
    *STEPS[1:],
]


@pytest.mark.parametrize("mass_model", ["distributed", "lumped"])
def test_modes_are_those_of_the_shaft_written_out_by_hand(mass_model: str) -> None:
    if mass_model == "lumped":
        # Lumps stand at the ends of segments, which are those of the shaft by hand.
        cut = [replace(UNIFORM, length=part.length) for part in BY_HAND[:4]] + STEPS[1:]
    else:
        cut = STEPS
    rotor = Rotor("shaft", cut, DISCS, mass_model, STIFF)  # type: ignore[arg-type]
    by_hand = Rotor("shaft", BY_HAND, DISCS, mass_model)  # type: ignore[arg-type]
    bare = Rotor("shaft", cut, DISCS, mass_model)  # type: ignore[arg-type]
    assert rotor.mass == pytest.approx(by_hand.mass, rel=1e-14)
    lateral, expected, plain = (solve_lateral_modes(one, SUPPORTS, count=5) for one in (rotor, by_hand, bare))
    np.testing.assert_allclose(lateral.frequencies, expected.frequencies, rtol=1e-11)
    assert lateral.frequencies[0] > 1.05 * plain.frequencies[0]
    places = np.linspace(0.0, 0.72, 40)
    for found, wanted in zip(lateral.evaluate(places), expected.evaluate(places), strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())
    torsional, twisted, untwisted = (solve_torsional_modes(one, count=4) for one in (rotor, by_hand, bare))
    np.testing.assert_allclose(torsional.frequencies, twisted.frequencies, rtol=1e-11, atol=1e-9)
    assert torsional.frequencies[1] > 1.05 * untwisted.frequencies[1]


def test_whirl_and_sag_are_those_of_the_shaft_written_out_by_hand() -> None:
    rotor, by_hand = Rotor("shaft", STEPS, DISCS, stiffness_diameters=STIFF), Rotor("shaft", BY_HAND, DISCS)
    found, expected = (solve_whirl(one, BEARINGS, speed=800.0, count=6) for one in (rotor, by_hand))
    np.testing.assert_allclose(found.eigenvalues, expected.eigenvalues, rtol=1e-9, atol=1e-6)
    sag, wanted = (static_deflection(one, BEARINGS) for one in (rotor, by_hand))
    np.testing.assert_allclose(sag.bearing_loads, wanted.bearing_loads, rtol=1e-9, atol=1e-9)
    places = np.linspace(0.0, 0.72, 30)
    np.testing.assert_allclose(sag.evaluate(places), wanted.evaluate(places), rtol=1e-8, atol=1e-14)


def test_a_rod_stretches_with_the_diameter_of_bending() -> None:
    by_hand = [
        replace(UNIFORM, length=0.1),
        stretched(UNIFORM, 0.15, 0.045),
        replace(UNIFORM, length=0.1),
        stretched(UNIFORM, 0.05, 0.042),
        *STEPS[1:],
    ]
    found = solve_axial_modes(Rotor("shaft", STEPS, DISCS, stiffness_diameters=STIFF), count=4)
    expected = solve_axial_modes(Rotor("shaft", by_hand, DISCS), count=4)
    np.testing.assert_allclose(found.frequencies, expected.frequencies, rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("young", [3e9, 6.3e11])
def test_a_body_of_another_material_is_a_sleeve_around_the_shaft(young: float) -> None:
    """EI, GJ, κGA and EA of core and sleeve add up; a soft sleeve hardly stiffens."""
    shear, bore, bare, outer = young / 2.6, 0.01, 0.03, 0.045

    def together(modulus: float, sleeve: float, power: int) -> float:
        """Stiffness of both over that of the core."""
        core = modulus * (bare**power - bore**power)
        return (core + sleeve * (outer**power - bare**power)) / core

    bent, twisted = together(2.1e11, young, 4), together(8e10, shear, 4)
    sheared = together(8e10, shear, 2)
    spread = ShaftMaterial(2.1e11 * bent, 8e10 * twisted, 7850.0)
    by_hand = Segment(0.15, bare, bore, spread, 0.85 * sheared / twisted)
    stretched_by_hand = replace(
        UNIFORM, length=0.15, material=ShaftMaterial(2.1e11 * together(2.1e11, young, 2), 8e10, 7850.0)
    )
    stiff = [StiffnessDiameter(0.1, 0.25, outer, outer, young, shear)]
    # One thinner than the shaft, and one softer than the other, have no effect.
    stiff += [
        StiffnessDiameter(0.3, 0.35, 0.02, 0.02, 1e13, 1e13),
        StiffnessDiameter(0.12, 0.2, outer, outer, 1e9, 1e9),
    ]
    rotor = Rotor("shaft", STEPS, DISCS, stiffness_diameters=stiff)
    ends = [replace(UNIFORM, length=0.1), replace(UNIFORM, length=0.15), *STEPS[1:]]
    written, rod = (Rotor("shaft", [ends[0], part, *ends[1:]], DISCS) for part in (by_hand, stretched_by_hand))
    for found, expected in (
        (solve_lateral_modes(rotor, SUPPORTS, count=5), solve_lateral_modes(written, SUPPORTS, count=5)),
        (solve_torsional_modes(rotor, count=4), solve_torsional_modes(written, count=4)),
        (solve_axial_modes(rotor, count=4), solve_axial_modes(rod, count=4)),
    ):
        np.testing.assert_allclose(found.frequencies, expected.frequencies, rtol=1e-10, atol=1e-9)


def test_the_thickest_of_overlapping_diameters_counts() -> None:
    over = [StiffnessDiameter(0.1, 0.25, 0.035, 0.035), StiffnessDiameter(0.15, 0.2, 0.045, 0.032)]
    apart = [
        StiffnessDiameter(0.1, 0.15, 0.035, 0.035),
        StiffnessDiameter(0.15, 0.2, 0.045, 0.035),
        StiffnessDiameter(0.2, 0.25, 0.035, 0.035),
    ]
    stations = [0.05, 0.3, 0.7]
    found, expected = (static_shaft(Rotor("s", STEPS, stiffness_diameters=one), stations) for one in (over, apart))
    np.testing.assert_allclose(found.stiffness, expected.stiffness, rtol=1e-10, atol=1e-3)


def test_a_cone_is_stiffened_up_to_the_diameter_and_keeps_its_mass() -> None:
    # From 30 to 60 mm: it is 40 mm thick at a third, 45 mm at the half.
    L = CONE.length
    stiff = [StiffnessDiameter(0.02, 0.2, 0.04, 0.04), StiffnessDiameter(JAW.length + L / 6, 0.2, 0.045, 0.045)]
    rotor, ends = Rotor("shaft", [JAW, CONE], stiffness_diameters=stiff), [JAW.length, JAW.length + L]
    shaft = static_shaft(rotor, ends)
    bores = [CONE.section(fraction).inner_diameter for fraction in (0.0, 1 / 6, 1 / 2)]
    by_hand: list[Segment | Coupling] = [
        JAW,
        replace(CONE, length=L / 6, outer_diameter=0.04, right_outer_diameter=0.04, right_inner_diameter=bores[1]),
        replace(CONE, length=L / 3, outer_diameter=0.045, right_outer_diameter=0.045, inner_diameter=bores[1],
                right_inner_diameter=bores[2]),
        replace(CONE, length=L / 2, outer_diameter=0.045, inner_diameter=bores[2]),
    ]  # fmt: skip
    expected = static_shaft(Rotor("shaft", by_hand), ends)
    scale = np.abs(expected.stiffness).max()
    np.testing.assert_allclose(shaft.stiffness, expected.stiffness, atol=1e-12 * scale)
    total = shaft.weight([1.0, 0.0, 0.0]).reshape(-1, 6)
    about_left = total[:, 0] @ shaft.places + total[:, 4].sum()
    np.testing.assert_allclose(total[:, 0].sum(), rotor.mass, rtol=1e-12)
    np.testing.assert_allclose(about_left, rotor.mass * rotor.centre_of_mass, rtol=1e-12)


SLIM = Segment(0.15, 0.03, 0.0, STEEL, "cowper", right_outer_diameter=0.036)


@pytest.mark.parametrize(
    ("cone", "stiff"),
    [
        (CONE, [StiffnessDiameter(0.03, 0.12, 0.042, 0.05)]),
        # Two bodies alike on places of different mass.
        (SLIM, [StiffnessDiameter(at, at + 0.03, 0.06, 0.06) for at in (0.015, 0.105)]),
    ],
)
def test_modes_of_a_stiffened_cone_are_those_of_many_short_cylinders(
    cone: Segment, stiff: list[StiffnessDiameter]
) -> None:
    """The error of n steps falls as 1/n², so that Richardson's extrapolation of two of them is the reference."""
    rotor = Rotor("cone", [cone], [Disc(0.15, 0.3, 1e-4, 1e-4)], stiffness_diameters=stiff)

    def stepped(count: int) -> Rotor:
        middles = (np.arange(count) + 0.5) / count
        sections = [cone.section(float(place)) for place in middles]
        parts: list[Segment | Coupling] = [
            Segment(cone.length / count, one.outer_diameter, one.inner_diameter, STEEL, "cowper") for one in sections
        ]
        return replace(rotor, segments=parts)

    def frequencies(one: Rotor) -> FloatArray:
        lateral = solve_lateral_modes(one, SUPPORTS[:0], count=4).frequencies[2:]
        return np.concatenate([lateral, solve_torsional_modes(one, count=2).frequencies[1:]])

    coarse, fine = frequencies(stepped(60)), frequencies(stepped(120))
    np.testing.assert_allclose(frequencies(rotor), fine + (fine - coarse) / 3.0, rtol=1e-7)
    assert np.abs(frequencies(replace(rotor, stiffness_diameters=())) / fine - 1.0).min() > 0.02


def test_a_file_for_ross_says_that_the_stiffness_is_left_out(tmp_path: Path) -> None:
    rotor = Rotor("shaft", STEPS, DISCS, stiffness_diameters=STIFF)
    remarks = write_ross(tmp_path / "shaft.toml", rotor, BEARINGS)
    assert any("stiffness diameter" in remark and "2" in remark for remark in remarks)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((0.3, 0.9, 0.05, 0.05), r"rotor 'shaft' stiffness diameter position is 0\.9; expected a place on the shaft"),
        ((0.3, 0.2, 0.05, 0.05), "its left end before its right"),
        ((0.2, 0.3, -0.05, 0.05), "stiffness diameter in bending is -0.05"),
        ((0.2, 0.3, 0.05, math.nan), "stiffness diameter in torsion is nan"),
        ((0.2, 0.3, 0.05, 0.05, 0.0, None), "youngs_modulus of a stiffness diameter is 0"),
        ((0.2, 0.3, 0.05, 0.05, None, math.inf), "shear_modulus of a stiffness diameter is inf"),
    ],
)
def test_bad_input_is_refused(given: tuple[Any, ...], message: str) -> None:
    with pytest.raises(RotorError, match=message):
        Rotor("shaft", STEPS, stiffness_diameters=[StiffnessDiameter(*given)])


def test_outer_diameter_at_a_shoulder_is_that_of_the_side_asked_for() -> None:
    rotor = Rotor("shaft", [*STEPS, JAW, CONE])
    assert rotor.outer_diameter(0.4, 0.3) == 0.03
    assert rotor.outer_diameter(0.4, 0.5) == 0.05
    assert rotor.outer_diameter(0.0, 0.1) == 0.03
    assert rotor.outer_diameter(0.72, 0.73) == 0.0
    assert rotor.outer_diameter(0.77 + 0.5 * CONE.length, 0.9) == pytest.approx(0.045)
    assert rotor.outer_diameter(rotor.length, 0.8) == pytest.approx(0.06)
