"""Gears: tooth geometry, mesh stiffness, contact law and loaded transmission error of external spur and helical gears.

Each step is usable alone:

>>> from gearwhine.coupling.gears import Gear, GearPairGeometry, PotentialEnergyStiffness
>>> from gearwhine.coupling.gears import loaded_transmission_error, tooth_contact
>>> wheel = Gear("wheel", teeth=62, module=2e-3, pressure_angle=0.349066, face_width=20e-3, bore=35e-3)
>>> pair = GearPairGeometry(wheel, wheel)  # path of contact, working pressure angle, backlash
>>> contact = tooth_contact(pair, PotentialEnergyStiffness())  # stiffness and deviation along the path of contact
>>> loaded = loaded_transmission_error(contact, force=2000.0)  # transmission error, mesh stiffness, load sharing
>>> round(pair.contact_ratio, 4)
1.7898

Sub-packages: ``gearwhine.coupling.gears.geometry``, ``gearwhine.coupling.gears.stiffness`` (tooth models, ISO 6336),
``gearwhine.coupling.gears.contact`` (tooth contact force, face slices, kernels), ``gearwhine.coupling.gears.loaded``
(mesh under load). :func:`stiffness_model` chooses a tooth model of :data:`STIFFNESS_MODELS` by name. Positions along
the path of contact are in base pitches, phases in mesh periods, everything else in SI. Only the kernels import numba.
"""

from gearwhine.coupling.gears.contact.contact_law import ToothContact as ToothContact
from gearwhine.coupling.gears.contact.contact_law import tooth_contact as tooth_contact
from gearwhine.coupling.gears.errors import GearError as GearError
from gearwhine.coupling.gears.geometry.faults import MissingTooth as MissingTooth
from gearwhine.coupling.gears.geometry.faults import Spall as Spall
from gearwhine.coupling.gears.geometry.faults import Wear as Wear
from gearwhine.coupling.gears.geometry.gear import Gear as Gear
from gearwhine.coupling.gears.geometry.modifications import HelixDeviation as HelixDeviation
from gearwhine.coupling.gears.geometry.modifications import ProfileDeviation as ProfileDeviation
from gearwhine.coupling.gears.geometry.modifications import RootRelief as RootRelief
from gearwhine.coupling.gears.geometry.modifications import TipRelief as TipRelief
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry as GearPairGeometry
from gearwhine.coupling.gears.geometry.path_of_contact import path_of_contact as path_of_contact
from gearwhine.coupling.gears.geometry.ring_support import RingSupport as RingSupport
from gearwhine.coupling.gears.loaded.gear_pair import GearPair as GearPair
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair as LoadedGearPair
from gearwhine.coupling.gears.loaded.gear_pair import load_gear_pair as load_gear_pair
from gearwhine.coupling.gears.loaded.optimal_relief import harris_map as harris_map
from gearwhine.coupling.gears.loaded.optimal_relief import optimal_tip_relief as optimal_tip_relief
from gearwhine.coupling.gears.loaded.transmission_error import LoadedMesh as LoadedMesh
from gearwhine.coupling.gears.loaded.transmission_error import loaded_transmission_error as loaded_transmission_error
from gearwhine.coupling.gears.loaded.transmission_error import mesh_stiffness as mesh_stiffness
from gearwhine.coupling.gears.stiffness.crack import ToothCrack as ToothCrack
from gearwhine.coupling.gears.stiffness.iso6336 import Iso6336Stiffness as Iso6336Stiffness
from gearwhine.coupling.gears.stiffness.models import STIFFNESS_MODELS as STIFFNESS_MODELS
from gearwhine.coupling.gears.stiffness.models import ConstantStiffness as ConstantStiffness
from gearwhine.coupling.gears.stiffness.models import SquareStiffness as SquareStiffness
from gearwhine.coupling.gears.stiffness.models import StiffnessModel as StiffnessModel
from gearwhine.coupling.gears.stiffness.models import TableStiffness as TableStiffness
from gearwhine.coupling.gears.stiffness.models import stiffness_model as stiffness_model
from gearwhine.coupling.gears.stiffness.tooth_compliance import CornellStiffness as CornellStiffness
from gearwhine.coupling.gears.stiffness.tooth_compliance import ElasticRingStiffness as ElasticRingStiffness
from gearwhine.coupling.gears.stiffness.tooth_compliance import PotentialEnergyStiffness as PotentialEnergyStiffness
from gearwhine.coupling.gears.stiffness.tooth_compliance import WeberBanaschekStiffness as WeberBanaschekStiffness
