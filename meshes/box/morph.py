"""Mesh morphing of a box: nodes follow the box's dimensions, elements stay the same.

A new mesh at other dimensions has other elements, so that frequencies jump by the discretisation errors. With nodes
that move with the dimensions frequencies are smooth, and the velocities of the nodes give exact shape sensitivities.

Every boundary node lies on faces that a box's dimensions place: on planes along the axes, which fix one component of
its motion, and on the cylinders of bores and bosses, which fix two. The rest of each component slides along its faces
and follows through the solid as a harmonic field: ∇²u_i = 0, with u_i given on the planes that are normal to axis i and
on the cylinders. Middle nodes stay where they are between the ends of their edges, those of cylinders on the cylinder.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from meshes.box.geometry import BoxGeometry
from meshes.box.placed_faces import MorphError, carried, check_faces, cylinders_of, on_cylinders, parts_of, planes_of
from meshes.elements import FloatArray, IntArray, facet_centers, facet_normals
from meshes.errors import GeometryError
from meshes.mesh import Mesh

_FACING = 1.0 - 1e-6  # cosine from which a facet is normal to an axis


class BoxMorph:
    """Morphing of a box's mesh to other dimensions.

    Parameters
    ----------
    mesh : Mesh
        Tetrahedra, of :func:`meshes.mesh_box` or moved by an earlier morph.
    geometry : BoxGeometry
        Present dimensions of the mesh.

    Raises
    ------
    MorphError
        Where the box has faces that are neither planes along the axes nor bores and bosses, or circles of bolts.
    """

    def __init__(self, mesh: Mesh, geometry: BoxGeometry) -> None:
        check_faces(geometry)
        self._mesh, self._geometry = mesh, geometry
        slack = 1e-6 * max(geometry.size)
        boundary = mesh.boundary
        corners = np.concatenate([block.corners for block in boundary])
        everything = np.concatenate([block.nodes for block in boundary])
        places = mesh.points[corners]
        round_, self._on_cylinder = on_cylinders(places, cylinders_of(geometry), slack)
        normals, centers = facet_normals(mesh.points, boundary), facet_centers(mesh.points, boundary)
        planes = planes_of(geometry)
        self._on_plane: list[tuple[int, int, IntArray]] = []  # axis, number of the plane, its nodes
        claimed = round_.copy()
        for number, plane in enumerate(planes):
            member = (
                ~round_
                & (np.abs(normals[:, plane.axis]) > _FACING)
                & (np.abs(places[:, :, plane.axis] - plane.at).max(axis=1) < slack)
                & ((centers > plane.low - slack) & (centers < plane.high + slack)).all(axis=1)
            )
            if member.any():
                self._on_plane.append((plane.axis, number, np.unique(corners[member])))
                claimed |= member
        if not claimed.all():
            x, y, z = centers[np.argmin(claimed)]
            raise MorphError(f"the face at ({x:.4g}, {y:.4g}, {z:.4g}) m is none that the box's dimensions place")
        self._round = [
            (number, np.unique(corners[member]), np.unique(everything[member])) for number, member in self._on_cylinder
        ]
        self._vertices = np.unique(np.concatenate([block.corners.ravel() for block in mesh.blocks]))
        self._held = [self._given_nodes(axis) for axis in range(3)]
        self._harmonic = [_Harmonic(mesh, self._vertices, held) for held in self._held]

    def displacement(self, geometry: BoxGeometry) -> FloatArray:
        """Displacement of each node to another geometry of the same parts [m], shape (n_nodes, 3).

        It is linear in the places of planes and axes and in the radii.

        Raises
        ------
        MorphError
            Where the other geometry has other parts, or parts that share a face in one do not in the other.
        """
        check_faces(geometry)
        planes, others = planes_of(self._geometry), planes_of(geometry)
        cylinders, turned = cylinders_of(self._geometry), cylinders_of(geometry)
        if parts_of(geometry) != parts_of(self._geometry):
            raise MorphError("the box has other parts than its mesh: mesh it anew")
        points = self._mesh.points
        moved = np.zeros_like(points)
        given = np.full_like(points, np.nan)
        for axis, number, nodes in self._on_plane:
            shift = others[number].at - planes[number].at
            self._give(given, nodes, axis, np.full(len(nodes), shift))
        for number, nodes, _ in self._round:
            for axis in range(2):
                self._give(given, nodes, axis, carried(points[nodes], cylinders[number], turned[number])[:, axis])
        for axis, harmonic in enumerate(self._harmonic):
            moved[self._vertices, axis] = harmonic.extended(given[self._vertices, axis])
        moved = _with_middles(self._mesh, moved)
        for number, _, nodes in self._round:
            moved[nodes, :2] = carried(points[nodes], cylinders[number], turned[number])
        return moved

    def moved(self, geometry: BoxGeometry) -> Mesh:
        """The mesh at another geometry.

        Raises
        ------
        MorphError
            As :meth:`displacement`, and where an element would be inverted.
        """
        try:
            return replace(self._mesh, points=self._mesh.points + self.displacement(geometry))
        except MorphError:
            raise
        except GeometryError as error:
            raise MorphError(f"the mesh cannot follow so far: {error}") from error

    def _given_nodes(self, axis: int) -> npt.NDArray[np.bool_]:
        held = np.zeros(len(self._mesh.points), dtype=bool)
        for own, _, nodes in self._on_plane:
            if own == axis:
                held[nodes] = True
        for _, nodes, _ in self._round:
            if axis < 2:
                held[nodes] = True
        return np.asarray(held[self._vertices])

    def _give(self, given: FloatArray, nodes: IntArray, axis: int, shift: FloatArray) -> None:
        before = given[nodes, axis]
        apart = np.abs(before - shift) > 1e-9 * max(self._geometry.size)
        if (apart & ~np.isnan(before)).any():
            x, y, z = self._mesh.points[nodes[np.argmax(apart & ~np.isnan(before))]]
            raise MorphError(
                f"faces that meet flush at ({x:.4g}, {y:.4g}, {z:.4g}) m would part along {'xyz'[axis]}: mesh it anew"
            )
        given[nodes, axis] = shift


class _Harmonic:
    """Harmonic extension of a component from given corners to all of them: ∇²u = 0 by linear tetrahedra."""

    def __init__(self, mesh: Mesh, vertices: IntArray, held: npt.NDArray[np.bool_]) -> None:
        laplacian = _laplacian(mesh)[vertices][:, vertices]
        self._held = held
        self._coupling = laplacian[~held][:, held]
        free = sparse.csc_array(laplacian[~held][:, ~held])
        self._factor = splu(free) if free.shape[0] else None

    def extended(self, values: FloatArray) -> FloatArray:
        whole = values.copy()
        if self._factor is not None:
            whole[~self._held] = self._factor.solve(-(self._coupling @ values[self._held]))
        return whole


def _laplacian(mesh: Mesh) -> sparse.csr_array:
    n = len(mesh.points)
    total = sparse.csr_array((n, n))
    for block in mesh.blocks:
        if block.of.corners != "tetra":
            raise MorphError(f"a mesh of {block.kind} elements: only tetrahedra are moved")
        places = mesh.points[block.corners]
        edges = (places[:, 1:] - places[:, :1]).transpose(0, 2, 1)
        inner = np.linalg.inv(edges)
        slopes = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
        volume = np.linalg.det(edges) / 6.0
        local = np.einsum("eai,ebi,e->eab", slopes, slopes, volume)
        rows, columns = np.repeat(block.corners, 4, axis=1), np.tile(block.corners, 4)
        total = total + sparse.csr_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n))
    return sparse.csr_array(total)


def _with_middles(mesh: Mesh, moved: FloatArray) -> FloatArray:
    """Motions of the corners, and half the sum of both ends' for the middle of each edge."""
    for block in mesh.blocks:
        places, corners = np.array(block.of.places), block.of.n_corners
        for first, second in combinations(range(corners), 2):
            middle = np.flatnonzero(np.abs(places[corners:] - (places[first] + places[second]) / 2).max(axis=1) < 1e-12)
            for local in middle:
                nodes = block.nodes
                moved[nodes[:, corners + local]] = (moved[nodes[:, first]] + moved[nodes[:, second]]) / 2
    return moved
