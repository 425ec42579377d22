"""The transient's part of the results file: histories, written piece by piece, and spectra."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import numpy.typing as npt

from coupling.histories import HISTORY_QUANTITIES, Quantity
from gearwhine.stages.march_record import Signals
from gearwhine.stages.transient import SolvedTransient
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]

MODAL_COORDINATE = "modal coordinate by unit modal mass; of torsion by unit modal inertia [rad kg0.5 m]"


_MODAL = Quantity(
    "modal_displacement", ("modal_coordinate", "time"), lambda coordinates: coordinates, "m kg0.5", MODAL_COORDINATE
)


def _recorded(signals: Signals) -> list[tuple[Quantity, Mapping[str, FloatArray]]]:
    """Every quantity that was recorded, with the values of each of its signals."""
    found = [(quantity, quantity.of(signals.histories)) for quantity in HISTORY_QUANTITIES]
    found.append((_MODAL, signals.modal.coordinates))
    return [(quantity, values) for quantity, values in found if values]


def write_transient(solved: SolvedTransient, variables: Variables, coordinates: Variables) -> None:
    """Add the names of the signals and the spectra; the histories follow by :func:`append_histories`."""
    for quantity, values in _recorded(solved.signals):
        coordinates.update(quantity.coordinates(list(values)))
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


@dataclass(frozen=True)
class HistoryStream:
    """Histories of a transient as a stream of the results file."""

    solved: SolvedTransient

    def append_to(self, path: Path) -> None:
        """See :func:`append_histories`."""
        append_histories(path, self.solved)

    def add_to(self, variables: Variables) -> None:
        """See :func:`add_histories`."""
        add_histories(self.solved, variables, variables)


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
        for quantity, _ in _recorded(solved.signals):
            variable = file.create_variable(quantity.name, quantity.dimensions, "f4", fillvalue=np.float32(np.nan))
            variable.attrs.update(_unit(quantity.unit, quantity.what) | beside | _sampled(solved))
        done = 0
        for piece in record.pieces():
            span = slice(done, done + len(piece.times))
            times[span] = piece.times
            for quantity, values in _recorded(piece):
                file.variables[quantity.name][:, span] = np.array(list(values.values()), dtype=np.float32)
            done = span.stop


def add_histories(solved: SolvedTransient, variables: Variables, coordinates: Variables) -> None:
    """Add the histories in memory, as :func:`append_histories` writes them."""
    times: list[FloatArray] = []
    found: dict[str, list[npt.NDArray[np.float32]]] = {}
    for piece in solved.record.pieces():
        times.append(piece.times)
        for quantity, values in _recorded(piece):
            found.setdefault(quantity.name, []).append(np.array(list(values.values()), dtype=np.float32))
    coordinates["time"] = ("time", np.concatenate(times), _unit("s", "time from static equilibrium"))
    for quantity, _ in _recorded(solved.signals):
        labels = _unit(quantity.unit, quantity.what) | _sampled(solved)
        variables[quantity.name] = (quantity.dimensions, np.concatenate(found[quantity.name], axis=1), labels)


def _sampled(solved: SolvedTransient) -> dict[str, Any]:
    """What a history that was filtered says of itself."""
    sampling = solved.record.sampling
    if not sampling.is_long:
        return {}
    return {"decimated_by": sampling.decimation.factor, "complete_below_hz": solved.trusted_limit}


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
