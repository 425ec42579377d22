"""Pins off their places under rolling bearings: the motion's equilibrium is that of the operating point."""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from plane_planetary_set import STEEL, equal_angles, plane_set

from gearwhine.coupling import Machine, MountedBearing, PinBeam, RollingLaw
from gearwhine.coupling.description.planetary import PlanetarySet
from gearwhine.coupling.statics.mean_mesh import mean_equilibrium
from gearwhine.rotors.rolling_bearings import RollerRow, RollingBearing, rolling_equilibrium

ERROR = 15e-6
ROLLERS = RollingBearing((RollerRow(14, 4e-3, 12e-3, 30e-3, clearance=8e-6),))


@cache
def machine(law: str, pin: Any = None, error: float = ERROR) -> Machine:
    """A set with a planet whose pin is displaced, on rollers and, at the other end, on springs."""
    parts = plane_set(
        equal_angles(3), pressure_angle=math.radians(20.0), with_ring=True, material=STEEL, diameter=0.05, mode_count=1
    )
    parts["shafts"] = [
        replace(one, pin_error=(0.0, error) if one.name == "planet 1" else (0.0, 0.0), pin=pin) if one.carrier else one
        for one in parts["shafts"]
    ]
    bearings = []
    for one in parts["bearings"]:
        if one.rotor.startswith("planet") and one.bearing.name.endswith("left"):
            on_rollers = MountedBearing.from_elements(one.bearing.name, one.bearing.at, one.rotor, None, ROLLERS)
            state = rolling_equilibrium(ROLLERS, [100.0, 0.0, 0.0, 0.0, 0.0], held={"z": 0.0, "rx": 0.0, "ry": 0.0})
            in_motion = replace(on_rollers, law=RollingLaw(state), rolling=None)
            bearings.append(on_rollers if law == "linear" else in_motion)
        else:
            bearings.append(one)
    gears = tuple(f"planet gear {number}" for number in (1, 2, 3))
    planetary = PlanetarySet("stage", gears, "carrier", sun="sun gear", ring="ring gear")
    return Machine(**(parts | {"bearings": bearings}), speed=300.0, torque=200.0, planetary_sets=[planetary])


@pytest.mark.parametrize("pin", [None, PinBeam((-0.01, 0.11), 0.03, STEEL)])
@pytest.mark.parametrize("law", ["linear", "nonlinear"])
def test_the_mean_of_the_motion_is_the_operating_point(law: str, pin: Any) -> None:
    point = machine(law, pin).operating_point()
    static = np.array([pair.force for pair in point.pairs])
    assert static.max() > 1.1 * static.min()
    means, _ = mean_equilibrium(machine(law, pin).at_operating_point(point).assembled.system)
    assert [mean.force for mean in means if mean is not None] == pytest.approx(static, rel=2e-3)


def test_rollers_by_either_law_share_alike() -> None:
    shares = [[pair.force for pair in machine(law).operating_point().pairs] for law in ("linear", "nonlinear")]
    assert shares[0] == pytest.approx(shares[1], rel=1e-6)
