"""Dashpots in couplings: damping ratios by hand, and internal damping that feeds forward whirl above its frequency."""

import math

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling import CoupledMachine, MountedBearing, assemble_machine, coupled_modes
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.shaft_dashpots import ShaftDashpots, internal_damping, shaft_dashpots
from gearwhine.rotors import Bearing, Coupling, Disc, Rotor, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 7850.0)
TORSIONAL, AXIAL, LATERAL = 2e4, 1e7, 4e6
INERTIA = (0.05, 0.03)


def machine(speed: float = 0.0, polar: tuple[float, float] = INERTIA, **damping: float) -> CoupledMachine:
    """Two short thick shafts with a disc each and a soft coupling between them, on a bearing at either end."""
    shaft = Segment(0.1, 0.08, 0.0, STEEL)
    soft = Coupling(0.02, LATERAL, 1e5, TORSIONAL, AXIAL)
    discs = [Disc(0.05, 5.0, polar[0], 0.03), Disc(0.17, 5.0, polar[1], 0.03)]
    rotor = Rotor("train", [shaft, soft, shaft], discs)
    # The left bearing holds the axis as well, so that there are axial modes.
    held = [
        Bearing("left", 0.0, np.diag([1e9, 1e9, 1e12, 0.0, 0.0]), np.zeros((5, 5))),
        Bearing("right", 0.22, np.diag([1e9, 1e9]), np.zeros((2, 2))),
    ]
    component = rotor_component("train", modal_rotor(rotor, held, count=8), start=0.0)
    dashpots = [ShaftDashpots("coupling 1", "train", 0.1, 0.12, **damping)] if damping else []
    bearings = [MountedBearing(bearing, "train", None) for bearing in held]
    return assemble_machine([component], None, speeds={"train": speed}, bearings=bearings, dashpots=dashpots)


def test_torsion_is_damped_as_two_inertias_on_a_spring_and_a_dashpot() -> None:
    """ζ = c ω / 2k of the mode that the coupling makes, J' = J₁ J₂ / (J₁ + J₂)."""
    modes = coupled_modes(machine(torsional=0.3).system)
    shaft = STEEL.density * math.pi / 32.0 * 0.08**4 * 0.1
    one, other = INERTIA[0] + shaft, INERTIA[1] + shaft
    omega = math.sqrt(TORSIONAL * (one + other) / (one * other))
    near = int(np.argmin(np.abs(2.0 * math.pi * modes.frequencies_hz - omega)))
    assert modes.kinds[near] == "torsion"
    assert 2.0 * math.pi * modes.frequencies_hz[near] == pytest.approx(omega, rel=1e-2)
    assert modes.damping_ratios[near] == pytest.approx(0.3 * omega / (2.0 * TORSIONAL), rel=2e-2)
    assert "coupling 1" in [part.name for part in modes.shares.parts]


def test_axial_motion_is_damped_as_a_mass_on_a_spring_and_a_dashpot() -> None:
    modes = coupled_modes(machine(axial=200.0).system)
    mass = 5.0 + STEEL.density * math.pi / 4.0 * 0.08**2 * 0.1
    omega = math.sqrt(AXIAL / mass)
    near = int(np.argmin(np.abs(2.0 * math.pi * modes.frequencies_hz - omega)))
    assert modes.kinds[near] == "axial"
    assert modes.damping_ratios[near] == pytest.approx(200.0 * omega / (2.0 * AXIAL), rel=3e-2)


def test_internal_damping_feeds_forward_whirl_above_its_frequency() -> None:
    """In the turning shaft a whirl at ω is seen at ω - Ω: ζ = ζ₀ (1 - Ω/ω) forward and ζ₀ (1 + Ω/ω) backward."""

    def lowest(speed: float) -> tuple[np.ndarray, np.ndarray]:
        modes = coupled_modes(machine(speed, polar=(1e-5, 1e-5), lateral=100.0).system)
        pair = [i for i, kind in enumerate(modes.kinds) if kind == "rotor"][:2]
        return 2.0 * math.pi * modes.frequencies_hz[pair], modes.damping_ratios[pair]

    (omega, _), (ratio, _) = lowest(0.0)
    assert ratio > 1e-4
    for part in (0.5, 1.0, 1.6):
        _, ratios = lowest(part * omega)
        # The shafts' own gyroscopic moments part the two frequencies a little.
        expected = [ratio * (1.0 - part), ratio * (1.0 + part)]
        np.testing.assert_allclose(np.sort(ratios), expected, atol=0.1 * ratio)


def test_what_circulates_goes_with_the_speed_of_a_run() -> None:
    """Of a machine that runs at 0 to 1.5 of its speed, the ties at any of them are those of a machine of that speed."""
    component = machine().rotors[0]
    given = ShaftDashpots("coupling 1", "train", 0.1, 0.12, lateral=100.0, tilt=20.0)
    _, law = shaft_dashpots(given, component, 300.0, (0.0, 1.5))
    assert law.over_speed is not None
    for rate in (0.0, 0.4, 1.0, 1.5):
        _, there = shaft_dashpots(given, component, 300.0 * rate)
        stiffness, damping = law.over_speed.at(rate)
        np.testing.assert_allclose(stiffness, there.stiffness, atol=1e-9)
        np.testing.assert_allclose(damping, there.damping)


@pytest.mark.parametrize("part", [-2.0, 0.5, 2.99, 3.01])
def test_a_jeffcott_rotor_with_internal_damping_loses_stability_at_the_published_speed(part: float) -> None:
    """λ² + 2 (ζ_e + ζ_i) ω λ + ω² = 2 i ζ_i ω Ω: stable up to Ω = ω (1 + ζ_e / ζ_i), three times ω here."""
    mass, length, diameter, external, internal = 20.0, 1.0, 0.04, 0.02, 0.01
    light = ShaftMaterial.from_poisson_ratio(2.1e11, 0.3, 1.0)
    segment = Segment(length / 2.0, diameter, 0.0, light, shear_coefficient=0.9)
    second_moment, area = math.pi * diameter**4 / 64.0, math.pi * diameter**2 / 4.0
    bending = length**3 / (48.0 * 2.1e11 * second_moment)
    omega = 1.0 / math.sqrt(mass * (bending + length / (4.0 * 0.9 * light.shear_modulus * area)))
    rotor = Rotor("jeffcott", [segment] * 2, [Disc(length / 2.0, mass)])
    dashpot = 2.0 * external * omega * mass * np.eye(2)
    held = [
        *(Bearing.isotropic(f"at {at}", at, 1e12) for at in (0.0, length)),
        Bearing("at the disc", length / 2.0, np.zeros((2, 2)), dashpot),
    ]
    shaft = gw.Shaft(rotor, damping_ratio=0.0, internal_damping=2.0 * internal / omega)
    mounted = [MountedBearing(bearing, "jeffcott", None) for bearing in held]
    modes = gw.Machine([shaft], mounted, speed=part * omega).modes()
    found = modes.eigenvalues[[kind == "rotor" for kind in modes.kinds]][:2]
    equation = [1.0, 2.0 * (external + internal) * omega, omega**2 - 2j * internal * omega * abs(part) * omega]
    expected = np.roots(equation)
    by_damping = np.argsort(expected.real)
    np.testing.assert_allclose(np.sort(found.real), expected.real[by_damping], atol=2e-6 * omega)
    np.testing.assert_allclose(found.imag[np.argsort(found.real)], np.abs(expected.imag[by_damping]), rtol=5e-5)
    assert (found.real.max() > 0.0) == (part > 3.0)


def test_internal_damping_goes_with_the_speed_of_a_run() -> None:
    rotor = Rotor("shaft", [Segment(0.3, 0.03, 0.0, STEEL)])
    held = [Bearing.isotropic(f"at {at}", at, 1e8) for at in (0.0, 0.3)]
    component = rotor_component("shaft", modal_rotor(rotor, held, count=4), start=0.0, internal_damping=1e-5)
    law = internal_damping(component, 300.0, (0.0, 1.5))
    assert law.over_speed is not None
    for rate in (0.0, 0.4, 1.5):
        stiffness, damping = law.over_speed.at(rate)
        expected = internal_damping(component, rate * 300.0, (1.0, 1.0))
        np.testing.assert_allclose(stiffness, expected.stiffness, atol=1e-9 * np.abs(law.stiffness).max())
        np.testing.assert_array_equal(damping, expected.damping)
