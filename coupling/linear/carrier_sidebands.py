"""Sidebands of mesh harmonics by planet carriers: lines n f_m + k f_c of a machine whose directions turn, by name.

The meshes of planets circle with their carrier at f_c. A sensor that stands still sees the motion at the harmonic n of
their mesh frequency f_m, in the carrier's frame, at all n f_m + k f_c
(:mod:`gearwhine.coupling.linear.turning_response`). Each planet moves the sensor alike, but by its angle ψ and its mesh
phase γ earlier or later: equal planets add with the phases n γ + k ψ, so that of N planets at equal angles every N-th
line stays and the others are suppressed (McFadden & Smith, Proc. IMechE C 199, 65, 1985). Errors, loads and stiffness
that differ between planets leave a part of them. How far a line is suppressed is measured here, as the size of the
housing's motion by all meshes over the sum of its sizes by each alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.linear.turning_response import Order, TurningResponse
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.frames import Frames
from gearwhine.coupling.machine.planets import frame_speeds, mesh_frame
from gearwhine.coupling.statics.mean_mesh import ContactState

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LINE_KINDS = ("mesh harmonic", "planet pass", "carrier sideband")
"""Kinds of lines by their place beside a mesh harmonic."""

SUPPRESSED = 0.05
"""Part of the sum of the sizes by each mesh alone below which a line is suppressed by phasing."""

_WHOLE = 1e-6  # distance from a whole number of turns that is rounding
_SAME_SPEED = 1e-9  # relative difference of speeds that are one


@dataclass(frozen=True)
class Sideband:
    """Place of a line beside the excitation that drives it.

    Attributes
    ----------
    turns : tuple of (str, float)
        Carriers by whose turns the line's frequency differs from the excitation's, and their numbers; none of the
        excitation's own frequency.
    planets : tuple of int
        Number of planets of each of these carriers.
    """

    turns: tuple[tuple[str, float], ...] = ()
    planets: tuple[int, ...] = ()

    @property
    def kind(self) -> str:
        """One of `LINE_KINDS`: a planet pass is off by whole multiples of the planets' passing."""
        if not self.turns:
            return "mesh harmonic"
        passes = [number / count for (_, number), count in zip(self.turns, self.planets, strict=True)]
        whole = all(abs(one - round(one)) < _WHOLE for one in passes)
        return "planet pass" if whole else "carrier sideband"

    @property
    def words(self) -> str:
        """Turns in words that follow the excitation's, such as `` - 3× carrier``; empty at its own frequency."""
        return "".join(f" {'-' if number < 0 else '+'} {abs(number):g}× {carrier}" for carrier, number in self.turns)


@dataclass(frozen=True, eq=False)
class CarrierSidebands:
    """A machine whose directions turn, with names of its sidebands and loads by order.

    Attributes
    ----------
    machine : CoupledMachine
    contact : ContactState
        Contacts about their mean forces.
    """

    machine: CoupledMachine
    contact: ContactState

    @cached_property
    def model(self) -> TurningResponse:
        """Harmonic balance of the machine."""
        return TurningResponse(self.machine.system, self.contact)

    @cached_property
    def frames(self) -> Frames:
        """Frames of the components."""
        machine = self.machine
        speeds = frame_speeds(machine.rotors, machine.bearings, machine.meshes, machine.speeds)
        return Frames(machine.system.components, speeds)

    def sideband(self, order: Order) -> Sideband:
        """Name an order by the carriers that turn at its rates."""
        turns: list[tuple[str, float]] = []
        planets = []
        for number, rate in zip(order, self.model.rates, strict=True):
            if number == 0:
                continue
            carrier, turn = self._carrier(rate)
            turns.append((carrier, round(number * turn, 9)))
            planets.append(max(1, sum(rotor.carrier == carrier for rotor in self.machine.rotors)))
        return Sideband(tuple(turns), tuple(planets))

    def _carrier(self, rate: float) -> tuple[str, float]:
        """Name of the carrier whose turns make a rate, and the number of turns that the rate is."""
        carriers = {rotor.carrier for rotor in self.machine.rotors if rotor.carrier is not None}
        found = [(name, rate / abs(speed)) for name in sorted(carriers) if (speed := self.machine.speeds[name])]
        # A rate that no carrier has, as of two of them, is told by the turns of the one that is nearest.
        return min(found, key=lambda one: (abs(one[1] - max(1.0, round(one[1]))) > _SAME_SPEED, abs(one[1] - 1.0)))

    def by_order(self, frequency: float, load: HarmonicLoad, frame: float) -> dict[Order, ComplexArray]:
        """Split a load that turns with a frame into loads on the coordinates by order beside a frequency [rad/s]."""
        found: dict[Order, ComplexArray] = {}
        for part in self.frames.harmonics(load, frame):
            order = self.model.order_of(part.frequency - frequency)
            if order is not None:
                found[order] = found.get(order, np.zeros_like(part.amplitude)) + part.amplitude
        return found

    def frame_of_contact(self, number: int) -> float:
        """Speed of the frame in which the line of centres of a contact stands still [rad/s]."""
        coordinates = MachineCoordinates(self.machine.system.components, self.machine.speeds)
        return mesh_frame(coordinates, self.machine.meshes[self.machine.flanks(number)[0]])

    def respond(self, frequency: float, loads: Sequence[Mapping[Order, ComplexArray]]) -> dict[Order, ComplexArray]:
        """Coordinates (i, n) by the order of their frequency, under each of some loads by order at a frequency."""
        return self.model.respond(frequency, [(load, {}) for load in loads])


def phasing(parts: ComplexArray) -> float:
    """Size of the sum of motions (i, n) over the sum of their sizes; 1 where nothing moves."""
    sizes = float(np.linalg.norm(parts, axis=1).sum())
    return float(np.linalg.norm(parts.sum(axis=0))) / sizes if sizes > 0.0 else 1.0
