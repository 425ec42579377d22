"""Gearbox housings by their dimensions: a box with walls, bores, bosses, feet, ribs, a cover and rounded edges."""

from meshes.box.fit import BoxMisfit as BoxMisfit
from meshes.box.geometry import BoxGeometry as BoxGeometry
from meshes.box.geometry import BoxMisfitError as BoxMisfitError
from meshes.box.meshing import mesh_box as mesh_box
from meshes.box.morph import BoxMorph as BoxMorph
from meshes.box.morph import MorphError as MorphError
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
