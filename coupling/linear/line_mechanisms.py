r"""Mechanisms of spectral lines: what excites a machine at a frequency, and the part of a sensor's line by each.

About the mean load the motion at a frequency ω is linear in what excites it
(:mod:`gearwhine.coupling.linear.mesh_harmonics`),

    (K + iω C - ω² I) q = Σ f_m,      a_m = -ω² s · q_m,

s the row of a sensor, f_m the load of the mechanism m:

- ``transmission_error``: k e d at the harmonics of a mesh, e those of the loaded transmission error of teeth that are
  all alike: of their shape, deflection and changing number in contact;
- ``varying_stiffness``: the force -g d by the mesh stiffness that varies with the phase
  (:mod:`gearwhine.coupling.linear.parametric_stiffness`), at the mesh harmonics, and, where teeth differ, between them;
- ``load_shuttling``: the moments of a load that moves along the face
  (:mod:`gearwhine.coupling.machine.load_shuttling`);
- ``friction``: Coulomb's friction on the flanks under the mean force, which reverses at the pitch point
  (:mod:`gearwhine.coupling.machine.tooth_friction`);
- ``pitch_errors``: k e d of what differs between teeth, by pitch deviations and damage, at the harmonics of the hunting
  period, e the loaded transmission error less that of teeth that are alike; and (k + iω c) e d by the runout of gears;
- ``unbalance``, ``shaft_bow``, ``torque_ripple``, ``base_motion``: as given.

Where directions turn with carriers, an excitation at ω_e moves a sensor at all ω_e + m f too, so that a line is made by
all excitations that are so many turns off it (:mod:`gearwhine.coupling.linear.carriers.turning_response`).

The parts add up with their phases to the line of the linear model. A motion has other lines than that where flanks
part and where a bearing's law bends within the motion.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.gears.loaded.transmission_error import (
    HuntingCurve,
    hunting_period_mesh,
    loaded_transmission_error,
    polygon_phasors,
)
from gearwhine.coupling.linear.carriers.turning_response import Excitation, Order, TurningResponse
from gearwhine.coupling.linear.carriers.turning_stiffness import TurningStiffnessForce
from gearwhine.coupling.linear.mesh_harmonics import Force, MeshHarmonicModel, sum_by_order
from gearwhine.coupling.linear.parametric_stiffness import VaryingMesh
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, StiffnessForce
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.numerics.arrays import ComplexArray, FloatArray

MECHANISMS = (
    "transmission_error",
    "varying_stiffness",
    "load_shuttling",
    "friction",
    "pitch_errors",
    "unbalance",
    "shaft_bow",
    "torque_ripple",
    "base_motion",
    "load",
)
"""Mechanisms in the order in which they are told; ``load`` is a harmonic load of another kind."""

_SAME_FREQUENCY_DIFFERENCE = 1e-6  # relative difference of frequencies that are one
_TRANSMISSION_ERROR_ROUNDING = 1e-12  # part of the largest transmission error that is rounding
_UNRESOLVED_HARMONICS = 32  # largest number of harmonics of the hunting period that a line adds up
_FAINT_HARMONIC = 1e-4  # part of the largest of these below which one adds nothing


@dataclass(frozen=True)
class LineParts:
    """Amplitudes of a sensor's line by the mechanisms.

    Attributes
    ----------
    amplitudes : dict of str to float
        Amplitude by each mechanism alone, in the order of `MECHANISMS` [m/s²].
    shares : dict of str to float
        Part of the sum in phase with it; shares add up to 1.
    together : float
        Amplitude of the sum [m/s²].
    """

    amplitudes: dict[str, float]
    shares: dict[str, float]
    together: float

    @classmethod
    def of(cls, groups: Sequence[Mapping[str, complex]]) -> "LineParts":
        """Return the parts by complex amplitudes; groups of different frequencies add by their squares."""
        found = [mechanism for mechanism in MECHANISMS if any(mechanism in group for group in groups)]
        sums = [sum(group.values()) for group in groups]
        power = sum(abs(total) ** 2 for total in sums) or 1.0
        of = {name: np.array([group.get(name, 0.0) for group in groups]) for name in found}
        return cls(
            {name: float(np.linalg.norm(values)) for name, values in of.items()},
            {name: float((values @ np.conj(sums)).real / power) for name, values in of.items()},
            float(np.linalg.norm(sums)),
        )


@dataclass(frozen=True, eq=False)
class Drive:
    """An excitation of a line of a machine whose directions turn.

    Attributes
    ----------
    line : float
        Frequency of the line, its sign that of the motion's e^{iωt} [rad/s].
    excitation : float
        Frequency ω_e > 0 of the excitation [rad/s].
    order : tuple of int
        Turns m of the line off it.
    forces : dict of str to list of Force
        Forces by mechanism.
    """

    line: float
    excitation: float
    order: Order
    forces: dict[str, list[Force]]

    def motions(self, model: TurningResponse) -> dict[str, dict[Order, ComplexArray]]:
        """Motions e^{i(ω_e + m·f)t} by mechanism and order m, shape (n,) each."""
        loads: list[Excitation] = []
        for forces in self.forces.values():
            loads.append((sum_by_order(force.by_order(model) for force in forces), {}))
        moved = model.respond(self.excitation, loads)
        return {
            mechanism: {order: motion[number] for order, motion in moved.items()}
            for number, mechanism in enumerate(self.forces)
        }


@dataclass(frozen=True, eq=False)
class LineMechanisms:
    """Loads that excite a machine about its mean load at a frequency, by mechanism.

    Attributes
    ----------
    machine : CoupledMachine
        Assembled about its operating point.
    """

    machine: CoupledMachine

    @cached_property
    def _base_rows(self) -> dict[str, FloatArray]:
        """Acceleration of each sensor by unit accelerations of the base, (6,): sensors show motion in space."""
        base, housing = self.machine.loads.base, self.machine.housing
        if base is None or housing is None:
            return {}
        return {name: base.row_at(at.position, at.direction) for name, at in housing.sensor_places.items()}

    @cached_property
    def model(self) -> MeshHarmonicModel:
        """Linear model about the mean load."""
        return MeshHarmonicModel(self.machine)

    def loads(
        self, frequency: float, within: float = 0.0, stiffness_forces: Mapping[int, StiffnessForce] | None = None
    ) -> list[tuple[float, dict[str, ComplexArray]]]:
        """Return the loads near a frequency, those of one frequency together.

        Parameters
        ----------
        frequency : float
            ω > 0 [rad/s].
        within : float
            Distance up to which an excitation is at the line [rad/s], at least a small part of ω.
        stiffness_forces : mapping of int to StiffnessForce, optional
            Forces by the stiffness that varies, by default those of the machine as it is.

        Returns
        -------
        list of (float, dict of str to ndarray of complex, shape (n,))
            Frequency of the excitation [rad/s], and f of each of its mechanisms with their phases at t = 0.
        """
        together: list[tuple[float, dict[str, ComplexArray]]] = []
        forces = self._stiffness_forces if stiffness_forces is None else stiffness_forces
        reach = max(within, _SAME_FREQUENCY_DIFFERENCE * frequency)
        for at, mechanism, force in self._sources(frequency, reach, forces):
            load = force.load
            if not np.any(load):
                continue
            place = next((known for w, known in together if _are_one(w, at)), None)
            if place is None:
                place = {}
                together.append((at, place))
            place[mechanism] = place.get(mechanism, 0.0) + load
        return together

    def motions(self, frequency: float, within: float = 0.0) -> list[tuple[float, dict[str, ComplexArray]]]:
        """Motions q by the mechanisms, shape (n,) each; frequencies and parameters as of `loads`."""
        if self.machine.system.turns:
            return self.turning_motions(self.turning, frequency, within)
        solved = []
        for at, loads in self.loads(frequency, within):
            moved = linalg.solve(self.model.dynamic_stiffness(at), np.stack([*loads.values()], axis=1)).T
            solved.append((at, dict(zip(loads, moved, strict=True))))
        return solved

    @cached_property
    def turning(self) -> TurningResponse:
        """Harmonic balance of a machine whose directions turn."""
        return self.model.turning.model

    @cached_property
    def _driven(self) -> dict[tuple[TurningResponse, float], dict[str, dict[Order, ComplexArray]]]:
        """Motions by a harmonic balance and an excitation: the sidebands of one mesh harmonic have the same."""
        return {}

    def _drives(self, model: TurningResponse, frequency: float, within: float) -> list[Drive]:
        """Return the excitations of a line of a machine whose directions turn; parameters as of `turning_motions`."""
        forces = self.model.turning_forces(model) if self.model.stiffness_varies else {}
        reach = max(within, _SAME_FREQUENCY_DIFFERENCE * frequency)
        found: list[Drive] = []
        for order in model.orders:
            for sense in (1.0, -1.0):
                excitation = sense * frequency - model.shift(order)
                if excitation <= reach:
                    continue
                for at, mechanism, force in self._sources(excitation, reach, forces):
                    if not np.any(force.load):
                        continue
                    one = next(
                        (drive for drive in found if drive.order == order and _are_one(drive.excitation, at)), None
                    )
                    if one is None:
                        one = Drive(at + model.shift(order), at, order, {})
                        found.append(one)
                    one.forces.setdefault(mechanism, []).append(force)
        return found

    def turning_motions(
        self, model: TurningResponse, frequency: float, within: float = 0.0
    ) -> list[tuple[float, dict[str, ComplexArray]]]:
        """Motions as of `motions`, by a harmonic balance of the machine, perhaps with other damping."""
        together: list[tuple[float, dict[str, ComplexArray]]] = []
        for drive in self._drives(model, frequency, within):
            at = abs(drive.line)
            place = next((known for w, known in together if _are_one(w, at)), None)
            if place is None:
                place = {}
                together.append((at, place))
            key = model, drive.excitation
            if key not in self._driven:
                self._driven[key] = drive.motions(model)
            for mechanism, by_order in self._driven[key].items():
                motion = by_order[drive.order]
                place[mechanism] = place.get(mechanism, 0.0) + (motion if drive.line > 0.0 else motion.conj())
        return together

    def parts(self, frequency: float, within: float = 0.0) -> dict[str, LineParts]:
        """Amplitudes of acceleration of each sensor's line by the mechanism, and that of their sum.

        Excitations of different frequencies, which the line does not resolve, add by their squares.

        Parameters
        ----------
        frequency, within : float
            As of `loads`.

        Returns
        -------
        dict of str to LineParts
            By sensor; nothing where nothing excites.
        """
        by_sensor: dict[str, list[dict[str, complex]]] = {name: [] for name in self.machine.sensor_rows}
        for at, motions in self.motions(frequency, within):
            for name, row in self.machine.sensor_rows.items():
                values = {mechanism: complex(-(at**2) * (row @ q)) for mechanism, q in motions.items()}
                if "base_motion" in values:
                    values["base_motion"] += self._of_base(name, at)
                by_sensor[name].append(values)
        return {name: LineParts.of(groups) for name, groups in by_sensor.items() if groups}

    def _of_base(self, sensor: str, frequency: float) -> complex:
        """Acceleration of the place of a sensor with a base that moves at a frequency [m/s²]."""
        base = self.machine.loads.base
        if base is None or sensor not in self._base_rows:
            return 0.0
        return complex(base.harmonic_amplitude(frequency) @ self._base_rows[sensor])

    def _sources(
        self, frequency: float, reach: float, forces: Mapping[int, StiffnessForce | TurningStiffnessForce]
    ) -> Iterator[tuple[float, str, Force]]:
        """Yield frequency [rad/s], mechanism and force of every excitation within a reach of a frequency."""
        for number in self.model.loaded:
            yield from self._of_contact(number, frequency, reach, forces.get(number))
        for number, contact in enumerate(self.machine.system.contacts):
            for at, force in self._runout(number, contact):
                if abs(at - frequency) <= reach:
                    yield at, "pitch_errors", force
        for harmonic in self.machine.system.harmonic_loads:
            at = abs(harmonic.frequency)
            # The friction of contacts is whole already.
            if at > 0.0 and abs(at - frequency) <= reach and harmonic.mechanism != "friction":
                # F = Re(a e^{iwt}) of a negative w is Re(conj(a) e^{i|w|t}).
                amplitude = harmonic.amplitude if harmonic.frequency > 0.0 else harmonic.amplitude.conj()
                yield at, harmonic.mechanism, Force(amplitude[:, None], np.ones(1, dtype=np.complex128))

    def _of_contact(
        self, number: int, frequency: float, reach: float, varying: StiffnessForce | TurningStiffnessForce | None
    ) -> Iterator[tuple[float, str, Force]]:
        """Yield what a loaded contact excites near a frequency by its phase."""
        contact, stiffness = self.machine.system.contacts[number], self.model.contact.stiffness[number]
        rate, periods = 2.0 * np.pi * abs(contact.mesh_frequency), contact.contact.hunting_period
        order = round(frequency / rate)
        alike, _ = self.model.alike[number]
        swings = periods == 1 and number in self.model.swinging_meshes
        if order > 0 and abs(order * rate - frequency) <= reach:
            for swung in self.model.error_forces((number, order)) if swings else ():
                if not any(swung.order):  # sidebands are among the loads of the system
                    yield order * rate, "transmission_error", swung
            error = contact.at_time_zero(polygon_phasors(alike.phases, alike.transmission_error, [order]), order)
            if not swings and abs(error[0]) > _TRANSMISSION_ERROR_ROUNDING * np.abs(alike.transmission_error).max():
                yield order * rate, "transmission_error", Force.along(contact, stiffness * error[0])
            for rubbed in self.model.friction_forces((number, order)):
                yield order * rate, "friction", rubbed
            if isinstance(varying, TurningStiffnessForce):
                for turns, force in varying.at(order).items():
                    yield order * rate, "varying_stiffness", Force.along(contact, force, turns)
        # The harmonics of the hunting period that the line does not resolve make it together.
        spacing = rate / periods
        cycles = np.arange(max(1, np.ceil((frequency - reach) / spacing)), np.floor((frequency + reach) / spacing) + 1)
        few = len(cycles) <= _UNRESOLVED_HARMONICS
        if isinstance(varying, StiffnessForce):
            orders, forces = varying.lines
            near = slice(*np.searchsorted(orders, [(frequency - reach) / rate, (frequency + reach) / rate]))
            orders, forces = orders[near], np.where(few | (orders[near] % 1.0 == 0.0), forces[near], 0.0)
            rounding = _TRANSMISSION_ERROR_ROUNDING * stiffness * np.abs(alike.transmission_error).max()
            least = max(rounding, _FAINT_HARMONIC * np.abs(forces).max(initial=0.0))
            for at, force in zip(orders.tolist(), forces.tolist(), strict=True):
                if abs(force) > least:
                    yield at * rate, "varying_stiffness", Force.along(contact, force)
        if periods == 1 or not few or not len(cycles):
            return
        largest, differences = self._differences[number]
        orders = cycles / periods
        errors = contact.at_time_zero(differences.amplitudes(cycles.astype(np.int64)), orders)
        rounding = _TRANSMISSION_ERROR_ROUNDING * largest
        least = max(rounding, _FAINT_HARMONIC * np.abs(errors).max())
        for at, error in zip(orders.tolist(), errors.tolist(), strict=True):
            if abs(error) > least:
                yield at * rate, "pitch_errors", Force.along(contact, stiffness * error)

    def _runout(self, number: int, contact: ContactConnector) -> Iterator[tuple[float, Force]]:
        """Yield frequency [rad/s] and force (k + iω c) e d of each harmonic of a contact's runout."""
        state = self.model.contact
        for amplitude, frequency, phase in contact.errors.tolist():
            at = abs(frequency)
            if at > 0.0 and amplitude != 0.0 and state.stiffness[number] > 0.0:
                error = amplitude * np.exp(1j * phase * np.sign(frequency))
                law = complex(state.stiffness[number], at * state.damping[number])
                yield at, Force.along(contact, law * error)

    def stiffness_forces(self, machine: DampedMachine) -> dict[int, StiffnessForce]:
        """Find the forces by the mesh stiffness that varies in a machine, by contact; none where it is the mean one."""
        return self.model.stiffness_forces(self._varying_meshes, machine) if self._varying_meshes else {}

    @cached_property
    def _stiffness_forces(self) -> dict[int, StiffnessForce]:
        """Those in the machine as it is."""
        return self.stiffness_forces(self.model.damped)

    @cached_property
    def _varying_meshes(self) -> list[VaryingMesh]:
        return self.model.varying_meshes() if self.model.stiffness_varies else []

    @cached_property
    def _differences(self) -> dict[int, tuple[float, HuntingCurve]]:
        """Transmission error over the hunting period less that of teeth alike, after its largest value [m]."""
        found = {}
        for number in self.model.loaded:
            law, force = self.machine.system.contacts[number].contact, self._force[number]
            if (periods := law.hunting_period) > 1:
                phases, error = (every := hunting_period_mesh(law, force)).phases, every.transmission_error
                alike = loaded_transmission_error(law.teeth_alike, force, phases[: phases.size // periods])
                more = error - np.tile(alike.transmission_error, periods)
                found[number] = float(np.abs(error).max()), HuntingCurve.through(phases, more, periods)
        return found

    @property
    def _force(self) -> list[float]:
        """Mean force of every contact [N]."""
        force = self.model.contact.force
        assert force is not None
        return [float(value) for value in force]


def _are_one(first: float, second: float) -> bool:
    """Whether two frequencies are one but for rounding."""
    return abs(first - second) <= _SAME_FREQUENCY_DIFFERENCE * abs(second)
