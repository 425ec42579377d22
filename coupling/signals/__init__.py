"""Vibration signals: spectra, levels, order tracking, sidebands, names of spectral lines, transfer paths.

- :func:`rms_of_peak`, :func:`decibels` and their inverses -- peak, rms and decibels, by one convention.
- :func:`power_density`, :func:`spectrogram` -- Welch's average over a long record, and spectra along it.
- :func:`resample_by_angle`, :func:`order_map` -- signals of a run-up by rotation angle, and their orders over speed.
- :func:`sidebands` -- amplitude and phase modulation of mesh harmonics by a shaft.
- :func:`line_names` -- harmonic, order, sideband or mode of a spectral line.
- :func:`housing_paths` -- contributions of bearings and housing modes to a sensor's lines.
"""

from gearwhine.coupling.signals.line_names import LineName, line_names
from gearwhine.coupling.signals.order_tracking import (
    AngleSignal,
    OrderMap,
    order_map,
    order_spectrum,
    resample_by_angle,
)
from gearwhine.coupling.signals.sidebands import Sideband, sidebands
from gearwhine.coupling.signals.spectrum import (
    ACCELERATION_REFERENCE,
    PowerDensity,
    Spectrogram,
    decibels,
    from_decibels,
    peak_of_rms,
    power_density,
    rms_of_peak,
    spectrogram,
)
from gearwhine.coupling.signals.transfer_paths import HousingPaths, SensorPaths, housing_paths, mode_parts

__all__ = [
    "ACCELERATION_REFERENCE",
    "AngleSignal",
    "HousingPaths",
    "LineName",
    "OrderMap",
    "PowerDensity",
    "SensorPaths",
    "Sideband",
    "Spectrogram",
    "decibels",
    "from_decibels",
    "housing_paths",
    "line_names",
    "mode_parts",
    "order_map",
    "order_spectrum",
    "peak_of_rms",
    "power_density",
    "resample_by_angle",
    "rms_of_peak",
    "sidebands",
    "spectrogram",
]
