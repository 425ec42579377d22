"""A box's mesh bent to other dimensions: the same nodes and elements, moved smoothly.

A mesh made anew at other dimensions has other elements, and its frequencies jump by their errors of discretisation.
Nodes that move with the dimensions keep them smooth, and have a rate: it makes sensitivities to geometry exact.

Every boundary node lies on faces that a box's dimensions place: on planes along the axes, which fix one component of
its motion, and on the cylinders of bores and bosses, which fix two. The rest of each component slides along its faces
and follows through the solid as a harmonic field: ∇²u_i = 0, with u_i given on the planes that are normal to axis i and
on the cylinders. Middle nodes stay where they are between the ends of their edges, those of cylinders on the cylinder.
"""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import splu

from meshes.box import layout
from meshes.box.geometry import BoxGeometry
from meshes.box.layout import Block
from meshes.elements import FloatArray, IntArray, facet_centers, facet_normals
from meshes.errors import GeometryError
from meshes.mesh import Mesh

_FACING = 1.0 - 1e-6  # cosine from which a facet is normal to an axis


class MorphError(GeometryError):
    """A mesh cannot follow its geometry: what is asked for wants another mesh, made anew."""


@dataclass(frozen=True)
class _Plane:
    """A rectangle normal to an axis: its place and its extent."""

    axis: int
    at: float
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class _Cylinder:
    """A cylinder along z: axis in x and y, radius, span in z."""

    center: FloatArray
    radius: float
    span: tuple[float, float]


class BoxMorph:
    """The ways in which a box's mesh can follow its dimensions.

    Parameters
    ----------
    mesh : Mesh
        Tetrahedra, of :func:`meshes.mesh_box` or moved by an earlier morph.
    geometry : BoxGeometry
        That the mesh has now.

    Raises
    ------
    MorphError
        Where the box has faces that are neither planes along the axes nor bores and bosses, or circles of bolts.
    """

    def __init__(self, mesh: Mesh, geometry: BoxGeometry) -> None:
        _check_faces(geometry)
        self._mesh, self._geometry = mesh, geometry
        slack = 1e-6 * max(geometry.size)
        boundary = mesh.boundary
        corners = np.concatenate([block.corners for block in boundary])
        everything = np.concatenate([block.nodes for block in boundary])
        places = mesh.points[corners]
        round_, self._on_cylinder = _on_cylinders(places, _cylinders(geometry), slack)
        normals, centers = facet_normals(mesh.points, boundary), facet_centers(mesh.points, boundary)
        planes = _planes(geometry)
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
        """How far each node moves to another geometry of the same parts [m], shape (n_nodes, 3).

        It is linear in the places of planes and axes and in the radii: the difference of two neighbours is a rate.

        Raises
        ------
        MorphError
            Where the other geometry has other parts, or parts that share a face in one do not in the other.
        """
        _check_faces(geometry)
        planes, others = _planes(self._geometry), _planes(geometry)
        cylinders, turned = _cylinders(self._geometry), _cylinders(geometry)
        if _parts(geometry) != _parts(self._geometry):
            raise MorphError("the box has other parts than its mesh: mesh it anew")
        points = self._mesh.points
        moved = np.zeros_like(points)
        given = np.full_like(points, np.nan)
        for axis, number, nodes in self._on_plane:
            shift = others[number].at - planes[number].at
            self._give(given, nodes, axis, np.full(len(nodes), shift))
        for number, nodes, _ in self._round:
            for axis in range(2):
                self._give(given, nodes, axis, _carried(points[nodes], cylinders[number], turned[number])[:, axis])
        for axis, harmonic in enumerate(self._harmonic):
            moved[self._vertices, axis] = harmonic.extended(given[self._vertices, axis])
        moved = _with_middles(self._mesh, moved)
        for number, _, nodes in self._round:
            moved[nodes, :2] = _carried(points[nodes], cylinders[number], turned[number])
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
    """A component's values at all corners from those at some: ∇²u = 0 by linear tetrahedra."""

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


def _carried(places: FloatArray, before: _Cylinder, after: _Cylinder) -> FloatArray:
    """How far points of a cylinder move in x and y with it."""
    return np.asarray(
        after.center - before.center + (after.radius / before.radius - 1.0) * (places[:, :2] - before.center)
    )


def _on_cylinders(
    places: FloatArray, cylinders: list[_Cylinder], slack: float
) -> tuple[npt.NDArray[np.bool_], list[tuple[int, npt.NDArray[np.bool_]]]]:
    """Which facets, by their corners, lie on a cylinder; and on which."""
    upright = np.ptp(places[:, :, 2], axis=1) > 1e2 * slack  # the end faces' facets have all corners at one height
    any_, members = np.zeros(len(places), dtype=bool), []
    for number, cylinder in enumerate(cylinders):
        radius = np.linalg.norm(places[:, :, :2] - cylinder.center, axis=2)
        inside = (places[:, :, 2] > cylinder.span[0] - slack) & (places[:, :, 2] < cylinder.span[1] + slack)
        member = upright & (np.abs(radius - cylinder.radius) < slack).all(axis=1) & inside.all(axis=1)
        if member.any():
            members.append((number, member))
            any_ |= member
    return any_, members


def _check_faces(box: BoxGeometry) -> None:
    if box.fillets.inside or box.fillets.outside:
        raise MorphError("a box with rounded edges: its mesh is not moved, its dimensions cannot be fitted")
    if box.bolts or (box.feet is not None and box.feet.bolt_patch is not None):
        raise MorphError("a box with circles of bolts: its mesh is not moved, its dimensions cannot be fitted")


def _parts(box: BoxGeometry) -> tuple[object, ...]:
    """What two geometries must share for one to be the other's mesh, moved."""
    bores = tuple((bore.name, box.end_wall(bore), bore.boss is None) for bore in box.bores)
    ribs = tuple((rib.face, rib.along, rib.side, rib.start is None, rib.end is None) for rib in box.ribs)
    cover = None if box.cover is None else (box.cover.face, box.cover.flange is None, box.cover.bonded)
    return bores, ribs, cover, box.feet is None


def _blocks(box: BoxGeometry) -> list[Block]:
    blocks = [layout.outer_block(box), layout.cavity_block(box), *layout.foot_blocks(box)]
    blocks += [layout.rib_block(box, rib) for rib in box.ribs]
    if box.cover is not None:
        blocks += [layout.plate_block(box, box.cover), layout.opening_block(box, box.cover)]
        flange = layout.flange_block(box, box.cover)
        blocks += [] if flange is None else [flange]
    return blocks


def _planes(box: BoxGeometry) -> list[_Plane]:
    planes = []
    for block in _blocks(box):
        low, high = np.array(block.low), np.array(block.high)
        for axis in range(3):
            for at in (low[axis], high[axis]):
                near, far = low.copy(), high.copy()
                near[axis] = far[axis] = at
                planes.append(_Plane(axis, float(at), near, far))
    for bore in box.bores:
        if bore.boss is not None:
            start, end = box.bore_span(bore)
            at = start if box.end_wall(bore) == "back" else end
            x, y, _ = bore.center
            r = bore.boss.diameter / 2
            planes.append(_Plane(2, at, np.array([x - r, y - r, at]), np.array([x + r, y + r, at])))
    return planes


def _cylinders(box: BoxGeometry) -> list[_Cylinder]:
    cylinders = []
    for bore in box.bores:
        center, span = np.array(bore.center[:2]), box.bore_span(bore)
        cylinders.append(_Cylinder(center, bore.diameter / 2, span))
        if bore.boss is not None:
            cylinders.append(_Cylinder(center, bore.boss.diameter / 2, span))
    return cylinders
