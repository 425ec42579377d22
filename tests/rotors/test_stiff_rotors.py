"""Rotors that random search found to be refused, or to lose digits: each the shortest known of its kind."""

import math

import numpy as np
import pytest
from finite_element_rotor import bending_model, rod_model

from gearwhine.rotors import (
    AxisSpring,
    Disc,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
)

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)
ALUMINIUM = ShaftMaterial(70e9, 26e9, 2700.0)
BRASS = ShaftMaterial(100e9, 37e9, 8500.0)
PLASTIC = ShaftMaterial(3e9, 1.1e9, 1400.0)
RUBBER = ShaftMaterial(5e6, 1.7e6, 1100.0)


def test_two_overhangs_of_one_clamp() -> None:
    count = 10
    sides = [Segment(0.5, 0.05, 0.0, STEEL), Segment(0.4, 0.05, 0.0, STEEL)]
    modes = solve_lateral_modes(Rotor("clamped", sides), [RadialSupport(0.5, math.inf, math.inf)], count=count)
    alone = [
        solve_lateral_modes(Rotor("side", [side]), [RadialSupport(at, math.inf, math.inf)], count=count).frequencies
        for side, at in zip(sides, (0.5, 0.0), strict=True)
    ]
    np.testing.assert_allclose(modes.frequencies, np.sort(np.concatenate(alone))[: modes.count], rtol=1e-12)


@pytest.mark.parametrize("at", [0.5, 1.0])
def test_rod_held_elsewhere_than_at_its_left_end(at: float) -> None:
    # Each side free at one end and held at the other, (n − ½) π c / l.
    rod = Rotor("rod", [Segment(0.5, 0.1, 0.0, STEEL)] * 2)
    modes = solve_axial_modes(rod, [AxisSpring(at, math.inf)], frequency_limit=3e4)
    waves = math.pi * math.sqrt(207e9 / 7850.0) * (np.arange(1, 20) - 0.5)
    roots = np.sort(np.concatenate([waves / side for side in (at, 1.0 - at) if side > 0.0]))
    np.testing.assert_allclose(modes.frequencies, roots[roots < 3e4], rtol=1e-12)


def test_few_modes_of_a_flat_ring() -> None:
    ring = Rotor("ring", [Segment(0.0019, 0.3, 0.285, STEEL)])
    modes = solve_lateral_modes(ring, count=7)
    limit = float(modes.frequencies[-1]) * (1.0 + 1e-9)
    reference = bending_model(ring, [], limit).natural_frequencies(limit)
    np.testing.assert_allclose(modes.frequencies, reference, rtol=1e-11)


def test_twins_tied_by_a_hair_in_bending() -> None:
    half = [
        Segment(0.4131, 0.1844, 0.95 * 0.1844, RUBBER),
        Segment(0.1254, 0.1844, 0.95 * 0.1844, PLASTIC),
        Segment(1.0, 0.03074, 0.0, PLASTIC),
        Segment(0.3632, 0.004711, 0.5 * 0.004711, ALUMINIUM),
    ]
    off = 1.0 + 1e-11
    discs = [Disc(1.2678, 3491.0, 3491.0, 1745.5), Disc(3.5356, off * 3491.0, off * 3491.0, off * 1745.5)]
    rotor = Rotor("twins", [*half, Segment(1.0, 1e-6, 0.0, STEEL), *half[::-1]], discs)
    supports = [RadialSupport(at, 1e4) for at in (0.158475, 0.4131)]
    supports += [RadialSupport(at, off * 1e4) for at in (4.644925, 4.3903)]
    modes = solve_lateral_modes(rotor, supports, count=5)
    limit = float(modes.frequencies[-1]) * (1.0 + 1e-9)
    reference = bending_model(rotor, supports, limit).natural_frequencies(limit)
    np.testing.assert_allclose(modes.frequencies, reference, rtol=1e-10)


def test_twins_tied_by_a_hair_in_torsion() -> None:
    half = [Segment(0.6955, 0.001, 0.0, BRASS), Segment(0.0002677, 0.009917, 0.0, BRASS)]
    inertia = 0.09211224999999999
    discs = [
        Disc(0.28990320833333333, 1.0, inertia, 0.5 * inertia),
        Disc(2.1016321916666665, 1.000000000001, 0.09211225000009211, 0.04605612500004606),
    ]
    rotor = Rotor("twins", [*half, Segment(1.0, 2.971e-06, 0.0, STEEL), *half[::-1]], discs)
    modes = solve_torsional_modes(rotor, count=6)
    limit = float(modes.frequencies[-1]) * (1.0 + 1e-9)
    reference = rod_model(rotor, "torsion", limit).natural_frequencies(limit)
    np.testing.assert_allclose(modes.frequencies, reference, rtol=1e-10, atol=1e-9 * limit)


def test_thin_walled_cone() -> None:
    tube = Segment(0.4, 0.1, 0.099, STEEL, right_outer_diameter=0.15, right_inner_diameter=0.1485)
    rotor = Rotor("tube", [tube])
    modes = solve_lateral_modes(rotor, count=5)
    limit = 1.01 * float(modes.frequencies[-1])
    reference = bending_model(rotor, [], limit).natural_frequencies(limit)
    np.testing.assert_allclose(modes.frequencies, reference, rtol=1e-11, atol=1e-6)


def test_rod_lighter_than_its_disc_by_sixteen_digits() -> None:
    # The rigid motion is nearly all in the disc, the others have only a rounded part there.
    rotor = Rotor("flag", [Segment(0.00333, 0.00274, 0.0, RUBBER)], [Disc(0.00333, 450.9, 450.9, 225.45)])
    modes = solve_torsional_modes(rotor, count=5)
    limit = 1.01 * float(modes.frequencies[-1])
    reference = rod_model(rotor, "torsion", limit).natural_frequencies(limit)
    np.testing.assert_allclose(modes.frequencies, reference, rtol=1e-10, atol=1e-6)
