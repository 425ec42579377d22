"""Cross-orthogonality: measured shapes against the model's in the model's mass, reduced to the survey.

The mass matrix of a finite-element model has other degrees of freedom than the survey. SEREP reduces it without loss
for the modes it is given (O'Callahan, Avitabile and Riemer 1989): with Φ the model's mass-normalised shapes at the
survey's degrees of freedom, T = Φ_full Φ⁺ expands them, and

    M_s = Tᵀ M T = (Φ⁺)ᵀ Φ⁺,    Φᵀ M_s Φ = I.

So the cross-orthogonality of a measured shape is Φᵀ M_s ψ = Φ⁺ ψ: its coordinates in the model's modes by least
squares, the same whether the matrix is formed or not. Here it is not. The reduced mass knows these modes alone: the
part of a measured shape outside their span has no mass; :func:`outside_span` gives its size.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.housing.correlation.modal_assurance_criterion import ShapeArray, alike_measured, two_sets
from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import ComplexArray, FloatArray

# Beyond this condition of the shapes, rounding and noise of a part in a thousand decide the coordinates.
_WORST_CONDITION = 1e3


def modal_coordinates(model: npt.ArrayLike, measured: npt.ArrayLike) -> ComplexArray:
    """Coordinates of measured shapes in the model's modes: Φ⁺ ψ, the cross-orthogonality before normalisation.

    Parameters
    ----------
    model : array_like, shape (n_modes, n_dofs)
        Mass-normalised shapes [1/√kg].
    measured : array_like, shape (n_measured, n_dofs)
        NaN where not measured: a shape is then taken at its own degrees of freedom, with Φ at these.

    Returns
    -------
    ndarray of complex, shape (n_modes, n_measured)
        To the measured shapes' scale.

    Raises
    ------
    HousingError
        Where a shape was measured at fewer degrees of freedom than there are modes, or at ones that cannot separate
        them.
    """
    phi, psi = two_sets(model, measured, ("the model's", "the measured"))
    coordinates = np.empty((len(phi), len(psi)), dtype=np.complex128)
    for pattern, modes in alike_measured(~np.isnan(psi)):
        which = f"measured shape {int(modes[0]) + 1} has"
        coordinates[:, modes] = _inverse(phi[:, pattern], which) @ psi[np.ix_(modes, pattern)].T
    return coordinates


def cross_orthogonality(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Normalised cross-orthogonality |φᵀ M_s ψ| / √(ψᴴ M_s ψ), shape (n_modes, n_measured).

    The columns' squares add up to 1: each entry squared is the part of a measured shape's mass-weighted square that a
    model mode holds. Common practice asks for 0.9 on the diagonal and at most 0.1 off it (NASA-STD-5002).

    Parameters and raises as :func:`modal_coordinates`.
    """
    coordinates = np.abs(modal_coordinates(model, measured))
    norms = np.linalg.norm(coordinates, axis=0)
    return np.asarray(coordinates / np.where(norms > 0.0, norms, 1.0))


def outside_span(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Return the part of each measured shape's square outside the span of the model's modes, shape (n_measured,).

    A large part points to noise, an error of geometry, or a mode that the model lacks. Raises as
    :func:`modal_coordinates`.
    """
    phi, psi = two_sets(model, measured, ("the model's", "the measured"))
    left = psi - modal_coordinates(phi, psi).T @ phi
    whole = np.nansum(np.abs(psi) ** 2, axis=1)
    return np.asarray(np.nansum(np.abs(left) ** 2, axis=1) / np.where(whole > 0.0, whole, 1.0))


def _inverse(shapes: ShapeArray, which: str) -> ShapeArray:
    """Φ⁺ of shapes (n_modes, n_dofs), as (n_modes, n_dofs)."""
    modes, freedoms = shapes.shape
    if freedoms < modes:
        raise HousingError(
            f"{which} {freedoms} degrees of freedom for {modes} model modes: SEREP needs at least as many; measure at "
            "more places, or compare fewer modes"
        )
    condition = float(np.linalg.cond(shapes))
    if not condition < _WORST_CONDITION:
        raise HousingError(
            f"{which} {freedoms} degrees of freedom that cannot tell {modes} model modes apart (condition "
            f"{condition:.0e}, at most {_WORST_CONDITION:.0e}): see the auto-MAC; measure elsewhere, or compare fewer"
        )
    return np.asarray(np.linalg.pinv(shapes.T))
