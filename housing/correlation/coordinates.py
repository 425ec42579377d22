"""Coordinate assurance criteria (COMAC, enhanced COMAC): differences of paired shapes at each degree of freedom.

Shapes to unknown scales cannot be compared at one place before they are scaled alike. Here both shapes of a pair are
scaled to unit norm (``comac``) or unit largest entry (``enhanced_comac``) over the degrees of freedom that both have.
"""

import numpy as np
import numpy.typing as npt

from housing.correlation.assurance import modal_scale_factor
from housing.correlation.shape_sets import FloatArray, ShapeArray, two_sets
from housing.errors import HousingError


def comac(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Coordinate modal assurance criterion of Lieven and Ewins (1988).

        COMAC(q) = (Σ_r |φ_qr ψ_qr|)² / (Σ_r |φ_qr|² Σ_r |ψ_qr|²)

    over the pairs r. It sees amplitudes alone: a sensor mounted the wrong way round keeps 1, and so does one whose gain
    is wrong alike in every mode. One pair alone gives 1 everywhere.

    Parameters
    ----------
    model, measured : array_like, shape (n_pairs, n_dofs)
        Row by row paired; NaN where not measured.

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
