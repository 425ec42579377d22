"""Mesh diagnosis: the defects of a mesh by name, with their places and remedies.

Conformity: neighbouring elements share the nodes of their common edges, and no node lies within a facet. Connectivity:
the bodies of the mesh, and the places where elements are not connected as they should be.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from gearwhine.meshes.elements import facet_corners, group_rows
from gearwhine.meshes.lengths import UNITS, length_text, plausible
from gearwhine.meshes.mesh import Mesh, MeshDefect, Severity, mesh_defect, place_text
from gearwhine.meshes.quality import edge_lengths, shape_numbers
from gearwhine.meshes.shape_functions import determinants, jacobians, quadrature, shape_functions
from gearwhine.numerics.arrays import FloatArray, IntArray

_COINCIDENCE_DISTANCE = 1e-6  # part of a facet's longest side: nodes nearer than that coincide, or lie in its plane


@dataclass(frozen=True)
class Touching:
    """Places where the surface touches itself without sharing nodes.

    Attributes
    ----------
    across : ndarray of int
        Corners of the surface at the place of a corner of another body.
    within : ndarray of int
        Corners of the surface at the place of another corner of the same body.
    hanging : ndarray of int
        Hanging nodes: corners of the surface within facets of other elements, at none of their corners.
    between_bodies : bool
        Whether all hanging nodes lie within facets of another body.
    """

    across: IntArray
    within: IntArray
    hanging: IntArray
    between_bodies: bool


def unequal_edges(mesh: Mesh) -> IntArray:
    """Corners of edges that have a middle node in one element and none, or another, in the next, shape (n, 2)."""
    ends, middles = [], []
    for block in mesh.blocks:
        corners, local = block.of.edges, np.array(block.of.places)
        edge = block.nodes[:, corners]
        if block.of.order == 2:
            halfway = local[corners].mean(axis=1)
            middle = np.argmin(np.abs(halfway[:, None] - local[None]).max(axis=2), axis=1)
            middles.append(block.nodes[:, middle].ravel())
        else:
            middles.append(np.full(edge.shape[0] * edge.shape[1], -1))
        ends.append(np.sort(edge.reshape(-1, 2), axis=1))
    together, middle_node = np.concatenate(ends), np.concatenate(middles)
    if len(mesh.blocks) == 1 and mesh.order == 1:
        return np.empty((0, 2), dtype=np.int64)
    number = group_rows(together)
    highest, lowest = np.full(number.max() + 1, -2), np.full(number.max() + 1, len(mesh.points))
    np.maximum.at(highest, number, middle_node)
    np.minimum.at(lowest, number, middle_node)
    _, first = np.unique(number, return_index=True)
    return np.asarray(together[first[highest != lowest]])


def covered_quadrilaterals(mesh: Mesh) -> IntArray:
    """Corners of quadrilaterals of the surface that lie on triangles with the same corners, shape (n, 4)."""
    quads = [block.corners for block in mesh.boundary if block.of.n_corners == 4]
    triangles = [block.corners for block in mesh.boundary if block.of.n_corners == 3]
    if not quads or not triangles:
        return np.empty((0, 4), dtype=np.int64)
    corners, triangle_corners = np.concatenate(quads), np.sort(np.concatenate(triangles), axis=1)
    halves = np.sort(corners[:, [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]]], axis=2)
    numbers = group_rows(np.concatenate([triangle_corners, halves.reshape(-1, 3)]))
    covered = np.isin(numbers[len(triangle_corners) :], numbers[: len(triangle_corners)]).reshape(-1, 4).any(axis=1)
    return np.asarray(corners[covered])


def touching_nodes(mesh: Mesh, body: IntArray, assembly: IntArray) -> Touching:
    """Find where parts of the surface lie on each other without sharing nodes, unless joints connect their bodies.

    Corners alone are compared with facets, which are taken as plane triangles between their corners: where curved
    facets conform, no corner lies within another facet.
    """
    from scipy.spatial import KDTree

    corners = facet_corners(mesh.boundary)
    tree = KDTree(mesh.points[corners])
    of_node = _body_of_nodes(mesh, body)
    triangles = np.concatenate(
        [block.nodes[:, triangle] for block in mesh.boundary for triangle in block.of.corner_triangles]
    )
    places = mesh.points[triangles]
    middle = places.mean(axis=1)
    reach = np.linalg.norm(places - middle[:, None], axis=2).max(axis=1)
    near = tree.query_ball_point(middle, reach * (1.0 + _COINCIDENCE_DISTANCE))
    lengths = np.array([len(found) for found in near])
    which = np.repeat(np.arange(len(triangles)), lengths)
    node = corners[np.concatenate([np.asarray(found, dtype=np.int64) for found in near])]
    first, second = of_node[triangles[which, 0]], of_node[node]
    joined = (first != second) & (assembly[first] == assembly[second])
    foreign = (triangles[which] != node[:, None]).all(axis=1) & ~joined
    which, node, other = which[foreign], node[foreign], (first != second)[foreign]
    within, at_corner = _within(places[which], mesh.points[node])
    # Where a facet's own corner is at the place, the nodes coincide and hang nowhere.
    matched = np.zeros(len(mesh.points), dtype=bool)
    matched[node[at_corner]] = True
    hanging = within & ~at_corner & ~matched[node]
    return Touching(
        across=_places(mesh.points, node[at_corner & other]),
        within=_places(mesh.points, node[at_corner & ~other]),
        hanging=np.unique(node[hanging]),
        between_bodies=bool(other[hanging].all()),
    )


def _places(points: FloatArray, nodes: IntArray) -> IntArray:
    """One node for each place at which some nodes lie."""
    nodes = np.unique(nodes)
    if not len(nodes):
        return nodes
    extent = max(float(np.ptp(points[nodes], axis=0).max()), 1e-300)
    _, first = np.unique(np.round(points[nodes] / (_COINCIDENCE_DISTANCE * extent)), axis=0, return_index=True)
    return np.asarray(nodes[np.sort(first)])


def _within(triangles: FloatArray, points: FloatArray) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Whether each point lies in its triangle, and whether at a corner of it."""
    a, first, second = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(first, second)
    doubled = np.linalg.norm(normal, axis=1)
    size = np.sqrt(np.maximum((first**2).sum(axis=1), (second**2).sum(axis=1)))
    flat = doubled <= 1e-12 * size**2
    safe = np.where(flat, 1.0, doubled)
    arm = points - a
    height = np.abs((arm * normal).sum(axis=1)) / safe
    u = (np.cross(arm, second) * normal).sum(axis=1) / safe**2
    v = (np.cross(first, arm) * normal).sum(axis=1) / safe**2
    inside = (
        ~flat
        & (u > -_COINCIDENCE_DISTANCE)
        & (v > -_COINCIDENCE_DISTANCE)
        & (u + v < 1.0 + _COINCIDENCE_DISTANCE)
        & (height < _COINCIDENCE_DISTANCE * size)
    )
    apart = np.linalg.norm(triangles - points[:, None], axis=2).min(axis=1)
    return inside, apart < _COINCIDENCE_DISTANCE * size


_MOST_LISTED_BODIES = 5  # bodies that a message lists one by one


def bodies(mesh: Mesh) -> IntArray:
    """Body of each element, 0 the largest; elements that share a node are of one body.

    Returns
    -------
    ndarray of int, shape (n_elements,)
    """
    return _parts(mesh, mesh.incidence)


def connection_defects(mesh: Mesh, joined: Sequence[IntArray] = ()) -> Iterator[MeshDefect]:
    """Find the defects of a mesh's connectivity, with the nodes of each joint as in :func:`diagnose`."""
    yield from _faces(mesh)
    body = bodies(mesh)
    assembly = _assemblies(mesh, body, joined)
    mismatches = [*_conformity(mesh, body, assembly)]
    yield from mismatches
    yield from _bodies(mesh, assembly[body], "share no node and no joint" if joined else "share no node")
    if not any(mismatch.name == "non-conforming" for mismatch in mismatches):
        yield from _hinges(mesh, body)


def _parts(mesh: Mesh, shared: sparse.csr_array) -> IntArray:
    """Label the connected parts of the mesh, from the largest down.

    ``shared`` is the incidence of elements and nodes, or of elements and faces, by which they are connected.
    """
    both = sparse.block_array([[None, shared], [shared.T, None]], format="csr", dtype=np.int8)
    _, labels = connected_components(both, directed=False)
    return _ranked(mesh, labels[: mesh.n_elements])


def _ranked(mesh: Mesh, labels: npt.NDArray[np.integer]) -> IntArray:
    """Renumber the labels of elements, that of the largest volume as 0."""
    _, part = np.unique(labels, return_inverse=True)
    size = np.bincount(part, mesh.corner_volumes)
    rank = np.empty(len(size), dtype=np.int64)
    rank[np.argsort(-size, kind="stable")] = np.arange(len(size))
    return np.asarray(rank[part])


def _body_of_nodes(mesh: Mesh, body: IntArray) -> IntArray:
    of_node = np.zeros(len(mesh.points), dtype=np.int64)
    for block, members in zip(mesh.blocks, np.split(body, mesh.block_ends), strict=True):
        of_node[block.nodes] = members[:, None]
    return of_node


def _assemblies(mesh: Mesh, body: IntArray, joined: Sequence[IntArray]) -> IntArray:
    """Find the assembly of each body, the largest 0: bodies that joints connect, one after the other."""
    of_node, count = _body_of_nodes(mesh, body), int(body.max()) + 1
    ends = [np.unique(of_node[nodes]) for nodes in joined]
    first = np.concatenate([np.empty(0, dtype=np.int64), *(np.broadcast_to(end[:1], len(end)) for end in ends)])
    second = np.concatenate([np.empty(0, dtype=np.int64), *ends])
    graph = sparse.coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    assembly = np.empty(count, dtype=np.int64)
    assembly[body] = _ranked(mesh, labels[body])
    return assembly


def _faces(mesh: Mesh) -> Iterator[MeshDefect]:
    """Faces of more than two elements, and pairs of elements on the same side of one."""
    table = mesh.faces
    crowded = np.flatnonzero(table.sharing > 2)
    if len(crowded):
        number = len(np.unique(table.number[crowded]))
        place = mesh.points[table.corners[crowded[0], :3]].mean(axis=0)
        finding = f"{number} facets are shared by three or more elements"
        advice = "elements lie in each other, perhaps twice in the file; remove the surplus ones"
        yield mesh_defect("non-manifold", "error", finding, advice, number, place)
    paired = np.flatnonzero(table.sharing == 2)
    pairs = paired[np.argsort(table.number[paired], kind="stable")].reshape(-1, 2)
    same = _turn(table.corners[pairs[:, 0]]) == _turn(table.corners[pairs[:, 1]])
    if same.any():
        number = int(same.sum())
        place = mesh.points[table.corners[pairs[np.argmax(same), 0], :3]].mean(axis=0)
        finding = f"at {number} facets both elements lie on the same side"
        advice = "one of each is turned inside out or folded over its neighbour; mesh anew"
        yield mesh_defect("overlapping", "error", finding, advice, number, place)


def _turn(corners: IntArray) -> npt.NDArray[np.bool_]:
    """Sense in which facets turn: whether after the least corner comes the smaller of its neighbours."""
    rows = np.arange(len(corners))
    count = np.where(corners[:, 3] < 0, 3, 4)
    least = np.argmin(np.where(corners < 0, np.iinfo(np.int64).max, corners), axis=1)
    after, before = corners[rows, (least + 1) % count], corners[rows, (least - 1) % count]
    return np.asarray(after < before)


def _bodies(mesh: Mesh, body: IntArray, which: str) -> Iterator[MeshDefect]:
    """Several disconnected bodies, or assemblies of bodies."""
    count = int(body.max()) + 1
    if count > 1:
        sizes = np.bincount(body, mesh.corner_volumes)
        middles = [
            mesh.centers[body == number].mean(axis=0) for number in range(1, min(count, 1 + _MOST_LISTED_BODIES))
        ]
        listed = ", ".join(
            f"one of {100 * sizes[number] / sizes.sum():.3g} % of the volume around {place_text(middle)}"
            for number, middle in enumerate(middles, start=1)
        )
        more = f" and {count - 1 - _MOST_LISTED_BODIES} more" if count > 1 + _MOST_LISTED_BODIES else ""
        finding = f"the mesh falls into {count} bodies that {which}: beside the largest {listed}{more}"
        yield MeshDefect("disconnected", "warning", f"{finding}; what joins them?", count, middles[0])


def _hinges(mesh: Mesh, body: IntArray) -> Iterator[MeshDefect]:
    """Parts that are connected by an edge or a node alone."""
    faces = mesh.faces
    ones = np.ones(len(faces.number), dtype=np.int8)
    shape = (mesh.n_elements, int(faces.number.max()) + 1)
    part = _parts(mesh, sparse.csr_array((ones, (faces.element, faces.number)), shape=shape))
    parts, count = int(part.max()) + 1, int(body.max()) + 1
    if parts > count:
        finding = f"{parts - count} parts hang on by an edge or a node alone"
        advice = "they turn about it as about a hinge; let them share facets"
        middle = mesh.centers[part == parts - 1].mean(axis=0)
        yield mesh_defect("hinged", "warning", finding, advice, parts - count, middle, which="the smallest around")


def _conformity(mesh: Mesh, body: IntArray, assembly: IntArray) -> Iterator[MeshDefect]:
    """Neighbours that touch and do not share their nodes, unless joints connect them."""
    unequal = unequal_edges(mesh)
    if len(unequal):
        finding = f"{len(unequal)} edges have a middle node in one element and not in its neighbour"
        advice = "elements of order 1 and 2 do not fit each other; use one order"
        yield mesh_defect(
            "non-conforming", "error", finding, advice, len(unequal), mesh.points[unequal[0]].mean(axis=0)
        )
    covered = covered_quadrilaterals(mesh)
    if len(covered):
        finding = f"{len(covered)} quadrilaterals lie on triangles"
        advice = "bricks do not fit tetrahedra, nor the ends of wedges; use one kind, or join them along matching faces"
        yield mesh_defect(
            "non-conforming", "error", finding, advice, len(covered), mesh.points[covered[0]].mean(axis=0)
        )
    touching = touching_nodes(mesh, body, assembly)
    if number := len(touching.across):
        finding = f"the mesh falls into {assembly.max() + 1} bodies whose nodes coincide at {number} places"
        advice = "merge them, unless the bodies are meant to be loose"
        yield mesh_defect("disconnected", "error", finding, advice, number, mesh.points[touching.across[0]])
    if number := len(touching.within):
        finding = f"nodes coincide at {number} places of one body and are not joined"
        advice = "merge them, unless a slit is meant"
        yield mesh_defect("slit", "warning", finding, advice, number, mesh.points[touching.within[0]])
    if number := len(touching.hanging):
        finding = f"{number} nodes lie within facets that they are no part of"
        advice = "the elements on both sides do not match and are not joined; mesh them together"
        severity: Severity = "warning" if touching.between_bodies else "error"
        yield mesh_defect("non-conforming", severity, finding, advice, number, mesh.points[touching.hanging[0]])


LEAST_SHAPE = 0.05
"""Shape number below which an element spoils the stresses around it."""

# Size of a housing [m]; of several possible units, the one that comes nearest to it is proposed.
_LIKELY_HOUSING_SIZE = 0.5
_NO_VOLUME = 1e-9  # least volume, as a part of the cube of an element's longest edge


def diagnose(mesh: Mesh, *, unit: float | None = None, joined: Sequence[IntArray] = ()) -> tuple[MeshDefect, ...]:
    """Find the defects of a mesh, errors first.

    Parameters
    ----------
    mesh : Mesh
    unit : float, optional
        The unit of length of the file that it came from [m]; with it, implausible sizes are reported too.
    joined : sequence of ndarray of int
        Nodes of each joint. Bodies that joints connect, one after the other, may touch without sharing nodes.

    Notes
    -----
    Inverted and flat elements are not among them, because :class:`Mesh` refuses them.
    """
    defects = [*_elements(mesh), *connection_defects(mesh, joined), *_nodes(mesh), *_unit(mesh, unit)]
    return tuple(sorted(defects, key=lambda one: one.severity != "error"))


def _elements(mesh: Mesh) -> Iterator[MeshDefect]:
    """Elements that are degenerate, folded, or of a bad shape."""
    repeats, edges, least, least_at_nodes = [], [], [], []
    for block in mesh.blocks:
        ordered = np.sort(block.nodes, axis=1)
        repeats.append((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
        edges.append(edge_lengths(mesh.points, block).max(axis=1))
        least.append(_least_determinant(mesh, block.nodes, block.kind, quadrature(block.kind, 2 * block.of.order)[0]))
        at_nodes = np.array(block.of.places, dtype=np.float64).T
        least_at_nodes.append(_least_determinant(mesh, block.nodes, block.kind, at_nodes))
    repeated, shape = np.concatenate(repeats), shape_numbers(mesh)
    flat = (mesh.corner_volumes < _NO_VOLUME * np.concatenate(edges) ** 3) & ~repeated
    folded = (np.concatenate(least) <= 0.0) & ~repeated & ~flat
    creased = (np.concatenate(least_at_nodes) <= 0.0) & ~repeated & ~flat & ~folded
    bad = (shape < LEAST_SHAPE) & ~repeated & ~flat
    cases: tuple[tuple[npt.NDArray[np.bool_], str, Severity, str, str], ...] = (
        (repeated, "degenerate", "error", "name a node twice", "write collapsed bricks as wedges or tetrahedra"),
        (flat, "degenerate", "error", "have next to no volume", "remove them or mesh anew"),
        (folded, "folded", "error", "are folded by their middle nodes", "refine where it is curved, or use order 1"),
        (creased, "folded", "warning", "are folded at a node by their middle nodes", "refine where it is curved"),
    )
    for which, name, severity, finding, advice in cases:
        if which.any():
            number = int(which.sum())
            yield mesh_defect(
                name, severity, f"{number} elements {finding}", advice, number, mesh.centers[np.argmax(which)]
            )
    if bad.any():
        worst, number = int(np.argmin(np.where(bad, shape, np.inf))), int(bad.sum())
        finding = f"{number} elements have a shape number below {LEAST_SHAPE} (1 is ideal, 0 is flat)"
        advice = "mesh anew with a smaller or more even size there"
        which_one = f"the worst with {shape[worst]:.2g} at"
        yield mesh_defect("shape", "warning", finding, advice, number, mesh.centers[worst], which=which_one)


def _least_determinant(mesh: Mesh, nodes: IntArray, kind: str, places: FloatArray) -> FloatArray:
    """Compute the least Jacobian determinant of each element at some reference places, shape (n_elements,)."""
    gradients = shape_functions(kind, places)[1]
    return np.asarray(determinants(jacobians(mesh.points, nodes, gradients)).min(axis=1))


def _nodes(mesh: Mesh) -> Iterator[MeshDefect]:
    unused = np.setdiff1d(np.arange(len(mesh.points)), mesh.used_nodes)
    if len(unused):
        finding = f"{len(unused)} nodes belong to no element"
        yield mesh_defect("unused nodes", "error", finding, "leave them out", len(unused), mesh.points[unused[0]])


def _unit(mesh: Mesh, unit: float | None) -> Iterator[MeshDefect]:
    """Implausible sizes of a housing, with the unit that would make them plausible."""
    length = float(np.ptp(mesh.bounds, axis=0).max())
    if unit is None or plausible(length):
        return
    name = next((name for name, value in UNITS.items() if np.isclose(value, unit)), f"{unit:g} m")
    other = {other: length / unit * value for other, value in UNITS.items() if other != name}
    believed = sorted(
        (other for other, size in other.items() if plausible(size)),
        key=lambda name: abs(np.log(other[name] / _LIKELY_HOUSING_SIZE)),
    )
    message = f"the part is {length_text(length)} long; is the unit {name!r}?"
    if believed:
        message += f" With {believed[0]!r} it would be {length_text(other[believed[0]])}"
    yield MeshDefect("unit", "warning", message, 1, mesh.bounds.mean(axis=0))
