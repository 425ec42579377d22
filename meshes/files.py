"""Mesh files in and out, through meshio."""

import os
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from meshes.elements import KINDS, SOLIDS, ElementBlock, FloatArray, IntArray, count, merged
from meshes.errors import GeometryError
from meshes.mapping import volumes as volumes_of
from meshes.mesh import Mesh

# The endings under which meshio keeps both orders of tetrahedra whole; under others it drops elements in silence.
WRITABLE = (".inp", ".med", ".msh", ".vtk", ".vtu", ".xdmf")


def read_mesh(path: str | Path, *, unit: float = 1.0) -> Mesh:
    """Read a mesh of solid elements, with its physical groups or cell sets as named regions.

    Parameters
    ----------
    path : path
        A file of any format that meshio reads.
    unit : float
        The file's unit of length [m], such as 1e-3 for millimetres.

    Raises
    ------
    GeometryError
        Where the file is missing, cannot be read, holds no solid elements, or such as are not
        known here beside them.
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

    solids = [block for block in content.cells if block.type in SOLIDS]
    if not solids:
        found = ", ".join(sorted({block.type for block in content.cells})) or "nothing"
        raise GeometryError(f"mesh file {path} holds no solid elements of {', '.join(SOLIDS)}; it holds: {found}")
    others = sorted({block.type for block in content.cells if block.dim == 3} - set(SOLIDS))
    if others:
        raise GeometryError(
            f"mesh file {path} holds {', '.join(others)} elements, which are not known here; mesh it with "
            f"{', '.join(SOLIDS)}"
        )
    names = _region_names(content)
    used = np.unique(np.concatenate([np.asarray(block.data, dtype=np.int64).ravel() for block in solids]))
    renumbered = np.full(len(content.points), -1, dtype=np.int64)  # -1 in a surface is refused by Mesh
    renumbered[used] = np.arange(len(used))
    points = np.asarray(content.points, dtype=np.float64)[used] * unit

    blocks: list[ElementBlock] = []
    volumes: dict[str, list[IntArray]] = {}
    surfaces: dict[str, list[ElementBlock]] = {}
    for number, cells in enumerate(content.cells):
        if cells.type not in KINDS:
            continue
        block = ElementBlock(cells.type, renumbered[np.asarray(cells.data, dtype=np.int64)])
        if block.of.dimension == 3:
            for name, members in names[number]:
                volumes.setdefault(name, []).append(count(blocks) + members)
            blocks.append(_right_handed(points, block))
        else:
            for name, members in names[number]:
                surfaces.setdefault(name, []).append(ElementBlock(block.kind, block.nodes[members]))
    return Mesh(
        points=points,
        blocks=tuple(blocks),
        surfaces={name: merged(parts) for name, parts in surfaces.items()},
        volumes={name: np.concatenate(parts) for name, parts in volumes.items()},
    )


def _right_handed(points: FloatArray, block: ElementBlock) -> ElementBlock:
    """The same elements with positive volume: some writers number them the other way round."""
    negative = volumes_of(points, block.corners, block.of.corners) < 0.0
    if not negative.any():
        return block
    return ElementBlock(block.kind, np.where(negative[:, None], block.nodes[:, block.of.mirrored], block.nodes))


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
    blocks = [(block.kind, block.nodes) for block in mesh.blocks]
    owners = [0] * len(blocks)
    for number, name in enumerate(names, start=1):
        blocks += [(block.kind, block.nodes) for block in mesh.surfaces[name]]
        owners += [number] * len(mesh.surfaces[name])
    tags = [np.full(len(cells), 1 + owner, dtype=np.int32) for owner, (_, cells) in zip(owners, blocks, strict=True)]
    if suffix == ".msh":
        groups = {"housing": np.array([1, 3])} | {name: np.array([tag, 2]) for tag, name in enumerate(names, start=2)}
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        return meshio.Mesh(mesh.points, blocks, cell_data=data, field_data=groups)
    if suffix == ".inp":
        nothing, owned = np.empty(0, dtype=np.int64), list(zip(owners, blocks, strict=True))
        sets = {
            name: [np.arange(len(cells)) if owner == place else nothing for owner, (_, cells) in owned]
            for place, name in enumerate(names, start=1)
        }
        return meshio.Mesh(mesh.points, blocks, cell_sets=sets)
    if suffix in (".vtu", ".vtk"):
        return meshio.Mesh(mesh.points, blocks, cell_data={"region": [tag - 1 for tag in tags]})
    return meshio.Mesh(mesh.points, blocks[: len(mesh.blocks)])


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
