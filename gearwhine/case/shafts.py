"""The `[[rotor]]` and `[[bearing]]` entries of a case. Attributes are named as the keys and are in SI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    Discriminator,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    Tag,
    field_validator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Angle,
    CaseFile,
    Damping,
    DampingFromZero,
    DampingRatio,
    Force,
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
    Whole,
    wrong,
)
from gearwhine.case.units import Dimension

if TYPE_CHECKING:
    from rotors import RossModel


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

    `damping_ratio` is that of the shaft's own modes; `shear_coefficient` names a formula. Where a `file` of ROSS
    holds the shaft, with its discs and grounded bearings, there are no `segments` here.
    """

    name: Name
    axis: tuple[Length, Length] = (0.0, 0.0)
    start: Length = 0.0
    file: CaseFile | None = None
    material: Name | None = None
    mass: Literal["distributed", "lumped"] = "distributed"
    damping_ratio: DampingRatio = 0.005
    shear_coefficient: Literal["cowper", "hutchinson"] = "cowper"
    segments: tuple[Segment, ...] = Field(default=(), min_length=1, max_length=MOST_ENTRIES)
    discs: tuple[Disc, ...] = Field(default=(), max_length=MOST_ENTRIES)
    unbalance: tuple[Unbalance, ...] = Field(default=(), max_length=MOST_ENTRIES)
    bow: tuple[Bow, ...] = Field(default=(), max_length=MOST_ENTRIES)

    _saved: RossModel | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _described(self) -> Rotor:
        if self.file is None:
            for key, what in (("material", "the name of a material"), ("segments", "a list")):
                if not getattr(self, key):
                    raise wrong(f"{what}, or a rotor's file instead", key)
            return self
        for key in ("segments", "shear_coefficient"):
            if key in self.model_fields_set:
                raise wrong("no such key beside file, which holds the shaft", key)
        from rotors import RotorError, read_ross

        try:
            self._saved = read_ross(self.file)
        except RotorError as error:
            raise wrong(f"a rotor saved by ROSS ({error})", "file") from None
        return self

    @model_serializer(mode="wrap")
    def _without_what_the_file_holds(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = write(self)
        if self.file is not None:
            del written["segments"], written["shear_coefficient"]
        return written

    @property
    def saved(self) -> RossModel | None:
        """What the file holds; None where the shaft is described here."""
        return self._saved

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        if self._saved is not None:
            return self._saved.rotor.length
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


class Rolling(Table):
    """A rolling-element bearing by its geometry [m, rad]; a groove is its radius over the ball's diameter.

    `clearance` is diametral; a negative one is an interference. `preload` is axial.
    """

    element: Literal["ball", "roller"] = "ball"
    count: Annotated[int, Whole(3, 500)]
    element_diameter: PositiveLength
    element_length: PositiveLength | None = None
    pitch_diameter: PositiveLength
    contact_angle: Annotated[float, Quantity(units.ANGLE, at_least=0.0, below=1.57)] = 0.0
    inner_groove: Annotated[float, Quantity(units.RATIO, above=0.5, at_most=1.0)] = 0.52
    outer_groove: Annotated[float, Quantity(units.RATIO, above=0.5, at_most=1.0)] = 0.53
    clearance: Length = 0.0
    preload: Force = 0.0

    @model_validator(mode="after")
    def _fits(self) -> Rolling:
        if self.element_diameter >= self.pitch_diameter:
            raise wrong("rolling elements smaller than their pitch circle", "element_diameter")
        if self.element == "roller" and self.element_length is None:
            raise wrong("the length of the rollers", "element_length")
        return self


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

    @property
    def radial_stiffness(self) -> Matrix2 | None:
        """The 2×2 stiffness over x, y [N/m], of a 5×5 its first block; None where it follows from a load."""
        return None if isinstance(self.stiffness, RollingStiffness) else _radial(self.stiffness)

    @property
    def radial_damping(self) -> Matrix2:
        """The 2×2 damping over x, y [N s/m], of a 5×5 its first block."""
        return _radial(self.damping)

    @property
    def grounded(self) -> bool:
        """Whether the bearing stands on the ground rather than in a seat."""
        return self.seat == "ground"
