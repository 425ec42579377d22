r"""Phasing of planets: the lines in which equal planets on a carrier add or cancel, by their angles and teeth alone.

Planet j at the angle ψ_j from the first one meets the teeth of a central gear, z of them, which turns in the sense s
as the carrier sees it, later by the phase s z ψ_j of a mesh period. A part that stands still feels the harmonic n of
its meshes at n f_m + k f_c by what circles with the carrier, in the sense c, k times around: later by -c k ψ_j. Equal
planets move it alike but for these phases, which are whole turns at all planets that a turn of 2π/S takes to the place
of another one where

    k - s c n z = 0 modulo S,

and else cancel in their sum. Planets at equal angles, S = N, all add or all cancel; with a ring that stands still, for
which s c = -1, they add where the order n z_r + k in turns of the carrier is a multiple of N (McFadden & Smith, Proc.
IMechE C 199, 65, 1985). This holds for any housing and any path, since an unequal stiffness of what stands still hands
a motion on by the carrier's turning alike for all planets. At other angles neither follows from the angles alone.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.description.gear_train import LARGEST_OFFSET

_WHOLE = 1e-6  # distance from a whole number of turns that is rounding

ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class CarriedPlanets:
    """Planets on a carrier, one group of those in mesh with each other at each angle.

    Attributes
    ----------
    carrier : str
    groups : tuple of frozenset of str
        Rotors of each group.
    angles : tuple of float, or None
        Angle of each group about the axis of the carrier from the first [rad]; None of groups that are not alike.
    radius : float
        Distance of the groups from the axis of the carrier [m].
    """

    carrier: str
    groups: tuple[frozenset[str], ...]
    angles: tuple[float, ...] | None
    radius: float

    @cached_property
    def symmetry(self) -> int:
        """Largest S of turns 2π/S that take all groups to each other's places; 0 of groups that are not alike."""
        if self.angles is None:
            return 0
        count, angles = len(self.angles), np.exp(1j * np.array(self.angles))

        def maps(turns: int) -> bool:
            gaps = np.abs(angles[:, None] * np.exp(2j * np.pi / turns) - angles)
            return bool(np.all(gaps.min(axis=1) * self.radius <= LARGEST_OFFSET))

        return next(turns for turns in range(count, 0, -1) if count % turns == 0 and (turns == 1 or maps(turns)))

    def ideal(self, waves: float) -> float | None:
        """1 where equal planets of phases by a number of waves around add, 0 where they cancel; None for neither."""
        if self.symmetry == 0:
            return None
        turns = waves / self.symmetry
        if abs(turns - round(turns)) > _WHOLE:
            return 0.0
        return 1.0 if self.symmetry == len(self.groups) else None


@dataclass(frozen=True)
class _CentralMesh:
    """Mesh of a planet with a gear on the carrier's axis: that gear's teeth, its rotor's and the planet's."""

    central: str
    planet: str
    teeth: int
    place: tuple[float, float]


@dataclass(frozen=True, eq=False)
class PlanetPhasing:
    """Phasing of the planets of a machine.

    Attributes
    ----------
    machine : CoupledMachine
    """

    machine: CoupledMachine

    @cached_property
    def carried(self) -> dict[str, CarriedPlanets]:
        """Planets of each carrier that turns, by its name."""
        carriers = dict.fromkeys(mesh.carrier for mesh in self.machine.meshes if mesh.carrier is not None)
        return {name: self._planets(name) for name in carriers if self.machine.speeds[name] != 0.0}

    @cached_property
    def _central(self) -> tuple[_CentralMesh | None, ...]:
        """Central gear of each mesh; None of meshes between planets, and of gears whose axes stand still."""
        carrier_of = {rotor.name: rotor.carrier for rotor in self.machine.rotors}
        found: list[_CentralMesh | None] = []
        for mesh in self.machine.meshes:
            ends = [(mesh.driver, mesh.geometry.driver), (mesh.driven, mesh.geometry.driven)]
            ends.sort(key=lambda end: carrier_of[end[0].rotor] is not None)
            (middle, gear), (planet, _) = ends
            if mesh.carrier is None or carrier_of[middle.rotor] is not None:
                found.append(None)
                continue
            place = planet.axis[0] - middle.axis[0], planet.axis[1] - middle.axis[1]
            found.append(_CentralMesh(middle.rotor, planet.rotor, abs(gear.teeth), place))
        return tuple(found)

    def _planets(self, carrier: str) -> CarriedPlanets:
        groups: list[frozenset[str]] = []
        for mesh, central in zip(self.machine.meshes, self._central, strict=True):
            if mesh.carrier != carrier:
                continue
            planets = {mesh.driver.rotor, mesh.driven.rotor} if central is None else {central.planet}
            joined = [group for group in groups if group & planets]
            place = groups.index(joined[0]) if joined else len(groups)
            groups = [group for group in groups if group not in joined]
            groups.insert(place, frozenset(planets.union(*joined)))
        meshes = [
            one for mesh, one in zip(self.machine.meshes, self._central, strict=True) if one and mesh.carrier == carrier
        ]
        for gear in dict.fromkeys((one.central, one.teeth) for one in meshes):
            around = [
                [one for one in meshes if (one.central, one.teeth) == gear and one.planet in group] for group in groups
            ]
            if all(len(ones) == 1 for ones in around):
                angles = [math.atan2(one.place[1], one.place[0]) for (one,) in around]
                radius = max(math.hypot(*one.place) for (one,) in around)
                return CarriedPlanets(carrier, tuple(groups), tuple(angle - angles[0] for angle in angles), radius)
        return CarriedPlanets(carrier, tuple(groups), None, 0.0)

    def _waves(self, contact: int) -> int | None:
        """Waves s c z of a contact's mesh phases around its carrier; None where no central gear has its frequency."""
        machine, own = self.machine, self.machine.flanks(contact)[0]
        rate = abs(machine.system.contacts[contact].mesh_frequency)
        alike = [own, *range(len(machine.meshes))]
        for number in alike:
            central, carrier = self._central[number], machine.meshes[number].carrier
            frequency = abs(machine.system.contacts[number].mesh_frequency)
            if central is None or carrier != machine.meshes[own].carrier or not math.isclose(frequency, rate):
                continue
            speed = machine.speeds[carrier]
            return int(math.copysign(central.teeth, (machine.speeds[central.central] - speed) * speed))
        return None

    def ideal(self, contact: int, harmonic: int, turns: Mapping[str, float]) -> float | None:
        """1 where equal planets add in a line off a harmonic of a contact by turns of carriers, 0 where they cancel.

        None where neither follows from angles and teeth alone.

        Parameters
        ----------
        contact : int
            Number of the contact in the system.
        harmonic : int
        turns : mapping of str to float
            Signed turns by the carrier.
        """
        own, parts = self.machine.meshes[self.machine.flanks(contact)[0]].carrier, []
        for carrier, planets in self.carried.items():
            of_mesh = self._waves(contact) if carrier == own else 0
            parts.append(None if of_mesh is None else planets.ideal(turns.get(carrier, 0.0) - harmonic * of_mesh))
        if 0.0 in parts:
            return 0.0
        return None if None in parts else 1.0

    def planet(self, contact: int) -> tuple[str, int] | None:
        """Carrier and number of the group of planets whose mesh a contact is; None of a mesh of other gears."""
        mesh = self.machine.meshes[self.machine.flanks(contact)[0]]
        planets = self.carried.get(mesh.carrier or "")
        ends = {mesh.driver.rotor, mesh.driven.rotor}
        numbers = () if planets is None else (n for n, group in enumerate(planets.groups) if group & ends)
        return next(((planets.carrier, number) for number in numbers if planets is not None), None)

    def solved(self, contacts: Sequence[int], parts: ComplexArray) -> float:
        """Size of the sum of motions (i, n) by contacts over the sum of sizes by each planet; 1 where nothing moves.

        The meshes of one planet move the housing as one, since it has neither without the other.
        """
        together: dict[object, ComplexArray] = {}
        for number, part in zip(contacts, parts, strict=True):
            planet = self.planet(number) or number
            together[planet] = together[planet] + part if planet in together else part
        sizes = sum(float(np.linalg.norm(part)) for part in together.values())
        return float(np.linalg.norm(parts.sum(axis=0))) / sizes if sizes > 0.0 else 1.0
