"""Solving one sweep point on a worker: the transient, reduced to the quantities that a sweep collects."""

from __future__ import annotations

import time
import traceback
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, mesh_frequencies
from gearwhine.doubtful import add_warnings
from gearwhine.failures import explain
from gearwhine.results.run import transient_document
from gearwhine.stages.bearing_loads import bearing_load_warnings
from gearwhine.stages.gears import solve_gears
from gearwhine.stages.housing import solve_housing
from gearwhine.stages.instability import machine_warnings
from gearwhine.stages.machine import ReducedHousing, basis_error, build_machine, reduce_housing
from gearwhine.stages.transient import SolvedTransient, mean_bearing_forces, solve_transient
from gearwhine.stages.uncertainty import add_uncertainty
from gearwhine.sweep.points import code_digest

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi


@dataclass(frozen=True)
class PointResult:
    """A machine in motion, reduced to what a sweep gathers.

    Attributes
    ----------
    document : dict
        As the main job's JSON has it for the transient.
    orders : ndarray, shape (m,)
        Lines of the spectra, in cycles for each turn of the first driver, up to the trusted limit. The record holds a
        number of its turns, so these are the same at every speed.
    sensor_spectra : dict of str to ndarray, shape (m,)
        Peak amplitude of acceleration [m/s²].
    force_spectra : dict of str to ndarray, shape (m,)
        Peak amplitude of the gear-mesh force [N], its mean at order zero.
    bearing_force_mean, bearing_force_rms : dict of str to ndarray, shape (5,)
        Along x and y [N]; the latter without the mean.
    housing_frequencies_hz : ndarray, shape (n_modes,)
        Empty without a housing.
    window : str
        Of the spectra.
    """

    document: dict[str, Any]
    orders: FloatArray
    sensor_spectra: dict[str, FloatArray] = field(default_factory=dict)
    force_spectra: dict[str, FloatArray] = field(default_factory=dict)
    bearing_force_mean: dict[str, FloatArray] = field(default_factory=dict)
    bearing_force_rms: dict[str, FloatArray] = field(default_factory=dict)
    housing_frequencies_hz: FloatArray = field(default_factory=lambda: np.empty(0))
    window: str = "uniform"


@dataclass(frozen=True)
class PointFailure:
    """A point without a result.

    Attributes
    ----------
    message : str
        A sentence: what happened, and what to try where that is known.
    traceback : str
        Of what nobody foresaw; empty otherwise.
    """

    message: str
    traceback: str = ""


def solve_point(case: Case, housing: ReducedHousing | PointFailure | None, code: str) -> PointResult | PointFailure:
    """Run the transient of a case whose housing is solved; what goes wrong is the answer, not an error.

    Parameters
    ----------
    case
        Of the point.
    housing
        Solved, where the case has one; a failure is handed on.
    code
        Digest of the code of whoever asks; another one here could give other numbers.
    """
    if isinstance(housing, PointFailure):
        return housing
    try:
        _require_same_code(code)
        begin = time.perf_counter()
        pairs = solve_gears(case) if case.gear_pair else ()
        machine = build_machine(case, housing, pairs)
        frequencies = mesh_frequencies(case) if case.gear_pair else ()
        solved = solve_transient(case, machine, frequencies, housing=housing)
        result = _reduced(case, solved, housing, time.perf_counter() - begin)
        add_uncertainty(result.document, basis_error(case, machine, housing, pairs), solved.trusted_limit)
        for pair, frequency in zip(result.document["gear_pairs"], frequencies, strict=True):
            pair["mesh_frequency_hz"] = frequency
        return result
    except Exception as error:
        return _failure(error)


def solve_point_housing(case: Case, code: str) -> ReducedHousing | PointFailure:
    """Solve the housing of a point, for its machine."""
    try:
        _require_same_code(code)
        return reduce_housing(case, solve_housing(case, command="sweep"))
    except Exception as error:
        return _failure(error)


class OtherCodeError(RuntimeError):
    """A worker runs another version of this code."""


def _require_same_code(code: str) -> None:
    if code_digest() != code:
        raise OtherCodeError(
            "the worker has another version of gearwhine than the command; install the same one on every worker"
        )


def _failure(error: Exception) -> PointFailure:
    _, message = explain(error)
    if message is None and not isinstance(error, OtherCodeError):
        return PointFailure(f"unexpected {type(error).__name__}: {error}", "".join(traceback.format_exception(error)))
    return PointFailure(message or str(error))


def _reduced(case: Case, solved: SolvedTransient, housing: ReducedHousing | None, seconds: float) -> PointResult:
    assert case.operation is not None
    turning_hz = abs(case.operation.speed) / _HERTZ
    spectra = [*solved.sensor_spectra.values(), *solved.force_spectra.values()]
    lines = spectra[0].frequencies if spectra else np.empty(0)
    kept = int(np.searchsorted(lines, solved.trusted_limit * (1.0 + 1e-9), side="right"))
    contacts = solved.machine.system.contacts
    # Under the drive flanks' name at every point, whichever are pressed there.
    pressed = {contacts[i].name: contacts[number].name for i, number in enumerate(solved.machine.loaded_contacts)}
    document = transient_document(solved)
    document["seconds"] = {"total": seconds, "time_stepping": solved.result.seconds}
    add_warnings(document, () if housing is None else housing.warnings)
    add_warnings(document, machine_warnings(solved.machine))
    add_warnings(document, bearing_load_warnings(case, mean_bearing_forces(solved)))
    forces = solved.histories.bearing_load
    return PointResult(
        document=document,
        orders=lines[:kept] / turning_hz,
        sensor_spectra={name: spectrum.amplitude[:kept] for name, spectrum in solved.sensor_spectra.items()},
        force_spectra={name: solved.force_spectra[one].amplitude[:kept] for name, one in pressed.items()},
        bearing_force_mean={name: force.mean(axis=0) for name, force in forces.items()},
        bearing_force_rms={name: force.std(axis=0) for name, force in forces.items()},
        housing_frequencies_hz=np.empty(0) if housing is None else housing.frequencies_hz,
        window=spectra[0].window if spectra else "uniform",
    )
