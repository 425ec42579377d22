"""Bearing seats and sensors: the ports at which the rest of the machine meets the housing.

A bearing seat moves as the rigid motion nearest to its surface's own, in the mean over the area; a sensor moves
as the point it is glued to (:mod:`gearwhine.housing.model.patches`). Both are linear in the nodes' displacements u,
``motion = P u``, and a load on the port acts on the nodes by the transpose, so the work done is the same on both sides.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from gearwhine.housing.errors import HousingError
from gearwhine.housing.fem.nearest_point import surface_point
from gearwhine.housing.model.patches import patch_matrix, point_matrix, ring_matrix
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Number, Numbers, Rule, Text, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples


@dataclass(frozen=True)
class Seat:
    """A bearing seat: six motions of a named surface about a centre.

    Attributes
    ----------
    name : str
        Name of its surface in the mesh.
    center : tuple of float
        The point whose translations x, y, z come first, followed by the rotations about x, y, z [m].
    diameter : float, optional
        Diameter of the bore [m], by which the seat is found in a solid or a mesh that does not name its surface.
    depth : float
        Length of the bore with its boss [m], where it is known: a bearing may be off the centre by as much.
    ring_orders : int
        Highest order of the bore's deformation around its circumference that ring teeth in it drive, such as twice the
        number of planets; 0 for the seat of a bearing, which moves as one body.
    """

    name: str
    center: tuple[float, float, float]
    diameter: float | None = None
    depth: float = 0.0
    ring_orders: int = 0

    def __post_init__(self) -> None:
        """Keep own copies; check name, centre and sizes."""
        keep_tuples(self, "center")
        rules: dict[str, Rule] = {
            "name": Text(),
            "center": Numbers(3),
            "diameter": Number(above=0.0, optional=True, unit="m"),
            "depth": Number(at_least=0.0, unit="m"),
            "ring_orders": Number(at_least=0, whole=True),
        }
        refuse(attribute_findings(("seat", str(self.name)), self, **rules), HousingError)

    @property
    def reach(self) -> float | None:
        """Distance along z from the centre within which a bearing sits in it [m]; None without a diameter."""
        return None if self.diameter is None else 0.5 * self.diameter + self.depth


@dataclass(frozen=True)
class Sensor:
    """An accelerometer on the surface.

    Attributes
    ----------
    name : str
    position : tuple of float
        Place [m]; the sensor sits on the nearest point of the surface.
    direction : tuple of float, optional
        Direction, of any length; the outward normal where not given.
    """

    name: str
    position: tuple[float, float, float]
    direction: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        """Keep own copies; check name, place and direction."""
        keep_tuples(self, "position", "direction")
        part = ("sensor", str(self.name))
        rules: dict[str, Rule] = {"name": Text(), "position": Numbers(3)}
        if self.direction is not None:
            rules["direction"] = Numbers(3)
        findings = list(attribute_findings(part, self, **rules))
        if not findings and self.direction is not None and not any(self.direction):
            findings.append(Finding(part, "direction", self.direction, "a vector that has a length"))
        refuse(findings, HousingError)


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
        Distance from the place asked for to the place found [m].
    """

    name: str
    matrix: sparse.csr_array
    position: FloatArray
    direction: FloatArray
    distance: float


def seat_matrix(mesh: Mesh, seat: Seat) -> sparse.csr_array:
    """Assemble the matrix of a bearing seat: the rigid motion at its centre from the nodes' displacements.

    See :func:`gearwhine.housing.model.patches.patch_matrix`.

    Returns
    -------
    scipy.sparse.csr_array, shape (6, 3 n_nodes)

    Raises
    ------
    HousingError
        Where the seat's surface does not span a rigid motion.
    """
    return patch_matrix(mesh, mesh.surface(seat.name), np.array(seat.center), name=f"seat {seat.name!r}")


def ring_port(mesh: Mesh, seat: Seat) -> sparse.csr_array:
    """Return the port of a ring gear in a seat: deformation of its bore by orders, shape (2 + 4 orders, 3 n_nodes).

    See :func:`gearwhine.housing.model.patches.ring_matrix`.
    """
    return ring_matrix(mesh, mesh.surface(seat.name), np.array(seat.center), seat.ring_orders)


def bearing_port(seat: sparse.csr_array, arm: float) -> sparse.csr_array:
    """Return the port of a bearing: motions x, y, z and rotations about x, y from the nodes', shape (5, 3 n_nodes).

    They are those of its seat at a distance from its centre [m]. The transpose spreads a bearing force over the nodes.

    Any bearing can load these; none loads the rotation about z, in which the shaft turns.
    """
    # A rotation about y moves a point above the centre towards +x, one about x towards -y.
    turned = sparse.diags_array([arm, -arm], dtype=np.float64) @ seat[[4, 3]]
    return sparse.csr_array(sparse.vstack([seat[[0, 1]] + turned, seat[[2, 3, 4]]]))


_FARTHEST = 0.1
"""Distance of a sensor from the surface, as a part of the mesh's diagonal, beyond which it is on no housing."""


def sensor_findings(mesh: Mesh, sensor: Sensor) -> Iterator[Finding]:
    """Yield a place that is far from the surface of a mesh."""
    place = np.array(sensor.position, dtype=np.float64)
    low, high = mesh.bounds
    limit = _FARTHEST * float(np.linalg.norm(high - low))
    # The nearest node is quickly found, and no nearer than the surface.
    if np.linalg.norm(mesh.points - place, axis=1).min() <= limit:
        return
    distance = float(np.linalg.norm(surface_point(mesh, mesh.boundary, place).position - place))
    if distance > limit:
        expected = f"a point on the surface of the housing; this one is {1e3 * distance:.6g} mm from it"
        yield Finding(("sensor", sensor.name), "position", sensor.position, expected)


def sensor_port(mesh: Mesh, sensor: Sensor) -> SensorPort:
    """Put a sensor on the surface of the mesh."""
    place = np.array(sensor.position)
    point = surface_point(mesh, mesh.boundary, place)
    direction = point.normal if sensor.direction is None else np.array(sensor.direction, dtype=np.float64)
    direction = direction / np.linalg.norm(direction)
    return SensorPort(
        name=sensor.name,
        matrix=sparse.csr_array(sparse.csr_array(direction[None, :]) @ point_matrix(mesh, point)),
        position=point.position,
        direction=direction,
        distance=float(np.linalg.norm(point.position - place)),
    )
