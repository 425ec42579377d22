"""Placeholder."""

from .torsion import TorsionalModes

AxialModes = TorsionalModes
