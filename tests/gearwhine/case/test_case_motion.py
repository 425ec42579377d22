"""Speeds, torques and mesh frequencies of gear trains, worked out by hand from tooth numbers."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearwhine.case import Case, CaseError, load_case, parse_case, require


def gears(teeth: dict[str, int], pairs: list[tuple[str, str]], **operation: Any) -> Case:
    """Return a case of gears alone, module 2 mm."""
    return parse_case(
        {
            "material": {"steel": {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}},
            "gear": [{"name": name, "teeth": z, "module": "2 mm", "face_width": "20 mm"} for name, z in teeth.items()],
            "gear_pair": [{"driver": a, "driven": b} for a, b in pairs],
            "operation": {"speed": "600 rpm", "torque": "30 N*m"} | operation,
        }
    )


def test_an_idler_turns_back_and_passes_the_torque_on() -> None:
    """20 : 30 : 40 teeth at 600 rpm, 30 N m: speeds 600, -400, 300 rpm; 20 teeth 10 times a second mesh at 200 Hz."""
    case = gears({"a": 20, "b": 30, "c": 40}, [("a", "b"), ("b", "c")])
    rpm = {name: speed * 60 / (2 * math.pi) for name, speed in case.parts.speeds.items()}
    assert rpm == pytest.approx({"a": 600.0, "b": -400.0, "c": 300.0})
    assert case.parts.mesh_frequencies == pytest.approx((200.0, 200.0))
    # the output, turning forwards, is held back by 30 N m * 40 / 20
    assert [(t.rotor, t.value) for t in case.parts.torques] == [("a", 30.0), ("c", pytest.approx(-60.0))]
    # the idler receives 30 N m * 30 / 20 and passes all of it on
    assert case.parts.pair_torques == pytest.approx((30.0, 45.0))


def test_two_outputs_share_the_power_equally() -> None:
    """The arrangement of NASA TM-101442: stage 1 drives 2 and 3, 36 teeth all, 2.25 kN m in at 1500 rpm (900 Hz)."""
    teeth = {"one": 36, "two": 36, "three": 36}
    case = gears(teeth, [("one", "two"), ("one", "three")], speed="1500 rpm", torque="2.25 kN*m")
    assert case.parts.mesh_frequencies == pytest.approx((900.0, 900.0))
    assert case.parts.pair_torques == pytest.approx((1125.0, 1125.0))
    assert [t.value for t in case.parts.torques] == pytest.approx([2250.0, 1125.0, 1125.0])


def test_given_outputs_split_the_torque() -> None:
    outputs = [{"rotor": "two", "torque": "1000 N*m"}, {"rotor": "three", "torque": "1250 N*m"}]
    teeth = {"one": 36, "two": 36, "three": 36}
    case = gears(teeth, [("one", "two"), ("one", "three")], torque="2.25 kN*m", output=outputs)
    assert case.parts.pair_torques == pytest.approx((1000.0, 1250.0))


def test_outputs_within_one_per_cent_are_scaled_to_balance() -> None:
    case = gears({"a": 20, "b": 20}, [("a", "b")], output=[{"rotor": "b", "torque": "29.8 N*m"}])
    assert [t.value for t in case.parts.torques] == [30.0, 30.0]


def test_turning_the_other_way_turns_every_sign() -> None:
    forwards = gears({"a": 20, "b": 30}, [("a", "b")])
    backwards = gears({"a": 20, "b": 30}, [("a", "b")], speed="-600 rpm")
    assert [t.value for t in backwards.parts.torques] == [-t.value for t in forwards.parts.torques]
    assert backwards.parts.pair_torques == forwards.parts.pair_torques
    assert backwards.parts.mesh_frequencies == forwards.parts.mesh_frequencies


def test_a_split_path_that_can_turn_carries_half_on_each_side() -> None:
    """Two equal idlers between one driver and one driven gear: by symmetry, half the torque through each."""
    pairs = [("in", "left"), ("in", "right"), ("left", "out"), ("right", "out")]
    case = gears({"in": 20, "left": 30, "right": 30, "out": 40}, pairs)
    assert case.parts.train.ratios == {
        "in": 1,
        "left": Fraction(-2, 3),
        "right": Fraction(-2, 3),
        "out": Fraction(1, 2),
    }
    assert case.parts.pair_torques == pytest.approx((15.0, 15.0, 22.5, 22.5))


@given(st.lists(st.integers(18, 200), min_size=2, max_size=6), st.floats(1.0, 1e4), st.floats(1.0, 1e3))
def test_power_in_is_power_out_along_any_chain(teeth: list[int], torque: float, speed: float) -> None:
    names = [f"g{index}" for index in range(len(teeth))]
    chain = list(itertools.pairwise(names))
    case = gears(dict(zip(names, teeth, strict=True)), chain, torque=torque, speed=speed)
    speeds = case.parts.speeds
    power = [applied.value * speeds[applied.rotor] for applied in case.parts.torques]
    assert power[0] == pytest.approx(torque * speed)
    assert sum(power) == pytest.approx(0.0, abs=1e-9 * torque * speed)
    through = [t * abs(speeds[driver]) for t, (driver, _) in zip(case.parts.pair_torques, chain, strict=True)]
    assert through == pytest.approx([torque * speed] * len(chain))


def test_without_gears_every_rotor_has_the_speed_of_the_operation() -> None:
    case = load_case("friswell-rotor").case
    assert case.parts.speeds == pytest.approx({"shaft": 4000 * 2 * math.pi / 60})
    assert (case.parts.torques, case.parts.pair_torques, case.parts.mesh_frequencies) == ((), (), ())
    assert case.sweep is not None
    assert [round(speed * 30 / math.pi) for speed in case.sweep.speeds] == list(range(0, 4001, 500))


def test_stations_of_torques_are_the_ends_unless_given() -> None:
    ends = [(t.rotor, t.at) for t in load_case("spur-pair").case.parts.torques]
    assert ends == [("input", 0.0), ("output", pytest.approx(0.2))]
    given_places = load_case("spur-pair", ["operation.at=30 mm"]).case
    assert given_places.parts.torques[0].at == 0.03


def test_what_a_command_needs_and_a_case_lacks_is_said() -> None:
    rotor = load_case("friswell-rotor").case
    require(rotor, "rotor", "operation", command="rotors")
    with pytest.raises(CaseError) as caught:
        require(rotor, "housing", "gear", command="run")
    assert "'run' needs [housing], which this case does not have" in str(caught.value)
    assert "'run' needs [[gear]], which this case does not have" in str(caught.value)
