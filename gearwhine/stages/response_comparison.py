"""Measured frequency responses beside the model's at the same points, with FRAC."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case
from gearwhine.stages.housing import SolvedHousing
from housing import HousingError
from housing.correlation import frac, synthesised_responses
from housing.measured import MappedSurvey, MeasuredGeometry, MeasuredResponses, map_survey

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


@dataclass(frozen=True)
class ResponseCorrelation:
    """FRAC of every measured response; see :func:`housing.correlation.frac`.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Of the motions.
    references : MeasuredGeometry
        Of the forces.
    band : tuple of float
        First and last line compared [rad/s].
    n_lines : int
    frac : ndarray, shape (n_dofs, n_references)
        NaN where a pair was not measured.
    """

    geometry: MeasuredGeometry
    references: MeasuredGeometry
    band: tuple[float, float]
    n_lines: int
    frac: FloatArray

    @property
    def n_measured(self) -> int:
        """Number of responses that were measured."""
        return int(np.count_nonzero(np.isfinite(self.frac)))

    @property
    def mean(self) -> float | None:
        """Mean of those measured; None where there are none."""
        known = np.isfinite(self.frac)
        return float(self.frac[known].mean()) if known.any() else None


def compare_responses(
    case: Case, solved: SolvedHousing, survey: MappedSurvey, responses: MeasuredResponses
) -> ResponseCorrelation:
    """The model's responses with its own damping beside the measured ones, up to where its modes are all known.

    Parameters
    ----------
    case : Case
    solved : SolvedHousing
    survey : MappedSurvey
        The motions' degrees of freedom on the model.
    responses : MeasuredResponses

    Raises
    ------
    housing.HousingError
        Where no two lines are left, a force was applied off the surface, or a mode has no damping at its own frequency.
    """
    limit = solved.modes.certificate.limit
    lines = np.flatnonzero((responses.frequencies > 0.0) & (responses.frequencies <= limit))
    if len(lines) < 2:
        raise HousingError(
            f"the responses have {len(lines)} lines between 0 and {limit / _HERTZ:.0f} Hz, up to where the model's "
            "modes are known: expected two at least"
        )
    forces = replace(
        responses.geometry, points=responses.reference_points, directions=responses.reference_directions, lines=()
    )
    given = case.measured
    tolerance = None if given is None else given.tolerance
    driven = map_survey(solved.mesh, forces, alignment=survey.alignment, tolerance=tolerance)
    frequencies = responses.frequencies[lines]
    model = synthesised_responses(
        solved.modes, solved.total_damping_ratios, driven.matrix, survey.matrix, frequencies, responses.motion
    )
    return ResponseCorrelation(
        geometry=responses.geometry,
        references=forces,
        band=(float(frequencies[0]), float(frequencies[-1])),
        n_lines=len(lines),
        frac=frac(model, responses.values[:, :, lines]),
    )


def compare_responses_document(
    case: Case, solved: SolvedHousing, survey: MappedSurvey
) -> ResponseCorrelation | str | None:
    """Correlation of a case's frequency responses, or the reason why there is none; None without measured responses."""
    given = case.measured
    responses = None if given is None or given.survey is None else given.survey.responses
    if responses is None:
        return None
    try:
        return compare_responses(case, solved, survey, responses)
    except HousingError as error:  # of the responses: the pairs of modes stand without them
        return str(error)
