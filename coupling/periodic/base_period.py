"""Common period of the excitations of a machine."""

from fractions import Fraction
from math import lcm

import numpy as np

from coupling.errors import CouplingError
from coupling.gears import ToothContact
from coupling.system import CoupledSystem

_SAME = 1e-9  # relative tolerance of a frequency ratio
_LARGEST_NUMBER = 2000  # largest number in a frequency ratio: no gear has more teeth
_WHOLE = 1e-6  # tolerance of a whole number of cycles in a given period


def driving_frequencies(system: CoupledSystem) -> dict[str, float]:
    """Frequency [Hz] of every excitation, by its name.

    A contact whose pairs of teeth differ repeats after its hunting period alone.
    """
    found = {}
    for contact in system.contacts:
        if contact.rate != 0.0 and _varies(contact.contact):
            found[f"contact {contact.name!r}"] = abs(contact.rate) / contact.contact.hunting_period
        for number, (amplitude, frequency, _) in enumerate(contact.errors):
            if amplitude != 0.0 and frequency != 0.0:
                found[f"runout {number + 1} of {contact.name!r}"] = abs(frequency) / (2.0 * np.pi)
    for number, load in enumerate(system.harmonic_loads):
        if load.frequency != 0.0 and np.any(load.amplitude != 0.0):
            found[f"harmonic load {number + 1}"] = abs(load.frequency) / (2.0 * np.pi)
    return found


def common_period(system: CoupledSystem, period: float | None = None) -> float:
    """The shortest time in which every driving frequency makes whole cycles [s].

    Parameters
    ----------
    system : CoupledSystem
    period : float, optional
        A multiple of it, which is checked: subharmonic motions repeat after several periods.

    Raises
    ------
    CouplingError
        Where the frequencies have no common period, nothing varies, or the given period is not one.
    """
    frequencies = driving_frequencies(system)
    if period is not None:
        if not 0.0 < period < np.inf:
            raise CouplingError(f"a period of {period} s; expected a positive number")
        for what, frequency in frequencies.items():
            cycles = frequency * period
            if round(cycles) < 1 or abs(cycles - round(cycles)) > _WHOLE:
                raise CouplingError(
                    f"{what} at {frequency:.9g} Hz makes {cycles:.9g} cycles in the period of {period:.9g} s; expected "
                    "a whole number"
                )
        return period
    if not frequencies:
        raise CouplingError(
            "nothing varies with time, so no period is given by the machine; static_equilibrium says where it rests, "
            "or give the period of a motion that you look for"
        )
    first = next(iter(frequencies))
    ratios = []
    for what, frequency in frequencies.items():
        exact = frequency / frequencies[first]
        ratio = Fraction(exact).limit_denominator(_LARGEST_NUMBER)
        if ratio == 0 or abs(float(ratio) / exact - 1.0) > _SAME or ratio.numerator > _LARGEST_NUMBER**2:
            raise CouplingError(
                f"{what} at {frequency:.9g} Hz and {first} at {frequencies[first]:.9g} Hz have no common period: their "
                f"ratio {exact:.12g} is no fraction of whole numbers up to {_LARGEST_NUMBER}; the motion does not "
                "repeat, leave one of them out or march through time"
            )
        ratios.append(ratio)
    # Cycles of the first in which all make whole ones.
    return lcm(*(ratio.denominator for ratio in ratios)) / frequencies[first] / _common_factor(ratios)


def _common_factor(ratios: list[Fraction]) -> int:
    """Number of times that all repeat within that."""
    cycles = lcm(*(ratio.denominator for ratio in ratios))
    return int(np.gcd.reduce([int(ratio * cycles) for ratio in ratios]))


def _varies(contact: ToothContact) -> bool:
    """Whether a contact law depends on the phase: a mesh with one constant spring does not."""
    if contact.faces is not None or contact.hunting_numbers or contact.variants:
        return True
    start, end = contact.contact_range
    curves = (contact.stiffness.coefficients, contact.deviation.coefficients)
    uneven = any(bool(np.any(curve[:, 1:])) or np.ptp(curve[:, 0]) > 0.0 for curve in curves)
    return uneven or abs(end - start - round(end - start)) > 1e-12
