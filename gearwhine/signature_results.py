"""Signatures in the results file: bearing force spectra, modal coordinates, and the lines of sensors with their
parts."""

import numpy as np
import numpy.typing as npt

import coupling as room
from gearwhine.stages.run_up import RunSignature
from gearwhine.stages.signature import SolvedSignature
from gearwhine.stages.transient import SolvedTransient
from gearwhine.transient_results import MODAL_COORDINATE
from housing.netcdf import Variables

FloatArray = npt.NDArray[np.float64]


def write_signature(
    transient: SolvedTransient, found: SolvedSignature, variables: Variables, coordinates: Variables
) -> None:
    """Add what was found to the variables; complex numbers stand along a dimension of real and imaginary part."""
    if found.bearing_spectra:
        spectra = list(found.bearing_spectra.values())
        coordinates["frequency"] = ("frequency", spectra[0].frequencies, _unit("Hz", "frequency"))
        axes = transient.histories.tie_axes
        loads = np.zeros((len(spectra), 5, len(spectra[0].frequencies)))
        for load, (name, spectrum) in zip(loads, found.bearing_spectra.items(), strict=True):
            load[list(axes[name])] = spectrum.amplitude
        for name, dimensions, amplitude, unit, what in (
            ("force", ("axis",), loads[:, :2], "N", "force of the shaft on its bearing"),
            ("axial_force", (), loads[:, 2], "N", "force of the shaft on its bearing along z"),
            ("moment", ("moment_axis",), loads[:, 3:], "N m", "moment of the shaft on its bearing about x and y"),
        ):
            variables[f"bearing_{name}_spectrum"] = (
                ("bearing", *dimensions, "frequency"),
                amplitude,
                _unit(unit, f"peak amplitude of the {what}") | {"window": spectra[0].window},
            )
    if transient.modal.coordinates:
        _coordinates(transient, variables, coordinates)
    if any(found.lines.values()):
        _lines(found, variables, coordinates)
    if found.housing is not None:
        _housing(found.housing, transient.trusted_limit, variables, coordinates)


def write_run_signature(found: RunSignature, variables: Variables, coordinates: Variables) -> None:
    """Add the spectra along a run and the orders over its speed, of all signals."""
    spectra, orders = list(found.spectra.values()), list(found.orders.values())
    coordinates["run_signal"] = ("run_signal", list(found.spectra), {})
    coordinates["run_speed"] = ("run_speed", found.speeds_rpm, _unit("rpm", "speed in the middle of each stretch"))
    coordinates["run_frequency"] = ("run_frequency", spectra[0].frequencies, _unit("Hz", "frequency"))
    coordinates["order_speed"] = (
        "order_speed",
        60.0 * orders[0].speeds,
        _unit("rpm", "speed of the leading shaft over each window"),
    )
    coordinates["order"] = ("order", orders[0].orders, _unit("1", "cycles each turn of the leading shaft"))
    variables["run_unit"] = ("run_signal", list(found.units.values()), {"long_name": "unit of the signal's amplitudes"})
    for name, dimensions, tables, what in (
        ("run_spectrum", ("run_signal", "run_speed", "run_frequency"), spectra, "of stretches along the run"),
        ("run_orders", ("run_signal", "order_speed", "order"), orders, "by order along the run"),
    ):
        amplitude = np.array([table.amplitude for table in tables], dtype=np.float32)
        variables[name] = (dimensions, amplitude, {"long_name": f"peak amplitude {what}", "window": "hann"})
    coordinates["named_order"] = ("named_order", list(found.named), {})
    variables["run_order_number"] = (
        "named_order",
        list(found.named.values()),
        _unit("1", "cycles each turn of the leading shaft"),
    )
    followed = np.array([[table.order_slice(order) for order in found.named.values()] for table in orders])
    variables["run_order_amplitude"] = (
        ("run_signal", "named_order", "order_speed"),
        followed.astype(np.float32),
        {"long_name": "peak amplitude of a shaft's or a mesh's order along the run", "window": "hann"},
    )


def _coordinates(transient: SolvedTransient, variables: Variables, coordinates: Variables) -> None:
    named = transient.modal.coordinates
    spectrum = transient.record.spectrum(np.array(list(named.values())), transient.trusted_limit)
    coordinates["modal_coordinate"] = ("modal_coordinate", list(named), {})
    coordinates["frequency"] = ("frequency", spectrum.frequencies, _unit("Hz", "frequency"))
    variables["modal_displacement_spectrum"] = (
        ("modal_coordinate", "frequency"),
        spectrum.amplitude,
        _unit("m kg0.5", f"peak amplitude of the {MODAL_COORDINATE}; its d.c. part at 0 Hz")
        | {"window": spectrum.window},
    )


def _housing(spectrum: room.Spectrum, limit: float, variables: Variables, coordinates: Variables) -> None:
    """Up to where the modes are complete: what any line's operating shape is made of."""
    shown = spectrum.frequencies <= limit * (1.0 + 1e-9)
    lines = spectrum.lines[:, shown]
    coordinates["housing_line"] = ("housing_line", spectrum.frequencies[shown], _unit("Hz", "frequency"))
    coordinates["part"] = ("part", ["real", "imaginary"], {})
    variables["housing_acceleration_spectrum"] = (
        ("housing_mode", "housing_line", "part"),
        np.stack([lines.real, lines.imag], axis=-1),
        _unit("m kg0.5 s-2", "complex peak amplitude of a housing mode's acceleration, by unit modal mass")
        | {"window": spectrum.window},
    )


def _lines(found: SolvedSignature, variables: Variables, coordinates: Variables) -> None:
    count = max(len(lines) for lines in found.lines.values())
    first = next(line for lines in found.lines.values() for line in lines)
    bearings = [part.name for part in first.bearings]
    # In the order of their numbers, the local compliance last.
    ordered = sorted(first.modes, key=lambda part: (part.mode is None, part.mode or 0))
    modes = [part.name for part in ordered]
    shape = (len(found.lines), count)
    frequency, names = np.full(shape, np.nan), np.full(shape, "", dtype=object)
    by_mode, by_bearing = np.full((*shape, len(modes), 2), np.nan), np.full((*shape, len(bearings), 2), np.nan)
    line_values = np.full((*shape, 2), np.nan)
    for i, lines in enumerate(found.lines.values()):
        for j, line in enumerate(lines):
            frequency[i, j], names[i, j] = line.frequency, line.named.name
            line_values[i, j] = line.value.real, line.value.imag
            for table, order, parts in ((by_mode, modes, line.modes), (by_bearing, bearings, line.bearings)):
                for part in parts:
                    table[i, j, order.index(part.name)] = part.value.real, part.value.imag
    coordinates["line"] = ("line", np.arange(1, count + 1), _unit("1", "rank of the line, highest first"))
    coordinates["part"] = ("part", ["real", "imaginary"], {})
    coordinates["mode_path"] = ("mode_path", modes, {})
    coordinates["bearing_path"] = ("bearing_path", bearings, {})
    variables["line_frequency"] = (("sensor", "line"), frequency, _unit("Hz", "frequency of the sensor's line"))
    variables["line_name"] = (("sensor", "line"), names.astype(str), {"long_name": "what the line is"})
    tables: tuple[tuple[str, FloatArray, tuple[str, ...], str], ...] = (
        ("line_amplitude", line_values, (), "complex amplitude of the sensor's line"),
        ("line_by_mode", by_mode, ("mode_path",), "part of a housing mode in the line; they add up to it"),
        ("line_by_bearing", by_bearing, ("bearing_path",), "part of a bearing's force in the line"),
    )
    for name, values, path, what in tables:
        variables[name] = (("sensor", "line", *path, "part"), values, _unit("m/s2", what))


def _unit(unit: str, what: str) -> dict[str, str]:
    return {"units": unit, "long_name": what}
