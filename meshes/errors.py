"""Errors of geometries and meshes."""

from gearwhine.numerics.findings import RefusedPartError, WorkFailedError


class GeometryError(RefusedPartError):
    """The geometry or the mesh file cannot be meshed or used as it stands; the message says what to change."""


class MeshSizeError(GeometryError):
    """Elements of the size asked for would be too many to solve, or larger than the part."""


class MesherUnavailableError(WorkFailedError):
    """gmsh is installed but cannot be loaded; the message says which system packages it lacks."""
