"""What was measured: the survey's geometry and its modes."""

from housing.measured.geometry import MeasuredGeometry
from housing.measured.modes import MeasuredModes

__all__ = ["MeasuredGeometry", "MeasuredModes"]
