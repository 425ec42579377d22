"""Mesh files in and out, through meshio."""

import os
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from meshes.errors import GeometryError
from meshes.mesh import FloatArray, IntArray, Mesh

_TETRAHEDRA = {"tetra": 4, "tetra10": 10}
_TRIANGLES = {3: "triangle", 6: "triangle6"}

# The endings under which meshio keeps both orders of tetrahedra whole; under others it drops elements in silence.
WRITABLE = (".inp", ".med", ".msh", ".vtk", ".vtu", ".xdmf")


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
        Where the file is missing, cannot be read, holds no tetrahedra, or holds other solid elements beside them.
    """
    import meshio

    if not unit > 0.0:
        raise GeometryError(f"unit of length {unit} m must be positive")
    path = Path(path)
    if not path.is_file():
        raise GeometryError(f"mesh file {path}: no such file")
    try:
        # meshio tells of trouble on the screen; standard output belongs to the caller.
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            content = meshio.read(path)
    except SystemExit as error:  # meshio leaves through sys.exit where no reader takes the file
        raise GeometryError(f"mesh file {path} is broken, or of a format that meshio does not read") from error
    except Exception as error:  # a broken file fails in whatever way its reader happens to stumble
        raise GeometryError(f"mesh file {path} cannot be read: {type(error).__name__}: {error}") from error

    kinds = {block.type for block in content.cells}
    solid = next((kind for kind in ("tetra10", "tetra") if kind in kinds), None)
    if solid is None:
        found = ", ".join(sorted(kinds)) or "nothing"
        raise GeometryError(f"mesh file {path} holds no tetrahedra (tet4 or tet10); it holds: {found}")
    others = sorted({block.type for block in content.cells if block.dim == 3} - {solid})
    if others:
        raise GeometryError(
            f"mesh file {path} holds {', '.join(others)} beside {solid}; every solid element must be of one kind"
        )
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
    renumbered = np.full(len(content.points), -1, dtype=np.int64)  # -1 in a surface is refused by Mesh
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

    The format follows the file's ending, one of :data:`WRITABLE`. Named surfaces become physical groups in ``.msh``,
    element sets in ``.inp``, and a cell array ``region`` (0 for the solid, then the surfaces by name) in ``.vtu`` and
    ``.vtk``; ``.med`` and ``.xdmf`` (with its ``.h5`` beside it) carry the mesh alone.

    Raises
    ------
    GeometryError
        Where the ending is another one, or the file cannot be written.
    """
    import meshio

    path = Path(path)
    if path.suffix not in WRITABLE:
        raise GeometryError(f"a mesh is not written to {path.suffix!r}; known endings: {' '.join(WRITABLE)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    # Written under its own name in a folder beside, because XDMF names its companion after itself.
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.stem}-") as folder:
        try:
            # Version 2.2 of gmsh's format is the one that every reader knows.
            format_name = "gmsh22" if path.suffix == ".msh" else None
            meshio.write(Path(folder) / path.name, _for_meshio(mesh, path.suffix), file_format=format_name)
            for part in sorted(Path(folder).iterdir(), key=lambda part: part.name == path.name):
                os.replace(part, path.parent / part.name)
        except Exception as error:  # writers refuse in many ways, some by a bare assertion
            raise GeometryError(f"mesh file {path} cannot be written: {type(error).__name__} {error}") from error


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
    """For each cell block, its named groups as (name, members within the block).

    Of gmsh's format 4 meshio gives the groups twice, as sets and as tags, and the tags name one group only of an
    element that is in several: the union of both is what the file says.
    """
    names: list[dict[str, IntArray]] = [{} for _ in content.cells]
    physical = content.cell_data.get("gmsh:physical")
    # A tag is unique among groups of one dimension only.
    by_tag = {(int(tag), int(dimension)): name for name, (tag, dimension) in content.field_data.items()}
    for number, block in enumerate(content.cells):
        if physical is not None:
            for tag in np.unique(physical[number]):
                name = by_tag.get((int(tag), block.dim), f"group-{int(tag)}")
                names[number][name] = np.flatnonzero(physical[number] == tag)
        for name, members in content.cell_sets.items():
            if not name.startswith("gmsh:") and members[number] is not None and len(members[number]):
                known = names[number].get(name, np.empty(0, dtype=np.int64))
                names[number][name] = np.union1d(known, np.asarray(members[number], dtype=np.int64))
    return [list(groups.items()) for groups in names]
