"""Receptance of the coupled system about a contact state, by direct solution or by mode superposition.

With q = H(s) f, H(s) = (s² I + s C + K)⁻¹ and s = iw. Superposition uses the expansion of :mod:`coupling.eigenpairs`,

    H(s) = X / s² - (Σ q pᴴ) / s + Σ q pᴴ / (s - λ),

over all modes, rigid-body motions included, so that both ways give one function; nothing is truncated.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_state import ContactState, linear_matrices, mean_contact
from coupling.eigenpairs import Eigenpairs
from coupling.errors import CouplingError, ModesError
from coupling.modes import CoupledModes
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_EVEN_POINTS = 600  # across a band, beside those of each resonance
_AROUND = np.array([-8.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 8.0])  # half-power half-widths
_SUM_RULE = 1e-6  # largest error of the modes' sum rule for a superposition


def receptance(
    system: CoupledSystem,
    outputs: FloatArray,
    inputs: FloatArray,
    frequencies: FloatArray,
    *,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> ComplexArray:
    """Motions along output directions by unit harmonic forces along input directions.

    Parameters
    ----------
    system : CoupledSystem
    outputs, inputs : ndarray, shapes (o, n) and (i, n)
        Directions of motion; a motion of a component by :func:`coupling.system.embed`.
    frequencies : ndarray, shape (f,)
        w [rad/s], not 0; the response at -w is the conjugate.
    contact : ContactState, optional
        By default the mean contact.
    modes : CoupledModes, optional
        Modes about the same contact, to be superposed; by default the system is solved at every frequency.

    Returns
    -------
    ndarray of complex, shape (f, o, i)
        [m/N] between translations.

    Raises
    ------
    CouplingError
        For directions of another length, or a frequency of 0.
    ModesError
        Where the modes are not complete, or an undamped mode is driven at its own frequency.
    """
    for what, rows in (("outputs", outputs), ("inputs", inputs)):
        if rows.ndim != 2 or rows.shape[1] != system.size:
            raise CouplingError(f"{what} of shape {rows.shape}; expected (any, {system.size})")
    loads = np.broadcast_to(inputs, (len(frequencies), *inputs.shape))
    return np.asarray(np.einsum("fin,on->foi", response(system, loads, frequencies, contact, modes), outputs))


def response(
    system: CoupledSystem,
    loads: npt.NDArray[np.float64] | ComplexArray,
    frequencies: FloatArray,
    contact: ContactState | None = None,
    modes: CoupledModes | None = None,
) -> ComplexArray:
    """Coordinates H(iw) f under loads f of shape (f, i, n): shape (f, i, n). See :func:`receptance`."""
    w = np.asarray(frequencies, dtype=np.float64)
    if not np.all(np.isfinite(w)) or np.any(w == 0.0):
        raise CouplingError("frequencies that are 0 or not finite; expected others: a free machine drifts at 0")
    if modes is not None:
        return superposed(modes.pairs, loads, w)
    stiffness, damping = linear_matrices(system, mean_contact(system) if contact is None else contact)
    found = np.empty(loads.shape, dtype=np.complex128)
    for number, (each, load) in enumerate(zip(w, loads, strict=True)):
        dynamic = stiffness + 1j * each * damping
        dynamic[np.diag_indices(system.size)] -= each**2
        try:
            found[number] = np.linalg.solve(dynamic, load.T).T
        except np.linalg.LinAlgError as error:
            raise ModesError(
                f"an undamped mode is driven at its own frequency, {each / (2.0 * np.pi):.6g} Hz; give it damping or "
                "leave that frequency out"
            ) from error
    return found


def superposed(
    pairs: Eigenpairs, loads: npt.NDArray[np.float64] | ComplexArray, frequencies: FloatArray
) -> ComplexArray:
    """H(iw) f from all eigenpairs, loads and result of shape (f, i, n).

    Raises
    ------
    ModesError
        Where the eigenpairs fail their sum rule: at a nearly defective eigenvalue.
    """
    if not pairs.sum_rule <= _SUM_RULE:
        raise ModesError(
            f"the coupled modes miss their sum rule by {pairs.sum_rule:.1e}: two of them are all but one, as at "
            "critical damping, and cannot be superposed; solve the system directly instead"
        )
    s = 1j * frequencies
    distance = s[:, None] - pairs.values
    if np.any(distance == 0.0):
        raise ModesError("an undamped mode is driven at its own frequency; give it damping or leave that frequency out")
    # 1 / (s - λ) - 1 / s = λ / (s (s - λ)), without the difference's loss of digits at high frequency.
    gains = pairs.values / (s[:, None] * distance)
    driven = np.einsum("mn,fin->fim", pairs.left.conj(), loads, optimize=True)
    moved = np.einsum("fim,mn->fin", driven * gains[:, None, :], pairs.right, optimize=True)
    if pairs.drifts:
        moved = moved + np.einsum("fin,kn->fik", loads, pairs.drift, optimize=True) / (s**2)[:, None, None]
    return np.asarray(moved)


def resonance_grid(modes: CoupledModes, low: float, high: float) -> FloatArray:
    """Frequency grid of a band that resolves every resonance, ascending [rad/s].

    Raises
    ------
    CouplingError
        Unless 0 < low < high.
    """
    if not 0.0 < low < high:
        raise CouplingError(f"a band from {low:g} to {high:g} rad/s; expected 0 < from < to")
    swinging = modes.eigenvalues[modes.eigenvalues.imag > 0.0]
    near = swinging.imag[:, None] + np.abs(swinging.real)[:, None] * _AROUND
    grid = np.unique(np.concatenate([np.linspace(low, high, _EVEN_POINTS), near.ravel()]))
    # An undamped mode has no finite response at its own frequency.
    undamped = swinging.imag[np.abs(swinging.real) <= 1e-12 * np.abs(swinging)]
    return np.asarray(grid[(grid >= low) & (grid <= high) & ~np.isin(grid, undamped)])
