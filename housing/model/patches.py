"""Patches of the surface: the rigid motion of each as a port of the nodes' displacements; rigid-body properties.

Rigid motions of points, with a mass matrix, give mass, centre of gravity and inertia of the body.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.matrices import NOTHING, Matrices, NodeBlocks
from gearwhine.housing.fem.nearest_point import SurfacePoint
from gearwhine.housing.fem.surface import SurfaceQuadrature, surface_quadrature
from gearwhine.meshes import Mesh, box_facets, circle_facets, plane_facets
from gearwhine.meshes.elements import Facets
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.numerics.own_copies import keep_tuples


def rigid_motions(points: FloatArray, center: FloatArray) -> FloatArray:
    """Return the rigid motions of points: displacement R r = translation + rotation x (x - centre).

    Parameters
    ----------
    points : ndarray, shape (..., 3)
        Points [m].
    center : ndarray, shape (3,)
        Centre [m].

    Returns
    -------
    ndarray, shape (..., 3, 6)
        Columns: translations along x, y, z, rotations about x, y, z through the centre.
    """
    x, y, z = np.moveaxis(points - center, -1, 0)
    motions = np.zeros((*points.shape, 6))
    motions[..., :3] = np.eye(3)
    motions[..., 0, 4], motions[..., 0, 5] = z, -y
    motions[..., 1, 3], motions[..., 1, 5] = -z, x
    motions[..., 2, 3], motions[..., 2, 4] = y, -x
    return motions


@dataclass(frozen=True)
class RigidBody:
    """Mass, centre of gravity and inertia of a body.

    Attributes
    ----------
    mass : float
        Mass [kg].
    center : ndarray, shape (3,)
        Centre of gravity [m].
    inertia : ndarray, shape (3, 3)
        Inertia tensor ∫ (|r|² I - r rᵀ) dm about the centre of gravity [kg m²].
    """

    mass: float
    center: FloatArray
    inertia: FloatArray

    def matrix(self, about: FloatArray) -> FloatArray:
        """M₆ [kg, kg m, kg m²] about a point [m], shape (6, 6): ½ ṙᵀ M₆ ṙ is the kinetic energy of a rigid motion r."""
        at_center = np.zeros((6, 6))
        at_center[:3, :3], at_center[3:, 3:] = self.mass * np.eye(3), self.inertia
        motion = np.eye(6)
        motion[:3] = rigid_motions(self.center, about)
        return np.asarray(motion.T @ at_center @ motion)


def rigid_body(points: FloatArray, matrices: Matrices) -> RigidBody:
    """Mass, centre of gravity and inertia of a housing with all its attached masses, from its mass matrix.

    M₆ = Rᵀ M R with the rigid field R of the nodes, which isoparametric elements hold exactly.

    Parameters
    ----------
    points : ndarray, shape (n_nodes, 3)
        Places of the nodes [m].
    matrices : Matrices
    """
    middle = points.mean(axis=0)
    field = rigid_motions(points, middle).reshape(-1, 6)
    whole = field.T @ (matrices.mass_operator @ field)
    mass = float(np.trace(whole[:3, :3])) / 3.0
    # The off-diagonal block is -m [arm]x, the matrix of the cross product with the arm from the middle to the centre.
    moment = 0.5 * (whole[:3, 3:] - whole[:3, 3:].T)
    arm = np.array([moment[1, 2], moment[2, 0], moment[0, 1]]) / mass
    inertia = whole[3:, 3:] - mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return RigidBody(mass, middle + arm, 0.5 * (inertia + inertia.T))


Point = tuple[float, float, float]

_FLATTEST = 1e-8  # least of the patch's second moments as a part of the largest: a strip 10⁴ times as long as wide
_FARTHEST = 1e4  # radii of a patch between it and its centre at most: beyond, a translation is all rotation


@dataclass(frozen=True)
class Patch:
    """A part of the surface: a named surface of the mesh, the facets in a box, on a plane, or in a circle.

    Attributes
    ----------
    surface : str, optional
        Name of a surface of the mesh.
    box : tuple of two points, optional
        Low and high corners of a box [m]; the facets inside belong to the patch.
    plane : tuple of two points, optional
        A point of it [m] and its normal; the facets on it belong to the patch.
    circle : tuple of center, normal and diameter, optional
        Circle in a flat face, with the face's outward normal [m]; see :func:`gearwhine.meshes.circle_facets`.
    """

    surface: str | None = None
    box: tuple[Point, Point] | None = None
    plane: tuple[Point, Point] | None = None
    circle: tuple[Point, Point, float] | None = None

    def __post_init__(self) -> None:
        """Check that the patch is given in exactly one way."""
        keep_tuples(self, "box", "plane", "circle")
        if sum(place is not None for place in (self.surface, self.box, self.plane, self.circle)) != 1:
            raise HousingError("a patch needs a surface, a box, a plane or a circle, one of the four")

    def facets(self, mesh: Mesh) -> Facets:
        """Return the facets of the patch.

        Raises
        ------
        gearwhine.meshes.GeometryError
            Where the mesh has no such surface, or no facet lies in the box, on the plane or in the circle.
        """
        if self.surface is not None:
            return mesh.surface(self.surface)
        if self.box is not None:
            return box_facets(mesh, *self.box)
        if self.plane is not None:
            return plane_facets(mesh, *self.plane)
        assert self.circle is not None
        return circle_facets(mesh, *self.circle)

    def center(self, mesh: Mesh) -> FloatArray:
        """Return the centre of the patch's area [m], shape (3,)."""
        return patch_center(mesh, self.facets(mesh))


def patch_center(mesh: Mesh, facets: Facets) -> FloatArray:
    """Return the centre of the area of some facets [m], shape (3,)."""
    parts, area = _quadrature(mesh, facets)
    return np.asarray(sum(np.einsum("fqi,fq->i", part.points, part.areas) for part in parts) / area)


def patch_matrix(mesh: Mesh, facets: Facets, center: FloatArray | None = None, *, name: str = "") -> sparse.csr_array:
    """Assemble the matrix P of a patch, which gives its rigid motion from the nodes' displacements.

    The six motions r = (translation, rotation) minimise ∫ |u - R r|² dA over the patch, with R the rigid field
    R r = translation + rotation x (x - centre): P = (∫ Rᵀ R dA)⁻¹ ∫ Rᵀ N dA. So the patch may deform; a load on it
    is spread by Pᵀ, and the work is the same on both sides. The problem is solved about the middle of the patch, where
    it is best posed, and the motion is then taken at the centre as a rigid body's.

    Parameters
    ----------
    mesh : Mesh
    facets : tuple of ElementBlock
    center : ndarray, shape (3,), optional
        The point whose translations come first [m]; the middle of the patch where not given.
    name : str
        Owner of the patch, for the message.

    Returns
    -------
    scipy.sparse.csr_array, shape (6, 3 n_nodes)

    Raises
    ------
    HousingError
        Where the patch does not span a rigid motion, or is too small for a centre so far away.
    """
    middle = patch_center(mesh, facets)
    parts, area = _quadrature(mesh, facets)
    fields = [rigid_motions(part.points, middle) for part in parts]
    gram = np.zeros((6, 6))
    for part, rigid in zip(parts, fields, strict=True):
        gram += np.einsum("fqir,fqis,fq->rs", rigid, rigid, part.areas, optimize=True)
    moments = np.linalg.eigvalsh(gram[3:, 3:])
    radius = np.sqrt(moments[-1] / area)
    arm = 0.0 if center is None else float(np.linalg.norm(center - middle))
    if moments[0] < _FLATTEST * moments[-1] or arm > _FARTHEST * radius:
        raise HousingError(f"the surface of {name or 'a patch'} is too small to tell its rotations")
    loads, columns = [], []
    for part, rigid in zip(parts, fields, strict=True):
        load = np.einsum("fqir,qa,fq->rfai", rigid, part.shape_values, part.areas, optimize=True)
        loads.append(load.reshape(6, -1))
        columns.append((3 * part.facets[:, :, None] + np.arange(3)).ravel())
    weights = np.asarray(np.linalg.solve(gram, np.concatenate(loads, axis=1)), dtype=np.float64)
    if center is not None:
        weights[:3] = rigid_motions(center, middle) @ weights
    return _port(weights, np.concatenate(columns), mesh)


def ring_matrix(mesh: Mesh, facets: Facets, center: FloatArray, orders: int) -> sparse.csr_array:
    """Assemble the deformation of a bore about z beside its rigid motion, by harmonics of its circumference.

    The radial and the tangential displacement over the angle θ about the bore's axis are, in the mean over its length,

        u_r = a₀ + Σ (a_n cos nθ + b_n sin nθ),        u_t = c₀ + Σ (c_n cos nθ + d_n sin nθ),

    of what is left of the displacement without the rigid motion of the whole patch.

    Parameters
    ----------
    mesh : Mesh
    facets : Facets
        Facets of the bore.
    center : ndarray, shape (3,)
        Point of its axis [m].
    orders : int
        Highest order n.

    Returns
    -------
    scipy.sparse.csr_array, shape (2 + 4 orders, 3 n_nodes)
        Rows a₀, c₀, and a_n, b_n, c_n, d_n of each order.
    """
    parts, _ = _quadrature(mesh, facets)
    loads, columns, squares = [], [], np.zeros(2 + 4 * orders)
    for part in parts:
        x, y = (part.points[..., axis] - center[axis] for axis in (0, 1))
        angle = np.arctan2(y, x)
        outward = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        along = np.stack([-np.sin(angle), np.cos(angle), np.zeros_like(angle)], axis=-1)
        waves = [(np.ones_like(angle), axis) for axis in (outward, along)]
        for order in range(1, orders + 1):
            waves += [(wave(order * angle), axis) for axis in (outward, along) for wave in (np.cos, np.sin)]
        fields = np.stack([wave[..., None] * axis for wave, axis in waves])
        squares += np.einsum("rfqi,rfqi,fq->r", fields, fields, part.areas, optimize=True)
        load = np.einsum("rfqi,qa,fq->rfai", fields, part.shape_values, part.areas, optimize=True)
        loads.append(load.reshape(len(fields), -1))
        columns.append((3 * part.facets[:, :, None] + np.arange(3)).ravel())
    deformed = _port(np.concatenate(loads, axis=1) / squares[:, None], np.concatenate(columns), mesh)
    rigid = sparse.csr_array(rigid_motions(mesh.points, center).reshape(-1, 6))
    return sparse.csr_array(deformed - (deformed @ rigid) @ patch_matrix(mesh, facets, center))


def point_matrix(mesh: Mesh, point: SurfacePoint) -> sparse.csr_array:
    """Assemble the translations of a surface point, shape (3, 3 n_nodes); a point of a solid has no rotation."""
    columns = (3 * point.nodes[:, None] + np.arange(3)).ravel()
    return _port(np.asarray(np.kron(point.weights, np.eye(3)), dtype=np.float64), columns, mesh)


def points_matrix(mesh: Mesh, points: Sequence[SurfacePoint]) -> sparse.csr_array:
    """Assemble the translations of n surface points, shape (3 n, 3 n_nodes): rows of :func:`point_matrix` in turn."""
    axes = np.arange(3)
    rows = 3 * np.repeat(np.arange(len(points)), [len(point.nodes) for point in points])[:, None] + axes
    columns = 3 * np.concatenate([point.nodes for point in points])[:, None] + axes
    values = np.repeat(np.concatenate([point.weights for point in points]), 3)
    shape = (3 * len(points), 3 * len(mesh.points))
    return sparse.csr_array((values, (rows.ravel(), columns.ravel())), shape=shape)


def spread(mesh: Mesh, facets: Facets, amounts: Point) -> NodeBlocks:
    """Spread amounts along x, y, z evenly over a patch of area A: blocks (1 / A) ∫ N_a N_b dA diag(amounts).

    A translation of the whole patch meets the whole amounts; the energy is that of the field, not of single nodes.
    """
    parts, area = _quadrature(mesh, facets)
    blocks = NOTHING
    for part in parts:
        products = np.einsum("fq,qa,qb->fab", part.areas, part.shape_values, part.shape_values) / area
        n_shape = part.facets.shape[1]
        blocks = blocks + NodeBlocks.summed(
            np.repeat(part.facets, n_shape, axis=1).ravel(),
            np.tile(part.facets, n_shape).ravel(),
            products.ravel()[:, None, None] * np.diag(amounts),
        )
    return blocks


def _quadrature(mesh: Mesh, facets: Facets) -> tuple[tuple[SurfaceQuadrature, ...], float]:
    """Quadrature on each kind of facet of a patch, and its whole area [m²]."""
    parts = surface_quadrature(mesh, facets)
    area = sum(part.area for part in parts)
    if not area > 0.0:
        raise HousingError("a patch of no facets has no area; name a surface that has some")
    return parts, area


def _port(weights: FloatArray, columns: IntArray, mesh: Mesh) -> sparse.csr_array:
    """Assemble a port from its weights, shape (n_motions, n), on degrees of freedom that may come several times."""
    motions = len(weights)
    entries = (weights.ravel(), (np.repeat(np.arange(motions), len(columns)), np.tile(columns, motions)))
    return sparse.csr_array(sparse.coo_array(entries, shape=(motions, 3 * len(mesh.points))))
