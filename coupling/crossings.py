"""Crossing of an excitation order with a coupled mode, refined between two speeds of a branch to ten digits."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from coupling.branches import ModesAtSpeed
from coupling.contact_state import ContactState, linear_matrices
from coupling.eigenpairs import refine_pair
from coupling.machine import CoupledMachine
from rotors.branch_following import BranchPoint, refined_crossing

ComplexArray = npt.NDArray[np.complex128]
Point = BranchPoint[ComplexArray]

_CROSSING = 1e-10  # of a frequency, to which a crossing is found
_STEPS = 40
_RESIDUAL = 1e-9


def order_crossing(
    machine: CoupledMachine, order: float, ends: Sequence[tuple[ModesAtSpeed, int]], contact: ContactState
) -> tuple[float, complex] | None:
    """Speed and eigenvalue where a branch has the frequency of an order, between two neighbours on it.

    At each speed on the way Newton's method on the eigenpair begins between its neighbours. None where that leads away
    from the branch.

    Parameters
    ----------
    machine : CoupledMachine
    order : float
        Frequency over the speed of the leading rotor.
    ends : two of (ModesAtSpeed, int)
        Modes at the speeds on either side, and the place of the branch among them.
    contact : ContactState
        Of all speeds.
    """

    def point(speed: float, value: complex, shape: ComplexArray) -> Point:
        # Shapes are known up to a factor; each is turned into line with the first, to be averaged with others.
        aligned = np.asarray(shape * np.exp(-1j * np.angle(np.vdot(first, shape))))
        return BranchPoint(speed, value, value.imag - order * abs(speed), aligned)

    def solve(part: float, low: Point, high: Point) -> Point | None:
        speed = low.speed + part * (high.speed - low.speed)
        stiffness, damping = linear_matrices(machine.at_speed(speed).system, contact)
        start = low.eigenvalue + part * (high.eigenvalue - low.eigenvalue)
        shape = (1.0 - part) * low.shape + part * high.shape
        value, shape, residual = refine_pair(stiffness, damping, start, shape)
        if residual > _RESIDUAL or not _between(value, (low.eigenvalue, high.eigenvalue)):
            return None
        return point(speed, value, shape)

    first = ends[0][0].right[ends[0][1]]
    low, high = (point(modes.speed, complex(modes.values[at]), modes.right[at]) for modes, at in ends)
    found = refined_crossing(low, high, solve, tolerance=_CROSSING, steps=_STEPS)
    return None if found is None else (found.speed, found.eigenvalue)


def _between(value: complex, ends: Sequence[complex]) -> bool:
    """Whether an eigenvalue is near two on its branch, and not one of another branch."""
    reach = 2.0 * abs(ends[1] - ends[0]) + 1e-3 * abs(ends[0])
    return min(abs(value - end) for end in ends) <= reach
