"""Axial location of shafts: which bearing takes thrust towards +z and -z, O and X arrangement, rows against each other.

A single row with a contact angle carries thrust in one sense alone. Two such rows locate a shaft if they carry opposite
senses: back to back (O) where the left one carries the shaft's force towards +z and the right one that towards -z, so
that the contact lines run apart towards the axis; face to face (X) the other way round (ISO 5593). Where their outer
rings turn with the shaft, as in a planet, it is X that carries so, and O the other way round. An axial offset of
their rings at assembly presses them against each other, a rigid preload. A spring's force on the shaft presses only the
row that carries it. A floating bearing carries no thrust; where two ball bearings carry it both ways, how they share it
depends on the place of their rings at assembly.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.rotors.rolling_bearings import BallRow, RollingBearing, Row, SphericalRollerRow

_BOTH = frozenset((1, -1))


@dataclass(frozen=True)
class AxialSupport:
    """Axial support of a shaft by a bearing.

    Attributes
    ----------
    name : str
    at : float
        Station from the shaft's left end [m].
    senses : frozenset of int
        Senses of the shaft's axial force that the bearing carries: 1 towards +z, -1 towards -z.
    rolling : RollingBearing or None
        Rolling bearing that is described by its elements.
    """

    name: str
    at: float
    senses: frozenset[int]
    rolling: RollingBearing | None = None

    @property
    def is_single(self) -> bool:
        """Whether it carries thrust in one sense alone."""
        return len(self.senses) == 1

    @property
    def inner_senses(self) -> frozenset[int]:
        """Senses of the inner ring's force that it carries: the opposite ones where the outer ring turns."""
        turned = self.rolling is not None and self.rolling.rows[0].outer_turns
        return frozenset(-sense if turned else sense for sense in self.senses)

    @property
    def arrangement(self) -> Literal["O", "X"] | None:
        """Arrangement of two rows within the bearing, one for each sense; None for other bearings."""
        rows = () if self.rolling is None else sorted(self.rolling.rows, key=lambda row: row.position)
        if len(rows) != 2 or rows[0].position == rows[1].position or _spherical(rows[0]):
            return None
        return {(1, -1): "O", (-1, 1): "X"}.get((rows[0].inner_direction, rows[1].inner_direction))  # type: ignore[return-value]

    @property
    def has_balls(self) -> bool:
        """Whether it is a ball bearing that is described by its elements."""
        return self.rolling is not None and isinstance(self.rolling.rows[0], BallRow)

    @property
    def is_set(self) -> bool:
        """Whether an axial offset of its inner ring, or a spring, sets it against other bearings at assembly."""
        return self.rolling is not None and (self.spring != 0.0 or self.rolling.ring_offset != 0.0)

    @property
    def spring(self) -> float:
        """Force of the bearing's spring on the shaft along z [N]."""
        return 0.0 if self.rolling is None else self.rolling.axial_preload


def axial_support(mounted: MountedBearing) -> AxialSupport:
    """Axial support by a mounted bearing: by its elements, else by its stiffness k_zz, at all speeds of its table."""
    elements, bearing = mounted.elements, mounted.bearing
    if elements is not None:
        return AxialSupport(bearing.name, bearing.at, elements.thrust_senses, elements)
    has_stiffness = bearing.stiffness.shape[-1] == 5 and bool((bearing.stiffness[..., 2, 2] > 0.0).all())
    return AxialSupport(bearing.name, bearing.at, _BOTH if has_stiffness else frozenset())


@dataclass(frozen=True)
class AxialLocation:
    """Axial location of a shaft.

    Attributes
    ----------
    shaft : str
    bearings : sequence of AxialSupport
        All bearings of the shaft; sorted from left to right.
    """

    shaft: str
    bearings: Sequence[AxialSupport]

    def __post_init__(self) -> None:
        """Keep the bearings from left to right."""
        object.__setattr__(self, "bearings", tuple(sorted(self.bearings, key=lambda one: one.at)))

    def carrying(self, sense: int) -> tuple[str, ...]:
        """Names of the bearings that carry the shaft's thrust towards +z (1) or -z (-1), from left to right."""
        return tuple(bearing.name for bearing in self.bearings if sense in bearing.senses)

    @property
    def is_located(self) -> bool:
        """Whether thrust is carried in both senses."""
        return bool(self.carrying(1) and self.carrying(-1))

    @cached_property
    def arrangement(self) -> Literal["O", "X"] | None:
        """O (back to back) or X (face to face) of bearings that carry one sense each; None where some carry both."""
        carried = [bearing for bearing in self.bearings if bearing.senses]
        if not self.is_located or not all(bearing.is_single for bearing in carried):
            return None
        plus, minus = ([bearing.at for bearing in carried if sense in bearing.inner_senses] for sense in (1, -1))
        if max(plus) < min(minus):
            return "O"
        return "X" if max(minus) < min(plus) else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on the rows that carry thrust.

        They concern rows that all carry thrust one way, springs that do not press rows against each other, and ball
        bearings that share thrust both ways.
        """
        return (*self._one_way(), *self._springs(), *self._shared())

    def _shared(self) -> tuple[str, ...]:
        """Ball bearings that locate the shaft both ways side by side, none of them offset or sprung at assembly."""
        sharing = [bearing for bearing in self.bearings if bearing.senses == _BOTH and bearing.has_balls]
        if len(sharing) < 2 or any(bearing.is_set for bearing in self.bearings):
            return ()
        names = _listed([bearing.name for bearing in sharing])
        return (
            f"shaft {self.shaft!r} is located both ways by {names}: how they share its thrust is statically "
            "indeterminate, and depends on where their rings are at assembly; give all but one of them "
            "`floating = true` where its outer ring slides in its seat, or an `axial_offset` where they are set "
            "against each other",
        )

    def _one_way(self) -> tuple[str, ...]:
        for sense in (1, -1):
            names = self.carrying(sense)
            if names and not self.carrying(-sense):
                way, other = _along(sense), _along(-sense)
                verb = {1: "carries", 2: "both carry"}.get(len(names), "all carry")
                return (
                    f"shaft {self.shaft!r} is located one way only: {_listed(names)} {verb} its thrust towards {way}, "
                    f"and no bearing carries it towards {other}; turn one round (`carries`), or add a bearing that "
                    f"carries thrust towards {other}",
                )
        return ()

    def _springs(self) -> tuple[str, ...]:
        """Springs of bearings that another bearing of the shaft opposes or shares."""
        sprung = [bearing for bearing in self.bearings if bearing.spring != 0.0]
        if len({bearing.spring > 0.0 for bearing in sprung}) == 2:
            names = _listed([bearing.name for bearing in sprung])
            forces = " and ".join(f"{abs(bearing.spring):.4g} N towards {_along(bearing.spring)}" for bearing in sprung)
            left = abs(sum(bearing.spring for bearing in sprung))
            effect = "cancel and press no element" if left == 0.0 else f"leave {left:.4g} N, which presses one way only"
            return (
                f"shaft {self.shaft!r}: the `preload` of {names} is a spring's force on the shaft each, and "
                f"{forces} {effect}; {_RIGID_PRELOAD_ADVICE}",
            )
        warnings = []
        for bearing in sprung:
            others = [other.name for other in self.bearings if other.senses and other is not bearing]
            if others:
                warnings.append(
                    f"shaft {self.shaft!r}: the `preload` of {bearing.name!r} is a spring's force on the shaft, "
                    f"{abs(bearing.spring):.4g} N towards {_along(bearing.spring)}, which moves it in "
                    f"{_listed(others)} as well: it does not press them against each other; {_RIGID_PRELOAD_ADVICE}"
                )
        return tuple(warnings)


ARRANGEMENTS = {"O": "back to back", "X": "face to face"}
"""Names of the arrangements (ISO 5593)."""

_RIGID_PRELOAD_ADVICE = (
    "a rigid preload of rows against each other is `axial_offset`, how far an inner ring is moved along `carries` at "
    "assembly: `load` with a torque of 0 finds the force that follows"
)


def _spherical(row: Row) -> bool:
    return isinstance(row, SphericalRollerRow) or (isinstance(row, BallRow) and row.self_aligning)


def _along(sense: float) -> str:
    return "+z" if sense > 0.0 else "-z"


def _listed(names: Sequence[str]) -> str:
    shown = [repr(name) for name in names]
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"
