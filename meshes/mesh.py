"""The finite-element mesh that every other room takes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from meshes.errors import GeometryError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# Faces of a tetrahedron: corners first, then the middle nodes of the edges between them, in VTK's node order.
_TETRAHEDRON_FACES = np.array([[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]])


@dataclass(frozen=True)
class Mesh:
    """A mesh of tetrahedra with named surfaces.

    Attributes
    ----------
    points : ndarray, shape (n_nodes, 3)
        Node coordinates [m].
    cells : ndarray of int, shape (n_elements, 4) or (n_elements, 10)
        Node numbers of each tetrahedron in VTK's order: four corners, then (order 2) the middle nodes of the
        edges 01, 12, 02, 03, 13, 23.
    surfaces : mapping of str to ndarray of int, shape (n_facets, 3) or (n_facets, 6)
        Named parts of the surface as triangles: three corners, then the middle nodes of the edges 01, 12, 02.
    volumes : mapping of str to ndarray of int, shape (n,)
        Named groups of elements, as element numbers.

    Raises
    ------
    GeometryError
        Where the arrays do not fit each other, a coordinate is not finite, or an element is inverted.
    """

    points: FloatArray
    cells: IntArray
    surfaces: Mapping[str, IntArray] = field(default_factory=dict)
    volumes: Mapping[str, IntArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1] != 3:
            raise GeometryError(f"mesh points have shape {self.points.shape}; expected (n_nodes, 3)")
        if self.cells.ndim != 2 or self.cells.shape[1] not in (4, 10) or len(self.cells) == 0:
            raise GeometryError(
                f"mesh elements have shape {self.cells.shape}; expected (n_elements, 4) or (n_elements, 10)"
            )
        if not np.isfinite(self.points).all():
            raise GeometryError("mesh points hold values that are not finite")
        if self.cells.min() < 0 or self.cells.max() >= len(self.points):
            raise GeometryError(f"mesh elements name nodes outside 0..{len(self.points) - 1}")
        for name, facets in self.surfaces.items():
            if facets.ndim != 2 or facets.shape[1] != 3 * self.order:
                raise GeometryError(
                    f"surface {name!r} has shape {facets.shape}; expected (n_facets, {3 * self.order}) on elements of "
                    f"order {self.order}"
                )
            if facets.size and (facets.min() < 0 or facets.max() >= len(self.points)):
                raise GeometryError(f"surface {name!r} names nodes outside 0..{len(self.points) - 1}")
        for name, members in self.volumes.items():
            if members.size and (members.min() < 0 or members.max() >= len(self.cells)):
                raise GeometryError(f"volume {name!r} names elements outside 0..{len(self.cells) - 1}")
        inverted = int(np.count_nonzero(self.corner_volumes <= 0.0))
        if inverted:
            raise GeometryError(
                f"{inverted} of {len(self.cells)} elements have no positive volume: they are inverted or flat"
            )

    @property
    def order(self) -> int:
        """Polynomial order of the elements: 1 or 2."""
        return 1 if self.cells.shape[1] == 4 else 2

    @cached_property
    def corner_volumes(self) -> FloatArray:
        """Volume of each element between its corners [m³], shape (n_elements,); negative where inverted."""
        corners = self.points[self.cells[:, :4]]
        edges = corners[:, 1:] - corners[:, :1]
        return np.asarray(np.linalg.det(edges) / 6.0)

    @cached_property
    def boundary(self) -> IntArray:
        """The facets that belong to one element only, outward, shape (n_facets, 3) or (n_facets, 6)."""
        n_nodes = 3 if self.order == 1 else 6
        facets = self.cells[:, _TETRAHEDRON_FACES[:, :n_nodes]].reshape(-1, n_nodes)
        corners = np.sort(facets[:, :3], axis=1)
        _, first, counts = np.unique(corners, axis=0, return_index=True, return_counts=True)
        return np.asarray(facets[np.sort(first[counts == 1])])

    @property
    def bounds(self) -> FloatArray:
        """Smallest and largest coordinates [m], shape (2, 3)."""
        used = self.points[np.unique(self.cells)]
        return np.array([used.min(axis=0), used.max(axis=0)])

    def surface(self, name: str) -> IntArray:
        """The facets of a named surface.

        Raises
        ------
        GeometryError
            Where the mesh has no surface of that name; the message lists those it has.
        """
        if name not in self.surfaces:
            known = ", ".join(sorted(self.surfaces)) or "none"
            raise GeometryError(f"the mesh has no surface {name!r}; it has: {known}")
        return self.surfaces[name]
