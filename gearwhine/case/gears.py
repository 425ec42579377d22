"""Gears and gear pairs of a case, `[[gear]]` and `[[gear_pair]]`, and the gear train that the pairs form.

Flank modifications, manufacturing errors and faults of a gear each build their object of `coupling.gears`. The train
lists pairs of shafts with their tooth numbers. Attributes are named as the keys and are in SI.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, StrictBool, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearwhine.case import units
from gearwhine.case.fields import (
    Angle,
    CaseFile,
    DampingFromZero,
    DampingRatio,
    Inertia,
    LengthFromZero,
    Mass,
    Name,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    Table,
    Whole,
    wrong,
)

if TYPE_CHECKING:
    from coupling.gears import Gear as BuiltGear
    from coupling.gears import HelixDeviation, ProfileDeviation, RootRelief, TipRelief
    from coupling.gears.geometry.gear import Fault as BuiltFault
    from coupling.machine.gear_train import GearTrain
    from gearwhine.case.housing import Material

Deviation = Annotated[float, Quantity(units.LENGTH, at_least=-1e-3, at_most=1e-3)]
RollAngle = Annotated[float, Quantity(units.ANGLE, at_least=0.0, at_most=2.0 * math.pi)]
Waves = Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=100.0)]


class Relief(Table):
    """Tip or root relief: its depth where the flank ends [m], and where it begins.

    By the roll angle [rad] or by the length along the line of action from the flank's end [m].
    """

    amount: LengthFromZero
    start_roll_angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=2.0 * math.pi)] | None = None
    length: PositiveLength | None = None
    shape: Literal["linear", "parabolic"] = "linear"

    @model_validator(mode="after")
    def _one_start(self) -> Relief:
        if (self.start_roll_angle is None) == (self.length is None):
            raise wrong("exactly one of 'start_roll_angle' and 'length'")
        return self

    def build_tip_relief(self) -> TipRelief:
        """Build the relief as a tip relief."""
        from coupling.gears import TipRelief

        return TipRelief(**self.model_dump())

    def build_root_relief(self) -> RootRelief:
        """Build the relief as a root relief."""
        from coupling.gears import RootRelief

        return RootRelief(**self.model_dump())


class ProfileErrors(Table):
    """Deviations along the profile [m], positive where there is too much material, as an inspection reports them.

    `slope` from the foot to the tip, `form` the height of `waves` waves, `crowning` what is taken off at both ends;
    `table`: rows of roll angle and deviation.
    """

    slope: Deviation = 0.0
    form: LengthFromZero = 0.0
    waves: Waves = 3.0
    phase: Angle = 0.0
    crowning: Deviation = 0.0
    table: Annotated[tuple[tuple[RollAngle, Deviation], ...], Field(max_length=2000)] = ()

    @field_validator("table", mode="after")
    @classmethod
    def _ascending(cls, rows: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if len(rows) == 1 or any(after[0] <= before[0] for before, after in itertools.pairwise(rows)):
            raise wrong("two rows or more of a roll angle and a deviation, the roll angles increasing")
        return rows

    def build(self) -> ProfileDeviation:
        """Build the profile deviation."""
        from coupling.gears import ProfileDeviation

        return ProfileDeviation(**self.model_dump())


class HelixErrors(Table):
    """Deviations across the face [m], positive where there is too much material.

    `slope` from the end of smaller z to the other, `crowning` what is taken off at both ends, `end_relief` the same
    over an `end_relief_length`.
    """

    slope: Deviation = 0.0
    crowning: Deviation = 0.0
    end_relief: LengthFromZero = 0.0
    end_relief_length: LengthFromZero = 0.0

    @model_validator(mode="after")
    def _relief_has_length(self) -> HelixErrors:
        if self.end_relief > 0.0 and self.end_relief_length == 0.0:
            raise wrong("the length of the end relief", "end_relief_length")
        return self

    def build(self) -> HelixDeviation:
        """Build the helix deviation across the face."""
        from coupling.gears import HelixDeviation

        return HelixDeviation(**self.model_dump())


class GearErrors(Table):
    """Manufacturing errors.

    Eccentricity of the teeth [m], or the runout that it shows, twice as much, and its angle from x at rest [rad];
    `pitch`: how far each tooth's working flank stands ahead of its ideal place along the pitch circle [m], tooth by
    tooth as they come into mesh (cumulative), or `spacing`: from its predecessor to each tooth; `profile` and `helix`
    of all flanks.
    """

    eccentricity: LengthFromZero = 0.0
    runout: LengthFromZero = 0.0
    phase: Angle = 0.0
    pitch: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    spacing: Annotated[tuple[Deviation, ...], Field(max_length=2000)] = ()
    profile: ProfileErrors | None = None
    helix: HelixErrors | None = None

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
    "spall": (("tooth", "depth", "start_roll_angle", "end_roll_angle"), ("width",)),
    "crack": (("tooth", "depth"), ("angle",)),
    "missing-tooth": (("tooth",), ()),
}
"""Keys that a kind of fault needs, and further ones that it takes."""


class Fault(Table):
    """A damaged tooth, numbered from 0 as the teeth come into mesh.

    `wear` by `depth`, of one tooth or of all, in proportion to the sliding or uniform; `spall` by `depth` between two
    roll angles, across the face or a `width` of it; `crack` of a `depth` at an `angle` to the tooth's axis;
    `missing-tooth`.
    """

    kind: Literal["wear", "spall", "crack", "missing-tooth"]
    tooth: Annotated[int, Whole(0, 1999)] | None = None
    depth: LengthFromZero | None = None
    shape: Literal["sliding", "uniform"] = "sliding"
    start_roll_angle: RollAngle | None = None
    end_roll_angle: RollAngle | None = None
    width: PositiveLength | None = None
    angle: Annotated[float, Quantity(units.ANGLE, above=0.0, at_most=math.pi / 2.0)] = math.radians(70.0)

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> Fault:
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        for key in needed:
            if getattr(self, key) is None:
                raise wrong(f"'{key}' of a fault of kind {self.kind!r}", key)
        for key, field in type(self).model_fields.items():
            if key not in ("kind", *needed, *optional) and getattr(self, key) != field.default:
                raise wrong(f"no '{key}' of a fault of kind {self.kind!r}", key)
        if self.kind == "spall":
            assert self.start_roll_angle is not None
            assert self.end_roll_angle is not None
            if self.end_roll_angle <= self.start_roll_angle:
                raise wrong("a roll angle beyond start_roll_angle", "end_roll_angle")
        return self

    def build(self) -> BuiltFault:
        """Build the gear fault of this kind."""
        from coupling.gears import MissingTooth, Spall, ToothCrack, Wear

        kinds = {"wear": Wear, "spall": Spall, "crack": ToothCrack, "missing-tooth": MissingTooth}
        needed, optional = _KEYS_OF_FAULTS[self.kind]
        made: BuiltFault = kinds[self.kind](**{key: getattr(self, key) for key in (*needed, *optional)})
        return made


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


class Gear(Table):
    """`[[gear]]`: an external spur or helical gear, by module, diametral pitch or base radius.

    On a rotor at a station [m from its left end]; without rotor in a case that has no rotors. Module, diametral pitch,
    pressure angle, profile shift, addendum, dedendum and the rack's corner `root_radius` are of the normal section,
    `base_radius` is of the transverse plane; a positive `helix_angle` is a right-hand helix. `rim` [m] reaches from the
    root circle inward, `web` [m] is the width of the disc within it. Its inertia comes from its geometry unless `mass`,
    `polar_inertia` and `diametral_inertia` are all given.
    """

    name: Name
    rotor: Name | None = None
    at: LengthFromZero | None = None
    teeth: Annotated[int, Whole(5, 2000)]
    module: Module | None = None
    diametral_pitch: DiametralPitch | None = None
    base_radius: PositiveLength | None = None
    face_width: PositiveLength | None = None
    pressure_angle: PressureAngle = math.radians(20.0)
    helix_angle: HelixAngle = 0.0
    profile_shift: Annotated[float, Quantity(units.RATIO, at_least=-2.0, at_most=2.0)] = 0.0
    addendum: ToothHeight = 1.0
    dedendum: ToothHeight = 1.25
    root_radius: LengthFromZero | None = None
    tooth_thinning: LengthFromZero = 0.0
    allow_undercut: StrictBool = False
    bore: LengthFromZero = 0.0
    rim: PositiveLength | None = None
    web: PositiveLength | None = None
    tip_relief: Relief | None = None
    root_relief: Relief | None = None
    material: Name | None = None
    mass: Mass | None = None
    polar_inertia: Inertia | None = None
    diametral_inertia: Inertia | None = None
    errors: GearErrors = GearErrors()
    fault: Annotated[tuple[Fault, ...], Field(max_length=100)] = ()

    @field_validator("fault", mode="before")
    @classmethod
    def _one_or_more(cls, given: object) -> object:
        return [given] if isinstance(given, dict) else given

    @model_validator(mode="after")
    def _consistent(self) -> Gear:
        if sum(size is not None for size in (self.module, self.diametral_pitch, self.base_radius)) != 1:
            raise wrong("exactly one of 'module', 'diametral_pitch' and 'base_radius'")
        if self.base_radius is None and self.face_width is None:
            raise wrong("the face width of a gear that is given by the size of its teeth", "face_width")
        if self.bore >= 2.0 * self.base_circle_radius:
            raise wrong(f"a bore smaller than the base circle, {2.0 * self.base_circle_radius:g} m", "bore")
        if self.web is not None and self.rim is None:
            raise wrong("no web, or a rim around it", "web")
        for key, deviations in (("pitch", self.errors.pitch), ("spacing", self.errors.spacing)):
            if deviations and len(deviations) != self.teeth:
                raise wrong(f"one deviation for each of {self.teeth} teeth, or none", "errors", key)
        for number, fault in enumerate(self.fault):
            if fault.tooth is not None and fault.tooth >= self.teeth:
                raise wrong(f"a tooth from 0 to {self.teeth - 1}", "fault", number, "tooth")
        given = [value is not None for value in (self.mass, self.polar_inertia, self.diametral_inertia)]
        if any(given) and not all(given):
            raise wrong("all of 'mass', 'polar_inertia' and 'diametral_inertia', or none of them")
        if self.base_radius is not None and self.face_width is None and not all(given):
            raise wrong("a face width, or all of 'mass', 'polar_inertia' and 'diametral_inertia'")
        if (self.rotor is None) != (self.at is None):
            raise wrong("'rotor' and 'at' together, or neither in a case without rotors")
        return self

    @property
    def tooth_module(self) -> float:
        """Normal module [m], also where the gear is given by its diametral pitch or its base radius."""
        if self.module is not None:
            return self.module
        from coupling.gears.geometry.involute import module_from_base_radius, module_from_diametral_pitch

        if self.diametral_pitch is not None:
            return module_from_diametral_pitch(self.diametral_pitch)
        assert self.base_radius is not None
        return module_from_base_radius(self.base_radius, self.teeth, self.pressure_angle, self.helix_angle)

    @property
    def base_circle_radius(self) -> float:
        """Radius of the base circle [m]."""
        if self.base_radius is not None:
            return self.base_radius
        from coupling.gears.geometry.involute import module_from_base_radius

        # The module is proportional to the base radius.
        return self.tooth_module / module_from_base_radius(1.0, self.teeth, self.pressure_angle, self.helix_angle)

    def build(self, material: Material | None = None) -> BuiltGear:
        """Build the gear, of a material or by default of steel.

        A gear known by its base radius alone has the module that gives it, and a nominal width where none is given.

        Raises
        ------
        coupling.gears.GearError
            Where there is no such gear.
        """
        from coupling.gears import Gear as BuiltGear

        module, errors = self.tooth_module, self.errors
        gear = BuiltGear(
            name=self.name,
            teeth=self.teeth,
            module=module,
            pressure_angle=self.pressure_angle,
            face_width=self.face_width if self.face_width is not None else NOMINAL_WIDTH * module,
            profile_shift=self.profile_shift,
            addendum=self.addendum,
            dedendum=self.dedendum,
            root_radius=self.root_radius,
            bore=self.bore,
            tip_relief=None if self.tip_relief is None else self.tip_relief.build_tip_relief(),
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
            tooth_thinning=self.tooth_thinning,
            allow_undercut=self.allow_undercut,
        )
        if material is None:
            return gear
        return replace(
            gear,
            youngs_modulus=material.youngs_modulus,
            poisson_ratio=material.poisson_ratio,
            density=material.density,
        )

    def inertia(self, material: Material | None = None) -> tuple[float, float, float]:
        """Mass [kg], polar and diametral moment of inertia [kg m²]: as given, else by the geometry."""
        if self.mass is not None and self.polar_inertia is not None and self.diametral_inertia is not None:
            return self.mass, self.polar_inertia, self.diametral_inertia
        built = self.build(material)
        return built.mass, built.polar_inertia, built.diametral_inertia


class ToothStiffness(Table):
    """Tooth stiffness of a pair: a model by name, and the value [N/m] or file that it needs."""

    model: Literal[
        "potential-energy", "elastic-ring", "cornell", "weber-banaschek", "iso6336", "constant", "square", "table"
    ] = "elastic-ring"
    value: PositiveStiffness | None = None
    file: CaseFile | None = None

    @model_validator(mode="after")
    def _has_what_it_needs(self) -> ToothStiffness:
        needs_value, needs_file = self.model in ("constant", "square"), self.model == "table"
        if needs_value != (self.value is not None):
            raise wrong(f"{'a' if needs_value else 'no'} stiffness value with model {self.model!r}", "value")
        if needs_file != (self.file is not None):
            raise wrong(f"{'a' if needs_file else 'no'} file with model {self.model!r}", "file")
        return self


class ReliefAim(Table):
    """Objective of the tip-relief search, in place of the peak-to-peak transmission error.

    `harmonics`: weights of the transmission error's amplitudes by the multiple of the mesh frequency. With `sensor` the
    level there, by the transmissibility, of those multiples, or of all below the model's limit.
    """

    harmonics: Annotated[dict[str, HarmonicWeight], Field(default_factory=dict, max_length=32)]
    sensor: Name | None = None

    @model_validator(mode="after")
    def _has_an_aim(self) -> ReliefAim:
        for key in self.harmonics:
            if not (key.isdecimal() and 1 <= int(key) <= 32):
                raise wrong(
                    "multiples of the mesh frequency from 1 to 32 as keys, such as { 1 = 1, 2 = 0.5 }", "harmonics"
                )
        if self.sensor is None and not self.harmonics:
            raise wrong("'harmonics' with weights, or 'sensor'")
        if self.harmonics and not any(self.harmonics.values()):
            raise wrong("at least one weight above 0", "harmonics")
        return self

    @property
    def weights(self) -> dict[int, float]:
        """Weight by multiple of the mesh frequency."""
        return {int(key): weight for key, weight in sorted(self.harmonics.items(), key=lambda one: int(one[0]))}


class GearPair(Table):
    """`[[gear_pair]]`: two gears by name, and their contact.

    `damping` [N s/m] stands in place of `damping_ratio`. `corner_contact`: whether teeth touch beyond their path of
    contact, where a load closes the gap to a corner; None: where the stiffness model is one of pairs of teeth.
    `misalignment` [rad] is the angle between the flanks in the plane of action, open towards +z; "found": that of the
    machine's operating point, by its shafts, bearings and housing; None: see :meth:`Case.finds_misalignment`.
    `backlash` [m] is measured along the line of action; None: that of thicknesses and distance, and where these leave
    none the back flanks never touch. `centre_distance`
    [m] is checked against the rotors' axes, and needed only in a case without rotors where it is not nominal.
    `friction` is the coefficient of friction between the teeth, in the transient. `relief_aim` is what `gears` seeks
    the best tip relief for; None: the peak-to-peak transmission error.
    """

    driver: Name
    driven: Name
    stiffness: ToothStiffness = ToothStiffness()
    damping_ratio: DampingRatio = 0.05
    damping: DampingFromZero | None = None
    corner_contact: StrictBool | None = None
    misalignment: Misalignment | None = None
    backlash: LengthFromZero | None = None
    centre_distance: PositiveLength | None = None
    friction: FrictionCoefficient = 0.0
    relief_aim: ReliefAim | None = None

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
    """Return the name of what a gear turns with: its rotor; the gear itself in a case without rotors."""
    return gear.rotor if gear.rotor is not None else gear.name


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


def train_of_pairs(pairs: Iterable[tuple[int, Gear, Gear]], shafts: Iterable[str] = ()) -> GearTrain:
    """Return the gear train of pairs, see :func:`readable_pairs`; without pairs that of single shafts."""
    # The package brings numpy and scipy: only a case that turns waits for them.
    from coupling.machine.gear_train import GearedShafts, gear_train

    geared = [
        GearedShafts(shaft_of(driver), shaft_of(driven), (driver.teeth, driven.teeth)) for _, driver, driven in pairs
    ]
    return gear_train(geared, shafts)
