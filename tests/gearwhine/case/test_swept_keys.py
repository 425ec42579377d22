"""Keys and values of a sweep: what ``--over`` says, and how it stands beside ``[sweep]``."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.case import CaseError, load_case
from gearwhine.case.swept_keys import parse_over, swept_keys


def test_a_range_has_both_ends_and_even_steps() -> None:
    key = parse_over("operation.torque=10 N*m:100 N*m:10")
    assert key.key == "operation.torque"
    assert key.unit == "N*m"
    assert key.values == tuple(range(10, 101, 10))
    assert key.texts[0] == "10 N*m"
    assert key.texts[-1] == "100 N*m"


def test_ends_may_have_units_of_their_own() -> None:
    key = parse_over("housing.box.wall=1 cm:12 mm:3")
    assert key.unit == "cm"
    assert key.values == (1.0, 1.1, 1.2)


def test_whole_numbers_stay_whole() -> None:
    assert parse_over("gear.pinion.teeth=20:30:3").texts == ("20", "25", "30")
    assert parse_over("gear_pair.0.damping_ratio=0.05:0.1:2").texts == ("0.05", "0.1")


def test_a_list_of_numbers_and_one_of_words() -> None:
    assert parse_over("operation.speed=900 rpm, 95 rad/s").values == pytest.approx((900.0, 907.183178178))
    words = parse_over("rotor.input.mass=lumped,distributed")
    assert words.values == ("lumped", "distributed")
    assert not words.is_numeric


def test_commas_and_colons_within_brackets_and_quotes_divide_nothing() -> None:
    key = parse_over("housing.box.size=['1 m','2 m','3 m'],['1 m', '2 m', '4 m']")
    assert key.texts == ("['1 m','2 m','3 m']", "['1 m', '2 m', '4 m']")
    assert parse_over('title="a:b","c, d"').texts == ('"a:b"', '"c, d"')


WRONG = {
    "no key": "=1:2:3",
    "no values": "operation.torque=",
    "no equals sign": "operation.torque",
    "two ends alone": "operation.torque=1:2",
    "a count that is none": "operation.torque=1:2:x",
    "a count of one": "operation.torque=1:2:1",
    "a count beyond counting": "operation.torque=1:2:99999999999",
    "ends alike": "operation.torque=1:1:3",
    "ends of two kinds": "operation.speed=100 rpm:10 Hz:3",
    "ends that are words": "rotor.0.mass=a:b:3",
    "a value twice": "operation.torque=1,1",
    "an empty value": "operation.torque=1,,2",
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_no_range_and_no_list_is_named(kind: str) -> None:
    with pytest.raises(CaseError, match="--over"):
        parse_over(WRONG[kind])


def test_speeds_of_the_case_come_first_and_exact() -> None:
    case = load_case(
        "small-gearbox", ["sweep={ speed = { from = '1500 rpm', to = '6000 rpm', step = '250 rpm' } }"]
    ).case
    speed, torque = swept_keys(case, ["operation.torque=10,20"])
    assert (speed.key, torque.key) == ("operation.speed", "operation.torque")
    assert speed.values == tuple(range(1500, 6001, 250))
    assert case.sweep is not None
    read_back = [load_case("small-gearbox", override).case.operation.speed for override in speed.overrides]  # type: ignore[union-attr]
    assert tuple(read_back) == case.sweep.speeds


def test_a_sweep_turns_in_the_sense_of_operation() -> None:
    """The thrust of helical teeth changes its direction with the sense of rotation: points would be others."""
    overrides = ["operation.speed=-3000 rpm", "sweep.speed=['3000 rpm', '0 rpm']"]
    case = load_case("helical-pair", overrides).case
    (speed,) = swept_keys(case, [])
    assert speed.values == (-3000.0, 0.0)
    assert speed.texts == ("-3000 rpm", "0 rpm")
    assert load_case("helical-pair", [*overrides, *speed.overrides[0]]).case == case


def test_over_the_speed_takes_the_place_of_the_sweep_in_the_case() -> None:
    case = load_case("small-gearbox", ["sweep.speed=['1500 rpm']"]).case
    (speed,) = swept_keys(case, ["operation.speed=1 Hz,2 Hz"])
    assert speed.values == (1.0, 2.0)


def test_nothing_to_go_through_twice_the_same_and_too_much() -> None:
    case = load_case("small-gearbox").case
    with pytest.raises(CaseError, match=r"\[?sweep|--over"):
        swept_keys(case, [])
    with pytest.raises(CaseError, match="each key once"):
        swept_keys(case, ["operation.torque=1,2", "operation.torque=3,4"])
    with pytest.raises(CaseError, match="at most 10000 points"):
        swept_keys(case, ["operation.torque=1:2:101", "operation.speed=1:2:100"])


@pytest.mark.parametrize(
    ("over", "part", "whole"),
    [
        (
            ["housing.box.wall=6 mm,8 mm", "housing.box.wall.back=7 mm,9 mm"],
            "housing.box.wall.back",
            "housing.box.wall",
        ),
        (
            ["housing.box.wall.back=7 mm,9 mm", "housing.box.wall=6 mm,8 mm"],
            "housing.box.wall.back",
            "housing.box.wall",
        ),
        (["operation.over_time.time,operation.over_time=1,2"], "operation.over_time.time", "operation.over_time"),
        (["operation={speed=1},{speed=2}"], "operation.speed", "operation"),
    ],
)
def test_a_table_and_a_key_of_it_are_not_swept_both(over: list[str], part: str, whole: str) -> None:
    """The table, set behind its key, would take the key's value back, and the axis would tell what is not there."""
    case = load_case("small-gearbox", ["sweep.speed=['1500 rpm']"]).case
    with pytest.raises(CaseError, match=f"none holds another: {part}, which is swept too, is a part of {whole}"):
        swept_keys(case, over)


def test_keys_beside_each_other_in_one_table_are_swept() -> None:
    keys = swept_keys(
        load_case("small-gearbox").case, ["housing.box.wall.back=7 mm,9 mm", "housing.box.wall.top=6 mm,8 mm"]
    )
    assert [key.key for key in keys] == ["housing.box.wall.back", "housing.box.wall.top"]


@given(
    st.decimals(-1000, 1000, places=3),
    st.decimals(-1000, 1000, places=3),
    st.integers(2, 60),
    st.sampled_from(["", " mm", " N*m", " rpm"]),
)
def test_every_value_written_reads_back_and_the_spacing_is_even(low, high, count: int, unit: str) -> None:
    if low == high:
        return
    key = parse_over(f"a.b={low}{unit}:{high}{unit}:{count}")
    assert len(key.values) == count
    step = float(high - low) / (count - 1)
    for number, (text, value) in enumerate(zip(key.texts, key.values, strict=True)):
        assert float(text.split()[0]) == value
        assert value == pytest.approx(float(low) + number * step, abs=1e-8)
    assert key.values[0] == float(low)
    assert key.values[-1] == float(high)
