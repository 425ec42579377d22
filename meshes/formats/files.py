"""Mesh files: read and write every format that meshio knows, and input decks of Abaqus, CalculiX and Nastran."""

import errno
import os
import shutil
import tempfile
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.abaqus import read_abaqus, write_abaqus
from gearwhine.meshes.formats.content import MeshContent
from gearwhine.meshes.formats.med import read_med
from gearwhine.meshes.formats.meshio_formats import content_from_meshio, load_meshio, meshio_from_mesh
from gearwhine.meshes.formats.nastran import is_nastran, read_nastran
from gearwhine.meshes.formats.universal import ENDINGS as UNIVERSAL
from gearwhine.meshes.formats.universal import read_universal_mesh
from gearwhine.meshes.mesh import Mesh

_SAME_UNIT = 1e-6  # relative difference of two units of length that count as one

# Every kind of element comes back whole under these endings; under others some are lost or changed in silence.
WRITABLE = (".inp", ".med", ".msh", ".vtk", ".vtu", ".xdmf")
"""Endings of the files that a mesh can be written to."""


def read_mesh(path: str | Path, *, unit: float = 1.0) -> Mesh:
    """Read a mesh of solid elements, with the file's named groups and sets as regions.

    Parameters
    ----------
    path : path
        A file of any format that meshio reads, or an input deck of Abaqus or CalculiX (``.inp``) or Nastran
        (``.bdf``, ``.fem``, ``.nas``, or ``.dat`` with cards of Nastran in it), or a universal file (``.unv``).
    unit : float
        The file's unit of length [m], such as 1e-3 for millimetres; a universal file that states its own has that.

    Returns
    -------
    Mesh
        Groups of solids are volumes. Groups of facets are surfaces, and so are sets of nodes: of all the boundary
        facets whose nodes are in the set. Nodes without a solid, shells, beams and the like are left out.

    Raises
    ------
    GeometryError
        Where the file is missing or cannot be read, or holds no solid elements, or elements of an unknown type.
    """
    if not unit > 0.0:
        raise GeometryError(f"unit of length {unit} m must be positive")
    path = Path(path)
    if not path.is_file():
        raise GeometryError(f"mesh file {path}: no such file")
    try:
        content, metre = _read(path)
    except GeometryError:
        raise
    except SystemExit as error:  # meshio leaves through sys.exit where no reader takes the file
        raise GeometryError(f"mesh file {path} is broken, or of a format that meshio does not read") from error
    except Exception as error:  # readers raise exceptions of many kinds on a broken file
        raise GeometryError(
            f"mesh file {path} cannot be read: {type(error).__name__}: {error}; it is broken, cut short, or of another "
            "format than its ending says"
        ) from error
    if not content.solids:
        raise GeometryError(f"mesh file {path} holds no solid elements")
    if metre is not None:
        if unit != 1.0 and abs(unit / metre - 1.0) > _SAME_UNIT:
            raise GeometryError(f"mesh file {path} states that its unit of length is {metre:g} m, and not {unit:g} m")
        unit = metre
    return content.mesh(unit)


def write_mesh(mesh: Mesh, path: str | Path) -> None:
    """Write a mesh with its named surfaces and volumes; the file appears whole or not at all.

    The format follows the file's ending, one of :data:`WRITABLE`. Regions become physical groups in ``.msh``, sets and
    surfaces in ``.inp``, families in ``.med``. In ``.vtu`` and ``.vtk`` they are cell arrays ``surface:NAME`` and
    ``volume:NAME``, 1 in the region and 0 elsewhere, with blanks and the like as in a web address. In ``.xdmf`` (with
    its ``.h5`` beside it) volumes are such arrays too, and ``faces:NAME`` has a bit for each face of an element that is
    in the surface. :func:`read_mesh` takes all of them back.

    Raises
    ------
    GeometryError
        Where the ending is another one, or the format cannot hold the mesh.
    OSError
        Where the file cannot be written.
    """
    path = Path(path)
    if path.suffix not in WRITABLE:
        raise GeometryError(f"a mesh is not written to {path.suffix!r}; known endings: {' '.join(WRITABLE)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    # Written under its own name in a folder beside, because XDMF names its companion after itself.
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.stem}-") as folder:
        try:
            _require_room(mesh, path.parent)
            _write(mesh, Path(folder) / path.name)
            for part in sorted(Path(folder).iterdir(), key=lambda part: part.name == path.name):
                os.replace(part, path.parent / part.name)
        except GeometryError:
            raise
        except Exception as error:  # writers refuse in many ways, some by a bare assertion
            if isinstance(error, OSError):  # numpy's own writer does not say why
                reason = error.errno or errno.ENOSPC
                raise OSError(reason, os.strerror(reason)) from error
            raise GeometryError(f"mesh file {path} cannot be written: {type(error).__name__} {error}") from error


def _require_room(mesh: Mesh, folder: Path) -> None:
    """Refuse a disk with less room than the mesh has bytes: HDF5, in XDMF and MED, crashes on a full one.

    Twice the bytes of nodes and elements are asked for: regions and HDF5's own tables need some too.
    """
    size = 2 * (mesh.points.nbytes + sum(block.nodes.nbytes for block in mesh.blocks))
    if shutil.disk_usage(folder).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _write(mesh: Mesh, path: Path) -> None:
    if path.suffix == ".inp":
        write_abaqus(mesh, path)
        return
    meshio = load_meshio()
    # Every reader knows version 2.2 of gmsh's format.
    format_name = "gmsh22" if path.suffix == ".msh" else None
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        meshio.write(path, meshio_from_mesh(mesh, path.suffix), file_format=format_name)


def _read(path: Path) -> tuple[MeshContent, float | None]:
    """Return the content of a file, and the unit of length [m] that it states, None where it does not."""
    ending = path.suffix.lower()
    if ending in UNIVERSAL:
        return read_universal_mesh(path)
    if ending == ".inp":
        return read_abaqus(path), None
    if ending in (".med", ".rmed"):
        return read_med(path), None
    return read_nastran(path) if is_nastran(path) else _through_meshio(path), None


def _through_meshio(path: Path) -> MeshContent:
    meshio = load_meshio()
    _check_ending(path, meshio.extension_to_filetypes)
    _check_tetgen(path)
    if not path.stat().st_size:
        raise GeometryError(f"mesh file {path} is empty")
    # meshio prints warnings to standard output, which belongs to the caller.
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        content = meshio.read(path)
    return content_from_meshio(content, path)


def _check_ending(path: Path, endings_known: Mapping[str, list[str]]) -> None:
    """Refuse a file whose ending has no reader."""
    endings = ["".join(path.suffixes[first:]).lower() for first in range(len(path.suffixes))]
    if not any(ending in endings_known for ending in endings):
        raise GeometryError(
            f"mesh file {path}: no format of meshes has the ending {path.suffix!r}; "
            f"such as {' '.join(WRITABLE)} .bdf .nas .e do"
        )


def _check_tetgen(path: Path) -> None:
    """Refuse an empty TetGen file, for which meshio's reader would wait without end."""
    if path.suffix not in (".node", ".ele"):
        return
    for part in (path.with_suffix(".node"), path.with_suffix(".ele")):
        lines = part.read_text(errors="replace").splitlines() if part.is_file() else []
        if not any(line.strip() and not line.strip().startswith("#") for line in lines):
            raise GeometryError(
                f"mesh file {path}: TetGen's .node and .ele belong together, and {part.name} is missing or empty"
            )
