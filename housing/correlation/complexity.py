"""Complexity of mode shapes: modal phase collinearity, mean phase, and the nearest real shapes.

All points of a lightly damped structure's mode move in phase or against it, so that φ = c ψ with ψ real. In the complex
plane its entries then lie on a line through zero; measured ones scatter about one. With s = Σ φ² (not |φ|²)

    MPC = |s|² / (Σ |φ|²)²,   MCF = 1 - MPC,   θ = ½ arg s:

the modal phase collinearity of Pappa, Elliott and Schenk (1993), which is the MAC of a shape with its own conjugate;
the modal complexity factor; and the direction of the line that is nearest to the entries, by total least squares: the
major axis of their ellipse of scatter, for |s| is the difference of its principal moments and Σ|φ|² their sum. Where
s vanishes the entries have no direction: a travelling wave.
"""

import numpy as np
import numpy.typing as npt

from housing.correlation.modal_assurance_criterion import ComplexArray, FloatArray, filled, shape_set


def phase_collinearity(shapes: npt.ArrayLike) -> FloatArray:
    """Modal phase collinearity, shape (n,): 1 for a real shape to any complex scale, 0 for a travelling wave."""
    known, _ = filled(shape_set(shapes, "complex"))
    total = (np.abs(known) ** 2).sum(axis=1)
    ratio = np.abs((known**2).sum(axis=1)) / np.where(total > 0.0, total, 1.0)
    return np.asarray(np.where(total > 0.0, np.minimum(ratio, 1.0) ** 2, 1.0))


def complexity_factor(shapes: npt.ArrayLike) -> FloatArray:
    """Modal complexity factor 1 - MPC, shape (n,): 0 for a real shape."""
    return np.asarray(1.0 - phase_collinearity(shapes))


def mean_phase(shapes: npt.ArrayLike) -> FloatArray:
    """Angle of the line nearest to a shape's entries, from -π/2 (left out) to π/2, shape (n,) [rad]."""
    known, _ = filled(shape_set(shapes, "complex"))
    return np.asarray(0.5 * np.angle((known**2).sum(axis=1)))


def phase_deviation(shapes: npt.ArrayLike) -> FloatArray:
    """Mean angle between a shape's entries and the line nearest to them, weighted by size, shape (n,) [rad].

    The mean phase deviation of Reynders, Houbrechts and De Roeck (2012): 0 for a real shape; random phases give π/4.
    """
    aligned, _ = filled(_aligned(shapes))
    size = np.abs(aligned)
    angle = np.arctan2(np.abs(aligned.imag), np.abs(aligned.real))
    total = size.sum(axis=1)
    return np.asarray((size * angle).sum(axis=1) / np.where(total > 0.0, total, 1.0))


def real_shapes(shapes: npt.ArrayLike) -> FloatArray:
    """Complex shapes turned on to the real axis by their mean phase, and their real parts; NaN stays.

    Of all real shapes these are nearest to the given ones at any phase: the part dropped is the minor axis of their
    scatter, a part (1 - √MPC) / 2 of their square.

    Parameters
    ----------
    shapes : array_like, shape (n, n_dofs)

    Returns
    -------
    ndarray, shape (n, n_dofs)
        Of arbitrary sign.
    """
    return np.asarray(_aligned(shapes).real)


def _aligned(shapes: npt.ArrayLike) -> ComplexArray:
    given = shape_set(shapes, "complex")
    return np.asarray(given * np.exp(-1j * mean_phase(given))[:, None], dtype=np.complex128)
