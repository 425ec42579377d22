"""Planets of a set made of one: shafts, gears, bearings and gear pairs, at angles around the axis of a carrier."""

import math
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace

from gearwhine.coupling.description.parts import Shaft, ShaftGear
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears.loaded.gear_pair import GearPair
from gearwhine.coupling.machine.mounted_parts import MountedBearing


@dataclass(frozen=True)
class PlanetCopies:
    """Planets of a set, alike but for their places and the errors of these.

    Attributes
    ----------
    shafts : tuple of Shaft
    gears : tuple of ShaftGear
    bearings : tuple of MountedBearing
    gear_pairs : tuple of GearPair
        Planet by planet for each of the pairs that were given.
    """

    shafts: tuple[Shaft, ...]
    gears: tuple[ShaftGear, ...]
    bearings: tuple[MountedBearing, ...]
    gear_pairs: tuple[GearPair, ...]

    @property
    def gear_names(self) -> tuple[str, ...]:
        """Names of the gears, for :class:`gearwhine.coupling.PlanetarySet`."""
        return tuple(gear.name for gear in self.gears)


def planet_copies(
    shaft: Shaft | Sequence[Shaft],
    gears: Sequence[ShaftGear],
    bearings: Sequence[MountedBearing],
    *,
    carrier: Shaft,
    count: int = 3,
    gear_pairs: Sequence[GearPair] = (),
    angles: Sequence[float] | None = None,
    pin_errors: Sequence[float | tuple[float, float]] | None = None,
    distance: float | None = None,
) -> PlanetCopies:
    """Make the planets of a set of one planet, named by its names and a number: "p 1", "p 2", ...

    Parameters
    ----------
    shaft : Shaft or sequence of Shaft
        Shaft of one planet, its ``axis`` where the first one stands; several of double planets.
    gears, bearings : sequence
        Gears and bearings of that planet; the bearings' seats become None, the pins of the carrier.
    carrier : Shaft
    count : int
        Number of planets at equal angles; that of ``angles`` where they are given.
    gear_pairs : sequence of GearPair
        Pairs with the gears of that planet, each made for every copy.
    angles : sequence of float, optional
        Angle of each planet about the carrier's axis from the given one [rad]; equal by default.
    pin_errors : sequence, optional
        Offset of each pin, counter-clockwise or (radial, counter-clockwise) [m].
    distance : float, optional
        Distance of the axis from the carrier's [m], of a planet with one shaft, in place of that by its ``axis``: the
        first one is then along x.

    Raises
    ------
    CouplingError
        For a planet on the carrier's own axis, or angles or errors that are not as many as planets.
    """
    shafts = [shaft] if isinstance(shaft, Shaft) else list(shaft)
    turns = [2.0 * math.pi * number / count for number in range(count)] if angles is None else list(angles)
    errors = [_pin_error(error) for error in (pin_errors if pin_errors is not None else [0.0] * len(turns))]
    if not turns:
        raise CouplingError(f"planets {shafts[0].name!r} of number 0; expected one or more")
    if len(errors) != len(turns):
        raise CouplingError(f"pin errors of {len(errors)} planets; expected one for each of {len(turns)}")
    if distance is not None:
        shafts = [replace(one, axis=(carrier.axis[0] + distance, carrier.axis[1])) for one in shafts]
    for one in shafts:
        if math.dist(one.axis, carrier.axis) == 0.0:
            raise CouplingError(
                f"planet {one.name!r} stands on the axis of its carrier {carrier.name!r}; expected an axis at the "
                "centre distance of its gears, or `distance`"
            )
    made = PlanetCopies((), (), (), ())
    for number, (turn, error) in enumerate(zip(turns, errors, strict=True), start=1):
        made = PlanetCopies(
            (*made.shafts, *(_turned(one, carrier, turn, number, error) for one in shafts)),
            (*made.gears, *(_on_copy(gear, number) for gear in gears)),
            (*made.bearings, *(_bearing(mounted, number) for mounted in bearings)),
            (),
        )
    own = {gear.name for gear in gears}
    pairs = [
        replace(pair, driver=_numbered(pair.driver, number, own), driven=_numbered(pair.driven, number, own))
        for pair in gear_pairs
        for number in range(1, len(turns) + 1)
    ]
    return replace(made, gear_pairs=tuple(pairs))


def _numbered(name: str, number: int, among: Container[str] | None = None) -> str:
    return name if among is not None and name not in among else f"{name} {number}"


def _pin_error(error: float | tuple[float, float]) -> tuple[float, float]:
    return (0.0, float(error)) if isinstance(error, int | float) else (float(error[0]), float(error[1]))


def _turned(shaft: Shaft, carrier: Shaft, turn: float, number: int, error: tuple[float, float]) -> Shaft:
    x, y = shaft.axis[0] - carrier.axis[0], shaft.axis[1] - carrier.axis[1]
    cosine, sine = math.cos(turn), math.sin(turn)
    axis = carrier.axis[0] + cosine * x - sine * y, carrier.axis[1] + sine * x + cosine * y
    rotor = replace(shaft.rotor, name=_numbered(shaft.name, number))
    return replace(shaft, rotor=rotor, axis=axis, carrier=carrier.name, pin_error=error)


def _on_copy(mounted: ShaftGear, number: int) -> ShaftGear:
    gear = replace(mounted.gear, name=_numbered(mounted.name, number))
    return replace(mounted, gear=gear, shaft=_numbered(mounted.shaft, number))


def _bearing(mounted: MountedBearing, number: int) -> MountedBearing:
    bearing = replace(mounted.bearing, name=_numbered(mounted.bearing.name, number))
    return replace(mounted, bearing=bearing, rotor=_numbered(mounted.rotor, number), seat=None)
