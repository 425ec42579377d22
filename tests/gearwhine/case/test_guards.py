"""What the case reader refuses, the library refuses where it is made: one finding, by part and attribute or by key."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from odd_but_sound import changed

from gearwhine.case import CaseError, fields, parse_case
from gearwhine.coupling import Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseHistory, BaseMotion
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine.speed_profile import SpeedRun, TorqueLine
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.housing import Housing, LumpedMass, Seat, Sensor, Support
from gearwhine.housing.material import STEEL
from gearwhine.meshes import Bore, BoxGeometry, WallThickness
from gearwhine.numerics.findings import RefusedPartError
from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, Unbalance
from gearwhine.rotors.model.loads import Bow

NAN, INF = math.nan, math.inf


def segment(length: Any = 0.1, diameter: Any = 0.03) -> Segment:
    return Segment(length, diameter, 0.0, STEEL)


def shaft(name: str = "input", x: float = -44.45e-3, diameter: float = 0.03, **keys: Any) -> Shaft:
    return Shaft(Rotor(name, [segment(diameter=diameter)] * 2), (x, 0.0), -0.1, **keys)


def bearing(name: str, rotor: str, at: float, seat: str | None = None, **keys: Any) -> MountedBearing:
    return MountedBearing(Bearing.isotropic(name, at, 1.2e8, 500.0), rotor, seat, **keys)


def gear(name: str, rotor: str, at: float = 0.1, **sizes: Any) -> ShaftGear:
    return ShaftGear(Gear(name, 28, 3.175e-3, math.radians(20.0), 6.35e-3, **sizes), rotor, at)


def machine(**keys: Any) -> Machine:
    """Return the bundled spur pair, with other parts."""
    pair = GearPair("pinion", "wheel", stiffness="potential-energy", backlash=1e-4)
    parts: dict[str, Any] = {
        "shafts": [shaft(), shaft("output", 44.45e-3)],
        "bearings": bearings(),
        "gears": [gear("pinion", "input"), gear("wheel", "output")],
        "gear_pairs": [pair],
        "speed": 576.0,
        "torque": 71.77,
    }
    return Machine(**parts | keys)


def bearings(first: MountedBearing | None = None) -> list[MountedBearing]:
    places = [("input-front", "input", 0.18), ("output-back", "output", 0.02), ("output-front", "output", 0.18)]
    return [first or bearing("input-back", "input", 0.02), *(bearing(*place) for place in places)]


def component(**keys: Any) -> HousingComponent:
    """Return a housing of two modes with a seat of a bore of 50 mm through a wall of 10 mm at z = -80 mm."""
    zeros = np.zeros((2, 2))
    parts: dict[str, Any] = {
        "stiffness": np.diag([1e6, 2e6]), "damping": zeros, "gyroscopic": zeros, "seats": {"s": np.ones((2, 6))},
        "seat_z": {"s": -0.08}, "sensors": {}, "seat_axes": {"s": (-44.45e-3, 0.0)}, "seat_reach": {"s": 0.035},
    }  # fmt: skip
    return HousingComponent("housing", ("housing",) * 2, **parts | keys)


def box(**keys: Any) -> Housing:
    bore = Bore("s", (0.0, 0.08, -0.08), 0.05)
    geometry = BoxGeometry(size=(0.2, 0.16, 0.16), wall=WallThickness.uniform(0.01), bores=(bore,))
    return Housing.from_box(geometry, 0.08, STEEL, **keys)


def settings(**keys: Any) -> TransientSettings:
    parts = {"duration": 1.0, "record_from": 0.5, "sample_interval": 1e-4, "largest_step": 1e-4}
    return TransientSettings(**parts | keys)


def pedestal(stiffness: float = 1e8) -> Pedestal:
    return Pedestal(stiffness * np.eye(2), np.zeros((2, 2)), 1.0)


def seated(at: float, axis: tuple[float, float] = (-44.45e-3, 0.0)) -> Machine:
    housing = component(seat_axes={"s": axis})
    return machine(housing=housing, bearings=bearings(bearing("input-back", "input", at, "s")))


def over_speeds(low: float, high: float) -> Machine:
    table = Bearing("input-back", 0.02, np.array([1.2e8 * np.eye(2)] * 2), np.zeros((2, 2)), np.array([low, high]))
    return machine(bearings=bearings(MountedBearing(table, "input", None)))


@dataclass(frozen=True)
class Trap:
    """What is refused on both ways: made in Python, its part and attribute; a case's changes, its key; the sentence."""

    make: Callable[[], object]
    label: str
    changes: tuple[tuple[str, Any], ...]
    key: str
    expected: str = ""
    """The expectation on both ways; empty where the case reads a text with a unit and says so in its own words."""
    case: str = "spur-pair"


TRAPS: dict[str, Trap] = {
    "bearing 80 mm from its seat": Trap(
        lambda: seated(0.1), "bearing 'input-back': at",
        (("bearing.0.at", "100 mm"),), "bearing[0].at",
        "a station within ", "small-gearbox",
    ),
    "bearing beside the axis of its seat": Trap(
        lambda: seated(0.02, (-42.45e-3, 0.0)), "bearing 'input-back': seat",
        (("rotor.0.axis", ["-46 mm", "60 mm"]),), "bearing[0].seat",
        'a seat on the axis of rotor "input"; the seat\'s centre is ', "small-gearbox",
    ),
    "pedestal in a seat": Trap(
        lambda: machine(housing=component(), bearings=bearings(MountedBearing(
            replace(bearing("input-back", "input", 0.02).bearing, pedestal=pedestal()), "input", "s"))),
        "bearing 'input-back': pedestal",
        (("bearing.0.pedestal", {"mass": "1 kg", "stiffness": {"xx": "1e8 N/m", "yy": "1e8 N/m"}}),),
        "bearing[0].pedestal", "no pedestal under a bearing in seat ", "small-gearbox",
    ),
    "sensor 5 m outside": Trap(
        lambda: box(sensors=[Sensor("a", (5.0, 0.08, 0.0))]), "sensor 'a': position",
        (("housing.sensor.0.position", ["5 m", "80 mm", "0 mm"]),), "housing.sensor[0].position",
        "a point on the surface of the box; this one is 4", "steel-box",
    ),
    "sensor in the cavity": Trap(
        lambda: box(sensors=[Sensor("a", (0.0, 0.08, 0.0))]), "sensor 'a': position",
        (("housing.sensor.0.position", ["0 mm", "80 mm", "0 mm"]),), "housing.sensor[0].position",
        "a point on the surface of the box; this one is in its cavity, ", "steel-box",
    ),
    "thick shaft": Trap(
        lambda: machine(shafts=[shaft(diameter=0.15), shaft("output", 44.45e-3)]), "gear 'pinion': at",
        (("rotor.0.segments.0.diameter", "150 mm"), ("rotor.0.segments.1.diameter", "150 mm"), ("gear.0.bore", 0)),
        "gear[0].at",
        "a gear whose teeth stand on its shaft; that has a diameter of 150 mm there, the root circle 80.9625 mm",
    ),
    "speed of NaN": Trap(lambda: machine(speed=NAN), "machine: speed", (("operation.speed", NAN),), "operation.speed"),
    "torque of infinity": Trap(
        lambda: machine(torque=INF), "machine: torque", (("operation.torque", INF),), "operation.torque"
    ),
    "negative damping of a shaft": Trap(
        lambda: shaft(damping_ratio=-0.1), "shaft 'input': damping_ratio",
        (("rotor.0.damping_ratio", -0.1),), "rotor[0].damping_ratio",
    ),
    "negative backlash": Trap(
        lambda: GearPair("a", "b", backlash=-1e-3), "gear pair 'a -> b': backlash",
        (("gear_pair.0.backlash", "-1 mm"),), "gear_pair[0].backlash",
    ),
    "negative damping of a bearing": Trap(
        lambda: Bearing.isotropic("b", 0.1, 1e8, -500.0), "bearing 'b': damping",
        (("bearing.0.damping.xx", "-500 N*s/m"),), "bearing[0].damping.xx",
    ),
    "damping of a bearing in seconds": Trap(
        lambda: bearing("b", "input", 0.1, damping_time=8.0), "bearing 'b': damping_time",
        (("bearing.0.damping", {"over_stiffness": "8 s"}),), "bearing[0].damping.over_stiffness",
    ),
    "negative unbalance": Trap(
        lambda: Unbalance(0.1, -1e-5), "unbalance: moment",
        (("rotor.0.unbalance.0.moment", "-1e-5 kg*m"),), "rotor[0].unbalance[0].moment",
    ),
    "pedestal that pushes away": Trap(
        lambda: pedestal(-1e8), "pedestal: stiffness",
        (("bearing.0.pedestal", {"mass": "1 kg", "stiffness": {"xx": "-1e8 N/m", "yy": "1e8 N/m"}}),),
        "bearing[0].pedestal.stiffness.xx",
    ),
    "bearing off the shaft": Trap(
        lambda: machine(bearings=bearings(bearing("input-back", "input", 0.3))), "bearing 'input-back': at",
        (("bearing.0.at", "300 mm"),), "bearing[0].at", 'a station on rotor "input", which is 200 mm long',
    ),
    "gear off the shaft": Trap(
        lambda: machine(gears=[gear("pinion", "input", 0.3), gear("wheel", "output", 0.3)]), "gear 'pinion': at",
        (("gear.0.at", "300 mm"),), "gear[0].at", 'a station on rotor "input", which is 200 mm long',
    ),
    "unbalance off the shaft": Trap(
        lambda: shaft(unbalances=[Unbalance(0.5, 1e-5)]), "shaft 'input': unbalance[0].at",
        (("rotor.0.unbalance.0.at", "500 mm"),), "rotor[0].unbalance[0].at",
        'a station on rotor "input", which is 200 mm long',
    ),
    "disc off the shaft": Trap(
        lambda: Rotor("input", [segment()] * 2, [Disc(0.5, 1.0)]), "rotor 'input': discs[0].at",
        (("rotor.0.discs", [{"at": "500 mm", "mass": "1 kg"}]),), "rotor[0].discs[0].at",
        'a station on rotor "input", which is 200 mm long',
    ),
    "force off the shaft": Trap(
        lambda: machine(forces=[ShaftForce("input", 0.5, (1.0, 0.0, 0.0))]), "machine: forces[0].at",
        (("operation.force", [{"rotor": "input", "at": "500 mm", "x": "1 N"}]),), "operation.force[0].at",
        'a station on rotor "input", which is 200 mm long',
    ),
    "output off the shaft": Trap(
        lambda: machine(outputs=[Output("output", 71.77, 0.5)]), "machine: outputs[0].at",
        (("operation.output", [{"rotor": "output", "torque": "71.77 N*m", "at": "500 mm"}]),),
        "operation.output[0].at", 'a station on rotor "output", which is 200 mm long',
    ),
    "torque off the shaft": Trap(
        lambda: machine(torque_at=0.5), "machine: torque_at",
        (("operation.at", "500 mm"),), "operation.at", 'a station on rotor "input", which is 200 mm long',
    ),
    "output where the torque comes in": Trap(
        lambda: machine(outputs=[Output("input", 71.77)]), "machine: outputs[0].shaft",
        (("operation.output", [{"rotor": "input", "torque": "71.77 N*m"}]),), "operation.output[0].rotor",
        'a rotor other than "input", where the torque comes in',
    ),
    "bow of one point": Trap(
        lambda: shaft(bow=Bow(np.array([0.1]), np.array([1e-5]))), "shaft 'input': bow",
        (("rotor.0.bow", [{"at": "100 mm", "amplitude": "0.01 mm"}]),), "rotor[0].bow",
        "two points or more: the centre line through one is straight and bends no shaft; ",
    ),
    "gears side by side": Trap(
        lambda: machine(gears=[gear("pinion", "input", 0.05), gear("wheel", "output")]),
        "gear pair 'pinion' -> 'wheel': driven",
        (("gear.0.at", "50 mm"),), "gear_pair[0].driven",
        "gears in one plane, within half a face width, 3.175 mm; they are 50 mm apart along z",
    ),
    "table of a bearing that ends too early": Trap(
        lambda: over_speeds(1.0, 100.0), "bearing 'input-back': speeds",
        (("bearing.0.speeds", ["10 rpm", "1000 rpm"]),
         ("bearing.0.stiffness", {"xx": ["1e8 N/m", "1e8 N/m"], "yy": "1e8 N/m"})),
        "bearing[0].speeds", 'a table that holds the speeds of rotor "input", 5500',
    ),
    "gear in mesh with itself": Trap(
        lambda: GearPair("pinion", "pinion"), "gear pair 'pinion -> pinion': driven",
        (("gear_pair.0.driven", "pinion"),), "gear_pair[0].driven",
    ),
    "gravity of two numbers": Trap(
        lambda: machine(gravity=(0.0, -9.81)), "machine: gravity",
        (("operation.gravity", ["0 m/s^2", "-9.81 m/s^2"]),), "operation.gravity",
    ),
}  # fmt: skip


def problems(trap: Trap) -> dict[str, str]:
    with pytest.raises(CaseError) as caught:
        parse_case(changed(trap.case, *trap.changes))
    return {problem.key: problem.expected for problem in caught.value.problems}


@pytest.mark.parametrize("trap", TRAPS.values(), ids=TRAPS)
def test_both_ways_refuse_with_one_sentence(trap: Trap) -> None:
    with pytest.raises(RefusedPartError) as caught:
        trap.make()
    found = {finding.label: finding.expected for finding in caught.value.findings}
    assert trap.label in found
    assert found[trap.label].startswith(trap.expected)
    told = problems(trap)
    (expected,) = (text for key, text in told.items() if key == trap.key or key.startswith(f"{trap.key}["))
    assert expected.startswith(trap.expected)


WITHOUT_A_KEY: dict[str, tuple[Callable[[], object], str]] = {
    "stiffness of NaN": (lambda: component(stiffness=np.diag([NAN, 1.0])), "housing 'housing': stiffness"),
    "negative stiffness": (lambda: component(stiffness=np.diag([-1e6, 1.0])), "housing 'housing': stiffness"),
    "stiffness of one way": (
        lambda: component(stiffness=np.array([[1e6, 5e5], [0.0, 1e6]])), "housing 'housing': stiffness"
    ),
    "stiffness of three modes": (lambda: component(stiffness=np.eye(3)), "housing 'housing': stiffness"),
    "damping that feeds": (lambda: component(damping=np.diag([-1.0, 0.0])), "housing 'housing': damping"),
    "gyroscopic that is not": (lambda: component(gyroscopic=np.eye(2)), "housing 'housing': gyroscopic"),
    "seat of five motions": (lambda: component(seats={"s": np.ones((2, 5))}), "housing 'housing': seats.s"),
    "seat without a place": (lambda: component(seat_z={}), "housing 'housing': seat_z.s"),
    "sensor without direction": (lambda: Sensor("a", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), "sensor 'a': direction"),
    "sensor in a plane": (lambda: Sensor("a", (0.0, 0.0)), "sensor 'a': position"),  # type: ignore[arg-type]
    "seat of a negative diameter": (lambda: Seat("s", (0.0, 0.0, 0.0), -0.05), "seat 's': diameter"),
    "seat at NaN": (lambda: Seat("s", (NAN, 0.0, 0.0)), "seat 's': center"),
    "mass of a text": (lambda: LumpedMass("m", "1 kg", position=(0.0, 0.0, 0.0)), "mass 'm': mass"),  # type: ignore[arg-type]
    "support that pushes": (lambda: Support("b", "bottom", stiffness=(-1e6, 1.0, 1.0)), "support 'b': stiffness"),
    "segment of a text": (lambda: segment("0.1"), "segment: length"),
    "rotor of texts": (lambda: Rotor("r", ["x"]), "rotor 'r': segments[0]"),  # type: ignore[list-item]
    "half a mode": (lambda: shaft(mode_count=2.5), "shaft 'input': mode_count"),
    "law of a bearing that is none": (lambda: bearing("b", "input", 0.1, law="gap"), "bearing 'b': law"),
    "ripple of a text": (lambda: machine(ripple=["x"]), "machine: ripple[0]"),
    "motor of a number": (lambda: machine(motor=3.0), "machine: motor"),
    "bearing on no shaft": (
        lambda: machine(bearings=bearings(bearing("input-back", "inptu", 0.02))), "bearing 'input-back': rotor"
    ),
    "torque over negative speeds": (lambda: TorqueLine([-5.0, 1.0], [1.0, 2.0]), "torque over speed: speeds"),
    "run that never starts": (lambda: SpeedRun([0.0, 1.0], [0.0, 0.0]), "run: times"),
    "shaking at no frequency": (lambda: BaseHarmonic(0.0, np.ones(6)), "base motion: frequency"),
    "shaking of NaN": (lambda: BaseHistory(np.array([0.0, 1.0]), np.full((2, 6), NAN)), "base motion: values"),
    "motion that is none": (lambda: BaseMotion(("x",)), "base motion: parts[0]"),  # type: ignore[arg-type]
    "gamma of NaN": (lambda: settings(gamma=NAN), "time integration: gamma"),
    "duration of a text": (lambda: settings(duration="1 s"), "time integration: duration"),
    "nothing recorded": (lambda: TransientPlan(4, discard=4), "transient: discard"),
    "next to nothing recorded": (lambda: TransientPlan(4, discard=3.995), "transient: revolutions"),
    "half a point": (lambda: TransientPlan(4, points_per_revolution=512.5), "transient: points_per_revolution"),  # type: ignore[arg-type]
    "too few points": (lambda: TransientPlan(4, points_per_revolution=20), "transient: points_per_revolution"),
    "steps of any size": (lambda: TransientPlan(4, tolerance=2.0), "transient: tolerance"),
    "start that is none": (lambda: TransientPlan(4, start="loaded"), "transient: start"),  # type: ignore[arg-type]
    "method that is none": (lambda: TransientPlan(4, method="euler"), "transient: method"),  # type: ignore[arg-type]
    "fewer than no coordinates": (lambda: TransientPlan(4, modal_coordinates=-1), "transient: modal_coordinates"),
}  # fmt: skip


@pytest.mark.parametrize(("make", "label"), WITHOUT_A_KEY.values(), ids=WITHOUT_A_KEY)
def test_parts_that_a_case_cannot_say_are_refused_too(make: Callable[[], object], label: str) -> None:
    with pytest.raises(RefusedPartError) as caught:
        make()
    assert label in [finding.label for finding in caught.value.findings]


def test_sound_parts_are_accepted() -> None:
    """The parts that the traps are made of are no traps themselves."""
    assert machine(gravity=(0.0, -9.81, 0.0), outputs=[Output("output", 71.77, 0.1)]).speeds["output"] == -576.0
    assert seated(0.02 + 0.034).housing is not None
    assert over_speeds(1.0, 600.0).bearings
    assert settings().samples == 5000


_NEVER_NEGATIVE = {"mass", "inertia", "imbalance", "torque", "ratio"}
_NEVER_ZERO = {"density", "modulus"}


def test_types_of_numbers_have_the_limits_that_their_names_say() -> None:
    """A mass may be zero, a density not; a damping ratio is below 1; a type from zero or positive is so in its name."""
    held = 0
    for name, kind in vars(fields).items():
        rules = [one for one in getattr(kind, "__metadata__", ()) if isinstance(one, fields.Quantity)]
        for rule in rules:
            words = {word.lower() for word in re.findall("[A-Z][a-z]+", name)}
            positive = "positive" in words or bool(words & _NEVER_ZERO)
            from_zero = not positive and ("zero" in words or bool(words & _NEVER_NEGATIVE))
            assert (rule.above, rule.at_least) == (0.0 if positive else None, 0.0 if from_zero else None), name
            assert (rule.below, rule.at_most) == (1.0 if "ratio" in words else None, None), name
            held += 1
    assert held > 18
