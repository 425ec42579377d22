"""Mesh files in and out, through meshio."""

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from meshes.errors import GeometryError
from meshes.mesh import FloatArray, IntArray, Mesh

_TETRAHEDRA = {"tetra": 4, "tetra10": 10}
_TRIANGLES = {3: "triangle", 6: "triangle6"}


def read_mesh(path: str | Path, *, unit: float = 1.0) -> Mesh:
    """Read a mesh of tetrahedra, with its physical groups or cell sets as named regions.

    Parameters
    ----------
    path : path
        A file of any format that meshio reads.
    unit : float
        The file's unit of length [m], such as 1e-3 for millimetres.

    Raises
    ------
    GeometryError
        Where the file is missing, cannot be read, or holds no tetrahedra.
    """
    import meshio

    path = Path(path)
    if not path.is_file():
        raise GeometryError(f"mesh file {path}: no such file")
    try:
        content = meshio.read(path)
    except SystemExit as error:  # meshio leaves through sys.exit where it cannot tell the format
        raise GeometryError(f"mesh file {path}: its format is not one that meshio reads") from error
    except Exception as error:  # a broken file fails in whatever way its reader happens to stumble
        raise GeometryError(f"mesh file {path} cannot be read: {type(error).__name__}: {error}") from error

    kinds = {block.type for block in content.cells}
    solid = next((kind for kind in ("tetra10", "tetra") if kind in kinds), None)
    if solid is None:
        found = ", ".join(sorted(kinds)) or "nothing"
        raise GeometryError(f"mesh file {path} holds no tetrahedra (tet4 or tet10); it holds: {found}")
    facet = _TRIANGLES[3 if solid == "tetra" else 6]
    names = _region_names(content)

    cells: list[IntArray] = []
    volumes: dict[str, list[IntArray]] = {}
    surfaces: dict[str, list[IntArray]] = {}
    for number, block in enumerate(content.cells):
        data = np.asarray(block.data, dtype=np.int64)
        if block.type == solid:
            start = sum(len(part) for part in cells)
            for name, members in names[number]:
                volumes.setdefault(name, []).append(start + members)
            cells.append(data)
        elif block.type == facet:
            for name, members in names[number]:
                surfaces.setdefault(name, []).append(data[members])

    connectivity = np.concatenate(cells)
    used = np.unique(connectivity)
    renumbered = np.full(len(content.points), -1, dtype=np.int64)
    renumbered[used] = np.arange(len(used))
    points = np.asarray(content.points, dtype=np.float64)[used] * unit
    return Mesh(
        points=points,
        cells=_right_handed(points, renumbered[connectivity]),
        surfaces={name: renumbered[np.concatenate(parts)] for name, parts in surfaces.items()},
        volumes={name: np.concatenate(parts) for name, parts in volumes.items()},
    )


def _right_handed(points: FloatArray, cells: IntArray) -> IntArray:
    """The same tetrahedra with positive volume: some writers number them the other way round."""
    corners = points[cells[:, :4]]
    negative = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0.0
    # Exchanging the first two corners also exchanges the middle nodes of the edges that lead to them.
    swapped = [1, 0, 2, 3] if cells.shape[1] == 4 else [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]
    return np.where(negative[:, None], cells[:, swapped], cells)


def write_mesh(mesh: Mesh, path: str | Path) -> None:
    """Write a mesh with its named surfaces; the file appears whole or not at all.

    The format follows the file's ending (``.msh``, ``.vtu``, ``.inp``, ...). Named surfaces become physical groups
    in ``.msh``, element sets in ``.inp``, and a cell array ``region`` (0 for the solid, then the surfaces by name)
    in ``.vtu`` and ``.vtk``; other formats carry the mesh alone.

    Raises
    ------
    GeometryError
        Where meshio knows no format for the ending, or the format cannot hold the mesh.
    """
    import meshio

    path = Path(path)
    if path.suffix not in meshio.extension_to_filetypes:
        known = " ".join(sorted(meshio.extension_to_filetypes))
        raise GeometryError(f"no mesh format ends in {path.suffix!r}; known endings: {known}")
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
    os.close(handle)
    try:
        # Version 2.2 of gmsh's format is the one that every reader knows.
        format_name = "gmsh22" if path.suffix == ".msh" else None
        meshio.write(temporary, _for_meshio(mesh, path.suffix), file_format=format_name)
        os.replace(temporary, path)
    except Exception as error:  # writers refuse in many ways, some by a bare assertion
        raise GeometryError(f"mesh file {path} cannot be written: {type(error).__name__} {error}") from error
    finally:
        Path(temporary).unlink(missing_ok=True)


def _for_meshio(mesh: Mesh, suffix: str) -> Any:
    """meshio's form of a mesh, with regions as the format of that ending can carry them."""
    import meshio

    names = sorted(mesh.surfaces)
    blocks = [("tetra" if mesh.order == 1 else "tetra10", mesh.cells)]
    blocks += [(_TRIANGLES[mesh.surfaces[name].shape[1]], mesh.surfaces[name]) for name in names]
    tags = [np.full(len(cells), tag, dtype=np.int32) for tag, (_, cells) in enumerate(blocks, start=1)]
    if suffix == ".msh":
        groups = {"housing": np.array([1, 3])} | {name: np.array([tag, 2]) for tag, name in enumerate(names, start=2)}
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        return meshio.Mesh(mesh.points, blocks, cell_data=data, field_data=groups)
    if suffix == ".inp":
        nothing = np.empty(0, dtype=np.int64)
        sets = {
            name: [np.arange(len(cells)) if number == place else nothing for number, (_, cells) in enumerate(blocks)]
            for place, name in enumerate(names, start=1)
        }
        return meshio.Mesh(mesh.points, blocks, cell_sets=sets)
    if suffix in (".vtu", ".vtk"):
        return meshio.Mesh(mesh.points, blocks, cell_data={"region": [tag - 1 for tag in tags]})
    return meshio.Mesh(mesh.points, blocks[:1])


def _region_names(content: Any) -> list[list[tuple[str, IntArray]]]:
    """For each cell block, its named groups as (name, members within the block)."""
    names: list[list[tuple[str, IntArray]]] = [[] for _ in content.cells]
    physical = content.cell_data.get("gmsh:physical")
    # A tag is unique among groups of one dimension only.
    by_tag = {(int(tag), int(dimension)): name for name, (tag, dimension) in content.field_data.items()}
    for number, block in enumerate(content.cells):
        if physical is not None:
            for tag in np.unique(physical[number]):
                name = by_tag.get((int(tag), block.dim), f"group-{int(tag)}")
                names[number].append((name, np.flatnonzero(physical[number] == tag)))
        for name, members in content.cell_sets.items():
            if not name.startswith("gmsh:") and members[number] is not None and len(members[number]):
                names[number].append((name, np.asarray(members[number], dtype=np.int64)))
    return names
