"""Operating shapes and drawn motions, against sums and maxima taken by brute force."""

import numpy as np
import pytest

from gearwhine.housing import HousingError, ModeSet, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.modes.receptance import OperatingShape
from gearwhine.housing.pictures.drawn_shapes import DrawnShape, peak_displacement, widest_angle

ANGLES = np.linspace(0.0, 2.0 * np.pi, 3601)


def _motion(seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(20, 3)) + 1j * rng.normal(size=(20, 3))


def _swings(motion: np.ndarray) -> np.ndarray:
    return (motion * np.exp(1j * ANGLES)[:, None, None]).real


def test_the_peak_is_the_largest_over_a_period() -> None:
    motion = _motion()
    np.testing.assert_allclose(
        peak_displacement(motion), np.linalg.norm(_swings(motion), axis=2).max(axis=0), rtol=1e-5
    )


def test_a_picture_shows_where_the_whole_is_widest() -> None:
    motion = _motion(1)
    widest = (_swings(motion) ** 2).sum(axis=(1, 2)).max()
    shape = DrawnShape("a", "A", "", motion)
    assert (shape.at(0.0) ** 2).sum() * peak_displacement(motion).max() ** 2 == pytest.approx(widest, rel=1e-5)
    np.testing.assert_allclose(shape.at(np.pi), -shape.at(0.0), atol=1e-12)
    assert shape.amplitude.max() == pytest.approx(1.0)


def test_a_real_shape_is_drawn_as_it_is_signs_and_all() -> None:
    real = -_motion(2).real
    assert widest_angle(real) == 0.0
    np.testing.assert_allclose(
        DrawnShape("a", "A", "", real).at(0.0), real / np.linalg.norm(real, axis=1).max(), atol=1e-15
    )


@pytest.mark.parametrize("motion", [np.zeros((4, 3)), np.full((4, 3), np.nan)])
def test_a_shape_that_does_not_move_is_refused(motion: np.ndarray) -> None:
    with pytest.raises(HousingError, match="finite displacements"):
        DrawnShape("a", "A", "", motion)


@pytest.fixture(scope="module")
def modes(cube: tuple[object, Matrices]) -> ModeSet:
    return solve_modes(cube[1], count=9)


def test_displacement_is_the_modal_sum_and_energy_that_of_the_mass(
    modes: ModeSet, cube: tuple[object, Matrices]
) -> None:
    """Mean kinetic energy ¼ vᴴ M v, by the mass matrix itself, is shared as the modes say."""
    rng = np.random.default_rng(3)
    count = len(modes.shapes)  # nine and the partners of the last
    modal = rng.normal(size=count) + 1j * rng.normal(size=count)
    shape = OperatingShape(2.0 * np.pi * 500.0, modal)
    everywhere = np.arange(modes.shapes.shape[1])
    moved = shape.displacement(modes, everywhere)
    expected = -sum(a * phi for a, phi in zip(modal, modes.shapes, strict=True)) / shape.frequency**2
    np.testing.assert_allclose(moved, expected, rtol=1e-12)
    mass = cube[1].mass

    def energy(motion: np.ndarray) -> float:
        velocity = (1j * shape.frequency * motion).ravel()
        return 0.25 * float((velocity.conj() @ (mass @ velocity)).real)

    alone = [energy(-a * phi / shape.frequency**2) for a, phi in zip(modal, modes.shapes, strict=True)]
    np.testing.assert_allclose(shape.kinetic_shares, np.array(alone) / energy(moved), rtol=1e-8)


def test_what_is_no_line_is_refused(modes: ModeSet) -> None:
    with pytest.raises(HousingError, match="above zero"):
        OperatingShape(0.0, np.ones(2, dtype=complex))
    with pytest.raises(HousingError, match="no mode of the housing moves"):
        OperatingShape(1.0, np.zeros(2, dtype=complex))
    with pytest.raises(HousingError, match="2 modal amplitudes for"):
        OperatingShape(1.0, np.ones(2, dtype=complex)).displacement(modes, np.arange(3))
