"""Solution of one sweep point on a worker: the transient, reduced to the quantities that a sweep collects.

Each point is a file of NetCDF4, written whole or not at all.
"""

from __future__ import annotations

import json
import os
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gearwhine import __version__
from gearwhine.case import Case, dump_case
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.modes_and_responses import machine_warnings
from gearwhine.coupling.analyses.operation_warnings import bearing_load_warnings
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.transient import SolvedTransient, mean_bearing_forces, solve_transient
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.sweep.reduced_motion import ReducedMotion, reduce_motion
from gearwhine.coupling.sweep.resonances import Resonances
from gearwhine.failures import explain
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.reduced_housing import reduced_component
from gearwhine.housing.storage.atomic_file import checksum_holds, write_checksum
from gearwhine.housing.storage.netcdf import Variables, read_netcdf, write_netcdf
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.output import finite, json_text
from gearwhine.output.quantity import add_warnings
from gearwhine.results.operating_point import load_part
from gearwhine.results.run import transient_document
from gearwhine.results.sensor_line_estimates import add_mechanisms, add_uncertainty
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import load_of_case, plan_of, reduce_housing
from gearwhine.sweep.points import Point
from gearwhine.workers import OtherCodeError, require_same_code

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi


@dataclass(frozen=True)
class PointResult:
    """Motion of a machine at a point of a sweep.

    Attributes
    ----------
    document : dict
        Document of the transient, as in the JSON of ``run``.
    motion : ReducedMotion
    """

    document: dict[str, Any]
    motion: ReducedMotion


@dataclass(frozen=True)
class PointFailure:
    """A point without a result.

    Attributes
    ----------
    message : str
        Sentence on the failure, with a remedy where one is known.
    traceback : str
        Traceback of an unexpected error; empty otherwise.
    """

    message: str
    traceback: str = ""


def solve_point(case: Case, housing: HousingComponent | PointFailure | None, code: str) -> PointResult | PointFailure:
    """Run the transient of a case whose housing is solved; errors are returned as failures, not raised.

    Parameters
    ----------
    case : Case
        Case of the point.
    housing : HousingComponent, PointFailure or None
        Solved housing, where the case has one; a failure is returned.
    code : str
        Digest of the caller's code; other code on the worker could give other numbers.
    """
    if isinstance(housing, PointFailure):
        return housing
    try:
        require_same_code(code)
        begin = time.perf_counter()
        described = describe_machine(case, housing or reduced_component(case.reduced_housing, case.input_files))
        load, warnings_of_load = load_of_case(case.parts, described)
        acoustics = None if case.acoustics is None else acoustics_of(case)
        return solve_motion_of_point(described, load, warnings_of_load, plan_of(case), begin, acoustics)
    except Exception as error:
        return failure_of(error)


def solve_motion_of_point(
    machine: Machine,
    load: SolvedLoad | None,
    warnings_of_load: list[ResultWarning],
    plan: TransientPlan,
    begin: float,
    acoustics: Acoustics | None = None,
) -> PointResult:
    """Integrate the motion of a machine about its operating point, and reduce it.

    Parameters
    ----------
    machine : Machine
    load : SolvedLoad or None
        Its operating point; None where nothing loads it, or none is found.
    warnings_of_load : list of dict
    plan : TransientPlan
    begin : float
        Time at which work on the point began, as `time.perf_counter` gives it [s].
    acoustics : Acoustics, optional
        Those of the sound whose lines are wanted.
    """
    loaded = load_machine(machine, None if load is None else load.point, plan.run)
    solved = solve_transient(loaded.coupled, plan)
    document = _document(solved, machine.housing_component, time.perf_counter() - begin, warnings_of_load)
    motion = reduce_motion(solved, acoustics)
    if load is not None:
        document["load"] = load_part(load)
    add_uncertainty(document, loaded.basis_error, solved.trusted_limit)
    add_mechanisms(document, loaded.mechanisms, solved.line_tolerance_hz)
    for pair, frequency in zip(document["gear_pairs"], machine.mesh_frequencies, strict=True):
        pair["mesh_frequency_hz"] = frequency
    return PointResult(document, motion)


def solve_point_housing(case: Case, code: str) -> HousingComponent | PointFailure:
    """Solve the housing of a point, for its machine."""
    try:
        require_same_code(code)
        return reduce_housing(case, solve_housing(case, command="sweep"))
    except Exception as error:
        return failure_of(error)


def failure_of(error: Exception) -> PointFailure:
    """Return the failure of a point by its error, with the traceback of an unexpected one."""
    _, message = explain(error)
    if message is None and not isinstance(error, OtherCodeError):
        return PointFailure(f"unexpected {type(error).__name__}: {error}", "".join(traceback.format_exception(error)))
    return PointFailure(message or str(error))


def _document(
    solved: SolvedTransient, housing: HousingComponent | None, seconds: float, warnings_of_load: list[ResultWarning]
) -> dict[str, Any]:
    """Return the document of a point's transient, with the warnings of its housing, its modes and its load."""
    document = transient_document(solved)
    document["seconds"] = {"total": seconds, "time_stepping": solved.result.seconds}
    add_warnings(document, () if housing is None else housing.warnings)
    add_warnings(document, machine_warnings(solved.machine))
    add_warnings(document, warnings_of_load)
    mean_forces = mean_bearing_forces(solved)
    add_warnings(document, bearing_load_warnings(solved.machine.bearings, mean_forces, known=warnings_of_load))
    return document


POINTS = "points"
"""Folder of the points within the results folder."""

# Group of results, its dimension, unit and long name.
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
    folder : path
        Results folder.
    place : path
        Staging folder on the same file system.
    point : Point
    result : PointResult or PointFailure
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
        attributes |= {"document": json_text(finite(result.document)), "window": result.motion.window}
        arrays = _arrays(result.motion)
    staged = place / point.file
    write_netcdf(staged, arrays, attributes)
    write_checksum(staged)
    (folder / POINTS).mkdir(exist_ok=True)
    os.replace(staged, folder / POINTS / point.file)


def read_point(folder: Path, point: Point) -> PointResult | PointFailure | None:
    """Read a point; None where its file is missing, damaged or of other content."""
    file = folder / POINTS / point.file
    try:
        # The check precedes HDF5, which may read a damaged file for ever.
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
    """Return files of points that are not of this sweep but of the case as it was."""
    names = {point.file for point in points}
    return [path for path in sorted((folder / POINTS).glob("*.nc")) if path.name not in names]


def _arrays(motion: ReducedMotion) -> Variables:
    arrays: Variables = {
        "order": ("order", motion.orders, {"units": "1", "long_name": "cycles for each turn of the first driver"})
    }
    for group, (dimension, unit, long_name) in _SPECTRA.items():
        spectra = getattr(motion, group)
        if spectra:
            arrays[dimension] = (dimension, list(spectra), {})
            values = np.array(list(spectra.values()))
            arrays[group] = ((dimension, "order"), values, {"units": unit, "long_name": long_name})
    for group, long_name in _FORCES.items():
        forces = getattr(motion, group)
        if forces:
            arrays |= {"bearing": ("bearing", list(forces), {}), "load": ("load", list(_LOADS), {})}
            values = np.array(list(forces.values()))
            arrays[group] = (("bearing", "load"), values, {"units": "N, N m of moments", "long_name": long_name})
    if motion.line_frequencies.size:
        line_attributes = {"units": "Hz", "long_name": "frequency of a line whose sound is wanted"}
        arrays["line_frequencies"] = ("sound_line", motion.line_frequencies, line_attributes)
        line_attributes = {
            "units": "m kg^0.5 / s",
            "long_name": "rates of the housing's coordinates, real and imaginary",
        }
        arrays["line_rates"] = (("sound_line", "coordinate", "part"), motion.line_rates, line_attributes)
        arrays["line_names"] = ("sound_line", list(motion.line_names), {"long_name": "name of the line"})
        arrays["line_kinds"] = ("sound_line", list(motion.line_kinds), {"long_name": "cause of the line"})
    if motion.resonances is not None:
        arrays |= _resonance_arrays(motion.resonances)
    attributes = {"units": "Hz", "long_name": "housing natural frequency"}
    arrays["housing_frequencies_hz"] = ("housing_mode", motion.housing_frequencies_hz, attributes)
    return arrays


def _resonance_arrays(resonances: Resonances) -> Variables:
    mode, line, output, near = "coupled_mode", "line", "output", "place_near"
    arrays: Variables = {
        "coupled_frequency": (mode, resonances.frequencies, {"units": "Hz", "long_name": "damped natural frequency"}),
        "coupled_half_width": (
            mode,
            resonances.half_widths,
            {"units": "Hz", "long_name": "half the half-power bandwidth"},
        ),
        "coupled_name": (mode, list(resonances.names), {"long_name": "kind and place of the coupled mode"}),
        "line": (line, list(resonances.lines), {"long_name": "mesh harmonic with all meshes that drive it"}),
        "line_order": (line, resonances.line_orders, {"units": "1", "long_name": "order over the first driver"}),
        "output": (output, list(resonances.outputs), {}),
        "line_level": (
            (output, line),
            resonances.line_levels,
            {"units": "dB", "long_name": "level of the line by the linear response, of a sensor re 1e-6 m/s2"},
        ),
        "level_near": (
            (output, line, mode, near),
            resonances.levels_near,
            {"units": "dB", "long_name": "level that the line would have about the mode"},
        ),
    }
    if resonances.mode_rates.size:
        of_rates = {"units": "m kg^0.5 / s", "long_name": "rates of the housing's coordinates by the linear response"}
        arrays |= {
            "line_response_rates": ((line, "coordinate", "part"), _parts(resonances.line_rates), of_rates),
            "mode_rates": ((line, mode, "coordinate", "part"), _parts(resonances.mode_rates), of_rates),
        }
    return arrays


def _parts(values: npt.NDArray[np.complex128]) -> FloatArray:
    return np.stack([values.real, values.imag], axis=-1)


def _resonances(arrays: dict[str, npt.NDArray[Any]]) -> Resonances | None:
    if "level_near" not in arrays:
        return None
    lines, modes = len(arrays["line"]), len(arrays["coupled_frequency"])
    of_lines = arrays.get("line_response_rates", np.zeros((lines, 0, 2)))
    of_modes = arrays.get("mode_rates", np.zeros((lines, modes, 0, 2)))
    return Resonances(
        frequencies=arrays["coupled_frequency"],
        half_widths=arrays["coupled_half_width"],
        names=tuple(map(str, arrays["coupled_name"])),
        lines=tuple(map(str, arrays["line"])),
        line_orders=arrays["line_order"],
        outputs=tuple(map(str, arrays["output"])),
        line_levels=arrays["line_level"],
        levels_near=arrays["level_near"],
        line_rates=of_lines[..., 0] + 1j * of_lines[..., 1],
        mode_rates=of_modes[..., 0] + 1j * of_modes[..., 1],
    )


def _result(arrays: dict[str, npt.NDArray[Any]], attributes: dict[str, Any]) -> PointResult:
    named: dict[str, Any] = {
        group: dict(zip(map(str, arrays[dimension]), arrays[group], strict=True))
        for group, dimension in (
            *((group, labels[0]) for group, labels in _SPECTRA.items()),
            *((group, "bearing") for group in _FORCES),
        )
        if group in arrays
    }
    motion = ReducedMotion(
        orders=arrays["order"],
        housing_frequencies_hz=arrays["housing_frequencies_hz"],
        window=attributes["window"],
        line_frequencies=arrays.get("line_frequencies", np.empty(0)),
        line_rates=arrays.get("line_rates", np.empty((0, 0, 2))),
        line_names=tuple(map(str, arrays.get("line_names", ()))),
        line_kinds=tuple(map(str, arrays.get("line_kinds", ()))),
        resonances=_resonances(arrays),
        **named,
    )
    return PointResult(json.loads(attributes["document"]), motion)
