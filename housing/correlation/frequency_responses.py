"""Frequency response assurance criteria: FRAC at each point over frequency, RVAC and FDAC at each frequency.

Responses need no modes to be identified, and no pairing; but a resonance a few per cent off costs all that these
criteria can show, so they follow once frequencies are right. Squared cosines see shape and not size:
:func:`amplitude_correlation` sees both.
"""

from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import sparse

from gearwhine.housing.correlation.modal_assurance_criterion import ComplexArray, FloatArray, modal_assurance_criterion
from gearwhine.housing.errors import HousingError
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.housing.modes.receptance import receptance

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
    return _coherence(a, x, axis=-1)


def response_vector_assurance(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """MAC of the shapes of vibration at each line (Heylen, Lammens and Sas 1997: RVAC), over the degrees of freedom.

    Grafe (1998) calls it the global shape correlation.

    Parameters
    ----------
    model, measured : array_like of complex, shape (n_dofs, ..., f)

    Returns
    -------
    ndarray, shape (..., f)

    Raises
    ------
    HousingError
        Where their shapes differ.
    """
    a, x = _alike(model, measured)
    return _coherence(a, x, axis=0)


def amplitude_correlation(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Likeness in shape and size at each line: the global amplitude correlation of Grafe (1998).

        2 |h_aᴴ h_x| / (h_aᴴ h_a + h_xᴴ h_x)

    It is 1 only where the responses are equal but for one phase; a factor g between them gives 2g / (1 + g²).
    Parameters and result are those of :func:`response_vector_assurance`.
    """
    a, x = _alike(model, measured)
    product = np.abs((a.conj() * x).sum(axis=0))
    return _ratio(2.0 * product, (np.abs(a) ** 2 + np.abs(x) ** 2).sum(axis=0))


def fdac(model: npt.ArrayLike, measured: npt.ArrayLike) -> FloatArray:
    """Frequency domain assurance criterion: MAC of the model's vibration at every line with the test's at every line.

    Pascual, Golinval and Razeto (1997). Resonances that agree in shape but not in frequency stand as ridges beside the
    diagonal, at a distance equal to the shift in frequency.

    Parameters
    ----------
    model, measured : array_like of complex, shapes (n_dofs, f) and (n_dofs, g)
        Responses to one reference; NaN where not measured.

    Returns
    -------
    ndarray, shape (f, g)

    Raises
    ------
    HousingError
        Where the degrees of freedom differ.
    """
    return modal_assurance_criterion(np.asarray(model).T, np.asarray(measured).T)


def _alike(model: npt.ArrayLike, measured: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    a, x = np.array(model, dtype=np.complex128), np.array(measured, dtype=np.complex128)
    if a.shape != x.shape or a.ndim < 1 or a.size == 0:
        raise HousingError(f"responses of the shapes {a.shape} and {x.shape}; expected them alike")
    unknown = np.isnan(a) | np.isnan(x)
    a[unknown] = x[unknown] = 0.0
    return a, x


def _coherence(a: ComplexArray, x: ComplexArray, axis: int) -> FloatArray:
    product = np.abs((a.conj() * x).sum(axis=axis)) ** 2
    return _ratio(product, (np.abs(a) ** 2).sum(axis=axis) * (np.abs(x) ** 2).sum(axis=axis))


def _ratio(part: FloatArray, whole: FloatArray) -> FloatArray:
    is_known = whole > 0.0
    return np.asarray(np.where(is_known, np.minimum(part / np.where(is_known, whole, 1.0), 1.0), np.nan))
