"""Shafts of a REXS file as `[[rotor]]`: sections, what is joined rigidly to one body, and carriers of planets.

Shafts on one axis that couplings join, and the plates and shafts of a planet carrier, are one rotor. Along it the
ring between the smallest bore and the largest diameter of all that stand side by side is taken.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from gearwhine.exchange.rexs.errors import RexsError, RexsProblem, wrong
from gearwhine.exchange.rexs.gear_unit import COUPLINGS, Connection, GearUnit
from gearwhine.exchange.rexs.materials import Materials
from gearwhine.exchange.rexs.model import Component
from gearwhine.exchange.rexs.notes import Notes
from gearwhine.exchange.rexs.placement import along
from gearwhine.exchange.rexs.quantities import mm, of

_SAME_AXIS = 1e-5  # distance of axes [m] within which shafts are on one line
_SAME_PLACE = 1e-7  # length [m] within which sections join
RIGID_RADIAL, RIGID_TILT = 1e10, 1e7
"""Stiffness [N/m, N m/rad] of a rigid connection: a hundred times that of a stiff bearing, and not so much that it
spoils the numbers of others. A greater one of the file is taken as this."""
COUPLING_STIFFNESS = (
    ("lateral_stiffness", "radial_stiffness", "N/m", RIGID_RADIAL),
    ("axial_stiffness", "axial_stiffness", "N/m", RIGID_RADIAL),
    ("tilt_stiffness", "bending_stiffness", "N*m/rad", RIGID_TILT),
    ("torsional_stiffness", "rotational_stiffness", "N*m/rad", RIGID_TILT),
)
"""Key of a coupling, attribute, SI unit and rigid value of each stiffness."""
INERTIAS = (
    ("polar_inertia", "moment_of_inertia_u_axis"),
    ("diametral_inertia", "moment_of_inertia_v_axis"),
)
"""Key of a disc, and attribute of an additional mass."""
_STRUTS_ACROSS, _STRUTS_TILTED = 1e11, 1e9
"""Stiffness [N/m, N m/rad] of what joins the plates of a carrier: above that of a solid shaft as wide."""
_NEAR_THE_END = 0.2  # part of a shaft's length beyond its end within which a part is taken for one at the end
_SHORTEST_COUPLING = 1e-4  # length [m] of a coupling between shafts that touch


@dataclass(frozen=True)
class Section:
    """A piece of a shaft or plate between two heights z [m], with its diameters at both [m]."""

    start: float
    end: float
    outer: tuple[float, float]
    inner: tuple[float, float]
    part: Component

    def at(self, z: float) -> tuple[float, float]:
        """Outer and inner diameter at a height [m]."""
        share = (z - self.start) / (self.end - self.start)
        outer, inner = (one + share * (other - one) for one, other in (self.outer, self.inner))
        return outer, inner


@dataclass(eq=False)
class Body:
    """Shafts and plates that are one rotor.

    Attributes
    ----------
    name : str
    notes : Notes
        Notes of the import, for places that are not quite on it.
    axis : tuple of float
        x and y of its axis [m].
    parts : list of Component
        Shafts and plates on the axis.
    sections : list of Section
        Their sections.
    couplings : list of Connection
        Couplings within it that are not rigid.
    carrier : Component or None
        Planet carrier that it is.
    pins : list of Component
        Pins of planets that it carries.
    """

    name: str
    notes: Notes
    axis: tuple[float, float]
    parts: list[Component]
    sections: list[Section] = field(default_factory=list)
    couplings: list[Connection] = field(default_factory=list)
    carrier: Component | None = None
    pins: list[Component] = field(default_factory=list)

    @property
    def start(self) -> float:
        """Height of its left end [m]."""
        return min(section.start for section in self.sections)

    @property
    def end(self) -> float:
        """Height of its right end [m]."""
        return max(section.end for section in self.sections)

    @property
    def label(self) -> str:
        """Label of the component that it is named for."""
        return (self.carrier or self.parts[0]).label

    def station(self, z: float, label: str) -> str:
        """Return the station of a height from the left end, for a case; a little beyond an end it is that end.

        Raises
        ------
        RexsError
            Where it is far beyond the ends.
        """
        at, length = z - self.start, self.end - self.start
        beyond = max(-at, at - length)
        if _SAME_PLACE < beyond <= _NEAR_THE_END * length:
            self.notes.changed(label, f'it stands {mm(beyond)} beyond the end of "{self.name}": taken at the end')
        elif beyond > _SAME_PLACE:
            raise wrong(
                label,
                f'a place on the shaft "{self.name}", from 0 to {length * 1e3:.6g} mm from its left end',
                f"{at * 1e3:.6g} mm",
            )
        return mm(min(max(at, 0.0), length))

    def diameter_at(self, z: float) -> float:
        """Outer diameter at a height [m], the largest of its parts; 0 beyond its ends."""
        there = [one for one in self.sections if one.start - _SAME_PLACE <= z <= one.end + _SAME_PLACE]
        return max((one.at(min(max(z, one.start), one.end))[0] for one in there), default=0.0)


@dataclass
class Bodies:
    """All bodies, and which of them a component belongs to."""

    bodies: list[Body]
    of_part: dict[int, Body]
    held: dict[Body, list[Connection]]
    """Couplings to the casing, of each body that has them."""

    def of(self, component: Component | None) -> Body | None:
        """Return the body of a shaft, a plate or a pin; None for others."""
        return None if component is None else self.of_part.get(component.number)

    def holds(self, body: Body) -> list[Connection]:
        """Return the couplings that hold a body in the casing."""
        return self.held.get(body, [])


def find_bodies(unit: GearUnit, materials: Materials) -> Bodies:
    """Return the bodies of a gear unit.

    Raises
    ------
    RexsError
        Where there is no shaft, a shaft has no sections, or shafts are not parallel.
    """
    shafts = list(unit.model.of_kind("shaft"))
    if not shafts:
        raise wrong("the file", "a gear unit with a shaft")
    plates = list(unit.model.of_kind("side_plate"))
    _require_parallel(unit, [*shafts, *plates])
    pins = _pins(unit)
    groups = _Groups([*shafts, *plates])
    carriers = _join_carriers(unit, groups, pins)
    held, soft = _join_coupled(unit, groups, pins)
    bodies, of_part = [], dict[int, Body]()
    for numbers in groups.sets():
        parts = [unit.model.components[number] for number in numbers if number not in pins]
        if not parts:
            continue
        carrier = next((carriers[number] for number in numbers if number in carriers), None)
        body = _body(unit, materials, parts, carrier)
        body.couplings = [one for one in soft if one.inner is not None and one.inner.number in numbers]
        bodies.append(body)
        of_part |= dict.fromkeys(numbers, body)
    for pin, carrier_number in pins.items():
        for one in bodies:
            if one.carrier is not None and one.carrier.number == carrier_number and pin in unit.model.components:
                one.pins.append(unit.model.components[pin])
                of_part[pin] = one
    holding: dict[Body, list[Connection]] = {}
    for number, connection in held:
        holding.setdefault(of_part[number], []).append(connection)
    return Bodies(bodies, of_part, holding)


class _Groups:
    """Sets of components that are joined to each other."""

    def __init__(self, components: Iterable[Component]) -> None:
        self._leader = {component.number: component.number for component in components}

    def __contains__(self, number: int) -> bool:
        return number in self._leader

    def leader(self, number: int) -> int:
        while self._leader[number] != number:
            number = self._leader[number]
        return number

    def join(self, one: int, other: int) -> None:
        first, second = sorted((self.leader(one), self.leader(other)))
        self._leader[second] = first

    def sets(self) -> Iterator[list[int]]:
        found: dict[int, list[int]] = {}
        for number in self._leader:
            found.setdefault(self.leader(number), []).append(number)
        yield from found.values()


def _require_parallel(unit: GearUnit, parts: Iterable[Component]) -> None:
    problems = [
        RexsProblem(part.label, "a shaft along the u-axis of the gear unit: all shafts of a case are parallel")
        for part in parts
        if along(unit.placement(part)) == 0
    ]
    if problems:
        raise RexsError(problems)


def _pins(unit: GearUnit) -> dict[int, int]:
    """Return the carrier of each planet's pin, by their numbers; its stage where the file has no carrier."""
    found = {}
    for relation in unit.model.of_relation("planet_pin"):
        stage, shaft = relation.role("planetary_stage"), relation.role("shaft")
        if stage is not None and shaft is not None:
            carrier = next(iter(unit.model.parts_of(stage, "planet_carrier")), None)
            found[shaft] = stage if carrier is None else carrier.number
    return found


def _join_carriers(unit: GearUnit, groups: _Groups, pins: dict[int, int]) -> dict[int, Component]:
    """Join the shafts and plates of each planet carrier; return the carrier of each by number."""
    found: dict[int, Component] = {}
    for stage in unit.model.of_kind("planetary_stage"):
        carrier = next(iter(unit.model.parts_of(stage.number, "planet_carrier")), None)
        members = [] if carrier is None else unit.model.parts_of(carrier.number, "shaft", "side_plate")
        numbers = [one.number for one in members if one.number not in pins]
        for relation in unit.model.of_relation("planet_carrier_shaft"):
            shaft = relation.role("shaft")
            if relation.role("planetary_stage") == stage.number and shaft is not None and shaft in groups:
                numbers.append(shaft)
        for number in numbers:
            if number in groups:
                groups.join(numbers[0], number)
                found[number] = carrier or stage
    return found


def _join_coupled(
    unit: GearUnit, groups: _Groups, pins: dict[int, int]
) -> tuple[list[tuple[int, Connection]], list[Connection]]:
    """Join what couplings connect on one axis; return those to the casing, with the part, and those that give way."""
    held, soft = [], []
    for connection in unit.connections(COUPLINGS):
        coupling = connection.component
        if not unit.is_engaged(coupling):
            unit.notes.left_out(coupling.label, "not engaged in this gear")
            continue
        ends = [one for one in connection.sides if one is not None and one.number in groups]
        casing = any(one is not None and one.kind == "gear_casing" for one in connection.sides)
        if len(ends) == 1 and casing:
            held.append((ends[0].number, connection))
        elif len(ends) == 2:
            if any(one.number in pins for one in ends):
                continue  # a pin in its carrier
            if not _on_one_axis(unit, *ends):
                raise wrong(coupling.label, "shafts on one axis, which a coupling joins")
            groups.join(ends[0].number, ends[1].number)
            if not is_rigid(coupling):
                soft.append(connection)
        elif len(ends) == 0:
            unit.notes.left_out(coupling.label, "it joins no shaft to another or to the casing")
    return held, soft


def is_rigid(coupling: Component) -> bool:
    """Whether a coupling is as good as rigid; without any stiffness it is taken as that."""
    stiffness = ((coupling.number_of(name, measure), rigid) for _, name, measure, rigid in COUPLING_STIFFNESS)
    return all(value is None or value >= rigid for value, rigid in stiffness)


def _on_one_axis(unit: GearUnit, one: Component, other: Component) -> bool:
    first, second = (unit.placement(part).origin for part in (one, other))
    return math.hypot(first[0] - second[0], first[1] - second[1]) <= _SAME_AXIS


def _body(unit: GearUnit, materials: Materials, parts: list[Component], carrier: Component | None) -> Body:
    """Return the body of some parts, with their sections."""
    first = parts[0]
    origin = unit.placement(first).origin
    named = next((one for one in parts if one.kind == "shaft"), first)
    if carrier is not None and carrier.kind == "planet_carrier":
        named = carrier
    axis = float(origin[0]), float(origin[1])
    body = Body(unit.names.of(named), unit.notes, axis, parts, carrier=carrier)
    for part in parts:
        if not _on_one_axis(unit, first, part):
            raise wrong(part.label, f'the axis of "{body.name}", to which it is joined')
        body.sections += _plate(unit, part) if part.kind == "side_plate" else _sections(unit, part)
    if not body.sections:
        raise wrong(first.label, "at least one shaft_section")
    body.sections.sort(key=lambda section: section.start)
    return body


def _plate(unit: GearUnit, plate: Component) -> list[Section]:
    """Return the section of a plate of a planet carrier."""
    length = plate.required("length", "m")
    outer, inner = plate.required("outer_diameter", "m"), plate.number_of("inner_diameter", "m") or 0.0
    return _checked(unit, plate, plate, 0.0, length, (outer, outer), (inner, inner))


def _sections(unit: GearUnit, shaft: Component) -> list[Section]:
    """Return the sections of a shaft; one without a coordinate follows the one before it."""
    found, reached = [], 0.0
    parts = unit.model.parts_of(shaft.number, "shaft_section")
    given = [part for part in parts if part.has("u_coordinate_on_shaft")]
    for part in sorted(parts, key=lambda one: one.number_of("u_coordinate_on_shaft", "m") or 0.0) if given else parts:
        begin = part.number_of("u_coordinate_on_shaft", "m")
        begin = reached if begin is None else begin
        if not part.has("length", "outer_diameter_begin"):
            unit.notes.left_out(part.label, "it has no sizes")
            continue
        length = part.required("length", "m")
        outer = part.required("outer_diameter_begin", "m")
        inner = part.number_of("inner_diameter_begin", "m") or 0.0
        outer_end, inner_end = (
            part.number_of("outer_diameter_end", "m"),
            part.number_of("inner_diameter_end", "m"),
        )
        outers = (outer, outer if outer_end is None else outer_end)
        inners = (inner, inner if inner_end is None else inner_end)
        found += _checked(unit, shaft, part, begin, length, outers, inners)
        reached = begin + length
    return found


def _checked(
    unit: GearUnit,
    shaft: Component,
    part: Component,
    begin: float,
    length: float,
    outer: tuple[float, float],
    inner: tuple[float, float],
) -> list[Section]:
    """Return a section in the machine's frame, once its sizes are those of a body; nothing for one without length."""
    if length < 0.0 or length > 100.0:
        raise wrong(f"{part.label}: length", "a length from 0 to 100 m", f"{length:g} m")
    if length < _SAME_PLACE:
        unit.notes.left_out(part.label, "it has no length")
        return []
    if not all(0.0 <= within < around <= 100.0 for within, around in zip(inner, outer, strict=True)):
        shown = f"{outer[0] * 1e3:g} and {inner[0] * 1e3:g} mm"
        raise wrong(part.label, "an outer diameter above the inner one, which is 0 or more", shown)
    start, end = unit.height(shaft, begin), unit.height(shaft, begin + length)
    if start <= end:
        return [Section(start, end, outer, inner, shaft)]
    return [Section(end, start, outer[::-1], inner[::-1], shaft)]


def rotor_table(unit: GearUnit, materials: Materials, body: Body, place: int) -> dict[str, Any]:
    """Return the `[[rotor]]` of a body.

    Raises
    ------
    RexsError
        Where its sections do not join.
    """
    main = max(body.sections, key=lambda one: (not materials.is_rigid(one.part), one.end - one.start)).part
    material = materials.name_for(main, *body.parts)
    table: dict[str, Any] = {
        "name": body.name,
        "axis": [mm(body.axis[0]), mm(body.axis[1])],
        "start": mm(body.start),
        "material": material,
        "segments": list(_segments(unit, materials, body, material, place)),
    }
    discs = [*_pin_discs(unit, materials, body, place), *_masses(unit, body)]
    if discs:
        table["discs"] = discs
    return table


def _segments(unit: GearUnit, materials: Materials, body: Body, usual: str, place: int) -> Iterator[dict[str, Any]]:
    """Yield the segments of a body from the left end to the right."""
    heights = [z for section in body.sections for z in (section.start, section.end)]
    soft = {coupling.component.number: coupling for coupling in body.couplings}
    ends = sorted(heights)
    joints = [ends[0], *(z for before, z in pairwise(ends) if z - before > _SAME_PLACE)]
    shortened = 0.0
    for left, right in pairwise(joints):
        middle = 0.5 * (left + right)
        there = [one for one in body.sections if one.start < middle < one.end]
        if body.carrier is not None and all(materials.is_rigid(one.part) for one in there):
            there = []  # by which programs mean the struts
        if not there:
            yield _filled(unit, body, left, right, soft, place)
            continue
        touching = [one for one in soft.values() if _parted_at(unit, body, one, left)]
        if touching and left > joints[0]:
            (coupling,) = touching[:1]
            yield _coupling(unit, body, soft.pop(coupling.component.number), _SHORTEST_COUPLING, place)
            shortened = _SHORTEST_COUPLING
        outer = [max(one.at(z)[0] for one in there) for z in (left, right)]
        inner = [min(one.at(z)[1] for one in there) for z in (left, right)]
        segment: dict[str, Any] = {"length": mm(right - left - shortened), "diameter": mm(outer[0])}
        shortened = 0.0
        if inner[0] > 0.0 or inner[1] > 0.0:
            segment["bore"] = mm(inner[0])
        if abs(outer[1] - outer[0]) > _SAME_PLACE:
            segment["right_diameter"] = mm(outer[1])
        if abs(inner[1] - inner[0]) > _SAME_PLACE:
            segment["right_bore"] = mm(inner[1])
        thickest = max(there, key=lambda one: one.at(middle)[0] ** 2 - one.at(middle)[1] ** 2)
        material = materials.name_for(thickest.part, *body.parts)
        if material != usual:
            segment["material"] = material
        yield segment
    for coupling in soft.values():
        text = "its shafts do not lie one behind the other: they are taken as joined rigidly"
        unit.notes.changed(coupling.component.label, text, "rotor", place)


def _parted_at(unit: GearUnit, body: Body, coupling: Connection, z: float) -> bool:
    """Whether the two sides of a coupling lie on either side of a height."""
    spans = []
    for side in coupling.sides:
        own = [one for one in body.sections if side is not None and one.part.number == side.number]
        if not own:
            return False
        spans.append((min(one.start for one in own), max(one.end for one in own)))
    (_, first_end), (second_start, second_end) = sorted(spans)
    return abs(first_end - z) <= _SAME_PLACE and second_start >= z - _SAME_PLACE and second_end > first_end


def _filled(
    unit: GearUnit, body: Body, left: float, right: float, soft: dict[int, Connection], place: int
) -> dict[str, Any]:
    """Return what joins the parts of a body over a gap."""
    for number, coupling in list(soft.items()):
        if _parted_at(unit, body, coupling, left):
            return _coupling(unit, body, soft.pop(number), right - left, place)
    beside = [one for one in body.sections if abs(one.end - left) < _SAME_PLACE or abs(one.start - right) < _SAME_PLACE]
    if body.carrier is not None:
        text = "what joins its plates beside the planets: rigid and without mass"
        unit.notes.assumed(body.carrier.label, text, "rotor", place, "segments")
        return {
            "length": mm(right - left),
            "coupling": {
                "lateral_stiffness": of(_STRUTS_ACROSS, "N/m"),
                "axial_stiffness": of(_STRUTS_ACROSS, "N/m"),
                "tilt_stiffness": of(_STRUTS_TILTED, "N*m/rad"),
                "torsional_stiffness": of(_STRUTS_TILTED, "N*m/rad"),
            },
        }
    if len(body.parts) == 1:
        raise wrong(body.label, "sections that join", f"a gap of {(right - left) * 1e3:g} mm")
    outer = min(max(one.outer) for one in beside)
    unit.notes.assumed(
        body.label, f"what joins its shafts over {mm(right - left)}: a shaft of {mm(outer)}", "rotor", place
    )
    return {"length": mm(right - left), "diameter": mm(outer)}


def _coupling(unit: GearUnit, body: Body, coupling: Connection, length: float, place: int) -> dict[str, Any]:
    """Return a coupling between two shafts of a body."""
    component, table = coupling.component, {}
    for key, name, measure, rigid in COUPLING_STIFFNESS:
        value = component.number_of(name, measure)
        if value is None or value > rigid:
            if value is None:
                unit.notes.assumed(component.label, f"no {name}: rigid", "rotor", place, "segments")
            value = rigid
        least = 1.0 if measure == "N/m" else 1e-3
        if value < least:
            unit.notes.changed(component.label, f"{name} of {value:g} {measure}: {least:g}", "rotor", place, "segments")
        table[key] = of(max(value, least), measure)
    mass = component.positive("mass_of_component", "kg")
    if mass is not None:
        table["mass"] = of(mass, "kg")
    return {"length": mm(length), "coupling": table}


def _pin_discs(unit: GearUnit, materials: Materials, body: Body, place: int) -> list[dict[str, Any]]:
    """Return the pins of a carrier's planets as one disc: their mass, and its moments of inertia about the axis."""
    mass = polar = lengthwise = first = 0.0
    for pin in body.pins:
        material = materials.name_for(pin, *body.parts)
        density = float(materials.tables[material]["density"].split()[0])
        origin = unit.placement(pin).origin
        radius = math.hypot(origin[0] - body.axis[0], origin[1] - body.axis[1])
        for section in _sections(unit, pin):
            length, middle = section.end - section.start, 0.5 * (section.start + section.end)
            outer, inner = section.at(middle)
            part = density * 0.25 * math.pi * (outer**2 - inner**2) * length
            mass += part
            polar += part * (radius**2 + (outer**2 + inner**2) / 8.0)
            lengthwise += part * (middle**2 + length**2 / 12.0)
            first += part * middle
    if mass == 0.0:
        return []
    z = min(max(first / mass, body.start), body.end)
    diametral = 0.5 * polar + max(lengthwise - mass * (first / mass) ** 2, 0.0)
    text = f"the {len(body.pins)} pins of its planets are a disc on it, and do not bend"
    unit.notes.changed(body.label, text, "rotor", place, "discs")
    return [
        {
            "at": body.station(z, body.label),
            "mass": of(mass, "kg"),
            "polar_inertia": of(polar, "kg*m^2"),
            "diametral_inertia": of(diametral, "kg*m^2"),
        }
    ]


def _masses(unit: GearUnit, body: Body) -> list[dict[str, Any]]:
    """Return the additional masses on the shafts of a body."""
    discs = []
    for part in body.parts:
        for mass in unit.model.parts_of(part.number, "additional_mass"):
            amount = mass.positive("mass_of_component", "kg")
            at = mass.number_of("u_coordinate_on_shaft", "m")
            if amount is None or at is None:
                unit.notes.left_out(mass.label, "it has no mass, or no place on its shaft")
                continue
            disc = {"at": body.station(unit.height(part, at), mass.label), "mass": of(amount, "kg")}
            inertias = ((key, mass.number_of(name, "kg*m^2")) for key, name in INERTIAS)
            disc |= {key: of(value, "kg*m^2") for key, value in inertias if value is not None and value > 0.0}
            if mass.has("eccentricity_vector") and any(mass.vector("eccentricity_vector") or ()):
                unit.notes.left_out(f"{mass.label}: eccentricity_vector", "its unbalance is not taken")
            discs.append(disc)
    return discs
