"""Finite-element meshes: from a geometry, or a file, to nodes and elements with named regions.

What the room offers:

- :class:`Mesh` -- nodes, blocks of solid elements (:class:`ElementBlock`) and named regions, in metres.
- :class:`BoxGeometry` with :class:`WallThickness`, :class:`Bore`, :class:`Boss`, :class:`Feet` -- a gearbox
  housing described by its dimensions; :func:`mesh_box` meshes it with gmsh.
- :func:`read_mesh`, :func:`write_mesh` -- mesh files of every format that meshio knows.
- :func:`mesh_quality` -- edge lengths and element shapes, as numbers that say whether to trust the mesh.
- :func:`diagnose` -- what is wrong with a mesh, or doubtful in it, by name (:class:`Ailment`);
  :func:`resolution_ailments` -- whether its elements are small enough for the waves in it.

In names, *mesh* is always the finite-element mesh; the gears' is the *gear mesh*.
gmsh itself is imported only when a mesh is made.
"""

from meshes.ailments import Ailment
from meshes.box import Bore, Boss, BoxGeometry, Feet, WallThickness, mesh_box
from meshes.diagnosis import diagnose
from meshes.elements import (
    KINDS,
    ElementBlock,
    ElementKind,
    Facets,
    facet_centers,
    facet_corners,
    facet_nodes,
    facets_of,
    pick_facets,
)
from meshes.errors import GeometryError, MesherUnavailableError
from meshes.files import read_mesh, write_mesh
from meshes.mesh import Mesh
from meshes.quality import MeshQuality, mesh_quality
from meshes.resolution import WaveCarrier, resolution_ailments, wall_thickness

__all__ = [
    "KINDS",
    "Ailment",
    "Bore",
    "Boss",
    "BoxGeometry",
    "ElementBlock",
    "ElementKind",
    "Facets",
    "Feet",
    "GeometryError",
    "Mesh",
    "MeshQuality",
    "MesherUnavailableError",
    "WallThickness",
    "WaveCarrier",
    "diagnose",
    "facet_centers",
    "facet_corners",
    "facet_nodes",
    "facets_of",
    "mesh_box",
    "mesh_quality",
    "pick_facets",
    "read_mesh",
    "resolution_ailments",
    "wall_thickness",
    "write_mesh",
]
