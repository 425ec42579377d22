"""Elements too large for their waves, and tetrahedra too stiff for bending."""

from collections.abc import Callable

import numpy as np
import pytest

from gearwhine.housing import Material, assemble, solve_modes
from gearwhine.meshes import Mesh, resolution_defects
from gearwhine.meshes.quality import WaveCarrier, edge_lengths, locking_excess, wall_thickness

STEEL = Material(207e9, 0.3, 7850.0)


def _wave(frequency_hz: float) -> WaveCarrier:
    return WaveCarrier(STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density, 2 * np.pi * frequency_hz)


def test_wall_thickness_is_that_of_a_plate_and_of_a_block(block_of: Callable[..., Mesh]) -> None:
    """2 a b t / (2 a b + 2 (a + b) t), t for a wide plate."""
    for kind in ("tetra10", "hexahedron", "wedge15"):
        a, b, t = 2.0, 1.5, 0.01
        mesh = block_of(kind, (a, b, t), (2, 1, 1))
        assert wall_thickness(mesh) == pytest.approx(a * b * t / (a * b + (a + b) * t), rel=1e-12)


def test_bending_waves_are_those_of_a_long_plate_until_shear_is_slower(block_of: Callable[..., Mesh]) -> None:
    """k⁴ = ω² ρ t / D with D = E t³ / 12 (1 - ν²); at high frequencies the wave runs at √(G / ρ)."""
    t, omega = 0.01, 2 * np.pi * 1000.0
    stiffness = STEEL.youngs_modulus * t**3 / (12 * (1 - STEEL.poisson_ratio**2))
    k = (omega**2 * STEEL.density * t / stiffness) ** 0.25
    assert _wave(1000.0).shortest_wave(t) == pytest.approx(2 * np.pi / k)
    speed = np.sqrt(STEEL.youngs_modulus / 2.6 / STEEL.density)
    assert _wave(1e5).shortest_wave(0.1) == pytest.approx(speed / 1e5)


def test_bending_frequency_of_a_free_plate_strip_has_that_wavelength(block_of: Callable[..., Mesh]) -> None:
    """Far from its ends a strip in plane strain waves as an infinite plate: with n half waves, ω(k) of the plate.

    Held at y = 0 and y = b in y, so that it bends as a plate does; the n-th free-free mode has k L = (n + ½) π.
    """
    length, width, t = 1.0, 0.05, 0.01
    mesh = block_of("hexahedron20", (length, width, t), (40, 1, 1))
    held = 3 * np.arange(len(mesh.points)) + 1
    modes = solve_modes(assemble(mesh, STEEL).held(held), count=14)
    bending = [
        frequency
        for frequency, shape in zip(modes.frequencies, modes.shapes, strict=True)
        if frequency > 1.0 and np.abs(shape[:, 2]).sum() > 5 * np.abs(shape[:, 0]).sum()
    ]
    sixth = WaveCarrier(STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density, float(bending[5]))
    assert sixth.shortest_wave(t) == pytest.approx(2 * length / 6.5, rel=0.03)


def test_elements_are_held_against_the_shortest_wave(block_of: Callable[..., Mesh]) -> None:
    """Sixteen elements of order 1, or eight of order 2, for each wave; a little longer edges and they are told."""
    size = (0.6, 0.6, 0.01)
    for kind, part in (("hexahedron", 16.0), ("hexahedron20", 8.0), ("wedge15", 8.0)):
        mesh = block_of(kind, size, (12, 12, 1))
        longest = 0.05 * (np.sqrt(2.0) if kind == "wedge15" else 1.0)
        thickness = wall_thickness(mesh)
        # λ ~ 1/√f: the frequency at which the longest edge is just short enough.
        limit = 1000.0 * (_wave(1000.0).shortest_wave(thickness) / (part * longest)) ** 2
        assert resolution_defects(mesh, _wave(0.99 * limit)) == ()
        (found,) = resolution_defects(mesh, _wave(1.01 * limit))
        assert (found.name, found.severity, found.count) == ("size", "warning", mesh.n_elements)
        needed = 1e3 * longest / np.sqrt(1.01)
        assert f"use elements of at most {needed:.3g} mm" in found.message


@pytest.mark.parametrize("layers", [1, 2])
def test_the_stiffness_of_simple_tetrahedra_is_foretold(block_of: Callable[..., Mesh], layers: int) -> None:
    """The first bending mode of a free bar against Timoshenko's small correction of Euler and Bernoulli, 4.730 / L."""
    length, width, t = 1.0, 0.2, 0.05
    mesh = block_of("tetra", (length, width, t), (20 * layers, 4 * layers, layers))
    first = solve_modes(assemble(mesh, STEEL), count=7).frequencies[6]
    slender = 4.7300407**2 * np.sqrt(STEEL.youngs_modulus * t**2 / 12 / STEEL.density) / length**2
    # Shear and rotary inertia lower it by about half of (1 + E / κ G) (4.73 r / L)².
    exact = slender * (1 - 0.5 * (1 + 2.6 / (5 / 6)) * (4.73 * t / np.sqrt(12) / length) ** 2)
    excess = (first / exact) ** 2 - 1
    (found,) = resolution_defects(mesh, _wave(1e-3))
    assert found.name == "locking"
    foretold = locking_excess(float(np.median(edge_lengths(mesh.points, mesh.blocks[0]))), t)
    assert 0.7 < foretold / excess < 1.4
    assert "% too stiff in bending" in found.message
    assert resolution_defects(block_of("tetra10", (length, width, t), (20, 4, 1)), _wave(1e-3)) == ()
