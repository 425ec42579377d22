r"""Superposition of periodic motions: steady state for excitations without a short common period.

Meshes of a train, and shafts with unbalance or runout, drive the machine at frequencies whose common period is that of
hunting teeth: thousands of mesh periods, or none. The motion is then a function of several independent phases. To the
first order of averaging it is the sum

    q(t) = q0 + sum_g (q_g(t) - q0)

of motions that repeat with one group of excitations g each. In the motion of a group its own meshes keep their whole
law, contact loss included; every other mesh h is linear about its mean load,

    F_h = F0_h + k_h (delta_h - delta0_h) + c_h delta_h',

with the mean F0 and k of :mod:`gearwhine.coupling.statics.mean_mesh`; q0 is the rest position of the machine with all
meshes so. A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations, Wiley 1979, chapters 2 and 5.

The sum satisfies every linear part of the equations of motion exactly. What it leaves is a force in each mesh,

    r_h = F_h(phase_h, delta_h, delta_h') - [F_h of its own group + sum of the others' parts],

the law at the superposed motion less the forces that were assumed. It is evaluated over all phases, and is the measure
of what is neglected: combination lines at sums and differences of the groups' frequencies.

A mesh whose gears both have teeth that differ repeats after their hunting period alone, lcm(z1, z2) mesh cycles. To the
first order in what differs its motion is

    q(t) = q_1(t) + q_2(t) - q_a(t),

the motions with the differences of the pinion's teeth alone (z1 mesh cycles), of the wheel's alone (z2), and of neither
(their greatest common divisor, mostly one cycle), each with the whole law. In meshes that share their frequency each
period of K gears is a motion of its own, and q_a counts 1 - K times. The sum leaves the same force r_h as others, here
of the second order: lines at k1/z1 + k2/z2 of the mesh frequency, by teeth of both gears together.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.errors import CouplingError, PeriodicError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.base_motion import BaseHarmonic, BaseMotion
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import CoupledSystem, HarmonicLoad
from gearwhine.coupling.machine.driving_frequencies import driving_frequencies
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.shooting import common_period, periodic_response
from gearwhine.coupling.signals.spectrum import Spectrum, amplitude_spectrum
from gearwhine.coupling.statics.mean_mesh import MeanMesh, mean_meshes
from gearwhine.coupling.time.step_matrices import contact_arrays

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LONGEST_COMMON_PERIOD = 40
"""Number of cycles of the fastest mesh in a common period beyond which excitations are superposed by default: the cost
of a periodic motion is proportional to it, and most pairs' hunting periods are longer."""

LONGEST_HUNTING_PERIOD = 300
"""Number of mesh cycles after which the same teeth meet beyond which the gears' differences of teeth are superposed by
default: a shorter one is solved within seconds."""

_PHASES = 8192  # least number of phases at which the neglected force is evaluated
_PHASES_OF_A_MESH = 16  # of these in each mesh cycle of a hunting period
_MOST_PHASES = 2**18
_MOST_CYCLES = 2**14  # longest common period over which the neglected force is solved, in cycles of the fastest mesh
_MANY_CYCLES = 2**9  # record of the neglected force where there is none
_SAMPLES, _SAMPLES_OF_LINES = 64, 512  # of the neglected force in such a cycle, and where its lines are to settle
_HARMONICS = 32  # of the fastest mesh up to which the motion by the neglected force counts
_REPETITIONS, _SETTLED = 10, 0.02  # of that motion's own part in the force, and the change that is small enough
_SPACING = 0.6180339887498949  # sample spacing over the slowest period: its multiples cover all phases evenly
_SAME_FREQUENCY = 1e-9


@dataclass(frozen=True, eq=False)
class ExcitationGroup:
    """Excitations whose motion repeats after a short common period.

    Attributes
    ----------
    meshes : tuple of int
        Numbers of the drive flanks' contacts in the system; their back flanks belong to them.
    frequencies : tuple of float
        Circular frequencies of harmonic loads and runout errors [rad/s].
    turn : float or None
        Turns in a second of the gears whose teeth alone differ in this motion [Hz], 0 for none; None where all do.
    weight : int
        Number of times that the motion counts in the sum.
    """

    meshes: tuple[int, ...] = ()
    frequencies: tuple[float, ...] = ()
    turn: float | None = None
    weight: int = 1

    def part_of(self, base: BaseMotion) -> BaseMotion:
        """Return the harmonics of a base's motion that are excitations of this group."""
        parts = (part for part in base.parts if isinstance(part, BaseHarmonic))
        return replace(base, parts=tuple(part for part in parts if _among(part.frequency, self.frequencies)))


@dataclass(frozen=True, eq=False)
class GroupMotion:
    """Motion by one group of excitations, the other meshes linear about their mean load.

    Attributes
    ----------
    name : str
        Name of the group's excitations.
    group : ExcitationGroup
    response : PeriodicResponse
        Response with the other meshes linear; their compression counts from the point where their force is zero.
    """

    name: str
    group: ExcitationGroup
    response: PeriodicResponse


@dataclass(frozen=True, eq=False)
class SuperposedResponse:
    """A steady motion as the sum of the motions of its groups of excitations; c contacts.

    Attributes
    ----------
    system : CoupledSystem
    motions : tuple of GroupMotion
        Motions, the fastest first.
    means : tuple of MeanMesh
        Mean mesh of each contact; all zero for back flanks.
    rest : ndarray, shape (n,)
        Rest position q0.
    """

    system: CoupledSystem
    motions: tuple[GroupMotion, ...]
    means: tuple[MeanMesh, ...]
    rest: FloatArray = field(repr=False)

    @property
    def stable(self) -> bool:
        """Whether no small disturbance grows in any of the motions."""
        return all(motion.response.stable for motion in self.motions)

    @cached_property
    def _sampled(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Compression, force by the law and assumed force over the phases of all groups, shape (s, c) each."""
        slowest = max(motion.response.period for motion in self.motions)
        count = min(max(_PHASES, _PHASES_OF_A_MESH * hunting_period(self.system)), _MOST_PHASES)
        times = slowest * _SPACING * np.arange(count, dtype=np.float64)
        compression, rate, assumed = self._sum_at(times)
        return compression, self._law_force(times, compression, rate), assumed

    def _sum_at(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Compression, its rate and the assumed force of the sum at times [s], shape (t, c) each."""
        parts = [self._piece_of_sum(piece) for piece in np.array_split(times, -(-len(times) // _PHASES))]
        compression, rate, assumed = (np.concatenate(part) for part in zip(*parts, strict=True))
        return compression, rate, assumed

    def _piece_of_sum(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        at_rest = self.system.contact_directions.T @ self.rest
        contacts = self.system.contacts
        compression = np.tile(at_rest - [contact.clearance for contact in contacts], (len(times), 1))
        rate = np.zeros((len(times), len(contacts)))
        assumed = np.tile([mean.force for mean in self.means], (len(times), 1))
        mean_force = np.array([mean.force for mean in self.means])
        for motion in self.motions:
            response, weight = motion.response, motion.group.weight
            delta, speed, force = response.contacts_at(np.mod(times, response.period))
            clearance = np.array([contact.clearance for contact in response.system.contacts])
            compression = compression + weight * (delta - (at_rest - clearance))
            rate = rate + weight * speed
            assumed += weight * (force - mean_force)
        return compression, rate, assumed

    def _law_force(self, times: FloatArray, compression: FloatArray, rate: FloatArray) -> FloatArray:
        """Force of the contacts by their law [N], shape (t, c)."""
        from gearwhine.coupling.collocation.arrays import element_work
        from gearwhine.coupling.collocation.integration_kernels import forces_at

        force = np.zeros_like(compression)
        forces_at(contact_arrays(self.system), times, compression, rate, element_work(1, 1, force.shape[1]), force)
        return force

    @cached_property
    def _common_cycles(self) -> int | None:
        """Cycles of the fastest mesh in the common period; None where that is too long or there is none."""
        try:
            cycles = round(self._fastest * common_period(self.system))
        except CouplingError:
            return None
        return cycles if 0 < cycles <= _MOST_CYCLES else None

    @property
    def _fastest(self) -> float:
        """Highest mesh frequency [Hz]."""
        return max(abs(contact.mesh_frequency) for contact in self.system.contacts)

    def neglected_spectrum(self, receptance: Callable[[FloatArray], ComplexArray]) -> tuple[Spectrum, bool]:
        """Spectrum of the neglected force of each contact, shape (c, m) [N], and whether its lines have settled.

        Over a common period the force is that of the sum with the motion that the force itself adds, the machine linear
        about its mean meshes: a fixed point, found by repetition as long as its changes fall. Where that is too long
        the force is that of the sum alone, without one or where it is longer still over a record of many cycles.

        Parameters
        ----------
        receptance : callable
            Compressions of the contacts by unit forces along them at frequencies [rad/s], shape (c, c, m) [m/N].
        """
        cycles = self._common_cycles or _MANY_CYCLES
        repeats = self._common_cycles is not None and cycles * _SAMPLES_OF_LINES <= _MOST_PHASES
        count = cycles * (_SAMPLES_OF_LINES if repeats else min(_SAMPLES, _MOST_PHASES // cycles))
        period = cycles / self._fastest
        times = period * (np.arange(count) + 0.5) / count
        compression, rate, assumed = self._sum_at(times)
        stiffness = np.array([mean.stiffness for mean in self.means])
        damping = np.array([one.contact.damping if one.loaded else 0.0 for one in self.system.contacts])
        w = 2.0 * np.pi / period * np.arange(min(_HARMONICS * cycles, count // 2 - 1) + 1, dtype=np.float64)
        answers = receptance(w if repeats else w[:1])
        further: FloatArray = np.zeros_like(compression)
        further_rate, found, left = further, None, np.inf
        before = np.zeros((len(stiffness), count // 2), dtype=np.complex128)
        for _ in range(_REPETITIONS):
            force = self._law_force(times, compression + further, rate + further_rate) - assumed
            force = force - further * stiffness - further_rate * damping
            spectrum = amplitude_spectrum(force.T, period / count)
            lines = spectrum.lines[:, 1:]
            changed = float(np.linalg.norm(lines - before) / max(np.linalg.norm(lines), np.finfo(np.float64).tiny))
            if not changed < left:
                break
            found, before, left = spectrum, lines, changed
            if left <= _SETTLED or not repeats:
                break
            moved = -0.5 * count * np.einsum("cdm,dm->mc", answers, spectrum.lines[:, : len(w)])
            further = np.asarray(np.fft.irfft(moved, count, axis=0), dtype=np.float64)
            further_rate = np.asarray(np.fft.irfft(1j * w[:, None] * moved, count, axis=0), dtype=np.float64)
        assert found is not None
        return replace(found, phase=found.phase - 2.0 * np.pi * found.frequencies * times[0]), left <= _SETTLED

    @property
    def mean_force(self) -> FloatArray:
        """Mean force of each contact over all phases [N], shape (c,)."""
        return np.asarray(self._sampled[2].mean(axis=0))

    @property
    def peak_force(self) -> FloatArray:
        """Largest force of each contact by its law at the superposed motion [N], shape (c,)."""
        return np.asarray(self._sampled[1].max(axis=0))

    @property
    def contact_loss(self) -> FloatArray:
        """Part of all phases at which the flanks are apart, shape (c,)."""
        return np.asarray((self._sampled[1] == 0.0).mean(axis=0))

    @property
    def mean_compression(self) -> FloatArray:
        """Mean compression of each contact [m], shape (c,)."""
        return np.asarray(self._sampled[0].mean(axis=0))

    @property
    def rms_compression(self) -> FloatArray:
        """Root mean square about the mean [m], shape (c,)."""
        return np.asarray(self._sampled[0].std(axis=0))

    @property
    def neglected_force(self) -> FloatArray:
        """Root mean square of the neglected force r of each contact [N], shape (c,)."""
        _, force, assumed = self._sampled
        return np.asarray(np.sqrt(np.mean((force - assumed) ** 2, axis=0)))

    @property
    def neglected_part(self) -> FloatArray:
        """Neglected force over the rms of each drive flank's varying force, shape (c,); 0 for separate back flanks."""
        varying = self._sampled[1].std(axis=0)
        return np.asarray(np.divide(self.neglected_force, varying, out=np.zeros_like(varying), where=varying > 0.0))


def common_cycles(system: CoupledSystem) -> float:
    """Cycles of the fastest excitation in the common period of all; infinite where there is none."""
    try:
        return common_period(system) * max(driving_frequencies(system).values())
    except CouplingError:
        return np.inf


def hunting_period(system: CoupledSystem) -> int:
    """Mesh cycles after which the same teeth meet in all meshes that share a frequency: the most of any frequency."""
    periods = dict[str, int]()
    for contact in (one for one in system.contacts if one.loaded):
        rate = _rate(contact)
        periods[rate] = math.lcm(periods.get(rate, 1), contact.contact.hunting_period)
    return max(periods.values(), default=1)


def excitation_groups(
    system: CoupledSystem,
    longest: float = LONGEST_COMMON_PERIOD,
    longest_hunting: float = LONGEST_HUNTING_PERIOD,
) -> tuple[ExcitationGroup, ...]:
    """Group excitations whose common period holds at most a number of the fastest one's cycles.

    Meshes are grouped first, the fastest first, then loads and runout errors; each joins the group with which its
    common period is the shortest, or begins one. What repeats within a group's own period joins it however long that
    is: the load shuttling of a mesh whose teeth are not alike adds to its lines with their phases. Constant loads are
    in none. Where a hunting period is too long, meshes that share their frequency are together, and divided by the
    turns of gears whose teeth differ.

    Parameters
    ----------
    system : CoupledSystem
    longest : float
        Largest number of cycles of the fastest excitation in a group's common period.
    longest_hunting : float
        Largest number of mesh cycles in the hunting period of meshes that share their frequency that is one group.
    """
    groups: list[ExcitationGroup] = []
    meshes, loads = _atoms(system)
    if hunting_period(system) > longest_hunting:
        sharing = dict[str, tuple[int, ...]]()
        for (number,) in (atom.meshes for atom in meshes):
            rate = _rate(system.contacts[number])
            sharing[rate] = (*sharing.get(rate, ()), number)
        groups = [part for numbers in sharing.values() for part in _by_turns(system, ExcitationGroup(numbers))]
        meshes = []
    for atom in (*meshes, *loads):
        _join(system, groups, atom, longest)
    return tuple(groups)


def _rate(contact: ContactConnector) -> str:
    """Return the mesh frequency, the same of meshes that share it."""
    return f"{abs(contact.mesh_frequency):.9g}"


def _join(system: CoupledSystem, groups: list[ExcitationGroup], atom: ExcitationGroup, longest: float) -> None:
    """Let an excitation join the group with which its common period is the shortest, or begin a group."""
    joined = [
        replace(group, meshes=group.meshes + atom.meshes, frequencies=group.frequencies + atom.frequencies)
        for group in groups
    ]
    for number, group in enumerate(groups):
        if group.weight < 0 and _repeats_within(system, group, joined[number]):
            # Of teeth that are alike: it is in every motion of these meshes, whose weights add up to one.
            groups[:] = [new if old.meshes == group.meshes else old for old, new in zip(groups, joined, strict=True)]
            return
    cycles = [
        common_cycles(_driven_by(system, one)) if group.weight > 0 else np.inf
        for group, one in zip(groups, joined, strict=True)
    ]
    best = int(np.argmin(cycles)) if cycles else -1
    if best >= 0 and (cycles[best] <= longest or _repeats_within(system, groups[best], joined[best])):
        groups[best] = joined[best]
    else:
        groups.append(atom)


def _by_turns(system: CoupledSystem, group: ExcitationGroup) -> list[ExcitationGroup]:
    """Divide a group of meshes by the turns of gears whose teeth differ, the motion of no such gear with them."""
    turns: list[float] = []
    for contact in (system.contacts[i] for i in group.meshes):
        common = contact.contact.teeth_of().hunting_period
        for side in ("driver", "driven"):
            turn = _turns_of(contact)[side]
            if contact.contact.teeth_of(**{side: True}).hunting_period > common and not _among(turn, turns):
                turns.append(turn)
    if len(turns) < 2:
        return [group]
    parts = [replace(group, turn=turn) for turn in sorted(turns, reverse=True)]
    return [replace(group, turn=0.0, weight=1 - len(turns)), *parts]


def _divides(contact: ContactConnector) -> bool:
    """Whether the teeth of the gears are known apart."""
    return all(contact.contact.tooth_counts) and contact.mesh_frequency != 0.0


def _turns_of(contact: ContactConnector) -> dict[str, float]:
    """Return the turns in a second of driver and driven gear against the mesh [Hz]; zeros where they are not known."""
    rate = abs(contact.mesh_frequency)
    return {
        side: rate / count if count else 0.0
        for side, count in zip(("driver", "driven"), contact.contact.tooth_counts, strict=True)
    }


def _with_teeth_of(system: CoupledSystem, turn: float | None) -> CoupledSystem:
    """Return the system in which only the teeth of gears differ that make some turns in a second [Hz]; None: all."""
    return replace(system, contacts=tuple(_teeth_of(contact, turn) for contact in system.contacts))


def _teeth_of(contact: ContactConnector, turn: float | None) -> ContactConnector:
    if turn is None or not _divides(contact):
        return contact
    sides = {side: turn > 0.0 and _among(one, [turn]) for side, one in _turns_of(contact).items()}
    return replace(contact, contact=contact.contact.teeth_of(**sides))


def _repeats_within(system: CoupledSystem, group: ExcitationGroup, joined: ExcitationGroup) -> bool:
    """Whether a group with one more excitation has the period that it has without."""
    try:
        alone, together = (common_period(_driven_by(system, one)) for one in (group, joined))
    except CouplingError:
        return False
    return together <= alone * (1.0 + _SAME_FREQUENCY)


def superposed_response(
    system: CoupledSystem,
    groups: Sequence[ExcitationGroup] | None = None,
    *,
    tolerance: float = 1e-8,
) -> SuperposedResponse:
    """Solve for the steady motion as the superposition of the motions of its groups of excitations.

    Parameters
    ----------
    system : CoupledSystem
        System at constant speed.
    groups : sequence of ExcitationGroup, optional
        Groups; by default those of :func:`excitation_groups`.
    tolerance : float
        Tolerance as for :func:`periodic_response`.

    Raises
    ------
    CouplingError
        Where nothing varies, or the loads do not balance.
    PeriodicError
        Where a mesh carries no mean force, so that it cannot be linear about one, or no motion is found.
    """
    chosen = excitation_groups(system) if groups is None else tuple(groups)
    if not chosen:
        common_period(system)  # says that nothing varies
    # Means of the whole hunting period are those of teeth that are alike, to the first order.
    divided = any(group.turn is not None for group in chosen)
    means = []
    for contact, mean in zip(
        system.contacts, mean_meshes(_with_teeth_of(system, 0.0 if divided else None)), strict=True
    ):
        if contact.loaded and (mean is None or mean.force <= 0.0):
            raise PeriodicError(
                f"mesh {contact.name!r} carries no mean force, so its flanks part and it is not linear about a mean; "
                "expected a torque through every mesh, or a time integration until the motion is steady"
            )
        means.append(MeanMesh(0.0, 0.0, 0.0, 0.0) if mean is None or not contact.loaded else mean)
    linear = tuple(_linear_mesh(contact, mean) for contact, mean in zip(system.contacts, means, strict=True))
    rest = _rest_position(replace(system, contacts=linear))
    motions = []
    for group in chosen:
        driven = _driven_by(system, group, linear)
        motions.append(GroupMotion(_name_of(system, group), group, periodic_response(driven, tolerance=tolerance)))
    motions.sort(key=lambda motion: motion.response.period)
    return SuperposedResponse(system, tuple(motions), tuple(means), rest)


def _atoms(system: CoupledSystem) -> tuple[list[ExcitationGroup], list[ExcitationGroup]]:
    """Each varying mesh, the fastest first; and each frequency of loads and runout errors, the highest first."""
    loaded = [i for i, contact in enumerate(system.contacts) if contact.loaded]
    meshes = [i for i in loaded if driving_frequencies(_driven_by(system, ExcitationGroup((i,))))]
    meshes.sort(key=lambda i: -abs(system.contacts[i].mesh_frequency))
    load_frequencies = [abs(load.frequency) for load in system.harmonic_loads if np.any(load.amplitude != 0.0)]
    load_frequencies += [abs(row[1]) for contact in system.contacts for row in contact.errors if row[0] != 0.0]
    frequencies: list[float] = []
    for frequency in sorted(load_frequencies, reverse=True):
        if frequency != 0.0 and not _among(frequency, frequencies):
            frequencies.append(frequency)
    return [ExcitationGroup((i,)) for i in meshes], [ExcitationGroup((), (frequency,)) for frequency in frequencies]


def _driven_by(
    system: CoupledSystem, group: ExcitationGroup, linear: Sequence[ContactConnector] | None = None
) -> CoupledSystem:
    """Return the system with the excitations of one group; other contacts are those of ``linear``, or constant."""
    names = {system.contacts[i].name for i in group.meshes}
    contacts = []
    for number, contact in enumerate(system.contacts):
        drives = contact.name.removesuffix(", back") in names
        if drives:
            stands = _teeth_of(contact, group.turn)
        elif linear is not None:
            stands = linear[number]
        else:
            stands = _linear_mesh(contact, MeanMesh(1.0, 1.0, 0.0, 1.0))
        errors = [row for row in contact.errors if row[1] == 0.0 or _among(row[1], group.frequencies)]
        contacts.append(replace(stands, errors=np.array(errors, dtype=np.float64).reshape(-1, 3)))
    loads: list[HarmonicLoad] = [
        load for load in system.harmonic_loads if load.frequency == 0.0 or _among(load.frequency, group.frequencies)
    ]
    return replace(system, contacts=tuple(contacts), harmonic_loads=tuple(loads))


def _among(frequency: float, frequencies: Sequence[float]) -> bool:
    return any(abs(abs(frequency) - one) <= _SAME_FREQUENCY * one for one in frequencies)


def _linear_mesh(contact: ContactConnector, mean: MeanMesh) -> ContactConnector:
    """Linearise a contact: spring and dashpot through its mean force and deflection; back flanks stay apart."""
    stiffness = mean.stiffness if contact.loaded else contact.contact.unloaded_mean_mesh_stiffness
    law = ToothContact(
        1.0, piecewise.constant(stiffness, 1.0), piecewise.constant(0.0, 1.0), damping=contact.contact.damping
    )
    clearance = contact.clearance
    if contact.loaded:
        clearance += mean.deflection - mean.force / stiffness
    return replace(contact, contact=law, phase=0.5, mesh_frequency=0.0, clearance=clearance)


def _rest_position(linear: CoupledSystem) -> FloatArray:
    """Rest position q0, shape (n,), under the constant load, all meshes linear; zero in rigid-body motions."""
    from gearwhine.coupling.statics.static_equilibrium import static_equilibrium

    still = tuple(replace(contact, errors=np.zeros((0, 3))) for contact in linear.contacts)
    return static_equilibrium(replace(linear, contacts=still))


def _name_of(system: CoupledSystem, group: ExcitationGroup) -> str:
    """Name of a group by its excitations."""
    names = [f"mesh {system.contacts[i].name}" for i in group.meshes]
    if group.turn:
        gears = [
            gear
            for contact in (system.contacts[i] for i in group.meshes)
            for gear, turn in zip(contact.name.split(" -> "), _turns_of(contact).values(), strict=False)
            if _among(group.turn, [turn])
        ]
        names = [f"unequal teeth of {' and '.join(dict.fromkeys(gears))}"]
    rates = [2.0 * np.pi * abs(system.contacts[i].mesh_frequency) for i in group.meshes]
    for frequency in group.frequencies:
        # Harmonics of a mesh, such as those of load shuttling, are not listed.
        if any(
            abs(frequency / rate - max(round(frequency / rate), 1)) <= _SAME_FREQUENCY * frequency / rate
            for rate in rates
        ):
            continue
        rotating = [
            component.name
            for component, speed in zip(system.components, system.speeds, strict=True)
            if speed != 0.0 and abs(abs(speed) - frequency) <= 1e-6 * frequency
        ]
        names.append(
            f"rotation of {' and '.join(rotating)}" if rotating else f"load at {frequency / (2.0 * np.pi):.6g} Hz"
        )
    return ", ".join(names)
