"""Gearwhine: from the geometry of a gearbox to the vibration that an accelerometer on it would show.

A case, from a file or from Python, and its analyses::

    import gearwhine as gw

    study = gw.load("small-gearbox")
    modes = study.modes()                      # certified complete
    modes.dataset["housing_frequency"]         # xarray, with units
    run = study.run()
    run.plot("spectrum")
    run.write("results")

Wrong input is a :class:`ValueError`: :class:`CaseError` of a case, :class:`GeometryError`, :class:`HousingError`,
:class:`RotorError`, :class:`GearError`, :class:`CouplingError` of objects. A result that fails its proof, and a missing
system library, is a :class:`RuntimeError`.

The parts of a machine as objects of the library: :class:`Housing`, :class:`Machine` with :class:`Shaft`,
:class:`ShaftGear`, :class:`GearPair` and :class:`MountedBearing`. The physics stands in the packages ``meshes``,
``housing``, ``rotors`` and ``coupling``.
"""

import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearwhine.analyses.optimisation_result import optimise as optimise
    from gearwhine.analyses.result import Result as Result
    from gearwhine.analyses.variation_result import vary as vary
    from gearwhine.case import Case as Case
    from gearwhine.case import CaseError as CaseError
    from gearwhine.case.units import rpm as rpm
    from gearwhine.case.units import to_rpm as to_rpm
    from gearwhine.case_study import CaseStudy as CaseStudy
    from gearwhine.case_study import build as build
    from gearwhine.case_study import load as load
    from gearwhine.coupling import CouplingError as CouplingError
    from gearwhine.coupling import GivenSpeed as GivenSpeed
    from gearwhine.coupling import Machine as Machine
    from gearwhine.coupling import MountedBearing as MountedBearing
    from gearwhine.coupling import Output as Output
    from gearwhine.coupling import PlanetarySet as PlanetarySet
    from gearwhine.coupling import Shaft as Shaft
    from gearwhine.coupling import ShaftForce as ShaftForce
    from gearwhine.coupling import ShaftGear as ShaftGear
    from gearwhine.coupling import SupportBolt as SupportBolt
    from gearwhine.coupling import TorqueSupport as TorqueSupport
    from gearwhine.coupling import planet_copies as planet_copies
    from gearwhine.coupling.analyses.recording import TransientPlan as TransientPlan
    from gearwhine.coupling.gears import Gear as Gear
    from gearwhine.coupling.gears import GearError as GearError
    from gearwhine.coupling.gears.loaded.gear_pair import GearPair as GearPair
    from gearwhine.coupling.sound import Acoustics as Acoustics
    from gearwhine.coupling.sound import Microphone as Microphone
    from gearwhine.housing import STEEL as STEEL
    from gearwhine.housing import Housing as Housing
    from gearwhine.housing import HousingError as HousingError
    from gearwhine.housing import Joint as Joint
    from gearwhine.housing import LumpedMass as LumpedMass
    from gearwhine.housing import Material as Material
    from gearwhine.housing import Mount as Mount
    from gearwhine.housing import Seat as Seat
    from gearwhine.housing import Sensor as Sensor
    from gearwhine.housing import Support as Support
    from gearwhine.housing.modal_test import ModalTest as ModalTest
    from gearwhine.housing_study import HousingStudy as HousingStudy
    from gearwhine.meshes import GeometryError as GeometryError
    from gearwhine.numerics.distributions import Discrete as Discrete
    from gearwhine.numerics.distributions import Normal as Normal
    from gearwhine.numerics.distributions import Triangular as Triangular
    from gearwhine.numerics.distributions import Uniform as Uniform
    from gearwhine.optimisation.scatter import Scatter as Scatter
    from gearwhine.progress import print_progress as print_progress
    from gearwhine.rotors import Bearing as Bearing
    from gearwhine.rotors import Disc as Disc
    from gearwhine.rotors import Rotor as Rotor
    from gearwhine.rotors import RotorError as RotorError
    from gearwhine.rotors import Segment as Segment
    from gearwhine.rotors import ShaftMaterial as ShaftMaterial
    from gearwhine.settings import Settings as Settings
    from gearwhine.study import Study as Study

try:
    __version__ = version("gearwhine")
except PackageNotFoundError:  # run from a checkout that is not installed
    __version__ = "0+unknown"

_HOMES = {
    "gearwhine.coupling": (
        "CouplingError",
        "GivenSpeed",
        "Machine",
        "MountedBearing",
        "Output",
        "PlanetarySet",
        "Shaft",
        "ShaftForce",
        "ShaftGear",
        "SupportBolt",
        "TorqueSupport",
        "planet_copies",
    ),
    "gearwhine.coupling.analyses.recording": ("TransientPlan",),
    "gearwhine.coupling.gears": ("Gear", "GearError"),
    "gearwhine.coupling.gears.loaded.gear_pair": ("GearPair",),
    "gearwhine.coupling.sound": ("Acoustics", "Microphone"),
    "gearwhine.analyses.result": ("Result",),
    "gearwhine.case": ("Case", "CaseError"),
    "gearwhine.case.units": ("rpm", "to_rpm"),
    "gearwhine.case_study": ("CaseStudy", "build", "load"),
    "gearwhine.settings": ("Settings",),
    "gearwhine.study": ("Study",),
    "gearwhine.housing": (
        "Housing",
        "HousingError",
        "Joint",
        "LumpedMass",
        "Material",
        "Mount",
        "STEEL",
        "Seat",
        "Sensor",
        "Support",
    ),
    "gearwhine.housing.modal_test": ("ModalTest",),
    "gearwhine.housing_study": ("HousingStudy",),
    "gearwhine.analyses.optimisation_result": ("optimise",),
    "gearwhine.analyses.variation_result": ("vary",),
    "gearwhine.meshes": ("GeometryError",),
    "gearwhine.numerics.distributions": ("Discrete", "Normal", "Triangular", "Uniform"),
    "gearwhine.optimisation.scatter": ("Scatter",),
    "gearwhine.progress": ("print_progress",),
    "gearwhine.rotors": ("Bearing", "Disc", "Rotor", "RotorError", "Segment", "ShaftMaterial"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [*sorted(_HOME_OF), "__version__"]


def __getattr__(name: str) -> Any:
    """Import a name where it is first used: the whole library takes more than a second."""
    if name not in _HOME_OF:
        raise AttributeError(f"module 'gearwhine' has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    return __all__


if "IPython" in sys.modules:
    import_module("gearwhine.notebook").register()
