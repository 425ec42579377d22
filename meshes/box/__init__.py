"""Gearbox housings by their dimensions: a box with walls, bores, bosses, feet, ribs, a cover and rounded edges."""

from meshes.box.geometry import BoxGeometry, BoxMisfitError
from meshes.box.meshing import mesh_box
from meshes.box.misfit import Misfit
from meshes.box.morph import BoxMorph
from meshes.box.parts import Bolt, Bore, Boss, Cover, CoverBolts, Feet, Fillets, Flange, Rib, WallThickness
from meshes.box.placed_faces import MorphError

__all__ = [
    "Bolt",
    "Bore",
    "Boss",
    "BoxGeometry",
    "BoxMisfitError",
    "BoxMorph",
    "Cover",
    "CoverBolts",
    "Feet",
    "Fillets",
    "Flange",
    "Misfit",
    "MorphError",
    "Rib",
    "WallThickness",
    "mesh_box",
]
