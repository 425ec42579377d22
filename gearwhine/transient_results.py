"""The transient's part of the results file: histories, written piece by piece, and spectra."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import numpy.typing as npt

from gearwhine.stages.march_record import Signals
from gearwhine.stages.transient import SolvedTransient
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]

MODAL_COORDINATE = "modal coordinate by unit modal mass; of torsion by unit modal inertia [rad kg0.5 m]"


@dataclass(frozen=True)
class _Quantity:
    """What is written of some histories: values per sample of each signal, all in one variable."""

    name: str
    dimensions: tuple[str, ...]
    of: Callable[[Signals], Mapping[str, FloatArray]]
    unit: str
    what: str


def _displacement(signals: Signals) -> dict[str, FloatArray]:
    return {name: motion[:, :2] for name, motion in signals.histories.gear_motion.items()}


def _rotation(signals: Signals) -> dict[str, FloatArray]:
    return {name: motion[:, 2] for name, motion in signals.histories.gear_motion.items()}


def _friction_force(signals: Signals) -> dict[str, FloatArray]:
    return {name: friction[:, 0] for name, friction in signals.histories.mesh_friction.items()}


def _friction_power(signals: Signals) -> dict[str, FloatArray]:
    return {name: friction[:, 1] for name, friction in signals.histories.mesh_friction.items()}


_QUANTITIES = (
    _Quantity(
        "sensor_acceleration",
        ("sensor", "time"),
        lambda signals: signals.histories.sensor_acceleration,
        "m/s2",
        "acceleration along the sensor",
    ),
    _Quantity(
        "bearing_force",
        ("bearing", "time", "axis"),
        lambda signals: signals.histories.bearing_force,
        "N",
        "force of the shaft on its bearing",
    ),
    _Quantity(
        "bearing_axial_force",
        ("bearing", "time"),
        lambda signals: {name: load[:, 2] for name, load in signals.histories.bearing_load.items()},
        "N",
        "force of the shaft on its bearing along z",
    ),
    _Quantity(
        "bearing_moment",
        ("bearing", "time", "moment_axis"),
        lambda signals: {name: load[:, 3:] for name, load in signals.histories.bearing_load.items()},
        "N m",
        "moment of the shaft on its bearing about x and y",
    ),
    _Quantity(
        "mesh_force",
        ("contact", "time"),
        lambda signals: signals.histories.mesh_force,
        "N",
        "gear-mesh force along the line of action",
    ),
    _Quantity(
        "mesh_compression",
        ("contact", "time"),
        lambda signals: signals.histories.mesh_compression,
        "m",
        "compression of the mesh along the line of action",
    ),
    _Quantity(
        "friction_force",
        ("friction_contact", "time"),
        _friction_force,
        "N",
        "friction between the teeth, across the line of action",
    ),
    _Quantity(
        "friction_power",
        ("friction_contact", "time"),
        _friction_power,
        "W",
        "power that friction between the teeth takes from the nominal rotation",
    ),
    _Quantity("gear_displacement", ("gear", "time", "axis"), _displacement, "m", "motion of the gear's centre"),
    _Quantity("gear_rotation", ("gear", "time"), _rotation, "rad", "rotation of the gear beside the steady one"),
    _Quantity(
        "modal_displacement",
        ("modal_coordinate", "time"),
        lambda signals: signals.modal.coordinates,
        "m kg0.5",
        MODAL_COORDINATE,
    ),
)


def write_transient(solved: SolvedTransient, variables: Variables, coordinates: Variables) -> None:
    """Add the names of the signals and the spectra; the histories follow by :func:`append_histories`."""
    for quantity in _QUANTITIES:
        if names := list(quantity.of(solved.signals)):
            coordinates[quantity.dimensions[0]] = (quantity.dimensions[0], names, {})
            if "axis" in quantity.dimensions:
                coordinates["axis"] = ("axis", ["x", "y"], {})
            if "moment_axis" in quantity.dimensions:
                coordinates["moment_axis"] = ("moment_axis", ["x", "y"], {})
    for name, spectra, dimension, unit, what in (
        ("sensor_spectrum", solved.sensor_spectra, "sensor", "m/s2", "peak amplitude of acceleration"),
        ("mesh_force_spectrum", solved.force_spectra, "contact", "N", "peak amplitude of the gear-mesh force"),
    ):
        if not spectra:
            continue
        first = next(iter(spectra.values()))
        coordinates["frequency"] = ("frequency", first.frequencies, _unit("Hz", "frequency"))
        amplitude = np.array([spectrum.amplitude for spectrum in spectra.values()])
        phase = np.array([spectrum.phase for spectrum in spectra.values()])
        attributes: dict[str, Any] = _unit(unit, what) | {"window": first.window}
        if solved.record.sampling.is_long:
            attributes |= {
                "averages": first.averages,
                "averaged_samples": solved.record.sampling.stretch,
                "averaging": "root mean square over stretches of whole revolutions, the last of the record",
            }
        variables[name] = ((dimension, "frequency"), amplitude, attributes)
        variables[f"{name}_phase"] = ((dimension, "frequency"), phase, _unit("rad", f"phase of {what[18:]}"))


def append_histories(path: Path, solved: SolvedTransient) -> None:
    """Add the histories to a results file that holds the names of their signals, one piece at a time.

    In single precision, seven digits, since there are many; times in double.
    """
    record = solved.record
    with h5netcdf.File(path, "a") as file:
        # As xarray does for whatever else is in the file.
        beside = {"coordinates": "speed"} if "speed" in file.variables else {}
        file.dimensions["time"] = record.samples
        times = file.create_variable("time", ("time",), "f8", fillvalue=np.nan)
        times.attrs.update(_unit("s", "time from static equilibrium"))
        written = [quantity for quantity in _QUANTITIES if quantity.of(solved.signals)]
        for quantity in written:
            variable = file.create_variable(quantity.name, quantity.dimensions, "f4", fillvalue=np.float32(np.nan))
            variable.attrs.update(_unit(quantity.unit, quantity.what) | beside | _sampled(solved))
        done = 0
        for piece in record.pieces():
            span = slice(done, done + len(piece.times))
            times[span] = piece.times
            for quantity in written:
                file.variables[quantity.name][:, span] = np.array(list(quantity.of(piece).values()), dtype=np.float32)
            done = span.stop


def _sampled(solved: SolvedTransient) -> dict[str, Any]:
    """What a history that was filtered says of itself."""
    sampling = solved.record.sampling
    if not sampling.is_long:
        return {}
    return {"decimated_by": sampling.decimation.factor, "complete_below_hz": solved.trusted_limit}


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
