"""Bulk data of Nastran: cards in free and fixed fields; reader of nodes, their coordinate systems, solids and shells.

meshio reads these files too, but takes every node for one of the basic coordinate system, follows no INCLUDE, and
passes over elements in large fields and in small letters.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gearwhine.meshes.elements import NO_NODE, ElementBlock
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.content import MeshContent
from gearwhine.numerics.arrays import FloatArray, IntArray

ENDINGS = (".bdf", ".fem", ".nas")
"""Endings of the files that are bulk data of Nastran."""

_DAT = ".dat"  # an ending of many programs
_SNIFFED = 1_000_000  # bytes within which a deck of Nastran shows that it is one
_OF_NASTRAN = re.compile(
    rb"^\s*(BEGIN\s+BULK|CEND\b|SOL\s+\d+|ENDDATA)|^(GRID|CHEXA|CTETRA|CPENTA|GRDSET)(\*?[ \t]+\d|\*?\s*,|\*)",
    re.IGNORECASE | re.MULTILINE,
)

# Solids by their number of nodes, and the place in the deck of each node in VTK's order where that is another one.
_SOLIDS = {
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
}
# The uprights come before the edges of the lid.
_TO_VTK = {
    "wedge15": [*range(9), 12, 13, 14, 9, 10, 11],
    "hexahedron20": [*range(12), 16, 17, 18, 19, 12, 13, 14, 15],
}
_SHELLS = {"CTRIA3": 3, "CTRIAR": 3, "CTRIA6": 3, "CQUAD4": 4, "CQUADR": 4, "CQUAD8": 4}
_SYSTEMS = {f"CORD{way}{kind}": (way, kind) for way in (1, 2) for kind in "RCS"}
_CARDS_READ = {"GRID", "GRDSET", "EXTRN", *_SOLIDS, *_SHELLS, *_SYSTEMS}
# Other solids (pyramids, those of p elements) and cards that make elements; a card "=" repeats the one before it.
_REFUSED = re.compile(r"C(I?HEX|TET|PEN|PYR)|CGEN$|=")
_DEPTH = 20  # levels of files that include files
_EXPONENT = re.compile(r"(?<=[\d.])(?=[+-])")  # of 1.5-3, which is 1.5e-3

_Place = tuple[Path, int]


@dataclass
class Card:
    """A card with its fields after the name, continuations included."""

    name: str
    fields: list[str]
    place: _Place

    def integer(self, number: int) -> int:
        """Whole number of a field; 0 of one that is blank or absent."""
        text = self.fields[number] if number < len(self.fields) else ""
        return int(text) if text else 0

    def real(self, number: int) -> float:
        """Real number of a field; 0 of one that is blank or absent."""
        text = self.fields[number] if number < len(self.fields) else ""
        return _real(text) if text else 0.0


@dataclass
class Bulk:
    """Content of the bulk data read so far, by the deck's own numbers."""

    grids: dict[int, tuple[int | None, tuple[float, float, float]]] = field(default_factory=dict)
    default_system: int = 0
    motion_systems: dict[int, int | None] = field(default_factory=dict)
    default_motion_system: int = 0
    boundary: list[Card] = field(default_factory=list)
    systems: dict[int, Card] = field(default_factory=dict)
    solids: dict[str, list[tuple[int, list[int], Card]]] = field(default_factory=dict)
    shells: list[tuple[int, list[int]]] = field(default_factory=list)


@dataclass(frozen=True)
class _System:
    """A coordinate system: its kind R, C or S, its origin and its axes as rows, both in the basic one."""

    kind: str
    origin: FloatArray
    axes: FloatArray

    def basic(self, places: FloatArray) -> FloatArray:
        """Return places in the basic system; angles are in degrees, that from the axis first in spherical ones."""
        first, second, third = places.T
        if self.kind == "C":
            turn = np.deg2rad(second)
            local = np.stack([first * np.cos(turn), first * np.sin(turn), third], axis=1)
        elif self.kind == "S":
            tilt, turn = np.deg2rad(second), np.deg2rad(third)
            across = first * np.sin(tilt)
            local = np.stack([across * np.cos(turn), across * np.sin(turn), first * np.cos(tilt)], axis=1)
        else:
            local = places
        return np.asarray(self.origin + local @ self.axes)

    def axes_at(self, place: FloatArray) -> FloatArray:
        """Axes along which a node at a place of the basic system moves, as rows in the basic one, shape (3, 3)."""
        x, y, z = self.axes @ (place - self.origin)
        turn = np.arctan2(y, x)
        radial = np.array([np.cos(turn), np.sin(turn), 0.0])
        around = np.array([-np.sin(turn), np.cos(turn), 0.0])
        upward = np.array([0.0, 0.0, 1.0])
        if self.kind == "C":
            local = np.stack([radial, around, upward])
        elif self.kind == "S":
            tilt = np.arctan2(np.hypot(x, y), z)
            outward = np.sin(tilt) * radial + np.cos(tilt) * upward
            local = np.stack([outward, np.cos(tilt) * radial - np.sin(tilt) * upward, around])
        else:
            local = np.eye(3)
        return np.asarray(local @ self.axes)


def is_nastran(path: Path) -> bool:
    """Whether a file is a deck of Nastran: by its ending, or of ``.dat`` by executive statements or cards in it."""
    ending = path.suffix.lower()
    if ending != _DAT:
        return ending in ENDINGS
    with path.open("rb") as file:
        return _OF_NASTRAN.search(file.read(_SNIFFED)) is not None


def read_nastran(path: Path) -> MeshContent:
    """Read a deck of Nastran, or its bulk data alone.

    The solids of a property, and the facets of its shells, become the set ``property-N``. Nodes may stand in
    rectangular, cylindrical and spherical coordinate systems (CORD1x, CORD2x, GRDSET). Elements that are no solids,
    shells aside, are passed over.

    Raises
    ------
    GeometryError
        Where the deck holds pyramids or other unknown solids, cards that repeat or generate others, superelements, or
        references to numbers or files that are not there.
    """
    return _content(read_bulk(path), path)


def read_bulk(path: Path) -> Bulk:
    """Read the cards of a deck.

    Raises
    ------
    GeometryError
        As :func:`read_nastran`, where a card is wrong by itself.
    """
    bulk = Bulk()
    for card in _cards(_bulk_lines(path)):
        try:
            _take(bulk, card)
        except GeometryError:
            raise
        except ValueError as error:
            raise GeometryError(f"{where(card.place)}, card {card.name}: {error}; expected a number") from error
    return bulk


def included_decks(path: Path) -> Iterator[Path]:
    """Yield the files that a file itself includes, whether they exist or not."""
    if b"INCLUDE" in path.read_bytes().upper():
        for line, _ in _own_lines(path):
            if name := _included(line):
                yield path.parent / name


def where(place: _Place) -> str:
    """Return file and line in words."""
    return f"mesh file {place[0]}, line {place[1]}"


def _own_lines(path: Path) -> Iterator[tuple[str, _Place]]:
    """Yield the lines of a file without comments; the name of an included file in one line, where it goes over more."""
    pending, start = "", 0
    for number, raw in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        if raw.startswith(("#", "//")):
            continue
        line = pending + raw.partition("$")[0].expandtabs(8).rstrip()
        start = start if pending else number
        pending = ""
        if _is_include(line) and (line.count("'") == 1 or line.count('"') == 1):
            pending = line
        elif line:
            yield line, (path, start)
    if pending:
        yield pending, (path, start)


def _is_include(line: str) -> bool:
    return bool(re.match(r"\s*INCLUDE\b", line, re.IGNORECASE))


def _included(line: str) -> str:
    """Return the name of the file that a line includes, empty where it includes none."""
    return line.strip()[len("INCLUDE") :].strip(" ='\"") if _is_include(line) else ""


def _lines(path: Path, depth: int = 0) -> Iterator[tuple[str, _Place]]:
    """Yield the lines of a file and of those it includes."""
    if depth > _DEPTH:
        raise GeometryError(f"mesh file {path} is included {_DEPTH} files deep; does it include itself?")
    for line, place in _own_lines(path):
        if name := _included(line):
            if not (path.parent / name).is_file():
                raise GeometryError(f"{where(place)} includes {name!r}: no such file beside it")
            yield from _lines(path.parent / name, depth + 1)
        else:
            yield line, place


def _bulk_lines(path: Path) -> Iterator[tuple[str, _Place]]:
    """Yield the lines between BEGIN BULK and ENDDATA; both may be missing, as where gmsh writes bulk data alone."""
    lines = list(_lines(path))
    begins = [number for number, (line, _) in enumerate(lines) if re.match(r"\s*BEGIN\b", line, re.IGNORECASE)]
    if len(begins) > 1:
        again = where(lines[begins[1]][1])
        raise GeometryError(f"{again} begins bulk data again, of a superelement; write the deck without superelements")
    for line, place in lines[begins[0] + 1 if begins else 0 :]:
        if line.upper().startswith("ENDDATA"):
            return
        yield line, place


def _cards(lines: Iterator[tuple[str, _Place]]) -> Iterator[Card]:
    """Yield the cards that are taken, each with its continuations."""
    card: Card | None = None
    width, end = 0, ""  # fields that the card has by the end of its last whole line, and what that line ends with
    large = False
    for line, place in lines:
        head, data, tail, large = _split(line, large)
        if head[:1] not in ("", "+", "*"):
            if card is not None:
                yield card
            name = head.rstrip("*_ ").upper()  # CHEXA_ is how meshio writes bricks of 20 nodes
            if _REFUSED.match(name) and name not in _SOLIDS:
                raise GeometryError(
                    f"{where(place)}: card {name} is not known here; write the deck with every element on a card of "
                    f"its own, solids as {', '.join(_SOLIDS)}"
                )
            card = Card(name, [], place) if name in _CARDS_READ else None
            width = 0
        elif card is not None and len(head) > 1 and len(end) > 1 and head[1:] != end[1:]:
            raise GeometryError(
                f"{where(place)}: continuation {head!r} of card {card.name} follows a line that ends with {end!r}; "
                "write the deck sorted"
            )
        if card is not None:
            card.fields += [""] * (width - len(card.fields))
            card.fields += data
            width += max(len(data), 4 if large else 8)
            end = tail
    if card is not None:
        yield card


def _split(line: str, large_before: bool) -> tuple[str, list[str], str, bool]:
    """Return the first field of a line, its fields of data, its last field, and whether its fields are large.

    The continuation of a card in large fields is in such fields too, if it begins with a blank or a plus sign as well.
    """
    free = "," in line
    parts = [part.strip() for part in line.split(",")] if free else []
    head = parts[0] if free else line[:8].strip()
    large = head.endswith("*") or head.startswith("*") or (head[:1] in ("", "+") and large_before)
    last = 5 if large else 9
    if free:
        # Some writers put all fields of a card in one line.
        whole = len(parts) > last + 1 or (len(parts) == last + 1 and parts[last].isdecimal())
        return head, parts[1:] if whole else parts[1:last], "" if whole else "".join(parts[last:]), large
    step = 16 if large else 8
    data = [line[start : start + step].strip() for start in range(8, min(len(line), 72), step)]
    # Blank or +, the first character of a continuation's name is none of it.
    return head, data, line[72:80].rstrip(), large


def _real(text: str) -> float:
    """Convert a real number of Nastran, such as 1.5-3 or 1.5D-3."""
    text = text.upper().replace("D", "E")
    return float(text if "E" in text else _EXPONENT.sub("E", text))


def _take(bulk: Bulk, card: Card) -> None:
    if card.name == "GRID":
        place = (card.real(2), card.real(3), card.real(4))
        system = card.integer(1) if len(card.fields) > 1 and card.fields[1] else None
        if bulk.grids.setdefault(card.integer(0), (system, place)) != (system, place):
            raise GeometryError(f"{where(card.place)}: GRID {card.integer(0)} is there already, at another place")
        bulk.motion_systems[card.integer(0)] = card.integer(5) if len(card.fields) > 5 and card.fields[5] else None
    elif card.name == "GRDSET":
        bulk.default_system = card.integer(1)
        bulk.default_motion_system = card.integer(5)
    elif card.name == "EXTRN":
        bulk.boundary.append(card)
    elif card.name in _SYSTEMS:
        bulk.systems[card.integer(0)] = card
        if _SYSTEMS[card.name][0] == 1 and card.integer(4):  # two systems on one card
            bulk.systems[card.integer(4)] = Card(card.name, card.fields[4:8], card.place)
    elif card.name in _SHELLS:
        n_corners = _SHELLS[card.name]
        bulk.shells.append((card.integer(1), [int(number) for number in card.fields[2 : 2 + n_corners]]))
    else:
        nodes = [card.integer(number) for number in range(2, len(card.fields))]
        while nodes and not nodes[-1]:
            nodes.pop()
        kind = _SOLIDS[card.name].get(len(nodes))
        if kind is None or not all(nodes):
            numbers = " or ".join(map(str, _SOLIDS[card.name]))
            raise GeometryError(
                f"{where(card.place)}: {card.name} {card.integer(0)} has {np.count_nonzero(nodes)} nodes; "
                f"expected {numbers}, without gaps"
            )
        bulk.solids.setdefault(kind, []).append((card.integer(1), nodes, card))


def _content(bulk: Bulk, path: Path) -> MeshContent:
    position = {number: place for place, number in enumerate(bulk.grids)}
    solids: list[ElementBlock] = []
    properties: list[int] = []
    for kind, elements in bulk.solids.items():
        for _, nodes, card in elements:
            if absent := [node for node in nodes if node not in position]:
                raise GeometryError(
                    f"{where(card.place)}: {card.name} {card.integer(0)} names GRID {absent[0]}, which is not there"
                )
        rows = np.array([[position[node] for node in nodes] for _, nodes, _ in elements], dtype=np.int64)
        solids.append(ElementBlock(kind, rows[:, _TO_VTK.get(kind, slice(None))]))
        properties += [number for number, _, _ in elements]
    facets: dict[int, list[list[int]]] = {}
    for number, nodes in bulk.shells:
        corners = [position.get(node, NO_NODE) for node in nodes]
        if NO_NODE in corners:
            raise GeometryError(f"mesh file {path} has a shell with a GRID that is not there")
        facets.setdefault(number, []).append([*corners, *[NO_NODE] * (4 - len(corners))])
    numbers = np.array(properties, dtype=np.int64)
    return MeshContent(
        points=grid_points(bulk, path),
        solids=tuple(solids),
        volumes={_named(number): np.flatnonzero(numbers == number) for number in np.unique(numbers).tolist() if number},
        shells={_named(number): _rows(rows) for number, rows in facets.items() if number},
    )


def _named(number: int) -> str:
    return f"property-{number}"


def _rows(rows: list[list[int]]) -> IntArray:
    return np.array(rows, dtype=np.int64).reshape(-1, 4)


def grid_points(bulk: Bulk, path: Path) -> FloatArray:
    """Return the nodes in the basic coordinate system."""
    points = np.array([place for _, place in bulk.grids.values()], dtype=np.float64).reshape(-1, 3)
    owners = np.array([_owner(bulk, number) for number in bulk.grids], dtype=np.int64)
    moved = points.copy()
    for number in np.unique(owners).tolist():
        if number:
            inside = owners == number
            moved[inside] = grid_system(bulk, number, path, ()).basic(points[inside])
    return moved


def _owner(bulk: Bulk, grid: int) -> int:
    """Return the number of the coordinate system in which a node stands, 0 for the basic one."""
    system, _ = bulk.grids[grid]
    return bulk.default_system if system is None else system


def grid_system(bulk: Bulk, number: int, path: Path, within: tuple[int, ...]) -> _System:
    """Return a coordinate system, which may itself stand in another one."""
    if number == 0:
        return _System("R", np.zeros(3), np.eye(3))
    if number not in bulk.systems:
        raise GeometryError(
            f"mesh file {path} has nodes in coordinate system {number}, and no card of {', '.join(_SYSTEMS)} defines "
            "it; write the deck in the basic coordinate system"
        )
    card = bulk.systems[number]
    if number in within:
        raise GeometryError(f"{where(card.place)}: coordinate system {number} is defined by itself")
    way, kind = _SYSTEMS[card.name]
    if way == 2:
        given = np.array([card.real(field_number) for field_number in range(2, 11)]).reshape(3, 3)
        three = grid_system(bulk, card.integer(1), path, (*within, number)).basic(given)
    else:
        three = np.empty((3, 3))
        for place, grid in enumerate(card.integer(field_number) for field_number in (1, 2, 3)):
            if grid not in bulk.grids:
                raise GeometryError(f"{where(card.place)}: {card.name} {number} names GRID {grid}, which is not there")
            owner = grid_system(bulk, _owner(bulk, grid), path, (*within, number))
            three[place] = owner.basic(np.array([bulk.grids[grid][1]]))[0]
    # The origin, a point of the third axis, and one of the half plane of the first and third.
    origin, axis, plane = three
    third = axis - origin
    second = np.cross(third, plane - origin)
    if not np.linalg.norm(second) > 1e-9 * np.linalg.norm(third) * np.linalg.norm(plane - origin):
        raise GeometryError(f"{where(card.place)}: the three points of {card.name} {number} are on one line")
    third, second = third / np.linalg.norm(third), second / np.linalg.norm(second)
    return _System(kind, origin, np.stack([np.cross(second, third), second, third]))
