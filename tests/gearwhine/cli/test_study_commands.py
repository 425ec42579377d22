"""Commands that are made of a study's methods: their options, what they hand on, and what they say of themselves."""

import inspect
from typing import Any

import pytest

from gearwhine.case_study import CaseStudy
from gearwhine.cli import run_command
from gearwhine.cli.study_commands import made_command, method_of
from gearwhine.commands import STUDY_COMMANDS, Command

CALLS: list[tuple[str, str, list[str], dict[str, Any]]] = [
    (
        "system",
        "system",
        ["--campbell", "--sidebands", "3", "--mesh-harmonics", "5", "--mesh-phase", "0.25"],
        {"campbell": True, "sidebands": 3, "mesh_harmonics": 5, "mesh_phase": 0.25},
    ),
    (
        "steady",
        "steady",
        ["--down", "--points", "7", "--exact", "--superpose"],
        {"down": True, "points": 7, "exact": True, "superpose": True},
    ),
    ("load", "operating_point", ["--over-torque", "--rigid-seats"], {"over_torque": True, "rigid_seats": True}),
    ("load", "operating_point", ["--line", "roof@1377"], {"line": "roof@1377"}),
    ("update", "update", ["--null", "5", "--held-back"], {"null": 5, "held_back": True}),
    ("survey", "survey", ["--sensors", "4", "--modes", "2"], {"sensors": 4, "modes": 2}),
    ("modes", "modes", ["--detail"], {"detail": True}),
    ("mesh", "mesh", ["--format", "vtu"], {"suffix": "vtu"}),
    ("run", "run_into", ["--no-pictures"], {"pictures": False}),
    (
        "render",
        "render",
        ["--view", "top", "--format", "gif", "--measured", "--line", "100", "--line", "200"],
        {"view": "top", "mode_format": "gif", "measured": True, "line": [100.0, 200.0]},
    ),
    ("sweep", "sweep", ["--over", "a=1,2", "--workers", "1"], {"over": ["a=1,2"], "workers": 1}),
    ("rotors", "rotors", ["--write-ross"], {"write_ross": True}),
]


class CalledError(Exception):
    """The method is called; nothing is solved."""


@pytest.mark.parametrize(("command", "method", "options", "expected"), CALLS)
def test_options_are_handed_on_to_the_method(
    command: str,
    method: str,
    options: list[str],
    expected: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Any,
) -> None:
    calls: list[dict[str, Any]] = []

    def called(_: CaseStudy, **given: Any) -> None:
        calls.append(given)
        raise CalledError

    monkeypatch.setattr(CaseStudy, method, called)
    with pytest.raises(CalledError):
        run_command([command, "spur-pair", "-q", "-o", str(tmp_path), *options])
    assert {key: calls[0][key] for key in expected} == expected


@pytest.mark.parametrize(("fresh", "options"), [(False, []), (True, ["--fresh"])])
def test_the_study_knows_the_folder_and_whether_to_begin_anew(
    fresh: bool, options: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    studies: list[CaseStudy] = []

    def called(study: CaseStudy, **_: Any) -> None:
        studies.append(study)
        raise CalledError

    monkeypatch.setattr(CaseStudy, "system", called)
    with pytest.raises(CalledError):
        run_command(["system", "spur-pair", "-q", "-o", str(tmp_path), *options])
    assert (studies[0].fresh, studies[0].folder) == (fresh, tmp_path)


@pytest.mark.parametrize("entry", STUDY_COMMANDS, ids=[entry.name for entry in STUDY_COMMANDS])
def test_every_parameter_of_a_method_is_an_option_with_a_text(entry: Command) -> None:
    options = inspect.signature(made_command(entry)).parameters
    parameters = inspect.signature(method_of(entry)).parameters
    named = {
        name
        for name, parameter in parameters.items()
        if name not in ("self", *entry.without) and parameter.kind is not inspect.Parameter.VAR_KEYWORD
    }
    assert named <= options.keys()
    for name in named:
        (marker,) = options[name].annotation.__metadata__
        assert marker.help, name


def test_pictures_may_be_left_out_where_there_are_any() -> None:
    options = {entry.name: inspect.signature(made_command(entry)).parameters for entry in STUDY_COMMANDS}
    assert options.keys() - {name for name in options if "pictures" in options[name]} == {
        "check",
        "mesh",
        "render",
        "update",
    }
    assert "no renderer" in options["load"]["pictures"].annotation.__metadata__[0].help


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--sidebands", "21"], "--sidebands"), (["--mesh-harmonics", "0"], "--mesh-harmonics")],
)
def test_a_number_out_of_its_range_is_refused_by_its_option(
    options: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(["system", "spur-pair", *options]) == 2
    assert said in capsys.readouterr().err
