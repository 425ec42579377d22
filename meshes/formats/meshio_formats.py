"""Conversion to and from meshio: element types, and regions in the form that each file format holds."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from gearwhine.meshes.elements import FACETS, NO_NODE, SOLIDS, ElementBlock, count, merged, outside_nodes
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.content import MeshContent, corner_rows, find_faces
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import IntArray

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
    types = sorted({block.type for block in content.cells})
    others = sorted({block.type for block in content.cells if block.dim == 3} - set(SOLIDS))
    if others:
        raise GeometryError(
            f"mesh file {path} holds {', '.join(others)} elements, which are not known here; known: {', '.join(SOLIDS)}"
        )
    if not set(types) & set(SOLIDS):
        have = ", ".join(types) or "nothing"
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

    For gmsh's format 4, meshio gives the groups twice, as sets and as tags, and the tags name one group only of an
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
    """Surfaces stored as a bit for each face of the elements, as this module writes them."""
    for key, arrays in content.cell_data.items():
        word, _, name = key.partition(":")
        if word == "faces":
            bits = np.asarray(arrays[number], dtype=np.int64)
            for place, face in enumerate(block.of.corner_faces):
                rows = np.full((np.count_nonzero(bits >> place & 1), 4), NO_NODE, dtype=np.int64)
                rows[:, : len(face)] = block.nodes[(bits >> place & 1) > 0][:, face]
                yield unquote(name), rows


def _tagged(content: Any, key: str, word: str, number: int, dimension: int) -> Iterator[tuple[str, IntArray]]:
    """Yield the groups numbered by a cell array; zero is no group."""
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
        for family in families.get(tag, [name]):
            yield family, np.flatnonzero(tags == tag)


def _node_sets(content: Any) -> Iterator[tuple[str, IntArray]]:
    for name, members in content.point_sets.items():
        yield name, np.asarray(members, dtype=np.int64).ravel()
    tags = content.point_data.get("point_tags")
    for tag, names in getattr(content, "point_tags", {}).items() if tags is not None else ():
        for name in names:
            yield name, np.flatnonzero(np.asarray(tags) == tag)


_NAME_LENGTH = 80  # characters of a group's name in MED
_KINDS_LOST = {".med": ("hexahedron27",)}


def meshio_from_mesh(mesh: Mesh, ending: str) -> Any:
    """Convert a mesh for files of an ending, with regions in the form that the format can hold.

    Raises
    ------
    GeometryError
        Where volumes overlap and the format knows only one for each element, or a name is too long for it.
    """
    meshio = load_meshio()
    lost = sorted(set(mesh.kinds) & set(_KINDS_LOST.get(ending, ())))
    if lost:
        raise GeometryError(f"{ending} files hold no {', '.join(lost)} elements; write .vtu, .msh or .inp")
    solids = merged(mesh.blocks) if ending == ".med" else mesh.blocks
    ends = np.cumsum([len(block) for block in solids])[:-1]
    inside = {name: np.isin(_positions(mesh, solids), members) for name, members in mesh.volumes.items()}
    if ending == ".xdmf":
        _check_xdmf(mesh)
        arrays = {f"volume:{quote(name, safe='')}": np.split(flag, ends) for name, flag in inside.items()}
        arrays |= {f"faces:{quote(name, safe='')}": np.split(_face_flags(mesh, name), ends) for name in mesh.surfaces}
        cells = [(block.kind, block.nodes) for block in solids]
        return meshio.Mesh(mesh.points, cells, cell_data=_whole_numbers(arrays))
    names = sorted(mesh.surfaces)
    owned = [(number, block) for number, name in enumerate(names, start=1) for block in mesh.surfaces[name]]
    facets = [block for _, block in owned]
    owner = [np.full(len(block), number) for number, block in owned]
    if ending == ".med":
        facets, owner = _merged_facets(facets, owner)
    cells = [(block.kind, block.nodes) for block in (*solids, *facets)]
    if ending == ".med":
        return _with_families(meshio.Mesh(mesh.points, cells), names, inside, ends, owner)
    if ending == ".msh":
        tags = [*np.split(_one_volume_each(inside, mesh.n_elements), ends), *owner]
        groups = {name: np.array([tag, 3]) for tag, name in enumerate(inside, start=1)}
        if set(inside) & set(names):
            raise GeometryError(f"a volume and a surface are both named {min(set(inside) & set(names))!r}")
        groups |= {name: np.array([tag, 2]) for tag, name in enumerate(names, start=1)}
        data = {"gmsh:physical": tags, "gmsh:geometrical": [np.maximum(tag, 1) for tag in tags]}
        return meshio.Mesh(mesh.points, cells, cell_data=_whole_numbers(data), field_data=groups)
    within: list[Any] = [np.zeros(len(block)) for block in solids]
    outside: list[Any] = [np.zeros(len(block)) for block in facets]
    flags: dict[str, Sequence[Any]] = {"region": [*within, *owner]}
    flags |= {f"volume:{quote(name, safe='')}": [*np.split(flag, ends), *outside] for name, flag in inside.items()}
    for number, name in enumerate(names, start=1):
        flags[f"surface:{quote(name, safe='')}"] = [*within, *(part == number for part in owner)]
    return meshio.Mesh(mesh.points, cells, cell_data=_whole_numbers(flags))


def _whole_numbers(data: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    return {key: [np.asarray(part, dtype=np.int32) for part in parts] for key, parts in data.items()}


def _check_xdmf(mesh: Mesh) -> None:
    if len(mesh.kinds) > 1 and mesh.order == 2:
        raise GeometryError(f".xdmf files of {' and '.join(mesh.kinds)} elements cannot be read back; write .vtu")


def _face_flags(mesh: Mesh, name: str) -> IntArray:
    """Bits of the faces of each element that are in a surface: meshio reads no facets beside solids of order 2."""
    flags = np.zeros(mesh.n_elements, dtype=np.int64)
    for block in mesh.surfaces[name]:
        faces = find_faces(mesh, corner_rows(block))
        if (faces < 0).any():
            raise GeometryError(f"surface {name!r} has facets that are no faces of elements")
        np.bitwise_or.at(flags, mesh.faces.element[faces], 1 << mesh.faces.source[faces, 2])
    return flags


def _positions(mesh: Mesh, solids: tuple[ElementBlock, ...]) -> IntArray:
    """Return the number in the mesh of each element to write: merging puts the elements of one kind together."""
    if solids is mesh.blocks:
        return np.arange(mesh.n_elements)
    first = np.cumsum([0, *(len(block) for block in mesh.blocks)])
    parts = [
        np.arange(first[number], first[number + 1])
        for kind in solids
        for number, block in enumerate(mesh.blocks)
        if block.kind == kind.kind
    ]
    return np.concatenate(parts)


def _merged_facets(facets: list[ElementBlock], owner: list[IntArray]) -> tuple[list[ElementBlock], list[IntArray]]:
    kinds = list(merged(facets))
    owners = [
        np.concatenate([part for block, part in zip(facets, owner, strict=True) if block.kind == kind.kind])
        for kind in kinds
    ]
    return kinds, owners


def _one_volume_each(inside: dict[str, Any], n_elements: int) -> IntArray:
    tags = np.zeros(n_elements, dtype=np.int64)
    for tag, (name, members) in enumerate(inside.items(), start=1):
        if (tags[members] > 0).any():
            other = list(inside)[int(tags[members].max()) - 1]
            raise GeometryError(
                f"volumes {other!r} and {name!r} overlap, and .msh files know one for each element; write .vtu or .inp"
            )
        tags[members] = tag
    return tags


def _with_families(
    content: Any, names: list[str], inside: dict[str, Any], ends: IntArray, owner: list[IntArray]
) -> Any:
    """Add the regions as MED's families: negative numbers, each for elements of the same groups."""
    for name in (*names, *inside):
        if len(name) > _NAME_LENGTH or not name.isascii():
            raise GeometryError(
                f"the name {name!r} cannot be that of a group in MED: at most {_NAME_LENGTH} ASCII letters"
            )
    families: dict[tuple[str, ...], int] = {}
    n_elements = sum(len(block.data) for block in content.cells[: len(ends) + 1])
    memberships = zip(*inside.values(), strict=True) if inside else [()] * n_elements
    patterns = [tuple(name for name, flag in zip(inside, row, strict=True) if flag) for row in memberships]
    solid = [families.setdefault(groups, -1 - len(families)) if groups else 0 for groups in patterns]
    surface = {number: -1 - len(families) - place for place, number in enumerate(range(1, len(names) + 1))}
    tags = [*np.split(np.array(solid, dtype=np.int64), ends)]
    tags += [np.array([surface[number] for number in part.tolist()], dtype=np.int64) for part in owner]
    content.cell_data["cell_tags"] = tags
    content.cell_tags = {tag: list(groups) for groups, tag in families.items()}
    content.cell_tags |= {surface[number]: [name] for number, name in enumerate(names, start=1)}
    content.point_tags = {}
    return content
