"""Drawn shapes: a housing's outer skin as triangles, and its mode shapes or harmonic motions with captions.

Pictures, films and 3D models share the skin, the scale of the shapes, and the file names of drawn modes. A survey is
drawn as a wireframe: lines between its points, and their motion from the measured degrees of freedom.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy import sparse
from scipy.spatial import KDTree

from gearwhine.housing.errors import HousingError
from gearwhine.housing.measured.survey_data import MeasuredGeometry
from gearwhine.housing.modes.natural_modes import ModeSet
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import ComplexArray, FloatArray, IntArray

DRAWN_SCALE = 0.07
"""Largest displacement drawn, as a part of the housing's diagonal."""

# Facets by their number of nodes, cut so that middle nodes bend too; each triangle turns the way its facet does.
_CUTS = {
    3: [[0, 1, 2]],
    6: [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
    4: [[0, 1, 2], [0, 2, 3]],
    8: [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    9: [[0, 4, 8], [4, 1, 8], [1, 5, 8], [5, 2, 8], [2, 6, 8], [6, 3, 8], [3, 7, 8], [7, 0, 8]],
}

_NEIGHBOURS = 16  # neighbours of each point to which a line may go


@dataclass(frozen=True)
class Skin:
    """The outer surface of a mesh as flat triangles between neighbouring nodes.

    Attributes
    ----------
    nodes : ndarray of int, shape (n_points,)
        The mesh's nodes on the surface.
    triangles : ndarray of int, shape (n_triangles, 3)
        Places in ``nodes``, anticlockwise as seen from outside.
    """

    nodes: IntArray
    triangles: IntArray

    def normals(self, points: FloatArray) -> FloatArray:
        """Outward unit normals at places of the nodes of shape (n_points, 3): means of the triangles, by area."""
        a, b, c = points[self.triangles.T]
        doubled_areas = np.cross(b - a, c - a)
        sums = self._triangles_at_points @ doubled_areas
        lengths = np.sqrt(np.einsum("pk,pk->p", sums, sums))
        # Where two sheets cancel there is no outside; any unit vector will do.
        sums[lengths == 0.0] = 0.0, 0.0, 1.0
        return np.asarray(sums / np.where(lengths > 0.0, lengths, 1.0)[:, None])

    @cached_property
    def _triangles_at_points(self) -> sparse.csr_array:
        """Incidence of triangles at points, shape (n_points, n_triangles)."""
        corners = self.triangles.ravel()
        return sparse.csr_array(
            (np.ones(corners.size), (corners, np.repeat(np.arange(len(self.triangles)), 3))),
            shape=(len(self.nodes), len(self.triangles)),
        )


def outer_skin(mesh: Mesh) -> Skin:
    """Return a mesh boundary as triangles: four for each quadratic triangle, so that its middle nodes bend too."""
    cut = [block.nodes[:, _CUTS[block.nodes.shape[1]]].reshape(-1, 3) for block in mesh.boundary]
    nodes, places = np.unique(np.concatenate(cut), return_inverse=True)
    return Skin(nodes, places.reshape(-1, 3))


def drawn_name(modes: ModeSet, number: int) -> str:
    """Return the name of a mode's picture or model, without ending: ``mode-03-1007Hz``."""
    return f"mode-{number:02d}-{modes.frequencies_hz[number - 1]:.0f}Hz"


def check_numbers(modes: ModeSet, numbers: Sequence[int]) -> None:
    """Refuse numbers of modes, from 1, that do not exist.

    Raises
    ------
    HousingError
        Where there is no mode of a number, or no number.
    """
    missing = [number for number in numbers if not 1 <= number <= len(modes.shapes)]
    if missing or not numbers:
        raise HousingError(f"modes {missing or 'none'} asked for; give numbers from 1 to {len(modes.shapes)}")


MODE_QUANTITY = "Displacement / largest"


@dataclass(frozen=True)
class DrawnHousing:
    """The outer surface at rest.

    Attributes
    ----------
    rest : ndarray, shape (n_points, 3)
        Points at rest [m].
    triangles : ndarray of int, shape (n_triangles, 3)
        Places in ``rest``.
    nodes : ndarray of int, shape (n_points,)
        Node numbers of the points in the mesh.
    up : ndarray, shape (3,)
        Unit vector that points upwards in pictures; by default y.
    """

    rest: FloatArray
    triangles: IntArray
    nodes: IntArray
    up: FloatArray = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.rest, axis=0)))


@dataclass(frozen=True)
class DrawnShape:
    """A harmonic motion u(t) = Re U e^{iωt} of the surface, with its captions.

    Attributes
    ----------
    name : str
        Name of its file, without ending.
    title, note : str
        The line above the picture and the lines below that; the note may be empty.
    motion : ndarray of float or complex, shape (n_points, 3)
        U, to any scale. A real one moves in one phase; a complex one may run around. Zero draws `values` on the surface
        at rest.
    quantity : str
        Quantity shown by the colours, with its unit.
    largest : float
        The coloured quantity where the motion is largest.
    values : ndarray, shape (n_points,), optional
        A quantity of either sign that the colours show in place of the displacement, from -`largest` to `largest`.

    Raises
    ------
    HousingError
        Where nothing moves and there are no values, or the motion has a NaN or infinity.
    """

    name: str
    title: str
    note: str
    motion: FloatArray | ComplexArray
    quantity: str = MODE_QUANTITY
    largest: float = 1.0
    values: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check that the displacements are finite and not all zero."""
        if not np.all(np.isfinite(self.motion)) or not (np.any(self.motion) or self.values is not None):
            raise HousingError(f"{self.title or self.name}: a shape to draw needs finite displacements, some not zero")

    @property
    def amplitude(self) -> FloatArray:
        """Largest displacement of each point over a period, as part of the largest of all, shape (n_points,)."""
        return np.asarray(self._swing / self._swing.max())

    @cached_property
    def _swing(self) -> FloatArray:
        """Largest displacement of each point over a period, to the scale of the motion, shape (n_points,)."""
        return peak_displacement(self.motion)

    def at(self, angle: float) -> FloatArray:
        """Displacement at a phase angle [rad] after that of the widest, the largest amplitude being 1; zero at rest."""
        turned = self.motion * np.exp(1j * (angle - widest_angle(self.motion)))
        largest = self._swing.max()
        return np.asarray(turned.real / largest if largest > 0.0 else turned.real)


def peak_displacement(motion: FloatArray | ComplexArray) -> FloatArray:
    """Largest |Re U e^{iθ}| over θ for each row of U, shape (n_points,).

    With U = a + ib, |Re U e^{iθ}|² = ½ (|U|² + Re (U·U) e^{2iθ}): the largest is half the major axis of the ellipse
    that the point runs along, √(½ (|U|² + |U·U|)).
    """
    size, dot = np.einsum("pk,pk->p", motion, motion.conj()).real, np.einsum("pk,pk->p", motion, motion)
    return np.asarray(np.sqrt(0.5 * (size + np.abs(dot))))


def widest_angle(motion: FloatArray | ComplexArray) -> float:
    """Return the θ of the largest Σ |Re U e^{−iθ}|² over all points [rad]; 0 where all move in phase with a real U."""
    return 0.5 * float(np.angle(np.vdot(motion.conj(), motion)))


def drawn_housing(mesh: Mesh, up: Sequence[float] = (0.0, 1.0, 0.0)) -> DrawnHousing:
    """Return the surface of a mesh on which shapes are drawn, with the unit vector that points upwards."""
    skin = outer_skin(mesh)
    return DrawnHousing(mesh.points[skin.nodes], skin.triangles, skin.nodes, np.array(up))


def drawn_modes(
    housing: DrawnHousing, modes: ModeSet, numbers: Sequence[int], notes: Mapping[int, str] | None = None
) -> list[DrawnShape]:
    """Modes by their numbers, from 1, named ``mode-03-1007Hz``; ``notes`` stand below their titles.

    Raises
    ------
    HousingError
        Where there is no mode of such a number.
    """
    check_numbers(modes, numbers)
    return [
        DrawnShape(
            drawn_name(modes, number),
            f"Mode {number}   {modes.frequencies_hz[number - 1]:.0f} Hz",
            (notes or {}).get(number, ""),
            modes.shapes[number - 1][housing.nodes],
        )
        for number in numbers
    ]


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
    neighbours = KDTree(places).query(places, k=min(_NEIGHBOURS + 1, count))
    distances, near = np.asarray(neighbours[0]), np.asarray(neighbours[1])
    edges = {
        (min(point, int(other)), max(point, int(other)))
        for point in range(count)
        for other, length in zip(near[point], distances[point], strict=True)
        if other != point and not _between(places, near[point], point, int(other), float(length))
    }
    return np.array(sorted(edges), dtype=np.int64).reshape(-1, 2)


def _between(places: FloatArray, near: IntArray, point: int, other: int, length: float) -> bool:
    """Whether a third point is closer to both; it is then among the nearer neighbours of the first."""
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
    measured = np.isfinite(values)
    for point in range(len(motions)):
        freedoms = np.flatnonzero((geometry.points == point) & measured)
        if freedoms.size:
            motions[point] = np.linalg.pinv(geometry.directions[freedoms]) @ values[freedoms]
    return motions


def laid_over(measured: ComplexArray, model: FloatArray) -> FloatArray:
    """Scale a measured shape to the model's phase and size, real, shape (n_dofs,); NaN where it was not measured.

    It is turned by the angle of ψᴴφ, which brings it nearest to φ, and has φ's norm over the measured entries.
    """
    is_measured = np.isfinite(measured)
    psi, phi = measured[is_measured], model[is_measured]
    size = float(np.linalg.norm(psi))
    likeness = np.vdot(psi, phi)
    turn = likeness / abs(likeness) if abs(likeness) > 0.0 else 1.0
    laid = np.full(len(measured), np.nan)
    laid[is_measured] = (psi * turn).real * (float(np.linalg.norm(phi)) / size if size > 0.0 else 0.0)
    return laid
