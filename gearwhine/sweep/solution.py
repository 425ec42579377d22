"""Solution of one sweep point on a worker: the transient, reduced to the quantities that a sweep collects.

Each point is a file of NetCDF4, written whole or not at all.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Mapping
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
from gearwhine.from_case.machine import describe_machine
from gearwhine.from_case.reduced_housing import reduced_component
from gearwhine.housing.storage.atomic_file import checksum_holds, write_checksum
from gearwhine.housing.storage.netcdf import Variables, read_netcdf, write_netcdf
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.output import finite, json_text
from gearwhine.output.attributes import meaning_of
from gearwhine.output.quantity import add_warnings
from gearwhine.results.operating_point import load_part
from gearwhine.results.run import transient_document
from gearwhine.results.sensor_line_estimates import add_mechanisms, add_uncertainty
from gearwhine.solutions import Failure, failure_of
from gearwhine.solve.acoustics import acoustics_of
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import load_of_case, plan_of, reduce_housing
from gearwhine.sweep.points import Point
from gearwhine.workers import require_same_code

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics

_Declared = Mapping[str, tuple[str, tuple[str, ...], str]]

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


def solve_point(case: Case, housing: HousingComponent | Failure | None, code: str) -> PointResult | Failure:
    """Run the transient of a case whose housing is solved; errors are returned as failures, not raised.

    Parameters
    ----------
    case : Case
        Case of the point.
    housing : HousingComponent, Failure or None
        Solved housing, where the case has one; a failure is returned.
    code : str
        Digest of the caller's code; other code on the worker could give other numbers.
    """
    if isinstance(housing, Failure):
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
    add_mechanisms(document, loaded.bands, solved.line_tolerance_hz)
    for pair, frequency in zip(document["gear_pairs"], machine.mesh_frequencies, strict=True):
        pair["mesh_frequency_hz"] = frequency
    return PointResult(document, motion)


def solve_point_housing(case: Case, code: str) -> HousingComponent | Failure:
    """Solve the housing of a point, for its machine."""
    try:
        require_same_code(code)
        return reduce_housing(case, solve_housing(case, command="sweep"))
    except Exception as error:
        return failure_of(error)


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

# Attributes of a motion and of its resonances: variable of each in the file, dimensions and unit. Complex numbers have
# their parts along a last dimension; empty arrays are left out.
_MOTION = {
    "orders": ("order", ("order",), "1"),
    "housing_frequencies_hz": ("housing_frequencies_hz", ("housing_mode",), "Hz"),
    "line_frequencies": ("line_frequencies", ("sound_line",), "Hz"),
    "line_rates": ("line_rates", ("sound_line", "coordinate", "part"), "m kg^0.5 / s"),
    "line_names": ("line_names", ("sound_line",), ""),
    "line_kinds": ("line_kinds", ("sound_line",), ""),
}
_RESONANCES = {
    "frequencies": ("coupled_frequency", ("coupled_mode",), "Hz"),
    "half_widths": ("coupled_half_width", ("coupled_mode",), "Hz"),
    "names": ("coupled_name", ("coupled_mode",), ""),
    "lines": ("line", ("line",), ""),
    "line_orders": ("line_order", ("line",), "1"),
    "outputs": ("output", ("output",), ""),
    "line_levels": ("line_level", ("output", "line"), "dB"),
    "levels_near": ("level_near", ("output", "line", "coupled_mode", "place_near"), "dB"),
    "line_rates": ("line_response_rates", ("line", "coordinate", "part"), "m kg^0.5 / s"),
    "mode_rates": ("mode_rates", ("line", "coupled_mode", "coordinate", "part"), "m kg^0.5 / s"),
}
# Attributes that have values by name: the dimension of the names, the other one, and the unit.
_BY_NAME = {
    "sensor_spectra": ("sensor", "order", "m/s2"),
    "force_spectra": ("contact", "order", "N"),
    "bearing_force_mean": ("bearing", "load", "N, N m of moments"),
    "bearing_force_rms": ("bearing", "load", "N, N m of moments"),
}
_LOADS = ("x", "y", "z", "moment about x", "moment about y")


def write_point(folder: Path, place: Path, point: Point, result: PointResult | Failure) -> None:
    """Write a point and move it to its place.

    Parameters
    ----------
    folder : path
        Results folder.
    place : path
        Staging folder on the same file system.
    point : Point
    result : PointResult or Failure
        Result to write.
    """
    attributes = {
        "source": f"gearwhine {__version__}",
        "key": point.key,
        "case": dump_case(point.case),
        "failure": "",
    }
    if isinstance(result, Failure):
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


def read_point(folder: Path, point: Point) -> PointResult | Failure | None:
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
            return Failure(**json.loads(attributes["failure"]))
        return _result({name: array.values for name, array in arrays.items()}, attributes)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError):
        return None


def outdated_points(folder: Path, points: tuple[Point, ...]) -> list[Path]:
    """Return files of points that are not of this sweep but of the case as it was."""
    names = {point.file for point in points}
    return [path for path in sorted((folder / POINTS).glob("*.nc")) if path.name not in names]


def _arrays(motion: ReducedMotion) -> Variables:
    arrays = _declared_arrays(motion, _MOTION)
    for attribute, (names, other, unit) in _BY_NAME.items():
        if values := getattr(motion, attribute):
            described = {"units": unit, "long_name": meaning_of(ReducedMotion, attribute)}
            arrays |= {names: (names, list(values), {})} | (
                {"load": ("load", list(_LOADS), {})} if other == "load" else {}
            )
            arrays[attribute] = ((names, other), np.array(list(values.values())), described)
    return arrays if motion.resonances is None else arrays | _declared_arrays(motion.resonances, _RESONANCES)


def _declared_arrays(of: ReducedMotion | Resonances, declared: _Declared) -> Variables:
    arrays: Variables = {}
    for attribute, (name, dimensions, unit) in declared.items():
        values = getattr(of, attribute)
        if np.iscomplexobj(values):
            values = np.stack([values.real, values.imag], axis=-1)
        if np.size(values):
            described = ({"units": unit} if unit else {}) | {"long_name": meaning_of(type(of), attribute)}  # type: ignore[arg-type]
            arrays[name] = (dimensions, list(values) if isinstance(values, tuple) else values, described)
    return arrays


def _declared_attributes(arrays: dict[str, npt.NDArray[Any]], declared: _Declared) -> dict[str, Any]:
    """Return the attributes that a file has, texts as tuples."""
    found = {attribute: arrays[name] for attribute, (name, _, _) in declared.items() if name in arrays}
    return {name: values if values.dtype.kind in "fc" else tuple(map(str, values)) for name, values in found.items()}


def _resonances(arrays: dict[str, npt.NDArray[Any]]) -> Resonances | None:
    found = _declared_attributes(arrays, _RESONANCES)
    if "levels_near" not in found:
        return None
    lines, modes = len(found["lines"]), len(found["frequencies"])
    for name, shape in (("line_rates", (lines, 0, 2)), ("mode_rates", (lines, modes, 0, 2))):
        parts = found.get(name, np.zeros(shape))
        found[name] = parts[..., 0] + 1j * parts[..., 1]
    return Resonances(**found)


def _result(arrays: dict[str, npt.NDArray[Any]], attributes: dict[str, Any]) -> PointResult:
    by_name: dict[str, Any] = {
        attribute: dict(zip(map(str, arrays[names]), arrays[attribute], strict=True))
        for attribute, (names, _, _) in _BY_NAME.items()
        if attribute in arrays
    }
    found = {"orders": np.empty(0)} | _declared_attributes(arrays, _MOTION)
    motion = ReducedMotion(**found, **by_name, window=attributes["window"], resonances=_resonances(arrays))
    return PointResult(json.loads(attributes["document"]), motion)
