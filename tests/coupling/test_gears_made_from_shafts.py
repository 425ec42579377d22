"""A gear without a bore on its shaft: together they weigh what one piece of steel of their shape weighs."""

import math
from dataclasses import replace

import pytest

from gearwhine.case import parse_case
from gearwhine.coupling import ShaftGear
from gearwhine.coupling.description.parts import gear_disc, inertia_with_discs, rotor_with_gears
from gearwhine.coupling.gears import Gear
from gearwhine.rotors import Rotor, Segment, ShaftMaterial

WIDTH = 0.04
GEAR = Gear("pinion", 25, 3e-3, math.radians(20.0), WIDTH)
OUTSIDE = 75e-3
STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, GEAR.density)
MASSLESS = replace(STEEL, density=0.0)


def moments(rotor: Rotor) -> list[float]:
    """Mass, its first and second moment along the axis from the left end, and polar inertia."""
    parts = [
        (part.mass, left + part.mass_centre, part.diametral_inertia)
        for part, left in zip(rotor.segments, rotor.joints.tolist()[:-1], strict=True)
    ]
    parts += [(disc.mass, disc.at, disc.diametral_inertia) for disc in rotor.discs]
    first = sum(mass * at for mass, at, _ in parts)
    return [rotor.mass, first, sum(own + mass * at**2 for mass, at, own in parts), rotor.polar_inertia]


def shaft(*sizes: tuple[float, ...]) -> Rotor:
    """Shaft of cylinders (length, diameter) and cones (length, diameter, right diameter)."""
    segments = [
        Segment(length, left, 0.0, STEEL, right_outer_diameter=right[0] if right else None)
        for length, left, *right in sizes
    ]
    return Rotor("shaft", segments)


SHAPES = {
    "plain": ([(0.24, 0.04)], 0.12, [(0.1, 0.04), (WIDTH, OUTSIDE), (0.1, 0.04)]),
    "a step off the middle": ([(0.11, 0.04), (0.13, 0.06)], 0.12, [(0.1, 0.04), (WIDTH, OUTSIDE), (0.1, 0.06)]),
    "a cone through it": (
        [(0.05, 0.03), (0.1, 0.03, 0.06), (0.05, 0.06)],
        0.09,
        [(0.05, 0.03), (0.02, 0.03, 0.036), (WIDTH, OUTSIDE), (0.04, 0.048, 0.06), (0.05, 0.06)],
    ),
    "beyond both ends": ([(0.02, 0.04), (0.01, 0.05)], 0.015, [(0.005, OUTSIDE), (0.035, OUTSIDE)]),
    "thinner than its shaft": ([(0.24, 0.1)], 0.12, [(0.24, 0.1)]),
}


@pytest.mark.parametrize(("sizes", "at", "whole"), SHAPES.values(), ids=SHAPES)
def test_shaft_and_gear_weigh_as_one_piece(
    sizes: list[tuple[float, ...]], at: float, whole: list[tuple[float, ...]]
) -> None:
    rotor = rotor_with_gears(shaft(*sizes), [ShaftGear(GEAR, "shaft", at, stiffens_shaft=False)])
    found, expected = moments(rotor), moments(shaft(*whole))
    if at < 0.5 * WIDTH:
        # The one piece begins at the left end of the face.
        start = at - 0.5 * WIDTH
        mass, first, second, polar = expected
        expected = [mass, first + start * mass, second + 2.0 * start * first + start**2 * mass, polar]
    assert found == pytest.approx(expected, rel=1e-12)


def test_a_web_ends_at_the_shaft_and_a_rim_is_whole() -> None:
    rimmed = replace(GEAR, rim_thickness=5e-3)
    webbed = replace(rimmed, web_thickness=8e-3)
    bare = shaft((0.24, 0.04))
    rim, both = (gear_disc(ShaftGear(gear, "shaft", 0.12), bare) for gear in (rimmed, webbed))
    inside = OUTSIDE - 2.0 * (1.25 * 3e-3 + 5e-3)
    ring = Segment(8e-3, inside, 0.04, STEEL)
    assert rim.mass == pytest.approx(Segment(WIDTH, OUTSIDE, inside, STEEL).mass, rel=1e-12)
    assert both.mass - rim.mass == pytest.approx(ring.mass, rel=1e-11)
    assert both.diametral_inertia - rim.diametral_inertia == pytest.approx(ring.diametral_inertia, rel=1e-10)


def test_a_shaft_without_mass_a_bore_and_a_given_inertia_leave_the_gear_whole() -> None:
    full = Segment(WIDTH, OUTSIDE, 0.0, STEEL)
    stub, under = shaft((0.1, 0.04)).segments[0], Segment(0.14, 0.04, 0.0, MASSLESS)
    massless = gear_disc(ShaftGear(GEAR, "shaft", 0.13), Rotor("shaft", [stub, under]))
    assert massless.mass == pytest.approx(full.mass, rel=1e-12)
    # Whatever diameter the shaft has.
    bored = gear_disc(ShaftGear(replace(GEAR, bore=0.02), "shaft", 0.12), shaft((0.24, 0.04)))
    assert bored.mass == pytest.approx(Segment(WIDTH, OUTSIDE, 0.02, STEEL).mass, rel=1e-12)
    given = gear_disc(ShaftGear(GEAR, "shaft", 0.12, (1.0, 2e-3, 3e-3)), shaft((0.24, 0.04)))
    assert (given.at, given.mass, given.polar_inertia, given.diametral_inertia) == (0.12, 1.0, 2e-3, 3e-3)


def test_the_core_counts_in_the_damping_of_the_mesh() -> None:
    gears = [ShaftGear(GEAR, "shaft", 0.12)]
    full = Segment(WIDTH, OUTSIDE, 0.0, STEEL)
    assert inertia_with_discs(gears[0], shaft((0.24, 0.04)), gears) == pytest.approx(full.polar_inertia, rel=1e-12)


def test_a_case_weighs_its_pinion_once() -> None:
    case = parse_case(
        {
            "material": {"steel": {"youngs_modulus": "207 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3"}},
            "rotor": [{"name": "a", "material": "steel", "segments": [{"length": "240 mm", "diameter": "40 mm"}]}],
            "gear": [{"name": "p", "rotor": "a", "at": "120 mm", "teeth": 25, "module": "3 mm", "face_width": "40 mm"}],
        }
    )
    mass = 7850.0 * math.pi / 4.0 * (0.04**2 * 0.2 + 0.075**2 * 0.04)
    assert case.parts.rotors[0].mass == pytest.approx(mass, rel=1e-12)
