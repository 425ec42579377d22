"""Wireframe of a survey: lines between its points, and their motion from the measured degrees of freedom."""

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from housing.measured.survey_data import MeasuredGeometry

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

_NEIGHBOURS = 16  # of each point that a line may go to


def wireframe(geometry: MeasuredGeometry) -> IntArray:
    """Pairs of points to join, shape (n_edges, 2): the survey's own lines, else those of neighbours.

    Neighbours are those of the relative neighbourhood graph (Toussaint 1980), among each point's nearest: two points
    are joined where no third is closer to both than they are to each other. On a grid these are its lines.
    """
    if geometry.lines:
        joined = [pair for line in geometry.lines for pair in pairwise(line)]
        return np.unique(np.sort(np.array(joined, dtype=np.int64).reshape(-1, 2), axis=1), axis=0)
    places, count = geometry.positions, len(geometry.labels)
    if count < 2:
        return np.zeros((0, 2), dtype=np.int64)
    found = KDTree(places).query(places, k=min(_NEIGHBOURS + 1, count))
    distances, near = np.asarray(found[0]), np.asarray(found[1])
    edges = {
        (min(point, int(other)), max(point, int(other)))
        for point in range(count)
        for other, length in zip(near[point], distances[point], strict=True)
        if other != point and not _between(places, near[point], point, int(other), float(length))
    }
    return np.array(sorted(edges), dtype=np.int64).reshape(-1, 2)


def _between(places: FloatArray, near: IntArray, point: int, other: int, length: float) -> bool:
    """Whether a third point is closer to both; it is then among the neighbours of the first that are nearer yet."""
    third = places[[place for place in near if place not in (point, other)]]
    longest = np.maximum(
        np.linalg.norm(third - places[point], axis=1),
        np.linalg.norm(third - places[other], axis=1),
    )
    return bool(np.any(longest < length * (1.0 - 1e-9)))


def point_motions(geometry: MeasuredGeometry, values: FloatArray) -> FloatArray:
    """Displacement of each point from its measured degrees of freedom, shape (n_points, 3).

    The least motion that has the measured components, D⁺ψ with the point's directions D as rows: components that were
    not measured, or are NaN, are at rest.
    """
    motions = np.zeros((len(geometry.labels), 3))
    known = np.isfinite(values)
    for point in range(len(motions)):
        here = np.flatnonzero((geometry.points == point) & known)
        if here.size:
            motions[point] = np.linalg.pinv(geometry.directions[here]) @ values[here]
    return motions


def laid_over(measured: ComplexArray, model: FloatArray) -> FloatArray:
    """Scale a measured shape to the model's phase and size, real, shape (n_dofs,); NaN where it was not measured.

    It is turned by the angle of ψᴴφ, which brings it nearest to φ, and has φ's norm over the measured entries.
    """
    known = np.isfinite(measured)
    psi, phi = measured[known], model[known]
    size = float(np.linalg.norm(psi))
    likeness = np.vdot(psi, phi)
    turn = likeness / abs(likeness) if abs(likeness) > 0.0 else 1.0
    laid = np.full(len(measured), np.nan)
    laid[known] = (psi * turn).real * (float(np.linalg.norm(phi)) / size if size > 0.0 else 0.0)
    return laid
