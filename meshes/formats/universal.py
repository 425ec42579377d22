"""Meshes in universal files of I-DEAS, NX, Salome and gmsh: nodes (2411), elements (2412) and groups (2467 and others).

Numbers stand in columns of ten characters. The nodes of a parabolic element go round its rings, corners and middles by
turns: the ring of the base, the middles of the uprights, the ring of the lid, or the apex of a tetrahedron.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gearwhine.meshes.elements import NO_NODE, SOLIDS, ElementBlock, count
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.content import MeshContent
from gearwhine.numerics.arrays import IntArray

ENDINGS = (".unv", ".uff")
"""Endings of universal files."""

# Elements by their descriptor, and the place in the file of each node in VTK's order where that is another one.
_KINDS = {111: "tetra", 118: "tetra10", 112: "wedge", 113: "wedge15", 115: "hexahedron", 116: "hexahedron20"}
_TO_VTK = {
    "tetra10": [0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
    "wedge15": [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8],
    "hexahedron20": [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
}
_SHELLS = {41: 3, 91: 3, 61: 3, 44: 4, 94: 4, 64: 4, 42: 6, 92: 6, 62: 6, 45: 8, 95: 8, 65: 8}  # numbers of nodes
_BEAMS = (11, 21, 22, 23, 24)  # whose nodes stand after a line of their orientation
_UNKNOWN_SOLIDS = range(101, 120)
_GROUPS = {2429: 2, 2430: 2, 2432: 2, 2435: 4, 2452: 4, 2467: 4, 2477: 4}  # numbers for each member
_NODE, _ELEMENT = 7, 8  # types of members
_MARK = "-1"
_NUMBER = re.compile(r"[-+]?[\d.]+(?:[EeDd][-+]?\d+)?")


@dataclass
class _Read:
    points: dict[int, list[float]] = field(default_factory=dict)
    solids: dict[str, dict[int, list[int]]] = field(default_factory=dict)
    shells: dict[int, list[int]] = field(default_factory=dict)
    groups: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    metre: float | None = None


def read_universal_mesh(path: Path) -> tuple[MeshContent, float | None]:
    """Read the mesh of a universal file, and the length of its unit [m]; None where it does not state one (164).

    Groups of solids become volumes, groups of shells sets of shells, groups of nodes node sets.

    Raises
    ------
    GeometryError
        Where a data set is cut short, or holds unknown solids or nodes that are not there.
    """
    read = _Read()
    for number, lines, first in _datasets(path):
        where = f"mesh file {path}, data set {number} from line {first}"
        try:
            _take(read, number, lines, where)
        except (ValueError, IndexError) as error:
            raise GeometryError(f"{where} is cut short, or not of the format: {error}") from error
    return _content(read, path), read.metre


def _datasets(path: Path) -> Iterator[tuple[int, list[str], int]]:
    """Yield number, lines and the number of the first line of each data set."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    marks = [number for number, line in enumerate(lines) if line[:6].strip() == _MARK and not line[6:].strip()]
    if not marks or len(marks) % 2:
        raise GeometryError(
            f"mesh file {path} is no universal file, or cut short: its lines '    -1' stand not in pairs"
        )
    for begin, end in zip(marks[::2], marks[1::2], strict=True):
        number = lines[begin + 1].split()[:1] if end > begin + 1 else []
        if number and number[0].isdecimal():
            yield int(number[0]), lines[begin + 2 : end], begin + 3


def _take(read: _Read, number: int, lines: Sequence[str], where: str) -> None:
    if number == 2411:
        for head, place in zip(lines[::2], lines[1::2], strict=True):
            values = [
                float(text.upper().replace("D", "E")) for text in re.findall(r"[-+]?[\d.]+(?:[EeDd][-+]?\d+)?", place)
            ]
            if len(values) != 3:
                raise ValueError(f"a node has {place.strip()!r}; expected three coordinates")
            read.points[_integers(head)[0]] = values
    elif number == 2412:
        _take_elements(read, lines, where)
    elif number == 164:
        read.metre = 1.0 / float(lines[1][:25].upper().replace("D", "E"))
    elif number in _GROUPS:
        _take_groups(read, lines, _GROUPS[number])


def _take_elements(read: _Read, lines: Sequence[str], where: str) -> None:
    row = 0
    while row < len(lines):
        label, descriptor, *_, n_nodes = _integers(lines[row])[:6]
        row += 2 if descriptor in _BEAMS else 1
        rows = -(-n_nodes // 8)
        nodes = [node for line in lines[row : row + rows] for node in _integers(line)]
        row += rows
        if len(nodes) != n_nodes:
            raise ValueError(f"element {label} has {len(nodes)} nodes; expected {n_nodes}")
        if descriptor in _KINDS:
            read.solids.setdefault(_KINDS[descriptor], {})[label] = nodes
        elif descriptor in _UNKNOWN_SOLIDS:
            raise GeometryError(
                f"{where}: element {label} is a solid of type {descriptor}, which is not known here; known: "
                + ", ".join(f"{name} ({kind})" for name, kind in _KINDS.items())
            )
        elif descriptor in _SHELLS and n_nodes == _SHELLS[descriptor]:
            corners = nodes if n_nodes < 5 else nodes[::2]
            read.shells[label] = [*corners, *[NO_NODE] * (4 - len(corners))]


def _take_groups(read: _Read, lines: Sequence[str], width: int) -> None:
    row = 0
    while row < len(lines):
        members = _integers(lines[row])[7]
        name = lines[row + 1].strip()
        rows = -(-members // (8 // width))
        numbers = [number for line in lines[row + 2 : row + 2 + rows] for number in _integers(line)]
        if len(numbers) < width * members or any(numbers[width * members :]):
            raise ValueError(f"group {name!r} has {len(numbers) // width} members; expected {members}")
        numbers = numbers[: width * members]
        pairs = zip(numbers[::width], numbers[1::width], strict=True)
        read.groups.setdefault(name, []).extend(pairs)
        row += 2 + rows


def _integers(line: str) -> list[int]:
    return [int(line[start : start + 10]) for start in range(0, len(line.rstrip()), 10)]


def _content(read: _Read, path: Path) -> MeshContent:
    place = {number: position for position, number in enumerate(read.points)}
    solids: list[ElementBlock] = []
    where: dict[int, int] = {}
    for kind in (kind for kind in SOLIDS if kind in read.solids):
        elements = read.solids[kind]
        where.update({label: count(solids) + member for member, label in enumerate(elements)})
        try:
            rows = np.array([[place[node] for node in nodes] for nodes in elements.values()], dtype=np.int64)
        except KeyError as error:
            raise GeometryError(f"mesh file {path} names node {error.args[0]}, which is not in it") from error
        solids.append(ElementBlock(kind, rows[:, _TO_VTK.get(kind, slice(None))]))
    volumes: dict[str, IntArray] = {}
    shells: dict[str, IntArray] = {}
    node_sets: dict[str, IntArray] = {}
    for name, members in read.groups.items():
        elements_in = [number for kind, number in members if kind == _ELEMENT]
        inside = [where[number] for number in elements_in if number in where]
        shells_in = [read.shells[number] for number in elements_in if number in read.shells]
        facets = [[place.get(node, NO_NODE) for node in corners] for corners in shells_in]
        nodes_in = [place[number] for kind, number in members if kind == _NODE and number in place]
        if inside:
            volumes[name] = np.unique(np.array(inside, dtype=np.int64))
        if facets:
            shells[name] = np.array(facets, dtype=np.int64)
        if nodes_in:
            node_sets[name] = np.unique(np.array(nodes_in, dtype=np.int64))
    points = np.array(list(read.points.values()), dtype=np.float64).reshape(-1, 3)
    return MeshContent(points, tuple(solids), volumes, node_sets=node_sets, shells=shells)
