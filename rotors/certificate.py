"""Certificate of a set of modes: the proof that none is missing and that each is accurate."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.errors import IncompleteModesError

ENERGY_TOLERANCE = 1e-8
ORTHONORMALITY_TOLERANCE = 1e-8
# Accepted relative residual of a root of the exact equations, and relative correction at which it has converged.
ACCEPTED = 1e-11
SETTLED = 2e-14
MOST_STEPS = 14  # largest number of Newton steps


@dataclass(frozen=True)
class ModeCertificate:
    """Proof that a set of modes is complete: an independent count of the modes, and how accurate those held are.

    Attributes
    ----------
    limit : float
        Frequency below which every mode is claimed; for whirl every oscillating motion with |λ| below it [rad/s].
    expected : int
        Number of modes below the limit by the count, doubles twice, rigid motions included.
    found : int
        Number of independent modes in the set below the limit.
    max_residual : float
        Planar and torsional modes: largest relative difference between ω² and the strain over the kinetic energy of a
        shape, both integrated along the shaft; zero of rigid motions. Whirl: largest last correction of a root of the
        exact equations, relative to the root.
    method : str
        ``"wittrick-williams"``: the root count of `gearwhine.rotors.transfer_matrix.wittrick_williams`. ``"inertia"``:
        the same count of the Hermitian dynamic stiffness (`gearwhine.rotors.whirl.completeness`). ``"winding"``: the
        argument principle (`gearwhine.rotors.whirl.argument_principle`). ``"crossings"``: crossings of a Campbell
        diagram, whose branches are proved.
    orthonormality : float
        Largest entry of |Φᵀ M Φ − I|; zero for whirl, whose modes have no such products.
    """

    limit: float
    expected: int
    found: int
    max_residual: float
    method: str
    orthonormality: float = 0.0

    @property
    def complete(self) -> bool:
        """Whether the set has every mode below the limit."""
        return self.found == self.expected


def combined_certificate(parts: Sequence[ModeCertificate], limit: float, method: str) -> ModeCertificate:
    """Certificate of several independent sets of motions below one limit [rad/s], counted by one method."""
    return ModeCertificate(
        limit,
        sum(part.expected for part in parts),
        sum(part.found for part in parts),
        max((part.max_residual for part in parts), default=0.0),
        method,
        max((part.orthonormality for part in parts), default=0.0),
    )


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
    accepted = int(squared.size) - failed if skewness <= ORTHONORMALITY_TOLERANCE else 0
    certificate = ModeCertificate(limit, expected, accepted, worst, "wittrick-williams", skewness)
    if not certificate.complete:
        raise IncompleteModesError(
            f"{accepted} of {expected} modes below {limit:g} rad/s pass their energy check (worst residual "
            f"{worst:.1e}, orthonormality {skewness:.1e}); lower the frequency limit, or check the model for parts "
            "that differ by many orders of magnitude in stiffness"
        )
    return certificate
