"""Mesh morphing of a box: nodes follow the box's dimensions, elements stay the same.

A new mesh at other dimensions has other elements, so that frequencies jump by the discretisation errors. With nodes
that move with the dimensions frequencies are smooth, and the velocities of the nodes give exact shape sensitivities.

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

from gearwhine.meshes.box import layout
from gearwhine.meshes.box.geometry import BoxGeometry
from gearwhine.meshes.box.layout import Block
from gearwhine.meshes.elements import facet_centers, facet_normals
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import FloatArray, IntArray


class MorphError(GeometryError):
    """A mesh cannot follow its geometry: the geometry needs a new mesh."""


@dataclass(frozen=True)
class Plane:
    """A rectangle normal to an axis: its place and its extent."""

    axis: int
    at: float
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along z: axis in x and y, radius, span in z."""

    center: FloatArray
    radius: float
    span: tuple[float, float]


def carried(places: FloatArray, before: Cylinder, after: Cylinder) -> FloatArray:
    """Displacements in x and y of points of a cylinder that moves [m]."""
    return np.asarray(
        after.center - before.center + (after.radius / before.radius - 1.0) * (places[:, :2] - before.center)
    )


def on_cylinders(
    places: FloatArray, cylinders: list[Cylinder], slack: float
) -> tuple[npt.NDArray[np.bool_], list[tuple[int, npt.NDArray[np.bool_]]]]:
    """Find the facets whose corners lie on a cylinder, and the cylinder of each."""
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


def check_faces(box: BoxGeometry) -> None:
    """Refuse a box with fillets or bolt circles, whose faces do not follow from its dimensions alone."""
    if box.fillets.inside or box.fillets.outside:
        raise MorphError("a box with rounded edges: its mesh is not moved, its dimensions cannot be fitted")
    if box.bolts or (box.feet is not None and box.feet.bolt_patch is not None):
        raise MorphError("a box with circles of bolts: its mesh is not moved, its dimensions cannot be fitted")


def parts_of(box: BoxGeometry) -> tuple[object, ...]:
    """Features that two geometries must share so that the mesh of one can be morphed to the other."""
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


def planes_of(box: BoxGeometry) -> list[Plane]:
    """Return the plane faces of the blocks and bosses of a box."""
    planes = []
    for block in _blocks(box):
        low, high = np.array(block.low), np.array(block.high)
        for axis in range(3):
            for at in (low[axis], high[axis]):
                near, far = low.copy(), high.copy()
                near[axis] = far[axis] = at
                planes.append(Plane(axis, float(at), near, far))
    for bore in box.bores:
        if bore.boss is not None:
            start, end = box.bore_span(bore)
            at = start if box.end_wall(bore) == "back" else end
            x, y, _ = bore.center
            r = bore.boss.diameter / 2
            planes.append(Plane(2, at, np.array([x - r, y - r, at]), np.array([x + r, y + r, at])))
    return planes


def cylinders_of(box: BoxGeometry) -> list[Cylinder]:
    """Return the cylinders of the bores and bosses of a box."""
    cylinders = []
    for bore in box.bores:
        center, span = np.array(bore.center[:2]), box.bore_span(bore)
        cylinders.append(Cylinder(center, bore.diameter / 2, span))
        if bore.boss is not None:
            cylinders.append(Cylinder(center, bore.boss.diameter / 2, span))
    return cylinders


_LEAST_NORMAL_COSINE = 1.0 - 1e-6  # cosine from which a facet is normal to an axis


class BoxMorph:
    """Morphing of a box's mesh to other dimensions.

    Parameters
    ----------
    mesh : Mesh
        Tetrahedra, of :func:`gearwhine.meshes.mesh_box` or moved by an earlier morph.
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
                & (np.abs(normals[:, plane.axis]) > _LEAST_NORMAL_COSINE)
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
        shifts = np.full_like(points, np.nan)
        for axis, number, nodes in self._on_plane:
            shift = others[number].at - planes[number].at
            self._give(shifts, nodes, axis, np.full(len(nodes), shift))
        for number, nodes, _ in self._round:
            for axis in range(2):
                self._give(shifts, nodes, axis, carried(points[nodes], cylinders[number], turned[number])[:, axis])
        for axis, harmonic in enumerate(self._harmonic):
            moved[self._vertices, axis] = harmonic.extended(shifts[self._vertices, axis])
        moved = with_middles(self._mesh, moved)
        for number, _, nodes in self._round:
            moved[nodes, :2] = carried(points[nodes], cylinders[number], turned[number])
        return moved

    def moved(self, geometry: BoxGeometry) -> Mesh:
        """Return the mesh morphed to another geometry.

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
        is_given = np.zeros(len(self._mesh.points), dtype=bool)
        for plane_axis, _, nodes in self._on_plane:
            if plane_axis == axis:
                is_given[nodes] = True
        for _, nodes, _ in self._round:
            if axis < 2:
                is_given[nodes] = True
        return np.asarray(is_given[self._vertices])

    def _give(self, shifts: FloatArray, nodes: IntArray, axis: int, shift: FloatArray) -> None:
        before = shifts[nodes, axis]
        apart = np.abs(before - shift) > 1e-9 * max(self._geometry.size)
        if (apart & ~np.isnan(before)).any():
            x, y, z = self._mesh.points[nodes[np.argmax(apart & ~np.isnan(before))]]
            raise MorphError(
                f"faces that meet flush at ({x:.4g}, {y:.4g}, {z:.4g}) m would part along {'xyz'[axis]}: mesh it anew"
            )
        shifts[nodes, axis] = shift


class _Harmonic:
    """Harmonic extension of a component from given corners to all of them: ∇²u = 0 by linear tetrahedra."""

    def __init__(self, mesh: Mesh, vertices: IntArray, prescribed: npt.NDArray[np.bool_]) -> None:
        laplacian = _laplacian(mesh)[vertices][:, vertices]
        self._prescribed = prescribed
        self._coupling = laplacian[~prescribed][:, prescribed]
        free = sparse.csc_array(laplacian[~prescribed][:, ~prescribed])
        self._factor = splu(free) if free.shape[0] else None

    def extended(self, values: FloatArray) -> FloatArray:
        whole = values.copy()
        if self._factor is not None:
            whole[~self._prescribed] = self._factor.solve(-(self._coupling @ values[self._prescribed]))
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


def with_middles(mesh: Mesh, moved: FloatArray) -> FloatArray:
    """Motions of the corners, and half the sum of both ends' for the middle of each edge."""
    for block in mesh.blocks:
        places, corners = np.array(block.of.places), block.of.n_corners
        for first, second in combinations(range(corners), 2):
            middle = np.flatnonzero(np.abs(places[corners:] - (places[first] + places[second]) / 2).max(axis=1) < 1e-12)
            for local in middle:
                nodes = block.nodes
                moved[nodes[:, corners + local]] = (moved[nodes[:, first]] + moved[nodes[:, second]]) / 2
    return moved
