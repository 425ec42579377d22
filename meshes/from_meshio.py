"""Conversion from meshio: element types, and regions from the ways in which file formats name them."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from meshes.content import MeshContent, corner_rows
from meshes.elements import FACETS, SOLIDS, ElementBlock, IntArray, count, outside_nodes
from meshes.errors import GeometryError
from meshes.topology import NO_NODE

# Cell arrays of numbers that stand for regions, and how a region without a name is called.
_TAGS = {
    "gmsh:physical": "group",
    "nastran:ref": "property",
    "medit:ref": "ref",
    "tetgen:ref": "region",
    "avsucd:material": "material",
    "netgen:index": "index",
    "cell_tags": "family",
}
# Solids that meshio's readers know but its table of dimensions lacks, so that it fails on them with a bare KeyError.
_FORGOTTEN = ("wedge15", "pyramid13", "hexahedron24")


def load_meshio() -> Any:
    """Import meshio and complete its table of dimensions for every solid that its readers know."""
    import meshio
    from meshio._mesh import topological_dimension

    for kind in _FORGOTTEN:
        topological_dimension.setdefault(kind, 3)
    return meshio


def content_from_meshio(content: Any, path: Path) -> MeshContent:
    """Convert the content that meshio has read.

    Raises
    ------
    GeometryError
        Where there are no solid elements, or elements of an unknown type.
    """
    found = sorted({block.type for block in content.cells})
    others = sorted({block.type for block in content.cells if block.dim == 3} - set(SOLIDS))
    if others:
        raise GeometryError(
            f"mesh file {path} holds {', '.join(others)} elements, which are not known here; known: {', '.join(SOLIDS)}"
        )
    if not set(found) & set(SOLIDS):
        have = ", ".join(found) or "nothing"
        raise GeometryError(f"mesh file {path} holds no solid elements of {', '.join(SOLIDS)}; it holds: {have}")
    solids: list[ElementBlock] = []
    volumes: dict[str, list[IntArray]] = {}
    facets: dict[str, list[IntArray]] = {}
    for number, cells in enumerate(content.cells):
        if cells.type not in SOLIDS and cells.type not in FACETS:
            continue
        block = ElementBlock(cells.type, np.asarray(cells.data, dtype=np.int64))
        if fault := outside_nodes(block, len(content.points)):
            raise GeometryError(f"mesh file {path} {fault}")
        for name, members in _groups(content, number):
            if cells.type in SOLIDS:
                volumes.setdefault(name, []).append(count(solids) + members)
            else:
                facets.setdefault(name, []).append(corner_rows(block)[members])
        if cells.type in SOLIDS:
            for name, corners in _flagged_faces(content, number, block):
                facets.setdefault(name, []).append(corners)
            solids.append(block)
    points = np.asarray(content.points, dtype=np.float64)
    return MeshContent(
        points=points if points.shape[1] == 3 else np.pad(points, ((0, 0), (0, 3 - points.shape[1]))),
        solids=tuple(solids),
        volumes={name: np.unique(np.concatenate(parts)) for name, parts in volumes.items()},
        facets={name: np.concatenate(parts) for name, parts in facets.items()},
        node_sets=dict(_node_sets(content)),
    )


def _groups(content: Any, number: int) -> list[tuple[str, IntArray]]:
    """Named groups of one block, as (name, members).

    Of gmsh's format 4 meshio gives the groups twice, as sets and as tags, and the tags name one group only of an
    element that is in several: the union of both is the file's content.
    """
    groups: dict[str, IntArray] = {}

    def add(name: str, members: Any) -> None:
        if members is not None and len(members):
            groups[name] = np.union1d(
                groups.get(name, np.empty(0, dtype=np.int64)), np.asarray(members, dtype=np.int64)
            )

    dimension = content.cells[number].dim
    for key, word in _TAGS.items():
        for name, members in _tagged(content, key, word, number, dimension):
            add(name, members)
    for key, arrays in content.cell_data.items():
        word, _, name = key.partition(":")
        if word == {2: "surface", 3: "volume"}[dimension]:
            add(unquote(name), np.flatnonzero(np.asarray(arrays[number]) > 0))
    for name, parts in content.cell_sets.items():
        if not name.startswith("gmsh:"):
            add(name, parts[number])
    return list(groups.items())


def _flagged_faces(content: Any, number: int, block: ElementBlock) -> Iterator[tuple[str, IntArray]]:
    """Surfaces stored as a bit for each face of the elements, as :mod:`meshes.to_meshio` writes them."""
    for key, arrays in content.cell_data.items():
        word, _, name = key.partition(":")
        if word == "faces":
            bits = np.asarray(arrays[number], dtype=np.int64)
            for place, face in enumerate(block.of.corner_faces):
                rows = np.full((np.count_nonzero(bits >> place & 1), 4), NO_NODE, dtype=np.int64)
                rows[:, : len(face)] = block.nodes[(bits >> place & 1) > 0][:, face]
                yield unquote(name), rows


def _tagged(content: Any, key: str, word: str, number: int, dimension: int) -> Iterator[tuple[str, IntArray]]:
    """Groups numbered by a cell array; zero is no group."""
    if key not in content.cell_data:
        return
    tags = np.asarray(content.cell_data[key][number]).ravel()
    families = getattr(content, "cell_tags", {}) if key == "cell_tags" else {}
    # A tag is unique among groups of one dimension only.
    by_tag = {
        (int(data[0]), int(data[1])): name
        for name, data in content.field_data.items()
        if key == "gmsh:physical" and np.size(data) == 2
    }
    for tag in np.unique(tags).tolist():
        if tag == 0:
            continue
        name = by_tag.get((int(tag), dimension), f"{word}-{int(tag)}")
        for each in families.get(tag, [name]):
            yield each, np.flatnonzero(tags == tag)


def _node_sets(content: Any) -> Iterator[tuple[str, IntArray]]:
    for name, members in content.point_sets.items():
        yield name, np.asarray(members, dtype=np.int64).ravel()
    tags = content.point_data.get("point_tags")
    for tag, names in getattr(content, "point_tags", {}).items() if tags is not None else ():
        for name in names:
            yield name, np.flatnonzero(np.asarray(tags) == tag)
