"""Mesh harmonics: response of a machine about its operating point to its loaded meshes.

About the operating point a mesh under its mean force F acts as its mean mesh stiffness k and damping c, driven by its
loaded transmission error e(t), by the moments of its shuttling load and by the friction of its teeth. Its stiffness κ
varies with the phase, which adds the force -g of :mod:`gearwhine.coupling.linear.parametric_stiffness`. At a mesh
harmonic ω the motion q of the machine is

    Z q = f,      Z = K + iωC - ω² I,      f = Σ (k e - g) d + moments of shuttling + friction,

K and C with the tangents of bearings and meshes, d the directions of the meshes. All excitations of a mesh are periodic
with it, and their phases are those of one mesh period: at a harmonic they add as complex numbers, and one may be far
above another at a sensor. A transmissibility by transmission error alone misses the others.

Where directions turn with planet carriers, the force k e acts along d(t) and the moments turn with the mesh, and the
motion has lines at ω + m f_c (:mod:`gearwhine.coupling.linear.carriers.carrier_sidebands`), each a response of its own
here. So has g (:mod:`gearwhine.coupling.linear.carriers.turning_stiffness`).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears.loaded.transmission_error import (
    LoadedMesh,
    hunting_period_mesh,
    loaded_transmission_error,
    mesh_period_phases,
    polygon_phasors,
    transmission_error_phasors,
)
from gearwhine.coupling.linear.carriers.carrier_sidebands import CarrierSidebands, Sideband
from gearwhine.coupling.linear.carriers.turning_response import Order, TurningResponse
from gearwhine.coupling.linear.carriers.turning_stiffness import (
    SwingingMesh,
    TurningStiffnessForce,
    by_order,
    swings_at_rest,
    turning_stiffness_forces,
)
from gearwhine.coupling.linear.excitation_orders import meshes_of_planets
from gearwhine.coupling.linear.parametric_stiffness import LEAST_REACH, Cause, VaryingMesh, varying_mesh
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, StiffnessForce, stiffness_forces
from gearwhine.coupling.machine.connectors import ContactConnector, TurningPart
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.machine.mesh_face import MeshFace
from gearwhine.coupling.machine.tooth_friction import alike_teeth
from gearwhine.coupling.statics.flank_swing import (
    LawsOverTurn,
    forces_over_turn,
    swinging_laws,
    swinging_shuttling,
    turn_waves,
)
from gearwhine.coupling.statics.mean_mesh import (
    ContactState,
    MeanMesh,
    equilibrium_over_turn,
    linear_matrices,
    mean_contact,
)
from gearwhine.numerics.arrays import ComplexArray, FloatArray

IntArray = npt.NDArray[np.int_]

HARMONICS = 12
"""Largest number of harmonics of a mesh."""
_POINTS = 200  # number of phases of a mesh period, as in the mean mesh
_SAME_FREQUENCY_DIFFERENCE = 1e-9  # relative difference below which frequencies are equal
_FAINT_SIDEBAND = 1e-4  # part of the largest motion by its meshes one by one below which a sideband is left out


@dataclass(frozen=True, eq=False)
class Response:
    """Motion of the machine at a mesh harmonic, or at a sideband of one.

    Attributes
    ----------
    frequency : float
        Circular frequency ω of the motion [rad/s].
    causes : tuple of (int, int)
        For each mesh that drives the motion, number of its contact in the system and harmonic of its mesh frequency.
    motion : ndarray of complex, shape (n,)
        Motion q by the coordinates of the system.
    sidebands : tuple of Sideband
        Place of the motion beside the mesh harmonic of each cause; empty of a machine whose directions stand still.
    phasing : float
        Size of the housing's motion over the sum of its sizes by the meshes of each planet alone: 1 where planets add,
        0 where they cancel. 1 of a machine whose directions stand still.
    """

    frequency: float
    causes: tuple[Cause, ...]
    motion: ComplexArray
    sidebands: tuple[Sideband, ...] = field(default=(), kw_only=True)
    phasing: float = field(default=1.0, kw_only=True)

    @property
    def kind(self) -> str:
        """Kind of the line: ``mesh harmonic``, ``planet pass`` or ``sideband``."""
        kinds = [one.kind for one in self.sidebands]
        return next((kind for kind in ("mesh harmonic", "planet pass") if kind in kinds or not kinds), "sideband")

    @property
    def harmonic(self) -> int | None:
        """Mesh harmonic of all causes; None where they differ."""
        harmonics = {harmonic for _, harmonic in self.causes}
        return harmonics.pop() if len(harmonics) == 1 else None

    @property
    def turns(self) -> dict[str, float] | None:
        """Turns of carriers by which the line is off the harmonics of all causes; None where they differ."""
        places = {one.turns for one in self.sidebands}
        return dict(places.pop()) if len(places) == 1 else None

    @property
    def ideal_phasing(self) -> float | None:
        """The phasing, were all planets of a carrier equal: 1 where they add, 0 where they cancel.

        None where neither follows from their angles and teeth alone; of several causes, 0 where all have it.
        """
        ideals = [one.ideal for one in self.sidebands]
        if not ideals or None in ideals:
            return None
        return max(ideal for ideal in ideals if ideal is not None)

    @property
    def is_suppressed(self) -> bool:
        """Whether equal planets would cancel each other: what the line has is of differences between planets."""
        return self.ideal_phasing == 0.0

    def cause(self, machine: CoupledMachine) -> str:
        """Return the mesh harmonics that drive the line in words, with the turns of carriers that it is off them."""
        return " and ".join(causes_in_words(machine, self.causes, self.sidebands))


def causes_in_words(
    machine: CoupledMachine, causes: Sequence[Cause], sidebands: Sequence[Sideband] = (), *, of_flanks: bool = True
) -> list[str]:
    """Return each mesh harmonic of a line in words, with the turns of carriers that the line is off it.

    Meshes of the planets of one carrier that have one harmonic are told together. Those of the fewest turns come first.

    Parameters
    ----------
    machine : CoupledMachine
    causes : sequence of (int, int)
        As of a `Response`.
    sidebands : sequence of Sideband
        As of a `Response`.
    of_flanks : bool
        Whether meshes have the names of the contacts, which say which flanks touch, or of the gears alone.
    """
    together: dict[tuple[int, str | None, str], list[str]] = {}
    rows = zip(causes, sidebands or [Sideband()] * len(causes), strict=True)
    for (number, harmonic), sideband in sorted(rows, key=lambda row: sum(abs(turns) for _, turns in row[1].turns)):
        mesh = machine.meshes[machine.flanks(number)[0]]
        name = machine.system.contacts[number].name if of_flanks else mesh.name
        together.setdefault((harmonic, mesh.carrier, sideband.words), []).append(name)
    words = []
    for (harmonic, carrier, off), names in together.items():
        meshes = names if carrier is None or len(names) == 1 else [meshes_of_planets(machine, carrier)]
        words += [f"{harmonic}× {name}{off}" for name in meshes]
    return words


@dataclass(frozen=True, eq=False)
class Force:
    """A harmonic force: its directions, which may turn, and its amplitudes along them.

    Attributes
    ----------
    directions : ndarray, shape (n, d)
        Directions D(0).
    amplitudes : ndarray of complex, shape (d,)
    turning : tuple of TurningPart
        Parts of the directions that turn.
    order : tuple of int
        Turns of carriers by which the force is off the frequency of what excites it; none by default.
    """

    directions: FloatArray | ComplexArray
    amplitudes: ComplexArray
    turning: tuple[TurningPart, ...] = ()
    order: Order = ()

    @classmethod
    def along(cls, contact: ContactConnector, amplitude: complex, order: Order = ()) -> "Force":
        """Force along the line of action of a contact."""
        return cls(contact.direction[:, None], np.array([amplitude], dtype=np.complex128), contact.turning, order)

    @property
    def load(self) -> ComplexArray:
        """Load on the coordinates with the directions as they stand at t = 0, shape (n,)."""
        return np.asarray(self.directions @ self.amplitudes)

    def by_order(self, model: TurningResponse) -> dict[Order, ComplexArray]:
        """Split the force into loads on the coordinates by the order of their frequency, shape (n,) each."""
        loads = {model.still: self.load}
        if self.turning:
            parts = model.directions_by_order(self.directions.real, self.turning)
            loads = {order: np.asarray(directions @ self.amplitudes) for order, directions in parts.items()}
        return model.at_order(loads, self.order) if self.order else loads


@dataclass(frozen=True, eq=False)
class ResponseParts(Response):
    """Motion of the machine at a mesh harmonic, and its parts.

    Attributes
    ----------
    parts : mapping of str to ndarray of complex, shape (n,)
        Motions by the mechanisms of the meshes that drive it, q their sum: by ``transmission_error``,
        ``load_shuttling``, ``friction`` where teeth have any, and ``varying_stiffness`` where it is known.
    """

    parts: Mapping[str, ComplexArray]


@dataclass(frozen=True, eq=False)
class MeshLoad:
    """Load on the machine at a mesh harmonic, by all meshes that drive it.

    Attributes
    ----------
    frequency : float
        Circular frequency ω [rad/s].
    causes : tuple of (int, int)
        As of a `Response`.
    load : ndarray of complex, shape (n,)
        Load f on the coordinates of the system.
    """

    frequency: float
    causes: tuple[Cause, ...]
    load: ComplexArray


@dataclass(frozen=True, eq=False)
class MeshHarmonicModel:
    """A machine linear about its mean load, driven by its loaded meshes.

    Attributes
    ----------
    machine : CoupledMachine
        Assembled about its operating point.
    stiffness_varies : bool
        Whether the stiffness of meshes varies with the phase; otherwise it is the mean one.
    """

    machine: CoupledMachine
    stiffness_varies: bool = field(default=True, kw_only=True)

    def frozen(self, time: float) -> "MeshHarmonicModel":
        """Model of the machine whose directions stand as they do at a nominal time [s], with the same loaded meshes."""
        still = replace(self, machine=replace(self.machine, system=self.machine.system.standing(time)))
        still.__dict__.update({name: getattr(self, name) for name in ("contact", "meshes", "alike")})
        return still

    @cached_property
    def contact(self) -> ContactState:
        """Contacts about their mean forces."""
        return mean_contact(self.machine.system, self._at_rest[0])

    @cached_property
    def _at_rest(self) -> tuple[list[MeanMesh | None], FloatArray]:
        """Mean meshes and motion under the constant load, see `equilibrium_over_turn`."""
        return equilibrium_over_turn(self.machine.system)

    @cached_property
    def loaded(self) -> tuple[int, ...]:
        """Numbers of the contacts that carry a mean force and turn."""
        force = self.contact.force
        contacts = self.machine.system.contacts
        return tuple(
            n
            for n, contact in enumerate(contacts)
            if force is not None and force[n] > 0.0 and contact.mesh_frequency != 0.0
        )

    def loads(self, limit: float) -> tuple[MeshLoad, ...]:
        """Return the loads of the mesh harmonics up to a limit [rad/s], ascending, with frozen directions.

        They are those on the machine with the mean mesh stiffness, f without g.
        """
        return tuple(MeshLoad(w, causes, sum_of(self._mean_loads(causes))) for w, causes in self._harmonics(limit))

    def responses(self, limit: float) -> tuple[Response, ...]:
        """Solve the motions at the mesh harmonics, and their sidebands, up to a limit [rad/s], ascending."""
        return self.parts(limit) if self.machine.system.turns else self.frozen_responses(limit)

    def frozen_responses(self, limit: float) -> tuple[Response, ...]:
        """Solve the motions of `responses` with directions that turn frozen as they stand at t = 0."""
        return tuple(
            Response(w, causes, linalg.solve(self._dynamic(w), sum_of(self._loads(causes))))
            for w, causes in self._harmonics(limit)
        )

    def parts(self, limit: float) -> tuple[ResponseParts, ...]:
        """Solve the motions of `responses` with their parts by mechanism."""
        if self.machine.system.turns:
            return self._turning_parts(limit)
        parts = []
        for w, causes in self._harmonics(limit):
            loads = self._loads(causes)
            moved = linalg.solve(self._dynamic(w), np.stack([*loads.values()], axis=1)).T
            parts.append(ResponseParts(w, causes, moved.sum(axis=0), dict(zip(loads, moved, strict=True))))
        return tuple(parts)

    def _turning_parts(self, limit: float) -> tuple[ResponseParts, ...]:
        """Solve the motions at mesh harmonics and their sidebands of a machine whose directions turn."""
        lines: list[ResponseParts] = []
        # A sideband below the limit may belong to a harmonic above it.
        reach = max((abs(self.turning.model.shift(order)) for order in self.turning.model.orders), default=0.0)
        for w, causes in self._harmonics(limit + reach):
            lines += [line for line in self._sidebands(w, causes) if 0.0 < line.frequency <= limit]
        return tuple(_merged(sorted(lines, key=lambda line: line.frequency)))

    def _sidebands(self, w: float, causes: tuple[Cause, ...]) -> list[ResponseParts]:
        """Solve the motions at a mesh harmonic [rad/s] and its sidebands."""
        turning, seen = self.turning, self._housing_coordinates
        by_cause = [self._turning_loads(w, cause) for cause in causes]
        mechanisms = [*by_cause[0]]
        solved = turning.respond(w, [loads[mechanism] for mechanism in mechanisms for loads in by_cause])
        # By mechanism and cause.
        motion = {order: q.reshape(len(mechanisms), len(causes), -1) for order, q in solved.items()}
        sizes = {order: np.linalg.norm(q.sum(axis=0)[:, seen], axis=1).sum() for order, q in motion.items()}
        lines = []
        for order, q in motion.items():
            if sizes[order] <= _FAINT_SIDEBAND * max(sizes.values()):
                continue
            at = w + turning.model.shift(order)
            # A motion Re(q e^{iωt}) of a negative ω is Re(conj(q) e^{i|ω|t}).
            moved = q if at > 0.0 else q.conj()
            lines.append(
                ResponseParts(
                    abs(at),
                    causes,
                    moved.sum(axis=(0, 1)),
                    dict(zip(mechanisms, moved.sum(axis=1), strict=True)),
                    sidebands=tuple(turning.sideband(order, cause) for cause in causes),
                    phasing=turning.planets.solved([number for number, _ in causes], q.sum(axis=0)[:, seen]),
                )
            )
        return lines

    def moved_to(self, line: Response, frequencies: FloatArray) -> ComplexArray:
        """Motions (f, n) of a line of a machine whose directions turn, were it at other frequencies [rad/s].

        The excitation is as far off the line as it is, and its loads are the same; the carriers turn at their speeds.
        """
        model = self.turning.model
        moved = np.zeros((len(frequencies), self.machine.system.size), dtype=np.complex128)
        together: dict[float, list[Cause]] = {}
        for number, harmonic in line.causes:
            rate = abs(self.machine.system.contacts[number].mesh_frequency)
            together.setdefault(round(2.0 * np.pi * harmonic * rate, 6), []).append((number, harmonic))
        for w, causes in together.items():
            loads = [load for cause in dict.fromkeys(causes) for load in self._turning_loads(w, cause).values()]
            for sense in (1.0, -1.0):
                order = model.order_of(sense * line.frequency - w)
                if order is None:
                    continue
                for place, at in enumerate(frequencies.tolist()):
                    excitation = sense * at - model.shift(order)
                    if excitation > 0.0:
                        motion = model.respond(excitation, [(load, {}) for load in loads], [order])[order].sum(axis=0)
                        moved[place] += motion if sense > 0.0 else motion.conj()
        return moved

    @cached_property
    def turning(self) -> CarrierSidebands:
        """Sidebands of the machine, whose directions turn."""
        return CarrierSidebands(self.machine, self.contact)

    @property
    def _housing_coordinates(self) -> npt.NDArray[np.bool_]:
        """Mask of the coordinates of the housing; of all coordinates without one, shape (n,)."""
        machine = self.machine
        if machine.housing is None:
            return np.ones(machine.system.size, dtype=np.bool_)
        return np.asarray(np.any(machine.rows(machine.housing.name, np.eye(machine.housing.size)) != 0.0, axis=0))

    def _mean_turning_loads(self, w: float, cause: Cause) -> dict[str, dict[Order, ComplexArray]]:
        """Return the loads of a cause at ω on the machine with the mean mesh stiffness, by mechanism and order."""
        number, harmonic = cause
        model, frame = self.turning.model, self.turning.frame_of_contact(number)
        moments = [
            self.turning.by_order(w, load, frame)
            for load in self._shuttling_over_turn[number]
            if round(load.frequency / (w / harmonic)) == harmonic
        ]
        loads = {
            "transmission_error": sum_by_order(force.by_order(model) for force in self.error_forces(cause)),
            "load_shuttling": sum_by_order(moments),
        }
        if self._has_friction:
            loads["friction"] = sum_by_order(force.by_order(model) for force in self.friction_forces(cause))
        return loads

    def error_forces(self, cause: Cause) -> list[Force]:
        """Return the forces k e along a contact at a mesh harmonic, and at its sidebands where flanks swing."""
        number, harmonic = cause
        contact, stiffness = self.machine.system.contacts[number], self.contact.stiffness[number]
        if number not in self.swinging_meshes:
            return [Force.along(contact, stiffness * self._errors[number][harmonic - 1])]
        if harmonic > LEAST_REACH:
            return []
        errors = self.swinging_meshes[number].errors
        return [
            Force.along(contact, 2.0 * stiffness * complex(error[LEAST_REACH + harmonic]), order)
            for order, error in errors.items()
        ]

    @cached_property
    def _laws_over_turn(self) -> LawsOverTurn:
        """Laws and forces of the loaded contacts whose flanks swing as the carriers turn."""
        found = swinging_laws(self.machine.system, self._at_rest)
        return {number: laws for number, laws in found.items() if number in self.loaded}

    @cached_property
    def swinging_meshes(self) -> dict[int, SwingingMesh]:
        """Loaded contacts whose flanks swing as the carriers turn."""
        waves, found = by_order(turn_waves(self.machine.system), self.turning.model), dict[int, SwingingMesh]()
        for number, laws in self._laws_over_turn.items():
            contact, stiffness = self.machine.system.contacts[number], float(self.contact.stiffness[number])
            force = self._force(number)
            under = [
                varying_mesh(number, replace(contact, contact=law), stiffness, mesh_under(law, force), between=False)
                for law, _ in laws
            ]
            errors, varying = (np.array([getattr(one, name)[0] for one in under]) for name in ("error", "stiffness"))
            by_turns, stiffness_by_turns = (
                {order: wave @ one for order, wave in waves.items()} for one in (errors, varying)
            )
            if contact.contact.hunting_period > 1:
                # The mean over a turn has what differs between teeth, of which sidebands are left out.
                mean = varying_mesh(number, contact, stiffness, self.meshes[number], between=False)
                still = self.turning.model.still
                by_turns[still], stiffness_by_turns[still] = mean.error[0], mean.stiffness[0]
            found[number] = SwingingMesh(by_turns, stiffness_by_turns)
        return found

    @cached_property
    def _shuttling_over_turn(self) -> dict[int, list[HarmonicLoad]]:
        """Moments of every loaded contact at mesh harmonics, and at their sidebands where its flanks swing."""
        contacts, waves = self.machine.system.contacts, turn_waves(self.machine.system)
        found = dict[int, list[HarmonicLoad]]()
        for number, by_harmonic in self._shuttling.items():
            rate = 2.0 * np.pi * abs(contacts[number].mesh_frequency)
            found[number] = [HarmonicLoad(harmonic * rate, moment) for harmonic, moment in by_harmonic.items()]
            if number in self._laws_over_turn:
                face = self.machine.face(number, contacts[number].contact)
                found[number] = swinging_shuttling(face, contacts[number], self._laws_over_turn[number], waves)
        return found

    def _turning_loads(self, w: float, cause: Cause) -> dict[str, dict[Order, ComplexArray]]:
        """Return the loads of a cause at ω by mechanism and order; every cause has the same mechanisms."""
        (number, harmonic), model = cause, self.turning.model
        loads = self._mean_turning_loads(w, cause)
        if not self.stiffness_varies:
            return loads
        contact, varying = self.machine.system.contacts[number], list[Mapping[Order, ComplexArray]]()
        for order, amplitude in self.turning_forces(model)[number].at(harmonic).items():
            varying.append(Force.along(contact, amplitude, order).by_order(model))
        return {**loads, "varying_stiffness": sum_by_order(varying)}

    def turning_forces(self, model: TurningResponse) -> dict[int, TurningStiffnessForce]:
        """Solve the forces by the mesh stiffness that varies of a machine whose directions turn, by contact.

        The machine has the directions of this one, and perhaps other damping.
        """
        if model in self._turning_forces:
            return self._turning_forces[model]
        groups = dict[float, list[VaryingMesh]]()
        for mesh in self.varying_harmonics.values():
            groups.setdefault(round(mesh.rate, 6), []).append(mesh)

        def loads(meshes: Sequence[VaryingMesh], harmonic: int) -> dict[Order, ComplexArray]:
            mean = [self._mean_turning_loads(harmonic * mesh.rate, (mesh.number, harmonic)) for mesh in meshes]
            return sum_by_order(load for by_mechanism in mean for load in by_mechanism.values())

        found = dict[int, TurningStiffnessForce]()
        swings = swings_at_rest(self.machine.system, *self._at_rest, model)
        for meshes in groups.values():
            found |= turning_stiffness_forces(meshes, model, partial(loads, meshes), swings, self.swinging_meshes)
        self._turning_forces[model] = found
        return found

    @cached_property
    def _turning_forces(self) -> dict[TurningResponse, dict[int, TurningStiffnessForce]]:
        return {}

    def dynamic_stiffness(self, frequency: float) -> ComplexArray:
        """Z at a frequency [rad/s], shape (n, n), with directions that turn as they stand at t = 0."""
        return self._dynamic(frequency)

    def transmission_error(
        self, number: int, mesh: LoadedMesh, *, hunting_period: int, count: int = HARMONICS
    ) -> ComplexArray:
        """Harmonics of a loaded mesh's transmission error at t = 0 [m], shape (count,).

        Parameters
        ----------
        number : int
            Number of the contact in the system, which gives the phase and the mesh frequency.
        mesh : LoadedMesh
            Loaded mesh of the flanks of this contact, or of flanks in their place.
        hunting_period : int
            Number of mesh periods that the phases of ``mesh`` cover.
        count : int
        """
        phasors = transmission_error_phasors(mesh, count, hunting_period)
        return self.machine.system.contacts[number].at_time_zero(phasors, np.arange(1, count + 1))

    def shuttling_loads(self, number: int, face: MeshFace, force: float) -> dict[int, ComplexArray]:
        """Moments of load shuttling by harmonic, of the flanks of a face under a force [N], shape (n,) each."""
        standing = self.machine.system.contacts[number]
        loads = face.shuttling(force, standing.phase, standing.mesh_frequency)[1]
        return {load.harmonic_of(standing.mesh_frequency): load.amplitude for load in loads}

    def _dynamic(self, w: float) -> ComplexArray:
        stiffness, damping = self._matrices
        return np.asarray(stiffness + 1j * w * damping - w**2 * np.eye(len(stiffness)))

    @cached_property
    def _matrices(self) -> tuple[FloatArray, FloatArray]:
        return linear_matrices(self.machine.system, self.contact)

    def _harmonics(self, limit: float) -> list[tuple[float, tuple[Cause, ...]]]:
        """Frequencies of the mesh harmonics up to a limit [rad/s], ascending, and the meshes that drive each."""
        harmonics: list[tuple[float, tuple[Cause, ...]]] = []
        every = [
            (2.0 * np.pi * h * abs(self.machine.system.contacts[n].mesh_frequency), (n, h))
            for n in self.loaded
            for h in range(1, HARMONICS + 1)
        ]
        for w, cause in sorted(every):
            if w > limit * (1.0 + _SAME_FREQUENCY_DIFFERENCE):
                break
            if harmonics and w <= harmonics[-1][0] * (1.0 + _SAME_FREQUENCY_DIFFERENCE):
                harmonics[-1] = (harmonics[-1][0], (*harmonics[-1][1], cause))
            else:
                harmonics.append((w, (cause,)))
        return harmonics

    def _loads(self, causes: Sequence[Cause]) -> dict[str, ComplexArray]:
        """Return f by the mechanisms of the meshes alone: torque ripple of a mesh's frequency has no part in it."""
        loads = self._mean_loads(causes)
        if self.varying_harmonics:
            loads["varying_stiffness"] = self._stiffness_load(causes, self._stiffness_forces)
        return loads

    def _stiffness_load(self, causes: Sequence[Cause], forces: Mapping[int, StiffnessForce]) -> ComplexArray:
        """Return -Σ g d of meshes by their stiffness that varies, shape (n,)."""
        directions = np.array([self.machine.system.contacts[number].direction for number, _ in causes])
        return np.asarray([forces[number].harmonic(harmonic) for number, harmonic in causes] @ directions)

    def _mean_loads(self, causes: Sequence[Cause]) -> dict[str, ComplexArray]:
        """Return Σ k e d, the moments of load shuttling, and friction where teeth have any, shape (n,) each."""
        contacts, size = self.machine.system.contacts, self.machine.system.size
        loads = {name: np.zeros(size, dtype=np.complex128) for name in ("transmission_error", "load_shuttling")}
        if self._has_friction:
            loads["friction"] = np.zeros(size, dtype=np.complex128)
        for number, harmonic in causes:
            force = self.contact.stiffness[number] * self._errors[number][harmonic - 1]
            loads["transmission_error"] += force * contacts[number].direction
            loads["load_shuttling"] += self._shuttling[number].get(harmonic, 0.0)
            if (rubbed := self.friction((number, harmonic))) is not None:
                loads["friction"] += rubbed.load
        return loads

    @property
    def _has_friction(self) -> bool:
        return any(self.machine.system.contacts[number].sliding is not None for number in self.loaded)

    def friction(self, cause: Cause) -> Force | None:
        """Friction of a contact's teeth at a mesh harmonic under its mean force; None without friction."""
        number, harmonic = cause
        return friction_force(self.machine.system.contacts[number], *self.alike[number], harmonic)

    def friction_forces(self, cause: Cause) -> list[Force]:
        """Friction of a contact's teeth at a mesh harmonic, and at its sidebands as the load swings over a turn."""
        number, harmonic = cause
        contact, by_angle = self.machine.system.contacts[number], self._friction_over_turn.get(number)
        if by_angle is None:
            rubbed = self.friction(cause)
            return [] if rubbed is None else [rubbed]
        forces = [friction_force(contact, *alike, harmonic) for alike in by_angle]
        amplitudes = np.array([force.amplitudes for force in forces if force is not None])
        return [
            Force(contact.sliding.directions, wave @ amplitudes, contact.sliding.turning, order)
            for order, wave in by_order(turn_waves(self.machine.system), self.turning.model).items()
            if contact.sliding is not None
        ]

    @cached_property
    def _friction_over_turn(self) -> dict[int, list[tuple[LoadedMesh, FloatArray | None]]]:
        """As `alike`, at the load and the gap of each angle of a turn, of contacts with friction whose load swings."""
        if not (self.machine.system.turns and self._has_friction):
            return {}
        contacts, found = self.machine.system.contacts, dict[int, list[tuple[LoadedMesh, FloatArray | None]]]()
        for number, forces in forces_over_turn(self.machine.system, self._at_rest).items():
            contact = contacts[number]
            if number not in self.loaded or contact.sliding is None or not np.all(forces > 0.0):
                continue
            laws = self._laws_over_turn.get(number)
            gaps = [contact] * len(forces) if laws is None else [contact.with_law(law) for law, _ in laws]
            found[number] = [alike_teeth(gap, force) for gap, force in zip(gaps, forces.tolist(), strict=True)]
        return found

    @cached_property
    def alike(self) -> dict[int, tuple[LoadedMesh, FloatArray | None]]:
        """Mesh of every loaded contact over a period with all teeth alike, and its friction, as of `alike_teeth`."""
        return {
            number: alike_teeth(self.machine.system.contacts[number], self._force(number)) for number in self.loaded
        }

    def varying_meshes(self, limit: float = 0.0, *, between: bool = True) -> list[VaryingMesh]:
        """Return the loaded meshes with the orders that count up to a limit [rad/s], `LEAST_REACH` harmonics at least.

        Parameters
        ----------
        limit : float
        between : bool
            Whether orders between the mesh harmonics are wanted.
        """
        contacts, stiffness = self.machine.system.contacts, self.contact.stiffness
        return [
            varying_mesh(number, contacts[number], float(stiffness[number]), mesh, limit, between=between)
            for number, mesh in self.meshes.items()
        ]

    def stiffness_forces(
        self, meshes: Sequence[VaryingMesh], machine: DampedMachine | None = None
    ) -> dict[int, StiffnessForce]:
        """Force -g of meshes along their lines of action, by the number of the contact.

        Parameters
        ----------
        meshes : sequence of VaryingMesh
        machine : DampedMachine, optional
            Machine with the mean mesh stiffness, by default the model's.
        """
        machine, numbers = machine or self.damped, {mesh.number for mesh in meshes}
        motions = {
            cause: machine.motion(w, sum_of(self._mean_loads(causes)))
            for w, causes in self._harmonics(np.inf)
            for cause in causes
            if cause[0] in numbers
        }
        directions = self.machine.system.contact_directions
        return stiffness_forces(meshes, self.contact, directions, machine, motions)

    @cached_property
    def damped(self) -> DampedMachine:
        """The machine with the mean mesh stiffness."""
        return DampedMachine(*self._matrices)

    @cached_property
    def varying_harmonics(self) -> dict[int, VaryingMesh]:
        """Loaded meshes with their mesh harmonics, by contact; none where the stiffness is the mean one."""
        meshes = self.varying_meshes(between=False) if self.stiffness_varies else []
        return {mesh.number: mesh for mesh in meshes}

    @cached_property
    def _stiffness_forces(self) -> dict[int, StiffnessForce]:
        """As `stiffness_forces`, of the mesh harmonics alone."""
        return self.stiffness_forces([*self.varying_harmonics.values()])

    def _force(self, number: int) -> float:
        """Mean force of a contact [N]."""
        assert self.contact.force is not None
        return float(self.contact.force[number])

    @cached_property
    def _errors(self) -> dict[int, ComplexArray]:
        """Return e of every loaded contact by harmonic."""
        return {n: self._error(n, self.meshes[n], LEAST_REACH) for n in self.loaded}

    @cached_property
    def meshes(self) -> dict[int, LoadedMesh]:
        """Mesh of every loaded contact under its mean force, over the mesh periods that differ."""
        return {n: mesh_under(self.machine.system.contacts[n].contact, self._force(n)) for n in self.loaded}

    @cached_property
    def _shuttling(self) -> dict[int, dict[int, ComplexArray]]:
        """Return the moments of every loaded contact by harmonic."""
        machine, found = self.machine, dict[int, dict[int, ComplexArray]]()
        for n in self.loaded:
            known = None if machine.mean_faces is None else machine.mean_faces.moments_under(n, self._force(n))
            if known is None:
                face = machine.face(n, machine.system.contacts[n].contact)
                known = self.shuttling_loads(n, face, self._force(n))
            found[n] = known
        return found

    def _error(self, number: int, mesh: LoadedMesh, count: int = HARMONICS) -> ComplexArray:
        """Harmonics of the transmission error of a contact at t = 0 [m], shape (count,)."""
        period = self.machine.system.contacts[number].contact.hunting_period
        return self.transmission_error(number, mesh, hunting_period=period, count=count)


def _merged(lines: Sequence[ResponseParts]) -> list[ResponseParts]:
    """Add lines of one frequency, in ascending order; the phasing of the sum is that of the larger one."""
    merged: list[ResponseParts] = []
    for line in lines:
        if not merged or line.frequency > merged[-1].frequency * (1.0 + _SAME_FREQUENCY_DIFFERENCE):
            merged.append(line)
            continue
        last = merged[-1]
        larger = last if np.linalg.norm(last.motion) >= np.linalg.norm(line.motion) else line
        merged[-1] = ResponseParts(
            last.frequency,
            (*last.causes, *line.causes),
            last.motion + line.motion,
            {mechanism: motion + line.parts[mechanism] for mechanism, motion in last.parts.items()},
            sidebands=(*last.sidebands, *line.sidebands),
            phasing=larger.phasing,
        )
    return merged


def mesh_under(law: ToothContact, force: float, points: int = _POINTS) -> LoadedMesh:
    """Mesh of a contact law under a force [N], over the mesh periods that differ."""
    if law.hunting_period > 1:
        return hunting_period_mesh(law, force)
    return loaded_transmission_error(law, force, mesh_period_phases(law, points))


def sum_of(loads: Mapping[str, ComplexArray]) -> ComplexArray:
    """Sum of loads or motions by mechanism, shape (n,)."""
    return np.asarray(np.sum([*loads.values()], axis=0))


def sum_by_order(loads: Iterable[Mapping[Order, ComplexArray]]) -> dict[Order, ComplexArray]:
    """Sum of loads on the coordinates by the order of their frequency."""
    total = dict[Order, ComplexArray]()
    for some in loads:
        for order, load in some.items():
            total[order] = total[order] + load if order in total else load
    return total


def friction_force(
    contact: ContactConnector, mesh: LoadedMesh, friction: FloatArray | None, harmonic: int
) -> Force | None:
    """Friction of a contact's teeth at a mesh harmonic, its mesh and friction those of `alike_teeth`; None without."""
    if friction is None or contact.sliding is None:
        return None
    shares = contact.at_time_zero(polygon_phasors(mesh.phases, friction, [harmonic]), harmonic)
    return Force(contact.sliding.directions, -shares[:, 0], contact.sliding.turning)
