"""Cases that cannot run as they say: nothing in them, power against the pairs, torques that do not balance."""

from __future__ import annotations

from typing import Any

import pytest

from gearwhine.case import CaseError, load_case, parse_case
from gearwhine.coupling.description.arrangement import POWER_FROM_THE_DRIVER

STEEL = {"steel": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}}


def gears(pairs: list[tuple[str, str]], **operation: Any) -> dict[str, Any]:
    """Return three gears alone: a and c with 20 teeth, b with 40."""
    return {
        "material": STEEL,
        "gear": [
            {"name": name, "teeth": teeth, "module": "2 mm", "face_width": "20 mm"}
            for name, teeth in (("a", 20), ("b", 40), ("c", 20))
        ],
        "gear_pair": [{"driver": driver, "driven": driven} for driver, driven in pairs],
        "operation": {"speed": "600 rpm", "torque": "30 N*m"} | operation,
    }


def shafts(*outputs: dict[str, Any]) -> dict[str, Any]:
    """Return two shafts without gears, 30 N m in."""
    segments = [{"length": "200 mm", "diameter": "30 mm"}]
    return {
        "material": STEEL,
        "rotor": [{"name": name, "material": "steel", "segments": segments} for name in ("left", "right")],
        "operation": {"speed": "600 rpm", "torque": "30 N*m", "output": list(outputs)},
    }


def problems(document: dict[str, Any]) -> list[str]:
    with pytest.raises(CaseError) as caught:
        parse_case(document)
    return str(caught.value).splitlines()


@pytest.mark.parametrize("document", [{}, {"title": "nothing yet"}, {"rotor": []}, {"material": STEEL}])
def test_a_case_of_nothing_is_an_error(document: dict[str, Any]) -> None:
    assert problems(document) == ["the case: expected at least one of [housing], [[rotor]] and [[gear_pair]]"]


def test_shafts_alone_and_gears_without_a_pair_are_cases() -> None:
    alone = gears([])
    del alone["operation"], alone["gear_pair"]
    assert parse_case(alone).gear_pair == ()
    bare = shafts()
    del bare["operation"]
    assert len(parse_case(bare).rotor) == 2


def test_power_from_driven_to_driver_is_an_error() -> None:
    """In at a, out at c: b must drive c; the pair says otherwise."""
    output = [{"rotor": "c", "torque": "30 N*m"}]
    expected = f'gear_pair[1] ("c" to "b"): expected {POWER_FROM_THE_DRIVER}'
    assert problems(gears([("a", "b"), ("c", "b")], output=output)) == [expected]
    assert parse_case(gears([("a", "b"), ("b", "c")], output=output)).parts.pair_torques == pytest.approx((30.0, 60.0))
    backwards = gears([("a", "b"), ("c", "b")], output=output, speed="-600 rpm")
    assert problems(backwards) == [expected]


def test_a_pair_without_torque_may_stand_either_way() -> None:
    parse_case(gears([("a", "b"), ("c", "b")], torque=0))
    idle = parse_case(gears([("a", "b"), ("c", "b")], output=[{"rotor": "b", "torque": "60 N*m"}]))
    assert idle.parts.pair_torques == pytest.approx((30.0, 0.0), abs=1e-12)


def test_an_output_of_no_torque_is_an_imbalance_and_nothing_worse() -> None:
    (line,) = problems(gears([("a", "b"), ("b", "c")], output=[{"rotor": "c", "torque": 0}]))
    assert "outputs that balance the input torque of 30 N*m" in line


def test_outputs_that_drive_each_other_need_their_torque_as_the_input() -> None:
    """30 N m of c give the 60 N m of b, of twice the teeth, and a idles."""
    output = [{"rotor": "b", "torque": "60 N*m"}, {"rotor": "c", "torque": "-30 N*m"}]
    (line,) = problems(gears([("a", "b"), ("b", "c")], output=output, torque=0))
    assert line.startswith("operation.torque: expected the torque that drives the outputs; where they drive each")
    idle = parse_case(gears([("c", "b"), ("a", "b")], output=output[:1]))
    assert idle.parts.pair_torques == pytest.approx((30.0, 0.0), abs=1e-12)


def test_shafts_without_gears_balance_each_for_itself() -> None:
    """The input goes in where the first output is; 15 N m on each of two shafts balance neither."""
    half = [{"rotor": name, "torque": "15 N*m"} for name in ("left", "right")]
    first, second = problems(shafts(*half))
    assert first.startswith('operation.output[0]: expected torques that balance on rotor "left"')
    assert first.endswith("it takes in 30 N*m and gives out 15 N*m")
    assert second.startswith('operation.output[1]: expected torques that balance on rotor "right"')
    assert second.endswith("it takes in 0 N*m and gives out 15 N*m")
    parse_case(shafts({"rotor": "right", "torque": "30 N*m"}))
    parse_case(shafts({"rotor": "left", "torque": "10 N*m"}, {"rotor": "left", "torque": "20 N*m", "at": 0}))


def test_a_train_that_gears_beyond_all_measure_is_an_error() -> None:
    """160 stages of 2000 to 18 teeth are 10 to the power of 327, more than a float can hold."""
    for big, small in ((2000, 18), (18, 2000)):
        segments = [{"length": "1 m", "diameter": "10 mm"}]
        shape = {"at": "0.5 m", "module": "0.2 mm", "face_width": "10 mm"}
        axes = [[0.2018 * place, 0.0] for place in range(161)]
        document = {
            "material": STEEL,
            "rotor": [
                {"name": f"s{i}", "material": "steel", "axis": a, "segments": segments} for i, a in enumerate(axes)
            ],
            "gear": [{"name": f"a{i}", "rotor": f"s{i}", "teeth": big, **shape} for i in range(160)]
            + [{"name": f"b{i}", "rotor": f"s{i + 1}", "teeth": small, **shape} for i in range(160)],
            "gear_pair": [{"driver": f"a{i}", "driven": f"b{i}"} for i in range(160)],
            "operation": {"speed": "1 rpm", "torque": "1 N*m"},
        }
        assert problems(document) == [
            "gear_pair: expected pairs that gear no shaft up or down more than 1e+12 times in all"
        ]


def test_a_bow_of_one_point_is_refused() -> None:
    with pytest.raises(CaseError, match="two points or more: the centre line through one is straight"):
        load_case("spur-pair", ["rotor.0.bow=[{at='100 mm', amplitude='10 um'}]"])
