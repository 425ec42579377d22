"""Gears and gear pairs of a case: `[[gear]]` and `[[gear_pair]]`. Attributes are named as the keys and are in SI."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, StrictBool, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
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
from gearwhine.case.flanks import Fault, GearErrors, Relief

if TYPE_CHECKING:
    import coupling.gears
    from gearwhine.case.housing import Material

PressureAngle = Annotated[float, Quantity(units.ANGLE, at_least=math.radians(10.0), at_most=math.radians(35.0))]
HelixAngle = Annotated[float, Quantity(units.ANGLE, at_least=math.radians(-60.0), at_most=math.radians(60.0))]
Module = Annotated[float, Quantity(units.LENGTH, at_least=1e-5, at_most=0.2)]
DiametralPitch = Annotated[float, Quantity(units.DIAMETRAL_PITCH, at_least=5.0, at_most=1e5)]
Misalignment = Annotated[float, Quantity(units.ANGLE, at_least=-0.1, at_most=0.1)]
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
        from coupling.gears import module_from_base_radius, module_from_diametral_pitch

        if self.diametral_pitch is not None:
            return module_from_diametral_pitch(self.diametral_pitch)
        assert self.base_radius is not None
        return module_from_base_radius(self.base_radius, self.teeth, self.pressure_angle, self.helix_angle)

    @property
    def base_circle_radius(self) -> float:
        """Radius of the base circle [m]."""
        if self.base_radius is not None:
            return self.base_radius
        from coupling.gears import module_from_base_radius

        # The module is proportional to the base radius.
        return self.tooth_module / module_from_base_radius(1.0, self.teeth, self.pressure_angle, self.helix_angle)

    def build(self, material: Material | None = None) -> coupling.gears.Gear:
        """The gear, of a material or by default of steel.

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
    `misalignment` [rad] is the angle between the flanks in the plane of action, open towards +z.
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
    misalignment: Misalignment = 0.0
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
