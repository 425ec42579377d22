"""Nearest point of a surface: on the curved facets of a mesh, and on plane triangles."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from gearwhine.housing.errors import HousingError
from gearwhine.meshes import ElementBlock, Mesh
from gearwhine.meshes.elements import ElementKind, Facets
from gearwhine.meshes.shape_functions import shape_functions
from gearwhine.numerics.arrays import FloatArray, IntArray

_NEIGHBOURS = 6  # facets looked at: as many as meet in a node of a usual mesh
_STEPS = 20
_SHORTENINGS = (1.0, 0.5, 0.25, 0.125)
_LENGTH_ROUNDING = 1e-12
_AT_ONCE = 2**18  # pairs of places and facets that are compared at once: some megabytes


@dataclass(frozen=True)
class SurfacePoint:
    """A point of the surface, held by the shape functions of its facet.

    Attributes
    ----------
    nodes : ndarray of int, shape (n_shape,)
    weights : ndarray, shape (n_shape,)
        Shape functions at the point; they sum to one.
    position : ndarray, shape (3,)
        Place [m].
    normal : ndarray, shape (3,)
        Outward unit normal.
    """

    nodes: IntArray
    weights: FloatArray
    position: FloatArray
    normal: FloatArray


class NearestOnSurface:
    """Finds the point of some boundary facets that is nearest to a place.

    Candidates are the few facets that are nearest by the plane triangles between their corners; among them the true,
    curved or twisted shape decides.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
        Outward facets to search.
    along : ndarray, shape (3,), optional
        A unit vector; distances are then taken across it only, so that places are projected along it.

    Raises
    ------
    HousingError
        Where there are no facets.
    """

    def __init__(self, mesh: Mesh, facets: Facets, along: FloatArray | None = None) -> None:
        self._points = mesh.points
        self._across = np.eye(3) if along is None else np.eye(3) - np.outer(along, along)
        self._triangles = [
            _Triangles.of(mesh, block, triangle, self._across)
            for block in facets
            for triangle in (block.of.corner_triangles if len(block) else ())
        ]
        if not self._triangles:
            raise HousingError("there are no facets to find a point on")

    def point(self, place: FloatArray) -> SurfacePoint:
        """Return the point of the surface nearest to a place [m], shape (3,)."""
        (nearest,) = self.points(place[None])
        return nearest

    def points(self, places: FloatArray) -> list[SurfacePoint]:
        """Return the points of the surface nearest to places [m], shape (n, 3)."""
        most = max(_AT_ONCE // max(len(triangles.centers) for triangles in self._triangles), 1)
        chunks = (places[first : first + most] for first in range(0, len(places), most))
        return [point for chunk in chunks for point in self._nearest(chunk)]

    def _nearest(self, places: FloatArray) -> list[SurfacePoint]:
        targets = places @ self._across
        candidates = self._candidates(targets)
        chosen = [
            self._chosen(target, candidates, slice(first, end))
            for target, first, end in zip(targets, candidates.bounds[:-1], candidates.bounds[1:], strict=True)
        ]
        points: list[SurfacePoint | None] = [None] * len(chosen)
        for number, triangles in enumerate(self._triangles):
            mine = [place for place, (one, _) in enumerate(chosen) if candidates.sets[one] == number]
            if not mine:
                continue
            of = triangles.block.nodes[candidates.members[[chosen[place][0] for place in mine]]]
            values, gradients = shape_functions(triangles.block.kind, np.array([chosen[place][1] for place in mine]).T)
            corners = self._points[of]
            positions = np.einsum("pn,pni->pi", values, corners)
            tangents = np.einsum("pni,pnd->pdi", corners, gradients)
            normals = np.cross(tangents[:, 0], tangents[:, 1])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            for place, *parts in zip(mine, of, values, positions, normals, strict=True):
                points[place] = SurfacePoint(*parts)
        return [point for point in points if point is not None]

    def _chosen(self, target: FloatArray, candidates: "_Candidates", which: slice) -> tuple[int, FloatArray]:
        """Return the candidate whose facet is nearest to a target, and the reference coordinates of its nearest point.

        Where facets are equally near, as at their common edge, the first is taken, whatever the rounding.
        """
        best, least, place = -1, np.inf, candidates.starts[which.start]
        for number in range(which.start, which.stop):
            distance, bulge, slack = candidates.distances[number], candidates.bulges[number], candidates.slacks[number]
            if distance - bulge > least - slack:
                continue
            start, gap = candidates.starts[number], distance
            if bulge > slack:
                block = self._triangles[candidates.sets[number]].block
                corners = self._points[block.nodes[candidates.members[number]]] @ self._across
                start = _closest_on_facet(corners, block, start, target)
                gap = float(np.linalg.norm(shape_functions(block.kind, start[:, None])[0][0] @ corners - target))
            if gap < least - slack or best < 0:
                best, least, place = number, gap, start
        return best, place

    def _candidates(self, targets: FloatArray) -> "_Candidates":
        """Find the facets nearest to each target by the plane triangles between their corners, nearest first."""
        columns = [triangles.candidates(number, targets) for number, triangles in enumerate(self._triangles)]
        rows, distances, sets, members, starts = (np.concatenate(column) for column in zip(*columns, strict=True))
        order = np.lexsort((distances, rows))
        first = np.searchsorted(rows[order], np.arange(len(targets)))
        order = order[np.arange(len(order)) - first[rows[order]] < _NEIGHBOURS]
        sets, members = sets[order], members[order]
        bulges, slacks = np.zeros(len(order)), np.zeros(len(order))
        for number, triangles in enumerate(self._triangles):
            mine = sets == number
            nodes = self._points[triangles.block.nodes[members[mine]]]
            bulges[mine] = _bulges(nodes @ self._across, triangles.block)
            slacks[mine] = _LENGTH_ROUNDING * np.ptp(nodes, axis=1).max(axis=1, initial=0.0)
        return _Candidates(
            np.searchsorted(rows[order], np.arange(len(targets) + 1)).tolist(),
            distances[order].tolist(),
            sets.tolist(),
            members,
            starts[order],
            bulges.tolist(),
            slacks.tolist(),
        )


@dataclass(frozen=True)
class _Candidates:
    """Facets that may be nearest to places, those of one place together, nearest by their plane triangles first.

    Attributes
    ----------
    bounds : list of int
        First candidate of each place, and the end of the last place.
    distances : list of float
        Distances of the plane triangles [m].
    sets : list of int
        Numbers of their sets of triangles.
    members : ndarray of int
        Numbers of the facets in their blocks.
    starts : ndarray, shape (n, 2)
        Reference coordinates of the triangles' nearest points.
    bulges : list of float
        Upper bounds on the distance of a facet from its plane triangles [m].
    slacks : list of float
        Rounding of distances [m].
    """

    bounds: list[int]
    distances: list[float]
    sets: list[int]
    members: IntArray
    starts: FloatArray
    bulges: list[float]
    slacks: list[float]


@dataclass(frozen=True)
class _Triangles:
    """One plane triangle of each facet of a block, and the ball around it.

    Attributes
    ----------
    block : ElementBlock
    places : ndarray, shape (3, 2)
        Reference coordinates of the corners.
    corners : ndarray, shape (n_facets, 3, 3)
        Places of the corners [m].
    centers : ndarray, shape (n_facets, 3)
    radii : ndarray, shape (n_facets,)
        Radii [m].
    """

    block: ElementBlock
    places: FloatArray
    corners: FloatArray
    centers: FloatArray
    radii: FloatArray

    @classmethod
    def of(cls, mesh: Mesh, block: ElementBlock, triangle: tuple[int, ...], across: FloatArray) -> "_Triangles":
        corners = mesh.points[block.nodes[:, triangle]] @ across
        centers = corners.mean(axis=1)
        radii = np.linalg.norm(corners - centers[:, None], axis=2).max(axis=1)
        places = np.array(block.of.places, dtype=np.float64)[list(triangle)]
        return cls(block, places, corners, centers, radii)

    def candidates(
        self, number: int, targets: FloatArray
    ) -> tuple[IntArray, FloatArray, IntArray, IntArray, FloatArray]:
        """Pair targets with triangles that may be among the nearest: their ball is as near as the few nearest centres.

        Returns
        -------
        rows : ndarray of int, shape (n,)
            The targets.
        distances : ndarray, shape (n,)
            Distance of the triangle's nearest point [m].
        sets : ndarray of int, shape (n,)
            The parameter `number`.
        members : ndarray of int, shape (n,)
            The triangles.
        starts : ndarray, shape (n, 2)
            Reference coordinates of the nearest point.
        """
        apart = np.linalg.norm(self.centers - targets[:, None], axis=2)
        few = min(_NEIGHBOURS, apart.shape[1]) - 1
        reach = np.partition(apart, few, axis=1)[:, few, None] * (1.0 + _LENGTH_ROUNDING)
        rows, members = np.nonzero(apart - self.radii * (1.0 + _LENGTH_ROUNDING) <= reach)
        shares, distances = closest_on_triangles(self.corners[members], targets[rows])
        return rows, distances, np.full(len(rows), number), members, shares @ self.places


def surface_point(mesh: Mesh, facets: Facets, place: FloatArray) -> SurfacePoint:
    """Return the surface point nearest to a place; :class:`NearestOnSurface` serves many places at once.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
        Outward facets to search.
    place : ndarray, shape (3,)
        Target [m].

    Raises
    ------
    HousingError
        Where there are no facets.
    """
    return NearestOnSurface(mesh, facets).point(place)


def _bulges(nodes: FloatArray, block: ElementBlock) -> FloatArray:
    """Upper bounds on the distance of facets from the plane triangles between their corners [m]; 0 where they are flat.

    `nodes` are those of n facets of a block, shape (n, n_nodes, 3).
    """
    first = block.of.n_corners
    offset = np.linalg.norm(nodes - _corner_shares(block.of) @ nodes[:, :first], axis=2).max(axis=1)
    twist = nodes[:, 0] - nodes[:, 1] + nodes[:, 2] - nodes[:, 3] if first == 4 else np.zeros((len(nodes), 3))
    # The shape functions of middle nodes add up to at most 3 in size, and a twisted facet bends by a quarter.
    return np.asarray(3.0 * offset + np.linalg.norm(twist, axis=1))


@cache
def _corner_shares(of: ElementKind) -> FloatArray:
    """Return the corners' shape functions at each node, shape (n_nodes, n_corners)."""
    return shape_functions(of.corners, np.array(of.places, dtype=np.float64).T)[0]


def _closest_on_facet(nodes: FloatArray, block: ElementBlock, start: FloatArray, target: FloatArray) -> FloatArray:
    """Find the reference coordinates of the facet's point nearest to the target by Gauss-Newton steps.

    Only steps that come nearer are taken, shortened where they must be, and none that leaves the facet: on a flat
    facet the first guess is already the answer, and on a curved one no step makes it worse.
    """
    coordinates = start
    gap = np.inf
    for _ in range(_STEPS):
        values, gradients = shape_functions(block.kind, coordinates[:, None])
        gap = min(gap, float(np.linalg.norm(values[0] @ nodes - target)))
        tangents = nodes.T @ gradients[0]
        step = np.linalg.lstsq(tangents, target - values[0] @ nodes, rcond=1e-10)[0]
        trials = np.array([_clipped(coordinates + shortening * step, block) for shortening in _SHORTENINGS])
        gaps = np.linalg.norm(shape_functions(block.kind, trials.T)[0] @ nodes - target, axis=1)
        if gaps.min() >= gap * (1.0 - 1e-12):
            break
        coordinates, gap = trials[np.argmin(gaps)], float(gaps.min())
    return coordinates


def _clipped(coordinates: FloatArray, block: ElementBlock) -> FloatArray:
    """Clip reference coordinates to the facet."""
    if block.of.n_corners == 4:
        return np.clip(coordinates, 0.0, 1.0)
    excess = coordinates.sum() - 1.0
    if excess > 0.0:
        coordinates = coordinates - excess / 2.0
    u = float(np.clip(coordinates[0], 0.0, 1.0))
    return np.array([u, np.clip(coordinates[1], 0.0, 1.0 - u)])


def closest_on_triangles(corners: FloatArray, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Barycentric coordinates of the points of triangles nearest to places, and the distances.

    Triangles that a projection made flat (zero area) are measured by their edges.

    Parameters
    ----------
    corners : ndarray, shape (..., 3, d)
        Corners of the triangles in the plane or in space [m].
    places : ndarray, shape (..., d)
        Places [m], broadcast against the triangles.

    Returns
    -------
    coordinates : ndarray, shape (..., 3)
    distance : ndarray, shape (...)
        [m].
    """
    first, second = corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :]
    offset = places - corners[..., 0, :]
    g11, g12, g22 = (first**2).sum(-1), (first * second).sum(-1), (second**2).sum(-1)
    h1, h2 = (offset * first).sum(-1), (offset * second).sum(-1)
    determinant = g11 * g22 - g12**2
    flat = determinant <= 1e-12 * g11 * g22
    safe = np.where(flat, 1.0, determinant)
    u, v = (g22 * h1 - g12 * h2) / safe, (g11 * h2 - g12 * h1) / safe
    best = np.stack([1.0 - u - v, u, v], axis=-1)
    inside = ~flat & (best >= 0.0).all(axis=-1)
    distance = np.where(inside, np.linalg.norm(offset - u[..., None] * first - v[..., None] * second, axis=-1), np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        edge = corners[..., j, :] - corners[..., i, :]
        beside = places - corners[..., i, :]
        t = np.clip((beside * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-300), 0.0, 1.0)
        gap = np.linalg.norm(t[..., None] * edge - beside, axis=-1)
        closer = gap < distance
        distance = np.where(closer, gap, distance)
        candidate = np.zeros_like(best)
        candidate[..., i], candidate[..., j] = 1.0 - t, t
        best = np.where(closer[..., None], candidate, best)
    return best, distance
