"""Gears and gear pairs of a case, `[[gear]]` and `[[gear_pair]]`, and the gear train that the pairs form.

Flank modifications, manufacturing errors and faults of a gear each build their object of `gearwhine.coupling.gears`.
The train lists pairs of shafts with their tooth numbers. Attributes are named as the keys and are in SI.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, StrictBool, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearwhine.case import units
from gearwhine.case.fields import (
    Angle,
    CaseFile,
    DampingFromZero,
    DampingRatio,
    GearName,
    Inertia,
    LengthFromZero,
    Mass,
    MaterialName,
    Name,
    ObjectTable,
    PlanetNumber,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    RotorName,
    SensorName,
    Table,
    Whole,
    one_of_planets,
    wrong,
)

if TYPE_CHECKING:
    from gearwhine.case.housing import Material
    from gearwhine.coupling.description.gear_train import GearTrain
    from gearwhine.coupling.gears import Gear as BuiltGear
    from gearwhine.coupling.gears import HelixDeviation, ProfileDeviation, RootRelief, TipRelief
    from gearwhine.coupling.gears.geometry.gear import Fault as BuiltFault
    from gearwhine.coupling.gears.geometry.ring_support import RingSupport as BuiltRingSupport

Deviation = Annotated[float, Quantity(units.LENGTH, at_least=-1e-3, at_most=1e-3)]
RollAngle = Annotated[float, Quantity(units.ANGLE, at_least=0.0, at_most=2.0 * math.pi)]
Waves = Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=100.0)]


class Relief(ObjectTable):
    """Tip or root relief: its depth where the flank ends [m], and where it begins.

    By the roll angle [rad] or by the length along the line of action from the flank's end [m].
    """

    amount: LengthFromZero
    """Depth where the flank ends."""
    start_roll_angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=2.0 * math.pi)] | None = None
    """Roll angle at which it begins. One of this and `length`."""
    length: PositiveLength | None = None
    """Length along the line of action from the flank's end. One of this and `start_roll_angle`."""
    shape: Literal["linear", "parabolic"] = "linear"
    """Course from its beginning to the flank's end."""

    def build(self) -> TipRelief:
        """Build the relief as a tip relief."""
        from gearwhine.coupling.gears import TipRelief

        return TipRelief(**self.model_dump())

    def build_root_relief(self) -> RootRelief:
        """Build the relief as a root relief."""
        from gearwhine.coupling.gears import RootRelief

        return RootRelief(**self.model_dump())


class ProfileErrors(ObjectTable):
    """Deviations along the profile [m], positive where there is too much material, as an inspection reports them."""

    slope: Deviation = 0.0
    """Slope deviation from the foot to the tip."""
    form: LengthFromZero = 0.0
    """Height of the waves."""
    waves: Waves = 3.0
    """Number of waves along the profile."""
    phase: Angle = 0.0
    """Phase of the waves."""
    crowning: Deviation = 0.0
    """Relief at both ends of the profile."""
    table: Annotated[tuple[tuple[RollAngle, Deviation], ...], Field(max_length=2000)] = ()
    """Rows of roll angle and deviation, the roll angles ascending."""

    def build(self) -> ProfileDeviation:
        """Build the profile deviation."""
        from gearwhine.coupling.gears import ProfileDeviation

        return ProfileDeviation(**self.model_dump())


class HelixErrors(ObjectTable):
    """Deviations and modifications across the face [m], positive where there is too much material."""

    slope: Deviation = 0.0
    """Slope deviation from the end of smaller z to the other."""
    crowning: Deviation = 0.0
    """Relief at both ends of the face."""
    end_relief: LengthFromZero = 0.0
    """Relief at both ends, over `end_relief_length`."""
    end_relief_length: LengthFromZero = 0.0
    """Length of the end relief; needed with it."""

    def build(self) -> HelixDeviation:
        """Build the helix deviation across the face."""
        from gearwhine.coupling.gears import HelixDeviation

        return HelixDeviation(**self.model_dump())


class GearErrors(Table):
    """Manufacturing errors, and modifications of the flanks across the face."""

    eccentricity: LengthFromZero = 0.0
    """Offset of the teeth from the shaft. One of this and `runout`."""
    runout: LengthFromZero = 0.0
    """Runout, twice the eccentricity."""
    phase: Angle = 0.0
    """Angle of the eccentricity from x at rest."""
    pitch: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    """One deviation for each tooth, from its ideal place along the pitch circle (cumulative). One of this and
    `spacing`."""
    spacing: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    """One deviation for each tooth, from its predecessor. One of this and `pitch`."""
    profile: ProfileErrors | None = None
    """Deviations along the profile of all flanks."""
    helix: HelixErrors | None = None
    """Deviations across the face of all flanks: errors, and helix modifications such as crowning and end relief."""
    planet: PlanetNumber | None = None
    """Number from 1 of the one planet that has these errors, of a gear that a `[[planetary]]` mounts `count` times.
    Default: all of them."""

    @model_validator(mode="after")
    def _said_once(self) -> GearErrors:
        if self.eccentricity > 0.0 and self.runout > 0.0:
            raise wrong("eccentricity or runout, which is twice as much", "runout")
        if self.pitch and self.spacing:
            raise wrong("'pitch', cumulative, or 'spacing' from tooth to tooth", "spacing")
        return self

    @property
    def offset(self) -> float:
        """Eccentricity, however it is given [m]."""
        return self.eccentricity or 0.5 * self.runout

    @property
    def cumulative_pitch(self) -> tuple[float, ...]:
        """Deviation of each tooth from its ideal place [m], of zero mean where it follows from `spacing`."""
        if not self.spacing:
            return self.pitch
        # The pitches of all teeth sum to the circumference: the mean spacing is subtracted.
        closing = sum(self.spacing) / len(self.spacing)
        places = [0.0]
        for step in self.spacing[1:]:
            places.append(places[-1] + step - closing)
        mean = sum(places) / len(places)
        return tuple(place - mean for place in places)


_KEYS_OF_FAULTS = {
    "wear": (("depth",), ("tooth", "shape")),
    "spall": (("tooth", "depth", "start_roll_angle", "end_roll_angle"), ("width", "flank")),
    "crack": (("tooth", "depth"), ("angle", "flank")),
    "missing-tooth": (("tooth",), ()),
}
"""Keys that a kind of fault needs, and further ones that it takes."""


class Fault(Table):
    """A damaged tooth, numbered from 0 as the teeth come into mesh, of a gear with several mates in its first pair."""

    kind: Literal["wear", "spall", "crack", "missing-tooth"]
    """Kind of damage. `wear` needs `depth`; `spall` needs `tooth`, `depth`, `start_roll_angle`, `end_roll_angle`;
    `crack` needs `tooth`, `depth`; `missing-tooth` needs `tooth`."""
    tooth: Annotated[int, Whole(0, 1999)] | None = None
    """Number of the tooth, from 0 as the teeth come into mesh. Default: wear of all teeth."""
    depth: LengthFromZero | None = None
    """Depth of wear, spall or crack."""
    shape: Literal["sliding", "uniform"] = "sliding"
    """Distribution of wear: in proportion to the sliding, or uniform."""
    start_roll_angle: RollAngle | None = None
    """Roll angle at which a spall begins."""
    end_roll_angle: RollAngle | None = None
    """Roll angle at which a spall ends."""
    width: PositiveLength | None = None
    """Width of a spall across the common face of its pair. Default: all of the face."""
    angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=math.pi / 2.0)] = math.radians(70.0)
    """Angle of a crack to the tooth's axis, like its depth in the normal section."""
    flank: Literal["working", "back"] = "working"
    """Flank with a spall, or from which a crack runs: the one that works in the first pair of the gear, or the one
    behind it, which of an idler works in the next. A planet behind the sun works with the ring on its `back`."""
    planet: PlanetNumber | None = None
    """Number from 1 of the one planet with the fault, of a gear that a `[[planetary]]` mounts `count` times. Default:
    all of them."""

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Fault:
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        for key in needed:
            if getattr(self, key) is None:
                raise wrong(f"'{key}' of a fault of kind {self.kind!r}", key)
        for key, field in type(self).model_fields.items():
            if key not in ("kind", "planet", *needed, *optional) and getattr(self, key) != field.default:
                raise wrong(f"no '{key}' of a fault of kind {self.kind!r}", key)
        start, end = self.start_roll_angle, self.end_roll_angle
        if start is not None and end is not None and end <= start:
            raise wrong("a roll angle beyond start_roll_angle", "end_roll_angle")
        return self

    def build(self) -> BuiltFault:
        """Build the gear fault of this kind."""
        from gearwhine.coupling.gears import MissingTooth, Spall, ToothCrack, Wear

        kinds = {"wear": Wear, "spall": Spall, "crack": ToothCrack, "missing-tooth": MissingTooth}
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        fault: BuiltFault = kinds[self.kind](**{key: getattr(self, key) for key in (*needed, *optional)})
        return fault


PressureAngle = Annotated[float, Quantity(units.ANGLE, at_least=math.radians(10.0), at_most=math.radians(35.0))]
HelixAngle = Annotated[float, Quantity(units.ANGLE, at_least=math.radians(-60.0), at_most=math.radians(60.0))]
Module = Annotated[float, Quantity(units.LENGTH, at_least=1e-5, at_most=0.2)]
DiametralPitch = Annotated[float, Quantity(units.DIAMETRAL_PITCH, at_least=5.0, at_most=1e5)]


class _Misalignment(Quantity):
    """An angle, or the word that leaves it to the machine's operating point."""

    def validate(self, value: object) -> Any:
        """Return the angle in SI, or "found"."""
        if value == "found":
            return value
        try:
            return super().validate(value)
        except PydanticCustomError:
            raise wrong(self.expected) from None

    def write(self, number: Any) -> str | float:
        """Return the angle as text with its unit, or "found"."""
        return "found" if number == "found" else super().write(number)

    @property
    def expected(self) -> str:
        """Expected value, in words."""
        return f'{super().expected}, or "found" for that of the machine under load'


Misalignment = Annotated[float | Literal["found"], _Misalignment(units.ANGLE, at_least=-0.1, at_most=0.1)]
FrictionCoefficient = Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=0.5)]
HarmonicWeight = Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=1e6)]
NOMINAL_WIDTH = 10.0
"""Face width of a gear that has none, in modules."""

ToothHeight = Annotated[float, Quantity(units.RATIO, above=0.0, at_most=3.0)]


class RingSupport(ObjectTable):
    """What holds the outside of an internal gear's rim."""

    kind: Literal["clamped", "housing", "springs", "bolts", "pins"] = "clamped"
    """`clamped`: the whole outside stands still; `housing`: the same, but the outside moves with the housing,
    by the `rim_seat` of its rotor;
    `springs`: an elastic bed all around; `bolts`: seats at equal angles that hold the ring, against rotation too;
    `pins`: seats without a moment. The mesh has the mean compliance over the places between two bolts."""
    count: Annotated[int, Whole(2, 360)] | None = None
    """Number of bolts or pins."""
    seat_width: PositiveLength | None = None
    """Length of each seat of a bolt or pin along the outside of the ring."""
    radial_stiffness: PositiveStiffness | None = None
    """Radial stiffness of each bolt or pin, or of all springs together. Default: rigid bolts and pins."""
    tangential_stiffness: PositiveStiffness | None = None
    """Tangential stiffness of each bolt or pin, or of all springs together. Default: rigid bolts and pins."""
    first: Angle = 0.0
    """Angle of the first bolt or pin from x."""

    def build(self) -> BuiltRingSupport:
        """Build the support."""
        from gearwhine.coupling.gears.geometry.ring_support import RingSupport as BuiltRingSupport

        return BuiltRingSupport(**self.model_dump())


class Gear(Table):
    """`[[gear]]`: an external or internal gear, spur or helical, by module, diametral pitch or base radius.

    Sizes are those of the normal section, `base_radius` is of the transverse plane. An internal gear (ring gear) has a
    negative number of teeth, as in ISO 21771, or `internal = true`; its sizes are given as positive lengths.
    """

    name: Name
    """Name of the gear."""
    rotor: RotorName | None = None
    """Name of its rotor; left out in a case without rotors."""
    at: LengthFromZero | None = None
    """Station on its rotor from the left end."""
    teeth: Annotated[int, Whole(5, 2000, negative="an internal gear")]
    """Number of teeth, negative of an internal gear."""
    internal: StrictBool | None = None
    """Whether the teeth point inward, as a ring gear's. Default: where `teeth` is negative."""
    module: Module | None = None
    """Normal module. Exactly one of `module`, `diametral_pitch` and `base_radius`."""
    diametral_pitch: DiametralPitch | None = None
    """Normal diametral pitch. Exactly one of `module`, `diametral_pitch` and `base_radius`."""
    base_radius: PositiveLength | None = None
    """Base radius in the transverse plane. Exactly one of `module`, `diametral_pitch` and `base_radius`."""
    face_width: PositiveLength | None = None
    """Face width; needed of helical gears, and unless the size is `base_radius`. Without it teeth touch in one point,
    and nothing resists a tilt of the flanks."""
    pressure_angle: PressureAngle = math.radians(20.0)
    """Pressure angle of the normal section."""
    helix_angle: HelixAngle = 0.0
    """Helix angle, positive for a right hand; gears in mesh have opposite hands, an internal gear and its pinion equal
    ones. A shaft moves along its axis where a
    bearing's 5x5 `matrix` or `rolling` holds it there; else it is held rigidly."""
    profile_shift: Annotated[float, Quantity(units.RATIO, at_least=-2.0, at_most=2.0)] = 0.0
    """Profile shift in modules, positive outward, of an internal gear inward: a positive one makes teeth thicker."""
    addendum: ToothHeight = 1.0
    """Addendum in modules."""
    dedendum: ToothHeight = 1.25
    """Dedendum in modules."""
    root_radius: LengthFromZero | None = None
    """Tip corner radius of the generating rack, which shapes the fillet; of an internal gear the radius of the fillet.
    Default: the radius that ends the rack's flank one addendum deep."""
    tooth_thinning: LengthFromZero = 0.0
    """Reduction of the tooth thickness along the reference circle beside that of the profile shift; the rack cuts
    deeper for it."""
    allow_undercut: StrictBool = False
    """Accept undercut teeth, with the remaining flank; else they are an error."""
    bore: LengthFromZero = 0.0
    """Diameter of the bore, at which the body of the teeth is held; 0 is a gear made from its shaft, whose mass is then
    what lies outside the shaft. A wheel on a shaft has a bore: its mesh is softer. See `stiffens_shaft` for how firmly
    it sits."""
    rim: PositiveLength | None = None
    """Thickness from the root circle to the inside of the rim. Default: a disc as wide as the face. Of an internal gear
    that to the outside of its ring, by default 3.5 modules."""
    web: PositiveLength | None = None
    """Width of the disc from the rim to the hub, in the middle of the face. The wheel vibrates and tilts on it, see
    `gear_bodies` of `check`. Default: the rim weighs alone, and is held at its inside."""
    hub_diameter: PositiveLength | None = None
    """Outer diameter of the hub around the bore, inside the `web`. Default: the web begins at the bore."""
    hub_width: PositiveLength | None = None
    """Width of the hub. Default: the face width."""
    ring_support: RingSupport | None = None
    """What holds the outside of an internal gear's rim. Default: it is clamped."""
    stiffens_shaft: StrictBool = True
    """Whether the shaft bends and twists under the gear as in one piece with it: cut into it, or pressed or keyed on
    firmly. `false`, and any gear with a `rim` or without `face_width`: the gear is a disc on one section of its shaft,
    as in many published models, or gripped loosely."""
    tip_relief: Relief | None = None
    """Tip relief."""
    root_relief: Relief | None = None
    """Root relief."""
    material: MaterialName | None = None
    """Name of the material. Default: that of its rotor, or of the shaft at its station where a file holds the rotor;
    without a rotor the only one of the case."""
    mass: Mass | None = None
    """Mass beside the shaft's own; with both inertias, or none of the three. Default: from the geometry."""
    polar_inertia: Inertia | None = None
    """Moment of inertia about the axis. Default: from the geometry."""
    diametral_inertia: Inertia | None = None
    """Moment of inertia across the axis. Default: from the geometry."""
    errors: GearErrors = GearErrors()
    """Manufacturing errors, and helix modifications (`errors.helix`)."""
    fault: Annotated[tuple[Fault, ...], Field(max_length=100)] = ()
    """Damaged teeth: one table, or a list."""

    @model_validator(mode="before")
    @classmethod
    def _signed(cls, values: object) -> object:
        teeth = values.get("teeth") if isinstance(values, dict) else None
        if isinstance(values, dict) and values.get("internal") is True and isinstance(teeth, int) and teeth > 0:
            return {**values, "teeth": -teeth}
        return values

    @field_validator("fault", mode="before")
    @classmethod
    def _one_or_more(cls, value: object) -> object:
        return [value] if isinstance(value, dict) else value

    @model_validator(mode="after")
    def _consistent(self) -> Gear:
        if sum(size is not None for size in (self.module, self.diametral_pitch, self.base_radius)) != 1:
            raise wrong("exactly one of 'module', 'diametral_pitch' and 'base_radius'")
        if self.base_radius is None and self.face_width is None:
            raise wrong("the face width of a gear that is given by the size of its teeth", "face_width")
        if self.helix_angle != 0.0 and self.face_width is None:
            raise wrong("the face width of a helical gear, over which its teeth come into mesh", "face_width")
        if self.internal is False and self.teeth < 0:
            raise wrong("true, or left out, with a negative number of teeth", "internal")
        if self.errors.planet is not None:
            raise wrong(one_of_planets("gear"), "errors", "planet")
        for number, fault in enumerate(self.fault):
            if fault.planet is not None:
                raise wrong(one_of_planets("gear"), "fault", number, "planet")
        is_given = [value is not None for value in (self.mass, self.polar_inertia, self.diametral_inertia)]
        if any(is_given) and not all(is_given):
            raise wrong("all of 'mass', 'polar_inertia' and 'diametral_inertia', or none of them")
        if self.base_radius is not None and self.face_width is None and not all(is_given):
            raise wrong("a face width, or all of 'mass', 'polar_inertia' and 'diametral_inertia'")
        if (self.rotor is None) != (self.at is None):
            raise wrong("'rotor' and 'at' together, or neither in a case without rotors")
        return self

    @property
    def tooth_module(self) -> float:
        """Normal module [m], also where the gear is given by its diametral pitch or its base radius."""
        if self.module is not None:
            return self.module
        from gearwhine.coupling.gears.geometry.involute import module_from_base_radius, module_from_diametral_pitch

        if self.diametral_pitch is not None:
            return module_from_diametral_pitch(self.diametral_pitch)
        assert self.base_radius is not None
        return module_from_base_radius(self.base_radius, abs(self.teeth), self.pressure_angle, self.helix_angle)

    def build(self, material: Material | None = None) -> BuiltGear:
        """Build the gear, of a material or by default of steel.

        A gear known by its base radius alone has the module of that radius, and a nominal width where none is given.

        Raises
        ------
        gearwhine.coupling.gears.GearError
            Where there is no such gear.
        """
        if material is None:
            return self._of_steel
        from gearwhine.numerics.own_copies import unchecked

        # The case's materials check themselves.
        return unchecked(
            self._of_steel,
            youngs_modulus=material.youngs_modulus,
            poisson_ratio=material.poisson_ratio,
            density=material.density,
        )

    @cached_property
    def _of_steel(self) -> BuiltGear:
        """The gear of steel: checks of a case and its machine need it one after the other."""
        from gearwhine.coupling.gears import Gear as BuiltGear

        module, errors = self.tooth_module, self.errors
        return BuiltGear(
            name=self.name,
            teeth=self.teeth,
            module=module,
            pressure_angle=self.pressure_angle,
            face_width=self.face_width if self.face_width is not None else NOMINAL_WIDTH * module,
            has_face=self.face_width is not None,
            profile_shift=self.profile_shift,
            addendum=self.addendum,
            dedendum=self.dedendum,
            root_radius=self.root_radius,
            bore=self.bore,
            tip_relief=None if self.tip_relief is None else self.tip_relief.build(),
            root_relief=None if self.root_relief is None else self.root_relief.build_root_relief(),
            eccentricity=errors.offset,
            eccentricity_phase=errors.phase,
            pitch_deviations=errors.cumulative_pitch,
            profile_deviation=None if errors.profile is None else errors.profile.build(),
            helix_deviation=None if errors.helix is None else errors.helix.build(),
            faults=tuple(fault.build() for fault in self.fault),
            helix_angle=self.helix_angle,
            rim_thickness=self.rim,
            web_thickness=self.web,
            hub_diameter=self.hub_diameter,
            hub_width=self.hub_width,
            ring_support=None if self.ring_support is None else self.ring_support.build(),
            tooth_thinning=self.tooth_thinning,
            allow_undercut=self.allow_undercut,
        )

    @property
    def given_inertia(self) -> tuple[float, float, float] | None:
        """Mass [kg], polar and diametral moment of inertia [kg m²] as given; None where they are by the geometry."""
        if self.mass is None or self.polar_inertia is None or self.diametral_inertia is None:
            return None
        return self.mass, self.polar_inertia, self.diametral_inertia


class ToothStiffness(Table):
    """Tooth stiffness of a pair: a model by name, and the value [N/m] or file that it needs."""

    model: Literal[
        "potential-energy", "elastic-ring", "cornell", "weber-banaschek", "iso6336", "constant", "square", "table"
    ] = "elastic-ring"
    """Model of the tooth stiffness; see [gear stiffness](gear-stiffness.md)."""
    value: PositiveStiffness | None = None
    """Stiffness of the whole mesh, of model "constant"; of one pair of teeth while it touches, of "square": in the mean
    the mesh has the value times the contact ratio."""
    file: CaseFile | None = None
    """File of a table, of model "table"."""

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> ToothStiffness:
        needs_value, needs_file = self.model in ("constant", "square"), self.model == "table"
        if needs_value != (self.value is not None):
            raise wrong(f"{'a' if needs_value else 'no'} stiffness value with model {self.model!r}", "value")
        if needs_file != (self.file is not None):
            raise wrong(f"{'a' if needs_file else 'no'} file with model {self.model!r}", "file")
        return self


class ReliefAim(Table):
    """Objective of the tip-relief search: weighted harmonics, the level at a sensor, or peak to peak."""

    harmonics: Annotated[dict[str, HarmonicWeight], Field(default_factory=dict, max_length=32)]
    """Weights w of the transmission error's amplitudes e by the multiple of the mesh frequency, √(Σ (w e)²), such as `{
    1 = 1, 2 = 0.5 }`; load shuttling is left out. With `sensor`: weights of the amplitudes of its acceleration."""
    sensor: SensorName | None = None
    """Sensor whose level is the objective, by the linear response to transmission error and load shuttling together, as
    in `gearwhine load --sensitivity`: root mean square over the first eight multiples of the mesh frequency below the
    housing's limit, or over those that `harmonics` weighs."""
    peak_to_peak: bool = False
    """Aim at the peak-to-peak transmission error."""

    @model_validator(mode="after")
    def _has_an_aim(self) -> ReliefAim:
        for key in self.harmonics:
            if not (key.isdecimal() and 1 <= int(key) <= 32):
                raise wrong(
                    "multiples of the mesh frequency from 1 to 32 as keys, such as { 1 = 1, 2 = 0.5 }", "harmonics"
                )
        if self.peak_to_peak:
            if self.sensor is not None or self.harmonics:
                raise wrong("false beside 'harmonics' or 'sensor'", "peak_to_peak")
            return self
        if self.sensor is None and not self.harmonics:
            raise wrong("'harmonics' with weights, 'sensor', or 'peak_to_peak = true'")
        if self.harmonics and not any(self.harmonics.values()):
            raise wrong("at least one weight above 0", "harmonics")
        return self

    @property
    def weights(self) -> dict[int, float]:
        """Weight by multiple of the mesh frequency."""
        return {int(key): weight for key, weight in sorted(self.harmonics.items(), key=lambda item: int(item[0]))}


class GearPair(Table):
    """`[[gear_pair]]`: two gears by name, and their contact."""

    driver: GearName
    """Name of the driving gear."""
    driven: GearName
    """Name of the driven gear."""
    stiffness: ToothStiffness = ToothStiffness()
    """Tooth stiffness model."""
    damping_ratio: DampingRatio = 0.05
    """Damping ratio of the mesh. The literature has 0.03 to 0.17 by measurements of spur gears (Kasuba and Evans 1981,
    Wang and Cheng 1981). Whether motions jump over speed depends on it."""
    damping: DampingFromZero | None = None
    """Damping coefficient along the line of action, in place of `damping_ratio`."""
    corner_contact: StrictBool | None = None
    """Teeth touch beyond their path of contact where the load closes the gap to a tip's corner. Default: true for
    models of teeth; false for "constant", "square" and "table"."""
    misalignment: Misalignment | None = None
    """Angle between the flanks in the plane of action, open towards +z; or "found": the gap over the face by shafts,
    bearings and housing at the static equilibrium. Default: "found" for loaded gears with a `face_width` on shafts in
    bearings, and 0 where no equilibrium is found, with a warning. `"0 rad"` for a machine of no known parts."""
    backlash: LengthFromZero | None = None
    """Backlash along the line of action. Default: that of tooth thicknesses and centre distance, where these leave more
    than 0.001 modules; else the back flanks never meet. One that differs from it by more than 10 % is a warning."""
    centre_distance: PositiveLength | None = None
    """Distance of the shafts, in a case without rotors; else checked against the rotors' axes. Default: without
    backlash."""
    friction: FrictionCoefficient = 0.0
    """Coefficient of friction between the teeth, in the transient; not with model "constant"."""
    relief_aim: ReliefAim | None = None
    """Objective of the best tip relief of `gearwhine gears`. Default: the level at the sensor that this pair makes
    loudest, where the machine turns in a housing with sensors whose modes are in the results folder, else the
    peak-to-peak transmission error."""

    @model_validator(mode="after")
    def _slides(self) -> GearPair:
        if self.friction > 0.0 and self.stiffness.model == "constant":
            raise wrong("0 with the stiffness model 'constant', one spring that knows no pairs of teeth", "friction")
        return self

    @model_validator(mode="after")
    def _two_gears(self) -> GearPair:
        if self.driver == self.driven:
            raise wrong("another gear than the driver itself", "driven")
        return self


def shaft_of(gear: Gear) -> str:
    """Return the name of a gear's shaft: its rotor, or the gear itself in a case without rotors."""
    return gear.rotor if gear.rotor is not None else gear.name


def distance_of_axes(first: tuple[float, float], second: tuple[float, float]) -> float:
    """Return the distance of two axes along z [m]."""
    return math.hypot(second[0] - first[0], second[1] - first[1])


def readable_pairs(gears: Iterable[Gear], pairs: Iterable[tuple[int, GearPair]]) -> list[tuple[int, Gear, Gear]]:
    """Return driver and driven gear of each pair with its place in the list.

    Pairs whose gears are missing or on one shaft are passed over.
    """
    by_name = {gear.name: gear for gear in gears}
    return [
        (place, by_name[pair.driver], by_name[pair.driven])
        for place, pair in pairs
        if pair.driver in by_name
        and pair.driven in by_name
        and shaft_of(by_name[pair.driver]) != shaft_of(by_name[pair.driven])
    ]


@dataclass(frozen=True)
class TrainMembers:
    """Members of a gear train beside its pairs: carriers of planets, held shafts, speeds and place of the drives.

    Attributes
    ----------
    carriers : mapping of str to str
        Carrier of each planet's shaft.
    held : tuple of str
    given : mapping of str to float
        Speeds of further driven shafts over that of the first driver.
    first : str or None
        Shaft at which the torque comes in; None: that of the first pair's driver.
    """

    carriers: Mapping[str, str] = dataclasses.field(default_factory=dict)
    held: tuple[str, ...] = ()
    given: Mapping[str, float] = dataclasses.field(default_factory=dict)
    first: str | None = None


NO_MEMBERS = TrainMembers()


def train_of_pairs(
    pairs: Iterable[tuple[int, Gear, Gear]], shafts: Iterable[str] = (), members: TrainMembers = NO_MEMBERS
) -> GearTrain:
    """Return the gear train of pairs, see :func:`readable_pairs`; without pairs that of single shafts."""
    # The package brings numpy and scipy: only a case that turns waits for them.
    from gearwhine.coupling.description.gear_train import GearedShafts, drive_ratio, gear_train

    carriers = members.carriers
    geared = [
        GearedShafts(
            shaft_of(driver),
            shaft_of(driven),
            (driver.teeth, driven.teeth),
            carriers.get(shaft_of(driver)) or carriers.get(shaft_of(driven)),
        )
        for _, driver, driven in pairs
    ]
    given = {name: drive_ratio(ratio) for name, ratio in members.given.items()}
    return gear_train(geared, shafts, held=members.held, planets=list(carriers), given=given, first=members.first)
