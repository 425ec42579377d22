"""Trust-region Newton method: the minimum of a convex function with its exact Hessian, from any start."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import linalg
from scipy.linalg import lapack

from gearwhine.numerics.arrays import FloatArray

MOST_ITERATIONS = 500
# Part of the largest eigenvalue below which an eigenvalue's direction is flat.
_FLAT_DIRECTION_SHARE = 1e-14
# Part of the largest pivot above which those of a Hessian's Cholesky factor have no flat direction.
_STIFF_DIRECTION_SHARE = 1e-9
# Distance, in first radii, beyond which a function that still falls is taken to have no minimum.
_FARTHEST = 1e12
_EPSILON = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Local:
    """A function and its derivatives at a point.

    Attributes
    ----------
    value : float
        Value of the function.
    gradient : ndarray, shape (n,)
        Gradient.
    hessian : ndarray, shape (n, n)
        Hessian, symmetric and positive semidefinite.
    noise : float
        Size of the terms whose difference is ``value``: the scale of its rounding.
    force : float
        Size of the terms whose sum is ``gradient``.
    """

    value: float
    gradient: FloatArray
    hessian: FloatArray
    noise: float
    force: float


@dataclass(frozen=True)
class Minimum:
    """Final point of the iteration, and the largest component of the gradient over ``force`` there."""

    place: FloatArray
    residual: float
    iterations: int


def minimise(function: Callable[[FloatArray], Local], start: FloatArray, radius: float, tolerance: float) -> Minimum:
    """Newton's method within a trust region (Conn, Gould and Toint 2000, algorithms 6.1.1 and 7.3.4).

    On a convex function every step is the exact minimiser of the local quadratic within the radius, so the iteration
    converges from any start if the function is bounded below, quadratically where its Hessian is positive definite at
    the minimum. Steps along directions without any stiffness or force are not taken.

    Parameters
    ----------
    function : callable
        Value, gradient and Hessian at a point, (n,).
    start : ndarray, shape (n,)
        Start of the iteration.
    radius : float
        Largest length of the first step; it adapts.
    tolerance : float
        Tolerance of the gradient over the size of its terms; rounding, or a function without a minimum, may stop the
        iteration above it.
    """
    local, place, stalled, farthest = function(start), start, 0, _FARTHEST * radius
    best = Minimum(place, _residual(local), 0)
    for iteration in range(1, MOST_ITERATIONS + 1):
        if best.residual <= tolerance or stalled == 3 or radius > farthest:
            break
        step, predicted = _step(local, radius)
        if not step.any():
            break
        trial = function(place + step)
        # Within rounding the decrease is meaningless, and the ratio tends to one.
        noise = 10.0 * _EPSILON * max(local.noise, trial.noise)
        ratio = (local.value - trial.value + noise) / (predicted + noise)
        length = _norm(step)
        if ratio < 0.25:
            radius = 0.25 * length
        elif ratio > 0.75:
            radius = max(radius, 2.5 * length)
        if ratio > 1e-4:
            place, local = place + step, trial
            if _residual(local) < best.residual:
                best, stalled = Minimum(place, _residual(local), iteration), 0
            elif predicted <= noise:
                stalled += 1
    return best


def _residual(local: Local) -> float:
    worst = float(np.abs(local.gradient).max(initial=0.0))
    return worst / local.force if local.force > 0.0 else 0.0


def _step(local: Local, radius: float) -> tuple[FloatArray, float]:
    """Minimiser of the local quadratic within the radius, and the decrease of the quadratic."""
    factor, failure = lapack.dpotrf(local.hessian, lower=True)
    pivots = np.diagonal(factor) ** 2
    if not failure and pivots.size and pivots.min() > _STIFF_DIRECTION_SHARE * pivots.max():
        step, _ = lapack.dpotrs(factor, -local.gradient, lower=True)
        if _norm(step) <= radius:
            return step, -0.5 * float(local.gradient @ step)
    values, vectors = linalg.eigh(local.hessian, check_finite=False)
    values = np.maximum(values, 0.0)
    slope = vectors.T @ local.gradient
    flat = (values <= _FLAT_DIRECTION_SHARE * values[-1]) & (np.abs(slope) <= 100.0 * _EPSILON * local.force)
    slope = np.where(flat, 0.0, slope)
    if not slope.any():
        return np.zeros_like(slope), 0.0
    values = np.where(flat, max(float(values[-1]), 1.0), values)
    # |step| falls with the shift; a shift of |slope| / radius is always enough, as values are not negative.
    low, high = 0.0, _norm(slope) / radius
    shift = 0.0
    if values.min() <= _EPSILON * high or _length(slope, values, 0.0) > radius:
        shift = high
        for _ in range(60):
            # Newton on 1/|step| − 1/radius, which is concave in the shift, kept within its bracket.
            length = _length(slope, values, shift)
            if 0.9 * radius <= length <= radius:
                break
            low, high = (shift, high) if length > radius else (low, shift)
            curve = float((slope**2 / (values + shift) ** 3).sum())
            shift += (length - radius) / radius * length**2 / curve
            if not low < shift < high:
                shift = 0.5 * (low + high)
    step = -slope / (values + shift)
    return np.asarray(vectors @ step), -float(slope @ step + 0.5 * (values * step**2).sum())


def _length(slope: FloatArray, values: FloatArray, shift: float) -> float:
    return _norm(slope / (values + shift))


def _norm(vector: FloatArray) -> float:
    return math.sqrt(vector @ vector)  # a tenth of the time of numpy's on a few numbers
