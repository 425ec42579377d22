"""The proof that travels with a set of modes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .errors import IncompleteModesError

FloatArray = npt.NDArray[np.float64]

ENERGY_TOLERANCE = 1e-8
ORTHONORMALITY_TOLERANCE = 1e-8
# Of a root refined on the exact equations: its relative residual, and how far it still moves when it is done.
ACCEPTED = 1e-11
SETTLED = 2e-14
MOST_STEPS = 14  # of Newton's method


@dataclass(frozen=True)
class ModeCertificate:
    """What the root count demands, what the mode set holds, and how well its modes satisfy the energies.

    Attributes
    ----------
    limit
        rad/s below which every mode is claimed.
    expected
        Number of modes below the limit by the Wittrick–Williams count, doubles twice, rigid motions included.
    found
        Number of independent shapes held whose own energies give their frequency.
    max_residual
        Largest relative difference between a mode's ω² and its strain over kinetic energy, both integrated
        along the shaft; of rigid motions, zero.
    orthonormality
        Largest entry of |Φᵀ M Φ − I|.
    """

    limit: float
    expected: int
    found: int
    max_residual: float
    orthonormality: float

    @property
    def complete(self) -> bool:
        """Whether every mode below the limit is held."""
        return self.found == self.expected


def certify(
    limit: float, expected: int, frequencies: FloatArray, mass: FloatArray, stiffness: FloatArray
) -> ModeCertificate:
    """Certificate of modes with the given frequencies (m,) and integrated matrices (m, m).

    Raises
    ------
    IncompleteModesError
        Shapes are missing, dependent, or do not have the energies of their frequencies.
    """
    squared = frequencies**2
    moving = squared > 0.0
    residual = np.abs(stiffness.diagonal()[moving] / squared[moving] - 1.0)
    worst = float(residual.max(initial=0.0))
    skewness = float(np.abs(mass - np.eye(squared.size)).max(initial=0.0))
    failed = int(np.count_nonzero(~(residual <= ENERGY_TOLERANCE)))
    found = int(squared.size) - failed if skewness <= ORTHONORMALITY_TOLERANCE else 0
    certificate = ModeCertificate(limit, expected, found, worst, skewness)
    if not certificate.complete:
        raise IncompleteModesError(
            f"{found} of {expected} modes below {limit:g} rad/s pass their energy check (worst residual "
            f"{worst:.1e}, orthonormality {skewness:.1e}); lower the frequency limit, or check the model for parts "
            "that differ by many orders of magnitude in stiffness"
        )
    return certificate
