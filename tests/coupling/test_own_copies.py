"""Descriptions keep own copies: later changes of the caller's lists and arrays leave machine and housing alone."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.description.excitation import Driving
from gearwhine.coupling.description.gear_train import Output
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.geometry.faults import MissingTooth
from gearwhine.coupling.gears.geometry.modifications import ProfileDeviation
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import TableStiffness
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseHistory, BaseMotion
from gearwhine.coupling.machine.loads import Torque, TorqueHistory, TorqueSlope
from gearwhine.housing import STEEL, Housing, Joint, LumpedMass, Mount, Seat, Sensor, Support
from gearwhine.housing.model.bushings import Bushing
from gearwhine.housing.model.patches import Patch
from gearwhine.meshes import Mesh
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, Unbalance
from gearwhine.rotors.model.loads import Bow

ROTOR = Rotor("r", [Segment(0.2, 0.03, 0.0, ShaftMaterial(207e9, 80e9, 7850.0))])
SHAKEN = BaseHarmonic(100.0, np.ones(6, dtype=np.complex128))
GEAR = Gear("pinion", 25, 3e-3, 0.35, 0.02)
UNIT = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
PATCH = Patch("floor")
SIX = np.eye(6)

LISTS: dict[str, tuple[Callable[[Any], Any], str, Any, Any]] = {
    "shaft's axis": (lambda given: Shaft(ROTOR, axis=given), "axis", [1.0, 2.0], (1.0, 2.0)),
    "unbalances": (
        lambda given: Shaft(ROTOR, unbalances=given),
        "unbalances",
        [Unbalance(0.1, 1e-5)],
        (Unbalance(0.1, 1e-5),),
    ),
    "inertia": (lambda given: ShaftGear(GEAR, "r", 0.1, given), "inertia", [1.0, 2.0, 3.0], (1.0, 2.0, 3.0)),
    "force": (lambda given: ShaftForce("r", 0.1, given), "force", np.arange(3.0), (0.0, 1.0, 2.0)),
    "torques": (lambda given: Driving(given), "torques", [Torque("r", 0.1, 5.0)], (Torque("r", 0.1, 5.0),)),
    "gravity": (lambda given: Driving(gravity=given), "gravity", np.arange(3.0), (0.0, 1.0, 2.0)),
    "parts": (lambda given: BaseMotion(given), "parts", [SHAKEN, SHAKEN], (SHAKEN, SHAKEN)),
    "pitch": (
        lambda given: replace(GEAR, pitch_deviations=given),
        "pitch_deviations",
        [1e-6] * 25,
        (1e-6,) * 25,
    ),
    "faults": (lambda given: replace(GEAR, faults=given), "faults", [MissingTooth(3)], (MissingTooth(3),)),
    "profile": (
        lambda given: ProfileDeviation(table=given),
        "table",
        [[0.1, 1e-6], [0.2, 2e-6]],
        ((0.1, 1e-6), (0.2, 2e-6)),
    ),
    "face gap": (lambda given: GearPair("a", "b", face_gap=given), "face_gap", [1e-6, 2e-6], (1e-6, 2e-6)),
    "seat": (lambda given: Seat("s", given), "center", np.arange(3.0), (0.0, 1.0, 2.0)),
    "sensor's place": (lambda given: Sensor("s", given), "position", [1.0, 2.0, 3.0], (1.0, 2.0, 3.0)),
    "sensor's direction": (lambda given: Sensor("s", (0, 0, 0), given), "direction", [0.0, 0.0, 1.0], (0.0, 0.0, 1.0)),
    "support": (lambda given: Support("s", "floor", stiffness=given), "stiffness", [1.0, 2.0, 3.0], (1.0, 2.0, 3.0)),
    "support's box": (
        lambda given: Support("s", box=given, fixed=(True, True, True)),
        "box",
        [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]],
        ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
    ),
    "bushing": (lambda given: Bushing(given), "stiffness", np.arange(6.0), (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)),
    "axes": (
        lambda given: Bushing((1.0,) * 6, axes=given),
        "axes",
        np.array(UNIT),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ),
    "mount": (lambda given: Mount("m", PATCH, Bushing((1.0,) * 6), given), "center", [1.0, 2.0, 3.0], (1.0, 2.0, 3.0)),
    "joint": (
        lambda given: Joint("j", PATCH, Patch("roof"), Bushing((1.0,) * 6), given),
        "center",
        [1.0, 2.0, 3.0],
        (1.0, 2.0, 3.0),
    ),
    "mass": (lambda given: LumpedMass("m", 1.0, position=given), "position", [1.0, 2.0, 3.0], (1.0, 2.0, 3.0)),
    "inertia of a mass": (
        lambda given: LumpedMass("m", 1.0, PATCH, inertia=given),
        "inertia",
        np.array(UNIT),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ),
    "patch": (
        lambda given: Patch(box=given),
        "box",
        np.array(UNIT[:2]),
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ),
}


@pytest.mark.parametrize("kind", LISTS)
def test_a_description_keeps_tuples_of_lists_and_arrays(kind: str) -> None:
    make, attribute, given, expected = LISTS[kind]
    described = make(given)
    if isinstance(given, np.ndarray):
        given *= 7.0
    else:
        if isinstance(given[0], list):
            given[0][0] = 7.0
        given.pop()
    kept = getattr(described, attribute)
    assert kept == expected
    assert isinstance(kept, tuple)


ARRAYS: dict[str, tuple[Callable[[Any], Any], str, Any]] = {
    "positions of a table": (lambda given: TableStiffness(given, np.full(2, 3e8)), "position", [0.0, 1.0]),
    "stiffness of a table": (lambda given: TableStiffness(np.arange(2.0), given), "stiffness", [3e8, 4e8]),
    "torque over time": (lambda given: TorqueHistory("r", 0.1, np.arange(2.0), given), "values", [1.0, 2.0]),
    "slope over speed": (lambda given: TorqueSlope("t", "r", 0.1, np.arange(2.0), given), "slopes", [1.0, 2.0]),
    "offset": (
        lambda given: MountedBearing(Bearing.isotropic("b", 0.1, 1e8), "r", None, offset=given),
        "offset",
        [1.0, 2.0, 3.0, 4.0, 5.0],
    ),
    "places of a bow": (lambda given: Bow(given, np.ones(2)), "at", [0.1, 0.2]),
    "phases of a bow": (lambda given: Bow(np.arange(2.0), np.ones(2), given), "phase", [0.1, 0.2]),
    "times of a base": (lambda given: BaseHistory(given, SIX[:2]), "times", [0.0, 1.0]),
    "amplitude of a base": (lambda given: BaseHarmonic(10.0, given), "amplitude", [1.0 + 1.0j] * 6),
}


@pytest.mark.parametrize("kind", ARRAYS)
def test_a_description_keeps_arrays_that_can_only_be_read(kind: str) -> None:
    make, attribute, numbers = ARRAYS[kind]
    given = np.array(numbers)
    described = make(given)
    given *= 7.0
    kept = getattr(described, attribute)
    assert kept.tolist() == numbers
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 7.0


def test_machines_of_one_list_that_changes_are_machines_of_their_own() -> None:
    """A rigid shaft on two equal springs each: ten times the stiffness makes the frequency √10 times as high."""
    rigid = Rotor("r", [Segment(0.1, 0.05, 0.0, ShaftMaterial(2e15, 8e14, 7850.0))])

    def bearings(stiffness: float) -> list[MountedBearing]:
        ends = (("left", 0.0), ("right", 0.1))
        return [MountedBearing(Bearing.isotropic(name, at, stiffness), "r", None) for name, at in ends]

    shafts, listed, machines = [Shaft(rigid)], bearings(1e6), []
    for stiffness in (1e6, 1e7):
        listed[:] = bearings(stiffness)
        machines.append(Machine(shafts, listed))
    mass = 7850.0 * np.pi / 4.0 * 0.05**2 * 0.1
    listed.clear()
    shafts.clear()
    for machine, stiffness in zip(machines, (1e6, 1e7), strict=True):
        bounce = np.sqrt(2.0 * stiffness / mass) / (2.0 * np.pi)
        frequencies = machine.modes().frequencies_hz
        assert np.abs(frequencies / bounce - 1.0).min() < 1e-4
        assert (len(machine.shafts), len(machine.bearings)) == (1, 2)


def test_every_list_of_a_machine_is_its_own() -> None:
    machine = gw.load("spur-pair").machine
    lists: dict[str, list[Any]] = {
        "shafts": [*machine.shafts],
        "bearings": [*machine.bearings],
        "gears": [*machine.gears],
        "gear_pairs": [*machine.gear_pairs],
        "outputs": [Output("output")],
        "forces": [ShaftForce("output", 0.1, (1.0, 0.0, 0.0))],
    }
    lengths = {name: len(parts) for name, parts in lists.items()}
    copy = replace(machine, **lists)  # type: ignore[arg-type]
    for parts in lists.values():
        parts.clear()
    assert {name: len(getattr(copy, name)) for name in lists} == lengths


def test_every_list_of_a_housing_is_its_own(block_of: Callable[..., Mesh]) -> None:
    mesh = replace(block_of("hexahedron"), volumes={"all": np.arange(1)})
    fixtures = [Support("floor", box=((-9.0, -9.0, -9.0), (9.0, 9.0, 9.0)), stiffness=(1e8, 1e8, 1e8))]
    seats, sensors = [Seat("bore", (0.0, 0.0, 0.0))], [Sensor("top", (0.0, 0.0, 0.0))]
    materials = {"all": STEEL}
    mesh = replace(mesh, surfaces={"bore": mesh.boundary})
    housing = Housing(mesh, STEEL, materials, fixtures, seats, sensors)
    for parts in (fixtures, seats, sensors):
        parts.clear()
    materials.clear()
    assert [len(part) for part in (housing.fixtures, housing.seats, housing.sensors, housing.materials)] == [1] * 4
