"""Alignment of a survey's frame with the model's, and mapping of its points to the model's surface.

The frames are aligned by landmarks, or by the nearest points of the surface (ICP). Both are rigid registrations by
least squares: points to points (Kabsch), and points to planes. A mapped survey has the model's motion at each of its
degrees of freedom.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import permutations, product
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import MeasuredDataError
from gearwhine.housing.fem.nearest_point import NearestOnSurface
from gearwhine.housing.fem.outer_facets import SurfaceSamples, outer_facets, sample_surface
from gearwhine.housing.measured.survey_data import MeasuredGeometry
from gearwhine.housing.model.patches import point_matrix
from gearwhine.meshes import Mesh
from gearwhine.meshes.lengths import UNITS, length_text
from gearwhine.numerics.arrays import FloatArray

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


_ON_A_LINE = 1e-6  # second largest spread of points as a part of the largest, below which they turn about their line
_LARGEST_SIZE_RATIO = 20.0  # largest size of a housing over that of its survey; a millionth of it lies near any surface
_TOLERANCE = 0.02  # part of the housing's diagonal beyond which a point is not one of this surface


@dataclass(frozen=True)
class RigidMotion:
    """Rigid motion from one frame to another: x' = R x + t.

    Attributes
    ----------
    rotation : ndarray, shape (3, 3)
    translation : ndarray, shape (3,)
        Translation [m].
    """

    rotation: FloatArray
    translation: FloatArray

    def place(self, points: FloatArray) -> FloatArray:
        """Move points of shape (n, 3) [m]."""
        return np.asarray(points @ self.rotation.T + self.translation)

    def turn(self, directions: FloatArray) -> FloatArray:
        """Rotate directions of shape (n, 3)."""
        return np.asarray(directions @ self.rotation.T)

    @property
    def angle_degrees(self) -> float:
        """Angle of the rotation [degrees]."""
        return float(np.rad2deg(np.arccos(np.clip((np.trace(self.rotation) - 1.0) / 2.0, -1.0, 1.0))))


def fit_points(points: FloatArray, targets: FloatArray) -> tuple[RigidMotion, float]:
    """Fit points to their targets by a rigid motion, and return the scale of a similarity transformation too.

    Minimises Σ |R x + t - y|²: with U S Vᵀ the singular value decomposition of Σ (y - ȳ)(x - x̄)ᵀ, R = U D Vᵀ where
    D = diag(1, 1, det U Vᵀ) keeps it a rotation. The scale that would minimise Σ |s R x + t - y|² is
    tr(S D) / Σ |x - x̄|²; it is not applied, but detects wrong units. W. Kabsch, *Acta Cryst.* A32, 1976;
    S. Umeyama, *IEEE Trans. PAMI* 13, 1991.

    Parameters
    ----------
    points, targets : ndarray, shape (n, 3)

    Raises
    ------
    MeasuredDataError
        Where there are fewer than three points, or they lie on one line, so that the rotation about it is undetermined.
    """
    middle, goal = points.mean(axis=0), targets.mean(axis=0)
    for name, spread in (("points", points - middle), ("places", targets - goal)):
        sizes = np.linalg.svd(spread, compute_uv=False)
        if len(points) < 3 or not sizes[1] > _ON_A_LINE * sizes[0]:
            raise MeasuredDataError(
                f"the {len(points)} {name} to align by lie on one line; expected three or more that span a triangle"
            )
    left, sizes, right = np.linalg.svd((targets - goal).T @ (points - middle))
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation = (left * signs) @ right
    scale = float(sizes @ signs / ((points - middle) ** 2).sum())
    return RigidMotion(rotation, goal - rotation @ middle), scale


def small_motion(points: FloatArray, targets: FloatArray, normals: FloatArray) -> tuple[RigidMotion, FloatArray]:
    """Fit points to planes by a small rigid motion, and return how firmly the planes determine it.

    Minimises Σ (n · (x + r × (x - x̄) + d - y))², linear in d and r (Y. Chen, G. Medioni, *Image and Vision Computing*
    10, 1992); the rotation by r is then made exact.

    Returns
    -------
    motion : RigidMotion
    firmness : ndarray, shape (6,)
        Ascending singular values of the problem over the square root of the number of points, lengths as parts of the
        points' radius: near 0 where the points can move without leaving the planes.
    """
    middle = points.mean(axis=0)
    arms = points - middle
    radius = float(np.sqrt((arms**2).sum(axis=1).mean()))
    matrix = np.concatenate([normals, np.cross(arms, normals) / radius], axis=1)
    gaps = np.einsum("pi,pi->p", targets - points, normals)
    solution, _, _, sizes = np.linalg.lstsq(matrix, gaps, rcond=1e-6)
    vector = solution[3:] / radius
    angle = float(np.linalg.norm(vector))
    rotation = np.eye(3)
    if angle > 0.0:
        x, y, z = vector / angle
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        rotation = rotation + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    firmness = np.zeros(6)
    firmness[: len(sizes)] = sizes
    return RigidMotion(rotation, middle + solution[:3] - rotation @ middle), np.sort(firmness) / np.sqrt(len(points))


_FIRST_STEPS, _STEPS = 6, 40  # steps from every start; from the promising ones
_PROMISING = 4.0  # after the first steps: limit of the rms distance over the least one plus the samples' spacing
_SPREAD_STARTS = 60  # rotations spread over all there are, beside those of axes onto axes
_LAST_STEP = 1e-6  # a step that moves points by less, as a part of the housing's diagonal, is the last
# Root mean square distances that differ by less, as a part of the diagonal, do not distinguish positions.
_EQUAL_FIT_RMS = 0.005
_DISTINCT_DEGREES, _DISTINCT_SHIFT = 5.0, 0.05  # degrees, part of the diagonal: positions that differ by less are one
# Firmness below which the points do not determine a motion; for points all over a box it is 0.3 and more.
_LOOSE_MOTION_FIRMNESS = 0.02
_SCALE_OFF = 0.03  # deviation of the scale from 1 beyond which the survey is of another size than the model


@dataclass(frozen=True)
class Alignment:
    """Position of the survey's frame in the model's.

    Attributes
    ----------
    motion : RigidMotion
        Motion from the survey's frame to the model's.
    rms, largest : float
        Distances left, between landmarks or to the surface [m].
    by : {"landmarks", "surface"}
    others : tuple of RigidMotion
        Other positions of the survey that fit as well; `motion` turns the survey least.
    remarks : tuple of str
        Remarks for the user, a sentence each.
    """

    motion: RigidMotion
    rms: float
    largest: float
    by: str
    others: tuple[RigidMotion, ...] = ()
    remarks: tuple[str, ...] = ()


def align_landmarks(geometry: MeasuredGeometry, landmarks: Mapping[str, tuple[float, float, float]]) -> Alignment:
    """Align a survey by points whose places on the model are known.

    Parameters
    ----------
    geometry : MeasuredGeometry
    landmarks : dict
        Place of each labelled point in the model's frame [m]; three or more, not on one line.

    Raises
    ------
    MeasuredDataError
        Where a label is not among the points, or too few landmarks determine no position.
    """
    if unknown := [label for label in landmarks if label not in geometry.labels]:
        raise MeasuredDataError(f"landmark {unknown[0]!r} is not among the survey's {len(geometry.labels)} points")
    points = geometry.positions[[geometry.labels.index(label) for label in landmarks]]
    places = np.array(list(landmarks.values()), dtype=np.float64).reshape(-1, 3)
    motion, scale = fit_points(points, places)
    gaps = np.linalg.norm(motion.place(points) - places, axis=1)
    remarks = () if abs(np.log(scale)) < _SCALE_OFF else (_scale_remark(scale),)
    return Alignment(motion, float(np.sqrt((gaps**2).mean())), float(gaps.max()), "landmarks", remarks=remarks)


def align_to_surface(mesh: Mesh, geometry: MeasuredGeometry) -> Alignment:
    """Align a survey so that its points lie as near to the housing's outer surface as they can.

    The search starts from many rotations, with the survey's middle on the housing's, and brings points and the nearest
    planes of the surface together alternately (:func:`small_motion`). A housing with symmetries, or one measured on too
    few faces, fits in several positions: the one that turns the survey least is taken, and the others are reported.

    Raises
    ------
    MeasuredDataError
        Where the survey has fewer than six points, too few to determine a position by distances from a surface.
    """
    from scipy.spatial import cKDTree

    points = geometry.positions
    if len(points) < 6:
        raise MeasuredDataError(f"a survey of {len(points)} points cannot be aligned by the surface; give landmarks")
    samples = sample_surface(mesh, outer_facets(mesh))
    surface = _Surface(cKDTree(samples.points), samples)
    diagonal = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    first = [
        _settle(points, surface, _started(points, samples.points, rotation), diagonal, _FIRST_STEPS)
        for rotation in _starts(points, samples.points)
    ]
    limit = _PROMISING * (min(rms for rms, _ in first) + samples.spacing)
    promising = _parted(first, limit, points, diagonal)
    settled = [_settle(points, surface, motion, diagonal, _STEPS) for motion in promising]
    fits = _parted(settled, min(rms for rms, _ in settled) + _EQUAL_FIT_RMS * diagonal, points, diagonal)
    fits.sort(key=lambda motion: motion.angle_degrees)
    motion = fits[0]
    gaps, _, firmness = surface.gaps(motion.place(points))
    return Alignment(
        motion,
        float(np.sqrt((gaps**2).mean())),
        float(gaps.max()),
        "surface",
        others=tuple(fits[1:]),
        remarks=tuple(_remarks(fits, firmness, points, mesh)),
    )


def size_hint(geometry: MeasuredGeometry, mesh: Mesh, part: float = 2.5) -> str | None:
    """Hint at the cause where the survey is of a very different size than the model; None where it is about as large.

    The survey may be `part` times smaller than the model where it covers a part of the housing.
    """
    survey_size = float(np.linalg.norm(np.ptp(geometry.positions, axis=0)))
    if not survey_size > 0.0:
        return None
    scale = float(np.linalg.norm(np.ptp(mesh.points, axis=0))) / survey_size
    return None if 0.4 < scale < part else _scale_remark(scale)


@dataclass(frozen=True)
class _Surface:
    """The surface as samples, and a tree to find the nearest."""

    tree: "cKDTree"
    samples: SurfaceSamples

    def gaps(self, points: FloatArray) -> tuple[FloatArray, RigidMotion, FloatArray]:
        """Distances to the planes of the nearest samples, the small motion that lessens them, and its firmness.

        A point that lies beside its sample by more than their spacing is as much farther away.
        """
        far, nearest = self.tree.query(points)
        targets, normals = self.samples.points[nearest], self.samples.normals[nearest]
        away = np.einsum("pi,pi->p", points - targets, normals)
        beside = np.sqrt(np.maximum(far**2 - away**2, 0.0))
        distances = np.hypot(away, np.maximum(beside - self.samples.spacing, 0.0))
        motion, firmness = small_motion(points, targets, normals)
        return distances, motion, firmness


def _starts(points: FloatArray, centers: FloatArray) -> Iterator[FloatArray]:
    """Rotations to start from: axes onto axes, main axes onto main axes, and others spread over all there are."""
    from scipy.spatial.transform import Rotation

    onto = [
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
    onto = [rotation for rotation in onto if np.linalg.det(rotation) > 0.0]
    yield from onto
    main_axes, surface_axes = (
        np.linalg.svd(places - places.mean(axis=0), full_matrices=False)[2] for places in (points, centers)
    )
    main_axes, surface_axes = (
        axes * np.array([[1.0], [1.0], [np.linalg.det(axes)]]) for axes in (main_axes, surface_axes)
    )
    yield from (surface_axes.T @ rotation @ main_axes for rotation in onto)
    yield from Rotation.random(_SPREAD_STARTS, rng=np.random.default_rng(0)).as_matrix()


def _started(points: FloatArray, centers: FloatArray, rotation: FloatArray) -> RigidMotion:
    """Apply a rotation, and centre the survey's extent on that of the surface."""
    turned = points @ rotation.T
    middles = [(places.min(axis=0) + places.max(axis=0)) / 2.0 for places in (centers, turned)]
    return RigidMotion(rotation, middles[0] - middles[1])


def _settle(
    points: FloatArray, surface: _Surface, motion: RigidMotion, diagonal: float, steps: int
) -> tuple[float, RigidMotion]:
    """Iterate small motions until they vanish; least root mean square distance, and the motion there."""
    best = (np.inf, motion)
    for _ in range(steps):
        placed = motion.place(points)
        distances, step, _ = surface.gaps(placed)
        rms = float(np.sqrt((distances**2).mean()))
        if rms < best[0]:
            best = (rms, motion)
        moved = float(np.linalg.norm(step.place(placed) - placed, axis=1).max())
        motion = RigidMotion(step.rotation @ motion.rotation, step.place(motion.translation[None])[0])
        if moved < _LAST_STEP * diagonal:
            break
    return best


def _parted(
    settled: list[tuple[float, RigidMotion]], limit: float, points: FloatArray, diagonal: float
) -> list[RigidMotion]:
    """Distinct motions whose distance is below a limit, the best first; of nearly equal ones the best alone."""
    parted: list[RigidMotion] = []
    for rms, motion in sorted(settled, key=lambda one: one[0]):
        if rms <= limit and all(_distinct(motion, other, points, diagonal) for other in parted):
            parted.append(motion)
    return parted


def _distinct(motion: RigidMotion, other: RigidMotion, points: FloatArray, diagonal: float) -> bool:
    turned = RigidMotion(motion.rotation @ other.rotation.T, np.zeros(3)).angle_degrees
    shifted = np.linalg.norm(motion.place(points).mean(axis=0) - other.place(points).mean(axis=0))
    return bool(turned > _DISTINCT_DEGREES or shifted > _DISTINCT_SHIFT * diagonal)


def _remarks(fits: list[RigidMotion], firmness: FloatArray, points: FloatArray, mesh: Mesh) -> Iterator[str]:
    if len(fits) > 1:
        turns = ", ".join(
            _turn_text(RigidMotion(other.rotation @ fits[0].rotation.T, np.zeros(3))) for other in fits[1:5]
        )
        yield (
            f"the survey fits in {len(fits)} positions equally well; the one that turns it least was taken, others are "
            f"that {turns}; landmarks tell which is right"
        )
    loose = int(np.count_nonzero(firmness < _LOOSE_MOTION_FIRMNESS))
    if loose:
        yield (
            f"in {loose} of 6 ways the survey can slide along the surface without leaving it: points on too few faces; "
            "give landmarks"
        )
    extent = float(np.linalg.norm(np.ptp(points, axis=0)) / np.linalg.norm(np.ptp(mesh.points, axis=0)))
    if not 0.4 < extent < 2.5:
        yield _scale_remark(1.0 / extent)


def _turn_text(motion: RigidMotion) -> str:
    from scipy.spatial.transform import Rotation

    vector = Rotation.from_matrix(motion.rotation).as_rotvec(degrees=True)
    angle = float(np.linalg.norm(vector))
    if angle < 1.0:
        return "shifted"
    axis = vector / angle
    name = next((f"{letter}" for letter, share in zip("xyz", axis, strict=True) if abs(share) > 0.99), None)
    return f"turned by {angle:.0f}° about {name or np.round(axis, 2).tolist()}"


def _scale_remark(scale: float) -> str:
    """Describe the survey's scale in words, as a mistaken unit where it matches one."""
    for unit, size in UNITS.items():
        for meant, other in UNITS.items():
            if unit != meant and abs(np.log(scale * size / other)) < 0.3:
                return (
                    f"the model is {scale:.4g} times as large as the survey: its lengths are in {meant}, not in {unit}?"
                )
    return f"the model is {scale:.4g} times as large as the survey; a rigid motion does not bring them together"


@dataclass(frozen=True)
class MappedSurvey:
    """The degrees of freedom of a survey on a mesh.

    Attributes
    ----------
    geometry : MeasuredGeometry
        Geometry in the model's frame, points where they were measured.
    positions, normals : ndarray, shape (n_points, 3)
        The nearest points of the outer surface [m] and their outward normals.
    distances : ndarray, shape (n_points,)
        Distance from each measuring point to the surface [m].
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
        Alignment of the survey's frame with the model's; by default the two are the same.
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
    if len(geometry.labels) > 2 and (hint := size_hint(geometry, mesh, _LARGEST_SIZE_RATIO)):
        raise MeasuredDataError(f"the survey is not as large as the housing: {hint}")
    facets = outer_facets(mesh)
    nearest = NearestOnSurface(mesh, facets).points(geometry.positions)
    positions = np.array([point.position for point in nearest]).reshape(-1, 3)
    distances = np.linalg.norm(positions - geometry.positions, axis=1)
    if np.count_nonzero(distances > limit) > len(nearest) / 2:
        hint = size_hint(geometry, mesh)
        advice = f"; {hint}" if hint else "; does the survey stand in the model's frame? It can be aligned"
        raise MeasuredDataError(
            f"{np.count_nonzero(distances > limit)} of {len(nearest)} points of the survey are farther than "
            f"{length_text(limit)} from the housing's surface, the worst {length_text(float(distances.max()))}{advice}"
        )
    motions = [point_matrix(mesh, point) for point in nearest]
    rows = [
        sparse.csr_array(direction[None, :] @ motions[point])
        for point, direction in zip(geometry.points, geometry.directions, strict=True)
    ]
    matrix = sparse.vstack(rows, format="csr") if rows else sparse.csr_array((0, 3 * len(mesh.points)))
    normals = np.array([point.normal for point in nearest]).reshape(-1, 3)
    return MappedSurvey(geometry, positions, normals, distances, sparse.csr_array(matrix), limit, alignment)
