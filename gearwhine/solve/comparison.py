"""Measured modes of a case as a modal test of its housing, refusals by the case's keys, and files of a survey plan."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from gearwhine.case import CaseError, Housing, Problem
from gearwhine.case.errors import UNSAID
from gearwhine.case.measured import Measured
from gearwhine.case.measured import Pairing as PairingTable
from gearwhine.housing import HousingError, HousingModes
from gearwhine.housing.correlation.pairing import PairingRule
from gearwhine.housing.measured import MeasuredModes, SurveyData, identify_modes, write_table, write_universal
from gearwhine.housing.modal_test import (
    ABOVE_HIGHEST_MEASURED,
    ComparedTest,
    ModalTest,
    PlannedSurvey,
    compare_test,
    needed_limit,
)
from gearwhine.numerics.progress import Progress, silent

_TWO_PI = 2.0 * np.pi
_PLAN_FILES = ("survey.uff", "survey.csv")


def read_measured(measured: Measured, progress: Progress = silent) -> MeasuredModes:
    """Read the measured modes of a case: listed in it, stored in its file, or identified from the file's responses.

    Raises
    ------
    CaseError
        Where the responses hold no modes that are stable.
    """
    if measured.frequencies is not None:
        ratios = None if measured.damping_ratios is None else np.array(measured.damping_ratios)
        return MeasuredModes(_TWO_PI * np.array(measured.frequencies), ratios)
    survey = measured.survey
    if survey is not None and survey.modes is not None:
        return survey.modes
    responses = None if survey is None else survey.responses
    assert responses is not None  # checked with the case
    progress("finding modes in the measured responses")
    try:
        return identify_modes(responses).modes
    except HousingError as error:
        raise CaseError([Problem("measured.file", UNSAID, f"responses with modes in them; {error}")]) from error


def modal_test_of(measured: Measured, progress: Progress = silent) -> ModalTest:
    """Return the modal test of a case.

    Raises
    ------
    CaseError
        As :func:`read_measured`.
    """
    align = measured.align
    return ModalTest(
        modes=read_measured(measured, progress),
        responses=None if measured.survey is None else measured.survey.responses,
        align=("surface" if align else None)
        if isinstance(align, bool)
        else {landmark.point: landmark.position for landmark in align.landmarks},
        tolerance=measured.tolerance,
        pairing=measured.paired_by,
        rule=PairingRule(**measured.pairing.model_dump()) if isinstance(measured.pairing, PairingTable) else None,
    )


def compare_measured(
    measured: Measured, housing: HousingModes, progress: Progress = silent, *, with_responses: bool = False
) -> ComparedTest:
    """Compare a housing with the measured modes of its case, as `[measured]` says; with measured responses, if wanted.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        As :func:`gearwhine.housing.modal_test.compare_test`.
    """
    test = modal_test_of(measured, progress)
    with refused_by_key():
        return compare_test(housing, test, progress, with_responses=with_responses)


@contextmanager
def refused_by_key() -> Iterator[None]:
    """Refuse a modal test that does not fit the housing by the keys of the case.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    keys = {
        ("modal test", "align"): "measured.align",
        ("modal test", "modes"): "measured.file",
        ("modal test", "pairing"): "measured.pairing",
        ("housing", "seats"): "housing.seat",
        ("housing", "below_hz"): "housing.frequency_limit",
    }
    try:
        yield
    except HousingError as error:
        if not error.findings:
            raise
        problems = []
        for finding in error.findings:
            value = f"{finding.value:.5g} Hz" if isinstance(finding.value, float) else finding.value
            key = keys[finding.part[0], finding.attribute]
            problems.append(Problem(key, UNSAID if value is None else value, finding.expected))
        raise CaseError(problems) from error


def require_comparable(measured: Measured | None, housing: Housing | None) -> None:
    """Refuse a housing whose modes will not be known as far as the measured ones are paired, before it is solved.

    Raises
    ------
    CaseError
        Where `frequency_limit` or `modes` are too low; nothing where the measured modes are not known yet.
    """
    if measured is None or housing is None or (highest := _highest_measured_hz(measured)) is None:
        return
    count, expected = highest
    if measured.paired_by == "order":
        if housing.modes is not None and housing.modes < count:
            text = f"at least {count}, as many as are measured: the first of the model is paired with the first of them"
            raise CaseError([Problem("housing.modes", housing.modes, text)])
    elif housing.frequency_limit is not None and housing.frequency_limit < ABOVE_HIGHEST_MEASURED * expected:
        text = needed_limit(ABOVE_HIGHEST_MEASURED * expected)
        if ABOVE_HIGHEST_MEASURED * expected < _TWO_PI * housing.frequency_limit:
            text += "; or measured frequencies in Hz, if these are in rad/s"
        raise CaseError([Problem("housing.frequency_limit", f"{housing.frequency_limit:.5g} Hz", text)])


def _highest_measured_hz(measured: Measured) -> tuple[int, float] | None:
    """Return the number of measured modes and the highest frequency [Hz]; None where they are yet to be identified."""
    frequencies = measured.frequencies_hz
    return (len(frequencies), frequencies[-1]) if frequencies else None


def write_plan(place: Path, planned: PlannedSurvey) -> None:
    """Write the survey plan as a universal file (points, directions, trace lines) and as a table."""
    survey = SurveyData(planned.geometry)
    write_universal(place / _PLAN_FILES[0], survey, points=15)
    write_table(place / _PLAN_FILES[1], survey)
