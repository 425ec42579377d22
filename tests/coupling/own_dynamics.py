"""An independent dynamic model of a gearbox for tests: beams with mass, and springs at every slice of the faces.

The statics are those of :mod:`own_statics` on finer beams. Mass and rotary inertia of the elements are lumped at their
ends; a gear is a disc at its middle. The housing is given by its modes. Nothing of the code under test is used but the
description of the parts.
"""

import math
from itertools import pairwise

import numpy as np
from own_statics import SLICES, OwnStatics

from gearwhine.coupling import Machine
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.numerics.arrays import ComplexArray, FloatArray

ELEMENT = 4e-3  # longest element of a beam [m]


class OwnDynamics(OwnStatics):
    """Coordinates: six of each node of each shaft, then the housing's modes.

    Parameters
    ----------
    machine
        With a housing component, whose seats all bearings are in; gears with inertias of their own.
    phases
        Number of phases of a mesh period, where pairs of teeth are springs on their lines of contact.
    """

    def __init__(self, machine: Machine, phases: int = 1) -> None:
        self.phases = phases
        super().__init__(machine)
        housing = machine.housing
        assert isinstance(housing, HousingComponent)
        self.housing, self.beams = housing, self.size
        self.size += housing.size
        stiffness = np.zeros((self.size, self.size))
        stiffness[: self.beams, : self.beams] = self.linear
        stiffness[self.beams :, self.beams :] = housing.stiffness
        self.linear = stiffness

    def _nodes(self, shaft: str) -> FloatArray:
        coarse = super()._nodes(shaft)
        cuts = [np.linspace(a, b, 1 + math.ceil((b - a) / ELEMENT)) for a, b in pairwise(coarse.tolist())]
        return np.unique(np.round(np.concatenate(cuts), 12))

    def _blank(self, one):  # type: ignore[no-untyped-def]
        return 0.0, one.at

    def seat(self, name: str) -> FloatArray:
        """Motion of a bearing's seat by the housing's modes, (5, n): of its centre, and of a place beside it."""
        found = np.zeros((5, self.size))
        one = self.mounted(name)
        assert one.seat is not None
        along = self.machine.shaft(one.rotor).start + one.bearing.at - self.housing.seat_z[one.seat]
        motion = self.housing.seats[one.seat].T
        found[:, self.beams :] = motion[:5]
        found[0, self.beams :] += along * motion[4]
        found[1, self.beams :] -= along * motion[3]
        return found

    def section(self, shaft: str, at: float) -> FloatArray:
        """Motion of a node, (6, n)."""
        return np.asarray(super().section(shaft, at))

    def mass_and_gyroscopic(self) -> tuple[FloatArray, FloatArray]:
        """Mass, and gyroscopic matrix times the speeds, both (n, n)."""
        mass, gyroscopic = np.zeros((self.size, self.size)), np.zeros((self.size, self.size))
        mass[self.beams :, self.beams :] = np.eye(self.size - self.beams)
        for shaft in self.machine.shafts:
            speed = self.machine.speeds[shaft.name]
            lumps = []
            for at, part, _, length in self._elements(shaft.name):
                area = math.pi / 4 * (part.outer_diameter**2 - part.inner_diameter**2)
                second = math.pi / 64 * (part.outer_diameter**4 - part.inner_diameter**4)
                half = 0.5 * part.material.density * length
                lumps += [(node, half * area, 2 * half * second, half * second) for node in (at, at + 1)]
            for gear in self.machine.gears:
                if gear.shaft == shaft.name:
                    assert gear.inertia is not None
                    node = int(np.argmin(np.abs(self.nodes[shaft.name] - gear.at)))
                    lumps.append((node, *gear.inertia))
            for node, m, polar, diametral in lumps:
                first = self.first[shaft.name] + 6 * node
                mass[range(first, first + 6), range(first, first + 6)] += [m, m, m, diametral, diametral, polar]
                gyroscopic[first + 3, first + 4] += speed * polar
                gyroscopic[first + 4, first + 3] -= speed * polar
        return mass, gyroscopic

    def springs_of(self, pair: GearPair) -> tuple[FloatArray, FloatArray]:
        """Stiffness (n, n) of a pair's springs, and the load on the coordinates for each metre of error of all, (n,).

        Springs of pairs of teeth (`SquareStiffness`) are on the path of contact in part of a mesh period: the mean over
        its phases stands for it.
        """
        width, number = self.width(pair), SLICES if self.phases == 1 else 4 * SLICES
        z = width * ((np.arange(number) + 0.5) / number - 0.5)
        over, tilt = self.approach(pair, z)
        h = self.plane(pair)[1]
        total, push = np.zeros((self.size, self.size)), np.zeros(self.size)
        if self.phases == 1:
            rows = over - h * self.middle_of_path(pair) * tilt
            return pair.stiffness.value * rows.T @ rows / number, pair.stiffness.value * rows.mean(axis=0)
        gear = self.gears[pair.driver].gear
        transverse = math.atan(math.tan(gear.pressure_angle) / math.cos(gear.helix_angle))
        base_pitch = math.pi * gear.module / math.cos(gear.helix_angle) * math.cos(transverse)
        overlap = width * math.sin(abs(gear.helix_angle)) / (math.pi * gear.module)
        # A right-hand driver that turns counter-clockwise leads at the end of larger z: the axial part is below 0.
        shift = -np.sign(h) * overlap * z / width
        start, length = self.path(pair)
        ratio = length / base_pitch
        for phase in (np.arange(self.phases) + 0.5) / self.phases:
            for behind in range(-4, 6):
                at = phase + behind + shift
                there = (at >= 0.0) & (at < ratio)
                rows = over - h * (start + base_pitch * at)[:, None] * tilt
                part = rows[there] * pair.stiffness.value / number / self.phases
                total += part.T @ rows[there]
                push += part.sum(axis=0)
        return total, push

    def path(self, pair: GearPair) -> tuple[float, float]:
        """Start of the path of contact from the pitch point, and its length [m]."""
        driver, driven = self.gears[pair.driver].gear, self.gears[pair.driven].gear
        shafts = [self.machine.shaft(self.gears[name].shaft) for name in (pair.driver, pair.driven)]
        bases = [self.base_radius(one) for one in (driver, driven)]
        working = math.acos(sum(bases) / math.dist(shafts[0].axis, shafts[1].axis))
        tips = [0.5 * one.module * one.teeth / math.cos(one.helix_angle) + one.module for one in (driver, driven)]
        recess, approach = (
            math.sqrt(tip**2 - base**2) - base * math.tan(working) for tip, base in zip(tips, bases, strict=True)
        )
        return -approach, recess + approach

    def error_response(self, frequencies_hz: FloatArray, number: int = 0) -> dict[str, ComplexArray]:
        """Acceleration of each sensor by a unit transmission error of one pair [1/s²]."""
        mass, damping = self.mass_and_gyroscopic()
        damping[self.beams :, self.beams :] += self.housing.damping
        stiffness = self.linear.copy()
        for one in self.machine.bearings:
            rows = self.bearing(one.bearing.name)
            stiffness += rows.T @ one.bearing.spatial_stiffness @ rows
            damping += rows.T @ one.bearing.spatial_damping @ rows
        push = np.zeros(self.size)
        for at, pair in enumerate(self.machine.gear_pairs):
            spring, load = self.springs_of(pair)
            stiffness += spring
            if at == number:
                push = load
        found: dict[str, list[complex]] = {name: [] for name in self.housing.sensors}
        for w in 2.0 * np.pi * frequencies_hz:
            moved = np.linalg.solve(stiffness + 1j * w * damping - w**2 * mass, push)
            for name, row in self.housing.sensors.items():
                found[name].append(-(w**2) * complex(row @ moved[self.beams :]))
        return {name: np.array(values) for name, values in found.items()}
