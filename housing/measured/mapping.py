"""Mapping of a survey to the model: nearest surface points, and the model's motion at each degree of freedom."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import MeasuredDataError
from housing.fem.surface import NearestOnSurface, outer_facets
from housing.measured.alignment import Alignment, size_hint
from housing.measured.survey_data import MeasuredGeometry
from housing.model.patches import point_matrix
from meshes import Mesh
from meshes.lengths import length_text

FloatArray = npt.NDArray[np.float64]

_SMALLEST = 20.0  # times as large as its survey a housing may be; a millionth of it lies near any surface
_TOLERANCE = 0.02  # of the housing's diagonal: beyond it a point is not one of this surface


@dataclass(frozen=True)
class MappedSurvey:
    """The degrees of freedom of a survey on a mesh.

    Attributes
    ----------
    geometry : MeasuredGeometry
        In the model's frame, points where they were measured.
    positions, normals : ndarray, shape (n_points, 3)
        The nearest points of the outer surface [m] and their outward normals.
    distances : ndarray, shape (n_points,)
        From each measuring point to the surface [m].
    matrix : scipy.sparse.csr_array, shape (n_dofs, 3 n_nodes)
        Motion at each degree of freedom, along its direction, from the nodes' displacements.
    tolerance : float
        Distance up to which a point counts as one of the surface [m].
    alignment : Alignment or None
        None where the survey is assumed to be in the model's frame.
    """

    geometry: MeasuredGeometry
    positions: FloatArray
    normals: FloatArray
    distances: FloatArray
    matrix: sparse.csr_array
    tolerance: float
    alignment: Alignment | None = None

    @property
    def far(self) -> tuple[str, ...]:
        """Labels of the points farther from the surface than the tolerance, the farthest first."""
        order = np.argsort(-self.distances, kind="stable")
        return tuple(self.geometry.labels[point] for point in order if self.distances[point] > self.tolerance)

    @property
    def rms_distance(self) -> float:
        """Root mean square distance of the points from the surface [m]."""
        return float(np.sqrt((self.distances**2).mean()))

    def shapes(self, shapes: FloatArray) -> FloatArray:
        """Nodes' displacements of shape (n_modes, n_nodes, 3) at the degrees of freedom, shape (n_modes, n_dofs)."""
        return np.asarray((self.matrix @ shapes.reshape(len(shapes), -1).T).T)


def map_survey(
    mesh: Mesh, geometry: MeasuredGeometry, *, alignment: Alignment | None = None, tolerance: float | None = None
) -> MappedSurvey:
    """Put each point of a survey on the nearest point of the housing's outer surface.

    The model's motion there is that of the facet, by its own shape functions; directions stay as measured.

    Parameters
    ----------
    mesh : Mesh
    geometry : MeasuredGeometry
    alignment : Alignment, optional
        From the survey's frame to the model's; they are taken for the same where not given.
    tolerance : float, optional
        Distance beyond which a point is called far [m]; by default 2 % of the housing's diagonal.

    Raises
    ------
    MeasuredDataError
        Where most points are far from the surface: another unit, another frame, or another housing.
    """
    if alignment is not None:
        motion = alignment.motion
        geometry = replace(
            geometry, positions=motion.place(geometry.positions), directions=motion.turn(geometry.directions)
        )
    limit = _TOLERANCE * float(np.linalg.norm(np.ptp(mesh.points, axis=0))) if tolerance is None else tolerance
    if len(geometry.labels) > 2 and (hint := size_hint(geometry, mesh, _SMALLEST)):
        raise MeasuredDataError(f"the survey is not as large as the housing: {hint}")
    facets = outer_facets(mesh)
    nearest = NearestOnSurface(mesh, facets)
    found = [nearest.point(position) for position in geometry.positions]
    positions = np.array([point.position for point in found]).reshape(-1, 3)
    distances = np.linalg.norm(positions - geometry.positions, axis=1)
    if np.count_nonzero(distances > limit) > len(found) / 2:
        hint = size_hint(geometry, mesh)
        advice = f"; {hint}" if hint else "; does the survey stand in the model's frame? It can be aligned"
        raise MeasuredDataError(
            f"{np.count_nonzero(distances > limit)} of {len(found)} points of the survey are farther than "
            f"{length_text(limit)} from the housing's surface, the worst {length_text(float(distances.max()))}{advice}"
        )
    motions = [point_matrix(mesh, point) for point in found]
    rows = [
        sparse.csr_array(direction[None, :] @ motions[point])
        for point, direction in zip(geometry.points, geometry.directions, strict=True)
    ]
    matrix = sparse.vstack(rows, format="csr") if rows else sparse.csr_array((0, 3 * len(mesh.points)))
    normals = np.array([point.normal for point in found]).reshape(-1, 3)
    return MappedSurvey(geometry, positions, normals, distances, sparse.csr_array(matrix), limit, alignment)
