"""Fixtures of the housing besides its supports: `[[housing.mount]]`, `[[housing.joint]]`, `[[housing.mass]]`.

Each table builds its object of `housing`. Attributes are named as the keys of the case file and are in SI.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Discriminator, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    DampingFromZero,
    Direction,
    Inertia,
    Name,
    ObjectTable,
    Patch,
    Point,
    PositiveLength,
    Quantity,
    StiffnessFromZero,
    Table,
    UnitVector,
    Vector,
    unit_vector,
    wrong,
)

if TYPE_CHECKING:
    from gearwhine.housing import Bushing as BuiltBushing
    from gearwhine.housing import Joint as BuiltJoint
    from gearwhine.housing import LumpedMass as BuiltMass
    from gearwhine.housing import Mount as BuiltMount

TiltStiffness = Annotated[float, Quantity(units.TILT_STIFFNESS, at_least=0.0)]
TiltDamping = Annotated[float, Quantity(units.TILT_DAMPING, at_least=0.0)]
PositiveMass = Annotated[float, Quantity(units.MASS, above=0.0)]
InertiaProduct = Annotated[float, Quantity(units.INERTIA)]
Six = tuple[float, float, float, float, float, float]
Tensor = tuple[Point, Point, Point]

_LEAST_SINE = 1e-6  # least sine of the angle between two axes


class Springs(Table):
    """Stiffness along x, y, z [N/m], in all, spread over the patch."""

    x: StiffnessFromZero = 0.0
    """Stiffness along x."""
    y: StiffnessFromZero = 0.0
    """Stiffness along y."""
    z: StiffnessFromZero = 0.0
    """Stiffness along z."""


class Dashpots(Table):
    """Damping along x, y, z [N s/m], in all, spread over the patch."""

    x: DampingFromZero = 0.0
    """Damping along x."""
    y: DampingFromZero = 0.0
    """Damping along y."""
    z: DampingFromZero = 0.0
    """Damping along z."""


class SixSprings(Springs):
    """Stiffness along x, y, z [N/m] and about them [N m/rad]."""

    rx: TiltStiffness = 0.0
    """Stiffness about x."""
    ry: TiltStiffness = 0.0
    """Stiffness about y."""
    rz: TiltStiffness = 0.0
    """Stiffness about z."""


class SixDashpots(Dashpots):
    """Damping along x, y, z [N s/m] and about them [N m s/rad]."""

    rx: TiltDamping = 0.0
    """Damping about x."""
    ry: TiltDamping = 0.0
    """Damping about y."""
    rz: TiltDamping = 0.0
    """Damping about z."""


class AxialSprings(Table):
    """Stiffness along an axis and across it [N/m], about lines across it and about itself [N m/rad]."""

    axial: StiffnessFromZero = 0.0
    """Stiffness along the axis."""
    shear: StiffnessFromZero = 0.0
    """Stiffness across the axis."""
    tilting: TiltStiffness = 0.0
    """Stiffness about lines across the axis."""
    torsional: TiltStiffness = 0.0
    """Stiffness about the axis."""


class AxialDashpots(Table):
    """Damping along an axis and across it [N s/m], about lines across it and about itself [N m s/rad]."""

    axial: DampingFromZero = 0.0
    """Damping along the axis."""
    shear: DampingFromZero = 0.0
    """Damping across the axis."""
    tilting: TiltDamping = 0.0
    """Damping about lines across the axis."""
    torsional: TiltDamping = 0.0
    """Damping about the axis."""


def _form(value: Any) -> str:
    keys = value if isinstance(value, dict) else type(value).model_fields if isinstance(value, Table) else ()
    return "~axial" if any(key in AxialSprings.model_fields for key in keys) else "~six"


def amounts(table: SixSprings | SixDashpots | AxialSprings | AxialDashpots) -> tuple[float, ...]:
    """Return a table's numbers in the order of its keys."""
    return tuple(getattr(table, key) for key in type(table).model_fields)


class Bushing(Table):
    """Springs and dashpots in all six motions, along axes of their own or knowing one axis only."""

    stiffness: (
        Annotated[
            Annotated[SixSprings, Tag("~six")] | Annotated[AxialSprings, Tag("~axial")],
            Discriminator(_form),
        ]
        | None
    ) = None
    """Springs, along one axis and across it or in six motions."""
    damping: (
        Annotated[
            Annotated[SixDashpots, Tag("~six")] | Annotated[AxialDashpots, Tag("~axial")],
            Discriminator(_form),
        ]
        | None
    ) = None
    """Dashpots, with the same keys as the springs."""
    axis: Direction | None = None
    """Direction of `axial`, with the keys of one axis."""
    axes: tuple[Vector, Vector] | None = None
    """Directions of the own x and y, with the keys of six motions. Default: the global ones."""
    center: Point | None = None
    """Point where the axes meet. Default: the middle of the patch."""

    @model_validator(mode="after")
    def _holds(self) -> Bushing:
        tables = [table for table in (self.stiffness, self.damping) if table is not None]
        if not any(value for table in tables for value in amounts(table)):
            raise wrong("a stiffness or a damping above 0 in at least one motion")
        if len({_form(table) for table in tables}) > 1:
            raise wrong("the keys of 'stiffness': axial, shear, tilting, torsional, or x, y, z, rx, ry, rz", "damping")
        if self.knows_one_axis:
            if self.axis is None:
                raise wrong("the direction of 'axial': 'x', 'y', 'z' or a vector", "axis")
            if self.axes is not None:
                raise wrong("'axis' alone where stiffness is axial, shear, tilting, torsional", "axes")
        elif self.axis is not None:
            raise wrong("'axes', two directions, where stiffness is along x, y, z and about them", "axis")
        if self.axes is not None and math.hypot(*_cross(*map(unit_vector, self.axes))) < _LEAST_SINE:
            raise wrong("two directions at an angle to each other, the own x and y", "axes")
        return self

    @property
    def knows_one_axis(self) -> bool:
        """Whether springs and dashpots are given along and across one axis."""
        return any(_form(table) == "~axial" for table in (self.stiffness, self.damping) if table is not None)

    @property
    def own_axes(self) -> tuple[UnitVector, UnitVector] | None:
        """Directions of the own z and x; None where they are the global ones or there is one axis only."""
        if self.axes is None:
            return None
        x, y = map(unit_vector, self.axes)
        return unit_vector(_cross(x, y)), x

    def build_bushing(self) -> BuiltBushing:
        """Build the bushing: springs and dashpots along its axes."""
        from gearwhine.housing import Bushing as BuiltBushing
        from gearwhine.housing.model.bushings import GLOBAL_AXES, Axial, axes_along

        tables = self.stiffness, self.damping
        if self.axis is not None:
            along = [Axial() if table is None else Axial(*amounts(table)) for table in tables]
            return BuiltBushing.along(unit_vector(self.axis), *along)
        stiffness, damping = (_six(table) for table in tables)
        axes = self.own_axes
        return BuiltBushing(stiffness, damping, GLOBAL_AXES if axes is None else axes_along(*axes))


def _six(table: SixSprings | SixDashpots | AxialSprings | AxialDashpots | None) -> Six:
    """Amounts along x, y, z and about them."""
    x, y, z, rx, ry, rz = (0.0,) * 6 if table is None else amounts(table)
    return x, y, z, rx, ry, rz


def _cross(a: UnitVector, b: UnitVector) -> UnitVector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


class Mount(Patch, Bushing):
    """`[[housing.mount]]`: the rigid motion of a patch on six springs and dashpots to the ground."""

    name: Name
    """Name of the mount."""

    @property
    def holds(self) -> bool:
        """Whether it keeps the housing in its place; a dashpot alone lets it creep away."""
        return self.stiffness is not None and any(amounts(self.stiffness))

    def build(self) -> BuiltMount:
        """Build the mount."""
        from gearwhine.housing import Mount as BuiltMount

        return BuiltMount(self.name, self.build_patch(), self.build_bushing(), self.center)


class Joint(Bushing):
    """`[[housing.joint]]`: six springs and dashpots between the rigid motions of two patches, such as a bolt.

    The patches are two named surfaces, or the circles that a bolt clamps on two faces that meet.
    """

    name: Name
    """Name of the joint."""
    surfaces: tuple[Name, Name] | None = None
    """Names of the two surfaces. One of this and `diameter`."""
    diameter: PositiveLength | None = None
    """Diameter that a bolt clamps: the circles on the two faces that meet at `center` across `axis`. One of this and
    `surfaces`."""

    @model_validator(mode="after")
    def _two_patches(self) -> Joint:
        if (self.surfaces is None) == (self.diameter is None):
            raise wrong("exactly one of 'surfaces', two names, and 'diameter', of the circles around 'center'")
        if self.surfaces is not None and self.surfaces[0] == self.surfaces[1]:
            raise wrong("two different surfaces", "surfaces")
        if self.diameter is not None and (self.center is None or self.axis is None):
            raise wrong("'center' and 'axis' with it: where the two faces meet, and across them", "diameter")
        return self

    def build(self) -> BuiltJoint:
        """Build the joint of two surfaces, or of circles on the faces that look along its axis and against it."""
        from gearwhine.housing import Joint as BuiltJoint
        from gearwhine.housing import Patch as BuiltPatch

        if self.diameter is None or self.center is None or self.axis is None:
            first, second = (BuiltPatch(surface) for surface in self.surfaces or ())
        else:
            x, y, z = unit_vector(self.axis)
            first = BuiltPatch(circle=(self.center, (x, y, z), self.diameter))
            second = BuiltPatch(circle=(self.center, (-x, -y, -z), self.diameter))
        return BuiltJoint(self.name, first, second, self.build_bushing(), self.center)


class InertiaTensor(Table):
    """Entries of an inertia tensor about the body's own centre of gravity, along the global axes [kg m²].

    Products are as they stand in the tensor, such as xy = -∫ x y dm.
    """

    xx: Inertia = 0.0
    """Moment of inertia about x."""
    yy: Inertia = 0.0
    """Moment of inertia about y."""
    zz: Inertia = 0.0
    """Moment of inertia about z."""
    xy: InertiaProduct = 0.0
    """Entry xy of the tensor, -∫ x y dm."""
    xz: InertiaProduct = 0.0
    """Entry xz of the tensor, -∫ x z dm."""
    yz: InertiaProduct = 0.0
    """Entry yz of the tensor, -∫ y z dm."""

    @property
    def rows(self) -> Tensor:
        """The tensor."""
        return (self.xx, self.xy, self.xz), (self.xy, self.yy, self.yz), (self.xz, self.yz, self.zz)


class LumpedMass(ObjectTable, Patch):
    """`[[housing.mass]]`: a point mass at a position, or a rigid body on a patch [kg, m]."""

    places: ClassVar[tuple[str, ...]] = ("position", "box", "surface", "plane")

    name: Name
    """Name of the mass."""
    mass: PositiveMass
    """Mass."""
    position: Point | None = None
    """Position of a point mass, in place of a patch."""
    inertia: InertiaTensor | None = None
    """Inertia tensor about the centre of gravity, of a mass on a patch."""
    offset: Point | None = None
    """Vector from the middle of the patch to the centre of gravity. Default: none."""

    def build(self) -> BuiltMass:
        """Build the lumped mass."""
        from gearwhine.housing import LumpedMass as BuiltMass
        from gearwhine.housing.model.fixtures import NO_INERTIA

        return BuiltMass(
            name=self.name,
            mass=self.mass,
            patch=None if self.position is not None else self.build_patch(),
            position=self.position,
            inertia=self.inertia.rows if self.inertia else NO_INERTIA,
            offset=self.offset or (0.0, 0.0, 0.0),
        )
