"""Connectivity of a mesh: its bodies, and the defects where elements are not connected as they should be."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from meshes.ailments import MeshDefect, Severity, mesh_defect, place_text
from meshes.elements import IntArray
from meshes.matching import covered_quadrilaterals, touching_nodes, unequal_edges
from meshes.mesh import Mesh

_LISTED = 5  # bodies that a message lists one by one


def bodies(mesh: Mesh) -> IntArray:
    """Body of each element, 0 the largest; elements that share a node are of one body.

    Returns
    -------
    ndarray of int, shape (n_elements,)
    """
    return _parts(mesh, mesh.incidence)


def connection_defects(mesh: Mesh) -> Iterator[MeshDefect]:
    """Find the defects of a mesh's connectivity."""
    yield from _faces(mesh)
    body = bodies(mesh)
    mismatches = [*_conformity(mesh, body)]
    yield from mismatches
    yield from _bodies(mesh, body)
    if not any(one.name == "non-conforming" for one in mismatches):
        yield from _hinges(mesh, body)


def _parts(mesh: Mesh, shared: sparse.csr_array) -> IntArray:
    """Label the connected parts of the mesh, from the largest down.

    ``shared`` is the incidence of elements and nodes, or of elements and faces, by which they are connected.
    """
    both = sparse.block_array([[None, shared], [shared.T, None]], format="csr", dtype=np.int8)
    _, labels = connected_components(both, directed=False)
    _, part = np.unique(labels[: mesh.n_elements], return_inverse=True)
    size = np.bincount(part, mesh.corner_volumes)
    rank = np.empty(len(size), dtype=np.int64)
    rank[np.argsort(-size, kind="stable")] = np.arange(len(size))
    return np.asarray(rank[part])


def _faces(mesh: Mesh) -> Iterator[MeshDefect]:
    """Faces of more than two elements, and pairs of elements on the same side of one."""
    table = mesh.faces
    crowded = np.flatnonzero(table.sharing > 2)
    if len(crowded):
        number = len(np.unique(table.number[crowded]))
        place = mesh.points[table.corners[crowded[0], :3]].mean(axis=0)
        what = f"{number} facets are shared by three or more elements"
        advice = "elements lie in each other, perhaps twice in the file; remove the surplus ones"
        yield mesh_defect("non-manifold", "error", what, advice, number, place)
    paired = np.flatnonzero(table.sharing == 2)
    pairs = paired[np.argsort(table.number[paired], kind="stable")].reshape(-1, 2)
    same = _turn(table.corners[pairs[:, 0]]) == _turn(table.corners[pairs[:, 1]])
    if same.any():
        number = int(same.sum())
        place = mesh.points[table.corners[pairs[np.argmax(same), 0], :3]].mean(axis=0)
        what = f"at {number} facets both elements lie on the same side"
        advice = "one of each is turned inside out or folded over its neighbour; mesh anew"
        yield mesh_defect("overlapping", "error", what, advice, number, place)


def _turn(corners: IntArray) -> npt.NDArray[np.bool_]:
    """Sense in which facets turn: whether after the least corner comes the smaller of its neighbours."""
    rows = np.arange(len(corners))
    count = np.where(corners[:, 3] < 0, 3, 4)
    least = np.argmin(np.where(corners < 0, np.iinfo(np.int64).max, corners), axis=1)
    after, before = corners[rows, (least + 1) % count], corners[rows, (least - 1) % count]
    return np.asarray(after < before)


def _bodies(mesh: Mesh, body: IntArray) -> Iterator[MeshDefect]:
    """Several disconnected bodies."""
    count = int(body.max()) + 1
    if count > 1:
        sizes = np.bincount(body, mesh.corner_volumes)
        middles = [mesh.centers[body == number].mean(axis=0) for number in range(1, min(count, 1 + _LISTED))]
        listed = ", ".join(
            f"one of {100 * sizes[number] / sizes.sum():.3g} % of the volume around {place_text(middle)}"
            for number, middle in enumerate(middles, start=1)
        )
        more = f" and {count - 1 - _LISTED} more" if count > 1 + _LISTED else ""
        what = f"the mesh falls into {count} bodies that share no node: beside the largest {listed}{more}"
        yield MeshDefect("disconnected", "warning", f"{what}; what joins them?", count, middles[0])


def _hinges(mesh: Mesh, body: IntArray) -> Iterator[MeshDefect]:
    """Parts that are connected by an edge or a node alone."""
    faces = mesh.faces
    ones = np.ones(len(faces.number), dtype=np.int8)
    shape = (mesh.n_elements, int(faces.number.max()) + 1)
    part = _parts(mesh, sparse.csr_array((ones, (faces.element, faces.number)), shape=shape))
    parts, count = int(part.max()) + 1, int(body.max()) + 1
    if parts > count:
        what = f"{parts - count} parts hang on by an edge or a node alone"
        advice = "they turn about it as about a hinge; let them share facets"
        middle = mesh.centers[part == parts - 1].mean(axis=0)
        yield mesh_defect("hinged", "warning", what, advice, parts - count, middle, which="the smallest around")


def _conformity(mesh: Mesh, body: IntArray) -> Iterator[MeshDefect]:
    """Neighbours that touch and do not share their nodes."""
    unequal = unequal_edges(mesh)
    if len(unequal):
        what = f"{len(unequal)} edges have a middle node in one element and not in its neighbour"
        advice = "elements of order 1 and 2 do not fit each other; use one order"
        yield mesh_defect("non-conforming", "error", what, advice, len(unequal), mesh.points[unequal[0]].mean(axis=0))
    covered = covered_quadrilaterals(mesh)
    if len(covered):
        what = f"{len(covered)} quadrilaterals lie on triangles"
        advice = "bricks do not fit tetrahedra, nor the ends of wedges; use one kind, or join them along matching faces"
        yield mesh_defect("non-conforming", "error", what, advice, len(covered), mesh.points[covered[0]].mean(axis=0))
    touching = touching_nodes(mesh, body)
    if number := len(touching.across):
        what = f"the mesh falls into {body.max() + 1} bodies whose nodes coincide at {number} places"
        advice = "merge them, unless the bodies are meant to be loose"
        yield mesh_defect("disconnected", "error", what, advice, number, mesh.points[touching.across[0]])
    if number := len(touching.within):
        what = f"nodes coincide at {number} places of one body and are not joined"
        advice = "merge them, unless a slit is meant"
        yield mesh_defect("slit", "warning", what, advice, number, mesh.points[touching.within[0]])
    if number := len(touching.hanging):
        what = f"{number} nodes lie within facets that they are no part of"
        advice = "the elements on both sides do not match and are not joined; mesh them together"
        severity: Severity = "warning" if touching.between_bodies else "error"
        yield mesh_defect("non-conforming", severity, what, advice, number, mesh.points[touching.hanging[0]])
