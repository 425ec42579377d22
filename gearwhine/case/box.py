"""The `[housing.box]` of a case: a closed box with walls and feet, in m.

Faces: left/right are x min/max, bottom/top y, back/front z. The origin is the middle of the box in x and z, the
underside of its base in y; feet reach below.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Discriminator, Tag

from gearwhine.case import units
from gearwhine.case.fields import PositiveLength, Quantity, Table

FACES = ("left", "right", "bottom", "top", "back", "front")
"""The outer faces of a box, by which supports may name them."""

FOOT_SURFACES = ("foot-1", "foot-2", "foot-3", "foot-4")
"""The undersides of a box's feet."""

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
    """Four blocks under the corners of a box; size along x, y, z [m]."""

    size: tuple[PositiveLength, PositiveLength, PositiveLength]


class Box(Table):
    """`[housing.box]`: a closed box by its outside size, walls, feet and element size, all in m."""

    size: tuple[BoxLength, BoxLength, BoxLength]
    wall: Annotated[
        Annotated[PositiveLength, Tag("~scalar")] | Annotated[Walls, Tag("~table")],
        Discriminator(_scalar_or_table),
    ]
    mesh_size: PositiveLength
    feet: Feet | None = None

    @property
    def walls(self) -> Walls:
        """The thickness of every wall, also where one number holds for all."""
        if isinstance(self.wall, Walls):
            return self.wall
        return Walls.model_construct(
            left=self.wall, right=self.wall, bottom=self.wall, top=self.wall, back=self.wall, front=self.wall
        )

    @property
    def lower(self) -> tuple[float, float, float]:
        """The corner of least x, y, z [m], without feet and bosses."""
        return (-self.size[0] / 2, 0.0, -self.size[2] / 2)

    @property
    def upper(self) -> tuple[float, float, float]:
        """The corner of greatest x, y, z [m], without feet and bosses."""
        return (self.size[0] / 2, self.size[1], self.size[2] / 2)
