"""Units of a case: quantities as text with a unit, such as ``"6.35 mm"``, to SI and back.

A quantity is a number and a unit of plain symbols multiplied, divided and raised to whole powers. Text is
held to that grammar before the unit registry sees any of it, so nothing in a case file is ever evaluated.
For objects made in Python, :func:`rpm` turns a speed into SI.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pint


LONGEST_QUANTITY = 100
"""Characters beyond which a string is not taken for a quantity."""

_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*)", re.DOTALL)
_FACTOR = re.compile(r"\s*([*·/]?)\s*([A-Za-zµμ°%]{1,20})(?:\s*(?:\^|\*\*)\s*([+-]?[1-9])|([+-]?[1-9]))?")
_BRACKET = re.compile(r"/\s*\(([^()/]*)\)")  # "N*m/(rad*s)": the one place where brackets are customary
_SUPERSCRIPTS = str.maketrans({"⁻": "-", "¹": "1", "²": "2", "³": "3", "⋅": "·"})
_A_MINUTE = ("1/min", "min^-1", "min-1")  # of a speed: revolutions, as catalogues write it
_RESPELT = {"°": "degree", "%": "percent", "rev": "revolution"}


class QuantityError(ValueError):
    """A text or number is not the required quantity.

    The message is the expectation; `note` names the dimension of the value, where that is not obvious.
    """

    def __init__(self, expected: str, note: str = "") -> None:
        super().__init__(expected)
        self.note = note


@dataclass(frozen=True)
class Dimension:
    """Physical dimension: its SI unit, its limits, and an example.

    Attributes
    ----------
    name : str
        Name with its article, as a message shows it: ``"a length"``.
    unit : str
        SI unit of the stored float.
    example : str
        A quantity as a user might write it.
    largest, smallest : float
        Largest absolute value, and least one of a divisor [SI]: far beyond gearboxes, but such that products of several
        quantities neither overflow nor vanish.
    display : str
        Customary unit, used in output where it gives back the very same float.
    """

    name: str
    unit: str
    example: str
    largest: float
    smallest: float
    display: str = ""


LENGTH = Dimension("a length", "m", "6.35 mm", 100.0, 1e-12)
MASS = Dimension("a mass", "kg", "4 kg", 1e7, 1e-9)
DENSITY = Dimension("a density", "kg/m^3", "7850 kg/m^3", 1e6, 1e-3)
STRESS = Dimension("an elastic modulus", "Pa", "207 GPa", 1e15, 1.0)
INERTIA = Dimension("a moment of inertia", "kg*m^2", "0.02 kg*m^2", 1e9, 1e-15)
IMBALANCE = Dimension("an unbalance", "kg*m", "2e-5 kg*m", 1e5, 1e-15)
STIFFNESS = Dimension("a stiffness", "N/m", "1.2e8 N/m", 1e15, 1e-6)
COUPLED_STIFFNESS = Dimension("a force per angle", "N/rad", "1e5 N/rad", 1e15, 1e-6)
TILT_STIFFNESS = Dimension("a tilting stiffness", "N*m/rad", "1e4 N*m/rad", 1e15, 1e-6)
DAMPING = Dimension("a damping", "N*s/m", "500 N*s/m", 1e12, 1e-9)
COUPLED_DAMPING = Dimension("a damping force per angular rate", "N*s/rad", "1 N*s/rad", 1e12, 1e-9)
TILT_DAMPING = Dimension("a tilting damping", "N*m*s/rad", "0.1 N*m*s/rad", 1e12, 1e-9)
FORCE = Dimension("a force", "N", "1 kN", 1e10, 1e-9)
TORQUE = Dimension("a torque", "N*m", "71.77 N*m", 1e10, 1e-9)
ACCELERATION = Dimension("an acceleration", "m/s^2", "9.81 m/s^2", 1e6, 1e-9)
ANGULAR_ACCELERATION = Dimension("an angular acceleration", "rad/s^2", "10 rad/s^2", 1e9, 1e-9)
TIME = Dimension("a time", "s", "10 s", 1e7, 1e-9)
ANGLE = Dimension("an angle", "rad", "24 deg", 1e6, 1e-12, display="deg")
FREQUENCY = Dimension("a frequency", "Hz", "3.2 kHz", 1e7, 1e-6)
SPEED = Dimension("an angular speed", "rad/s", "5500 rpm", 1e6, 1e-6, display="rpm")
VELOCITY = Dimension("a velocity", "m/s", "343 m/s", 1e5, 1e-6)
DIAMETRAL_PITCH = Dimension("a diametral pitch", "1/m", "8 1/in", 1e6, 1e-3)
TEMPERATURE = Dimension("a difference of temperatures", "K", "45 K", 1e4, 1e-6)
EXPANSION = Dimension("a coefficient of thermal expansion", "1/K", "12e-6 1/K", 1.0, 1e-12)
RATIO = Dimension("a plain number", "", "0.01", 1e12, 1e-12)

_DIMENSIONS = (
    *(LENGTH, MASS, DENSITY, STRESS, INERTIA, IMBALANCE, STIFFNESS, COUPLED_STIFFNESS, DAMPING, TILT_DAMPING),
    *(TORQUE, ACCELERATION, TIME, ANGLE, FREQUENCY, SPEED, DIAMETRAL_PITCH),
)


@dataclass(frozen=True)
class _Unit:
    """A unit in SI: ``factor`` times a product of base units to whole powers; cycles counted apart."""

    factor: Decimal
    powers: tuple[tuple[str, int], ...]

    def without_angle(self) -> tuple[tuple[str, int], ...]:
        return tuple(item for item in self.powers if item[0] != "radian")


_BASE_UNITS = {"kilogram": "kg", "meter": "m", "second": "s", "radian": "rad", "kelvin": "K"}


def _common() -> dict[str, _Unit]:
    """Return the symbols of nearly every case without reading the registry; tests hold them against it."""
    force = (("kilogram", 1), ("meter", 1), ("second", -2))
    pressure = (("kilogram", 1), ("meter", -1), ("second", -2))
    # Power of ten and powers of base units, with prefixes.
    prefixed = {
        "m": (0, (("meter", 1),)),
        "g": (-3, (("kilogram", 1),)),
        "s": (0, (("second", 1),)),
        "N": (0, force),
        "Pa": (0, pressure),
        "Hz": (0, (("cycle", 1), ("second", -1))),
    }
    prefixes = {"": 0, "k": 3, "M": 6, "G": 9, "c": -2, "m": -3, "u": -6, "\u00b5": -6, "\u03bc": -6}
    units = {
        prefix + symbol: _Unit(Decimal(1).scaleb(ten + power), powers)
        for symbol, (ten, powers) in prefixed.items()
        for prefix, power in prefixes.items()
    }
    degree = _Unit(Decimal(repr(math.pi / 180.0)), (("radian", 1),))
    return units | {
        "rad": _Unit(Decimal(1), (("radian", 1),)),
        **dict.fromkeys(("deg", "degree", "°"), degree),
        "rpm": _Unit(Decimal(repr(math.pi / 30.0)), (("radian", 1), ("second", -1))),
        **dict.fromkeys(("in", "inch"), _Unit(Decimal("0.0254"), (("meter", 1),))),
        "%": _Unit(Decimal("0.01"), ()),
    }


COMMON_UNITS = _common()


def _newton_metres() -> dict[str, _Unit]:
    """Return newton metres written together, as catalogues have them; the registry takes Nm for a count of yarn."""
    moment = (("kilogram", 1), ("meter", 2), ("second", -2))
    return {
        force + length: _Unit(COMMON_UNITS[force].factor * COMMON_UNITS[length].factor, moment)
        for force in ("N", "kN", "MN", "mN")
        for length in ("m", "mm")
    }


TOGETHER = _newton_metres()
"""Products of units that are written without a sign between them."""


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    """Return the one shared unit registry, made when the first uncommon unit is read (a second)."""
    import pint

    return pint.UnitRegistry(cache_folder=None)


@lru_cache(maxsize=256)
def _symbol(symbol: str) -> _Unit | None:
    """Look up one unit symbol; None where there is no such (whole-power, multiplicative) unit."""
    return COMMON_UNITS.get(symbol) or TOGETHER.get(symbol) or registered_unit(symbol)


def registered_unit(symbol: str) -> _Unit | None:
    """Parse a unit by the unit registry alone."""
    import pint

    registry = _registry()
    try:
        unit = registry.parse_units(_RESPELT.get(symbol, symbol))
        if not registry.Quantity(1, unit)._is_multiplicative:
            return None
        factor, base = registry.get_base_units(unit)
    except (pint.PintError, AttributeError, ValueError, TypeError, KeyError):
        return None
    powers = {str(name): float(str(power)) for name, power in base._units.items()}
    if any(power % 1.0 != 0.0 for power in powers.values()):
        return None
    if str(unit).endswith("hertz"):
        powers["cycle"] = 1.0  # the registry takes 1 Hz for 1/s, which would lose a 2 pi in angular speeds
    whole = sorted((name, int(power)) for name, power in powers.items())
    return _Unit(Decimal(repr(float(str(factor)))), tuple(whole))


@lru_cache(maxsize=1024)
def _parse_unit(text: str) -> _Unit | None:
    """Multiply out a unit such as ``kg*m^2`` or ``1/in``; None where it is not one."""
    inverse = text.startswith("1/")
    text = _BRACKET.sub(lambda inside: "/" + "/".join(re.split(r"[*·]", inside[1])), text.translate(_SUPERSCRIPTS))
    factor, powers, place = Decimal(1), dict[str, int](), int(inverse)
    while place < len(text.rstrip()):
        match = _FACTOR.match(text, place)
        if match is None or (place == 0 and match[1]):
            return None
        unit = _symbol(match[2])
        if unit is None:
            return None
        exponent = int(match[3] or match[4] or 1) * (-1 if match[1] == "/" else 1)
        factor *= unit.factor**exponent
        for key, power in unit.powers:
            powers[key] = powers.get(key, 0) + power * exponent
        place = match.end()
    return _Unit(factor, tuple(sorted((key, power) for key, power in powers.items() if power)))


def _unit_of(text: str) -> _Unit:
    """Return the unit of a text that is known to be one; ValueError where it is none."""
    unit = _parse_unit(text)
    if unit is None:
        raise ValueError(f"expected a unit, got {text!r}")
    return unit


def _matches(unit: _Unit, dimension: Dimension) -> bool:
    """Whether a unit measures this dimension; radians count only for angles, speeds and frequencies."""
    if dimension is RATIO:
        return unit.powers == ()
    required = _unit_of(dimension.unit)
    if dimension is SPEED and ("cycle", 1) in unit.powers:
        return unit.powers == (("cycle", 1), ("second", -1))
    if dimension in (ANGLE, SPEED, FREQUENCY):
        return unit.powers == required.powers
    # An angle may be left out, as in N*m for N*m/rad; a torque in N*m/deg is none.
    if dict(unit.powers).get("radian", 0) not in (0, dict(required.powers).get("radian", 0)):
        return False
    return unit.without_angle() == required.without_angle()


def _name_of(unit: _Unit) -> str:
    """Name what a unit measures, for a message: ``"mass"``, or nothing."""
    if unit.powers == ():
        return "plain number"
    return next((d.name.split(" ", 1)[1] for d in _DIMENSIONS if _matches(unit, d)), "")


def parse_quantity(value: object, dimension: Dimension) -> float:
    """Read a quantity: text with a unit, or a plain number in SI.

    Parameters
    ----------
    value : str or float
        Text such as ``"6.35 mm"``, or number such as ``0.00635``.
    dimension : Dimension
        Required dimension.

    Returns
    -------
    float
        Value in ``dimension.unit``: the double nearest to the written decimal number wherever the unit is a decimal
        multiple of the SI unit.

    Raises
    ------
    QuantityError
        When the value is no finite number or text, has no unit or an unknown one, or measures something else.
    """
    expected = f"{dimension.name} such as {dimension.example!r}"
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise QuantityError(expected)
    try:
        number = _parse_text(value, dimension, expected) if isinstance(value, str) else float(value)
    except (OverflowError, InvalidOperation):
        raise QuantityError(f"{expected} that a computer number can hold") from None
    if not math.isfinite(number):
        raise QuantityError(f"{expected}, and a finite one")
    return number


@lru_cache(maxsize=4096)  # a varied case is read again with few other texts
def _parse_text(text: str, dimension: Dimension, expected: str) -> float:
    """Read number and unit of a text; see `parse_quantity`."""
    match = _NUMBER.fullmatch(text) if len(text) <= LONGEST_QUANTITY else None
    if match is None:
        raise QuantityError(expected)
    number, unit_text = Decimal(match[1]), match[2].strip()
    if unit_text == dimension.unit:
        return float(number)
    if not unit_text:
        raise QuantityError(f"{expected} with its unit (numbers without quotes are in {dimension.unit})")
    is_turns = dimension is SPEED and unit_text.translate(_SUPERSCRIPTS).replace(" ", "") in _A_MINUTE
    unit = _parse_unit("rpm" if is_turns else unit_text)
    if unit is None:
        raise QuantityError(f"{expected} (the unit {unit_text!r} is not known)")
    if not _matches(unit, dimension):
        raise QuantityError(expected, note=_name_of(unit))
    turn = 2.0 * math.pi if dimension is SPEED and ("cycle", 1) in unit.powers else 1.0
    return float(number * unit.factor) * turn


def si_unit(unit: str) -> str:
    """Return the SI unit in which :func:`si_amount` gives quantities of a known unit; ``"1"`` for plain numbers."""
    parsed = _parse_unit(unit) if unit else None
    if parsed is None or not parsed.powers:
        return "1"
    for dimension in _DIMENSIONS:
        if _parse_unit(dimension.unit) == _Unit(Decimal(1), parsed.powers):
            return dimension.unit
    return "*".join(_BASE_UNITS.get(name, name) + (f"^{power}" if power != 1 else "") for name, power in parsed.powers)


def split_quantity(text: str) -> tuple[Decimal, str] | None:
    """Split a number from its unit, which may be none; None where the text is neither a number nor a quantity."""
    match = _NUMBER.fullmatch(text.strip()) if len(text) <= LONGEST_QUANTITY else None
    if match is None:
        return None
    unit = match[2].strip()
    return (Decimal(match[1]), unit) if not unit or _parse_unit(unit) is not None else None


def unit_ratio(unit: str, target: str) -> Decimal | None:
    """Return the conversion factor from a unit to another; None where they measure different things."""
    if unit == target:
        return Decimal(1)
    first, second = (_parse_unit(text) if text else None for text in (unit, target))
    return (
        first.factor / second.factor
        if first is not None and second is not None and first.powers == second.powers
        else None
    )


def si_amount(value: object) -> float | None:
    """Return a quantity of any kind in SI, where hertz and rpm are no angular speeds; None for other text."""
    if isinstance(value, str):
        parts = split_quantity(value)
        unit = None if parts is None else _parse_unit(parts[1])
        if parts is None or (parts[1] and unit is None):
            return None
        value = float(parts[0] * unit.factor) if unit is not None and parts[1] else float(parts[0])
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return None
    return float(value)


def amount(value: str | float) -> float:
    """Return in SI the value of a text that is a quantity.

    Raises
    ------
    ValueError
        Where it is none.
    """
    if (number := si_amount(value)) is None:
        raise ValueError(f"{value!r} is no quantity")
    return number


def kind_of(value: object) -> tuple[tuple[str, int], ...] | None:
    """Dimension of a quantity as powers of base units; None for a plain number, whose dimension its key knows."""
    parts = split_quantity(value) if isinstance(value, str) else None
    unit = _parse_unit(parts[1]) if parts is not None and parts[1] else None
    return None if unit is None else unit.without_angle()


def format_quantity(number: float, dimension: Dimension) -> str | float:
    """Write a quantity so that `parse_quantity` gives back the very same float.

    Parameters
    ----------
    number : float
        Value in ``dimension.unit``.
    dimension : Dimension

    Returns
    -------
    str or float
        Text with a unit (the customary one where it is exact); the number itself for a ratio.
    """
    if not dimension.unit:
        return number
    if dimension.display:
        unit = _unit_of(dimension.display)
        customary = float(Decimal(repr(number)) / unit.factor)
        text = f"{customary:.12g} {dimension.display}"
        if math.isfinite(customary) and parse_quantity(text, dimension) == number:
            return text
    short = f"{number:g}"
    return f"{short if float(short) == number else repr(number)} {dimension.unit}"


def rpm(value: float) -> float:
    """Return revolutions per minute as an angular speed [rad/s]."""
    try:
        return value * math.pi / 30.0
    except TypeError:
        raise QuantityError(f"rpm: value is {value!r}; expected a number of revolutions per minute") from None


def to_rpm(speed: float) -> float:
    """Return an angular speed [rad/s] in revolutions per minute."""
    try:
        return speed * 30.0 / math.pi
    except TypeError:
        raise QuantityError(f"to_rpm: speed is {speed!r}; expected a number of radians per second") from None
