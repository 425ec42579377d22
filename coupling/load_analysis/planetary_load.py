"""Planetary sets at the operating point: load sharing between planets, loads of pins, and their change over a turn.

Sun, planets and ring of a set carry the torque by several meshes side by side. How much of it each planet carries is
statically indeterminate: it follows from the stiffness of teeth, bearings, shafts and housing, from pins off their
places, and from how freely sun or ring can float. With the torques T_i that the N planets take from the sun (or give to
the ring), the load share is T_i / Σ T, and the mesh load factor K_γ = N max T_i / Σ T (ISO 6336-1; IEC 61400-4).

The carrier takes the planets round. Where something of the machine is not alike all round, such as a housing, weight or
a gear pair beside the set, the sharing changes over a turn. :func:`over_carrier_turn` finds the equilibrium at several
angles of the carrier, each at rest there; inertia beside the planets' centrifugal forces is left out.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.description.planetary import PlacedSet, SetMember
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.progress import Progress, silent

ANGLES = 24
"""Number of angles of the carrier over its turn, by default."""


@dataclass(frozen=True, eq=False)
class PlanetLoad:
    """A planet, or planets in mesh with each other, at the operating point.

    Attributes
    ----------
    shaft : str
        Shaft of the planet, of several the one next to the sun.
    angle : float
        Angle of its place about the carrier's axis from x [rad].
    torque : float
        Torque about the carrier's axis that it takes from the sun, of a set without a sun gives to the ring [N m].
    load_share : float
        Part of the set's torque.
    bearing_force : float
        Resultant force of its shafts on their pins across the axis [N].
    pin_error : tuple of float
        Displacement of its pin, radial and tangential [m].
    """

    shaft: str
    angle: float
    torque: float
    load_share: float
    bearing_force: float
    pin_error: tuple[float, float]


@dataclass(frozen=True, eq=False)
class PlanetaryLoad:
    """A planetary set at the operating point.

    Attributes
    ----------
    name : str
    members : tuple of SetMember
        Speed, torque and power of sun, ring, carrier and planets, by the train.
    planets : tuple of PlanetLoad
    """

    name: str
    members: tuple[SetMember, ...]
    planets: tuple[PlanetLoad, ...]

    @property
    def mesh_load_factor(self) -> float:
        """Mesh load factor K_γ: share of the most loaded planet over the mean one."""
        return len(self.planets) * max(planet.load_share for planet in self.planets)


def planetary_load(machine: Machine, placed: PlacedSet, point: OperatingPoint) -> PlanetaryLoad:
    """Load sharing of a planetary set at an operating point of its machine.

    Raises
    ------
    CouplingError
        Where no mesh of the set carries a load.
    """
    kind = "ring" if placed.of.sun is None else "sun"
    torques = np.zeros(len(placed.groups))
    for mesh in placed.meshes:
        if mesh.kind == kind:
            load = point.pairs[mesh.number]
            central = load.pair.geometry.driver if mesh.driver == placed.of.sun else load.pair.geometry.driven
            torques[mesh.group] += load.force * abs(central.base_radius)
    total = float(torques.sum())
    if total == 0.0:
        raise CouplingError(f"planetary set {placed.of.name!r}: no mesh carries a load; expected a torque")
    forces: dict[str, FloatArray] = {}
    for bearing in point.bearings:
        forces.setdefault(bearing.mounted.rotor, np.zeros(2))
        forces[bearing.mounted.rotor] = forces[bearing.mounted.rotor] + bearing.force[:2]
    radial, tangential = zip(*(machine.shaft(group.shafts[0]).pin_error for group in placed.groups), strict=True)
    planets = [
        PlanetLoad(
            shaft=group.shafts[0],
            angle=group.angle,
            torque=float(torque),
            load_share=float(torque) / total,
            bearing_force=math.hypot(*np.sum([forces[shaft] for shaft in group.shafts], axis=0)),
            pin_error=(out, along),
        )
        for group, torque, out, along in zip(placed.groups, torques, radial, tangential, strict=True)
    ]
    return PlanetaryLoad(placed.of.name, machine.members_of(placed), tuple(planets))


@dataclass(frozen=True, eq=False)
class CarrierTurn:
    """Operating points of a machine over a turn of a planet carrier.

    Attributes
    ----------
    carrier : str
        Shaft of the carrier.
    angles : ndarray, shape (a,)
        Angles that it has turned by, from 0 [rad].
    points : tuple of OperatingPoint
        The equilibrium at each angle.
    sets : tuple of tuple of PlanetaryLoad
        The sets on this carrier at each angle.
    """

    carrier: str
    angles: FloatArray
    points: tuple[OperatingPoint, ...]
    sets: tuple[tuple[PlanetaryLoad, ...], ...]

    @property
    def mesh_forces(self) -> dict[str, FloatArray]:
        """Force of each gear pair over the turn by its label [N], shape (a,)."""
        return {
            load.label: np.array([point.pairs[number].force for point in self.points])
            for number, load in enumerate(self.points[0].pairs)
        }

    @property
    def bearing_forces(self) -> dict[str, FloatArray]:
        """Force of the shaft on each bearing along x, y, z over the turn by its name [N], shape (a, 3).

        Those of planets are along the machine's x and y, in which they turn.
        """
        return {
            load.name: np.array([point.bearings[number].force[:3] for point in self.points])
            for number, load in enumerate(self.points[0].bearings)
        }

    @property
    def misalignments(self) -> dict[str, FloatArray]:
        """Misalignment of each gear pair over the turn by its label [rad], shape (a,)."""
        return {
            load.label: np.array([point.pairs[number].misalignment for point in self.points])
            for number, load in enumerate(self.points[0].pairs)
        }

    def load_shares(self, name: str) -> FloatArray:
        """Load share of each planet of a set over the turn, shape (a, planets)."""
        found = [one for sets in self.sets for one in sets if one.name == name]
        return np.array([[planet.load_share for planet in one.planets] for one in found])


def over_carrier_turn(
    machine: Machine, carrier: str, angles: Sequence[float] | None = None, progress: Progress = silent
) -> CarrierTurn:
    """Find the static equilibrium at angles over a turn of a planet carrier.

    Parameters
    ----------
    machine : Machine
    carrier : str
        Shaft of the carrier.
    angles : sequence of float, optional
        Angles [rad]; by default `ANGLES` over a turn.
    progress : callable

    Raises
    ------
    CouplingError
        Where the machine has no planets on this shaft.
    EquilibriumNotFoundError
        Where no equilibrium is found.
    """
    if not any(shaft.carrier == carrier for shaft in machine.shafts):
        carriers = sorted({shaft.carrier for shaft in machine.shafts if shaft.carrier is not None})
        raise CouplingError(f"no planets on {carrier!r}; expected a carrier, one of {', '.join(carriers) or 'none'}")
    evenly = 2.0 * math.pi * np.arange(ANGLES, dtype=np.float64) / ANGLES
    chosen: FloatArray = evenly if angles is None else np.asarray(angles, dtype=np.float64)
    points, sets = [], []
    for number, angle in enumerate(chosen.tolist()):
        progress(f"static equilibrium over a turn of {carrier}", number / len(chosen))
        turned = machine.turned(angle, carrier)
        point = turned.operating_point()
        points.append(point)
        on_it = [placed for placed in turned.placed_sets if placed.of.carrier == carrier]
        sets.append(tuple(planetary_load(turned, placed, point) for placed in on_it))
    return CarrierTurn(carrier, chosen, tuple(points), tuple(sets))
