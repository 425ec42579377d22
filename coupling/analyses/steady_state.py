"""Steady state of a machine: the periodic motion under its excitation, and the branch of such motions over speed."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import least_sampling_rate
from gearwhine.coupling.periodic.continuation import ResponseCurve, response_curve
from gearwhine.coupling.periodic.response import PeriodicResponse
from gearwhine.coupling.periodic.settled_curve import settled_curve
from gearwhine.coupling.periodic.settling import SettledMotion, circles, settled_response
from gearwhine.coupling.periodic.shooting import periodic_response
from gearwhine.coupling.periodic.superposition import (
    ExcitationGroup,
    SuperposedResponse,
    common_cycles,
    excitation_groups,
    superposed_response,
)
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.coupling.signals.spectrum import SignalParts, Spectrum, amplitude_spectrum, signal_parts
from gearwhine.coupling.time.histories import Histories, modal_record, transient_outputs, with_modal_rows
from gearwhine.coupling.time.histories import histories as coupled_histories
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning

FloatArray = npt.NDArray[np.float64]

_RPM = 60.0 / (2.0 * np.pi)
_OVERSAMPLING = 32.0  # sampling of a period over the highest frequency of interest: little folds back below it
_LEAST_SAMPLES = 512
_HARMONICS = 4.0  # mesh harmonics of interest where no housing limits the model
_LINES = 20  # reported lines of each signal
_LONG_HUNTING = 300  # mesh periods after which the same teeth meet from which a steady motion takes long
_NAMED_LINE_DISTANCE = 1e-3  # distance of a line from the excitation that it is named after, over the spacing of lines
_DOUBTFUL_FORCE_SHARE = 0.1  # part of a mesh's varying force that may be neglected without a warning

_NARROW_RANGE_SHARE = 0.01  # width over that of the whole range below which ranges are told together
_WHY_NOT_SETTLED = "the motion settles at none of the points there; `run` shows what the machine does"
_WHY_NOT = (
    "the branch is lost there and no other start led to a motion; --points 400 takes shorter steps, a narrower [sweep] "
    "more of them, and `run` or `sweep` shows what the machine does there"
)

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
    """

    speed: float
    response: PeriodicResponse | SettledMotion
    histories: Histories
    trusted_limit: float
    excitation: str = ""

    def spectrum(self, signal: FloatArray) -> Spectrum:
        """Lines of a signal of the histories, exact."""
        return amplitude_spectrum(signal, self.response.period / len(signal))

    @property
    def reported_lines(self) -> int:
        """Number of the highest lines of a signal that are reported."""
        return _LINES

    def lines(self, signal: FloatArray, limit: float = np.inf) -> list[tuple[float, float, float]]:
        """Frequencies [Hz], amplitudes and phases [rad] of a signal's highest lines up to a limit [Hz].

        Each is a whole number of times the period's frequency; the phase is that of its cosine at t = 0.
        """
        spectrum = self.spectrum(signal)
        inside = np.flatnonzero((spectrum.frequencies > 0.0) & (spectrum.frequencies <= limit * (1.0 + 1e-9)))
        highest = inside[np.argsort(-spectrum.amplitude[inside], kind="stable")][:_LINES]
        return [
            (float(spectrum.frequencies[i]), float(spectrum.amplitude[i]), float(spectrum.phase[i]))
            for i in highest
            if spectrum.amplitude[i] > 0.0
        ]

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
    """

    machine: CoupledMachine
    motions: tuple[SteadyMotion, ...]
    curve: ResponseCurve | None = None
    branch_rms: dict[str, FloatArray] = field(default_factory=dict)
    superposed: SuperposedResponse | None = None
    loudest: tuple[LoudestPoint, ...] = ()
    assumed_damping: tuple[str, ...] = ()

    @property
    def contact_loss(self) -> FloatArray:
        """Largest part of the time in which the flanks of each contact are apart in any of the motions, shape (c,)."""
        losses = [motion.response.contact_loss for motion in self.motions]
        losses += [] if self.superposed is None else [self.superposed.contact_loss]
        losses += [] if self.curve is None else [self.curve.contact_loss.max(axis=0)]
        return np.asarray(np.max(losses, axis=0))

    def bearing_parts(self, motion: SteadyMotion | None = None) -> list[tuple[str, SignalParts]]:
        """Mean and alternating part of each bearing's load in one motion, or in all that are superposed.

        Forces along x, y, z [N] and moments about x, y [N m]; the peak of superposed motions is a bound.
        """
        motions = self.motions if motion is None else (motion,)
        loads = []
        for name in motions[0].histories.bearing_load:
            parts = [signal_parts(motion.histories.bearing_load[name].T) for motion in motions]
            # Each group's motion has the mean load; of different frequencies the powers add.
            mean, rms = np.mean([part.mean for part in parts], axis=0), np.hypot.reduce([part.rms for part in parts])
            loads.append((name, SignalParts(mean, rms, np.sum([part.peak for part in parts], axis=0))))
        return loads

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
            message = (
                f"superposed motions are doubtful at {contact.name}: {text}; hold them against run, or use --exact"
            )
            warnings.append(
                warning("superposition", message, contact=contact.name, neglected_part=part, contact_loss=loss)
            )
        return warnings


def solve_steady(
    machine: CoupledMachine,
    progress: Progress = silent,
    *,
    over_speed: tuple[float, float] | None = None,
    points: int = 100,
    exact: bool = False,
) -> SolvedSteady:
    """Find the motion that repeats at the speed of operation, and where asked follow it over speed.

    Where carriers turn, the motion is the one in which the machine settles, see
    :mod:`gearwhine.coupling.periodic.settling`; over speed it is settled anew at each of the points.

    If the common period of all excitations is long, such as that of hunting teeth, each group of excitations has its
    own motion and these are superposed, see :mod:`gearwhine.coupling.periodic.superposition`.

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

    Raises
    ------
    gearwhine.coupling.CouplingError
        Where the machine stands still, the excitation does not repeat, or a branch is asked for of motions that are
        superposed.
    gearwhine.coupling.PeriodicError
        Where no motion is found. A branch that is lost on its way is given as far as it was followed.
    """
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
    groups = () if exact or turning else excitation_groups(machine.system)
    if len(groups) > 1 and over_speed is not None:
        cycles = common_cycles(machine.system)
        raise CouplingError(f"expected {_NO_BRANCH.format(_period_in_words(cycles))}")
    hunting = max((contact.contact.hunting_period for contact in machine.system.contacts if contact.loaded), default=1)
    if hunting > _LONG_HUNTING:
        progress(f"a motion over {hunting} mesh periods, after which the same teeth meet: `run` takes less time")
    if len(groups) > 1:
        return _superposed(machine, speed, groups, progress)
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
    motions = tuple(
        replace(
            _motion(replace(machine, loads=of_group), speed, one.response),
            excitation=one.name,
        )
        for one in superposed.motions
        for of_group in [loads if loads.base is None else replace(loads, base=one.group.part_of(loads.base))]
    )
    return SolvedSteady(machine, motions, superposed=superposed)


def _motion(machine: CoupledMachine, speed: float, response: PeriodicResponse | SettledMotion) -> SteadyMotion:
    """Motion of a machine at its speed; it carries some harmonics of the meshes where no housing limits the model."""
    limit = _HARMONICS * max((abs(contact.mesh_frequency) for contact in machine.system.contacts), default=250.0)
    if machine.housing is not None and machine.housing.complete_below is not None:
        limit = machine.housing.complete_below / (2.0 * np.pi)
    rate = max(_OVERSAMPLING * limit, least_sampling_rate(response.system)[0])
    samples = 2 ** math.ceil(math.log2(max(rate * response.period, _LEAST_SAMPLES)))
    record = response.record(transient_outputs(machine), samples)
    return SteadyMotion(speed, response, coupled_histories(machine, record), limit)
