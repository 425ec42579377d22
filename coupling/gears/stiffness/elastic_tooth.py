r"""Elastic tooth of an internal gear under tractions on its root arc that have no resultant.

A beam on a rigid root (:mod:`gearwhine.coupling.gears.stiffness.beam`) knows the resultants of its load alone. A rim
that bends, or dents under a neighbour, also stretches and bows the root arc of a tooth, which yields to that as an
elastic body. The tooth is a plane one here, free but for its root arc, with its outline: half angle ``psi(r)`` about
its axis, from the root circle (radius 1) to the tip. Its displacements are polynomials of least energy (Ritz) under
tractions on the root arc,

    s(t) = T_k(t/theta) / sqrt(1 - (t/theta)^2),

radial and tangential, the shapes of :mod:`gearwhine.coupling.gears.stiffness.elastic_ring`. Of the tractions x with
resultants R x the part ``Q R x`` is the beam's own, normal stress linear and shear stress parabolic across the root,
and only the rest ``N x = (1 - Q R) x`` works on the elastic tooth.
"""

from __future__ import annotations

import math

import numpy as np

from gearwhine.numerics.arrays import FloatArray

_DEGREE = 9
"""Degree of the polynomials."""
_ACROSS = 16
"""Points of Gauss's quadrature across the tooth, and Legendre's polynomials that are resolved."""
_ALONG_ARC = 100


def tooth_flexibility(radius: FloatArray, half_angle: FloatArray, kappa: float, resultants: FloatArray) -> FloatArray:
    """Flexibility of a tooth under tractions on its root arc, times 2 mu, without the beam's.

    Parameters
    ----------
    radius, half_angle : ndarray, shape (p,)
        Outline of the tooth from the root circle, radius 1, to the tip, in root circle radii and [rad].
    kappa : float
        Kolosov's constant.
    resultants : ndarray, shape (3, shapes)
        Resultants R of the tractions' shapes, radial ones first.

    Returns
    -------
    ndarray, shape (shapes, shapes)
        Symmetric, no eigenvalue below 0.
    """
    theta, count = float(half_angle[0]), resultants.shape[1] // 2
    size = 0.5 * (1.0 - float(radius[-1]))
    points, weights = np.polynomial.legendre.leggauss(_ACROSS)
    middle, width = 0.5 * (radius[1:] + radius[:-1]), 0.5 * (half_angle[1:] + half_angle[:-1])
    angle = width[:, None] * points
    area = (-np.diff(radius) * middle * width)[:, None] * weights
    x, y = (middle[:, None] * function(angle) for function in (np.sin, np.cos))
    half = math.sin(theta)
    _, along_x, along_y = _polynomials(x.ravel() / half, (y.ravel() - 1.0) / size + 1.0)
    along_x, along_y = along_x / half, along_y / size
    lame = (3.0 - kappa) / (2.0 * (kappa - 1.0))
    square = [(a.T * area.ravel()) @ b for a, b in ((along_x, along_x), (along_y, along_y), (along_x, along_y))]
    xx, yy, xy = square
    # Energy density times 2, with 2 mu = 1: e_xx^2 + e_yy^2 + 2 e_xy^2 + lame (e_xx + e_yy)^2.
    energy = np.block(
        [
            [(1.0 + lame) * xx + 0.5 * yy, lame * xy + 0.5 * xy.T],
            [lame * xy.T + 0.5 * xy, (1.0 + lame) * yy + 0.5 * xx],
        ]
    )
    phase = math.pi * (np.arange(_ALONG_ARC) + 0.5) / _ALONG_ARC
    t = theta * np.cos(phase)
    shapes = math.pi * theta / _ALONG_ARC * np.cos(np.outer(phase, np.arange(count)))
    values = _polynomials(np.sin(t) / half, (np.cos(t) - 1.0) / size + 1.0)[0]
    sine, cosine = np.sin(t)[:, None] * values, np.cos(t)[:, None] * values
    work = np.block([[sine.T @ shapes, cosine.T @ shapes], [cosine.T @ shapes, -sine.T @ shapes]])
    # The beam's tractions on the root: linear and uniform normal stress, parabolic shear.
    place = np.cos(phase)
    chebyshev = np.cos(np.outer(np.arange(count), phase)) * np.where(np.arange(count) == 0, 1.0, 2.0)[:, None]
    linear, uniform, parabola = (
        chebyshev @ (np.sin(phase) * traction) / _ALONG_ARC for traction in (place, np.ones_like(place), 1.0 - place**2)
    )
    none = np.zeros(count)
    beam = np.array([np.concatenate(pair) for pair in ((linear, none), (none, parabola), (uniform, none))]).T
    rest = np.eye(2 * count) - beam @ np.linalg.solve(resultants @ beam, resultants)
    loads = work @ rest
    # Rigid motions store no energy, and the rest has no resultant: the least solution will do.
    solution = np.linalg.lstsq(energy, loads, rcond=1e-11)[0]
    flexibility = loads.T @ solution
    return np.asarray(0.5 * (flexibility + flexibility.T), dtype=np.float64)


def _polynomials(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Products of Legendre's polynomials up to `_DEGREE`, with their derivatives by x and y, (points, products)."""
    pairs = [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]
    one = np.eye(_DEGREE + 1)
    slopes = [np.polynomial.legendre.legder(row) for row in one]
    values = [np.polynomial.legendre.legvander(each, _DEGREE) for each in (x, y)]
    rates = [np.column_stack([np.polynomial.legendre.legval(each, slope) for slope in slopes]) for each in (x, y)]
    i, j = np.array(pairs).T
    return values[0][:, i] * values[1][:, j], rates[0][:, i] * values[1][:, j], values[0][:, i] * rates[1][:, j]
