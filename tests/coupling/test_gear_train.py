"""Gear trains that cannot exist: the library refuses them with the numbers that do not fit."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearwhine.coupling import (
    CoupledMachine,
    CouplingError,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    assemble_machine,
)
from gearwhine.coupling.gears import ConstantStiffness, Gear, GearPairGeometry, tooth_contact
from gearwhine.coupling.machine.components import rotor_component
from gearwhine.coupling.machine.loads import AnyTorque, TorqueHistory
from gearwhine.rotors import Bearing, ModalRotor, Rotor, Segment, ShaftMaterial, modal_rotor

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
RIG = GearPairGeometry(*(Gear(name, 28, 3.175e-3, math.radians(20.0), 6.35e-3) for name in ("pinion", "wheel")))
"""The gears of NASA's gear noise rig: 28 teeth each, axes 88.9 mm apart."""


@pytest.fixture(scope="module")
def shaft() -> tuple[ModalRotor, list[Bearing]]:
    held = [Bearing(str(at), at, np.diag([1e8, 1e8]), np.zeros((2, 2))) for at in (0.0, 0.25)]
    return modal_rotor(Rotor("", [Segment(0.25, 0.03, 0.0, STEEL)], []), held, count=3, gears_at=[0.125]), held


def built(shaft: tuple[ModalRotor, list[Bearing]], **changes: Any) -> CoupledMachine:
    """Two shafts with gears half way; a change to the speeds, the second axis, the second start or the torques."""
    pair = changes.get("pair", RIG)
    axis = changes.get("axis", (pair.working_centre_distance, 0.0))
    rotors = [
        rotor_component("first", shaft[0], start=0.0),
        rotor_component("second", shaft[0], start=changes.get("start", 0.0)),
    ]
    gears = (
        MountedGear("pinion", "first", 0.125, (0.0, 0.0)),
        MountedGear("wheel", changes.get("rotor", "second"), 0.125, axis),
    )
    return assemble_machine(
        rotors,
        None,
        speeds=dict(zip(("first", "second"), changes.get("speeds", (500.0, -500.0 / pair.ratio)), strict=True)),
        bearings=[MountedBearing(bearing, rotor.name, None) for rotor in rotors for bearing in shaft[1]],
        meshes=[GearMesh(*gears, pair, tooth_contact(pair, ConstantStiffness(1e8)))],
        loads=MachineLoads(torques=changes.get("torques", ())),
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"speeds": (500.0, -1000.0)}, "'second' turns at -1000 rad/s; expected -500 rad/s, by 28 and 28 teeth"),
        ({"speeds": (500.0, 500.0)}, "turn the same way; expected speeds of opposite signs"),
        ({"speeds": (500.0, 0.0)}, "turns at 0 rad/s; expected -500 rad/s"),
        ({"speeds": (0.0, -500.0)}, "turns at -500 rad/s; expected"),
        ({"axis": (0.2, 0.0)}, "are 200 mm apart; expected the gears' centre distance, 88.9 mm"),
        ({"axis": (0.0889, 0.001)}, "apart; expected the gears' centre distance, 88.9 mm"),
        ({"start": 0.004}, "in one plane, within half a face width, 3.175 mm; they are 4 mm apart along z"),
        ({"rotor": "first"}, "both gears are on rotor 'first'"),
    ],
)
def test_gears_that_cannot_be_in_mesh_are_refused(
    shaft: tuple[ModalRotor, list[Bearing]], changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(CouplingError, match="gear pair 'pinion' -> 'wheel'") as refused:
        built(shaft, **changes)
    assert words in str(refused.value)


@settings(max_examples=30, deadline=None)
@given(
    teeth=st.tuples(st.integers(20, 60), st.integers(20, 60)),
    speed=st.floats(-2000.0, 2000.0).filter(lambda value: abs(value) > 1.0),
    angle=st.floats(-math.pi, math.pi),
    shift=st.floats(-3e-3, 3e-3),
    wrong=st.floats(1e-6, 0.5),
)
def test_any_pair_in_mesh_is_taken_and_any_slip_refused(
    shaft: tuple[ModalRotor, list[Bearing]],
    teeth: tuple[int, int],
    speed: float,
    angle: float,
    shift: float,
    wrong: float,
) -> None:
    """At any angle of the line of centres, and with faces that overlap by half."""
    pair = GearPairGeometry(*(Gear(str(z), z, 3e-3, math.radians(20.0), 6.35e-3) for z in teeth))
    pair = replace(pair, axial_offset=shift)
    a = pair.working_centre_distance
    axis = (a * math.cos(angle), a * math.sin(angle))
    machine = built(shaft, pair=pair, axis=axis, start=shift, speeds=(speed, -speed * teeth[0] / teeth[1]))
    assert machine.system.contacts[0].mesh_frequency == pytest.approx(abs(speed) * teeth[0] / (2.0 * math.pi))
    with pytest.raises(CouplingError, match="turns at"):
        built(shaft, pair=pair, axis=axis, start=shift, speeds=(speed, -speed * (1.0 + wrong) * teeth[0] / teeth[1]))


def test_at_rest_nothing_needs_a_ratio(shaft: tuple[ModalRotor, list[Bearing]]) -> None:
    assert built(shaft, speeds=(0.0, 0.0)).speeds == {"first": 0.0, "second": 0.0}


def test_a_torque_that_nothing_takes_is_refused(shaft: tuple[ModalRotor, list[Bearing]]) -> None:
    taken = Torque("first", 0.0, 70.0), Torque("second", 0.25, 70.0)
    built(shaft, torques=taken)
    for wrong in (taken[:1], (taken[0], Torque("second", 0.25, -70.0)), (taken[0], Torque("second", 0.25, 60.0))):
        with pytest.raises(CouplingError, match="balance through the tooth ratios"):
            built(shaft, torques=wrong)
    # What speeds the train up for a while is no steady state.
    rising: AnyTorque = TorqueHistory("first", 0.0, np.array([0.0, 1.0]), np.array([70.0, 90.0]))
    built(shaft, torques=(rising, taken[1]))
