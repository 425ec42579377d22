"""The `[update]` table: which numbers of a case it sets, and what is said of one that cannot."""

from typing import Any

import numpy as np
import pytest

from gearwhine.case import CaseError, dump_case, load_case, parse_case
from gearwhine.case.units import amount, kind_of, si_amount, si_unit
from gearwhine.from_case.parametric_housing import FittedCase, fitted_case
from gearwhine.output.dataset import arrays_of
from gearwhine.output.quantity import Rows, document_of
from gearwhine.results.update import PARAMETER
from gearwhine.solve.updating import FoundNumber

RIG = "nasa-gear-noise-rig-nominal"


def fitted(*entries: dict[str, Any], **update: Any) -> FittedCase:
    case = load_case(RIG).case
    table = {"parameter": [{"name": f"p{place}", **entry} for place, entry in enumerate(entries)], **update}
    document = load_case(RIG).case.model_dump(mode="json", by_alias=True, exclude_none=True)
    document["update"] = table
    assert case.update is not None
    return fitted_case(parse_case(document))


def test_values_go_to_every_key_and_nothing_else_changes() -> None:
    made = fitted(
        {"keys": ["housing.box.wall.top", "housing.box.wall.left"], "range": ["5 mm", "20 mm"]},
        {"keys": ["housing.support.*.stiffness.y"], "range": ["1e9 N/m", "2e10 N/m"]},
        {"keys": ["housing.seat.input-back.center[1]"], "range": ["120 mm", "130 mm"]},
        {"keys": ["material.steel.youngs_modulus"], "range": ["190 GPa", "215 GPa"], "spread": "3 GPa"},
    )
    case = made.at([0.008, 6e9, 0.126, 200e9])
    assert case.housing is not None
    assert case.housing.box is not None
    walls = case.housing.box.walls
    assert (walls.top, walls.left, walls.right) == (0.008, 0.008, 0.012)
    assert [entry.stiffness.y for entry in case.housing.support if entry.stiffness] == [6e9] * 4
    assert [seat.center[1] for seat in case.housing.seat] == [0.126, 0.127, 0.127, 0.127]
    assert case.material["steel"].youngs_modulus == 200e9
    assert made.at([number.start for number in made.numbers]) == load_case(RIG).case.model_copy(
        update={"update": case.update}
    )


def test_a_factor_multiplies_what_stands_there() -> None:
    made = fitted({"keys": ["housing.box.size[2]", "housing.seat.*.center[2]"], "range": [0.9, 1.1], "factor": True})
    case = made.at([1.05])
    assert case.housing is not None
    assert case.housing.box is not None
    assert case.housing.box.size[2] == pytest.approx(0.33 * 1.05)
    assert sorted(seat.center[2] for seat in case.housing.seat) == pytest.approx(
        [-0.165 * 1.05] * 2 + [0.165 * 1.05] * 2
    )


def test_keys_with_different_numbers_need_a_factor() -> None:
    """One value for all would change the case before it is fitted: a housing that nobody has would be "before"."""
    keys = {"keys": ["housing.box.wall.top", "housing.box.feet.size[1]"], "range": ["5 mm", "30 mm"]}
    with pytest.raises(CaseError, match=r"wall.top is 0.012 and housing.box.feet.size\[1\] is 0.02 \(SI\)"):
        fitted(keys)
    (number,) = fitted({**keys, "range": [0.5, 2.0], "factor": True}).numbers
    assert list(number.entries(1.0)) == list(zip(number.places, (0.012, 0.02), strict=True))
    inches = load_case("steel-box", ["housing.box.wall=0.5 in", "measured.frequencies=['700 Hz']"]).case
    document = inches.model_dump(mode="json", by_alias=True, exclude_none=True)
    document["housing"]["box"]["feet"]["size"][1] = "12.7 mm"
    document["update"] = {"parameter": [{"name": "p", **keys}]}
    assert fitted_case(parse_case(document)).numbers[0].start == pytest.approx(0.0127)


def test_one_wall_for_all_becomes_a_wall_for_each_face() -> None:
    made = fitted_case(
        load_case(
            "steel-box",
            [
                "measured.frequencies=['700 Hz']",
                "update.parameter=[{name='top', keys=['housing.box.wall.top'], range=['8 mm', '14 mm']}]",
            ],
        ).case
    )
    case = made.at([0.009])
    assert case.housing is not None
    assert case.housing.box is not None
    assert (case.housing.box.walls.top, case.housing.box.walls.front) == (0.009, 0.010)


def test_priors_are_what_is_given_or_follow_from_the_case_and_the_range() -> None:
    key = "housing.box.wall.top"
    own = fitted({"keys": [key], "range": ["6 mm", "27 mm"]}).numbers[0].parameter
    assert (own.nominal, own.spread) == pytest.approx((0.012, 0.005))
    (number,) = fitted({"keys": [key], "range": ["6 mm", "27 mm"], "nominal": "10 mm", "spread": "1 mm"}).numbers
    assert (number.parameter.nominal, number.parameter.spread, number.start) == pytest.approx((0.010, 0.001, 0.012))


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"keys": ["housing.box.wall.lid"], "range": [0.005, 0.02]}, "the key path of a number in this case"),
        ({"keys": ["housing.material"], "range": [0.005, 0.02]}, "housing.material is none"),
        ({"keys": ["housing.box.size"], "range": [0.005, 0.02]}, "housing.box.size is none"),
        ({"keys": ["housing.box.wall.top"] * 2, "range": [0.005, 0.02]}, "a key that no other sets"),
        ({"keys": ["housing.box.wall.top"], "range": [0.013, 0.02]}, "a range with the case's own 0.012 in it"),
    ],
)
def test_keys_that_lead_nowhere_are_named(entry: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as error:
        fitted(entry)
    assert said in str(error.value)
    assert "update.parameter[0]" in str(error.value)


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"range": ["5 mm", "20 N/m"]}, "that measure the same"),
        ({"range": ["20 mm", "5 mm"]}, "a range that ascends"),
        ({"range": ["5 mm", "much"]}, "a quantity such as '12 mm'"),
        ({"range": ["5 mm", "20 mm"], "nominal": "2 mm"}, "a nominal value within the range"),
        ({"range": ["5 mm", "20 mm"], "spread": "0 mm"}, "a spread above 0"),
        ({"range": [0.0, 2.0], "factor": True}, "factors above 0"),
        ({"range": ["5 mm", "20 mm"], "keys": ["a..b"]}, "a key path of this case"),
    ],
)
def test_wrong_parameters_are_errors_of_the_case(entry: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as error:
        fitted({"keys": ["housing.box.wall.top"], **entry})
    assert said in str(error.value)


def test_the_table_survives_being_written() -> None:
    import tomllib

    case = load_case(RIG).case
    assert parse_case(tomllib.loads(dump_case(case))) == case


@pytest.mark.parametrize(
    ("text", "value"),
    [("12 mm", 0.012), ("207 GPa", 207e9), ("5e8 N/m", 5e8), (3, 3.0), ("7", 7.0), ("12 parsnips", None)],
)
def test_amounts_of_any_kind(text: object, value: float | None) -> None:
    assert si_amount(text) == (None if value is None else pytest.approx(value))


def test_kinds_tell_lengths_from_stiffnesses() -> None:
    assert kind_of("12 mm") == kind_of("1 in") != kind_of("5 N/m")
    assert amount("1 in") == pytest.approx(0.0254)


def test_results_are_in_the_unit_that_they_name() -> None:
    """A wall of 12 mm is 0.012 m, a modulus of 207 GPa 207e9 Pa, a factor 1: in JSON and in labelled arrays."""
    made = fitted(
        {"keys": ["housing.box.wall.top"], "range": ["5 mm", "20 mm"]},
        {"keys": ["material.steel.youngs_modulus"], "range": ["190 GPa", "215 GPa"]},
        {"keys": ["housing.support.*.stiffness.y"], "range": ["1e3 N/mm", "1e8 N/mm"]},
        {"keys": ["housing.box.size[2]"], "range": [0.9, 1.1], "factor": True},
    )
    found = [FoundNumber(number, 1.1 * number.start, 0.01 * number.start, 0.5) for number in made.numbers]
    rows = document_of((Rows("parameters", lambda found: found, PARAMETER),), found)["parameters"]
    arrays = arrays_of((Rows("parameters", lambda found: found, PARAMETER, "parameter"),), found)
    stiffness = rows[2]["before"]
    assert [(row["before"], row["unit"]) for row in rows] == [
        (pytest.approx(0.012), "m"),
        (pytest.approx(207e9), "Pa"),
        (pytest.approx(stiffness), "N/m"),
        (pytest.approx(1.0), "1"),
    ]
    assert list(arrays["unit"][1]) == [row["unit"] for row in rows]
    for key in ("before", "after"):
        assert arrays[f"value_{key}"][1] == pytest.approx(np.array([row[key] for row in rows]))
    # Back to what is written: the unit beside its size in SI.
    written = [(row["before"] / row["written_unit_in_si"], row["written_unit"]) for row in rows[:2]]
    assert written == [(pytest.approx(12.0), "mm"), (pytest.approx(207.0), "GPa")]


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("mm", "m"), ("1/in", "1/m"), ("N/mm", "N/m"), ("g/cm^3", "kg/m^3"), ("deg", "rad"), ("%", "1"), ("", "1"),
     ("kHz", "Hz"), ("kg*mm^2", "kg*m^2"), ("lbf/s", "kg*m*s^-3")],
)  # fmt: skip
def test_the_si_unit_of_a_unit_is_that_of_its_amounts(unit: str, expected: str) -> None:
    assert si_unit(unit) == expected
    if unit and expected != "1":
        assert si_amount(f"1 {expected}") == 1.0
