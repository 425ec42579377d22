"""Gears: tooth geometry, mesh stiffness, contact law and loaded transmission error of external spur and helical gears.

Each step is usable alone:

>>> from coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness
>>> from coupling.gears import loaded_transmission_error, tooth_contact
>>> wheel = Gear("wheel", teeth=62, module=2e-3, pressure_angle=0.349066, face_width=20e-3, bore=35e-3)
>>> pair = GearPairGeometry(wheel, wheel)  # path of contact, working pressure angle, backlash
>>> contact = tooth_contact(pair, PotentialEnergyStiffness())  # stiffness and deviation along the path of contact
>>> loaded = loaded_transmission_error(contact, force=2000.0)  # transmission error, mesh stiffness, load sharing
>>> round(pair.contact_ratio, 4)
1.7898

Sub-packages: ``coupling.gears.geometry``, ``coupling.gears.stiffness`` (tooth models, ISO 6336),
``coupling.gears.contact`` (tooth contact force, face slices, kernels), ``coupling.gears.loaded`` (mesh under load).
:func:`stiffness_model` chooses a tooth model of :data:`STIFFNESS_MODELS` by name. Positions along the path of contact
are in base pitches, phases in mesh periods, everything else in SI. Only the kernels import numba.
"""

from coupling.gears.contact.contact_law import ToothContact as ToothContact
from coupling.gears.contact.contact_law import tooth_contact as tooth_contact
from coupling.gears.errors import GearError as GearError
from coupling.gears.geometry.faults import MissingTooth as MissingTooth
from coupling.gears.geometry.faults import Spall as Spall
from coupling.gears.geometry.faults import Wear as Wear
from coupling.gears.geometry.gear import Gear as Gear
from coupling.gears.geometry.modifications import HelixDeviation as HelixDeviation
from coupling.gears.geometry.modifications import ProfileDeviation as ProfileDeviation
from coupling.gears.geometry.modifications import RootRelief as RootRelief
from coupling.gears.geometry.modifications import TipRelief as TipRelief
from coupling.gears.geometry.pair import GearPairGeometry as GearPairGeometry
from coupling.gears.geometry.path_of_contact import path_of_contact as path_of_contact
from coupling.gears.loaded.gear_pair import GearPair as GearPair
from coupling.gears.loaded.gear_pair import LoadedGearPair as LoadedGearPair
from coupling.gears.loaded.gear_pair import load_gear_pair as load_gear_pair
from coupling.gears.loaded.optimal_relief import harris_map as harris_map
from coupling.gears.loaded.optimal_relief import optimal_tip_relief as optimal_tip_relief
from coupling.gears.loaded.transmission_error import LoadedMesh as LoadedMesh
from coupling.gears.loaded.transmission_error import loaded_transmission_error as loaded_transmission_error
from coupling.gears.loaded.transmission_error import mesh_stiffness as mesh_stiffness
from coupling.gears.stiffness.crack import ToothCrack as ToothCrack
from coupling.gears.stiffness.iso6336 import Iso6336Stiffness as Iso6336Stiffness
from coupling.gears.stiffness.models import STIFFNESS_MODELS as STIFFNESS_MODELS
from coupling.gears.stiffness.models import ConstantStiffness as ConstantStiffness
from coupling.gears.stiffness.models import SquareStiffness as SquareStiffness
from coupling.gears.stiffness.models import StiffnessModel as StiffnessModel
from coupling.gears.stiffness.models import TableStiffness as TableStiffness
from coupling.gears.stiffness.models import stiffness_model as stiffness_model
from coupling.gears.stiffness.tooth_compliance import CornellStiffness as CornellStiffness
from coupling.gears.stiffness.tooth_compliance import ElasticRingStiffness as ElasticRingStiffness
from coupling.gears.stiffness.tooth_compliance import PotentialEnergyStiffness as PotentialEnergyStiffness
from coupling.gears.stiffness.tooth_compliance import WeberBanaschekStiffness as WeberBanaschekStiffness
