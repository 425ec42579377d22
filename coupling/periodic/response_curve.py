"""Periodic motions over speed: one branch, with what happens along it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.periodic.response import PeriodicResponse
from coupling.periodic.shooting import periodic_response
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
Event = Literal["fold", "period doubling", "Neimark-Sacker", "branch point"]


@dataclass(frozen=True)
class Bifurcation:
    """Where a branch turns back in speed, or its stability changes.

    Attributes
    ----------
    index : int
        Of its point on the curve.
    kind : str
        ``fold`` where the branch turns back and a real machine jumps; ``period doubling`` where a multiplier passes
        -1, ``Neimark-Sacker`` where a pair leaves the unit circle, ``branch point`` where one passes +1 on a branch
        that goes on.
    speed : float
        In the unit of the curve.
    """

    index: int
    kind: Event
    speed: float


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """A branch of periodic motions, p points in the order in which they were followed; c contacts.

    Attributes
    ----------
    speeds : ndarray, shape (p,)
        In the unit that ``system_at`` takes.
    responses : tuple of PeriodicResponse
    bifurcations : tuple of Bifurcation
    """

    speeds: FloatArray
    responses: tuple[PeriodicResponse, ...]
    bifurcations: tuple[Bifurcation, ...]
    system_at: Callable[[float], CoupledSystem] = field(repr=False)
    periods: int = 1

    @property
    def folds(self) -> tuple[Bifurcation, ...]:
        """Where the branch turns back in speed."""
        return tuple(event for event in self.bifurcations if event.kind == "fold")

    @property
    def stable(self) -> npt.NDArray[np.bool_]:
        """Whether each motion is stable, shape (p,)."""
        return np.array([response.stable for response in self.responses])

    @property
    def rms_compression(self) -> FloatArray:
        """Of every contact about its mean [m], shape (p, c)."""
        return np.array([response.rms_compression for response in self.responses])

    @property
    def peak_force(self) -> FloatArray:
        """Of every contact [N], shape (p, c)."""
        return np.array([response.peak_force for response in self.responses])

    @property
    def contact_loss(self) -> FloatArray:
        """Part of the period that the flanks of every contact are apart, shape (p, c)."""
        return np.array([response.contact_loss for response in self.responses])

    def at(self, speed: float, tolerance: float = 1e-8) -> list[PeriodicResponse]:
        """Every motion of the branch at a speed, in the branch's order.

        Raises
        ------
        CouplingError
            Where the branch does not come to this speed.
        """
        away = self.speeds - speed
        found = []
        system = self.system_at(speed)
        for i in np.flatnonzero(away == 0.0):
            found.append((float(i), self.responses[i]))
        for i in np.flatnonzero(away[:-1] * away[1:] < 0.0):
            before, after = self.responses[i], self.responses[i + 1]
            part = away[i] / (away[i] - away[i + 1])
            q = (1.0 - part) * before.displacement + part * after.displacement
            # Rates are compared in their own period.
            ratio = (before.period + part * (after.period - before.period)) ** -1.0
            v = ((1.0 - part) * before.velocity * before.period + part * after.velocity * after.period) * ratio
            period = None if self.periods == 1 else 1.0 / ratio
            found.append((i + part, periodic_response(system, period=period, start=(q, v), tolerance=tolerance)))
        if not found:
            raise CouplingError(
                f"no motion at {speed:g}: the branch was followed from {self.speeds.min():g} to {self.speeds.max():g}"
            )
        return [response for _, response in sorted(found, key=lambda one: one[0])]
