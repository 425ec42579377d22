"""Content of a mesh file, independent of its format: nodes, solids and named sets, and the mesh made of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gearwhine.meshes.elements import NO_NODE, ElementBlock, faces_as_facets, group_rows, pick_facets
from gearwhine.meshes.errors import GeometryError
from gearwhine.meshes.mesh import Mesh
from gearwhine.meshes.shape_functions import volumes
from gearwhine.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class MeshContent:
    """Nodes, solid elements and named sets, as a file has them.

    Attributes
    ----------
    points : ndarray, shape (n_points, 3)
        Points in the file's unit of length; nodes that no element uses may be among them.
    solids : tuple of ElementBlock
        Elements may be numbered left-handed.
    volumes : mapping of str to ndarray of int
        Named sets of elements, counted over all blocks.
    facets : mapping of str to ndarray of int, shape (n_facets, 4)
        Named sets of facets by their corners, in any order of turn; the fourth is -1 in triangles.
    node_sets : mapping of str to ndarray of int
        Named sets of nodes.
    shells : mapping of str to ndarray of int, shape (n_facets, 4)
        Named sets of shell elements by their corners, as `facets`; some may lie on the solids and others not.
    """

    points: FloatArray
    solids: tuple[ElementBlock, ...]
    volumes: Mapping[str, IntArray] = field(default_factory=dict)
    facets: Mapping[str, IntArray] = field(default_factory=dict)
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    shells: Mapping[str, IntArray] = field(default_factory=dict)

    def mesh(self, unit: float = 1.0) -> Mesh:
        """Make the mesh, in metres where ``unit`` is the file's unit of length [m].

        Nodes that no solid uses are left out and left-handed elements turned. A set of facets becomes the surface of
        that name, each facet as its element has it: with its middle nodes, seen from outside. Sets of facets that bound
        no solid are left out, and so are shells beside it. A set of nodes becomes the surface of the boundary
        facets all of whose nodes are in it, unless facets have that name, or there is none.

        Raises
        ------
        GeometryError
            Where a set has facets of the solids and others too, or the elements make no mesh.
        """
        used = np.unique(np.concatenate([block.nodes.ravel() for block in self.solids]))
        renumbered = np.full(len(self.points) + 1, NO_NODE, dtype=np.int64)  # the last place is that of no node
        renumbered[used] = np.arange(len(used))
        points = self.points[used] * unit
        blocks = tuple(right_handed(points, ElementBlock(block.kind, renumbered[block.nodes])) for block in self.solids)
        bare = Mesh(points, blocks, volumes=dict(self.volumes))
        surfaces = {}
        for name, nodes in self.node_sets.items():
            inside = np.zeros(len(self.points), dtype=bool)
            inside[nodes] = True
            members = inside[used]
            chosen = [members[block.nodes].all(axis=1) for block in bare.boundary]
            if facets := pick_facets(bare.boundary, np.concatenate(chosen)):
                surfaces[name] = facets
        for name, corners in self.shells.items():
            on_solids = find_faces(bare, renumbered[corners])
            if len(faces := np.unique(on_solids[on_solids >= 0])):
                surfaces[name] = faces_as_facets(bare.blocks, bare.faces, faces)
        for name, corners in self.facets.items():
            faces = find_faces(bare, renumbered[corners])
            if (faces >= 0).all() and len(faces):
                # A facet that is listed twice, as by two sets with an element in both, is one.
                once = np.sort(np.unique(faces, return_index=True)[1])
                surfaces[name] = faces_as_facets(bare.blocks, bare.faces, faces[once])
            elif (faces >= 0).any():
                x, y, z = self.points[corners[np.argmin(faces)][:3]].mean(axis=0) * unit
                raise GeometryError(
                    f"{np.count_nonzero(faces < 0)} of the {len(faces)} facets of surface {name!r} are no faces of "
                    f"solid elements, the first at ({x:.6g}, {y:.6g}, {z:.6g}) m; the others are"
                )
        return Mesh(points, blocks, surfaces, bare.volumes)


def right_handed(points: FloatArray, block: ElementBlock) -> ElementBlock:
    """Renumber elements so that their volume is positive: some writers number them left-handed."""
    negative = volumes(points, block.corners, block.of.corners) < 0.0
    if not negative.any():
        return block
    return ElementBlock(block.kind, np.where(negative[:, None], block.nodes[:, block.of.mirrored], block.nodes))


def find_faces(mesh: Mesh, corners: IntArray) -> IntArray:
    """Find the face of each set of corners in the mesh's table of faces, -1 where there is none.

    Parameters
    ----------
    mesh : Mesh
    corners : ndarray of int, shape (n, 4)
        Corners in any order of turn; the fourth is -1 in triangles. A face shared by two elements is that of the first.
    """
    table = mesh.faces
    numbers = group_rows(np.sort(np.concatenate([table.corners, corners]), axis=1))
    listed, wanted = numbers[: len(table.corners)], numbers[len(table.corners) :]
    first = np.full(numbers.max() + 1, -1, dtype=np.int64)
    first[listed[::-1]] = np.arange(len(listed))[::-1]
    return np.asarray(first[wanted])


def corner_rows(block: ElementBlock) -> IntArray:
    """Return the corners of facets as rows of four, -1 for the fourth of triangles."""
    rows = np.full((len(block), 4), NO_NODE, dtype=np.int64)
    rows[:, : block.of.n_corners] = block.corners
    return rows
