"""Mesh topology: the table of element faces, and their sharing between elements."""

from dataclasses import dataclass

import numpy as np

from meshes.elements import KINDS, ElementBlock, Facets, IntArray

NO_NODE = -1
"""Stands for the missing fourth corner of a triangle."""


@dataclass(frozen=True)
class FaceTable:
    """Every face of every element, faces of the same corners under the same number.

    Attributes
    ----------
    corners : ndarray of int, shape (n_faces, 4)
        Corners of each face in its own order as its element sees it from outside; the fourth is -1 in a triangle.
    element : ndarray of int, shape (n_faces,)
        The element it belongs to, over all blocks.
    number : ndarray of int, shape (n_faces,)
        Equal for faces of the same corners.
    sharing : ndarray of int, shape (n_faces,)
        Number of elements that have a face of these corners.
    source : ndarray of int, shape (n_faces, 3)
        Block, element within the block, and which of its faces.
    """

    corners: IntArray
    element: IntArray
    number: IntArray
    sharing: IntArray
    source: IntArray


def face_table(blocks: tuple[ElementBlock, ...]) -> FaceTable:
    """Tabulate the faces of solid elements; in the order of the elements, and of each one's faces."""
    corners: list[IntArray] = []
    elements: list[IntArray] = []
    sources: list[IntArray] = []
    first = 0
    for number, block in enumerate(blocks):
        faces = block.of.corner_faces
        table = np.full((len(block), len(faces), 4), NO_NODE, dtype=np.int64)
        for which, face in enumerate(faces):
            table[:, which, : len(face)] = block.nodes[:, face]
        corners.append(table.reshape(-1, 4))
        member, place = np.divmod(np.arange(len(block) * len(faces)), len(faces))
        elements.append(first + member)
        sources.append(np.stack([np.full_like(member, number), member, place], axis=1))
        first += len(block)
    together = np.concatenate(corners)
    numbers = group_rows(np.sort(together, axis=1))
    return FaceTable(
        corners=together,
        element=np.concatenate(elements),
        number=numbers,
        sharing=np.bincount(numbers)[numbers],
        source=np.concatenate(sources),
    )


def group_rows(rows: IntArray) -> IntArray:
    """Number rows of integers so that equal rows, and only they, have equal numbers."""
    order = np.lexsort(rows.T)
    ordered = rows[order]
    fresh = np.ones(len(rows), dtype=np.int64)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.cumsum(fresh) - 1
    return numbers


def faces_as_facets(blocks: tuple[ElementBlock, ...], table: FaceTable, chosen: IntArray) -> Facets:
    """Some faces of a table with all their nodes, outward; a block for each kind, in the order of ``chosen``."""
    parts: dict[str, list[tuple[IntArray, IntArray]]] = {}
    source = table.source[chosen]
    for number, block in enumerate(blocks):
        for place, (kind, local) in enumerate(block.of.faces):
            here = np.flatnonzero((source[:, 0] == number) & (source[:, 2] == place))
            if len(here):
                parts.setdefault(kind, []).append((here, block.nodes[source[here, 1]][:, local]))
    facets = []
    for kind in sorted(parts, key=list(KINDS).index):
        places = np.concatenate([where for where, _ in parts[kind]])
        nodes = np.concatenate([nodes for _, nodes in parts[kind]])
        facets.append(ElementBlock(kind, nodes[np.argsort(places)]))
    return tuple(facets)
