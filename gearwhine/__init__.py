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
    from coupling import CouplingError as CouplingError
    from coupling import Machine as Machine
    from coupling import MountedBearing as MountedBearing
    from coupling import Output as Output
    from coupling import Shaft as Shaft
    from coupling import ShaftForce as ShaftForce
    from coupling import ShaftGear as ShaftGear
    from coupling.gears import Gear as Gear
    from coupling.gears import GearError as GearError
    from coupling.gears.loaded.gear_pair import GearPair as GearPair
    from gearwhine.analyses.result import Result as Result
    from gearwhine.case import Case as Case
    from gearwhine.case import CaseError as CaseError
    from gearwhine.case.units import rpm as rpm
    from gearwhine.case.units import to_rpm as to_rpm
    from gearwhine.study import Study as Study
    from gearwhine.study import build as build
    from gearwhine.study import load as load
    from housing import STEEL as STEEL
    from housing import Housing as Housing
    from housing import HousingError as HousingError
    from housing import Joint as Joint
    from housing import LumpedMass as LumpedMass
    from housing import Material as Material
    from housing import Mount as Mount
    from housing import Seat as Seat
    from housing import Sensor as Sensor
    from housing import Support as Support
    from meshes import GeometryError as GeometryError
    from rotors import Bearing as Bearing
    from rotors import Disc as Disc
    from rotors import Rotor as Rotor
    from rotors import RotorError as RotorError
    from rotors import Segment as Segment
    from rotors import ShaftMaterial as ShaftMaterial

try:
    __version__ = version("gearwhine")
except PackageNotFoundError:  # run from a checkout that is not installed
    __version__ = "0+unknown"

_HOMES = {
    "coupling": ("CouplingError", "Machine", "MountedBearing", "Output", "Shaft", "ShaftForce", "ShaftGear"),
    "coupling.gears": ("Gear", "GearError"),
    "coupling.gears.loaded.gear_pair": ("GearPair",),
    "gearwhine.analyses.result": ("Result",),
    "gearwhine.case": ("Case", "CaseError"),
    "gearwhine.case.units": ("rpm", "to_rpm"),
    "gearwhine.study": ("Study", "build", "load"),
    "housing": (
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
    "meshes": ("GeometryError",),
    "rotors": ("Bearing", "Disc", "Rotor", "RotorError", "Segment", "ShaftMaterial"),
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
