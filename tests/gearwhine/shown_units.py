"""Units as texts, tables and keys show them, with their dimensions: the tests' own table."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

SHOWN = {
    "m": ("m", 1.0),
    "mm": ("m", 1e-3),
    "µm": ("m", 1e-6),
    "nm": ("m", 1e-9),
    "mm²": ("m2", 1e-6),
    "m²": ("m2", 1.0),
    "N": ("N", 1.0),
    "kN": ("N", 1e3),
    "N·m": ("N m", 1.0),
    "N/mm": ("N/m", 1e3),
    "N/µm": ("N/m", 1e6),
    "N/m": ("N/m", 1.0),
    "µrad": ("rad", 1e-6),
    "mrad": ("rad", 1e-3),
    "rad": ("rad", 1.0),
    "°": ("rad", math.pi / 180.0),
    "Hz": ("Hz", 1.0),
    "rpm": ("rpm", 1.0),
    "krpm": ("rpm", 1e3),
    "Pa": ("Pa", 1.0),
    "MPa": ("Pa", 1e6),
    "GPa": ("Pa", 1e9),
    "kg": ("kg", 1.0),
    "s": ("s", 1.0),
    "ms": ("s", 1e-3),
    "h": ("h", 1.0),
    "W": ("W", 1.0),
    "m/s²": ("m/s2", 1.0),
    "m/s": ("m/s", 1.0),
    "dB": ("dB", 1.0),
    "%": ("%", 1.0),
    "‰": ("%", 0.1),
}
"""Unit as it is shown: its dimension, and how many of SI's units it is."""

ENDS = {
    "_m_per_s2": "m/s2",
    "_m_per_s": "m/s",
    "_n_per_m": "N/m",
    "_n_m": "N m",
    "_kg": "kg",
    "_rad": "rad",
    "_hz": "Hz",
    "_rpm": "rpm",
    "_pa": "Pa",
    "_n": "N",
    "_m": "m",
    "_m2": "m2",
    "_s": "s",
    "_h": "h",
    "_w": "W",
    "_db": "dB",
    "_db_a": "dB",
    "_percent": "percent",
}
"""End of a key: the dimension of its value, which is in SI's unit, or in turns a minute, hours, decibels."""

_SYMBOL = "(?:m|kg|s|h|N|Hz|rpm|rad|degree|Pa|W|J|dB)"
_FILE_UNIT = re.compile(rf"(?:1|percent|see \w+|{_SYMBOL}-?[0-9.]*(?:[ /]{_SYMBOL}-?[0-9.]*)*)?")


def dimension_of(key: str) -> str | None:
    """Dimension that the end of a key says, the last of its steps that says one."""
    for step in reversed(key.split(".")):
        for end in sorted(ENDS, key=len, reverse=True):
            if step.endswith(end):
                return ENDS[end]
    return None


NAMES = {
    "frequency": {"Hz"},
    "speed": {"rpm", "rad s-1"},
    "force": {"N"},
    "thrust": {"N"},
    "preload": {"N"},
    "torque": {"N m"},
    "stiffness": {"N/m", ""},  # of all motions together in mixed units
    "displacement": {"m", "m kg0.5"},
    "deflection": {"m", "kg-0.5"},  # of a mode
    "misalignment": {"rad"},
    "tilt": {"rad"},
    "rotation": {"rad"},
    "pressure": {"Pa"},
    "power": {"W"},
    "angle": {"rad"},
    "length": {"m"},
    "mass": {"kg"},
    "acceleration": {"m/s2", "m s-2"},
    "period": {"s"},
    "time": {"s"},
    "level": {"dB"},
    "ratio": {"1"},
    "phase": {"rad", "1"},  # of a mesh period, too
    "spectrum": {"m/s2", "N", "N m", "m kg0.5", "m kg0.5 s-2"},  # of modal coordinates too
}
"""Last word of a name in a file of results: units that it may have."""


def mislabelled(variables: Mapping[str, tuple[Sequence[str], Any, Mapping[str, Any]]]) -> list[str]:
    """Variables of a file whose unit is none, or none of what the name says, or whose long name is no words."""
    wrong = []
    for name, (_, values, attributes) in variables.items():
        if np.asarray(values).dtype.kind not in "fc":  # a label, a number of, a truth
            continue
        unit, meaning = attributes.get("units", ""), attributes.get("long_name", "words")
        word = re.split("_over_|_by_", name)[0].rpartition("_")[2]
        if unit.startswith(("see ", "in SI, as ")):  # of rows that differ in it
            continue
        if not _FILE_UNIT.fullmatch(unit):
            wrong.append(f"{name} has the unit {unit!r}")
        elif "transmissibility" not in name and unit not in NAMES.get(word, {unit}):
            wrong.append(f"{name} is in {unit!r}")
        if not re.search("[a-z]{3}", meaning):
            wrong.append(f"{name} means {meaning!r}")
    return wrong
