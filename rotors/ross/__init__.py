"""ROSS files: read and write rotors of ROSS (Rotordynamic Open Source Software), which need not be installed.

ROSS reads its files itself, but takes fourteen seconds to import, and what it gives are its finite elements: the
translation between these and segments, discs and bearings, which is most of this folder, would stay.
"""

from gearwhine.rotors.ross.reading import RossModel, read_ross
from gearwhine.rotors.ross.writing import write_ross

__all__ = ["RossModel", "read_ross", "write_ross"]
