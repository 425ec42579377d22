"""The screen, from documents built by hand: units in brackets, counts, shares and what is left out."""

import io
import math
from collections.abc import Callable, Iterable
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

import pytest
from rich.console import Console

from gearwhine.output.sections import Column, Section, Table, rms_of_band, significant
from gearwhine.output.terminal import say_warning, show_section, shown_by
from gearwhine.results import comparison, housing, run, system

Document = dict[str, Any]


def _said(sections: Callable[[Document], Iterable[Section]], document: Document, *, timed: bool = False) -> str:
    with redirect_stdout(io.StringIO()) as out:
        shown_by(sections, timed=timed)(document)
    return out.getvalue()


def _run(loss: float = 0.0) -> Document:
    pair = {"driver": "a", "driven": "b", "mean_force_n": 100.0, "peak_force_n": 150.0, "contact_loss_fraction": loss}
    sensor = {"name": "top", "rms_m_per_s2": 1.5, "peaks": [{"frequency_hz": 100.0, "amplitude_m_per_s2": 2.0}]}
    housing = {
        "certificate": {"found": 1, "expected": 1, "limit_hz": 900.0, "max_residual": 1e-12},
        "mesh": {"dofs": 300},
        "mass_kg": 4.0,
        "seconds": {"total": 0.5},
    }
    return {
        "title": "case [bold] :warning: [/nothing]",
        "housing": housing,
        "gear_pairs": [pair],
        "sensors": [sensor],
        "seconds": {"total": 1.0},
    }


def _system(**more: Any) -> Document:
    none = dict.fromkeys(("housing", "axial", "pedestal", "residual"), 0.0)
    shares = none | {"rotor": -1e-9, "torsion": 1.0, "mesh": -1e-3}
    modes = [
        {"frequency_hz": frequency, "damping_ratio": damping, "kind": kind, "energy": shares}
        for frequency, damping, kind in ((-0.0, -0.0, "rigid"), (900.0, -1e-9, "torsion"), (2500.0, 0.01, "torsion"))
    ]
    return {"coordinates": 3, "speed_rpm": 1000.0, "modes": modes} | more


def _comparison(gap: float | None) -> Document:
    pair = {"mode": 1, "measured_hz": 100.0, "model_hz": 101.0, "error_percent": 1.0, "strength": 0.01}
    errors = {"rms_error_percent": 1.0, "max_error_percent": 1.0}
    counted = {"model_modes": {"count": 1, "below_hz": 900.0}}
    return (
        {"pairs": [pair], "pairing": "order", "pairing_rule": "order", "gap": gap, "measures_agree": True}
        | errors
        | counted
    )


def test_brackets_are_printed_as_they_stand() -> None:
    told = _said(run.sections, _run(), timed=True)
    assert "rms [m/s²]" in told
    assert "s → p" in _said(lambda _: (Section("", ("s -> p",)),), {})
    assert (significant(2824.0), significant(0.01234)) == ("2820", "0.0123")
    assert rms_of_band([900.0, 800.0]) == "rms"
    assert "rms 0–1500 Hz [m/s²]" in _said(run.sections, _run() | {"trusted_below_hz": 1500.0})
    assert "case [bold] :warning: [/nothing]" in told
    assert "measured [Hz]" in _said(comparison.sections, _comparison(0.5))


@pytest.mark.parametrize(
    ("loss", "said"),
    [(0.0, "0 %"), (0.003, "0.3 %"), (0.5, "50 %"), (1.0, "100 %"), (1e-6, "less than 0.01 %")],
)
def test_the_time_apart_is_a_plain_percentage(loss: float, said: str) -> None:
    assert f"apart {said} of the time" in _said(run.sections, _run(loss))


def test_one_mode_is_no_modes() -> None:
    assert "Housing: 1 mode below 900 Hz" in _said(run.sections, _run())
    assert "1 model mode below 900 Hz" in _said(comparison.sections, _comparison(0.5))


def test_no_share_is_minus_nothing_and_rigid_modes_have_none() -> None:
    out = _said(system.sections, _system())
    assert "-0" not in out
    rows = [line for line in out.splitlines() if "rigid" in line or "torsion" in line][1:]  # the first is the head
    assert rows[0].split() == ["0.00", "0.0000", "rigid"]
    assert rows[1].split() == ["900.00", "0.0000", "torsion", "0", "%", "0", "%", "100", "%", "0", "%", "0", "%"]
    assert len(rows) == 3
    assert "above" not in out


def test_motion_along_the_axis_and_of_pedestals_is_shown_where_there_is_any() -> None:
    thrust = _system()
    thrust["modes"][1]["energy"] = thrust["modes"][1]["energy"] | {"torsion": 0.25, "axial": 0.75}
    out = _said(system.sections, thrust)
    assert "axial" in out
    assert "75 %" in out
    assert "pedestal" not in out
    assert "axial" not in _said(system.sections, _system())


def test_modes_far_above_the_housing_limit_are_counted_only() -> None:
    out = _said(system.sections, _system(trusted_below_hz=1000.0))
    assert "2500.00" not in out
    assert out.rstrip().endswith("1 more mode above 2000 Hz.")
    assert "above" not in _said(system.sections, _system(trusted_below_hz=1250.0))
    assert "2500.00" in _said(system.sections, _system(trusted_below_hz=None))


@pytest.mark.parametrize("gap", [None, math.inf])
def test_a_gap_to_nothing_is_said_in_words(gap: float | None) -> None:
    out = _said(comparison.sections, _comparison(gap))
    assert "no other mode in the band" in out
    assert "coin toss" not in out
    assert "ln 0.050 (below 0.1 the choice is a coin toss)" in _said(comparison.sections, _comparison(0.05))


def _modes(*, ok: bool = True, strength: float | None = None) -> Document:
    names = ["x", "y", "rotation_x"]
    lines = [
        {"name": "mass", "value": 1e-15, "bound": 1e-6, "ok": True, "why": "alike"},
        {"name": "grounding", "value": 0.0 if ok else 2.0, "bound": 0.0, "ok": ok, "why": "what holds it"},
        {"name": "static error", "value": 0.4, "bound": None, "ok": True, "why": "for information"},
    ]
    # As a mode file gives them back: the keys of a table in the order of the alphabet.
    shares = dict(sorted(zip(names, (0.1, 0.2, 0.3), strict=True)))
    parts = {key: [0.9, 0.8, 0.7] for key in ("captured", "missing")} | {"held_by_supports": [0.0, 0.0, 0.0]}
    mode = {
        "number": 1,
        "frequency_hz": 100.0,
        "damping_ratio": 0.01,
        "strength": strength,
        "effective_mass": [0.5] * 3,
    }
    return _run()["housing"] | {
        "modes": [mode],
        "health": {"lines": lines, "supports": [{"name": "foot", "fixes": 3, "share": shares}]},
        "static_error": None,
        "effective_mass": {"directions": names} | parts,
        "selection": None,
        "folder": "out",
        "files": ["modes.nc"],
    }


def test_a_sound_model_is_told_in_a_line_and_what_is_not_is_shown() -> None:
    sound, doubtful = _said(housing.sections, _modes()), _said(housing.sections, _modes(ok=False))
    assert "2 of 2 checks keep their bounds" in sound
    assert "what it says" not in sound
    assert "what holds it" in doubtful
    assert "alike" not in doubtful
    assert "1 of 2 checks keep their bounds" in doubtful
    (section,) = housing.sections(_modes(ok=False))
    (checks,) = [one for one in section.tables if any("grounding" in row.values() for row in one.rows)]
    assert [column.heading for column in checks.columns] == ["check", "value", "bound", "", "what it says"]


def test_detail_shows_every_check_and_ends_with_the_files() -> None:
    said = _said(housing.detailed_sections, _modes())
    for text in ("alike", "what holds it", "for information"):
        assert text in said
    assert said.rstrip().endswith("Written to out: modes.nc")
    assert "fixed patches" not in said  # there are none


def test_shares_stand_under_their_own_directions_whatever_the_order_of_the_document() -> None:
    lines = _said(housing.detailed_sections, _modes()).splitlines()
    (head,) = [line.split() for line in lines if "fixes" in line]
    (foot,) = [line.split() for line in lines if line.split()[:1] == ["foot"]]
    assert head == ["support", "fixes", "x", "y", "rot", "x"]
    assert foot == ["foot", "3", "of", "6", "10.0", "%", "20.0", "%", "30.0", "%"]


def test_strength_has_a_column_only_where_there_are_seats() -> None:
    assert "strength" not in _said(housing.sections, _modes())
    assert "1.000e-02" in _said(housing.sections, _modes(strength=0.01))


def test_rows_of_a_table_too_wide_for_the_terminal_become_columns() -> None:
    columns = tuple(Column(f"quantity {number} [mm]", f"q{number}", ".3f") for number in range(8))
    named = (Column("gear", "name"), *columns)
    rows = tuple({"name": name} | {f"q{number}": number + 0.125 for number in range(8)} for name in ("pinion", "wheel"))
    section = Section("", (Table(named, rows),))

    def drawn(width: int) -> list[str]:
        console = Console(file=io.StringIO(), force_terminal=True, width=width, color_system=None, markup=False)
        show_section(console, section)
        assert isinstance(console.file, io.StringIO)
        return console.file.getvalue().splitlines()

    # A file has whole words, however many columns they take; a terminal its own width.
    many = Table(tuple(Column(f"displacement {number}", "name") for number in range(12)), rows)
    lines = _said(lambda _: (Section("", (many,)),), {}).splitlines()
    assert (lines[0].split().count("displacement"), lines[3].split()) == (12, 12 * ["pinion"])
    wide, wrapped, narrow = drawn(200), drawn(80), drawn(60)
    assert sum("quantity 0 [mm]" in line and "quantity 7 [mm]" in line for line in wide) == 1
    assert [line.split() for line in wrapped if "pinion" in line] == [["pinion", *(f"{one}.125" for one in range(8))]]
    assert wrapped[0].split() == 8 * ["quantity"]
    assert not any("…" in line or len(line.rstrip()) > width for width in (60, 80) for line in drawn(width))
    assert narrow[0].split() == ["gear", "pinion", "wheel"]
    assert [line.split() for line in narrow if "quantity 7" in line] == [["quantity", "7", "[mm]", "7.125", "7.125"]]


@pytest.mark.parametrize("width", range(24, 120, 5))
def test_a_figure_stands_beside_its_unit_at_every_width(width: int) -> None:
    parts = "housing mode 5: 136 %, local compliance: -22 %, 12.5 m/s² at 0.5 mm, 3 N·m by 4 gears"
    columns = (Column("line", "name"), Column("mostly by", "parts"), Column("level [dB]", "level", "d"))
    rows = ({"name": "1× pinion → wheel", "parts": parts, "level": 136},)
    console = Console(file=io.StringIO(), force_terminal=True, width=width, color_system=None, markup=False)
    show_section(console, Section("", (parts, Table(columns, rows))))
    assert isinstance(console.file, io.StringIO)
    lines = console.file.getvalue().splitlines()
    assert max(map(len, map(str.rstrip, lines))) <= width
    for words in ("136 %", "-22 %", "12.5 m/s²", "0.5 mm", "3 N·m"):
        assert sum(line.count(words) for line in lines) == 2, words


def test_a_command_to_copy_has_no_line_end_inside_its_values() -> None:
    values = "'operation.speed=" + ",".join(f"{speed} rpm" for speed in range(600, 2000, 100)) + "'"
    console = Console(file=io.StringIO(), force_terminal=True, width=40, color_system=None, markup=False)
    show_section(console, Section("", (f"Add these: gearwhine sweep CASE --over {values}",)))
    assert isinstance(console.file, io.StringIO)
    assert values in console.file.getvalue().splitlines()


def test_a_warning_is_wrapped_at_the_width_of_a_terminal_between_words(monkeypatch: pytest.MonkeyPatch) -> None:
    message = "the flanks are -14 µm out of line over the face: stiffer shafts even it out"
    for is_terminal, lines in (("1", ["warning: the flanks are", "         -14 µm out of line"]), ("", None)):
        monkeypatch.setenv("FORCE_COLOR", is_terminal)
        monkeypatch.setenv("COLUMNS", "28")
        with redirect_stderr(io.StringIO()) as said:
            say_warning(message)
        told = said.getvalue().splitlines()
        assert told[:2] == lines if lines else told == [f"warning: {message}"]
        assert "".join(told).replace(" ", "") == f"warning:{message}".replace(" ", "")
