"""Refinement of a housing's mesh until the estimated error of every mode is within an accuracy.

From the size h of the elements and the largest estimate e of a step follows the next size, h (a / e)^(1 / q) for an
accuracy a, with the order q that the last two steps show, and the first step with that of thin walls.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

from gearwhine.case import CaseError, Problem
from gearwhine.meshes.lengths import length_text

MOST_UNKNOWNS = 1.5e6
"""Degrees of freedom beyond which no mesh is tried: their modes take tens of gigabytes of memory, and hours."""
_MOST_STEPS = 8
_ORDER, _ORDERS = 2.0, (0.7, 4.0)  # assumed order of the errors, and bounds of an observed one
_AIM = 0.85  # part of the accuracy that a step aims at
_FINER = (0.4, 0.85)  # bounds of one size over the one before
# Unknowns foreseen of the last mesh over the most, from which the first ones are not worth their time.
_LARGEST_FORESEEN_RATIO = 4.0
_GROWTH = 2.5  # unknowns grow with 1 / h to this power: 2 in walls of one layer, 3 in solids


@dataclass(frozen=True)
class RefinementStep:
    """One mesh of a refinement.

    Attributes
    ----------
    mesh_size_m : float
        Size of its elements [m].
    dofs : int
        Degrees of freedom.
    modes : int
        Number of modes found.
    largest_error : float
        Largest estimate of a frequency's relative error.
    """

    mesh_size_m: float
    dofs: int
    modes: int
    largest_error: float

    @property
    def document(self) -> dict[str, Any]:
        """Its figures, for the document and the mode cache."""
        return asdict(self)


def next_size(steps: list[RefinementStep], accuracy: float) -> float:
    """Return the size of the next mesh [m].

    Raises
    ------
    CaseError
        Where it needs too many unknowns, or the steps do not come nearer.
    """
    last, order = steps[-1], _ORDER
    if len(steps) > 1:
        before = steps[-2]
        fall = math.log(before.largest_error / last.largest_error)
        order = min(max(fall / math.log(before.mesh_size_m / last.mesh_size_m), _ORDERS[0]), _ORDERS[1])
    needed: float = (_AIM * accuracy / last.largest_error) ** (1.0 / order)
    factor: float = min(max(needed, _FINER[0]), _FINER[1])
    unknowns, in_all = last.dofs * factor**-_GROWTH, last.dofs * needed**-_GROWTH
    too_many = unknowns > MOST_UNKNOWNS or in_all > _LARGEST_FORESEEN_RATIO * MOST_UNKNOWNS
    if too_many or len(steps) >= _MOST_STEPS:
        reached = math.ceil(1e3 * last.largest_error) / 10.0
        size = length_text(last.mesh_size_m)
        cause = f"{len(steps)} meshes do not come near"
        if too_many:
            cause = (
                f"elements of about {length_text(needed * last.mesh_size_m)} and {in_all:.1g} of these are needed, "
                f"and more than {MOST_UNKNOWNS:.2g} take tens of gigabytes of memory and hours"
            )
        expected = (
            f"an accuracy within reach, such as '{reached:g} %' of elements of {size} with {last.dofs} degrees of "
            f"freedom; {cause}"
        )
        raise CaseError([Problem("housing.accuracy", f"{100 * accuracy:g} %", expected)])
    return factor * last.mesh_size_m
