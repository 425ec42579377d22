"""Vibration signatures: what the lines of a spectrum are, where they come from and how they change with speed.

- :mod:`coupling.signature.levels` -- peak, rms and decibels, by one convention.
- :func:`power_density`, :func:`spectrogram` -- averages over a long record, and spectra along it.
- :func:`order_resampled`, :func:`order_map` -- signals of a run-up by turned angle, and their orders over speed.
- :func:`sidebands` -- what a shaft does to the harmonics of a gear mesh.
- :func:`line_names` -- which harmonic, order, sideband or mode a line is.
- :func:`housing_paths` -- what each bearing, and each mode of the housing, puts into a sensor's lines.
"""

from coupling.signature.averages import PowerDensity, Spectrogram, power_density, spectrogram
from coupling.signature.levels import ACCELERATION_REFERENCE, decibels, from_decibels, peak_of_rms, rms_of_peak
from coupling.signature.line_names import LineName, line_names
from coupling.signature.order_tracking import OrderMap, TurnedSignal, order_map, order_resampled, order_spectrum
from coupling.signature.sidebands import Sideband, sidebands
from coupling.signature.transfer_paths import HousingPaths, SensorPaths, housing_paths, mode_parts

__all__ = [
    "ACCELERATION_REFERENCE",
    "HousingPaths",
    "LineName",
    "OrderMap",
    "PowerDensity",
    "SensorPaths",
    "Sideband",
    "Spectrogram",
    "TurnedSignal",
    "decibels",
    "from_decibels",
    "housing_paths",
    "line_names",
    "mode_parts",
    "order_map",
    "order_resampled",
    "order_spectrum",
    "peak_of_rms",
    "power_density",
    "rms_of_peak",
    "sidebands",
    "spectrogram",
]
