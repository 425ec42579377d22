"""Modal assurance criterion (MAC) of mode shapes, auto-MAC, pole-weighted MAC, scale factor, COMAC, and complexity.

The criterion is the squared cosine of the angle between two vectors (Allemang and Brown 1982),

    MAC(a, b) = |aᴴ b|² / (aᴴ a · bᴴ b),

between 0 and 1, whatever complex number scales either. It weighs all degrees of freedom alike: a survey with most
points on one wall judges mostly that wall, and one with too few points finds different modes alike (Allemang 2003).
:func:`auto_mac` shows the second; :mod:`gearwhine.housing.correlation.orthogonality` weighs by mass instead.

The coordinate criteria :func:`comac` and :func:`enhanced_comac` give the difference of paired shapes at each degree of
freedom. Shapes of unknown scale are comparable at one degree of freedom only after they are scaled alike: here both
shapes of a pair are scaled to unit norm (``comac``) or unit largest entry (``enhanced_comac``) over the degrees of
freedom that both have.

Complexity: all points of a lightly damped structure's mode move in phase or against it, so that φ = c ψ with ψ real. In
the complex plane its entries then lie on a line through zero; measured ones scatter about one. With s = Σ φ² (not
|φ|²)

    MPC = |s|² / (Σ |φ|²)²,   MCF = 1 - MPC,   θ = ½ arg s:

the modal phase collinearity of Pappa, Elliott and Schenk (1993), which is the MAC of a shape with its own conjugate;
the modal complexity factor; and the direction of the line that is nearest to the entries, by total least squares: the
major axis of their ellipse of scatter, for |s| is the difference of its principal moments and Σ|φ|² their sum. Where
s vanishes the entries have no direction: a travelling wave.

A set of mode shapes is a matrix: one row a mode, one column a degree of freedom.
"""

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import BoolArray, ComplexArray, FloatArray

ShapeArray: TypeAlias = npt.NDArray[np.inexact[Any]]


def shape_set(shapes: npt.ArrayLike, name: str) -> ShapeArray:
    """Return a set of mode shapes as a matrix, real where all entries are real.

    Parameters
    ----------
    shapes : array_like, shape (n_modes, n_dofs) or (n_dofs,)
        Real or complex; NaN where a degree of freedom was not measured. One shape alone is a set of one.
    name : str
        Name of the set of shapes, for messages.

    Raises
    ------
    HousingError
        Where it is no such matrix, an entry is infinite, or a mode has no entry at all.
    """
    raw = np.asarray(shapes)
    kind = np.complex128 if np.iscomplexobj(raw) else np.float64
    array: ShapeArray = np.atleast_2d(raw.astype(kind))
    if array.ndim != 2 or array.shape[1] == 0:
        raise HousingError(f"{name} shapes have the shape {raw.shape}; expected (modes, degrees of freedom)")
    if np.isinf(array).any():
        raise HousingError(f"{name} shape {int(np.argwhere(np.isinf(array))[0, 0]) + 1} has an infinite entry")
    blank = np.flatnonzero(np.isnan(array).all(axis=1))
    if blank.size:
        raise HousingError(f"{name} shape {int(blank[0]) + 1} was measured at no degree of freedom")
    return array


def two_sets(
    first: npt.ArrayLike, second: npt.ArrayLike, names: tuple[str, str] = ("the first set's", "the second set's")
) -> tuple[ShapeArray, ShapeArray]:
    """Two sets over the same degrees of freedom; see :func:`shape_set`.

    Raises
    ------
    HousingError
        Also where their numbers of degrees of freedom differ.
    """
    first_set, second_set = shape_set(first, names[0]), shape_set(second, names[1])
    if first_set.shape[1] != second_set.shape[1]:
        raise HousingError(
            f"{names[0]} shapes have {first_set.shape[1]} degrees of freedom and {names[1]} {second_set.shape[1]}; "
            "expected the same ones in both"
        )
    return first_set, second_set


def filled(shapes: ShapeArray) -> tuple[ShapeArray, BoolArray]:
    """Scale shapes to unit largest entry against overflow of squares; 0 where not measured; and mark those measured."""
    seen = ~np.isnan(shapes)
    values = np.where(seen, shapes, 0.0)
    largest = np.abs(values).max(axis=1, keepdims=True)
    return values / np.where(largest > 0.0, largest, 1.0), seen


def alike_measured(seen: BoolArray) -> list[tuple[BoolArray, npt.NDArray[np.int64]]]:
    """Degrees of freedom measured, and the modes measured at exactly these: most surveys have one such group."""
    patterns, group = np.unique(seen, axis=0, return_inverse=True)
    return [(pattern, np.flatnonzero(group.ravel() == number)) for number, pattern in enumerate(patterns)]


def modal_assurance_criterion(first: npt.ArrayLike, second: npt.ArrayLike) -> FloatArray:
    """Modal assurance criterion between every shape of one set and every shape of another.

    Parameters
    ----------
    first, second : array_like, shapes (a, n_dofs) and (b, n_dofs)
        Real or complex, each shape to any scale. NaN where not measured: two shapes are compared where both were.

    Returns
    -------
    ndarray, shape (a, b)
        From 0 to 1; NaN where two shapes share no degree of freedom; 0 for a shape that is zero wherever the other was
        measured.

    Raises
    ------
    HousingError
        Where the sets do not fit together.
    """
    first_set, second_set = two_sets(first, second)
    (a, seen_a), (b, seen_b) = filled(first_set), filled(second_set)
    shared = seen_a @ seen_b.T
    product = np.abs(a.conj() @ b.T) ** 2
    norms = (np.abs(a) ** 2 @ seen_b.T) * (seen_a @ np.abs(b.T) ** 2)
    # Rounding may lift a perfect match above one.
    return np.asarray(np.where(shared, np.minimum(product / np.where(norms > 0.0, norms, 1.0), 1.0), np.nan))


def auto_mac(shapes: npt.ArrayLike) -> FloatArray:
    """MAC of a set with itself, shape (n, n): the survey cannot distinguish modes with large off-diagonal values."""
    return modal_assurance_criterion(shapes, shapes)


def modal_scale_factor(reference: npt.ArrayLike, shapes: npt.ArrayLike) -> ComplexArray:
    """Return the modal scale factors: the least-squares factors from shapes to those of a reference, pair by pair.

    aᴴ b / aᴴ a with a a shape and b its reference (Allemang 1980), over the degrees of freedom that both have.

    Parameters
    ----------
    reference, shapes : array_like, shape (n, n_dofs)

    Returns
    -------
    ndarray of complex, shape (n,)
        Zero for a shape that is zero.

    Raises
    ------
    HousingError
        Where the sets do not fit together or differ in size.
    """
    target, scaled = two_sets(reference, shapes, ("the reference's", "the scaled"))
    if len(target) != len(scaled):
        raise HousingError(f"{len(scaled)} shapes to be scaled to {len(target)} of a reference; expected as many")
    both = ~(np.isnan(target) | np.isnan(scaled))
    b, a = np.where(both, target, 0.0), np.where(both, scaled, 0.0)
    norm = (np.abs(a) ** 2).sum(axis=1)
    return np.asarray((a.conj() * b).sum(axis=1) / np.where(norm > 0.0, norm, 1.0), dtype=np.complex128)


def largest_off_diagonal(matrix: FloatArray) -> float:
    """Largest off-diagonal entry of a square matrix without NaN; 0 where there is none."""
    others = matrix[~np.eye(len(matrix), dtype=bool)]
    return float(np.max(others[~np.isnan(others)], initial=0.0))


def comac(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Coordinate modal assurance criterion of Lieven and Ewins (1988).

        COMAC(q) = (Σ_r |φ_qr ψ_qr|)² / (Σ_r |φ_qr|² Σ_r |ψ_qr|²)

    over the pairs r. It sees amplitudes alone: a sensor mounted the wrong way round keeps 1, and so does one whose gain
    is wrong alike in every mode. One pair alone gives 1 everywhere.

    Parameters
    ----------
    model, measured : array_like, shape (n_pairs, n_dofs)
        Shapes, paired row by row; NaN where not measured.

    Returns
    -------
    ndarray, shape (n_dofs,)
        From 0 to 1; NaN at a degree of freedom that no pair has, or that moves in none.

    Raises
    ------
    HousingError
        Where the sets do not fit together or there is no pair.
    """
    phi, psi = _paired(model, measured)
    phi, psi = _unit_norm(np.where(np.isnan(psi), np.nan, phi)), _unit_norm(psi)
    product = np.nansum(np.abs(phi * psi), axis=0) ** 2
    norms = np.nansum(np.abs(phi) ** 2, axis=0) * np.nansum(np.abs(psi) ** 2, axis=0)
    return np.asarray(np.where(norms > 0.0, np.minimum(product / np.where(norms > 0.0, norms, 1.0), 1.0), np.nan))


def enhanced_comac(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Enhanced coordinate criterion of Hunt (1992): half the mean difference of shapes scaled to unit largest entry.

        ECOMAC(q) = Σ_r |φ_qr - ψ_qr| / 2L

    over the L pairs that have the degree of freedom, ψ turned to φ's phase by their modal scale factor. It sees signs
    and gains, unlike COMAC: 0 where all agree, and as much as a shape's own amplitude where a sensor is turned round.

    Parameters and raises as :func:`comac`.

    Returns
    -------
    ndarray, shape (n_dofs,)
        From 0 to 1; NaN at a degree of freedom that no pair has.
    """
    phi, psi = _paired(model, measured)
    # Model shapes are known everywhere, but both are scaled where both are.
    phi = np.where(np.isnan(psi), np.nan, phi)
    factor = modal_scale_factor(phi, psi)
    size = np.abs(factor)
    turned = psi * np.where(size > 0.0, factor / np.where(size > 0.0, size, 1.0), 1.0)[:, None]
    difference = np.abs(_unit(phi) - _unit(turned))
    pairs = (~np.isnan(difference)).sum(axis=0)
    return np.asarray(np.where(pairs > 0, np.nansum(difference, axis=0) / np.maximum(2 * pairs, 1), np.nan))


def _unit_norm(shapes: ShapeArray) -> ShapeArray:
    norm = np.sqrt(np.nansum(np.abs(shapes) ** 2, axis=1, keepdims=True))
    return np.asarray(shapes / np.where(norm > 0.0, norm, 1.0))


def _unit(shapes: ShapeArray) -> ShapeArray:
    largest = np.nanmax(np.abs(shapes), axis=1, keepdims=True)
    return np.asarray(shapes / np.where(largest > 0.0, largest, 1.0))


def _paired(model: npt.ArrayLike, measured: npt.ArrayLike) -> tuple[ShapeArray, ShapeArray]:
    phi, psi = two_sets(model, measured, ("the model's", "the measured"))
    if len(phi) != len(psi) or len(phi) == 0:
        raise HousingError(f"{len(phi)} model and {len(psi)} measured shapes; expected pairs, row by row")
    if np.isnan(phi).any() or not np.abs(phi).any(axis=1).all():
        raise HousingError("a model shape in a pair is zero, or unknown at a degree of freedom; expected it everywhere")
    return phi, psi


def phase_collinearity(shapes: npt.ArrayLike) -> FloatArray:
    """Modal phase collinearity, shape (n,): 1 for a real shape to any complex scale, 0 for a travelling wave."""
    values, _ = filled(shape_set(shapes, "complex"))
    total = (np.abs(values) ** 2).sum(axis=1)
    ratio = np.abs((values**2).sum(axis=1)) / np.where(total > 0.0, total, 1.0)
    return np.asarray(np.where(total > 0.0, np.minimum(ratio, 1.0) ** 2, 1.0))


def mean_phase(shapes: npt.ArrayLike) -> FloatArray:
    """Angle of the line nearest to a shape's entries, from -π/2 (left out) to π/2, shape (n,) [rad]."""
    values, _ = filled(shape_set(shapes, "complex"))
    return np.asarray(0.5 * np.angle((values**2).sum(axis=1)))


def real_shapes(shapes: npt.ArrayLike) -> FloatArray:
    """Complex shapes turned on to the real axis by their mean phase, and their real parts; NaN stays.

    These real shapes are the nearest to the given ones at any phase: the part dropped is the minor axis of their
    scatter, a part (1 - √MPC) / 2 of their square.

    Parameters
    ----------
    shapes : array_like, shape (n, n_dofs)

    Returns
    -------
    ndarray, shape (n, n_dofs)
        Real shapes of arbitrary sign.
    """
    return np.asarray(_aligned(shapes).real)


def _aligned(shapes: npt.ArrayLike) -> ComplexArray:
    complex_shapes = shape_set(shapes, "complex")
    return np.asarray(complex_shapes * np.exp(-1j * mean_phase(complex_shapes))[:, None], dtype=np.complex128)
