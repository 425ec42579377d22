"""Bearings of a case, `[[bearing]]`: stiffness, damping, pedestals, stops and mean loads; rolling bearings.

A rolling bearing is given by its geometry, or by the main dimensions of a catalogue, from which its inside is
estimated. Attributes are named as the keys and are in SI.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Angle,
    CarrierOfBearing,
    Coefficient,
    Damping,
    DampingFromZero,
    Force,
    Length,
    LengthFromZero,
    Mass,
    Name,
    OverSpeed,
    PlanetNumber,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    RotorName,
    SpeedFromZero,
    Stiffness,
    Table,
    Whole,
    one_of_planets,
    wrong,
)
from gearwhine.case.units import Dimension

if TYPE_CHECKING:
    from collections.abc import Container, Iterable

    import numpy as np
    import numpy.typing as npt

    from gearwhine.coupling import GapLaw
    from gearwhine.rotors import Pedestal as BuiltPedestal
    from gearwhine.rotors.rolling_bearings import BearingDamage, RollingBearing, Row
    from gearwhine.rotors.rolling_bearings import CageSlip as BuiltCageSlip

Arrangement = Literal["single", "back to back", "face to face", "tandem"]
# The types of `gearwhine.rotors.rolling_bearings.catalogue`, as a test verifies: a case is read without numpy, which
# that room imports.
CatalogueType = Literal[
    "deep-groove",
    "angular-contact",
    "double-row-angular-contact",
    "four-point",
    "self-aligning-ball",
    "cylindrical-roller",
    "tapered-roller",
    "spherical-roller",
]

_ContactAngle = Annotated[float, Quantity(units.ANGLE, at_least=0.0, below=1.57)]
_Groove = Annotated[float, Quantity(units.RATIO, above=0.5, at_most=1.0)]


class BearingLoad(Table):
    """Mean load of a bearing: the force of the shaft on it [N]."""

    x: Force = 0.0
    """Force along x."""
    y: Force = 0.0
    """Force along y."""
    z: Force = 0.0
    """Force along z."""


class Stop(Table):
    """A ring around the shaft: beyond its radial `gap` [m] it takes `force` [N] at a `depth` [m], by an `exponent`."""

    force: Annotated[float, Quantity(units.FORCE, above=0.0)]
    """Force at the penetration `depth`."""
    depth: PositiveLength
    """Penetration at which the force is `force`."""
    exponent: Annotated[float, Quantity(units.RATIO, at_least=1.0, at_most=10.0)] = 1.0
    """Exponent n of force · (penetration / depth)ⁿ."""
    gap: LengthFromZero = 0.0
    """Radial gap between shaft and ring."""

    def build(self) -> GapLaw:
        """Build the force law of the stop."""
        from gearwhine.coupling import GapLaw

        return GapLaw(self.force, self.depth, self.exponent, self.gap)


class Mounting(Table):
    """Fits and temperatures of a bearing, by which `clearance`, then that before mounting, changes [m, K].

    The shaft is of steel.
    """

    inner_interference: Length = 0.0
    """Diametral interference of the inner ring on the shaft, cold."""
    outer_interference: Length = 0.0
    """Diametral interference of the outer ring in the housing, cold."""
    smoothing: LengthFromZero = 0.0
    """Loss of either interference by smoothing of the surfaces."""
    shaft_bore: LengthFromZero = 0.0
    """Bore of a hollow shaft of steel."""
    housing_diameter: PositiveLength | None = None
    """Outer diameter of the housing around the ring. Default: thick."""
    housing_modulus: Annotated[float, Quantity(units.STRESS, above=0.0)] = 210e9
    """Young's modulus of the housing."""
    housing_poisson_ratio: Annotated[float, Quantity(units.RATIO, above=-1.0, at_most=0.5)] = 0.3
    """Poisson's ratio of the housing."""
    housing_expansion: Annotated[float, Quantity(units.EXPANSION, at_least=0.0)] = 11.7e-6
    """Coefficient of thermal expansion of the housing."""
    inner_rise: Annotated[float, Quantity(units.TEMPERATURE)] = 0.0
    """Temperature of the inner ring over that of the sizes."""
    outer_rise: Annotated[float, Quantity(units.TEMPERATURE)] = 0.0
    """Temperature of the outer ring over that of the sizes."""
    shaft_rise: Annotated[float, Quantity(units.TEMPERATURE)] | None = None
    """Temperature of the shaft over that of the sizes. Default: `inner_rise`."""
    housing_rise: Annotated[float, Quantity(units.TEMPERATURE)] | None = None
    """Temperature of the housing over that of the sizes. Default: `outer_rise`."""
    bore: PositiveLength | None = None
    """Bore of the bearing; needed without a catalogue."""
    outer_diameter: PositiveLength | None = None
    """Outer diameter of the bearing; needed without a catalogue."""

    def operating_clearance(self, row: Row, clearance: float, bore: float, outer_diameter: float) -> float:
        """Diametral clearance in operation of a row in a bearing of these diameters [m]."""
        from gearwhine.rotors.rolling_bearings import RingFit, operating_clearance

        inner_rise, outer_rise = self.inner_rise, self.outer_rise
        height = row.element_diameter * math.cos(row.contact_angle)
        shaft = RingFit(
            self.inner_interference,
            self.shaft_bore,
            self.smoothing,
            temperature_rise=inner_rise if self.shaft_rise is None else self.shaft_rise,
        )
        housing = RingFit(
            self.outer_interference,
            self.housing_diameter or 0.0,
            self.smoothing,
            self.housing_modulus,
            self.housing_poisson_ratio,
            self.housing_expansion,
            outer_rise if self.housing_rise is None else self.housing_rise,
        )
        return operating_clearance(
            clearance,
            bore,
            row.pitch_diameter - height,
            row.pitch_diameter + height,
            outer_diameter,
            shaft=shaft,
            housing=housing,
            inner_rise=inner_rise,
            outer_rise=outer_rise,
        ).clearance


class _Mounted(Table):
    """Mounting of a bearing: clearance, preload and arrangement of rows [m, N]."""

    law: Literal["linear", "nonlinear"] = "linear"
    """Law in the transient: the tangent about the load, or the Hertzian force of every element with its clearance while
    the cage rotates, which excites the ball-pass frequency. "nonlinear" is not for four-point balls and flanges."""
    clearance: Length = 0.0
    """Diametral clearance in operation, or before mounting where `mounting` is given; negative is an interference."""
    mounting: Mounting | None = None
    """Fits and temperatures, which change the clearance."""
    preload: Annotated[float, Quantity(units.FORCE, at_least=0.0)] = 0.0
    """Axial preload: of one row and of rows in tandem a spring's force on the shaft along `carries`, of two opposed
    rows, also within one bearing, the force between them. Springs of two opposed bearings cancel on the shaft: their
    preload is `axial_offset`."""
    axial_offset: Length = 0.0
    """Displacement of the inner ring along `carries` at assembly: rigid preload against another bearing of the shaft,
    whose force `gearwhine load` finds."""
    floating: bool = False
    """Whether the outer ring slides in its seat along the axis, without friction: a floating bearing, which takes no
    axial force; another bearing of the shaft locates it. Not for rows that carry thrust one way only or are pressed
    axially."""
    carries: Literal["+z", "-z"] = "+z"
    """Direction of the axial force of the shaft that loads the elements; of elements that carry it both ways, of
    `axial_offset` and a spring."""
    turning_ring: Literal["inner", "outer"] | None = None
    """Ring that turns with the rotor; the other stands in the seat. Default: "outer" of a planet with a bore, which
    turns around a pin, else "inner"."""
    arrangement: Arrangement = "single"
    """One such row, or two."""
    spacing: PositiveLength | None = None
    """Distance of the centres of two rows; needed for two."""
    dynamic_rating: Annotated[float, Quantity(units.FORCE, above=0.0)] | None = None
    """Basic dynamic load rating C of the whole bearing, of both with `arrangement`, for the lives of `rotors` and
    `load`. Default: that of the geometry by ISO 281."""
    flanges: Literal["none", "one", "both"] = "none"
    """Flanges of cylindrical rollers, which carry no axial load without: one, along `carries`, or both."""
    flange_stiffness: PositiveStiffness | None = None
    """Stiffness of each roller between its flanges; needed with `flanges`."""
    axial_clearance: LengthFromZero = 0.0
    """Axial clearance between the flanges."""

    @property
    def pressed(self) -> bool:
        """Whether its elements are pressed without any load of the shaft and without another bearing."""
        return self.preload > 0.0 or self.clearance < 0.0

    @model_validator(mode="after")
    def _arranged(self) -> _Mounted:
        if self.arrangement != "single" and self.spacing is None:
            raise wrong("the distance between the two rows", "spacing")
        if self.arrangement == "single" and self.spacing is not None:
            raise wrong("nothing: a single row has no spacing", "spacing")
        cylinders = self.kind == "cylindrical-roller"
        if cylinders and self.flanges == "none":
            for key in ("preload", "axial_offset"):
                if getattr(self, key) != 0.0:
                    raise wrong("nothing: cylindrical rollers carry no axial load without flanges", key)
        if self.arrangement != "single" and cylinders:
            raise wrong("'single': two rows of rollers are one of twice the length", "arrangement")
        if self.arrangement != "single" and self.kind in _BOTH_WAYS:
            raise wrong(f"'single': a {self.kind} bearing carries axial load both ways by itself", "arrangement")
        if self.axial_offset != 0.0 and self.arrangement != "single":
            raise wrong("nothing: two rows have the preload between them", "axial_offset")
        if self.floating:
            self._require_floats()
        if self.flanges != "none" and not cylinders:
            raise wrong("nothing: only cylindrical rollers run between flanges", "flanges")
        if (self.flanges == "none") != (self.flange_stiffness is None):
            expected = "nothing without flanges" if self.flanges == "none" else "of each roller between its flanges"
            raise wrong(expected, "flange_stiffness")
        if self.law == "nonlinear" and (self.flanges != "none" or self.kind == "four-point"):
            kind = "four-point balls" if self.kind == "four-point" else "rollers between flanges"
            raise wrong(f"'linear': {kind} have no law in the transient", "law")
        return self

    def _require_floats(self) -> None:
        """Refuse a sliding outer ring of rows that it lets slide open, or that are pressed axially at assembly."""
        for key in ("preload", "axial_offset"):
            if getattr(self, key) != 0.0:
                raise wrong("nothing: the outer ring of a floating bearing slides and holds no axial force", key)
        if self.arrangement != "single":
            raise wrong("false: only a single bearing floats, not rows set against each other", "floating")
        if self.kind in ("angular-contact", "tapered-roller") or self.flanges == "one":
            kind = "rollers with a flange on one side" if self.flanges == "one" else f"{self.kind} bearings"
            raise wrong(f"false: {kind} would slide open, as they carry thrust one way only", "floating")

    @property
    def kind(self) -> CatalogueType:
        """Type of the bearing by its elements."""
        raise NotImplementedError

    @property
    def width(self) -> float:
        """Width of the bearing, where the places of its rows follow from it, else 0 [m]."""
        return 0.0

    def build_row(self) -> Row:
        """One row of rolling elements."""
        raise NotImplementedError

    def build(self, name: str, *, on_pin: bool = False) -> RollingBearing:
        """Build the rolling bearing, of one or two rows.

        Parameters
        ----------
        name : str
        on_pin : bool
            Whether its outer ring turns where ``turning_ring`` does not say.

        Raises
        ------
        gearwhine.rotors.RotorError
            Where there is no such bearing.
        """
        from gearwhine.rotors.rolling_bearings import RollerRow, bearing_of_row

        row = self.build_row()
        outer_turns = on_pin if self.turning_ring is None else self.turning_ring == "outer"
        changes: dict[str, Any] = {}
        if self.mounting is not None:
            bore, outer_diameter = self._rings(self.mounting)
            changes["clearance"] = self.mounting.operating_clearance(row, self.clearance, bore, outer_diameter)
        if isinstance(row, RollerRow) and self.flange_stiffness is not None:
            changes["flanges"], changes["flange_stiffness"] = self.flanges, self.flange_stiffness
            changes["axial_clearance"] = self.axial_clearance
        return bearing_of_row(
            self.kind,
            replace(row, **changes, outer_turns=outer_turns),
            self.width,
            carries=self.carries,
            preload=self.preload,
            axial_offset=self.axial_offset,
            arrangement=self.arrangement,
            spacing=self.spacing,
            floating=self.floating,
            dynamic=self.dynamic_rating,
            name=f"bearing {name!r}",
        )

    def _rings(self, mounting: Mounting) -> tuple[float, float]:
        """Bore and outer diameter of the bearing [m]."""
        raise NotImplementedError


# Types of two rows, and those whose one row carries axial load both ways.
_BOTH_WAYS = ("spherical-roller", "self-aligning-ball", "double-row-angular-contact", "four-point")

Element = Literal["ball", "four-point-ball", "self-aligning-ball", "roller", "tapered-roller", "spherical-roller"]

_KINDS: dict[str, CatalogueType] = {
    "four-point-ball": "four-point",
    "self-aligning-ball": "self-aligning-ball",
    "roller": "cylindrical-roller",
    "tapered-roller": "tapered-roller",
    "spherical-roller": "spherical-roller",
}


_BALLS: tuple[Element, ...] = ("ball", "four-point-ball", "self-aligning-ball")
_ROLLERS: tuple[Element, ...] = ("roller", "tapered-roller", "spherical-roller")
_WITHOUT: tuple[tuple[str, tuple[Element, ...], str], ...] = (
    ("element_length", _BALLS, "balls have no length"),
    ("inner_groove", _ROLLERS, "only balls run in grooves"),
    ("outer_groove", _ROLLERS, "only balls run in grooves"),
    ("outer_groove", ("self-aligning-ball",), "the outer raceway is a sphere about the bearing's centre"),
    ("profile", (*_BALLS, "spherical-roller"), "only cylindrical and tapered rollers have such a profile"),
    ("osculation", (*_BALLS, "roller", "tapered-roller"), "only spherical rollers have a contour"),
)
"""Keys that some elements do not have, and why."""


class RollingGeometry(_Mounted):
    """A rolling bearing by its geometry [m, rad]; a groove is its radius over the ball's diameter."""

    element: Element = "ball"
    """Rolling elements. "four-point-ball" has two arcs a ring, with the `contact_angle` of the shim;
    "self-aligning-ball" has two rows in a spherical outer ring; "roller" is cylindrical; "spherical-roller" has two
    rows."""
    count: Annotated[int, Whole(3, 500)]
    """Number of elements of one row."""
    element_diameter: PositiveLength
    """Diameter of the balls or rollers."""
    element_length: PositiveLength | None = None
    """Length of contact of rollers; needed for them."""
    pitch_diameter: PositiveLength
    """Diameter of the circle of the elements' centres."""
    contact_angle: _ContactAngle = 0.0
    """Contact angle at the outer ring; needed by four-point and self-aligning balls and tapered rollers."""
    inner_groove: _Groove | None = None
    """Groove radius of the inner ring over the ball's diameter. Default: 0.52, of self-aligning balls 0.53."""
    outer_groove: _Groove | None = None
    """Groove radius of the outer ring over the ball's diameter. Default: 0.53."""
    profile: Literal["straight", "logarithmic"] | None = None
    """Profile of cylindrical and tapered rollers. Default: logarithmic."""
    osculation: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] | None = None
    """Contour radius of spherical rollers over that of the raceways. Default: 0.98."""

    @model_validator(mode="after")
    def _fits(self) -> RollingGeometry:
        if self.element_diameter >= self.pitch_diameter:
            raise wrong("rolling elements smaller than their pitch circle", "element_diameter")
        angled = self.contact_angle != 0.0
        if self.element.endswith("roller") and self.element_length is None:
            raise wrong("the length of the rollers", "element_length")
        if self.element == "roller" and angled:
            raise wrong('nothing, or 0: rollers are cylindrical; element = "tapered-roller" has one', "contact_angle")
        if self.element in ("tapered-roller", "four-point-ball", "self-aligning-ball") and not angled:
            raise wrong(f"more than 0, the contact angle of a {self.element}", "contact_angle")
        for key, without, reason in _WITHOUT:
            if getattr(self, key) is not None and self.element in without:
                raise wrong(f"nothing: {reason}", key)
        if self.mounting is not None:
            for key in ("bore", "outer_diameter"):
                if getattr(self.mounting, key) is None:
                    raise wrong(f"the {key.replace('_', ' ')} of the bearing", "mounting", key)
        return self

    @property
    def kind(self) -> CatalogueType:
        """Type of the bearing by its elements; a ball's angle tells deep grooves from angular contact."""
        return _KINDS.get(self.element, "angular-contact" if self.contact_angle > 0.0 else "deep-groove")

    def build_row(self) -> Row:
        """One row of balls or rollers."""
        from gearwhine.rotors.rolling_bearings import (
            BallRow,
            FourPointRow,
            RollerRow,
            SphericalRollerRow,
            TaperedRollerRow,
            spherical_groove,
        )

        if self.element_length is not None:
            size = (self.count, self.element_diameter, self.element_length, self.pitch_diameter, self.clearance)
            profile = self.profile or "logarithmic"
            if self.element == "roller":
                return RollerRow(*size, profile=profile)
            if self.element == "tapered-roller":
                return TaperedRollerRow(*size, profile=profile, angle=self.contact_angle)
            return SphericalRollerRow(*size, angle=self.contact_angle, osculation=self.osculation or 0.98)
        aligning = self.element == "self-aligning-ball"
        sphere = spherical_groove(self.element_diameter, self.pitch_diameter, self.contact_angle)
        make = FourPointRow if self.element == "four-point-ball" else BallRow
        return make(
            self.count,
            self.element_diameter,
            self.pitch_diameter,
            self.contact_angle,
            self.inner_groove or (0.53 if aligning else 0.52),
            sphere if aligning else self.outer_groove or 0.53,
            self.clearance,
        )

    def _rings(self, mounting: Mounting) -> tuple[float, float]:
        assert mounting.bore is not None
        assert mounting.outer_diameter is not None
        return mounting.bore, mounting.outer_diameter


class Catalogue(Table):
    """Main dimensions of a catalogue [m, rad]; the inside is estimated."""

    type: CatalogueType
    """Type of the bearing."""
    bore: PositiveLength
    """Bore."""
    outer_diameter: PositiveLength
    """Outer diameter."""
    width: PositiveLength
    """Width, of tapered rollers T."""
    contact_angle: _ContactAngle | None = None
    """Contact angle. Default: a usual one of the type."""
    axial_factor: Annotated[float, Quantity(units.RATIO, above=0.0)] | None = None
    """Factor Y of tapered or Y1 of spherical rollers, in place of the contact angle (ISO 281)."""

    @model_validator(mode="after")
    def _is_a_ring(self) -> Catalogue:
        if self.outer_diameter <= self.bore:
            raise wrong(f"more than the bore of {self.bore:g} m", "outer_diameter")
        if self.contact_angle is not None and self.type in ("deep-groove", "cylindrical-roller"):
            raise wrong(f"nothing: a {self.type} bearing has none", "contact_angle")
        if self.axial_factor is not None and self.type not in ("tapered-roller", "spherical-roller"):
            raise wrong("nothing: only tapered and spherical rollers have their angle from it", "axial_factor")
        if self.axial_factor is not None and self.contact_angle is not None:
            raise wrong("nothing beside contact_angle", "axial_factor")
        return self


class RollingCatalogue(_Mounted):
    """A rolling bearing by its main dimensions."""

    catalogue: Catalogue
    """Main dimensions, from which the inside is estimated."""
    static_rating: Annotated[float, Quantity(units.FORCE, above=0.0)] | None = None
    """Basic static load rating C0 of the whole bearing, of both with `arrangement`; improves the estimated inside."""

    @model_validator(mode="after")
    def _has_rings(self) -> RollingCatalogue:
        for key in ("bore", "outer_diameter"):
            if self.mounting is not None and getattr(self.mounting, key) is not None:
                raise wrong("nothing: the catalogue has it", "mounting", key)
        return self

    @property
    def kind(self) -> CatalogueType:
        """Type of the bearing in the catalogue."""
        return self.catalogue.type

    @property
    def width(self) -> float:
        """Width of the bearing [m]."""
        return self.catalogue.width

    def build_row(self) -> Row:
        """One row, its inside estimated from the main dimensions and ratings."""
        from gearwhine.rotors.rolling_bearings import catalogue_row

        size = self.catalogue
        return catalogue_row(
            size.type,
            size.bore,
            size.outer_diameter,
            size.width,
            contact_angle=size.contact_angle,
            axial_factor=size.axial_factor,
            clearance=self.clearance,
            # Without C0 it is for the lives alone.
            dynamic=self.dynamic_rating if self.static_rating is not None else None,
            static=self.static_rating,
            bearings=1 if self.arrangement == "single" else 2,
        )

    def _rings(self, mounting: Mounting) -> tuple[float, float]:
        return self.catalogue.bore, self.catalogue.outer_diameter


def _form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return "~catalogue" if "catalogue" in keys else "~geometry"


Rolling = Annotated[
    Annotated[RollingGeometry, Tag("~geometry")] | Annotated[RollingCatalogue, Tag("~catalogue")],
    Discriminator(_form),
]


class _Radial(Table):
    """A 2×2 matrix over x and y by its entries, each a number or a list over speeds."""

    def build(self) -> npt.NDArray[np.float64]:
        """Build the coefficient matrix, (2, 2), or with lists in it one for each speed, (s, 2, 2)."""
        import numpy as np

        entries = np.broadcast_arrays(*(getattr(self, key) for key in ("xx", "xy", "yx", "yy")))
        return np.stack(entries, axis=-1).reshape(*entries[0].shape, 2, 2)


class RadialStiffness(_Radial):
    """A 2×2 radial stiffness [N/m]: force against the shaft's motion relative to its seat."""

    xx: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))]
    """Stiffness xx: force along x against motion along x; a list with `speeds`. 0 of a damper; negative of seals and
    magnetic bearings."""
    yy: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))]
    """Stiffness yy: force along y against motion along y; a list with `speeds`."""
    xy: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))] = 0.0
    """Stiffness xy: force along x against motion along y; a list with `speeds`."""
    yx: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))] = 0.0
    """Stiffness yx: force along y against motion along x; a list with `speeds`."""


class RadialDamping(_Radial):
    """A 2×2 radial damping [N s/m]."""

    xx: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING, at_least=0.0))] = 0.0
    """Damping xx: force along x against velocity along x; a list with `speeds`."""
    yy: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING, at_least=0.0))] = 0.0
    """Damping yy: force along y against velocity along y; a list with `speeds`."""
    xy: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING))] = 0.0
    """Damping xy: force along x against velocity along y; a list with `speeds`."""
    yx: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING))] = 0.0
    """Damping yx: force along y against velocity along x; a list with `speeds`."""


class PedestalStiffness(_Radial):
    """A 2×2 stiffness to the ground [N/m]."""

    xx: PositiveStiffness
    """Stiffness xx to the ground."""
    yy: PositiveStiffness
    """Stiffness yy to the ground."""
    xy: Stiffness = 0.0
    """Stiffness xy to the ground."""
    yx: Stiffness = 0.0
    """Stiffness yx to the ground."""

    @model_validator(mode="after")
    def _holds(self) -> PedestalStiffness:
        if self.xy * self.yx >= self.xx * self.yy:
            raise wrong(f"a product with yx below xx times yy, {self.xx * self.yy:g} N²/m², so that it holds", "xy")
        return self


class PedestalDamping(_Radial):
    """A 2×2 damping to the ground [N s/m]."""

    xx: DampingFromZero = 0.0
    """Damping xx to the ground."""
    yy: DampingFromZero = 0.0
    """Damping yy to the ground."""
    xy: Damping = 0.0
    """Damping xy to the ground."""
    yx: Damping = 0.0
    """Damping yx to the ground."""


class Pedestal(Table):
    """Pedestal of a bearing on the ground: a mass [kg] on springs and dashpots, free to move in x and y."""

    mass: Mass = 0.0
    """Mass."""
    stiffness: PedestalStiffness
    """Stiffness to the ground."""
    damping: PedestalDamping = PedestalDamping()
    """Damping to the ground."""

    def build(self) -> BuiltPedestal:
        """Build the pedestal."""
        from gearwhine.rotors import Pedestal as BuiltPedestal

        return BuiltPedestal(self.stiffness.build(), self.damping.build(), self.mass)


MatrixRows = tuple[tuple[float, ...], ...]

_STIFFNESSES = (units.STIFFNESS, units.COUPLED_STIFFNESS, units.TILT_STIFFNESS)
_DAMPINGS = (units.DAMPING, units.COUPLED_DAMPING, units.TILT_DAMPING)


def _read_matrix(
    value: Any, kinds: tuple[Dimension, Dimension, Dimension], least_direct: float | None = None
) -> MatrixRows:
    """Validate a 5x5 matrix of quantities over (x, y, z, tilt about x, tilt about y)."""
    rows = value if isinstance(value, (list, tuple)) else ()
    if len(rows) != 5 or any(not isinstance(row, (list, tuple)) or len(row) != 5 for row in rows):
        raise wrong("five rows of five, over x, y, z and the tilts about x and y")
    return tuple(
        tuple(
            Quantity(kinds[(i >= 3) + (j >= 3)], at_least=least_direct if i == j else None).validate_at(entry, i, j)
            for j, entry in enumerate(row)
        )
        for i, row in enumerate(value)
    )


class _Matrix(Table):
    """A 5x5 matrix over (x, y, z, tilt about x, tilt about y)."""

    matrix: MatrixRows
    """Five rows of five over x, y, z and the rotations about x and y."""

    def build(self) -> npt.NDArray[np.float64]:
        """Build the coefficient matrix, (5, 5)."""
        import numpy as np

        return np.array(self.matrix)


class MatrixStiffness(_Matrix):
    """A 5x5 stiffness over (x, y, z, tilt about x, tilt about y): N/m, N/rad and N m/rad."""

    @field_validator("matrix", mode="before")
    @classmethod
    def _read(cls, value: Any) -> MatrixRows:
        return _read_matrix(value, _STIFFNESSES)


class MatrixDamping(_Matrix):
    """A 5x5 damping over (x, y, z, tilt about x, tilt about y): N s/m, N s/rad and N m s/rad."""

    @field_validator("matrix", mode="before")
    @classmethod
    def _read(cls, value: Any) -> MatrixRows:
        return _read_matrix(value, _DAMPINGS, least_direct=0.0)


class StiffnessDamping(Table):
    """A damping in proportion to the bearing's stiffness, in all its directions."""

    over_stiffness: Annotated[float, Quantity(units.TIME, at_least=0.0, at_most=1e-2)]
    """Damping over stiffness. Rolling bearings have 2.5e-6 to 2.5e-5 s (Krämer 1993); at a frequency f the loss factor
    is 2π f times it."""


class RollingStiffness(Table):
    """A stiffness that follows from the geometry of a rolling-element bearing under its load."""

    rolling: Rolling
    """Rolling bearing, by its geometry or by a catalogue's main dimensions."""


class BearingFault(Table):
    """A fault of a rolling bearing with `law = "nonlinear"`: a spall of a raceway or an element, or a worn cage.

    A spall is material that broke out; a pocket of the cage that is worn or broken lets an element out of its place.
    """

    on: Literal["outer", "inner", "element", "cage"]
    """Damaged raceway, a rolling element, or the cage."""
    length: PositiveLength
    """Length along the rolling direction: the elements drop by what its edges let them, and strike the far one. Of a
    cage it is the way along the pitch circle by which an element is ahead of its place."""
    depth: PositiveLength | None = None
    """Depth of the floor, which no element drops beyond; needed but for a cage, which has none."""
    azimuth: Annotated[float, Quantity(units.ANGLE)] = 0.0
    """Azimuth of the middle at the start: on a ring from x towards y, on an element from its line to the inner
    raceway. On a ring of a planet that a `[[planetary]]` mounts `count` times it is that at the first one, and turned
    with the others."""
    row: Annotated[int, Whole(0, 7)] = 0
    """Number of the row of elements, from 0."""
    element: Annotated[int, Whole(0, 999)] = 0
    """Number of the damaged element, from 0."""
    width: PositiveLength | None = None
    """Width across the rolling direction, in the middle of rollers. Default: all of their length; of balls that of
    their contact."""
    planet: PlanetNumber | None = None
    """Number from 1 of the one planet with the fault, of a bearing that a `[[planetary]]` mounts `count` times.
    Default: all planets have it."""

    @model_validator(mode="after")
    def _of_its_part(self) -> BearingFault:
        if self.on in ("outer", "inner") and self.element:
            raise wrong("0 of a raceway, which all elements pass", "element")
        if self.on == "cage":
            for key in ("depth", "azimuth", "width"):
                if getattr(self, key):
                    raise wrong("none of a cage, whose pocket is told by 'element'", key)
        elif self.depth is None:
            raise wrong("the depth of a spall's floor", "depth")
        return self

    def build(self) -> BearingDamage:
        """Build the spall, or the fault of the cage."""
        from gearwhine.rotors.rolling_bearings import CageFault, RollingSpall

        if self.on == "cage" or self.depth is None:
            return CageFault(self.length, self.row, self.element)
        return RollingSpall(self.on, self.length, self.depth, self.azimuth, self.row, self.element, self.width)


class CageSlip(Table):
    """Slip of the cage of a rolling bearing with `law = "nonlinear"`, in each of its rows."""

    mean: Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=0.5)] = 0.0
    """Mean part of the speed of pure rolling by which the cage lags; 0.01 to 0.02 are usual."""
    scatter: Annotated[float, Quantity(units.RATIO, at_least=0.0, at_most=0.1)] = 0.0
    """Standard deviation of the angle between two elements' passing over its mean: multiples of strikes get wide."""
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    """Seed of the random changes. The same seed gives the same ones."""

    def build(self) -> BuiltCageSlip:
        """Build the slip."""
        from gearwhine.rotors.rolling_bearings import CageSlip as BuiltCageSlip

        return BuiltCageSlip(self.mean, self.scatter, self.seed)


class StopStiffness(Table):
    """No stiffness, but a stop that the shaft may strike; linear analyses see its slope under the bearing's load."""

    stop: Stop
    """Stop that the shaft may strike; linear analyses use its slope under `load`."""


def _stiffness_form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return next((f"~{form}" for form in ("matrix", "rolling", "stop") if form in keys), "~radial")


def _damping_form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return next((form for key, form in (("matrix", "~matrix"), ("over_stiffness", "~time")) if key in keys), "~radial")


class SeatError(Table):
    """Error of the place of a bearing's seat: position of its bore [m] and rotation of its axis [rad]."""

    x: Length = 0.0
    """Position along x."""
    y: Length = 0.0
    """Position along y."""
    tilt_x: Angle = 0.0
    """Rotation of its axis about x."""
    tilt_y: Angle = 0.0
    """Rotation of its axis about y."""

    def build(self) -> tuple[float, float, float, float] | None:
        """Return position and rotation; None where all are 0."""
        error = self.x, self.y, self.tilt_x, self.tilt_y
        return error if any(error) else None


class Bearing(Table):
    """`[[bearing]]`: between a rotor at a station [m from its left end] and a seat, or "ground".

    Stiffness and damping may be tables over `speeds` of rotation [rad/s], in whichever sense.
    """

    name: Name
    """Name of the bearing."""
    rotor: RotorName
    """Name of the rotor."""
    at: LengthFromZero
    """Middle of the bearing from the rotor's left end, whatever its contact angles."""
    seat: CarrierOfBearing = "ground"
    """Name of a seat of the housing, or "ground", which is warned of beside bearings in seats; or of another rotor on
    the same axis, in or on which it stands. Of a planet: its carrier, which is the default there."""
    speeds: tuple[SpeedFromZero, ...] | None = Field(default=None, min_length=2, max_length=MOST_ENTRIES)
    """Ascending speeds of the rotor, at which coefficients that are lists are given; all speeds of the case lie between
    them."""
    pedestal: Pedestal | None = None
    """Pedestal under a bearing on the ground. Default: rigid ground."""
    stiffness: Annotated[
        Annotated[RadialStiffness, Tag("~radial")]
        | Annotated[MatrixStiffness, Tag("~matrix")]
        | Annotated[RollingStiffness, Tag("~rolling")]
        | Annotated[StopStiffness, Tag("~stop")],
        Discriminator(_stiffness_form),
    ]
    """Stiffness against the shaft's motion relative to its seat, in one of four forms."""
    damping: (
        Annotated[
            Annotated[RadialDamping, Tag("~radial")]
            | Annotated[MatrixDamping, Tag("~matrix")]
            | Annotated[StiffnessDamping, Tag("~time")],
            Discriminator(_damping_form),
        ]
        | None
    ) = None
    """Damping, in one of three forms. Default: of a rolling bearing by its elements `{ over_stiffness = "8 us" }`, the
    middle of Krämer's range; of others none."""
    seat_error: SeatError = SeatError()
    """Error of the place of its bore, as by a position tolerance. A bearing with `law = "nonlinear"` or a stop takes
    none. Default: none."""
    load: BearingLoad | None = None
    """Mean force of the shaft on a rolling bearing or stop. Default: of a rolling bearing that of the static
    equilibrium, in a case with an operation where gear pairs, a force, gravity or an `axial_offset` on its rotor load
    it; of a stop none."""
    fault: Annotated[tuple[BearingFault, ...], Field(max_length=100)] = ()
    """Spalls and faults of the cage of a rolling bearing in the transient: one table, or a list."""
    slip: CageSlip | None = None
    """Slip of the cage of a rolling bearing in the transient. Default: none, pure rolling."""

    @field_validator("fault", mode="before")
    @classmethod
    def _one_or_more(cls, value: object) -> object:
        return [value] if isinstance(value, dict) else value

    @model_validator(mode="after")
    def _consistent(self) -> Bearing:
        if self.rolling is None or self.rolling.law != "nonlinear":
            for key in ("fault", "slip"):
                if getattr(self, key):
                    raise wrong('none, or rolling = { …, law = "nonlinear" }, which follows every element', key)
        for number, fault in enumerate(self.fault):
            if fault.planet is not None:
                raise wrong(one_of_planets("bearing"), "fault", number, "planet")
        if self.follows_own_law and self.seat_error.build() is not None:
            raise wrong(
                "none of a stop or of law = 'nonlinear', which take the seat in its nominal place", "seat_error"
            )
        if self.load is not None and not isinstance(self.stiffness, RollingStiffness | StopStiffness):
            raise wrong("nothing: only the stiffness of a rolling bearing or a stop depends on its load", "load")
        if self.rolling is not None and self.rolling.floating:
            if self.load is not None and self.load.z != 0.0:
                raise wrong("0: a floating bearing takes no axial force", "load", "z")
            rows = self.damping.matrix if isinstance(self.damping, MatrixDamping) else None
            if rows is not None and (any(rows[2]) or any(row[2] for row in rows)):
                raise wrong("zeros in the row and column of z: a floating bearing takes no axial force", "damping")
        for place, (lower, upper) in enumerate(pairwise(self.speeds or ()), start=1):
            if upper <= lower:
                raise wrong("a speed above the one before it", "speeds", place)
        return self

    @property
    def rolling(self) -> RollingGeometry | RollingCatalogue | None:
        """The rolling bearing, whose stiffness follows from its elements; None of another kind."""
        return self.stiffness.rolling if isinstance(self.stiffness, RollingStiffness) else None

    @property
    def follows_own_law(self) -> bool:
        """Whether its force in motion is no matrix times its deflection."""
        by_elements = self.rolling is not None and self.rolling.law == "nonlinear"
        return by_elements or isinstance(self.stiffness, StopStiffness)

    @property
    def damping_time(self) -> float:
        """Damping over stiffness [s]; 0 where the damping is given by itself, and of typed stiffness without any."""
        from gearwhine.rotors.rolling_bearings import ROLLING_DAMPING_TIME

        if isinstance(self.damping, StiffnessDamping):
            return self.damping.over_stiffness
        return ROLLING_DAMPING_TIME if self.damping is None and self.rolling is not None else 0.0

    @property
    def lacks_load(self) -> bool:
        """Whether it is a rolling bearing whose load is not given."""
        return self.rolling is not None and self.load is None

    @property
    def is_offset(self) -> bool:
        """Whether an axial offset of its inner ring presses it and other bearings of its rotor."""
        return self.rolling is not None and self.rolling.axial_offset != 0.0

    @property
    def grounded(self) -> bool:
        """Whether the bearing stands on the ground rather than in a seat."""
        return self.seat == "ground"


def operation_loads(bearing: Bearing, bearings: Iterable[Bearing], loaded_rotors: Container[str]) -> bool:
    """Whether the static equilibrium of a case with an operation has the load of a bearing, which is not given.

    It does where gears, a force or weight load its rotor, see :meth:`gearwhine.case.operation.Operation.loaded_rotors`,
    or where one of the case's ``bearings`` is set against this one.
    """
    opposed = any(one.is_offset and one.rotor == bearing.rotor for one in bearings)
    return bearing.lacks_load and (bearing.rotor in loaded_rotors or opposed)
