"""The `[[rotor]]` and `[[bearing]]` entries of a case. Attributes are named as the keys and are in SI."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Angle,
    Damping,
    DampingFromZero,
    DampingRatio,
    Imbalance,
    Inertia,
    Length,
    LengthFromZero,
    Mass,
    Name,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    Stiffness,
    Table,
    wrong,
)
from gearwhine.case.rolling import BearingLoad, Rolling
from gearwhine.case.units import Dimension


class Segment(Table):
    """A cylindrical piece of shaft [m]; its own material where it differs from the rotor's."""

    length: PositiveLength
    diameter: PositiveLength
    bore: LengthFromZero = 0.0
    material: Name | None = None

    @model_validator(mode="after")
    def _hollow(self) -> Segment:
        if self.bore >= self.diameter:
            raise wrong(f"a bore smaller than the diameter of {self.diameter:g} m", "bore")
        return self


class Disc(Table):
    """A rigid disc at a station [m from the rotor's left end]: mass [kg] and inertias [kg m²]."""

    at: LengthFromZero
    mass: Mass
    polar_inertia: Inertia = 0.0
    diametral_inertia: Inertia = 0.0


class Unbalance(Table):
    """An unbalance at a station: mass times eccentricity [kg m] and its angle from x at rest [rad]."""

    at: LengthFromZero
    moment: Imbalance
    phase: Angle = 0.0


class Bow(Table):
    """A point of the residual bow: run-out of the unloaded centre line [m] and its angle from x [rad]."""

    at: LengthFromZero
    amplitude: LengthFromZero
    phase: Angle = 0.0


class Rotor(Table):
    """`[[rotor]]`: a shaft along z at `axis` (x, y), its left end at z = `start`, all in m.

    `damping_ratio` is that of the shaft's own modes; `shear_coefficient` names a formula.
    """

    name: Name
    axis: tuple[Length, Length] = (0.0, 0.0)
    start: Length = 0.0
    material: Name
    mass: Literal["distributed", "lumped"] = "distributed"
    damping_ratio: DampingRatio = 0.005
    shear_coefficient: Literal["cowper", "hutchinson"] = "cowper"
    segments: tuple[Segment, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    discs: tuple[Disc, ...] = Field(default=(), max_length=MOST_ENTRIES)
    unbalance: tuple[Unbalance, ...] = Field(default=(), max_length=MOST_ENTRIES)
    bow: tuple[Bow, ...] = Field(default=(), max_length=MOST_ENTRIES)

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return sum(segment.length for segment in self.segments)


class RadialStiffness(Table):
    """A 2×2 radial stiffness [N/m]: force against the shaft's motion relative to its seat."""

    xx: PositiveStiffness
    yy: PositiveStiffness
    xy: Stiffness = 0.0
    yx: Stiffness = 0.0


class RadialDamping(Table):
    """A 2×2 radial damping [N s/m]."""

    xx: DampingFromZero = 0.0
    yy: DampingFromZero = 0.0
    xy: Damping = 0.0
    yx: Damping = 0.0


MatrixRows = tuple[tuple[float, ...], ...]

_STIFFNESSES = (units.STIFFNESS, units.COUPLED_STIFFNESS, units.TILT_STIFFNESS)
_DAMPINGS = (units.DAMPING, units.COUPLED_DAMPING, units.TILT_DAMPING)


def _read_matrix(value: Any, kinds: tuple[Dimension, Dimension, Dimension]) -> MatrixRows:
    """Validate a 5×5 matrix of quantities over (x, y, z, tilt about x, tilt about y)."""
    rows = value if isinstance(value, (list, tuple)) else ()
    if len(rows) != 5 or any(not isinstance(row, (list, tuple)) or len(row) != 5 for row in rows):
        raise wrong("five rows of five, over x, y, z and the tilts about x and y")
    return tuple(
        tuple(_read_entry(entry, i, j, kinds[(i >= 3) + (j >= 3)]) for j, entry in enumerate(row))
        for i, row in enumerate(value)
    )


def _read_entry(value: object, row: int, column: int, dimension: Dimension) -> float:
    """Validate one entry of a matrix, naming its place in the error."""
    try:
        return Quantity(dimension).validate(value)
    except PydanticCustomError as error:
        context = error.context or {}
        raise wrong(context["expected"], row, column, note=context["note"]) from None


class MatrixStiffness(Table):
    """A 5×5 stiffness over (x, y, z, tilt about x, tilt about y): N/m, N/rad and N m/rad."""

    matrix: MatrixRows

    @field_validator("matrix", mode="before")
    @classmethod
    def _read(cls, value: Any) -> MatrixRows:
        return _read_matrix(value, _STIFFNESSES)


class MatrixDamping(Table):
    """A 5×5 damping over (x, y, z, tilt about x, tilt about y): N s/m, N s/rad and N m s/rad."""

    matrix: MatrixRows

    @field_validator("matrix", mode="before")
    @classmethod
    def _read(cls, value: Any) -> MatrixRows:
        return _read_matrix(value, _DAMPINGS)


class RollingStiffness(Table):
    """A stiffness that follows from the geometry of a rolling-element bearing under its load."""

    rolling: Rolling


def _stiffness_form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    if "matrix" in keys:
        return "~matrix"
    return "~rolling" if "rolling" in keys else "~radial"


def _damping_form(value: Any) -> str:
    return "~matrix" if _stiffness_form(value) == "~matrix" else "~radial"


Matrix2 = tuple[tuple[float, float], tuple[float, float]]


def _radial(given: RadialStiffness | RadialDamping | MatrixStiffness | MatrixDamping) -> Matrix2:
    """Return the 2×2 block over x, y."""
    if isinstance(given, (RadialStiffness, RadialDamping)):
        return (given.xx, given.xy), (given.yx, given.yy)
    (xx, xy, *_), (yx, yy, *_) = given.matrix[:2]
    return (xx, xy), (yx, yy)


class Bearing(Table):
    """`[[bearing]]`: between a rotor at a station [m from its left end] and a seat, or "ground"."""

    name: Name
    rotor: Name
    at: LengthFromZero
    seat: Name = "ground"
    stiffness: Annotated[
        Annotated[RadialStiffness, Tag("~radial")]
        | Annotated[MatrixStiffness, Tag("~matrix")]
        | Annotated[RollingStiffness, Tag("~rolling")],
        Discriminator(_stiffness_form),
    ]
    damping: Annotated[
        Annotated[RadialDamping, Tag("~radial")] | Annotated[MatrixDamping, Tag("~matrix")],
        Discriminator(lambda value: "~radial" if _stiffness_form(value) == "~rolling" else _stiffness_form(value)),
    ] = RadialDamping()
    load: BearingLoad | None = None

    @model_validator(mode="after")
    def _loaded(self) -> Bearing:
        rolls = isinstance(self.stiffness, RollingStiffness)
        if self.load is not None and not rolls:
            raise wrong("nothing: only the stiffness of a rolling bearing depends on its load", "load")
        if isinstance(self.stiffness, RollingStiffness) and self.load is None and not self.stiffness.rolling.pressed:
            expected = "{ x, y, z }, the force of the shaft on it: a rolling bearing without preload has no stiffness"
            raise wrong(expected, "load")
        return self

    @property
    def radial_stiffness(self) -> Matrix2 | None:
        """The 2×2 stiffness over x, y [N/m], of a 5×5 its first block; None where it follows from a load."""
        return None if isinstance(self.stiffness, RollingStiffness) else _radial(self.stiffness)

    @property
    def radial_damping(self) -> Matrix2:
        """The 2×2 damping over x, y [N s/m], of a 5×5 its first block."""
        return _radial(self.damping)

    @property
    def resists_axially(self) -> bool:
        """Whether its stiffness or damping has anything along z, as far as the case says."""
        given = [
            matrix for matrix in (self.stiffness, self.damping) if isinstance(matrix, (MatrixStiffness, MatrixDamping))
        ]
        stated = any(any(form.matrix[2]) or any(row[2] for row in form.matrix) for form in given)
        return stated or (
            isinstance(self.stiffness, RollingStiffness) and not self.stiffness.rolling.rolls_on_cylinders
        )

    @property
    def grounded(self) -> bool:
        """Whether the bearing stands on the ground rather than in a seat."""
        return self.seat == "ground"
