"""ROSS files: read and write rotors of ROSS (Rotordynamic Open Source Software), which need not be installed."""

from rotors.ross.reading import RossModel, read_ross
from rotors.ross.writing import write_ross

__all__ = ["RossModel", "read_ross", "write_ross"]
