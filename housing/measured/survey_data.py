"""Survey data: content of one file of a modal survey."""

from dataclasses import dataclass

from housing.errors import MeasuredDataError
from housing.measured.geometry import MeasuredGeometry
from housing.measured.modes import MeasuredModes
from housing.measured.responses import MeasuredResponses


@dataclass(frozen=True)
class SurveyData:
    """Content of a file of measured data, in SI and in the survey's own frame.

    Attributes
    ----------
    geometry : MeasuredGeometry or None
        Points and lines; its degrees of freedom are those of the shapes, else those of the responses, else none.
    modes : MeasuredModes or None
    responses : MeasuredResponses or None
    remarks : tuple of str
        Assumptions made and data ignored, a sentence each.
    """

    geometry: MeasuredGeometry | None = None
    modes: MeasuredModes | None = None
    responses: MeasuredResponses | None = None
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.geometry is None and self.modes is None and self.responses is None:
            raise MeasuredDataError("the file holds no points, no modes and no frequency responses")
