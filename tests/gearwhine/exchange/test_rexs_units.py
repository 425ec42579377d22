"""Units of REXS files against pint, which knows them by their definitions."""

import pint
import pytest

from gearwhine.exchange.rexs.units import UNITS, WRITTEN, in_unit

PINT: pint.UnitRegistry[float] = pint.UnitRegistry()
NAMES = {"mum": "micrometer", "1 / min": "turn / min", "°": "deg", "1e-6 / C": "1e-6 / K", "C": "degC", "%": "percent"}
"""What pint calls the names that it reads otherwise."""


@pytest.mark.parametrize("name", [name for name in UNITS if name not in ("", "none")])
def test_a_unit_is_that_of_its_name(name: str) -> None:
    unit, text = UNITS[name], name
    for own, other in NAMES.items():
        text = other if text == own else text.replace(own, other) if own == "mum" else text
    for number in (0.0, 1.0, -3.5):
        amount = PINT.Quantity(number, text) if "1e-6" not in text else number * PINT.Quantity(1e-6, "1 / K")
        expected = amount.to(unit.si or "dimensionless").magnitude
        assert number * unit.factor + unit.offset == pytest.approx(expected, rel=1e-12)
        assert in_unit(expected, name) == pytest.approx(number, rel=1e-12, abs=1e-12)


def test_an_amount_is_written_in_a_unit_of_its_measure() -> None:
    assert all(UNITS[name].si == measure for measure, name in WRITTEN.items())
