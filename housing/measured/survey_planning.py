"""Survey planning: sensor placement by effective independence, driving points for the hammer, survey grid.

Effective independence (D. C. Kammer, *J. Guidance, Control, and Dynamics* 14, 1991): the candidate that contributes
least to the linear independence of the modes is removed, repeatedly. Its share is the diagonal of the projector on the
shapes' space, E = diag Φ (Φᵀ Φ)⁻¹ Φᵀ, between 0 and 1: removing candidate i multiplies the determinant of the
information Φᵀ Φ by (1 - E_i), so that a candidate of share 1 is indispensable.

The survey grid has measuring points over the outer faces of a box, along the outward normal.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.nearest_point import NearestOnSurface
from gearwhine.housing.fem.outer_facets import outer_facets, sample_surface
from gearwhine.housing.measured.survey_data import MeasuredGeometry
from gearwhine.housing.model.patches import points_matrix
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import Facets, facet_centers, facet_normals, pick_facets
from gearwhine.numerics.arrays import FloatArray, IntArray

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

_LEAST_FACE_COSINE = 0.9  # least cosine between a facet's normal and that of the face it makes up


@dataclass(frozen=True)
class Survey:
    """Survey points on a mesh.

    Attributes
    ----------
    positions : ndarray, shape (n_points, 3)
        Places on the surface [m].
    normals : ndarray, shape (n_points, 3)
        Outward unit normals.
    matrix : scipy.sparse.csr_array, shape (3 n_points, 3 n_nodes)
        Motions x, y, z of each point from the nodes' displacements.
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
        Low and high corners of the box [m]; by default the mesh's.
    counts : dict
        Columns and rows on each face.

    Raises
    ------
    HousingError
        Where the box lies beside the mesh.

    Notes
    -----
    Each point is projected along the face's normal on to the facets that look that way on the outer side; a point
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
    points, normals = [], []
    for face, (columns, rows) in counts.items():
        normal_axes, column_axis, row_axis = _FACES[face]
        normal = np.array(normal_axes, dtype=np.float64)
        outer = pick_facets(boundary, (facing @ normal > _LEAST_FACE_COSINE) & ((centers - middle) @ normal > 0.0))
        if not outer:  # on a cone, for instance: the facets that come nearest to that direction
            outer = pick_facets(boundary, facing @ normal > _LEAST_FACE_COSINE * (facing @ normal).max())
        places = np.tile(middle, (columns, rows, 1))
        places[..., column_axis] = (box[0] + _middles(columns)[:, None] * (box[1] - box[0]))[:, column_axis, None]
        places[..., row_axis] = (box[0] + _middles(rows)[:, None] * (box[1] - box[0]))[:, row_axis]
        points += NearestOnSurface(mesh, outer, along=normal).points(places.reshape(-1, 3))
        normals += [normal] * (columns * rows)
    return Survey(
        positions=np.array([point.position for point in points]),
        normals=np.array(normals),
        matrix=points_matrix(mesh, points),
    )


def _middles(count: int) -> FloatArray:
    """Middles of equal parts of the range from 0 to 1."""
    return np.asarray((np.arange(count) + 0.5) / count)


_PLACES = 3  # places for the hammer
_NEIGHBOURS = 3  # points that trace lines join a point with
_DEPENDENT = 1e-8  # smallest singular value of the shapes as a part of the largest, below which two are one


@dataclass(frozen=True)
class SurveyPlan:
    """Degrees of freedom chosen from candidates.

    Attributes
    ----------
    sensors : ndarray of int, shape (n_sensors,)
        Candidates kept, the most indispensable first.
    independence : ndarray, shape (n_sensors,)
        Share of each sensor in the independence of the modes; the shares sum to the number of modes.
    condition : float
        Largest over smallest singular value of the shapes at the sensors, each shape of length 1.
    auto_mac : ndarray, shape (n_modes, n_modes)
        |φᵢᵀ φⱼ|² / (φᵢᵀφᵢ φⱼᵀφⱼ) at the sensors.
    driving_points : ndarray of int, shape (n_places,)
        Candidates for the hammer: the best single one, the best one to add to it, and so on.
    residues : ndarray, shape (n_places,)
        With the places up to each one, the least over the modes of the best driving-point residue, as a part of the
        largest of the mode over all candidates. Near 0 a mode is hardly excited from any of them.
    """

    sensors: IntArray
    independence: FloatArray
    condition: float
    auto_mac: FloatArray
    driving_points: IntArray
    residues: FloatArray

    @property
    def worst_likeness(self) -> float:
        """The largest value of the auto-MAC beside its diagonal; 0 of a single mode."""
        return float(np.max(self.auto_mac - np.diag(np.diag(self.auto_mac)), initial=0.0))


def plan_survey(shapes: FloatArray, count: int) -> SurveyPlan:
    """Choose sensors by effective independence, and rank places for the hammer.

    A blow at candidate i excites mode r by its driving-point residue, φ_ir² / (2 ω_r) for mass-normalised shapes (D. J.
    Ewins, *Modal Testing*, 2000). Divided by the largest that the mode has at any candidate, ω_r drops out; the best
    place is where the least of these over the modes is largest: no mode is missed there. Further places are added
    one by one so that the least over the modes, each at its best place, is largest.

    Parameters
    ----------
    shapes : ndarray, shape (n_modes, n_candidates)
        Modes at the candidates.
    count : int
        Sensors wanted.

    Raises
    ------
    HousingError
        Where fewer sensors than modes or more than candidates are wanted, or the candidates cannot distinguish modes.
    """
    modes, candidates = shapes.shape
    if not modes <= count <= candidates:
        raise HousingError(
            f"{count} sensors for {modes} modes among {candidates} candidates; expected at least as many as modes "
            "and at most as many as candidates"
        )
    lengths = np.linalg.norm(shapes, axis=1, keepdims=True)
    sizes = np.linalg.svd(shapes / np.where(lengths > 0.0, lengths, 1.0), compute_uv=False)
    if not sizes[-1] > _DEPENDENT * sizes[0]:
        raise HousingError(
            f"the {modes} modes look alike at all {candidates} candidates: no choice of sensors parts them"
        )
    remaining = np.arange(candidates)
    shares = _independence(shapes)
    while len(remaining) > count:
        remaining = np.delete(remaining, np.argmin(shares))
        shares = _independence(shapes[:, remaining])
    order = np.argsort(-shares, kind="stable")
    chosen = shapes[:, remaining] / np.linalg.norm(shapes[:, remaining], axis=1, keepdims=True)
    chosen_sizes = np.linalg.svd(chosen, compute_uv=False)
    places, residues = _driving_points(shapes)
    return SurveyPlan(
        sensors=remaining[order],
        independence=shares[order],
        condition=float(chosen_sizes[0] / chosen_sizes[-1]),
        auto_mac=(chosen @ chosen.T) ** 2,
        driving_points=places,
        residues=residues,
    )


def _driving_points(shapes: FloatArray) -> tuple[IntArray, FloatArray]:
    """Places for the hammer, one added after the other, and the least residue with each."""
    parts = shapes**2 / (shapes**2).max(axis=1, keepdims=True)
    best = np.zeros(len(shapes))
    places, residues = [], []
    for _ in range(min(_PLACES, shapes.shape[1])):
        least = np.maximum(parts, best[:, None]).min(axis=0)
        places.append(int(np.argmax(least)))
        residues.append(float(least[places[-1]]))
        best = np.maximum(best, parts[:, places[-1]])
    return np.array(places), np.array(residues)


def _independence(shapes: FloatArray) -> FloatArray:
    """Diagonal of the projector on the space of shapes of shape (n_modes, n), by their orthonormal basis."""
    basis, _ = np.linalg.qr(shapes.T)
    return np.asarray((basis**2).sum(axis=1))


def candidate_points(mesh: Mesh, count: int, *, without: Facets = ()) -> MeasuredGeometry:
    """Points spread over the outer surface, each to be measured along its outward normal.

    The first is the farthest from the housing's middle, each further one the farthest from all before, among samples of
    the surface: so they are even, whatever the mesh.

    Parameters
    ----------
    mesh : Mesh
    count : int
    without : tuple of ElementBlock
        Facets where no sensor can stand, such as bearing seats and feet.

    Raises
    ------
    HousingError
        Where the surface has no room for that number.
    """
    from scipy.spatial import cKDTree

    facets = outer_facets(mesh)
    samples = sample_surface(mesh, facets)
    free = np.ones(len(samples.points), dtype=np.bool_)
    if without:
        excluded = sample_surface(mesh, without)
        free = np.asarray(cKDTree(excluded.points).query(samples.points)[0] > samples.spacing, dtype=np.bool_)
    points = samples.points[free]
    if not 0 < count <= len(points) // 4:
        raise HousingError(f"{count} candidates for sensors; the outer surface has room for 1 to {len(points) // 4}")
    chosen = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    nearest = np.full(len(points), np.inf)
    while len(chosen) < count:
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
        chosen.append(int(np.argmax(nearest)))
    labels = tuple(str(number) for number in range(1, count + 1))
    # Samples lie between the corners of facets, off a curved surface.
    surface = NearestOnSurface(mesh, facets)
    surface_points = surface.points(points[chosen])
    normals = np.array([point.normal for point in surface_points]) + 0.0  # zeros without a sign
    return MeasuredGeometry(labels, np.array([point.position for point in surface_points]), np.arange(count), normals)


def planned_geometry(candidates: MeasuredGeometry, sensors: IntArray) -> MeasuredGeometry:
    """Return the chosen degrees of freedom as a survey of their own, neighbouring points joined by trace lines.

    Points are numbered from 1 in the order given.
    """
    from scipy.spatial import cKDTree

    points = candidates.points[sensors]
    positions = candidates.positions[points]
    count = len(sensors)
    near = cKDTree(positions).query(positions, k=min(_NEIGHBOURS + 1, count))[1].reshape(count, -1)
    joined = {
        (min(index, other), max(index, other))
        for index, row in enumerate(near.tolist())
        for other in row
        if other != index
    }
    labels = tuple(str(number) for number in range(1, count + 1))
    directions = candidates.directions[sensors]
    return MeasuredGeometry(labels, positions, np.arange(count), directions, tuple(sorted(joined)))
