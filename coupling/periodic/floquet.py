"""Floquet multipliers: stability of a periodic motion."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Loss = Literal["fold", "period doubling", "Neimark-Sacker"]

STABLE_WITHIN = 1e-7
"""Tolerance of a stable multiplier beyond one, for the rounding of an undamped motion."""


@dataclass(frozen=True, eq=False)
class FloquetMultipliers:
    """Eigenvalues of the monodromy, the largest first.

    Attributes
    ----------
    values : ndarray of complex, shape (2 N,)
        A disturbance along the eigenvector number i is multiplied by values[i] every period.
    period : float
        [s].
    """

    values: ComplexArray
    period: float

    @property
    def exponents(self) -> ComplexArray:
        """ln(multiplier) / period [1/s], the frequency within half the driving one; -inf for a multiplier of zero."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.values.astype(np.complex128)) / self.period)

    @property
    def largest(self) -> float:
        """Largest modulus; 0 where there is nothing to disturb."""
        return float(np.abs(self.values).max(initial=0.0))

    @property
    def stable(self) -> bool:
        """Whether no disturbance grows."""
        return self.largest <= 1.0 + STABLE_WITHIN

    @property
    def growing(self) -> int:
        """Number of multipliers outside the unit circle."""
        return int(np.count_nonzero(np.abs(self.values) > 1.0 + STABLE_WITHIN))

    @property
    def leaving(self) -> Loss | None:
        """Kind of instability, by the place where the largest multiplier left the unit circle; None if stable.

        At +1 the motion has a fold and jumps; at -1 a motion of twice the period replaces it; a pair elsewhere brings a
        second frequency (Neimark and Sacker).
        """
        if self.stable:
            return None
        worst = self.values[np.argmax(np.abs(self.values))]
        if abs(worst.imag) > 1e-9 * abs(worst):
            return "Neimark-Sacker"
        return "fold" if worst.real > 0.0 else "period doubling"


def multipliers(monodromy: FloatArray, period: float) -> FloquetMultipliers:
    """Eigenvalues of a monodromy matrix."""
    values = np.linalg.eigvals(monodromy).astype(np.complex128)
    return FloquetMultipliers(values[np.argsort(-np.abs(values), kind="stable")], period)
