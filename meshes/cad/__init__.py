"""Housings from CAD files, through gmsh's OpenCASCADE kernel in a process of its own."""

from meshes.cad.reading import CadMesh, mesh_cad

__all__ = ["CadMesh", "mesh_cad"]
