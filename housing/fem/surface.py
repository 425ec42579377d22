"""Surface of a housing: integration by quadrature, nearest point, and the outer facets.

The outer facets are those that are visible from outside, where sensors and the hammer reach.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from housing.errors import HousingError
from meshes import ElementBlock, Mesh
from meshes.elements import ElementKind, Facets, facet_centers, facet_normals, pick_facets
from meshes.shape_functions import quadrature, shape_functions

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SurfaceQuadrature:
    """Quadrature points on facets of one kind.

    Attributes
    ----------
    facets : ndarray of int, shape (n_facets, n_shape)
        Nodes of each facet.
    shape_values : ndarray, shape (n_points, n_shape)
        Shape functions at the points, the same on each facet.
    points : ndarray, shape (n_facets, n_points, 3)
        Places [m].
    areas : ndarray, shape (n_facets, n_points)
        Area that each point stands for [m²].
    """

    facets: IntArray
    shape_values: FloatArray
    points: FloatArray
    areas: FloatArray

    @property
    def area(self) -> float:
        """Area of all facets [m²]."""
        return float(self.areas.sum())


def surface_quadrature(mesh: Mesh, facets: Facets) -> tuple[SurfaceQuadrature, ...]:
    """Points and areas on facets, one set for each block of a kind.

    Exact for the product of two fields of the elements' order on flat facets whose opposite sides are parallel.
    """
    return tuple(_block_quadrature(mesh, block) for block in facets)


def _block_quadrature(mesh: Mesh, block: ElementBlock) -> SurfaceQuadrature:
    places, weights = quadrature(block.kind, 4)
    values, gradients = shape_functions(block.kind, places)
    nodes = mesh.points[block.nodes]
    tangents = np.einsum("fai,qaj->fqij", nodes, gradients, optimize=True)
    normal = np.cross(tangents[..., 0], tangents[..., 1])
    return SurfaceQuadrature(
        facets=block.nodes,
        shape_values=values,
        points=np.einsum("fai,qa->fqi", nodes, values, optimize=True),
        areas=np.linalg.norm(normal, axis=2) * weights,
    )


_ALIGNED = 1.0 - 1e-5  # cosine between the normals of neighbouring facets of one plane


@dataclass(frozen=True)
class FlatFace:
    """A flat part of a mesh's boundary, in one piece.

    Attributes
    ----------
    facets : tuple of ElementBlock
    area : float
        Area [m²].
    center, normal : ndarray, shape (3,)
        Centroid [m] and outward unit normal.
    """

    facets: Facets
    area: float
    center: FloatArray
    normal: FloatArray


def flat_faces(mesh: Mesh) -> list[FlatFace]:
    """Divide a mesh's boundary into flat faces: facets that share edges and lie in one plane; the largest first."""
    boundary, face_of = mesh.boundary, flat_face_numbers(mesh)
    normals, centers = facet_normals(mesh.points, boundary), facet_centers(mesh.points, boundary)
    areas = np.concatenate([part.areas.sum(axis=1) for part in surface_quadrature(mesh, boundary)])
    faces = []
    for number in np.argsort(-np.bincount(face_of, areas), kind="stable").tolist():
        chosen = face_of == number
        area, normal = float(areas[chosen].sum()), areas[chosen] @ normals[chosen]
        center = areas[chosen] @ centers[chosen] / area
        faces.append(FlatFace(pick_facets(boundary, chosen), area, center, normal / np.linalg.norm(normal)))
    return faces


def flat_face_numbers(mesh: Mesh) -> IntArray:
    """Find the number of the flat face that each boundary facet belongs to, shape (n_facets,), block after block."""
    boundary = mesh.boundary
    normals = facet_normals(mesh.points, boundary)
    ends, owners, first = [], [], 0
    for block in boundary:
        corners = block.corners
        for side in range(corners.shape[1]):
            ends.append(np.sort(corners[:, [side, (side + 1) % corners.shape[1]]], axis=1))
            owners.append(first + np.arange(len(block)))
        first += len(block)
    edges, owner = np.concatenate(ends), np.concatenate(owners)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    first_facet, second_facet = (
        owner[part][(edges[1:] == edges[:-1]).all(axis=1)] for part in (slice(None, -1), slice(1, None))
    )
    flat = np.einsum("ei,ei->e", normals[first_facet], normals[second_facet]) > _ALIGNED
    joined = sparse.coo_array((np.ones(flat.sum()), (first_facet[flat], second_facet[flat])), shape=(first, first))
    return np.asarray(connected_components(joined, directed=False)[1], dtype=np.int64)


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
            for triangle in (_CORNER_TRIANGLES[block.of.n_corners] if len(block) else ())
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
            slacks[mine] = _ROUNDING * np.ptp(nodes, axis=1).max(axis=1, initial=0.0)
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
        reach = np.partition(apart, few, axis=1)[:, few, None] * (1.0 + _ROUNDING)
        rows, members = np.nonzero(apart - self.radii * (1.0 + _ROUNDING) <= reach)
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


# Plane triangles between the corners of a facet.
_CORNER_TRIANGLES = {3: ((0, 1, 2),), 4: ((0, 1, 2), (0, 2, 3))}
_NEIGHBOURS = 6  # facets looked at: as many as meet in a node of a usual mesh
_STEPS = 20
_SHORTENINGS = (1.0, 0.5, 0.25, 0.125)
_ROUNDING = 1e-12
_AT_ONCE = 2**18  # pairs of places and facets that are compared at once: some megabytes


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


_CELLS = 80  # cells of a view along the housing's diagonal
_DIRECTIONS = 60  # directions of view
_FACING = 0.5  # least cosine between a facet's normal and the direction of a view that counts
_SEEN = 0.25  # least part of the views of a facet in which it is visible; through a bore it is in few
_DEPTH = 3.0  # cells that a facet may lie behind the foremost in its own: slanting neighbours share cells
_TRIANGLES = {3: ((0, 1, 2),), 4: ((0, 1, 2), (0, 2, 3))}


@dataclass(frozen=True)
class SurfaceSamples:
    """Points spread over facets.

    Attributes
    ----------
    points, normals : ndarray, shape (n, 3)
        Places on the plane triangles between the facets' corners [m], and their outward unit normals.
    spacing : float
        Neighbours are no farther from each other than this [m].
    """

    points: FloatArray
    normals: FloatArray
    spacing: float


def sample_surface(mesh: Mesh, facets: Facets) -> SurfaceSamples:
    """Points on facets, no farther apart than an eightieth of the mesh's diagonal."""
    spacing = float(np.linalg.norm(np.ptp(mesh.points, axis=0))) / _CELLS
    points, normals = [], []
    for block in facets:
        for corners in _TRIANGLES[block.of.n_corners]:
            triangles = mesh.points[block.nodes[:, corners]]
            edges = np.roll(triangles, -1, axis=1) - triangles
            normal = np.cross(edges[:, 0], edges[:, 1])
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            normal = normal / np.where(length > 0.0, length, 1.0)
            parts = np.ceil(np.linalg.norm(edges, axis=2).max(axis=1) / spacing).astype(np.int64)
            for count in np.unique(parts):
                shares = triangle_middles(int(count))
                chosen = parts == count
                points.append(np.einsum("sc,tci->tsi", shares, triangles[chosen]).reshape(-1, 3))
                normals.append(np.repeat(normal[chosen], len(shares), axis=0))
    return SurfaceSamples(np.concatenate(points), np.concatenate(normals), spacing)


def outer_facets(mesh: Mesh) -> Facets:
    """Return the outer facets: those visible from outside from enough of the directions that they face.

    Points of the surface are sorted into the cells of views from evenly spread directions: a facet whose middle lies
    well behind the foremost point of its cell is hidden. Walls inside a closed housing are hidden but for parts visible
    through bores; those of an open one count as outer.
    """
    boundary = mesh.boundary
    samples = sample_surface(mesh, boundary)
    middles, normals = facet_centers(mesh.points, boundary), facet_normals(mesh.points, boundary)
    faced, seen = np.zeros(len(middles)), np.zeros(len(middles))
    for direction in _even_directions(_DIRECTIONS):
        towards = samples.points[samples.normals @ direction > 0.0]
        cells, middle_cells = _cells(towards, middles, _across(direction), samples.spacing)
        foremost = np.full(max(cells.max(), middle_cells.max()) + 1, -np.inf)
        np.maximum.at(foremost, cells, towards @ direction)
        facing = normals @ direction > _FACING
        seen += facing & (middles @ direction > foremost[middle_cells] - _DEPTH * samples.spacing)
        faced += facing
    return pick_facets(boundary, seen >= _SEEN * np.maximum(faced, 1.0))


def _cells(points: FloatArray, others: FloatArray, across: FloatArray, size: float) -> tuple[IntArray, IntArray]:
    """Numbers of the cells of a view that points, and others, fall into."""
    # By columns, each contiguous: to seek the least of rows takes longer than all the rest.
    first, second = ([np.floor(places @ one / size).astype(np.int64) for one in across] for places in (points, others))
    lowest = [min(one.min(), other.min()) for one, other in zip(first, second, strict=True)]
    width = max(first[1].max(), second[1].max()) - lowest[1] + 1
    of_points, of_others = ((u - lowest[0]) * width + (v - lowest[1]) for u, v in (first, second))
    return of_points, of_others


def triangle_middles(count: int) -> FloatArray:
    """Shares of the corners at the middles of the triangles that a triangle is cut into, `count` along each side."""
    upward = [(i + 1 / 3, j + 1 / 3) for i in range(count) for j in range(count - i)]
    downward = [(i + 2 / 3, j + 2 / 3) for i in range(count) for j in range(count - i - 1)]
    u, v = np.array(upward + downward).T / count
    return np.stack([1.0 - u - v, u, v], axis=1)


def _even_directions(count: int) -> FloatArray:
    """Return unit vectors spread evenly over the sphere along a spiral of the golden angle."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=1)


def _across(direction: FloatArray) -> FloatArray:
    """Two unit vectors perpendicular to a direction and to each other, as rows."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(direction, first)])
