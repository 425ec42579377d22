"""Survey grid: measuring points over the outer faces of a box, along the outward normal."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import HousingError
from housing.surface import NearestOnSurface
from meshes import Mesh, facet_centers, facet_normals, pick_facets

FloatArray = npt.NDArray[np.float64]

# Columns and rows of points on each face. The rig's survey had 116 points (TM-104434, "Experimental study"), laid
# out in a way not printed; here they cover the five faces that are within reach, at nearly even density:
# top 7 x 4, left and right 6 x 4 each, back and front 5 x 4 each. The base faces its mounts.
SURVEY_COUNTS = {"top": (7, 4), "left": (6, 4), "right": (6, 4), "back": (5, 4), "front": (5, 4)}

# For each face: its normal, and the axes along which columns and rows run.
_FACES = {
    "left": ((-1, 0, 0), 2, 1),
    "right": ((1, 0, 0), 2, 1),
    "bottom": ((0, -1, 0), 2, 0),
    "top": ((0, 1, 0), 2, 0),
    "back": ((0, 0, -1), 0, 1),
    "front": ((0, 0, 1), 0, 1),
}

_FACING = 0.9  # least cosine between a facet's normal and that of the face it makes up


@dataclass(frozen=True)
class Survey:
    """Survey points on a mesh.

    Attributes
    ----------
    positions : ndarray, shape (n_points, 3)
        On the surface [m].
    normals : ndarray, shape (n_points, 3)
        Outward.
    matrix : scipy.sparse.csr_array, shape (3 n_points, 3 n_nodes)
        x, y, z of each point from the nodes' displacements.
    """

    positions: FloatArray
    normals: FloatArray
    matrix: sparse.csr_array

    def normal_motion(self, shapes: FloatArray) -> FloatArray:
        """Outward normal motion of modes of shape (n_modes, n_nodes, 3), as (n_modes, n_points)."""
        motion = (self.matrix @ shapes.reshape(len(shapes), -1).T).T.reshape(len(shapes), -1, 3)
        return np.asarray(np.einsum("mpi,pi->mp", motion, self.normals))


def survey_grid(
    mesh: Mesh,
    bounds: FloatArray | None = None,
    counts: dict[str, tuple[int, int]] = SURVEY_COUNTS,
) -> Survey:
    """Points at the middles of an even grid on each face of a box, put on the housing's outer surface.

    Parameters
    ----------
    mesh : Mesh
    bounds : ndarray, shape (2, 3), optional
        The box [m]; by default that of the mesh.
    counts : dict
        Columns and rows on each face.

    Raises
    ------
    HousingError
        Where the box lies beside the mesh.

    Notes
    -----
    Each point is projected along the face's normal on to the facets that look that way on the outer side; one
    that falls into a bore moves to the nearest of them. Where no facet looks that way, those that come nearest to it
    take their place.
    """
    box = mesh.bounds if bounds is None else bounds
    if (box[0] > mesh.bounds[1]).any() or (box[1] < mesh.bounds[0]).any():
        raise HousingError(f"no part of the housing lies in the box {box.tolist()} m")
    boundary = mesh.boundary
    facing = facet_normals(mesh.points, boundary)
    centers = facet_centers(mesh.points, boundary)
    middle = box.mean(axis=0)
    points = []
    for face, (columns, rows) in counts.items():
        normal_axes, column_axis, row_axis = _FACES[face]
        normal = np.array(normal_axes, dtype=np.float64)
        outer = pick_facets(boundary, (facing @ normal > _FACING) & ((centers - middle) @ normal > 0.0))
        if not outer:  # as on a cone: the facets that come nearest to that direction
            outer = pick_facets(boundary, facing @ normal > _FACING * (facing @ normal).max())
        nearest = NearestOnSurface(mesh, outer, along=normal)
        for column in (np.arange(columns) + 0.5) / columns:
            for row in (np.arange(rows) + 0.5) / rows:
                place = middle.copy()
                place[column_axis] = box[0, column_axis] + column * (box[1] - box[0])[column_axis]
                place[row_axis] = box[0, row_axis] + row * (box[1] - box[0])[row_axis]
                points.append((nearest.point(place), normal))
    entries = sparse.lil_array((3 * len(points), 3 * len(mesh.points)))
    for number, (point, _) in enumerate(points):
        for component in range(3):
            entries[3 * number + component, 3 * point.nodes + component] = point.weights
    return Survey(
        positions=np.array([point.position for point, _ in points]),
        normals=np.array([normal for _, normal in points]),
        matrix=sparse.csr_array(entries),
    )
