"""Poles of measured responses by the least-squares complex frequency-domain method (LSCF), from edge to edge of a band.

All responses share a common denominator in a discrete variable,

    H_i(ω) ≈ N_i(z) / D(z),   z = exp(i 2π α (ω - ω_1) / (ω_N - ω_1)),   D(z) = Σ_k a_k z^k,  a_n = 1,

with complex coefficients. For given D the numerators are eliminated from Σ_i Σ_ω |N_i - H_i D|², which leaves the
normal equations of D alone,

    M a = 0,   M = T - Σ_i S_iᴴ R⁻¹ S_i,

whose Toeplitz matrices R, S_i and T hold the Fourier sums of 1, H_i and Σ_i |H_i|² over the lines (P. Verboven,
Frequency-domain system identification for modal analysis, dissertation, Vrije Universiteit Brussel, 2002, section 5.3;
the highest coefficient is set to 1, after which poles of noise wander over the orders and those of modes stay).

The band covers the part α of the unit circle. With α = 1, and with real coefficients on a half circle that ends at the
last line, the two edges of the band meet in one point, or a pole and its conjugate do: a pole near the edge is then
lost, or pulled along the real axis. The gap that α < 1 leaves keeps the edges apart, and holds poles beyond them.
"""

import numpy as np
import scipy.linalg

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.numerics.arrays import ComplexArray

CIRCLE_SHARE = 0.9
"""Part α of the unit circle that the band covers: 0.9 to 0.95 in the literature."""

_LINES_PER_ORDER = 3  # least number of lines for each coefficient of the denominator


def common_denominator_poles(responses: ComplexArray, first: float, spacing: float, orders: int) -> list[ComplexArray]:
    """Return the poles of the denominators of every order, from 1 up.

    Parameters
    ----------
    responses : ndarray of complex, shape (n_responses, n_lines)
        Responses at evenly spaced frequencies, of any motion to any force.
    first, spacing : float
        Circular frequency of the first line, and distance of two lines [rad/s].
    orders : int
        Highest order; lower where there are less than three lines for each.

    Returns
    -------
    list of ndarray of complex
        Poles λ [rad/s], as many as the order; some are beyond an edge of the band, by half of the gap or less.

    Raises
    ------
    MeasuredDataError
        Where the responses have too few lines, or are so alike over them that they determine no denominator.
    """
    n_lines = responses.shape[1]
    orders = min(orders, n_lines // _LINES_PER_ORDER)
    if orders < 2:
        raise MeasuredDataError(f"responses at {n_lines} frequencies; finding modes needs {2 * _LINES_PER_ORDER}")
    circle = int(np.ceil((n_lines - 1) / CIRCLE_SHARE))
    lags = (np.arange(orders + 1)[:, None] - np.arange(orders + 1)) % circle
    scale = np.linalg.norm(responses) or 1.0
    sums = np.fft.fft(responses / scale, n=circle, axis=1)
    powers = np.fft.fft(np.sum(np.abs(responses / scale) ** 2, axis=0), n=circle)
    numerators = np.linalg.cholesky(np.fft.fft(np.ones(n_lines), n=circle)[lags])
    # L⁻¹ S_i for R = L Lᴴ: the first rows and columns are those of every lower order.
    whitened = [scipy.linalg.solve_triangular(numerators, one[lags], lower=True) for one in sums]
    eliminated = np.zeros((orders + 1, orders + 1), dtype=np.complex128)
    poles = []
    for order in range(orders + 1):
        rows = np.array([one[order] for one in whitened])
        eliminated += rows.conj().T @ rows
        if order:
            normal = (powers[lags] - eliminated)[: order + 1, : order + 1]
            poles.append(_poles(normal, n_lines, circle, first, spacing))
    return poles


def _poles(normal: ComplexArray, n_lines: int, circle: int, first: float, spacing: float) -> ComplexArray:
    """Solve the normal equations of one order, and turn the roots of its denominator into poles."""
    order = len(normal) - 1
    try:
        lower = np.linalg.solve(normal[:order, :order], -normal[:order, order])
    except np.linalg.LinAlgError as error:
        raise MeasuredDataError("the responses are the same at all frequencies, or zero: they have no modes") from error
    roots = np.roots(np.append(lower, 1.0)[::-1])
    roots = roots[roots != 0.0]
    angles = np.angle(roots) % (2.0 * np.pi)
    end_of_band = 2.0 * np.pi * (n_lines - 1) / circle
    beyond = 0.5 * (2.0 * np.pi - end_of_band)
    angles = np.where(angles > end_of_band + beyond, angles - 2.0 * np.pi, angles)
    per_angle = circle * spacing / (2.0 * np.pi)
    return np.asarray(per_angle * np.log(np.abs(roots)) + 1j * (first + per_angle * angles))
