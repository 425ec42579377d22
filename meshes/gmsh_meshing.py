"""Tetrahedral meshing of a gmsh model of solids: element size, order, middle nodes, node numbering.

The gmsh session imports gmsh when it is needed, silent and deterministic, and finalises it after errors too. gmsh has
one state for the whole process: sessions of several threads follow each other.
"""

import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import reverse_cuthill_mckee

from gearwhine.meshes.errors import GeometryError, MesherUnavailableError, MeshSizeError
from gearwhine.meshes.lengths import length_text
from gearwhine.meshes.mesh import Mesh
from gearwhine.numerics.arrays import FloatArray, IntArray

# Libraries that gmsh's wheel links against but does not contain, as Debian and Ubuntu package names.
SYSTEM_PACKAGES = (
    "libglu1-mesa",
    "libgl1",
    "libx11-6",
    "libxext6",
    "libxrender1",
    "libxcursor1",
    "libxfixes3",
    "libxft2",
    "libxinerama1",
    "libfontconfig1",
    "libgomp1",
)


def load_gmsh() -> Any:
    """Import gmsh.

    Raises
    ------
    MesherUnavailableError
        Where a system library that gmsh needs is missing; the message names the packages to install.
    """
    try:
        import gmsh
    except (ImportError, OSError) as error:
        packages = " ".join(SYSTEM_PACKAGES)
        raise MesherUnavailableError(
            f"gmsh cannot be loaded: {error}. On Debian or Ubuntu install its system libraries with\n"
            f"    sudo apt-get install {packages}"
        ) from error
    return gmsh


_SESSION = threading.RLock()  # gmsh's state belongs to the process, and a session to the thread that holds this


@contextmanager
def gmsh_session(name: str) -> Iterator[Any]:
    """Open a gmsh model that is finalised at the end; gmsh's own failures become :class:`GeometryError`.

    The session runs on one thread so that the same geometry gives the same mesh, bit for bit. It waits for the session
    of another thread to end.

    Raises
    ------
    MesherUnavailableError
        Where gmsh cannot be loaded, or other code of this process has it initialised: its models would be lost.
    """
    with _SESSION:
        yield from _session(name)


def _session(name: str) -> Iterator[Any]:
    gmsh = load_gmsh()
    if gmsh.isInitialized():
        raise MesherUnavailableError(
            "gmsh is initialised already by other code of this process, whose models the mesher would discard: "
            "call gmsh.finalize() first"
        )
    # interruptible=False leaves the signal handlers alone, so it works off the main thread and Ctrl-C stays ours.
    with _signals_kept():
        gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.RandomSeed", 1)
        gmsh.model.add(name)
        yield gmsh
    except GeometryError:
        raise
    except Exception as error:  # gmsh raises bare Exception for every failure of its kernel
        if type(error) is not Exception:
            raise
        raise GeometryError(f"gmsh could not mesh {name}: {error}") from error
    finally:
        with _signals_kept():
            gmsh.finalize()


@contextmanager
def _signals_kept() -> Iterator[None]:
    """Restore the process's signal handlers: gmsh resets SIGTERM's, and a killed run could not clean up."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in handlers.items():
            if handler is not None:
                signal.signal(number, handler)


# gmsh numbers the last two middle nodes of a ten-node tetrahedron the other way round than VTK does.
_GMSH_TO_VTK = {4: [0, 1, 2, 3], 10: [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}
# Edges of the tetrahedron in gmsh's order of their middle nodes.
_GMSH_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]])
_TET10 = 11
_WORST_JACOBIAN = 0.05  # least Jacobian of an element over its mean, below which it counts as folded
_HALVINGS = 3
_COARSE_SIZE_PER_WALL = 1.5  # size of the elements of a first mesh over the thickness of the walls
_REGULAR_TETRAHEDRA_PER_VOLUME = 6.0 * np.sqrt(2.0)  # regular tetrahedra of unit edge in a unit of volume

MOST_ELEMENTS = 3e6
"""Largest number of elements: about twelve million degrees of freedom, beyond the solvers."""

_STRAIGHT_EDGE_BEND = 1e-6  # an edge bent by less, as a part of its length, is straight


def check_mesh_request(mesh_size: float | None, order: int) -> None:
    """Check element size and order.

    Raises
    ------
    GeometryError
        For a size that is not positive, or an order other than 1 and 2.
    """
    if (mesh_size is not None and not mesh_size > 0.0) or order not in (1, 2):
        raise GeometryError(f"mesh size {mesh_size} m must be positive and order {order} be 1 or 2")


def expected_elements(volume: float, mesh_size: float) -> float:
    """Approximate number of tetrahedra that fill a volume: regular ones have edge³ / (6 √2) each.

    Parameters
    ----------
    volume, mesh_size : float
        Volume [m³] and mesh size [m], or both in another unit of length.
    """
    return float(_REGULAR_TETRAHEDRA_PER_VOLUME * volume / mesh_size**3)


def check_mesh_size(volume: float, extent: float, mesh_size: float) -> None:
    """Refuse an element size that cannot be meshed or solved, before meshing starts.

    Parameters
    ----------
    volume, extent, mesh_size : float
        Volume of the solid, its longest side, and the edge length aimed at [m³, m, m].

    Raises
    ------
    MeshSizeError
        Where the elements would be larger than the part, or more than :data:`MOST_ELEMENTS`.
    """
    if mesh_size > extent:
        meant = f"; did you mean {mesh_size:g} mm?" if 1e-3 * mesh_size <= extent else ""
        raise MeshSizeError(
            f"elements of {length_text(mesh_size)} are larger than the part, whose longest side is "
            f"{length_text(extent)}{meant}"
        )
    number = expected_elements(volume, mesh_size)
    if number > MOST_ELEMENTS:
        least = mesh_size * np.cbrt(number / MOST_ELEMENTS)
        raise MeshSizeError(
            f"elements of {length_text(mesh_size)} would be about {number:.1g} in number, more than any solver takes "
            f"({MOST_ELEMENTS:.0g}); expected at least {length_text(least)}"
        )


def coarse_size(volume: float, area: float, extent: float) -> float:
    """Size of elements for a first mesh of walls, by their mean thickness, twice the volume over the surface [m].

    Parameters
    ----------
    volume, area, extent : float
        Volume and surface of the solid, and its longest side [m³, m², m].
    """
    return min(_COARSE_SIZE_PER_WALL * 2.0 * volume / area, extent / 3.0)


def mesh_solids(gmsh: Any, mesh_size: float, order: int, *, smallest: float | None = None) -> None:
    """Fill the solids of the current model with tetrahedra.

    Parameters
    ----------
    gmsh : module
    mesh_size : float
        Edge length aimed at, in the model's unit.
    order : {1, 2}
    smallest : float, optional
        Least edge length that a size field of the model may ask for; by default ``mesh_size``.
    """
    gmsh.option.setNumber("Mesh.MeshSizeMin", mesh_size if smallest is None else smallest)
    gmsh.option.setNumber("Mesh.MeshSizeMax", mesh_size)
    gmsh.option.setNumber("Mesh.Algorithm3D", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    if order == 2:
        _unfold(gmsh)


def _unfold(gmsh: Any) -> None:
    """Straighten the edges of elements that are folded by their curved sides, no more than needed.

    A bore or a fillet that is small beside its elements bends their edges so far that an element may turn inside
    out. The middle nodes of such an element are drawn back towards the middles of their edges, by halves and in the
    end all the way; its neighbours follow by sharing them. (gmsh's own remedy, an optimisation, takes minutes on
    fillets and ends the process where it does not converge.)
    """
    tags, connectivity = gmsh.model.mesh.getElementsByType(_TET10)
    elements = np.asarray(connectivity, dtype=np.int64).reshape(-1, 10)
    node_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(node_tags.max()) + 1, dtype=np.int64)
    number[node_tags] = np.arange(len(node_tags))
    points = np.asarray(coordinates, dtype=np.float64).reshape(-1, 3)
    curved = points.copy()
    bend = np.ones(len(points))
    for _ in range(_HALVINGS + 1):
        folded = gmsh.model.mesh.getElementQualities(tags, "minSJ") < _WORST_JACOBIAN
        nodes = number[elements[folded]]
        middle, ends = nodes[:, 4:].ravel(), nodes[:, _GMSH_EDGES].reshape(-1, 2)
        middle, first = np.unique(middle, return_index=True)
        straight = points[ends[first]].mean(axis=1)
        bent = np.linalg.norm(points[middle] - straight, axis=1) > _STRAIGHT_EDGE_BEND * np.ptp(
            points[ends[first]], axis=1
        ).max(axis=1, initial=0.0)
        if not bent.any():
            return
        middle, straight = middle[bent], straight[bent]
        bend[middle] = np.where(bend[middle] > 0.5**_HALVINGS, bend[middle] / 2, 0.0)
        points[middle] = straight + bend[middle, None] * (curved[middle] - straight)
        for node in middle:
            gmsh.model.mesh.setNode(node_tags[node], points[node], [])


@dataclass(frozen=True)
class Tetrahedra:
    """Mesh from gmsh as plain arrays in the mesh's own order of nodes, shaped as in :class:`gearwhine.meshes.Mesh`."""

    points: FloatArray
    cells: IntArray
    surfaces: Mapping[str, IntArray]
    volumes: Mapping[str, IntArray]

    def mesh(self) -> Mesh:
        """Make the mesh of these arrays.

        Raises
        ------
        GeometryError
            Where an element is inverted.
        """
        return Mesh.of_tetrahedra(self.points, self.cells, self.surfaces, self.volumes)


def _nearby(cells: IntArray, n_nodes: int) -> IntArray:
    """Reverse Cuthill-McKee order of the nodes (1969), in which the nodes of an element are near each other.

    gmsh numbers faces before solids and corners before middle nodes; loops over elements or over the rows of a matrix
    then jump through the whole memory.
    """
    first = np.repeat(np.arange(len(cells)), cells.shape[1])
    incidence = sparse.csr_array((np.ones(cells.size), (first, cells.ravel())), shape=(len(cells), n_nodes))
    return np.asarray(reverse_cuthill_mckee(sparse.csr_matrix(incidence.T @ incidence), symmetric_mode=True))


def collect(
    gmsh: Any,
    order: int,
    surfaces: Mapping[str, Sequence[int]],
    volumes: Mapping[str, Sequence[int]],
    *,
    unit: float = 1.0,
) -> Tetrahedra:
    """Nodes, elements and named regions of the current gmsh model, numbered from zero.

    Parameters
    ----------
    gmsh : module
    order : {1, 2}
        Order of the elements.
    surfaces, volumes : mapping of str to sequence of int
        Faces and solids of the model that make up each named region.
    unit : float
        The model's unit of length [m].
    """
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags] = np.arange(len(tags))
    points = np.asarray(coordinates, dtype=np.float64).reshape(-1, 3)

    tetrahedron, n_nodes = {1: (4, 4), 2: (11, 10)}[order]
    elements, connectivity = gmsh.model.mesh.getElementsByType(tetrahedron)
    cells = number[np.asarray(connectivity, dtype=np.int64)].reshape(-1, n_nodes)[:, _GMSH_TO_VTK[n_nodes]]
    nearby = _nearby(cells, len(points))
    number[tags] = np.argsort(nearby)
    points, cells = points[nearby], np.argsort(nearby)[cells]

    triangle, n_facet = {1: (2, 3), 2: (9, 6)}[order]
    # gmsh orders a six-node triangle 01, 12, 20: our 01, 12, 02 are the same nodes.
    facets: dict[str, IntArray] = {}
    for name, faces in surfaces.items():
        parts = [gmsh.model.mesh.getElementsByType(triangle, face)[1] for face in faces]
        facets[name] = number[np.concatenate(parts).astype(np.int64)].reshape(-1, n_facet)
    place = np.zeros(int(elements.max()) + 1 if len(elements) else 0, dtype=np.int64)
    place[elements] = np.arange(len(elements))
    members: dict[str, IntArray] = {}
    for name, solids in volumes.items():
        parts = [gmsh.model.mesh.getElementsByType(tetrahedron, solid)[0] for solid in solids]
        members[name] = np.sort(place[np.concatenate(parts)])
    return Tetrahedra(points * unit, cells, facets, members)
