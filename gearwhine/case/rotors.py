"""Rotors of a case, `[[rotor]]`, and the analyses of them, `[rotor_analysis]`.

Shaft segments, couplings, discs, unbalance and bow each build their object of `rotors`. Attributes are named as the
keys and are in SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    Discriminator,
    Field,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    Tag,
    ValidationError,
    ValidationInfo,
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
    DampingFromZero,
    DampingRatio,
    Density,
    Force,
    Imbalance,
    Inertia,
    Length,
    LengthFromZero,
    Mass,
    MaterialName,
    Name,
    PositiveFrequency,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    RotorName,
    Rule,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.input_files import ChangedFileError, files_of
from gearwhine.case.operation import Acceleration, Speeds

if TYPE_CHECKING:
    from gearwhine.case.housing import Material
    from gearwhine.coupling.machine.pins import Pin as BuiltPin
    from gearwhine.rotors import Coupling as BuiltCoupling
    from gearwhine.rotors import Disc as BuiltDisc
    from gearwhine.rotors import Rotor as BuiltRotor
    from gearwhine.rotors import Segment as BuiltSegment
    from gearwhine.rotors import ShaftMaterial
    from gearwhine.rotors import Unbalance as BuiltUnbalance
    from gearwhine.rotors.model.loads import Bow as BuiltBow
    from gearwhine.rotors.ross.reading import RossModel

_MOST_SHEAR = 1.5
"""Largest shear coefficient: sections that bend softer than they shear have little more than 1; for a larger one its
reciprocal is meant."""


@dataclass(frozen=True)
class _ShearRule(Rule):
    """Validates a shear coefficient: a formula by its name, or the number itself."""

    def validate(self, value: object) -> ShearFormula | float:
        if value == "cowper" or value == "hutchinson":
            return value
        try:
            return Quantity(units.RATIO, above=0.0, at_most=_MOST_SHEAR).validate(value)
        except PydanticCustomError:
            raise wrong(f"'cowper', 'hutchinson', or a number above 0 and of at most {_MOST_SHEAR:g}") from None


ShearFormula = Literal["cowper", "hutchinson"]
ShearCoefficient = Annotated[ShearFormula | float, _ShearRule()]
PositiveTiltStiffness = Annotated[float, Quantity(units.TILT_STIFFNESS, above=0.0)]
TiltDampingFromZero = Annotated[float, Quantity(units.TILT_DAMPING, at_least=0.0)]


_SLENDEREST = 1000.0  # length over diameter of a piece of shaft


class Segment(Table):
    """A piece of shaft [m], a cone where `right_diameter` or `right_bore` differ from those at its left end."""

    length: PositiveLength
    """Length."""
    diameter: PositiveLength
    """Outer diameter, of a cone at its left end."""
    bore: LengthFromZero = 0.0
    """Inner diameter, of a cone at its left end."""
    right_diameter: PositiveLength | None = None
    """Outer diameter at the right end of a cone. Default: `diameter`."""
    right_bore: LengthFromZero | None = None
    """Inner diameter at the right end of a cone. Default: `bore`."""
    material: MaterialName | None = None
    """Name of the material. Default: that of the rotor."""
    shear_coefficient: ShearCoefficient | None = None
    """Shear coefficient. Default: that of the rotor."""
    axial_force: Force | None = None
    """Static axial force, tension positive. Default: that of the rotor."""

    @field_validator("diameter", "bore", mode="before")
    @classmethod
    def _one_end(cls, value: Any, info: ValidationInfo) -> Any:
        if isinstance(value, (list, tuple)):
            raise wrong(f"one length, at the left end; that of a cone's right end is 'right_{info.field_name}'")
        return value

    @model_validator(mode="after")
    def _hollow(self) -> Segment:
        thinnest = min(self.diameter, self.right_diameter or self.diameter)
        if self.length > _SLENDEREST * thinnest:
            raise wrong(f"at most {_SLENDEREST:g} times its diameter of {thinnest:g} m: a shaft, not a wire", "length")
        if self.bore >= self.diameter:
            raise wrong(f"a bore smaller than the diameter of {self.diameter:g} m", "bore")
        diameter = self.diameter if self.right_diameter is None else self.right_diameter
        if self.right_bore is None and self.bore >= diameter:
            raise wrong(f"a diameter larger than the bore of {self.bore:g} m, or a 'right_bore'", "right_diameter")
        if self.right_bore is not None and self.right_bore >= diameter:
            raise wrong(f"a bore smaller than the diameter of {diameter:g} m at the right end", "right_bore")
        return self

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltSegment:
        """Build the shaft segment, with its rotor's properties where it has none of its own."""
        from gearwhine.rotors import Segment as BuiltSegment

        return BuiltSegment(
            length=self.length,
            outer_diameter=self.diameter,
            inner_diameter=self.bore,
            material=_shaft_material_named(self.material, rotor, materials),
            shear_coefficient=self.shear_coefficient or rotor.shear_coefficient,
            right_outer_diameter=self.right_diameter,
            right_inner_diameter=self.right_bore,
            axial_force=rotor.axial_force if self.axial_force is None else self.axial_force,
        )


class Coupling(Table):
    """A flexible coupling by its stiffness, damping, mass and inertia.

    Dashpots stand beside the springs.
    """

    lateral_stiffness: PositiveStiffness
    """Stiffness across the axis."""
    tilt_stiffness: PositiveTiltStiffness
    """Stiffness against an angle between the axes."""
    torsional_stiffness: PositiveTiltStiffness
    """Stiffness about the axis."""
    axial_stiffness: PositiveStiffness
    """Stiffness along the axis."""
    lateral_damping: DampingFromZero = 0.0
    """Damping across the axis; dashpots rotate with the shaft and act in the coupled system."""
    tilt_damping: TiltDampingFromZero = 0.0
    """Damping against an angle between the axes."""
    torsional_damping: TiltDampingFromZero = 0.0
    """Damping about the axis, also in the torsional response."""
    axial_damping: DampingFromZero = 0.0
    """Damping along the axis."""
    mass: Mass = 0.0
    """Mass of the whole."""
    polar_inertia: Inertia = 0.0
    """Moment of inertia about the axis."""
    diametral_inertia: Inertia = 0.0
    """Moment of inertia across the axis."""


class CouplingSegment(Table):
    """A coupling in the row of segments: its length from hub to hub [m]."""

    length: PositiveLength
    """Length from hub to hub."""
    coupling: Coupling
    """Stiffness, damping and inertia of the coupling."""
    axial_force: Force | None = None
    """Static axial force that it passes on, tension positive; 0 where it slides. Default: that of the shafts on both
    sides if they have the same, else that of the rotor."""

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltCoupling:
        """Build the coupling, with its rotor's axial force where it has none of its own."""
        from gearwhine.rotors import Coupling as BuiltCoupling

        force = rotor.axial_force if self.axial_force is None else self.axial_force
        return BuiltCoupling(self.length, **self.coupling.model_dump(), axial_force=force)


class Disc(Table):
    """A rigid disc at a station [m from the left end]: mass [kg] and inertias [kg m²]; without these a point mass."""

    at: LengthFromZero
    """Station from the rotor's left end."""
    mass: Mass
    """Mass."""
    polar_inertia: Inertia = 0.0
    """Moment of inertia about the axis; without inertias a point mass."""
    diametral_inertia: Inertia = 0.0
    """Moment of inertia across the axis."""

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltDisc:
        """Build the disc; it takes no property from its rotor."""
        from gearwhine.rotors import Disc as BuiltDisc

        return BuiltDisc(**self.model_dump())


class RoundDisc(Table):
    """A rigid disc by its sizes [m], its middle at a station: of a material (None: the rotor's) or density [kg/m³]."""

    at: LengthFromZero
    """Station of its middle from the rotor's left end."""
    width: PositiveLength
    """Width."""
    diameter: PositiveLength
    """Outer diameter."""
    bore: LengthFromZero = 0.0
    """Inner diameter."""
    material: MaterialName | None = None
    """Name of the material. Default: that of the rotor."""
    density: Density | None = None
    """Density, in place of `material`."""

    @model_validator(mode="after")
    def _solid(self) -> RoundDisc:
        if self.bore >= self.diameter:
            raise wrong(f"a bore smaller than the diameter of {self.diameter:g} m", "bore")
        if self.material is not None and self.density is not None:
            raise wrong("either 'material' or 'density', not both", "density")
        return self

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltDisc:
        """Build the disc by its dimensions and density."""
        from gearwhine.rotors import Disc as BuiltDisc

        density = self.density
        if density is None:
            material = rotor.material_of(self.material, self.at, materials)
            assert material is not None  # checked with the case
            density = material.density
        return BuiltDisc.from_dimensions(self.at, self.width, self.diameter, self.bore, density)


def _named(part_material: str | None, rotor: Rotor) -> str:
    """Name of a part's material: its own, else its rotor's."""
    name = part_material or rotor.material
    assert name is not None
    return name


def _shaft_material_named(own: str | None, rotor: Rotor, materials: Mapping[str, Material]) -> ShaftMaterial:
    """Material of a part of a shaft: its own by name, else its rotor's."""
    from gearwhine.rotors import ShaftMaterial

    steel = materials[_named(own, rotor)]
    return ShaftMaterial(steel.youngs_modulus, steel.shear_modulus, steel.density)


def _segment_form(value: Any) -> str:
    coupled = "coupling" in value if isinstance(value, dict) else isinstance(value, CouplingSegment)
    return "~coupling" if coupled else "~shaft"


def _disc_form(value: Any) -> str:
    sized = {"width", "diameter", "bore", "material", "density"}
    by_size = not sized.isdisjoint(value) if isinstance(value, dict) else isinstance(value, RoundDisc)
    return "~sizes" if by_size else "~inertia"


AnySegment = Annotated[
    Annotated[Segment, Tag("~shaft")] | Annotated[CouplingSegment, Tag("~coupling")], Discriminator(_segment_form)
]
AnyDisc = Annotated[Annotated[Disc, Tag("~inertia")] | Annotated[RoundDisc, Tag("~sizes")], Discriminator(_disc_form)]


class Unbalance(Table):
    """An unbalance at a station: mass times eccentricity [kg m] and its angle from x at rest [rad]."""

    at: LengthFromZero
    """Station from the rotor's left end."""
    moment: Imbalance
    """Mass times eccentricity."""
    phase: Angle = 0.0
    """Angle from x when the rotor's mark points along x."""


class Bow(Table):
    """A point of the residual bow: run-out of the unloaded centre line [m] and its angle from x [rad]."""

    at: LengthFromZero
    """Station from the rotor's left end."""
    amplitude: LengthFromZero
    """Runout of the unloaded centre line."""
    phase: Angle = 0.0
    """Angle from x when the rotor's mark points along x."""


_PIN_FORMS = "'walls' and 'diameter', or 'at', 'stiffness' and 'tilt_stiffness'"


class Pin(Table):
    """`pin` of a planet's `[[rotor]]`, on which its bearings sit: a beam in `walls` of the carrier, or its stiffness.

    The carrier's rotor takes the walls along: what joins two of them is its segments between, and its mass has that of
    the pin.
    """

    walls: tuple[Length, ...] | None = Field(default=None, min_length=1, max_length=4)
    """z of the walls that clamp it: two, or one of a pin that is clamped at one end. Needs `diameter`."""
    diameter: PositiveLength | None = None
    """Diameter of the beam."""
    bore: LengthFromZero = 0.0
    """Bore of the beam."""
    material: MaterialName | None = None
    """Material of the beam. Default: that of the rotor."""
    at: Length | None = None
    """z of the place that the stiffness is of; in place of walls."""
    stiffness: PositiveStiffness | None = None
    """Force over displacement across the axis, of a rigid pin on springs `at` a place. Needs `tilt_stiffness`."""
    tilt_stiffness: Annotated[float, Quantity(units.TILT_STIFFNESS, above=0.0)] | None = None
    """Moment over rotation about an axis across."""

    @model_validator(mode="after")
    def _one_of_both(self) -> Pin:
        beam, springs = ("walls", "diameter"), ("at", "stiffness", "tilt_stiffness")
        is_beam = self.walls is not None or self.diameter is not None
        for key in beam if is_beam else springs:
            if getattr(self, key) is None:
                raise wrong(_PIN_FORMS if not is_beam and self.stiffness is None else f"'{key}' beside the others", key)
        for key in springs if is_beam else ("bore", "material"):
            if getattr(self, key):
                raise wrong("nothing beside " + ("walls" if is_beam else "a stiffness"), key)
        if self.walls is not None and len(set(self.walls)) < len(self.walls):
            raise wrong("each wall once", "walls")
        if self.diameter is not None and self.bore >= self.diameter:
            raise wrong(f"a bore smaller than the diameter of {self.diameter:g} m", "bore")
        return self

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltPin:
        """Build the pin, of the rotor's material where it has none of its own."""
        from gearwhine.coupling.machine.pins import PinBeam, PinSprings

        match self:
            case Pin(walls=tuple(walls), diameter=float(diameter)):
                return PinBeam(walls, diameter, _shaft_material_named(self.material, rotor, materials), self.bore)
            case Pin(at=float(at), stiffness=float(radial), tilt_stiffness=float(tilt)):
                return PinSprings(at, radial, tilt)
        raise wrong(_PIN_FORMS)


_OF_THE_SHAFT = ("segments", "shear_coefficient", "axial_force")
"""Keys that a rotor's file stands for."""


class Rotor(Table):
    """`[[rotor]]`: a shaft along z at `axis` (x, y), its left end at z = `start`, all in m.

    Where a `file` of ROSS holds the shaft, with its discs and grounded bearings, there are no `segments` here.
    """

    name: Name
    """Name of the rotor."""
    axis: tuple[Length, Length] = (0.0, 0.0)
    """x and y of the shaft line."""
    carrier: RotorName | None = None
    """Rotor with which the shaft line turns, as that of a planet with its carrier; `axis` is then its place at t = 0,
    and its bearings sit on the carrier. Planets of a `[[planetary]]` have it from there."""
    pin_error: tuple[Length, Length] = (0.0, 0.0)
    """Offset of a planet's pin from `axis`, outward from the carrier's axis and counter-clockwise about it."""
    pin: Pin | None = None
    """Elastic pin of a planet between its bearings and the carrier. Default: a rigid one."""
    rim_seat: Name | None = None
    """Seat of the housing, with `ring_orders`, whose bore the rim of the ring gear on this rotor follows as it deforms;
    the gear's `ring_support` is then none, `clamped` or `housing`.
    Default: the rim moves as one body with the rotor."""
    start: Length = 0.0
    """z of its left end."""
    file: CaseFile | None = None
    """Rotor saved by ROSS (`.toml`, `.json`), relative to the case file, in place of `material` and `segments`: its
    shaft, discs and bearings."""
    material: MaterialName | None = None
    """Name of the material; needed without `file`. Beside it: that of discs and gears on the shaft, which by default
    have the material that the shaft of the file has at their station."""
    mass: Literal["distributed", "lumped"] = "distributed"
    """Mass of the shaft, distributed or lumped at the ends of the segments, at which its bearings should stand then."""
    damping_ratio: DampingRatio = 0.005
    """Damping ratio of the shaft's own modes, in the coupled system."""
    internal_damping: Annotated[float, Quantity(units.TIME, at_least=0.0, at_most=1e-2)] = 0.0
    """Internal viscous damping of the shaft over its stiffness, in the coupled system. It rotates with the shaft, and
    feeds forward whirl at speeds above the whirl's frequency; `damping_ratio` does not."""
    shear_coefficient: ShearCoefficient = "cowper"
    """Shear coefficient: the formula of Cowper or of Hutchinson, or the number itself."""
    axial_force: Force = 0.0
    """Static axial force, tension positive."""
    modes: Annotated[int, Whole(1, 300)] | None = None
    """Number of bending modes of each plane and of torsional modes in the coupled system, the rigid rotation included.
    One of this and `frequency_limit`."""
    frequency_limit: PositiveFrequency | None = None
    """Modes in the coupled system are those below this frequency, at least four of each kind. Default: 8 kHz, or 2.5
    times the housing's limit where that is more."""
    segments: tuple[AnySegment, ...] = Field(default=(), min_length=1, max_length=MOST_ENTRIES)
    """Shaft segments and couplings from the left end to the right; needed without `file`."""
    discs: tuple[AnyDisc, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Rigid discs."""
    unbalance: tuple[Unbalance, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Unbalances."""
    bow: tuple[Bow, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Residual bow, by two points or more."""

    _saved: RossModel | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _described(self, info: ValidationInfo) -> Rotor:
        if self.file is None:
            for key, expected in (("material", "the name of a material"), ("segments", "a list")):
                if not getattr(self, key):
                    raise wrong(f"{expected}, or a rotor's file instead", key)
            return self
        for key in _OF_THE_SHAFT:
            if key in self.model_fields_set:
                raise wrong("no such key beside file, which holds the shaft", key)
        from gearwhine.rotors import RotorError, read_ross

        try:
            self._saved = files_of(info).read(self.file, read_ross)
        except RotorError as error:
            raise wrong(f"a rotor saved by ROSS ({error})", "file") from None
        except ChangedFileError as error:
            raise wrong(str(error), "file") from None
        return self

    @model_serializer(mode="wrap")
    def _without_what_the_file_holds(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = write(self)
        if self.file is not None:
            for key in _OF_THE_SHAFT:
                del written[key]
        return written

    @model_validator(mode="after")
    def _one_measure(self) -> Rotor:
        if self.modes is not None and self.frequency_limit is not None:
            raise wrong("either 'modes' or 'frequency_limit', not both", "frequency_limit")
        return self

    @property
    def saved(self) -> RossModel | None:
        """Content of the ROSS file; None where the shaft is described here."""
        return self._saved

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        if self._saved is not None:
            return self._saved.rotor.length
        return sum(segment.length for segment in self.segments)

    @property
    def bores(self) -> tuple[float, ...]:
        """Bores of the segments of a shaft that stands here, at their left ends [m]."""
        return tuple(segment.bore for segment in self.segments if isinstance(segment, Segment))

    def material_of(self, own: str | None, at: float, materials: Mapping[str, Material]) -> Material | None:
        """Return the material of a disc or gear at a station [m]: its own, the rotor's, else the shaft's of the file.

        None where the file's shaft has several materials at the station, or none that a solid can have.
        """
        name = own or self.material
        if name is not None:
            return materials[name]
        return None if self._saved is None else _shaft_material(self._saved.rotor, at)

    def build(self, materials: Mapping[str, Material]) -> BuiltRotor:
        """Build the shaft with its discs, without the gears on it; the discs of the rotor's own file stand first."""
        from gearwhine.rotors import Rotor as BuiltRotor

        discs = [disc.build(self, materials) for disc in self.discs]
        if self._saved is not None:
            of_file = self._saved.rotor
            return BuiltRotor(self.name, of_file.segments, [*of_file.discs, *discs], self.mass)
        return BuiltRotor(self.name, self._build_segments(materials), discs, self.mass)

    def _build_segments(self, materials: Mapping[str, Material]) -> list[BuiltSegment | BuiltCoupling]:
        from gearwhine.rotors.model.segment import forces_beside

        segments = [segment.build(self, materials) for segment in self.segments]
        for number, table in enumerate(self.segments):
            if isinstance(table, CouplingSegment) and table.axial_force is None:
                left, right = forces_beside(segments, number)
                if left is not None and left == right:
                    segments[number] = replace(segments[number], axial_force=left)
        return segments

    def build_pin(self, materials: Mapping[str, Material]) -> BuiltPin | None:
        """Build the elastic pin of a planet; None of a rigid one."""
        return None if self.pin is None else self.pin.build(self, materials)

    def build_unbalance(self) -> list[BuiltUnbalance]:
        """Build the unbalances."""
        from gearwhine.rotors import Unbalance as BuiltUnbalance

        return [BuiltUnbalance(entry.at, entry.moment, entry.phase) for entry in self.unbalance]

    def build_bow(self) -> BuiltBow | None:
        """Build the residual bow; None for a straight shaft."""
        if not self.bow:
            return None
        from numpy import array

        from gearwhine.rotors.model.loads import Bow as BuiltBow

        return BuiltBow(*array([(point.at, point.amplitude, point.phase) for point in self.bow]).T)


_STATION_ROUNDING = 1e-9  # part of a shaft's length within which a station stands at the end of a segment


def _shaft_material(shaft: BuiltRotor, at: float) -> Material | None:
    """Return the one material of the segments that a station [m] touches; None where there is not one."""
    from gearwhine.case.housing import Material
    from gearwhine.rotors import Segment as BuiltSegment

    ends, rounding = shaft.joints.tolist(), _STATION_ROUNDING * shaft.length
    touched = {
        segment.material
        for segment, left, right in zip(shaft.segments, ends, ends[1:], strict=False)
        if isinstance(segment, BuiltSegment) and left - rounding <= at <= right + rounding
    }
    if len(touched) != 1:
        return None
    (material,) = touched
    try:
        return Material(
            youngs_modulus=material.youngs_modulus,
            poisson_ratio=material.youngs_modulus / (2.0 * material.shear_modulus) - 1.0,
            density=material.density,
        )
    except ValidationError:
        return None


MOST_PROBES = 100
MOST_ORDERS = 20

STANDARD_GRAVITY = 9.80665
"""The standard acceleration of free fall [m/s²]."""


class StiffnessMap(Table):
    """Bearing stiffnesses from `start` (key `from`) to `to` [N/m], both included, in `points` equal ratios."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveStiffness = Field(alias="from")
    """Lowest stiffness."""
    to: PositiveStiffness
    """Highest stiffness, included."""
    points: Annotated[int, Whole(2, 1000)] = 30
    """Number of stiffnesses, in equal ratios."""
    modes: Annotated[int, Whole(1, 50)] = 4
    """Number of critical speeds at each."""
    whirl: Literal["forward", "backward"] = "forward"
    """Direction of whirl."""

    @model_validator(mode="after")
    def _ascends(self) -> StiffnessMap:
        if self.to <= self.start:
            raise wrong(f"a stiffness above 'from', {self.start:g} N/m", "to")
        return self

    @property
    def stiffnesses(self) -> tuple[float, ...]:
        """Every stiffness of the map [N/m], ascending."""
        step = (self.to / self.start) ** (1.0 / (self.points - 1))
        return (*(self.start * step**place for place in range(self.points - 1)), self.to)


class Probe(Table):
    """A sensor of the shaft's displacement at a station [m from the rotor's left end], at an angle from x [rad]."""

    name: Name
    """Name of the probe."""
    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Station from the rotor's left end."""
    angle: Angle = 0.0
    """Angle of the measured direction from x."""


class UnbalanceResponse(Table):
    """Speeds of the response to unbalance and bow (None: over the Campbell diagram's, finer), and what reads it."""

    speed: Speeds | None = None
    """Speeds, in the sense of `[operation] speed`: a list or a range. Default: the Campbell diagram's range in 300
    steps."""
    probes: tuple[Probe, ...] = Field(default=(), max_length=MOST_PROBES)
    """Probes of the shaft's displacement. Default: one at each bearing and each unbalance, along x."""


class FrequencyRange(Table):
    """Frequencies from `start` (key `from`) to `to` [Hz], both included, in `points` equal steps."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveFrequency = Field(alias="from")
    """Lowest frequency."""
    to: PositiveFrequency
    """Highest frequency, included."""
    points: Annotated[int, Whole(2, 100_000)] = 400
    """Number of frequencies, in equal steps."""

    @model_validator(mode="after")
    def _ascends(self) -> FrequencyRange:
        if self.to <= self.start:
            raise wrong(f"a frequency above 'from', {self.start:g} Hz", "to")
        return self

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Every frequency of the range [Hz], ascending."""
        step = (self.to - self.start) / (self.points - 1)
        return (*(self.start + step * place for place in range(self.points - 1)), self.to)


class HarmonicTorque(Table):
    """A torque [N m] about the axis of a rotor at a station [m], that swings ahead by a phase [rad]."""

    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Station from the rotor's left end."""
    amplitude: Annotated[float, Quantity(units.TORQUE, above=0.0)]
    """Amplitude, zero to peak."""
    phase: Angle = 0.0
    """Phase."""


class TorsionSpring(Table):
    """Torsional support of a rotor at a station [m] against the ground: stiffness [N m/rad], damping [N m s/rad]."""

    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Station from the rotor's left end."""
    stiffness: Annotated[float, Quantity(units.TILT_STIFFNESS, at_least=0.0)] = 0.0
    """Stiffness to the ground."""
    damping: Annotated[float, Quantity(units.TILT_DAMPING, at_least=0.0)] = 0.0
    """Damping to the ground."""


class TorsionProbe(Table):
    """A station [m from the rotor's left end] at which angle and torque are wanted."""

    name: Name
    """Name of the probe."""
    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Station from the rotor's left end."""


class TorsionalAnalysis(Table):
    """Steady answer of each rotor's torsion to torques that swing at a frequency."""

    torques: tuple[HarmonicTorque, ...] = Field(min_length=1, max_length=MOST_PROBES)
    """Harmonic torques."""
    frequency: FrequencyRange | None = None
    """Frequencies. Default: up to 1.25 times the third elastic mode, in 400 steps and at the modes."""
    damping_ratio: DampingRatio | None = None
    """Damping ratio of the shafts. Default: that of each rotor."""
    springs: tuple[TorsionSpring, ...] = Field(default=(), max_length=MOST_PROBES)
    """Torsion springs to the ground."""
    probes: tuple[TorsionProbe, ...] = Field(default=(), max_length=MOST_PROBES)
    """Stations at which angle and torque are read. Default: one at each torque and one at either end."""


class RotorAnalysis(Table):
    """`[rotor_analysis]`: speeds of the first driver's rotor, and what is wanted beside the modes."""

    speed: Speeds | None = None
    """Speeds of the Campbell diagram, in the sense of `[operation] speed`: a list or a range. Default: those of
    `[sweep]`, else 50 steps up to 1.5 times the speed of operation."""
    modes: Annotated[int, Whole(1, 200)] | None = None
    """Number of lateral modes. Default: 12, or all of a small lumped rotor."""
    orders: tuple[Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1000.0)], ...] = Field(
        default=(), max_length=MOST_ORDERS
    )
    """Further multiples of the speed whose lines and critical speeds the Campbell diagram shows; 1 is always there."""
    stiffness_map: StiffnessMap | None = None
    """Critical speeds over the stiffness of all bearings."""
    torsional_response: TorsionalAnalysis | None = None
    """Response to harmonic torques."""
    unbalance_response: UnbalanceResponse = UnbalanceResponse()
    """Response to unbalance and bow."""
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -STANDARD_GRAVITY, 0.0)
    """Acceleration of gravity along x, y, z, for static deflections."""
