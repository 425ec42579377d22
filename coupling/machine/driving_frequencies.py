"""Driving frequencies: those of all excitations of a coupled system at its nominal speeds."""

import numpy as np
import numpy.typing as npt

from coupling.gears import ToothContact
from coupling.machine.bearing_laws import RollingLaw
from coupling.machine.coupled_system import CoupledSystem
from rotors.rolling_bearings import characteristic_frequencies

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi
_ALIKE = 12  # digits of the frequencies of rows that are alike


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
    """Return the frequencies at which elements pass the outer raceway [Hz], of bearings whose law follows the elements.

    Each frequency of a bearing once, ascending: its rows are mostly alike.
    """
    passes = {}
    for connector in system.nonlinear:
        if isinstance(connector.law, RollingLaw) and connector.speed != 0.0:
            rows = connector.law.state.bearing.rows
            frequencies = [characteristic_frequencies(row, connector.speed).outer_pass / _TWO_PI for row in rows]
            passes[connector.name] = tuple(sorted({round(frequency, _ALIKE) for frequency in frequencies}))
    return passes


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
