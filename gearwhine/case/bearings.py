"""Bearings of a case, `[[bearing]]`: stiffness, damping, pedestals, stops and mean loads; rolling bearings.

A rolling bearing is given by its geometry, or by the main dimensions of a catalogue, from which its inside is
estimated. Attributes are named as the keys and are in SI.
"""

from __future__ import annotations

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
    from rotors.rolling_bearings import BallRow, RollerRow, RollingBearing

Arrangement = Literal["single", "back to back", "face to face", "tandem"]

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


class _Mounted(Table):
    """Mounting of a bearing: clearance, preload and arrangement of rows [m, N].

    `clearance` is diametral and in running; a negative one is an interference. `preload` is axial: of a single row a
    spring's force on the shaft along `carries`, of two rows the force with which they press each other. `carries` is
    the way in which an axial force of the shaft presses the balls of a single row, or of two in tandem. `law`: whether
    it is the linear one about its load in the transient, or that of every element with its play as they go round.
    `dynamic_rating` is the maker's C, for the rated life.
    """

    law: Literal["linear", "nonlinear"] = "linear"
    clearance: Length = 0.0
    preload: Annotated[float, Quantity(units.FORCE, at_least=0.0)] = 0.0
    carries: Literal["+z", "-z"] = "+z"
    arrangement: Arrangement = "single"
    spacing: PositiveLength | None = None
    dynamic_rating: Annotated[float, Quantity(units.FORCE, above=0.0)] | None = None

    @property
    def pressed(self) -> bool:
        """Whether its elements are pressed without any load of the shaft."""
        return self.preload > 0.0 or self.clearance < 0.0

    @model_validator(mode="after")
    def _arranged(self) -> _Mounted:
        if self.arrangement != "single" and self.spacing is None:
            raise wrong("the distance between the two rows", "spacing")
        if self.arrangement == "single" and self.spacing is not None:
            raise wrong("nothing: a single row has no spacing", "spacing")
        if self.preload > 0.0 and self.rolls_on_cylinders:
            raise wrong("nothing: cylindrical rollers carry no axial load", "preload")
        if self.arrangement != "single" and self.rolls_on_cylinders:
            raise wrong("'single': two rows of rollers are one of twice the length", "arrangement")
        return self

    @property
    def rolls_on_cylinders(self) -> bool:
        """Whether its elements are cylindrical rollers, which carry no axial load."""
        raise NotImplementedError

    def build_row(self) -> BallRow | RollerRow:
        """One row of rolling elements."""
        raise NotImplementedError

    def build(self, name: str) -> RollingBearing:
        """Build the rolling bearing, of one or two rows.

        Raises
        ------
        rotors.RotorError
            Where there is no such bearing.
        """
        from rotors.rolling_bearings import BallRow, RollerRow, RollingBearing, paired

        row, sense, label = self.build_row(), 1 if self.carries == "+z" else -1, f"bearing {name!r}"
        if isinstance(row, RollerRow):
            return RollingBearing([row], name=label)
        if self.arrangement == "single":
            return RollingBearing([row.facing(sense)], sense * self.preload, label)
        assert self.spacing is not None
        if self.arrangement == "tandem":
            pair = paired(row, "tandem", self.spacing)
            rows = [one.facing(sense) for one in pair.rows if isinstance(one, BallRow)]
            return RollingBearing(rows, sense * self.preload, label)
        return paired(row, self.arrangement, self.spacing, preload=self.preload, name=label)


class RollingGeometry(_Mounted):
    """A rolling bearing by its geometry [m, rad]; a groove is its radius over the ball's diameter."""

    element: Literal["ball", "roller"] = "ball"
    count: Annotated[int, Whole(3, 500)]
    element_diameter: PositiveLength
    element_length: PositiveLength | None = None
    pitch_diameter: PositiveLength
    contact_angle: _ContactAngle = 0.0
    inner_groove: _Groove = 0.52
    outer_groove: _Groove = 0.53
    profile: Literal["straight", "logarithmic"] = "logarithmic"

    @model_validator(mode="after")
    def _fits(self) -> RollingGeometry:
        if self.element_diameter >= self.pitch_diameter:
            raise wrong("rolling elements smaller than their pitch circle", "element_diameter")
        if self.element == "roller" and self.element_length is None:
            raise wrong("the length of the rollers", "element_length")
        if self.element == "ball" and self.element_length is not None:
            raise wrong("nothing: balls have no length", "element_length")
        if self.element == "roller" and self.contact_angle != 0.0:
            raise wrong("nothing, or 0: rollers are cylindrical", "contact_angle")
        return self

    @property
    def rolls_on_cylinders(self) -> bool:
        """Whether its elements are cylindrical rollers."""
        return self.element == "roller"

    def build_row(self) -> BallRow | RollerRow:
        """One row of balls or rollers."""
        from rotors.rolling_bearings import BallRow, RollerRow

        if self.element == "roller":
            assert self.element_length is not None
            return RollerRow(
                self.count,
                self.element_diameter,
                self.element_length,
                self.pitch_diameter,
                clearance=self.clearance,
                profile=self.profile,
            )
        return BallRow(
            self.count,
            self.element_diameter,
            self.pitch_diameter,
            self.contact_angle,
            self.inner_groove,
            self.outer_groove,
            self.clearance,
        )


class Catalogue(Table):
    """Main dimensions of a catalogue [m, rad]; the inside is estimated."""

    type: Literal["deep-groove", "angular-contact", "cylindrical-roller"]
    bore: PositiveLength
    outer_diameter: PositiveLength
    width: PositiveLength
    contact_angle: _ContactAngle | None = None

    @model_validator(mode="after")
    def _is_a_ring(self) -> Catalogue:
        if self.outer_diameter <= self.bore:
            raise wrong(f"more than the bore of {self.bore:g} m", "outer_diameter")
        if self.contact_angle is not None and self.type != "angular-contact":
            raise wrong("nothing: only angular-contact bearings have one", "contact_angle")
        return self


class RollingCatalogue(_Mounted):
    """A rolling bearing by its main dimensions."""

    catalogue: Catalogue

    @property
    def rolls_on_cylinders(self) -> bool:
        """Whether its elements are cylindrical rollers."""
        return self.catalogue.type == "cylindrical-roller"

    def build_row(self) -> BallRow | RollerRow:
        """One row, its inside estimated from the main dimensions."""
        from rotors.rolling_bearings import catalogue_row

        sizes = self.catalogue.model_dump(exclude={"type"})
        return catalogue_row(self.catalogue.type, **sizes, clearance=self.clearance)


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
