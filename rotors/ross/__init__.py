"""ROSS files: read and write rotors of ROSS (Rotordynamic Open Source Software), which need not be installed."""

from gearwhine.rotors.ross.reading import RossModel, read_ross
from gearwhine.rotors.ross.writing import write_ross

__all__ = ["RossModel", "read_ross", "write_ross"]
