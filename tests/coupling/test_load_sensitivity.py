"""Gradients of the operating point by adjoints, against central differences of equilibria that are solved anew."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from own_statics import one_stage

from gearwhine.coupling import Machine, MountedBearing, machine_description
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.statics.sensitivity import OUTCOMES, Adjoint, pair_adjoints, tilt_adjoint
from gearwhine.coupling.statics.static_model import ConnectorLaw, LinearLaw, StaticBearing, static_bearing
from gearwhine.rotors import Pedestal
from gearwhine.rotors.rolling_bearings import BallRow, paired

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


def on_balls() -> Machine:
    pair = paired(BallRow(13, 8.1e-3, 38.5e-3, np.radians(25.0)), "back to back", 15e-3, preload=150.0)
    return one_stage(bearings=[replace(one, rolling=pair) for one in one_stage().bearings])


MACHINES = {
    "full bearings": one_stage(),
    "spur, on the back flanks": one_stage(hand=0.0, torque=-150.0),
    "journal bearings": one_stage(stiffness=JOURNAL),
    "pedestals": on_pedestals(),
    "preloaded angular-contact ball bearings": on_balls(),
}


def in_housing() -> Machine:
    """The bearings in seats of an elastic body, whose seats turn in its modes, each bearing beside its seat."""
    machine = one_stage()
    motions = np.random.default_rng(3).normal(size=(len(machine.bearings), 8, 6)) * np.repeat([0.05, 0.6], 3)
    names = [one.bearing.name for one in machine.bearings]
    starts = [machine.shaft(one.rotor).start for one in machine.bearings]
    seat_z = [start + one.bearing.at + 4e-3 for start, one in zip(starts, machine.bearings, strict=True)]
    stiffness = np.diag((2.0 * np.pi * np.linspace(300.0, 1500.0, 8)) ** 2)
    box = HousingComponent(
        "box",
        ("housing",) * 8,
        stiffness,
        np.zeros((8, 8)),
        np.zeros((8, 8)),
        seats=dict(zip(names, motions, strict=True)),
        seat_z=dict(zip(names, seat_z, strict=True)),
        sensors={},
        participation=np.zeros((8, 6)),
    )
    return one_stage(
        bearings=[replace(one, seat=name) for one, name in zip(machine.bearings, names, strict=True)], housing=box
    )


def outcomes(point: OperatingPoint, bearing: str) -> FloatArray:
    (pair,) = point.pairs
    return np.array([pair.misalignment, pair.k_h_beta, np.ptp(pair.transmission_error), point.bearing(bearing).tilt])


@dataclass(frozen=True)
class Scaled:
    """A law with its energy, force and tangent multiplied."""

    law: ConnectorLaw
    factor: float

    def at(self, deflection: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        energy, force, tangent = self.law.at(deflection)
        return self.factor * energy, self.factor * force, self.factor * tangent


def scaled(machine: Machine, number: int, size: float) -> OperatingPoint:
    name = machine.bearings[number].bearing.name

    def stiffer(mounted: MountedBearing, *how: Any) -> StaticBearing:
        made = static_bearing(mounted, *how)
        if mounted.bearing.name != name:
            return made
        # A linear one stays such: its part without energy is known as that.
        linear = isinstance(made.law, LinearLaw)
        factor = 1.0 + size
        return replace(made, law=LinearLaw(factor * made.law.stiffness) if linear else Scaled(made.law, factor))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(machine_description, "static_bearing", stiffer)
        return replace(machine, gravity=GRAVITY).operating_point()


def moved(machine: Machine, number: int, size: float) -> OperatingPoint:
    held = list(machine.bearings)
    own = held[number]
    held[number] = replace(own, bearing=replace(own.bearing, at=own.bearing.at + size))
    return replace(machine, bearings=held, gravity=GRAVITY).operating_point()


def difference(machine: Machine, number: int, change: Callable[..., OperatingPoint], step: float) -> FloatArray:
    """Central difference, fourth order, of the outcomes by a change of a bearing."""
    first = machine.bearings[0].bearing.name
    found = [outcomes(change(machine, number, size), first) for size in (step, -step, 2.0 * step, -2.0 * step)]
    near, far = found[0] - found[1], found[2] - found[3]
    return np.asarray((8.0 * near - far) / (12.0 * step))


def test_position_of_a_bearing_in_a_housing_whose_seats_tilt() -> None:
    """The bearing goes along its seat, which is out of line with its shaft by more than the shaft's own slope."""
    machine = in_housing()
    point = replace(machine, gravity=GRAVITY).operating_point()
    (pair,) = pair_adjoints(point)
    for number in (0, len(machine.bearings) - 1):
        name = machine.bearings[number].bearing.name
        either = [outcomes(moved(machine, number, size), name)[:2] for size in (5e-5, -5e-5)]
        own = [pair[outcome].by_bearing_position(name) for outcome in OUTCOMES[:2]]
        np.testing.assert_allclose(own, (either[0] - either[1]) / 1e-4, rtol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_bearings(machine: Machine) -> None:
    """Stiffness and position to 1e-7 of the largest derivative of each outcome.

    The error of the differences falls with the fourth power of their steps, where rolling elements bend the outcomes.
    """
    point = replace(machine, gravity=GRAVITY).operating_point()
    tolerance = 1e-7
    (pair,) = pair_adjoints(point)
    assert tuple(pair) == OUTCOMES
    adjoints = [*pair.values(), tilt_adjoint(point, machine.bearings[0].bearing.name)]
    # One of each shaft.
    numbers = (0, len(machine.bearings) - 1)
    names = [machine.bearings[number].bearing.name for number in numbers]
    for change, step in ((scaled, 2.5e-4), (moved, 2.5e-5)):
        by = Adjoint.by_bearing_stiffness if change is scaled else Adjoint.by_bearing_position
        own = np.array([[by(one, name) for one in adjoints] for name in names])
        expected = np.array([difference(machine, number, change, step) for number in numbers])
        # A bearing's own place also moves its own tilt.
        told = np.ones(own.shape, dtype=bool)
        told[0, 3] = change is scaled
        scale = np.abs(expected).max(axis=0)
        error = np.where(told, np.abs(own - expected), 0.0).max(axis=0)
        # An even spring of the whole mesh leaves spur gears no transmission error.
        assert (error <= tolerance * np.where(scale > 1e-12, scale, 1.0)).all()
