"""Record of a machine's condition: its sensors up to the trusted limit, and their averages by the turns of each shaft.

The tachometer of a shaft is its nominal rotation, which the model knows exactly, at varying speed, too. A sensor is
low-passed at the limit up to which the housing's modes are complete: beyond, its signal is none that the model vouches
for. The discarded part of a motion is no part of it.

A gear's average stands for its teeth where its mesh frequency is a multiple of the turn of its shaft. It is none of a
planet, whose axis turns, nor of the gears that mesh with planets.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import get_args

import numpy as np

from gearwhine.coupling.analyses.transient import SolvedTransient
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.signals.condition_indicators import synchronous_average
from gearwhine.coupling.signals.decimation import Decimation, decimation
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings import CageFault, RollingSpall
from gearwhine.rotors.rolling_bearings.spalls import Place

LEAST_TURNS = 4
"""Fewest turns of a shaft that are averaged."""
_TWO_PI = 2.0 * math.pi
_SAMPLING = 4.0  # least sampling rate of a record over the trusted limit
_FINER = 4  # times that by which a record is sampled where it is interpolated at a shaft's angles
_EDGE = 10  # samples of a stored record at each end that the interpolating filter does not reach
_WHOLE_ORDER = 1e-9
_REJECTION, _TRANSITION = 60.0, 0.15  # of the filter at the limit [dB], and its width over the limit


@dataclass(frozen=True)
class MonitoredGear:
    """A gear whose teeth are watched.

    Attributes
    ----------
    gear, shaft : str
    teeth : int
        Number of teeth.
    others : tuple of int
        Numbers of teeth of further gears on the shaft.
    turn_hz : float
        Turns of the shaft in a second, of a run its nominal ones.
    turns : int
        Whole turns of the shaft in the record.
    undefined : str
        Why there is no average; empty where there is one.
    """

    gear: str
    shaft: str
    teeth: int
    others: tuple[int, ...]
    turn_hz: float
    turns: int
    undefined: str = ""


@dataclass(frozen=True, eq=False)
class ConditionRecord:
    """Signals of a machine's sensors from which condition indicators follow.

    Attributes
    ----------
    limit_hz : float
        Frequency up to which the signals are those of the model.
    interval : float
        Time between samples of the signals [s].
    gears : tuple of MonitoredGear
    signals : dict of str to ndarray, shape (s,)
        Acceleration by sensor [m/s²].
    averages : dict of (str, str) to ndarray, shape (n,)
        Average over a turn by shaft and sensor [m/s²].
    unsettled : dict of (str, str) to ndarray, shape (n,)
        Half the difference of the averages over the first and the second half of the turns [m/s²]: what an average is
        not sure of, as a motion that settles still, or parts that repeat over more turns.
    tones_hz : dict of str to float
        Characteristic frequencies of rolling bearings.
    is_steady : bool
        Whether the speed is constant, which spectra of time need.
    """

    limit_hz: float
    interval: float
    gears: tuple[MonitoredGear, ...]
    signals: dict[str, FloatArray]
    averages: dict[tuple[str, str], FloatArray]
    unsettled: dict[tuple[str, str], FloatArray] = field(default_factory=dict)
    tones_hz: dict[str, float] = field(default_factory=dict)
    is_steady: bool = True

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors."""
        return tuple(self.signals)


def bearing_tones(machine: Machine) -> dict[str, float]:
    """Characteristic frequencies of the rolling bearings of a machine [Hz], by "bearing: outer raceway" and the like.

    Of the first row of each; those of raceways and elements, and of cages that are damaged.
    """
    return dict(_bearing_tones(machine))


def _bearing_tones(machine: Machine) -> Iterator[tuple[str, float]]:
    for mounted in machine.bearings:
        if mounted.elements is None:
            continue
        row, speed = mounted.elements.rows[0], machine.bearing_speed(mounted)
        for place in get_args(Place):
            spall = RollingSpall(place, 1.0, 1.0)
            if (tone := spall.tone(row, speed, mounted.slip)) > 0.0:
                yield f"{mounted.bearing.name}: {spall.part}", tone / _TWO_PI
        faults = dict.fromkeys(fault.row for fault in mounted.spalls if isinstance(fault, CageFault))
        for number in faults:
            cage = CageFault(1.0, number)
            yield (
                f"{mounted.bearing.name}: cage",
                cage.tone(mounted.elements.rows[number], speed, mounted.slip) / _TWO_PI,
            )


def condition_record(transient: SolvedTransient, tones_hz: Mapping[str, float] | None = None) -> ConditionRecord:
    """Return the record of a machine's condition from its motion over time.

    Parameters
    ----------
    transient : SolvedTransient
        Of a long record its last stretch is taken.
    tones_hz : mapping of str to float, optional
        Characteristic frequencies of its bearings, of :func:`bearing_tones`.
    """
    histories, limit = transient.histories, transient.trusted_limit
    profile = transient.speed_profile or SpeedProfile.steady()
    times, interval = histories.times, transient.record.sampling.interval
    names = list(histories.sensor_acceleration)
    columns = np.array([histories.sensor_acceleration[name] for name in names]).reshape(len(names), len(times)).T
    fine_times, fine, step = _low_passed(times, columns, interval, limit)
    nominal_time = profile.at(fine_times)[0] if fine_times.size else fine_times
    ratios = profile.at(fine_times)[1] if fine_times.size else np.ones(1)
    slowest, fastest = float(ratios.min()), float(ratios.max())
    gears, averages, unsettled = list[MonitoredGear](), dict[tuple[str, str], FloatArray](), {}
    of_shaft: dict[str, tuple[FloatArray, FloatArray]] = {}
    for gear in _gears(transient):
        turned = nominal_time * gear.turn_hz
        turns = math.floor(float(turned[-1] - turned[0]) + 1e-9) if turned.size else 0
        known = replace(gear, turns=turns)
        if not known.undefined and turns < LEAST_TURNS:
            known = replace(
                known, undefined=f"{turns} turns of its shaft in the record; expected {LEAST_TURNS} or more"
            )
        gears.append(known)
        if known.undefined or not names:
            continue
        if known.shaft not in of_shaft:
            # So fine that FM0 finds the peaks, which lie between the samples of a coarser average. Beyond the limit the
            # average of a slower stretch has nothing, so that more samples do no harm.
            least = _FINER * _SAMPLING * limit / (slowest * known.turn_hz)
            count = 2 ** max(math.ceil(math.log2(max(least, 2.0 * known.teeth + 4.0))), 3)
            highest = math.floor(limit / (fastest * known.turn_hz) + 1e-9)
            of_shaft[known.shaft] = _averages(turned, fine, turns, count, highest)
        for place, sensor in enumerate(names):
            averages[known.shaft, sensor] = of_shaft[known.shaft][0][:, place]
            unsettled[known.shaft, sensor] = of_shaft[known.shaft][1][:, place]
    signals = dict(zip(names, _limited(fine[::_FINER], limit * step * _FINER), strict=True))
    steady = transient.speed_profile is None
    return ConditionRecord(
        limit, step * _FINER, tuple(gears), signals, averages, unsettled, dict(tones_hz or {}), steady
    )


def _gears(transient: SolvedTransient) -> Iterator[MonitoredGear]:
    """Yield the gears of a machine in the order of its meshes, each once."""
    machine = transient.machine
    carried = {rotor.name for rotor in machine.rotors if rotor.carrier is not None}
    of_shafts: dict[str, dict[str, int]] = {}
    frequencies: dict[str, float] = {}
    for mesh, contact in zip(machine.meshes, machine.system.contacts, strict=False):
        for mounted, gear in ((mesh.driver, mesh.geometry.driver), (mesh.driven, mesh.geometry.driven)):
            of_shafts.setdefault(mounted.rotor, {})[gear.name] = gear.tooth_count
            frequencies.setdefault(gear.name, abs(contact.mesh_frequency))
    for shaft, of_shaft in of_shafts.items():
        turn = abs(machine.speeds[shaft]) / _TWO_PI
        for name, teeth in of_shaft.items():
            others = tuple(count for other, count in of_shaft.items() if other != name)
            reason = ""
            if shaft in carried:
                reason = "the axis of the gear turns with its carrier"
            elif turn == 0.0:
                reason = "the shaft stands still"
            elif abs(frequencies[name] / turn - teeth) > _WHOLE_ORDER * teeth:
                reason = "the gear meshes with planets: its mesh frequency is no multiple of its shaft's turns"
            elif frequencies[name] + turn > transient.trusted_limit:
                reason = (
                    f"its mesh frequency, {frequencies[name]:.4g} Hz, with sidebands is beyond the trusted limit of "
                    f"{transient.trusted_limit:.4g} Hz; raise the housing's frequency_limit, or take a lower speed"
                )
            yield MonitoredGear(name, shaft, teeth, others, turn, 0, reason)


def _low_passed(
    times: FloatArray, columns: FloatArray, interval: float, limit: float
) -> tuple[FloatArray, FloatArray, float]:
    """Return signals up to a limit [Hz] at sixteen or more times it: their times, values and interval.

    A record as it was sampled is filtered; one that is filtered already, at four times the limit, is interpolated.
    """
    coarse = 2 ** max(math.floor(math.log2(1.0 / (interval * _SAMPLING * limit))), 0)
    if coarse >= _FINER:
        low_pass = decimation(coarse, limit * interval * coarse)
        factor = coarse // _FINER
        finer = Decimation(factor, low_pass.taps)
        kept, _ = finer.through(columns[:0], columns)
        return times[:1] + interval * (finer.delay + factor * np.arange(len(kept))), kept, factor * interval
    # The import of scipy's signals takes long, and few records are stored so.
    from scipy.signal import resample_poly

    if len(columns) <= 2 * _EDGE:
        return times[:0], columns[:0], interval / _FINER
    dense = resample_poly(columns, _FINER, 1, axis=0)
    inner = slice(_FINER * _EDGE, _FINER * (len(columns) - _EDGE))
    step = interval / _FINER
    at = times[0] + step * np.arange(len(dense))
    return at[inner], np.asarray(dense[inner]), step


def _limited(columns: FloatArray, band: float) -> FloatArray:
    """Return signals as rows, without what is above a band, a part of the sampling rate.

    Kaiser's window, 60 dB from 1.15 times the band on; half its length is left out at each end.
    """
    transition = 2.0 * math.pi * _TRANSITION * band
    half = math.ceil((_REJECTION - 7.95) / (2.285 * transition) / 2.0)
    if len(columns) <= 2 * half:
        return np.asarray(columns[:0].T)
    middle = band * (1.0 + 0.5 * _TRANSITION)
    taps = np.sinc(2.0 * middle * np.arange(-half, half + 1)) * np.kaiser(2 * half + 1, 0.1102 * (_REJECTION - 8.7))
    return np.array([np.convolve(column, taps / taps.sum(), "valid") for column in columns.T])


def _averages(
    turned: FloatArray, columns: FloatArray, turns: int, count: int, highest: int
) -> tuple[FloatArray, FloatArray]:
    """Average signals over the last whole turns of a shaft, at ``count`` angles: the averages, and how sure they are.

    Parameters
    ----------
    turned : ndarray, shape (s,)
        Turns of the shaft at the samples.
    columns : ndarray, shape (s, k)
    turns, count : int
    highest : int
        Highest order that is kept.
    """
    from scipy.interpolate import CubicSpline

    # The last turns are the most settled.
    first = turned[-1] - turns
    at = first + np.arange(turns * count) / count
    signals = CubicSpline(turned, columns)(at)
    half = (turns // 2) * count

    def averaged(part: FloatArray) -> FloatArray:
        rows = np.array([synchronous_average(part[:, k], count) for k in range(columns.shape[1])])
        orders = np.fft.rfft(rows)
        orders[:, highest + 1 :] = 0.0
        return np.asarray(np.fft.irfft(orders, n=count).T)

    return averaged(signals), 0.5 * (averaged(signals[half:]) - averaged(signals[:half]))
