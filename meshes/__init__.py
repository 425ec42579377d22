"""Finite-element meshes: from box dimensions, a CAD file or a mesh file to nodes, elements and named regions.

- :class:`Mesh` holds nodes [m], blocks of solid elements (:class:`ElementBlock`) and named regions.
- :class:`BoxGeometry` describes a box housing by its parts (:class:`WallThickness`, :class:`Bore`, :class:`Boss`,
  :class:`Feet`, :class:`Rib`, :class:`Cover`, :class:`Fillets`). :func:`mesh_box` meshes it with gmsh, and
  :class:`BoxMorph` moves that mesh to other dimensions.
- :func:`mesh_cad` meshes the solids of a STEP, IGES or BREP file; :func:`read_mesh` and :func:`write_mesh` exchange
  mesh files.
- :func:`box_facets`, :func:`plane_facets`, :func:`circle_facets` and :func:`cylinder_facets` select parts of the
  surface; :func:`find_bores` and :func:`with_bore` find bores by centre and diameter.
- :func:`diagnose` lists the defects of a mesh (:class:`MeshDefect`), :func:`mesh_quality` measures its elements, and
  :func:`resolution_defects` compares their size with the wavelength.

Sub-packages: ``meshes.box`` (parametric housing), ``meshes.cad`` (CAD import), ``meshes.formats`` (file formats).
*Mesh* always means the finite-element mesh; the contact of two gears is the *gear mesh*. gmsh is imported when a mesh
is made, not before.
"""

from meshes.bores import find_bores as find_bores
from meshes.box.geometry import BoxGeometry as BoxGeometry
from meshes.box.meshing import mesh_box as mesh_box
from meshes.box.morph import BoxMorph as BoxMorph
from meshes.box.parts import Bolt as Bolt
from meshes.box.parts import Bore as Bore
from meshes.box.parts import Boss as Boss
from meshes.box.parts import Cover as Cover
from meshes.box.parts import CoverBolts as CoverBolts
from meshes.box.parts import Feet as Feet
from meshes.box.parts import Fillets as Fillets
from meshes.box.parts import Flange as Flange
from meshes.box.parts import Rib as Rib
from meshes.box.parts import WallThickness as WallThickness
from meshes.cad.reading import CadMesh as CadMesh
from meshes.cad.reading import mesh_cad as mesh_cad
from meshes.diagnosis import diagnose as diagnose
from meshes.elements import ElementBlock as ElementBlock
from meshes.errors import GeometryError as GeometryError
from meshes.formats.files import read_mesh as read_mesh
from meshes.formats.files import write_mesh as write_mesh
from meshes.gmsh_meshing import check_mesh_size as check_mesh_size
from meshes.mesh import Mesh as Mesh
from meshes.mesh import MeshDefect as MeshDefect
from meshes.quality import mesh_quality as mesh_quality
from meshes.quality import resolution_defects as resolution_defects
from meshes.regions import box_facets as box_facets
from meshes.regions import circle_facets as circle_facets
from meshes.regions import cylinder_facets as cylinder_facets
from meshes.regions import plane_facets as plane_facets
from meshes.regions import with_bore as with_bore
