"""Couplings in a row of segments: rigid rotors joined by springs, whose roots are quadratics."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from gearwhine.rotors import (
    AxisSpring,
    Coupling,
    Disc,
    RadialSupport,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
    torsional_response,
)
from gearwhine.rotors.analyses.torsional_response import Torque
from gearwhine.rotors.modes.torsional_and_axial import solve_torsional_chain
from gearwhine.rotors.transfer_matrix.rotor_shafts import axial_shaft_on, discretised_bending_shaft
from gearwhine.rotors.transfer_matrix.wittrick_williams import lowest_natural_frequencies

STEEL = ShaftMaterial(207e9, 79.6e9, 7850.0)
# Without mass, and so stiff that it moves as a rigid body.
RIGID = ShaftMaterial(2e20, 8e19, 0.0)


@pytest.mark.parametrize("mass_model", ["distributed", "lumped"])
def test_two_rigid_rotors_on_a_coupling(mass_model: str) -> None:
    """Torsion and axial motion of two discs and half the coupling each: ω² = k (1/m₁ + 1/m₂)."""
    coupling = Coupling(0.05, 3e7, 2e4, 4e4, 5e6, mass=2.0, polar_inertia=0.01, diametral_inertia=0.008)
    bar = Segment(0.1, 0.2, 0.0, RIGID)
    discs = [Disc(0.0, 5.0, 0.1, 0.06), Disc(0.25, 8.0, 0.2, 0.12)]
    rotor = Rotor("pair", [bar, coupling, bar], discs, mass_model=mass_model)  # type: ignore[arg-type]
    assert rotor.mass == pytest.approx(15.0)
    twist = solve_torsional_modes(rotor, count=2)
    np.testing.assert_allclose(twist.frequencies, [0, math.sqrt(4e4 * (1 / 0.105 + 1 / 0.205))], rtol=1e-8)
    axial = solve_axial_modes(rotor, count=2)
    np.testing.assert_allclose(axial.frequencies, [0, math.sqrt(5e6 * (1 / 6 + 1 / 9))], rtol=1e-8)
    assert twist.certificate.complete
    assert axial.certificate.complete


def test_a_coupling_bends_as_a_massless_beam() -> None:
    # Cantilever: tip deflection per force 1/k + L²/3 k_t of a beam with κGA = k L and EI = k_t L; ω² = 1/(m δ).
    length, lateral, tilt, mass = 0.3, 2e6, 1e5, 4.0
    coupling = Coupling(length, lateral, tilt, 1e4, 1e6)
    rotor = Rotor("tip", [coupling, Segment(1e-3, 0.3, 0.0, RIGID)], [Disc(length, mass)])
    modes = solve_lateral_modes(rotor, [RadialSupport(0.0, math.inf, math.inf)], count=1)
    compliance = 1 / lateral + length**2 / (3 * tilt)
    assert modes.frequencies[0] == pytest.approx(1 / math.sqrt(mass * compliance), rel=1e-9)


def test_torsional_springs_to_ground() -> None:
    # A disc on a rod held at its far end, massless: ω² = (k_ground + GJ/L)/I; and of a chain the same.
    rod = ShaftMaterial(207e9, 79.6e9, 0.0)
    stiffness = 79.6e9 * math.pi * 0.03**4 / 32 / 0.5
    rotor = Rotor("held", [Segment(0.5, 0.03, 0.0, rod)], [Disc(0.0, 1.0, 0.02)])
    springs = [AxisSpring(0.0, 3e3), AxisSpring(0.5, math.inf)]
    omega = math.sqrt((3e3 + stiffness) / 0.02)
    assert solve_torsional_modes(rotor, springs, count=1).frequencies[0] == pytest.approx(omega, rel=1e-12)
    chain = solve_torsional_chain([0.02, 0.0], [stiffness], ground=[3e3, math.inf])
    assert chain.frequencies == pytest.approx([omega], rel=1e-12)


def test_torsional_chain_between_springs_to_ground_is_the_textbook_band() -> None:
    # n equal inertias, held at both ends by equal springs: ω_j = 2 √(k/J) sin(jπ / 2(n + 1)).
    n, k, inertia = 9, 500.0, 0.3
    modes = solve_torsional_chain([inertia] * n, [k] * (n - 1), ground=[k] + [0.0] * (n - 2) + [k])
    expected = 2 * math.sqrt(k / inertia) * np.sin(np.arange(1, n + 1) * math.pi / (2 * (n + 1)))
    np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-12)


def test_axial_chain_on_the_nodes_of_bending_is_the_same_shaft() -> None:
    cone = Segment(0.4, 0.05, 0.0, STEEL, right_outer_diameter=0.09)
    coupling = Coupling(0.02, 1e8, 1e5, 1e4, 1e7, mass=1.0)
    rotor = Rotor("row", [cone, coupling, Segment(0.3, 0.04, 0.01, STEEL)], [Disc(0.2, 3.0)])
    bending = discretised_bending_shaft(rotor, [RadialSupport(0.1, 1e6)], 1e5)
    axial = axial_shaft_on(rotor, bending)
    np.testing.assert_array_equal(axial.nodes, bending.nodes)
    np.testing.assert_allclose(axial.lengths, bending.lengths, rtol=1e-12)
    for chain in (axial, bending):
        # Masses are scaled by the unit of displacement squared.
        mass = chain.energy_weights.mass[:: chain.size].sum() / chain.displacement_unit[0] ** 2
        assert mass == pytest.approx(rotor.mass, rel=1e-12)
    found = lowest_natural_frequencies(axial, 4, 1e5)
    np.testing.assert_allclose(found, solve_axial_modes(rotor, count=4).frequencies, rtol=1e-12)


@pytest.mark.parametrize("held", [(0, 10), (0,), (10,), (4,), (0, 4, 10)])
def test_torsional_chain_held_anywhere_is_its_matrices(held: tuple[int, ...]) -> None:
    # Held inertias drop out of the tridiagonal stiffness matrix of the rest.
    n, k, inertia = 11, 500.0, 0.3
    ground = [math.inf if i in held else 0.0 for i in range(n)]
    stiffness = k * (2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
    stiffness[0, 0] = stiffness[-1, -1] = k
    free = [i for i in range(n) if i not in held]
    expected = np.sqrt(np.linalg.eigvalsh(stiffness[np.ix_(free, free)]) / inertia)
    modes = solve_torsional_chain([inertia] * n, [k] * (n - 1), ground=ground)
    np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-10)
    np.testing.assert_allclose(modes.angle[:, list(held)], 0.0, atol=1e-12)


@pytest.mark.parametrize("pieces", [1, 7, 400])
def test_axial_rod_on_a_spring(pieces: int) -> None:
    # Spring k at the left, free at the right: (EA λ/L) tan λ = k with λ = ω L/c.
    area, stiffness, length = math.pi * 0.04**2 / 4, 3e8, 0.9
    rotor = Rotor("rod", [Segment(length / pieces, 0.04, 0.0, STEEL)] * pieces)
    modes = solve_axial_modes(rotor, [AxisSpring(0.0, stiffness)], count=12)
    wave = math.sqrt(207e9 / 7850.0)
    ratio = stiffness * length / (207e9 * area)
    for n, omega in enumerate(modes.frequencies):
        root = brentq(
            lambda x: x * math.sin(x) - ratio * math.cos(x), n * math.pi + 1e-9, (n + 0.5) * math.pi, rtol=1e-14
        )
        assert omega == pytest.approx(root * wave / length, rel=1e-11)
    z = np.linspace(0, length, 9)
    np.testing.assert_allclose(
        np.abs(modes.evaluate(z)[3]),
        np.abs(modes.evaluate([length])[3] * np.cos(modes.frequencies[3] / wave * (length - z))),
        atol=1e-9,
    )
    np.testing.assert_allclose(modes.displacement, modes.evaluate(modes.stations), atol=1e-12)


def test_a_coupling_damps_the_torsional_response() -> None:
    """Two discs on k + iωc: the angles of both, half way between, and the torque that the coupling carries."""
    coupling = Coupling(0.05, 3e9, 2e7, 4e4, 5e6, torsional_damping=8.0)
    bar = Segment(0.01, 0.2, 0.0, RIGID)
    rotor = Rotor("pair", [bar, coupling, bar], [Disc(0.0, 5.0, 0.1, 0.06), Disc(0.07, 8.0, 0.2, 0.12)])
    omega = np.array([100.0, 775.0, 2000.0])
    found = torsional_response(rotor, [Torque(0.0, 3.0)], omega, damping_ratio=0.01)
    for number, frequency in enumerate(omega):
        spring = 4e4 * (1.0 + 0.02j) + 8j * frequency
        dynamic = np.array([[spring - 0.1 * frequency**2, -spring], [-spring, spring - 0.2 * frequency**2]])
        angles = np.linalg.solve(dynamic, [3.0, 0.0])
        np.testing.assert_allclose(found.angle([0.0, 0.07])[number], angles, rtol=1e-6)
        assert found.torque([0.03])[number, 0] == pytest.approx(spring * (angles[1] - angles[0]), rel=1e-6)
        assert found.angle([0.035])[number, 0] == pytest.approx(angles.mean(), rel=1e-6)
