"""Subspaces of close modes: MAC with a span, nearest combination, principal angles.

Two modes of one frequency have no shapes of their own: any two combinations of them are as good, and a test and a
model find different ones. A small error of the model mixes modes that are merely close. What is compared then
is the space that they span: by the angles between two spaces, or by the part of a measured shape that lies in one.
"""

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.housing.correlation.modal_assurance_criterion import alike_measured, filled, two_sets
from gearwhine.housing.errors import HousingError
from gearwhine.numerics.arrays import FloatArray, IntArray

_RANK = 1e-10  # singular values below this part of the largest are no directions


def close_modes(frequencies: npt.ArrayLike, closeness: float) -> tuple[IntArray, ...]:
    """Group close modes: neighbours within a part of their frequency; a mode apart is a group of one.

    Parameters
    ----------
    frequencies : array_like, shape (n,)
        Ascending, zero for rigid motion, which is close to rigid motion alone.
    closeness : float
        Gap of neighbours, as a part of the higher frequency; 0 joins equal ones only.

    Returns
    -------
    tuple of ndarray of int
        Indices, each once, ascending.

    Raises
    ------
    HousingError
        Where frequencies are negative or descend, or closeness is not from 0 to 1.
    """
    values = np.asarray(frequencies, dtype=np.float64)
    if not 0.0 <= closeness < 1.0:
        raise HousingError(f"a closeness of {closeness}; expected a part of the frequency, from 0 to below 1")
    if np.any(np.diff(values) < 0.0) or np.any(values < 0.0) or not np.isfinite(values).all():
        raise HousingError("frequencies must ascend from zero or above")
    apart = np.flatnonzero(np.diff(values) > closeness * values[1:]) + 1
    return tuple(np.split(np.arange(len(values)), apart))


def span_mac(basis: npt.ArrayLike, shapes: npt.ArrayLike) -> FloatArray:
    """MAC of shapes with the nearest combination of a basis: ‖P ψ‖² / ‖ψ‖², P the projector on the span.

    It is the largest MAC that any member of the span has with the shape, so no less than that of any shape of the
    basis, and does not change when these are mixed. A random shape reaches k/n for a basis of k over n degrees of
    freedom.

    Parameters
    ----------
    basis : array_like, shape (k, n_dofs)
        Shapes without NaN; k below the degrees of freedom that each of ``shapes`` has.
    shapes : array_like, shape (n, n_dofs)
        NaN where not measured.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    HousingError
        Where the sets do not fit together, the basis has gaps, or spans all that a shape could be.
    """
    return np.asarray(np.minimum(_projected(basis, shapes)[1], 1.0))


def nearest_in_span(basis: npt.ArrayLike, shapes: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    """Return the combination of a basis nearest to each shape, at every degree of freedom; see :func:`span_mac`."""
    return _projected(basis, shapes)[0]


def principal_angles(first: npt.ArrayLike, second: npt.ArrayLike) -> FloatArray:
    """Angles between the spans of two sets, descending, as many as the smaller set has shapes [rad].

    All zero: one span holds the other. The largest at π/2: something in one is unlike everything in the other
    (Björck and Golub 1973). The degrees of freedom are those where every shape of both was measured.

    Raises
    ------
    HousingError
        Where the sets do not fit together or have more shapes than shared degrees of freedom.
    """
    first_set, second_set = two_sets(first, second)
    seen = ~(np.isnan(first_set).any(axis=0) | np.isnan(second_set).any(axis=0))
    largest = max(len(first_set), len(second_set))
    if seen.sum() < largest:
        raise HousingError(
            f"{largest} shapes share {int(seen.sum())} degrees of freedom; angles between spans need at least as many"
        )
    (a, _), (b, _) = filled(first_set[:, seen]), filled(second_set[:, seen])
    return np.asarray(linalg.subspace_angles(a.T, b.T))


def _projected(basis: npt.ArrayLike, shapes: npt.ArrayLike) -> tuple[npt.NDArray[np.complex128], FloatArray]:
    phi, psi = two_sets(basis, shapes, ("the basis'", "the projected"))
    if np.isnan(phi).any():
        raise HousingError("a shape of the basis is unknown at a degree of freedom; expected it everywhere")
    phi, _ = filled(phi)
    scaled, seen = filled(psi)
    nearest = np.empty(psi.shape, dtype=np.complex128)
    part = np.empty(len(psi))
    for pattern, modes in alike_measured(seen):
        if len(phi) >= pattern.sum():
            raise HousingError(
                f"a basis of {len(phi)} shapes over the {int(pattern.sum())} degrees of freedom of shape "
                f"{int(modes[0]) + 1} is like anything; expected fewer shapes than degrees of freedom"
            )
        left, sizes, right = np.linalg.svd(phi[:, pattern].T, full_matrices=False)
        independent = sizes > _RANK * sizes[0]
        inner = left[:, independent].conj().T @ scaled[np.ix_(modes, pattern)].T
        whole = (np.abs(scaled[modes]) ** 2).sum(axis=1)
        part[modes] = (np.abs(inner) ** 2).sum(axis=0) / np.where(whole > 0.0, whole, 1.0)
        nearest[modes] = ((right[independent].conj().T / sizes[independent]) @ inner).T @ phi
    size = np.abs(np.where(seen, psi, 0.0)).max(axis=1, keepdims=True)
    return nearest * size, part
