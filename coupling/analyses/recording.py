"""Recording of a time integration in blocks: sampling, histories block by block, and their spectra.

Sampling: stepwise changes of the mesh force have harmonics without end. Samples are therefore taken at a hundred times
the highest frequency of interest: little folds back then, and the spectra of whole periods need no filter. They are
closer together where an excitation of a higher frequency asks for it, see
:mod:`gearwhine.coupling.machine.driving_frequencies`: an inverter's ripple above half the sampling rate would be
a false line. A record that fits in memory stays like that, and its spectra are those of the whole. A longer one is
filtered as it comes and stored at four times that frequency: its histories and spectra are right up to there, which is
also as far as the model's modes go. Its spectra are averaged over stretches of whole revolutions, the last ones of the
record.

Window: lines are exact where every shaft turns whole times and every excitation makes whole periods. Spectra are
therefore taken over the last such stretch of the record. Where the record holds none, and where a load varies over
time, Hann's window is taken; at constant speed the stretch then holds whole periods of the meshes at least, whose lines
keep their height.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, Literal, Protocol, get_args

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import (
    driving_frequencies,
    frequencies_of_elements,
    least_sampling_rate,
    varies_within,
)
from gearwhine.coupling.machine.speed_profile import FreeRun, SpeedProfile, SpeedRun
from gearwhine.coupling.signals.decimation import Decimation
from gearwhine.coupling.signals.decimation import decimation as coupled_decimation
from gearwhine.coupling.signals.spectrum import (
    Spectrum,
    Window,
    amplitude_spectrum,
    averaged_spectrum,
    whole_period_samples,
)
from gearwhine.coupling.time.histories import Histories, ModalRecord
from gearwhine.coupling.time.integration import SAMPLES_PER_BLOCK, Checkpoint
from gearwhine.coupling.time.settings import Method, TransientSettings
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Choice, Finding, Instance, Number, Rule, attribute_findings, refuse

Arrays = Mapping[str, npt.NDArray[Any]]
Start = Literal["equilibrium", "unloaded"]

_TWO_PI = 2.0 * math.pi
_OVERSAMPLING = 100.0  # sampling of the integration over the highest frequency of interest
_FEWEST_SAMPLES = 16  # least number of samples of an integration
_MOST_SAMPLES = 2_000_000_000  # largest number that an excitation may ask for: days of computing
_STORED_SAMPLING = 4.0  # sampling of stored long records over that frequency: aliases are a wide transition away
SHORTEST_RECORD = 0.01
"""Shortest record at constant speed, in revolutions of the first driver's shaft."""

RECORD_BYTES = 128 << 20
"""The longest record that is stored as it was sampled, all signals together."""
_STRETCH_BYTES = 64 << 20
_LONGEST_STRETCH = 1 << 18  # samples
_BLOCK_BYTES = 32 << 20
_LARGEST_BLOCK = 1 << 18  # samples
_WHOLE_PERIODS_TOLERANCE = 1e-6  # tolerance of a whole number of periods: a line leaks as large a part of its height
_NEARLY_ALL = 0.9  # least part of a record under Hann's window that is cut to whole periods of the meshes
_MOST_TURNS = 1000  # largest number of times that a period of the shafts is repeated until a driving frequency is whole


class Blocks(Protocol):
    """Blocks in their order, in memory or on file."""

    def __len__(self) -> int:
        """Return the number of blocks."""

    def append(self, arrays: Arrays, /) -> None:
        """Add the arrays of the next block."""

    def __getitem__(self, number: int, /) -> Arrays:
        """Return the arrays of a block."""


@dataclass(frozen=True)
class Sampling:
    """Sampling of a transient.

    Attributes
    ----------
    settings : gearwhine.coupling.TransientSettings
        Settings of the integration.
    samples_per_block : int
        Approximate number of the integration's samples in a block.
    decimation : Decimation
        Decimation from recorded to stored samples; by 1 for a record that fits in memory.
    stretch : int
        Number of stored samples over which a spectrum is taken.
    window : {"uniform", "hann"}
        Uniform where a stretch holds whole turns of every shaft and whole periods of every excitation.
    """

    settings: TransientSettings
    samples_per_block: int
    decimation: Decimation
    stretch: int
    window: Window

    @property
    def interval(self) -> float:
        """Interval between stored samples [s]."""
        return self.settings.sample_interval * self.decimation.factor

    @property
    def is_long(self) -> bool:
        """Whether the record is too long to be stored as sampled."""
        return self.decimation.factor > 1


@dataclass(frozen=True)
class TransientPlan:
    """Stretch of a machine's motion that is integrated and recorded.

    Attributes
    ----------
    revolutions : float or None
        Number of revolutions of the first driver's shaft at constant speed; either this or a run.
    run : SpeedRun, FreeRun or None
        Speed over time.
    discard : float, optional
        Revolutions before the record begins; by default half of the revolutions, or none of a run.
    points_per_revolution : int
        Least number of recorded samples of each revolution; no step is longer than the interval of so many.
    tolerance : float
        Tolerance of the local error of a step, see :class:`gearwhine.coupling.TransientSettings`.
    start : {"equilibrium", "unloaded"}
        Static equilibrium under the load; or straight shafts, teeth that just touch, and a load applied at once.
    method : {"newmark", "exact", "auto"}
    modal_coordinates : int
        Number of modes of each shaft, torsional and bending, and of the housing, that are recorded.
    indicators : bool
        Whether the results have condition indicators of a machine without damage, too.
    """

    revolutions: float | None = None
    run: Run | None = None
    discard: float | None = None
    points_per_revolution: int = 200
    tolerance: float = 5e-4
    start: Start = "equilibrium"
    method: Method = "newmark"
    modal_coordinates: int = 0
    indicators: bool = False

    def __post_init__(self) -> None:
        """Require a number of revolutions or a run, a stretch to record, and numbers that can be."""
        if self.revolutions is None and self.run is None:
            refuse(
                [Finding(_PART, "revolutions", "None", "a number above 0 of revolutions, or a 'run'")], CouplingError
            )
        if self.revolutions is not None and self.run is not None:
            expected = "no number of revolutions beside a 'run', which has its own time"
            refuse([Finding(_PART, "revolutions", self.revolutions, expected)], CouplingError)
        rules: dict[str, Rule] = {
            "revolutions": Number(above=0.0, at_most=1e6, optional=True),
            "run": Instance((SpeedRun, FreeRun), "a SpeedRun or a FreeRun, or None", optional=True),
            "discard": Number(at_least=0.0, optional=True),
            "points_per_revolution": Number(at_least=200, at_most=1_000_000, whole=True),
            "tolerance": Number(above=0.0, at_most=0.1),
            "start": Choice(get_args(Start)),
            "method": Choice(get_args(Method)),
            "modal_coordinates": Number(at_least=0, at_most=1000, whole=True),
        }
        refuse(attribute_findings(_PART, self, **rules), CouplingError)
        refuse(self._record_findings(), CouplingError)

    def _record_findings(self) -> Iterator[Finding]:
        """Yield revolutions of which nothing, or next to nothing, is recorded."""
        if self.revolutions is None or self.revolutions - self.discarded >= SHORTEST_RECORD:
            return
        if self.discarded >= self.revolutions:
            yield Finding(_PART, "discard", self.discard, f"fewer revolutions than the {self.revolutions:g} of the run")
        else:
            expected = f"{SHORTEST_RECORD:g} or more revolutions than 'discard', which are recorded"
            yield Finding(_PART, "revolutions", self.revolutions, expected)

    @property
    def discarded(self) -> float:
        """Revolutions before the record begins."""
        if self.discard is not None:
            return self.discard
        return 0.0 if self.revolutions is None else 0.5 * self.revolutions

    def duration(self, period: float) -> float:
        """Duration [s] of a machine whose first driver's shaft turns once in a period [s]."""
        if self.run is not None:
            return self.run.duration
        assert self.revolutions is not None
        return self.revolutions * period

    def record_from(self, period: float, profile: SpeedProfile | None) -> float:
        """Return the time at which the discarded revolutions end [s].

        Raises
        ------
        CouplingError
            Where a run does not turn so far.
        """
        if profile is None or self.discarded == 0.0:
            return self.discarded * period
        time, duration = float(profile.times_of(np.array([self.discarded * period]))[0]), self.duration(period)
        if not time < duration:
            revolutions = float(profile.at(duration)[0][0]) / period
            expected = f"fewer revolutions than the {revolutions:g} that the run turns"
            refuse([Finding(_PART, "discard", self.discard, expected)], CouplingError)
        return time


_PART = ("transient", "")


def sampling(
    machine: CoupledMachine,
    plan: TransientPlan,
    limit: float,
    signals: int,
    rows: int,
    *,
    largest: int = RECORD_BYTES,
    block: int | None = None,
) -> Sampling:
    """Choose how a machine's motion is sampled: for its highest speed, where that varies.

    Parameters
    ----------
    machine : CoupledMachine
        Machine whose motion is sampled: its excitations decide on the window.
    plan : TransientPlan
    limit : float
        Highest frequency of interest [Hz].
    signals, rows : int
        Numbers of values in a stored sample, and in a sample of the integration.
    largest : int
        Size of the longest record that is stored as it was sampled [bytes].
    block : int, optional
        Approximate number of samples in a block; by default as many as suit their size.

    Raises
    ------
    CouplingError
        Where more is discarded than a run turns, or an excitation asks for samples without end.
    """
    system, profile = machine.system, machine.speed_profile
    nominal = _TWO_PI / abs(machine.speed)
    fastest = 1.0 if profile is None else float(profile.speed_ratios.max())
    period = nominal / fastest
    duration, record_from = plan.duration(nominal), plan.record_from(nominal, profile)
    rate, exciting = least_sampling_rate(system, record_from, duration, fastest=fastest)
    if rate * duration > _MOST_SAMPLES:
        raise CouplingError(
            f"transient: an excitation at {exciting:.4g} Hz asks for {rate * duration:.2g} samples in "
            f"{duration:.4g} s; expected at most {_MOST_SAMPLES:g} of them: a lower frequency, or a shorter run"
        )
    per_revolution = _power_of_two(max(plan.points_per_revolution, _OVERSAMPLING * limit * period, rate * period))
    settings = TransientSettings(
        duration=duration,
        record_from=record_from,
        sample_interval=period / per_revolution,
        largest_step=nominal / plan.points_per_revolution,
        tolerance=plan.tolerance,
        method=plan.method,
    )
    if settings.samples < _FEWEST_SAMPLES:
        raise CouplingError(
            f"transient: a record of {settings.samples} samples; expected {_FEWEST_SAMPLES} or more: a longer run"
        )
    steady = profile is None and not varies_within(system, settings.record_from, settings.duration)
    orders = _driving_orders(system, nominal)
    if 8 * signals * settings.samples <= largest:
        window: Window = "hann"
        stretch = settings.samples
        if profile is None:
            stretch, window = _whole_stretch(machine, orders if steady else None, per_revolution, stretch)
        return Sampling(settings, block or SAMPLES_PER_BLOCK, coupled_decimation(1, 0.25), stretch, window)
    stored_per_revolution = min(_power_of_two(_STORED_SAMPLING * limit * period), per_revolution // 2)
    factor = per_revolution // stored_per_revolution
    decimation = coupled_decimation(factor, limit * period / stored_per_revolution)
    stored = decimation.kept(settings.samples)
    most = max(min(_LONGEST_STRETCH, _STRETCH_BYTES // (8 * signals)), stored_per_revolution)
    whole = _period(machine, orders) if steady else None
    repeats = whole is not None and whole * stored_per_revolution <= min(most, stored)
    unit = stored_per_revolution * (whole if whole is not None and repeats else 1)
    units = max(stored // unit, 1)
    stretch = unit * (units // math.ceil(units * unit / most)) if unit <= stored else stored
    if block is None:
        block = min(max(_BLOCK_BYTES // (8 * rows), SAMPLES_PER_BLOCK), _LARGEST_BLOCK)
    return Sampling(settings, block, decimation, stretch, "uniform" if repeats else "hann")


def _power_of_two(least: float) -> int:
    return int(2 ** np.ceil(np.log2(max(least, 1.0))))


def _driving_orders(system: CoupledSystem, revolution: float) -> list[float]:
    """Driving frequencies, with those of rolling elements, over that of the first driver."""
    frequencies = [*driving_frequencies(system).values(), *frequencies_of_elements(system)]
    return sorted({revolution * frequency for frequency in frequencies})


def _whole_stretch(
    machine: CoupledMachine, orders: list[float] | None, per_revolution: int, samples: int
) -> tuple[int, Window]:
    """Return the number of samples at the end of a record that hold whole periods, and the window for them.

    The stretch has whole periods of all shafts and orders; else, under Hann's window, of the first driver's shaft and
    the meshes, where it is nearly all of the record; else it is the whole record. ``orders`` is None where a load
    varies in the record.
    """
    if orders is not None:
        turns = [abs(float(ratio)) for ratio in _felt_turns(machine)]
        whole = whole_period_samples(samples, 1.0 / per_revolution, [*turns, *orders])
        if whole is not None:
            return whole, "uniform"
    meshes = [abs(contact.mesh_frequency) * _TWO_PI / abs(machine.speed) for contact in machine.system.contacts]
    whole = whole_period_samples(samples, 1.0 / per_revolution, [1.0, *meshes], least=_NEARLY_ALL)
    return whole or samples, "hann"


def _felt_turns(machine: CoupledMachine) -> list[Fraction]:
    """Speeds of the shafts over the leading one's, but for planets.

    A planet's rotation is felt by its unbalance and its teeth alone, which have orders of their own; with it, few
    records of a planetary set would hold whole periods.
    """
    carried = {rotor.name for rotor in machine.rotors if rotor.carrier is not None}
    return [ratio for name, ratio in machine.speed_ratios.items() if name not in carried]


def _period(machine: CoupledMachine, orders: list[float]) -> int | None:
    """Fewest revolutions of the first driver in which all shafts and orders repeat; None where there are none."""
    whole = math.lcm(*(ratio.denominator for ratio in _felt_turns(machine)))
    for order in orders:
        periods = Fraction(whole * order).limit_denominator(_MOST_TURNS)
        whole *= periods.denominator
        if abs(whole * order - round(whole * order)) > _WHOLE_PERIODS_TOLERANCE:
            return None
    return whole


def block_arrays(columns: FloatArray, filter_state: FloatArray, after: Checkpoint) -> Arrays:
    """Return the stored arrays of a block: its samples, the filter's state, and the state to restart from."""
    return {"columns": columns, "held": filter_state, **after.as_arrays()}


@dataclass(frozen=True)
class Signals:
    """Recorded signals of a transient: histories, and the modal motion behind them."""

    histories: Histories
    modal: ModalRecord

    @property
    def times(self) -> FloatArray:
        """Times [s], shape (s,)."""
        return self.histories.times

    @property
    def columns(self) -> FloatArray:
        """All signals side by side, shape (s, k)."""
        return np.concatenate([self.histories.columns, self.modal.columns], axis=1)

    def with_columns(self, times: FloatArray, columns: FloatArray) -> "Signals":
        """Other samples of the same signals, from what :attr:`columns` gives."""
        modal = self.modal.columns.shape[1]
        split = columns.shape[1] - modal
        return Signals(
            self.histories.with_columns(times, columns[:, :split]), self.modal.with_columns(columns[:, split:])
        )


@dataclass(frozen=True)
class TransientRecord:
    """The record of a finished time integration.

    Attributes
    ----------
    sampling : Sampling
    blocks : Blocks
        Blocks of the record, at least one.
    signals : Signals
        Names of the signals; samples in it do not count.
    """

    sampling: Sampling
    blocks: Blocks
    signals: Signals

    @property
    def end(self) -> Checkpoint:
        """State at the end of the integration."""
        return Checkpoint.from_arrays(self.blocks[len(self.blocks) - 1])

    @property
    def samples(self) -> int:
        """Number of stored samples."""
        return self.sampling.decimation.kept(self.end.sample)

    def pieces(self) -> Iterator[Signals]:
        """Yield the histories, block by block."""
        done = 0
        for number in range(len(self.blocks)):
            columns = self.blocks[number]["columns"]
            yield self._named(columns, done)
            done += len(columns)

    def stretches(self) -> Iterator[Signals]:
        """Yield the histories in stretches of equal length, the last of which ends with the record."""
        length = min(self.sampling.stretch, self.samples)
        skipped = self.samples % length
        waiting, done = self.signals.columns[:0], 0
        for piece in self.pieces():
            columns = piece.columns
            if skipped:
                dropped = min(skipped, len(columns))
                columns, skipped, done = columns[dropped:], skipped - dropped, done + dropped
            waiting = np.concatenate([waiting, columns]) if len(waiting) else columns
            while len(waiting) >= length:
                yield self._named(waiting[:length], done)
                waiting, done = waiting[length:], done + length

    def last_stretch(self) -> Signals:
        """Return the last stretch; of a record that fits in memory, all of it."""
        length = min(self.sampling.stretch, self.samples)
        parts: list[FloatArray] = []
        for number in reversed(range(len(self.blocks))):
            parts.insert(0, self.blocks[number]["columns"])
            if sum(map(len, parts)) >= length:
                break
        columns = parts[0] if len(parts) == 1 else np.concatenate(parts)
        return self._named(columns[len(columns) - length :], self.samples - length)

    def _named(self, columns: FloatArray, first: int) -> Signals:
        """Return the samples under their names, counted from a first one."""
        recorded = self.sampling.decimation.delay + self.sampling.decimation.factor * np.arange(
            first, first + len(columns), dtype=np.float64
        )
        settings = self.sampling.settings
        return self.signals.with_columns(settings.record_from + settings.sample_interval * recorded, columns)

    def spectrum(self, stretch: FloatArray, limit: float) -> Spectrum:
        """Return the lines of signals over one stretch, shape (..., s); of a long record up to a limit [Hz]."""
        spectrum = amplitude_spectrum(stretch, self.sampling.interval, self.sampling.window)
        return _below(spectrum, limit) if self.sampling.is_long else spectrum


def record_spectra(
    record: TransientRecord, last: Histories, limit: float
) -> tuple[dict[str, Spectrum], dict[str, Spectrum]]:
    """Spectra of the sensors' accelerations and of the mesh forces.

    A record that fits in memory is given whole, as ``last``; the spectra of a long record are averaged over its
    stretches, up to the limit [Hz] below which all of it is stored.
    """
    sensors, meshes = list(last.sensor_acceleration), list(last.mesh_force)
    if not record.sampling.is_long:
        of_sensors, of_meshes = (
            {name: record.spectrum(signal, limit) for name, signal in group.items()}
            for group in (last.sensor_acceleration, last.mesh_force)
        )
        return of_sensors, of_meshes
    if not sensors and not meshes:
        return {}, {}
    rows = (
        np.array([*stretch.histories.sensor_acceleration.values(), *stretch.histories.mesh_force.values()])
        for stretch in record.stretches()
    )
    together = _below(averaged_spectrum(rows, record.sampling.interval, record.sampling.window), limit)
    spectra = [
        replace(together, amplitude=amplitude, phase=phase)
        for amplitude, phase in zip(together.amplitude, together.phase, strict=True)
    ]
    return dict(zip(sensors, spectra, strict=False)), dict(zip(meshes, spectra[len(sensors) :], strict=True))


def _below(spectrum: Spectrum, limit: float) -> Spectrum:
    """Return the lines up to a limit [Hz], and two more: a peak at the limit stands out only beside its neighbours."""
    count = int(np.searchsorted(spectrum.frequencies, limit + 2.0 * spectrum.frequencies[1], side="right"))
    return replace(
        spectrum,
        frequencies=spectrum.frequencies[:count],
        amplitude=spectrum.amplitude[..., :count],
        phase=spectrum.phase[..., :count],
    )
