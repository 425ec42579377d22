"""Box geometry of a welded or cast gearbox housing: walls, bores, bosses, feet, ribs, cover, fillets.

The box stands in the global frame with its shafts along z. The origin is the middle of the box in x and z and
the underside of its base in y; feet reach below y = 0.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from meshes.box import layout
from meshes.box.fit import misfits
from meshes.box.misfit import Misfit
from meshes.box.parts import FACES, FOOT_NAMES, Bolt, Bore, Cover, Feet, Fillets, Rib, WallThickness
from meshes.errors import GeometryError


class BoxMisfitError(GeometryError):
    """Parts of a box do not fit each other.

    Attributes
    ----------
    misfits : tuple of Misfit
        Everything that does not fit.
    """

    def __init__(self, found: tuple[Misfit, ...]) -> None:
        self.misfits = found
        super().__init__("\n".join(str(misfit) for misfit in found))


@dataclass(frozen=True)
class BoxGeometry:
    """A closed box with walls, bores, feet, ribs, a cover and rounded edges.

    Attributes
    ----------
    size : tuple of float
        Outside lengths along x, y, z [m], without bosses, feet, outside ribs and flange.
    wall : WallThickness
        [m]; that of the cover's face is the thickness of its plate.
    bores : tuple of Bore
    feet : Feet, optional
    ribs : tuple of Rib
    cover : Cover, optional
    fillets : Fillets

    Raises
    ------
    GeometryError
        Where the walls meet, a bore leaves its wall, touches another, or lies in neither end wall.
    BoxMisfitError
        Where ribs, cover, fillets or bolt patches do not fit; it carries all the misfits.
    """

    size: tuple[float, float, float]
    wall: WallThickness
    bores: tuple[Bore, ...] = ()
    feet: Feet | None = None
    ribs: tuple[Rib, ...] = ()
    cover: Cover | None = None
    fillets: Fillets = field(default_factory=Fillets)

    def __post_init__(self) -> None:
        """Check the dimensions, and that the parts fit the box."""
        wall = self.wall
        pairs = ((wall.left, wall.right), (wall.bottom, wall.top), (wall.back, wall.front))
        for axis, length, (low, high) in zip("xyz", self.size, pairs, strict=True):
            if not all(value > 0.0 for value in (length, low, high)):
                raise GeometryError(f"box along {axis}: size {length} m and walls {low}, {high} m must be positive")
            if low + high >= length:
                raise GeometryError(f"walls of {low} m and {high} m leave no room in a box {length} m along {axis}")
        if self.feet is not None:
            width, height, depth = self.feet.size
            base = layout.body_block(self).size
            # Feet that touch would melt into one, and their undersides with them.
            if min(self.feet.size) <= 0.0 or 2 * width >= base[0] or 2 * depth >= base[2]:
                raise GeometryError(
                    f"feet of {width} x {height} x {depth} m do not fit under a base of "
                    f"{base[0]} x {base[2]} m: give positive sizes, less than half the base each"
                )
        for bore in self.bores:
            self._check_bore(bore)
        for i, first in enumerate(self.bores):
            for second in self.bores[i + 1 :]:
                self._check_apart(first, second)
        found = tuple(misfits(self))
        if found:
            raise BoxMisfitError(found)
        patches = {name for bolt in self.bolts for name in (bolt.cover_surface, bolt.body_surface)}
        for bore in self.bores:
            if bore.name in {*FACES, *FOOT_NAMES, *(f"{name}-bolt" for name in FOOT_NAMES), *patches}:
                raise GeometryError(f"a seat cannot be named {bore.name!r}, which is a surface of the box itself")

    @property
    def bolts(self) -> tuple[Bolt, ...]:
        """The bolts that tie the cover to the body, with their places and the names of their patches."""
        return layout.cover_bolts(self)

    @property
    def rim_width(self) -> float:
        """Width of the rim under the cover where it is narrowest [m]; 0 without a cover."""
        return 0.0 if self.cover is None else layout.rim_width(self, self.cover)

    def end_wall(self, bore: Bore) -> Literal["back", "front"]:
        """Return the end wall that a bore goes through.

        Raises
        ------
        GeometryError
            Where the bore's centre lies in neither the back nor the front wall.
        """
        half = self.size[2] / 2
        slack = 1e-9 + 1e-6 * half
        for name, start, thickness in (
            ("back", -half, self.wall.back),
            ("front", half - self.wall.front, self.wall.front),
        ):
            if start - slack <= bore.center[2] <= start + thickness + slack:
                return "back" if name == "back" else "front"
        raise GeometryError(
            f"seat {bore.name!r} at z = {bore.center[2]:g} m lies in neither end wall: the back wall spans "
            f"{-half:g} to {-half + self.wall.back:g} m, the front wall {half - self.wall.front:g} to {half:g} m"
        )

    def bore_span(self, bore: Bore) -> tuple[float, float]:
        """Return the ends of the bore's surface along z, boss included [m]."""
        half = self.size[2] / 2
        length = bore.boss.length if bore.boss else 0.0
        if self.end_wall(bore) == "back":
            return (-half - length, -half + self.wall.back)
        return (half - self.wall.front, half + length)

    @property
    def inside_height(self) -> tuple[float, float]:
        """Ends of the cavity along y [m]."""
        return (self.wall.bottom, self.size[1] - self.wall.top)

    def _check_bore(self, bore: Bore) -> None:
        self.end_wall(bore)
        if bore.diameter <= 0.0:
            raise GeometryError(f"seat {bore.name!r}: diameter {bore.diameter} m must be positive")
        radius = bore.diameter / 2
        if bore.boss is not None:
            if bore.boss.diameter <= bore.diameter or bore.boss.length <= 0.0:
                raise GeometryError(
                    f"seat {bore.name!r}: a boss of {bore.boss.diameter} m diameter and {bore.boss.length} m length "
                    f"needs a positive length and more than the bore's {bore.diameter} m"
                )
            radius = bore.boss.diameter / 2
        x, y, _ = bore.center
        if abs(x) + radius > self.size[0] / 2 or y - radius < 0.0 or y + radius > self.size[1]:
            raise GeometryError(
                f"seat {bore.name!r}: a circle of radius {radius:g} m around x = {x:g}, y = {y:g} m leaves "
                f"its wall of {self.size[0]:g} x {self.size[1]:g} m"
            )

    def _check_apart(self, first: Bore, second: Bore) -> None:
        if first.name == second.name:
            raise GeometryError(f"two seats are named {first.name!r}")
        if self.end_wall(first) != self.end_wall(second):
            return
        distance = float(np.hypot(first.center[0] - second.center[0], first.center[1] - second.center[1]))
        # A bore may touch a neighbour's boss no more than its bore: both would break the cylinder.
        for bore, other in ((first, second), (second, first)):
            reach = bore.diameter / 2 + (other.boss.diameter if other.boss else other.diameter) / 2
            if distance <= reach:
                raise GeometryError(
                    f"seats {first.name!r} and {second.name!r} overlap: centres {distance:g} m apart, "
                    f"more than {reach:g} m needed"
                )
