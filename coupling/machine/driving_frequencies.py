"""Driving frequencies: those of all excitations of a coupled system at its nominal speeds, and the sampling for them.

A record shows an excitation above half its sampling rate as a false line below it. The sampling rate therefore follows
the excitations: a number of samples in each cycle of a harmonic one and of a mesh, whose own harmonics fall off. A load
that is linear between given times has, at a frequency ω, a line of at most

    2 Σ |Δs| / (T ω²),    Δs the changes of its slope in the record of length T,

which is small against its range beyond a frequency that follows from that.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.machine.bearing_laws import RollingLaw
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors.rolling_bearings import CageFault

_TWO_PI = 2.0 * np.pi
_ALIKE_FREQUENCY_DIGITS = 12  # digits of the frequencies of rows that are alike
_SAMPLES_PER_CYCLE = 8.0  # of a harmonic excitation: its third harmonic is below half the sampling rate
_SAMPLES_PER_MESH = 32.0  # of a mesh, whose force has many harmonics
_FOLDED = 0.01  # largest line of a table over time above half the sampling rate, over the table's range


def driving_frequencies(system: CoupledSystem) -> dict[str, float]:
    """Frequency [Hz] of every excitation, by its name, but for the passing of rolling elements.

    A contact whose pairs of teeth differ repeats after its hunting period alone.
    """
    frequencies = {}
    for contact in system.contacts:
        if contact.mesh_frequency != 0.0 and _varies(contact.contact):
            frequencies[f"contact {contact.name!r}"] = abs(contact.mesh_frequency) / contact.contact.hunting_period
        for number, (amplitude, frequency, _) in enumerate(contact.errors):
            if amplitude != 0.0 and frequency != 0.0:
                frequencies[f"runout {number + 1} of {contact.name!r}"] = abs(frequency) / _TWO_PI
    for number, load in enumerate(system.harmonic_loads):
        if load.frequency != 0.0 and np.any(load.amplitude != 0.0):
            frequencies[f"harmonic load {number + 1}"] = abs(load.frequency) / _TWO_PI
    return frequencies


def element_passes(system: CoupledSystem) -> dict[str, tuple[float, ...]]:
    """Return the frequencies at which elements pass a place at rest [Hz], of bearings whose law follows the elements.

    Each frequency of a bearing once, ascending: its rows are mostly alike.
    """
    passes = {}
    for connector in system.nonlinear:
        if isinstance(connector.law, RollingLaw) and (connector.speed != 0.0 or connector.holder_speed != 0.0):
            rows = connector.law.state.bearing.rows
            rolling = 1.0 - connector.law.slip.mean
            cages = [rolling * row.cage_speed(connector.speed) + connector.holder_speed for row in rows]
            frequencies = [row.count * abs(cage) / _TWO_PI for row, cage in zip(rows, cages, strict=True)]
            passes[connector.name] = tuple(
                sorted({round(frequency, _ALIKE_FREQUENCY_DIGITS) for frequency in frequencies})
            )
    return passes


@dataclass(frozen=True)
class SpallStrikes:
    """Strikes of a bearing's spall.

    Attributes
    ----------
    part, bearing : str
        Damaged part, and name of the bearing.
    frequency : float
        Strikes in a second [Hz].
    turning : str
        What carries the spall through the loaded zone; empty where it stands still there.
    turning_frequency : float
        Turns of that in a second [Hz].
    half_width : float
        Half-width of the strikes' own frequency by the scatter of the cage's slip [Hz]; that of the k-th multiple is k²
        times as much.
    """

    part: str
    bearing: str
    frequency: float
    turning: str = ""
    turning_frequency: float = 0.0
    half_width: float = 0.0

    @property
    def name(self) -> str:
        """Damaged part of the bearing."""
        return f"{self.part} of {self.bearing}"


def spall_strikes(system: CoupledSystem) -> tuple[SpallStrikes, ...]:
    """Return the strikes of all spalls of rolling bearings and the turns of faulty cages, alike ones once.

    Elements pass a raceway's spall, which its ring carries through the loaded zone where it turns; an element strikes
    either raceway once in each turn of its own, and the cage carries it.
    """
    found = list[SpallStrikes]()
    for connector in system.nonlinear:
        if not isinstance(connector.law, RollingLaw):
            continue
        slip = connector.law.slip
        for spall in connector.law.spalls:
            row = connector.law.state.bearing.rows[spall.row]
            cage = (1.0 - slip.mean) * row.cage_speed(connector.speed)
            frequency = spall.tone(row, connector.speed, slip) / _TWO_PI
            passes = row.count * abs(cage) / _TWO_PI
            width = slip.half_width(passes)
            if spall.part == "rolling element" and passes > 0.0:
                # It turns with the cage, and its multiples are as much wider as they are higher than those of passing.
                width *= (frequency / passes) ** 2
            strikes = SpallStrikes(spall.part, connector.name, frequency, half_width=width)
            if isinstance(spall, CageFault):
                turn = abs(cage + connector.holder_speed) / _TWO_PI
                found.append(replace(strikes, frequency=turn, half_width=slip.half_width(passes) / row.count**2))
                continue
            if spall.on == "element":
                turn, carrying = cage, "cage"
            else:
                turns_with_shaft = (spall.on == "outer") == row.outer_turns
                turn, carrying = connector.speed if turns_with_shaft else 0.0, f"{spall.on} ring"
            turn = abs(turn + connector.holder_speed) / _TWO_PI
            if turn > 0.0:
                strikes = replace(strikes, turning=f"{carrying} of {connector.name}", turning_frequency=turn)
            found.append(strikes)
    return tuple(dict.fromkeys(one for one in found if one.frequency > 0.0))


def frequencies_of_elements(system: CoupledSystem) -> list[float]:
    """Return the frequencies of rolling elements [Hz]: their passing, strikes of spalls and turns of these."""
    frequencies = [frequency for passes in element_passes(system).values() for frequency in passes]
    for strikes in spall_strikes(system):
        frequencies += [one for one in (strikes.frequency, strikes.turning_frequency) if one > 0.0]
    return frequencies


def least_sampling_rate(
    system: CoupledSystem, begin: float = 0.0, end: float = 0.0, *, fastest: float = 1.0
) -> tuple[float, float]:
    """Return the sampling rate at which no excitation folds down to a lower frequency, and its frequency.

    Parameters
    ----------
    system : CoupledSystem
    begin, end : float
        Recorded part of the loads that are given over time [s]; without it they do not count.
    fastest : float
        Highest speed over the nominal one, which meshes, runout and loads by order follow.

    Returns
    -------
    rate, frequency : float
        Sampling rate and highest frequency of that excitation [Hz]; zeros where nothing excites.
    """
    return max(_sampling_rates(system, begin, end, fastest), default=(0.0, 0.0))


def _sampling_rates(system: CoupledSystem, begin: float, end: float, fastest: float) -> Iterator[tuple[float, float]]:
    for frequency in harmonic_frequencies(system, fastest):
        yield _SAMPLES_PER_CYCLE * frequency, frequency
    for contact in system.contacts:
        frequency = fastest * abs(contact.mesh_frequency)
        yield _SAMPLES_PER_MESH * frequency, frequency
    for frequency in frequencies_of_elements(system):
        yield _SAMPLES_PER_MESH * fastest * frequency, fastest * frequency
    for load in system.timed_loads if end > begin else ():
        inside = _inside(load.times, begin, end)
        times = np.concatenate([[begin], load.times[inside], [end]])
        values = np.interp(times, load.times, load.values)
        bends = np.abs(np.diff(np.diff(values) / np.diff(times))).sum()
        if bends > 0.0:
            frequency = float(np.sqrt(2.0 * bends / ((end - begin) * _FOLDED * np.ptp(values)))) / _TWO_PI
            yield 2.0 * frequency, frequency


def harmonic_frequencies(system: CoupledSystem, fastest: float = 1.0) -> list[float]:
    """Frequencies of harmonic loads and runout errors [Hz], of those that follow the speed at ``fastest`` times it."""
    frequencies = [
        abs(load.frequency) / _TWO_PI * (1.0 if load.follows == "time" else fastest)
        for load in system.harmonic_loads
        if np.any(load.amplitude != 0.0)
    ]
    frequencies += [
        fastest * abs(frequency) / _TWO_PI
        for contact in system.contacts
        for amplitude, frequency, _ in contact.errors
        if amplitude != 0.0
    ]
    return frequencies


def varies_within(system: CoupledSystem, begin: float, end: float) -> bool:
    """Whether a load given over time varies between two times [s]."""
    return any(
        np.ptp([*np.interp([begin, end], load.times, load.values), *load.values[_inside(load.times, begin, end)]]) > 0.0
        for load in system.timed_loads
    )


def _inside(times: FloatArray, begin: float, end: float) -> npt.NDArray[np.bool_]:
    return np.asarray((times > begin) & (times < end))


def _varies(contact: ToothContact) -> bool:
    """Whether a contact law depends on the phase: a mesh with one constant spring does not."""
    if contact.enters_by_slices or contact.hunting_numbers or contact.variants:
        return True
    start, end = contact.contact_range
    curves = (contact.stiffness.coefficients, contact.deviation.coefficients)
    uneven = any(bool(np.any(curve[:, 1:])) or np.ptp(curve[:, 0]) > 0.0 for curve in curves)
    return uneven or abs(end - start - round(end - start)) > 1e-12
