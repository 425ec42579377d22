"""Damped, cross-coupled whirl on the exact equations, against an independent finite-element model and closed forms."""

import dataclasses
import math

import numpy as np
import pytest

from gearwhine.rotors import (
    Bearing,
    Disc,
    IncompleteModesError,
    Pedestal,
    RadialSupport,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    campbell,
    critical_speeds,
    rest_frequencies,
    solve_lateral_modes,
    solve_whirl,
)
from gearwhine.rotors.analyses.critical_speeds import critical_speed_map
from gearwhine.rotors.whirl.circular_coordinates import coupled_motions
from gearwhine.rotors.whirl.completeness import certified_roots, count_roots, oscillating
from gearwhine.rotors.whirl.eigenvalues import constant_speed, refine_roots
from gearwhine.rotors.whirl.equations import whirl_equations, whirl_reach

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
ZERO = np.zeros((2, 2))
SHAFT = Rotor(
    "s",
    [Segment(0.3, 0.05, 0.0, STEEL), Segment(0.4, 0.06, 0.02, STEEL), Segment(0.2, 0.04, 0.0, STEEL)],
    [Disc(0.3, 12.0, 0.09, 0.05), Disc(0.9, 5.0, 0.04, 0.022)],
)
# A ball bearing's form: radial, axial and tilting stiffness with all couplings of two contact lines.
ROW = 1e8 * np.array(
    [
        [1.0, 0.05, 0.3, 0.002, -0.01],
        [0.05, 0.8, 0.1, 0.008, 0.003],
        [0.3, 0.1, 0.6, 0.001, 0.002],
        [0.002, 0.008, 0.001, 2e-3, 1e-4],
        [-0.01, 0.003, 0.002, 1e-4, 3e-3],
    ]
)


def bearings_of(kind: str) -> list[Bearing]:
    cross = np.array([[2e7, 6e6], [-4e6, 1.5e7]])
    damping = np.array([[9e3, 1e3], [5e2, 7e3]])
    if kind == "cross-coupled":
        return [Bearing("a", 0.05, cross, damping), Bearing("b", 0.75, cross.T, damping)]
    if kind == "pedestals":
        heavy = Pedestal(np.diag([3e7, 2e7]), np.diag([4e3, 2e3]), 15.0)
        bare = Pedestal(np.array([[6e7, 1e6], [1e6, 4e7]]), np.diag([1e3, 1e3]))
        first = Bearing("a", 0.05, cross, damping, pedestal=heavy)
        return [first, Bearing("b", 0.75, cross, damping, pedestal=bare)]
    if kind == "tilting":
        tilt = ROW.copy()
        tilt[2, [0, 1, 3, 4]] = tilt[[0, 1, 3, 4], 2] = 0.0
        return [Bearing("a", 0.05, tilt, 1e-5 * tilt), Bearing("b", 0.75, tilt, ZERO)]
    if kind == "five motions":
        heavy = Pedestal(np.diag([3e8, 2e8]), np.diag([4e3, 2e3]), 15.0)
        return [Bearing("a", 0.05, ROW, 2e-5 * ROW, pedestal=heavy), Bearing("b", 0.75, 0.5 * ROW, ZERO)]
    return [Bearing.isotropic("a", 0.05, 2e7, 3e3), Bearing.isotropic("b", 0.75, 1e7, 2e3)]


def test_double_and_nearly_double_roots_keep_all_digits() -> None:
    supports = [bearing.mean_support for bearing in bearings_of("isotropic")]
    planar = solve_lateral_modes(SHAFT, supports, count=6).frequencies
    for split in (0.0, 1e-10, 1e-7, 1e-4):
        # A nearly isotropic bearing, turned so that neither plane is its own.
        turn = np.array([[0.6, -0.8], [0.8, 0.6]])
        bearings = [
            Bearing(b.name, b.at, turn @ (b.radial_stiffness * np.diag([1.0, 1.0 + split])) @ turn.T, ZERO)
            for b in bearings_of("isotropic")
        ]
        modes = solve_whirl(
            SHAFT,
            [dataclasses.replace(b, stiffness=0.5 * (b.stiffness + b.stiffness.T)) for b in bearings],
            0.0,
            count=12,
        )
        assert modes.certificate.method == "inertia"
        stiff = [dataclasses.replace(s, stiffness=s.stiffness * (1.0 + split)) for s in supports]
        upper = solve_lateral_modes(SHAFT, stiff, count=6).frequencies
        np.testing.assert_allclose(modes.frequencies, np.sort(np.concatenate([planar, upper])), rtol=5e-13)


@pytest.mark.parametrize("excess", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_forward_and_backward_whirl_that_coalesce(excess: float) -> None:
    # [[m + d, κ], [−κ, m − d]] has the principal stiffnesses m ± √(d² − κ²): one, with one shape, at κ = d. Bearings
    # alike have the same axes, so each is a planar problem of its own.
    mean, half = 1.5e7, 5e6
    kappa = half * (1.0 - excess)
    matrix = np.array([[mean + half, kappa], [-kappa, mean - half]])
    bearings = [Bearing("a", 0.05, matrix, ZERO), Bearing("b", 0.75, matrix, ZERO)]
    modes = solve_whirl(SHAFT, bearings, 0.0, count=8)
    part = half * math.sqrt(excess * (2.0 - excess))
    planar = [
        solve_lateral_modes(SHAFT, [RadialSupport(at, mean + sign * part) for at in (0.05, 0.75)], count=4).frequencies
        for sign in (1.0, -1.0)
    ]
    # κ itself is rounded: what parts the pair is known to the root of that.
    known = 3e-15 / math.sqrt(max(excess, 1e-15))
    np.testing.assert_allclose(modes.frequencies, np.sort(np.concatenate(planar)), rtol=max(1e-11, 10.0 * known))
    assert modes.certificate.complete


@pytest.mark.parametrize("speed", [0.0, 400.0, -400.0])
def test_gyroscopic_overhung_disc(speed: float) -> None:
    # A disc at the tip of a massless cantilever: det(S − ω² diag(m, I_d) + ω Ω diag(0, I_p)) = 0 with the inverse S of
    # the tip's compliance [[l³/3EI + l/κGA, l²/2EI], [l²/2EI, l/EI]].
    light = ShaftMaterial(211e9, 81.2e9, 0.0)
    mass, polar, diametral, length = 15.0, 0.4, 0.22, 0.4
    shaft = Rotor("overhung", [Segment(length, 0.04, 0.0, light)], [Disc(length, mass, polar, diametral)])
    clamp = np.diag([1e15, 1e15, 0.0, 1e14, 1e14])
    part = shaft.segments[0].section(0.0)
    ei, ga = part.bending_stiffness, part.shear_stiffness
    tip = np.linalg.inv(
        [[length**3 / (3 * ei) + length / ga, length**2 / (2 * ei)], [length**2 / (2 * ei), length / ei]]
    )
    # (s₁₁ − mω²)(s₂₂ − I_d ω² + I_p Ω ω) − s₁₂² = 0, all four roots: negative ones are backward whirl.
    quartic = np.polysub(np.polymul([-mass, 0.0, tip[0, 0]], [-diametral, polar * speed, tip[1, 1]]), [tip[0, 1] ** 2])
    expected = np.sort(np.abs(np.roots(quartic).real))
    modes = solve_whirl(shaft, [Bearing("clamp", 0.0, clamp, np.zeros((5, 5)))], speed)
    np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-7)
    assert modes.certificate.method == "inertia"
    assert modes.certificate.complete


def test_certificate_catches_a_removed_root_and_the_search_finds_it() -> None:
    for kind in ("isotropic", "cross-coupled", "undamped"):
        bearings = bearings_of(kind)
        if kind == "undamped":
            bearings = [Bearing(b.name, b.at, np.diag([2e7, 1e7]), ZERO) for b in bearings]
        speed, limit = 900.0, 5000.0
        modes = solve_whirl(SHAFT, bearings, speed, frequency_limit=limit)
        for blocks in coupled_motions(bearings):
            chain = whirl_equations(SHAFT, bearings, blocks, whirl_reach(1.2 * limit, speed))
            turning, sector = constant_speed(speed), oscillating(1e-2, limit)
            roots = refine_roots(chain, modes.eigenvalues, turning)
            roots = roots.take(sector.holds(roots.eigenvalues))
            undriven = kind == "undamped"
            assert count_roots(chain, turning, sector, undriven) == roots.eigenvalues.size
            # Both counts agree where both can be had.
            assert count_roots(chain, turning, sector, False) == roots.eigenvalues.size
            for lost in ([0], [1, 2], list(range(roots.eigenvalues.size))):
                kept = roots.take(np.setdiff1d(np.arange(roots.eigenvalues.size), lost))
                found, proof = certified_roots(chain, kept, turning, sector, undriven)
                assert proof.complete
                same = np.abs(found.eigenvalues[:, None] - roots.eigenvalues).min(axis=0)
                np.testing.assert_array_less(same, 1e-11 * np.abs(roots.eigenvalues))


def test_a_root_too_many_is_refused() -> None:
    bearings = bearings_of("cross-coupled")
    chain = whirl_equations(SHAFT, bearings, (1, -1), whirl_reach(6000.0, 900.0))
    turning, sector = constant_speed(900.0), oscillating(1e-2, 3000.0)
    modes = solve_whirl(SHAFT, bearings, 900.0, frequency_limit=3000.0)
    roots = refine_roots(chain, modes.eigenvalues, turning)
    twice = roots.joined(roots.take(np.array([0])))
    with pytest.raises(IncompleteModesError, match="exact equations have"):
        certified_roots(chain, twice, turning, sector, False)


def test_campbell_is_solve_whirl_at_every_speed_and_crosses_at_critical_speeds() -> None:
    for kind in ("isotropic", "cross-coupled"):
        bearings = bearings_of(kind)
        speeds = np.linspace(0.0, 1500.0, 16)
        diagram = campbell(SHAFT, bearings, speeds, count=8)
        assert diagram.proved[0]
        assert diagram.proved[-1]
        for k in (0, 7, 15):
            direct = solve_whirl(SHAFT, bearings, float(speeds[k]), count=8)
            mine = diagram.eigenvalues[k][np.isfinite(diagram.eigenvalues[k])]
            mine = mine[np.argsort(np.abs(mine))][:8]
            np.testing.assert_allclose(np.abs(mine), direct.frequencies, rtol=1e-11)
        for crossing in diagram.crossings(1.0):
            modes = solve_whirl(SHAFT, bearings, crossing.speed, count=10)
            assert np.abs(modes.eigenvalues - crossing.eigenvalue).min() < 1e-9 * crossing.speed
            assert crossing.eigenvalue.imag == pytest.approx(crossing.speed, rel=1e-10)


def test_undamped_crossings_are_the_critical_speeds() -> None:
    bearings = [Bearing(b.name, b.at, np.diag([2e7, 1e7]), ZERO) for b in bearings_of("isotropic")]
    expected = critical_speeds(SHAFT, bearings, speed_limit=2500.0)
    assert expected.certificate.complete
    diagram = campbell(SHAFT, bearings, np.linspace(10.0, 2500.0, 40), frequency_limit=2600.0)
    assert diagram.proved.all()
    found = diagram.crossings()
    np.testing.assert_allclose([c.speed for c in found], expected.speeds, rtol=1e-9)
    np.testing.assert_allclose([c.direction for c in found], expected.direction, atol=1e-7)


def test_tables_over_speed_are_followed() -> None:
    table = np.array([1e7 * np.eye(2), 3e7 * np.eye(2), 5e7 * np.eye(2)])
    speeds = np.array([0.0, 1000.0, 2000.0])
    tabled = [Bearing(n, at, table, ZERO, speeds=speeds) for n, at in (("a", 0.05), ("b", 0.75))]
    diagram = campbell(SHAFT, tabled, np.linspace(0.0, 2000.0, 30), count=6)
    for k in (0, 11, 29):
        fixed = [b.at_speed(float(diagram.speeds[k])) for b in tabled]
        direct = solve_whirl(SHAFT, fixed, float(diagram.speeds[k]), count=6).frequencies
        mine = np.sort(diagram.frequencies[k][np.isfinite(diagram.frequencies[k])])[:6]
        np.testing.assert_allclose(mine, direct, rtol=1e-11)
    found = critical_speeds(SHAFT, tabled, speed_limit=1900.0)
    assert found.speeds.size > 0
    for speed in found.speeds:
        at = solve_whirl(SHAFT, tabled, float(speed), count=8).frequencies
        assert np.abs(at / speed - 1.0).min() < 1e-9
    assert rest_frequencies(SHAFT, tabled, count=4).certificate.complete
    with pytest.raises(RotorError, match="a speed in its table"):
        solve_whirl(SHAFT, tabled, 2500.0)


def test_critical_speed_map_joins_free_and_pinned_shaft() -> None:
    bearings = bearings_of("isotropic")
    chart = critical_speed_map(SHAFT, bearings, [1e5, 1e7, 1e13], count=3)
    for k, stiffness in enumerate(chart.stiffnesses):
        held = [Bearing.isotropic(b.name, b.at, float(stiffness)) for b in bearings]
        np.testing.assert_allclose(chart.speeds[k], critical_speeds(SHAFT, held).forward[:3], rtol=1e-10)
    assert (np.diff(chart.speeds, axis=0) > 0.0).all()
    # On soft bearings the lowest two are a rigid body's: √(eig of stiffness over mass) at I_d − I_p.
    mass, centre = SHAFT.mass, SHAFT.centre_of_mass
    tilt = sum(d.diametral_inertia + d.mass * (d.at - centre) ** 2 for d in SHAFT.discs) - SHAFT.polar_inertia
    for part, left in zip(SHAFT.segments, SHAFT.joints[:-1], strict=True):
        tilt += part.diametral_inertia + part.mass * (left + part.mass_centre - centre) ** 2
    arms = np.array([b.at - centre for b in bearings])
    stiff = 1e5 * np.array([[2.0, arms.sum()], [arms.sum(), (arms**2).sum()]])
    rigid = np.sqrt(np.linalg.eigvals(np.diag([1 / mass, 1 / tilt]) @ stiff))
    np.testing.assert_allclose(chart.speeds[0, :2], np.sort(rigid), rtol=1e-2)
    for wrong, message in (
        ({"stiffnesses": [0.0]}, "stiffnesses"),
        ({"stiffnesses": [1e6], "direction": 0}, "direction"),
    ):
        with pytest.raises(RotorError, match=message):
            critical_speed_map(SHAFT, bearings, **wrong)
