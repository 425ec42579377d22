"""Quantities by names such as ``sensor.top.level_db``: what they are of, and how tables and figures show them."""

import re
from fnmatch import fnmatchcase

from gearwhine.output.quantity import UNITS, shown_product, unit_of

_STATISTIC = re.compile(r"(mean|standard deviation|quantile 0?\.\d+) of (?=.)")
"""Begin of the name of a statistic over gearboxes, such as ``quantile 0.95 of sensor.top.level_db``."""

_SCALES = {"m": ("µm", 1e6), "Pa": ("MPa", 1e-6), "N/m": ("N/µm", 1e-6), "rad": ("µrad", 1e6)}
"""Units that tables and figures show in place of those of the names, and the factors to them."""
_LEVELS = {
    "level_db": ("highest level over speed", "dB re 1 µm/s²"),
    "motion_level_db": ("level of the motion", "dB re 1 µm/s²"),
    "sound_power_db": ("highest sound power over speed", "dB re 1 pW"),
    "sound_power_db_a": ("highest A-weighted sound power over speed", "dB re 1 pW"),
}
_SYMBOLS = {"k_h_beta": "K_Hβ", "mesh_load_factor": "mesh load factor K_γ"}


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
    words = _SYMBOLS.get(last, last.removesuffix(end).replace("_", " "))
    if last in _LEVELS:
        words, reference = _LEVELS[last]
        unit = "dB" if statistic == "standard deviation" else reference
    words = f"{statistic} of {words}" if statistic else words
    return (f"{words} [{unit}]" if unit else words), factor


def shown_unit(unit: str) -> tuple[str, float]:
    """Return the unit in which values of a varied key are shown, and the factor to it."""
    return {**_SCALES, "um": ("µm", 1.0)}.get(unit, (shown_product(unit), 1.0))
