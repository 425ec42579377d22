"""Residues of measured responses at known poles, by least squares over the lines of a band (LSFD).

    H(ω) ≈ (iω)ᵖ [ Σ_k ( A_k / (iω - λ_k) + A_k* / (iω - λ_k*) ) - B / ω² + C ]

with p = 0, 1, 2 of receptances, mobilities and accelerances, a residual mass B for the modes below the poles and a
residual stiffness C for those above (P. Verboven, dissertation, Vrije Universiteit Brussel, 2002, section 5.4).
"""

from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import ComplexArray, FloatArray

POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Power p of iω by which a motion differs from the displacement."""


_STEPS = 30  # Gauss-Newton steps at most
_HALF_WIDTHS, _LINES_NEAR = 3.0, 20  # misfit near a pole: within half-power half-widths of it, or over its next lines
_AT_REST = 1e-12  # change of the squared misfit below which the steps end, as a part of it


@dataclass(frozen=True)
class FittedResponses:
    """Least-squares fit of responses at given poles.

    Attributes
    ----------
    synthesised : ndarray of complex, shape (n_responses, n_lines)
    residues : ndarray of complex, shape (n_responses, n_poles)
    misfit : float
        Norm of measured less synthesised responses over that of the measured.
    """

    synthesised: ComplexArray
    residues: ComplexArray
    misfit: float


def fit_residues(responses: ComplexArray, omega: FloatArray, poles: ComplexArray, power: int) -> FittedResponses:
    """Fit the residues of all poles in all responses.

    Parameters
    ----------
    responses : ndarray of complex, shape (n_responses, n_lines)
    omega : ndarray, shape (n_lines,)
        Circular frequencies above 0 [rad/s].
    poles : ndarray of complex, shape (n_poles,)
        One pole of each conjugate pair [rad/s].
    power : {0, 1, 2}
        Power p of the motion.
    """
    basis = _basis(omega, poles, power)
    scales = np.linalg.norm(basis, axis=0)
    measured = _stacked(responses.T)
    unknowns = np.linalg.lstsq(basis / scales, measured, rcond=None)[0] / scales[:, None]
    synthesised = basis @ unknowns
    misfit = float(np.linalg.norm(measured - synthesised) / np.linalg.norm(measured))
    count, lines = len(poles), len(omega)
    residues = (unknowns[:count] + 1j * unknowns[count : 2 * count]).T
    return FittedResponses((synthesised[:lines] + 1j * synthesised[lines:]).T, residues, misfit)


def refine_poles(responses: ComplexArray, omega: FloatArray, poles: ComplexArray, power: int) -> ComplexArray:
    """Move poles to the least misfit of the responses, by Gauss-Newton steps with the residues eliminated.

    The denominators of :mod:`common_denominator` weight the lines by D(z), which noise biases. Here the misfit itself
    is least. With P⊥ the projection that the fit of the residues leaves, E the misfit and dΦ_j the derivative of the
    basis times residues with respect to the real or imaginary part of a pole, the step solves J δ = E for
    J_j = P⊥ dΦ_j (variable projection: G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10, 1973; L. Kaufman, BIT 15,
    1975).

    Parameters
    ----------
    responses, omega, poles, power
        As in :func:`fit_residues`.

    Returns
    -------
    ndarray of complex, shape (n_poles,)
        Poles whose misfit is at most that of the given ones.
    """
    fit = fit_residues(responses, omega, poles, power)
    for _ in range(_STEPS):
        step = _gauss_newton_step(responses, omega, poles, power, fit)
        for part in (1.0, 0.5, 0.25, 0.125):
            moved = poles + part * step
            if np.any(moved.real >= 0.0) or np.any(moved.imag <= 0.0):
                continue
            tried = fit_residues(responses, omega, moved, power)
            if tried.misfit < fit.misfit:
                break
        else:
            return poles
        gain = fit.misfit**2 - tried.misfit**2
        poles, fit = moved, tried
        if gain <= _AT_REST * fit.misfit**2:
            break
    return poles


def pole_evidence(
    responses: ComplexArray, omega: FloatArray, poles: ComplexArray, power: int, fit: FittedResponses
) -> FloatArray:
    """Mean square of what each pole explains that the others do not, over that of the misfit near it, by unknown.

    It is the F-statistic of the pole's residues, 2 unknowns for each response: about 1 to 2 of a pole that fits noise,
    at most about the logarithm of the number of lines where there is one response. A mode has hundreds and more.

    Parameters
    ----------
    responses, omega, poles, power
        As in :func:`fit_residues`.
    fit : FittedResponses
        Fit of the residues at these poles.

    Returns
    -------
    ndarray, shape (n_poles,)
    """
    basis = _basis(omega, poles, power)
    scales = np.linalg.norm(basis, axis=0)
    covariance = np.linalg.pinv((basis / scales).T @ (basis / scales))
    errors = np.sum(np.abs(responses - fit.synthesised) ** 2, axis=0) / (2.0 * len(responses))
    count, evidence = len(poles), []
    for number, pole in enumerate(poles):
        columns = [number, count + number]
        amplitudes = np.stack([fit.residues[:, number].real, fit.residues[:, number].imag]) * scales[columns, None]
        own = covariance[np.ix_(columns, columns)]
        explained = float(np.sum(amplitudes * np.linalg.solve(own, amplitudes))) / (2.0 * len(responses))
        apart = np.abs(omega - abs(pole))
        near = apart <= max(_HALF_WIDTHS * abs(pole.real), np.sort(apart)[min(_LINES_NEAR, len(omega) - 1)])
        evidence.append(explained / max(float(np.mean(errors[near])), np.finfo(np.float64).tiny))
    return np.array(evidence)


def _gauss_newton_step(
    responses: ComplexArray, omega: FloatArray, poles: ComplexArray, power: int, fit: FittedResponses
) -> ComplexArray:
    """Change of the poles by one Gauss-Newton step.

    With q = (s - λ)⁻², q' = (s - λ*)⁻² and λ = σ + iν the derivative of A (s - λ)⁻¹ + A* (s - λ*)⁻¹ is Re A u + Im A v
    by σ and Re A v - Im A u by ν, for u = q + q' and v = i (q - q').
    """
    s = 1j * omega[:, None]
    one, other = 1.0 / (s - poles) ** 2, 1.0 / (s - poles.conj()) ** 2
    slopes = _stacked(s**power * np.concatenate([one + other, 1j * (one - other)], axis=1))
    span = np.linalg.qr(_basis(omega, poles, power) / np.abs(omega[-1]) ** power)[0]
    free = slopes - span @ (span.T @ slopes)
    error = _stacked((responses - fit.synthesised).T)
    count = len(poles)
    factors = np.zeros((2 * count, 2 * count, len(responses)))  # of each parameter: rows of its slopes
    each, real, imaginary = np.arange(count), fit.residues.real.T, fit.residues.imag.T
    factors[each, each], factors[each, count + each] = real, imaginary
    factors[count + each, each], factors[count + each, count + each] = -imaginary, real
    flat = factors.reshape(2 * count, -1)
    products = np.einsum("ab,jbr->jar", free.T @ free, factors).reshape(2 * count, -1) @ flat.T
    gradient = flat @ (free.T @ error).ravel()
    scales = np.sqrt(np.maximum(np.diag(products), np.finfo(np.float64).tiny))
    change = np.linalg.lstsq(products / np.outer(scales, scales), gradient / scales, rcond=1e-13)[0] / scales
    return np.asarray(change[:count] + 1j * change[count:])


def _basis(omega: FloatArray, poles: ComplexArray, power: int) -> FloatArray:
    """Responses of unit residues, shape (2 n_lines, 2 n_poles + 4).

    Columns are real and imaginary parts of the residues of all poles, of B and of C.
    """
    s = 1j * omega[:, None]
    one, other = 1.0 / (s - poles), 1.0 / (s - poles.conj())
    residual = np.concatenate([1.0 / s**2, np.ones_like(s)], axis=1)
    return _stacked(s**power * np.concatenate([one + other, 1j * (one - other), residual, 1j * residual], axis=1))


def _stacked(values: ComplexArray) -> FloatArray:
    """Real parts above imaginary ones: a residue's conjugate is in the model, too, which is linear over reals alone."""
    return np.concatenate([values.real, values.imag])
