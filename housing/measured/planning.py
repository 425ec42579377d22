"""Sensor placement by effective independence, and driving points for the hammer.

Effective independence (D. C. Kammer, *J. Guidance, Control, and Dynamics* 14, 1991): the candidate that contributes
least to the linear independence of the modes is removed, repeatedly. Its share is the diagonal of the projector on the
shapes' space, E = diag Φ (Φᵀ Φ)⁻¹ Φᵀ, between 0 and 1: removing candidate i multiplies the determinant of the
information Φᵀ Φ by (1 - E_i), so that a candidate of share 1 is indispensable.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from housing.errors import HousingError
from housing.measured.geometry import MeasuredGeometry
from housing.measured.outer_surface import outer_facets, sample_surface
from housing.surface import NearestOnSurface
from meshes import Facets, Mesh

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

_PLACES = 3  # for the hammer
_DEPENDENT = 1e-8  # smallest singular value of the shapes as a part of the largest, below which two are one


@dataclass(frozen=True)
class SurveyPlan:
    """Degrees of freedom chosen from candidates.

    Attributes
    ----------
    sensors : ndarray of int, shape (n_sensors,)
        Candidates kept, the most indispensable first.
    independence : ndarray, shape (n_sensors,)
        Share of each in the independence of the modes; they sum to the number of modes.
    condition : float
        Largest over smallest singular value of the shapes at the sensors, each shape of length 1.
    auto_mac : ndarray, shape (n_modes, n_modes)
        |φᵢᵀ φⱼ|² / (φᵢᵀφᵢ φⱼᵀφⱼ) at the sensors.
    driving_points : ndarray of int, shape (n_places,)
        Candidates for the hammer: the best single one, the best one to add to it, and so on.
    residues : ndarray, shape (n_places,)
        With the places up to each: the least over the modes of the best driving-point residue, as a part of the largest
        that the mode has anywhere. Near 0 a mode is hardly excited from any of them.
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
    one by one so that, with the best of all for each mode, the least is largest.

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
    kept = np.arange(candidates)
    shares = _independence(shapes)
    while len(kept) > count:
        kept = np.delete(kept, np.argmin(shares))
        shares = _independence(shapes[:, kept])
    order = np.argsort(-shares, kind="stable")
    chosen = shapes[:, kept] / np.linalg.norm(shapes[:, kept], axis=1, keepdims=True)
    chosen_sizes = np.linalg.svd(chosen, compute_uv=False)
    places, residues = _driving_points(shapes)
    return SurveyPlan(
        sensors=kept[order],
        independence=shares[order],
        condition=float(chosen_sizes[0] / chosen_sizes[-1]),
        auto_mac=(chosen @ chosen.T) ** 2,
        driving_points=places,
        residues=residues,
    )


def _driving_points(shapes: FloatArray) -> tuple[IntArray, FloatArray]:
    """Places for the hammer, one added to the other, and the least residue with each."""
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

    The first is the farthest from the housing's middle, each next one the farthest from those before, among samples of
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
    facets = outer_facets(mesh)
    samples = sample_surface(mesh, facets)
    free = np.ones(len(samples.points), dtype=np.bool_)
    if without:
        taken = sample_surface(mesh, without)
        free = np.asarray(cKDTree(taken.points).query(samples.points)[0] > samples.spacing, dtype=np.bool_)
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
    found = [surface.point(place) for place in points[chosen]]
    normals = np.array([point.normal for point in found]) + 0.0  # zeros without a sign
    return MeasuredGeometry(labels, np.array([point.position for point in found]), np.arange(count), normals)


def planned_geometry(candidates: MeasuredGeometry, sensors: IntArray, *, neighbours: int = 3) -> MeasuredGeometry:
    """The chosen degrees of freedom as a survey of their own, points joined with their neighbours to be drawn.

    Points are numbered from 1 in the order given.
    """
    points = candidates.points[sensors]
    positions = candidates.positions[points]
    count = len(sensors)
    near = cKDTree(positions).query(positions, k=min(neighbours + 1, count))[1].reshape(count, -1)
    joined = {
        (min(one, other), max(one, other)) for one, row in enumerate(near.tolist()) for other in row if other != one
    }
    labels = tuple(str(number) for number in range(1, count + 1))
    directions = candidates.directions[sensors]
    return MeasuredGeometry(labels, positions, np.arange(count), directions, tuple(sorted(joined)))
