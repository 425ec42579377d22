"""`[[planetary]]`: planetary sets; planets written once are made `count` times before a case is read.

A planet that is written once has one `[[rotor]]`, its gears, bearings and gear pairs. :func:`with_planets` replaces
each of these tables by one for every planet, with a number behind its name, at its angle around the carrier's axis. The
first copy stands in the place of the table, further ones at the end of the list, and :class:`PlanetCopies` knows of
each which table it is a copy of, so that findings name what stands in the file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, TypeGuard

from pydantic import Discriminator, Field, Tag, ValidationError, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gearwhine.case import units
from gearwhine.case.errors import UNSAID, Finding, Location, look_up
from gearwhine.case.fields import (
    MEMBER,
    MOST_ENTRIES,
    MOST_PLANETS,
    Angle,
    GearName,
    Length,
    LengthFromZero,
    Name,
    PositiveLength,
    PositiveStiffness,
    Quantity,
    RotorName,
    SeatName,
    StiffnessFromZero,
    Table,
    Whole,
    wrong,
)
from gearwhine.case.gears import Gear, TrainMembers
from gearwhine.case.operation import Operation
from gearwhine.case.overrides import parse_key_path
from gearwhine.case.rotors import Rotor

if TYPE_CHECKING:
    from gearwhine.coupling import PlanetarySet, SupportBolt, TorqueSupport

_LENGTH, _ANGLE = Quantity(units.LENGTH), Quantity(units.ANGLE)
_TORSION = Quantity(units.TILT_STIFFNESS, above=0.0)
TorsionalStiffness = Annotated[float, _TORSION]


def _error_form(value: object) -> str:
    return "~list" if isinstance(value, list | tuple) else "~length"


PinError = Annotated[
    Annotated[Length, Tag("~length")] | Annotated[tuple[Length, Length], Tag("~list")], Discriminator(_error_form)
]


TangentialStiffness = Annotated[
    Annotated[PositiveStiffness, Tag("~length")] | Annotated[tuple[PositiveStiffness, ...], Tag("~list")],
    Discriminator(_error_form),
]
OtherStiffness = Annotated[
    Annotated[StiffnessFromZero, Tag("~length")] | Annotated[tuple[StiffnessFromZero, ...], Tag("~list")],
    Discriminator(_error_form),
]


class Bolts(Table):
    """Bolts, pins or bushes on a circle that hold a member from turning; a list of stiffness has one for each."""

    circle: PositiveLength
    """Diameter of their circle."""
    angles: tuple[Angle, ...] = Field(min_length=2, max_length=360)
    """Angle of each from x."""
    tangential_stiffness: TangentialStiffness
    """Stiffness along the circle, of each or a list."""
    radial_stiffness: OtherStiffness = 0.0
    """Radial stiffness, of each or a list."""
    axial_stiffness: OtherStiffness = 0.0
    """Stiffness along the axis, of each or a list."""

    @model_validator(mode="after")
    def _one_for_each(self) -> Bolts:
        for key in ("tangential_stiffness", "radial_stiffness", "axial_stiffness"):
            value = getattr(self, key)
            if isinstance(value, tuple) and len(value) != len(self.angles):
                raise wrong(f"one for each of {len(self.angles)} bolts, or one for all", key)
        return self

    def build(self) -> tuple[SupportBolt, ...]:
        """Build the bolts."""
        from gearwhine.coupling import SupportBolt

        def each(value: float | tuple[float, ...]) -> tuple[float, ...]:
            return value if isinstance(value, tuple) else (value,) * len(self.angles)

        rows = zip(
            self.angles,
            *map(each, (self.tangential_stiffness, self.radial_stiffness, self.axial_stiffness)),
            strict=True,
        )
        return tuple(SupportBolt(0.5 * self.circle, *row) for row in rows)


class HeldMember(Table):
    """`[[torque_support]]`, and `fixed` of a `[[planetary]]`: what is held from turning, and by what."""

    member: Annotated[Name, MEMBER]
    """Gear or rotor that is held, by its name."""
    stiffness: TorsionalStiffness | None = None
    """Torque over rotation. Default: rigid."""
    bolts: Bolts | None = None
    """Bolts in place of a stiffness; they hold the member in all directions in which they are stiff."""
    seat: SeatName | None = None
    """Seat of the housing that takes the torque. Default: the ground."""
    at: LengthFromZero | None = None
    """Station on the rotor. Default: that of the gear; of a rotor its left end."""
    damping_time: Annotated[float, Quantity(units.TIME, at_least=0.0, at_most=1e-2)] = 0.0
    """Damping over stiffness."""

    @model_validator(mode="after")
    def _held_once(self) -> HeldMember:
        if self.bolts is not None and self.stiffness is not None:
            raise wrong("none beside 'bolts', which have their own", "stiffness")
        return self

    def place(self, gears: Sequence[Gear]) -> tuple[str, float]:
        """Return the rotor that is held, and the station on it [m]."""
        gear = next((gear for gear in gears if gear.name == self.member), None)
        rotor = self.member if gear is None or gear.rotor is None else gear.rotor
        at = gear.at if self.at is None and gear is not None else self.at
        return rotor, at or 0.0

    def build(self, gears: Sequence[Gear]) -> TorqueSupport:
        """Build what holds it."""
        from gearwhine.coupling import TorqueSupport

        bolts = () if self.bolts is None else self.bolts.build()
        return TorqueSupport(*self.place(gears), self.stiffness, self.seat, self.damping_time, bolts)


class Planetary(Table):
    """`[[planetary]]`: a planetary set by the names of its gears and its carrier.

    Planets are named each, on rotors with this `carrier`; or one planet is written once and mounted `count` times.
    """

    name: Name
    """Name of the set."""
    sun: GearName | None = None
    """Sun, a gear."""
    ring: GearName | None = None
    """Ring, an internal gear."""
    planets: tuple[GearName, ...] = Field(min_length=1, max_length=MOST_ENTRIES)
    """Planets, gears by name: all of them, or with `count` or `angles` those of one planet."""
    carrier: RotorName
    """Rotor that carries the planets."""
    count: Annotated[int, Whole(1, MOST_PLANETS)] | None = None
    """Number of planets that are made of one. Their rotors, gears and bearings get a number behind their names: `p 1`,
    `p 2`, ..."""
    angles: tuple[Angle, ...] | None = Field(default=None, min_length=1, max_length=MOST_PLANETS)
    """Angle of each planet about the carrier's axis, from the place of the one that is written. Default: equal ones."""
    fixed: Annotated[HeldMember | None, MEMBER] = None
    """Member that is held from turning: a gear or a rotor by its name; the name of a seat or a stiffness such as
    "1e7 N*m/rad", by which the ring is held; or a table. Default: none, as of a differential."""
    pin_errors: tuple[PinError, ...] | None = Field(default=None, max_length=MOST_PLANETS)
    """Offset of each pin from its place, counter-clockwise about the carrier's axis; or a list of two, outward and
    counter-clockwise."""

    @field_validator("fixed", mode="before")
    @classmethod
    def _by_name(cls, value: object) -> object:
        return {"member": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _complete(self) -> Planetary:
        if self.sun is None and self.ring is None:
            raise wrong("a 'sun' or a 'ring', or both", "sun")
        if self.count is not None and self.angles is not None and self.count != len(self.angles):
            raise wrong(f"as many planets as angles, {len(self.angles)}", "count")
        number = self.count or len(self.angles or ())
        if self.pin_errors is not None and len(self.pin_errors) != number:
            expected = f"one for each of {number} planets" if number else "none beside planets that are named each"
            raise wrong(f"{expected}; a [[rotor]] has its own 'pin_error'", "pin_errors")
        return self

    def build(self) -> PlanetarySet:
        """Build the description of the set."""
        from gearwhine.coupling import PlanetarySet

        return PlanetarySet(self.name, self.planets, self.carrier, self.sun, self.ring)


def held_members(sets: Iterable[Planetary], supports: Iterable[HeldMember]) -> list[HeldMember]:
    """Return the members that are held from turning: those of the sets, then those of `[[torque_support]]`."""
    return [*(one.fixed for one in sets if one.fixed is not None), *supports]


def train_members(
    rotors: Sequence[Rotor], gears: Sequence[Gear], held: Sequence[HeldMember], operation: Operation | None
) -> TrainMembers:
    """Return the members of the train of a case beside its gear pairs."""
    carriers = {rotor.name: rotor.carrier for rotor in rotors if rotor.carrier is not None}
    given = (
        {}
        if operation is None or operation.speed == 0.0
        else {drive.rotor: drive.speed / operation.speed for drive in operation.drive}
    )
    first = None if operation is None else operation.rotor
    return TrainMembers(carriers, tuple(dict.fromkeys(one.place(gears)[0] for one in held)), given, first)


_NUMBER_OF_COPY = re.compile(r" \d+(?=['\"])")


@dataclass(frozen=True)
class PlanetCopies:
    """Origin of the tables that were made of others: place in a list to place in that list of the file."""

    origins: Mapping[tuple[str, int], Location]

    def in_file(self, finding: Finding) -> Finding:
        """Return a finding at the table of the file that its own is a copy of."""
        kind, place = (*finding.location, "", "")[:2]
        origin = self.origins.get((str(kind), place)) if isinstance(place, int) else None
        if origin is None:
            return finding
        if origin[0] == kind:
            return replace(finding, location=(*origin, *finding.location[2:]))
        return replace(finding, location=origin, value=UNSAID)

    def as_written(self, findings: Iterable[Finding]) -> Iterator[Finding]:
        """Yield findings at the tables of the file, that of each copy of a planet once."""
        seen = set[tuple[str, str]]()
        for finding in findings:
            placed = self.in_file(finding)
            # Keys of a file that cannot be read may be of any kind.
            key = repr(placed.location), _NUMBER_OF_COPY.sub("", placed.expected)
            if not self.origins or key not in seen:
                seen.add(key)
                yield placed


def with_planets(document: Mapping[str, Any], context: Mapping[str, Any]) -> tuple[dict[str, Any], PlanetCopies]:
    """Make the planets of sets that are written once, and give named ones their carrier.

    Sets of which a key cannot be read are left as they are, to be refused as such.

    Parameters
    ----------
    document : mapping
        Tables and lists of the case file.
    context : mapping
        Folder and files, for tables that are read here.
    """
    sets = document.get("planetary")
    expansion = _Expansion(document, context)
    if isinstance(sets, list | tuple) and all(isinstance(one, Mapping) for one in sets):
        for index, one in enumerate(sets):
            expansion.add(index, dict(one))
    return expansion.document, PlanetCopies(expansion.origins)


def with_implied_pairs(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document with the gear pairs that its sets imply written out, once of planets that are written once."""
    written = _Expansion(document, {})
    for index, entry in written.entries("planetary"):
        one = {**entry, "fixed": written._fixed(entry)}
        planets = one.get("planets")
        if _are_names(planets) and planets:
            written._pair_gears(index, one, len(planets) if {"count", "angles"} & one.keys() else 1)
    if not written.document.get("gear_pair"):
        written.document.pop("gear_pair", None)
    return written.document


_KINDS = ("rotor", "gear", "bearing", "gear_pair")
_NAMES = ("name", "rotor", "driver", "driven")


def _are_names(names: object) -> TypeGuard[Sequence[str]]:
    """Whether a value of a file is a list of texts."""
    return isinstance(names, list | tuple) and all(isinstance(name, str) for name in names)


class _Expansion:
    """Document whose planets are made set by set."""

    def __init__(self, document: Mapping[str, Any], context: Mapping[str, Any]) -> None:
        self.context = context
        self.document = dict(document)
        self.origins: dict[tuple[str, int], Location] = {}
        for kind in (*_KINDS, "planetary"):
            if isinstance(document.get(kind), list | tuple):
                self.document[kind] = list(document[kind])

    def entries(self, kind: str) -> list[tuple[int, dict[str, Any]]]:
        """Return tables of a kind with their places, but those with a name that is no text: it is refused later."""
        listed = self.document.get(kind)
        return [
            (index, entry)
            for index, entry in enumerate(listed if isinstance(listed, list) else [])
            if isinstance(entry, dict) and all(isinstance(entry.get(key, ""), str) for key in _NAMES)
        ]

    def named(self, kind: str, name: object) -> dict[str, Any] | None:
        return next((entry for _, entry in self.entries(kind) if entry.get("name") == name), None)

    def add(self, index: int, one: dict[str, Any]) -> None:
        """Make the planets of a set."""
        one["fixed"] = self._fixed(one)
        if one["fixed"] is None:
            del one["fixed"]
        self.document["planetary"][index] = one
        planets, carrier = one.get("planets"), one.get("carrier")
        if not _are_names(planets) or not isinstance(carrier, str):
            return
        gears = [self.named("gear", name) for name in planets]
        named = [gear.get("rotor") for gear in gears if gear is not None]
        if not _are_names(named):
            return
        rotors = list(dict.fromkeys(named))
        shafts = [self.named("rotor", name) for name in rotors]
        if not gears or None in gears or not shafts or None in shafts or self.named("rotor", carrier) is None:
            return
        for shaft in shafts:
            if shaft is not None:
                shaft_index = next(i for i, entry in self.entries("rotor") if entry is shaft)
                self.document["rotor"][shaft_index] = {"carrier": carrier, **shaft}
        for place, bearing in self.entries("bearing"):
            if bearing.get("rotor") in rotors and "seat" not in bearing:
                self.document["bearing"][place] = {**bearing, "seat": carrier}
        try:
            turns = self._angles(one)
            errors = self._pin_errors(one, len(turns))
            places = self._places(one, rotors)
        except (PydanticCustomError, TypeError, ValueError):
            return  # its tables tell what is wrong with it
        if turns:
            self._copy(one, rotors, turns, errors, places)
            for key in ("count", "angles", "pin_errors"):
                one.pop(key, None)
        self._pair_gears(index, one, len(planets) if turns else 1)

    def _fixed(self, one: Mapping[str, Any]) -> Any:
        """Return what holds a member as a table, where it is given by a seat or a stiffness."""
        fixed = one.get("fixed")
        if isinstance(fixed, str) and not (self.named("gear", fixed) or self.named("rotor", fixed)):
            seats = look_up(self.document, ("housing", "seat"))
            if any(look_up(seat, ("name",)) == fixed for seat in (seats if isinstance(seats, list | tuple) else ())):
                return {"member": one.get("ring"), "seat": fixed}
        if isinstance(fixed, str | int | float) and not isinstance(fixed, bool):
            try:
                _TORSION.validate(fixed)
            except PydanticCustomError:
                return fixed
            return {"member": one.get("ring"), "stiffness": fixed}
        return fixed

    def _way(self, one: Mapping[str, Any], planets: Sequence[Any]) -> list[tuple[str, str]]:
        """Return driver and driven gear of each mesh between sun, one planet and ring, in the order of the power.

        One gear of each rotor meshes with its neighbours; both gears of a stepped planet are on one rotor.
        """
        way = [name for name in (one.get("sun"), *planets, one.get("ring")) if isinstance(name, str)]
        if self._drives_from_ring(one):
            way.reverse()
        return [ends for ends in pairwise(way) if self._rotor_of(ends[0]) != self._rotor_of(ends[1])]

    def _pair_gears(self, index: int, one: Mapping[str, Any], of_each: int) -> None:
        """Add the pairs of sun, ring and planets, ``of_each`` gears of every planet, of which the file has none."""
        listed, planets = self.document.setdefault("gear_pair", []), list(one["planets"])
        if not isinstance(listed, list):
            return
        gears, central = set(planets), {name for name in (one.get("sun"), one.get("ring")) if isinstance(name, str)}
        pairs = [[pair.get("driver"), pair.get("driven")] for _, pair in self.entries("gear_pair")]
        written = [set(pair) for pair in pairs if _are_names(pair)]
        ways = [self._way(one, planets[place : place + of_each]) for place in range(0, len(planets), of_each)]
        for meshes in zip(*ways, strict=False):
            for driver, driven in meshes:
                ends = {driver, driven}
                known = (pair & central & ends if ends & central else pair <= gears for pair in written if pair & gears)
                if any(known):
                    continue
                self.origins["gear_pair", len(listed)] = ("planetary", index)
                listed.append({"driver": driver, "driven": driven})

    def _rotor_of(self, gear: str) -> object:
        entry = self.named("gear", gear)
        return None if entry is None else entry.get("rotor")

    def _drives_from_ring(self, one: Mapping[str, Any]) -> bool:
        """Whether power passes from the ring to the sun, as the carrier sees it."""
        given = look_up(self.document, ("operation", "rotor"))
        ring, fixed = one.get("ring"), one.get("fixed")
        held = [fixed if isinstance(fixed, str) else look_up(one, ("fixed", "member"))]
        held += [support.get("member") for _, support in self.entries("torque_support")]
        ring_names = {ring, self._rotor_of(ring)} if isinstance(ring, str) else set()
        return bool(
            isinstance(given, str)
            and (given in ring_names or (given == one.get("carrier") and any(name in ring_names for name in held)))
        )

    def _angles(self, one: Mapping[str, Any]) -> list[float]:
        angles, count = one.get("angles"), one.get("count")
        if angles is not None:
            if count is not None and (not isinstance(angles, list | tuple) or count != len(angles)):
                raise ValueError
            return [_ANGLE.validate(angle) for angle in angles] if isinstance(angles, list | tuple) else []
        if count is None:
            return []
        number = Whole(1, MOST_PLANETS).validate(count)
        return [2.0 * math.pi * n / number for n in range(number)]

    def _pin_errors(self, one: Mapping[str, Any], count: int) -> list[tuple[float, float]]:
        errors = one.get("pin_errors", [0.0] * count)
        found = [
            tuple(_LENGTH.validate(part) for part in error)
            if isinstance(error, list | tuple)
            else (0.0, _LENGTH.validate(error))
            for error in errors
        ]
        if len(found) != count or any(len(error) != 2 for error in found):
            raise ValueError
        return found  # type: ignore[return-value]

    def _axis(self, rotor: str) -> tuple[float, float]:
        entry = self.named("rotor", rotor) or {}
        x, y = entry.get("axis", (0.0, 0.0))
        return _LENGTH.validate(x), _LENGTH.validate(y)

    def _places(self, one: Mapping[str, Any], rotors: Sequence[str]) -> list[tuple[float, float]]:
        """Return the place of each rotor of the planet from the carrier's axis [m]: its `axis`, or along x."""
        centre, places = self._axis(one["carrier"]), []
        for rotor in rotors:
            entry = self.named("rotor", rotor) or {}
            if "axis" in entry:
                x, y = self._axis(rotor)
                places.append((x - centre[0], y - centre[1]))
            else:
                places.append((self._centre_distance(one, rotor), 0.0))
        return places

    def _centre_distance(self, one: Mapping[str, Any], rotor: str) -> float:
        """Return the distance at which a planet meshes with the sun, or without one with the ring [m]; 0 if unknown."""
        from gearwhine.coupling.gears import GearError, GearPairGeometry

        central = one.get("sun") or one.get("ring")
        written = [(pair.get("driver"), pair.get("driven")) for _, pair in self.entries("gear_pair")]
        for names in [*written, *self._way(one, one["planets"])]:
            others = [name for name in names if name != central]
            if central not in names or len(others) != 1 or self._rotor_of(str(others[0])) != rotor:
                continue
            try:
                entries = [_of_planet(self.named("gear", name) or {}, 0, MOST_PLANETS) for name in names]
                gears = [Gear.model_validate(entry, context=dict(self.context)).build() for entry in entries]
                return abs(GearPairGeometry(gears[0], gears[1]).working_centre_distance)
            except (ValidationError, GearError, ValueError):
                return 0.0
        return 0.0

    def _copy(
        self,
        one: dict[str, Any],
        rotors: Sequence[str],
        turns: Sequence[float],
        errors: Sequence[tuple[float, float]],
        places: Sequence[tuple[float, float]],
    ) -> None:
        """Replace the tables of one planet by those of all."""
        centre = self._axis(one["carrier"])
        own = [str(entry["name"]) for _, entry in self.entries("gear") if entry.get("rotor") in rotors]

        def turned(entry: dict[str, Any], number: int) -> dict[str, Any]:
            (x, y), turn = places[list(rotors).index(entry["name"])], turns[number]
            cosine, sine = math.cos(turn), math.sin(turn)
            axis = [centre[0] + cosine * x - sine * y, centre[1] + sine * x + cosine * y]
            copied = {**entry, "axis": axis, "name": _numbered(entry["name"], number)}
            return copied | ({"pin_error": list(errors[number])} if any(errors[number]) else {})

        def renamed(*keys: str) -> Callable[[dict[str, Any], int], dict[str, Any]]:
            taken = {*own, *rotors}
            return lambda entry, number: {
                **entry,
                **{key: _numbered(entry[key], number) for key in keys if key == "name" or entry.get(key) in taken},
            }

        count = len(turns)
        bearings = {entry.get("name") for _, entry in self.entries("bearing") if entry.get("rotor") in rotors}
        self._replicate("rotor", lambda entry: entry.get("name") in rotors, turned, count)
        on_copy = renamed("name", "rotor")
        self._replicate(
            "gear",
            lambda entry: entry.get("name") in own,
            lambda entry, number: _of_planet(on_copy(entry, number), number, count),
            count,
        )
        self._replicate(
            "bearing",
            lambda entry: entry.get("rotor") in rotors and isinstance(entry.get("name"), str),
            lambda entry, number: _with_turned_spalls(_of_planet(on_copy(entry, number), number, count), turns[number]),
            count,
        )
        self._replicate(
            "gear_pair",
            lambda entry: bool({entry.get("driver"), entry.get("driven")} & set(own)),
            renamed("driver", "driven"),
            count,
        )
        one["planets"] = [_numbered(name, number) for number in range(count) for name in one["planets"]]
        self._rename_paths({"rotor": set(rotors), "gear": set(own), "bearing": bearings}, count)

    def _replicate(
        self,
        kind: str,
        chosen: Callable[[dict[str, Any]], bool],
        made: Callable[[dict[str, Any], int], dict[str, Any]],
        count: int,
    ) -> None:
        listed = self.document.get(kind)
        for index, entry in self.entries(kind):
            if not isinstance(listed, list) or not chosen(entry):
                continue
            origin = self.origins.get((kind, index), (kind, index))
            copies = [made(entry, number) for number in range(count)]
            listed[index] = copies[0]
            for copied in copies[1:]:
                self.origins[kind, len(listed)] = origin
                listed.append(copied)

    def _rename_paths(self, names: Mapping[str, set[Any]], count: int) -> None:
        """Let key paths of `[provenance]` and `unusual` to a planet lead to each copy."""

        def paths(path: object) -> list[Any]:
            steps = parse_key_path(path) if isinstance(path, str) else None
            if steps is None or len(steps) < 2 or steps[1] not in names.get(steps[0], ()):
                return [path]
            rest = "".join(f".{step}" if step.isalnum() or "_" in step else f'."{step}"' for step in steps[2:])
            return [f'{steps[0]}."{_numbered(steps[1], number)}"{rest}' for number in range(count)]

        table, listed = self.document.get("provenance"), self.document.get("unusual")
        if isinstance(table, dict):
            self.document["provenance"] = {new: value for path, value in table.items() for new in paths(path)}
        if isinstance(listed, list | tuple):
            self.document["unusual"] = [new for path in listed for new in paths(path)]


def _of_planet(entry: dict[str, Any], number: int, count: int) -> dict[str, Any]:
    """Return the table of a gear or bearing with those faults and errors that its planet has, by its number from 0.

    A `planet` that is not the number of one is left, to be refused.
    """

    def belongs(table: object) -> bool:
        planet = table.get("planet") if isinstance(table, Mapping) else None
        return type(planet) is not int or not 1 <= planet <= count or planet == number + 1

    def taken(table: Any) -> Any:
        planet = table.get("planet") if isinstance(table, Mapping) else None
        return {key: value for key, value in table.items() if key != "planet"} if planet == number + 1 else table

    faults, errors = entry.get("fault", []), entry.get("errors", {})
    listed = faults if isinstance(faults, list | tuple) else [faults]
    own = [taken(fault) for fault in listed if belongs(fault)]
    changed = {**entry, "fault": own, "errors": taken(errors) if belongs(errors) else {}}
    return {key: value for key, value in changed.items() if key in entry}


def _with_turned_spalls(entry: dict[str, Any], turn: float) -> dict[str, Any]:
    """Return a bearing's table whose spalls of the rings stand to its planet as they do to the first one.

    An azimuth that cannot be read is left, to be refused.
    """

    def turned(fault: Any) -> Any:
        if not isinstance(fault, Mapping) or fault.get("on") not in ("outer", "inner"):
            return fault
        try:
            return {**fault, "azimuth": _ANGLE.validate(fault.get("azimuth", 0.0)) + turn}
        except (PydanticCustomError, ValueError):
            return fault

    return {**entry, "fault": [turned(fault) for fault in entry["fault"]]} if "fault" in entry else entry


def _numbered(name: str, number: int) -> str:
    return f"{name} {number + 1}"
