"""Housings from CAD files, through gmsh's OpenCASCADE kernel in a process of its own."""

from gearwhine.meshes.cad.reading import CadMesh as CadMesh
from gearwhine.meshes.cad.reading import mesh_cad as mesh_cad
