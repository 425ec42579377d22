"""The case that an update writes: the prior of each parameter stays where it was, about the old number."""

import tomllib
from typing import Any

import numpy as np
import pytest

from gearwhine.case import Case, case_document, load_case, parse_case
from gearwhine.from_case.parametric_housing import ParametricHousing, fitted_case
from gearwhine.solve.updating import update_housing, updated_case

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
