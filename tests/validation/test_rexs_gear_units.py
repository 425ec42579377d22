"""Equilibria of industrial gear units, of public REXS files, against statics by hand.

- FVA's two-stage industrial gear unit: REXS 1.4, ``test/example_models/FVA-Industriegetriebe_2stufig_1-4.rexs`` of
  BearinxSimulationSuite/REXSapi (GitHub). Shafts, gears, bearing names and four load cases; no results.

- SEW's three-stage cylindrical gear unit: REXS 1.0, ``api/src/test/resources/SEW_3-stage_cylindrical_gearbox_1.0.rexs``
  of fva-net/rexs-api-java (GitHub). Shafts, gears, bearings with C and C0, the motor's torque; no results. The last but
  one shaft stands in three bearings.

Both files name bearings without their insides: those of tapered rollers follow from the main dimensions, C0, e and the
distance a of the pressure centre in SKF's general catalogue, all others from C and C0. The needle bearing of FVA's unit
stands between input and output shaft, which a machine cannot have: a stiff one on the ground takes its place, and its
force acts on the output shaft. Ball bearings that are loose axially in SEW's unit are radial springs, as those of
elements always hold the shaft axially. Weight is left out, as its direction is in neither file.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from gearwhine.coupling import Machine, MountedBearing, Output, Shaft, ShaftForce, ShaftGear
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.contact.contact_law import tooth_contact
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.face_load import FaceContact, face_load_factor
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import stiffness_under_load
from gearwhine.coupling.statics.operating_point import OperatingPoint, PairLoad
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial
from gearwhine.rotors.rolling_bearings import RollingBearing, catalogue_bearing, catalogue_row

Published = Callable[..., None]

HAND = "FVA two-stage industrial gear unit (REXS 1.4), statics by hand"
SEW_HAND = "SEW three-stage gear unit (REXS 1.0), statics by hand"
STEEL = ShaftMaterial.from_poisson_ratio(210e9, 0.3, 7850.0)
PRESSURE = math.radians(20.0)
PILOT = 0.015


class Wheel(NamedTuple):
    """A gear: teeth, profile shift, face width and bore [mm], its shaft and the place of its middle on it [mm]."""

    name: str
    teeth: int
    shift: float
    width: float
    bore: float
    shaft: str
    at: float


class Stage(NamedTuple):
    """Normal module [mm], helix angle of the driver [degrees], driver and driven gear."""

    module: float
    helix: float
    driver: Wheel
    driven: Wheel


class Unit(NamedTuple):
    """A gear unit.

    Of each shaft its axis and left end [mm], and length, outer and inner diameter of its segments [mm].
    """

    places: dict[str, tuple[float, float, float]]
    segments: dict[str, tuple[tuple[float, float, float], ...]]
    stages: tuple[Stage, ...]

    def at(self, shaft: str, at: float) -> FloatArray:
        """Place on the axis of a shaft, from its left end [m]."""
        return 1e-3 * np.array(self.places[shaft]) + [0.0, 0.0, at]


FVA = Unit(
    places={"input": (0.0, 0.0, -70.0), "intermediate": (0.0, -190.0, -25.0), "output": (0.0, 0.0, 90.0)},
    segments={
        "input": ((80, 50, 0), (80, 60, 0), (30, 50, 0)),
        "intermediate": ((45, 80, 0), (60, 90, 0), (165, 80, 0)),
        "output": ((31, 70, 58), (82, 70, 0), (10, 80, 0), (100, 60, 0)),
    },
    stages=(
        Stage(
            4.5,
            21,
            Wheel("pinion 1", 27, 0.231415, 50, 60, "input", 117),
            Wheel("wheel 1", 51, 0.231415, 50, 90, "intermediate", 72),
        ),
        Stage(
            6.5,
            -10,
            Wheel("pinion 2", 23, 0.15074, 74, 80, "intermediate", 180),
            Wheel("wheel 2", 34, 0.15074, 74, 70, "output", 65),
        ),
    ),
)
SEW = Unit(
    places={
        "ANW": (0.0, 0.0, 0.0),
        "RW3": (47.02148907341676, -24.45362069957225, 137.5),
        "RW5": (50.33350037591513, 32.45007497243242, 128.5),
        "ABW": (-19.008575782311063, -1.026431327759056, 182.7),
    },
    segments={
        "ANW": (
            *((40, 19, 0), (11.5, 22, 0), (2.3, 25, 0), (1.3, 23.9, 0), (18.9, 25, 0), (30.3, 30, 0)),
            *((15.2, 25, 0), (22.5, 22, 0), (4, 14, 0), (15.9, 10, 0), (1.1, 9.6, 0), (1.5, 10, 0)),
        ),
        "RW3": ((2.5, 14.8, 0), (10, 15, 0), (13.5, 16, 0), (23, 14, 0), (10.5, 15, 0)),
        "RW5": (
            *((7, 14.6, 0), (14, 15, 0), (52, 20, 0), (5, 25.91, 0), (41, 18.403, 0), (9, 25.91, 0)),
            *((12, 17, 0), (3, 16.8, 0)),
        ),
        "ABW": (
            *((4, 35, 0), (1.6, 33, 0), (20.4, 35, 0), (39, 40, 0), (44, 39.5, 0), (22, 40, 0)),
            *((19, 47, 0), (70, 35, 0)),
        ),
    },
    stages=(
        Stage(
            1.0,
            30,
            Wheel("pinion 1", 23, 0.581, 16, 10, "ANW", 154),
            Wheel("wheel 1", 67, 0.5131, 11, 16, "RW3", 19),
        ),
        Stage(
            1.25,
            -10,
            Wheel("pinion 2", 13, 0.521, 23, 14, "RW3", 37.5),
            Wheel("wheel 2", 76, -0.094, 15, 20, "RW5", 49),
        ),
        Stage(
            1.5,
            10,
            Wheel("pinion 3", 14, 0.536, 41, 18.403, "RW5", 98.5),
            Wheel("wheel 3", 87, -0.4815, 36, 40, "ABW", 44.3),
        ),
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
        1e-3 * wheel.width,
        wheel.shift,
        bore=1e-3 * wheel.bore,
        helix_angle=hand * math.radians(stage.helix),
    )


def machine_of(
    unit: Unit,
    bearings: Sequence[MountedBearing],
    torque: float,
    speed: float,
    out: float,
    forces: Sequence[ShaftForce],
) -> Machine:
    """Driven at the left end of the first shaft, with the load on the last one."""
    shafts = [
        Shaft(
            Rotor(name, [Segment(1e-3 * length, 1e-3 * outer, 1e-3 * inner, STEEL) for length, outer, inner in parts]),
            (1e-3 * unit.places[name][0], 1e-3 * unit.places[name][1]),
            1e-3 * unit.places[name][2],
        )
        for name, parts in unit.segments.items()
    ]
    gears = [
        ShaftGear(toothed(stage, wheel, hand), wheel.shaft, 1e-3 * wheel.at)
        for stage in unit.stages
        for wheel, hand in ((stage.driver, 1), (stage.driven, -1))
    ]
    ratio = math.prod(stage.driven.teeth / stage.driver.teeth for stage in unit.stages)
    return Machine(
        shafts,
        list(bearings),
        gears,
        [GearPair(stage.driver.name, stage.driven.name) for stage in unit.stages],
        speed=speed * math.pi / 30.0,
        torque=torque,
        outputs=[Output(unit.stages[-1].driven.shaft, torque * ratio, out)],
        forces=forces,
    )


def gear_unit(case: LoadCase, from_needle: FloatArray) -> Machine:
    forces = [
        ShaftForce("input", 0.0, case.on_input),
        ShaftForce("output", 0.17, case.on_output),
        ShaftForce("output", PILOT, (float(from_needle[0]), float(from_needle[1]), 0.0)),
    ]
    return machine_of(FVA, bearings(), case.torque, case.speed, 0.17, forces)


@cache
def equilibrium(number: int) -> tuple[Machine, OperatingPoint]:
    """Of a load case, solved twice: the needle bearing, and so its force, knows nothing of the output shaft."""
    case, force = CASES[number], np.zeros(2)
    for _ in range(2):
        machine = gear_unit(case, force)
        point = machine.operating_point()
        force = point.bearing("needle").force[:2]
    return machine, point


def tooth_force(unit: Unit, stage: Stage, torque: float) -> tuple[FloatArray, FloatArray]:
    """Force of the driver on the driven gear [N], and the pitch point in the middle of the face that both share [m].

    The driver's torque is along z.
    """
    first, second = stage.driver, stage.driven
    helix = math.radians(stage.helix)
    transverse = math.atan(math.tan(PRESSURE) / math.cos(helix))
    base = 0.5e-3 * first.teeth * stage.module / math.cos(helix) * math.cos(transverse)
    middle = unit.at(first.shaft, 0.0)
    ends = [
        [unit.at(gear.shaft, 1e-3 * (gear.at + side * gear.width))[2] for gear in (first, second)]
        for side in (-0.5, 0.5)
    ]
    middle[2] = 0.5 * (max(ends[0]) + min(ends[1]))
    apart = (unit.at(second.shaft, 0.0) - middle)[:2]
    radius = float(np.hypot(*apart)) * first.teeth / (first.teeth + second.teeth)
    line = apart / np.hypot(*apart)
    tangential = torque / radius
    radial = abs(tangential) * math.tan(math.acos(base / radius))
    across = np.array([-line[1], line[0]])
    axial = -torque / base * math.tan(helix) * math.cos(transverse)
    return np.array([*(tangential * across + radial * line), axial]), middle + [*(radius * line), 0.0]


def loads(unit: Unit, machine: Machine, shaft: str, centres: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Sum of the forces of teeth and ends on a shaft, and of their moments about the origin, with torques about z.

    ``centres`` are the middles of the tooth loads beside the pitch points, by drivers.
    """
    force, moment = np.zeros(3), np.zeros(3)
    torque = machine.torque
    for stage in unit.stages:
        on_driven, pitch = tooth_force(unit, stage, torque)
        for wheel, acting in ((stage.driver, -on_driven), (stage.driven, on_driven)):
            if wheel.shaft == shaft:
                force += acting
                moment += np.cross(pitch + centres[stage.driver.name], acting)
        torque *= -stage.driven.teeth / stage.driver.teeth
    for one in machine.forces:
        if one.rotor == shaft:
            force += one.force
            moment += np.cross(unit.at(shaft, one.at), one.force)
    return force, moment


MIDDLE = {f"pinion {number}": np.zeros(3) for number in (1, 2, 3)}


def load_centre(pair: PairLoad) -> FloatArray:
    """Middle of the tooth load over face, path of contact and mesh period, beside the pitch point [m]."""
    geometry, mesh = pair.pair.geometry, pair.mesh
    faces = pair.pair.contact.tooth_contact.faces
    along = (mesh.positions[:, :, None] + faces.shift - geometry.pitch_point_position) * geometry.base_pitch
    weight = mesh.line_loads / mesh.line_loads.sum(axis=(1, 2))[:, None, None]
    across = np.where(weight > 0.0, weight * along, 0.0).sum(axis=(1, 2)).mean()
    return np.array([*(across * np.asarray(pair.pair.push)), (weight * faces.z).sum(axis=(1, 2)).mean()])


def radial_by_hand(
    unit: Unit, machine: Machine, shaft: str, bearings: tuple[float, float], more: ShaftForce | None = None
) -> FloatArray:
    """Forces on two bearings at these places on a shaft that tilts freely in them, teeth bearing in mid-face [N]."""
    own = [one for one in machine.forces if one.at != PILOT]
    force, moment = loads(unit, replace(machine, forces=[*own, *([more] if more else [])]), shaft, MIDDLE)
    first, second = (unit.at(shaft, at) for at in bearings)
    # The thrust acts on the axis, wherever a bearing takes it.
    moment -= np.cross(first, force)
    on_second = np.array([moment[1], -moment[0]]) / (second - first)[2]
    return np.array([force[:2] - on_second, on_second])


def assert_in_balance(unit: Unit, machine: Machine, point: OperatingPoint) -> None:
    """With the tooth forces of the geometry where the teeth bear, bearing forces and moments leave only the torques."""
    centres = {pair.names[0]: load_centre(pair) for pair in point.pairs}
    first, last = machine.shafts[0].name, machine.shafts[-1].name
    ratio = math.prod(-stage.driven.teeth / stage.driver.teeth for stage in unit.stages)
    ends = {first: machine.torque, last: -machine.torque * ratio}
    largest = max(pair.force for pair in point.pairs)
    for shaft in unit.places:
        axis = unit.at(shaft, 0.0)
        force, moment = loads(unit, machine, shaft, centres)
        moment -= np.cross(axis, force)
        for bearing in point.bearings:
            if bearing.mounted.rotor == shaft:
                force -= bearing.force[:3]
                moment -= np.cross([0.0, 0.0, bearing.mounted.bearing.at], bearing.force[:3])
                moment[:2] -= bearing.force[3:]
        np.testing.assert_allclose(force, 0.0, atol=1e-9 * largest)
        # The middle of the load on slices is known to some micrometres.
        np.testing.assert_allclose(moment[:2], 0.0, atol=5e-6 * largest)
        assert moment[2] == pytest.approx(-ends.get(shaft, 0.0), abs=1e-6)


def test_fva_face_load_factor_converges_with_slices() -> None:
    """K_Hβ under the approach found, with 31, 61 and 121 slices of the face."""
    _, point = equilibrium(0)
    for pair in point.pairs:
        geometry, contact, found = pair.pair.geometry, pair.pair.contact, []
        model = stiffness_under_load("elastic-ring", geometry, pair.force)
        shape = pair.approach - contact.uniform * float(contact.face_mean @ pair.approach)
        for count in (31, 61, 121):
            faces = face_slices(geometry, count=count)
            law = contact.tooth_contact
            assert law.faces is not None
            if (faces.shift[-1] > 0.0) != (law.faces.shift[-1] > 0.0):
                faces = replace(faces, shift=-faces.shift)
            law = tooth_contact(geometry, model, corner_contact=law.has_corner_contact, faces=faces)
            sliced = FaceContact(law, geometry, contact.stations, pair.pair.axial)
            phases = pair.fine.phases
            load = sliced.under_force(pair.force, shape, phases)
            found.append(face_load_factor(load, sliced.evenly(pair.force, phases)))
        assert found[1] == pytest.approx(pair.k_h_beta, rel=1e-9)
        np.testing.assert_allclose(np.diff(found), 0.0, atol=0.005)


@pytest.mark.parametrize("number", [0, 1])
def test_fva_face_load_factor_beside_iso_6336(published: Published, number: int) -> None:
    """ISO 6336-1, 7.5, 1 + F_βy c_γβ b / 2 F_m for a straight gap, c_γβ the mean mesh stiffness over b.

    The norm's mesh is as stiff against tilt as against approach. Teeth and bodies that resist tilt make the slope of
    the load between the ends a quarter to a third steeper, and the twisted teeth press at their ends.
    """
    pair = equilibrium(0)[1].pairs[number]
    width = pair.pair.geometry.face_width
    iso = 1.0 + 0.5 * abs(pair.misalignment) * width * pair.mean_stiffness / pair.force
    published(HAND, f"K_Hβ of stage {number + 1}, load case 1, by ISO 6336-1", iso, pair.k_h_beta, rel=0.25)
    inner = np.abs(pair.z) < 0.4 * width
    slope = float(np.polyfit(pair.z[inner], pair.line_load[inner] / pair.line_load.mean(), 1)[0])
    line = 1.0 + 0.5 * abs(slope) * width
    assert iso < line < pair.k_h_beta


# Type, bore, outside diameter, width [mm], C and C0 [kN], shaft and place [mm].
SEW_BEARINGS = {
    "6305": ("deep-groove", 25, 62, 17, 22.4, 11.4, "ANW", 65.5),
    "6202 left": ("deep-groove", 15, 35, 11, 7.8, 3.75, "RW3", 6.5),
    "6202 right": ("deep-groove", 15, 35, 11, 7.8, 3.75, "RW3", 54.5),
    "6302": ("deep-groove", 15, 42, 13, 11.4, 5.4, "RW5", 13.5),
    "NUP 204": ("cylindrical-roller", 20, 47, 14, 32.5, 24.7, "RW5", 66),
    "6303": ("deep-groove", 17, 47, 14, 15.0, 6.5, "RW5", 135),
    "6308": ("deep-groove", 40, 90, 23, 42.5, 25.0, "ABW", 119.5),
}
SEW_LOOSE = {"6205": ("ANW", 111.8), "6207": ("ABW", 16.8)}


def sew_unit() -> Machine:
    held = []
    for name, (kind, bore, outside, width, dynamic, static, shaft, at) in SEW_BEARINGS.items():
        size = (1e-3 * bore, 1e-3 * outside, 1e-3 * width)
        one = catalogue_bearing(kind, *size, static=1e3 * static, dynamic=1e3 * dynamic, name=name)
        held.append(mounted(one, shaft, at))
    for name, (shaft, at) in SEW_LOOSE.items():
        spring = Bearing(name, 1e-3 * at, 1e8 * np.eye(2), np.zeros((2, 2)))
        held.append(MountedBearing(spring, shaft, None))
    return machine_of(SEW, held, 4.724562306435156, 1400.0, 0.185, ())


@pytest.mark.parametrize("number", [0, 3])
def test_fva_shafts_are_in_balance(number: int) -> None:
    assert_in_balance(FVA, *equilibrium(number))


@pytest.mark.parametrize("number", [0, 3])
def test_fva_bearings_by_hand(published: Published, remark: Callable[[str, str], None], number: int) -> None:
    remark(
        HAND,
        "By hand the teeth bear in mid-face and no bearing resists tilt. In the machine the load stands 1.9 and 5.5 mm "
        "off the middle, and the 6210 takes 31 N·m of load case 1; with both counted, sums of forces and moments of "
        "every shaft vanish. The induced thrust F_r / 2Y of a catalogue assumes half the circle loaded; less of a row "
        "that external thrust relieves is.",
    )
    machine, point = equilibrium(number)

    def force(name: str) -> FloatArray:
        return point.bearing(name).force

    ball, needle = radial_by_hand(FVA, machine, "input", (0.065, 0.175))
    from_input = ShaftForce("output", PILOT, (*needle.tolist(), 0.0))
    pair = TAPERED["33016 left"].centre, TAPERED["33016 right"].centre
    left, right = radial_by_hand(FVA, machine, "intermediate", pair)
    near, far = radial_by_hand(FVA, machine, "output", (TAPERED["33014"].centre, TAPERED["33012"].centre), from_input)
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
        thrust = loads(FVA, machine, shaft, MIDDLE)[0][2]
        ours = sum(force(name)[2] for name in (taken_by, *other))
        published(HAND, f"thrust of the {shaft} shaft, {case}", thrust, float(ours), "N", rel=1e-6)
        if other:
            # The thrust presses the left one on; the right one keeps what its radial force induces.
            assert thrust < 0.0
            induced = 0.5 * float(np.hypot(*force(other[0])[:2])) / TAPERED[other[0]].y
            assert 0.85 * induced < force(other[0])[2] < induced


@cache
def sew_equilibrium() -> tuple[Machine, OperatingPoint]:
    machine = sew_unit()
    return machine, machine.operating_point()


def test_sew_shafts_are_in_balance() -> None:
    """Of offset faces, an overhung pinion and a shaft in three bearings."""
    assert_in_balance(SEW, *sew_equilibrium())


def test_sew_bearings_by_hand(published: Published, remark: Callable[[str, str], None]) -> None:
    remark(
        SEW_HAND,
        "By hand the teeth bear in the middle of the common face and no bearing resists tilt. In the machine the load "
        "stands 1 mm off it, on a span of 48 mm of the shaft RW3, and the 6308 takes 10 N·m.",
    )
    machine, point = sew_equilibrium()
    for shaft, names in {"ANW": ("6305", "6205"), "RW3": ("6202 left", "6202 right"), "ABW": ("6207", "6308")}.items():
        places = [point.bearing(name).mounted.bearing.at for name in names]
        for name, expected in zip(names, radial_by_hand(SEW, machine, shaft, (places[0], places[1])), strict=True):
            ours = float(np.hypot(*point.bearing(name).force[:2]))
            published(SEW_HAND, f"radial force on {name}", float(np.hypot(*expected)), ours, "N", rel=0.18)
    for shaft in SEW.places:
        thrust = loads(SEW, machine, shaft, MIDDLE)[0][2]
        ours = sum(one.force[2] for one in point.bearings if one.mounted.rotor == shaft)
        published(SEW_HAND, f"thrust of the shaft {shaft}", thrust, float(ours), "N", rel=1e-6)
