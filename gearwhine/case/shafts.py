"""Bearings of a case, `[[bearing]]`: stiffness, damping, pedestal. Attributes are named as the keys and are in SI."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Damping,
    DampingFromZero,
    LengthFromZero,
    Mass,
    Name,
    PositiveStiffness,
    Quantity,
    SpeedFromZero,
    Stiffness,
    Table,
    wrong,
)
from gearwhine.case.over_speed import Coefficient, OverSpeed
from gearwhine.case.rolling import BearingLoad, Rolling, Stop
from gearwhine.case.units import Dimension

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    import rotors


class _Radial(Table):
    """A 2×2 matrix over x and y by its entries, each a number or a list over speeds."""

    def build(self) -> npt.NDArray[np.float64]:
        """The matrix, (2, 2), or with lists in it one for each speed, (s, 2, 2)."""
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

    def build(self) -> rotors.Pedestal:
        """The pedestal."""
        from rotors import Pedestal as BuiltPedestal

        return BuiltPedestal(self.stiffness.build(), self.damping.build(), self.mass)


MatrixRows = tuple[tuple[float, ...], ...]

_STIFFNESSES = (units.STIFFNESS, units.COUPLED_STIFFNESS, units.TILT_STIFFNESS)
_DAMPINGS = (units.DAMPING, units.COUPLED_DAMPING, units.TILT_DAMPING)


def _read_matrix(value: Any, kinds: tuple[Dimension, Dimension, Dimension]) -> MatrixRows:
    """Validate a 5×5 matrix of quantities over (x, y, z, tilt about x, tilt about y), none negative on its diagonal."""
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
    """A 5×5 matrix over (x, y, z, tilt about x, tilt about y)."""

    matrix: MatrixRows

    def build(self) -> npt.NDArray[np.float64]:
        """The matrix, (5, 5)."""
        import numpy as np

        return np.array(self.matrix)


class MatrixStiffness(_Matrix):
    """A 5×5 stiffness over (x, y, z, tilt about x, tilt about y): N/m, N/rad and N m/rad."""

    @field_validator("matrix", mode="before")
    @classmethod
    def _read(cls, value: Any) -> MatrixRows:
        return _read_matrix(value, _STIFFNESSES)


class MatrixDamping(_Matrix):
    """A 5×5 damping over (x, y, z, tilt about x, tilt about y): N s/m, N s/rad and N m s/rad."""

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
        if isinstance(self.stiffness, RollingStiffness) and self.load is None and not self.stiffness.rolling.pressed:
            expected = "{ x, y, z }, the force of the shaft on it: a rolling bearing without preload has no stiffness"
            raise wrong(expected, "load")
        return self

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
