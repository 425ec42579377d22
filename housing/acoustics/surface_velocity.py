"""Normal velocity of a radiating surface from the motion of a housing's nodes, and the faces that its triangles lie on.

Each triangle's normal velocity is linear over it. It is the L2 projection of the skin's: with the shape functions phi
of the triangle, the values q at its corners solve ``sum_j q_j int phi_i phi_j dA = int phi_i (n . v) dA``, where v is
the velocity of the nearest point of the skin that looks the same way, and n the triangle's normal.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from gearwhine.housing.acoustics.radiating_surface import RadiatingSurface
from gearwhine.housing.acoustics.skin import NearestSkin, Skin, skin_of
from gearwhine.housing.acoustics.skin_points import FacetPoints, SkinPoints
from gearwhine.housing.errors import TriangleSizeError
from gearwhine.housing.fem.outer_facets import triangle_middles
from gearwhine.housing.fem.surface import boundary_members, flat_face_names, flat_face_numbers, nearest_axis
from gearwhine.meshes import Mesh
from gearwhine.meshes.elements import Facets, facet_centers, facet_normals
from gearwhine.meshes.shape_functions import quadrature, shape_functions
from gearwhine.numerics.arrays import BoolArray, FloatArray, IntArray

_RULE_POINTS, _RULE_WEIGHTS = quadrature("triangle", 4)
_SHARES = np.stack([1.0 - _RULE_POINTS.sum(axis=0), *_RULE_POINTS], axis=1)  # shape functions at the six points
_WEIGHTS = _RULE_WEIGHTS / _RULE_WEIGHTS.sum()
# Corner values from values at the points: the inverse of the mass matrix area (1 + delta_ij) / 12, times the load.
_PROJECTION = 12.0 * (np.eye(3) - 0.25) @ (_SHARES * _WEIGHTS[:, None]).T

_CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])  # corners of a triangle in its own coordinates

_SPACING = 0.35  # edges between the samples of a skin
_TURNED = 0.5  # edges that a skin at a right angle counts as farther, over sqrt(2)
_BESIDE = 0.1  # edges that a point of a cap lies beside the skin, across its normal
_PARTS = 8  # a triangle's edges are cut into these parts for the area of what it closes
_GRAZING = 1e-3  # cosine between skin and normal below which a line does not meet the skin, but runs along it
_EDGEWISE = 1e-6  # part of a skin triangle by which a line may miss it at its edge
_ON = 0.35  # edges that the skin and the wrap may lie apart where both are compared
_SAME_WAY = 0.7  # least cosine between their normals there
_LABELLED_FACE_AREA = 0.02  # part of the surface's area above which a flat face has a label of its own


@dataclass(frozen=True)
class SurfaceVelocity:
    """Nearest points of a housing's skin for a radiating surface, and the velocity that follows from them.

    Attributes
    ----------
    mesh : Mesh
    surface : RadiatingSurface
    skin : Skin
        Skin of the mesh's boundary.
    nearest : NearestSkin
        Nearest points of the six points of each triangle, triangle after triangle.
    resting_caps : bool
        Whether what closes holes is at rest. Else it moves as the rim that is nearest, as covers and bearings do.
    """

    mesh: Mesh
    surface: RadiatingSurface
    skin: Skin
    nearest: NearestSkin
    resting_caps: bool = False

    @cached_property
    def facets(self) -> IntArray:
        """Boundary facet that each point of a triangle moves with, shape (n_triangles, 6)."""
        return self.skin.facet[self.nearest.triangles].reshape(-1, len(_WEIGHTS))

    @cached_property
    def edge(self) -> float:
        """Edge of an equilateral triangle of the mean area [m]."""
        return float(np.sqrt(4.0 / np.sqrt(3.0) * self.surface.area / len(self.surface.triangles)))

    @cached_property
    def _cap_points(self) -> BoolArray:
        """Points that lie beside the skin and not before it, shape (n_triangles, 6)."""
        gap = (_places(self.surface) - self.nearest.points).reshape(-1, len(_WEIGHTS), 3)
        ahead = np.einsum("epi,ei->ep", gap, self.surface.normals)
        beside = np.sqrt(np.maximum((gap**2).sum(axis=2) - ahead**2, 0.0))
        return np.asarray(beside > _BESIDE * self.edge)

    @cached_property
    def caps(self) -> BoolArray:
        """Triangles that close a hole for the most part, shape (n_triangles,)."""
        return np.asarray(self._cap_points @ _WEIGHTS > 0.5)

    @cached_property
    def _over_holes(self) -> BoolArray:
        """Points of the triangles over a hole, shape (n_triangles, 6)."""
        over = np.zeros(self._cap_points.shape, dtype=bool)
        for triangle in self._near_caps.tolist():
            over[triangle] = self._over_hole(triangle, _SHARES)
        return over

    @cached_property
    def cap_area(self) -> float:
        """Area of the surface over holes [m²]."""
        shares = triangle_middles(_PARTS)
        parts = [self.surface.areas[one] * self._over_hole(one, shares).mean() for one in self._near_caps.tolist()]
        return float(sum(parts))

    @cached_property
    def _near_caps(self) -> IntArray:
        """Triangles that close holes, and those that share a vertex with them."""
        touched = np.zeros(len(self.surface.points), dtype=bool)
        touched[self.surface.triangles[self._cap_points.any(axis=1)]] = True
        return np.flatnonzero(touched[self.surface.triangles].any(axis=1))

    @cached_property
    def _skin_tree(self) -> tuple[cKDTree, float]:
        """Tree of the middles of the skin's triangles, and the largest distance of a corner from its middle [m]."""
        middles = self.skin.corners.mean(axis=1)
        reach = float(np.linalg.norm(self.skin.corners - middles[:, None], axis=2).max())
        return cKDTree(middles), reach

    def _over_hole(self, triangle: int, shares: FloatArray) -> BoolArray:
        """Whether the line along its normal through each point of a triangle meets no skin that looks its way.

        Points by their shares of the corners, shape (n, 3). Skin farther off than an edge is that of another wall.
        """
        corners, normal = self.surface.corners[triangle], self.surface.normals[triangle]
        tree, size = self._skin_tree
        middle = corners.mean(axis=0)
        reach = float(np.linalg.norm(corners - middle, axis=1).max()) + self.edge + size
        near = np.array(tree.query_ball_point(middle, reach), dtype=np.int64)
        near = near[self.skin.normals[near] @ normal > _GRAZING]
        first, *others = np.moveaxis(self.skin.corners[near], 1, 0)
        # p + t n = a + u (b - a) + v (c - a) for every point p and skin triangle a b c.
        frame = np.stack([others[0] - first, others[1] - first, np.broadcast_to(-normal, first.shape)], axis=2)
        # u, v and t of a point are means of those of the corners by its shares.
        at_corners = np.linalg.inv(frame) @ (corners.T - first[:, :, None])
        u, v, t = np.moveaxis(at_corners @ shares.T, 1, 0)
        met = (u >= -_EDGEWISE) & (v >= -_EDGEWISE) & (u + v <= 1.0 + _EDGEWISE) & (np.abs(t) <= self.edge)
        return np.asarray(~met.any(axis=0))

    @cached_property
    def distances(self) -> FloatArray:
        """Distance of each vertex outside the caps from the skin [m]; 0 in caps."""
        free = np.ones(len(self.surface.points), dtype=bool)
        free[self.surface.triangles[self.caps]] = False
        distances = np.zeros(len(free))
        # The corners of a triangle look its way; the least distance of a vertex by any of them counts.
        corners = self.surface.triangles
        places, normals = self.surface.points[corners].reshape(-1, 3), np.repeat(self.surface.normals, 3, axis=0)
        away = self.skin.nearest(places, normals, _SPACING * self.edge, _TURNED * self.edge).distances
        least = np.full(len(free), np.inf)
        np.minimum.at(least, corners.ravel(), away)
        distances[free] = least[free]
        return distances

    def transfer(self, without: Sequence[str | Facets] = ()) -> sparse.csr_array:
        """Matrix from nodal velocities to normal velocities at the corners of the triangles.

        Parameters
        ----------
        without : sequence of str or of facets
            Surfaces that do not radiate, such as the soles of feet on a floor: named surfaces of the mesh or their
            facets. The normal velocity is 0 there.

        Returns
        -------
        csr_array, shape (3 n_triangles, 3 n_nodes)
            Corners triangle after triangle; velocities x, y, z node after node.

        Raises
        ------
        gearwhine.meshes.GeometryError
            Where the mesh has no surface of a name.
        """
        return self.points(without).transfer

    def points(self, without: Sequence[str | Facets] = ()) -> SkinPoints:
        """Points of the skin that the triangles move with; see :meth:`transfer`."""
        facets = self.facets.ravel()
        silent = np.isin(facets, boundary_members(self.mesh, without))
        if self.resting_caps:
            silent |= self._over_holes.ravel()
        groups, first = [], 0
        for block in self.mesh.boundary:
            chosen = np.flatnonzero((facets >= first) & (facets < first + len(block)) & ~silent)
            if len(chosen):
                triangles, shares = self.nearest.triangles[chosen], self.nearest.shares[chosen]
                reference = self.skin.places[triangles]
                shape, gradients = shape_functions(block.kind, np.einsum("pk,pki->ip", shares, reference))
                nodes = block.nodes[facets[chosen] - first]
                groups.append(
                    FacetPoints(chosen, nodes, shape, gradients, self.skin.nodes[triangles], reference, shares)
                )
            first += len(block)
        normals = np.repeat(self.surface.normals, len(_WEIGHTS), axis=0)
        project = sparse.kron(sparse.eye_array(len(self.surface.triangles)), _PROJECTION, format="csr")
        return SkinPoints(self.mesh.points, tuple(groups), normals, project)

    def face_of_triangles(self) -> list[str]:
        """Label of the housing's face that each triangle lies on.

        A face has the name of the mesh's surface that holds most of it, as ``top``. Another flat face of at least
        2 % of the surface has that of its place, ``+y at 0, 10, 0 mm``, and the rest is ``other (+y)``.
        Triangles over holes are ``cap``.
        """
        share = np.repeat(self.surface.areas, len(_WEIGHTS)) * np.tile(_WEIGHTS, len(self.surface.triangles))
        numbers = flat_face_numbers(self.mesh)
        area = np.bincount(numbers[self.facets.ravel()], share, numbers.max() + 1)
        faces = flat_face_names(self.mesh)
        labelled = [
            face.is_surface or area[number] > _LABELLED_FACE_AREA * self.surface.area
            for number, face in enumerate(faces)
        ]
        middle = self.facets[:, int(np.argmax(_WEIGHTS))]
        labels = []
        for e, facet in enumerate(middle.tolist()):
            axis = nearest_axis(self.surface.normals[e])
            number = numbers[facet]
            label = faces[number].name if labelled[number] else f"other ({axis})"
            labels.append("cap" if self.caps[e] else label)
        return labels


def surface_velocity(mesh: Mesh, surface: RadiatingSurface, *, resting_caps: bool = False) -> SurfaceVelocity:
    """Find the points of a housing's skin that a radiating surface moves with.

    Parameters
    ----------
    mesh : Mesh
        The housing's finite elements.
    surface : RadiatingSurface
        Radiating surface around the housing.
    resting_caps : bool
        See :class:`SurfaceVelocity`.
    """
    skin = skin_of(mesh, mesh.boundary)
    edge = float(np.sqrt(4.0 / np.sqrt(3.0) * surface.area / len(surface.triangles)))
    normals = np.repeat(surface.normals, len(_WEIGHTS), axis=0)
    return SurfaceVelocity(
        mesh, surface, skin, skin.nearest(_places(surface), normals, _SPACING * edge, _TURNED * edge), resting_caps
    )


def velocity_transfer(mesh: Mesh, surface: RadiatingSurface, without: Sequence[str | Facets] = ()) -> sparse.csr_array:
    """Matrix from nodal velocities to normal velocities at corners; see :meth:`SurfaceVelocity.transfer`."""
    return surface_velocity(mesh, surface).transfer(without)


@dataclass(frozen=True)
class TransferError:
    """Mean-square normal velocity of shapes on a radiating surface, compared with that on the skin.

    Attributes
    ----------
    on_surface, on_skin : ndarray, shape (n,)
        Integral of the squared normal velocity over both, without caps, for each shape.
    surface_area, skin_area : float
        Areas compared [m²].
    """

    on_surface: FloatArray
    on_skin: FloatArray
    surface_area: float
    skin_area: float

    @property
    def relative(self) -> FloatArray:
        """Relative error of each shape, shape (n,): positive where the radiating surface moves more."""
        return self.on_surface / self.on_skin - 1.0

    def require(self, bound: float = 0.1) -> None:
        """Refuse a surface that is too coarse for the shapes.

        Raises
        ------
        TriangleSizeError
            Where the median of the errors' sizes is above the bound.
        """
        sizes = np.abs(self.relative)
        if not np.median(sizes) <= bound:
            worst = int(np.argmax(sizes))
            raise TriangleSizeError(
                f"the radiating surface carries the mean-square normal velocity of the {len(sizes)} shapes with a "
                f"median error of {100 * np.median(sizes):.3g} %, the worst {100 * self.relative[worst]:+.3g} % of "
                f"shape {worst + 1}; expected at most {100 * bound:.3g} %: take triangles with shorter edges"
            )


def transfer_error(velocity: SurfaceVelocity, shapes: FloatArray) -> TransferError:
    """Compare the mean-square normal velocity of shapes on the radiating surface with that on the skin.

    Parameters
    ----------
    velocity : SurfaceVelocity
    shapes : ndarray, shape (n, n_nodes, 3)
        Mode shapes.

    Notes
    -----
    The skin is that part of the boundary whose facets lie near the radiating surface and look its way; on it the
    integral is exact for the elements' shape functions.
    """
    mesh, surface = velocity.mesh, velocity.surface
    normal = (velocity.transfer() @ shapes.reshape(len(shapes), -1).T).reshape(len(surface.triangles), 3, -1)
    # int q² dA = area / 12 (sum q_i² + (sum q_i)²)
    squares = surface.areas[:, None] / 12.0 * ((normal**2).sum(axis=1) + normal.sum(axis=1) ** 2)
    edge = velocity.edge
    wrapped = _triangle_skin(surface)
    on_skin, area = np.zeros(len(shapes)), 0.0
    for block in mesh.boundary:
        middle, direction = facet_centers(mesh.points, (block,)), facet_normals(mesh.points, (block,))
        near = wrapped.nearest(middle, direction, _SPACING * edge, _TURNED * edge)
        cosine = (surface.normals[near.triangles] * direction).sum(axis=1)
        facets = block.nodes[(near.distances < _ON * edge) & (cosine > _SAME_WAY)]
        places, weights = quadrature(block.kind, 4)
        values, gradients = shape_functions(block.kind, places)
        tangents = np.einsum("fai,qaj->fqij", mesh.points[facets], gradients, optimize=True)
        # n dA without its length: (n . u)² dA is the square of (n dA . u) over dA.
        cross = np.cross(tangents[..., 0], tangents[..., 1])
        size = np.linalg.norm(cross, axis=2)
        flux = np.einsum("nfai,qa,fqi->nfq", shapes[:, facets], values, cross, optimize=True)
        on_skin += np.einsum("nfq,fq,q->n", flux**2, 1.0 / size, weights, optimize=True)
        area += float((size @ weights).sum())
    outside = ~velocity.caps
    return TransferError(squares[outside].sum(axis=0), on_skin, float(surface.areas[outside].sum()), area)


def face_surface(mesh: Mesh, facets: Facets) -> tuple[RadiatingSurface, SkinPoints]:
    """Make a radiating surface of facets themselves, such as those of a flat face.

    Facets are split into triangles between their nodes, and the normal velocity at each corner is that of its node.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
        Facets, seen from outside.

    Returns
    -------
    surface : RadiatingSurface
        Surface of the facets, open if they are.
    points : SkinPoints
        The corners of the triangles.

    Raises
    ------
    HousingError
        Where there are no facets.
    """
    skin = skin_of(mesh, facets)
    used, triangles = np.unique(skin.nodes, return_inverse=True)
    surface = RadiatingSurface(mesh.points[used], triangles.reshape(-1, 3).astype(np.int64))
    count = len(skin.nodes)
    nodes, reference = np.repeat(skin.nodes, 3, axis=0), np.tile(_CORNERS, (3 * count, 1, 1))
    shape, gradients = shape_functions("triangle", np.tile(_CORNERS, (count, 1)).T)
    corners = FacetPoints(np.arange(3 * count), nodes, shape, gradients, nodes, reference, shape)
    normals = np.repeat(surface.normals, 3, axis=0)
    return surface, SkinPoints(mesh.points, (corners,), normals, sparse.eye_array(3 * count, format="csr"))


def _places(surface: RadiatingSurface) -> FloatArray:
    """Places of the six points of each triangle [m], shape (6 n_triangles, 3)."""
    return np.asarray(np.einsum("pc,eci->epi", _SHARES, surface.corners).reshape(-1, 3))


def _triangle_skin(surface: RadiatingSurface) -> Skin:
    """Return the triangles of a radiating surface as a skin."""
    numbers = np.arange(len(surface.triangles))
    places = np.tile(_CORNERS, (len(numbers), 1, 1))
    return Skin(surface.triangles, surface.corners, numbers, places)
