"""Rolling bearing: rows of balls or rollers that share their rings, and arrangements of two rows.

The inner ring moves by q = (x, y, z, rotation about x, rotation about y) against the outer, taken at the bearing's
centre. A row's own direction is +1 where pushing the inner ring towards +z loads its contacts, −1 where −z does.
Where the outer ring turns with the shaft, as of a planet on its pin, q and the direction are the outer ring's. Against
it the inner ring moves by −q: elements are pressed opposite to the shaft's motion, and mirrored along z a pressed
element sees z − R (θ_x sin ψ − θ_y cos ψ), ψ the azimuth opposite to it. The pressure centre of a row lies on the side
of its inner ring's push, so that rows of the directions (1, −1) are face to face.
Double-row and paired bearings stand back to back, face to face or in tandem. A floating bearing has an outer ring that
slides in its seat along z, without friction: it takes the place at which the elements have no axial force.

Forces of the elements and the 5x5 bearing stiffness follow in :mod:`gearwhine.rotors.rolling_bearings.equilibrium`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal

from scipy.optimize import brentq

from gearwhine.rotors.errors import RotorError, require, require_finite
from gearwhine.rotors.rolling_bearings.ratings import Row, dynamic_rating
from gearwhine.rotors.rolling_bearings.roller_rows import SphericalRollerRow

_CLOSEST_ROW_DISTANCE = 0.7  # distance of two rows over the width of their elements, which may be staggered


@dataclass(frozen=True)
class RollingBearing:
    """A rolling bearing: one row or several that share their rings.

    Parameters
    ----------
    rows : sequence of Row
        Rows, at least one.
    axial_preload : float
        A constant force of a spring on the inner ring along z [N].
    name : str
        Name in messages.
    floating : bool
        Whether the outer ring slides freely in its seat along z; q is then the inner ring's displacement against the
        seat.
    catalogue_rating : float, optional
        Dynamic rating C by its maker [N]; by default that of its geometry by ISO 281.

    Raises
    ------
    RotorError
        No rows, rows that turn with different rings, a preload that is not finite, or one on rollers without flanges,
        which have no axial stiffness. A floating bearing with a preload, an axial offset of a single row, or rows that
        carry thrust one way only.
    """

    rows: Sequence[Row]
    axial_preload: float = 0.0
    name: str = "rolling bearing"
    floating: bool = False
    catalogue_rating: float | None = None

    def __post_init__(self) -> None:
        """Check for at least one row, and that a preloaded bearing has axial stiffness; keep a tuple."""
        object.__setattr__(self, "rows", tuple(self.rows))
        if not self.rows:
            raise RotorError(f"{self.name} has no rows; expected at least one")
        require_finite(f"axial preload of {self.name}", self.axial_preload)
        if self.catalogue_rating is not None:
            require_finite(f"dynamic rating of {self.name}", self.catalogue_rating, positive=True)
        turning = {"outer" if row.outer_turns else "inner" for row in self.rows}
        require(
            len(turning) == 1, f"rings of {self.name} that turn", sorted(turning), "one: its rows share their rings"
        )
        self._require_rows_apart()
        if self.floating:
            self._require_floats()
        is_opposed = self.axial_preload == 0.0 or self.has_axial_stiffness
        require(
            is_opposed,
            f"axial preload of {self.name}",
            self.axial_preload,
            "none: cylindrical rollers carry no axial load without flanges",
        )

    def _require_rows_apart(self) -> None:
        """Refuse rows whose elements stand in each other."""
        # Rows of spherical rollers are placed by their angle, on a sphere about one centre; two rows in one place are
        # two contacts of the same elements.
        placed = [row for row in self.rows if not isinstance(row, SphericalRollerRow)]
        for one, other in pairwise(sorted(placed, key=lambda row: row.position)):
            apart, least = other.position - one.position, _CLOSEST_ROW_DISTANCE * 0.5 * (one.width + other.width)
            expected = f"rows at least {least:.4g} m apart, whose elements do not overlap"
            require(apart == 0.0 or apart >= least, f"distance of two rows of {self.name}", apart, expected)

    def _require_floats(self) -> None:
        """Refuse a floating bearing that slides open, or whose preload its sliding ring does not hold."""
        carried = frozenset[int]().union(*(row.thrust_senses for row in self.rows))
        if len(carried) == 1:
            raise RotorError(
                f"{self.name} floats, and its rows carry thrust one way only: they slide open; expected rows that "
                "carry it both ways or not at all"
            )
        sliding = "none: the outer ring of a floating bearing slides and holds no axial force"
        require(self.axial_preload == 0.0, f"axial preload of {self.name}", self.axial_preload, sliding)
        if len(self.rows) == 1:
            offset = self.rows[0].axial_offset
            require(offset == 0.0, f"axial offset of {self.name}", offset, sliding)

    @property
    def estimated(self) -> bool:
        """Whether the inside of any row is an estimate."""
        return any(row.estimated for row in self.rows)

    @property
    def dynamic_rating(self) -> float:
        """Dynamic rating C [N]: by its maker, else of the geometry by ISO 281."""
        if self.catalogue_rating is not None:
            return self.catalogue_rating
        return dynamic_rating(self.rows[0], len(self.rows))

    @cached_property
    def force_scale(self) -> float:
        """E* D² of the smallest element, a force far above its capacity [N]."""
        return min(row.elasticity.contact_modulus * row.element_diameter**2 for row in self.rows)

    @property
    def envelope(self) -> tuple[float, float, float, float]:
        """Ends of the elements along z from the centre, and radii within and without which there are none [m]."""
        left = min(row.position - 0.5 * row.width for row in self.rows)
        right = max(row.position + 0.5 * row.width for row in self.rows)
        inner = min(row.pitch_diameter - row.element_diameter for row in self.rows)
        outer = max(row.pitch_diameter + row.element_diameter for row in self.rows)
        return left, right, 0.5 * inner, 0.5 * outer

    @cached_property
    def largest_element(self) -> float:
        """Largest diameter of an element [m]."""
        return max(row.element_diameter for row in self.rows)

    @property
    def has_axial_stiffness(self) -> bool:
        """Whether the bearing holds the shaft axially: any row carries an axial load, and it does not float."""
        return not self.floating and any(row.has_axial_stiffness for row in self.rows)

    @property
    def thrust_senses(self) -> frozenset[int]:
        """Senses of the shaft's axial force that it carries: 1 towards +z, −1 towards −z; none of a floating one."""
        if self.floating:
            return frozenset()
        return frozenset[int]().union(*(row.thrust_senses for row in self.rows))

    @property
    def is_preloaded(self) -> bool:
        """Whether a spring, or an offset of one row or of two opposed rows at assembly, loads the bearing along z."""
        return self.axial_preload != 0.0 or any(row.axial_offset != 0.0 for row in self.rows)

    @property
    def ring_offset(self) -> float:
        """Displacement of the inner ring along z at assembly, the mean of its rows', a preload against others [m].

        Equal offsets of two opposed rows, which press each other, have none.
        """
        return sum(row.direction * row.axial_offset for row in self.rows) / len(self.rows)

    @property
    def reach(self) -> float:
        """Half the largest pitch diameter, by which rotations are scaled to displacements of the contacts [m]."""
        return 0.5 * max(row.pitch_diameter for row in self.rows)


Arrangement = Literal["back to back", "face to face", "tandem"]

# Directions in which the left and the right row carry a push of the inner ring. Contact lines of (1, −1) run apart
# towards the axis: stiff against tilting.
_DIRECTIONS: dict[str, tuple[int, int]] = {"back to back": (1, -1), "face to face": (-1, 1), "tandem": (1, 1)}


def paired(
    row: Row, arrangement: Arrangement, spacing: float, *, preload: float = 0.0, name: str = "paired bearing"
) -> RollingBearing:
    """Two equal rows, on the same rings or on rings clamped together.

    Parameters
    ----------
    row : Row
        One of the two rows; its position and direction are replaced.
    arrangement : Arrangement
        ``"back to back"`` (O: contact lines meet the axis outside the pair), ``"face to face"`` (X: inside) or
        ``"tandem"`` (both carry loads towards +z).
    spacing : float
        Distance between the centres of the rows' balls [m].
    preload : float
        Axial force with which the rows press each other when nothing else loads them [N].

    Raises
    ------
    RotorError
        A spacing that is not positive, a negative preload, or a preload in tandem, where no row opposes it, or of rows
        without axial stiffness.
    """
    is_known = arrangement in _DIRECTIONS
    require(is_known, "arrangement", arrangement, f"one of {', '.join(map(repr, _DIRECTIONS))}")
    require_finite("spacing of the rows", spacing, positive=True)
    require_finite("preload of the rows", preload, minimum=0.0)
    left, right = _DIRECTIONS[arrangement]
    opposed = preload == 0.0 or left != right
    require(opposed, "preload of rows in tandem", preload, "none: give the bearing an axial_preload")
    if left != right and row.outer_turns:
        left, right = right, left
    offset = row.axial_offset if preload == 0.0 else preload_offset(row, preload)
    rows = (
        replace(row, position=-0.5 * spacing, direction=left, axial_offset=offset),
        replace(row, position=0.5 * spacing, direction=right, axial_offset=offset),
    )
    return RollingBearing(rows, name=name)


def preload_offset(row: Row, preload: float) -> float:
    """Axial offset [m] at which a centred row presses with the axial force ``preload`` [N] along its direction.

    The root e of the row's `axial_force`, which grows with e: of balls, with v = (A cos α − s/2, A sin α + e),
    Z K (|v| − A)^{3/2} sin α' = F, sin α' = v_z/|v|; of rollers Z c/n Σ_k δ_k^{10/9} sin α = F.

    Raises
    ------
    RotorError
        A preload that is not positive, or a row that carries no axial load.
    """
    require_finite("preload of a row", preload, positive=True)
    require(row.has_axial_stiffness, "preload of a row", preload, "none: its rollers carry no axial load")
    lowest, scale = row.slack_offset, 0.01 * row.element_diameter
    width = scale
    while row.axial_force(lowest + width) < preload:
        width *= 2.0
    return float(
        brentq(lambda e: row.axial_force(e) - preload, lowest, lowest + width, xtol=1e-14 * scale, rtol=8.9e-16)
    )
