"""Shafts under axial force: Euler's and Engesser's buckling loads, the tensioned beam and string in closed form."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from rotors import Coupling, RadialSupport, Rotor, RotorError, Segment, ShaftMaterial, solve_lateral_modes
from rotors.modes.lateral import buckling_factor

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)
LENGTH, DIAMETER = 0.8, 0.04
AREA, MOMENT = math.pi * DIAMETER**2 / 4, math.pi * DIAMETER**4 / 64
BENDING, SHEAR, MASS, ROTARY = 207e9 * MOMENT, 0.9 * 79.6e9 * AREA, 7850.0 * AREA, 7850.0 * MOMENT
PIN, CLAMP = (math.inf, 0.0), (math.inf, math.inf)


def bar(force: float, pieces: int = 3, length: float = LENGTH) -> Rotor:
    segment = Segment(length / pieces, DIAMETER, 0.0, STEEL, 0.9, axial_force=force)
    return Rotor("bar", [segment] * pieces)


def held(left: tuple[float, float], right: tuple[float, float]) -> list[RadialSupport]:
    return [RadialSupport(0.0, *left), RadialSupport(LENGTH, *right)]


def test_pinned_bar_buckles_at_the_load_of_euler_softened_by_shear() -> None:
    # Engesser: P = P_E / (1 + P_E / κGA), P_E = π² EI / L².
    euler = math.pi**2 * BENDING / LENGTH**2
    assert buckling_factor(bar(-1.0), held(PIN, PIN)) == pytest.approx(euler / (1 + euler / SHEAR), rel=1e-10)


def test_clamped_and_cantilever_bars_buckle_as_engesser_says() -> None:
    for ends, wave in (
        (held(CLAMP, CLAMP), 2 * math.pi / LENGTH),
        ([RadialSupport(0.0, *CLAMP)], math.pi / 2 / LENGTH),
    ):
        euler = wave**2 * BENDING
        assert buckling_factor(bar(-1e3), ends) == pytest.approx(euler / (1 + euler / SHEAR) / 1e3, rel=1e-10)


def test_clamped_and_pinned_bar_buckles_at_its_transcendental_root() -> None:
    load = brentq(
        _clamped_pinned, 1.5 * math.pi**2 * BENDING / LENGTH**2, 2.1 * math.pi**2 * BENDING / LENGTH**2, rtol=1e-14
    )
    assert buckling_factor(bar(-1.0), held(CLAMP, PIN)) == pytest.approx(load, rel=1e-9)


def _clamped_pinned(force: float) -> float:
    """Deflection at the pin of a bar clamped at 0, under the reaction r that makes its moment vanish there.

    With P = −force: EI β'' = gPβ − g r, so β = r/P + a cos kz + b sin kz with k² = g·force/EI; β(0) = 0 and β'(L) = 0
    give a = −r/P, b = a tan kL; x(L) = ∫ gβ + r/(κGA + P) dz.
    """
    share, pull = SHEAR / (SHEAR - force), -force
    k = math.sqrt(share * force / BENDING)
    a = -1.0 / pull
    b = a * math.tan(k * LENGTH)
    integral = LENGTH / pull + a * math.sin(k * LENGTH) / k + b * (1 - math.cos(k * LENGTH)) / k
    return (share * integral + LENGTH / (SHEAR + pull)) * math.cos(k * LENGTH)


def test_a_shaft_beyond_buckling_is_refused_with_the_load_that_it_bears() -> None:
    euler = math.pi**2 * BENDING / LENGTH**2
    critical = euler / (1 + euler / SHEAR)
    below = solve_lateral_modes(bar(-0.999999 * critical), held(PIN, PIN), count=2).frequencies
    free = solve_lateral_modes(bar(0.0), held(PIN, PIN), count=2).frequencies
    assert 0.0 < below[0] < 2e-3 * free[0]
    with pytest.raises(RotorError, match=r"buckles at 0\.5 times its axial forces"):
        solve_lateral_modes(bar(-2.0 * critical), held(PIN, PIN), count=2)
    with pytest.raises(RotorError, match="half of its shear stiffness"):
        solve_lateral_modes(bar(-0.6 * SHEAR), held(PIN, PIN), count=2)
    with pytest.raises(RotorError, match="buckles at 0 times"):
        solve_lateral_modes(bar(-1.0), count=2)
    assert buckling_factor(bar(5.0), held(PIN, PIN)) == math.inf


@pytest.mark.parametrize("part", [-0.8, -0.2, 0.5, 20.0, 2000.0])
def test_pinned_bar_under_axial_force(part: float) -> None:
    """x = sin qz and β = B cos qz leave a quadratic in ω², P adding P q² to the translational stiffness.

    ρA ρI ω⁴ − [ρA (EI q² + κGA) + ρI (κGA + P) q²] ω² + (κGA + P) q² (EI q² + κGA) − κGA² q² = 0.
    """
    euler = math.pi**2 * BENDING / LENGTH**2
    force = part * euler
    # Both spectra, with the pure rotation of the sections at n = 0.
    roots = [SHEAR / ROTARY]
    for n in range(1, 13):
        q2 = (n * math.pi / LENGTH) ** 2
        half = (MASS * (BENDING * q2 + SHEAR) + ROTARY * (SHEAR + force) * q2) / 2
        static = SHEAR * BENDING * q2**2 + force * q2 * (BENDING * q2 + SHEAR)
        upper = half + math.sqrt(half**2 - MASS * ROTARY * static)
        roots += [static / upper, upper / (MASS * ROTARY)]
    expected = np.sqrt(np.sort(roots))[:12]
    for pieces in (1, 5):
        modes = solve_lateral_modes(bar(force, pieces), held(PIN, PIN), count=12)
        np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-11)
        assert modes.certificate.complete


def test_tight_wire_is_a_string() -> None:
    # f_n = n/2L √(T/ρA), stiffened by bending to the order d²/L² E A/T.
    diameter, tension = 1e-4, 3.0
    wire = Segment(1.0, diameter, 0.0, STEEL, axial_force=tension)
    ends = [RadialSupport(0.0, *PIN), RadialSupport(1.0, *PIN)]
    modes = solve_lateral_modes(Rotor("wire", [wire]), ends, count=10)
    string = np.arange(1, 11) * math.pi * math.sqrt(tension / (7850.0 * math.pi * diameter**2 / 4))
    stiffer = np.sqrt(1 + (np.arange(1, 11) * math.pi) ** 2 * 207e9 * math.pi * diameter**4 / 64 / tension)
    np.testing.assert_allclose(modes.frequencies, string * stiffer, rtol=1e-6)


def test_tension_holds_a_free_shaft_against_tilting_and_leaves_its_shift_free() -> None:
    # Forces that keep their direction: a rigid free bar of length L tilts at ω² = P L / I.
    force, length = 1e3, 0.2
    rod = bar(force, 2, length)
    modes = solve_lateral_modes(rod, count=3)
    assert modes.frequencies[0] == 0.0
    inertia = rod.mass * (length**2 / 12 + DIAMETER**2 / 16)
    assert modes.frequencies[1] == pytest.approx(math.sqrt(force * length / inertia), rel=2e-5)


def test_force_of_a_part_acts_in_that_part() -> None:
    # Cut by a coupling as soft as a hinge and held beside it, a shaft is two: only the loaded one changes.
    joint = Coupling(1e-3, 1e12, 1e-6, 1e3, 1e6)
    left = Segment(0.4, DIAMETER, 0.0, STEEL, 0.9, axial_force=4e5)
    right = Segment(0.5, DIAMETER, 0.0, STEEL, 0.9)
    ends = [RadialSupport(z, math.inf) for z in (0.0, 0.4, 0.401, 0.901)]
    both = solve_lateral_modes(Rotor("both", [left, joint, right]), ends, count=6).frequencies
    alone = [
        solve_lateral_modes(Rotor("one", [part]), [RadialSupport(0.0, math.inf), RadialSupport(z, math.inf)], count=5)
        for part, z in ((left, 0.4), (right, 0.5))
    ]
    merged = np.sort(np.concatenate([modes.frequencies for modes in alone]))
    np.testing.assert_allclose(both, merged[: both.size], rtol=1e-8)
