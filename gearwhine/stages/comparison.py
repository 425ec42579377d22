"""Comparison of a solved housing with the measured modes of its case: read, aligned, paired."""

from gearwhine.case import Case
from gearwhine.progress import Progress, silent
from gearwhine.stages.housing import SolvedHousing, pair_modes
from gearwhine.stages.measured import map_measured, mapped_shapes, read_measured
from housing import Comparison, PairingRule
from housing.measured import MappedSurvey


def compare_housing(case: Case, solved: SolvedHousing, progress: Progress = silent) -> Comparison:
    """Pair the model's modes with the case's measured ones; see :func:`compare_with_survey`."""
    return compare_with_survey(case, solved, progress)[0]


def compare_with_survey(
    case: Case, solved: SolvedHousing, progress: Progress = silent
) -> tuple[Comparison, MappedSurvey | None]:
    """Pair the model's modes with the case's measured ones, by shape where there are shapes, else by dominance.

    Returns
    -------
    tuple
        The pairs, and how the survey lies on the model, where there was one.

    Raises
    ------
    CaseError
        Where nothing is measured, the survey does not fit the housing, or the modes cannot be compared.
    housing.HousingError
        Where the model has too few modes in the band.
    """
    measured = read_measured(case, progress)
    if measured.geometry is None:
        return pair_modes(solved, measured), None
    survey = map_measured(case, solved.mesh, measured.geometry)
    assert case.measured is not None
    rule = PairingRule(**case.measured.pairing.model_dump())
    return pair_modes(solved, measured, mapped_shapes(solved, survey), rule), survey
