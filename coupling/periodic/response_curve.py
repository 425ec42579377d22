"""Response curve: a branch of periodic motions over speed, with its bifurcations."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from coupling.errors import CouplingError
from coupling.periodic.branch_motion import BranchMotion
from coupling.periodic.response import PeriodicResponse
from coupling.periodic.shooting import integrated_again, response_near
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]
Ending = Literal["end", "start", "lost", "points", "tries"]
Event = Literal["fold", "period doubling", "Neimark-Sacker", "branch point"]


@dataclass(frozen=True)
class Bifurcation:
    """Bifurcation: a fold of the branch, or a change of its stability.

    Attributes
    ----------
    index : int
        Index of its point on the curve.
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
    responses : tuple of BranchMotion
        Summary of each motion; :meth:`motion` computes its course over time.
    bifurcations : tuple of Bifurcation
    ending : str
        ``end`` where the branch reached the given speed, ``start`` where it came back to its start; ``lost`` where no
        next point was found, ``points`` and ``tries`` at the largest number of these.
    aim : float
        Speed to which the branch was to be followed.
    """

    speeds: FloatArray
    responses: tuple[BranchMotion, ...]
    bifurcations: tuple[Bifurcation, ...]
    system_at: Callable[[float], CoupledSystem] = field(repr=False)
    periods: int = 1
    ending: Ending = "end"
    aim: float = np.nan

    @property
    def account(self) -> str:
        """Followed range and ending of the branch, in a sentence; speeds in the curve's own unit."""
        return self.told()

    def told(self, unit: float = 1.0, name: str = "") -> str:
        """The same with speeds divided by a named unit."""
        start, last, aim = (value / unit for value in (self.speeds[0], self.speeds[-1], self.aim))
        name = name and f" {name}"
        way = f"followed from {start:.6g} to {last:.6g}{name}: {len(self.speeds)} points, {len(self.folds)} folds"
        if self.ending == "end":
            return way
        sense = np.sign(self.aim - self.speeds[0])
        farthest = self.speeds[0] + sense * (sense * (self.speeds - self.speeds[0])).max()
        why = {
            "start": "the branch came back to where it began",
            "lost": "no next motion was found however near: the flanks may begin to graze there, or the motion ends",
            "points": "as many points as were allowed",
            "tries": "as many tries as were allowed",
        }[self.ending]
        return f"{way}; {why}. Between {farthest / unit:.6g} and {aim:.6g}{name} nothing was followed"

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
        """Root mean square of every contact's compression about its mean [m], shape (p, c)."""
        return np.array([response.rms_compression for response in self.responses])

    @property
    def peak_force(self) -> FloatArray:
        """Largest force of every contact [N], shape (p, c)."""
        return np.array([response.peak_force for response in self.responses])

    @property
    def contact_loss(self) -> FloatArray:
        """Part of the period that the flanks of every contact are apart, shape (p, c)."""
        return np.array([response.contact_loss for response in self.responses])

    def motion(self, index: int) -> PeriodicResponse:
        """The whole motion of a point, integrated again from the starts of its segments."""
        kept = self.responses[index]
        return integrated_again(self.system_at(float(self.speeds[index])), self._period(kept.period), kept)

    def at(self, speed: float, tolerance: float = 1e-8) -> list[PeriodicResponse]:
        """Every motion of the branch at a speed, in the branch's order.

        Raises
        ------
        CouplingError
            Where the branch does not come to this speed.
        PeriodicError
            Where a motion between two points is not found from them, or the tolerance is not met.
        """
        away = self.speeds - speed
        found = [(float(i), self.motion(int(i))) for i in np.flatnonzero(away == 0.0)]
        for i in np.flatnonzero(away[:-1] * away[1:] < 0.0):
            part = away[i] / (away[i] - away[i + 1])
            found.append((i + part, self._between(int(i), part, speed, tolerance)))
        if not found:
            raise CouplingError(
                f"no motion at {speed:g}: the branch was followed from {self.speeds.min():g} to {self.speeds.max():g}"
            )
        return [response for _, response in sorted(found, key=lambda one: one[0])]

    def _between(self, index: int, part: float, speed: float, tolerance: float) -> PeriodicResponse:
        """The motion at a speed that is a part of the way from one point to the next."""
        before, after = self.responses[index], self.responses[index + 1]
        # Rates are compared in their own period.
        length = 1.0 / (1.0 / before.period + part * (1.0 / after.period - 1.0 / before.period))
        q = (1.0 - part) * before.displacements + part * after.displacements
        v = ((1.0 - part) * before.velocities * before.period + part * after.velocities * after.period) / length
        level = max(before.level, after.level)
        return response_near(self.system_at(speed), self._period(length), (q, v), level, tolerance)

    def _period(self, length: float) -> float | None:
        return None if self.periods == 1 else length
