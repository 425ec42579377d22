"""Finite-element mesh: nodes, blocks of solid elements, named surfaces and volumes; and its defects.

A mesh defect has a name, a severity, a message, a number and a place.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from scipy import sparse

from gearwhine.meshes.elements import (
    ElementBlock,
    FaceTable,
    Facets,
    count,
    face_table,
    faces_as_facets,
    facets_of,
    outside_nodes,
)
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.shape_functions import volumes
from gearwhine.numerics.arrays import FloatArray, IntArray

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class MeshDefect:
    """A defect of a mesh, or a doubt about it.

    Attributes
    ----------
    name : str
        Finding on the mesh itself: ``degenerate``, ``folded``, ``shape``, ``non-manifold``, ``overlapping``,
        ``disconnected``, ``slit``, ``non-conforming``, ``hinged``, ``unused nodes``, ``unit``; on its resolution:
        ``size``, ``locking``.
    severity : {"error", "warning"}
        Errors make the modes wrong or impossible; warnings leave the judgement to the user.
    message : str
        The defect, its place, and the remedy.
    count : int
        Number of nodes, facets, elements or bodies.
    place : ndarray, shape (3,)
        Place of the first or the worst of them [m].
    """

    name: str
    severity: Severity
    message: str
    count: int
    place: FloatArray


def mesh_defect(
    name: str,
    severity: Severity,
    finding: str,
    advice: str,
    count: int,
    place: FloatArray,
    *,
    which: str = "the first at",
) -> MeshDefect:
    """Make a defect whose message names the fault, one place, and the remedy."""
    return MeshDefect(name, severity, f"{finding}, {which} {place_text(place)}; {advice}", int(count), place)


def place_text(place: FloatArray) -> str:
    """Write a place for a message."""
    return f"({place[0]:.6g}, {place[1]:.6g}, {place[2]:.6g}) m"


_ROTATION_TOLERANCE = 1e-9  # largest deviation of a rotation from an orthogonal matrix


@dataclass(frozen=True)
class Mesh:
    """A mesh of solid elements with named surfaces and volumes.

    Attributes
    ----------
    points : ndarray, shape (n_nodes, 3)
        Node coordinates [m].
    blocks : tuple of ElementBlock
        Solid elements, a block for each kind or part; elements are counted over all blocks in order.
    surfaces : mapping of str to tuple of ElementBlock
        Named parts of the surface, as facets.
    volumes : mapping of str to ndarray of int, shape (n,)
        Named groups of elements, as element numbers.

    Raises
    ------
    GeometryError
        Where the arrays do not fit each other, a coordinate is not finite, or an element is inverted or flat.
    """

    points: FloatArray
    blocks: tuple[ElementBlock, ...]
    surfaces: Mapping[str, Facets] = field(default_factory=dict)
    volumes: Mapping[str, IntArray] = field(default_factory=dict)

    def __repr__(self) -> str:
        """Return the size and the named surfaces in a line."""
        elements = sum(len(block.nodes) for block in self.blocks)
        return f"<Mesh: {len(self.points)} nodes, {elements} elements; surfaces {', '.join(self.surfaces) or 'none'}>"

    def __post_init__(self) -> None:
        """Check the points, the numbers of nodes and elements, and the volumes of the elements."""
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise GeometryError(f"mesh points have shape {self.points.shape}; expected (n_nodes, 3)")
        if not np.isfinite(self.points).all():
            raise GeometryError("mesh points hold values that are not finite")
        if self.n_elements == 0:
            raise GeometryError("the mesh has no elements")
        for block in self.blocks:
            self._check_nodes(block, "the mesh", dimension=3)
        for name, facets in self.surfaces.items():
            for block in facets:
                self._check_nodes(block, f"surface {name!r}", dimension=2)
        for name, members in self.volumes.items():
            if members.size and (members.min() < 0 or members.max() >= self.n_elements):
                raise GeometryError(f"volume {name!r} names elements outside 0..{self.n_elements - 1}")
        wrong = np.flatnonzero(self.corner_volumes <= 0.0)
        if len(wrong):
            inverted = np.count_nonzero(self.corner_volumes < 0.0)
            raise GeometryError(
                f"{len(wrong)} of {self.n_elements} elements have no positive volume: {inverted} are inverted, "
                f"{len(wrong) - inverted} flat, the first at {place_text(self.centers[wrong[0]])}"
            )

    @classmethod
    def of_tetrahedra(
        cls,
        points: FloatArray,
        cells: IntArray,
        surfaces: Mapping[str, IntArray] | None = None,
        volumes: Mapping[str, IntArray] | None = None,
    ) -> "Mesh":
        """Make a mesh of tetrahedra of one order from plain arrays.

        Parameters
        ----------
        points : ndarray, shape (n_nodes, 3)
            Places of the nodes [m].
        cells : ndarray of int, shape (n_elements, 4) or (n_elements, 10)
        surfaces : mapping of str to ndarray of int, shape (n_facets, 3) or (n_facets, 6)
        volumes : mapping of str to ndarray of int, shape (n,)

        Raises
        ------
        GeometryError
            As :class:`Mesh`, and where the surfaces are of another order than the elements.
        """
        kind = {4: "tetra", 10: "tetra10"}.get(cells.shape[1] if cells.ndim == 2 else 0)
        if kind is None:
            raise GeometryError(f"mesh elements have shape {cells.shape}; expected (n_elements, 4) or (n_elements, 10)")
        expected = 3 if kind == "tetra" else 6
        for name, facets in (surfaces or {}).items():
            if facets.ndim != 2 or facets.shape[1] != expected:
                raise GeometryError(
                    f"surface {name!r} has shape {facets.shape}; expected (n_facets, {expected}) on {kind} elements"
                )
        named = {name: facets_of(facets) for name, facets in (surfaces or {}).items()}
        return cls(points, (ElementBlock(kind, cells),), named, volumes or {})

    def rotated(self, rotation: FloatArray) -> "Mesh":
        """Rotate the mesh about the origin.

        Parameters
        ----------
        rotation : ndarray, shape (3, 3)
            Matrix R of x' = R x, proper and orthogonal.

        Raises
        ------
        GeometryError
            Where it is no rotation.
        """
        turn = np.asarray(rotation, dtype=np.float64)
        if (
            turn.shape != (3, 3)
            or np.abs(turn @ turn.T - np.eye(3)).max() > _ROTATION_TOLERANCE
            or np.linalg.det(turn) < 0.0
        ):
            raise GeometryError(f"{turn.tolist()} is no rotation; expected an orthogonal matrix of determinant 1")
        return Mesh(self.points @ turn.T, self.blocks, self.surfaces, self.volumes)

    @property
    def n_elements(self) -> int:
        """Number of elements in all blocks."""
        return count(self.blocks)

    @property
    def order(self) -> int:
        """Highest polynomial order of the elements: 1 or 2."""
        return max(block.of.order for block in self.blocks)

    @property
    def kinds(self) -> dict[str, int]:
        """Number of elements of each kind."""
        kinds: dict[str, int] = {}
        for block in self.blocks:
            kinds[block.kind] = kinds.get(block.kind, 0) + len(block)
        return kinds

    @property
    def block_ends(self) -> IntArray:
        """Indices at which arrays over all elements split into the blocks, for numpy.split."""
        return np.asarray(np.cumsum([len(block) for block in self.blocks])[:-1])

    @property
    def incidence(self) -> sparse.csr_array:
        """Incidence of elements (rows) and nodes (columns), shape (n_elements, n_points): 1 where a node belongs."""
        nodes = np.concatenate([block.nodes.ravel() for block in self.blocks])
        lengths = np.concatenate([np.full(len(block), block.of.n_nodes) for block in self.blocks])
        pointer = np.concatenate([[0], np.cumsum(lengths)])
        ones = np.ones(len(nodes), dtype=np.int32)
        return sparse.csr_array((ones, nodes, pointer), shape=(len(lengths), len(self.points)))

    @cached_property
    def corner_volumes(self) -> FloatArray:
        """Volume of each element between its corners [m³], shape (n_elements,); negative where inverted."""
        return np.concatenate([volumes(self.points, block.corners, block.of.corners) for block in self.blocks])

    @cached_property
    def element_volumes(self) -> FloatArray:
        """Volume of each element with its curved sides [m³], shape (n_elements,)."""
        return np.concatenate([volumes(self.points, block.nodes, block.kind) for block in self.blocks])

    @cached_property
    def centers(self) -> FloatArray:
        """Mean of each element's corners [m], shape (n_elements, 3)."""
        return np.concatenate([self.points[block.corners].mean(axis=1) for block in self.blocks])

    @cached_property
    def faces(self) -> FaceTable:
        """Table of the faces of all elements, with the sharing of each."""
        return face_table(self.blocks)

    @cached_property
    def boundary(self) -> Facets:
        """Facets that belong to one element only, seen from outside: a block for each kind."""
        return faces_as_facets(self.blocks, self.faces, np.flatnonzero(self.faces.sharing == 1))

    @property
    def bounds(self) -> FloatArray:
        """Smallest and largest coordinates [m], shape (2, 3)."""
        used = self.points[self.used_nodes]
        return np.array([used.min(axis=0), used.max(axis=0)])

    @property
    def used_nodes(self) -> IntArray:
        """The numbers of the nodes that belong to an element, ascending."""
        used = np.zeros(len(self.points), dtype=bool)
        for block in self.blocks:
            used[block.nodes] = True
        return np.flatnonzero(used)

    def surface(self, name: str) -> Facets:
        """Return the facets of a named surface.

        Raises
        ------
        GeometryError
            Where the mesh has no surface of that name; the message lists those it has.
        """
        if name not in self.surfaces:
            names = ", ".join(sorted(self.surfaces)) or "none"
            raise GeometryError(f"the mesh has no surface {name!r}; it has: {names}")
        return self.surfaces[name]

    def _check_nodes(self, block: ElementBlock, owner: str, dimension: int) -> None:
        if block.of.dimension != dimension:
            wanted = "solid elements" if dimension == 3 else "facets"
            raise GeometryError(f"{owner} holds {block.kind} elements; expected {wanted}")
        if outside_nodes(block, len(self.points)):
            raise GeometryError(f"{owner} {outside_nodes(block, len(self.points))}")
