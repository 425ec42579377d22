"""Warnings of an operation that loads only part of the train, or whose lines of torque miss its torque."""

import tomllib

import pytest
from reducer_case import reducer

from gearwhine.case import Case, parse_case
from gearwhine.coupling.analyses.operation_warnings import operation_warnings
from gearwhine.coupling.load_analysis.load_warnings import load_warnings
from gearwhine.coupling.load_analysis.solved_load import solve_load
from gearwhine.from_case.machine import describe_machine
from gearwhine.solve.case_summary import check_case

RUN = {"transient": {"run": {"from": "2000 rpm", "time": "1 s"}}}


def case_of(text: str, **operation: object) -> Case:
    document = tomllib.loads(text)
    document["operation"] |= operation
    return parse_case(document | (RUN if operation else {}))


def test_a_pair_behind_which_nothing_is_taken_off_is_told() -> None:
    """With driver and driven of the second stage exchanged the torque leaves at the middle shaft."""
    assert operation_warnings(describe_machine(case_of(reducer()), None)) == []
    exchanged = reducer().replace('driver = "c"\ndriven = "d"', 'driver = "d"\ndriven = "c"')
    (told,) = operation_warnings(describe_machine(case_of(exchanged)))
    assert told["name"] == "idle gear pair"
    assert told["gear_pair"] == "d -> c"
    assert "exchanged" in told["message"]
    idle = case_of(exchanged)
    assert told in check_case(idle).warnings
    assert told in load_warnings(solve_load(describe_machine(idle)))
    # Where the case says where the torque leaves, it is meant so.
    output = f'output = [{{ rotor = "middle", torque = {60.0 * 72.0 / 21.0} }}]\n'
    assert operation_warnings(describe_machine(case_of(exchanged + output))) == []
    assert (
        operation_warnings(describe_machine(case_of(reducer().replace('torque = "60 N*m"', 'torque = "0 N*m"')), None))
        == []
    )


def test_two_shafts_that_share_the_power_without_being_named_are_told() -> None:
    """With driver and driven of the first stage exchanged torque and speed are those of the middle shaft."""
    exchanged = reducer().replace('driver = "a"\ndriven = "b"', 'driver = "b"\ndriven = "a"')
    assert exchanged != reducer()
    (told,) = operation_warnings(describe_machine(case_of(exchanged)))
    assert told["name"] == "several outputs"
    assert (told["input"], sorted(told["outputs"])) == ("middle", ["input", "output"])
    assert "are driver and driven of gear pair 'b' -> 'a' exchanged?" in told["message"]
    halves = {"input": 30.0 * 21.0 / 72.0, "output": 30.0 * 56.0 / 19.0}
    listed = ", ".join(f'{{ rotor = "{name}", torque = {torque} }}' for name, torque in halves.items())
    named = f"output = [{listed}]\n"
    assert operation_warnings(describe_machine(case_of(exchanged + named))) == []


@pytest.mark.parametrize(("at_speed", "warned"), [(62.0, False), (45.0, True)])
def test_a_line_of_torque_that_misses_the_torque_of_operation_is_told(at_speed: float, *, warned: bool) -> None:
    motor = {"speed": ["0 rpm", "3000 rpm", "3300 rpm"], "torque": ["90 N*m", "60 N*m", "0 N*m"]}
    load = {"speed": ["0 rpm", "3000 rpm"], "torque": ["0 N*m", f"{at_speed} N*m"]}
    told = operation_warnings(describe_machine(case_of(reducer(), motor=motor, load=load), None))
    assert [(entry["line"], entry["line_n_m"], entry["torque_n_m"]) for entry in told] == [
        ("load", pytest.approx(at_speed), 60.0)
    ] * warned
