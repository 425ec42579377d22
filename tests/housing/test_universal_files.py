"""Universal files that we write: they come back, and what cannot be written leaves the old file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from universal_surveys import SIX_DIGITS, motion, same_motion, survey

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.measured import (
    MeasuredGeometry,
    MeasuredModes,
    SurveyData,
    read_survey,
    read_universal,
    write_survey,
    write_universal,
)


@pytest.mark.parametrize("complex_shapes", [False, True])
@pytest.mark.parametrize("points", [15, 2411])
def test_a_round_trip_loses_nothing_but_digits(tmp_path: Path, points: Any, complex_shapes: bool) -> None:
    path, given = tmp_path / "survey.uff", survey(complex_shapes=complex_shapes)
    write_universal(path, given, points=points)
    again = read_universal(path)
    assert again.geometry is not None
    assert again.geometry.labels == given.geometry.labels
    assert again.geometry.lines == given.geometry.lines
    digits = 1e-15 if points == 2411 else SIX_DIGITS
    np.testing.assert_allclose(again.geometry.positions, given.geometry.positions, rtol=digits)
    np.testing.assert_allclose(again.modes.frequencies, given.modes.frequencies, rtol=SIX_DIGITS)
    np.testing.assert_allclose(again.modes.damping_ratios, given.modes.damping_ratios, rtol=1e-3)
    for number in range(2):
        same_motion(
            motion(given.modes.geometry, given.modes.shapes[number]),
            motion(again.modes.geometry, again.modes.shapes[number]),
            2 * SIX_DIGITS * np.abs(given.modes.shapes).max(),
        )


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_responses_keep_every_digit(tmp_path: Path, seed: int) -> None:
    path, given = tmp_path / "survey.uff", survey(seed=seed).responses
    write_universal(path, SurveyData(given.geometry, None, given))
    again = read_universal(path).responses
    np.testing.assert_array_equal(again.values, given.values)
    np.testing.assert_allclose(again.frequencies, given.frequencies, rtol=1e-15)
    np.testing.assert_array_equal(again.reference_points, given.reference_points)
    # Directions off the axes stand as systems of six digits.
    np.testing.assert_allclose(again.reference_directions, given.reference_directions, atol=SIX_DIGITS)
    np.testing.assert_allclose(again.geometry.directions, given.geometry.directions, atol=SIX_DIGITS)
    assert again.motion == "acceleration"


def test_the_length_of_the_binary_part_is_that_of_its_bytes(tmp_path: Path) -> None:
    """Record 1 of dataset 58b, field 6: readers that trust it must find the end."""
    path, given = tmp_path / "survey.uff", survey().responses
    write_universal(path, SurveyData(given.geometry, None, given))
    content = path.read_bytes()
    start = content.index(b"    58b")
    header, size = content[start : start + 12 * 81], int(content[start + 31 : start + 43])
    assert size == 50 * 3 * 8
    assert content[start + len(header) + size :].startswith(b"    -1\n")


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10_000), complex_shapes=st.booleans(), damping=st.booleans())
def test_any_survey_comes_back(tmp_path: Path, seed: int, complex_shapes: bool, damping: bool) -> None:
    path, given = tmp_path / f"{seed}.unv", survey(seed=seed, complex_shapes=complex_shapes, damping=damping)
    write_survey(path, given)
    again = read_survey(path)
    for number in range(2):
        same_motion(
            motion(given.modes.geometry, given.modes.shapes[number]),
            motion(again.modes.geometry, again.modes.shapes[number]),
            2 * SIX_DIGITS * np.abs(given.modes.shapes).max(),
        )
    assert (again.modes.damping_ratios is None) == (not damping)


def test_what_cannot_be_written_is_refused_and_leaves_the_old_file(tmp_path: Path) -> None:
    given = survey()
    path = tmp_path / "survey.uff"
    path.write_text("what was there", encoding="ascii")
    labels = ("lid",) + given.geometry.labels[1:]
    named = MeasuredGeometry(labels, given.geometry.positions, given.geometry.points, given.geometry.directions)
    with pytest.raises(MeasuredDataError, match="'lid': a universal file knows points by whole numbers"):
        write_universal(path, SurveyData(named))
    with pytest.raises(MeasuredDataError, match="needs points"):
        write_universal(path, SurveyData(modes=MeasuredModes(np.array([1.0]))))
    holes = given.modes.shapes.copy()
    holes[0, 3] = np.nan
    modes = MeasuredModes(given.modes.frequencies, None, holes, given.geometry)
    with pytest.raises(MeasuredDataError, match="point 12 was measured in some modes only"):
        write_universal(path, SurveyData(given.geometry, modes))
    assert path.read_text(encoding="ascii") == "what was there"
    assert [entry.name for entry in tmp_path.iterdir()] == ["survey.uff"]
