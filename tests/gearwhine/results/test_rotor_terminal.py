"""What `gearwhine rotors` says, from documents built by hand: kinds, directions, margins, stability, proof."""

import io
import math
import re
from contextlib import redirect_stdout
from typing import Any

import pytest

from gearwhine.output.terminal import show
from gearwhine.results.rotors import sections

Document = dict[str, Any]


CROSSINGS = [
    {"speed_rpm": -600.0, "direction": -1.0, "axial_share": 0.0, "log_decrement": 0.25, "margin": -0.4},
    {"speed_rpm": -1080.0, "direction": 1.0, "axial_share": 0.0, "log_decrement": 1e-14, "margin": 0.08},
]
STATIC = {
    "bearings_at_rpm": None,
    "bearings": [{"name": "left", "load_n": [-0.0, -12.5, 0.0]}],
    "largest_deflection_m": 3.2e-5,
    "largest_deflection_at_m": 0.25,
}
ROLLING = {
    "name": "left",
    "load_n": [0.0, -1250.0, 40.0],
    "stiffness": [[1.5e8 if i == j == 1 else 2e7 * (i == j) for j in range(5)] for i in range(5)],
    "elements": 9,
    "loaded_elements": 4,
    "peak_pressure_pa": 1.4567e9,
}
PROBE = {
    "name": "disc",
    "at_m": 0.25,
    "angle_deg": 45.0,
    "largest_amplitude_m": 8e-5,
    "largest_at_rpm": 600.0,
    "operation_amplitude_m": 2e-5,
    "operation_phase_lag_deg": 170.2,
}


def rotor(**more: Any) -> Document:
    certificate = {"limit_hz": 500.0, "found": 4, "expected": 4}
    whirl = {
        "speed_rpm": 1000.0,
        "frequency_hz": [9.0, 11.0, 40.0],
        "direction": [-0.9, 1.0, 0.0],
        "axial_share": [0.0, 0.0, 0.2],
        "log_decrement": [0.25, -0.01, 1e-13],
        "damping_ratio": [0.04, -0.002, 1e-14],
        "most_strained": [
            {"part": "pedestal of left", "share": 0.45},
            {"part": "segment 1", "share": 0.6},
            None,
        ],
    }
    return {
        "name": "shaft [left]",
        "mass_kg": 2.0,
        "length_m": 0.5,
        "bearings": ["left"],
        "lateral_hz": [10.0, 10.0, 40.0, 45.0],
        "lateral_axial_share": [0.0, 0.0, 0.02, 0.4, 0.0, 0.0],
        "torsional_hz": [0.0, 30.0, 700.0],
        "axial_hz": [],
        "rest_bearings_at_rpm": None,
        "operation_rpm": 1000.0,
        "whirl": [whirl],
        "critical_speeds_rpm": [600.0, 900.0, 1080.0, 2500.0, 9000.0],
        "critical_directions": [1.0, 0.4, -1.0, 1.0, 1.0],
        "critical_axial_share": [0.0, 0.0, 0.0, 0.25, 0.0],
        "critical_margins": [-0.4, -0.1, 0.08, 1.5, 8.0],
        "campbell": None,
        "static": STATIC,
        "unbalance_response": None,
        "torsional_response": None,
        "stiffness_map": None,
        "rolling_bearings": [],
        "certificate": certificate,
    } | more


def campbell(**more: Any) -> Document:
    diagram = {"speed_rpm": [-1500.0, 0.0], "unstable_from_rpm": None, "why_no_critical_speeds": None, "orders": []}
    return diagram | {"critical_speeds": CROSSINGS} | more


def said(**more: Any) -> str:
    with redirect_stdout(io.StringIO()) as out:
        document = {"rotors": [rotor(**more)]}
        show(document, sections(document))
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
        ["45", "bending, one plane, 40 % along the axis"],
    ]
    assert ["20", "axial"] in rows(said(axial_hz=[20.0, 900.0]), "At rest")
    free = said(lateral_hz=[0.0, 0.0, 0.0, 0.0, 50.0, 50.0])
    assert rows(free, "At rest")[1] == ["0", "moves freely, both planes"]


def test_tables_say_which_of_their_speeds_is_taken() -> None:
    assert "At rest, with the bearings' coefficients at 200 rpm" in said(rest_bearings_at_rpm=200.0)
    assert "Under its weight, with the bearings' coefficients at 900 rpm" in said(
        static=STATIC | {"bearings_at_rpm": 900.0}
    )
    assert "coefficients" not in said()


def test_whirl_is_named_against_the_sense_of_rotation() -> None:
    expected = [["9", "backward", "0.25", "decays"], ["11", "forward", "-0.01", "GROWS"]]
    shown = [row[:4] for row in rows(said(), "Turning at 1000 rpm")]
    assert shown == [*expected, ["40", "in a plane, 20 % along the axis", "0", "undamped"]]
    (whirl,) = rotor()["whirl"]
    clockwise = rows(said(whirl=[whirl | {"speed_rpm": -1000.0}]), "Turning at -1000 rpm")
    assert [row[1] for row in clockwise] == ["forward", "backward", "in a plane, 20 % along the axis"]


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
        ["2500", "forward, 25 % along the axis", "2.5 times"],
    ]
    # 1080 rpm is nearer, but unbalance does no work on a circular backward whirl.
    assert "Of those that unbalance excites, 900 rpm is nearest: 10 % below operation" in out


@pytest.mark.parametrize(
    ("onset", "text"),
    [(None, "Stable at 2 speeds from 0 to 1500 rpm"), (1500.0, "UNSTABLE from 1500 rpm on, of 2 speeds")],
)
def test_stability_is_said_of_the_speeds_looked_at(onset: float | None, text: str) -> None:
    assert text in said(campbell=campbell(unstable_from_rpm=onset))
    assert "table" not in said().lower()


def test_a_campbell_diagram_has_damped_critical_speeds_named_against_the_sense_of_rotation() -> None:
    out = said(campbell=campbell())
    assert rows(out, "Critical speeds from 0 to 1500 rpm") == [
        ["600", "forward", "0.25", "40 % below"],
        ["1080", "backward", "0", "8 % above"],
    ]
    assert "Of those that unbalance excites, 600 rpm is nearest: 40 % below operation" in out
    none = said(campbell=campbell(critical_speeds=[]))
    assert "No critical speed from 0 to 1500 rpm; undamped, the lowest is 600 rpm, forward" in none
    unknown = said(campbell=campbell(critical_speeds=None, why_no_critical_speeds="too few speeds"))
    assert rows(unknown, "Undamped critical speeds")[0] == ["600", "forward", "40 % below"]
    assert "No damped critical speeds: too few speeds" in unknown


def test_bearings_carry_the_weight_or_it_is_said_why_not() -> None:
    out = said()
    assert rows(out, "Under its weight") == [["left", "0", "-12.5"]]
    assert "It sags most at 250 mm, by 32 µm" in out
    assert "No static deflection: it floats" in said(static={"bearings": None, "why_not": "it floats"})


def test_rolling_bearings_tell_how_stiff_and_how_hard_pressed_they_are() -> None:
    told = rows(said(rolling_bearings=[ROLLING]), "Rolling bearings under their loads")
    assert told == [["left", "0, -1250, 40", "4 of 9", "1.46", "2e+07, 1.5e+08, 2e+07"]]
    assert "Rolling bearings" not in said()


def test_a_stiffness_map_is_shown_from_end_to_end() -> None:
    stiffnesses = [1e6, 2e6, 4e6, 8e6, 1.6e7, 3.2e7, 6.4e7, 1.28e8, 2.56e8]
    speeds = [[100.0 + place, 500.0, math.nan] for place in range(9)]
    out = said(stiffness_map={"stiffness_n_per_m": stiffnesses, "forward_critical_speeds_rpm": speeds})
    table = rows(out, "Over the stiffness of all bearings")
    assert [row[0] for row in table] == ["1e+06", "4e+06", "1.6e+07", "6.4e+07", "2.56e+08"]
    assert table[2][1] == "104  500"


def test_each_probe_has_its_reading_at_operation_and_its_largest() -> None:
    out = said(unbalance_response={"probes": [PROBE]})
    assert rows(out, "Response to") == [["disc, 250 mm, 45°", "20", "170°", "80 at 600 rpm"]]
    # A lag of 359.7° is none.
    in_phase = PROBE | {"operation_phase_lag_deg": 359.7}
    assert rows(said(unbalance_response={"probes": [in_phase]}), "Response to")[0][2] == "0°"
    at_rest = PROBE | {"operation_amplitude_m": None, "operation_phase_lag_deg": None}
    assert rows(said(unbalance_response={"probes": [at_rest]}), "Response to") == [
        ["disc, 250 mm, 45°", "80 at 600 rpm"]
    ]


def test_whirl_says_where_it_strains_most() -> None:
    lines = said().splitlines()
    assert any("decays" in line and "45 % pedestal of left" in line for line in lines)
    assert any("GROWS" in line and "60 % segment 1" in line for line in lines)
    assert any(line.rstrip().endswith("undamped") for line in lines)


def test_other_orders_are_listed_with_their_speeds_or_with_what_hinders_them() -> None:
    orders = [
        {"order": 2.0, "critical_speeds": CROSSINGS, "why_no_critical_speeds": None},
        {"order": 0.5, "critical_speeds": None, "why_no_critical_speeds": "does not settle"},
    ]
    text = said(campbell=campbell(critical_speeds=CROSSINGS, orders=orders))
    table = text[text.index("Other orders") :]
    assert re.search(r"2×\s+600\s+forward", table)
    assert re.search(r"2×\s+1080\s+backward", table)
    assert re.search(r"0.5×\s+does not settle", table)
    none = [{"order": 2.0, "critical_speeds": [], "why_no_critical_speeds": None}]
    assert "None of the other orders" in said(campbell=campbell(critical_speeds=[], orders=none))


def test_torsional_response_shows_its_largest() -> None:
    probe = {
        "name": "fan",
        "at_m": 0.1,
        "largest_angle_rad": 2e-3,
        "largest_angle_at_hz": 44.0,
        "largest_torque_n_m": 120.0,
        "largest_torque_at_hz": 45.0,
    }
    end = probe | {"name": "end", "largest_torque_n_m": 1e-13}
    response = {
        "from_hz": 1.0,
        "to_hz": 50.0,
        "probes": [probe, end],
        "largest_torque_n_m": 150.0,
        "largest_torque_at_m": 0.2,
        "largest_torque_at_hz": 45.0,
    }
    text = said(torsional_response=response)
    assert re.search(r"fan, 100 mm\s+2 at 44 Hz\s+120 at 45 Hz", text)
    assert re.search(r"end, 100 mm\s+2 at 44 Hz\s+0\s", text)
    assert "carries most at 200 mm: 150 N·m at 45 Hz" in text


def test_the_proof_is_told() -> None:
    assert "complete below 500 Hz: 4 found, 4 counted" in said()


def test_a_mode_that_moves_along_the_axis_for_the_most_part_is_called_axial() -> None:
    table = dict(rows(said(lateral_hz=[10.0, 40.0, 45.0], lateral_axial_share=[0.0, 0.8, 0.4]), "At rest"))
    assert table["40"] == "axial, 80 % along the axis"
    assert table["45"] == "bending, one plane, 40 % along the axis"
