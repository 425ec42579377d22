"""Loads over time that a result cannot follow are told: unbalanced torques, and those that steady motions leave out."""

import math
from dataclasses import replace

import pytest

import gearwhine as gw
from gearwhine.coupling.analyses.shafts_alone import held_speeds
from gearwhine.from_case.machine import describe_machine

RAMP = {"time": ["0 s", "1 ms"], "torque": ["0 N*m", "6 N*m"]}
OUTPUT = [{"rotor": "output", "torque": "20 N*m", "over_time": RAMP}]


def test_torque_taken_off_over_time_is_unbalanced_unless_the_input_gives_it() -> None:
    """At the first driver, over the ratio of speeds: here 28 teeth drive as many."""
    alone = gw.load("spur-pair", {"operation.torque": "20 N*m", "operation.output": OUTPUT}).case
    assert describe_machine(alone).unbalanced_torque == pytest.approx(6.0)
    both = gw.load(
        "spur-pair", {"operation.torque": "20 N*m", "operation.output": OUTPUT, "operation.over_time": RAMP}
    ).case
    assert describe_machine(both).unbalanced_torque == 0.0
    # An input that falls as the output rises leaves both.
    falling = {"time": RAMP["time"], "torque": ["0 N*m", "-6 N*m"]}
    apart = {"operation.torque": "20 N*m", "operation.output": OUTPUT, "operation.over_time": falling}
    assert describe_machine(gw.load("spur-pair", apart).case).unbalanced_torque == pytest.approx(12.0)
    shared = gw.load("spur-pair", {"operation.over_time": RAMP}).case
    assert describe_machine(shared).unbalanced_torque == 0.0


def test_a_run_under_unbalanced_torques_says_so() -> None:
    changes = {
        "operation.torque": "20 N*m",
        "operation.output": OUTPUT,
        "transient.revolutions": 1,
        "transient.discard": 0.5,
    }
    warnings = {one["name"]: one for one in gw.load("spur-pair", changes).run().document["warnings"]}
    assert warnings["unbalanced torque"]["torque_n_m"] == pytest.approx(6.0)
    assert "balance them, or take a free run" in warnings["unbalanced torque"]["message"]


def test_a_steady_motion_says_what_loads_it_leaves_out() -> None:
    study = gw.load("spur-pair", {"operation.over_time": RAMP})
    warnings = {one["name"]: one for one in study.steady().document["warnings"]}
    assert warnings["loads over time"]["keys"] == ["operation.over_time"]
    assert "loads over time" not in {one["name"] for one in gw.load("spur-pair").steady().document["warnings"]}


def test_a_branch_over_speed_keeps_within_the_tables_of_the_bearings() -> None:
    case = gw.load("overhung-fan").case
    low, high = case.parts.table_range("fan")
    assert 0.0 < low < high < math.inf
    held = held_speeds(describe_machine(case))
    assert held == pytest.approx((low, high))
    # The branch goes from half the speed to one and a half times it.
    for speed in (0.5 * (low + high), -high):
        solved = gw.Study(replace(describe_machine(case), speed=speed))
        ends = max(low, 0.5 * abs(speed)), min(high, 1.5 * abs(speed))
        assert solved._branch_speeds(down=False) == pytest.approx(tuple(math.copysign(end, speed) for end in ends))
