"""From a gmsh model of solids to a mesh of tetrahedra: element size, order, middle nodes, numbering."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from meshes.errors import GeometryError
from meshes.mesh import IntArray, Mesh

# gmsh numbers the last two middle nodes of a ten-node tetrahedron the other way round than VTK does.
_GMSH_TO_VTK = {4: [0, 1, 2, 3], 10: [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}
_WORST_JACOBIAN = 0.05


def check_mesh_request(mesh_size: float, order: int) -> None:
    """Hold the numbers that every mesher takes to their ranges.

    Raises
    ------
    GeometryError
        For a size that is not positive, or an order other than 1 and 2.
    """
    if not mesh_size > 0.0 or order not in (1, 2):
        raise GeometryError(f"mesh size {mesh_size} m must be positive and order {order} be 1 or 2")


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
    """Bend elements back whose curved side folds them: it happens where they are large beside a bore's radius."""
    tags, _ = gmsh.model.mesh.getElementsByType(11)
    if len(tags) and gmsh.model.mesh.getElementQualities(tags, "minSJ").min() < _WORST_JACOBIAN:
        gmsh.model.mesh.optimize("HighOrder")


def collect_mesh(
    gmsh: Any,
    order: int,
    surfaces: Mapping[str, Sequence[int]],
    volumes: Mapping[str, Sequence[int]],
    *,
    unit: float = 1.0,
) -> Mesh:
    """Nodes, elements and named regions of the current gmsh model, numbered from zero.

    Parameters
    ----------
    gmsh : module
    order : {1, 2}
        Of the elements.
    surfaces, volumes : mapping of str to sequence of int
        Which faces and solids of the model make up each named region.
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
    return Mesh(points=points * unit if unit != 1.0 else points, cells=cells, surfaces=facets, volumes=members)
