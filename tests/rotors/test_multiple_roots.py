"""Double and nearly double roots, modes that live in one part of a shaft, and stations where nothing moves."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.rotors import (
    Disc,
    IncompleteModesError,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.certificate import certify
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
PIN = math.inf


def assert_orthonormal_by_energy(modes: object) -> None:
    assert modes.certificate.complete  # type: ignore[attr-defined]
    assert modes.certificate.orthonormality < 1e-9  # type: ignore[attr-defined]
    assert modes.certificate.max_residual < 1e-10  # type: ignore[attr-defined]


def test_two_overhangs_joined_by_a_pinned_middle_are_an_exact_double() -> None:
    # Sixty pins between them decouple the two ends far below rounding: every root is double.
    shaft = Rotor(
        "twin", [Segment(0.5, 0.05, 0.0, STEEL), Segment(3.0, 0.05, 0.0, STEEL), Segment(0.5, 0.05, 0.0, STEEL)]
    )
    pins = [RadialSupport(z, PIN) for z in np.linspace(0.5, 3.5, 60)]
    modes = solve_lateral_modes(shaft, pins, count=3)
    assert modes.count == 4, "a double root at the end is kept whole"
    np.testing.assert_allclose(modes.frequencies[::2], modes.frequencies[1::2], rtol=1e-12)
    assert_orthonormal_by_energy(modes)
    # Two independent shapes span both ends.
    ends = modes.displacement[:2][:, [0, -1]]
    assert np.linalg.matrix_rank(ends, tol=0.1 * np.abs(ends).max()) == 2


@pytest.mark.parametrize("difference", [0.0, 1e-13, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("pins", [6, 12, 24])
def test_nearly_equal_ends(difference: float, pins: int) -> None:
    shaft = Rotor(
        "near twin",
        [Segment(0.5, 0.05, 0.0, STEEL), Segment(1.0, 0.05, 0.0, STEEL), Segment(0.5, 0.05, 0.0, STEEL)],
        [Disc(0.0, 3.0, 0.02, 0.01), Disc(2.0, 3.0 * (1.0 + difference), 0.02, 0.01)],
    )
    middle = [RadialSupport(z, PIN) for z in np.linspace(0.5, 1.5, pins)]
    modes = solve_lateral_modes(shaft, middle, count=4)
    assert_orthonormal_by_energy(modes)
    # Shapes of displacement and slope at the pins: nothing moves there.
    np.testing.assert_allclose(modes.evaluate(np.linspace(0.5, 1.5, pins))[0], 0.0, atol=1e-12)


def test_modes_at_either_end_of_unequal_ends_are_both_found() -> None:
    # Marching from one end would lose the modes of the other: each must equal the end cut off alone.
    left, right = Segment(0.5, 0.05, 0.0, STEEL), Segment(0.4, 0.05, 0.0, STEEL)
    pins = np.linspace(0.5, 2.5, 50)
    both = Rotor("both", [left, Segment(2.0, 0.05, 0.0, STEEL), right])
    modes = solve_lateral_modes(both, [RadialSupport(z, PIN) for z in pins], count=2)
    alone_left = Rotor("left", [left, Segment(2.0, 0.05, 0.0, STEEL)])
    alone_right = Rotor("right", [Segment(2.0, 0.05, 0.0, STEEL), right])
    first = solve_lateral_modes(alone_left, [RadialSupport(z, PIN) for z in pins], count=1)
    second = solve_lateral_modes(alone_right, [RadialSupport(z - 0.5, PIN) for z in pins], count=1)
    np.testing.assert_allclose(modes.frequencies, [first.frequencies[0], second.frequencies[0]], rtol=1e-12)
    np.testing.assert_allclose(np.abs(modes.displacement[0, 0]), np.abs(first.displacement[0, 0]), rtol=1e-10)
    np.testing.assert_allclose(np.abs(modes.displacement[1, -1]), np.abs(second.displacement[0, -1]), rtol=1e-10)


def test_count_holds_at_clamped_subsystem_resonances() -> None:
    # A clamp in the middle makes both halves cantilevers, whose roots are poles of the elimination there.
    half = [Segment(0.25, 0.04, 0.0, STEEL)] * 2
    clamp = [RadialSupport(0.5, PIN, PIN)]
    modes = solve_lateral_modes(Rotor("clamped", half + half), clamp, count=8)
    single = solve_lateral_modes(Rotor("half", half), [RadialSupport(0.5, PIN, PIN)], count=4)
    np.testing.assert_allclose(modes.frequencies, np.repeat(single.frequencies, 2), rtol=1e-12)
    assert_orthonormal_by_energy(modes)


def test_disc_at_a_node_of_the_mode_changes_nothing() -> None:
    bar = Rotor("bar", [Segment(1.0, 0.05, 0.0, STEEL)])
    with_mass = Rotor("bar", [Segment(1.0, 0.05, 0.0, STEEL)], [Disc(0.5, 40.0)])
    ends = [RadialSupport(0.0, PIN), RadialSupport(1.0, PIN)]
    plain = solve_lateral_modes(bar, ends, count=4).frequencies
    loaded = solve_lateral_modes(with_mass, ends, count=4).frequencies
    np.testing.assert_allclose(loaded[1::2], plain[1::2], rtol=1e-12)
    assert (loaded[::2] < 0.9 * plain[::2]).all()


@pytest.mark.parametrize("stiffness", [1e-6, 1.0, 1e6, 1e12, 1e18, 1e24])
def test_any_support_stiffness_keeps_the_digits(stiffness: float) -> None:
    # One spring at the middle of a short bar: from a soft mount, √(k/m), to what cannot be told from a pin.
    bar = Rotor("bar", [Segment(0.5, 0.05, 0.0, STEEL)] * 2)
    modes = solve_lateral_modes(bar, [RadialSupport(0.5, stiffness)], frequency_limit=8000.0)
    assert modes.certificate.complete
    soft = math.sqrt(stiffness / bar.mass)
    if stiffness < 1e3:
        # The rigid bar on its spring, softened by less than k / (modal stiffness).
        assert modes.frequencies[1] == pytest.approx(soft, rel=1e-6)
    # From 1e12 up, the spring is a pin to within modal stiffness / k.
    if stiffness >= 1e12:
        pinned = solve_lateral_modes(bar, [RadialSupport(0.5, PIN)], frequency_limit=8000.0)
        np.testing.assert_allclose(modes.frequencies, pinned.frequencies, rtol=1e9 / stiffness + 1e-12)


def test_torsion_with_a_station_that_is_a_node() -> None:
    # Two equal discs on a symmetric massless shaft, twisting against each other: ω² = 2 k/J.
    spring = ShaftMaterial(211e9, 81.2e9, 0.0)
    discs = [Disc(0.0, 1.0, 0.02), Disc(1.0, 1.0, 0.02)]
    modes = solve_torsional_modes(Rotor("dumb-bell", [Segment(0.5, 0.03, 0.0, spring)] * 2, discs))
    stiffness = 81.2e9 * math.pi * 0.03**4 / 32
    np.testing.assert_allclose(modes.frequencies, [0.0, math.sqrt(2 * stiffness / 0.02)], rtol=1e-12)
    np.testing.assert_allclose(modes.angle[1, 1], 0.0, atol=1e-12)


def test_torsional_chain_with_an_inertialess_joint() -> None:
    # Springs in series around a zero inertia act as one.
    joint = solve_torsional_chain([2.0, 0.0, 3.0], [100.0, 300.0])
    np.testing.assert_allclose(joint.frequencies, [0.0, math.sqrt(75.0 * (1 / 2 + 1 / 3))], rtol=1e-12)


def test_rod_with_end_disc_against_its_transcendental_equation() -> None:
    # Free rod with a disc: tan(λ) = −(J_disc/J_rod) λ, λ = ω L/c.
    rod = Segment(1.2, 0.04, 0.0, STEEL)
    ratio = 0.7
    modes = solve_torsional_modes(Rotor("r", [rod], [Disc(0.0, 1.0, ratio * rod.polar_inertia)]), count=5)
    speed = math.sqrt(81.2e9 / 7810.0)
    for n, omega in enumerate(modes.frequencies[1:], start=1):
        root = brentq(lambda x: math.sin(x) + ratio * x * math.cos(x), (n - 0.5) * math.pi + 1e-9, n * math.pi)
        assert omega == pytest.approx(root * speed / 1.2, rel=1e-12)


def test_certificate_refuses_what_is_not_a_mode_set() -> None:
    frequencies = np.array([1.0, 2.0])
    assert certify(3.0, 2, frequencies, np.eye(2), np.diag([1.0, 4.0])).complete
    for expected, mass, stiffness in [
        (3, np.eye(2), np.diag([1.0, 4.0])),  # one mode missing
        (2, np.ones((2, 2)), np.diag([1.0, 4.0])),  # the same shape twice
        (2, np.eye(2), np.diag([1.0, 4.1])),  # a shape with another frequency's energies
    ]:
        with pytest.raises(IncompleteModesError, match=f"of {expected} modes below 3"):
            certify(3.0, expected, frequencies, mass, stiffness)
