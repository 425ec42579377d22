"""A study hands on to the analyses what it is called with, and to a sweep what its case was made of."""

import math
import pickle
from collections.abc import Iterator
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.analyses import housing, machine
from gearwhine.analyses.result import Result
from gearwhine.case import Material, Rotor

CALLS: list[tuple[Any, str, str, dict[str, Any], dict[str, Any]]] = [
    (
        machine,
        "system",
        "system",
        {"campbell": True, "sidebands": 3, "mesh_harmonics": 5, "mesh_phase": 0.25},
        {"campbell": True, "sidebands": 3, "mesh_harmonics": 5, "mesh_phase": 0.25},
    ),
    (
        machine,
        "steady",
        "steady",
        {"curve": False, "down": True, "points": 7, "exact": True},
        {"curve": False, "down": True, "points": 7, "exact": True},
    ),
    (
        machine,
        "operating_point",
        "operating_point",
        {"over_torque": True, "sensitivity": True, "rigid_seats": True},
        {"over_torque": True, "sensitivity": True, "rigid_seats": True},
    ),
    (machine, "steady", "steady", {"curve": True}, {"curve": True, "down": False, "exact": False}),
    (housing, "update", "update", {"null": 5, "held_back": True}, {"null": 5, "held_back": True}),
    (housing, "survey", "survey", {"sensors": 4, "modes": 2}, {"sensors": 4, "modes": 2}),
    (housing, "modes", "modes", {"detail": True}, {"detail": True}),
    (housing, "mesh", "mesh", {"suffix": "vtu"}, {"suffix": "vtu"}),
    (
        housing,
        "render",
        "render",
        {"view": "top", "mode_format": "gif", "measured": True},
        {"view": "top", "mode_format": "gif", "measured": True},
    ),
]


@pytest.mark.parametrize(("module", "function", "method", "given", "expected"), CALLS)
def test_a_study_hands_on_what_it_is_called_with(
    monkeypatch: pytest.MonkeyPatch,
    module: Any,
    function: str,
    method: str,
    given: dict[str, Any],
    expected: dict[str, Any],
) -> None:
    calls: list[dict[str, Any]] = []
    monkeypatch.setattr(module, function, lambda case, *_, **named: calls.append(named))
    getattr(gw.load("spur-pair"), method)(**given)
    assert {key: calls[0][key] for key in expected} == expected


def test_the_points_of_a_sweep_are_made_of_the_case_with_its_changes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    calls: list[tuple[Any, ...]] = []
    monkeypatch.setattr(machine, "sweep", lambda *given, **_: calls.append(given))
    gw.load("spur-pair", {"operation.torque": "20 N*m"}).sweep(["operation.speed=1000 rpm"], folder=tmp_path)
    _, source, over, folder = calls[0]
    point = source.changed(["operation.speed=1000 rpm"]).case
    assert (point.operation.torque, point.operation.speed) == (20.0, pytest.approx(1000.0 * math.pi / 30.0))
    assert (over, folder) == (["operation.speed=1000 rpm"], tmp_path)


def test_truth_values_in_changes_are_those_of_the_file() -> None:
    changes = {"gear_pair.0.corner_contact": False, "gear.0.allow_undercut": True}
    case = gw.load("spur-pair", changes).case
    assert case.gear_pair[0].corner_contact is False
    assert case.gear[0].allow_undercut is True


def test_objects_of_the_case_keep_the_keys_that_python_cannot_spell() -> None:
    """`from` of a run up is a keyword of Python; the object's field has another name."""
    run = gw.load("small-gearbox", {"transient": {"run": {"from": "1500 rpm", "to": "4500 rpm", "time": "0.5 s"}}}).case
    assert run.transient is not None
    steel = Material(youngs_modulus=207e9, poisson_ratio=0.3, density=7850.0)
    rotor = Rotor.model_validate(
        {"name": "shaft", "material": "steel", "segments": [{"length": 0.5, "diameter": 0.03}]}
    )
    bearings = [
        {"name": name, "rotor": "shaft", "at": at, "seat": "ground", "stiffness": {"xx": 1e8, "yy": 1e8}}
        for name, at in (("left", 0.02), ("right", 0.48))
    ]
    study = gw.build(
        material={"steel": steel},
        rotor=[rotor],
        bearing=bearings,
        operation={"speed": gw.rpm(3000.0), "torque": 0.0},
        transient=run.transient,
    )
    assert [bearing.name for bearing in study.case.bearing] == ["left", "right"]
    assert study.case.transient is not None
    assert study.case.transient.run is not None
    assert study.case.transient.run.start == pytest.approx(gw.rpm(1500.0))


def draw(*names: str) -> Any:
    def figures(_: Any) -> Iterator[tuple[str, Any]]:
        yield from ((name, object()) for name in names)

    return figures


def test_a_figure_is_asked_for_by_its_whole_name() -> None:
    case = gw.load("spur-pair").case
    result: Result[None] = Result("system", case, None, {}, _figures=draw("modes-all", "modes"))
    drawn = dict(result.figures())
    assert set(drawn) == {"modes-all", "modes"}
    with pytest.raises(KeyError, match="no figure 'mode' of 'system'; there are: modes-all, modes"):
        result.plot("mode")


def test_proofs_are_named_by_their_path() -> None:
    case = gw.load("spur-pair").case
    document = {
        "housing": {"certificate": {"complete": True}, "modes": [{"residual": 1.0}]},
        "rotors": [{"residual": 1e-12}, {"residual": 2e-12}],
        "residual": 3e-12,
    }
    result: Result[None] = Result("run", case, None, document)
    assert result.proofs == {
        "housing.certificate": {"complete": True},
        "rotors[0].residual": 1e-12,
        "rotors[1].residual": 2e-12,
        "residual": 3e-12,
    }


@pytest.mark.slow
def test_a_result_comes_back_from_a_pickle_with_all_its_numbers() -> None:
    result = gw.load("friswell-rotor").rotors()
    again = pickle.loads(pickle.dumps(result))  # noqa: S301 - of its own
    assert again.document == result.document
    assert again.dataset.identical(result.dataset)
    assert again.case == result.case
    assert again.warnings == result.warnings
