"""Response curve of a machine with turning carriers: motions over speed, each settled from that of its neighbour.

Speeds are evenly spaced. At each the search of :mod:`gearwhine.coupling.periodic.settling` begins with the motion of
the speed before, whose rates grow with the speed, and where that does not settle with static equilibrium. It follows no
branch through folds: where several motions exist, as where flanks part, the curve has the one that is nearest to its
neighbour's, and a curve in the other sense may have another.
"""

from collections.abc import Callable

import numpy as np

from gearwhine.coupling.errors import CouplingError, PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.periodic.continuation import Bifurcation, Ending, Event, ResponseCurve
from gearwhine.coupling.periodic.response import Loss
from gearwhine.coupling.periodic.settling import SettledMotion, settled_response

_EVENTS: dict[Loss, Event] = {
    "fold": "branch point",
    "period doubling": "period doubling",
    "Neimark-Sacker": "Neimark-Sacker",
}
"""Changes of stability by where the multiplier leaves; the curve does not turn back, so that one at +1 is no fold."""


def settled_curve(
    system_at: Callable[[float], CoupledSystem],
    begin: float,
    end: float,
    *,
    points: int,
    progress: Callable[[float], None] = lambda fraction: None,
    seen: Callable[[float, SettledMotion], None] = lambda speed, motion: None,
) -> ResponseCurve:
    """Settle the motion at evenly spaced speeds, each from that of its neighbour.

    Parameters
    ----------
    system_at : callable
        System at a speed.
    begin, end : float
        First and last speed, of one sense and not zero, in the unit that ``system_at`` takes.
    points : int
        Number of speeds, two or more.
    progress : callable
        Called with the finished part, from 0 to 1.
    seen : callable
        Called with each speed and its motion.

    Raises
    ------
    CouplingError
        For speeds or a number of points that span no curve, or excitations without a common period.
    PeriodicError
        Where no motion settles at any of the speeds.
    """
    if points < 2 or not begin * end > 0.0 or begin == end:
        raise CouplingError(
            f"{points} points from {begin:g} to {end:g}; expected two or more, and two speeds of one sense"
        )
    speeds: list[float] = []
    motions: list[SettledMotion] = []
    events: list[Bifurcation] = []
    pieces, broken, first_error = [0], False, None
    endings: list[Ending] = []
    for number, speed in enumerate(np.linspace(begin, end, points).tolist()):
        try:
            motion = _settled(system_at(speed), motions[-1] if motions else None)
        except PeriodicError as error:
            first_error, broken = first_error or error, True
            continue
        finally:
            progress((number + 1) / points)
        if broken and motions:
            pieces.append(len(motions))
            endings.append("lost")
        elif motions and (event := _event(motions[-1], motion)):
            events.append(Bifurcation(len(motions), event, speed))
        broken = False
        speeds.append(speed)
        motions.append(motion)
        seen(speed, motion)
    if not motions:
        raise first_error or PeriodicError("no motion settles")
    return ResponseCurve(
        speeds=np.array(speeds),
        responses=tuple(motions),
        bifurcations=tuple(events),
        system_at=system_at,
        endings=(*endings, "lost" if broken else "end"),
        begin=begin,
        aim=end,
        pieces=tuple(pieces),
    )


def _settled(system: CoupledSystem, neighbour: SettledMotion | None) -> SettledMotion:
    """Motion from that of a neighbouring speed, or from rest where that does not lead to one."""
    if neighbour is not None:
        try:
            return settled_response(system, near=neighbour)
        except PeriodicError:
            pass
    return settled_response(system)


def _event(before: SettledMotion, after: SettledMotion) -> Event | None:
    """Change of stability between two speeds, where it is decided at both."""
    verdicts = {before.stability, after.stability}
    if verdicts != {"stable", "unstable"}:
        return None
    leaving = before.floquet.leaving or after.floquet.leaving
    return None if leaving is None else _EVENTS[leaving]
