"""Point files of a sweep: NetCDF4, written whole or not at all."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine import __version__
from gearwhine.case import dump_case
from gearwhine.output import finite, json_text
from gearwhine.sweep.points import Point
from gearwhine.sweep.solution import PointFailure, PointResult
from housing.netcdf import Variables, read_netcdf, write_netcdf
from housing.seals import checksum_holds, write_checksum

POINTS = "points"
"""Folder of the points within the results folder."""

# Group of results, its dimension, unit, and what it is.
_SPECTRA = {
    "sensor_spectra": ("sensor", "m/s2", "peak amplitude of acceleration"),
    "force_spectra": ("contact", "N", "peak amplitude of the gear-mesh force"),
}
_FORCES = {
    "bearing_force_mean": "mean load of the shaft on its bearing",
    "bearing_force_rms": "root mean square of that load without its mean",
}
_LOADS = ("x", "y", "z", "moment about x", "moment about y")


def write_point(folder: Path, place: Path, point: Point, result: PointResult | PointFailure) -> None:
    """Write a point and move it to its place.

    Parameters
    ----------
    folder
        The results folder.
    place
        A staging folder on the same file system.
    point, result
        Result to write.
    """
    attributes = {
        "source": f"gearwhine {__version__}",
        "key": point.key,
        "case": dump_case(point.case),
        "failure": "",
    }
    if isinstance(result, PointFailure):
        attributes["failure"] = json_text({"message": result.message, "traceback": result.traceback})
        arrays = {}
    else:
        attributes |= {"document": json_text(finite(result.document)), "window": result.window}
        arrays = _arrays(result)
    staged = place / point.file
    write_netcdf(staged, arrays, attributes)
    write_checksum(staged)
    (folder / POINTS).mkdir(exist_ok=True)
    os.replace(staged, folder / POINTS / point.file)


def read_point(folder: Path, point: Point) -> PointResult | PointFailure | None:
    """Read a point; None where there is no file of it, or one that is of other content or damaged."""
    file = folder / POINTS / point.file
    try:
        # Before HDF5 sees it, which may read a damaged file for ever.
        if not checksum_holds(file):
            return None
        arrays, attributes = read_netcdf(file)
        if attributes.get("key") != point.key:
            return None
        if attributes["failure"]:
            return PointFailure(**json.loads(attributes["failure"]))
        return _result({name: array.values for name, array in arrays.items()}, attributes)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError):
        return None


def outdated_points(folder: Path, points: tuple[Point, ...]) -> list[Path]:
    """Files of points that are not of this sweep: those of the case as it was."""
    names = {point.file for point in points}
    return [path for path in sorted((folder / POINTS).glob("*.nc")) if path.name not in names]


def _arrays(result: PointResult) -> Variables:
    arrays: Variables = {
        "order": ("order", result.orders, {"units": "1", "long_name": "cycles for each turn of the first driver"})
    }
    for group, (dimension, unit, what) in _SPECTRA.items():
        spectra = getattr(result, group)
        if spectra:
            arrays[dimension] = (dimension, list(spectra), {})
            values = np.array(list(spectra.values()))
            arrays[group] = ((dimension, "order"), values, {"units": unit, "long_name": what})
    for group, what in _FORCES.items():
        forces = getattr(result, group)
        if forces:
            arrays |= {"bearing": ("bearing", list(forces), {}), "load": ("load", list(_LOADS), {})}
            values = np.array(list(forces.values()))
            arrays[group] = (("bearing", "load"), values, {"units": "N, N m of moments", "long_name": what})
    attributes = {"units": "Hz", "long_name": "housing natural frequency"}
    arrays["housing_frequencies_hz"] = ("housing_mode", result.housing_frequencies_hz, attributes)
    return arrays


def _result(arrays: dict[str, npt.NDArray[Any]], attributes: dict[str, Any]) -> PointResult:
    named = {
        group: dict(zip(map(str, arrays[dimension]), arrays[group], strict=True))
        for group, dimension in (
            *((group, labels[0]) for group, labels in _SPECTRA.items()),
            *((group, "bearing") for group in _FORCES),
        )
        if group in arrays
    }
    return PointResult(
        document=json.loads(attributes["document"]),
        orders=arrays["order"],
        housing_frequencies_hz=arrays["housing_frequencies_hz"],
        window=attributes["window"],
        **named,
    )
