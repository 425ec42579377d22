"""Ports: the few motions of the housing that the rest of the machine sees.

A bearing seat moves as the rigid motion nearest to its surface's own, in the mean over the area; a sensor moves
as the point it is glued to. Both are linear in the nodes' displacements u, ``motion = P u``, and a load on the
port acts on the nodes by the transpose, so the work done is the same on both sides.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse

from housing.errors import HousingError
from housing.surface import surface_point, surface_quadrature
from meshes import Mesh

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Seat:
    """A bearing seat: six motions of a named surface about a centre.

    Attributes
    ----------
    name : str
        Its surface in the mesh.
    center : tuple of float
        The point whose translations x, y, z come first, followed by the rotations about x, y, z [m].
    """

    name: str
    center: tuple[float, float, float]


@dataclass(frozen=True)
class Sensor:
    """An accelerometer on the surface.

    Attributes
    ----------
    name : str
    position : tuple of float
        [m]; the nearest point of the surface is taken.
    direction : tuple of float, optional
        Where it points, of any length; the outward normal where not given.
    """

    name: str
    position: tuple[float, float, float]
    direction: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class SensorPort:
    """A sensor on its mesh.

    Attributes
    ----------
    name : str
    matrix : scipy.sparse.csr_array, shape (1, 3 n_nodes)
        Motion along the direction from the nodes' displacements.
    position, direction : ndarray, shape (3,)
        The place on the surface [m] and the unit vector.
    distance : float
        From the place asked for to the place found [m].
    """

    name: str
    matrix: sparse.csr_array
    position: FloatArray
    direction: FloatArray
    distance: float


def seat_matrix(mesh: Mesh, seat: Seat) -> sparse.csr_array:
    """The rigid motion of a seat from the nodes' displacements.

    The six motions r = (translation, rotation) minimise ∫ |u - R r|² dA over the seat's surface, with R the
    rigid field R r = translation + rotation x (x - centre): P = (∫ Rᵀ R dA)⁻¹ ∫ Rᵀ N dA.

    Returns
    -------
    scipy.sparse.csr_array, shape (6, 3 n_nodes)

    Raises
    ------
    HousingError
        Where the seat's surface does not span a rigid motion.
    """
    patches = surface_quadrature(mesh, mesh.surface(seat.name))
    fields = [_rigid_fields(patch.points - np.array(seat.center)) for patch in patches]
    gram = np.zeros((6, 6))
    for patch, rigid in zip(patches, fields, strict=True):
        gram += np.einsum("fqir,fqis,fq->rs", rigid, rigid, patch.areas)
    scale = np.sqrt(np.outer(gram.diagonal(), gram.diagonal()))
    if not (scale > 0.0).all() or np.linalg.cond(gram / scale) > 1e8:
        raise HousingError(f"the surface of seat {seat.name!r} is too small to tell its rotations")
    parts = []
    for patch, rigid in zip(patches, fields, strict=True):
        loads = np.einsum("fqir,qa,fq->rfai", rigid, patch.shape_values, patch.areas, optimize=True)
        weights = np.linalg.solve(gram, loads.reshape(6, -1))
        columns = (3 * patch.facets[:, :, None] + np.arange(3)).ravel()
        entries = (weights.ravel(), (np.repeat(np.arange(6), len(columns)), np.tile(columns, 6)))
        parts.append(sparse.csr_array(sparse.coo_array(entries, shape=(6, 3 * len(mesh.points)))))
    return sparse.csr_array(sum(parts[1:], parts[0]))


def _rigid_fields(arm: FloatArray) -> FloatArray:
    """Displacements of six rigid motions at places relative to the centre, shape (..., 3) to (..., 3, 6)."""
    rigid = np.zeros((*arm.shape, 6))
    rigid[..., :3] = np.eye(3)
    x, y, z = np.moveaxis(arm, -1, 0)
    rigid[..., 0, 4], rigid[..., 0, 5] = z, -y
    rigid[..., 1, 3], rigid[..., 1, 5] = -z, x
    rigid[..., 2, 3], rigid[..., 2, 4] = y, -x
    return rigid


def sensor_port(mesh: Mesh, sensor: Sensor) -> SensorPort:
    """Put a sensor on the surface of the mesh.

    Raises
    ------
    HousingError
        Where its direction has no length.
    """
    place = np.array(sensor.position)
    point = surface_point(mesh, mesh.boundary, place)
    direction = point.normal if sensor.direction is None else np.array(sensor.direction, dtype=np.float64)
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        raise HousingError(f"sensor {sensor.name!r}: its direction has no length")
    direction = direction / length
    columns = (3 * point.nodes[:, None] + np.arange(3)).ravel()
    values = np.outer(point.weights, direction).ravel()
    entries = (values, (np.zeros(len(columns), dtype=np.int64), columns))
    return SensorPort(
        name=sensor.name,
        matrix=sparse.csr_array(sparse.coo_array(entries, shape=(1, 3 * len(mesh.points)))),
        position=point.position,
        direction=direction,
        distance=float(np.linalg.norm(point.position - place)),
    )
