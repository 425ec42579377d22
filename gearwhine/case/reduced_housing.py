"""Housing of reduced matrices: `[housing.reduced]`, with seats, supports and sensors at its interface nodes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    CaseFile,
    Direction,
    Name,
    Point,
    PositiveFrequency,
    Quantity,
    Table,
    Whole,
)
from gearwhine.case.fixtures import SixDashpots, SixSprings

NodeNumber = Annotated[int, Whole(0, 999_999_999)]


class ReducedFiles(Table):
    """`[housing.reduced]`: files of the matrices, and what these do not say."""

    stiffness: CaseFile
    """Stiffness matrix: a file of Nastran, Abaqus, CalculiX or Ansys, of Matrix Market, NumPy, NetCDF or REXS."""
    mass: CaseFile | None = None
    """Mass matrix. Default: none, of a housing that follows its loads without resonances of its own."""
    damping: CaseFile | None = None
    """Matrix of viscous damping. Default: none beside `damping_ratio` and dashpots."""
    mass_name: Annotated[str, Field(max_length=100)] = ""
    """Name of the mass matrix in a file of several. Default: the only one, or one named as usual."""
    stiffness_name: Annotated[str, Field(max_length=100)] = ""
    """Name of the stiffness matrix in a file of several. Default: the only one, or one named as usual."""
    damping_name: Annotated[str, Field(max_length=100)] = ""
    """Name of the damping matrix in a file of several. Default: the only one, or one named as usual."""
    static: CaseFile | None = None
    """Static stiffness of the interface nodes from another computation, for a proof: `check` states the difference."""
    recovery: CaseFile | None = None
    """Points beside the nodes and their motions by the coordinates, for `compare`: `.npz` or `.nc` with `positions`,
    `recovery`."""
    nodes: tuple[NodeNumber, ...] = Field(default=(), max_length=500)
    """Nodes of the first rows, six each, of files that do not name them; the rows after these are internal."""
    mapping: CaseFile | None = None
    """Nodes and components of the rows, in place of `nodes`: file of Ansys (`.mapping`), CalculiX (`.dof`) or Nastran
    (`.pch` with a card EXTRN)."""
    units: Literal["SI", "mm-t-s"] = "SI"
    """Units of the matrices."""


class NodeSeat(Table):
    """`[[housing.seat]]` of a reduced housing: a bearing seat that moves as an interface node."""

    name: Name
    """Name, to which bearings refer."""
    node: NodeNumber
    """Number of the node, which has six motions."""
    center: Point
    """Place of the node, on the axis of the shaft."""


class NodeSupport(Table):
    """`[[housing.support]]` of a reduced housing: springs and dashpots from an interface node to the ground."""

    name: Name
    """Name of the support."""
    node: NodeNumber
    """Number of the node."""
    position: Point
    """Place of the node."""
    stiffness: SixSprings = SixSprings()
    """Springs to the ground."""
    damping: SixDashpots = SixDashpots()
    """Dashpots to the ground."""


class NodeSensor(Table):
    """`[[housing.sensor]]` of a reduced housing: a measured direction at an interface node."""

    name: Name
    """Name of the sensor."""
    node: NodeNumber
    """Number of the node."""
    position: Point
    """Place of the node."""
    direction: Direction
    """Measured direction: "x", "y", "z" or a vector."""


class ReducedHousing(Table):
    """`[housing]` with `reduced`: matrices of another program in place of a box, CAD or mesh file."""

    reduced: ReducedFiles
    """Files of the matrices."""
    frequency_limit: PositiveFrequency
    """Frequency below which the reduction is accurate, as whoever made it knows."""
    damping_ratio: Annotated[float, Quantity(units.RATIO, at_least=0.0, below=1.0)] = 0.01
    """Modal damping ratio, in addition to a damping matrix and dashpots."""
    seat: tuple[NodeSeat, ...] = Field(default=(), max_length=500)
    """Bearing seats, `[[housing.seat]]`."""
    support: tuple[NodeSupport, ...] = Field(default=(), max_length=500)
    """Supports, `[[housing.support]]`."""
    sensor: tuple[NodeSensor, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Accelerometers, `[[housing.sensor]]`."""
