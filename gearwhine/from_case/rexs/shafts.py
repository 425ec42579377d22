"""Rotors of a case as shafts of a REXS model, with sections, couplings, additional masses and materials.

A shaft of the schema is of one material and has no gaps: a rotor of several materials, or with couplings among its
segments, is several shafts, which couplings join.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from gearwhine.case import CaseError, Problem
from gearwhine.case.housing import Material
from gearwhine.case.rotors import CouplingSegment, Disc, Rotor, Segment
from gearwhine.exchange.rexs.materials import PROPERTIES
from gearwhine.exchange.rexs.model import Attribute
from gearwhine.exchange.rexs.shafts import COUPLING_STIFFNESS, INERTIAS
from gearwhine.from_case.rexs.sheet import Sheet, plain, quantities, quantity, vector

_HELD = ("name", "axis", "carrier", "start", "material", "segments", "discs")


@dataclass
class Piece:
    """A shaft of the model: its number, and where it begins and ends on its rotor [m]."""

    number: int
    start: float
    end: float


@dataclass
class Shafts:
    """The shafts of all rotors.

    Attributes
    ----------
    sheet : Sheet
    unit, casing : int
        Numbers of gear unit and casing.
    materials : mapping of str to int
        Component of each material of the case.
    pieces : dict of str to list of Piece
        Shafts of each rotor, by name.
    """

    sheet: Sheet
    unit: int
    casing: int
    materials: Mapping[str, int] = field(default_factory=dict)
    pieces: dict[str, list[Piece]] = field(default_factory=dict)

    def place(self, rotor: str, at: float) -> tuple[int, float]:
        """Return the shaft of a station on a rotor, and the station on it [m]; of one in a coupling the nearest."""
        piece = min(self.pieces[rotor], key=lambda one: max(one.start - at, at - one.end, 0.0))
        return piece.number, min(max(at, piece.start), piece.end) - piece.start

    def first(self, rotor: str) -> int:
        """Return the first shaft of a rotor."""
        return self.pieces[rotor][0].number


def add_materials(sheet: Sheet, materials: Mapping[str, Material]) -> dict[str, int]:
    """Add the materials of a case; return their numbers by name."""
    found = {}
    for name, material in materials.items():
        attributes = {
            attribute: quantity(getattr(material, key), measure)
            for key, attribute, measure in PROPERTIES
            if getattr(material, key) is not None
        }
        found[name] = sheet.add("material", name, attributes)
        sheet.left_out(f'material "{name}"', material, [key for key, _, _ in PROPERTIES])
    return found


def add_shafts(rotors: Sequence[Rotor], materials: Mapping[str, Material], shafts: Shafts) -> None:
    """Add the shafts of every rotor.

    Raises
    ------
    CaseError
        Where a file holds a rotor, or a coupling has no shaft on either side.
    """
    problems = [
        problem for place, rotor in enumerate(rotors) if (problem := _cannot_be_shafts(place, rotor)) is not None
    ]
    if problems:
        raise CaseError(problems)
    for rotor in rotors:
        _add_rotor(rotor, materials, shafts)


def _cannot_be_shafts(place: int, rotor: Rotor) -> Problem | None:
    if rotor.file is not None:
        expected = "segments of the case: a rotor of a file is not exported"
        return Problem(f"rotor[{place}].file", str(rotor.file), expected)
    kinds = [isinstance(segment, CouplingSegment) for segment in rotor.segments]
    if kinds[0] or kinds[-1] or any(one and other for one, other in itertools.pairwise(kinds)):
        return Problem(f"rotor[{place}].segments", rotor.name, "a piece of shaft on either side of each coupling")
    return None


def _add_rotor(rotor: Rotor, materials: Mapping[str, Material], shafts: Shafts) -> None:
    sheet, about, station = shafts.sheet, f'rotor "{rotor.name}"', 0.0
    pieces: list[Piece] = []
    waiting: CouplingSegment | None = None
    material: str | None = None
    for segment in rotor.segments:
        if isinstance(segment, CouplingSegment):
            waiting = segment
            sheet.left_out(about, segment, ("length", "coupling"), "segments: ")
        else:
            own = segment.material or rotor.material
            if not pieces or waiting is not None or own != material:
                piece = _add_shaft(rotor, station, own, shafts, len(pieces))
                if pieces:
                    _couple(about, waiting, pieces[-1], piece, shafts)
                pieces.append(piece)
                material, waiting = own, None
            _add_section(segment, station, pieces[-1], sheet, about)
            pieces[-1].end = station + segment.length
        station += segment.length
    shafts.pieces[rotor.name] = pieces
    for disc in rotor.discs:
        built = disc.build(rotor, materials)
        shaft, at = shafts.place(rotor.name, disc.at)
        attributes = {
            "u_coordinate_on_shaft": quantity(at, "m"),
            "mass_of_component": quantity(built.mass, "kg"),
            **quantities({name: getattr(built, key) for key, name in INERTIAS}, "kg*m^2"),
            "moment_of_inertia_w_axis": quantity(built.diametral_inertia, "kg*m^2"),
        }
        sheet.part(shaft, "additional_mass", attributes=attributes)
        if not isinstance(disc, Disc):
            sheet.notes.changed(about, "a disc of width and diameter is written by its mass and moments of inertia")
    sheet.left_out(about, rotor, _HELD)


def _add_shaft(rotor: Rotor, station: float, material: str | None, shafts: Shafts, place: int) -> Piece:
    """Add a shaft that begins at a station of its rotor."""
    name = rotor.name if place == 0 else f"{rotor.name}, part {place + 1}"
    # u, v, w of the gear unit are z, x, y of the machine.
    origin = (rotor.start + station, *rotor.axis)
    number = shafts.sheet.part(shafts.unit, "shaft", name, placed(shafts.unit, origin))
    if material is not None:
        shafts.sheet.relate("reference", origin=number, referenced=shafts.materials[material])
    return Piece(number, station, station)


def placed(unit: int, origin: Iterable[float]) -> dict[str, Attribute]:
    """Return the attributes of a place in the gear unit, u, v, w [m], with its axes."""
    return {
        "reference_component_for_position": plain(unit),
        "support_vector": vector(origin),
        "u_axis_vector": vector((1e-3, 0.0, 0.0)),
        "w_axis_vector": vector((0.0, 0.0, 1e-3)),
    }


def _add_section(segment: Segment, station: float, piece: Piece, sheet: Sheet, about: str) -> None:
    bore = segment.bore
    lengths = {
        "u_coordinate_on_shaft": station - piece.start,
        "length": segment.length,
        "outer_diameter_begin": segment.diameter,
        "outer_diameter_end": segment.diameter if segment.right_diameter is None else segment.right_diameter,
        "inner_diameter_begin": bore,
        "inner_diameter_end": bore if segment.right_bore is None else segment.right_bore,
    }
    sheet.part(piece.number, "shaft_section", attributes=quantities(lengths, "m"))
    held = ("length", "diameter", "bore", "right_diameter", "right_bore", "material")
    sheet.left_out(about, segment, held, "segments: ")


def _couple(about: str, segment: CouplingSegment | None, left: Piece, right: Piece, shafts: Shafts) -> None:
    """Join two shafts: by a coupling segment, or without one rigidly."""
    sheet = shafts.sheet
    attributes = quantities(
        {"u_coordinate_on_shaft_inner_side": left.end - left.start, "u_coordinate_on_shaft_outer_side": 0.0}, "m"
    )
    if segment is not None:
        table = segment.coupling
        attributes |= {name: quantity(getattr(table, key), measure) for key, name, measure, _ in COUPLING_STIFFNESS}
        attributes |= {"mass_of_component": quantity(table.mass, "kg")}
        sheet.left_out(about, table, [*(key for key, *_ in COUPLING_STIFFNESS), "mass"], "coupling: ")
    number = sheet.add("coupling", attributes=attributes)
    sheet.relate("side", assembly=number, inner_part=left.number, outer_part=right.number)
