"""Steady state of a machine: the periodic motion under its excitation, and the branch of such motions over speed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.linear.unequal_teeth import DampedMachine
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import least_sampling_rate
from gearwhine.coupling.periodic.continuation import ResponseCurve, response_curve
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.settled_curve import settled_curve
from gearwhine.coupling.periodic.settling import SettledMotion, circles, settled_response
from gearwhine.coupling.periodic.shooting import periodic_response
from gearwhine.coupling.periodic.superposition import (
    LONGEST_COMMON_PERIOD,
    LONGEST_HUNTING_PERIOD,
    ExcitationGroup,
    SuperposedResponse,
    common_cycles,
    excitation_groups,
    hunting_period,
    superposed_response,
)
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.coupling.signals.spectrum import SignalParts, Spectrum, amplitude_spectrum, signal_parts
from gearwhine.coupling.statics.mean_mesh import ContactState, linear_matrices
from gearwhine.coupling.time.histories import Histories, modal_record, transient_outputs, with_modal_rows
from gearwhine.coupling.time.histories import histories as coupled_histories
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning

_RPM = 60.0 / (2.0 * np.pi)
_OVERSAMPLING = 32.0  # sampling of a period over the highest frequency of interest: little folds back below it
_ROUNDING = 1e-10  # of the highest line of a signal
_LEAST_SAMPLES, _LEAST_OF_A_CYCLE = 512, 64  # of a period, and of a part of it that motions share
_HARMONICS = 4.0  # mesh harmonics of interest where no housing limits the model
_SHARED_LINE = 1e-9  # relative distance of lines of several motions that are one
_NAMED_LINE_DISTANCE = 1e-3  # distance of a line from the excitation that it is named after, over the spacing of lines
_DOUBTFUL_FORCE_SHARE = 0.1  # part of a mesh's varying force that may be neglected without a warning
_DOUBTFUL_SENSOR_SHARE = 0.3  # part of a sensor's rms that this may make: 5 % of the rms where phases are random
_INSTEAD = "hold them against run or steady --exact"

_NARROW_RANGE_SHARE = 0.01  # width over that of the whole range below which ranges are told together
_WHY_NOT_SETTLED = "the motion settles at none of the points there; `run` shows what the machine does"
_WHY_NOT = (
    "the branch is lost there and no other start led to a motion; --points 400 takes shorter steps, a narrower [sweep] "
    "more of them, and `run` or `sweep` shows what the machine does there"
)

REPORTED_LINES = 20
"""Number of the highest lines of a signal that are reported."""

CURVE_TOLERANCE = 1e-5
"""Relative tolerance of the points of a branch: a tenth of a transient's default."""


@dataclass(frozen=True)
class SteadyMotion:
    """A periodic motion at one speed.

    Attributes
    ----------
    speed : float
        Speed of the first driver's rotor [rad/s].
    response : PeriodicResponse or SettledMotion
    histories : Histories
        Histories of one period.
    trusted_limit : float
        Highest frequency that the model carries [Hz].
    excitation : str
        Name of its excitations, where it is one of several superposed motions; empty for the motion under all.
    group : ExcitationGroup
        These excitations; with no meshes and loads for the motion under all.
    """

    speed: float
    response: PeriodicResponse | SettledMotion
    histories: Histories
    trusted_limit: float
    excitation: str = ""
    group: ExcitationGroup = field(default_factory=ExcitationGroup)

    def spectrum(self, signal: FloatArray) -> Spectrum:
        """Lines of a signal of the histories, shape (..., s), exact."""
        return amplitude_spectrum(signal, self.response.period / signal.shape[-1])

    def lines(self, signal: FloatArray, limit: float = np.inf) -> list[tuple[float, float, float]]:
        """Return the highest lines of a signal, multiples of the period's frequency; see :func:`highest_lines`."""
        return highest_lines(self.spectrum(signal), limit)

    def resampled(self, signal: FloatArray, count: int) -> FloatArray:
        """Resample a whole period of a signal to another number of samples, by its own lines."""
        if len(signal) == count:
            return signal
        return np.asarray(np.fft.irfft(np.fft.rfft(signal), count) * (count / len(signal)))

    @property
    def sensor_rms(self) -> dict[str, float]:
        """Rms value of each sensor's acceleration up to the trusted limit [m/s²]."""
        signals = self.histories.sensor_acceleration
        return {name: float(self.spectrum(signal).rms(self.trusted_limit)) for name, signal in signals.items()}


def highest_lines(spectrum: Spectrum, limit: float = np.inf) -> list[tuple[float, float, float]]:
    """Frequencies [Hz], amplitudes and phases [rad] of the highest lines up to a limit [Hz], as many as are reported.

    The phase is that of the line's cosine at t = 0. What is no more than rounding beside the highest is no line.
    """
    inside = np.flatnonzero((spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit * (1.0 + 1e-9)))
    highest = inside[np.argsort(-spectrum.amplitude[inside], kind="stable")][:REPORTED_LINES]
    return [
        (float(spectrum.frequencies[i]), float(spectrum.amplitude[i]), float(spectrum.phase[i]))
        for i in highest
        if spectrum.amplitude[i] > _ROUNDING * spectrum.amplitude[highest[0]]
    ]


def spectra_of_sum(motions: Sequence[SteadyMotion], signals: Sequence[FloatArray]) -> list[Spectrum]:
    """Spectra of a signal, shape (..., s), in motions that are superposed, each line of their sum in one of them.

    A line that several motions have is the sum of their complex amplitudes, each as often as its motion counts, in the
    spectrum of the first of them; it is 0 in the others.
    """
    found: list[Spectrum] = []
    for motion, signal in zip(motions, signals, strict=True):
        spectrum = motion.spectrum(signal)
        lines = motion.group.weight * spectrum.lines
        for number, (other, before) in enumerate(zip(motions, found, strict=False)):
            cycles = spectrum.frequencies * other.response.period
            place = np.round(cycles).astype(np.int64)
            shared = (place > 0) & (place < before.frequencies.size) & (np.abs(cycles - place) <= _SHARED_LINE * place)
            together = before.lines
            together[..., place[shared]] += lines[..., shared]
            lines[..., shared] = 0.0
            found[number] = replace(before, amplitude=np.abs(together), phase=np.angle(together))
        found.append(replace(spectrum, amplitude=np.abs(lines), phase=np.angle(lines)))
    return found


@dataclass(frozen=True)
class LoudestPoint:
    """Point of a branch at which a sensor's acceleration is largest, with its highest line.

    Attributes
    ----------
    sensor : str
    speed : float
        Speed of the first driver's rotor [rad/s].
    rms : float
        Rms acceleration up to the trusted limit [m/s²].
    frequency : float
        Frequency of its highest line [Hz].
    amplitude : float
        Amplitude of that line [m/s²].
    excitation : str
        Name of that line, such as ``3× pinion -> wheel``.
    mode : int
        Number of the housing mode with the largest part in that line, from 1.
    mode_hz : float
        Natural frequency of that mode [Hz].
    share : float
        Part of that mode, in phase with the line, over the line.
    """

    sensor: str
    speed: float
    rms: float
    frequency: float
    amplitude: float
    excitation: str
    mode: int
    mode_hz: float
    share: float


@dataclass(frozen=True)
class SolvedSteady:
    """The steady state.

    Attributes
    ----------
    machine : gearwhine.coupling.CoupledMachine
        Machine at the speed of operation.
    motions : tuple of SteadyMotion
        Motions at the speed of operation: one, or all that a branch has there; where they are superposed, one of each
        group of excitations.
    superposed : SuperposedResponse or None
        Sum of the motions, where the excitations have no short common period.
    curve : ResponseCurve or None
        The branch over the speed of the first driver's rotor [rad/s].
    branch_rms : dict of str to ndarray, shape (p,)
        Rms of each sensor's acceleration up to the trusted limit at every point of the branch [m/s²].
    loudest : tuple of LoudestPoint
        Loudest point of each sensor on the branch.
    assumed_damping : tuple of str
        Gear pairs whose mesh damping the case leaves to the default.
    neglected_acceleration : dict of str to Spectrum
        Acceleration of each sensor up to the trusted limit by the forces that the sum of motions leaves out, of the
        machine with the mean mesh stiffness [m/s²]: an estimate of its error.
    neglected_settles : bool
        Whether these forces are those of the sum with the motion that they add, over a common period: their lines are
        then those that the sum lacks.
    """

    machine: CoupledMachine
    motions: tuple[SteadyMotion, ...]
    curve: ResponseCurve | None = None
    branch_rms: dict[str, FloatArray] = field(default_factory=dict)
    superposed: SuperposedResponse | None = None
    loudest: tuple[LoudestPoint, ...] = ()
    assumed_damping: tuple[str, ...] = ()
    neglected_acceleration: dict[str, Spectrum] = field(default_factory=dict)
    neglected_settles: bool = False

    @property
    def contact_loss(self) -> FloatArray:
        """Largest part of the time in which the flanks of each contact are apart in any of the motions, shape (c,)."""
        losses = [motion.response.contact_loss for motion in self.motions]
        losses += [] if self.superposed is None else [self.superposed.contact_loss]
        losses += [] if self.curve is None else [self.curve.contact_loss.max(axis=0)]
        return np.asarray(np.max(losses, axis=0))

    @property
    def hunting_mesh_cycles(self) -> int | None:
        """Mesh cycles after which the same teeth meet, where motions by unequal teeth of each gear are superposed."""
        if not any(motion.group.weight < 0 for motion in self.motions):
            return None
        return hunting_period(self.machine.system)

    def bearing_parts(self, motion: SteadyMotion | None = None) -> list[tuple[str, SignalParts]]:
        """Mean and alternating part of each bearing's load in one motion, or in all that are superposed.

        Forces along x, y, z [N] and moments about x, y [N m]; the peak of superposed motions is a bound.
        """
        if motion is not None or self.superposed is None:
            histories = (motion or self.motions[0]).histories
            return [(name, signal_parts(load.T)) for name, load in histories.bearing_load.items()]
        motions = self.motions
        weights = np.array([one.group.weight for one in motions], dtype=np.float64)
        alike = {one.group.meshes: place for place, one in enumerate(motions) if one.group.weight < 0}
        loads = []
        for name in motions[0].histories.bearing_load:
            signals = [np.ascontiguousarray(one.histories.bearing_load[name].T) for one in motions]
            rms = np.hypot.reduce([spectrum.rms(np.inf) for spectrum in spectra_of_sum(motions, signals)])
            means = np.array([signal.mean(axis=-1) for signal in signals])
            # Each group's motion has the mean load.
            mean = weights @ means - (weights.sum() - 1.0) * means.mean(axis=0)
            peak = np.zeros(len(mean))
            for one, signal in zip(motions, signals, strict=True):
                varying = signal
                if one.group.meshes in alike and one.group.weight > 0:
                    cycle = signals[alike[one.group.meshes]]
                    varying = signal - np.tile(cycle, signal.shape[-1] // cycle.shape[-1])
                peak += signal_parts(varying).peak
            loads.append((name, SignalParts(mean, rms, peak)))
        return loads

    def rms_of_sum(self, sensor: str) -> float:
        """Rms acceleration of a sensor up to the trusted limit in the sum of the motions [m/s²]."""
        signals = [motion.histories.sensor_acceleration[sensor] for motion in self.motions]
        limit = self.motions[0].trusted_limit
        return float(np.hypot.reduce([spectrum.rms(limit) for spectrum in spectra_of_sum(self.motions, signals)]))

    def branch_warnings(self) -> list[dict[str, Any]]:
        """Warnings of every range of speeds over which no motion was followed; narrow ones together."""
        curve = self.curve
        if curve is None or not curve.gaps:
            return []
        low, high = sorted((abs(curve.begin), abs(curve.aim)))
        why = _WHY_NOT_SETTLED if curve.settled else _WHY_NOT
        gaps = [tuple(sorted((_RPM * abs(first), _RPM * abs(last)))) for first, last in curve.gaps]
        narrow = [gap for gap in gaps if gap[1] - gap[0] < _NARROW_RANGE_SHARE * _RPM * (high - low)]
        warnings = []
        for first, last in (gap for gap in gaps if gap not in narrow):
            message = (
                f"no motion was followed between {first:.5g} and {last:.5g} rpm of {_RPM * low:.5g} to "
                f"{_RPM * high:.5g}: {why}"
            )
            warnings.append(warning("branch range", message, from_rpm=first, to_rpm=last))
        if narrow:
            width = sum(last - first for first, last in narrow)
            widest = max(narrow, key=lambda gap: gap[1] - gap[0])
            message = (
                f"no motion was followed in {len(narrow)} narrow ranges, {width:.4g} rpm together, the widest "
                f"{widest[0]:.6g} to {widest[1]:.6g} rpm: resonances that next to nothing damps, or flanks that graze"
            )
            warnings.append(warning("branch ranges", message, ranges_rpm=[list(gap) for gap in narrow]))
        return warnings

    def superposition_warnings(self) -> list[dict[str, Any]]:
        """Warnings where the sum of the groups' motions is no longer near the motion under all of them."""
        warnings: list[dict[str, Any]] = []
        sum_ = self.superposed
        for number, contact in enumerate(self.machine.system.contacts if sum_ is not None else ()):
            assert sum_ is not None
            loss, part = float(sum_.contact_loss[number]), float(sum_.neglected_part[number])
            if contact.loaded and loss > 0.0:
                text = f"its flanks are apart {100.0 * loss:.2g} % of the time under all excitations together"
            elif contact.loaded and part > _DOUBTFUL_FORCE_SHARE:
                text = f"the sum leaves out {100.0 * part:.2g} % of its varying force"
            elif not contact.loaded and loss < 1.0:
                text = f"these flanks touch {100.0 * (1.0 - loss):.2g} % of the time under all excitations together"
            else:
                continue
            message = f"superposed motions are doubtful at {contact.name}: {text}; {_INSTEAD}"
            warnings.append(
                warning("superposition", message, contact=contact.name, neglected_part=part, contact_loss=loss)
            )
        for name, neglected in self.neglected_acceleration.items():
            part = float(neglected.rms(np.inf)) / max(self.rms_of_sum(name), np.finfo(np.float64).tiny)
            if part > _DOUBTFUL_SENSOR_SHARE:
                message = (
                    f"superposed motions are doubtful at sensor {name}: what the sum leaves out makes some "
                    f"{100.0 * part:.2g} % of its acceleration, rms; {_INSTEAD}"
                )
                warnings.append(warning("superposition", message, sensor=name, neglected_part=part))
        return warnings


def solve_steady(
    machine: CoupledMachine,
    progress: Progress = silent,
    *,
    over_speed: tuple[float, float] | None = None,
    points: int = 100,
    exact: bool = False,
    superpose: bool = False,
) -> SolvedSteady:
    """Find the motion that repeats at the speed of operation, and where asked follow it over speed.

    Where carriers turn, the motion is the one in which the machine settles, see
    :mod:`gearwhine.coupling.periodic.settling`; over speed it is settled anew at each of the points.

    If the common period of all excitations is long, such as that of hunting teeth, each group of excitations has its
    own motion and these are superposed, see :mod:`gearwhine.coupling.periodic.superposition`. Beyond
    ``LONGEST_HUNTING_PERIOD`` mesh cycles the teeth of each gear of a pair that differ are such groups, too.

    Parameters
    ----------
    machine : CoupledMachine
    progress : callable
    over_speed : tuple of float, optional
        Signed speeds of the first driver's shaft from which and to which the branch is followed [rad/s].
    points : int
        Number of points on a straight branch.
    exact : bool
        Whether the common period is solved however long it is.
    superpose : bool
        Whether motions are superposed however short it is, where there are several.

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where the machine stands still, the excitation does not repeat, a branch is asked for of motions that are
        superposed, or both ``exact`` and ``superpose`` are given.
    gearwhine.coupling.PeriodicError
        Where no motion is found. A branch that is lost on its way is given as far as it was followed.
    """
    if exact and superpose:
        raise CouplingError("exact and superpose together; expected one of them, or neither: the common period decides")
    speed = machine.speed
    if speed == 0.0:
        raise CouplingError("a speed of 0; expected a speed: what stands still has no motion that repeats")
    progress("compiling the search for periodic motions (the first time takes longer)")
    turning = circles(machine.system)
    if turning and over_speed is None:
        settled = settled_response(
            machine.system, progress=lambda fraction: progress("settling in a motion that repeats", fraction)
        )
        return SolvedSteady(machine, (_motion(machine, speed, settled),))
    longest = (1.0, 1.0) if superpose else (LONGEST_COMMON_PERIOD, LONGEST_HUNTING_PERIOD)
    groups = () if exact or turning else excitation_groups(machine.system, *longest)
    hunting = hunting_period(machine.system)
    if len(groups) > 1 and over_speed is not None:
        cycles = max(common_cycles(machine.system), hunting)
        raise CouplingError(f"expected {_NO_BRANCH.format(_period_in_words(cycles))}")
    if len(groups) > 1:
        return _superposed(machine, speed, groups, progress)
    if hunting > LONGEST_HUNTING_PERIOD:
        progress(f"a motion over {hunting} mesh cycles, after which the same teeth meet: `run` takes less time")
    if over_speed is None:
        response = periodic_response(machine.system)
        return SolvedSteady(machine, (_motion(machine, speed, response),))
    rms: dict[str, list[float]] = {name: [] for name in machine.housing.sensors} if machine.housing is not None else {}

    def seen(at: float, response: PeriodicResponse | SettledMotion) -> None:
        if rms:
            motion = _motion(machine.at_speed(at), at, response)
            for name, value in motion.sensor_rms.items():
                rms[name].append(value)

    def system_at(at: float) -> CoupledSystem:
        return machine.at_speed(at).system

    def followed(fraction: float) -> None:
        progress("following the motion over speed", fraction)

    if turning:
        curve = settled_curve(system_at, *over_speed, points=points, progress=followed, seen=seen)
    else:
        curve = response_curve(
            system_at, *over_speed, points=points, tolerance=CURVE_TOLERANCE, progress=followed, seen=seen
        )
    progress("the motions at the speed of operation")
    alone = settled_response if turning else periodic_response
    responses = curve.at(speed) if curve.passes(speed) else [alone(machine.system)]
    motions = tuple(_motion(machine, speed, response) for response in responses)
    branch_rms = {name: np.array(values) for name, values in rms.items()}
    loudest = () if machine.housing is None else tuple(_loudest(machine, curve, branch_rms))
    return SolvedSteady(machine, motions, curve, branch_rms, loudest=loudest)


def _loudest(machine: CoupledMachine, curve: ResponseCurve, rms: dict[str, FloatArray]) -> Iterator[LoudestPoint]:
    """Yield the loudest point of each sensor on a branch; none of a sensor that does not move."""
    places = {name: int(values.argmax()) for name, values in rms.items() if values.any()}
    for place in sorted(set(places.values())):
        speed = float(curve.speeds[place])
        machine_there = machine.at_speed(speed)
        motion = _motion(machine_there, speed, curve.motion(place))
        samples = len(motion.histories.times)
        record = motion.response.record(with_modal_rows(machine_there, transient_outputs(machine_there)), samples)
        modal = amplitude_spectrum(
            modal_record(machine_there, record).housing_acceleration.T, motion.response.period / samples
        )
        assert machine_there.housing is not None
        for name, row in machine_there.housing.sensors.items():
            if places.get(name) != place:
                continue
            spectrum = motion.spectrum(motion.histories.sensor_acceleration[name])
            frequency, amplitude, _ = motion.lines(motion.histories.sensor_acceleration[name], motion.trusted_limit)[0]
            number = int(np.argmin(np.abs(spectrum.frequencies - frequency)))
            line = spectrum.lines[number]
            shares = (row[: len(modal.lines)] * modal.lines[:, number] * line.conj()).real / abs(line) ** 2
            mode = int(shares.argmax())
            yield LoudestPoint(
                sensor=name,
                speed=speed,
                rms=float(rms[name][place]),
                frequency=frequency,
                amplitude=amplitude,
                excitation=line_names(machine_there, [frequency], _NAMED_LINE_DISTANCE * spectrum.spacing)[0].name,
                mode=mode + 1,
                mode_hz=float(np.sqrt(machine_there.housing.stiffness[mode, mode])) / (2.0 * np.pi),
                share=float(shares[mode]),
            )


_NO_BRANCH = (
    "excitations with a short common period, for a branch over speed follows one periodic motion; theirs {}; "
    "`gearwhine sweep` solves speed by speed, and names the peaks between them; or leave unbalance, runout or a stage "
    "out, or solve one speed without --curve"
)


def _period_in_words(cycles: float) -> str:
    if not np.isfinite(cycles):
        return "does not exist"
    return f"holds {cycles:.0f} cycles of the fastest one, which --exact follows in its time"


def _superposed(
    machine: CoupledMachine,
    speed: float,
    groups: tuple[ExcitationGroup, ...],
    progress: Progress,
) -> SolvedSteady:
    progress(f"the motions of {len(groups)} groups of excitations without a short common period")
    superposed, loads = superposed_response(machine.system, groups), machine.loads
    cycles = {one.group.meshes: one.response.period for one in superposed.motions if one.group.weight < 0}
    motions = tuple(
        replace(
            _motion(replace(machine, loads=of_group), speed, one.response, cycles.get(one.group.meshes)),
            excitation=one.name,
            group=one.group,
        )
        for one in superposed.motions
        for of_group in [loads if loads.base is None else replace(loads, base=one.group.part_of(loads.base))]
    )
    neglected, settled = _neglected_acceleration(machine, superposed, motions[0].trusted_limit)
    return SolvedSteady(
        machine, motions, superposed=superposed, neglected_acceleration=neglected, neglected_settles=settled
    )


def _neglected_acceleration(
    machine: CoupledMachine, superposed: SuperposedResponse, limit: float
) -> tuple[dict[str, Spectrum], bool]:
    """Acceleration of each sensor up to a limit [Hz] by the neglected forces [m/s²], and whether these settle."""
    rows = transient_outputs(machine).acceleration
    if not len(rows) or not any(contact.mesh_frequency for contact in machine.system.contacts):
        return {}, False
    system = machine.system
    state = ContactState(
        np.array([mean.stiffness for mean in superposed.means]),
        np.array([contact.contact.damping if contact.loaded else 0.0 for contact in system.contacts]),
    )
    damped, directions = DampedMachine(*linear_matrices(system, state)), system.contact_directions
    loaded = [number for number, contact in enumerate(system.contacts) if contact.loaded]

    def receptance(w: FloatArray) -> ComplexArray:
        found = np.zeros((directions.shape[1], directions.shape[1], w.size), dtype=np.complex128)
        for number in loaded:
            found[:, number] = damped.answers(directions.T, directions[:, number], w)
        return found

    spectrum, settled = superposed.neglected_spectrum(receptance)
    inside = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit)
    w = 2.0 * np.pi * spectrum.frequencies[inside]
    moved = np.zeros((len(rows), w.size), dtype=np.complex128)
    for number in loaded:
        moved += damped.answers(rows, directions[:, number], w) * spectrum.lines[number, inside]
    # The force of a mesh acts against its line of action.
    lines = w**2 * moved
    spectra = (
        Spectrum(spectrum.frequencies[inside], np.abs(of_sensor), np.angle(of_sensor), spectrum.window)
        for of_sensor in lines
    )
    return dict(zip(machine.sensor_rows, spectra, strict=True)), settled


def _motion(
    machine: CoupledMachine, speed: float, response: PeriodicResponse | SettledMotion, cycle: float | None = None
) -> SteadyMotion:
    """Motion of a machine at its speed; it carries some harmonics of the meshes where no housing limits the model.

    Motions that share a cycle [s], a part of their periods, have as many samples in each.
    """
    limit = _HARMONICS * max((abs(contact.mesh_frequency) for contact in machine.system.contacts), default=250.0)
    if machine.housing is not None and machine.housing.complete_below is not None:
        limit = machine.housing.complete_below / (2.0 * np.pi)
    rate = max(_OVERSAMPLING * limit, least_sampling_rate(response.system)[0])
    if cycle is None:
        samples = 2 ** math.ceil(math.log2(max(rate * response.period, _LEAST_SAMPLES)))
    else:
        samples = 2 ** math.ceil(math.log2(max(rate * cycle, _LEAST_OF_A_CYCLE))) * round(response.period / cycle)
    record = response.record(transient_outputs(machine), samples)
    return SteadyMotion(speed, response, coupled_histories(machine, record), limit)
