"""The case that an update writes: the prior of each parameter stays where it was, about the old number."""

import tomllib
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.from_case.parametric_housing import ParametricHousing, fitted_case
from gearwhine.housing.updating.misfit import Misfit
from gearwhine.solve.updating import FoundNumber, update_housing, updated_case

NOISE, OWN, HIGHER = 0.005, 207e9, 1.05
FACTOR = {"name": "E", "keys": ["material.steel.youngs_modulus"], "range": [0.7, 1.3], "spread": 0.02, "factor": True}


def clamped_box(measured: list[float], **parameter: Any) -> Case:
    """The bundled steel box, coarser; all its frequencies go with the root of the modulus."""
    document = case_document(load_case("steel-box", ["housing.box.mesh_size=100 mm"]).case)
    document["measured"] = {"frequencies": measured}
    table = {"modes": 12, "solves": 4, "gap": 0.0, "frequency_noise": NOISE, "parameter": [FACTOR | parameter]}
    document["update"] = table
    return parse_case(document)


@pytest.fixture(scope="module")
def measured() -> list[float]:
    """Two dominant modes of a box that is 5 % higher in all its frequencies [Hz]."""
    designs = ParametricHousing(fitted_case(clamped_box([1.0])), 12, threads=1)
    state = designs.solve(designs.start).state
    strongest = state.dominance.strongest(2, (0.0, state.frequencies[7]))
    return (HIGHER * state.frequencies[strongest] / (2.0 * np.pi)).tolist()


def test_the_case_says_what_changed_and_why() -> None:
    """Written to the digits of its range's unit, the prior about the old number, each place with its provenance."""
    wall = {"name": "front", "keys": ["housing.box.wall.front"], "range": ["5 mm", "20 mm"]}
    case = clamped_box([500.0, 900.0])
    document = case_document(case)
    document["update"]["parameter"].append(wall | {"nominal": "9 mm", "spread": "2 mm"})
    fitted = fitted_case(parse_case(document))
    factor, thickness = fitted.numbers
    before, after = (
        Misfit(1.0, np.arange(len(errors)), np.log1p(errors), gap, 0.0, 0)
        for errors, gap in ((np.array([0.03, -0.04]), 0.5), (np.array([0.01, 0.0, -0.02]), 0.25))
    )
    found = (FoundNumber(factor, 1.2345678, 0.0123456, 0.5), FoundNumber(thickness, 0.01234567, 0.0005, 0.5))
    solved: Any = SimpleNamespace(fitted=fitted, misfit_before=before, misfit_after=after, found=found)
    text = updated_case(solved)
    start = 1e3 * thickness.start
    rms, of_old = (100.0 * np.sqrt(np.mean(np.square(one))) for one in ((0.01, 0.0, 0.02), (0.03, 0.04)))
    assert text.split("\n\n")[0].splitlines() == [
        "# Updated to 3 measured frequencies by 'gearwhine update'; errors:",
        f"#   before: rms {of_old:.2f} %, largest 4.00 %",
        f"#   after:  rms {rms:.2f} %, largest 2.00 %, paired by frequency alone",
        "# Each parameter before and after, with one standard deviation of what prior and measurement leave of it:",
        "#   E: 1 -> 1.2346, give or take 0.012346",
        f"#   front: {start:.5g} mm -> 12.346 mm, give or take 0.5 mm",
    ]
    updated = tomllib.loads(text)
    again = parse_case(updated)
    assert again.material["steel"].youngs_modulus == pytest.approx(1.2346 * OWN, rel=1e-9)
    assert updated["housing"]["box"]["wall"]["front"] == "12.346 mm"
    assert updated["provenance"] == {
        "material.steel.youngs_modulus": "found: by updating to the measured frequencies; "
        "1 before, 1.2346 give or take 0.012346 after",
        "housing.box.wall.front": "found: by updating to the measured frequencies; "
        f"{start:.5g} mm before, 12.346 mm give or take 0.5 mm after",
    }
    for old, new, value in zip(fitted.numbers, fitted_case(again).numbers, (1.2346, 1.0), strict=True):
        prior, now = old.parameter, new.parameter
        assert value * np.array([now.low, now.nominal, now.high, now.spread]) == pytest.approx(
            [prior.low, prior.nominal, prior.high, prior.spread], rel=1e-9
        )
    # How the modes were paired: by shapes, or by dominance.
    by_shape = replace(after, mac=np.array([0.97, 0.875, 0.99]))
    by_dominance = replace(after, choice_shortfall=cast(Any, SimpleNamespace()))
    for misfit, said in ((by_shape, "least MAC 0.88"), (by_dominance, "gap of dominance 0.25")):
        solved.misfit_after = misfit
        assert f"largest 2.00 %, {said}\n" in updated_case(solved)


@pytest.mark.slow
def test_a_second_update_ends_where_the_first_did(measured: list[float]) -> None:
    """The fit of f is that of a line: with ln ω = ½ ln f and s = ln(1 + spread), z = ln f / s is the mean of data and
    prior, weighted by n (s / 2 σ)² and 1. It stays where it is when the fitted case is updated again.
    """
    spread = np.log1p(0.02)
    weight = len(measured) * (0.5 * spread / NOISE) ** 2
    expected = HIGHER ** (2.0 * weight / (1.0 + weight))
    case = clamped_box(measured)
    for _ in range(2):
        solved = update_housing(case, threads=1)
        case = parse_case(tomllib.loads(updated_case(solved)))
        assert case.material["steel"].youngs_modulus / OWN == pytest.approx(expected, rel=5e-4)
        (number,) = fitted_case(case).numbers
        prior = number.parameter
        now = case.material["steel"].youngs_modulus
        assert now * np.array([prior.low, prior.nominal, prior.high]) == pytest.approx(OWN * np.array([0.7, 1.0, 1.3]))
        assert prior.spread / prior.nominal == pytest.approx(0.02)
        assert number.start == 1.0


@pytest.mark.slow
def test_a_factor_at_the_end_of_its_range_makes_a_valid_case(measured: list[float]) -> None:
    """The end 1.0312765 is written as 1.0313, beyond it: the range of the updated case contains the case's own 1."""
    case = clamped_box(measured, range=[0.7, 1.0312765], spread=0.5)
    updated = parse_case(tomllib.loads(updated_case(update_housing(case, threads=1))))
    (number,) = fitted_case(updated).numbers
    assert number.parameter.low < 1.0 <= number.parameter.high == pytest.approx(1.0, rel=1e-4)
