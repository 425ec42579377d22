"""An accuracy in place of a mesh size: refined until every mode's estimated error is within it, or refused."""

from pathlib import Path
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.solve.housing_modes import given_housing, solve_housing
from gearwhine.solve.mesh_refinement import RefinementStep, next_size

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
    assert not [entry for entry in solved.warnings if entry["name"] == "discretisation"]
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


def test_steps_follow_the_order_that_errors_show() -> None:
    """h (0.85 a / e)^(1/q): q = 2 at first, then as two steps have it; never less than 0.4, never more than 0.85."""
    first = RefinementStep(0.02, 10_000, 8, 0.02)
    assert next_size([first], 0.01) == pytest.approx(0.02 * (0.425) ** 0.5)
    second = RefinementStep(0.01, 60_000, 8, 0.014)
    order = 0.5145731728  # log2(0.02 / 0.014), below the least that is believed
    assert order < 0.7
    assert next_size([first, second], 0.01) == pytest.approx(0.01 * (0.85 / 1.4) ** (1 / 0.7))
    assert next_size([RefinementStep(0.02, 10_000, 8, 0.4)], 0.05) == pytest.approx(0.02 * 0.4)


def test_what_no_mesh_reaches_is_refused_with_what_was_reached() -> None:
    with pytest.raises(CaseError, match=r"such as '2\.2 %' of elements of 5 mm with 355914 degrees of freedom"):
        next_size([RefinementStep(0.013, 61_071, 12, 0.035), RefinementStep(0.005, 355_914, 12, 0.022)], 0.002)
    creeping = [RefinementStep(0.02 * 0.9**n, 1000, 8, 0.05) for n in range(8)]
    creeping[-2] = RefinementStep(0.02, 1000, 8, 0.06)
    with pytest.raises(CaseError, match="8 meshes do not come near"):
        next_size(creeping, 0.04)


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
