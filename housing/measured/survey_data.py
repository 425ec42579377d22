"""Survey data of a modal test: measuring points and directions, measured modes, frequency response functions.

:class:`SurveyData` is the content of one file: the points with the directions measured at each
(:class:`MeasuredGeometry`), frequencies with damping and shapes where they were measured (:class:`MeasuredModes`), and
motions at the survey's degrees of freedom by forces at references (:class:`MeasuredResponses`).
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from gearwhine.housing.errors import HousingError, MeasuredDataError
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

_UNIT = 1e-6  # largest deviation of a unit vector's length from one: files carry six digits


@dataclass(frozen=True)
class MeasuredGeometry:
    """The points of a survey and its measured degrees of freedom, each one direction at one point.

    Attributes
    ----------
    labels : tuple of str
        Name or number of each point, each once.
    positions : ndarray, shape (n_points, 3)
        Positions in the survey's frame [m].
    points : ndarray of int, shape (n_dofs,)
        Point of each degree of freedom.
    directions : ndarray, shape (n_dofs, 3)
        Unit vector of each, in the survey's own frame; local directions are resolved when a file is read.
    lines : tuple of tuple of int
        Points joined by a line where the survey is drawn.

    Raises
    ------
    HousingError
        Where shapes do not fit together, a label stands twice, or a direction is not a unit vector.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    points: IntArray
    directions: FloatArray
    lines: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        """Check shapes of arrays, unique labels, indices of points, and unit directions."""
        n_points, n_dofs = len(self.labels), len(self.points)
        if self.positions.shape != (n_points, 3) or self.directions.shape != (n_dofs, 3):
            raise HousingError(
                f"{n_points} labels and {n_dofs} degrees of freedom, but positions of shape {self.positions.shape} and "
                f"directions of shape {self.directions.shape}"
            )
        if len(set(self.labels)) < n_points:
            twice = next(label for label in self.labels if self.labels.count(label) > 1)
            raise HousingError(f"the point {twice!r} stands twice in the survey; each point needs its own label")
        if n_dofs and (self.points.min() < 0 or self.points.max() >= n_points):
            raise HousingError(f"a degree of freedom of the survey names a point outside its {n_points} points")
        lengths = np.linalg.norm(self.directions, axis=1)
        if np.any(np.abs(lengths - 1.0) > _UNIT):
            worst = int(np.argmax(np.abs(lengths - 1.0)))
            raise HousingError(f"direction {worst} of the survey has length {lengths[worst]:g}; expected a unit vector")


@dataclass(frozen=True)
class MeasuredModes:
    """The modes of a modal test, ascending in frequency.

    Attributes
    ----------
    frequencies : ndarray, shape (n_modes,)
        Undamped natural frequencies [rad/s].
    damping_ratios : ndarray, shape (n_modes,), or None
        Parts of critical damping; None where not known.
    shapes : ndarray of complex, shape (n_modes, n_dofs), or None
        Shapes at the geometry's degrees of freedom, to an unknown scale; NaN where a degree of freedom was not
        measured.
    geometry : MeasuredGeometry or None
        Geometry of the shapes; None where there are none.
    cut_by_band : tuple of int
        Indices of the modes, identified from responses, whose half-power width an edge of the measured band cuts.

    Raises
    ------
    HousingError
        Where the frequencies are not positive and ascending, or the arrays do not fit together.
    """

    frequencies: FloatArray
    damping_ratios: FloatArray | None = None
    shapes: ComplexArray | None = None
    geometry: MeasuredGeometry | None = None
    cut_by_band: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Check ascending frequencies, number of damping ratios, and shapes against the geometry."""
        count = len(self.frequencies)
        if count == 0 or not self.frequencies[0] > 0.0 or not np.all(np.diff(self.frequencies) >= 0.0):
            raise HousingError(f"measured frequencies {self.frequencies} rad/s must be positive and ascending")
        if self.damping_ratios is not None and self.damping_ratios.shape != (count,):
            raise HousingError(f"{len(self.damping_ratios)} damping ratios for {count} measured frequencies")
        if (self.shapes is None) != (self.geometry is None):
            raise HousingError("measured shapes need the geometry they were measured at, and the geometry shapes")
        if self.shapes is not None and self.geometry is not None:
            expected = (count, len(self.geometry.points))
            if self.shapes.shape != expected:
                raise HousingError(f"measured shapes have shape {self.shapes.shape}; expected {expected}")


Motion = Literal["displacement", "velocity", "acceleration"]


@dataclass(frozen=True)
class MeasuredResponses:
    """Motion over force as functions of frequency: receptances, mobilities or accelerances.

    Attributes
    ----------
    geometry : MeasuredGeometry
        The points of the survey and the degrees of freedom whose motion was measured.
    reference_points : ndarray of int, shape (n_references,)
        Point of the geometry at which each force acted.
    reference_directions : ndarray, shape (n_references, 3)
        Unit vector of each force.
    frequencies : ndarray, shape (n_lines,)
        Circular frequencies, ascending, not negative [rad/s].
    values : ndarray of complex, shape (n_dofs, n_references, n_lines)
        Responses in m/N, m/(s N) or m/(s² N) by `motion`; NaN where a pair was not measured.
    motion : {"displacement", "velocity", "acceleration"}
        Measured quantity of the motion.

    Raises
    ------
    MeasuredDataError
        Where the arrays do not fit together or the frequencies do not ascend.
    """

    geometry: MeasuredGeometry
    reference_points: IntArray
    reference_directions: FloatArray
    frequencies: FloatArray
    values: ComplexArray
    motion: Motion = "acceleration"

    def __post_init__(self) -> None:
        """Check shapes of arrays, ascending frequencies, points of references, missing values, and kind of motion."""
        references, lines = len(self.reference_points), len(self.frequencies)
        expected = (len(self.geometry.points), references, lines)
        if self.values.shape != expected or self.reference_directions.shape != (references, 3):
            raise MeasuredDataError(
                f"responses of shape {self.values.shape} and reference directions of shape "
                f"{self.reference_directions.shape}; expected {expected} and {(references, 3)}"
            )
        if lines < 2 or self.frequencies[0] < 0.0 or not np.all(np.diff(self.frequencies) > 0.0):
            raise MeasuredDataError(f"the {lines} frequencies of the responses must ascend from 0 or above")
        if references and not 0 <= self.reference_points.min() <= self.reference_points.max() < len(
            self.geometry.labels
        ):
            raise MeasuredDataError(f"a force acts at a point outside the survey's {len(self.geometry.labels)} points")
        if np.any(np.isnan(self.values).any(axis=2) != np.isnan(self.values[:, :, 0])):
            raise MeasuredDataError("responses lack values at some frequencies only; expected all or none of a pair")
        if self.motion not in get_args(Motion):
            raise MeasuredDataError(f"responses of {self.motion!r}; expected one of {', '.join(get_args(Motion))}")


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
        """Check that the survey holds points, modes or responses."""
        if self.geometry is None and self.modes is None and self.responses is None:
            raise MeasuredDataError("the file holds no points, no modes and no frequency responses")
