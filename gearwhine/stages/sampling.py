"""Sampling of a transient: steps, record length, decimation and spectral windows.

Stepwise changes of the mesh force have harmonics without end. Samples are therefore taken at a hundred times the
highest frequency of interest: little folds back then, and the spectra of whole periods need no filter. A record that
fits in memory is kept like that, and its spectra are those of the whole. A longer one is filtered as it comes and kept
at four times that frequency: its histories and spectra are right up to there, which is also as far as the model's
modes go. Its spectra are averaged over stretches of whole revolutions, the last ones of the record.
"""

import math
from dataclasses import dataclass

import numpy as np

import coupling as room
from gearwhine.case import Case, CaseError, Problem, rotor_speeds, speed_ratios

_HERTZ = 2.0 * math.pi
_OVERSAMPLING = 100.0  # of the march over the highest frequency of interest
_FEWEST_SAMPLES = 16  # of a march: fewer show nothing
_KEPT_SAMPLING = 4.0  # of what is kept of long records: what folds onto that frequency is a wide transition away
RECORD_BYTES = 128 << 20
"""The longest record that is kept as it was sampled, all signals together."""
_STRETCH_BYTES = 64 << 20
_LONGEST_STRETCH = 1 << 18  # samples
_BLOCK_BYTES = 32 << 20
_LARGEST_BLOCK = 1 << 18  # samples


@dataclass(frozen=True)
class Sampling:
    """Sampling of a transient.

    Attributes
    ----------
    settings : coupling.TransientSettings
        Of the march.
    samples_per_block : int
        Of the march, about.
    decimation : coupling.Decimation
        From what is recorded to what is kept; by 1 for a record that fits in memory.
    stretch : int
        Kept samples over which a spectrum is taken.
    window : {"uniform", "hann"}
        Uniform where every shaft turns a whole number of times in a stretch.
    """

    settings: room.TransientSettings
    samples_per_block: int
    decimation: room.Decimation
    stretch: int
    window: room.Window

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
    turning: room.SpeedProfile | None,
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
        With an operation and a transient.
    turning : coupling.Turning or None
        Speed over time; None where it is the nominal one all along.
    limit : float
        Highest frequency of interest [Hz].
    signals, rows : int
        Numbers in a kept sample, and in one of the march.
    largest : int
        The longest record that is kept as it was sampled [bytes].
    block : int, optional
        Samples in a block, about; by default as many as suit the length.

    Raises
    ------
    CaseError
        Where more is discarded than a run turns.
    """
    assert case.operation is not None
    assert case.transient is not None
    given = case.transient
    nominal = _HERTZ / abs(case.operation.speed)
    period = nominal / (1.0 if turning is None else float(turning.rates.max()))
    per_revolution = _power_of_two(max(given.points_per_revolution, _OVERSAMPLING * limit * period))
    settings = room.TransientSettings(
        duration=transient_duration(case),
        record_from=_record_from(case, nominal, turning),
        sample_interval=period / per_revolution,
        largest_step=nominal / given.points_per_revolution,
        tolerance=given.tolerance,
        method=given.method,
    )
    if settings.samples < _FEWEST_SAMPLES:
        problem = Problem(
            "transient", f"a record of {settings.samples} samples", f"{_FEWEST_SAMPLES} or more: a longer run"
        )
        raise CaseError([problem])
    if 8 * signals * settings.samples <= largest:
        decimation = room.decimation(1, 0.25)
        return Sampling(settings, block or room.SAMPLES_PER_BLOCK, decimation, settings.samples, _window(case))
    kept_per_revolution = min(_power_of_two(_KEPT_SAMPLING * limit * period), per_revolution // 2)
    factor = per_revolution // kept_per_revolution
    decimation = room.decimation(factor, limit * period / kept_per_revolution)
    kept = decimation.kept(settings.samples)
    most = max(min(_LONGEST_STRETCH, _STRETCH_BYTES // (8 * signals)), kept_per_revolution)
    whole = math.lcm(*(ratio.denominator for ratio in speed_ratios(case).values()))
    repeats = turning is None and whole * kept_per_revolution <= min(most, kept)
    unit = kept_per_revolution * (whole if repeats else 1)
    units = max(kept // unit, 1)
    stretch = unit * (units // math.ceil(units * unit / most)) if unit <= kept else kept
    if block is None:
        block = min(max(_BLOCK_BYTES // (8 * rows), room.SAMPLES_PER_BLOCK), _LARGEST_BLOCK)
    return Sampling(settings, block, decimation, stretch, "uniform" if repeats else "hann")


def transient_duration(case: Case) -> float:
    """Duration of the transient [s]."""
    assert case.operation is not None
    assert case.transient is not None
    if case.transient.run is not None:
        return case.transient.run.duration
    assert case.transient.revolutions is not None
    return case.transient.revolutions * (_HERTZ / abs(case.operation.speed))


def _record_from(case: Case, period: float, turning: room.SpeedProfile | None) -> float:
    """When the discarded revolutions are done [s].

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
        turned = float(turning.at(duration)[0][0]) / period
        expected = f"fewer revolutions than the {turned:g} that the run turns"
        raise CaseError([Problem("transient.discard", discard, expected)])
    return time


def _power_of_two(least: float) -> int:
    return int(2 ** np.ceil(np.log2(max(least, 1.0))))


def _window(case: Case) -> room.Window:
    """Uniform where every shaft turns a whole number of times in the record."""
    assert case.transient is not None
    if case.transient.revolutions is None:
        return "hann"
    recorded = case.transient.revolutions - case.transient.discard
    turns = [recorded * abs(ratio) for ratio in rotor_speeds(case, 1.0).values()]
    return "uniform" if all(abs(turn - round(turn)) < 1e-9 for turn in turns) else "hann"
