"""Placed solids of revolution: parts of a machine that stand in each other, in a wall, or off their shaft.

Every part is a ring about an axis along z: a length of shaft, a gear's rim, web and teeth, a disc, the rolling elements
of a bearing. Two parts overlap where their lengths do and their circles do; a shaft in the bore of a gear does not. A
bearing whose size is not known is a short ring around its shaft.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from gearwhine.coupling.description.parts import Shaft, ShaftGear
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.machine.bearing_laws import GapLaw
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.coupling.machine.mounted_parts import MountedBearing
from gearwhine.numerics.findings import Finding, Part, in_mm
from gearwhine.rotors import Rotor, Segment
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    RollingBearing,
    SphericalRollerRow,
    TaperedRollerRow,
    dynamic_rating,
)

_SLACK = 5e-5
"""Overlap of two parts up to which they just touch [m]."""
_SAME_AXIS = 1e-6
_RATINGS_APART = 4.0
"""Factor between a given dynamic rating and that of the geometry from which one of them is doubted."""
_STEEPEST_TAPER = 35.0
"""Contact angle of tapered rollers from which it is doubted [°]."""
_LARGEST_OFFSET = 5e-4
"""Axial offset at assembly from which it is doubted [m]."""
_LARGEST_CLEARANCE = 0.01
"""Diametral clearance or interference over the pitch diameter from which it is doubted; group 5 of ISO 5753-1 has less
in every size."""
_UNKNOWN_BEARING_WIDTH = 0.9e-4
"""Width of a bearing of unknown size, and height of its ring [m]: half of it is within the slack, so that a bearing at
the end of a face touches it."""


@dataclass(frozen=True)
class PlacedSolid:
    """A ring of a part at its place in the machine.

    Attributes
    ----------
    part : tuple of str
        Kind and name of the part.
    attribute : str
        Attribute that places it.
    shaft : str
        Shaft that it turns with, or around.
    axis : tuple of float
        x and y of its axis [m].
    left, right : float
        Ends along z [m].
    inner, outer : float
        Radii [m].
    """

    part: Part
    attribute: str
    shaft: str
    axis: tuple[float, float]
    left: float
    right: float
    inner: float
    outer: float

    @property
    def label(self) -> str:
        """Kind and name of the part."""
        return " ".join((self.part[0], f'"{self.part[1]}"'))


def overlap(one: PlacedSolid, other: PlacedSolid) -> float:
    """Return the length along z over which two rings stand in each other [m]; 0 where they do not."""
    length = min(one.right, other.right) - max(one.left, other.left)
    if length <= _SLACK:
        return 0.0
    apart = math.hypot(one.axis[0] - other.axis[0], one.axis[1] - other.axis[1])
    if apart <= _SAME_AXIS:
        return length if min(one.outer, other.outer) - max(one.inner, other.inner) > _SLACK else 0.0
    beside = apart >= one.outer + other.outer - _SLACK
    within = apart + other.outer <= one.inner + _SLACK or apart + one.outer <= other.inner + _SLACK
    return 0.0 if beside or within else length


def shaft_solids(rotor: Rotor, axis: tuple[float, float], start: float) -> Iterator[PlacedSolid]:
    """Yield the lengths of a shaft, cones as thick as their thin end, and its discs of known size."""
    for left, right, inner, outer in _shaft_lengths(rotor):
        yield PlacedSolid(
            ("shaft", rotor.name), "segments", rotor.name, axis, start + left, start + right, inner, outer
        )
    for number, disc in enumerate(rotor.discs):
        if disc.size is not None:
            width, outer, inner = disc.size
            middle, part = start + disc.at, ("shaft", rotor.name)
            yield PlacedSolid(
                part,
                f"discs.{number}.at",
                rotor.name,
                axis,
                middle - 0.5 * width,
                middle + 0.5 * width,
                0.5 * inner,
                0.5 * outer,
            )


def _shaft_lengths(rotor: Rotor) -> Iterator[tuple[float, float, float, float]]:
    joints = rotor.joints.tolist()
    for part, left, right in zip(rotor.segments, joints[:-1], joints[1:], strict=True):
        if isinstance(part, Segment):
            (outer, inner), (right_outer, right_inner) = part.end_diameters
            yield left, right, 0.5 * max(inner, right_inner), 0.5 * min(outer, right_outer)


def gear_solids(gear: Gear, shaft: str, axis: tuple[float, float], middle: float) -> Iterator[PlacedSolid]:
    """Yield the rings of a gear's blank, with the teeth out to the tip circle; its middle at z = ``middle`` [m]."""
    rings = gear.blank_rings
    for ring in rings:
        outer = gear.outer_radius if ring is rings[0] else ring.outer_radius
        inner = -gear.tip_radius if gear.is_internal else ring.inner_radius
        half = 0.5 * ring.width
        yield PlacedSolid(("gear", gear.name), "at", shaft, axis, middle - half, middle + half, inner, outer)


def bearing_solid(
    name: str, rotor: Rotor, axis: tuple[float, float], start: float, at: float, rolling: RollingBearing | None
) -> PlacedSolid:
    """Return the ring of a bearing: its rolling elements, or a short one around the shaft."""
    radius = 0.5 * rotor.outer_diameter(at, at) if 0.0 <= at <= rotor.length else 0.0
    left, right, inner, outer = (
        -0.5 * _UNKNOWN_BEARING_WIDTH,
        0.5 * _UNKNOWN_BEARING_WIDTH,
        radius,
        radius + _UNKNOWN_BEARING_WIDTH,
    )
    if rolling is not None:
        left, right, inner, outer = rolling.envelope
    middle = start + at
    return PlacedSolid(("bearing", name), "at", rotor.name, axis, middle + left, middle + right, inner, outer)


def overlap_findings(
    solids: Sequence[PlacedSolid],
    meshing: Iterable[frozenset[str]] = (),
    radial: Iterable[str] = (),
    stand_ins: Iterable[str] = (),
    carriers: Mapping[str, str] | None = None,
    *,
    unplaced: bool = False,
) -> Iterator[Finding]:
    """Yield parts that stand in each other, each two of them once.

    Parameters
    ----------
    solids : sequence of PlacedSolid
    meshing : iterable of frozenset
        Names of two gears in mesh, whose teeth stand in each other's spaces.
    radial : iterable of str
        Bearings that hold the shaft across its axis: two of them have no room at one place; one beside a thrust bearing
        or damper has.
    stand_ins : iterable of str
        Gears whose body a disc at their place stands for.
    carriers : mapping of str to str, optional
        Carrier of each planet's shaft. A planet turns on its bearing, and its pin is in the carrier.
    unplaced : bool
        Whether nobody gave the axes of the shafts, which then all stand at one place.
    """
    carried = dict(carriers or {})
    pairs, holding, replaced = set(meshing), set(radial), set(stand_ins)
    found: set[frozenset[tuple[Part, str]]] = set()
    ordered = sorted(enumerate(solids), key=lambda item: item[1].left)
    for place, (number, one) in enumerate(ordered):
        for later, other in ordered[place + 1 :]:
            if other.left >= one.right:
                break
            first, second = (one, other) if number < later else (other, one)
            key = frozenset(((first.part, first.attribute), (second.part, second.attribute)))
            if (
                key in found
                or not _foreign(first, second, pairs, holding, replaced, unplaced)
                or _on_pin(first, second, carried)
            ):
                continue
            length = overlap(first, second)
            if length > 0.0:
                found.add(key)
                # The axis at the origin is also that of shafts that stand for others, whose sizes mean little.
                finding = _overlapping(first, second, length)
                apart = first.shaft != second.shaft and first.axis == second.axis == (0.0, 0.0)
                yield replace(finding, severity="warning") if apart else finding


def _on_pin(first: PlacedSolid, second: PlacedSolid, carriers: Mapping[str, str]) -> bool:
    """Whether two solids are a planet and its bearing inside it, or its pin or bearing and the carrier around them.

    Or the gear of a planet and a hollow part of the carrier, which joins its walls and has a window for it.
    """
    kinds = {first.part[0], second.part[0]}
    if first.shaft == second.shaft:
        return first.shaft in carriers and kinds == {"gear", "bearing"}
    of_carrier = carriers.get(first.shaft) == second.shaft or carriers.get(second.shaft) == first.shaft
    around = first if carriers.get(second.shaft) == first.shaft else second
    in_window = kinds == {"gear", "shaft"} and around.part[0] == "shaft" and around.inner > 0.0
    return of_carrier and (in_window or kinds <= {"shaft", "bearing"})


def _foreign(
    first: PlacedSolid,
    second: PlacedSolid,
    meshing: set[frozenset[str]],
    radial: set[str],
    replaced: set[str],
    unplaced: bool,
) -> bool:
    """Whether two solids are of parts that must be clear of each other."""
    kinds, names = (first.part[0], second.part[0]), (first.part[1], second.part[1])
    discs = [solid.attribute.startswith("discs") for solid in (first, second)]
    if first.part == second.part and first.attribute == second.attribute:
        return False
    if first.shaft == second.shaft:
        if "shaft" in kinds and not any(discs):
            return False  # parts on their own shaft, see :func:`fit_findings`
        if kinds == ("bearing", "bearing"):
            return set(names) <= radial
        if any(discs):
            # A disc may stand for a gear or a journal of a published model.
            others = [name for name, disc in zip(names, discs, strict=True) if not disc]
            return "gear" in kinds and not set(others) & replaced
        return True
    if unplaced and first.axis == second.axis:
        return False
    if kinds == ("gear", "gear"):
        return frozenset(names) not in meshing
    return kinds != ("bearing", "bearing") and not _is_short(first, second)


def _is_short(*solids: PlacedSolid) -> bool:
    return any(
        solid.part[0] == "bearing" and solid.right - solid.left <= 1.5 * _UNKNOWN_BEARING_WIDTH for solid in solids
    )


def _overlapping(first: PlacedSolid, second: PlacedSolid, length: float) -> Finding:
    """Return the finding of two solids, at the one that is moved more easily: gears, discs, bearings, shafts."""
    order = {"gear": 0, "bearing": 1, "shaft": 2}
    rank = [order[solid.part[0]] - 0.5 * solid.attribute.startswith("discs") for solid in (first, second)]
    at, other = (first, second) if rank[0] < rank[1] else (second, first)
    kind = "a disc" if at.attribute.startswith("discs") else f"a {at.part[0]}"
    on = f" on {other.label}" if other.attribute.startswith("discs") else ""
    name = f"the disc{on}" if on else other.label
    low, high = max(at.left, other.left), min(at.right, other.right)
    middles = (
        f"they overlap over {in_mm(length)} from z = {in_mm(low)} to {in_mm(high)}"
        if length > 1.5 * _UNKNOWN_BEARING_WIDTH
        else f"both are at z = {in_mm(0.5 * (low + high))}"
    )
    apart = math.hypot(at.axis[0] - other.axis[0], at.axis[1] - other.axis[1])
    radii = (
        f", with radii of {in_mm(at.outer)} and {in_mm(other.outer)} and axes {in_mm(apart)} apart"
        if apart > _SAME_AXIS
        else ""
    )
    return Finding(at.part, at.attribute, None, f"{kind} clear of {name}; {middles}{radii}")


_HANGS_OFF = 0.05
"""Part of a gear's face beyond the end of its shaft that is unlikely."""


def fit_findings(gear: Gear, rotor: Rotor, at: float) -> Iterator[Finding]:
    """Yield a shaft as thick as the gear on it, and a face that hangs off the end of its shaft, by a known width."""
    part, half = ("gear", gear.name), 0.5 * gear.face_width
    if not gear.has_face:
        return
    if gear.is_internal:
        yield from _ring_fit_findings(gear, rotor, at)
        return
    for left, right, _, outer in _shaft_lengths(rotor):
        over = min(right, at + half) - max(left, at - half)
        if over > max(_SLACK, 1e-3 * gear.face_width) and outer >= gear.root_circle_radius:
            expected = (
                f"a gear whose teeth stand on its shaft; that has a diameter of {in_mm(2.0 * outer)} there, the root "
                f"circle {in_mm(2.0 * gear.root_circle_radius)}"
            )
            yield Finding(part, "at", None, expected)
            break
    if gear.face_width > rotor.length:
        expected = f"a face narrower than the shaft that carries it is long, {in_mm(rotor.length)}"
        yield Finding(part, "face_width", gear.face_width, expected)
        return
    beyond = max(half - at, at + half - rotor.length)
    if beyond > _HANGS_OFF * gear.face_width:
        expected = f"a place at which the shaft carries the face; {in_mm(beyond)} of it hang off the end"
        yield Finding(part, "at", float(at), expected, "warning")


def _ring_fit_findings(gear: Gear, rotor: Rotor, at: float) -> Iterator[Finding]:
    """Yield a shaft in the teeth of the ring that it carries, by a disc or a bell beside them."""
    half = 0.5 * gear.face_width
    for left, right, inner, outer in _shaft_lengths(rotor):
        over = min(right, at + half) - max(left, at - half)
        if over > max(_SLACK, 1e-3 * gear.face_width) and outer > -gear.tip_radius and inner < gear.outer_radius:
            expected = (
                f"a ring around its shaft; that has a diameter of {in_mm(2.0 * outer)} there, the ring a tip circle of "
                f"{in_mm(-2.0 * gear.tip_radius)}"
            )
            if inner > -gear.root_circle_radius:
                # A sleeve around the ring: it is the rim that stands in it.
                expected += (
                    f"; or a sleeve around the ring, whose bore of {in_mm(2.0 * inner)} leaves room for a rim of "
                    f"{in_mm(inner + gear.root_circle_radius)} at most behind the root circle of "
                    f"{in_mm(-2.0 * gear.root_circle_radius)}; this one reaches to {in_mm(2.0 * gear.outer_radius)}"
                )
            yield Finding(("gear", gear.name), "at", None, expected)
            return


def _rolling_findings(part: Part, rolling: RollingBearing) -> Iterator[Finding]:
    """Yield a rating, a contact angle, an offset at assembly and a clearance that rolling bearings hardly have."""
    geometry, given = dynamic_rating(rolling.rows[0], len(rolling.rows)), rolling.catalogue_rating
    if given is not None and not 1.0 / _RATINGS_APART < given / geometry < _RATINGS_APART:
        expected = (
            f"a dynamic rating C near that of its elements by ISO 281, {1e-3 * geometry:.3g} kN; it is "
            f"{1e-3 * given:.3g} kN"
        )
        yield Finding(part, "rolling", None, expected, "warning")
    for row in rolling.rows:
        angle = math.degrees(row.contact_angle)
        if isinstance(row, TaperedRollerRow) and angle > _STEEPEST_TAPER:
            expected = (
                f"a contact angle of 10° to 30°, as tapered rollers have; {angle:.3g}° is a factor Y = 0.4 / tan α of "
                f"{0.4 / math.tan(row.contact_angle):.3g} (a catalogue's e is 1.5 tan α)"
            )
            yield Finding(part, "rolling", None, expected, "warning")
            return
        offset = abs(getattr(row, "axial_offset", 0.0))
        if offset > _LARGEST_OFFSET:
            expected = f"an axial offset of some µm, by which bearings are preloaded; it is {in_mm(offset)}"
            yield Finding(part, "rolling", None, expected, "warning")
            return
        most = _LARGEST_CLEARANCE * row.pitch_diameter
        if abs(row.clearance) > most:
            expected = (
                f"a clearance or an interference in operation of at most {in_mm(most)}, a hundredth of the pitch "
                f"diameter; it is {in_mm(row.clearance)}"
            )
            yield Finding(part, "rolling", None, expected, "warning")
            return


def bearing_findings(
    name: str, rotor: Rotor, at: float, rolling: RollingBearing | None, seat_diameter: float | None
) -> Iterator[Finding]:
    """Yield a shaft that does not go through its bearing or the bore that this sits in, or is not around it."""
    part = ("bearing", name)
    if rolling is not None and rolling.rows[0].outer_turns:
        left, right, _, outer = rolling.envelope
        widest = max(
            (2.0 * inner for a, b, inner, _ in _shaft_lengths(rotor) if a < at + right and b > at + left), default=0.0
        )
        if widest < 2.0 * outer - _SLACK:
            expected = (
                f"rolling elements within the bore of the shaft, {in_mm(widest)} wide there, as its outer ring turns; "
                f"they reach to {in_mm(2.0 * outer)}"
            )
            within = widest <= max(row.pitch_diameter for row in rolling.rows) + _SLACK
            yield Finding(part, "rolling", None, expected, "error" if within else "warning")
    elif rolling is not None:
        left, right, inner, _ = rolling.envelope
        thinnest = min(
            (2.0 * outer for a, b, _, outer in _shaft_lengths(rotor) if a < at + right and b > at + left), default=0.0
        )
        if thinnest > 2.0 * inner + _SLACK:
            expected = (
                f"rolling elements around the shaft, {in_mm(thinnest)} thick there; they leave {in_mm(2.0 * inner)}"
            )
            within = thinnest >= min(row.pitch_diameter for row in rolling.rows) - _SLACK
            yield Finding(part, "rolling", None, expected, "error" if within else "warning")
    if seat_diameter is not None:
        thick = min(
            (2.0 * outer for a, b, _, outer in _shaft_lengths(rotor) if a <= at + _SLACK and b >= at - _SLACK),
            default=0.0,
        )
        if thick >= seat_diameter - _SLACK:
            expected = f"a seat with room for the shaft, {in_mm(thick)} thick there; its bore is {in_mm(seat_diameter)}"
            yield Finding(part, "seat", None, expected)


@dataclass(frozen=True)
class Wall:
    """A wall of a box with its bores along z.

    Attributes
    ----------
    name : str
        Face of the box.
    low, high : tuple of float
        Corners of least and of greatest x, y, z [m].
    bores : sequence of tuple
        Circles (x, y, radius) through it [m].
    """

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    bores: Sequence[tuple[float, float, float]] = ()


def wall_findings(solids: Iterable[PlacedSolid], walls: Sequence[Wall]) -> Iterator[Finding]:
    """Yield parts that stand in a wall; a shaft through a wall without a bore is a warning, as of a hole left out."""
    found: set[tuple[Part, str]] = set()
    for solid in solids:
        for wall in walls:
            if (solid.part, wall.name) in found or solid.part[0] == "bearing" or not _in_wall(solid, wall):
                continue
            found.add((solid.part, wall.name))
            low, high = max(solid.left, wall.low[2]), min(solid.right, wall.high[2])
            where = f"a radius of {in_mm(solid.outer)} about x = {in_mm(solid.axis[0])}, y = {in_mm(solid.axis[1])}"
            expected = (
                f"a place clear of the {wall.name} wall of the housing; with {where} it stands in it from "
                f"z = {in_mm(low)} to {in_mm(high)}"
            )
            through = solid.part[0] == "shaft" and solid.attribute == "segments" and wall.name in ("back", "front")
            aside = not any(_about(solid, bore) for bore in wall.bores)
            yield Finding(solid.part, solid.attribute, None, expected, "warning" if through and aside else "error")


def _about(solid: PlacedSolid, bore: tuple[float, float, float]) -> bool:
    return math.hypot(solid.axis[0] - bore[0], solid.axis[1] - bore[1]) <= bore[2]


def _in_wall(solid: PlacedSolid, wall: Wall) -> bool:
    """Whether a ring and a wall have room in common; one that is within a bore has not."""
    if min(solid.right, wall.high[2]) - max(solid.left, wall.low[2]) <= _SLACK:
        return False
    x, y = solid.axis
    nearest = math.hypot(max(wall.low[0] - x, 0.0, x - wall.high[0]), max(wall.low[1] - y, 0.0, y - wall.high[1]))
    farthest = math.hypot(max(x - wall.low[0], wall.high[0] - x), max(y - wall.low[1], wall.high[1] - y))
    if nearest >= solid.outer - _SLACK or farthest <= solid.inner + _SLACK:
        return False
    return not any(math.hypot(x - a, y - b) + solid.outer <= radius + _SLACK for a, b, radius in wall.bores)


def _bore_radius(rotor: Rotor, left: float, right: float) -> float:
    """Smallest inner radius of a shaft between two places from its left end [m]; 0 off its segments."""
    radii = [inner for start, end, inner, _ in _shaft_lengths(rotor) if min(end, right) - max(start, left) > _SLACK]
    return min(radii, default=0.0)


def placed_solids(
    shafts: Sequence[Shaft], gears: Sequence[ShaftGear], bearings: Sequence[MountedBearing]
) -> list[PlacedSolid]:
    """Return the rings of all parts of a machine, but of gears whose face width is not known."""
    by_name = {shaft.name: shaft for shaft in shafts}
    solids = [solid for shaft in shafts for solid in shaft_solids(shaft.rotor, shaft.axis, shaft.start)]
    for mounted in filter(lambda one: one.gear.has_face, gears):
        shaft = by_name[mounted.shaft]
        for solid in gear_solids(mounted.gear, shaft.name, shaft.axis, shaft.start + mounted.at):
            # A gear that is made from a hollow shaft has the bore of that.
            within = _bore_radius(shaft.rotor, solid.left - shaft.start, solid.right - shaft.start)
            solids.append(solid if solid.inner > 0.0 else replace(solid, inner=within))
    for held in bearings:
        shaft, bearing = by_name[held.rotor], held.bearing
        solids.append(bearing_solid(bearing.name, shaft.rotor, shaft.axis, shaft.start, bearing.at, held.elements))
    return solids


def machine_findings(
    shafts: Sequence[Shaft],
    gears: Sequence[ShaftGear],
    bearings: Sequence[MountedBearing],
    meshing: Iterable[frozenset[str]],
    seat_diameters: Mapping[str, float] | None = None,
) -> Iterator[Finding]:
    """Yield what is wrong or unlikely of the places of a machine's parts.

    Parameters
    ----------
    shafts, gears, bearings : sequence
        Parts of the machine.
    meshing : iterable of frozenset
        Names of two gears in mesh.
    seat_diameters : mapping of str to float, optional
        Diameters of the bores of seats [m], of shafts that are drawn with their journals: these go through bearings
        and seats. Without it a shaft may stand for one whose journals are left out.
    """
    by_name, pairs = {shaft.name: shaft for shaft in shafts}, list(meshing)
    for shaft in shafts:
        yield from shaft_findings(shaft)
        yield from support_findings(shaft, [held for held in bearings if held.rotor == shaft.name])
    for mounted in gears:
        shaft = by_name[mounted.shaft]
        yield from fit_findings(mounted.gear, shaft.rotor, mounted.at)
    for held in bearings:
        shaft, bearing = by_name[held.rotor], held.bearing
        if held.elements is None and held.law is None:
            yield from bearing.findings
        yield from seat_error_findings(held)
        if held.elements is not None:
            yield from _rolling_findings(("bearing", bearing.name), held.elements)
        if seat_diameters is None:
            continue
        seat = seat_diameters.get(held.seat) if held.seat is not None else None
        yield from bearing_findings(bearing.name, shaft.rotor, bearing.at, held.elements, seat)
    radial = [
        held.bearing.name
        for held in bearings
        # A stop stands around the shaft beside what carries it.
        if held.elements is not None
        or (not isinstance(held.law, GapLaw) and (held.bearing.stiffness[..., :2, :2] > 0.0).any())
    ]
    stand_ins = [mounted.name for mounted in gears if mounted.inertia is not None]
    carriers = {shaft.name: shaft.carrier for shaft in shafts if shaft.carrier is not None}
    # Gears in mesh cannot stand on one axis: where all shafts do, their centre distance alone is given.
    unplaced = bool(pairs) and len({shaft.axis for shaft in shafts}) == 1
    solids = placed_solids(shafts, gears, bearings)
    yield from overlap_findings(solids, pairs, radial, stand_ins, carriers, unplaced=unplaced)


def support_findings(shaft: Shaft, bearings: Sequence[MountedBearing]) -> Iterator[Finding]:
    """Yield a shaft that one bearing holds like a pivot: a load beside it finds no equilibrium.

    A row of balls, or of rollers that align themselves, resists no tilt; nor does a stiffness without rotations.
    """
    if len(bearings) != 1:
        return
    (held,) = bearings
    if held.elements is not None:
        row, *further_rows = held.elements.rows
        tilts = not further_rows and isinstance(row, BallRow | SphericalRollerRow)
    else:
        tilts = not held.bearing.stiffness[..., 3:, 3:].any()
    if tilts:
        expected = f"a second bearing, or one that resists tilting: about {held.bearing.name!r} alone the shaft swings"
        yield Finding(("shaft", shaft.name), "", None, expected, "warning")


_MOST_DAMPED = 0.2
_LARGEST_SEAT_ERROR = 1e-3, 1e-2
"""Position [m] and rotation [rad] of a bore that no workshop leaves."""


def seat_error_findings(held: MountedBearing) -> Iterator[Finding]:
    """Yield an error of a seat's place that is no error of production."""
    x, y, rx, ry = held.seat_error or (0.0, 0.0, 0.0, 0.0)
    off, turned = math.hypot(x, y), math.hypot(rx, ry)
    if off > _LARGEST_SEAT_ERROR[0] or turned > _LARGEST_SEAT_ERROR[1]:
        expected = f"a bore within 1 mm and 10 mrad of its place; it is {in_mm(off)} and {1e3 * turned:.3g} mrad off"
        yield Finding(("bearing", held.bearing.name), "seat_error", None, expected, "warning")


_LARGEST_ECCENTRICITY = 0.1
"""Eccentricity of a rotor's mass over its radius that is unlikely."""


def shaft_findings(shaft: Shaft) -> Iterator[Finding]:
    """Yield discs wider than their shaft, unbalance of a mass off the rotor, and damping that no shaft has."""
    part, rotor = ("shaft", shaft.name), shaft.rotor
    for number, disc in enumerate(rotor.discs):
        if disc.size is not None and disc.size[0] > rotor.length:
            expected = f"a disc narrower than its shaft is long, {in_mm(rotor.length)}"
            yield Finding(part, f"discs.{number}.width", disc.size[0], expected)
        for finding in disc.findings:
            yield replace(finding, part=part, attribute=f"discs.{number}.{finding.attribute}")
    if shaft.damping_ratio > _MOST_DAMPED:
        expected = "at most 0.2: shafts and their fits have 0.001 to 0.02"
        yield Finding(part, "damping_ratio", shaft.damping_ratio, expected, "warning")


_SHEARED = 1e9
"""Mean shear stress of a section that no steel bears [Pa]."""


def force_findings(force: ShaftForce, rotor: Rotor, place: int) -> Iterator[Finding]:
    """Yield a force that shears its shaft off; ``place`` is its place among the forces."""
    areas = [math.pi * (outer**2 - inner**2) for *_, inner, outer in _shaft_lengths(rotor)]
    size = math.hypot(*force.force)
    if areas and size > _SHEARED * max(areas):
        expected = f"a force that the shaft bears; {size:.4g} N shear it with {1e-9 * size / max(areas):.3g} GPa"
        yield Finding(("force", force.rotor), f"force.{place}", None, expected, "warning")


def unbalance_findings(shaft: Shaft, rotor: Rotor, tip_radius: float) -> Iterator[Finding]:
    """Yield unbalances whose eccentricity is large for the rotor.

    Parameters
    ----------
    shaft : Shaft
    rotor : Rotor
        Its rotor with the gears.
    tip_radius : float
        Largest tip radius of the gears [m]; 0 without gears.
    """
    radii = [outer for *_, outer in _shaft_lengths(rotor)] + [0.5 * disc.size[1] for disc in rotor.discs if disc.size]
    mass, radius = rotor.mass, max([tip_radius, *radii])
    if any(disc.size is None and disc.mass > 0.0 for disc in shaft.rotor.discs):
        radius = max(radius, rotor.length)  # of a disc by its inertia the radius is not known
    for number, unbalance in enumerate(shaft.unbalances):
        off = abs(unbalance.moment) / mass
        if off <= _LARGEST_ECCENTRICITY * radius:
            continue
        expected = (
            f"a moment whose eccentricity is within the rotor; it moves {mass:.4g} kg by {in_mm(off)}, of a radius of "
            f"{in_mm(radius)}"
        )
        yield Finding(("shaft", shaft.name), f"unbalance.{number}.moment", unbalance.moment, expected, "warning")
