"""Record of a time integration in blocks: sampling, checkpoint files, histories block by block, and their spectra.

Checkpoints: a run stores its blocks in a hidden folder of the output folder, each with the state after it, for a later
restart. The folder bears the key of everything that the integration depends on, and goes when the results are written.
A block and its checkpoint are one file that appears whole: it is written beside, forced to the disk, and renamed. A run
that is killed, interrupted or fails leaves its blocks; the next run with the same key goes on behind the last one
before any damage. A run of anything else clears them away.

Sampling: stepwise changes of the mesh force have harmonics without end. Samples are therefore taken at a hundred times
the highest frequency of interest: little folds back then, and the spectra of whole periods need no filter. They are
closer together where an excitation of a higher frequency asks for it, see
:mod:`gearwhine.coupling.machine.driving_frequencies`: an inverter's ripple above half the sampling rate would be a
false line. A record that fits in memory stays like that, and its spectra are those of the whole. A longer one is
filtered as it comes and stored at four times that frequency: its histories and spectra are right up to there, which is
also as far as the model's modes go. Its spectra are averaged over stretches of whole revolutions, the last ones of the
record.

Window: lines are exact where every shaft turns whole times and every excitation makes whole periods. Spectra are
therefore taken over the last such stretch of the record. Where the record holds none, and where a load varies over
time, Hann's window is taken; at constant speed the stretch then holds whole periods of the meshes at least, whose lines
keep their height.
"""

import math
import os
import shutil
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, CaseError, Problem, speed_ratios
from gearwhine.coupling import CoupledSystem, SpeedProfile, TransientSettings, amplitude_spectrum
from gearwhine.coupling.machine.driving_frequencies import (
    driving_frequencies,
    element_passes,
    least_sampling_rate,
    varies_within,
)
from gearwhine.coupling.signals.decimation import Decimation
from gearwhine.coupling.signals.decimation import decimation as coupled_decimation
from gearwhine.coupling.signals.spectrum import Spectrum, Window, averaged_spectrum, whole_period_samples
from gearwhine.coupling.time.histories import Histories, ModalRecord
from gearwhine.coupling.time.integration import SAMPLES_PER_BLOCK, Checkpoint
from gearwhine.output.files import exclusive_lock, held_lock, is_locked, room_named

_FOLDER_PREFIX = ".resume-"
_KEY_DIGITS = 16  # digits of the key in the folder's name: no two integrations of one folder share them by chance

Arrays = Mapping[str, npt.NDArray[Any]]
FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * math.pi
_OVERSAMPLING = 100.0  # sampling of the integration over the highest frequency of interest
_FEWEST_SAMPLES = 16  # least number of samples of an integration
_MOST_SAMPLES = 2_000_000_000  # largest number that an excitation may ask for: days of computing
_STORED_SAMPLING = 4.0  # sampling of stored long records over that frequency: aliases are a wide transition away
RECORD_BYTES = 128 << 20
"""The longest record that is stored as it was sampled, all signals together."""
_STRETCH_BYTES = 64 << 20
_LONGEST_STRETCH = 1 << 18  # samples
_BLOCK_BYTES = 32 << 20
_LARGEST_BLOCK = 1 << 18  # samples
_WHOLE = 1e-6  # tolerance of a whole number of periods: a line leaks as large a part of its height
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


class BlockFiles:
    """Blocks in a folder, one file each; those behind a damaged or missing one do not count."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        # All are read: a disk, a copy or another program damages any of them, not only the last one written.
        while self._is_whole(self._count):
            self._count += 1

    def __len__(self) -> int:
        """Return the number of whole blocks, up to the first damaged or missing one."""
        return self._count

    @property
    def is_empty(self) -> bool:
        """Whether no block is on file, an uncounted one of an interruption included."""
        return not self._file(0).exists()

    def append(self, arrays: Arrays) -> None:
        """Write the next block: after this call it is there, whatever happens."""
        target = self._file(self._count)
        beside = target.with_suffix(".part")
        try:
            with beside.open("wb") as file:
                np.savez(file, allow_pickle=False, **arrays)
                file.flush()
                os.fsync(file.fileno())
            os.replace(beside, target)
        except OSError:
            beside.unlink(missing_ok=True)
            raise
        _force_names(self._folder)
        self._count += 1

    def __getitem__(self, number: int) -> Arrays:
        """Read the arrays of a block."""
        return self._read(range(self._count)[number])

    def _file(self, number: int) -> Path:
        return self._folder / f"block-{number:08d}.npz"

    def _read(self, number: int) -> Arrays:
        with self._file(number).open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}

    def _is_whole(self, number: int) -> bool:
        """Whether a block is there and every array in it has the checksum that was written with it."""
        try:
            with zipfile.ZipFile(self._file(number)) as file:
                return bool(file.namelist()) and file.testzip() is None
        # A damaged header claims a compression, an encryption or a length that no block has.
        except (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error, struct.error):
            return False


@contextmanager
def stored_record(folder: Path, key: str, *, fresh: bool = False) -> Iterator[BlockFiles]:
    """Checkpoint blocks in an output folder under a key, removed when the work inside ends well.

    If a living run performs the same integration in the same folder, this one stores blocks of its own.

    Parameters
    ----------
    folder : path
        The output folder.
    key : str
        Key of all inputs of the blocks.
    fresh : bool
        Whether to remove stored blocks, and begin anew.
    """
    is_new = not folder.exists()
    with room_named(folder), ExitStack() as stack:
        with exclusive_lock(folder):
            place = _place(folder, f"{_FOLDER_PREFIX}{key[:_KEY_DIGITS]}", fresh=fresh)
            stack.enter_context(held_lock(place))
        blocks = BlockFiles(place)
        try:
            yield blocks
        except BaseException as error:
            if blocks.is_empty:
                _clear(place, folder if is_new else None)
            elif isinstance(error, KeyboardInterrupt | OSError):
                error.add_note(
                    f"what was marched so far is kept in {place}: the same command goes on from there, --fresh does not"
                )
            raise
        _clear(place, None)


def _place(folder: Path, name: str, *, fresh: bool) -> Path:
    """Return a folder for the blocks, after those of any other ended run are cleared away."""
    target = folder / name
    for candidate in folder.glob(f"{_FOLDER_PREFIX}*"):
        if (
            candidate.is_dir()
            and not candidate.is_symlink()
            and (fresh or candidate != target)
            and not is_locked(candidate)
        ):
            shutil.rmtree(candidate, ignore_errors=True)
    if target.exists() and is_locked(target):
        return Path(tempfile.mkdtemp(prefix=f"{name}-", dir=folder))
    target.mkdir(exist_ok=True)
    return target


def _clear(place: Path, created: Path | None) -> None:
    shutil.rmtree(place, ignore_errors=True)
    if created is not None:
        with suppress(OSError):  # another run is at work in it
            created.rmdir()


def _force_names(folder: Path) -> None:
    """Force a folder's entries to the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


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


def sampling(
    case: Case,
    system: CoupledSystem,
    turning: SpeedProfile | None,
    limit: float,
    signals: int,
    rows: int,
    *,
    largest: int = RECORD_BYTES,
    block: int | None = None,
) -> Sampling:
    """Choose how a case is sampled: for its highest speed, where that varies.

    Parameters
    ----------
    case : Case
        Case with an operation and a transient.
    system : CoupledSystem
        System whose motion is sampled: its excitations decide on the window.
    turning : SpeedProfile or None
        Speed over time; None where it is the nominal one all along.
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
    CaseError
        Where more is discarded than a run turns, or an excitation asks for samples without end.
    """
    assert case.operation is not None
    assert case.transient is not None
    transient = case.transient
    nominal = _TWO_PI / abs(case.operation.speed)
    fastest = 1.0 if turning is None else float(turning.speed_ratios.max())
    period = nominal / fastest
    duration, record_from = transient_duration(case), _record_from(case, nominal, turning)
    rate, exciting = least_sampling_rate(system, record_from, duration, fastest=fastest)
    if rate * duration > _MOST_SAMPLES:
        told = f"an excitation at {exciting:.4g} Hz, which asks for {rate * duration:.2g} samples in {duration:.4g} s"
        expected = f"at most {_MOST_SAMPLES:g} of them: a lower frequency, or a shorter run"
        raise CaseError([Problem("transient", told, expected)])
    per_revolution = _power_of_two(max(transient.points_per_revolution, _OVERSAMPLING * limit * period, rate * period))
    settings = TransientSettings(
        duration=duration,
        record_from=record_from,
        sample_interval=period / per_revolution,
        largest_step=nominal / transient.points_per_revolution,
        tolerance=transient.tolerance,
        method=transient.method,
    )
    if settings.samples < _FEWEST_SAMPLES:
        problem = Problem(
            "transient", f"a record of {settings.samples} samples", f"{_FEWEST_SAMPLES} or more: a longer run"
        )
        raise CaseError([problem])
    steady = turning is None and not varies_within(system, settings.record_from, settings.duration)
    orders = _driving_orders(system, nominal)
    if 8 * signals * settings.samples <= largest:
        window: Window = "hann"
        stretch = settings.samples
        if turning is None:
            stretch, window = _whole_stretch(case, system, orders if steady else None, per_revolution, stretch)
        return Sampling(settings, block or SAMPLES_PER_BLOCK, coupled_decimation(1, 0.25), stretch, window)
    stored_per_revolution = min(_power_of_two(_STORED_SAMPLING * limit * period), per_revolution // 2)
    factor = per_revolution // stored_per_revolution
    decimation = coupled_decimation(factor, limit * period / stored_per_revolution)
    stored = decimation.kept(settings.samples)
    most = max(min(_LONGEST_STRETCH, _STRETCH_BYTES // (8 * signals)), stored_per_revolution)
    whole = _period(case, orders) if steady else None
    repeats = whole is not None and whole * stored_per_revolution <= min(most, stored)
    unit = stored_per_revolution * (whole if whole is not None and repeats else 1)
    units = max(stored // unit, 1)
    stretch = unit * (units // math.ceil(units * unit / most)) if unit <= stored else stored
    if block is None:
        block = min(max(_BLOCK_BYTES // (8 * rows), SAMPLES_PER_BLOCK), _LARGEST_BLOCK)
    return Sampling(settings, block, decimation, stretch, "uniform" if repeats else "hann")


def transient_duration(case: Case) -> float:
    """Duration of the transient [s]."""
    assert case.operation is not None
    assert case.transient is not None
    if case.transient.run is not None:
        return case.transient.run.duration
    assert case.transient.revolutions is not None
    return case.transient.revolutions * (_TWO_PI / abs(case.operation.speed))


def _record_from(case: Case, period: float, turning: SpeedProfile | None) -> float:
    """Return the time at which the discarded revolutions end [s].

    Raises
    ------
    CaseError
        Where a run does not turn so far.
    """
    assert case.transient is not None
    discard = case.transient.discard
    if turning is None or discard == 0.0:
        return discard * period
    time = float(turning.times_of(np.array([discard * period]))[0])
    duration = transient_duration(case)
    if not time < duration:
        revolutions = float(turning.at(duration)[0][0]) / period
        expected = f"fewer revolutions than the {revolutions:g} that the run turns"
        raise CaseError([Problem("transient.discard", discard, expected)])
    return time


def _power_of_two(least: float) -> int:
    return int(2 ** np.ceil(np.log2(max(least, 1.0))))


def _driving_orders(system: CoupledSystem, revolution: float) -> list[float]:
    """Driving frequencies, with those of rolling elements, over that of the first driver."""
    passes = [frequency for frequencies in element_passes(system).values() for frequency in frequencies]
    return sorted({revolution * frequency for frequency in [*driving_frequencies(system).values(), *passes]})


def _whole_stretch(
    case: Case, system: CoupledSystem, orders: list[float] | None, per_revolution: int, samples: int
) -> tuple[int, Window]:
    """Return the number of samples at the end of a record that hold whole periods, and the window for them.

    The stretch has whole periods of all shafts and orders; else, under Hann's window, of the first driver's shaft and
    the meshes, where it is nearly all of the record; else it is the whole record. ``orders`` is None where a load
    varies in the record.
    """
    if orders is not None:
        turns = [abs(float(ratio)) for ratio in speed_ratios(case).values()]
        whole = whole_period_samples(samples, 1.0 / per_revolution, [*turns, *orders])
        if whole is not None:
            return whole, "uniform"
    assert case.operation is not None
    meshes = [abs(contact.mesh_frequency) * _TWO_PI / abs(case.operation.speed) for contact in system.contacts]
    whole = whole_period_samples(samples, 1.0 / per_revolution, [1.0, *meshes], least=_NEARLY_ALL)
    return whole or samples, "hann"


def _period(case: Case, orders: list[float]) -> int | None:
    """Fewest revolutions of the first driver in which all shafts and orders repeat; None where there are none."""
    whole = math.lcm(*(ratio.denominator for ratio in speed_ratios(case).values()))
    for order in orders:
        periods = Fraction(whole * order).limit_denominator(_MOST_TURNS)
        whole *= periods.denominator
        if abs(whole * order - round(whole * order)) > _WHOLE:
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
