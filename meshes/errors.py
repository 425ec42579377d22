"""What can go wrong between a geometry and its mesh."""


class GeometryError(ValueError):
    """The geometry or the mesh file cannot be meshed or used as it stands; the message says what to change."""


class MesherUnavailableError(RuntimeError):
    """gmsh is installed but cannot be loaded; the message says which system packages it lacks."""
