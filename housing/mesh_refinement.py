"""Refinement of a housing's mesh until the estimated error of every mode is within an accuracy.

From the size h of the elements and the largest estimate e of a step follows the next size, h (a / e)^(1 / q) for an
accuracy a, with the order q that the last two steps show, and the first step with that of thin walls.
"""

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.housing.housing import HousingModes
from gearwhine.meshes import mesh_quality
from gearwhine.meshes.lengths import length_text
from gearwhine.numerics.findings import Finding, refuse
from gearwhine.numerics.progress import Progress, silent

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


def refined_modes(
    solve: Callable[[float | None], HousingModes],
    accuracy: float,
    size: float | None = None,
    progress: Progress = silent,
) -> HousingModes:
    """Solve a housing on finer and finer meshes, until every mode's estimated error is within an accuracy.

    Parameters
    ----------
    solve : callable
        Meshes the housing by a size of elements [m] and solves its modes; None is a coarse size of the mesher's own.
    accuracy : float
        Largest estimated error of a natural frequency, as a part of it.
    size : float, optional
        Size of the first mesh's elements [m].
    progress : callable

    Raises
    ------
    HousingError
        Where the accuracy needs too many unknowns, or finer meshes do not come nearer to it.
    """
    steps: list[RefinementStep] = []
    begin = time.perf_counter()
    while True:
        solved = solve(size)
        errors = solved.modes.discretisation_errors
        assert errors is not None
        size = mesh_quality(solved.mesh).edge_length[1] if size is None else size
        worst = int(np.argmax(errors))
        steps.append(RefinementStep(size, 3 * len(solved.mesh.points), len(errors), float(errors[worst])))
        progress(
            f"elements of {length_text(size)}, {steps[-1].dofs} degrees of freedom: mode {worst + 1} has the largest "
            f"estimated error, {100 * errors[worst]:.3g} %; {100 * accuracy:g} % is wanted"
        )
        if errors[worst] <= accuracy:
            break
        size = next_size(steps, accuracy)
    seconds = {**solved.seconds, "total": time.perf_counter() - begin}
    # What was asked for is reached: no advice on the size of elements.
    noted = [entry for entry in solved.record.notes["warnings"] if entry["name"] != "discretisation"]
    steps_made = [step.document for step in steps]
    notes = {**solved.record.notes, "warnings": noted, "seconds": seconds, "refinement": steps_made}
    return replace(solved, seconds=seconds, record=replace(solved.record, notes=notes))


def next_size(steps: list[RefinementStep], accuracy: float) -> float:
    """Return the size of the next mesh [m].

    Raises
    ------
    HousingError
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
        refuse([Finding(("housing", ""), "accuracy", f"{100 * accuracy:g} %", expected)], HousingError)
    return factor * last.mesh_size_m
