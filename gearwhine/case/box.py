"""Box housing of a case, `[housing.box]`: walls, feet, ribs, a cover and rounded edges, in m.

Faces: left/right are x min/max, bottom/top y, back/front z. The origin is the middle of the box in x and z, the
underside of its base in y; feet reach below.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, Tag, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    Length,
    LengthFromZero,
    MaterialName,
    PositiveLength,
    Quantity,
    Table,
    Whole,
    by_table,
    wrong,
)

Face = Literal["left", "right", "bottom", "top", "back", "front"]

FACES: tuple[Face, ...] = ("left", "right", "bottom", "top", "back", "front")
"""The outer faces of a box, by which supports may name them."""

FOOT_SURFACES = ("foot-1", "foot-2", "foot-3", "foot-4")
"""The undersides of a box's feet."""

MOST_PARTS = 200
"""Most ribs, and most bolts, of a box."""

BoxLength = Annotated[float, Quantity(units.LENGTH, at_least=1e-3, at_most=20.0)]


def wall_by_face(wall: Any) -> dict[str, Any]:
    """Return a wall thickness, as written, face by face; one number stands for all."""
    return dict(wall) if isinstance(wall, Mapping) else dict.fromkeys(FACES, wall)


class Walls(Table):
    """Wall thicknesses face by face [m]."""

    left: PositiveLength
    """Thickness of the left wall (x min)."""
    right: PositiveLength
    """Thickness of the right wall (x max)."""
    bottom: PositiveLength
    """Thickness of the bottom wall (y min)."""
    top: PositiveLength
    """Thickness of the top wall (y max)."""
    back: PositiveLength
    """Thickness of the back wall (z min)."""
    front: PositiveLength
    """Thickness of the front wall (z max)."""


class Feet(Table):
    """Four blocks under the corners of a box; size along x, y, z, and the diameter of their bolts' circles [m]."""

    size: tuple[PositiveLength, PositiveLength, PositiveLength]
    """Size of each block along x, y, z."""
    bolt_patch: PositiveLength | None = None
    """Diameter of the circle that each bolt clamps on the underside; names the surfaces `foot-1-bolt` to `foot-4-bolt`.
    Default: no such surfaces."""


class Rib(Table):
    """A straight rib on a wall: where it runs, where its middle plane lies, how high and thick it is [m]."""

    face: Face
    """Wall that the rib stands on."""
    along: Literal["x", "y", "z"]
    """Axis that it runs along."""
    at: Length
    """Coordinate of its middle plane."""
    height: PositiveLength
    """Height above the wall."""
    thickness: PositiveLength
    """Thickness."""
    side: Literal["outside", "inside"] = "outside"
    """Side of the wall that it stands on."""
    start: Length | None = Field(default=None, alias="from")
    """Beginning along its axis. Default: that of the wall."""
    end: Length | None = Field(default=None, alias="to")
    """End along its axis. Default: that of the wall."""


class Flange(Table):
    """A frame that widens the rim under a cover: how far it stands off the walls, how thick it is [m]."""

    width: PositiveLength
    """Distance that it stands off the walls."""
    thickness: PositiveLength
    """Thickness."""
    side: Literal["outside", "inside"] = "outside"
    """Side of the walls that it stands on."""


class CoverBolts(Table):
    """The bolts of a cover [m]: `per_edge`, even rows with the corners counted in both, or `positions`."""

    diameter: PositiveLength
    """Nominal diameter of the thread."""
    per_edge: tuple[Annotated[int, Whole(2, MOST_PARTS)], Annotated[int, Whole(2, MOST_PARTS)]] | None = None
    """Number of bolts along the two edges of the plane, the corners counted in both. One of this and `positions`."""
    positions: tuple[tuple[Length, Length], ...] = Field(default=(), max_length=MOST_PARTS)
    """Points of the plane in which the bolts stand. One of this and `per_edge`."""
    patch_diameter: PositiveLength | None = None
    """Diameter of the circle that each bolt clamps. Default: twice the diameter."""
    grip: PositiveLength | None = None
    """Length between head and thread. Default: the thickness of cover and flange."""
    material: MaterialName | None = None
    """Material of the bolts. Default: that of the housing."""


class Cover(Table):
    """The wall of one face as a plate of its own; its thickness [m] is by default the wall's."""

    face: Face
    """Face whose wall is the cover."""
    thickness: PositiveLength | None = None
    """Thickness of the plate. Default: that of the wall."""
    flange: Flange | None = None
    """Frame that widens the rim under the cover."""
    bolts: CoverBolts | None = None
    """Bolts of the cover; needed unless `bonded`. They clamp what `[[housing.region]]` says of the materials there."""
    bonded: StrictBool = False
    """Cover and rim share their nodes, in place of bolts."""

    @model_validator(mode="after")
    def _fastened(self) -> Cover:
        if self.bolts is None and not self.bonded:
            raise wrong("'bolts', such as { diameter = '8 mm', per_edge = [3, 4] }, or bonded = true")
        return self


class Fillets(Table):
    """Radii of the edges of the cavity and of the outer box [m]; those around a cover stay sharp."""

    inside: LengthFromZero = 0.0
    """Radius of the edges of the cavity."""
    outside: LengthFromZero = 0.0
    """Radius of the outer edges."""


class Box(Table):
    """`[housing.box]`: a closed box by its outside size, walls, element size and parts, all in m."""

    size: tuple[BoxLength, BoxLength, BoxLength]
    """Outside size along x, y, z."""
    wall: Annotated[
        Annotated[PositiveLength, Tag("~scalar")] | Annotated[Walls, Tag("~table")],
        by_table("~scalar"),
    ]
    """Wall thickness: one for all walls, or one for each face."""
    mesh_size: PositiveLength | None = None
    """Edge length of the elements. One of this and the housing's `accuracy`."""
    feet: Feet | None = None
    """Four blocks under the corners."""
    ribs: tuple[Rib, ...] = Field(default=(), max_length=MOST_PARTS)
    """Ribs on the walls."""
    cover: Cover | None = None
    """The wall of one face as a plate of its own."""
    fillets: Fillets = Fillets()
    """Radii of the edges; those around a cover stay sharp."""

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
        """Height of the highest outside rib or flange over the walls [m]."""
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
