"""Complex shapes, by ellipses whose axes are known."""

import numpy as np
import pytest

from gearwhine.housing.correlation import (
    modal_assurance_criterion,
    phase_collinearity,
    real_shapes,
)
from gearwhine.housing.correlation.modal_assurance_criterion import mean_phase

X, Y = np.array([1.0, 2.0, -2.0, 0.0]), np.array([2.0, -1.0, 0.0, 2.0])  # orthogonal, of one norm


@pytest.mark.parametrize("angle", [0.0, 0.1, np.pi / 8, 0.7])
def test_a_known_ellipse(angle: float) -> None:
    """φ = (cos α x + i sin α y) e^{iθ}: s = Σφ² ∝ cos 2α e^{2iθ}, so MPC = cos² 2α."""
    shape = (np.cos(angle) * X + 1j * np.sin(angle) * Y) * 3.0 * np.exp(0.9j)
    assert phase_collinearity(shape) == pytest.approx(np.cos(2 * angle) ** 2)
    assert phase_collinearity(shape) == pytest.approx(modal_assurance_criterion(shape, shape.conj())[0, 0])
    assert mean_phase(shape) == pytest.approx(0.9)
    assert real_shapes(shape)[0] == pytest.approx(3.0 * np.cos(angle) * X)
    dropped = 1.0 - modal_assurance_criterion(real_shapes(shape), shape)[0, 0]
    assert dropped == pytest.approx((1.0 - np.sqrt(phase_collinearity(shape)[0])) / 2.0, abs=1e-14)


def test_a_wave_that_travels_has_no_collinearity() -> None:
    wave = np.exp(2j * np.pi * np.arange(8) / 8)
    assert phase_collinearity(wave) == pytest.approx(0.0, abs=1e-15)


def test_gaps_stay_gaps() -> None:
    shape = np.array([1.0j, np.nan, -2.0j])
    assert phase_collinearity(shape) == pytest.approx(1.0)
    turned = real_shapes(shape)[0]
    assert np.isnan(turned[1])
    assert turned[[0, 2]] == pytest.approx(turned[0] * np.array([1.0, -2.0]))
