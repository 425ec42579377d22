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
    Coefficient,
    Damping,
    DampingFromZero,
    Force,
    Length,
    LengthFromZero,
    Mass,
    Name,
    OverSpeed,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    SpeedFromZero,
    Stiffness,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.units import Dimension

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from coupling import GapLaw
    from rotors import Pedestal as BuiltPedestal
    from rotors.rolling_bearings import RollingBearing, Row

Arrangement = Literal["single", "back to back", "face to face", "tandem"]
# As `rotors.rolling_bearings.catalogue` has it, and a test holds: a case is read without numpy, which that room takes.
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
    y: Force = 0.0
    z: Force = 0.0


class Stop(Table):
    """A ring around the shaft: beyond its radial `gap` [m] it takes `force` [N] at a `depth` [m], by an `exponent`."""

    force: Annotated[float, Quantity(units.FORCE, above=0.0)]
    depth: PositiveLength
    exponent: Annotated[float, Quantity(units.RATIO, at_least=1.0, at_most=10.0)] = 1.0
    gap: LengthFromZero = 0.0

    def build(self) -> GapLaw:
        """Build the force law of the stop."""
        from coupling import GapLaw

        return GapLaw(self.force, self.depth, self.exponent, self.gap)


class Mounting(Table):
    """Fits and temperatures of a bearing, by which `clearance`, then that before mounting, changes [m, K].

    `inner_interference` on the shaft and `outer_interference` in the housing are diametral, of the cold parts, less
    `smoothing` of the surfaces; the shaft is hollow by `shaft_bore`, the housing a ring to `housing_diameter`, thick
    where none is given. `..._rise` is a temperature over that of the sizes: of shaft and housing that of their rings
    unless given. The shaft is of steel. `bore` and `outer_diameter` are the bearing's, where no catalogue has them.
    """

    inner_interference: Length = 0.0
    outer_interference: Length = 0.0
    smoothing: LengthFromZero = 0.0
    shaft_bore: LengthFromZero = 0.0
    housing_diameter: PositiveLength | None = None
    housing_modulus: Annotated[float, Quantity(units.STRESS, above=0.0)] = 210e9
    housing_poisson_ratio: Annotated[float, Quantity(units.RATIO, above=-1.0, at_most=0.5)] = 0.3
    housing_expansion: Annotated[float, Quantity(units.EXPANSION, at_least=0.0)] = 11.7e-6
    inner_rise: Annotated[float, Quantity(units.TEMPERATURE)] = 0.0
    outer_rise: Annotated[float, Quantity(units.TEMPERATURE)] = 0.0
    shaft_rise: Annotated[float, Quantity(units.TEMPERATURE)] | None = None
    housing_rise: Annotated[float, Quantity(units.TEMPERATURE)] | None = None
    bore: PositiveLength | None = None
    outer_diameter: PositiveLength | None = None

    def operating_clearance(self, row: Row, clearance: float, bore: float, outer_diameter: float) -> float:
        """Diametral clearance in operation of a row in a bearing of these diameters [m]."""
        from rotors.rolling_bearings import RingFit, operating_clearance

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
    """Mounting of a bearing: clearance, preload and arrangement of rows [m, N].

    `clearance` is diametral and in running, or before mounting with `mounting`; a negative one is an interference.
    `preload` is axial: of a single row a spring's force on the shaft along `carries`, of two rows the force with which
    they press each other. `carries` is the way in which an axial force of the shaft presses the elements of a single
    row, or of two in tandem; `axial_offset` moves the inner ring that way at assembly, against another bearing.
    `law`: whether it is the linear one about its load in the transient, or that of every element with its play as they
    go round. `dynamic_rating` and `static_rating` are the maker's C and C0 of the whole bearing, for the rated life and
    for an inside that is estimated. `flanges` let cylindrical rollers carry axial load, by `flange_stiffness` each.
    """

    law: Literal["linear", "nonlinear"] = "linear"
    clearance: Length = 0.0
    mounting: Mounting | None = None
    preload: Annotated[float, Quantity(units.FORCE, at_least=0.0)] = 0.0
    axial_offset: Length = 0.0
    carries: Literal["+z", "-z"] = "+z"
    arrangement: Arrangement = "single"
    spacing: PositiveLength | None = None
    dynamic_rating: Annotated[float, Quantity(units.FORCE, above=0.0)] | None = None
    static_rating: Annotated[float, Quantity(units.FORCE, above=0.0)] | None = None
    flanges: Literal["none", "one", "both"] = "none"
    flange_stiffness: PositiveStiffness | None = None
    axial_clearance: LengthFromZero = 0.0

    @property
    def pressed(self) -> bool:
        """Whether its elements are pressed without any load of the shaft."""
        return self.preload > 0.0 or self.clearance < 0.0 or self.axial_offset > 0.0

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
        if self.flanges != "none" and not cylinders:
            raise wrong("nothing: only cylindrical rollers run between flanges", "flanges")
        if (self.flanges == "none") != (self.flange_stiffness is None):
            expected = "nothing without flanges" if self.flanges == "none" else "of each roller between its flanges"
            raise wrong(expected, "flange_stiffness")
        if self.law == "nonlinear" and (self.flanges != "none" or self.kind == "four-point"):
            kind = "four-point balls" if self.kind == "four-point" else "rollers between flanges"
            raise wrong(f"'linear': {kind} have no law in the transient", "law")
        return self

    @property
    def kind(self) -> CatalogueType:
        """Type of the bearing by its elements."""
        raise NotImplementedError

    @property
    def width(self) -> float:
        """Of the bearing, as far as the places of its rows follow from it [m]."""
        return 0.0

    def build_row(self) -> Row:
        """One row of rolling elements."""
        raise NotImplementedError

    def build(self, name: str) -> RollingBearing:
        """Build the rolling bearing, of one or two rows.

        Raises
        ------
        rotors.RotorError
            Where there is no such bearing.
        """
        from rotors.rolling_bearings import RollerRow, RollingBearing, paired, standing_rows

        row, sense, label = self.build_row(), 1 if self.carries == "+z" else -1, f"bearing {name!r}"
        changes: dict[str, Any] = {"axial_offset": self.axial_offset}
        if self.mounting is not None:
            bore, outer_diameter = self._rings(self.mounting)
            changes["clearance"] = self.mounting.operating_clearance(row, self.clearance, bore, outer_diameter)
        if isinstance(row, RollerRow) and self.flange_stiffness is not None:
            changes["flanges"], changes["flange_stiffness"] = self.flanges, self.flange_stiffness
            changes["axial_clearance"] = self.axial_clearance
        row = replace(row, **changes)
        rows = standing_rows(self.kind, row, self.width)
        if len(rows) == 2 or self.arrangement == "single":
            rows = rows if len(rows) == 2 else (row.facing(sense),)
            return RollingBearing(rows, sense * self.preload, label)
        assert self.spacing is not None
        if self.arrangement == "tandem":
            pair = paired(row, "tandem", self.spacing)
            return RollingBearing([one.facing(sense) for one in pair.rows], sense * self.preload, label)
        return paired(row, self.arrangement, self.spacing, preload=self.preload, name=label)

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


class RollingGeometry(_Mounted):
    """A rolling bearing by its geometry [m, rad]; a groove is its radius over the ball's diameter.

    `count` is of one row; "spherical-roller" and "self-aligning-ball" have two. `contact_angle` is that at the outer
    ring; `osculation` the contour radius of spherical rollers over that of their raceways.
    """

    element: Element = "ball"
    count: Annotated[int, Whole(3, 500)]
    element_diameter: PositiveLength
    element_length: PositiveLength | None = None
    pitch_diameter: PositiveLength
    contact_angle: _ContactAngle = 0.0
    inner_groove: _Groove | None = None
    outer_groove: _Groove | None = None
    profile: Literal["straight", "logarithmic"] | None = None
    osculation: Annotated[float, Quantity(units.RATIO, above=0.0, below=1.0)] | None = None

    @model_validator(mode="after")
    def _fits(self) -> RollingGeometry:
        if self.element_diameter >= self.pitch_diameter:
            raise wrong("rolling elements smaller than their pitch circle", "element_diameter")
        rollers, angled = self.element.endswith("roller"), self.contact_angle != 0.0
        if rollers and self.element_length is None:
            raise wrong("the length of the rollers", "element_length")
        if not rollers and self.element_length is not None:
            raise wrong("nothing: balls have no length", "element_length")
        if self.element == "roller" and angled:
            raise wrong('nothing, or 0: rollers are cylindrical; element = "tapered-roller" has one', "contact_angle")
        if self.element in ("tapered-roller", "four-point-ball", "self-aligning-ball") and not angled:
            raise wrong(f"more than 0, the contact angle of a {self.element}", "contact_angle")
        for key in ("inner_groove", "outer_groove"):
            if getattr(self, key) is not None and rollers:
                raise wrong("nothing: only balls run in grooves", key)
        if self.outer_groove is not None and self.element == "self-aligning-ball":
            raise wrong("nothing: the outer raceway is a sphere about the bearing's centre", "outer_groove")
        if self.profile is not None and self.element not in ("roller", "tapered-roller"):
            raise wrong("nothing: only cylindrical and tapered rollers have such a profile", "profile")
        if self.osculation is not None and self.element != "spherical-roller":
            raise wrong("nothing: only spherical rollers have a contour", "osculation")
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
        from rotors.rolling_bearings import (
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
    """Main dimensions of a catalogue [m, rad]; the inside is estimated.

    `axial_factor` is the catalogue's Y of tapered or Y1 of spherical rollers, in place of their contact angle.
    """

    type: CatalogueType
    bore: PositiveLength
    outer_diameter: PositiveLength
    width: PositiveLength
    contact_angle: _ContactAngle | None = None
    axial_factor: Annotated[float, Quantity(units.RATIO, above=0.0)] | None = None

    @model_validator(mode="after")
    def _is_a_ring(self) -> Catalogue:
        if self.outer_diameter <= self.bore:
            raise wrong(f"more than the bore of {self.bore:g} m", "outer_diameter")
        if self.contact_angle is not None and self.type in ("deep-groove", "cylindrical-roller"):
            raise wrong(f"nothing: a {self.type} bearing has none", "contact_angle")
        if self.axial_factor is not None and self.type not in _AXIAL_FACTORS:
            raise wrong("nothing: only tapered and spherical rollers have their angle from it", "axial_factor")
        if self.axial_factor is not None and self.contact_angle is not None:
            raise wrong("nothing beside contact_angle", "axial_factor")
        return self

    @property
    def angle(self) -> float | None:
        """Contact angle, where it is given or follows from a factor: cot α = Y/0.4 or Y1/0.45 by ISO 281 [rad]."""
        if self.axial_factor is None:
            return self.contact_angle
        return math.atan(_AXIAL_FACTORS[self.type] / self.axial_factor)


_AXIAL_FACTORS = {"tapered-roller": 0.4, "spherical-roller": 0.45}


class RollingCatalogue(_Mounted):
    """A rolling bearing by its main dimensions."""

    catalogue: Catalogue

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
        """Of the bearing [m]."""
        return self.catalogue.width

    def build_row(self) -> Row:
        """One row, its inside estimated from the main dimensions and ratings."""
        from rotors.rolling_bearings import catalogue_row

        size = self.catalogue
        # The ratings of a pair say nothing certain of a single row.
        single = self.arrangement == "single"
        return catalogue_row(
            size.type,
            size.bore,
            size.outer_diameter,
            size.width,
            contact_angle=size.angle,
            clearance=self.clearance,
            dynamic=self.dynamic_rating if single and self.static_rating is not None else None,
            static=self.static_rating if single else None,
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

    xx: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS, above=0.0))]
    yy: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS, above=0.0))]
    xy: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))] = 0.0
    yx: Annotated[Coefficient, OverSpeed(Quantity(units.STIFFNESS))] = 0.0


class RadialDamping(_Radial):
    """A 2×2 radial damping [N s/m]."""

    xx: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING, at_least=0.0))] = 0.0
    yy: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING, at_least=0.0))] = 0.0
    xy: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING))] = 0.0
    yx: Annotated[Coefficient, OverSpeed(Quantity(units.DAMPING))] = 0.0


class PedestalStiffness(_Radial):
    """A 2×2 stiffness to the ground [N/m]."""

    xx: PositiveStiffness
    yy: PositiveStiffness
    xy: Stiffness = 0.0
    yx: Stiffness = 0.0

    @model_validator(mode="after")
    def _holds(self) -> PedestalStiffness:
        if self.xy * self.yx >= self.xx * self.yy:
            raise wrong(f"a product with yx below xx times yy, {self.xx * self.yy:g} N²/m², so that it holds", "xy")
        return self


class PedestalDamping(_Radial):
    """A 2×2 damping to the ground [N s/m]."""

    xx: DampingFromZero = 0.0
    yy: DampingFromZero = 0.0
    xy: Damping = 0.0
    yx: Damping = 0.0


class Pedestal(Table):
    """Pedestal of a bearing on the ground: a mass [kg] on springs and dashpots, free to move in x and y."""

    mass: Mass = 0.0
    stiffness: PedestalStiffness
    damping: PedestalDamping = PedestalDamping()

    def build(self) -> BuiltPedestal:
        """Build the pedestal."""
        from rotors import Pedestal as BuiltPedestal

        return BuiltPedestal(self.stiffness.build(), self.damping.build(), self.mass)


MatrixRows = tuple[tuple[float, ...], ...]

_STIFFNESSES = (units.STIFFNESS, units.COUPLED_STIFFNESS, units.TILT_STIFFNESS)
_DAMPINGS = (units.DAMPING, units.COUPLED_DAMPING, units.TILT_DAMPING)


def _read_matrix(value: Any, kinds: tuple[Dimension, Dimension, Dimension]) -> MatrixRows:
    """Validate a 5x5 matrix of quantities over (x, y, z, tilt about x, tilt about y), none negative on its diagonal."""
    rows = value if isinstance(value, (list, tuple)) else ()
    if len(rows) != 5 or any(not isinstance(row, (list, tuple)) or len(row) != 5 for row in rows):
        raise wrong("five rows of five, over x, y, z and the tilts about x and y")
    return tuple(
        tuple(
            Quantity(kinds[(i >= 3) + (j >= 3)], at_least=0.0 if i == j else None).validate_at(entry, i, j)
            for j, entry in enumerate(row)
        )
        for i, row in enumerate(value)
    )


class _Matrix(Table):
    """A 5x5 matrix over (x, y, z, tilt about x, tilt about y)."""

    matrix: MatrixRows

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
        return _read_matrix(value, _DAMPINGS)


class RollingStiffness(Table):
    """A stiffness that follows from the geometry of a rolling-element bearing under its load."""

    rolling: Rolling


class StopStiffness(Table):
    """No stiffness, but a stop that the shaft may strike; linear analyses see its slope under the bearing's load."""

    stop: Stop


def _stiffness_form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return next((f"~{form}" for form in ("matrix", "rolling", "stop") if form in keys), "~radial")


def _damping_form(value: Any) -> str:
    return "~matrix" if _stiffness_form(value) == "~matrix" else "~radial"


class Bearing(Table):
    """`[[bearing]]`: between a rotor at a station [m from its left end] and a seat, or "ground".

    Stiffness and damping may be tables over `speeds` of rotation [rad/s], in whichever sense.
    """

    name: Name
    rotor: Name
    at: LengthFromZero
    seat: Name = "ground"
    speeds: tuple[SpeedFromZero, ...] | None = Field(default=None, min_length=2, max_length=MOST_ENTRIES)
    pedestal: Pedestal | None = None
    stiffness: Annotated[
        Annotated[RadialStiffness, Tag("~radial")]
        | Annotated[MatrixStiffness, Tag("~matrix")]
        | Annotated[RollingStiffness, Tag("~rolling")]
        | Annotated[StopStiffness, Tag("~stop")],
        Discriminator(_stiffness_form),
    ]
    damping: Annotated[
        Annotated[RadialDamping, Tag("~radial")] | Annotated[MatrixDamping, Tag("~matrix")],
        Discriminator(_damping_form),
    ] = RadialDamping()
    load: BearingLoad | None = None

    @property
    def follows_own_law(self) -> bool:
        """Whether its force in motion is no matrix times its deflection."""
        if isinstance(self.stiffness, RollingStiffness):
            return self.stiffness.rolling.law == "nonlinear"
        return isinstance(self.stiffness, StopStiffness)

    @model_validator(mode="after")
    def _loaded(self) -> Bearing:
        depends = isinstance(self.stiffness, RollingStiffness | StopStiffness)
        if self.load is not None and not depends:
            raise wrong("nothing: only the stiffness of a rolling bearing or a stop depends on its load", "load")
        return self

    @property
    def lacks_load(self) -> bool:
        """Whether it is a rolling bearing whose load is not given."""
        return isinstance(self.stiffness, RollingStiffness) and self.load is None

    @model_validator(mode="after")
    def _ascending(self) -> Bearing:
        for place, (lower, upper) in enumerate(pairwise(self.speeds or ()), start=1):
            if upper <= lower:
                raise wrong("a speed above the one before it", "speeds", place)
        return self

    @property
    def grounded(self) -> bool:
        """Whether the bearing stands on the ground rather than in a seat."""
        return self.seat == "ground"
