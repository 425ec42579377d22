"""Housings from CAD files, through gmsh's OpenCASCADE kernel in a process of its own."""

from meshes.cad.reading import CadMesh as CadMesh
from meshes.cad.reading import mesh_cad as mesh_cad
