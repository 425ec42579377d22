r"""Tolerances of the flanks of a gear by ISO 1328-1:2013, flank tolerance classes 1 to 11.

Each tolerance is that of class 5 times the step factor √2 a class. With the reference diameter d, the normal module
m_n and the face width b in mm, in µm:

    single pitch          f_pT  = 0.001 d + 0.4 m_n + 5
    cumulative pitch      F_pT  = 0.002 d + 0.55 √d + 0.7 m_n + 12
    profile slope         f_HαT = 0.001 d + 0.4 m_n + 4
    profile form          f_fαT = 0.55 m_n + 5
    helix slope           f_HβT = 0.05 √d + 0.35 √b + 4
    helix form            f_fβT = 0.07 √d + 0.45 √b + 4
    runout                F_rT  = 0.9 F_pT

The standard rounds its values; these are not rounded.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.numerics.findings import Finding, Number, refuse

CLASSES = Number(at_least=1, at_most=11, whole=True)
"""Rule of a flank tolerance class."""
_MM, _MICRO = 1e3, 1e-6
_RANGES = {
    "teeth": (5.0, 1000.0, ""),
    "reference diameter": (5.0, 15000.0, " mm"),
    "normal module": (0.5, 70.0, " mm"),
    "face width": (4.0, 1200.0, " mm"),
}


@dataclass(frozen=True)
class FlankTolerances:
    """Tolerances of a gear's flanks [m]; deviations of either sign are within ± these.

    Attributes
    ----------
    single_pitch, cumulative_pitch, profile_slope, profile_form, helix_slope, helix_form, runout : float
        f_pT, F_pT, f_HαT, f_fαT, f_HβT, f_fβT, F_rT.
    """

    single_pitch: float
    cumulative_pitch: float
    profile_slope: float
    profile_form: float
    helix_slope: float
    helix_form: float
    runout: float


def flank_tolerances(gear: Gear, tolerance_class: int) -> FlankTolerances:
    """Return the tolerances of a gear in a class of ISO 1328-1:2013.

    Parameters
    ----------
    gear : Gear
    tolerance_class : int
        Flank tolerance class A, from 1, the finest, to 11.

    Raises
    ------
    GearError
        For another class, or a gear beyond the ranges of the standard.
    """
    refuse(_findings(gear, tolerance_class), GearError)
    d, m, b = (_MM * size for size in (2.0 * abs(gear.pitch_radius), gear.module, gear.face_width))
    step = _MICRO * math.sqrt(2.0) ** (tolerance_class - 5)
    cumulative = 0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0
    return FlankTolerances(
        single_pitch=step * (0.001 * d + 0.4 * m + 5.0),
        cumulative_pitch=step * cumulative,
        profile_slope=step * (0.001 * d + 0.4 * m + 4.0),
        profile_form=step * (0.55 * m + 5.0),
        helix_slope=step * (0.05 * math.sqrt(d) + 0.35 * math.sqrt(b) + 4.0),
        helix_form=step * (0.07 * math.sqrt(d) + 0.45 * math.sqrt(b) + 4.0),
        runout=step * 0.9 * cumulative,
    )


def _findings(gear: Gear, tolerance_class: int) -> Iterator[Finding]:
    part = ("gear", gear.name)
    if not CLASSES.accepts(tolerance_class):
        yield Finding(part, "tolerance class", tolerance_class, f"{CLASSES.expected}, of ISO 1328-1:2013")
    sizes = (abs(gear.teeth), _MM * 2.0 * abs(gear.pitch_radius), _MM * gear.module, _MM * gear.face_width)
    for (name, (low, high, unit)), size in zip(_RANGES.items(), sizes, strict=True):
        if not low * (1.0 - 1e-9) <= size <= high * (1.0 + 1e-9):
            expected = f"{low:g} to {high:g}{unit}, the range of ISO 1328-1:2013"
            yield Finding(part, name, float(size), expected)


def random_pitch_deviations(tolerances: FlankTolerances, teeth: int, seed: int) -> tuple[float, ...]:
    """Cumulative pitch deviations of a gear's teeth that passed inspection in its class [m], of zero mean.

    The single pitches are normal with a third of their tolerance as standard deviation σ. As a sum of z independent
    steps the places would range over 1.25 σ √z and more (Brownian bridge), which of many teeth is beyond F_pT. Steps
    therefore have a cumulative part with the standard deviation ``min(σ, F_pT / (2.6 √z))`` only; the rest is of places
    that deviate each by itself, whose steps do not add up. A slow part with a lobe a turn, as of teeth cut about an
    axis beside their own, has normal components of F_pT / 12. About 1 % of the gears are beyond F_pT; gears beyond a
    tolerance are rejected and drawn anew, so that none are heaped at the limit.

    Parameters
    ----------
    tolerances : FlankTolerances
    teeth : int
    seed : int
    """
    single, cumulative = tolerances.single_pitch, tolerances.cumulative_pitch
    deviation = min(single / 3.0, cumulative / 5.0)  # the second, beyond any class, keeps most gears within F_pT
    of_steps = min(deviation, cumulative / (2.6 * math.sqrt(teeth)))
    of_places = math.sqrt(0.5 * (deviation**2 - of_steps**2))
    angles = 2.0 * np.pi * np.arange(teeth) / teeth
    rng = np.random.default_rng(seed)
    while True:
        steps = of_steps * rng.normal(size=teeth)
        slow = rng.normal(size=2) * cumulative / 12.0
        places = np.cumsum(steps - steps.mean()) + of_places * rng.normal(size=teeth)
        places += slow[0] * np.cos(angles) + slow[1] * np.sin(angles)
        places -= places.mean()
        largest_step = float(np.abs(np.diff(places, append=places[:1])).max())
        if largest_step <= single and float(np.ptp(places)) <= cumulative:
            return tuple(places.tolist())
