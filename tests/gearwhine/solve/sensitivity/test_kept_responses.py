"""A results folder keeps the responses by which a ranking extends the housing's modes: the next one factors nothing."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearwhine as gw
from gearwhine.housing import read_modes
from gearwhine.housing.fem.factorization import Factorizer

COARSE = {"housing.box.mesh_size": "60 mm", "housing.frequency_limit": "1.6 kHz", "operation.speed": "1500 rpm"}


def ranked(folder: Path, changes: dict[str, str]) -> tuple[dict[str, Any], int]:
    """Document of the ranked operating point that is written to a folder, and the number of factorisations."""
    made: list[object] = []
    factor = Factorizer.factor

    def counted(factorizer: Factorizer, matrix: Any) -> Any:
        made.append(matrix)
        return factor(factorizer, matrix)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Factorizer, "factor", counted)
        result = gw.load("small-gearbox", COARSE | changes, folder=folder).operating_point(sensitivity=True)
    result.write(folder, pictures=False)
    return result.document["sensitivity"], len(made)


def numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in numbers(value[key])]
    if isinstance(value, list):
        return [number for entry in value for number in numbers(entry)]
    return [float(value)] if isinstance(value, float) else []


@pytest.mark.slow
@pytest.mark.usefixtures("few_slices")
def test_a_second_ranking_solves_no_response_again(tmp_path: Path) -> None:
    """The same numbers without a factorisation; another torque keeps the sensors' residual modes alone."""
    first, at_first = ranked(tmp_path, {})
    kept = read_modes(tmp_path / "modes.nc").extras
    assert len([name for name in kept if name.startswith("responses_")]) == 2
    again, at_second = ranked(tmp_path, {})
    assert (at_first, at_second) == (2, 0)
    np.testing.assert_allclose(numbers(again), numbers(first), rtol=1e-9)
    other, at_third = ranked(tmp_path, {"operation.torque": "60 N m"})
    assert at_third == 1
    fresh, _ = ranked(tmp_path / "fresh", {"operation.torque": "60 N m"})
    np.testing.assert_allclose(numbers(other), numbers(fresh), rtol=1e-9)
    after = read_modes(tmp_path / "modes.nc").extras
    assert len(kept.keys() & after.keys()) == 1
    assert len(after) == len(kept)
