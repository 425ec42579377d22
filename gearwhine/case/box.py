"""Box housing of a case, `[housing.box]`: walls, feet, ribs, a cover and rounded edges, in m.

Faces: left/right are x min/max, bottom/top y, back/front z. The origin is the middle of the box in x and z, the
underside of its base in y; feet reach below.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictBool, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import Length, LengthFromZero, Name, PositiveLength, Quantity, Table, Whole, wrong

Face = Literal["left", "right", "bottom", "top", "back", "front"]

FACES: tuple[Face, ...] = ("left", "right", "bottom", "top", "back", "front")
"""The outer faces of a box, by which supports may name them."""

FOOT_SURFACES = ("foot-1", "foot-2", "foot-3", "foot-4")
"""The undersides of a box's feet."""

MOST_PARTS = 200
"""Most ribs, and most bolts, of a box."""

BoxLength = Annotated[float, Quantity(units.LENGTH, at_least=1e-3, at_most=20.0)]


def _scalar_or_table(value: Any) -> str:
    return "~table" if isinstance(value, (dict, Table)) else "~scalar"


class Walls(Table):
    """Wall thicknesses face by face [m]."""

    left: PositiveLength
    right: PositiveLength
    bottom: PositiveLength
    top: PositiveLength
    back: PositiveLength
    front: PositiveLength


class Feet(Table):
    """Four blocks under the corners of a box; size along x, y, z, and the diameter of their bolts' circles [m]."""

    size: tuple[PositiveLength, PositiveLength, PositiveLength]
    bolt_patch: PositiveLength | None = None


class Rib(Table):
    """A straight rib on a wall: where it runs, where its middle plane lies, how high and thick it is [m].

    `start` and `end`, in the file `from` and `to`, lie along its axis; by default it runs the length of the wall.
    """

    face: Face
    along: Literal["x", "y", "z"]
    at: Length
    height: PositiveLength
    thickness: PositiveLength
    side: Literal["outside", "inside"] = "outside"
    start: Length | None = Field(default=None, alias="from")
    end: Length | None = Field(default=None, alias="to")


class Flange(Table):
    """A frame that widens the rim under a cover: how far it stands off the walls, how thick it is [m]."""

    width: PositiveLength
    thickness: PositiveLength
    side: Literal["outside", "inside"] = "outside"


class CoverBolts(Table):
    """The bolts of a cover [m]: `per_edge`, even rows with the corners counted in both, or `positions`.

    `grip` is the length between head and thread, `patch_diameter` the circle that each presses together; `material`
    is that of the bolts, by default the housing's.
    """

    diameter: PositiveLength
    per_edge: tuple[Annotated[int, Whole(2, MOST_PARTS)], Annotated[int, Whole(2, MOST_PARTS)]] | None = None
    positions: tuple[tuple[Length, Length], ...] = Field(default=(), max_length=MOST_PARTS)
    patch_diameter: PositiveLength | None = None
    grip: PositiveLength | None = None
    material: Name | None = None


class Cover(Table):
    """The wall of one face as a plate of its own; its thickness [m] is by default the wall's."""

    face: Face
    thickness: PositiveLength | None = None
    flange: Flange | None = None
    bolts: CoverBolts | None = None
    bonded: StrictBool = False

    @model_validator(mode="after")
    def _fastened(self) -> Cover:
        if self.bolts is None and not self.bonded:
            raise wrong("'bolts', such as { diameter = '8 mm', per_edge = [3, 4] }, or bonded = true")
        return self


class Fillets(Table):
    """Radii of the edges of the cavity and of the outer box [m]; those around a cover stay sharp."""

    inside: LengthFromZero = 0.0
    outside: LengthFromZero = 0.0


class Box(Table):
    """`[housing.box]`: a closed box by its outside size, walls, element size and parts, all in m."""

    size: tuple[BoxLength, BoxLength, BoxLength]
    wall: Annotated[
        Annotated[PositiveLength, Tag("~scalar")] | Annotated[Walls, Tag("~table")],
        Discriminator(_scalar_or_table),
    ]
    mesh_size: PositiveLength
    feet: Feet | None = None
    ribs: tuple[Rib, ...] = Field(default=(), max_length=MOST_PARTS)
    cover: Cover | None = None
    fillets: Fillets = Fillets()

    @property
    def walls(self) -> Walls:
        """The thickness of every wall, also where one number holds for all; the cover's own in its place."""
        if isinstance(self.wall, Walls):
            thickness = {face: getattr(self.wall, face) for face in FACES}
        else:
            thickness = dict.fromkeys(FACES, self.wall)
        if self.cover is not None and self.cover.thickness is not None:
            thickness[self.cover.face] = self.cover.thickness
        return Walls.model_construct(**thickness)

    @property
    def lower(self) -> tuple[float, float, float]:
        """The corner of least x, y, z [m], without feet, bosses, ribs and flange."""
        return (-self.size[0] / 2, 0.0, -self.size[2] / 2)

    @property
    def upper(self) -> tuple[float, float, float]:
        """The corner of greatest x, y, z [m], without feet, bosses, ribs and flange."""
        return (self.size[0] / 2, self.size[1], self.size[2] / 2)

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of its surfaces, bores left out."""
        feet = () if self.feet is None else FOOT_SURFACES
        patches = tuple(f"{foot}-bolt" for foot in feet) if self.feet and self.feet.bolt_patch is not None else ()
        bolts = 0
        if self.cover is not None and self.cover.bolts is not None and not self.cover.bonded:
            along, across = self.cover.bolts.per_edge or (2, 2)
            bolts = len(self.cover.bolts.positions) or 2 * (along + across) - 4
        sides = tuple(f"bolt-{number}-{part}" for number in range(1, bolts + 1) for part in ("cover", "body"))
        return (*FACES, *feet, *patches, *sides)

    @property
    def stands_out(self) -> float:
        """How far the highest outside rib or flange stands out of the walls [m]."""
        heights = [rib.height for rib in self.ribs if rib.side == "outside"]
        if self.cover is not None and self.cover.flange is not None and self.cover.flange.side == "outside":
            heights.append(self.cover.flange.width)
        return max(heights, default=0.0)

    @property
    def furnished(self) -> bool:
        """Whether anything but walls lies inside."""
        flange = self.cover.flange if self.cover is not None else None
        ribs = any(rib.side == "inside" for rib in self.ribs)
        return ribs or self.fillets.inside > 0.0 or (flange is not None and flange.side == "inside")
