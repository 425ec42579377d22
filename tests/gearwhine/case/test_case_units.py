"""Quantities: every unit's scale against its definition, dimensions kept apart, nothing evaluated."""

from __future__ import annotations

import math
import time
from importlib import import_module
from pkgutil import iter_modules

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from gearwhine import case
from gearwhine.case import units
from gearwhine.case.fields import Quantity
from gearwhine.case.units import Dimension, QuantityError, format_quantity, parse_quantity

DEFINED = [
    # text, dimension, SI value from the unit's definition
    ("6.35 mm", units.LENGTH, 0.00635),
    ("10in", units.LENGTH, 0.254),
    ("25 µm", units.LENGTH, 25e-6),
    ("25 um", units.LENGTH, 25e-6),
    ("+1.5e1 cm", units.LENGTH, 0.15),
    (".5 m", units.LENGTH, 0.5),
    ("4 kg", units.MASS, 4.0),
    ("300 g", units.MASS, 0.3),
    ("207 GPa", units.STRESS, 207e9),
    ("206000 N/mm^2", units.STRESS, 206e9),
    ("7.85 g/cm**3", units.DENSITY, 7850.0),
    ("7850 kg/m³", units.DENSITY, 7850.0),
    ("200 kg mm^2", units.INERTIA, 2e-4),
    ("2e-5 kg*m", units.IMBALANCE, 2e-5),
    ("20 g*mm", units.IMBALANCE, 2e-5),
    ("120 N/um", units.STIFFNESS, 1.2e8),
    ("500 N*s/m", units.DAMPING, 500.0),
    ("1e4 N*m/rad", units.TILT_STIFFNESS, 1e4),
    ("1e4 N*m", units.TILT_STIFFNESS, 1e4),
    ("2 N·m/(rad)", units.TILT_STIFFNESS, 2.0),
    ("71.77 N*m", units.TORQUE, 71.77),
    ("2.25 kN*m", units.TORQUE, 2250.0),
    *((text, units.TORQUE, 71.77) for text in ("71.77 Nm", "71.77 N m", "71.77 N·m", "71.77 N⋅m", "71.77Nm")),
    ("2.25 kNm", units.TORQUE, 2250.0),
    ("850 Nmm", units.TORQUE, 0.85),
    ("2 Nm/rad", units.TILT_STIFFNESS, 2.0),
    ("3 Nm s/rad", units.TILT_DAMPING, 3.0),
    ("180 deg", units.ANGLE, math.pi),
    ("90°", units.ANGLE, math.pi / 2),
    ("1 rad", units.ANGLE, 1.0),
    ("3.2 kHz", units.FREQUENCY, 3200.0),
    ("658 Hz", units.FREQUENCY, 658.0),
    ("60 rpm", units.SPEED, 2 * math.pi),
    ("60 1/min", units.SPEED, 2 * math.pi),
    ("60 min⁻¹", units.SPEED, 2 * math.pi),
    ("7850 kg/m3", units.DENSITY, 7850.0),
    ("3 N/mm2", units.STRESS, 3e6),
    ("60 rev/min", units.SPEED, 2 * math.pi),
    ("1 Hz", units.SPEED, 2 * math.pi),
    ("360 deg/s", units.SPEED, 2 * math.pi),
    ("7 rad/s", units.SPEED, 7.0),
    ("8 1/in", units.DIAMETRAL_PITCH, 8 / 0.0254),
    ("0.4 1/mm", units.DIAMETRAL_PITCH, 400.0),
    ("1 %", units.RATIO, 0.01),
    (0.02, units.RATIO, 0.02),
    (3, units.LENGTH, 3.0),
]


@pytest.mark.parametrize("symbol", units.COMMON_UNITS)
def test_common_units_are_those_of_the_registry(symbol: str) -> None:
    ours, registered = units.COMMON_UNITS[symbol], units.registered_unit(symbol)
    assert registered is not None
    assert ours.powers == registered.powers
    assert float(ours.factor) == float(registered.factor)


@pytest.mark.parametrize(("text", "dimension", "expected"), DEFINED)
def test_units_have_the_scale_of_their_definition(text: object, dimension: Dimension, expected: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(expected, rel=4e-16, abs=0.0)


@pytest.mark.parametrize(
    ("text", "dimension"),
    [
        ("3 kg", units.LENGTH),
        ("3 m3", units.LENGTH),
        ("3 kg/m 3", units.DENSITY),
        ("3 1/s", units.SPEED),
        ("3 1/min", units.FREQUENCY),
        ("3 mm^2", units.LENGTH),
        ("3 m/m", units.LENGTH),
        ("20 degC", units.ANGLE),
        ("3 m^0.5", units.LENGTH),
        ("3 dB", units.RATIO),
        ("3000 rpm", units.FREQUENCY),
        ("30 1/s", units.FREQUENCY),
        ("8 1/", units.DIAMETRAL_PITCH),
        ("8 1/1/in", units.DIAMETRAL_PITCH),
        ("8 in", units.DIAMETRAL_PITCH),
        ("30 rad/s", units.FREQUENCY),
        ("30 Hz*s/s", units.LENGTH),
        ("0.5", units.ANGLE),
        ("20 %", units.ANGLE),
        ("3 rad", units.RATIO),
        ("9**9**9", units.LENGTH),
        ("9 m^9^9", units.LENGTH),
        ("1e400 m", units.LENGTH),
        ("1e9999 m", units.LENGTH),
        ("nan m", units.LENGTH),
        ("(3 m)", units.LENGTH),
        ("3 m;import os", units.LENGTH),
        ("__import__('os')", units.LENGTH),
        ("3 " + "m*" * 1000 + "m", units.LENGTH),
        ("9" * 1000 + " m", units.LENGTH),
        ("", units.LENGTH),
        (True, units.LENGTH),
        (None, units.LENGTH),
        (float("nan"), units.LENGTH),
        (10**400, units.LENGTH),
    ],
)
def test_what_is_not_the_quantity_asked_for_is_refused_at_once(text: object, dimension: Dimension) -> None:
    started = time.perf_counter()
    with pytest.raises(QuantityError) as caught:
        parse_quantity(text, dimension)
    assert dimension.example in str(caught.value)
    assert time.perf_counter() - started < 5.0  # no exponentials of exponentials


PREFIXES = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "km": 1e3}


@given(st.decimals(-(10**6), 10**6, allow_nan=False, places=6), st.sampled_from(sorted(PREFIXES)))
def test_a_decimal_prefix_is_exact(number: object, unit: str) -> None:
    """The value is the double nearest to the decimal number, as if it had been written in metres."""
    exponent = {"m": 0, "mm": -3, "um": -6, "km": 3}[unit]
    assert parse_quantity(f"{number:f} {unit}", units.LENGTH) == float(f"{number:f}e{exponent}")


@given(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([units.LENGTH, units.STRESS, units.SPEED, units.ANGLE, units.FREQUENCY, units.TILT_DAMPING]),
)
def test_writing_and_reading_gives_the_very_same_float(number: float, dimension: Dimension) -> None:
    assert parse_quantity(format_quantity(number, dimension), dimension) == number


@given(st.text(max_size=40))
def test_any_text_is_a_number_or_a_quantity_error(text: str) -> None:
    for dimension in (units.LENGTH, units.SPEED, units.RATIO):
        try:
            number = parse_quantity(text, dimension)
        except QuantityError:
            continue
        assert math.isfinite(number)


@given(st.from_regex(r"[0-9]{1,3} [a-zA-Z]{1,4}([*/][a-zA-Z]{1,3})?(\^[0-9-]{1,2})?", fullmatch=True))
def test_any_unit_is_one_dimension_or_none(text: str) -> None:
    """No text is both a length and a mass, whatever units the registry knows."""
    read = []
    for dimension in (units.LENGTH, units.MASS, units.STRESS, units.FREQUENCY, units.SPEED, units.ANGLE):
        try:
            read.append(parse_quantity(text, dimension))
        except QuantityError:
            continue
    assert len(read) <= (2 if "Hz" in text or "hertz" in text else 1)


def test_customary_units_are_used_where_nothing_is_lost() -> None:
    assert format_quantity(parse_quantity("5500 rpm", units.SPEED), units.SPEED) == "5500 rpm"
    assert format_quantity(parse_quantity("24 deg", units.ANGLE), units.ANGLE) == "24 deg"
    assert format_quantity(0.00635, units.LENGTH) == "0.00635 m"


@pytest.mark.parametrize(
    "dimension", [one for one in vars(units).values() if isinstance(one, Dimension)], ids=lambda one: one.name
)
def test_a_quantity_ends_at_its_bounds_of_either_sign(dimension: Dimension) -> None:
    def takes(number: float, **bounds: float) -> bool:
        try:
            return Quantity(dimension, **bounds).validate(number) == number
        except PydanticCustomError:
            return False

    for sign in (1.0, -1.0):
        assert takes(sign * dimension.largest)
        assert not takes(1.001 * sign * dimension.largest)
    assert takes(dimension.smallest, above=0.0)
    assert not takes(0.999 * dimension.smallest, above=0.0)
    assert takes(-dimension.smallest)
    assert [takes(number, at_least=-0.5, below=0.25) for number in (-0.51, -0.5, 0.24, 0.25)] == [0, 1, 1, 0]
    assert [takes(number, above=-0.5, at_most=0.25) for number in (-0.5, -0.49, 0.25, 0.26)] == [0, 1, 1, 0]


NEVER_NEGATIVE = (
    "Mass",
    "Inertia",
    "Imbalance",
    "Torque",
    "TiltStiffness",
    "TiltDamping",
    "FrictionCoefficient",
    "Time",
)
ABOVE_ZERO = ("Density", "ElasticModulus", "SpeedOfSound", "TorsionalStiffness", "Module", "ToothHeight", "Order")


def test_quantities_keep_the_signs_that_their_names_have() -> None:
    """What is named positive is above zero; what is named from zero, or is a sum of squares, takes zero."""
    modules = [import_module(f"gearwhine.case.{one.name}") for one in iter_modules(case.__path__)]
    found = {
        name: bound
        for module in modules
        for name, alias in vars(module).items()
        for bound in getattr(alias, "__metadata__", ())
        if isinstance(bound, Quantity)
    }
    assert len(found) > 40
    for name, bound in found.items():
        positive = name.startswith("Positive") or name in ABOVE_ZERO
        for number in (0.0, -bound.dimension.smallest) if positive else ():
            with pytest.raises(PydanticCustomError):
                bound.validate(number)
        if name.endswith("FromZero") or name in NEVER_NEGATIVE:
            assert bound.validate(0.0) == 0.0
            with pytest.raises(PydanticCustomError):
                bound.validate(-bound.dimension.smallest)
    assert {*NEVER_NEGATIVE, *ABOVE_ZERO} < found.keys()
