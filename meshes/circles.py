"""Circles fitted to the surface of a mesh: candidates for bores, proposed by facets and their neighbours."""

import numpy as np

from meshes.elements import Facets, FloatArray, IntArray, facet_centers, facet_normals
from meshes.mesh import Mesh

SIDEWAYS = 0.5  # largest cosine between the axis and a facet's normal: chords of coarse meshes are askew
SLACK = 0.01  # corners of a bore may be off its circle by this part of its diameter
_SHARPEST = np.cos(np.radians(75.0))  # neighbours of a bore of five or more facets turn by less
_LOCAL_FIT = 0.02  # corners of neighbours may be off their circle by this part of its radius
_MOST_CIRCLES = 500
_FEWEST_FACETS = 3  # that must propose a circle before it is tried


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
        A point of each one's axis and its radius [m].
    """
    boundary = mesh.boundary
    centers, normals = facet_centers(mesh.points, boundary), facet_normals(mesh.points, boundary)
    sideways = np.abs(normals @ axis) < SIDEWAYS
    corners = np.concatenate([block.corners[:, [0, 1, 2, -1]] for block in boundary])
    pairs = _edge_neighbors(boundary)
    one, two = pairs[:, 0], pairs[:, 1]
    # Neighbours round a bore lie in front of each other, and turn, but not by a corner.
    step = centers[two] - centers[one]
    hollow = np.minimum(np.einsum("pi,pi->p", normals[one], step), -np.einsum("pi,pi->p", normals[two], step))
    turn = np.einsum("pi,pi->p", normals[one], normals[two])
    linked = sideways[one] & sideways[two] & (turn > _SHARPEST)
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
    """Circles that agree to their slack, as their medians, those with the most proposals first."""
    if len(radii) == 0:
        return []
    size = np.exp(np.round(np.log(radii) / 0.05) * 0.05)  # bins of the same width for radii of the same size
    bins = np.stack([places @ first / size, places @ second / size, radii / size], axis=1) / (2 * SLACK)
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
    """As :func:`fit_circle` for many sets, shape (n, n_points, 2); not finite where points are in line."""
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
