"""Whirl of a rigid rotor on two bearings, where every root is a quadratic; and what a basis must not change."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.rotors import (
    Bearing,
    Disc,
    RadialSupport,
    Rotor,
    RotorError,
    Segment,
    ShaftMaterial,
    critical_speeds,
    rest_frequencies,
    solve_lateral_modes,
    solve_whirl,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

# A shaft without mass, stiff enough that a force of the bearings' size bends it by 1e-11 of their deflection.
RIGID = ShaftMaterial(2e20, 8e19, 0.0)
STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
MASS, POLAR, DIAMETRAL, STIFFNESS, HALF = 30.0, 0.5, 0.8, 4e6, 0.25


def rigid_rotor(polar: float = POLAR) -> Rotor:
    shaft = [Segment(0.25, 0.2, 0.0, RIGID)] * 2
    return Rotor("rigid", shaft, [Disc(HALF, MASS, polar, DIAMETRAL)])


def pair(stiffness: np.ndarray, damping: np.ndarray) -> list[Bearing]:
    return [Bearing(name, z, stiffness, damping) for name, z in (("left", 0.0), ("right", 2 * HALF))]


def isotropic(damping: float = 0.0) -> list[Bearing]:
    return pair(STIFFNESS * np.eye(2), damping * np.eye(2))


@pytest.mark.parametrize("speed", [0.0, 300.0, -300.0, 5000.0])
def test_cylindrical_and_conical_whirl(speed: float) -> None:
    # I_t ω² ∓ I_p Ω ω − 2 k a² = 0, upper sign counter-clockwise; the cylindrical pair is at √(2k/m).
    modes = solve_whirl(rigid_rotor(), isotropic(), speed)
    tilt, gyro = 2 * STIFFNESS * HALF**2, POLAR * speed
    forward = (gyro + math.sqrt(gyro**2 + 4 * DIAMETRAL * tilt)) / (2 * DIAMETRAL)
    backward = (-gyro + math.sqrt(gyro**2 + 4 * DIAMETRAL * tilt)) / (2 * DIAMETRAL)
    cylinder = math.sqrt(2 * STIFFNESS / MASS)
    np.testing.assert_allclose(modes.frequencies, np.sort([cylinder, cylinder, forward, backward]), rtol=1e-8)
    np.testing.assert_allclose(modes.damping_ratios, 0.0, atol=1e-10)
    if speed:
        directions = dict(zip(np.round(modes.frequencies, 3), np.round(modes.direction, 6), strict=True))
        assert directions[round(float(modes.frequencies[np.argmin(abs(modes.frequencies - forward))]), 3)] == 1.0
        assert directions[round(float(modes.frequencies[np.argmin(abs(modes.frequencies - backward))]), 3)] == -1.0


def test_damped_whirl() -> None:
    # m s² + 2 c s + 2 k = 0 and I_t s² + (2 c a² ∓ i I_p Ω) s + 2 k a² = 0.
    damping, speed = 2000.0, 400.0
    modes = solve_whirl(rigid_rotor(), isotropic(damping), speed)
    roots = list(np.roots([MASS, 2 * damping, 2 * STIFFNESS])) * 2
    for sign in (1, -1):
        conical = [DIAMETRAL, 2 * damping * HALF**2 + sign * 1j * POLAR * speed, 2 * STIFFNESS * HALF**2]
        roots += list(np.roots(conical))
    expected = np.array([root for root in roots if root.imag > 0])
    expected = expected[np.argsort(np.abs(expected))]
    found = modes.eigenvalues
    np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=1e-8)
    np.testing.assert_allclose(np.sort(found.real), np.sort(expected.real), rtol=1e-7)
    np.testing.assert_allclose(modes.damping_ratios, -found.real / np.abs(found), rtol=1e-12)
    np.testing.assert_allclose(modes.damped_frequencies, found.imag)


def test_cross_coupled_stiffness_drives_forward_whirl_unstable() -> None:
    # With k_xy = −k_yx = κ, r = x + i y obeys m s² + 2 k − 2 i κ = 0: forward whirl grows.
    kappa = 1e5
    cross = np.array([[STIFFNESS, kappa], [-kappa, STIFFNESS]])
    bearings = pair(cross, np.zeros((2, 2)))
    modes = solve_whirl(rigid_rotor(polar=0.0), bearings, 0.0)
    root = np.sqrt(complex(-2 * STIFFNESS, 2 * kappa) / MASS)
    lowest = modes.eigenvalues[np.argsort(np.abs(modes.eigenvalues))[:2]]
    np.testing.assert_allclose(np.sort(lowest.real), [-abs(root.real), abs(root.real)], rtol=1e-8)
    np.testing.assert_allclose(lowest.imag, abs(root.imag), rtol=1e-8)
    unstable = modes.direction[np.argmin(modes.damping_ratios)]
    assert unstable == pytest.approx(1.0, abs=1e-8)
    assert rest_frequencies(rigid_rotor(), bearings).frequencies[0] == pytest.approx(abs(root.imag), rel=1e-8)


def test_symmetric_cross_stiffness_turns_the_principal_axes() -> None:
    # A bearing turned by 30° has the frequencies of the bearing not turned.
    turn = np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
    own = np.diag([4e6, 2e6])
    shaft = Rotor("s", [Segment(0.3, 0.04, 0.0, STEEL)] * 3, [Disc(0.3, 10.0, 0.05, 0.03)])
    straight = rest_frequencies(shaft, pair(own, np.zeros((2, 2))), count=8)
    turned = rest_frequencies(shaft, pair(turn @ own @ turn.T, np.zeros((2, 2))), count=8)
    np.testing.assert_allclose(turned.frequencies, straight.frequencies, rtol=1e-6)
    assert straight.certificate.complete


def test_critical_speeds_of_the_rigid_rotor() -> None:
    # Cylindrical √(2k/m) twice; conical √(2 k a²/(I_t − I_p)) forward and √(2 k a²/(I_t + I_p)) backward.
    found = critical_speeds(rigid_rotor(), isotropic())
    tilt, cylinder = 2 * STIFFNESS * HALF**2, math.sqrt(2 * STIFFNESS / MASS)
    forward, backward = math.sqrt(tilt / (DIAMETRAL - POLAR)), math.sqrt(tilt / (DIAMETRAL + POLAR))
    np.testing.assert_allclose(found.speeds, np.sort([cylinder, cylinder, forward, backward]), rtol=1e-8)
    assert found.direction[np.argmin(abs(found.speeds - forward))] == pytest.approx(1.0)
    assert found.direction[np.argmin(abs(found.speeds - backward))] == pytest.approx(-1.0)
    assert not np.isclose(found.forward, backward).any()
    # A thin disc, I_p > I_t, has no forward conical critical speed.
    thin = critical_speeds(rigid_rotor(polar=1.2), isotropic())
    np.testing.assert_allclose(thin.speeds, [math.sqrt(tilt / 2.0), cylinder, cylinder], rtol=1e-8)
    # Nor in bearings that drive it. With k_xy = −k_yx = k/10 the backward conical whirl λ = a + iΩ grows,
    # I_t λ² + i I_p Ω λ + 2 k a² (1 − i/10) = 0: (I_t + I_p) Ω⁴ − 2 k a² Ω² − I_t (2 k a² / (20 I_t + 10 I_p))² = 0.
    driving = STIFFNESS * np.array([[1.0, 0.1], [-0.1, 1.0]])
    polar = 1.2
    quartic = [DIAMETRAL + polar, -tilt, -DIAMETRAL * (0.1 * tilt / (2.0 * DIAMETRAL + polar)) ** 2]
    conical = math.sqrt(np.roots(quartic).max())
    expected = [conical, *[math.sqrt(STIFFNESS * 2.0 / MASS) * np.sqrt(1.0 + 0.1j).real] * 2]
    constant = pair(driving, np.zeros((2, 2)))
    np.testing.assert_allclose(critical_speeds(rigid_rotor(polar=polar), constant).speeds, expected, rtol=1e-8)
    # The same numbers as a table over speed are the same bearing.
    speeds = np.array([0.0, 1000.0])
    tabled = [replace(b, stiffness=[b.stiffness] * 2, damping=[b.damping] * 2, speeds=speeds) for b in constant]
    np.testing.assert_allclose(critical_speeds(rigid_rotor(polar=polar), tabled).speeds, expected, rtol=1e-8)


def test_attached_loads_make_static_compliance_exact() -> None:
    # Pinned bar under a mid-span force: L³/48EI + L/4κGA; the modes alone fall short of it.
    bar = Segment(0.5, 0.08, 0.0, STEEL)
    pins = [RadialSupport(0.0, math.inf), RadialSupport(1.0, math.inf)]
    modes = solve_lateral_modes(Rotor("bar", [bar] * 2), pins, count=3)
    exact = 1.0 / (48 * bar.section(0.5).bending_stiffness) + 1.0 / (4 * bar.section(0.5).shear_stiffness)

    def compliance(set_of_modes: object) -> float:
        shape = set_of_modes.evaluate([0.5])[0][:, 0]  # type: ignore[attr-defined]
        return float((shape**2 / set_of_modes.frequencies**2).sum())  # type: ignore[attr-defined]

    attached = add_attachment_modes(modes, forces_at=[0.5], moments_at=[0.25])
    assert compliance(modes) < 0.999 * exact
    assert compliance(attached) == pytest.approx(exact, rel=1e-10)
    np.testing.assert_array_equal(attached.frequencies[:3], modes.frequencies)
    np.testing.assert_allclose(attached.displacement[:3], modes.displacement, atol=1e-12)
    # Loads that add nothing new add no vectors.
    again = add_attachment_modes(attached, forces_at=[0.5, 0.5, 0.0], moments_at=[0.25])
    assert again.count == attached.count


def test_lumped_rotor_with_all_its_modes_needs_no_attachments() -> None:
    lumped = Rotor("l", [Segment(0.2, 0.04, 0.0, STEEL)] * 3, mass_model="lumped")
    modes = solve_lateral_modes(lumped, [RadialSupport(0.0, 1e6), RadialSupport(0.6, 1e6)])
    assert modes.count == 8
    # Both planes together have sixteen, and no more.
    bearings = [Bearing.isotropic(str(z), z, 1e6) for z in (0.0, 0.6)]
    found = rest_frequencies(lumped, bearings, count=16)
    np.testing.assert_allclose(found.frequencies, np.repeat(modes.frequencies, 2), rtol=1e-12)
    assert found.certificate.complete
    assert rest_frequencies(lumped, bearings).frequencies.size == 12
    with pytest.raises(RotorError, match="at most 16"):
        rest_frequencies(lumped, bearings, count=17)
    assert add_attachment_modes(modes, forces_at=[0.0, 0.6], moments_at=[0.2]).count == 8


def test_free_rotor_keeps_its_rigid_motions_and_whirls() -> None:
    # A free rigid rotor nutates at Ω I_p/I_t, and has no other finite frequency below its bending.
    shaft = Rotor("free", [Segment(0.5, 0.05, 0.0, STEEL)] * 2, [Disc(0.5, 20.0, 3.0, 1.6)])
    free = solve_lateral_modes(shaft, count=4)
    np.testing.assert_array_equal(free.frequencies[:2], 0.0)
    tilt = shaft.segments[0].diametral_inertia * 2 + 2 * shaft.segments[0].mass * 0.25**2 + 1.6
    nutation = 30.0 * shaft.polar_inertia / tilt
    assert solve_whirl(shaft, [], 30.0, count=1).frequencies[0] == pytest.approx(nutation, rel=1e-3)


def test_support_matrix_takes_the_supports_out_again() -> None:
    shaft = Rotor("s", [Segment(0.3, 0.04, 0.0, STEEL)] * 3, [Disc(0.3, 10.0, 0.05, 0.03)])
    supports = [RadialSupport(0.1, 3e6), RadialSupport(0.8, 2e6)]
    modes = solve_lateral_modes(shaft, supports, count=12)
    attached = add_attachment_modes(modes, forces_at=[0.1, 0.8])
    without = np.diag(attached.frequencies**2) - attached.support_matrix
    free = solve_lateral_modes(shaft, count=5).frequencies
    found = np.sqrt(np.abs(np.linalg.eigvalsh(without)[:5]))
    np.testing.assert_allclose(found[2:], free[2:], rtol=1e-6)
    assert (found[:2] < 1e-2 * free[2]).all()
