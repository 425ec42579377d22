"""Quantities of a varied gearbox by names such as ``sensor.top.level_db``: which there are, and how they are shown."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from gearwhine.output.quantity import UNITS, shown_product, unit_of

_STATISTIC = re.compile(r"(mean|standard deviation|quantile 0?\.\d+) of (?=.)")
"""Begin of the name of a statistic over gearboxes, such as ``quantile 0.95 of sensor.top.level_db``."""

_SCALES = {"m": ("µm", 1e6), "Pa": ("MPa", 1e-6), "N/m": ("N/µm", 1e-6), "rad": ("µrad", 1e6)}
"""Units that tables and figures show in place of those of the names, and the factors to them."""


@dataclass(frozen=True)
class NamedQuantity:
    """Quantity that is found of each part of a kind.

    Attributes
    ----------
    analysis : str
        Name of the analysis that finds it, of :data:`gearwhine.variation.quantities.ANALYSES`.
    kind : str
        Kind of the parts.
    end : str
        Last part of its name, with the unit.
    words : str
        Its name in tables and figures; by default that of `end`.
    reference : str
        Unit there of a level, with its reference.
    over_all_periods : bool
        Whether it takes all mesh periods, which pitch deviations make differ.
    """

    analysis: str
    kind: str
    end: str
    words: str = ""
    reference: str = ""
    over_all_periods: bool = False

    def of_part(self, part: str) -> str:
        """Name of the quantity of a part, whose name is empty where it is the only one of its kind."""
        return ".".join(filter(None, (self.kind.removeprefix("rolling_"), part, self.end)))


HARMONICS = 3
"""Number of harmonics of a transmission error."""
CRITICAL_SPEEDS = 3
"""Number of critical speeds of a shaft."""
TRACKED_MODES = 12
"""Number of natural frequencies of a machine."""
_AT_SENSOR, _OF_SOUND = "dB re 1 µm/s²", "dB re 1 pW"

QUANTITIES = (
    NamedQuantity(
        "gears", "gear_pair", "transmission_error_peak_to_peak_m", "transmission error p-p in the first mesh period"
    ),
    NamedQuantity("gears", "gear_pair", "transmission_error_over_hunting_period_m", over_all_periods=True),
    *(
        NamedQuantity("gears", "gear_pair", f"transmission_error_harmonic_{one}_m", over_all_periods=True)
        for one in range(1, HARMONICS + 1)
    ),
    NamedQuantity("gears", "gear_pair", "mesh_stiffness_n_per_m", over_all_periods=True),
    NamedQuantity("load", "gear_pair", "k_h_beta", "K_Hβ"),
    NamedQuantity("load", "gear_pair", "misalignment_rad"),
    NamedQuantity("load", "gear_pair", "contact_pressure_pa"),
    NamedQuantity("load", "bearing", "force_n"),
    NamedQuantity("load", "rolling_bearing", "life_h"),
    NamedQuantity("load", "rolling_bearing", "reference_life_h"),
    NamedQuantity("load", "planetary", "mesh_load_factor", "mesh load factor K_γ"),
    *(NamedQuantity("rotors", "rotor", f"critical_speed_{one}_rpm") for one in range(1, CRITICAL_SPEEDS + 1)),
    *(NamedQuantity("mass", kind, "mass_kg") for kind in ("gear", "rotor", "housing", "machine")),
    *(NamedQuantity("modes", "machine", f"natural_frequency_{one}_hz") for one in range(1, TRACKED_MODES + 1)),
    NamedQuantity("lines", "sensor", "level_db", "highest level over speed", _AT_SENSOR),
    NamedQuantity("lines", "sensor", "loudest_speed_rpm"),
    NamedQuantity("sound", "housing", "sound_power_db", "highest sound power over speed", _OF_SOUND),
    NamedQuantity("sound", "housing", "sound_power_db_a", "highest A-weighted sound power over speed", _OF_SOUND),
    NamedQuantity("sound", "housing", "sound_power_db_speed_rpm"),
    NamedQuantity("sound", "housing", "sound_power_db_a_speed_rpm"),
    NamedQuantity("motion", "sensor", "motion_level_db", "level of the motion", _AT_SENSOR),
)
"""Every quantity of a varied gearbox; :mod:`gearwhine.variation.quantities` finds them."""
_BY_END = {one.end: one for one in QUANTITIES}


def possible_quantities(parts: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, str]]:
    """Yield the name of every quantity that a gearbox may have, with the analysis that finds it.

    Parameters
    ----------
    parts : mapping of str to sequence of str
        Names of the parts by their kind; one without a name is the only one of its kind.
    """
    for one in QUANTITIES:
        yield from ((one.of_part(part), one.analysis) for part in parts.get(one.kind, ()))


def analysis_of(name: str) -> str | None:
    """Return the analysis that finds a quantity, by its name, in which ``*`` stands for any part.

    None where no analysis has such quantities, and where the name leaves open which of several is meant.
    """
    kind, last = (name.partition(".")[0] if "." in name else "*"), name.rpartition(".")[2]
    of_end = (one for one in QUANTITIES if matches(one.end, last))
    found = list(dict.fromkeys(one.analysis for one in of_end if matches(one.kind.removeprefix("rolling_"), kind)))
    # A part alone, as in ``sensor.*``, leaves it open; an end of a name means the first analysis that has such.
    return found[0] if found and (len(found) == 1 or last.strip("*")) else None


def takes_all_periods(name: str) -> bool:
    """Whether a quantity takes all mesh periods of its gear pair."""
    found = _BY_END.get(name.rpartition(".")[2])
    return found is not None and found.over_all_periods


def statistic_of(name: str) -> tuple[str, str]:
    """Return the statistic over gearboxes that a name begins with, empty of a quantity itself, and the quantity."""
    begin = _STATISTIC.match(name)
    return (begin[1], name[begin.end() :]) if begin else ("", name)


def matches(name: str, pattern: str) -> bool:
    """Whether a quantity has a name, in which ``*`` stands for any part."""
    return name == pattern or ("*" in pattern and fnmatchcase(name, plain_pattern(pattern)))


def plain_pattern(pattern: str) -> str:
    """Return a pattern in which only ``*`` has a meaning."""
    return pattern.replace("[", "[[]").replace("?", "[?]")


def part_of(name: str) -> str:
    """Return what a quantity is of: ``sensor top`` of ``sensor.top.level_db``."""
    _, name = statistic_of(name)
    kind, _, rest = name.rpartition(".")[0].partition(".")
    return rest if kind == "gear_pair" else f"{kind} {rest}".strip()


def shown_quantity(name: str) -> tuple[str, float]:
    """Return a quantity's name in words with the unit that is shown, and the factor to that."""
    statistic, name = statistic_of(name)
    unit, factor = _SCALES.get(unit_of(name), (unit_of(name), 1.0))
    last = name.rpartition(".")[2]
    end = max((end for end in UNITS if last.endswith(end)), key=len, default="")
    known = _BY_END.get(last)
    words = (known and known.words) or last.removesuffix(end).replace("_", " ")
    if known is not None and known.reference and statistic != "standard deviation":
        unit = known.reference
    words = f"{statistic} of {words}" if statistic else words
    return (f"{words} [{unit}]" if unit else words), factor


def shown_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which values of a varied key are shown, and the factor to it."""
    return {**_SCALES, "um": ("µm", 1.0)}.get(unit, (shown_product(unit), 1.0))
