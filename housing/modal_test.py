"""Modal test of a housing: measured modes and responses beside the model's, and the plan of a survey of them.

Measured modes are aligned, mapped to the model's degrees of freedom, and paired. Measured frequency responses are
compared with the model's at the same points by FRAC. A planned survey has sensors and a hammer position.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from gearwhine.housing.correlation import frac, synthesised_responses
from gearwhine.housing.correlation.comparison import (
    Comparison,
    Pairing,
    compare_by_dominance,
    compare_by_frequency,
    compare_by_shapes,
    with_shapes,
)
from gearwhine.housing.correlation.pairing import PairingRule
from gearwhine.housing.errors import HousingError
from gearwhine.housing.housing import HousingModes
from gearwhine.housing.measured import (
    Alignment,
    MappedSurvey,
    MeasuredGeometry,
    MeasuredModes,
    MeasuredResponses,
    SurveyPlan,
    align_landmarks,
    align_to_surface,
    candidate_points,
    map_survey,
    plan_survey,
    planned_geometry,
)
from gearwhine.housing.model.supports import Support
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Instance, Number, Part, Rule, attribute_findings, refuse
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning

if TYPE_CHECKING:
    from gearwhine.housing.reduced import ReducedModes

Point = tuple[float, float, float]

ABOVE_HIGHEST_MEASURED = 1.05
"""Limit of the model's modes over the highest measured frequency, as for dominance."""

_TWO_PI = 2.0 * np.pi
_PART: Part = ("modal test", "")
_CLEARER = 0.5  # error as a part of that of random frequencies, above which the nearest modes are no evidence

# Candidate places for each sensor, and the least number of all. With denser candidates the method chooses neighbours,
# which measure the same twice.
_PLACES, _FEWEST = 4, 100


@dataclass(frozen=True, eq=False)
class ModalTest:
    """Modal test of a housing: what was measured, how it lies on the model, and how its modes are paired.

    Attributes
    ----------
    modes : MeasuredModes
        Frequencies, and shapes where they were measured.
    responses : MeasuredResponses, optional
        Frequency responses at the same points.
    align : {"surface"} or mapping of str to point, optional
        How the survey's points come into the model's frame: on to its surface, or by the places of some of them, by
        label [m]; by default they stand in it.
    tolerance : float, optional
        Distance of points from the surface beyond which they are named [m]; by default 2 % of the housing's diagonal.
    pairing : {"order", "nearest", "dominance", "shapes"}, optional
        By default "shapes" where there are some, else "nearest".
    rule : PairingRule, optional
        Rule of the pairing by shapes.

    Raises
    ------
    HousingError
        Where an attribute is of another kind.
    """

    modes: MeasuredModes
    responses: MeasuredResponses | None = None
    align: Literal["surface"] | Mapping[str, Point] | None = None
    tolerance: float | None = None
    pairing: Pairing | None = None
    rule: PairingRule | None = None

    def __post_init__(self) -> None:
        """Check kinds and numbers."""
        rules: dict[str, Rule] = {
            "modes": Instance(MeasuredModes, "MeasuredModes"),
            "responses": Instance(MeasuredResponses, "MeasuredResponses, or None", optional=True),
            "tolerance": Number(above=0.0, optional=True, unit="m"),
            "rule": Instance(PairingRule, "a PairingRule, or None", optional=True),
        }
        refuse(attribute_findings(_PART, self, **rules), HousingError)
        if self.align not in (None, "surface") and not isinstance(self.align, Mapping):
            expected = "'surface', a mapping from labels of points to their places m, or None"
            refuse([Finding(_PART, "align", self.align, expected)], HousingError)
        if self.pairing not in (None, "order", "nearest", "dominance", "shapes"):
            expected = "one of order, nearest, dominance, shapes, or None"
            refuse([Finding(_PART, "pairing", self.pairing, expected)], HousingError)
        if self.pairing == "shapes" and self.modes.shapes is None:
            refuse([Finding(_PART, "pairing", "shapes", "another one of frequencies alone")], HousingError)

    def mapped(self, mesh: Mesh, geometry: MeasuredGeometry) -> MappedSurvey:
        """Put the points of the survey on the mesh of a housing.

        Raises
        ------
        HousingError
            Where they cannot be aligned, or most of them are far from the surface.
        """
        alignment: Alignment | None = None
        attribute = "align"
        try:
            if self.align == "surface":
                alignment = align_to_surface(mesh, geometry)
            elif self.align is not None:
                alignment = align_landmarks(geometry, dict(self.align))
            attribute = "modes"
            return map_survey(mesh, geometry, alignment=alignment, tolerance=self.tolerance)
        except HousingError as error:
            refuse([Finding(_PART, attribute, None, f"a survey of this housing; {error}")], HousingError)
            raise


@dataclass(frozen=True, eq=False)
class ComparedTest:
    """Modal test beside the model.

    Attributes
    ----------
    test : ModalTest
    comparison : Comparison
        Pairs of measured and model modes.
    survey : MappedSurvey or None
        Measured points on the model; None of frequencies alone.
    responses : ResponseCorrelation, str or None
        Measured responses beside the model's, or why they are not compared; None without any.
    """

    test: ModalTest
    comparison: Comparison
    survey: MappedSurvey | None = None
    responses: "ResponseCorrelation | str | None" = None


def compare_test(
    housing: HousingModes, test: ModalTest, progress: Progress = silent, *, with_responses: bool = True
) -> ComparedTest:
    """Pair the modes of a housing with measured ones, and compare its responses with measured ones.

    Parameters
    ----------
    housing : HousingModes
    test : ModalTest
    progress : callable
    with_responses : bool
        Whether to compare responses, too.

    Raises
    ------
    HousingError
        Where the modes are not known as high as the measured ones or are too few in the band, the survey does not fit
        the housing, or it lacks the seats between which and the skin modes are dominant.
    """
    measured = test.modes
    if measured.geometry is None:
        return ComparedTest(test, pair_modes(housing, measured, pairing=test.pairing))
    survey = test.mapped(housing.mesh, measured.geometry)
    shapes = survey.shapes(housing.modes.shapes)
    comparison = pair_modes(housing, measured, shapes, test.rule, pairing=test.pairing)
    if test.responses is None or not with_responses:
        return ComparedTest(test, comparison, survey)
    progress("comparing responses")
    try:
        responses: ResponseCorrelation | str = compare_responses(housing, survey, test.responses, test.tolerance)
    except HousingError as error:  # of the responses: the pairs of modes stand without them
        responses = str(error)
    return ComparedTest(test, comparison, survey, responses)


def comparison_warnings(
    comparison: Comparison, modes: "ModeSet | ReducedModes", measured: MeasuredModes | None = None
) -> list[ResultWarning]:
    """Warn of measured modes without a partner, of pairs that are weak evidence or hang on the mesh, and of edges.

    Measured modes that were identified from responses are cut by an edge of the responses' band where it lies within
    their half-power width.
    """
    warnings = _mesh_dependence(comparison, modes)
    if measured is not None and measured.cut_by_band:
        cut = [mode + 1 for mode in measured.cut_by_band]
        listed = ", ".join(f"{number} ({measured.frequencies[number - 1] / _TWO_PI:.5g} Hz)" for number in cut)
        message = (
            f"an edge of the measured band cuts the half-power width of measured mode{'s' * (len(cut) > 1)} {listed}, "
            "whose shape and damping are less sure; responses measured further tell"
        )
        warnings.append(warning("edge of the band", message, modes=cut))
    if comparison.unpaired_measured:
        numbers = ", ".join(
            f"{mode.number} ({mode.frequency / _TWO_PI:.5g} Hz)" for mode in comparison.unpaired_measured
        )
        message = f"the model has fewer modes than were measured; without a partner: {numbers}"
        warnings.append(warning("unpaired modes", message, modes=len(comparison.unpaired_measured)))
    if comparison.pairing == "nearest" and comparison.chance_error_percent is not None:
        chance, rms = comparison.chance_error_percent, comparison.rms_error_percent
        message = (
            f"paired by nearest frequencies, which is weak evidence: a frequency at random in the band is "
            f"{chance:.2g} % from a mode of the model (rms), the measured ones are {rms:.2g} %"
        )
        if rms > _CLEARER * chance:
            message += "; such errors do not tell this model from another: measure shapes"
        warnings.append(warning("weak pairing", message, rms_error_percent=rms, chance_error_percent=chance))
    return warnings


def _mesh_dependence(comparison: Comparison, modes: "ModeSet | ReducedModes") -> list[ResultWarning]:
    """Warn of pairs by frequency or dominance whose modes lie closer to others than their errors by the mesh.

    By its estimated error e a mode at f lies between f (1 - e) and f on a fine mesh. Where two of these ranges overlap
    the modes may change places, and in the pairing by nearest frequencies another mode may come nearest.
    """
    errors = modes.discretisation_errors
    if errors is None or comparison.pairing == "shapes":
        return []
    upper = modes.frequencies
    lower = upper * (1.0 - np.minimum(errors, 0.9))
    doubtful = []
    for pair in comparison.pairs:
        mode = pair.mode - 1
        overlap = (lower <= upper[mode]) & (lower[mode] <= upper)
        with np.errstate(divide="ignore"):  # of rigid motions
            nearest = int(np.argmin(np.abs(np.log(lower / pair.measured))))
        if overlap.sum() > 1 or (comparison.pairing == "nearest" and nearest != mode):
            doubtful.append(pair.mode)
    if not doubtful:
        return []
    listed = ", ".join(map(str, doubtful))
    message = (
        f"pairs may change with the mesh: model mode{'s' * (len(doubtful) > 1)} {listed} may change places with "
        "neighbours, which lie nearer than the estimated errors by the mesh; a smaller mesh_size tells"
    )
    return [warning("pairs by the mesh", message, modes=doubtful)]


@dataclass(frozen=True)
class ResponseCorrelation:
    """FRAC of every measured response; see :func:`gearwhine.housing.correlation.frac`.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Points and directions of the motions.
    references : MeasuredGeometry
        Points and directions of the forces.
    band : tuple of float
        Frequencies of the first and the last line compared [rad/s].
    n_lines : int
    frac : ndarray, shape (n_dofs, n_references)
        FRAC of each pair; NaN where it was not measured.
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
        """Mean FRAC of the measured responses; None without any."""
        is_measured = np.isfinite(self.frac)
        return float(self.frac[is_measured].mean()) if is_measured.any() else None


def compare_responses(
    housing: HousingModes, survey: MappedSurvey, responses: MeasuredResponses, tolerance: float | None = None
) -> ResponseCorrelation:
    """Compare the model's responses, with its own damping, with measured ones up to where its modes are complete.

    Parameters
    ----------
    housing : HousingModes
    survey : MappedSurvey
        Degrees of freedom of the motions on the model.
    responses : MeasuredResponses
    tolerance : float, optional
        Distance of points from the surface beyond which they are named [m].

    Raises
    ------
    HousingError
        Where no two lines are left, a force was applied off the surface, or a mode has no damping at its own frequency.
    """
    limit = housing.modes.certificate.limit
    lines = np.flatnonzero((responses.frequencies > 0.0) & (responses.frequencies <= limit))
    if len(lines) < 2:
        raise HousingError(
            f"the responses have {len(lines)} lines between 0 and {limit / _TWO_PI:.0f} Hz, up to where the model's "
            "modes are known: expected two at least"
        )
    forces = replace(
        responses.geometry, points=responses.reference_points, directions=responses.reference_directions, lines=()
    )
    driven = map_survey(housing.mesh, forces, alignment=survey.alignment, tolerance=tolerance)
    frequencies = responses.frequencies[lines]
    model = synthesised_responses(
        housing.modes, housing.total_damping_ratios, driven.matrix, survey.matrix, frequencies, responses.motion
    )
    return ResponseCorrelation(
        geometry=responses.geometry,
        references=forces,
        band=(float(frequencies[0]), float(frequencies[-1])),
        n_lines=len(lines),
        frac=frac(model, responses.values[:, :, lines]),
    )


def pair_modes(
    housing: HousingModes,
    measured: MeasuredModes,
    shapes: FloatArray | None = None,
    rule: PairingRule | None = None,
    *,
    pairing: Pairing | None = None,
) -> Comparison:
    """Pair the model's modes with measured ones.

    Parameters
    ----------
    housing : HousingModes
    measured : MeasuredModes
    shapes : ndarray, shape (n_modes, n_dofs), optional
        The model's shapes at the measured degrees of freedom [1/√kg], where ``measured`` has shapes.
    rule : PairingRule, optional
        Rule of the pairing by shape.
    pairing : {"order", "nearest", "dominance", "shapes"}, optional
        By default "shapes" where there are some, else "nearest".

    Raises
    ------
    HousingError
        Where the model's modes are not known as high as the measured ones, or are too few in the band, its shapes do
        not fit the measured ones, or it lacks the seats between which and the skin modes are dominant.
    """
    pairing = pairing or ("nearest" if measured.shapes is None or shapes is None else "shapes")
    model, highest = housing.modes.frequencies, ABOVE_HIGHEST_MEASURED * float(measured.frequencies[-1])
    if pairing != "order" or np.count_nonzero(model > 0.0) < len(measured.frequencies):
        _require_modes_up_to(housing, highest)
    if pairing == "shapes":
        assert shapes is not None
        return compare_by_shapes(model, shapes, measured, rule=rule, strengths=housing.strengths)
    if pairing == "dominance":
        comparison = _compare_by_dominance(housing, measured.frequencies)
    else:
        comparison = compare_by_frequency(measured.frequencies, model, pairing, strengths=housing.strengths)
    return comparison if shapes is None else with_shapes(comparison, model, shapes, measured)


def _compare_by_dominance(housing: HousingModes, frequencies: FloatArray) -> Comparison:
    if housing.strengths is None:
        expected = "bearing seats: dominance is the strength between seats and skin"
        refuse([Finding(("housing", ""), "seats", (), expected)], HousingError)
    assert housing.strengths is not None
    return compare_by_dominance(frequencies, housing.strengths)


def _require_modes_up_to(housing: HousingModes, highest: float) -> None:
    if housing.modes.certificate.limit < highest:
        finding = Finding(("housing", ""), "below_hz", housing.trusted_limit_hz, needed_limit(highest / _TWO_PI))
        refuse([finding], HousingError)


def needed_limit(highest_hz: float) -> str:
    """Return the limit that the model's modes need, to be read after "expected"."""
    return (
        f"at least {highest_hz:.5g} Hz: measured modes are paired with the model's up to there, and these are known "
        "only below the limit"
    )


@dataclass(frozen=True)
class PlannedSurvey:
    """Planned survey and its quality.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Sensors, the best first.
    candidates : MeasuredGeometry
    plan : SurveyPlan
    modes : list of int
        Numbers of the modes to separate, from 1.
    frequencies_hz : ndarray, shape (n_modes,)
        Natural frequencies of these modes [Hz].
    """

    geometry: MeasuredGeometry
    candidates: MeasuredGeometry
    plan: SurveyPlan
    modes: list[int]
    frequencies_hz: npt.NDArray[np.float64]


def plan_modal_survey(housing: HousingModes, sensors: int | None = None, modes: int | None = None) -> PlannedSurvey:
    """Plan a survey of the lowest modes that bend the housing.

    Parameters
    ----------
    housing : HousingModes
    sensors : int, optional
        Three for two modes where not given, since as many as modes leave nothing to check their shapes by.
    modes : int, optional
        Number of modes; all that are known where not given. Rigid motions of a free housing are left out.

    Raises
    ------
    HousingError
        Where the sensors cannot separate the modes.
    """
    elastic = np.flatnonzero(housing.modes.frequencies > 0.0)[:modes]
    sensors = math.ceil(1.5 * elastic.size) if sensors is None else sensors
    seats = [block for seat in housing.housing.seats for block in housing.mesh.surface(seat.name)]
    supports = [fixture for fixture in housing.housing.fixtures if isinstance(fixture, Support)]
    supported = [block for support in supports for block in support.facets(housing.mesh)]
    candidates = candidate_points(housing.mesh, max(_FEWEST, _PLACES * sensors), without=(*seats, *supported))
    shapes = map_survey(housing.mesh, candidates).shapes(housing.modes.shapes[elastic])
    plan = plan_survey(shapes, sensors)
    geometry = planned_geometry(candidates, plan.sensors)
    return PlannedSurvey(geometry, candidates, plan, (elastic + 1).tolist(), housing.frequencies_hz[elastic])
