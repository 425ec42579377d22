"""A housing of Python has the results of the same housing in a case: modes, comparison with a test, survey plan."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_housings import described_housing

import gearwhine as gw
from gearwhine.housing import HousingModes
from gearwhine.housing.measured import MeasuredModes
from gearwhine.housing.modal_test import ModalTest
from gearwhine.meshes import Bore, BoxGeometry, WallThickness
from gearwhine.solve.comparison import modal_test_of

MEASURED = {"frequencies": ["1.2 kHz", "2.1 kHz"], "pairing": "nearest"}
CLOCK = {"seconds", "warnings", "reused"}


@pytest.fixture(scope="module")
def case() -> gw.CaseStudy:
    coarse = {"housing.box.mesh_size": "45 mm", "transient": "", "measured": MEASURED}
    return gw.load("small-gearbox", coarse)


@pytest.fixture(scope="module")
def modes() -> HousingModes:
    box = BoxGeometry((0.2, 0.15, 0.18), WallThickness(*[0.02] * 6), (Bore("bore", (0.0, 0.075, 0.09), 0.05),))
    return gw.Housing.from_box(box, 0.06, gw.Material(207e9, 0.3, 7850.0)).modes(count=9)


def alike(found: gw.Result[Any], expected: gw.Result[Any]) -> None:
    one, other = (
        {key: value for key, value in result.document.items() if key not in CLOCK} for result in (found, expected)
    )
    assert one == other
    for name, array in found.dataset.variables.items():
        np.testing.assert_array_equal(array, expected.dataset.variables[name])


@pytest.mark.slow
def test_results_of_a_housing_are_those_of_its_case(case: gw.CaseStudy, tmp_path: Path) -> None:
    solved, table = case.housing, case.case.housing
    assert solved is not None
    assert table is not None
    described = described_housing(case.case, solved.mesh)
    modes = described.modes(below_hz=table.frequency_limit, bearings=solved.bearings)
    assert modes.warnings == solved.warnings
    assert [entry["name"] for entry in modes.result_warnings] == ["discretisation"]
    study = gw.HousingStudy(modes, case.case.title)
    assert set(modes.warnings) <= set(study.modes().warnings)
    assert study.modes().document["certificate"]["complete"]
    alike(study.modes(detail=True), case.modes(detail=True))
    assert case.case.measured is not None
    alike(study.compare(modal_test_of(case.case.measured)), case.compare())
    plan = study.survey(30, 5)
    alike(plan, case.survey(30, 5))
    assert {"survey.csv", "survey.uff"} <= set(plan.write(tmp_path))


@pytest.mark.slow
def test_the_housing_of_a_machine_has_the_results_of_that_of_the_case(case: gw.CaseStudy, tmp_path: Path) -> None:
    study = gw.Study(case.machine, case.settings)
    alike(study.modes(detail=True), case.modes(detail=True))
    assert case.case.measured is not None
    alike(study.compare(modal_test_of(case.case.measured)), case.compare())
    alike(study.survey(30, 5), case.survey(30, 5))
    for place, one in (("machine", study), ("case", case)):
        one.render("1", mode_format="glb").write(tmp_path / place)
    (drawn,) = (tmp_path / "machine").glob("mode-*.glb")
    assert drawn.read_bytes() == (tmp_path / "case" / drawn.name).read_bytes()
    study.modes().write(tmp_path / "machine", pictures=False)
    page = study.report(tmp_path / "machine").read_text(encoding="utf-8")
    assert 'id="modes-housing-mode-1"' in page
    assert study.export(tmp_path / "machine", ["csv"])
    without = gw.Study(case.on_rigid_seats())
    for verb in (without.modes, without.render, lambda: without.survey(3), lambda: without.compare([1e3])):
        with pytest.raises(gw.CouplingError, match=r"expected a machine whose housing is solved"):
            verb()


def test_a_test_that_does_not_fit_the_housing_is_refused(modes: HousingModes) -> None:
    study = gw.HousingStudy(modes)
    compared = study.compare(2.0 * np.pi * modes.frequencies_hz[6:8])
    assert [pair["mode"] for pair in compared.document["pairs"]] == [7, 8]
    assert [pair["error_percent"] for pair in compared.document["pairs"]] == pytest.approx([0.0, 0.0])
    with pytest.raises(gw.HousingError, match=r"housing: below_hz is .*; expected at least .* only below the limit"):
        study.compare([2.0 * np.pi * 2.0 * modes.trusted_limit_hz])
    with pytest.raises(gw.HousingError, match="2 sensors for 3 modes"):
        study.survey(2, 3)
    assert len(study.survey(modes=3).document["sensors"]) == 5  # three for two modes
    with pytest.raises(
        gw.HousingError, match=r"as gearwhine\.Housing\.modes\(\) gives, or of a ReducedHousing; got 'box'"
    ):
        gw.HousingStudy("box")  # type: ignore[arg-type]
    alone = MeasuredModes(np.array([1e3]))
    with pytest.raises(gw.HousingError, match="modal test: pairing is 'shapes'; expected another one of frequencies"):
        ModalTest(alone, pairing="shapes")
    with pytest.raises(gw.HousingError, match="align is 'walls'; expected 'surface', a mapping"):
        ModalTest(alone, align="walls")  # type: ignore[arg-type]
    with pytest.raises(gw.HousingError, match=r"modal test: modes is .*; expected MeasuredModes"):
        ModalTest([1e3])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ((0.01, 0.02), r"damping_ratio is \(0\.01, 0\.02\); expected a ratio for each of the \d modes found"),
        ((0.01, 1.5), "expected numbers, each a finite number"),
        ({}, "a ratio at one frequency at least"),
        ({-1.0: 0.01}, "frequencies of at least 0 Hz"),
    ],
)
def test_damping_ratios_of_modes_are_checked(modes: HousingModes, given: Any, words: str) -> None:
    with pytest.raises(gw.HousingError, match=words):
        replace(modes, housing=replace(modes.housing, damping_ratio=given))


def test_damping_is_by_mode_or_by_frequency(modes: HousingModes) -> None:
    """Linear between its frequencies, and the ends' beyond them; a list for the modes in order, with the rest told."""
    low, high = float(modes.frequencies_hz[0]), float(modes.frequencies_hz[-1])
    by_frequency = replace(modes, housing=replace(modes.housing, damping_ratio={high: 0.03, low: 0.01}))
    middle = (modes.frequencies_hz - low) / (high - low)
    assert by_frequency.damping_ratios == pytest.approx(0.01 + 0.02 * middle)
    ratios = [0.01 * (1 + number) for number in range(len(middle) + 1)]
    listed = replace(modes, housing=replace(modes.housing, damping_ratio=ratios))
    assert listed.damping_ratios.tolist() == ratios[:-1]
    assert "the others are not used" in listed.warnings[-1]
