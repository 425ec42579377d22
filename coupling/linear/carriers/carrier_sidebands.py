"""Sidebands of mesh harmonics by planet carriers: lines n f_m + k f_c of a machine whose directions turn, by name.

The meshes of planets circle with their carrier at f_c. A sensor that stands still sees the motion at the harmonic n of
their mesh frequency f_m, in the carrier's frame, at n f_m + k f_c. How large k is follows from what turns: a shaft in a
housing of rigid bores has k = ±1, the rim of a ring that follows a bore by its orders up to m has k = ±m, and parts
that hand a motion on to each other have sums of these (:mod:`gearwhine.coupling.linear.carriers.turning_response`,
which all analyses follow). Equal planets add in some of the lines and cancel in the others
(:mod:`gearwhine.coupling.linear.carriers.planet_phasing`); errors, loads and stiffness that differ between planets
leave a part.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.description.parts import bolted_rotors
from gearwhine.coupling.linear.carriers.planet_phasing import PlanetPhasing
from gearwhine.coupling.linear.carriers.turning_response import Order, TurningResponse
from gearwhine.coupling.machine.coordinates import MachineCoordinates
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.frames import Frames
from gearwhine.coupling.machine.planets import frame_speeds, mesh_frame
from gearwhine.coupling.statics.mean_mesh import ContactState

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LINE_KINDS = ("mesh harmonic", "planet pass", "sideband")
"""Kinds of lines by their place beside a mesh harmonic."""

_SAME_SPEED = 1e-9  # relative difference of speeds that are one


@dataclass(frozen=True)
class Sideband:
    """Place of a line beside the excitation that drives it.

    Attributes
    ----------
    turns : tuple of (str, float)
        Carriers by whose turns the line's frequency differs from the excitation's, and their numbers; none of the
        excitation's own frequency.
    ideal : float or None
        Phasing of equal planets in the line: 1 where they add, 0 where they cancel, None where neither follows from
        their angles and teeth alone, or the excitation is no mesh.
    """

    turns: tuple[tuple[str, float], ...] = ()
    ideal: float | None = None

    @property
    def kind(self) -> str:
        """One of `LINE_KINDS`: in a planet pass, off the harmonic, equal planets add."""
        if not self.turns:
            return "mesh harmonic"
        return "planet pass" if self.ideal == 1.0 else "sideband"

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
        bolted = bolted_rotors(machine.torque_supports)
        speeds = frame_speeds(machine.rotors, machine.bearings, machine.meshes, machine.speeds, bolted)
        return Frames(machine.system.components, speeds)

    @cached_property
    def planets(self) -> PlanetPhasing:
        """Phasing of the planets."""
        return PlanetPhasing(self.machine)

    def sideband(self, order: Order, cause: tuple[int, int] | None = None) -> Sideband:
        """Name an order by the carriers that turn at its rates.

        Parameters
        ----------
        order : Order
        cause : tuple of (int, int), optional
            Number of the contact whose mesh harmonic the line is off, and that harmonic; by default no mesh.
        """
        turns: list[tuple[str, float]] = []
        for number, rate in zip(order, self.model.rates, strict=True):
            if number != 0:
                carrier, turn = self._carrier(rate)
                turns.append((carrier, round(number * turn, 9)))
        return Sideband(tuple(turns), None if cause is None else self.planets.ideal(*cause, dict(turns)))

    @property
    def followed(self) -> tuple[Sideband, ...]:
        """Sidebands that an excitation has, but for its own frequency."""
        return tuple(self.sideband(order) for order in self.model.orders if order != self.model.still)

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


def forced_sidebands(machine: CoupledMachine) -> tuple[Sideband, ...]:
    """Sidebands that a machine's turning frames and bores give each excitation; none where no directions turn."""
    if not machine.system.turns:
        return ()
    # Which orders there are follows from the directions alone, at any stiffness of the contacts.
    apart = np.zeros(len(machine.system.contacts))
    return CarrierSidebands(machine, ContactState(apart, apart)).followed


def farthest_turns(sidebands: Sequence[Sideband]) -> dict[str, float]:
    """Largest number of turns of each carrier among some sidebands."""
    farthest: dict[str, float] = {}
    for one in sidebands:
        for carrier, number in one.turns:
            farthest[carrier] = max(farthest.get(carrier, 0.0), abs(number))
    return farthest
