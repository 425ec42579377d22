"""Gradients of the operating point by adjoints, against central differences of equilibria that are solved anew."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from own_statics import one_stage

from coupling import Machine
from coupling.statics.operating_point import OperatingPoint
from coupling.statics.sensitivity import OUTCOMES, Adjoint, pair_adjoints, tilt_adjoint
from rotors import Pedestal

FloatArray = npt.NDArray[np.float64]
GRAVITY = (1.0, -9.81, 0.3)
JOURNAL = np.pad([[2.0e7, 3.5e7], [-1.2e7, 6.0e7]], (0, 3)) + np.diag([0.0, 0.0, 1e7, 0.0, 0.0])


def on_pedestals() -> Machine:
    foot = Pedestal(np.array([[3e8, 8e7], [-2e7, 5e8]]), np.zeros((2, 2)), 2.0)
    held = one_stage().bearings
    return one_stage(
        bearings=[
            replace(one, bearing=replace(one.bearing, pedestal=foot)) if n % 2 else one for n, one in enumerate(held)
        ]
    )


MACHINES = {
    "full bearings": one_stage(),
    "spur, on the back flanks": one_stage(hand=0.0, torque=-150.0),
    "journal bearings": one_stage(stiffness=JOURNAL),
    "pedestals": on_pedestals(),
}


def outcomes(point: OperatingPoint, bearing: str) -> FloatArray:
    (pair,) = point.pairs
    return np.array([pair.misalignment, pair.k_h_beta, np.ptp(pair.transmission_error), point.bearing(bearing).tilt])


def difference(machine: Machine, number: int, change: Callable[[Any, float], Any], step: float) -> FloatArray:
    """Central difference, fourth order, of the outcomes by a change of a bearing."""
    found = []
    for size in (step, -step, 2.0 * step, -2.0 * step):
        held = list(machine.bearings)
        held[number] = replace(held[number], bearing=change(held[number].bearing, size))
        point = replace(machine, bearings=held).operating_point(GRAVITY)
        found.append(outcomes(point, held[0].bearing.name))
    near, far = found[0] - found[1], found[2] - found[3]
    return np.asarray((8.0 * near - far) / (12.0 * step))


def scaled(bearing: Any, size: float) -> Any:
    return replace(bearing, stiffness=(1.0 + size) * np.asarray(bearing.stiffness))


def moved(bearing: Any, size: float) -> Any:
    return replace(bearing, at=bearing.at + size)


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_bearings(machine: Machine) -> None:
    """Stiffness and position to 1e-7 of the largest derivative of each outcome."""
    point = machine.operating_point(GRAVITY)
    (pair,) = pair_adjoints(point)
    assert tuple(pair) == OUTCOMES
    adjoints = [*pair.values(), tilt_adjoint(point, machine.bearings[0].bearing.name)]
    names = [one.bearing.name for one in machine.bearings]
    for change, step, tolerance in ((scaled, 2e-3, 1e-7), (moved, 2e-4, 1e-7)):
        by = Adjoint.by_bearing_stiffness if change is scaled else Adjoint.by_bearing_position
        own = np.array([[by(one, name) for one in adjoints] for name in names])
        expected = np.array([difference(machine, number, change, step) for number in range(len(names))])
        # A bearing's own place also moves its own tilt.
        told = np.ones(own.shape, dtype=bool)
        told[0, 3] = change is scaled
        scale = np.abs(expected).max(axis=0)
        error = np.where(told, np.abs(own - expected), 0.0).max(axis=0)
        # An even spring of the whole mesh leaves spur gears no transmission error.
        assert (error <= tolerance * np.where(scale > 1e-12, scale, 1.0)).all()
