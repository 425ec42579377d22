"""Mode superposition: the receptance of a system from all its eigenpairs.

With s = iω and the eigenpairs λ, q, p of :mod:`gearwhine.coupling.linear.eigenpairs`,

    H(s) = X / s² - (Σ q pᴴ) / s + Σ q pᴴ / (s - λ),

rigid-body motions included, so that it is the function (s² I + s C + K)⁻¹ itself; nothing is truncated.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import ModesError
from gearwhine.coupling.linear.eigenpairs import Eigenpairs
from gearwhine.numerics.arrays import ComplexArray, FloatArray

SUM_RULE = 1e-6
"""Largest error of the modes' sum rule for a superposition."""


def superposed(
    pairs: Eigenpairs,
    loads: npt.NDArray[np.float64] | ComplexArray,
    frequencies: FloatArray,
    outputs: FloatArray | None = None,
) -> ComplexArray:
    """H(iw) f from all eigenpairs, loads and result of shape (f, i, n); loads (1, i, n) are the same at all w.

    With output directions (o, n) the result is the motion along these alone, of shape (f, i, o).

    Raises
    ------
    ModesError
        Where the eigenpairs fail their sum rule: at a nearly defective eigenvalue.
    """
    if not pairs.sum_rule <= SUM_RULE:
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
    right, drift = pairs.right, pairs.drift
    if outputs is not None:
        right, drift = right @ outputs.T, outputs @ drift
    driven = np.einsum("mn,fin->fim", pairs.left.conj(), loads, optimize=True)
    moved = np.einsum("fim,mn->fin", driven * gains[:, None, :], right, optimize=True)
    if pairs.drifts:
        moved = moved + np.einsum("fin,kn->fik", loads, drift, optimize=True) / (s**2)[:, None, None]
    return np.asarray(moved)
