"""MAC, scale factor and complexity beside those of sdypy-EMA, another program for modal tests."""

import numpy as np
import pytest

from gearwhine.housing.correlation import modal_assurance_criterion, modal_scale_factor, phase_collinearity

tools = pytest.importorskip("sdypy.EMA.tools", reason="sdypy-EMA is not installed")
RANDOM = np.random.default_rng(5)
A, B = RANDOM.normal(size=(2, 4, 13)) + 1j * RANDOM.normal(size=(2, 4, 13))


@pytest.mark.filterwarnings("ignore:Casting complex values")  # theirs keeps the real part of what is real
def test_mac() -> None:
    assert modal_assurance_criterion(A, B) == pytest.approx(np.asarray(tools.MAC(A.T, B.T)).real, rel=1e-12)


def test_phase_collinearity() -> None:
    assert 1.0 - phase_collinearity(A) == pytest.approx(np.asarray(tools.MCF(A.T)), rel=1e-10)


def test_scale_factor_of_real_shapes() -> None:
    """Theirs takes no conjugate, so real shapes alone are comparable."""
    assert modal_scale_factor(B.real, A.real) == pytest.approx(np.asarray(tools.MSF(A.real.T, B.real.T)), rel=1e-12)
