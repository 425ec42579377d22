"""Damping by what is attached: complex eigenvalues against closed forms."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.housing import (
    Bushing,
    Material,
    ModeSet,
    Mount,
    Patch,
    Support,
    assemble,
    attach_fixtures,
    modal_damping,
    solve_modes,
)
from gearwhine.housing.modes.effective_mass import damping_ratios
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray


def _eigenvalues(modes: ModeSet, damping: FloatArray) -> npt.NDArray[np.complex128]:
    """Of q'' + C q' + diag(ω²) q = 0, those with positive imaginary part, ascending."""
    n = len(modes.frequencies)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(modes.frequencies**2), -damping]])
    values = np.linalg.eigvals(state)
    return np.array(sorted(values[values.imag > 0.0], key=lambda value: value.imag))


def test_a_block_on_a_damped_mount_decays_as_one_degree_of_freedom(block: Callable[..., Mesh], steel: Material) -> None:
    """Heave of a rigid mass: s = -c/2m ± i √(k/m - (c/2m)²)."""
    mesh = block((0.1, 0.1, 0.1))
    k, c, mass = 5e4, 60.0, 7.85
    mount = Mount("m", Patch(surface="bottom"), Bushing((k, k, k, 9e3, 9e3, 9e3), (0.0, 0.0, c, 0.0, 0.0, 0.0)))
    matrices = attach_fixtures(assemble(mesh, steel), mesh, [mount])
    modes = solve_modes(matrices, count=6)
    damping = modal_damping(modes, matrices)
    expected = complex(-c / (2 * mass), np.sqrt(k / mass - (c / (2 * mass)) ** 2))
    assert np.abs(_eigenvalues(modes, damping) - expected).min() < 1e-5 * abs(expected)
    ratios = damping_ratios(modes.frequencies, np.full(len(modes.frequencies), 0.01), damping)
    heave = int(np.argmax(damping.diagonal()))
    assert ratios[heave] == pytest.approx(0.01 + c / (2 * np.sqrt(k * mass)), rel=1e-5)
    np.testing.assert_allclose(np.delete(ratios, heave), 0.01, atol=1e-6)


@pytest.mark.parametrize("how", ["support", "mount"])
def test_a_bar_with_a_dashpot_at_its_end(block: Callable[..., Mesh], how: str) -> None:
    """Lengthwise waves in a clamped bar with a dashpot D at its end: tanh(s L / c) = -E A / (D c).

    With r = D c / E A < 1 the roots are s L / c = -artanh r + i π (n - ½): all modes decay alike, though none of them
    is a mode of the undamped bar. The modes of the bar couple through the full matrix; without its other entries the
    decay rate would be r and not artanh r.
    """
    length, side, r = 0.2, 0.05, 0.3
    material = Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7800.0)
    speed = np.sqrt(material.youngs_modulus / material.density)
    dashpot = r * material.youngs_modulus * side**2 / speed
    mesh = block((side, side, length), (1, 1, 6))
    root = Support("root", surface="bottom", fixed=(True, True, True))
    end = {
        "support": Support("end", surface="top", damping=(0.0, 0.0, dashpot)),
        "mount": Mount("end", Patch(surface="top"), Bushing(damping=(0.0, 0.0, dashpot, 0.0, 0.0, 0.0))),
    }[how]
    matrices = attach_fixtures(assemble(mesh, material), mesh, [root, end])
    modes = solve_modes(matrices, frequency_limit=20 * speed / length)
    expected = complex(-np.arctanh(r), np.pi / 2) * speed / length
    found = _eigenvalues(modes, modal_damping(modes, matrices))
    nearest = found[np.argmin(np.abs(found - expected))]
    # The bar's first six lengthwise modes are kept; the rest are what is missed.
    assert abs(nearest - expected) < 0.01 * abs(expected)
    uncoupled = -r * speed / length
    assert abs(nearest.real - expected.real) < 0.2 * abs(uncoupled - expected.real)


def test_modal_damping_is_symmetric_and_takes_energy(box: Mesh, steel: Material) -> None:
    free = assemble(box, steel)
    feet = [Support(f"foot-{n}", surface=f"foot-{n}", damping=(10.0 * n, 20.0, 30.0)) for n in (1, 2, 3, 4)]
    modes = solve_modes(free, count=10)
    damping = modal_damping(modes, attach_fixtures(free, box, feet))
    assert np.array_equal(damping, damping.T)
    values = np.linalg.eigvalsh(damping)
    assert values.min() > -1e-12 * values.max()
    assert modal_damping(modes, free).any() == np.False_
