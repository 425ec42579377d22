"""Field types of the case keys: quantities with unit and range, names, files, and the base class of all tables.

Further types are a direction, an axis by its letter or a vector of any length; a coefficient over speed, one quantity
or a list with one for each speed of a table; and a patch of the housing's surface, which is a named surface, or the
surface in a box or on a plane.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    GetCoreSchemaHandler,
    Tag,
    ValidationInfo,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError, core_schema

from gearwhine.case import units
from gearwhine.case.input_files import files_of
from gearwhine.case.units import Dimension, QuantityError, format_quantity, parse_quantity
from gearwhine.numerics.findings import RefusedPartError
from gearwhine.numerics.names import has_hidden_characters

if TYPE_CHECKING:
    from gearwhine.housing import Patch as BuiltPatch

MOST_ENTRIES = 10_000
"""Most entries a list may hold; beyond it a case is a mistake, not a gearbox."""

MOST_PLANETS = 24
"""Most planets of a `[[planetary]]`."""


def wrong(expected: str, *at: str | int, note: str = "") -> PydanticCustomError:
    """Make the error for a value that is not what was expected.

    Parameters
    ----------
    expected : str
        Expected value.
    *at : str or int
        Steps that lead on to the key at fault.
    note : str
        Dimension of the value, where it is not obvious.
    """
    return PydanticCustomError("case", "{expected}", {"expected": expected, "at": at, "note": note})


class Rule(ABC):
    """Validates the value of a key; to stand in `Annotated`. A rule with a `write` takes that to write it back."""

    write: Callable[..., Any] | None = None

    @abstractmethod
    def validate(self, value: object) -> Any:
        """Return the value, or raise pydantic's error with what was expected."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Return pydantic's schema for validation and serialisation of this field."""
        if self.write is None:
            return core_schema.no_info_plain_validator_function(self.validate)
        writer = core_schema.plain_serializer_function_ser_schema(self.write, when_used="json")
        return core_schema.no_info_plain_validator_function(self.validate, serialization=writer)


@dataclass(frozen=True)
class Quantity(Rule):
    """Validates a quantity within a range, and writes it back with its unit; to stand in `Annotated`.

    Attributes
    ----------
    dimension : Dimension
        Physical dimension.
    above, below : float, optional
        Limits that the value must not touch [SI].
    at_least, at_most : float, optional
        Limits that the value may touch [SI].
    """

    dimension: Dimension
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

    def write(self, number: float) -> str | float:
        """Return the quantity as text with its unit."""
        return format_quantity(number, self.dimension)

    def validate(self, value: object) -> float:
        """Return the quantity in SI, or raise pydantic's error with what was expected."""
        try:
            number = parse_quantity(value, self.dimension)
        except QuantityError as error:
            raise wrong(str(error), note=error.note) from None
        within = (
            (self.above is None or number > self.above)
            and (self.at_least is None or number >= self.at_least)
            and (self.below is None or number < self.below)
            and (self.at_most is None or number <= self.at_most)
        )
        if not within:
            raise wrong(self.expected + self._hint(value, number))
        dimension = self.dimension
        if abs(number) > dimension.largest:
            hint = hint_of_millimetres(value) if dimension is units.LENGTH else ""
            raise wrong(f"{dimension.name} of at most {self._plainly(dimension.largest)}{hint}")
        # Elsewhere a tiny value counts as zero, since rounding leaves such values.
        if self.above == 0.0 and number < dimension.smallest:
            raise wrong(f"{dimension.name} of at least {self._plainly(dimension.smallest)}")
        return number

    def validate_at(self, value: object, *at: str | int) -> float:
        """Return a quantity that stands in a list, or raise the error with its place there."""
        try:
            return self.validate(value)
        except PydanticCustomError as error:
            context = error.context or {}
            raise wrong(context["expected"], *at, note=context["note"]) from None

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        example = f"such as {self.dimension.example!r}" if self._has_fair_example() else ""
        return " ".join(word for word in (self.dimension.name, self._range(), example) if word)

    def _has_fair_example(self) -> bool:
        """Whether the dimension's example is within the limits."""
        dimension = self.dimension
        example = parse_quantity(dimension.example if dimension.unit else float(dimension.example), dimension)
        low = max(limit for limit in (self.above, self.at_least, float("-inf")) if limit is not None)
        high = min(limit for limit in (self.below, self.at_most, float("inf")) if limit is not None)
        return low < example < high

    def _range(self) -> str:
        """Write the limits as words."""
        lower = (("above", self.above), ("of at least", self.at_least))
        upper = (("below", self.below), ("at most" if self.at_least is not None else "of at most", self.at_most))
        return " and ".join(f"{word} {self._show(limit)}" for word, limit in (*lower, *upper) if limit is not None)

    def _hint(self, value: object, number: float) -> str:
        """Return the advice for a length that is too long because its unit is missing."""
        too_long = self.dimension is units.LENGTH and self.at_most is not None and number > self.at_most
        return hint_of_millimetres(value) if too_long else ""

    def _plainly(self, limit: float) -> str:
        """Write a limit of the dimension with its SI unit."""
        return f"{limit:g} {self.dimension.unit}".rstrip()

    def _show(self, limit: float) -> str:
        """Write a limit with its unit."""
        return str(self.write(limit)) if self.dimension.unit else f"{limit:g}"


def hint_of_millimetres(value: object) -> str:
    """Return the advice for a plain number of metres that looks like millimetres, or nothing."""
    if isinstance(value, str):
        return ""
    return f"; plain numbers are in metres: did you mean '{value:g} mm'?"


@dataclass(frozen=True)
class Whole(Rule):
    """Validates a whole number within limits; to stand in `Annotated`.

    Where negative numbers of the same size stand for something, `negative` names it: "an internal gear".
    """

    at_least: int
    at_most: int
    negative: str = ""

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return f"a whole number from {self.at_least} to {self.at_most}"

    def validate(self, value: object) -> int:
        """Return the whole number, or raise pydantic's error with what was expected."""
        if isinstance(value, int) and not isinstance(value, bool) and self.at_least <= value <= self.at_most:
            return value
        if self.negative and isinstance(value, int) and value < 0:
            if self.at_least <= -value <= self.at_most:
                return value
            raise wrong(f"{self.expected}, or {-self.at_most} to {-self.at_least} of {self.negative}")
        raise wrong(self.expected)


PlanetNumber = Annotated[int, Whole(1, MOST_PLANETS)]
"""Number of a planet, from 1, of those that a `[[planetary]]` mounts of one."""


def one_of_planets(kind: str) -> str:
    """Return what is expected for the planet of a fault of a part that stands once, in words."""
    return f"a planet of the `count` that a [[planetary]] mounts of this {kind}; none of a {kind} that stands once"


_NAME = re.compile(r"[^\s\x00-\x1f\x7f/\\](?:[^\x00-\x1f\x7f/\\]{0,98}[^\s\x00-\x1f\x7f/\\])?")


@dataclass(frozen=True)
class _NameRule(Rule):
    """Validates an entry's name: short, on one line, fit to stand in a table, a plot and a file name."""

    def validate(self, value: object) -> str:
        if not isinstance(value, str) or _NAME.fullmatch(value) is None:
            raise wrong("a name of 1 to 100 characters, without slashes, line breaks or blanks at its ends")
        if has_hidden_characters(value):
            raise wrong("a name without characters that nobody sees, such as blanks without a width")
        return value


@dataclass(frozen=True)
class _FileRule:
    """Validates a file: its name is relative to the case file's folder (the validation context), and it exists."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        writer = core_schema.plain_serializer_function_ser_schema(str, when_used="json")
        return core_schema.with_info_plain_validator_function(self.validate, serialization=writer)

    def validate(self, value: object, info: ValidationInfo) -> Path:
        text = str(value) if isinstance(value, (str, Path)) else ""
        if not 0 < len(text) <= 1000 or "\0" in text:
            raise wrong("the name of a file, relative to the case file's folder")
        path, files = Path((info.context or {}).get("folder", ""), text), files_of(info)
        try:
            found: Path | None = path.resolve()
            if not path.is_file() and str(found) not in files.contents:
                found = None
        except (OSError, ValueError, RuntimeError):  # names no file system takes, and loops of links
            found = None
        if found is None:
            raise wrong(f"an existing file (looked in {str(path.parent)!r})")
        try:
            files.add(found)
        except OSError as error:
            raise wrong(f"a file that can be read ({error.strerror or error})") from None
        return found


@dataclass(frozen=True)
class Reference:
    """Says which entry of the case a name is that of; to stand in `Annotated` beside it.

    Attributes
    ----------
    kind : str
        What it names, in words.
    to : tuple of str
        Paths of the lists that hold these entries; in quotes a word that is no entry's name.
    otherwise : tuple of str
        The same, of a case that has no such entry.
    """

    kind: str
    to: tuple[str, ...]
    otherwise: tuple[str, ...] = ()


Name = Annotated[str, _NameRule()]
RotorName = Annotated[Name, Reference("rotor", ("rotor",))]
ShaftName = Annotated[Name, Reference("rotor", ("rotor",), otherwise=("gear",))]
"""Name of a rotor, or in a case without rotors of a gear."""
GearName = Annotated[Name, Reference("gear", ("gear",))]
MEMBER = Reference("gear or rotor", ("gear", "rotor"))
MaterialName = Annotated[Name, Reference("material", ("material",))]
SeatName = Annotated[Name, Reference("seat", ("housing.seat",))]
CarrierOfBearing = Annotated[Name, Reference("seat", ("housing.seat", "'ground'", "rotor"))]
SensorName = Annotated[Name, Reference("sensor", ("housing.sensor",))]
CaseFile = Annotated[Path, _FileRule()]

Length = Annotated[float, Quantity(units.LENGTH)]
LengthFromZero = Annotated[float, Quantity(units.LENGTH, at_least=0.0)]
PositiveLength = Annotated[float, Quantity(units.LENGTH, above=0.0)]
Mass = Annotated[float, Quantity(units.MASS, at_least=0.0)]
Inertia = Annotated[float, Quantity(units.INERTIA, at_least=0.0)]
Imbalance = Annotated[float, Quantity(units.IMBALANCE, at_least=0.0)]
Density = Annotated[float, Quantity(units.DENSITY, above=0.0)]
ElasticModulus = Annotated[float, Quantity(units.STRESS, above=0.0)]
Stiffness = Annotated[float, Quantity(units.STIFFNESS)]
StiffnessFromZero = Annotated[float, Quantity(units.STIFFNESS, at_least=0.0)]
PositiveStiffness = Annotated[float, Quantity(units.STIFFNESS, above=0.0)]
Damping = Annotated[float, Quantity(units.DAMPING)]
DampingFromZero = Annotated[float, Quantity(units.DAMPING, at_least=0.0)]
Force = Annotated[float, Quantity(units.FORCE)]
Torque = Annotated[float, Quantity(units.TORQUE, at_least=0.0)]
Angle = Annotated[float, Quantity(units.ANGLE)]
PositiveFrequency = Annotated[float, Quantity(units.FREQUENCY, above=0.0)]
Speed = Annotated[float, Quantity(units.SPEED)]
SpeedFromZero = Annotated[float, Quantity(units.SPEED, at_least=0.0)]
PlainNumber = Annotated[float, Quantity(units.RATIO)]
DampingRatio = Annotated[float, Quantity(units.RATIO, at_least=0.0, below=1.0)]

Point = tuple[Length, Length, Length]


class Table(BaseModel):
    """A table of the case file: frozen, and strict about its keys."""

    later: ClassVar[frozenset[str]] = frozenset()
    """Keys that a later version has."""

    # Tables within others are built as parts of these: by themselves they would take a third of the import.
    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        populate_by_name=True,
        hide_input_in_errors=True,
        protected_namespaces=(),
        defer_build=True,
    )


class ObjectTable(Table):
    """A table of one object of the library, which checks itself: an attribute that it refuses is wrong at its key."""

    key_of_attribute: ClassVar[Mapping[str, str]] = {}
    """Keys of attributes that have another name."""

    def build(self) -> object:
        """Build the object."""
        raise NotImplementedError

    @model_validator(mode="after")
    def _can_be_built(self) -> Self:
        try:
            self.build()
        except RefusedPartError as error:
            if not error.findings:
                raise wrong(str(error)) from None
            first = error.findings[0]
            steps = filter(None, self.key_of_attribute.get(first.attribute, first.attribute).split("."))
            raise wrong(first.expected, *steps) from None
        return self


def meaning_of_field(field: FieldInfo) -> Iterator[Any]:
    """Yield every type, rule and literal of a key, outside in."""
    yield from field.metadata
    yield from _parts(field.annotation)


def _parts(annotation: Any) -> Iterator[Any]:
    yield annotation if get_origin(annotation) is None else get_origin(annotation)
    if get_origin(annotation) is Literal:
        yield get_args(annotation)
        return
    for part in get_args(annotation):
        yield from _parts(part)


def by_table(other: str) -> Discriminator:
    """Tell a table, which has the tag ``~table``, from another form with its tag."""
    return Discriminator(lambda value: "~table" if isinstance(value, (dict, Table)) else other)


def by_list(other: str) -> Discriminator:
    """Tell a list, which has the tag ``~list``, from another form with its tag."""
    return Discriminator(lambda value: "~list" if isinstance(value, (list, tuple)) else other)


UnitVector = tuple[float, float, float]


def _has_length(vector: UnitVector) -> UnitVector:
    if not 1e-100 < math.hypot(*vector) < 1e100:
        raise wrong("a vector with a direction")
    return vector


Vector = Annotated[tuple[PlainNumber, PlainNumber, PlainNumber], AfterValidator(_has_length)]
"""A vector of some length."""

Direction = Annotated[
    Annotated[Literal["x", "y", "z"], Tag("~axis")] | Annotated[Vector, Tag("~list")],
    by_list("~axis"),
]
"""'x', 'y', 'z' or a vector of some length."""


def unit_vector(direction: str | UnitVector) -> UnitVector:
    """Return a direction as a unit vector."""
    if isinstance(direction, str):
        return (float(direction == "x"), float(direction == "y"), float(direction == "z"))
    x, y, z = direction
    length = math.hypot(x, y, z)
    return (x / length, y / length, z / length)


Coefficient = float | tuple[float, ...]
"""A constant, or one value for each of some speeds."""


@dataclass(frozen=True)
class OverSpeed(Rule):
    """Validates a quantity, or a list with one for each speed of a table; to stand in `Annotated`."""

    each: Quantity

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return self.each.expected

    def write(self, coefficient: Coefficient) -> str | float | list[str | float]:
        """Return the quantity, or each of the list, as text with its unit."""
        return (
            [self.each.write(number) for number in coefficient]
            if isinstance(coefficient, tuple)
            else self.each.write(coefficient)
        )

    def validate(self, value: object) -> Coefficient:
        """Return the quantity or quantities in SI, or raise pydantic's error with what was expected and where."""
        if isinstance(value, (list, tuple)):
            if len(value) > MOST_ENTRIES:
                raise wrong(f"at most {MOST_ENTRIES} entries")
            return tuple(self.each.validate_at(entry, place) for place, entry in enumerate(value))
        return self.each.validate(value)


class Plane(Table):
    """A plane at right angles to an axis, where it meets it [m]."""

    axis: Literal["x", "y", "z"]
    """Axis normal to the plane."""
    at: Length
    """Coordinate on this axis."""


class Patch(Table):
    """Patch of the housing surface for a fixture: exactly one of the keys in `places`."""

    places: ClassVar[tuple[str, ...]] = ("box", "surface", "plane")
    """The keys that can say where; exactly one of them must."""

    box: tuple[Point, Point] | None = None
    """Two opposite corners: the facets inside."""
    surface: Name | None = None
    """Name of a surface."""
    plane: Plane | None = None
    """Plane: the facets on it."""

    @model_validator(mode="after")
    def _one_place(self) -> Patch:
        if sum(getattr(self, key) is not None for key in self.places) != 1:
            *first, last = (f"'{key}'" for key in self.places)
            raise wrong(f"exactly one of {', '.join(first)} and {last}")
        return self

    @property
    def corners(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The box's corners of least and of greatest x, y, z [m], whichever two opposite ones were given."""
        if self.box is None:
            return None
        (x1, y1, z1), (x2, y2, z2) = self.box
        return (min(x1, x2), min(y1, y2), min(z1, z2)), (max(x1, x2), max(y1, y2), max(z1, z2))

    @property
    def point_and_normal(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """A point of the plane [m] and its unit normal."""
        if self.plane is None:
            return None
        x, y, z = (float(axis == self.plane.axis) for axis in "xyz")
        return (x * self.plane.at, y * self.plane.at, z * self.plane.at), (x, y, z)

    def build_patch(self) -> BuiltPatch:
        """Build the patch of the mesh's surface."""
        from gearwhine.housing import Patch as BuiltPatch

        return BuiltPatch(self.surface, self.corners, self.point_and_normal)
