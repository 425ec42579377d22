"""MED files of Salome, Code_Aster and gmsh: reader of nodes, solids, facets and groups, by HDF5.

meshio reads these files too, but fails on fields of results beside the mesh, on groups of facets without a name and on
files whose nodes are in no family, which Code_Aster and gmsh write; it takes the twenty-seven nodes of a brick in
MED's order for those of VTK's.

A mesh stands in ``/ENS_MAA/NAME``, since MED 3 one time step deeper, with coordinates ``NOE/COO`` and connectivities
``MAI/TYPE/NOD``, component by component. Each element and node has the number of a family, and a family in
``/FAS/NAME`` names the groups that it belongs to.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.meshes.elements import KINDS, SOLIDS, ElementBlock, count, outside_nodes
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.formats.content import MeshContent, corner_rows
from gearwhine.numerics.arrays import FloatArray, IntArray

# Elements by MED's names; others of one or two dimensions are passed over.
_KINDS = {
    "TE4": "tetra",
    "T10": "tetra10",
    "HE8": "hexahedron",
    "H20": "hexahedron20",
    "H27": "hexahedron27",
    "PE6": "wedge",
    "P15": "wedge15",
    "TR3": "triangle",
    "TR6": "triangle6",
    "QU4": "quad",
    "QU8": "quad8",
    "QU9": "quad9",
}
_UNKNOWN_SOLIDS = {
    "PY5": "pyramids",
    "P13": "pyramids",
    "P18": "wedges of 18 nodes",
    "O12": "hexagonal prisms",
    "POE": "polyhedra",
    "PO2": "polyhedra",
}


def read_med(path: Path) -> MeshContent:
    """Read a MED file with one mesh of solids.

    Groups of solids become volumes, groups of facets sets of facets, and groups of nodes node sets.

    Raises
    ------
    GeometryError
        Where the file is no MED file, holds several meshes of solids or none, elements of an unknown kind, or nodes
        that are not there.
    """
    import h5py  # costs a tenth of a second

    try:
        with h5py.File(path) as file:
            if "ENS_MAA" not in file:
                raise GeometryError(f"mesh file {path} is HDF5 without a group ENS_MAA; expected a MED file")
            name, mesh = _mesh_of_solids(file["ENS_MAA"], path)
            families = file.get(f"FAS/{name}")
            of_elements, of_nodes = (_groups_of_families(families, kind) for kind in ("ELEME", "NOEUD"))
            return _content(mesh, of_elements, of_nodes, path)
    except GeometryError:
        raise
    except OSError as error:
        raise GeometryError(f"mesh file {path} is no HDF5 file, which a MED file is: {error}") from error
    except (KeyError, ValueError, AttributeError) as error:
        raise GeometryError(f"mesh file {path} has not the groups and arrays of a MED file: {error}") from error


def _mesh_of_solids(meshes: Any, path: Path) -> tuple[str, Any]:
    """Return name and group of the one mesh that holds solids."""
    found = {}
    for name, mesh in meshes.items():
        step = mesh if "NOE" in mesh else next((part for part in mesh.values() if "NOE" in part), None)
        if step is not None:
            found[name] = step
    kinds = {name for name, kind in _KINDS.items() if kind in SOLIDS} | set(_UNKNOWN_SOLIDS)
    solid = {name: step for name, step in found.items() if kinds & set(step.get("MAI", ()))}
    if not solid:
        held = ", ".join(sorted({kind for step in found.values() for kind in step.get("MAI", ())})) or "nothing"
        raise GeometryError(f"mesh file {path} holds no solid elements of {', '.join(SOLIDS)}; it holds: {held}")
    if len(solid) > 1:
        raise GeometryError(f"mesh file {path} holds {len(solid)} meshes, {', '.join(solid)}; write one of them")
    return next(iter(solid.items()))


def _groups_of_families(families: Any, kind: str) -> dict[int, list[str]]:
    """Names of the groups of each family of elements or of nodes, by its number; those without groups are left out."""
    if families is None or kind not in families:
        return {}
    return {
        int(np.ravel(family.attrs["NUM"])[0]): [_text(row) for row in family["GRO/NOM"][()]]
        if "GRO/NOM" in family
        else []
        for family in families[kind].values()
    }


def _text(row: Any) -> str:
    """Text of eighty bytes, filled with zeros or blanks."""
    return bytes(np.asarray(row, dtype=np.int8)).split(b"\0")[0].decode("utf-8", errors="replace").strip()


def _content(
    mesh: Any, of_elements: Mapping[int, list[str]], of_nodes: Mapping[int, list[str]], path: Path
) -> MeshContent:
    places = mesh["NOE/COO"]
    n_points = int(np.ravel(places.attrs["NBR"])[0]) if "NBR" in places.attrs else len(places) // 3
    if n_points < 1 or len(places) != 3 * n_points:
        raise GeometryError(
            f"mesh file {path} has {len(places)} coordinates of {n_points} nodes; expected three of each"
        )
    points = np.asarray(places[()], dtype=np.float64).reshape(3, n_points).T
    solids: list[ElementBlock] = []
    volumes: dict[str, list[IntArray]] = {}
    facets: dict[str, list[IntArray]] = {}
    for name, cells in mesh["MAI"].items():
        if name in _UNKNOWN_SOLIDS:
            known = ", ".join(SOLIDS)
            raise GeometryError(
                f"mesh file {path} holds {_UNKNOWN_SOLIDS[name]}, which are not known here; known: {known}"
            )
        if name not in _KINDS:
            continue
        block = _block(_KINDS[name], cells["NOD"][()], points, path)
        tags = np.asarray(cells["FAM"][()]) if "FAM" in cells else np.zeros(len(block), dtype=np.int64)
        if len(tags) != len(block):
            raise GeometryError(f"mesh file {path} has families of {len(tags)} elements {name}; expected {len(block)}")
        for group, members in _members(tags, of_elements):
            if block.kind in SOLIDS:
                volumes.setdefault(group, []).append(count(solids) + members)
            else:
                facets.setdefault(group, []).append(corner_rows(block)[members])
        if block.kind in SOLIDS:
            solids.append(block)
    node_tags = np.asarray(mesh["NOE/FAM"][()]) if "FAM" in mesh["NOE"] else np.zeros(0, dtype=np.int64)
    node_sets: dict[str, list[IntArray]] = {}
    for group, members in _members(node_tags, of_nodes):
        node_sets.setdefault(group, []).append(members)
    return MeshContent(
        points=points,
        solids=tuple(solids),
        volumes={name: np.unique(np.concatenate(parts)) for name, parts in volumes.items()},
        facets={name: np.concatenate(parts) for name, parts in facets.items()},
        node_sets={name: np.unique(np.concatenate(parts)) for name, parts in node_sets.items()},
    )


def _members(tags: IntArray, families: Mapping[int, list[str]]) -> Iterator[tuple[str, IntArray]]:
    for tag in np.unique(tags).tolist():
        for group in families.get(int(tag), ()):
            yield group, np.flatnonzero(tags == tag)


def _block(kind: str, flat: Any, points: FloatArray, path: Path) -> ElementBlock:
    """Elements of a kind, whose connectivity stands node by node, counted from 1."""
    n_nodes = KINDS[kind].n_nodes
    if len(flat) % n_nodes:
        raise GeometryError(f"mesh file {path} has {len(flat)} nodes of {kind} elements; expected {n_nodes} of each")
    block = ElementBlock(kind, np.asarray(flat, dtype=np.int64).reshape(n_nodes, -1).T - 1)
    if fault := outside_nodes(block, len(points)):
        raise GeometryError(f"mesh file {path} {fault}")
    if kind == "hexahedron27":
        return ElementBlock(kind, _centred(block, points, path))
    return block


def _centred(block: ElementBlock, points: FloatArray, path: Path) -> IntArray:
    """Nodes of bricks with those in the middles of faces and elements in VTK's order, which their places tell."""
    first = KINDS["hexahedron20"].n_nodes
    corners = points[block.corners]
    weights = np.array(block.of.places)[first:]
    # A middle's reference coordinates are those of all corners of its face, or 0.5.
    ends = np.array(KINDS["hexahedron"].places)
    shares = np.all((weights[:, None] == 0.5) | (weights[:, None] == ends), axis=2).astype(np.float64)
    expected = np.einsum("fc,ecx->efx", shares / shares.sum(axis=1, keepdims=True), corners)
    given = points[block.nodes[:, first:]]
    apart = np.linalg.norm(given[:, None] - expected[:, :, None], axis=3).mean(axis=0)
    order = np.argmin(apart, axis=1)
    if len(set(order.tolist())) < len(order):
        raise GeometryError(f"mesh file {path} has bricks of 27 nodes whose inner ones are not in the middles of faces")
    return np.concatenate([block.nodes[:, :first], block.nodes[:, first:][:, order]], axis=1)
