"""Frequency response assurance criterion (FRAC): likeness of responses at each point over frequency.

Responses need no modes to be identified, and no pairing; but a resonance a few per cent off costs all that the
criterion can show, so it follows once frequencies are right. A squared cosine sees shape and not size.
"""

from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.modes.receptance import receptance
from gearwhine.numerics.arrays import ComplexArray, FloatArray

Quantity = Literal["displacement", "velocity", "acceleration"]

_RATES: dict[Quantity, int] = {"displacement": 0, "velocity": 1, "acceleration": 2}


def synthesised_responses(
    modes: ModeSet,
    damping_ratios: FloatArray,
    driven: sparse.csr_array,
    survey: sparse.csr_array,
    frequencies: FloatArray,
    quantity: Quantity = "acceleration",
) -> ComplexArray:
    """Return the model's frequency responses at the measured degrees of freedom to unit forces, with residual modes.

    (iw)^n times the receptance (:func:`gearwhine.housing.modes.receptance.receptance`), n = 0, 1, 2.

    Parameters
    ----------
    modes : ModeSet
        n modes.
    damping_ratios : ndarray, shape (n,)
        Measured ratios, where the sizes at resonance are to be compared.
    driven : scipy.sparse.csr_array, shape (r, 3 n_nodes)
        Motions along the forces, one a reference.
    survey : scipy.sparse.csr_array, shape (d, 3 n_nodes)
        The measured motions.
    frequencies : ndarray, shape (f,)
        w [rad/s].
    quantity : str
        Measured quantity of the motion per unit force.

    Returns
    -------
    ndarray of complex, shape (d, r, f)
        Responses [m/N], [m/(N s)] or [m/(N s²)].

    Raises
    ------
    HousingError
        Where the quantity is none of these, or as :func:`gearwhine.housing.modes.receptance.receptance`.
    """
    if quantity not in _RATES:
        raise HousingError(f"a response in {quantity!r}; expected one of {', '.join(_RATES)}")
    motion = receptance(modes, damping_ratios, driven, survey, frequencies)
    return np.asarray(np.moveaxis(motion, 0, 2) * (1j * np.asarray(frequencies)) ** _RATES[quantity])


def frac(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Frequency response assurance criterion at each degree of freedom (Heylen and Lammens 1996).

        FRAC = |Σ_w H_a* H_x|² / (Σ_w |H_a|² Σ_w |H_x|²)

    Parameters
    ----------
    model, measured : array_like of complex, shape (..., f)
        Responses of one shape, such as (n_dofs, n_references, f). NaN where a line was not measured: it is left out.

    Returns
    -------
    ndarray, shape (...,)
        From 0 to 1; NaN where no line is shared.

    Raises
    ------
    HousingError
        Where their shapes differ.
    """
    a, x = _alike(model, measured)
    product = np.abs((a.conj() * x).sum(axis=-1)) ** 2
    whole = (np.abs(a) ** 2).sum(axis=-1) * (np.abs(x) ** 2).sum(axis=-1)
    is_known = whole > 0.0
    return np.asarray(np.where(is_known, np.minimum(product / np.where(is_known, whole, 1.0), 1.0), np.nan))


def _alike(model: npt.ArrayLike, measured: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    a, x = np.array(model, dtype=np.complex128), np.array(measured, dtype=np.complex128)
    if a.shape != x.shape or a.ndim < 1 or a.size == 0:
        raise HousingError(f"responses of the shapes {a.shape} and {x.shape}; expected them alike")
    unknown = np.isnan(a) | np.isnan(x)
    a[unknown] = x[unknown] = 0.0
    return a, x
