"""Amplitudes at a part of an element: by power series from its end, against the integrals from its start."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling.collocation.arrays import MONOMIALS, ORDER, PLACES, Reference
from gearwhine.coupling.collocation.element_kernels import advance_to, carry_on


@settings(deadline=None)
@given(
    part=st.floats(0.94, 1.06),
    fastest=st.floats(0.01, 40.0),
    damped=st.floats(0.0, 0.9),
    seed=st.integers(0, 2**32 - 1),
)
def test_from_the_end_as_from_the_start(part: float, fastest: float, damped: float, seed: int) -> None:
    """Modes slow and fast, damped and not, a force that is any polynomial; series and exponentials on both sides."""
    random = np.random.default_rng(seed)
    m, c, h = 4, 2, 0.7
    values = fastest * random.uniform(0.0, 1.0, m) * np.exp(1j * (np.pi / 2 + damped * np.pi / 2)) / h
    source = random.normal(size=(m, c)) + 1j * random.normal(size=(m, c))
    none = np.zeros((c, 2 * m))
    reference = Reference(values, source, none, none, *np.zeros((3, c)))
    z, excess = random.normal(size=2 * m), random.normal(size=ORDER * c)
    coefficient, integral = np.zeros((ORDER, c)), np.zeros(ORDER + 2, dtype=np.complex128)
    expected, found = np.zeros(2 * m), np.zeros(2 * m)
    advance_to(reference, h, part, z, excess, expected, coefficient, integral)
    advance_to(reference, h, 1.0, z, excess, found, coefficient, integral)
    carry_on(reference, h, part, z, excess, found, coefficient, integral, np.zeros(2 * m))
    # The moments' recursion loses two digits where it begins, and the polynomials' coefficients two more.
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=5e-11 * max(1.0, float(np.abs(expected).max())))


def test_a_slow_mode_gathers_the_force() -> None:
    """z' = -b g with g = u²: z falls by b h u³ / 3."""
    none = np.zeros((1, 2))
    reference = Reference(
        np.zeros(1, dtype=np.complex128),
        np.ones((1, 1), dtype=np.complex128),
        none,
        none,
        *np.zeros((3, 1)),
    )
    end, h, part = np.zeros(2), 0.3, 1.05
    excess, coefficient, integral = PLACES**2, np.zeros((ORDER, 1)), np.zeros(ORDER + 2, dtype=np.complex128)
    assert MONOMIALS.T @ excess == pytest.approx([0.0, 0.0, 1.0, 0.0, 0.0], abs=1e-12)
    end[0] = -h / 3.0
    carry_on(reference, h, part, np.zeros(2), excess, end, coefficient, integral, np.zeros(2))
    assert end == pytest.approx([-h * part**3 / 3.0, 0.0], abs=1e-14)
