"""Rotors of a case, `[[rotor]]`, and the analyses of them, `[rotor_analysis]`.

Shaft segments, couplings, discs, unbalance and bow each build their object of `rotors`. Attributes are named as the
keys and are in SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    PrivateAttr,
    SerializerFunctionWrapHandler,
    Tag,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError, core_schema

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
    Name,
    PositiveFrequency,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.operation import Acceleration, Speeds

if TYPE_CHECKING:
    from gearwhine.case.housing import Material
    from rotors import Coupling as BuiltCoupling
    from rotors import Disc as BuiltDisc
    from rotors import Rotor as BuiltRotor
    from rotors import Segment as BuiltSegment
    from rotors import Unbalance as BuiltUnbalance
    from rotors.model.loads import Bow as BuiltBow
    from rotors.ross.reading import RossModel

_MOST_SHEAR = 1.5
"""Coefficients of sections that bend softer than they shear are above 1, hardly ever by more; its reciprocal is meant
where one is."""


@dataclass(frozen=True)
class _ShearRule:
    """Validates a shear coefficient: a formula by its name, or the number itself."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

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
    """A piece of shaft [m], a cone where `right_diameter` or `right_bore` differ from those at its left end.

    `material`, `shear_coefficient` and `axial_force` [N, tension positive] where they differ from the rotor's.
    """

    length: PositiveLength
    diameter: PositiveLength
    bore: LengthFromZero = 0.0
    right_diameter: PositiveLength | None = None
    right_bore: LengthFromZero | None = None
    material: Name | None = None
    shear_coefficient: ShearCoefficient | None = None
    axial_force: Force | None = None

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
        from rotors import Segment as BuiltSegment
        from rotors import ShaftMaterial

        steel = materials[_named(self.material, rotor)]
        return BuiltSegment(
            length=self.length,
            outer_diameter=self.diameter,
            inner_diameter=self.bore,
            material=ShaftMaterial(steel.youngs_modulus, steel.shear_modulus, steel.density),
            shear_coefficient=self.shear_coefficient or rotor.shear_coefficient,
            right_outer_diameter=self.right_diameter,
            right_inner_diameter=self.right_bore,
            axial_force=rotor.axial_force if self.axial_force is None else self.axial_force,
        )


class Coupling(Table):
    """A flexible coupling by its stiffness, damping, mass and inertia.

    Stiffness across the axis and along it [N/m], against an angle between the axes and about them [N m/rad]; dashpots
    beside these [N s/m, N m s/rad]; mass [kg] and inertias [kg m²] of the whole.
    """

    lateral_stiffness: PositiveStiffness
    tilt_stiffness: PositiveTiltStiffness
    torsional_stiffness: PositiveTiltStiffness
    axial_stiffness: PositiveStiffness
    lateral_damping: DampingFromZero = 0.0
    tilt_damping: TiltDampingFromZero = 0.0
    torsional_damping: TiltDampingFromZero = 0.0
    axial_damping: DampingFromZero = 0.0
    mass: Mass = 0.0
    polar_inertia: Inertia = 0.0
    diametral_inertia: Inertia = 0.0


class CouplingSegment(Table):
    """A coupling in the row of segments: its length from hub to hub [m]."""

    length: PositiveLength
    coupling: Coupling

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltCoupling:
        """Build the coupling; it takes no property from its rotor."""
        from rotors import Coupling as BuiltCoupling

        return BuiltCoupling(self.length, **self.coupling.model_dump())


class Disc(Table):
    """A rigid disc at a station [m from the left end]: mass [kg] and inertias [kg m²]; without these a point mass."""

    at: LengthFromZero
    mass: Mass
    polar_inertia: Inertia = 0.0
    diametral_inertia: Inertia = 0.0

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltDisc:
        """Build the disc; it takes no property from its rotor."""
        from rotors import Disc as BuiltDisc

        return BuiltDisc(**self.model_dump())


class RoundDisc(Table):
    """A rigid disc by its sizes [m], its middle at a station: of a material (None: the rotor's) or density [kg/m³]."""

    at: LengthFromZero
    width: PositiveLength
    diameter: PositiveLength
    bore: LengthFromZero = 0.0
    material: Name | None = None
    density: Density | None = None

    @model_validator(mode="after")
    def _solid(self) -> RoundDisc:
        if self.bore >= self.diameter:
            raise wrong(f"a bore smaller than the diameter of {self.diameter:g} m", "bore")
        if self.material is not None and self.density is not None:
            raise wrong("either 'material' or 'density', not both", "density")
        return self

    def build(self, rotor: Rotor, materials: Mapping[str, Material]) -> BuiltDisc:
        """Build the disc by its dimensions and density."""
        from rotors import Disc as BuiltDisc

        density = self.density or materials[_named(self.material, rotor)].density
        return BuiltDisc.from_dimensions(self.at, self.width, self.diameter, self.bore, density)


def _named(own: str | None, rotor: Rotor) -> str:
    """Name of a part's material: its own, else its rotor's."""
    name = own or rotor.material
    assert name is not None
    return name


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
    moment: Imbalance
    phase: Angle = 0.0


class Bow(Table):
    """A point of the residual bow: run-out of the unloaded centre line [m] and its angle from x [rad]."""

    at: LengthFromZero
    amplitude: LengthFromZero
    phase: Angle = 0.0


_OF_THE_SHAFT = ("segments", "shear_coefficient", "axial_force")
"""Keys that a rotor's file stands for."""


class Rotor(Table):
    """`[[rotor]]`: a shaft along z at `axis` (x, y), its left end at z = `start`, all in m.

    `damping_ratio` is that of the shaft's own modes. `shear_coefficient` (a formula or a number) and `axial_force`
    [N, tension positive] hold for segments that have none of their own. The coupled system keeps the lowest `modes` of
    each kind, or those below a `frequency_limit` [Hz]. Where a `file` of ROSS holds the shaft, with its discs and
    grounded bearings, there are no `segments` here.
    """

    name: Name
    axis: tuple[Length, Length] = (0.0, 0.0)
    start: Length = 0.0
    file: CaseFile | None = None
    material: Name | None = None
    mass: Literal["distributed", "lumped"] = "distributed"
    damping_ratio: DampingRatio = 0.005
    shear_coefficient: ShearCoefficient = "cowper"
    axial_force: Force = 0.0
    modes: Annotated[int, Whole(1, 300)] | None = None
    frequency_limit: PositiveFrequency | None = None
    segments: tuple[AnySegment, ...] = Field(default=(), min_length=1, max_length=MOST_ENTRIES)
    discs: tuple[AnyDisc, ...] = Field(default=(), max_length=MOST_ENTRIES)
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
        for key in _OF_THE_SHAFT:
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

    def build(self, materials: Mapping[str, Material]) -> BuiltRotor:
        """Build the shaft with its discs, without the gears on it; the discs of the rotor's own file stand first."""
        from rotors import Rotor as BuiltRotor

        discs = [disc.build(self, materials) for disc in self.discs]
        if self._saved is not None:
            of_file = self._saved.rotor
            return BuiltRotor(self.name, of_file.segments, [*of_file.discs, *discs], self.mass)
        segments = [segment.build(self, materials) for segment in self.segments]
        return BuiltRotor(self.name, segments, discs, self.mass)

    def build_unbalance(self) -> list[BuiltUnbalance]:
        """Build the unbalances."""
        from rotors import Unbalance as BuiltUnbalance

        return [BuiltUnbalance(one.at, one.moment, one.phase) for one in self.unbalance]

    def build_bow(self) -> BuiltBow | None:
        """Build the residual bow; None for a straight shaft."""
        if not self.bow:
            return None
        from numpy import array

        from rotors.model.loads import Bow as BuiltBow

        return BuiltBow(*array([(point.at, point.amplitude, point.phase) for point in self.bow]).T)


MOST_PROBES = 100
MOST_ORDERS = 20

STANDARD_GRAVITY = 9.80665
"""The standard acceleration of free fall [m/s²]."""


class StiffnessMap(Table):
    """Bearing stiffnesses from `start` (key `from`) to `to` [N/m], both included, in `points` equal ratios.

    At each, the lowest `modes` critical speeds of forward or backward `whirl`.
    """

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveStiffness = Field(alias="from")
    to: PositiveStiffness
    points: Annotated[int, Whole(2, 1000)] = 30
    modes: Annotated[int, Whole(1, 50)] = 4
    whirl: Literal["forward", "backward"] = "forward"

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
    rotor: Name
    at: LengthFromZero
    angle: Angle = 0.0


class UnbalanceResponse(Table):
    """Speeds of the response to unbalance and bow (None: over the Campbell diagram's, finer), and what reads it."""

    speed: Speeds | None = None
    probes: tuple[Probe, ...] = Field(default=(), max_length=MOST_PROBES)


class FrequencyRange(Table):
    """Frequencies from `start` (key `from`) to `to` [Hz], both included, in `points` equal steps."""

    model_config = ConfigDict(serialize_by_alias=True)

    start: PositiveFrequency = Field(alias="from")
    to: PositiveFrequency
    points: Annotated[int, Whole(2, 100_000)] = 400

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

    rotor: Name
    at: LengthFromZero
    amplitude: Annotated[float, Quantity(units.TORQUE, above=0.0)]
    phase: Angle = 0.0


class TorsionSpring(Table):
    """Torsional support of a rotor at a station [m] against the ground: stiffness [N m/rad], damping [N m s/rad]."""

    rotor: Name
    at: LengthFromZero
    stiffness: Annotated[float, Quantity(units.TILT_STIFFNESS, at_least=0.0)] = 0.0
    damping: Annotated[float, Quantity(units.TILT_DAMPING, at_least=0.0)] = 0.0


class TorsionProbe(Table):
    """A station [m from the rotor's left end] at which angle and torque are wanted."""

    name: Name
    rotor: Name
    at: LengthFromZero


class TorsionalAnalysis(Table):
    """Steady answer of each rotor's torsion to torques that swing at a frequency.

    Without `frequency`, up to beyond the third elastic mode. `damping_ratio` is that of the shafts (None: each rotor's
    own). Without probes, one stands at each torque and one at either end.
    """

    torques: tuple[HarmonicTorque, ...] = Field(min_length=1, max_length=MOST_PROBES)
    frequency: FrequencyRange | None = None
    damping_ratio: DampingRatio | None = None
    springs: tuple[TorsionSpring, ...] = Field(default=(), max_length=MOST_PROBES)
    probes: tuple[TorsionProbe, ...] = Field(default=(), max_length=MOST_PROBES)


class RotorAnalysis(Table):
    """`[rotor_analysis]`: speeds of the first driver's rotor, and what is wanted beside the modes.

    `orders` are the multiples of the speed of rotation that the Campbell diagram shows with their critical speeds;
    that of once a revolution is always among them. `modes` is how many lateral ones (None: 12, or all of a small lumped
    rotor). Without `speed` the Campbell diagram has the speeds of `[sweep]`, else those up to one and a half times the
    speed of operation. `gravity` is an acceleration along x, y, z [m/s²].
    """

    speed: Speeds | None = None
    modes: Annotated[int, Whole(1, 200)] | None = None
    orders: tuple[Annotated[float, Quantity(units.RATIO, above=0.0, at_most=1000.0)], ...] = Field(
        default=(), max_length=MOST_ORDERS
    )
    stiffness_map: StiffnessMap | None = None
    torsional_response: TorsionalAnalysis | None = None
    unbalance_response: UnbalanceResponse = UnbalanceResponse()
    gravity: tuple[Acceleration, Acceleration, Acceleration] = (0.0, -STANDARD_GRAVITY, 0.0)
