"""An independent static model of a gearbox for tests: own beams, springs, and gear meshes as quadratic forms.

Nothing of the code under test is used but the description of the parts. A shaft is a row of Timoshenko elements of 12
degrees of freedom (Przemieniecki, Theory of Matrix Structural Analysis, 1968, section 5.6), a housing its compliance at
the seats, a gear mesh a spring at each slice of the face.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling import Machine, MountedBearing, Shaft, ShaftGear
from gearwhine.coupling.gears import ConstantStiffness, Gear
from gearwhine.coupling.gears.geometry.toothed_section import toothed_section
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial

SLICES, STATIONS = 61, 5

STEEL = ShaftMaterial.from_poisson_ratio(2.07e11, 0.3, 7850.0)  # that of gears by default
MODULE, PRESSURE, HELIX, WIDTH = 3e-3, math.radians(20.0), math.radians(15.0), 25e-3
TEETH = 23, 41
STIFFNESS = 4e8
FULL = np.array(
    [
        [2.0e8, 3.0e7, 1.0e7, 2.0e5, -8.0e5],
        [3.0e7, 1.6e8, -2.0e7, 6.0e5, 1.0e5],
        [1.0e7, -2.0e7, 9.0e7, 1.0e5, -2.0e5],
        [2.0e5, 6.0e5, 1.0e5, 4.0e4, 2.0e3],
        [-8.0e5, 1.0e5, -2.0e5, 2.0e3, 5.0e4],
    ]
)
"""Stiffness of a bearing with all cross terms, positive definite."""


def toothed(name: str, teeth: int, hand: float = 0.0, width: float = WIDTH, **more: Any) -> Gear:
    """Gear of these tests; `hand` is 1 for a right-hand helix, -1 for a left-hand one, 0 for none."""
    return Gear(name, teeth, MODULE, PRESSURE, width, helix_angle=hand * HELIX, **more)


def distance(first: int, second: int, hand: float) -> float:
    """Centre distance of two gears of these numbers of teeth [m]."""
    return 0.5 * MODULE * (first + second) / math.cos(hand * HELIX)


def one_stage(hand: float = 1.0, stiffness: npt.ArrayLike = FULL, **changes: Any) -> Machine:
    """Two shafts in steps with a gear pair of one mesh spring, on bearings of this stiffness, each 20 % stiffer."""
    apart = distance(*TEETH, hand)
    shafts = [
        Shaft(Rotor("in", [Segment(0.06, 0.03, 0.0, STEEL), Segment(0.12, 0.04, 0.0, STEEL)]), start=-0.08),
        Shaft(
            Rotor("out", [Segment(0.05, 0.035, 0.0, STEEL), Segment(0.11, 0.05, 0.0, STEEL)]),
            (apart * math.cos(0.4), apart * math.sin(0.4)),
            start=-0.08,
        ),
    ]
    held = [
        MountedBearing(linear_bearing(f"{shaft} {at}", at, (1 + 0.2 * number) * np.asarray(stiffness)), shaft, None)
        for number, (shaft, at) in enumerate([("in", 0.016), ("in", 0.164), ("out", 0.01), ("out", 0.154)])
    ]
    parts: dict[str, Any] = {
        "shafts": shafts,
        "bearings": held,
        "gears": [
            ShaftGear(toothed("pinion", TEETH[0], hand), "in", 0.07),
            ShaftGear(toothed("wheel", TEETH[1], -hand), "out", 0.07),
        ],
        "gear_pairs": [GearPair("pinion", "wheel", ConstantStiffness(STIFFNESS), backlash=1e-4)],
        "speed": 300.0,
        "torque": 150.0,
    }
    return Machine(**parts | changes)


def linear_bearing(name: str, at: float, stiffness: npt.ArrayLike, **more: Any) -> Bearing:
    """Bearing of a stiffness (2, 2) or (5, 5) without damping."""
    matrix = np.asarray(stiffness)
    return Bearing(name, at, matrix, np.zeros(matrix.shape), **more)


def element(part: Segment, diameter: float, twisted: float, length: float) -> FloatArray:
    """Stiffness (12, 12) of a round uniform element over x, y, z, and the rotations about them, of both ends.

    It twists as if it had a diameter of its own.
    """
    inner, E, G = part.inner_diameter, part.material.youngs_modulus, part.material.shear_modulus
    area, second = math.pi / 4 * (diameter**2 - inner**2), math.pi / 64 * (diameter**4 - inner**4)
    nu = E / (2 * G) - 1
    assert inner == 0.0
    kappa = 6 * (1 + nu) / (7 + 6 * nu)  # Cowper, solid
    phi = 12 * E * second / (kappa * G * area * length**2)
    found = np.zeros((12, 12))
    for at, stiffness in ((2, E * area / length), (5, G * math.pi / 32 * twisted**4 / length)):
        found[np.ix_([at, at + 6], [at, at + 6])] = stiffness * np.array([[1, -1], [-1, 1]])
    c = E * second / ((1 + phi) * length**3)
    near, far, arm = (4 + phi) * length**2, (2 - phi) * length**2, 6 * length
    bent = c * np.array([[12, arm, -12, arm], [arm, near, -arm, far], [-12, -arm, 12, -arm], [arm, far, -arm, near]])
    # The slope of x is the rotation about y, that of y minus the rotation about x.
    for at, sign in (([0, 4, 6, 10], 1.0), ([1, 3, 7, 9], -1.0)):
        turn = np.array([1.0, sign, 1.0, sign])
        found[np.ix_(at, at)] += bent * np.outer(turn, turn)
    return found


def weight(part: Segment, length: float) -> FloatArray:
    """Consistent loads (12, 3) of an element's weight per acceleration: q h / 2 and q h² / 12."""
    force = part.material.density * math.pi / 4 * part.outer_diameter**2 * length
    found = np.zeros((12, 3))
    for at, side in ((0, 1.0), (6, -1.0)):
        found[at : at + 3] = 0.5 * force * np.eye(3)
        found[at + 4, 0], found[at + 3, 1] = side * force * length / 12, -side * force * length / 12
    return found


class OwnStatics:
    """Coordinates: six of each node of each shaft, five of each seat, two of each pedestal.

    Parameters
    ----------
    machine
        Its description; shafts of solid uniform segments without discs.
    compliance
        Of the housing at the bearings (5 b, 5 b), bearings in the order of ``seated``.
    seated
        Names of the bearings in seats.
    """

    def __init__(self, machine: Machine, *, compliance: FloatArray | None = None, seated: Sequence[str] = ()) -> None:
        self.machine = machine
        self.gears = {one.name: one for one in machine.gears}
        self.seated = list(seated)
        self.nodes = {shaft.name: self._nodes(shaft.name) for shaft in machine.shafts}
        self.first, size = {}, 0
        for name, nodes in self.nodes.items():
            self.first[name], size = size, size + 6 * nodes.size
        self.seat_first = size
        size += 5 * len(self.seated)
        self.feet = [one.bearing.name for one in machine.bearings if one.bearing.pedestal is not None]
        self.foot_first = size
        self.size = size + 2 * len(self.feet)
        self.linear = np.zeros((self.size, self.size))
        for shaft in machine.shafts:
            for at, part, diameters, length in self._elements(shaft.name):
                here = slice(self.first[shaft.name] + 6 * at, self.first[shaft.name] + 6 * at + 12)
                self.linear[here, here] += element(part, *diameters, length)
        if compliance is not None:
            here = slice(self.seat_first, self.seat_first + 5 * len(self.seated))
            self.linear[here, here] = np.linalg.inv(compliance)
        for number, name in enumerate(self.feet):
            pedestal = self.mounted(name).bearing.pedestal
            assert pedestal is not None
            here = slice(self.foot_first + 2 * number, self.foot_first + 2 * number + 2)
            self.linear[here, here] = pedestal.stiffness

    def mounted(self, name: str) -> MountedBearing:
        return next(one for one in self.machine.bearings if one.bearing.name == name)

    def width(self, pair: GearPair) -> float:
        return min(self.gears[pair.driver].gear.face_width, self.gears[pair.driven].gear.face_width)

    def stations(self, pair: GearPair) -> FloatArray:
        return 0.5 * self.width(pair) * np.cos(np.pi * np.arange(STATIONS)[::-1] / (STATIONS - 1))

    def bodies(self, shaft: str) -> list[tuple[float, float, float, float]]:
        """Ends of the gears' bodies and of their teeth on a shaft, and diameters in bending and torsion, or zeros.

        At each end of the face b the shaft of diameter d stays bare until its stress has spread into the root circle D:
        α g d (1 − exp(−b / 2 α g d)), g = 1 − (d/D)³.
        """
        found = []
        for one in self.machine.gears:
            if one.shaft == shaft:
                teeth = toothed_section(one.gear)
                for spread, toothed, motion in (
                    (0.243, teeth.bending_diameter, np.array([1.0, 0.0])),
                    (0.158, teeth.torsion_diameter, np.array([0.0, 1.0])),
                ):
                    left, right = self._core(one, spread)
                    for shorter, outer in ((0.0, self._root(one.gear)), (teeth.end_length, toothed)):
                        low, high = left + shorter, right - shorter
                        if low < high:
                            found.append((low, high, *(outer * motion).tolist()))
        return found

    @staticmethod
    def _root(gear: Gear) -> float:
        return gear.module * gear.teeth / math.cos(gear.helix_angle) - 2.5 * gear.module

    def _core(self, one: ShaftGear, spread: float) -> tuple[float, float]:
        ends = []
        for side in (-1.0, 1.0):
            end = one.at + side * 0.5 * one.gear.face_width
            d = self._part(one.shaft, end - side * 1e-9).outer_diameter
            reach = spread * d * (1.0 - (d / self._root(one.gear)) ** 3)
            bare = reach * (1.0 - math.exp(-0.5 * one.gear.face_width / reach)) if reach > 0.0 else 0.0
            ends.append(end - side * bare)
        return ends[0], ends[1]

    def carriers(self, one: ShaftGear, pair: GearPair) -> FloatArray:
        """Sections that carry the stations: the body is rigid beyond the length that bends with it."""
        return np.clip(one.at + self.stations(pair), *self._core(one, 0.243))

    def _blank(self, one: ShaftGear) -> tuple[float, float]:
        """Mass of a gear made from its shaft, out to the reference circle, and the place of its centre [kg, m]."""
        low, high = one.at - 0.5 * one.gear.face_width, one.at + 0.5 * one.gear.face_width
        ends = np.cumsum([0.0, *(part.length for part in self.machine.shaft(one.shaft).rotor.segments)])
        cuts = np.unique([low, *ends[(ends > low) & (ends < high)], high])
        middles = 0.5 * (cuts[1:] + cuts[:-1])
        shaft = np.array([self._part(one.shaft, at).outer_diameter for at in middles])
        reference = one.gear.module * one.gear.teeth / math.cos(one.gear.helix_angle)
        masses = one.gear.density * math.pi / 4 * (reference**2 - shaft**2) * np.diff(cuts)
        return float(masses.sum()), float(masses @ middles / masses.sum())

    def _part(self, shaft: str, at: float) -> Segment:
        rotor = self.machine.shaft(shaft).rotor
        part = rotor.segments[int(np.searchsorted(np.cumsum([one.length for one in rotor.segments]), at))]
        assert isinstance(part, Segment)
        return part

    def _nodes(self, shaft: str) -> FloatArray:
        rotor = self.machine.shaft(shaft).rotor
        places = [0.0, *np.cumsum([part.length for part in rotor.segments])]
        places += [one.bearing.at for one in self.machine.bearings if one.rotor == shaft]
        places += [torque.at for torque in self.machine.constant_torques if torque.rotor == shaft]
        places += [one.at for one in self.machine.forces if one.rotor == shaft]
        places += [self._blank(one)[1] for one in self.machine.gears if one.shaft == shaft]
        places += [end for low, high, *_ in self.bodies(shaft) for end in (low, high)]
        for pair in self.machine.gear_pairs:
            for name in (pair.driver, pair.driven):
                if self.gears[name].shaft == shaft:
                    places += [self.gears[name].at, *self.carriers(self.gears[name], pair)]
        return np.unique(np.round(places, 12))

    def _elements(self, shaft: str) -> list[tuple[int, Segment, tuple[float, float], float]]:
        nodes, found = self.nodes[shaft], []
        for at, (left, right) in enumerate(pairwise(nodes)):
            middle = 0.5 * (left + right)
            part = self._part(shaft, middle)
            thick = [diameters for low, high, *diameters in self.bodies(shaft) if low < middle < high]
            bending, torsion = (max([part.outer_diameter, *(one[n] for one in thick)]) for n in (0, 1))
            found.append((at, part, (bending, torsion), float(right - left)))
        return found

    def section(self, shaft: str, at: float) -> FloatArray:
        """Motion of a node by all coordinates, (6, n)."""
        found = np.zeros((6, self.size))
        node = int(np.argmin(np.abs(self.nodes[shaft] - at)))
        assert abs(self.nodes[shaft][node] - at) < 1e-10
        found[:, self.first[shaft] + 6 * node : self.first[shaft] + 6 * node + 6] = np.eye(6)
        return found

    def seat(self, name: str) -> FloatArray:
        """Motion of a bearing's seat by all coordinates, (5, n)."""
        found = np.zeros((5, self.size))
        if name in self.seated:
            first = self.seat_first + 5 * self.seated.index(name)
            found[:, first : first + 5] = np.eye(5)
        if name in self.feet:
            first = self.foot_first + 2 * self.feet.index(name)
            found[:2, first : first + 2] = np.eye(2)
        return found

    def bearing(self, name: str) -> FloatArray:
        """Deflection of a bearing by all coordinates, (5, n)."""
        one = self.mounted(name)
        return self.section(one.rotor, one.bearing.at)[:5] - self.seat(name)

    def loads(self, gravity: Sequence[float] | None = None, sag: FloatArray | None = None) -> FloatArray:
        """Torques and forces, weight of the shafts, and what lets the seats sag by (5 b,) under the housing's own."""
        found = np.zeros(self.size)
        if sag is not None:
            here = slice(self.seat_first, self.seat_first + sag.size)
            found[here] = self.linear[here, here] @ sag
        for torque in self.machine.constant_torques:
            found += torque.value * self.section(torque.rotor, torque.at)[5]
        for one in self.machine.forces:
            found += np.array(one.force) @ self.section(one.rotor, one.at)[:3]
        if gravity is not None:
            for shaft in self.machine.shafts:
                for at, part, _, length in self._elements(shaft.name):
                    first = self.first[shaft.name] + 6 * at
                    found[first : first + 12] += weight(part, length) @ np.array(gravity)
                for gear in self.machine.gears:
                    if gear.shaft == shaft.name:
                        mass, centre = self._blank(gear)
                        found += mass * np.array(gravity) @ self.section(shaft.name, centre)[:3]
        return found

    def plane(self, pair: GearPair) -> tuple[FloatArray, float, int, FloatArray]:
        """Direction in which the driver pushes, axial part of the force, sense of the closing turn, centre line."""
        driver, driven = self.gears[pair.driver], self.gears[pair.driven]
        a, b = (np.array(self.machine.shaft(one.shaft).axis) for one in (driver, driven))
        line = (b - a) / np.linalg.norm(b - a)
        number = list(self.machine.gear_pairs).index(pair)
        torque = self.machine.pair_torques[number]
        sense = int(np.sign(self.machine.speeds[driver.shaft]) or 1) * (1 if torque >= 0 else -1)
        transverse = math.atan(math.tan(driver.gear.pressure_angle) / math.cos(driver.gear.helix_angle))
        bases = sum(self.base_radius(one.gear) for one in (driver, driven))
        working = math.acos(bases / float(np.linalg.norm(b - a)))
        assert abs(working - transverse) < 0.1
        # Towards the driven gear, turned from the centre line by a right angle less the pressure angle.
        turn = sense * (math.pi / 2 - working)
        push = np.array(
            [line[0] * math.cos(turn) - line[1] * math.sin(turn), line[0] * math.sin(turn) + line[1] * math.cos(turn)]
        )
        base_helix = math.asin(math.sin(driver.gear.helix_angle) * math.cos(driver.gear.pressure_angle))
        # A right-hand driver that turns counter-clockwise seen from +z pushes the driven gear along -z.
        return push, -sense * math.tan(base_helix), sense, line

    @staticmethod
    def base_radius(gear: Gear) -> float:
        transverse = math.atan(math.tan(gear.pressure_angle) / math.cos(gear.helix_angle))
        return 0.5 * gear.module * gear.teeth / math.cos(gear.helix_angle) * math.cos(transverse)

    def approach(self, pair: GearPair, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Approach at places z over the face (s,) by the polynomial through the stations, (s, n); and the tilt, (n,).

        The flanks' common normal is (push, axial): the approach is that of points of both gears along it.
        """
        push, h, sense, line = self.plane(pair)
        stations = self.stations(pair)
        at_stations, tilt = np.zeros((stations.size, self.size)), np.zeros(self.size)
        bases = {name: self.base_radius(self.gears[name].gear) for name in (pair.driver, pair.driven)}
        shafts = [self.machine.shaft(self.gears[name].shaft) for name in bases]
        distance = math.dist(shafts[0].axis, shafts[1].axis)
        for name, side in ((pair.driver, 1.0), (pair.driven, -1.0)):
            gear = self.gears[name]
            pitch = distance * bases[name] / sum(bases.values())
            to_pitch_point = side * pitch * line
            middle = self.section(gear.shaft, gear.at)
            along = middle[2] + to_pitch_point[1] * middle[3] - to_pitch_point[0] * middle[4]
            tilt += side * (push[0] * middle[4] - push[1] * middle[3])
            for row, place, carrier in zip(at_stations, stations, self.carriers(gear, pair), strict=True):
                here = self.section(gear.shaft, carrier)
                arm = gear.at + place - carrier
                moved = here[:2] + arm * np.array([here[4], -here[3]])
                row += side * (push @ moved + h * along) + sense * bases[name] * here[5]
        powers = np.vander(stations / stations[-1], increasing=True)
        over = np.vander(z / stations[-1], stations.size, increasing=True) @ np.linalg.inv(powers)
        return over @ at_stations, tilt

    def mesh(self, pair: GearPair, stiffness: float) -> FloatArray:
        """Energy's matrix (n, n) of a spring spread over the face: k times the mean of a² over the slices.

        The approach of a slice is a = delta + g - h xi tilt, xi the place of the spring on the path.
        """
        width = self.width(pair)
        z = width * ((np.arange(SLICES) + 0.5) / SLICES - 0.5)
        over, tilt = self.approach(pair, z)
        rows = over - self.plane(pair)[1] * self.middle_of_path(pair) * tilt
        return stiffness * rows.T @ rows / SLICES

    def middle_of_path(self, pair: GearPair) -> float:
        """Place of the middle of the path of contact from the pitch point [m], where the spring of a mesh stands."""
        driver, driven = self.gears[pair.driver].gear, self.gears[pair.driven].gear
        transverse = math.atan(math.tan(driver.pressure_angle) / math.cos(driver.helix_angle))
        bases = [self.base_radius(one) for one in (driver, driven)]
        shafts = [self.machine.shaft(self.gears[name].shaft) for name in (pair.driver, pair.driven)]
        distance = math.dist(shafts[0].axis, shafts[1].axis)
        working = math.acos(sum(bases) / distance)
        assert math.isclose(working, transverse, rel_tol=1e-6), "teeth without shift, at the standard distance"
        tips = [0.5 * one.module * one.teeth / math.cos(one.helix_angle) + one.module for one in (driver, driven)]
        # From the pitch point: approach up to the driven gear's tip, recess up to the driver's.
        recess = math.sqrt(tips[0] ** 2 - bases[0] ** 2) - bases[0] * math.tan(working)
        approach = math.sqrt(tips[1] ** 2 - bases[1] ** 2) - bases[1] * math.tan(working)
        return 0.5 * (recess - approach)

    def springs(self) -> FloatArray:
        """Stiffness (n, n) of the linear bearings and of gear pairs with a constant stiffness."""
        found = np.zeros((self.size, self.size))
        for one in self.machine.bearings:
            rows = self.bearing(one.bearing.name)
            found += rows.T @ one.bearing.spatial_stiffness @ rows
        for pair in self.machine.gear_pairs:
            assert isinstance(pair.stiffness, ConstantStiffness)
            found += self.mesh(pair, pair.stiffness.value)
        return found

    def solve(self, loads: FloatArray) -> FloatArray:
        """Motions under loads with all springs, of least norm along motions that nothing holds."""
        whole = self.linear + self.springs()
        scale = 1.0 / np.sqrt(np.diag(whole))
        answer = np.linalg.lstsq(scale[:, None] * whole * scale, scale * loads, rcond=1e-13)[0]
        return scale * answer
