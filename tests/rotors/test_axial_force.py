"""Shafts under axial force: Euler's and Engesser's buckling loads, the tensioned beam and string in closed form."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.rotors import (
    Bearing,
    Coupling,
    Disc,
    RadialSupport,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    Unbalance,
    solve_lateral_modes,
    solve_whirl,
    static_deflection,
    unbalance_response,
)
from gearwhine.rotors.model.loads import Bow
from gearwhine.rotors.modes.lateral import buckling_factor

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


# Without mass, and so stiff that it moves as a rigid body.
RIGID = ShaftMaterial(2e20, 8e19, 0.0)


@pytest.mark.parametrize("part", [-0.9, -0.3, 0.6, 20.0])
def test_a_stiff_coupling_is_a_link_that_the_force_turns(part: float) -> None:
    """A mass on a coupling that hardly tilts: ω² = (k + P / L) / m, and none is left where −P = k L."""
    length, lateral, mass = 0.1, 3e6, 5.0
    coupling = Coupling(length, lateral, 1e10, 1e4, 1e6, axial_force=part * lateral * length)
    rotor = Rotor("link", [coupling], [Disc(length, mass)])
    held_left = [RadialSupport(0.0, *CLAMP)]
    modes = solve_lateral_modes(rotor, held_left, count=1)
    assert modes.frequencies[0] == pytest.approx(math.sqrt((1.0 + part) * lateral / mass), rel=2e-5)
    assert buckling_factor(rotor, held_left) == pytest.approx(-1.0 / part if part < 0.0 else math.inf, rel=2e-6)
    # Between two such couplings, of which one carries no force.
    row = Rotor("links", [coupling, Coupling(length, lateral, 1e10, 1e4, 1e6)], [Disc(length, mass)])
    modes = solve_lateral_modes(row, [*held_left, RadialSupport(2.0 * length, *CLAMP)], count=1)
    assert modes.frequencies[0] == pytest.approx(math.sqrt((2.0 + part) * lateral / mass), rel=2e-5)


@pytest.mark.parametrize("shear_over_euler", [1e6, 3.0, 0.2])
def test_rigid_shafts_on_a_coupling_buckle_as_its_bending_and_shear_let_them(shear_over_euler: float) -> None:
    """Two rigid shafts of length a, pinned at their outer ends: k_t L q = P a tan(qL / 2), q² = g P / (k_t L).

    Between clamped ends the same coupling buckles at qL = 2π. With 0.2 the load is more than half of kL.
    """
    a, length, tilt = 0.2, 0.3, 1e4
    bending = tilt * length
    shear = shear_over_euler * math.pi**2 * bending / length**2

    def moment(load: float) -> float:
        wave = math.sqrt(shear / (shear - load) * load / bending)
        return bending * wave * math.cos(0.5 * wave * length) - load * a * math.sin(0.5 * wave * length)

    def engesser(phase: float) -> float:
        euler = bending * (phase / length) ** 2
        return euler / (1.0 + euler / shear)

    expected = brentq(moment, 1e-6 * engesser(math.pi), engesser(math.pi), rtol=1e-14)
    bar = Segment(a, 0.2, 0.0, RIGID, axial_force=-1.0)
    coupling = Coupling(length, shear / length, tilt, 1e4, 1e6, axial_force=-1.0)
    rotor = Rotor("pair", [bar, coupling, bar], [Disc(a, 1.0)])
    pins = [RadialSupport(0.0, math.inf), RadialSupport(2.0 * a + length, math.inf)]
    assert buckling_factor(rotor, pins) == pytest.approx(expected, rel=1e-8)
    clamped = [RadialSupport(at, *CLAMP) for at in (a, a + length)]
    assert buckling_factor(rotor, clamped) == pytest.approx(engesser(2.0 * math.pi), rel=1e-8)


def of_three(middle: Segment | Coupling, force: float) -> Rotor:
    """A shaft with a thinner middle piece, which is a coupling or a segment without mass."""
    outer = Segment(0.2, 0.03, 0.0, STEEL, axial_force=force)
    return Rotor("three", [outer, middle, outer], [Disc(0.15, 2.0, 0.004, 0.003)])


@pytest.mark.parametrize("force", [-2e4, 2e4, 5e6])
def test_a_coupling_under_axial_force_is_a_massless_segment_of_its_stiffness(force: float) -> None:
    """Modes, buckling, whirl, unbalance with a bow and deflection of a coupling with κGA = kL and EI = k_t L."""
    light = Segment(0.3, 0.02, 0.0, ShaftMaterial(207e9, 79.6e9, 0.0), axial_force=force)
    section = light.section(0.5)
    stiffnesses = (
        section.shear_stiffness, section.bending_stiffness, section.torsional_stiffness, section.axial_stiffness
    )  # fmt: skip
    coupling = Coupling(0.3, *(value / 0.3 for value in stiffnesses), axial_force=force)
    one, other = of_three(coupling, force), of_three(light, force)
    supports = [RadialSupport(0.0, 4e7), RadialSupport(0.7, 4e7)]
    found, expected = (solve_lateral_modes(rotor, supports, count=6) for rotor in (one, other))
    np.testing.assert_allclose(found.frequencies, expected.frequencies, rtol=1e-11)
    z = np.linspace(0.0, 0.7, 15)
    np.testing.assert_allclose(found.evaluate(z)[0], expected.evaluate(z)[0], atol=1e-8)
    assert buckling_factor(one, supports) == pytest.approx(buckling_factor(other, supports), rel=1e-11)

    bearings = [Bearing(f"at {at}", at, np.diag([3e7, 5e7]), 200.0 * np.eye(2)) for at in (0.0, 0.7)]
    whirls = [solve_whirl(rotor, bearings, 400.0, count=4).eigenvalues for rotor in (one, other)]
    np.testing.assert_allclose(whirls[0], whirls[1], rtol=1e-10)
    bow = Bow(np.array([0.0, 0.35, 0.7]), np.array([0.0, 2e-5, 0.0]), np.array([0.0, 0.4, 0.0]))
    answers = [
        unbalance_response(rotor, bearings, [Unbalance(0.5, 1e-4)], [200.0, 500.0], bow=bow) for rotor in (one, other)
    ]
    assert answers[0].bow is not None
    assert answers[1].bow is not None
    assert answers[0].bow.strain_energy == pytest.approx(answers[1].bow.strain_energy, rel=1e-9)
    for reading, wanted in zip(*(answer.reading(z) for answer in answers), strict=True):
        np.testing.assert_allclose(reading, wanted, atol=1e-9 * np.abs(wanted).max())
    sags = [static_deflection(rotor, bearings, gravity=(0.0, -9.81, 0.0)).evaluate(z)[1] for rotor in (one, other)]
    np.testing.assert_allclose(sags[0], sags[1], atol=1e-10 * np.abs(sags[1]).max())


def test_the_bow_of_a_coupled_shaft_is_bent_without_its_axial_force() -> None:
    """The strain energy of a bow is that of the shaft without force, whatever it carries."""
    shaft = Segment(0.2, 0.03, 0.0, STEEL)
    coupling = Coupling(0.3, 1e7, 4e3, 1e4, 1e6)
    bow = Bow(np.array([0.0, 0.35, 0.7]), np.array([0.0, 2e-5, 0.0]), np.zeros(3))
    bearings = [Bearing.isotropic(f"at {at}", at, 5e7) for at in (0.0, 0.7)]
    energies = []
    for force in (0.0, 3e4):
        loaded = Coupling(*(getattr(coupling, name) for name in ("length", "lateral_stiffness", "tilt_stiffness")),
                          1e4, 1e6, axial_force=force)  # fmt: skip
        answer = unbalance_response(Rotor("bent", [shaft, loaded, shaft]), bearings, [], [200.0], bow=bow)
        assert answer.bow is not None
        energies.append(answer.bow.strain_energy)
    assert energies[0] == energies[1] > 0.0


def test_a_shaft_whose_coupling_buckles_is_refused() -> None:
    """Shafts of 30 mm pinned outside, on a coupling of 20 mm, buckle at 40.5 kN; clamped, it does at 4 π² EI / L²."""
    euler = math.pi**2 * 207e9 * math.pi * 0.02**4 / 64 / 0.3**2
    coupling = Coupling(0.3, 7e7, 207e9 * math.pi * 0.02**4 / 64 / 0.3, 1e4, 1e6)
    ends = [RadialSupport(0.0, math.inf), RadialSupport(0.7, math.inf)]
    for force, message in ((-4.5e4, r"buckles at 0\.[89]\d+ times"), (-4.1 * euler, r"buckles at 0\.\d+ times")):
        pushed = Coupling(0.3, 7e7, coupling.tilt_stiffness, 1e4, 1e6, axial_force=force)
        with pytest.raises(RotorError, match=message):
            solve_lateral_modes(of_three(pushed, force), ends, count=2)
    with pytest.raises(RotorError, match=r"coupling axial_force is .* expected a compression below \d+ N"):
        _ = of_three(Coupling(0.3, 7e7, coupling.tilt_stiffness, 1e4, 1e6, axial_force=-4.1 * euler), 0.0).profile
    with pytest.raises(RotorError, match="coupling: axial_force is nan"):
        Coupling(0.3, 7e7, 1e4, 1e4, 1e6, axial_force=math.nan)
