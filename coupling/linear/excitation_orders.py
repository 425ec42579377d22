"""Excitation orders of a machine: shafts, mesh harmonics, sidebands, passing of rolling elements, harmonic loads."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.base_motion import BaseHarmonic
from gearwhine.coupling.machine.driving_frequencies import element_passes as passing_frequencies
from gearwhine.coupling.machine.loads import TorqueRipple

_TWO_PI = 2.0 * math.pi
_STANDSTILL = 1e-9  # part of a mesh order below which a sideband is constant in time, and no line


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
    """

    name: str
    kind: Literal["shaft", "mesh", "sideband", "bearing", "load"]
    order: float


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
) -> tuple[ExcitationLine, ...]:
    """Orders of all shafts, meshes and rolling elements in motion; shafts of equal speed share a line.

    Parameters
    ----------
    machine : CoupledMachine
    shaft_orders : sequence of float
        Multiples of each shaft's speed: 1 is its unbalance.
    mesh_harmonics : sequence of int
        Multiples of each mesh frequency.
    sidebands : int
        Number of sidebands on either side of each mesh harmonic, spaced by the speed of either gear's shaft, or by the
        frequency of a load where loads count. One below zero is folded to its size, one at zero left out.
    element_passes : sequence of int
        Multiples of the passing of rolling elements over the outer raceway, of bearings whose law follows them.
    load_multiples : sequence of int
        Multiples of harmonic torques and of harmonic motions of the base, whose frequency may be constant.
    excited : mapping of str to ExcitedOrders, optional
        Rotors that something excites, see :func:`excited_shaft_orders`: only their orders and sidebands are listed. By
        default those of all rotors are.

    Raises
    ------
    CouplingError
        For a machine that stands still.
    """
    speeds = machine.speeds
    leading = abs(speeds[machine.leading_rotor])
    if leading == 0.0:
        raise CouplingError(f"rotor {machine.leading_rotor!r} stands still; expected a machine that turns")
    ratios = {name: abs(speed) / leading for name, speed in speeds.items() if speed != 0.0}
    together: dict[float, list[str]] = {}
    for name, ratio in ratios.items():
        together.setdefault(round(ratio, 12), []).append(name)
    lines = []
    for together_names in together.values():
        for multiple in shaft_orders:
            names = [name for name in together_names if excited is None or _holds(excited, name, multiple)]
            if names:
                lines.append(ExcitationLine(f"{multiple:g}× {', '.join(names)}", "shaft", multiple * ratios[names[0]]))
    loads = tuple(_harmonic_loads(machine, leading)) if load_multiples else ()
    lines += [
        ExcitationLine(f"{multiple}× {name}", "load", multiple * order)
        for name, order in loads
        for multiple in load_multiples
    ]
    for mesh in machine.meshes:
        frame = 0.0 if mesh.carrier is None else speeds[mesh.carrier]
        turns = {gear.rotor: abs(speeds[gear.rotor] - frame) / leading for gear in (mesh.driven, mesh.driver)}
        teeth = abs(mesh.geometry.driver.teeth) * turns[mesh.driver.rotor]
        name = mesh.name
        # A modulation of the mesh mixes with itself: every number of sidebands comes from the first order alone.
        shafts = {
            round(ratio, 12): (rotor if frame == 0.0 else f"{rotor} in {mesh.carrier}", ratio)
            for rotor, ratio in turns.items()
            if ratio > 0.0 and (excited is None or rotor in excited)
        }
        modulations = [*shafts.values(), *loads]
        if frame != 0.0 and mesh.carrier is not None:
            # A mesh that circles modulates what stands still, whatever the quality of its teeth.
            modulations.insert(0, (mesh.carrier, abs(frame) / leading))
        for harmonic in mesh_harmonics:
            lines.append(ExcitationLine(f"{harmonic}× {name}", "mesh", harmonic * teeth))
            for source, ratio in modulations:
                for number in range(1, sidebands + 1):
                    for sign, word in ((-1, "-"), (1, "+")):
                        # A carrier modulated faster than its own frequency has its lower sideband at |difference|.
                        order = abs(harmonic * teeth + sign * number * ratio)
                        text = f"{harmonic}× {name} {word} {number}× {source}"
                        if order > _STANDSTILL * teeth:
                            lines.append(ExcitationLine(text, "sideband", order))
    lines += [
        ExcitationLine(f"{multiple}× elements of {name}", "bearing", multiple * frequency * _TWO_PI / leading)
        for name, frequencies in passing_frequencies(machine.system).items()
        for frequency in frequencies
        for multiple in element_passes
    ]
    return tuple(lines)


def excited_shaft_orders(machine: CoupledMachine) -> dict[str, ExcitedOrders]:
    """Orders of the rotors that their own imperfections and loads excite; rotors without any are left out.

    Unbalance, a bow and the runout of a gear repeat once a turn, and a torque ripple by its order. Teeth that differ,
    by pitch deviations or faults, have every order, and so has any of these where a bearing is nonlinear.
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
        for mounted, gear in ((mesh.driver, mesh.geometry.driver), (mesh.driven, mesh.geometry.driven)):
            if gear.eccentricity != 0.0:
                found.setdefault(mounted.rotor, set()).add(1.0)
            if any(gear.pitch_deviations) or gear.faults:
                found.setdefault(mounted.rotor, set()).add(1.0)
                every.add(mounted.rotor)
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
