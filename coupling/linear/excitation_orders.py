"""Excitation orders of a machine: shafts, mesh harmonics, sidebands, passing of rolling elements, harmonic loads.

What a gear in a planetary set does not have alike on all teeth returns with its turn relative to the carrier, at
f_s - f_c of the sun: a tooth fault meets the N planets N times in it, and the unequal harmonics cancel in a sum over
equal planets only. A sensor, which the meshes pass by, has these modulated by the carrier, at
m f_mesh ± k (f_s - f_c) ± n f_c (Feng & Zuo, J. Sound Vib. 331 (2012) 4919, for faults of sun, planet and ring).
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.carriers.carrier_sidebands import Sideband
from gearwhine.coupling.machine.base_motion import BaseHarmonic
from gearwhine.coupling.machine.driving_frequencies import element_passes as passing_frequencies
from gearwhine.coupling.machine.driving_frequencies import spall_strikes
from gearwhine.coupling.machine.loads import TorqueRipple
from gearwhine.coupling.machine.mounted_parts import GearMesh

_TWO_PI = 2.0 * math.pi
_WIDEST = 0.15  # half-width of a line over the distance to the next multiple
_STANDSTILL = 1e-9  # part of a mesh order below which a sideband is constant in time, and no line
_Steps = Sequence[tuple[str, float, float]]
"""Causes of a sideband: name, order of its frequency, signed number of the sideband."""


@dataclass(frozen=True)
class ExcitationLine:
    """An excitation by its order: a frequency that is proportional to the speed, or a constant one at nominal speed.

    Attributes
    ----------
    name : str
        Name of the order, such as ``2× input``, ``3× pinion -> wheel``, or ``1× pinion -> wheel + 1× input`` for a
        sideband.
    kind : str
        ``shaft``, ``mesh``, ``sideband``, ``bearing`` or ``load``.
    order : float
        Frequency over the speed of the leading rotor, positive.
    steps : int
        Number of a sideband, of one by two causes the sum of both numbers; 0 of other lines.
    half_width : float
        Half-width of a line that slip makes wide, over the speed of the leading rotor.
    """

    name: str
    kind: Literal["shaft", "mesh", "sideband", "bearing", "load"]
    order: float
    steps: float = 0
    half_width: float = 0.0


@dataclass(frozen=True)
class ExcitedOrders:
    """Orders of a shaft that something excites.

    Attributes
    ----------
    orders : frozenset of float
        Multiples of the shaft's speed.
    every : bool
        Whether every whole multiple is excited, too.
    """

    orders: frozenset[float] = frozenset()
    every: bool = False

    def __contains__(self, order: float) -> bool:
        """Whether a multiple of the shaft's speed is excited."""
        return self.every or order in self.orders


def excitation_lines(
    machine: CoupledMachine,
    *,
    shaft_orders: Sequence[float] = (1.0, 2.0),
    mesh_harmonics: Sequence[int] = (1, 2, 3),
    sidebands: int = 0,
    element_passes: Sequence[int] = (),
    load_multiples: Sequence[int] = (),
    excited: Mapping[str, ExcitedOrders] | None = None,
    by_carriers: Sequence[Sideband] | None = None,
) -> tuple[ExcitationLine, ...]:
    """Orders of all shafts, meshes and rolling elements in motion; shafts of equal speed share a line.

    Parameters
    ----------
    machine : CoupledMachine
    shaft_orders : sequence of float
        Multiples of each shaft's speed: 1 is its unbalance. Where ``excited`` names them, also multiples of its speed
        relative to a carrier.
    mesh_harmonics : sequence of int
        Multiples of each mesh frequency.
    sidebands : int
        Number of sidebands on either side of each mesh harmonic, spaced by the speed of either gear's shaft, or by the
        frequency of a load where loads count. One below zero is folded to its size, one at zero left out.
    element_passes : sequence of int
        Multiples of the passing of rolling elements over the ring at rest, of bearings whose law follows them, and of
        the strikes of their spalls.
    load_multiples : sequence of int
        Multiples of harmonic torques and of harmonic motions of the base, whose frequency may be constant.
    excited : mapping of str to ExcitedOrders, optional
        Rotations that something excites, see :func:`excited_shaft_orders`: only their orders and sidebands are listed,
        those by a gear and by its carrier together among them. By default those of each rotor alone are.
    by_carriers : sequence of Sideband, optional
        Sidebands that each excitation has by the turning of carriers, as of
        :func:`gearwhine.coupling.linear.carriers.carrier_sidebands.forced_sidebands`; those of the mean load are orders
        of the carriers. By default each mesh of planets has ``sidebands`` by its own carrier.

    Raises
    ------
    CouplingError
        For a machine that stands still.
    """
    speeds = machine.speeds
    leading = abs(speeds[machine.leading_rotor])
    if leading == 0.0:
        raise CouplingError(f"rotor {machine.leading_rotor!r} stands still; expected a machine that turns")
    by_turning: list[_Steps] = [
        [(carrier, abs(speeds[carrier]) / leading, number) for carrier, number in one.turns]
        for one in by_carriers or ()
    ]
    loads = tuple(_harmonic_loads(machine, leading)) if load_multiples else ()
    lines = [*_shaft_lines(machine, leading, shaft_orders, excited), *_carrier_lines(by_turning)]
    lines += [
        ExcitationLine(f"{multiple}× {name}", "load", multiple * order)
        for name, order in loads
        for multiple in load_multiples
    ]
    for mesh in machine.meshes:
        frame = 0.0 if mesh.carrier is None else speeds[mesh.carrier]
        turns = {gear.rotor: abs(speeds[gear.rotor] - frame) / leading for gear in (mesh.driven, mesh.driver)}
        # A modulation of the mesh mixes with itself: every number of sidebands comes from the first order alone.
        shafts = {
            round(ratio, 12): (in_carrier(rotor, mesh, frame), ratio)
            for rotor, ratio in turns.items()
            if ratio > 0.0 and (excited is None or rotor in excited or in_carrier(rotor, mesh, frame) in excited)
        }
        of_gears: list[_Steps] = [
            [(source, ratio, number)] for source, ratio in [*shafts.values(), *loads] for number in _signed(sidebands)
        ]
        # A mesh that circles modulates what stands still, whatever the quality of its teeth.
        passing = by_turning
        if by_carriers is None and frame != 0.0 and mesh.carrier is not None:
            passing = [[(mesh.carrier, abs(frame) / leading, number)] for number in _signed(sidebands)]
        steps = [*passing, *of_gears] if excited is None else _joined_steps(of_gears, passing, sidebands)
        teeth = abs(mesh.geometry.driver.teeth) * turns[mesh.driver.rotor]
        lines += _with_sidebands(mesh.name, "mesh", teeth, mesh_harmonics, steps)
    lines += _bearing_lines(machine, leading, element_passes, sidebands, by_turning)
    return tuple(lines)


def _shaft_lines(
    machine: CoupledMachine, leading: float, orders: Sequence[float], excited: Mapping[str, ExcitedOrders] | None
) -> Iterator[ExcitationLine]:
    """Yield the orders of rotations that are excited; those of equal speed share a line."""
    turning = machine.speeds if excited is None else rotations(machine)
    ratios = {name: abs(speed) / leading for name, speed in turning.items() if speed != 0.0}
    together: dict[float, list[str]] = {}
    for name, ratio in ratios.items():
        together.setdefault(round(ratio, 12), []).append(name)
    for together_names in together.values():
        for multiple in orders:
            names = [name for name in together_names if excited is None or _holds(excited, name, multiple)]
            if names:
                yield ExcitationLine(f"{multiple:g}× {', '.join(names)}", "shaft", multiple * ratios[names[0]])


def _carrier_lines(by_turning: Sequence[_Steps]) -> Iterator[ExcitationLine]:
    """Yield the orders of carriers under the mean load."""
    for steps in by_turning:
        order = sum(number * ratio for _, ratio, number in steps)
        if order > _STANDSTILL:
            yield ExcitationLine(_in_words(steps).removeprefix("+ "), "shaft", order)


def _with_sidebands(
    name: str,
    kind: Literal["mesh", "bearing"],
    order: float,
    harmonics: Sequence[int],
    sidebands: Sequence[_Steps],
    half_width: float = 0.0,
) -> Iterator[ExcitationLine]:
    """Yield the harmonics of an excitation by its order, with their sidebands; the first is as wide as is given."""
    for harmonic in harmonics:
        # Multiples that run into each other are no lines.
        width = harmonic**2 * half_width if harmonic**2 * half_width < _WIDEST * order else 0.0
        yield ExcitationLine(f"{harmonic}× {name}", kind, harmonic * order, half_width=width)
        for steps in sidebands:
            # A carrier modulated faster than its own frequency has its lower sideband at |difference|.
            beside = abs(harmonic * order + sum(number * ratio for _, ratio, number in steps))
            if beside > _STANDSTILL * order:
                yield ExcitationLine(f"{harmonic}× {name} {_in_words(steps)}", "sideband", beside, _count(steps), width)


def _bearing_lines(
    machine: CoupledMachine,
    leading: float,
    element_passes: Sequence[int],
    sidebands: int,
    by_turning: Sequence[_Steps],
) -> Iterator[ExcitationLine]:
    """Yield the passing of rolling elements and the strikes of spalls, with sidebands by what turns spall or bearing.

    A bearing of a planet circles with its carrier, as meshes of planets do. In its frame a spall is carried through the
    load by its ring or the cage, so that a sensor has the turns of both (Feng, Ma and Zuo, J. Sound Vib.
    370 (2016) 372).
    """
    struck = spall_strikes(machine.system)
    for name, frequencies in passing_frequencies(machine.system).items():
        for frequency in frequencies:
            # Elements pass a spall of the ring at rest as often as any place of it.
            if any(one.bearing == name and math.isclose(one.frequency, frequency) for one in struck):
                continue
            order = frequency * _TWO_PI / leading
            yield from _with_sidebands(f"elements of {name}", "bearing", order, element_passes, by_turning)
    for strikes in struck:
        turn = strikes.turning_frequency * _TWO_PI / leading
        carried: list[_Steps] = [
            [(strikes.turning, turn, number)] for number in (_signed(sidebands) if strikes.turning else ())
        ]
        steps = _joined_steps(carried, by_turning, sidebands)
        per_hz = _TWO_PI / leading
        yield from _with_sidebands(
            strikes.name,
            "bearing",
            strikes.frequency * per_hz,
            element_passes,
            steps,
            strikes.half_width * per_hz,
        )


def _joined_steps(one: Sequence[_Steps], other: Sequence[_Steps], sidebands: int) -> list[_Steps]:
    """Return the steps of two causes, and those by both that are no more than the farthest by one alone.

    Steps of one shaft by both, such as a carrier with a pinion, are those by either alone.
    """
    farthest = max([sidebands, *map(_count, other)])
    sources = [{source for source, _, _ in steps} for steps in other]
    both = (
        [*first, *second]
        for first in one
        for second, of_second in zip(other, sources, strict=True)
        if of_second.isdisjoint(source for source, _, _ in first)
    )
    return [*other, *one, *(steps for steps in both if _count(steps) <= farthest)]


def meshes_of_planets(machine: CoupledMachine, carrier: str) -> str:
    """Name of the meshes of all planets on a carrier, which is named where the machine has several."""
    carriers = {mesh.carrier for mesh in machine.meshes if mesh.carrier is not None}
    return "planets' meshes" if len(carriers) == 1 else f"planets' meshes of {carrier}"


def joined_causes(machine: CoupledMachine, names: Sequence[str]) -> str:
    """Join the names of causes that coincide; the meshes of all planets on a carrier are one."""
    left = list(dict.fromkeys(names))
    for carrier in dict.fromkeys(mesh.carrier for mesh in machine.meshes if mesh.carrier is not None):
        meshes = [mesh.name for mesh in machine.meshes if mesh.carrier == carrier]
        for name in [name for name in left if meshes[0] in name] if len(meshes) > 1 else ():
            before, _, after = name.partition(meshes[0])
            alike = [f"{before}{mesh}{after}" for mesh in meshes]
            if all(one in left for one in alike):
                left[left.index(name)] = f"{before}{meshes_of_planets(machine, carrier)}{after}"
                left = [one for one in left if one not in alike]
    return ", ".join(left)


def _signed(sidebands: int) -> list[int]:
    return [sign * number for number in range(1, sidebands + 1) for sign in (-1, 1)]


def _count(steps: _Steps) -> float:
    return sum(abs(number) for _, _, number in steps)


def _in_words(steps: _Steps) -> str:
    return " ".join(f"{'-' if number < 0 else '+'} {abs(number):g}× {source}" for source, _, number in steps)


def in_carrier(rotor: str, mesh: GearMesh, frame: float) -> str:
    """Name of a rotor's rotation as a mesh sees it, whose frame turns with the mesh's carrier or not at all."""
    return rotor if frame == 0.0 else f"{rotor} in {mesh.carrier}"


def rotations(machine: CoupledMachine) -> dict[str, float]:
    """Signed speed of every rotor, and of those in mesh on a turning carrier relative to it [rad/s]."""
    found = dict(machine.speeds)
    for mesh in machine.meshes:
        frame = 0.0 if mesh.carrier is None else machine.speeds[mesh.carrier]
        for mounted in (mesh.driver, mesh.driven):
            found.setdefault(in_carrier(mounted.rotor, mesh, frame), machine.speeds[mounted.rotor] - frame)
    return found


def excited_shaft_orders(machine: CoupledMachine) -> dict[str, ExcitedOrders]:
    """Orders of the rotations that imperfections and loads of rotors excite; rotations without any are left out.

    Unbalance, a bow and the runout of a gear repeat once a turn, and a torque ripple by its order. Teeth that differ,
    by pitch deviations or faults, have every order, and so has any of these where a bearing is nonlinear. What a gear
    has repeats with its turn relative to the carrier of its mesh, see :func:`rotations`.
    """
    loads = machine.loads
    found: dict[str, set[float]] = {}
    for unbalance in loads.unbalances:
        if unbalance.moment != 0.0:
            found.setdefault(unbalance.rotor, set()).add(1.0)
    for bow in loads.bows:
        if bow.forces.any():
            found.setdefault(bow.rotor, set()).add(1.0)
    for torque in loads.torques:
        if isinstance(torque, TorqueRipple) and torque.amplitude != 0.0 and torque.order is not None:
            found.setdefault(torque.rotor, set()).add(torque.order)
    every = set()
    for mesh in machine.meshes:
        frame = 0.0 if mesh.carrier is None else machine.speeds[mesh.carrier]
        for mounted, gear in ((mesh.driver, mesh.geometry.driver), (mesh.driven, mesh.geometry.driven)):
            rotation = in_carrier(mounted.rotor, mesh, frame)
            if gear.eccentricity != 0.0:
                found.setdefault(rotation, set()).add(1.0)
            if any(gear.pitch_deviations) or gear.faults:
                found.setdefault(rotation, set()).add(1.0)
                every.add(rotation)
    if machine.system.nonlinear:
        every.update(found)
    return {rotor: ExcitedOrders(frozenset(orders), rotor in every) for rotor, orders in found.items()}


def _holds(excited: Mapping[str, ExcitedOrders], rotor: str, order: float) -> bool:
    return rotor in excited and order in excited[rotor]


def _harmonic_loads(machine: CoupledMachine, leading: float) -> Iterator[tuple[str, float]]:
    """Yield the name of each harmonic torque and motion of the base, and its order at the nominal speed."""
    for torque in machine.loads.torques:
        if isinstance(torque, TorqueRipple) and torque.amplitude != 0.0:
            if torque.frequency is not None:
                yield f"ripple of {torque.frequency / _TWO_PI:.6g} Hz on {torque.rotor}", torque.frequency / leading
            elif torque.order is not None and machine.speeds[torque.rotor] != 0.0:
                order = torque.order * abs(machine.speeds[torque.rotor]) / leading
                yield f"ripple of order {torque.order:g} on {torque.rotor}", order
    for part in () if machine.loads.base is None else machine.loads.base.parts:
        if isinstance(part, BaseHarmonic):
            yield f"base of {part.frequency / _TWO_PI:.6g} Hz", part.frequency / leading
