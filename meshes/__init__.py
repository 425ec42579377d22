"""Finite-element meshes: from a geometry, or a file, to nodes and elements with named regions.

- :class:`Mesh` -- nodes, blocks of solid elements (:class:`ElementBlock`) and named regions, in metres.
- :class:`BoxGeometry` with :class:`WallThickness`, :class:`Bore`, :class:`Boss`, :class:`Feet`, :class:`Rib`,
  :class:`Cover` (:class:`Flange`, :class:`CoverBolts`) and :class:`Fillets` -- a gearbox housing described by its
  dimensions; :func:`mesh_box` meshes it with gmsh, :class:`BoxMorph` moves that mesh to other dimensions.
- :func:`mesh_cad` -- the solids of a STEP, IGES or BREP file, as a :class:`CadMesh`.
- :func:`check_mesh_size` -- refuses an element size that cannot be meshed or solved.
- :func:`box_facets`, :func:`circle_facets`, :func:`plane_facets`, :func:`cylinder_facets`, :func:`find_bores`,
  :func:`with_bore` -- regions of the surface of any mesh by place; bores by centre and diameter.
- :func:`read_mesh`, :func:`write_mesh` -- mesh files of every format that meshio knows.
- :func:`mesh_quality` -- edge lengths and shape numbers of the elements.
- :func:`diagnose` -- defects of a mesh by name (:class:`MeshDefect`); :func:`resolution_defects` -- elements that are
  too large for the structural waves.

In names, *mesh* is always the finite-element mesh; the gears' is the *gear mesh*.
gmsh itself is imported only when a mesh is made.
"""

from meshes.ailments import MeshDefect
from meshes.bores import CylindricalBore, find_bores
from meshes.box import (
    Bolt,
    Bore,
    Boss,
    BoxGeometry,
    BoxMisfit,
    BoxMisfitError,
    BoxMorph,
    Cover,
    CoverBolts,
    Feet,
    Fillets,
    Flange,
    MorphError,
    Rib,
    WallThickness,
    mesh_box,
)
from meshes.cad import CadMesh, mesh_cad
from meshes.diagnosis import diagnose
from meshes.elements import (
    KINDS,
    ElementBlock,
    ElementKind,
    Facets,
    facet_centers,
    facet_corners,
    facet_nodes,
    facet_normals,
    facets_of,
    pick_facets,
)
from meshes.errors import GeometryError, MesherUnavailableError, MeshSizeError
from meshes.files import read_mesh, write_mesh
from meshes.lengths import UNITS
from meshes.mesh import Mesh
from meshes.quality import MeshQuality, mesh_quality
from meshes.regions import box_facets, circle_facets, cylinder_facets, plane_facets, with_bore
from meshes.resolution import WaveCarrier, resolution_defects, wall_thickness
from meshes.tetrahedra import check_mesh_size, expected_elements

__all__ = [
    "KINDS",
    "UNITS",
    "Bolt",
    "Bore",
    "Boss",
    "BoxGeometry",
    "BoxMisfit",
    "BoxMisfitError",
    "BoxMorph",
    "CadMesh",
    "Cover",
    "CoverBolts",
    "CylindricalBore",
    "ElementBlock",
    "ElementKind",
    "Facets",
    "Feet",
    "Fillets",
    "Flange",
    "GeometryError",
    "Mesh",
    "MeshDefect",
    "MeshQuality",
    "MeshSizeError",
    "MesherUnavailableError",
    "MorphError",
    "Rib",
    "WallThickness",
    "WaveCarrier",
    "box_facets",
    "check_mesh_size",
    "circle_facets",
    "cylinder_facets",
    "diagnose",
    "expected_elements",
    "facet_centers",
    "facet_corners",
    "facet_nodes",
    "facet_normals",
    "facets_of",
    "find_bores",
    "mesh_box",
    "mesh_cad",
    "mesh_quality",
    "pick_facets",
    "plane_facets",
    "read_mesh",
    "resolution_defects",
    "wall_thickness",
    "with_bore",
    "write_mesh",
]
