"""Cylindrical bores on the surface of a mesh: search for all of them, and the facets of each.

Circles are fitted to the corners of facets; facets and their neighbours propose the candidates. The corners of a bore's
facets lie on its cylinder, however coarse the mesh, and the facets look towards its axis; the outside of a boss looks
away from it. A fillet along the axis is no bore, for it covers a quarter of the circle only.

The corners of a recess with cut corners lie on a circle as well. An edge over the angle θ is off the circle by its
sagitta R (1 − cos θ/2). Below the tolerance of a circle it proves itself; above, it is a chord of a bore where the
edges divide the circle evenly, as meshes and tessellations do, and a wall where wide ones alternate with narrow ones.
A recess of five to eight equal walls looks the same, but for the middle nodes of its edges: where a mesh of second
order is curved anywhere, these lie on the circle of a bore, and on the chord of a wall.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.meshes.elements import Facets, facet_centers, facet_corners, facet_normals, pick_facets
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray

LARGEST_COSINE_TO_AXIS = 0.5  # largest cosine between the axis and a facet's normal: chords of coarse meshes are askew
CIRCLE_TOLERANCE = 0.01  # corners of a bore may be off its circle by this part of its diameter
_WIDEST_EDGE = np.radians(75.0)  # edges of a bore of five or more sectors cover less of it, and its facets turn by less
_LOCAL_FIT = 0.02  # corners of neighbours may be off their circle by this part of its radius
_MOST_CIRCLES = 500
_FEWEST_FACETS = 3  # facets that must propose a circle before it is tried


def candidate_circles(mesh: Mesh, axis: FloatArray) -> list[tuple[FloatArray, float]]:
    """Circles through facets and their neighbours, those that most facets propose first.

    Parameters
    ----------
    mesh : Mesh
    axis : ndarray, shape (3,)
        Unit vector at right angles to the circles.

    Returns
    -------
    list of (ndarray of shape (3,), float)
        A point of each circle's axis, and its radius [m].
    """
    boundary = mesh.boundary
    centers, normals = facet_centers(mesh.points, boundary), facet_normals(mesh.points, boundary)
    sideways = np.abs(normals @ axis) < LARGEST_COSINE_TO_AXIS
    corners = np.concatenate([block.corners[:, [0, 1, 2, -1]] for block in boundary])
    pairs = _edge_neighbors(boundary)
    first_facet, second_facet = pairs[:, 0], pairs[:, 1]
    # Neighbours round a bore lie in front of each other, and turn, but not by a corner.
    step = centers[second_facet] - centers[first_facet]
    hollow = np.minimum(
        np.einsum("pi,pi->p", normals[first_facet], step), -np.einsum("pi,pi->p", normals[second_facet], step)
    )
    turn = np.einsum("pi,pi->p", normals[first_facet], normals[second_facet])
    linked = sideways[first_facet] & sideways[second_facet] & (turn > np.cos(_WIDEST_EDGE))
    linked &= hollow > -1e-6 * np.linalg.norm(step, axis=1)
    pairs = np.concatenate([pairs[linked], pairs[linked][:, ::-1]])
    if len(pairs) == 0:
        return []
    pairs = pairs[np.argsort(pairs[:, 0], kind="stable")]
    facets, start, number = np.unique(pairs[:, 0], return_index=True, return_counts=True)
    column = np.arange(len(pairs)) - np.repeat(start, number)
    around = np.repeat(facets[:, None], 5, axis=1)  # itself where it has no further neighbour
    keep = column < 4
    around[np.repeat(np.arange(len(facets)), number)[keep], 1 + column[keep]] = pairs[keep, 1]
    first, second = plane_axes(axis)
    arms = mesh.points[corners[around].reshape(len(facets), -1)] - centers[facets][:, None]
    flat = np.stack([arms @ first, arms @ second], axis=2)
    middle, radius = _fit_circles(flat)
    off = np.abs(np.linalg.norm(flat - middle[:, None], axis=2) - radius[:, None]).max(axis=1)
    size = float(np.linalg.norm(mesh.bounds[1] - mesh.bounds[0]))
    good = np.isfinite(radius) & (off < _LOCAL_FIT * radius) & (radius < size)
    places = centers[facets[good]] + middle[good, :1] * first + middle[good, 1:] * second
    return _most_proposed(places, radius[good], first, second)


def _most_proposed(
    places: FloatArray, radii: FloatArray, first: FloatArray, second: FloatArray
) -> list[tuple[FloatArray, float]]:
    """Medians of the circles that agree to their slack, those with the most proposals first."""
    if len(radii) == 0:
        return []
    size = np.exp(np.round(np.log(radii) / 0.05) * 0.05)  # bins of the same width for radii of the same size
    bins = np.stack([places @ first / size, places @ second / size, radii / size], axis=1) / (2 * CIRCLE_TOLERANCE)
    keys = np.column_stack([np.round(bins).astype(np.int64), np.round(np.log(size) / 0.05).astype(np.int64)])
    _, which, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    order = [one for one in np.argsort(-counts, kind="stable")[:_MOST_CIRCLES] if counts[one] >= _FEWEST_FACETS]
    return [(np.median(places[which == one], axis=0), float(np.median(radii[which == one]))) for one in order]


def fit_circle(points: FloatArray) -> tuple[FloatArray, float]:
    """Centre and radius of the circle nearest to points of a plane, shape (n, 2) (Kåsa: least squares of r² - R²)."""
    matrix = np.column_stack([points, np.ones(len(points))])
    solution = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    center = solution[:2] / 2
    return center, float(np.sqrt(max(solution[2] + center @ center, 0.0)))


def _fit_circles(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Fit circles to n sets of points, shape (n, n_points, 2), by :func:`fit_circle`; not finite for points in line."""
    scale = np.abs(points).max(axis=(1, 2))
    scaled = points / scale[:, None, None]
    matrix = np.concatenate([scaled, np.ones((*scaled.shape[:2], 1))], axis=2)
    normal = np.einsum("npi,npj->nij", matrix, matrix)
    right = np.einsum("npi,np->ni", matrix, (scaled**2).sum(axis=2))
    sound = np.linalg.det(normal) > 1e-9
    solution = np.full((len(points), 3), np.nan)
    solution[sound] = np.linalg.solve(normal[sound], right[sound][..., None])[..., 0]
    center = solution[:, :2] / 2
    radius = np.sqrt(np.maximum(solution[:, 2] + (center**2).sum(axis=1), 0.0))
    return center * scale[:, None], radius * scale


def _edge_neighbors(facets: Facets) -> IntArray:
    """Pairs of facets that share an edge, shape (n_pairs, 2); facets are counted block after block."""
    edges, owners, start = [], [], 0
    for block in facets:
        local = block.of.edges
        edges.append(np.sort(block.nodes[:, local].reshape(-1, 2), axis=1))
        owners.append(np.repeat(np.arange(start, start + len(block)), len(local)))
        start += len(block)
    edge, owner = np.concatenate(edges), np.concatenate(owners)
    order = np.lexsort((edge[:, 1], edge[:, 0]))
    edge, owner = edge[order], owner[order]
    same = np.all(edge[1:] == edge[:-1], axis=1)
    return np.stack([owner[:-1][same], owner[1:][same]], axis=1)


def across(vectors: FloatArray, axis: FloatArray) -> FloatArray:
    """Component of each vector at right angles to a unit vector, shape (n, 3)."""
    return np.asarray(vectors - (vectors @ axis)[:, None] * axis)


def plane_axes(axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors at right angles to an axis and to each other; x and y for the z axis."""
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = helper - (helper @ axis) * axis
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


LEAST_ROUND = 0.45  # part of the full circle that a bore covers, as in a housing split at the axis
_LEAST_INWARD_COSINE = 0.5  # least cosine between a facet's normal and the direction to the axis
_ARC_STEPS = 720
_WHOLE_BORE_ROUNDNESS = 0.9  # part of the full circle above which a bore is whole
_HALF_BORE_ROUNDNESS = 0.55  # part of the full circle below which a wall between the ends of its arc stands on its axis
_FEWEST_SECTORS = 4.99  # sectors of the full circle, of one quadrangle or two triangles each, less rounding
_LEVEL = 0.1  # largest sine between an edge that runs round a bore and the plane of its circle
_EVEN_SPANS = 1.6  # angle of the usual coarse edge over that of the narrowest that is its like
_CURVED = 1e-3  # middle of a curved edge off its chord, over its length
_EVEN_SHARE = 0.85  # part of the edges round a bore that are alike, at least
_LEAST_SMOOTH_COSINE = 0.8  # cosine between a cylinder's normal and the next facet's above which the surface runs on


@dataclass(frozen=True)
class CylindricalBore:
    """A bore found on a mesh.

    Attributes
    ----------
    center : tuple of float
        The middle of its axis [m].
    diameter, length : float
        Diameter of the circle nearest to its corner nodes, and length between its ends [m].
    roundness : float
        Part of the full circle that its facets cover, 0 to 1.
    facets : tuple of ElementBlock
        Facets of the bore.
    """

    center: tuple[float, float, float]
    diameter: float
    length: float
    roundness: float
    facets: Facets


def find_bores(mesh: Mesh, *, axis: Sequence[float] | FloatArray = (0.0, 0.0, 1.0)) -> tuple[CylindricalBore, ...]:
    """All cylindrical bores along an axis, the widest first.

    Parameters
    ----------
    mesh : Mesh
    axis : sequence of float
        Direction of the axis, of any length.

    Notes
    -----
    Each facet proposes the circle through its own corners and its neighbours'. The circles with the most proposals are
    tried first. Facets that lie on one circle all around are a bore. The round end of a slot, or a fillet, is no bore:
    its sides run on along its tangents, where the sides of a split bore end at the parting plane. Nor is a half round
    recess behind a wall through its axis, nor one of flat walls whose corners lie on a circle.
    """
    direction = unit_vector(axis)
    bores: list[CylindricalBore] = []
    assigned = np.zeros(sum(len(block) for block in mesh.boundary), dtype=bool)
    for center, radius in candidate_circles(mesh, direction):
        on = fits_circle(mesh, center, radius, direction, 2 * CIRCLE_TOLERANCE * radius) & ~assigned
        if not on.any():
            continue
        for found in joined_by_span(mesh, pick_facets(mesh.boundary, on), center, direction):
            bore = _without_walls(mesh, found, direction)
            if bore.roundness < LEAST_ROUND or any(_same(bore, other, direction) for other in bores):
                continue
            if _is_divided_as_a_circle(mesh, bore, direction) and not _runs_on(mesh, bore, direction):
                bores.append(bore)
        assigned |= on
    return tuple(sorted(bores, key=lambda bore: (-round(bore.diameter, 7), [round(x, 7) for x in bore.center])))


def _runs_on(mesh: Mesh, bore: CylindricalBore, axis: FloatArray) -> bool:
    """Whether the surface goes on along its tangents beyond the ends of the arc of a bore that is not round.

    At an end the neighbouring facet then looks towards the axis, as the cylinder itself does there; where a bore is
    split it looks along the arc. A wall that closes a half bore has corners between the ends of its arc.
    """
    if bore.roundness >= _WHOLE_BORE_ROUNDNESS:
        return False
    normals = facet_normals(mesh.points, mesh.boundary)
    inside = np.zeros(len(mesh.points), dtype=bool)
    inside[facet_corners(bore.facets)] = True
    own = {tuple(corners) for block in bore.facets for corners in block.corners.tolist()}
    smooth, start = list[bool](), 0
    for block in mesh.boundary:
        on = inside[block.corners]
        block_normals = normals[start : start + len(block)]
        start += len(block)
        # Neighbours share an edge with the bore.
        sideways = np.abs(block_normals @ axis) < LARGEST_COSINE_TO_AXIS
        for facet in np.flatnonzero((on.sum(axis=1) >= 2) & sideways):
            if tuple(block.corners[facet].tolist()) in own:
                continue
            arms = across(mesh.points[block.corners[facet]] - np.asarray(bore.center), axis)
            shared = arms[on[facet]]
            inward = -(shared / np.linalg.norm(shared, axis=1)[:, None]).mean(axis=0)
            within = float(np.linalg.norm(arms.mean(axis=0))) < (0.5 - CIRCLE_TOLERANCE) * bore.diameter
            is_wall = within and bore.roundness < _HALF_BORE_ROUNDNESS
            smooth.append(is_wall or bool(block_normals[facet] @ inward > _LEAST_SMOOTH_COSINE))
    return bool(smooth) and 2 * sum(smooth) > len(smooth)


def _without_walls(mesh: Mesh, bore: CylindricalBore, axis: FloatArray) -> CylindricalBore:
    """Leave out facets with edges so wide that they are walls, unless the others are a whole bore by themselves."""
    spans = _level_spans(mesh, bore.facets, bore.center, axis).max(axis=1)
    narrow = pick_facets(bore.facets, spans < _WIDEST_EDGE)
    if not narrow or _roundness(mesh, narrow, np.asarray(bore.center), axis) >= _WHOLE_BORE_ROUNDNESS:
        return bore
    return _bore(mesh, narrow, np.asarray(bore.center), axis)


def _is_divided_as_a_circle(mesh: Mesh, bore: CylindricalBore, axis: FloatArray) -> bool:
    """Whether a bore's facets are enough for a circle, and divide it evenly where they are so coarse as to be walls."""
    sectors = sum(len(block) * (0.5 if block.corners.shape[1] == 3 else 1.0) for block in bore.facets)
    if sectors < _FEWEST_SECTORS * bore.roundness:
        return False
    spans = np.sort(_level_spans(mesh, bore.facets, bore.center, axis), axis=None)
    spans = spans[spans < _WIDEST_EDGE]
    total = float(spans.sum())
    if total == 0.0:
        return True
    # Half of the edges' angles together are of narrower ones.
    usual = float(spans[np.searchsorted(np.cumsum(spans), 0.5 * total)])
    if 1.0 - np.cos(0.5 * usual) <= 2.0 * CIRCLE_TOLERANCE:
        return True
    if _is_curved(mesh):
        return _rise_of_middles(mesh, bore, axis) > 0.5
    return float(spans[spans > usual / _EVEN_SPANS].sum()) >= _EVEN_SHARE * total


def fits_circle(
    mesh: Mesh, center: Sequence[float] | FloatArray, radius: float, axis: FloatArray, slack: float
) -> BoolArray:
    """Whether each boundary facet lies on a cylinder with all corners and looks towards its axis, shape (n_facets,).

    Parameters
    ----------
    mesh : Mesh
    center : sequence of float
        A point of the axis [m].
    radius, slack : float
        Radius of the cylinder, and largest distance of a corner from it [m].
    axis : ndarray, shape (3,)
        Unit vector.
    """
    arms = across(mesh.points - np.asarray(center), axis)
    near = np.abs(np.linalg.norm(arms, axis=1) - radius) <= slack
    on = np.concatenate([near[block.corners].all(axis=1) for block in mesh.boundary])
    # Few facets have their corners on the cylinder: only these are examined, since hundreds of circles are tried.
    few = pick_facets(mesh.boundary, on)
    normals = facet_normals(mesh.points, few)
    inward = -across(facet_centers(mesh.points, few) - np.asarray(center), axis)
    facing = np.einsum("fi,fi->f", normals, inward) > _LEAST_INWARD_COSINE * np.linalg.norm(inward, axis=1)
    on[on] = facing & (np.abs(normals @ axis) < LARGEST_COSINE_TO_AXIS)
    return on


def joined_by_span(
    mesh: Mesh, facets: Facets, center: Sequence[float] | FloatArray, axis: FloatArray
) -> tuple[CylindricalBore, ...]:
    """Facets of one cylinder as bores: parts that touch, or that lie side by side at the same height, are one.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
        Facets as chosen by :func:`fits_circle`.
    center : sequence of float
        A point of the cylinder's axis [m].
    axis : ndarray, shape (3,)
        Unit vector.
    """
    part = _connected(facets)
    heights = (mesh.points - np.asarray(center)) @ axis
    low = np.concatenate([heights[block.corners].min(axis=1) for block in facets])
    high = np.concatenate([heights[block.corners].max(axis=1) for block in facets])
    spans = sorted(
        (float(low[part == number].min()), float(high[part == number].max()), number) for number in np.unique(part)
    )
    groups: list[tuple[float, float, list[int]]] = []
    for begin, end, number in spans:
        if groups:
            first, last, members = groups[-1]
            if min(end, last) - begin > 0.5 * min(end - begin, last - first):
                groups[-1] = (first, max(last, end), [*members, number])
                continue
        groups.append((begin, end, [number]))
    return tuple(
        _bore(mesh, pick_facets(facets, np.isin(part, members)), np.asarray(center), axis) for _, _, members in groups
    )


def describe_bore(bore: CylindricalBore) -> str:
    """Describe a bore in words: diameter, middle and length in mm."""
    place = ", ".join(f"{round(1e3 * value, 3) + 0.0:.6g}" for value in bore.center)
    return f"{1e3 * bore.diameter:.5g} mm at ({place}) mm, {1e3 * bore.length:.4g} mm long"


def unit_vector(axis: Sequence[float] | FloatArray) -> FloatArray:
    """Normalise an axis to length 1.

    Raises
    ------
    GeometryError
        Where it has no length.
    """
    direction = np.asarray(axis, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    if not 0.0 < length < np.inf:
        raise GeometryError(f"axis {tuple(axis)} has no direction")
    return direction / length


def _bore(mesh: Mesh, facets: Facets, center: FloatArray, axis: FloatArray) -> CylindricalBore:
    """Fit the cylindrical bore of some facets to their corners."""
    arms = mesh.points[facet_corners(facets)] - center
    first, second = plane_axes(axis)
    (u, v), radius = fit_circle(np.stack([arms @ first, arms @ second], axis=1))
    heights = arms @ axis
    middle = center + u * first + v * second + (heights.min() + heights.max()) / 2 * axis
    x, y, z = (float(value) for value in middle)
    return CylindricalBore(
        center=(x, y, z),
        diameter=2 * radius,
        length=float(np.ptp(heights)),
        roundness=_roundness(mesh, facets, middle, axis),
        facets=facets,
    )


def _corner_angles(mesh: Mesh, facets: Facets, center: Sequence[float] | FloatArray, axis: FloatArray) -> FloatArray:
    """Azimuths of four corners of each facet about an axis, the last of a triangle twice, (n_facets, 4) [rad]."""
    first, second = plane_axes(axis)
    arms = mesh.points - np.asarray(center)
    angles = np.arctan2(arms @ second, arms @ first)
    return np.concatenate([np.zeros((0, 4)), *(angles[block.corners[:, [0, 1, 2, -1]]] for block in facets)])


def _short_way(angles: FloatArray) -> FloatArray:
    """Angles from -π to below π [rad]."""
    return np.asarray(np.mod(angles + np.pi, 2 * np.pi) - np.pi)


def _level_spans(mesh: Mesh, facets: Facets, center: Sequence[float] | FloatArray, axis: FloatArray) -> FloatArray:
    """Angles of the circle under those edges of each facet that run round it, others 0, (n_facets, 4) [rad]."""
    angles = _corner_angles(mesh, facets, center, axis)
    points = np.concatenate([np.zeros((0, 4, 3)), *(mesh.points[block.corners[:, [0, 1, 2, -1]]] for block in facets)])
    edges = np.roll(points, -1, axis=1) - points
    is_level = np.abs(edges @ axis) <= _LEVEL * np.linalg.norm(edges, axis=2)
    return np.asarray(np.where(is_level, np.abs(_short_way(np.roll(angles, -1, axis=1) - angles)), 0.0))


def _middles(facets: Facets) -> list[tuple[IntArray, IntArray, IntArray]]:
    """Nodes at both ends and in the middle of each edge of facets of second order, (n_edges,) each, block by block."""
    found = []
    for block in facets:
        corners = block.corners
        if block.nodes.shape[1] > corners.shape[1]:
            middle = block.nodes[:, corners.shape[1] : 2 * corners.shape[1]]
            found.append((corners.ravel(), np.roll(corners, -1, axis=1).ravel(), middle.ravel()))
    return found


def _is_curved(mesh: Mesh) -> bool:
    """Whether the middle of any edge on the surface is off its chord."""
    return any(
        bool(np.any(np.linalg.norm(off, axis=1) > _CURVED * np.linalg.norm(chord, axis=1)))
        for begin, end, middle in _middles(mesh.boundary)
        for chord in [mesh.points[end] - mesh.points[begin]]
        for off in [mesh.points[middle] - mesh.points[begin] - 0.5 * chord]
    )


def _rise_of_middles(mesh: Mesh, bore: CylindricalBore, axis: FloatArray) -> float:
    """Median rise of the middles of a bore's level edges above their chords over the sagitta; 1 on the circle."""
    rises = [np.zeros(0)]
    for begin, end, middle in _middles(bore.facets):
        chord = mesh.points[end] - mesh.points[begin]
        level = np.abs(chord @ axis) <= _LEVEL * np.linalg.norm(chord, axis=1)
        half, at = 0.5 * (mesh.points[begin] + mesh.points[end])[level], mesh.points[middle][level]
        on_chord, found = (np.linalg.norm(across(x - np.asarray(bore.center), axis), axis=1) for x in (half, at))
        rises.append((found - on_chord) / np.maximum(0.5 * bore.diameter - on_chord, 1e-12))
    return float(np.median(np.concatenate(rises)))


def _roundness(mesh: Mesh, facets: Facets, center: FloatArray, axis: FloatArray) -> float:
    """Part of the circle that the facets cover, each from its first to its last corner."""
    covered = np.zeros(_ARC_STEPS, dtype=bool)
    steps = np.arange(_ARC_STEPS)
    angles = _corner_angles(mesh, facets, center, axis)
    turned = _short_way(angles - angles[:, :1])
    ends = (angles[:, :1] + np.stack([turned.min(axis=1), turned.max(axis=1)], axis=1)) * _ARC_STEPS / (2 * np.pi)
    begin = np.floor(ends[:, 0] + 1e-6).astype(np.int64)
    width = np.ceil(ends[:, 1] - 1e-6).astype(np.int64) - begin
    for start, length in set(zip(begin.tolist(), width.tolist(), strict=True)):
        covered[(start + steps[:length]) % _ARC_STEPS] = True
    return float(covered.mean())


def _connected(facets: Facets) -> IntArray:
    """Label the connected part of each facet; facets that share a node are connected."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    nodes = facet_corners(facets)
    facet, node, start = [], [], 0
    for block in facets:
        facet.append(np.repeat(np.arange(start, start + len(block)), block.corners.shape[1]))
        node.append(np.searchsorted(nodes, block.corners).ravel())
        start += len(block)
    rows, columns = np.concatenate(facet), start + np.concatenate(node)
    size = start + len(nodes)
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(size, size)).tocsr()
    _, part = connected_components(graph, directed=False)
    return np.asarray(part[:start], dtype=np.int64)


def _same(bore: CylindricalBore, other: CylindricalBore, axis: FloatArray) -> bool:
    """Whether two bores are one, found by two circles that both fit."""
    gap = np.subtract(bore.center, other.center)
    apart = float(np.linalg.norm(across(gap[None], axis)))
    slack = 2 * CIRCLE_TOLERANCE * bore.diameter
    overlap = (bore.length + other.length) / 2 - abs(float(gap @ axis))
    return apart < slack and abs(bore.diameter - other.diameter) < slack and overlap > 0.5 * bore.length
