"""Finite element types and blocks of elements: reference coordinates of nodes, edges, faces, and face topology.

A kind has meshio's name and numbers its nodes as VTK does: corners, then the middles of edges, of faces, of the
element. Edges, faces and their middle nodes all follow from the reference coordinates of the nodes.
Solids are numbered so that the map from the reference element has a positive determinant: of a wedge, the triangle
0 1 2 turns towards 3 4 5.

The topology of a mesh is the table of its element faces, which shows the faces that elements share.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.meshes.errors import GeometryError
from gearwhine.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class ElementKind:
    """A type of element.

    Attributes
    ----------
    name : str
        Name in meshio, such as ``tetra10``.
    order : int
        Polynomial order, 1 or 2.
    corners : str
        The kind of order 1 with the same corners.
    places : tuple of tuple of float
        Reference coordinates of the nodes; the reference element reaches from 0 to 1.
    corner_faces : tuple of tuple of int
        Corners of each face of a solid, turning counter-clockwise seen from outside.
    """

    name: str
    order: int
    corners: str
    places: tuple[tuple[float, ...], ...]
    corner_faces: tuple[tuple[int, ...], ...] = ()

    @property
    def dimension(self) -> int:
        """Dimension: 2 for facets, 3 for solids."""
        return len(self.places[0])

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.places)

    @property
    def n_corners(self) -> int:
        """Number of corners, which are the first nodes."""
        return len(_CORNERS[self.corners])

    @property
    def corner_triangles(self) -> tuple[tuple[int, int, int], ...]:
        """Corners of the plane triangles that a facet is divided into."""
        return tuple((0, corner, corner + 1) for corner in range(1, self.n_corners - 1))

    @cached_property
    def edges(self) -> IntArray:
        """Corners at the ends of each edge, shape (n_edges, 2)."""
        faces = self.corner_faces or (tuple(range(self.n_corners)),)
        pairs = {(min(a, b), max(a, b)) for face in faces for a, b in zip(face, (*face[1:], face[0]), strict=True)}
        return np.array(sorted(pairs))

    @cached_property
    def mirrored(self) -> IntArray:
        """The order of the nodes that turns an element seen in a mirror right-handed again."""
        places = np.array(self.places)
        exchanged = places.copy()
        exchanged[:, [0, 1]] = places[:, [1, 0]]
        return np.asarray(np.argmin(np.abs(exchanged[:, None] - places[None]).max(axis=2), axis=1))

    @cached_property
    def faces(self) -> tuple[tuple[str, IntArray], ...]:
        """The facet kind of each face of a solid and the local numbers of its nodes, in the facet's own order."""
        return tuple(self._face(face) for face in self.corner_faces)

    def _face(self, corners: tuple[int, ...]) -> tuple[str, IntArray]:
        nodes = list(corners)
        if self.order == 2:
            nodes += [self._middle((a, b)) for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)]
        if self.name == "hexahedron27":
            nodes.append(self._middle(corners))
        return _FACET_OF[len(nodes)], np.array(nodes)

    def _middle(self, corners: Sequence[int]) -> int:
        """Find the node in the middle of some corners."""
        middle = np.mean([self.places[corner] for corner in corners], axis=0)
        return int(np.flatnonzero(np.all(np.isclose(np.array(self.places), middle), axis=1))[0])


def _with_middles(corners: Sequence[Sequence[float]], *groups: Sequence[int]) -> tuple[tuple[float, ...], ...]:
    """Corners, followed by the middles of groups of them."""
    middles = [np.mean([corners[corner] for corner in group], axis=0) for group in groups]
    return tuple(tuple(float(value) for value in place) for place in (*corners, *middles))


_CORNERS: dict[str, tuple[tuple[float, ...], ...]] = {
    "triangle": ((0, 0), (1, 0), (0, 1)),
    "quad": ((0, 0), (1, 0), (1, 1), (0, 1)),
    "tetra": ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "hexahedron": ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    "wedge": ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)),
}
_FACET_OF = {3: "triangle", 6: "triangle6", 4: "quad", 8: "quad8", 9: "quad9"}
_FACES: dict[str, tuple[tuple[int, ...], ...]] = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
}
# Middle nodes in VTK's order.
_RING_3 = ((0, 1), (1, 2), (2, 0))
_RING_4 = ((0, 1), (1, 2), (2, 3), (3, 0))
_HEXAHEDRON_EDGES = (*_RING_4, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_HEXAHEDRON_MIDDLES = ((0, 3, 4, 7), (1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7), range(8))
_QUADRATIC: dict[str, tuple[str, tuple[Sequence[int], ...]]] = {
    "triangle6": ("triangle", _RING_3),
    "quad8": ("quad", _RING_4),
    "quad9": ("quad", (*_RING_4, range(4))),
    "tetra10": ("tetra", (*_RING_3, (0, 3), (1, 3), (2, 3))),
    "hexahedron20": ("hexahedron", _HEXAHEDRON_EDGES),
    "hexahedron27": ("hexahedron", (*_HEXAHEDRON_EDGES, *_HEXAHEDRON_MIDDLES)),
    "wedge15": ("wedge", (*_RING_3, (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))),
}

KINDS: dict[str, ElementKind] = {
    **{name: ElementKind(name, 1, name, places, _FACES.get(name, ())) for name, places in _CORNERS.items()},
    **{
        name: ElementKind(name, 2, base, _with_middles(_CORNERS[base], *middles), _FACES.get(base, ()))
        for name, (base, middles) in _QUADRATIC.items()
    },
}
"""Every kind of solid element and of facet, by name."""

SOLIDS = tuple(name for name, kind in KINDS.items() if kind.dimension == 3)
"""Names of the solid elements."""

FACETS = tuple(name for name, kind in KINDS.items() if kind.dimension == 2)
"""Names of the facets."""


@dataclass(frozen=True)
class ElementBlock:
    """Elements of one kind.

    Attributes
    ----------
    kind : str
        One of :data:`KINDS`.
    nodes : ndarray of int, shape (n_elements, n_nodes)
        Node numbers of each element, in VTK's order.

    Raises
    ------
    GeometryError
        Where there is no such kind, or the array has another number of nodes.
    """

    kind: str
    nodes: IntArray

    def __post_init__(self) -> None:
        """Check the kind and the number of nodes of an element."""
        if self.kind not in KINDS:
            raise GeometryError(f"no elements of kind {self.kind!r}; known kinds: {', '.join(KINDS)}")
        if self.nodes.ndim != 2 or self.nodes.shape[1] != self.of.n_nodes:
            raise GeometryError(
                f"{self.kind} elements have shape {self.nodes.shape}; expected (n_elements, {self.of.n_nodes})"
            )

    @property
    def of(self) -> ElementKind:
        """The element type."""
        return KINDS[self.kind]

    @property
    def corners(self) -> IntArray:
        """The corners' node numbers, shape (n_elements, n_corners)."""
        return self.nodes[:, : self.of.n_corners]

    def __len__(self) -> int:
        """Return the number of elements."""
        return len(self.nodes)


def outside_nodes(block: ElementBlock, n_points: int) -> str:
    """Describe the first element of a block that names a missing node; empty where none does.

    Parameters
    ----------
    block : ElementBlock
    n_points : int
        Nodes are counted from 0 to one less.
    """
    wrong = (block.nodes < 0) | (block.nodes >= n_points)
    if not wrong.any():
        return ""
    element = int(np.argmax(wrong.any(axis=1)))
    node = int(block.nodes[element][wrong[element]][0])
    return (
        f"names nodes outside 0..{n_points - 1}: {block.kind} element {element} (counted from 0) has node {node}, "
        f"and there are {n_points} nodes"
    )


Facets = tuple[ElementBlock, ...]
"""Facets of the surface: triangles and quadrilaterals, a block for each kind."""


def facets_of(nodes: IntArray) -> Facets:
    """Facets of the kind that their number of nodes implies: 3 or 6 for triangles, 4, 8 or 9 for quadrilaterals.

    Raises
    ------
    GeometryError
        Where facets have another number of nodes.
    """
    if nodes.ndim != 2 or nodes.shape[1] not in _FACET_OF:
        numbers = ", ".join(map(str, _FACET_OF))
        raise GeometryError(f"facets have shape {nodes.shape}; expected (n_facets, n_nodes) with n_nodes of {numbers}")
    return (ElementBlock(_FACET_OF[nodes.shape[1]], nodes),)


def merged(blocks: Iterable[ElementBlock]) -> tuple[ElementBlock, ...]:
    """Merge the blocks of each kind into one, in the order in which the kinds first come."""
    parts: dict[str, list[IntArray]] = {}
    for block in blocks:
        parts.setdefault(block.kind, []).append(block.nodes)
    return tuple(ElementBlock(kind, np.concatenate(nodes)) for kind, nodes in parts.items())


def facet_nodes(facets: Facets) -> IntArray:
    """Return the node numbers of some facets, ascending, each once."""
    return _unique(block.nodes for block in facets)


def facet_corners(facets: Facets) -> IntArray:
    """Return the node numbers of the corners of some facets, ascending, each once."""
    return _unique(block.corners for block in facets)


def facet_centers(points: FloatArray, facets: Facets) -> FloatArray:
    """Compute the mean of each facet's corners [m], shape (n_facets, 3), block after block."""
    return np.concatenate([np.empty((0, 3)), *(points[block.corners].mean(axis=1) for block in facets)])


def facet_normals(points: FloatArray, facets: Facets) -> FloatArray:
    """Outward unit normals of boundary facets by their corners, shape (n_facets, 3), block after block."""
    normals = [np.empty((0, 3))]
    for block in facets:
        corners = points[block.corners]
        # A quadrilateral's normal by its diagonals, a triangle's by two sides.
        last = corners[:, -1] - corners[:, 1] if block.of.n_corners == 4 else corners[:, 2] - corners[:, 1]
        normals.append(np.cross(corners[:, 2] - corners[:, 0], last))
    together = np.concatenate(normals)
    return np.asarray(together / np.linalg.norm(together, axis=1)[:, None])


def pick_facets(facets: Facets, chosen: npt.NDArray[np.bool_]) -> Facets:
    """Select the facets for which ``chosen`` is true, shape (n_facets,), block after block; no empty blocks."""
    ends = np.cumsum([len(block) for block in facets])[:-1]
    parts = zip(facets, np.split(chosen, ends), strict=True)
    return tuple(ElementBlock(block.kind, block.nodes[mask]) for block, mask in parts if mask.any())


def count(blocks: Iterable[ElementBlock]) -> int:
    """Count the elements or facets in some blocks."""
    return sum(len(block) for block in blocks)


def _unique(parts: Iterable[IntArray]) -> IntArray:
    return np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(part.ravel() for part in parts)]))


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
        The element that the face belongs to, over all blocks.
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
    """Assign numbers to rows of integers so that equal rows, and only they, have equal numbers."""
    order = np.lexsort(rows.T)
    ordered = rows[order]
    fresh = np.ones(len(rows), dtype=np.int64)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.cumsum(fresh) - 1
    return numbers


def faces_as_facets(blocks: tuple[ElementBlock, ...], table: FaceTable, chosen: IntArray) -> Facets:
    """Return the faces ``chosen`` of a table with all their nodes, outward, one block for each kind, in that order."""
    parts: dict[str, list[tuple[IntArray, IntArray]]] = {}
    source = table.source[chosen]
    for number, block in enumerate(blocks):
        for place, (kind, local) in enumerate(block.of.faces):
            rows = np.flatnonzero((source[:, 0] == number) & (source[:, 2] == place))
            if len(rows):
                parts.setdefault(kind, []).append((rows, block.nodes[source[rows, 1]][:, local]))
    facets = []
    for kind in sorted(parts, key=list(KINDS).index):
        places = np.concatenate([where for where, _ in parts[kind]])
        nodes = np.concatenate([nodes for _, nodes in parts[kind]])
        facets.append(ElementBlock(kind, nodes[np.argsort(places)]))
    return tuple(facets)
