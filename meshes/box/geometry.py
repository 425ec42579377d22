"""Box geometry of a welded or cast gearbox housing: walls, bores, bosses, feet, ribs, cover, fillets.

The box stands in the global frame with its shafts along z. The origin is the middle of the box in x and z and
the underside of its base in y; feet reach below y = 0.
"""

from dataclasses import dataclass, field
from typing import Literal

from gearwhine.meshes.box import layout
from gearwhine.meshes.box.fit import BoxMisfit, misfits
from gearwhine.meshes.box.parts import (
    FACES,
    FOOT_NAMES,
    OPPOSITE_FACES,
    Bolt,
    Bore,
    Cover,
    Feet,
    Fillets,
    Rib,
    WallThickness,
)
from gearwhine.meshes.errors import GeometryError


class BoxMisfitError(GeometryError):
    """Parts of a box do not fit each other.

    Attributes
    ----------
    misfits : tuple of BoxMisfit
        Everything that does not fit.
    """

    def __init__(self, all_misfits: tuple[BoxMisfit, ...]) -> None:
        self.misfits = all_misfits
        super().__init__("\n".join(str(misfit) for misfit in all_misfits))


@dataclass(frozen=True)
class BoxGeometry:
    """A closed box with walls, bores, feet, ribs, a cover and rounded edges.

    Attributes
    ----------
    size : tuple of float
        Outside lengths along x, y, z [m], without bosses, feet, outside ribs and flange.
    wall : WallThickness
        Thickness of each wall [m]; at the cover's face, the thickness of its plate.
    bores : tuple of Bore
    feet : Feet, optional
    ribs : tuple of Rib
    cover : Cover, optional
    fillets : Fillets

    Raises
    ------
    GeometryError
        Where a size is not positive, a boss is no wider than its bore, or a seat has the name of another surface.
    BoxMisfitError
        Where the parts do not fit each other, with everything that does not: walls that meet, feet that touch, bores
        that leave their wall or touch another, ribs, cover, fillets, bolt patches.
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
        for axis, length, (low, high) in zip("xyz", self.size, OPPOSITE_FACES, strict=True):
            sizes = length, self.wall.of(low), self.wall.of(high)
            if not all(value > 0.0 for value in sizes):
                raise GeometryError(
                    f"box along {axis}: size {length} m and walls {sizes[1]}, {sizes[2]} m must be positive"
                )
        if self.feet is not None and min(self.feet.size) <= 0.0:
            raise GeometryError(f"feet of {' x '.join(map(str, self.feet.size))} m: give positive sizes")
        for bore in self.bores:
            _check_sizes(bore)
        names = [bore.name for bore in self.bores]
        for name in names:
            if names.count(name) > 1:
                raise GeometryError(f"two seats are named {name!r}")
        problems = tuple(misfits(self))
        if problems:
            raise BoxMisfitError(problems)
        patches = {name for bolt in self.bolts for name in (bolt.cover_surface, bolt.body_surface)}
        taken = {*FACES, *FOOT_NAMES, *(f"{name}-bolt" for name in FOOT_NAMES), *patches}
        expected = "another name than that of a face or foot of the box, or of a patch under a bolt"
        named = (BoxMisfit(("bores", at, "name"), expected) for at, bore in enumerate(self.bores) if bore.name in taken)
        if problems := tuple(named):
            raise BoxMisfitError(problems)

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
        wall = layout.end_wall(self, bore)
        if wall is None:
            half = self.size[2] / 2
            raise GeometryError(
                f"seat {bore.name!r} at z = {bore.center[2]:g} m lies in neither end wall: the back wall spans "
                f"{-half:g} to {-half + self.wall.back:g} m, the front wall {half - self.wall.front:g} to {half:g} m"
            )
        return wall

    def bore_depth(self, bore: Bore) -> float:
        """Return the length of a bore through its wall and its boss [m]."""
        return self.wall.of(self.end_wall(bore)) + (bore.boss.length if bore.boss is not None else 0.0)

    def bore_span(self, bore: Bore) -> tuple[float, float]:
        """Return the ends of the bore's surface along z, boss included [m]."""
        half = self.size[2] / 2
        length = bore.boss.length if bore.boss else 0.0
        if self.end_wall(bore) == "back":
            return (-half - length, -half + self.wall.back)
        return (half - self.wall.front, half + length)


def _check_sizes(bore: Bore) -> None:
    """Raise where a bore or its boss has no sound size of its own."""
    if bore.diameter <= 0.0:
        raise GeometryError(f"seat {bore.name!r}: diameter {bore.diameter} m must be positive")
    if bore.boss is not None and (bore.boss.diameter <= bore.diameter or bore.boss.length <= 0.0):
        raise GeometryError(
            f"seat {bore.name!r}: a boss of {bore.boss.diameter} m diameter and {bore.boss.length} m length "
            f"needs a positive length and more than the bore's {bore.diameter} m"
        )
