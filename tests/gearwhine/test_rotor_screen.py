"""What `gearwhine rotors` says, from documents built by hand: kinds, directions, margins, stability, proof."""

import io
from contextlib import redirect_stdout
from typing import Any

import pytest

from gearwhine import screen

Document = dict[str, Any]


def rotor(**more: Any) -> Document:
    certificate = {"limit_hz": 500.0, "found": 4, "expected": 4}
    whirl = {
        "speed_rpm": 1000.0,
        "frequency_hz": [9.0, 11.0, 40.0],
        "direction": [-0.9, 1.0, 0.0],
        "log_decrement": [0.25, -0.01, 1e-13],
        "damping_ratio": [0.04, -0.002, 1e-14],
    }
    return {
        "name": "shaft [left]",
        "mass_kg": 2.0,
        "length_m": 0.5,
        "lateral_hz": [10.0, 10.0, 40.0, 45.0],
        "torsional_hz": [0.0, 30.0, 700.0],
        "rest_bearings_at_rpm": None,
        "critical_bearings_at_rpm": None,
        "operation_rpm": 1000.0,
        "whirl": [whirl],
        "critical_speeds_rpm": [600.0, 900.0, 1080.0, 2500.0, 9000.0],
        "critical_directions": [1.0, 0.4, -1.0, 1.0, 1.0],
        "critical_margins": [-0.4, -0.1, 0.08, 1.5, 8.0],
        "campbell": {"speed_rpm": [0.0, -1500.0], "unstable_from_rpm": None},
        "critical_map": None,
        "unbalance_response": None,
        "static": None,
        "unheld": None,
        "certificate": certificate,
    } | more


def said(**more: Any) -> str:
    with redirect_stdout(io.StringIO()) as out:
        screen.show_rotors({"rotors": [rotor(**more)]})
    return out.getvalue()


def rows(text: str, title: str) -> list[list[str]]:
    """The cells of the table that follows a title, without its head."""
    lines = text.splitlines()
    start = next(number for number, line in enumerate(lines) if line.strip().startswith(title))
    cells = []
    for line in lines[start + 3 :]:
        if not line.strip():
            return cells
        cells.append([cell.strip() for cell in line.split("   ") if cell.strip()])
    return cells


def test_brackets_are_printed_as_they_stand() -> None:
    for text in ("shaft [left]", "frequency [Hz]", "speed [rpm]", "2 kg, 500 mm long"):
        assert text in said()


def test_frequencies_at_rest_stand_in_order_with_their_kind_as_far_as_both_kinds_are_known() -> None:
    """Torsion at 700 Hz is left out: bending is listed up to 45 Hz only, and more may lie between."""
    assert rows(said(), "At rest") == [
        ["0", "turns freely"],
        ["10", "bending, both planes"],
        ["30", "torsion"],
        ["40", "bending, one plane"],
        ["45", "bending, one plane"],
    ]
    free = said(lateral_hz=[0.0, 0.0, 0.0, 0.0, 50.0, 50.0])
    assert rows(free, "At rest")[1] == ["0", "moves freely, both planes"]


def test_tables_say_which_of_their_speeds_is_taken() -> None:
    assert "At rest, with the bearings' coefficients at 200 rpm" in said(rest_bearings_at_rpm=200.0)
    critical = "Undamped critical speeds, with the bearings' coefficients at 900 rpm"
    assert critical in said(critical_bearings_at_rpm=900.0)
    assert critical in said(critical_bearings_at_rpm=900.0, critical_margins=None)
    assert "coefficients" not in said()


def test_whirl_is_named_against_the_sense_of_rotation() -> None:
    expected = [["9", "backward", "0.25", "decays"], ["11", "forward", "-0.01", "GROWS"]]
    assert rows(said(), "Turning at 1000 rpm") == [*expected, ["40", "in a plane", "0", "undamped"]]
    (whirl,) = rotor()["whirl"]
    clockwise = rows(said(whirl=[whirl | {"speed_rpm": -1000.0}]), "Turning at -1000 rpm")
    assert [row[1] for row in clockwise] == ["forward", "backward", "in a plane"]


def test_without_operation_the_last_speed_of_the_sweep_is_shown() -> None:
    (whirl,) = rotor()["whirl"]
    swept = [whirl | {"speed_rpm": speed} for speed in (100.0, 200.0)]
    out = said(whirl=swept, operation_rpm=None, critical_margins=None)
    assert "Turning at 200 rpm" in out
    assert "Turning at 100 rpm" not in out
    assert rows(out, "Undamped critical speeds")[1] == ["900", "forward"]
    assert "operation" not in out
    assert "Turning" not in said(whirl=[], operation_rpm=None, critical_margins=None)


def test_critical_speeds_up_to_twice_operation_and_the_next_have_their_margin() -> None:
    out = said()
    assert rows(out, "Undamped critical speeds") == [
        ["600", "forward", "40 % below"],
        ["900", "forward", "10 % below"],
        ["1080", "backward", "8 % above"],
        ["2500", "forward", "2.5 times"],
    ]
    # 1080 rpm is nearer, but unbalance does no work on a circular backward whirl.
    assert "Of those that unbalance excites, 900 rpm is nearest: 10 % below operation" in out


@pytest.mark.parametrize(
    ("onset", "text"),
    [(None, "Stable at 2 speeds from 0 to 1500 rpm"), (1500.0, "UNSTABLE from 1500 rpm on, of 2 speeds")],
)
def test_stability_is_said_of_the_speeds_looked_at(onset: float | None, text: str) -> None:
    assert text in said(campbell={"speed_rpm": [0.0, -1500.0], "unstable_from_rpm": onset})
    assert "table" not in said(campbell=None).lower()


def test_the_proof_is_told_or_said_to_be_missing() -> None:
    assert "complete below 500 Hz: 4 found, 4 counted" in said()
    uncounted = {"limit_hz": None, "found": 4, "expected": None}
    assert "No count: the bearings' stiffness couples the planes" in said(certificate=uncounted)
