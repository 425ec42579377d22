"""Gearbox housings by their dimensions: a box with walls, bores, bosses, feet, ribs, a cover and rounded edges."""

from gearwhine.meshes.box.fit import BoxMisfit as BoxMisfit
from gearwhine.meshes.box.geometry import BoxGeometry as BoxGeometry
from gearwhine.meshes.box.geometry import BoxMisfitError as BoxMisfitError
from gearwhine.meshes.box.meshing import mesh_box as mesh_box
from gearwhine.meshes.box.morph import BoxMorph as BoxMorph
from gearwhine.meshes.box.morph import MorphError as MorphError
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
