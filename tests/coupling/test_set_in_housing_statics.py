"""Equilibrium of a planetary set whose members sit in an elastic housing, against an independent model of rigid bodies.

The housing is a Craig-Bampton reduction: the motions of its seats and the deformation of the ring's bore are its
boundary coordinates, with a few modes behind them. The machine takes it by its natural modes; the independent model has
the boundary stiffness alone, which is exact in statics.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from plane_planetary_set import (
    BEARING_STIFFNESS,
    MASS,
    MESH_STIFFNESS,
    MODULE,
    RIGID,
    RING_SUPPORT,
    TEETH,
    equal_angles,
    plane_set,
)

from gearwhine.coupling import Machine
from gearwhine.coupling.description.planetary import PlanetarySet
from gearwhine.coupling.load_analysis.planetary_load import planetary_load
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.numerics.arrays import FloatArray

SEATS = {"sun": 0.02, "carrier": 0.06, "ring": 0.05}
"""z of the centre of the seat of each member [m]."""
ORDERS = (2, 3)
BORE_FIRST = 6 * len(SEATS)
BOUNDARY = BORE_FIRST + 4 * len(ORDERS)
INNER = 5
LENGTH, MIDDLE, WIDTH = 0.1, 0.05, 0.02
PRESSURE_ANGLE = math.radians(20.0)
COUNT, SPEED, TORQUE = 3, 300.0, 400.0
ERROR = (5e-6, 20e-6)  # m, radial and tangential, of the first pin
RING_TEETH = TEETH[0] + 2 * TEETH[1]
DISTANCE = 0.5 * MODULE * sum(TEETH)


@cache
def craig_bampton() -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass (n, n): seats along and about x, y, z, a, b, c, d of each order of the bore, then modes."""
    rng = np.random.default_rng(5)
    scale = np.sqrt(np.r_[np.tile([2e8] * 3 + [4e5] * 3, len(SEATS)), np.full(4 * len(ORDERS), 3e9)])
    mixed = rng.normal(size=(BOUNDARY, BOUNDARY))
    stiffness = np.zeros((BOUNDARY + INNER,) * 2)
    stiffness[:BOUNDARY, :BOUNDARY] = scale[:, None] * (np.eye(BOUNDARY) + mixed @ mixed.T / BOUNDARY) * scale
    stiffness[BOUNDARY:, BOUNDARY:] = np.diag((2.0 * np.pi * np.linspace(900.0, 4000.0, INNER)) ** 2)
    mass = np.diag(np.r_[np.tile([9.0] * 3 + [0.05] * 3, len(SEATS)), np.full(4 * len(ORDERS), 6.0), np.ones(INNER)])
    mass[:BOUNDARY, BOUNDARY:] = (
        0.2 * np.sqrt(np.diag(mass)[:BOUNDARY, None]) * rng.uniform(-0.4, 0.4, (BOUNDARY, INNER))
    )
    mass[BOUNDARY:, :BOUNDARY] = mass[:BOUNDARY, BOUNDARY:].T
    return stiffness, mass


def housing() -> HousingComponent:
    """The reduced housing by all its natural modes."""
    stiffness, mass = craig_bampton()
    lower = np.linalg.cholesky(mass)
    inverse = np.linalg.inv(lower)
    squares, vectors = np.linalg.eigh(inverse @ stiffness @ inverse.T)
    shapes = (inverse.T @ vectors).T
    n = len(squares)
    ring = np.zeros((n, 2 + 4 * max(ORDERS)))
    for place, order in enumerate(ORDERS):
        first = BORE_FIRST + 4 * place
        ring[:, 4 * order - 2 : 4 * order + 2] = shapes[:, first : first + 4]
    return HousingComponent(
        "housing",
        ("housing",) * n,
        np.diag(squares),
        np.zeros((n, n)),
        np.zeros((n, n)),
        seats={f"{name} seat": shapes[:, 6 * place : 6 * place + 6] for place, name in enumerate(SEATS)},
        seat_z={f"{name} seat": z for name, z in SEATS.items()},
        sensors={},
        ring_motions={"ring seat": ring},
    )


@cache
def machine(follows_bore: bool) -> Machine:
    parts = plane_set(equal_angles(COUNT), pressure_angle=PRESSURE_ANGLE, with_ring=True, material=RIGID, diameter=0.05)
    (support,) = parts["torque_supports"]
    shafts = [
        replace(
            one,
            pin_error=ERROR if one.name == "planet 1" else (0.0, 0.0),
            rim_seat="ring seat" if follows_bore and one.name == "ring" else None,
        )
        for one in parts["shafts"]
    ]
    seated = [replace(one, seat=f"{one.rotor} seat") if one.rotor in SEATS else one for one in parts["bearings"]]
    names = tuple(f"planet gear {number}" for number in range(1, COUNT + 1))
    return Machine(
        **parts
        | {
            "shafts": shafts,
            "bearings": seated,
            "torque_supports": [replace(support, seat="ring seat")],
            "planetary_sets": [PlanetarySet("stage", names, "carrier", sun="sun gear", ring="ring gear")],
            "housing": housing(),
            "speed": SPEED,
            "torque": TORQUE,
        }
    )


class RigidBodies:
    """Rigid bodies with six coordinates each, along and about x, y, z at z = 0, and the boundary of the housing."""

    def __init__(self, follows_bore: bool) -> None:
        self.follows_bore = follows_bore
        self.names = ["sun", "carrier", "ring", *(f"planet {number}" for number in range(1, COUNT + 1))]
        self.first = 6 * len(self.names)
        self.size = self.first + BOUNDARY
        self.axes = dict.fromkeys(self.names, (0.0, 0.0))
        for number, angle in enumerate(equal_angles(COUNT), start=1):
            self.axes[f"planet {number}"] = (DISTANCE * math.cos(angle), DISTANCE * math.sin(angle))
        self.stiffness = np.zeros((self.size, self.size))
        self.stiffness[self.first :, self.first :] = craig_bampton()[0][:BOUNDARY, :BOUNDARY]
        self.load = np.zeros(self.size)
        self.bearings: dict[str, tuple[FloatArray, FloatArray]] = {}
        self.meshes: dict[str, FloatArray] = {}
        self._bearings()
        self._meshes()
        turned = self.at("ring", (0.0, 0.0, MIDDLE))[5] - self.seat("ring", (0.0, 0.0, MIDDLE))[5]
        radius = 0.5 * MODULE * RING_TEETH * math.cos(PRESSURE_ANGLE)
        self.stiffness += RING_SUPPORT * radius**2 * np.outer(turned, turned)
        # The sun drives, the carrier is driven, the ring is held.
        self.load += TORQUE * self.at("sun", (0.0, 0.0, 0.0))[5]
        self.load -= TORQUE * (1.0 + RING_TEETH / TEETH[0]) * self.at("carrier", (0.0, 0.0, 0.0))[5]
        self.motion = np.linalg.lstsq(self.stiffness, self.load, rcond=1e-11)[0]

    def _moved(self, rows: FloatArray, arm: FloatArray) -> FloatArray:
        """Motion (6, n) of a place at an arm from where a body moves by rows: v + w x r."""
        moved = rows.copy()
        moved[:3] += np.cross(rows[3:].T, arm).T
        return moved

    def at(self, name: str, place: tuple[float, float, float]) -> FloatArray:
        rows = np.zeros((6, self.size))
        rows[:, 6 * self.names.index(name) : 6 * self.names.index(name) + 6] = np.eye(6)
        return self._moved(rows, np.subtract(place, (*self.axes[name], 0.0)))

    def seat(self, name: str, place: tuple[float, float, float]) -> FloatArray:
        rows = np.zeros((6, self.size))
        first = self.first + 6 * list(SEATS).index(name)
        rows[:, first : first + 6] = np.eye(6)
        return self._moved(rows, np.subtract(place, (0.0, 0.0, SEATS[name])))

    def _bearings(self) -> None:
        law = 0.5 * np.diag([BEARING_STIFFNESS, BEARING_STIFFNESS, 0.0, 2e3, 2e3])
        carrier_speed = SPEED / (1.0 + RING_TEETH / TEETH[0])
        for name in self.names:
            x, y = self.axes[name]
            offset = np.zeros(5)
            if name == "planet 1":
                offset[:2] = ERROR
            for end, z in (("left", 0.0), ("right", LENGTH)):
                around = self.seat(name, (x, y, z)) if name in SEATS else self.at("carrier", (x, y, z))
                rows = (self.at(name, (x, y, z)) - around)[:5]
                self.bearings[f"{name} {end}"] = rows, offset
                self.stiffness += rows.T @ law @ rows
                self.load += rows.T @ law @ offset
            if name not in SEATS:
                middle = self.at(name, (x, y, MIDDLE))
                self.load += MASS["planet"] * carrier_speed**2 * (x * middle[0] + y * middle[1])
        self.law = law

    def _meshes(self) -> None:
        """Springs over the face of each mesh, by its compression in the middle and its slope."""
        sine, cosine = math.sin(PRESSURE_ANGLE), math.cos(PRESSURE_ANGLE)
        base = {
            name: 0.5 * MODULE * teeth * cosine
            for name, teeth in (("sun", TEETH[0]), ("planet", TEETH[1]), ("ring", RING_TEETH))
        }
        for number, angle in enumerate(equal_angles(COUNT), start=1):
            planet = f"planet {number}"
            outward, along = (
                np.array([math.cos(angle), math.sin(angle)]),
                np.array([-math.sin(angle), math.cos(angle)]),
            )
            centres = {name: self.at(name, (*self.axes[name], MIDDLE)) for name in ("sun", "ring", planet)}
            push = cosine * along + sine * outward
            one, other = centres["sun"], centres[planet]
            middle = push @ (one - other)[:2] + base["sun"] * one[5] + base["planet"] * other[5]
            self._mesh(f"sun gear -> planet gear {number}", middle, self._slope(push, one - other))
            push = -cosine * along + sine * outward
            one, other = centres[planet], centres["ring"]
            middle = push @ (one - other)[:2] - base["planet"] * one[5] + base["ring"] * other[5]
            if self.follows_bore:
                for place, order in enumerate(ORDERS):
                    first = self.first + BORE_FIRST + 4 * place
                    c, s = math.cos(order * angle), math.sin(order * angle)
                    middle[first : first + 4] -= np.r_[
                        push @ outward * np.array([c, s]), push @ along * np.array([c, s])
                    ]
            self._mesh(f"planet gear {number} -> ring gear", middle, self._slope(push, one - other))

    @staticmethod
    def _slope(push: FloatArray, apart: FloatArray) -> FloatArray:
        return np.asarray(push[0] * apart[4] - push[1] * apart[3])

    def _mesh(self, name: str, middle: FloatArray, slope: FloatArray) -> None:
        self.meshes[name] = middle
        self.stiffness += MESH_STIFFNESS * (np.outer(middle, middle) + WIDTH**2 / 12.0 * np.outer(slope, slope))


@pytest.mark.parametrize("follows_bore", [False, True])
def test_loads_and_deflections_are_those_of_rigid_bodies_in_a_reduced_housing(follows_bore: bool) -> None:
    given = machine(follows_bore)
    point, own = given.operating_point(), RigidBodies(follows_bore)
    forces = {name: MESH_STIFFNESS * float(row @ own.motion) for name, row in own.meshes.items()}
    assert max(forces.values()) > 1.05 * min(forces.values())
    for pair in point.pairs:
        name = " -> ".join(pair.names)
        assert pair.force == pytest.approx(forces[name], rel=1e-6)
    largest = max(float(np.abs(load.force).max()) for load in point.bearings)
    for load in point.bearings:
        rows, offset = own.bearings[load.name]
        assert load.force == pytest.approx(own.law @ (rows @ own.motion - offset), abs=1e-5 * largest)
    shares = np.array([forces[f"sun gear -> planet gear {number}"] for number in range(1, COUNT + 1)])
    found = planetary_load(given, given.placed_sets[0], point)
    assert [planet.load_share for planet in found.planets] == pytest.approx(shares / shares.sum(), rel=1e-6)
    assert found.mesh_load_factor == pytest.approx(COUNT * shares.max() / shares.sum(), rel=1e-6)
    part = given.housing_component
    assert part is not None
    assert point.housing is not None
    boundary = own.motion[own.first :]
    for place, name in enumerate(SEATS):
        expected = boundary[6 * place : 6 * place + 6]
        for axes in (slice(0, 3), slice(3, 6)):
            size = np.abs(boundary[:BORE_FIRST].reshape(-1, 6)[:, axes]).max()
            assert point.housing @ part.seats[f"{name} seat"][:, axes] == pytest.approx(expected[axes], abs=2e-5 * size)
    if follows_bore:
        bore = point.housing @ part.ring_motions["ring seat"][:, 6:14]
        assert bore == pytest.approx(boundary[BORE_FIRST:], abs=2e-5 * np.abs(boundary[BORE_FIRST:]).max())
