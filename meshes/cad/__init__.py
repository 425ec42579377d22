"""Housings from CAD files, through gmsh's OpenCASCADE kernel in a process of its own."""

from meshes.cad.reading import CadMesh, mesh_cad
from meshes.cad.units import UNITS

__all__ = ["UNITS", "CadMesh", "mesh_cad"]
