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

Sub-packages: ``gearwhine.meshes.box`` (parametric housing), ``gearwhine.meshes.cad`` (CAD import),
``gearwhine.meshes.formats`` (file formats). *Mesh* always means the finite-element mesh; the contact of two gears is
the *gear mesh*. gmsh is imported when a mesh is made, not before.
"""

from gearwhine.meshes.bores import find_bores as find_bores
from gearwhine.meshes.box.geometry import BoxGeometry as BoxGeometry
from gearwhine.meshes.box.meshing import mesh_box as mesh_box
from gearwhine.meshes.box.morph import BoxMorph as BoxMorph
from gearwhine.meshes.box.parts import Bolt as Bolt
from gearwhine.meshes.box.parts import Bore as Bore
from gearwhine.meshes.box.parts import Boss as Boss
from gearwhine.meshes.box.parts import Cover as Cover
from gearwhine.meshes.box.parts import CoverBolts as CoverBolts
from gearwhine.meshes.box.parts import Feet as Feet
from gearwhine.meshes.box.parts import Fillets as Fillets
from gearwhine.meshes.box.parts import Flange as Flange
from gearwhine.meshes.box.parts import Rib as Rib
from gearwhine.meshes.box.parts import WallThickness as WallThickness
from gearwhine.meshes.cad.reading import CadMesh as CadMesh
from gearwhine.meshes.cad.reading import mesh_cad as mesh_cad
from gearwhine.meshes.diagnosis import diagnose as diagnose
from gearwhine.meshes.elements import ElementBlock as ElementBlock
from gearwhine.meshes.errors import GeometryError as GeometryError
from gearwhine.meshes.formats.files import read_mesh as read_mesh
from gearwhine.meshes.formats.files import write_mesh as write_mesh
from gearwhine.meshes.gmsh_meshing import check_mesh_size as check_mesh_size
from gearwhine.meshes.mesh import Mesh as Mesh
from gearwhine.meshes.mesh import MeshDefect as MeshDefect
from gearwhine.meshes.quality import mesh_quality as mesh_quality
from gearwhine.meshes.quality import resolution_defects as resolution_defects
from gearwhine.meshes.regions import box_facets as box_facets
from gearwhine.meshes.regions import circle_facets as circle_facets
from gearwhine.meshes.regions import cylinder_facets as cylinder_facets
from gearwhine.meshes.regions import plane_facets as plane_facets
from gearwhine.meshes.regions import with_bore as with_bore
