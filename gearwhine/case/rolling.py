"""Rolling bearings of a case, by their geometry or by the main dimensions of a catalogue; stops; bearing loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import Force, Length, LengthFromZero, PositiveLength, Quantity, Table, Whole, wrong

if TYPE_CHECKING:
    import coupling
    from rotors.rolling import BallRow, RollerRow, RollingBearing

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

    def build(self) -> coupling.GapLaw:
        """The law of the stop."""
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
        """The bearing of one or two rows.

        Raises
        ------
        rotors.RotorError
            Where there is no such bearing.
        """
        from rotors.rolling import BallRow, RollerRow, RollingBearing, paired

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
    """By its geometry [m, rad]; a groove is its radius over the ball's diameter."""

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
        from rotors.rolling import BallRow, RollerRow

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
    """By its main dimensions."""

    catalogue: Catalogue

    @property
    def rolls_on_cylinders(self) -> bool:
        """Whether its elements are cylindrical rollers."""
        return self.catalogue.type == "cylindrical-roller"

    def build_row(self) -> BallRow | RollerRow:
        """One row, its inside estimated from the main dimensions."""
        from rotors.rolling import catalogue_row

        sizes = self.catalogue.model_dump(exclude={"type"})
        return catalogue_row(self.catalogue.type, **sizes, clearance=self.clearance)


def _form(value: Any) -> str:
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return "~catalogue" if "catalogue" in keys else "~geometry"


Rolling = Annotated[
    Annotated[RollingGeometry, Tag("~geometry")] | Annotated[RollingCatalogue, Tag("~catalogue")],
    Discriminator(_form),
]
