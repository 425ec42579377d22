"""Modal truncation error of sensors' lines, line by line and by bands."""

from typing import Any

import numpy as np

import coupling as room

_HERTZ = 2.0 * np.pi
_BANDS = 8  # of equal width up to the limit
_OF_A_BAND = 12  # frequencies at which each is looked at


def add_uncertainty(document: dict[str, Any], error: room.BasisError | None, limit_hz: float | None) -> None:
    """Add ``uncertainty`` to every line of the document's sensors, and its course by bands under ``basis_error``.

    Parameters
    ----------
    document : dict
        With ``sensors``, whose ``peaks`` or ``lines`` have a ``frequency_hz``, or with ``motions`` that have such.
    error : coupling.BasisError or None
        None, where no basis is behind the lines: nothing is added.
    limit_hz : float or None
        Upper end of the bands; no bands where it is not given.
    """
    if error is None:
        return
    holders = [document, *document.get("motions", ())]
    sensors = [sensor for holder in holders for sensor in holder.get("sensors", ())]
    rows = [(sensor["name"], line) for sensor in sensors for key in ("peaks", "lines") for line in sensor.get(key, ())]
    frequencies = np.unique([line["frequency_hz"] for _, line in rows])
    told = error.at(_HERTZ * frequencies)
    for name, line in rows:
        line["uncertainty"] = float(told[name][np.searchsorted(frequencies, line["frequency_hz"])])
    if limit_hz is not None:
        document["basis_error"] = _bands(error, limit_hz)


def _bands(error: room.BasisError, limit_hz: float) -> list[dict[str, Any]]:
    """Median and largest relative error of each sensor, by bands."""
    edges = np.linspace(0.0, limit_hz, _BANDS + 1)
    inner = (np.arange(_OF_A_BAND) + 0.5) / _OF_A_BAND
    frequencies = edges[:-1, None] + np.diff(edges)[:, None] * inner
    told = {name: values.reshape(_BANDS, -1) for name, values in error.at(_HERTZ * frequencies.ravel()).items()}
    return [
        {
            "from_hz": float(edges[band]),
            "to_hz": float(edges[band + 1]),
            "sensors": [
                {"name": name, "median": float(np.median(values[band])), "largest": float(values[band].max())}
                for name, values in told.items()
            ],
        }
        for band in range(_BANDS)
    ]
