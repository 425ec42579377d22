"""An accuracy in place of a mesh size: refined until every mode's estimated error is within it, or refused."""

from pathlib import Path
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.from_case.given_housing import given_housing
from gearwhine.housing import HousingModes, mesh_refinement
from gearwhine.housing.mesh_refinement import refined_modes
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.meshes import BoxGeometry, WallThickness
from gearwhine.solve.housing_modes import solve_housing

CASE = """
[material.steel]
youngs_modulus = "207 GPa"
poisson_ratio = 0.3
density = "7850 kg/m^3"
[housing]
material = "steel"
modes = 8
{accuracy}
[housing.box]
size = ["120 mm", "100 mm", "80 mm"]
wall = "20 mm"
{size}
"""


def _case(folder: Path, accuracy: str = "", size: str = "") -> Any:
    path = folder / "case.toml"
    path.write_text(CASE.format(accuracy=accuracy, size=size), encoding="utf-8")
    return gw.load(path).case


def test_elements_get_smaller_until_the_accuracy_is_reached(tmp_path: Path) -> None:
    """A mesh of the size found has the same modes; the mode cache is that of the case as it stands."""
    case, lines = _case(tmp_path, 'accuracy = "9 %"'), list[str]()
    solved = solve_housing(case, lines.append)
    first, *_, last = solved.refinement
    assert first["largest_error"] > 0.09 >= last["largest_error"]
    assert first["mesh_size_m"] > last["mesh_size_m"]
    assert solved.modes.discretisation_errors is not None
    assert solved.modes.discretisation_errors.max() == last["largest_error"]
    assert [line for line in lines if "largest estimated error" in line][-1].endswith("9 % is wanted")
    assert not [entry for entry in solved.result_warnings if entry["name"] == "discretisation"]
    assert solved.record.key == content_key(given_housing(case).cache_inputs())
    fixed = solve_housing(_case(tmp_path, size=f"mesh_size = {last['mesh_size_m']!r}"))
    assert (fixed.modes.frequencies == solved.modes.frequencies).all()
    assert fixed.refinement == []


@pytest.mark.parametrize(
    ("accuracy", "size", "said"),
    [
        ("", "", "housing.box.mesh_size: expected a length above 0 m such as '6.35 mm', or an accuracy"),
        ('accuracy = "2 %"', 'mesh_size = "9 mm"', "housing.box.mesh_size: expected none beside an accuracy"),
        ('accuracy = "200 %"', "", "housing.accuracy: expected a plain number of at least 0.001 and at most 0.2"),
        ('accuracy = "2 mm"', "", "housing.accuracy: expected a plain number"),
    ],
)
def test_size_and_accuracy_are_given_one_of_the_two(tmp_path: Path, accuracy: str, size: str, said: str) -> None:
    with pytest.raises(CaseError) as refused:
        _case(tmp_path, accuracy, size)
    assert said in str(refused.value)


def test_a_housing_of_python_is_refined_as_that_of_a_case(tmp_path: Path) -> None:
    """The same box from the same first size; an accuracy that no mesh reaches is refused by the case's key."""
    expected = solve_housing(_case(tmp_path, 'accuracy = "9 %"'))
    box = BoxGeometry((0.12, 0.1, 0.08), WallThickness.uniform(0.02))
    steel = gw.Material(207e9, 0.3, 7850.0)

    def solve(size: float | None) -> HousingModes:
        assert size is not None
        return gw.Housing.from_box(box, size, steel).modes(count=8)

    found = refined_modes(solve, 0.09, expected.refinement[0]["mesh_size_m"])
    assert found.refinement == expected.refinement
    assert (found.frequencies_hz == expected.frequencies_hz).all()


def test_an_accuracy_that_no_mesh_reaches_is_refused_by_its_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mesh_refinement, "MOST_UNKNOWNS", 1.0)
    with pytest.raises(CaseError, match=r"housing\.accuracy: expected an accuracy within reach, .*'9 %'"):
        solve_housing(_case(tmp_path, 'accuracy = "9 %"'))


def test_an_update_takes_a_size(tmp_path: Path) -> None:
    parameter = {"name": "E", "keys": ["material.steel.youngs_modulus"], "range": ["180 GPa", "220 GPa"]}
    changes = {
        "housing.box.mesh_size": "",
        "housing.accuracy": "5 %",
        "measured": {"frequencies": ["1500 Hz"]},
        "update": {"modes": 8, "parameter": [parameter]},
    }
    with pytest.raises(CaseError, match="a mesh_size in its place"):
        gw.load("steel-box", changes).update()
