"""`gears` without parts of its analysis: what stays is as in the whole one, and what is left out is not solved."""

from pathlib import Path
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.cli import run_command
from gearwhine.coupling import CouplingError
from gearwhine.coupling.gears.loaded.optimal_relief import PeakToPeak
from gearwhine.results.gears import sections
from gearwhine.solve import gear_pairs

pytestmark = pytest.mark.usefixtures("few_reliefs_tried")

RELIEVED = "gear.pinion.tip_relief={amount='10 um', length='2 mm'}"


def pair_of(study: gw.Study, *without: Any) -> dict[str, Any]:
    document = study.gears(without=without).document
    list(sections(document))  # the terminal shows what there is
    (pair,) = document["pairs"]
    return dict(pair)


def test_each_part_can_be_left_out_and_the_others_stay() -> None:
    said: list[str] = []
    study = gw.load("spur-pair", [RELIEVED])
    study.progress = lambda message, fraction=None: said.append(message)
    whole = pair_of(study)
    assert {"Harris map of pinion → wheel", "best tip relief of pinion → wheel"} <= set(said)

    said.clear()
    unsought = pair_of(study, "relief")
    assert unsought.pop("optimal_tip_relief") is None
    assert unsought == {key: value for key, value in whole.items() if key != "optimal_tip_relief"}
    assert not any("relief" in message for message in said)

    said.clear()
    unmapped = pair_of(study, "harris-map")
    assert not any("Harris" in message for message in said)
    assert unmapped.pop("harris_map") is None
    best, as_in_whole = unmapped.pop("optimal_tip_relief"), dict(whole["optimal_tip_relief"])
    # Without the map the given flanks are solved at other phases of the mesh period.
    assert best.pop("peak_to_peak_as_given_m") == pytest.approx(as_in_whole.pop("peak_to_peak_as_given_m"), rel=1e-2)
    assert best == as_in_whole
    assert unmapped == {key: value for key, value in whole.items() if key not in ("harris_map", "optimal_tip_relief")}


def test_a_machine_of_python_has_the_same_options() -> None:
    machine = gw.Study(gw.load("spur-pair").machine)
    pair = pair_of(machine, "relief", "harris-map")
    assert pair["harris_map"] is None
    assert pair["optimal_tip_relief"] is None


@pytest.mark.parametrize("made", ["case", "machine"])
def test_what_cannot_be_left_out_is_refused(made: str) -> None:
    case = gw.load("spur-pair")
    study: gw.Study = case if made == "case" else gw.Study(case.machine)
    with pytest.raises(CouplingError, match=r"without 'maps'; expected any of 'harris-map', 'relief'"):
        study.gears(without=("maps",))  # type: ignore[arg-type]
    with pytest.raises(CouplingError, match="got both"):
        study.gears([PeakToPeak()], without=("relief",))


def test_no_housing_is_solved_for_the_aim_of_a_relief_that_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("the housing is solved")

    study = gw.load("small-gearbox", ["gear_pair.0.relief_aim={sensor='top'}"])
    monkeypatch.setattr(gear_pairs, "solve_housing", refuse)
    monkeypatch.setattr("gearwhine.solve.housing_modes.solve_housing", refuse)
    monkeypatch.setattr(type(study), "solved_housing", refuse)
    with pytest.raises(AssertionError, match="the housing is solved"):
        study.gears()
    assert study.gears(without=("relief",)).document["pairs"][0]["optimal_tip_relief"] is None


def test_kept_modes_serve_the_aims_of_reliefs_that_are_sought(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pair of a given misalignment needs the housing for nothing else."""
    kept, given = object(), list[Any]()

    def pairs_in(_case: Any, housing: Any, *_: Any) -> None:
        given.append(housing)
        raise RuntimeError("the pairs are solved")

    monkeypatch.setattr("gearwhine.solve.housing_modes.kept_housing", lambda *_: kept)
    monkeypatch.setattr("gearwhine.solve.machine.solve_pairs", pairs_in)
    for aims, without in (([], ()), ([], ("relief",)), ([PeakToPeak()], ())):
        with pytest.raises(RuntimeError, match="the pairs are solved"):
            gw.load("small-gearbox", ["gear_pair.0.misalignment=10 urad"]).gears(aims, without=without)  # type: ignore[arg-type]
    assert given == [kept, None, None]


def test_the_command_writes_no_pictures_where_they_are_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = ("gears", "spur-pair", "-q", "--without", "relief", "--without", "harris-map")
    assert run_command([*few, "-o", str(tmp_path / "drawn")]) == 0
    assert run_command([*few, "--no-pictures", "-o", str(tmp_path / "plain")]) == 0
    assert "relief: " not in capsys.readouterr().out
    assert list((tmp_path / "drawn").glob("gears-*.png"))
    assert not list((tmp_path / "plain").glob("*.png"))
    assert (tmp_path / "plain" / "results.nc").exists()


def test_the_command_refuses_other_parts(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["gears", "spur-pair", "--without", "maps"]) == 2
    assert "harris-map" in capsys.readouterr().err
