"""Summary of a periodic motion on a branch: its figures, and the states at the starts of its segments."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from coupling.periodic.floquet import FloquetMultipliers
from coupling.periodic.response import PeriodicResponse

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BranchMotion:
    """Summary of a :class:`coupling.PeriodicResponse`; n coordinates, c contacts, K segments.

    The whole motion takes a hundred times the memory; :meth:`coupling.ResponseCurve.motion` computes it again.

    Attributes
    ----------
    period, floquet, residual, error, elements, switches, level, newton_steps
        Of the response.
    displacements, velocities : ndarray, shape (K, n)
        At the starts of the segments, the first at t = 0.
    mean_force, peak_force : ndarray, shape (c,)
        Of each contact over the period [N].
    mean_compression, rms_compression : ndarray, shape (c,)
        The mean, and the root mean square about it [m].
    contact_loss : ndarray, shape (c,)
        Part of the period in which the flanks are apart.
    """

    period: float
    floquet: FloquetMultipliers
    residual: float
    error: float
    elements: int
    switches: int
    level: int
    newton_steps: int
    displacements: FloatArray = field(repr=False)
    velocities: FloatArray = field(repr=False)
    mean_force: FloatArray
    peak_force: FloatArray
    mean_compression: FloatArray
    rms_compression: FloatArray
    contact_loss: FloatArray

    @property
    def stable(self) -> bool:
        """Whether no small disturbance grows."""
        return self.floquet.stable

    @property
    def displacement(self) -> FloatArray:
        """At t = 0, shape (n,)."""
        return np.asarray(self.displacements[0])

    @property
    def velocity(self) -> FloatArray:
        """At t = 0, shape (n,)."""
        return np.asarray(self.velocities[0])


def motion_summary(response: PeriodicResponse, segments: int) -> BranchMotion:
    """Summary of a response whose period is cut into some segments."""
    displacements, velocities = response.at_nodes(segments)
    return BranchMotion(
        period=response.period,
        floquet=response.floquet,
        residual=response.residual,
        error=response.error,
        elements=response.elements,
        switches=response.switches,
        level=response.level,
        newton_steps=response.newton_steps,
        displacements=displacements,
        velocities=velocities,
        mean_force=response.mean_force,
        peak_force=response.peak_force,
        mean_compression=response.mean_compression,
        rms_compression=response.rms_compression,
        contact_loss=response.contact_loss,
    )
