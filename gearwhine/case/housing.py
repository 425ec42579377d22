"""Housing of a case, `[housing]`: geometry, seats, supports, sensors and fixtures; materials and their regions.

Regions, `[[housing.region]]`, are parts of the housing of another material. Attributes are named as the keys of the
case file and are in SI; frequencies are in Hz.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.box import Box
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Angle,
    CaseFile,
    DampingRatio,
    Density,
    Direction,
    ElasticModulus,
    MaterialName,
    Name,
    Patch,
    Point,
    PositiveFrequency,
    PositiveLength,
    Quantity,
    Table,
    UnitVector,
    Whole,
    unit_vector,
    wrong,
)
from gearwhine.case.fixtures import Dashpots, Joint, LumpedMass, Mount, Springs
from gearwhine.case.units import QuantityError, parse_quantity
from gearwhine.numerics.materials import STRUCTURAL_DAMPING

if TYPE_CHECKING:
    from gearwhine.housing import Sensor as BuiltSensor
    from gearwhine.housing import Support as BuiltSupport


class Region(Table):
    """The elements of a named volume of the mesh, or those whose middle is in a box [m], and their material."""

    name: Name
    """Name of the region."""
    material: MaterialName
    """Name of its material."""
    volume: Name | None = None
    """Name of a volume of the mesh. One of this and `box`."""
    box: tuple[Point, Point] | None = None
    """Two opposite corners: the elements whose middle is inside. One of this and `volume`."""

    @model_validator(mode="after")
    def _one_of_each(self) -> Region:
        if (self.box is None) == (self.volume is None):
            raise wrong("exactly one of 'volume' and 'box'")
        return self


def _shape(value: Any) -> str:
    """Form in which a value with several forms is given."""
    if isinstance(value, str) and value.isalpha():
        return "~word"
    if isinstance(value, (dict, Table)):
        return "~table"
    return "~list" if isinstance(value, (list, tuple)) else "~scalar"


_PRINTED = 0.02  # part by which a printed shear modulus may miss that of an isotropic material
_STIFFEST_SHEAR = 5.0  # shear moduli over that of a Poisson ratio of 0, of composites wound at 45 degrees


class Material(Table):
    """`[material.NAME]`: Young's modulus [Pa], Poisson ratio, density [kg/m³]."""

    model_config = ConfigDict(serialize_by_alias=True)

    youngs_modulus: ElasticModulus
    """Young's modulus E."""
    poisson_ratio: Annotated[float, Quantity(units.RATIO, at_least=0.0, below=0.5)]
    """Poisson's ratio ν."""
    density: Density
    """Density ρ."""
    own_shear_modulus: ElasticModulus | None = Field(default=None, alias="shear_modulus")
    """Shear modulus G of shafts that are drawn or wound; a housing's solids are isotropic. Default: E / (2 (1 + ν))."""

    @model_validator(mode="after")
    def _shears(self) -> Material:
        # The formulas of shear coefficients take Poisson's ratio to be E / 2G - 1.
        low, high = self.youngs_modulus / 3.0, self.youngs_modulus / 2.0 * _STIFFEST_SHEAR
        if self.own_shear_modulus is not None and not low <= self.own_shear_modulus <= high:
            expected = f"a shear modulus from {low:.4g} to {high:.4g} Pa, of a material of this Young's modulus"
            raise wrong(expected, "shear_modulus")
        return self

    @property
    def is_isotropic(self) -> bool:
        """Whether its shear modulus is that of its Young's modulus and Poisson ratio, as printed numbers have it."""
        return abs(self.shear_modulus / self._isotropic_shear_modulus - 1.0) <= _PRINTED

    @property
    def shear_modulus(self) -> float:
        """Shear modulus as given, else E / (2 (1 + ν)) [Pa]."""
        return self._isotropic_shear_modulus if self.own_shear_modulus is None else self.own_shear_modulus

    @property
    def _isotropic_shear_modulus(self) -> float:
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))


Rotation = tuple[UnitVector, UnitVector, UnitVector]


class Turn(Table):
    """A rotation about an axis through the origin, counter-clockwise seen from its tip."""

    axis: Direction
    """Axis of the rotation."""
    angle: Angle
    """Angle, counter-clockwise seen from the tip of the axis."""

    @property
    def matrix(self) -> Rotation:
        """Rotation matrix by Rodrigues' formula, rows of a 3 x 3 matrix."""
        x, y, z = unit_vector(self.axis)
        sine, cosine = math.sin(self.angle), math.cos(self.angle)
        rest = 1.0 - cosine
        return (
            (cosine + rest * x * x, rest * x * y - sine * z, rest * x * z + sine * y),
            (rest * y * x + sine * z, cosine + rest * y * y, rest * y * z - sine * x),
            (rest * z * x - sine * y, rest * z * y + sine * x, cosine + rest * z * z),
        )


class Turned(Table):
    """A geometry whose file has another frame than the machine, whose shafts lie along z."""

    shafts_along: Literal["x", "y", "z"] | None = None
    """Axis of the file along which the shafts lie there: its y, z, x become x, y, z for "x", and z, x, y for "y".
    Default: "z"."""
    turn: Turn | None = None
    """Rotation of the file\'s geometry about its origin, in place of `shafts_along`."""

    @model_validator(mode="after")
    def _turned_once(self) -> Turned:
        if self.shafts_along is not None and self.turn is not None:
            raise wrong("either 'shafts_along' or 'turn', not both", "turn")
        return self

    @property
    def rotation(self) -> Rotation:
        """R of x' = R x from the file's frame to the machine's, rows of a 3 x 3 matrix."""
        if self.turn is not None:
            return self.turn.matrix
        x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        return {"x": (y, z, x), "y": (z, x, y)}.get(self.shafts_along or "z", (x, y, z))


class CadFile(Turned):
    """`[housing.cad]`: a STEP, IGES or BREP file and the element size [m], if wanted a smaller one around the seats."""

    file: CaseFile
    """STEP, IGES or BREP file (`.step`, `.stp`, `.iges`, `.igs`, `.brep`), relative to the case file."""
    mesh_size: PositiveLength | None = None
    """Edge length of the elements. One of this and the housing's `accuracy`."""
    seat_mesh_size: PositiveLength | None = None
    """Smaller edge length around the seats, beside a `mesh_size`. Default: `mesh_size`."""
    unit: Literal["m", "mm", "cm", "in"] | None = None
    """Unit of the file's numbers, where it states none or an implausible one. Default: the file's, else mm."""
    glue: bool = True
    """Solids that touch share their nodes; without it joints alone connect them."""

    @model_validator(mode="after")
    def _finer_at_seats(self) -> CadFile:
        if self.seat_mesh_size is not None and self.mesh_size is not None and self.seat_mesh_size > self.mesh_size:
            raise wrong(f"at most the mesh_size of {self.mesh_size:g} m", "seat_mesh_size")
        return self


class MeshFile(Turned):
    """`[housing.mesh]`: a finite-element mesh file and the unit of its coordinates."""

    file: CaseFile
    """Mesh file of a format that meshio reads, a deck of Abaqus or CalculiX (`.inp`) or Nastran (`.bdf`, `.fem`,
    `.nas`, `.dat`), or a universal file (`.unv`), relative to the case file."""
    unit: Literal["m", "mm", "cm", "in"] = "m"
    """Unit of its coordinates."""


class Boss(Table):
    """A cylinder on the outside of the wall, concentric with the bore [m]."""

    diameter: PositiveLength
    """Diameter."""
    length: PositiveLength
    """Length outside the wall."""


class Seat(Table):
    """`[[housing.seat]]`: a bearing seat, a bore along z [m]."""

    name: Name
    """Name, to which bearings refer; on a mesh or CAD file with named surfaces that of the surface."""
    center: Point
    """Point on the axis of the bore, at most a diameter beyond its ends."""
    diameter: PositiveLength
    """Diameter of the bore."""
    boss: Boss | None = None
    """Boss outside the wall, on a box."""
    ring_orders: Annotated[int, Whole(1, 24)] | None = None
    """Highest order of the bore's deformation around its circumference that a ring gear in it drives, such as twice the
    number of planets. Default: the bore moves as one body, as of a bearing."""

    @field_validator("name")
    @classmethod
    def _not_taken(cls, name: str) -> str:
        if name == "ground":
            raise wrong("another name than 'ground', which bearings use for what does not move")
        return name

    @model_validator(mode="after")
    def _boss_around_bore(self) -> Seat:
        if self.boss is not None and self.boss.diameter <= self.diameter:
            raise wrong(f"a boss wider than its bore of {self.diameter:g} m", "boss", "diameter")
        return self


class Face(Table):
    """`[[housing.face]]`: a name for a flat face of a CAD or mesh file, by a point on it [m]."""

    name: Name
    """Name of the face, as of a surface of the file: for supports, `still` faces, results."""
    at: Point
    """Point on the face."""


class Support(Patch):
    """`[[housing.support]]`: a patch of the surface, held fast, or on springs and dashpots."""

    name: Name
    """Name of the support."""
    fixed: tuple[Literal["x", "y", "z"], ...] | None = Field(default=None, min_length=1, max_length=3)
    """Fixed directions, some of "x", "y", "z"; in place of `stiffness` and `damping`."""
    stiffness: Springs | None = None
    """Springs to the ground, in all, spread over the patch."""
    damping: Dashpots | None = None
    """Dashpots to the ground, in all, spread over the patch."""

    @model_validator(mode="after")
    def _one_of_each(self) -> Support:
        if (self.fixed is None) == (self.stiffness is None and self.damping is None):
            raise wrong("either 'fixed', or 'stiffness' or 'damping' or both")
        if self.fixed is not None and len(set(self.fixed)) < len(self.fixed):
            raise wrong("each of 'x', 'y', 'z' at most once", "fixed")
        if self.stiffness is not None and self.stiffness == Springs():
            raise wrong("a stiffness above 0 N/m in x, y or z", "stiffness")
        if self.damping is not None and self.damping == Dashpots():
            raise wrong("a damping above 0 N*s/m in x, y or z", "damping")
        return self

    @property
    def holds(self) -> bool:
        """Whether it keeps the housing in its place; a dashpot alone lets it creep away."""
        return self.fixed is not None or self.stiffness is not None

    def build(self) -> BuiltSupport:
        """Build the support."""
        from gearwhine.housing import Support as BuiltSupport

        springs, dashpots, fixed = self.stiffness or Springs(), self.damping or Dashpots(), self.fixed or ()
        return BuiltSupport(
            name=self.name,
            surface=self.surface,
            box=self.corners,
            plane=self.point_and_normal,
            fixed=("x" in fixed, "y" in fixed, "z" in fixed),
            stiffness=(springs.x, springs.y, springs.z),
            damping=(dashpots.x, dashpots.y, dashpots.z),
        )


class Sensor(Table):
    """`[[housing.sensor]]`: a point on the surface [m] and a direction; None: the outward normal there."""

    name: Name
    """Name of the sensor."""
    position: Point
    """Point on the surface or near it."""
    direction: Direction | None = None
    """Measured direction: "x", "y", "z" or a vector. Default: the outward normal."""

    @property
    def unit_vector(self) -> UnitVector | None:
        """The direction as a unit vector; None where it is the surface normal."""
        return None if self.direction is None else unit_vector(self.direction)

    def build(self) -> BuiltSensor:
        """Build the sensor."""
        from gearwhine.housing import Sensor as BuiltSensor

        return BuiltSensor(self.name, self.position, self.unit_vector)


def _check_frequency_key(key: object) -> str:
    """Hold the keys of a damping table to frequencies."""
    try:
        if parse_quantity(key, units.FREQUENCY) >= 0.0:
            return str(key)
    except QuantityError:
        pass
    raise wrong("a frequency such as '658 Hz' as a key of the damping table")


GEOMETRIES = ("box", "cad", "mesh")
"""Tables of which a housing has exactly one: what it is made of."""


class Housing(Table):
    """`[housing]`: geometry (exactly one of box, cad, mesh), material, damping and the modes wanted."""

    material: MaterialName
    """Name of the material; a region may have another."""
    damping_ratio: Annotated[
        Annotated[DampingRatio, Tag("~scalar")]
        | Annotated[Literal["welded", "bolted", "cast"], Tag("~word")]
        | Annotated[tuple[DampingRatio, ...], Tag("~list"), Field(min_length=1, max_length=MOST_ENTRIES)]
        | Annotated[dict[str, DampingRatio], Tag("~table"), Field(min_length=1, max_length=MOST_ENTRIES)],
        Discriminator(_shape),
    ] = 0.01
    """Modal damping ratio: one for all modes, a list with one for each mode from the lowest on, a table from
    frequency to ratio such as `{ "0 Hz" = 0.02, "3 kHz" = 0.01 }`, linear between, or a word for one of all modes:
    "welded" is 0.00318 and "bolted" (high-strength bolts) 0.00477, of steel; with ordinary bolts it has 0.008
    (EN 1991-1-4:2005, table F.2); "cast" is 0.02: metal structures of one piece have 0.02 to 0.04, and 0.03 to 0.07
    with joints (Adams and Askenazi 1998)."""
    frequency_limit: PositiveFrequency | None = None
    """Every mode below this frequency is found. One of this and `modes`."""
    modes: Annotated[int, Whole(1, 5000)] | None = None
    """Number of lowest modes to find. One of this and `frequency_limit`."""
    accuracy: Annotated[float, Quantity(units.RATIO, at_least=1e-3, at_most=0.2)] | None = None
    """Largest estimated error of a mode's frequency by the mesh, such as "1 %", in place of the `mesh_size` of box or
    cad: elements are made smaller until every mode's `discretisation_error` is below it."""
    solver: Literal["lanczos", "eigsh", "slepc"] = "lanczos"
    """Eigensolver of the modes: block Lanczos, scipy's ARPACK ("eigsh"), or SLEPc with MUMPS on ranks of MPI, for a
    housing beyond one machine (`pip install gearwhine[slepc]`); all have the same certificate."""
    box: Box | None = None
    """Housing as a box. Exactly one of `box`, `cad` and `mesh`."""
    cad: CadFile | None = None
    """Housing from a CAD file. Exactly one of `box`, `cad` and `mesh`."""
    mesh: MeshFile | None = None
    """Housing from a mesh file. Exactly one of `box`, `cad` and `mesh`."""
    seat: tuple[Seat, ...] = Field(default=(), max_length=1000)
    """Bearing seats, `[[housing.seat]]`."""
    face: tuple[Face, ...] = Field(default=(), max_length=1000)
    """Names of flat faces of a CAD or mesh file, `[[housing.face]]`."""
    support: tuple[Support, ...] = Field(default=(), max_length=1000)
    """Supports, `[[housing.support]]`."""
    mount: tuple[Mount, ...] = Field(default=(), max_length=1000)
    """Mounts, `[[housing.mount]]`."""
    joint: tuple[Joint, ...] = Field(default=(), max_length=1000)
    """Joints, `[[housing.joint]]`."""
    mass: tuple[LumpedMass, ...] = Field(default=(), max_length=1000)
    """Lumped masses, `[[housing.mass]]`."""
    sensor: tuple[Sensor, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Accelerometers, `[[housing.sensor]]`."""
    region: tuple[Region, ...] = Field(default=(), max_length=1000)
    """Regions of another material, `[[housing.region]]`."""

    @field_validator("damping_ratio", mode="after")
    @classmethod
    def _keyed_by_frequency(cls, value: Any) -> Any:
        if isinstance(value, dict):
            for key in value:
                _check_frequency_key(key)
        return value

    def meshed_by(self, mesh_size: float) -> Housing:
        """Return the housing with a size of elements [m], in place of an accuracy."""
        key = "box" if self.box is not None else "cad"
        source = getattr(self, key).model_copy(update={"mesh_size": mesh_size})
        return self.model_copy(update={"accuracy": None, key: source})

    @property
    def mesh_size(self) -> float | None:
        """Edge length of the elements [m]; None where the housing is meshed already, or to an accuracy."""
        source = self.box or self.cad
        return None if source is None else source.mesh_size

    @property
    def modal_damping(self) -> float | tuple[float, ...] | dict[str, float]:
        """The damping ratios in numbers: one, one for each mode, or by frequency."""
        ratio = self.damping_ratio
        return STRUCTURAL_DAMPING[ratio].ratio if isinstance(ratio, str) else ratio

    @property
    def damping_points(self) -> tuple[tuple[float, float], ...]:
        """The damping table as (frequency in Hz, ratio), ascending; empty for the other forms."""
        if not isinstance(self.damping_ratio, dict):
            return ()
        return tuple(sorted((parse_quantity(k, units.FREQUENCY), v) for k, v in self.damping_ratio.items()))
