"""Input decks of Abaqus and CalculiX: keyword cards; reader and writer of nodes, solid elements, sets and surfaces.

meshio reads these files too, but gives an element set to the wrong block of elements where some blocks have none, and
knows no ``*SURFACE``. The reader takes flat decks, and decks with one instance of one of their parts.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np

from gearwhine.meshes.elements import KINDS, NO_NODE, ElementBlock, count
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.content import MeshContent, corner_rows, find_faces
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import IntArray

_LONGEST_FIELD = 20  # characters of a number that CalculiX reads
_DEPTH = 20  # levels of files that include files
_INCLUDE, _INPUT = "INCLUDE", "INPUT"
# Keywords that are read here, whose lines of data may stand in a file of their own.
_KEYWORDS_READ = {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"}
# Keywords that make, move or take away nodes or elements, and what to write in place of them.
_FLAT_DECK_ADVICE = "write the deck with every node and element in it (as preprocessors do), without this keyword"
_REFUSED = {"NGEN", "NCOPY", "NFILL", "NMAP", "ELGEN", "ELCOPY", "SYMMETRIC MODEL GENERATION", "IMPORT"}
_Member = TypeVar("_Member")
_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')  # outside of quotes


@dataclass(frozen=True)
class Card:
    """A keyword with its parameters, both upper case, and its lines of data.

    Attributes
    ----------
    keyword : str
        Keyword, such as ``ELSET``.
    parameters : dict of str to str
        Values without quotes; empty where a parameter has none.
    lines : list of list of str
        Items of each line; a comma at its end makes no item.
    place : str
        File and line, for messages.
    """

    keyword: str
    parameters: dict[str, str]
    lines: list[list[str]]
    place: str


def read_cards(path: Path) -> Iterator[Card]:
    """Yield the keyword cards of a file and of those it includes, without comments.

    Raises
    ------
    GeometryError
        Where an included file or one of data is missing, or a file includes itself.
    """
    yield from _cards(path, 0)


def included_files(path: Path) -> Iterator[Path]:
    """Yield the files that a file itself includes or takes lines of data from, whether they exist or not."""
    # Most decks include nothing and are long: their cards are made only where the word is in them.
    if _INPUT.encode() in path.read_bytes().upper():
        yield from (_included(card, path) for card in _own_cards(path) if _takes_file(card))


def _cards(path: Path, depth: int) -> Iterator[Card]:
    if depth > _DEPTH:
        raise GeometryError(f"mesh file {path} is included {_DEPTH} files deep; does it include itself?")
    for card in _own_cards(path):
        yield from _resolved(card, path, depth)


def _own_cards(path: Path) -> Iterator[Card]:
    """Yield the cards of a file itself, INCLUDE among them."""
    card: Card | None = None
    pending = ""
    for number, raw in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if line.startswith("*") or pending:
            pending += line
            if pending.endswith(","):  # the keyword goes on in the next line
                continue
            if card is not None:
                yield card
            card, pending = _card(pending, f"mesh file {path}, line {number}"), ""
        elif card is not None:
            card.lines.append(_items(line))
    if card is not None:
        yield card


def _resolved(card: Card, path: Path, depth: int) -> Iterator[Card]:
    """Yield the card itself, with its lines of data from another file, or the cards of the file that it includes."""
    if not _takes_file(card):
        yield card
        return
    other = _included(card, path)
    if not other.is_file():
        raise GeometryError(f"mesh file {path} includes {card.parameters.get(_INPUT, '')!r}: no such file")
    if card.keyword == _INCLUDE:
        yield from _cards(other, depth + 1)
        return
    for raw in other.read_text(encoding="utf-8", errors="replace").splitlines():
        line = raw.strip()
        if line.startswith("*") and not line.startswith("**"):
            raise GeometryError(f"{card.place}: {other} has a keyword, {line!r}; expected lines of data alone")
        if line and not line.startswith("**"):
            card.lines.append(_items(line))
    yield card


def _takes_file(card: Card) -> bool:
    return card.keyword == _INCLUDE or (card.keyword in _KEYWORDS_READ and _INPUT in card.parameters)


def _included(card: Card, path: Path) -> Path:
    """Return the file that a card names, relative to the file that it stands in; its folder where it names none."""
    return path.parent / card.parameters.get(_INPUT, "")


def _card(line: str, place: str) -> Card:
    word, *rest = _items(line[1:])
    pairs = [part.partition("=") for part in rest]
    parameters = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
    return Card(" ".join(word.upper().split()), parameters, [], place)


def _items(line: str) -> list[str]:
    return [item.strip().strip('"') for item in _COMMA.split(line.rstrip().removesuffix(","))]


# Solid elements by the number in their type, whatever letters follow (C3D10M, C3D8R, C3D20RH).
SOLID_TYPES = {
    "4": "tetra",
    "10": "tetra10",
    "8": "hexahedron",
    "20": "hexahedron20",
    "27": "hexahedron27",
    "6": "wedge",
    "15": "wedge15",
}
_SOLID_TYPE = re.compile(r"(?:C3D|DC3D|F3D)(\d+)[A-Z]*$")
# In the 27-node brick the centre comes before the middles of the faces bottom, top, front, right, back, left.
BRICK_27 = [*range(20), 26, 24, 25, 22, 21, 23, 20]
_TO_VTK = {"hexahedron27": [BRICK_27.index(place) for place in range(27)]}
# The faces S1, S2, ... by corners counted from one.
FACE_LABELS = {
    "tetra": ("123", "142", "243", "341"),
    "hexahedron": ("1234", "5678", "1562", "2673", "3784", "4851"),
    "wedge": ("123", "456", "1452", "2563", "3641"),
}


@dataclass
class _Deck:
    """Content of the deck read so far, by the deck's own numbers."""

    points: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[str, dict[int, list[int]]] = field(default_factory=dict)
    shells: dict[int, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    faces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    internal: set[str] = field(default_factory=set)


def read_abaqus(path: Path) -> MeshContent:
    """Read an input deck.

    Element sets become volumes, their shells sets of facets; surfaces of elements become sets of facets, and those of
    nodes node sets, as ``*NSET``. Elements that are no solids, facets aside, are passed over.

    Raises
    ------
    GeometryError
        Where the deck holds pyramids or other unknown solids, several instances or a moved one, keywords that generate
        nodes or elements, or references to missing numbers.
    """
    deck = _Deck()
    for card in _instanced(list(read_cards(path)), path):
        _take(deck, card)
    return _content(deck, path)


def _instanced(cards: list[Card], path: Path) -> Iterator[Card]:
    """Yield the cards outside of parts, and those of the part that is instanced; numbers are those of each part."""
    instances = [card for card in cards if card.keyword == "INSTANCE"]
    if len(instances) > 1:
        raise GeometryError(f"mesh file {path} assembles {len(instances)} instances; write one flat deck of them")
    parts = [card.parameters.get("NAME", "").upper() for card in cards if card.keyword == "PART"]
    for card in instances:
        if card.lines:
            raise GeometryError(f"{card.place}: an instance is moved; write a flat deck, where it stands in its place")
        part = card.parameters.get("PART", "")
        if parts and part.upper() not in parts:
            raise GeometryError(f"{card.place}: instance of part {part!r}, which is not there")
        parts = [part.upper()]
    if len(parts) > 1:
        raise GeometryError(f"mesh file {path} has {len(parts)} parts and no instance; write one flat deck of them")
    within: str | None = None
    for card in cards:
        if card.keyword == "PART":
            within = card.parameters.get("NAME", "").upper()
        elif card.keyword == "END PART":
            within = None
        elif within is None or within in parts:
            yield card


def _take(deck: _Deck, card: Card) -> None:
    if card.keyword in _REFUSED or (card.keyword == "SYSTEM" and card.lines):
        raise GeometryError(f"{card.place}: *{card.keyword} is not known here; {_FLAT_DECK_ADVICE}")
    if card.keyword == "NODE":
        numbers = []
        for number, *place in card.lines:
            coordinates = [float(value.upper().replace("D", "E") or 0.0) for value in (*place, "", "")[:3]]
            deck.points[int(number)] = _rectangular(coordinates, card)
            numbers.append(int(number))
        _add(deck.node_sets, card.parameters.get("NSET"), numbers)
    elif card.keyword == "ELEMENT":
        _take_elements(deck, card)
    elif card.keyword == "NSET":
        _add(deck.node_sets, card.parameters.get("NSET"), _members(card, deck.node_sets))
    elif card.keyword == "ELSET":
        _add(deck.element_sets, card.parameters.get("ELSET"), _members(card, deck.element_sets))
        if "INTERNAL" in card.parameters:  # a surface's set, not meant to be seen
            deck.internal.add(card.parameters.get("ELSET", ""))
    elif card.keyword == "SURFACE":
        name = card.parameters.get("NAME")
        if (card.parameters.get("TYPE") or "ELEMENT").upper() == "NODE":
            for first, *_ in card.lines:
                _add(deck.node_sets, name, _numbers(first, deck.node_sets))
        elif name is not None:
            _add(deck.faces, name, [(line[0], (line + [""])[1].upper()) for line in card.lines])


def _rectangular(place: list[float], card: Card) -> list[float]:
    """Return the rectangular coordinates of a node; with SYSTEM=C it has radius, angle in degrees and height."""
    system = (card.parameters.get("SYSTEM") or "R").upper()
    if system == "R":
        return place
    if system == "C":
        radius, angle, height = place
        return [radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle)), height]
    raise GeometryError(f"{card.place}: *NODE, SYSTEM={system} is not known here; write nodes with SYSTEM=R or C")


def _take_elements(deck: _Deck, card: Card) -> None:
    name = card.parameters.get("TYPE", "")
    kind = _kind(name)
    if kind is None:
        return
    rows = [[int(part) for part in line] for line in card.lines]
    if kind != "shell":
        # The nodes of one element may go on over several lines.
        items, width = [number for row in rows for number in row], 1 + KINDS[kind].n_nodes
        if len(items) % width:
            raise GeometryError(f"elements of type {name} have {width - 1} nodes each; some here have not")
        rows = [items[start : start + width] for start in range(0, len(items), width)]
    target = deck.shells if kind == "shell" else deck.elements.setdefault(kind, {})
    for number, *nodes in rows:
        target[number] = nodes
    _add(deck.element_sets, card.parameters.get("ELSET"), [row[0] for row in rows])


def _kind(name: str) -> str | None:
    """Map an element type of the deck to a solid kind, ``shell`` for plane elements of a surface, None for the rest."""
    name = name.upper()
    solid = _SOLID_TYPE.match(name)
    if solid:
        if solid[1] not in SOLID_TYPES:
            raise GeometryError(f"the file holds elements of type {name}, which are not known here")
        return SOLID_TYPES[solid[1]]
    return "shell" if re.match(r"(S|STRI|M3D|SFM3D|CPS|CPE|R3D|DS)\d", name) else None


def _add(sets: dict[str, list[_Member]], name: str | None, members: list[_Member]) -> None:
    """Add members to a set; names that differ in case alone are one, spelt as first written."""
    if name:
        known = name if name in sets else next((other for other in sets if other.upper() == name.upper()), name)
        sets.setdefault(known, []).extend(members)


def _members(card: Card, sets: dict[str, list[int]]) -> list[int]:
    if "GENERATE" in card.parameters:
        members: list[int] = []
        for line in card.lines:
            first, last, *step = (int(part) for part in line)
            members += range(first, last + 1, step[0] if step else 1)
        return members
    return [number for line in card.lines for part in line for number in _numbers(part, sets)]


def _numbers(part: str, sets: dict[str, list[int]]) -> list[int]:
    """Return a number, or the members of a named set; the instance before a point is ignored."""
    part = part if part.isdecimal() else part.rpartition(".")[2]
    if part.isdecimal():
        return [int(part)]
    if not part:
        return []
    by_name = {name.upper(): members for name, members in sets.items()}
    if part.upper() not in by_name:
        raise GeometryError(f"the file names a set {part!r} that is not in it")
    return by_name[part.upper()]


def _content(deck: _Deck, path: Path) -> MeshContent:
    try:
        place = {number: position for position, number in enumerate(deck.points)}
        solids: list[ElementBlock] = []
        where: dict[int, tuple[str, int]] = {}
        for kind, elements in deck.elements.items():
            nodes = np.array([[place[node] for node in nodes] for nodes in elements.values()], dtype=np.int64)
            where.update({number: (kind, count(solids) + member) for member, number in enumerate(elements)})
            solids.append(ElementBlock(kind, nodes[:, _TO_VTK.get(kind, slice(None))]))
        facets: dict[str, list[list[int]]] = {}
        volumes: dict[str, list[int]] = {}
        for name, members in deck.element_sets.items():
            for number in members if name not in deck.internal else ():
                if number in where:
                    volumes.setdefault(name, []).append(where[number][1])
                elif number in deck.shells:
                    facets.setdefault(name, []).append(_shell_corners(deck.shells[number], place))
        for name, faces in deck.faces.items():
            for part, label in faces:
                facets.setdefault(name, []).extend(_face_corners(deck, part, label, where, place, name))
        node_sets = {name: [place[number] for number in members] for name, members in deck.node_sets.items()}
    except KeyError as error:
        raise GeometryError(f"mesh file {path} names node {error.args[0]}, which is not in it") from error
    return MeshContent(
        points=np.array(list(deck.points.values()), dtype=np.float64).reshape(-1, 3),
        solids=tuple(solids),
        volumes={name: _sorted(members) for name, members in volumes.items()},
        facets={name: np.array(rows, dtype=np.int64) for name, rows in facets.items()},
        node_sets={name: _sorted(members) for name, members in node_sets.items()},
    )


def _sorted(members: list[int]) -> IntArray:
    return np.unique(np.array(members, dtype=np.int64))


def _shell_corners(nodes: list[int], place: dict[int, int]) -> list[int]:
    corners = 3 if len(nodes) in (3, 6) else 4
    return [*(place[node] for node in nodes[:corners]), *[NO_NODE] * (4 - corners)]


def _face_corners(
    deck: _Deck, part: str, label: str, where: dict[int, tuple[str, int]], place: dict[int, int], name: str
) -> Iterator[list[int]]:
    """Corners of face S1, S2, ... of an element or of the elements of a set."""
    for number in _numbers(part, deck.element_sets):
        if number in deck.shells:
            yield _shell_corners(deck.shells[number], place)
            continue
        if number not in where:
            raise GeometryError(f"surface {name!r} names element {number}, which is no solid of the file")
        kind = where[number][0]
        faces = FACE_LABELS[KINDS[kind].corners]
        if not re.fullmatch(r"S\d", label) or not 1 <= int(label[1]) <= len(faces):
            raise GeometryError(f"surface {name!r} names face {label!r} of a {kind}; expected S1 to S{len(faces)}")
        nodes = deck.elements[kind][number]
        corners = [place[nodes[int(corner) - 1]] for corner in faces[int(label[1]) - 1]]
        yield [*corners, *[NO_NODE] * (4 - len(corners))]


def write_abaqus(mesh: Mesh, path: Path) -> None:
    """Write an input deck: elements of full integration, volumes as element sets, surfaces of element faces.

    Raises
    ------
    GeometryError
        Where a facet of a named surface is no face of an element, or a name cannot stand in a deck.
    """
    for regions in (mesh.volumes, mesh.surfaces):
        spellings: dict[str, str] = {}
        for name in regions:
            if (other := spellings.setdefault(name.upper(), name)) != name:
                raise GeometryError(f"the names {other!r} and {name!r} differ in case alone, and are one in a deck")
    names = {kind: f"C3D{number}" for number, kind in SOLID_TYPES.items()}
    with path.open("w", encoding="utf-8") as file:
        file.write("*NODE\n")
        for number, place in enumerate(mesh.points.tolist(), start=1):
            file.write(f"{number}, " + ", ".join(map(_field, place)) + "\n")
        first = 1
        for block in mesh.blocks:
            file.write(f"*ELEMENT, TYPE={names[block.kind]}\n")
            order = BRICK_27 if block.kind == "hexahedron27" else slice(None)
            for number, nodes in enumerate((block.nodes[:, order] + 1).tolist(), start=first):
                # At most 16 numbers in a line.
                lines = [[number, *nodes[:15]], nodes[15:]] if len(nodes) > 15 else [[number, *nodes]]
                file.write(",\n".join(", ".join(map(str, line)) for line in lines) + "\n")
            first += len(block)
        for name, members in mesh.volumes.items():
            file.write(f"*ELSET, ELSET={_quoted(name)}\n")
            file.writelines(f"{number}\n" for number in (np.sort(members) + 1).tolist())
        for name, facets in mesh.surfaces.items():
            file.write(f"*SURFACE, TYPE=ELEMENT, NAME={_quoted(name)}\n")
            for block in facets:
                faces = find_faces(mesh, corner_rows(block))
                if (faces < 0).any():
                    raise GeometryError(f"surface {name!r} has facets that are no faces of elements")
                for number, place in zip(mesh.faces.element[faces] + 1, mesh.faces.source[faces], strict=True):
                    file.write(f"{number}, {_label(mesh.blocks[place[0]], int(place[2]))}\n")


def _field(value: float) -> str:
    """Return a number in at most 20 characters, as CalculiX reads it: 13 digits where all have no room."""
    return text if len(text := repr(value)) <= _LONGEST_FIELD else f"{value:.13g}"


def _quoted(name: str) -> str:
    if '"' in name or "\n" in name:
        raise GeometryError(f"the name {name!r} cannot stand in an input deck: it has a quotation mark or a line break")
    return name if re.fullmatch(r"\w+", name) else f'"{name}"'


def _label(block: ElementBlock, face: int) -> str:
    """Label S1, S2, ... of a face, by its number in the element kind."""
    corners = {corner + 1 for corner in block.of.corner_faces[face]}
    labels = [{int(corner) for corner in label} for label in FACE_LABELS[block.of.corners]]
    return f"S{labels.index(corners) + 1}"
