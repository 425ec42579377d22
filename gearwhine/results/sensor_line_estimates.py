"""Estimates beside the lines of sensors: modal truncation error, mechanisms that excite them, and band by damping."""

from typing import Any

import numpy as np

from gearwhine.coupling.linear.damping_band import DampingBand
from gearwhine.coupling.linear.frequency_response import BasisError

_TWO_PI = 2.0 * np.pi
_BANDS = 8  # bands of equal width up to the limit
_OF_A_BAND = 12  # frequencies in each band


def add_uncertainty(document: dict[str, Any], error: BasisError | None, limit_hz: float | None) -> None:
    """Add ``uncertainty`` to every line of the document's sensors, and its course by bands under ``basis_error``.

    Parameters
    ----------
    document : dict
        Document with ``sensors``, whose ``peaks`` or ``lines`` have a ``frequency_hz``, with ``motions`` that have
        such sensors, or with ``mesh_lines``, which have it by sensor.
    error : BasisError or None
        None, where no basis is behind the lines: nothing is added.
    limit_hz : float or None
        Upper end of the bands; no bands where it is not given.
    """
    if error is None:
        return
    rows, harmonics = _sensor_lines(document), document.get("mesh_lines") or ()
    frequencies = np.unique([line["frequency_hz"] for line in (*(line for _, line in rows), *harmonics)])
    errors = error.at(_TWO_PI * frequencies)
    for name, line in rows:
        line["uncertainty"] = float(errors[name][np.searchsorted(frequencies, line["frequency_hz"])])
    for line in harmonics:
        place = np.searchsorted(frequencies, line["frequency_hz"])
        line["uncertainty"] = {name: float(of_sensor[place]) for name, of_sensor in errors.items()}
    if limit_hz is not None:
        document["basis_error"] = _bands(error, limit_hz)


def _sensor_lines(document: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the lines of a document's sensors, and of those of its motions, each with the sensor's name."""
    holders = [document, *document.get("motions", ())]
    sensors = [sensor for holder in holders for sensor in holder.get("sensors", ())]
    return [(sensor["name"], line) for sensor in sensors for key in ("peaks", "lines") for line in sensor.get(key, ())]


def add_mechanisms(document: dict[str, Any], bands_by_damping: DampingBand, within_hz: float = 0.0) -> None:
    """Add its mechanisms and its band by damping to every line of the document's sensors.

    ``parts`` are the amplitudes by what excites the line, ``part_shares`` the parts in phase with their sum, and
    ``parts_together_m_per_s2`` the amplitude of the sum, by the linear model; ``band_db`` is [below, above], all
    damping doubled and halved. ``mesh_lines`` have them by sensor. What stands in a document over a run is no line: it
    has the band alone.

    Parameters
    ----------
    document : dict
    bands_by_damping : DampingBand
        Bands, with the mechanisms of the lines.
    within_hz : float
        Distance within which the frequencies of lines are known [Hz].
    """
    mechanisms = bands_by_damping.mechanisms
    rows, harmonics = _sensor_lines(document), document.get("mesh_lines") or ()
    frequencies = np.unique([line["frequency_hz"] for line in (*(line for _, line in rows), *harmonics)])
    frequencies = frequencies[frequencies > 0.0]
    if not frequencies.size or not mechanisms.machine.sensor_rows:
        return
    within = _TWO_PI * within_hz
    bands = bands_by_damping.at(_TWO_PI * frequencies, within)
    steady = document.get("run") is None
    parts = [mechanisms.parts(_TWO_PI * hertz, within) for hertz in frequencies.tolist()] if steady else None

    def figures(sensor: str, hertz: float) -> dict[str, Any]:
        place = int(np.searchsorted(frequencies, hertz))
        found: dict[str, Any] = {"band_db": bands[sensor][place].tolist()}
        if parts is not None and sensor in parts[place]:
            of_line = parts[place][sensor]
            found |= {
                "parts": of_line.amplitudes,
                "part_shares": of_line.shares,
                "parts_together_m_per_s2": of_line.together,
            }
        return found

    for sensor, line in rows:
        if line["frequency_hz"] > 0.0:
            line.update(figures(sensor, line["frequency_hz"]))
    for line in harmonics:
        by_sensor = {sensor: figures(sensor, line["frequency_hz"]) for sensor in bands}
        for key in ("band_db", "parts", "part_shares", "parts_together_m_per_s2"):
            line[key] = {sensor: found[key] for sensor, found in by_sensor.items() if key in found}


def _bands(error: BasisError, limit_hz: float) -> list[dict[str, Any]]:
    """Median and largest relative error of each sensor, by bands."""
    edges = np.linspace(0.0, limit_hz, _BANDS + 1)
    inner = (np.arange(_OF_A_BAND) + 0.5) / _OF_A_BAND
    frequencies = edges[:-1, None] + np.diff(edges)[:, None] * inner
    errors = {name: values.reshape(_BANDS, -1) for name, values in error.at(_TWO_PI * frequencies.ravel()).items()}
    return [
        {
            "from_hz": float(edges[band]),
            "to_hz": float(edges[band + 1]),
            "sensors": [
                {"name": name, "median": float(np.median(values[band])), "largest": float(values[band].max())}
                for name, values in errors.items()
            ],
        }
        for band in range(_BANDS)
    ]
