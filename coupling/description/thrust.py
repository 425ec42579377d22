"""Thrust of helical gears: axial forces on each rotor, and the bearings that carry them.

A pair's force F acts along the normal of the teeth: in the transverse plane along the line of action, and along z by
F tan β_b. At constant torque the moment about z of every rotor balances, s Σ F R_b = T, which gives the forces; a rotor
on which their axial parts do not cancel needs a bearing that holds it along its axis. Without one it has no axial
coordinate, and the thrust would vanish from the model.
"""

from collections.abc import Collection, Container, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.description.gear_train import turning_senses
from gearwhine.coupling.description.train_matrix import GearedShafts
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import GearPairGeometry
from gearwhine.coupling.machine.mounted_parts import MountedBearing

_CANCELLED = 1e-6  # part of the largest axial force of a gear on the rotor that may be left over


@dataclass(frozen=True)
class ThrustPair:
    """A gear pair in the thrust balance: its rotors, its gears' names, geometry, and the carrier of a planet."""

    rotors: tuple[str, str]
    gears: tuple[str, str]
    geometry: GearPairGeometry
    carrier: str | None = None

    @property
    def shafts(self) -> GearedShafts:
        """The rotors as shafts of a train."""
        return GearedShafts(*self.rotors, (self.geometry.driver.teeth, self.geometry.driven.teeth), self.carrier)

    @property
    def arms(self) -> dict[str, float]:
        """Moment about z on each rotor, carrier included, by a unit force that resists a driver turning about +z [m].

        A carrier gets by its planets' bearings what balances the moments on the gears about their own axes.
        """
        radii = [gear.base_radius for gear in (self.geometry.driver, self.geometry.driven)]
        arms = dict(zip(self.rotors, radii, strict=True))
        if self.carrier is not None:
            arms[self.carrier] = arms.get(self.carrier, 0.0) - sum(radii)
        return arms


@dataclass(frozen=True)
class AxialForces:
    """Axial forces of the gears on one rotor at its torques.

    Attributes
    ----------
    gears : tuple of str
        Names of the gears with a helix angle.
    forces : tuple of float
        Force along z on each of these gears [N].
    """

    gears: tuple[str, ...]
    forces: tuple[float, ...]

    @property
    def net(self) -> float:
        """Sum of the forces [N]; zero where they cancel within rounding."""
        total = sum(self.forces)
        return total if abs(total) > _CANCELLED * max(map(abs, self.forces), default=0.0) else 0.0


def axially_held(bearings: Sequence[MountedBearing], speeds: Mapping[str, float], among: Container[str]) -> set[str]:
    """Rotors of ``among`` that a bearing with axial stiffness holds at their speeds [rad/s]."""
    return {
        mounted.rotor
        for mounted in bearings
        if mounted.rotor in among and _holds_axially(mounted, speeds[mounted.rotor])
    }


def _holds_axially(mounted: MountedBearing, speed: float) -> bool:
    """Whether a bearing holds its rotor axially in motion: by its stiffness, or by its elements until that is known.

    An operating point asks the elements wherever there are any, see
    :func:`gearwhine.coupling.description.axial_location.axial_support`.
    """
    elements = mounted.elements
    if mounted.needs_load and elements is not None:
        return elements.has_axial_stiffness
    return bool(mounted.bearing.at_speed(speed).spatial_stiffness[2, 2] > 0.0)


def axial_forces(
    pairs: Sequence[ThrustPair],
    speeds: Mapping[str, float],
    torques: Mapping[str, float],
    held: Collection[str] = (),
) -> dict[str, AxialForces]:
    """Axial forces of helical gears on each rotor that has any, at constant torques.

    Parameters
    ----------
    pairs : sequence of ThrustPair
        All gear pairs.
    speeds : mapping of str to float
        Signed speed of each rotor [rad/s].
    torques : mapping of str to float
        Torque about z on each rotor [N m]; a rotor without one is free to turn.
    held : collection of str
        Rotors that are held from turning, which take any torque.

    Notes
    -----
    Where several paths share a torque the least-squares forces are taken: equal pairs carry equal parts.
    """
    names = list(dict.fromkeys(name for pair in pairs for name in pair.arms if name not in held))
    moments = np.zeros((len(names), len(pairs)))
    senses = turning_senses([pair.shafts for pair in pairs], speeds)
    for number, (pair, sense) in enumerate(zip(pairs, senses, strict=True)):
        for rotor, arm in pair.arms.items():
            if rotor not in held:
                moments[names.index(rotor), number] += pair.geometry.flank_sense(sense) * arm
    acting = np.array([torques.get(name, 0.0) for name in names])
    mesh_forces = np.linalg.lstsq(moments, acting, rcond=None)[0] if pairs else np.zeros(0)
    by_rotor: dict[str, list[tuple[str, float]]] = {}
    for pair, sense, force in zip(pairs, senses, mesh_forces.tolist(), strict=True):
        helix = pair.geometry.driver.base_helix_angle
        if helix == 0.0:
            continue
        thrust = sense * force * float(np.tan(helix))
        for rotor, name, side in zip(pair.rotors, pair.gears, (1.0, -1.0), strict=True):
            by_rotor.setdefault(rotor, []).append((name, side * thrust))
    return {
        rotor: AxialForces(tuple(gear for gear, _ in gear_forces), tuple(force for _, force in gear_forces))
        for rotor, gear_forces in by_rotor.items()
    }


def require_thrust_carried(
    pairs: Sequence[ThrustPair],
    bearings: Sequence[MountedBearing],
    speeds: Mapping[str, float],
    torques: Mapping[str, float],
    movable: Container[str] | None = None,
    held: Collection[str] = (),
) -> None:
    """Refuse helical gears that push a rotor which no bearing holds along its axis.

    Parameters
    ----------
    pairs, speeds, torques
        See :func:`axial_forces`.
    bearings : sequence of MountedBearing
        All bearings; those with axial stiffness carry thrust.
    movable : container of str, optional
        Rotors with an axial coordinate; by default all.
    held : collection of str
        Rotors that are held from turning.

    Raises
    ------
    CouplingError
        Naming the rotors, the gears and the forces [N].
    """
    forces = axial_forces(pairs, speeds, torques, held)
    held_rotors = axially_held(bearings, speeds, forces)
    loose = [
        f"rotor {rotor!r}: its gears {', '.join(map(repr, dict.fromkeys(axial.gears)))} push it along its axis with "
        f"{abs(axial.net):.4g} N, and none of its bearings has axial stiffness"
        for rotor, axial in forces.items()
        if axial.net != 0.0 and not (rotor in held_rotors and (movable is None or rotor in movable))
    ]
    if loose:
        raise CouplingError(
            "; ".join(loose)
            + "; expected a bearing that carries the thrust (a 5x5 stiffness matrix with the entry zz, "
            "or a rolling bearing that does not float), or helical gears whose thrusts on the rotor cancel"
        )
