"""Equilibria of industrial gear units, of public REXS files, against statics by hand.

- FVA's two-stage industrial gear unit: REXS 1.4, ``test/example_models/FVA-Industriegetriebe_2stufig_1-4.rexs`` of
  BearinxSimulationSuite/REXSapi (GitHub). Shafts, gears, bearing names and four load cases; no results.

The file names bearings without their insides: those of tapered rollers follow from the main dimensions, C0, e and the
distance a of the pressure centre in SKF's general catalogue, those of the 6210 from its C and C0. The needle bearing
of the file stands between input and output shaft, which a machine cannot have: a stiff one on the ground takes its
place, and its force acts on the output shaft. Weight is left out, as its direction is not in the file.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

from coupling import Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from coupling.gears import Gear
from coupling.gears.loaded.gear_pair import GearPair
from coupling.statics.operating_point import OperatingPoint, PairLoad
from rotors import Bearing, Rotor, Segment, ShaftMaterial
from rotors.rolling_bearings import RollingBearing, catalogue_bearing, catalogue_row

FloatArray = npt.NDArray[np.float64]
Published = Callable[..., None]

HAND = "FVA two-stage industrial gear unit (REXS 1.4), statics by hand"
STEEL = ShaftMaterial.from_poisson_ratio(210e9, 0.3, 7850.0)
DISTANCE, PILOT = 0.19, 0.015
PRESSURE = math.radians(20.0)
STARTS = {"input": -0.07, "intermediate": -0.025, "output": 0.09}
AXES = {"input": (0.0, 0.0), "intermediate": (0.0, -DISTANCE), "output": (0.0, 0.0)}
# Length, outer and inner diameter [mm].
SEGMENTS = {
    "input": ((80, 50, 0), (80, 60, 0), (30, 50, 0)),
    "intermediate": ((45, 80, 0), (60, 90, 0), (165, 80, 0)),
    "output": ((31, 70, 58), (82, 70, 0), (10, 80, 0), (100, 60, 0)),
}


class Wheel(NamedTuple):
    """A gear: teeth, profile shift, bore [mm], its shaft and place on it [mm]."""

    name: str
    teeth: int
    shift: float
    bore: float
    shaft: str
    at: float


class Stage(NamedTuple):
    """Normal module and face width [mm], helix angle of the driver [degrees], driver and driven gear."""

    module: float
    width: float
    helix: float
    driver: Wheel
    driven: Wheel


STAGES = (
    Stage(
        4.5,
        50,
        21,
        Wheel("pinion 1", 27, 0.231415, 60, "input", 117),
        Wheel("wheel 1", 51, 0.231415, 90, "intermediate", 72),
    ),
    Stage(
        6.5,
        74,
        -10,
        Wheel("pinion 2", 23, 0.15074, 80, "intermediate", 180),
        Wheel("wheel 2", 34, 0.15074, 70, "output", 65),
    ),
)


class Tapered(NamedTuple):
    """Bore, outside diameter, width [mm], C0 [kN], e, Y and a [mm] (SKF), shaft, place [mm] and side it faces."""

    bore: float
    outside: float
    width: float
    static: float
    e: float
    y: float
    a: float
    shaft: str
    at: float
    direction: int

    @property
    def centre(self) -> float:
        """Where the lines of contact meet the axis, from the shaft's left end [m]."""
        return 1e-3 * (self.at - self.direction * (self.a - 0.5 * self.width))


TAPERED = {
    "33016 left": Tapered(80, 125, 36, 285, 0.28, 2.1, 26, "intermediate", 20, -1),
    "33016 right": Tapered(80, 125, 36, 285, 0.28, 2.1, 26, "intermediate", 250, 1),
    "33014": Tapered(70, 110, 31, 196, 0.28, 2.1, 23, "output", 13, -1),
    "33012": Tapered(60, 95, 27, 143, 0.33, 1.8, 20, "output", 140, 1),
}


class LoadCase(NamedTuple):
    """Torque [N m], speed [1/min] and forces on the ends of the input and output shafts [N]."""

    torque: float
    speed: float
    on_input: tuple[float, float, float]
    on_output: tuple[float, float, float]


CASES = (
    LoadCase(567.0, 543.0, (456.0, 0.0, 0.0), (123.0, 0.0, 0.0)),
    LoadCase(345.0, 3456.0, (678.0, 0.0, 0.0), (0.0, 0.0, 123.0)),
    LoadCase(456.0, 1234.0, (876.0, 0.0, 0.0), (345.0, 0.0, 0.0)),
    LoadCase(789.0, 789.0, (1233.0, 0.0, 0.0), (0.0, 0.0, 567.0)),
)


def bearing_of_elements(name: str, tapered: Tapered) -> RollingBearing:
    """Its row moved along the shaft until the lines of contact meet the axis where the catalogue says."""
    row = catalogue_row(
        "tapered-roller",
        1e-3 * tapered.bore,
        1e-3 * tapered.outside,
        1e-3 * tapered.width,
        contact_angle=math.atan(tapered.e / 1.5),
        static=1e3 * tapered.static,
    )
    angle = row.contact_angle
    # The middle of a roller stands half its diameter inside the outer raceway.
    arm = 0.5 * (row.pitch_diameter * math.sin(angle) + row.roller_diameter * math.sin(row.roller_angle))
    position = tapered.centre - 1e-3 * tapered.at + tapered.direction * arm / math.cos(angle)
    return RollingBearing([replace(row, direction=tapered.direction, position=position)], name=name)


def mounted(rolling: RollingBearing, shaft: str, at: float) -> MountedBearing:
    free = Bearing(rolling.name, 1e-3 * at, np.zeros((5, 5)), np.zeros((5, 5)))
    return MountedBearing(free, shaft, None, rolling=rolling)


@cache
def bearings() -> tuple[MountedBearing, ...]:
    ball = catalogue_bearing("deep-groove", 0.05, 0.09, 0.02, static=23.2e3, dynamic=37.1e3, name="6210")
    return (
        mounted(ball, "input", 65),
        MountedBearing(Bearing("needle", 0.175, 1e9 * np.eye(2), np.zeros((2, 2))), "input", None),
        *(mounted(bearing_of_elements(name, one), one.shaft, one.at) for name, one in TAPERED.items()),
    )


def toothed(stage: Stage, wheel: Wheel, hand: int) -> Gear:
    return Gear(
        wheel.name,
        wheel.teeth,
        1e-3 * stage.module,
        PRESSURE,
        1e-3 * stage.width,
        wheel.shift,
        bore=1e-3 * wheel.bore,
        helix_angle=hand * math.radians(stage.helix),
    )


def gear_unit(case: LoadCase, from_needle: FloatArray) -> Machine:
    gears = [
        ShaftGear(toothed(stage, wheel, hand), wheel.shaft, 1e-3 * wheel.at)
        for stage in STAGES
        for wheel, hand in ((stage.driver, 1), (stage.driven, -1))
    ]
    ratio = math.prod(stage.driven.teeth / stage.driver.teeth for stage in STAGES)
    shafts = [
        Shaft(
            Rotor(name, [Segment(1e-3 * length, 1e-3 * outer, 1e-3 * inner, STEEL) for length, outer, inner in parts]),
            AXES[name],
            STARTS[name],
        )
        for name, parts in SEGMENTS.items()
    ]
    return Machine(
        shafts,
        list(bearings()),
        gears,
        [GearPair(stage.driver.name, stage.driven.name) for stage in STAGES],
        speed=case.speed * math.pi / 30.0,
        torque=case.torque,
        outputs=[Output("output", case.torque * ratio, 0.17)],
        forces=[
            ShaftForce("input", 0.0, case.on_input),
            ShaftForce("output", 0.17, case.on_output),
            ShaftForce("output", PILOT, (float(from_needle[0]), float(from_needle[1]), 0.0)),
        ],
    )


@cache
def equilibrium(number: int) -> tuple[Machine, OperatingPoint]:
    """Of a load case, solved twice: the needle bearing, and so its force, knows nothing of the output shaft."""
    case, force = CASES[number], np.zeros(2)
    for _ in range(2):
        machine = gear_unit(case, force)
        point = machine.operating_point()
        force = point.bearing("needle").force[:2]
    return machine, point


def tooth_forces(stage: Stage, torque: float) -> tuple[FloatArray, float]:
    """Force of the driver on the driven gear [N], and the driver's working pitch radius [m].

    The axes stand a centre distance apart along y; the driver turns about +z if its torque is positive.
    """
    first, second = stage.driver, stage.driven
    helix = math.radians(stage.helix)
    transverse = math.atan(math.tan(PRESSURE) / math.cos(helix))
    base = 0.5e-3 * first.teeth * stage.module / math.cos(helix) * math.cos(transverse)
    radius = DISTANCE * first.teeth / (first.teeth + second.teeth)
    working = math.acos(base / radius)
    tangential = abs(torque) / radius
    line = np.subtract(AXES[second.shaft], AXES[first.shaft]) / DISTANCE
    across = math.copysign(1.0, torque) * np.array([-line[1], line[0]])
    radial = tangential * math.tan(working)
    axial = -torque / base * math.tan(helix) * math.cos(transverse)
    return np.array([*(tangential * across + radial * line), axial]), radius


def loads(machine: Machine, shaft: str, centres: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Sum of the forces of teeth and ends on a shaft, and of their moments about the origin, with torques about z.

    ``centres`` are the middles of the tooth loads beside the pitch points, by drivers.
    """
    force, moment = np.zeros(3), np.zeros(3)

    def add(at: FloatArray, what: FloatArray) -> None:
        force.__iadd__(what)
        moment.__iadd__(np.cross(at, what))

    torque = machine.torque
    for stage in STAGES:
        on_driven, radius = tooth_forces(stage, torque)
        line = np.array([*np.subtract(AXES[stage.driven.shaft], AXES[stage.driver.shaft]), 0.0]) / DISTANCE
        pitch = np.array([*AXES[stage.driver.shaft], 0.0]) + radius * line + centres[stage.driver.name]
        pitch[2] += STARTS[stage.driver.shaft] + 1e-3 * stage.driver.at
        if stage.driver.shaft == shaft:
            add(pitch, -on_driven)
        if stage.driven.shaft == shaft:
            add(pitch, on_driven)
        torque *= -stage.driven.teeth / stage.driver.teeth
    for one in machine.forces:
        if one.rotor == shaft:
            add(np.array([*AXES[shaft], STARTS[shaft] + one.at]), np.asarray(one.force))
    return force, moment


MIDDLE = {stage.driver.name: np.zeros(3) for stage in STAGES}


def load_centre(pair: PairLoad) -> FloatArray:
    """Middle of the tooth load over face, path of contact and mesh period, beside the pitch point [m]."""
    geometry, mesh = pair.pair.geometry, pair.mesh
    faces = pair.pair.contact.tooth_contact.faces
    along = (mesh.positions[:, :, None] + faces.shift - geometry.pitch_point_position) * geometry.base_pitch
    weight = mesh.line_loads / mesh.line_loads.sum(axis=(1, 2))[:, None, None]
    across = np.where(weight > 0.0, weight * along, 0.0).sum(axis=(1, 2)).mean()
    return np.array([*(across * np.asarray(pair.pair.push)), (weight * faces.z).sum(axis=(1, 2)).mean()])


def radial_by_hand(
    machine: Machine, shaft: str, bearings: tuple[float, float], more: ShaftForce | None = None
) -> FloatArray:
    """Forces on two bearings at these places on a shaft that tilts freely in them, teeth bearing in mid-face [N]."""
    force, moment = loads(replace(machine, forces=[]), shaft, MIDDLE)
    here = [one for one in machine.forces if one.rotor == shaft and one.at != PILOT]
    for one in [*here, *([more] if more else [])]:
        force += one.force
        moment += np.cross([*AXES[shaft], STARTS[shaft] + one.at], one.force)
    first, second = (STARTS[shaft] + at for at in bearings)
    # The thrust acts on the axis, wherever a bearing takes it.
    moment -= np.cross([*AXES[shaft], 0.0], [0.0, 0.0, force[2]])
    on_second = np.array([moment[1] - first * force[0], -moment[0] - first * force[1]]) / (second - first)
    return np.array([force[:2] - on_second, on_second])


@pytest.mark.parametrize("number", [0, 3])
def test_fva_shafts_are_in_balance(number: int) -> None:
    """With the tooth forces of the geometry where the teeth bear, bearing forces and moments leave only the torques."""
    machine, point = equilibrium(number)
    centres = {pair.names[0]: load_centre(pair) for pair in point.pairs}
    turning = dict(zip(STARTS, (machine.torque, 0.0, -machine.outputs[0].torque), strict=True))
    for shaft in STARTS:
        force, moment = loads(machine, shaft, centres)
        for bearing in point.bearings:
            if bearing.mounted.rotor == shaft:
                at = [*AXES[shaft], STARTS[shaft] + bearing.mounted.bearing.at]
                force -= bearing.force[:3]
                moment -= np.cross(at, bearing.force[:3]) + [*bearing.force[3:], 0.0]
        largest = max(pair.force for pair in point.pairs)
        np.testing.assert_allclose(force, 0.0, atol=1e-9 * largest)
        # Approach and tilt of slices are solved together, the middle of their load to 5 micrometres.
        np.testing.assert_allclose(moment[:2], 0.0, atol=5e-6 * largest)
        assert moment[2] == pytest.approx(-turning[shaft], abs=1e-6)


@pytest.mark.parametrize("number", [0, 3])
def test_fva_bearings_by_hand(published: Published, remark: Callable[[str, str], None], number: int) -> None:
    remark(
        HAND,
        "By hand the teeth bear in mid-face and no bearing resists tilt. In the machine the load stands 2 and 7 mm off "
        "the middle, and the 6210 takes 31 N m of load case 1; with both counted, sums of forces and moments of every "
        "shaft vanish. The induced thrust F_r / 2Y of a catalogue assumes half the circle loaded; less of a row that "
        "external thrust relieves is.",
    )
    machine, point = equilibrium(number)

    def force(name: str) -> FloatArray:
        return point.bearing(name).force

    ball, needle = radial_by_hand(machine, "input", (0.065, 0.175))
    from_input = ShaftForce("output", PILOT, (*needle.tolist(), 0.0))
    pair = TAPERED["33016 left"].centre, TAPERED["33016 right"].centre
    left, right = radial_by_hand(machine, "intermediate", pair)
    near, far = radial_by_hand(machine, "output", (TAPERED["33014"].centre, TAPERED["33012"].centre), from_input)
    by_hand = {"6210": ball, "needle": needle, "33016 left": left, "33016 right": right, "33014": near, "33012": far}
    case = f"load case {number + 1}"
    for name, expected in by_hand.items():
        ours = float(np.hypot(*force(name)[:2]))
        published(HAND, f"radial force on {name}, {case}", float(np.hypot(*expected)), ours, "N", rel=0.18)
    for shaft, (taken_by, *other) in {
        "input": ("6210",),
        "intermediate": ("33016 left", "33016 right"),
        "output": ("33014", "33012"),
    }.items():
        thrust = loads(machine, shaft, MIDDLE)[0][2]
        ours = sum(force(name)[2] for name in (taken_by, *other))
        published(HAND, f"thrust of the {shaft} shaft, {case}", thrust, float(ours), "N", rel=1e-6)
        if other:
            # The thrust presses the left one on; the right one keeps what its radial force induces.
            assert thrust < 0.0
            induced = 0.5 * float(np.hypot(*force(other[0])[:2])) / TAPERED[other[0]].y
            assert 0.65 * induced < force(other[0])[2] < induced
