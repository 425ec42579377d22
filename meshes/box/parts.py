"""Parts of a box housing: walls, bores, bosses, feet, ribs, flange, cover, bolts and fillets, dimensions in m.

Faces: left/right are x min/max, bottom/top y, back/front z.
"""

from dataclasses import dataclass
from typing import Literal, Protocol

Face = Literal["left", "right", "bottom", "top", "back", "front"]
Axis = Literal["x", "y", "z"]
Side = Literal["outside", "inside"]
Point = tuple[float, float, float]

# For each face: the axis that it is normal to, and the sign of its outward normal.
FACES: dict[Face, tuple[int, int]] = {
    "left": (0, -1),
    "right": (0, 1),
    "bottom": (1, -1),
    "top": (1, 1),
    "back": (2, -1),
    "front": (2, 1),
}
# Opposite faces along x, y and z, the lower first.
OPPOSITE_FACES: tuple[tuple[Face, Face], ...] = (("left", "right"), ("bottom", "top"), ("back", "front"))
FOOT_NAMES = ("foot-1", "foot-2", "foot-3", "foot-4")


def plane_axes(face: Face) -> tuple[int, int]:
    """Return the two axes in the plane of a face, in the order x, y, z."""
    normal, _ = FACES[face]
    first, second = (axis for axis in range(3) if axis != normal)
    return first, second


@dataclass(frozen=True)
class WallThickness:
    """Thickness of each wall [m]: left/right are x min/max, bottom/top y, back/front z."""

    left: float
    right: float
    bottom: float
    top: float
    back: float
    front: float

    @classmethod
    def uniform(cls, thickness: float) -> "WallThickness":
        """Make walls of the same thickness [m] all round."""
        return cls(thickness, thickness, thickness, thickness, thickness, thickness)

    def of(self, face: Face) -> float:
        """Thickness of the wall of a face [m]."""
        return float(getattr(self, face))


@dataclass(frozen=True)
class Boss:
    """A cylinder on the outside of the wall, concentric with the bore: diameter and length [m]."""

    diameter: float
    length: float


@dataclass(frozen=True)
class Bore:
    """A bearing's bore through the front or the back wall.

    Attributes
    ----------
    name : str
        The name of its surface in the mesh.
    center : tuple of float
        A point of its axis [m]; its z selects the wall.
    diameter : float
        Diameter [m].
    boss : Boss, optional
        Material around the bore on the outside of the wall.
    """

    name: str
    center: Point
    diameter: float
    boss: Boss | None = None


@dataclass(frozen=True)
class Feet:
    """Four blocks under the corners, flush with the walls. Undersides: foot-1 … foot-4.

    Attributes
    ----------
    size : tuple of float
        Lengths along x, y, z [m].
    bolt_patch : float, optional
        Diameter [m] of a circle in the middle of each underside, where its bolt clamps: foot-1-bolt … foot-4-bolt.
    """

    size: tuple[float, float, float]
    bolt_patch: float | None = None


@dataclass(frozen=True)
class Rib:
    """A straight rib, standing at right angles on a wall.

    Attributes
    ----------
    face : str
        The wall it stands on.
    along : {"x", "y", "z"}
        Axis along which it runs, one of the wall's own two.
    at : float
        Position of its middle plane along the other axis [m].
    height, thickness : float
        Height above the wall and thickness [m].
    side : {"outside", "inside"}
    start, end : float, optional
        Ends of the rib along its axis [m]; by default it runs the whole length of the wall.
    """

    face: Face
    along: Axis
    at: float
    height: float
    thickness: float
    side: Side = "outside"
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True)
class Flange:
    """A frame that widens the rim under a cover: width beyond the walls, and thickness [m]."""

    width: float
    thickness: float
    side: Side = "outside"


@dataclass(frozen=True)
class CoverBolts:
    """The bolts of a cover: an even row along each edge, or each at its own place.

    Attributes
    ----------
    diameter : float
        Nominal diameter of the thread [m].
    per_edge : tuple of int, optional
        Number along each of the two axes of the cover's plane (in the order x, y, z), corners counted with both, on
        the middle line of the rim.
    positions : tuple of (float, float)
        Places along those two axes [m], where not in rows.
    patch_diameter : float, optional
        Diameter of the circle in which cover and body are pressed together [m]; by default twice the bolt's.
    grip : float, optional
        Length of bolt between head and thread [m]. By default that of a screw in a tapped rim: the cover, and half
        the rim's depth or half the bolt's diameter, whichever is less (Shigley, Table 8-7).
    """

    diameter: float
    per_edge: tuple[int, int] | None = None
    positions: tuple[tuple[float, float], ...] = ()
    patch_diameter: float | None = None
    grip: float | None = None


@dataclass(frozen=True)
class Cover:
    """The wall of one face as a plate of its own, lying on the rim of the other walls.

    Attributes
    ----------
    face : str
        The wall, whose thickness is that of the plate.
    flange : Flange, optional
        Rim; by default as wide as the walls are thick.
    bolts : CoverBolts, optional
        Bolts that hold the plate on the body; needed unless bonded.
    bonded : bool
        The plate shares its nodes with the rim, as if glued all round.
    """

    face: Face
    flange: Flange | None = None
    bolts: CoverBolts | None = None
    bonded: bool = False


@dataclass(frozen=True)
class Fillets:
    """Radii [m] of the edges of the cavity (inside) and of the outer box (outside); 0 leaves them sharp.

    Where the box has a cover, the edges around that face stay sharp.
    """

    inside: float = 0.0
    outside: float = 0.0


@dataclass(frozen=True)
class Bolt:
    """A bolt of a cover, placed.

    Attributes
    ----------
    name : str
        ``bolt-1`` and so on. The mesh's surfaces of its patches are ``bolt-1-cover`` and ``bolt-1-body``.
    position : tuple of float
        Middle of the bolt in the plane between cover and body [m].
    axis : tuple of float
        Unit vector from the body to the cover.
    diameter, grip, patch_diameter : float
        Lengths of :class:`CoverBolts`, defaults resolved [m].
    cover_thickness : float
        Thickness of the cover [m].
    """

    name: str
    position: Point
    axis: Point
    diameter: float
    grip: float
    patch_diameter: float
    cover_thickness: float

    @property
    def cover_grip(self) -> float:
        """Part of the grip in the cover [m]: its thickness, or half the grip where that is no longer (a sunk head)."""
        return self.cover_thickness if self.grip > self.cover_thickness else self.grip / 2.0

    @property
    def cover_surface(self) -> str:
        """Name of its patch on the underside of the cover."""
        return f"{self.name}-cover"

    @property
    def body_surface(self) -> str:
        """Name of its patch on the body's rim."""
        return f"{self.name}-body"


class Box(Protocol):
    """A box by its parts, as `gearwhine.meshes.BoxGeometry` has them; layout and checks are derived from it."""

    @property
    def size(self) -> Point:
        """Outside lengths along x, y, z [m]."""
        ...

    @property
    def wall(self) -> WallThickness:
        """Thickness of every wall [m]."""
        ...

    @property
    def bores(self) -> tuple[Bore, ...]:
        """Bores through the end walls."""
        ...

    @property
    def feet(self) -> Feet | None:
        """Feet under the base."""
        ...

    @property
    def ribs(self) -> tuple[Rib, ...]:
        """Ribs on the walls."""
        ...

    @property
    def cover(self) -> Cover | None:
        """Cover of one face."""
        ...

    @property
    def fillets(self) -> Fillets:
        """Fillets of the edges."""
        ...

    @property
    def bolts(self) -> tuple[Bolt, ...]:
        """Bolts of the cover."""
        ...

    def end_wall(self, bore: Bore) -> Literal["back", "front"]:
        """Return the end wall that a bore goes through."""
        ...

    def bore_span(self, bore: Bore) -> tuple[float, float]:
        """Return the ends of the bore's surface along z, boss included [m]."""
        ...
