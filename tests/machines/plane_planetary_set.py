"""Planetary sets of rigid bodies that move in a plane, with constant mesh stiffness, and independent equations of them.

The numbers are those of Lin & Parker, J. Vib. Acoust. 121, 316 (1999), Table 1: an OH-58 helicopter's set.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearwhine.coupling.description.gear_train import Output
from gearwhine.coupling.description.parts import Shaft, ShaftGear, TorqueSupport
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.gears.stiffness.models import ConstantStiffness
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial

MASS = {"carrier": 5.43, "ring": 2.35, "sun": 0.4, "planet": 0.66}  # kg
INERTIA = {"carrier": 6.29, "ring": 3.00, "sun": 0.39, "planet": 0.61}  # I / r², r the base radius or the distance, kg
STEEL = ShaftMaterial(youngs_modulus=210e9, shear_modulus=81e9, density=7850.0)
MESH_STIFFNESS, BEARING_STIFFNESS, RING_SUPPORT = 5e8, 1e8, 1e9  # N/m
TEETH = (24, 30)
"""Teeth of sun and planets."""
MODULE = 2.5e-3

# So stiff and light that the shafts are rigid bodies without mass of their own; time integration needs real ones.
RIGID = ShaftMaterial(youngs_modulus=2e16, shear_modulus=8e15, density=1e-3)
_LENGTH, _MIDDLE = 0.1, 0.05


def equal_angles(count: int) -> FloatArray:
    return 2.0 * np.pi * np.arange(count) / count


def plane_set(
    angles: Sequence[float] | FloatArray,
    *,
    pressure_angle: float,
    with_ring: bool,
    damping: float = 0.0,
    material: ShaftMaterial = RIGID,
    diameter: float = 0.03,
    teeth: tuple[int, int] = TEETH,
    mode_count: int | None = None,
) -> dict[str, Any]:
    """Parts of a machine: sun, carrier, planets at the angles and perhaps the ring; without it the carrier is held.

    ``damping`` is that of bearings and meshes over their stiffness [s]; ``mode_count`` that of each shaft.
    """
    numbers_of_teeth = {"sun": teeth[0], "planet": teeth[1], "ring": teeth[0] + 2 * teeth[1]}
    radius = {name: 0.5 * MODULE * z * math.cos(pressure_angle) for name, z in numbers_of_teeth.items()}
    distance = radius["carrier"] = 0.5 * MODULE * sum(teeth)
    shafts, bearings, gears = list[Shaft](), list[MountedBearing](), list[ShaftGear]()

    def body(kind: str, name: str, **where: Any) -> None:
        disc = Disc(_MIDDLE, MASS[kind], *[INERTIA[kind] * radius[kind] ** 2] * 2)
        rotor = Rotor(name, [Segment(_LENGTH, diameter, 0.0, material)], [disc])
        shafts.append(Shaft(rotor, damping_ratio=0.0, mode_count=mode_count, **where))
        law = 0.5 * np.diag([BEARING_STIFFNESS, BEARING_STIFFNESS, 0.0, 2e3, 2e3])
        for end, at in (("left", 0.0), ("right", _LENGTH)):
            bearings.append(MountedBearing(Bearing(f"{name} {end}", at, law, damping * law), name, None))

    def gear(name: str, shaft: str, z: int, addendum: float = 1.0) -> None:
        wheel = Gear(name, z, MODULE, pressure_angle, 0.02, addendum=addendum)
        gears.append(ShaftGear(wheel, shaft, _MIDDLE, inertia=(0.0, 0.0, 0.0), stiffens_shaft=False))

    def pair(driver: str, driven: str) -> GearPair:
        spring = ConstantStiffness(MESH_STIFFNESS)
        return GearPair(driver, driven, stiffness=spring, misalignment=0.0, damping=damping * MESH_STIFFNESS)

    body("sun", "sun")
    gear("sun gear", "sun", teeth[0])
    body("carrier", "carrier")
    numbers = range(1, len(angles) + 1)
    for number, angle in zip(numbers, angles, strict=True):
        axis = (distance * math.cos(angle), distance * math.sin(angle))
        body("planet", f"planet {number}", axis=axis, carrier="carrier")
        gear(f"planet gear {number}", f"planet {number}", teeth[1])
    pairs = [pair("sun gear", f"planet gear {number}") for number in numbers]
    held = "carrier"
    if with_ring:
        body("ring", "ring")
        # Full-depth teeth of the ring would reach below the planets' involutes.
        gear("ring gear", "ring", -numbers_of_teeth["ring"], addendum=0.8)
        pairs += [pair(f"planet gear {number}", "ring gear") for number in numbers]
        held = "ring"
    support = TorqueSupport(held, _MIDDLE, stiffness=RING_SUPPORT * radius[held] ** 2)
    return {
        "shafts": shafts,
        "bearings": bearings,
        "gears": gears,
        "gear_pairs": pairs,
        "torque_supports": [support],
        "outputs": [Output("carrier")] if with_ring else [],
    }


def independent_matrices(
    angles: Sequence[float] | FloatArray, *, pressure_angle: float, with_ring: bool, carrier_speed: float = 0.0
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, Coriolis and stiffness matrices in the carrier's frame, written out anew: x, y and u = r θ of each body.

    Bodies are carrier, sun, perhaps ring, planets. By T = Σ m/2 |v + Ω × r|²; the centrifugal force of a planet stays
    radial as the carrier turns.
    """
    names = ["carrier", "sun", *(["ring"] if with_ring else [])]
    first = {name: 3 * place for place, name in enumerate(names)}
    size = 3 * (len(names) + len(angles))
    mass, coriolis, stiffness = (np.zeros((size, size)) for _ in range(3))
    bodies = [*names, *["planet"] * len(angles)]
    for place, name in enumerate(bodies):
        x, y, u = range(3 * place, 3 * place + 3)
        mass[x, x] = mass[y, y] = MASS[name]
        mass[u, u] = INERTIA[name]
        coriolis[x, y], coriolis[y, x] = -2.0 * carrier_speed * MASS[name], 2.0 * carrier_speed * MASS[name]
        stiffness[x, x] = stiffness[y, y] = -(carrier_speed**2) * MASS[name]
        if name != "planet":
            stiffness[x, x] += BEARING_STIFFNESS
            stiffness[y, y] += BEARING_STIFFNESS
    held = first["ring" if with_ring else "carrier"] + 2
    stiffness[held, held] += RING_SUPPORT

    def spring(value: float, **parts: tuple[float, float, float]) -> None:
        row = np.zeros(size)
        for name, coefficients in parts.items():
            row[first[name] : first[name] + 3] = coefficients
        stiffness[:] += value * np.outer(row, row)

    for number, angle in enumerate(angles):
        first["planet"] = 3 * (len(names) + number)
        outward, along = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
        spring(BEARING_STIFFNESS, planet=(1.0, 0.0, 0.0), carrier=(-1.0, 0.0, -along[0]))
        spring(BEARING_STIFFNESS, planet=(0.0, 1.0, 0.0), carrier=(0.0, -1.0, -along[1]))
        sine, cosine = math.sin(pressure_angle), math.cos(pressure_angle)
        # The sun turns counter-clockwise and pushes the planet along the circle and outward; the planet pushes the ring
        # against the circle and outward.
        x, y = (cosine * a + sine * o for a, o in zip(along, outward, strict=True))
        spring(MESH_STIFFNESS, sun=(x, y, 1.0), planet=(-x, -y, 1.0))
        if with_ring:
            x, y = (-cosine * a + sine * o for a, o in zip(along, outward, strict=True))
            spring(MESH_STIFFNESS, planet=(x, y, -1.0), ring=(-x, -y, 1.0))
        # The centrifugal force N on a pin follows the carrier: its energy is N (θ u - a θ² / 2), here with a θ.
        force = MASS["planet"] * carrier_speed**2
        stiffness[2, 2] -= force
        for axis, part in enumerate(along):
            stiffness[first["planet"] + axis, 2] += force * part
            stiffness[2, first["planet"] + axis] += force * part
            stiffness[axis, 2] -= force * part
            stiffness[2, axis] -= force * part
    return mass, coriolis, stiffness


def eigenvalues(mass: FloatArray, damping: FloatArray, stiffness: FloatArray) -> ComplexArray:
    """Eigenvalues λ of λ² M + λ C + K = 0."""
    n = len(mass)
    first = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, np.hstack([stiffness, damping]))]])
    return np.asarray(np.linalg.eigvals(first))
