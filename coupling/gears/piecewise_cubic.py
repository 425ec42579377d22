"""Interpolation by piecewise cubics, in plain arrays that a compiled kernel can hold, and at Chebyshev points.

A piecewise cubic is on each interval ``f = c0 + c1 u + c2 u^2 + c3 u^3`` with ``u`` running from 0 to 1.

Chebyshev interpolation gives a smooth function from its values at few points, where each value is expensive. The
interpolant through n + 1 Chebyshev points converges geometrically with n to an analytic function (Trefethen,
Approximation Theory and Approximation Practice, 2013). Its coefficients are the discrete cosine transform of the
values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Chebyshev
from scipy.fft import dct
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from gearwhine.coupling.gears.errors import ContactAccuracyError, GearError
from gearwhine.numerics.arrays import FloatArray

Function = Callable[[FloatArray], FloatArray]

_FEWEST, _MOST = 32, 128
_TOLERANCE = 1e-13
"""Largest difference of interpolant and function between the points, relative to the largest value."""


def chebyshev_interpolant(function: Function, length: float) -> Function:
    """Interpolate a function on [0, length]; return the function itself where it is not smooth enough.

    The degree is doubled until the interpolant meets the function at all points between its own.

    Parameters
    ----------
    function : callable
        Function from positions (n,) to values (n,).
    length : float
        End of the range.
    """
    values = function(_points(_FEWEST, length))
    while 2 * (degree := values.size - 1) <= _MOST:
        finer = _points(2 * degree, length)
        between = function(finer[1::2])
        error = np.abs(_interpolant(values, length)(finer[1::2]) - between).max()
        refined = np.empty(finer.size)
        refined[0::2], refined[1::2] = values, between
        if error <= _TOLERANCE * np.abs(refined).max():
            return _interpolant(refined, length)
        values = refined
    return function


def _points(degree: int, length: float) -> FloatArray:
    """Extrema of the Chebyshev polynomial, from the end of the range to 0; they include those of half the degree."""
    return np.asarray(0.5 * length * (1.0 + np.cos(np.pi * np.arange(degree + 1) / degree)), dtype=np.float64)


def _interpolant(values: FloatArray, length: float) -> Chebyshev:
    """Chebyshev series through values at `_points`."""
    coefficients = dct(values, type=1) / (values.size - 1)
    coefficients[[0, -1]] *= 0.5
    return Chebyshev(coefficients, domain=[0.0, length])


NARROWEST = 1e-7
"""Shortest interval that is split."""
_MOST_INTERVALS = 20_000
_NODES = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
_BETWEEN = np.array([1.0 / 6.0, 0.5, 5.0 / 6.0])
_THROUGH_NODES = np.linalg.inv(np.vander(_NODES, increasing=True))


@dataclass(frozen=True, eq=False)
class PiecewiseCubic:
    """A function on ``[knots[0], knots[-1]]``.

    Attributes
    ----------
    knots : ndarray, shape (n + 1,)
        Strictly increasing.
    coefficients : ndarray, shape (n, 4)
        c0 ... c3 of each interval.
    """

    knots: FloatArray = field(repr=False)
    coefficients: FloatArray = field(repr=False)

    def __post_init__(self) -> None:
        """Check the shapes, the knots and the coefficients."""
        if self.knots.ndim != 1 or self.coefficients.shape != (self.knots.size - 1, 4):
            raise GearError(
                f"a piecewise cubic needs n + 1 knots and (n, 4) coefficients, "
                f"got {self.knots.shape} and {self.coefficients.shape}"
            )
        if not (np.all(np.isfinite(self.coefficients)) and np.all(np.diff(self.knots) > 0.0)):
            raise GearError("a piecewise cubic needs increasing knots and finite coefficients")

    def __call__(self, position: npt.ArrayLike, derivative: int = 0) -> FloatArray:
        """Value at `position`, or its first derivative (`derivative` = 1); outside the range at its nearest end."""
        inside = np.clip(np.asarray(position, dtype=np.float64), self.knots[0], self.knots[-1])
        return np.asarray(self._polynomial(inside, derivative), dtype=np.float64)

    @cached_property
    def _polynomial(self) -> PPoly:
        """The function in powers of (x - knot), highest first."""
        powers = np.diff(self.knots)[:, None] ** np.arange(4)
        return PPoly(np.ascontiguousarray((self.coefficients / powers).T[::-1]), self.knots)

    def plus(self, start: float, slope: float) -> PiecewiseCubic:
        """Return the sum with the straight line that is `start` at 0."""
        coefficients = self.coefficients.copy()
        coefficients[:, 0] += start + slope * self.knots[:-1]
        coefficients[:, 1] += slope * np.diff(self.knots)
        return PiecewiseCubic(self.knots, coefficients)

    @property
    def mean(self) -> float:
        """Mean value over the whole range."""
        start, end = float(self.knots[0]), float(self.knots[-1])
        return float(self._polynomial.integrate(start, end)) / (end - start)

    def on_knots(self, knots: FloatArray) -> PiecewiseCubic:
        """Return the same function on more knots, or on a wider range with its end values held constant.

        Parameters
        ----------
        knots : ndarray
            Increasing; every knot of this function within their range is among them.
        """
        return PiecewiseCubic(knots, self.between(knots[:-1], knots[1:]))

    def between(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Coefficients on intervals that each lie within one interval of this function, or outside its range.

        Parameters
        ----------
        low, high : ndarray
            Begin and end of the intervals; any shape.

        Returns
        -------
        ndarray
            Coefficients c0 ... c3 in the last axis, shape (..., 4).
        """
        inside = 0.5 * (low + high)
        interval = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, self.knots.size - 2)
        width = np.diff(self.knots)[interval]
        u = (low - self.knots[interval]) / width
        part = (high - low) / width
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[interval], -1, 0)
        moved = [
            c0 + u * (c1 + u * (c2 + u * c3)),
            part * (c1 + u * (2.0 * c2 + 3.0 * u * c3)),
            part**2 * (c2 + 3.0 * u * c3),
            part**3 * c3,
        ]
        beyond = (inside < self.knots[0]) | (inside > self.knots[-1])
        for power, values in enumerate(moved):
            values[beyond] = self(inside[beyond]) if power == 0 else 0.0
        return np.stack(moved, axis=-1)


def with_corners(knots: FloatArray, corners: npt.ArrayLike, apart: float) -> FloatArray:
    """Knots and the corners within their range, without knots nearer than `apart` to another one."""
    inner = np.unique(np.asarray(corners, dtype=np.float64))
    inner = inner[(inner > knots[0]) & (inner < knots[-1])]
    above = np.searchsorted(knots, inner)
    inner = inner[np.minimum(inner - knots[above - 1], knots[above] - inner) > apart]
    return np.sort(np.concatenate([knots, inner[np.diff(inner, prepend=-np.inf) > apart]]))


def constant(value: float, length: float) -> PiecewiseCubic:
    """Return the constant function `value` on ``[0, length]``."""
    return PiecewiseCubic(np.array([0.0, length]), np.array([[value, 0.0, 0.0, 0.0]]))


def quadratic(start: float, middle: float, end: float, length: float) -> PiecewiseCubic:
    """Return the parabola through three values at 0, ``length / 2`` and ``length``."""
    linear, square = -3.0 * start + 4.0 * middle - end, 2.0 * start - 4.0 * middle + 2.0 * end
    return PiecewiseCubic(np.array([0.0, length]), np.array([[start, linear, square, 0.0]]))


def polyline(knots: FloatArray, values: FloatArray) -> PiecewiseCubic:
    """Straight lines between `values` at `knots`, exact at every corner."""
    zeros = np.zeros(knots.size - 1)
    return PiecewiseCubic(knots, np.column_stack([values[:-1], np.diff(values), zeros, zeros]))


def fitted(function: Callable[[FloatArray], FloatArray], breaks: FloatArray, tolerance: float) -> PiecewiseCubic:
    """Cubics through a continuous function, with intervals halved until they follow it.

    Parameters
    ----------
    function : callable
        Function from positions (n,) to values (n,).
    breaks : ndarray
        Increasing: the ends of the range and the corners of the function. At corners not among them intervals are
        halved down to `NARROWEST`, where the error is what the function changes over such a length.
    tolerance : float
        Largest difference from `function` at points between those that a cubic goes through.

    Raises
    ------
    ContactAccuracyError
        When many thousand intervals do not suffice: the function has a step.
    """
    todo_low, todo_high = breaks[:-1], breaks[1:]
    lows: list[FloatArray] = []
    pieces: list[FloatArray] = []
    while todo_low.size:
        if todo_low.size > _MOST_INTERVALS:
            raise ContactAccuracyError("a curve has a step where it should be continuous: give it corners of its own")
        width = todo_high - todo_low
        # All points in one call: a call costs more than its points.
        places = (todo_low[:, None] + width[:, None] * np.concatenate([_NODES, _BETWEEN])).ravel()
        nodes, between = np.hsplit(function(places).reshape(todo_low.size, -1), [_NODES.size])
        coefficients = nodes @ _THROUGH_NODES.T
        error = np.abs(coefficients @ _BETWEEN ** np.arange(4)[:, None] - between).max(axis=1)
        good = (error <= tolerance) | (width <= NARROWEST)
        lows.append(todo_low[good])
        pieces.append(coefficients[good])
        middle = 0.5 * (todo_low + todo_high)[~good]
        todo_low, todo_high = np.concatenate([todo_low[~good], middle]), np.concatenate([middle, todo_high[~good]])
    starts = np.concatenate(lows)
    order = np.argsort(starts)
    return PiecewiseCubic(np.append(starts[order], breaks[-1]), np.concatenate(pieces)[order])


def tabulated(function: Callable[[FloatArray], FloatArray], length: float, tolerance: float = 1e-9) -> PiecewiseCubic:
    """Cubic spline of a smooth function on a uniform grid over ``[0, length]``, refined until it follows it.

    Parameters
    ----------
    function : callable
        Function from positions (n,) to values (n,).
    length : float
        End of the range.
    tolerance : float
        Largest difference from `function`, relative to its largest value, at points between the knots.

    Raises
    ------
    ContactAccuracyError
        When 8192 intervals do not suffice: the function has a step or a corner.
    """
    intervals, error = 64, math.inf
    # The knots and the middles between them.
    values = function(np.linspace(0.0, length, 2 * intervals + 1))
    while intervals <= 8192:
        knots = np.linspace(0.0, length, intervals + 1)
        table = _from_scipy(CubicSpline(knots, values[::2]))
        largest = max(float(np.max(np.abs(values))), 1e-300)
        error = float(np.max(np.abs(table(knots[:-1] + 0.5 * np.diff(knots)) - values[1::2]))) / largest
        if error <= tolerance:
            elsewhere = knots[:-1] + 0.211 * np.diff(knots)
            error = float(np.max(np.abs(table(elsewhere) - function(elsewhere)))) / largest
        if error <= tolerance:
            return table
        # A spline's error falls with the fourth power of the spacing; a call costs more than its points.
        finer = 2 ** max(1, min(3, math.ceil(math.log2(max(error / tolerance, 1.0)) / 4.0)))
        intervals *= finer
        points = np.linspace(0.0, length, 2 * intervals + 1)
        evaluated = np.arange(points.size) % finer == 0
        between = np.empty(points.size)
        between[evaluated], between[~evaluated] = values, function(points[~evaluated])
        values = between
    raise ContactAccuracyError(
        f"the table still misses the function by {error:.1e} (allowed {tolerance:.1e}) with 8192 intervals; "
        "it is not smooth: give it as a table with its own knots"
    )


def through_points(position: FloatArray, values: FloatArray) -> PiecewiseCubic:
    """Monotone cubic through given points (Fritsch & Carlson), on a uniform grid.

    Points that are spaced uniformly are kept as they are; others are carried over to a grid of 4096 intervals.
    """
    curve = PchipInterpolator(position, values)
    spacing = np.diff(position)
    if np.allclose(spacing, spacing.mean(), rtol=1e-9, atol=0.0):
        return _from_scipy(curve)
    knots = np.linspace(position[0], position[-1], 4097)
    return _from_scipy(PchipInterpolator(knots, curve(knots)))


def unit_coefficients(curve: PPoly) -> FloatArray:
    """Coefficients of a scipy cubic in the variable u of each interval, c0 ... c3 in the last axis, (n, ..., 4)."""
    highest_first = np.moveaxis(np.asarray(curve.c, dtype=np.float64), 0, -1)
    widths = np.diff(curve.x).reshape(-1, *(1,) * (highest_first.ndim - 1))
    return np.ascontiguousarray(highest_first[..., ::-1] * widths ** np.arange(4))


def _from_scipy(curve: PPoly) -> PiecewiseCubic:
    return PiecewiseCubic(np.asarray(curve.x, dtype=np.float64), unit_coefficients(curve))
