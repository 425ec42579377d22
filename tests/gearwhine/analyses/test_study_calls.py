"""A study of a case: what it is made of and changed by, and the result that its analyses return."""

import math
import pickle
import re
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.analyses import sweep_result
from gearwhine.analyses.result import Result
from gearwhine.case import Material, Rotor
from gearwhine.housing import Housing
from gearwhine.rotors import RotorError
from gearwhine.rotors.analyses.solved_rotor import RotorSettings


def test_the_points_of_a_sweep_are_made_of_the_case_with_its_changes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    calls: list[tuple[Any, ...]] = []
    monkeypatch.setattr(sweep_result, "solve_sweep", lambda *given, **_: calls.append(given))
    gw.load("spur-pair", {"operation.torque": "20 N*m"}).sweep(["operation.speed=1000 rpm"], folder=tmp_path)
    _, source, keys, folder = calls[0]
    point = source.changed(["operation.speed=1000 rpm"]).case
    assert (point.operation.torque, point.operation.speed) == (20.0, pytest.approx(1000.0 * math.pi / 30.0))
    assert ([key.key for key in keys], folder.path) == (["operation.speed"], tmp_path)


def test_a_run_seeks_no_modes_where_a_rotor_cannot_be_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rotors are solved while the housing is meshed; the modes of a large housing take minutes."""
    study = gw.load("small-gearbox", {"housing.box.mesh_size": "60 mm"})

    def fail() -> None:
        raise RotorError("no such rotor")

    monkeypatch.setattr(study, "solved_rotors", fail)
    monkeypatch.setattr(Housing, "modes", lambda *_, **__: pytest.fail("modes are sought"))
    with pytest.raises(RotorError, match="no such rotor"):
        study.run()


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


def test_help_names_every_setting_that_a_verb_takes_by_name() -> None:
    study = gw.Study
    kinds = {study.rotors: RotorSettings, study.simulate: gw.TransientPlan, study.sound: gw.Acoustics}
    for verb, kind in kinds.items():
        words = set(re.findall(r"\w+", str(verb.__doc__)))
        assert {one.name for one in fields(kind)} - words == set()
