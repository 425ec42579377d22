"""Gearwhine: from the geometry of a gearbox to the vibration that an accelerometer on it would show.

The front door: case files (:mod:`gearwhine.case`), the stages of a case (:mod:`gearwhine.stages`), the results folder
(:mod:`gearwhine.results`) and the command (:mod:`gearwhine.cli`). The physics stands in the rooms ``meshes``,
``housing``, ``rotors`` and ``coupling``.
"""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("gearwhine")
except PackageNotFoundError:  # run from a checkout that is not installed
    __version__ = "0+unknown"

__all__ = ["__version__"]
