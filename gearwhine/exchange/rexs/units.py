"""Units of the REXS schema, and their values in SI.

The schema writes products with a blank, ``N mm / rad``. Of a unit that is not listed no attribute is taken. Plane
angles are in rad, speeds in rad/s, and temperatures, which have an offset, in kelvin.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Unit(NamedTuple):
    """A unit of the schema: SI unit, factor to it, and offset that is added after the factor."""

    si: str
    factor: float
    offset: float = 0.0


_PLAIN = Unit("", 1.0)
UNITS = {
    "": _PLAIN,
    "none": _PLAIN,
    "%": Unit("", 0.01),
    "m": Unit("m", 1.0),
    "mm": Unit("m", 1e-3),
    "mum": Unit("m", 1e-6),
    "m^2": Unit("m^2", 1.0),
    "mm^2": Unit("m^2", 1e-6),
    "rad": Unit("rad", 1.0),
    "deg": Unit("rad", math.pi / 180.0),
    "°": Unit("rad", math.pi / 180.0),
    "s": Unit("s", 1.0),
    "h": Unit("s", 3600.0),
    "kg": Unit("kg", 1.0),
    "mg": Unit("kg", 1e-6),
    "kg m^2": Unit("kg*m^2", 1.0),
    "kg / dm^3": Unit("kg/m^3", 1000.0),
    "N": Unit("N", 1.0),
    "kN": Unit("N", 1e3),
    "N m": Unit("N*m", 1.0),
    "N mm": Unit("N*m", 1e-3),
    "N / m": Unit("N/m", 1.0),
    "N / mm": Unit("N/m", 1e3),
    "N / rad": Unit("N/rad", 1.0),
    "N m / rad": Unit("N*m/rad", 1.0),
    "N mm / rad": Unit("N*m/rad", 1e-3),
    "Pa": Unit("Pa", 1.0),
    "MPa": Unit("Pa", 1e6),
    "N / mm^2": Unit("Pa", 1e6),
    "N / (mm mum)": Unit("Pa", 1e9),
    "W": Unit("W", 1.0),
    "kW": Unit("W", 1e3),
    "1 / min": Unit("rad/s", math.pi / 30.0),
    "rad / s": Unit("rad/s", 1.0),
    "Hz": Unit("Hz", 1.0),
    "m / s": Unit("m/s", 1.0),
    "m / s^2": Unit("m/s^2", 1.0),
    "mm^2 / s": Unit("m^2/s", 1e-6),
    "1e-6 / C": Unit("1/K", 1e-6),
    "C": Unit("K", 1.0, 273.15),
    "K": Unit("K", 1.0),
}
"""Unit of each name of the schema, of all its versions."""


def unit_named(name: str) -> Unit | None:
    """Return the unit of a name, whatever its blanks; None for one that no attribute of a case has."""
    return UNITS.get(name) or _BY_BARE_NAME.get("".join(name.split()))


_BY_BARE_NAME = {"".join(name.split()): unit for name, unit in UNITS.items()}

WRITTEN = {
    "": "none",
    "m": "mm",
    "rad": "deg",
    "kg": "kg",
    "kg*m^2": "kg m^2",
    "kg/m^3": "kg / dm^3",
    "N": "N",
    "N*m": "N m",
    "N/m": "N / m",
    "N*m/rad": "N mm / rad",
    "Pa": "N / mm^2",
    "rad/s": "1 / min",
    "m/s^2": "m / s^2",
}
"""Unit that the schema 1.7 has for most attributes of a measure, by the SI unit."""


def in_unit(number: float, name: str) -> float:
    """Return an amount in SI in a unit of the schema."""
    unit = UNITS[name]
    return (number - unit.offset) / unit.factor
