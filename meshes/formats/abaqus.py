"""Input decks of Abaqus and CalculiX: keyword cards; reader and writer of nodes, solid elements, sets and surfaces.

meshio reads these files too, but gives an element set to the wrong block of elements where some blocks have none, and
knows no ``*SURFACE``. The reader takes flat decks, and assemblies of instances of parts.
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
from gearwhine.meshes.formats.abaqus_assembly import Frame, Scope, local_system, moved, parted, shared_names
from gearwhine.meshes.formats.abaqus_cards import Card, read_cards
from gearwhine.meshes.formats.content import MeshContent, corner_rows, find_faces
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import IntArray

_LONGEST_FIELD = 20  # characters of a number that CalculiX reads
# Keywords that make, move or take away nodes or elements, and what to write in place of them.
_FLAT_DECK_ADVICE = "write the deck with every node and element in it (as preprocessors do), without this keyword"
_REFUSED = {"NGEN", "NCOPY", "NFILL", "NMAP", "ELGEN", "ELCOPY", "SYMMETRIC MODEL GENERATION", "IMPORT"}
_Member = TypeVar("_Member")


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
    """Content of the deck read so far, by numbers that are unique over all instances.

    Attributes
    ----------
    scope : Scope
        That of the cards that are taken.
    scopes : dict of str to Scope
        Instances by name, in capitals.
    shared : set of str
        Names of sets, in capitals, that several instances have: these are called INSTANCE.SET.
    system : Frame
        Coordinate system of the nodes to come (``*SYSTEM``).
    """

    scope: Scope = field(default_factory=Scope)
    scopes: dict[str, Scope] = field(default_factory=dict)
    shared: set[str] = field(default_factory=set)
    system: Frame | None = None

    points: dict[int, list[float]] = field(default_factory=dict)
    elements: dict[str, dict[int, list[int]]] = field(default_factory=dict)
    shells: dict[int, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    faces: dict[str, list[tuple[str, str, Scope]]] = field(default_factory=dict)
    internal: set[str] = field(default_factory=set)

    def enter(self, scope: Scope) -> None:
        """Take the cards of another scope from here on."""
        self.scope, self.system = scope, None
        if scope.name:
            self.scopes[scope.name.upper()] = scope

    def highest(self) -> int:
        """Return the highest number of a node or an element."""
        numbers = [*self.points, *self.shells, *(number for elements in self.elements.values() for number in elements)]
        return max(numbers, default=0)

    def named(self, name: str | None, scope: Scope) -> str | None:
        """Return the name of a set that a scope calls by its own name."""
        return f"{scope.name}.{name}" if name and scope.name and name.upper() in self.shared else name


def read_abaqus(path: Path) -> MeshContent:
    """Read an input deck.

    Element sets become volumes, their shells sets of facets; surfaces of elements become sets of facets, and those of
    nodes node sets, as ``*NSET``. Elements that are no solids, facets aside, are passed over. Instances stand where
    they are moved to; a set that several of them have is called INSTANCE.SET.

    Raises
    ------
    GeometryError
        Where the deck holds pyramids or other unknown solids, keywords that generate nodes or elements, or references
        to missing numbers, sets or parts.
    """
    deck = _Deck()
    parts, instances, outside = parted(read_cards(path))
    if not instances:
        if len(parts) > 1:
            raise GeometryError(f"mesh file {path} has {len(parts)} parts and no instance; write one flat deck of them")
        for card in [*(card for cards in parts.values() for card in cards), *outside]:
            _take(deck, card)
        return _content(deck, path)
    owned = []
    for instance in instances:
        part = instance.card.parameters.get("PART", "")
        if parts and part.upper() not in parts:
            raise GeometryError(f"{instance.card.place}: instance of part {part!r}, which is not there")
        owned.append([*parts.get(part.upper(), ()), *instance.cards])
    deck.shared = shared_names(owned)
    for instance, cards in zip(instances, owned, strict=True):
        name = instance.card.parameters.get("NAME", "")
        deck.enter(Scope(name, deck.highest(), moved(instance.card)))
        for card in cards:
            _take(deck, card)
    deck.enter(Scope(first=deck.highest()))
    for card in outside:
        _take(deck, card)
    return _content(deck, path)


def _take(deck: _Deck, card: Card) -> None:
    if card.keyword in _REFUSED:
        raise GeometryError(f"{card.place}: *{card.keyword} is not known here; {_FLAT_DECK_ADVICE}")
    inside = card.parameters.get("INSTANCE", "").upper()
    scope = deck.scopes.get(inside, deck.scope)
    if card.keyword == "SYSTEM":
        deck.system = local_system(card) if card.lines else None
    elif card.keyword == "NODE":
        numbers = []
        for number, *place in card.lines:
            coordinates = [float(value.upper().replace("D", "E") or 0.0) for value in (*place, "", "")[:3]]
            point = _rectangular(coordinates, card)
            for frame in (deck.system, scope.frame):
                point = point if frame is None else frame.place(np.array(point)).tolist()
            deck.points[scope.first + int(number)] = point
            numbers.append(scope.first + int(number))
        _add(deck.node_sets, deck.named(card.parameters.get("NSET"), scope), numbers)
    elif card.keyword == "ELEMENT":
        _take_elements(deck, card)
    elif card.keyword == "NSET":
        name = deck.named(card.parameters.get("NSET"), deck.scope)
        _add(deck.node_sets, name, _members(card, deck, deck.node_sets, scope))
    elif card.keyword == "ELSET":
        name = deck.named(card.parameters.get("ELSET"), deck.scope)
        _add(deck.element_sets, name, _members(card, deck, deck.element_sets, scope))
        if "INTERNAL" in card.parameters:  # a surface's set, not meant to be seen
            deck.internal.add(name or "")
    elif card.keyword == "SURFACE":
        name = deck.named(card.parameters.get("NAME"), deck.scope)
        if (card.parameters.get("TYPE") or "ELEMENT").upper() == "NODE":
            for first, *_ in card.lines:
                _add(deck.node_sets, name, _numbers(first, deck, deck.node_sets, scope))
        elif name is not None:
            _add(deck.faces, name, [(line[0], (line + [""])[1].upper(), scope) for line in card.lines])


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
    first = deck.scope.first
    for number, *nodes in rows:
        target[first + number] = [first + node for node in nodes]
    _add(deck.element_sets, deck.named(card.parameters.get("ELSET"), deck.scope), [first + row[0] for row in rows])


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


def _members(card: Card, deck: _Deck, sets: dict[str, list[int]], scope: Scope) -> list[int]:
    if "GENERATE" in card.parameters:
        members: list[int] = []
        for line in card.lines:
            first, last, *step = (int(part) for part in line)
            members += range(scope.first + first, scope.first + last + 1, step[0] if step else 1)
        return members
    return [number for line in card.lines for part in line for number in _numbers(part, deck, sets, scope)]


def _numbers(part: str, deck: _Deck, sets: dict[str, list[int]], scope: Scope) -> list[int]:
    """Return a number, or the members of a named set; both may be those of an instance, before a point."""
    if not part.isdecimal():
        before, _, part = part.rpartition(".")
        scope = deck.scopes.get(before.upper(), scope)
    if part.isdecimal():
        return [scope.first + int(part)]
    if not part:
        return []
    by_name = {name.upper(): members for name, members in sets.items()}
    for name in (deck.named(part, scope) or "", part):
        if name.upper() in by_name:
            return by_name[name.upper()]
    raise GeometryError(f"the file names a set {part!r} that is not in it")


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
        shells: dict[str, list[list[int]]] = {}
        volumes: dict[str, list[int]] = {}
        for name, members in deck.element_sets.items():
            for number in members if name not in deck.internal else ():
                if number in where:
                    volumes.setdefault(name, []).append(where[number][1])
                elif number in deck.shells:
                    shells.setdefault(name, []).append(_shell_corners(deck.shells[number], place))
        for name, faces in deck.faces.items():
            for part, label, scope in faces:
                members = _numbers(part, deck, deck.element_sets, scope)
                facets.setdefault(name, []).extend(_face_corners(deck, members, label, where, place, name))
        node_sets = {name: [place[number] for number in members] for name, members in deck.node_sets.items()}
    except KeyError as error:
        raise GeometryError(f"mesh file {path} names node {error.args[0]}, which is not in it") from error
    return MeshContent(
        points=np.array(list(deck.points.values()), dtype=np.float64).reshape(-1, 3),
        solids=tuple(solids),
        volumes={name: _sorted(members) for name, members in volumes.items()},
        facets={name: np.array(rows, dtype=np.int64) for name, rows in facets.items()},
        node_sets={name: _sorted(members) for name, members in node_sets.items()},
        shells={name: np.array(rows, dtype=np.int64) for name, rows in shells.items()},
    )


def _sorted(members: list[int]) -> IntArray:
    return np.unique(np.array(members, dtype=np.int64))


def _shell_corners(nodes: list[int], place: dict[int, int]) -> list[int]:
    corners = 3 if len(nodes) in (3, 6) else 4
    return [*(place[node] for node in nodes[:corners]), *[NO_NODE] * (4 - corners)]


def _face_corners(
    deck: _Deck, members: list[int], label: str, where: dict[int, tuple[str, int]], place: dict[int, int], name: str
) -> Iterator[list[int]]:
    """Corners of face S1, S2, ... of elements."""
    for number in members:
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
    """Return a number in at most 20 characters, as CalculiX reads it: with as many digits as have room."""
    texts = (repr(value), *(f"{value:.{digits}g}" for digits in range(16, 12, -1)))
    return next(text for text in texts if len(text) <= _LONGEST_FIELD)


def _quoted(name: str) -> str:
    if '"' in name or "\n" in name:
        raise GeometryError(f"the name {name!r} cannot stand in an input deck: it has a quotation mark or a line break")
    return name if re.fullmatch(r"\w+", name) else f'"{name}"'


def _label(block: ElementBlock, face: int) -> str:
    """Label S1, S2, ... of a face, by its number in the element kind."""
    corners = {corner + 1 for corner in block.of.corner_faces[face]}
    labels = [{int(corner) for corner in label} for label in FACE_LABELS[block.of.corners]]
    return f"S{labels.index(corners) + 1}"
