"""Where an order of the speed meets a mode: between two speeds of a branch, to ten digits."""

from collections.abc import Sequence

import numpy as np

from coupling.branches import ModesAtSpeed
from coupling.contact_state import ContactState, linear_matrices
from coupling.eigenpairs import refine_pair
from coupling.machine import CoupledMachine

_CROSSING = 1e-10  # of a frequency, to which a crossing is found
_STEPS = 40
_RESIDUAL = 1e-9


def refined_crossing(
    machine: CoupledMachine, order: float, ends: Sequence[tuple[ModesAtSpeed, int]], contact: ContactState
) -> tuple[float, complex] | None:
    """Speed and eigenvalue where a branch has the frequency of an order, between two neighbours on it.

    Regula falsi with Illinois' halving; at each speed Newton's method on the eigenpair, begun between its neighbours.
    None where that leads away from the branch.

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
    (low, one), (high, other) = ends
    speeds = [low.speed, high.speed]
    values = [complex(low.values[one]), complex(high.values[other])]
    shapes = [low.right[one], high.right[other]]
    # Shapes are known up to a factor; the second is turned into line with the first, to be averaged with it.
    shapes[1] = shapes[1] * np.exp(-1j * np.angle(np.vdot(shapes[0], shapes[1])))
    gaps = [value.imag - order * abs(speed) for value, speed in zip(values, speeds, strict=True)]
    weights = list(gaps)
    for _ in range(_STEPS):
        part = weights[0] / (weights[0] - weights[1])
        speed = speeds[0] + part * (speeds[1] - speeds[0])
        system = machine.at_speed(speed).system
        stiffness, damping = linear_matrices(system, contact)
        start = values[0] + part * (values[1] - values[0])
        value, shape, residual = refine_pair(stiffness, damping, start, (1.0 - part) * shapes[0] + part * shapes[1])
        if residual > _RESIDUAL or not _between(value, values):
            return None
        gap = value.imag - order * abs(speed)
        if abs(gap) <= _CROSSING * abs(value):
            return speed, value
        shape = shape * np.exp(-1j * np.angle(np.vdot(shapes[0], shape)))
        near = 0 if (gap > 0.0) == (gaps[0] > 0.0) else 1
        speeds[near], values[near], shapes[near], gaps[near], weights[near] = speed, value, shape, gap, gap
        weights[1 - near] *= 0.5
    return None


def _between(value: complex, ends: Sequence[complex]) -> bool:
    """Whether an eigenvalue is near two on its branch, and not one of another branch."""
    reach = 2.0 * abs(ends[1] - ends[0]) + 1e-3 * abs(ends[0])
    return min(abs(value - end) for end in ends) <= reach
