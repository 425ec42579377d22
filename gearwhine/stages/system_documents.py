"""The linear analyses of the coupled system as the command's JSON."""

from typing import Any

import numpy as np
import numpy.typing as npt

import coupling as room
from gearwhine.case import Case
from gearwhine.stages.housing import SolvedHousing
from gearwhine.stages.housing_checks import static_error_document
from gearwhine.stages.system import SolvedSystem

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi
_RPM = 60.0 / _HERTZ
_PEAKS = 8  # of each response
_GROUPS = {"component": "components", "connector": "bearings", "contact": "gear_meshes"}


def system_document(case: Case, solved: SolvedSystem, housing: SolvedHousing | None = None) -> dict[str, Any]:
    """All that was found, but for the curves, which are in the results file."""
    assert case.operation is not None
    document: dict[str, Any] = {
        "speed_rpm": case.operation.speed * _RPM,
        "mesh_phase": solved.mesh_phase,
        "mesh_stiffness": _mesh_stiffness(solved),
        "modes": [_mode(solved, i) for i in range(len(solved.modes.kinds))],
        "coordinates": solved.machine.system.size,
        "certificate": _certificate(solved.modes.certificate),
        "stability": _stability(solved),
        "transmissibility": [_response(response) for response in solved.responses],
        "superposition_error": solved.superposition_error,
        "trusted_below_hz": None if housing is None else housing.modes.certificate.limit / _HERTZ,
        "static_error": None if housing is None else static_error_document(housing.modes, housing.loaded),
    }
    if solved.campbell is not None:
        document["campbell"] = _campbell(solved.campbell, case.operation.speed)
    if solved.unbalance_speeds is not None:
        document["unbalance_response"] = [
            _response(response, solved.unbalance_speeds * _RPM) for response in solved.unbalance
        ]
    return document


def _mesh_stiffness(solved: SolvedSystem) -> list[dict[str, Any]]:
    """The stiffness that each pressed flank is taken for, beside its mean without load."""
    system, contact = solved.machine.system, solved.contact
    unloaded = room.unloaded_contact(system).stiffness
    found = []
    for number, tooth in enumerate(system.contacts):
        if not tooth.drives:
            continue
        force = None if contact.force is None else float(contact.force[number])
        if force is None:
            taken = "tangent at the mesh phase"
        elif contact.stiffness[number] == 0.0:
            taken = "parted by the mean load"
        else:
            taken = "mean under load" if force else "mean without load"
        found.append(
            {
                "name": tooth.name,
                "taken": taken,
                "stiffness_n_per_m": float(contact.stiffness[number]),
                "unloaded_mean_n_per_m": float(unloaded[number]),
                "force_n": force,
            }
        )
    return found


def _mode(solved: SolvedSystem, i: int) -> dict[str, Any]:
    modes = solved.modes
    components = [component.name for component in solved.machine.system.components]
    whirl = {
        name: float(direction)
        for name, direction in zip(components, modes.whirl[i], strict=True)
        if not np.isnan(direction)
    }
    return {
        "frequency_hz": float(modes.frequencies_hz[i]),
        "damping_ratio": float(modes.damping_ratios[i]),
        "damped_frequency_hz": float(abs(modes.eigenvalues[i].imag) / _HERTZ),
        "kind": modes.kinds[i],
        "where": modes.where[i],
        "energy": modes.energy[i],
        "kinetic_energy": dict(zip(components, modes.shares.kinetic[i].tolist(), strict=True)),
        "strain_energy": _by_part(modes.shares.parts, modes.shares.strain[i]),
        "damping": _by_part(modes.shares.parts, modes.shares.damping[i]),
        "whirl": whirl,
    }


def _by_part(parts: tuple[room.Part, ...], values: FloatArray) -> dict[str, dict[str, float]]:
    """Values by component, bearing and gear mesh."""
    found: dict[str, dict[str, float]] = {group: {} for group in _GROUPS.values()}
    for part, value in zip(parts, values.tolist(), strict=True):
        found[_GROUPS[part.kind]][part.name] = value
    return found


def _certificate(certificate: room.ModesCertificate) -> dict[str, Any]:
    return {
        "expected": certificate.expected,
        "found": certificate.found,
        "zeros": certificate.zeros,
        "max_residual": certificate.max_residual,
        "sum_rule": certificate.sum_rule,
        "complete": certificate.found == certificate.expected,
    }


def _stability(solved: SolvedSystem) -> dict[str, Any]:
    modes, verdict = solved.modes, solved.stability
    least = verdict.least_damped
    return {
        "stable": verdict.stable,
        "growing": [
            {
                "frequency_hz": abs(one.eigenvalue) / _HERTZ,
                "damping_ratio": one.damping_ratio,
                "doubling_time_s": one.doubling_time,
                "kind": one.kind,
                "where": one.where,
                "fed_by": [{"kind": part.kind, "name": part.name, "share": share} for part, share in one.feeders],
            }
            for one in verdict.growing
        ],
        "least_damped": None
        if least is None
        else {
            "frequency_hz": float(modes.frequencies_hz[least]),
            "damping_ratio": float(modes.damping_ratios[least]),
            "kind": modes.kinds[least],
            "where": modes.where[least],
        },
    }


def _response(response: room.FrequencyResponse, speeds_rpm: FloatArray | None = None) -> dict[str, Any]:
    """The peaks of a response, over frequency, or over the speeds that go with it."""
    abscissa = response.frequencies / _HERTZ if speeds_rpm is None else np.abs(speeds_rpm)
    key = "frequency_hz" if speeds_rpm is None else "speed_rpm"

    def peaks(values: npt.NDArray[np.complex128]) -> list[dict[str, float]]:
        size = np.abs(values)
        tops = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
        tops = tops[np.argsort(-size[tops], kind="stable")][:_PEAKS]
        return [{key: float(abscissa[i]), "amplitude": float(size[i])} for i in tops]

    return {
        "excitation": response.excitation,
        "per": response.unit,
        "mesh_force_n": {name: peaks(values) for name, values in response.mesh_force.items()},
        "bearing_force_n": {
            name: {axis: peaks(load[:, i]) for i, axis in enumerate("xyz")}
            for name, load in response.bearing_load.items()
        },
        "bearing_moment_n_m": {
            name: {axis: peaks(load[:, 3 + i]) for i, axis in enumerate("xy")}
            for name, load in response.bearing_load.items()
        },
        "sensor_acceleration_m_per_s2": {name: peaks(v) for name, v in response.sensor_acceleration.items()},
    }


def _campbell(campbell: room.SystemCampbell, operation: float) -> dict[str, Any]:
    return {
        "speeds_rpm": (campbell.speeds * _RPM).tolist(),
        "branches": [
            {
                "frequency_hz": campbell.frequencies_hz[:, b].tolist(),
                "damping_ratio": campbell.damping_ratios[:, b].tolist(),
                "kind": campbell.kinds[:, b].tolist(),
                "where": campbell.where[:, b].tolist(),
            }
            for b in range(campbell.eigenvalues.shape[1])
        ],
        "lines": [{"name": line.name, "kind": line.kind, "order": line.order} for line in campbell.lines],
        "crossings": [
            {
                "speed_rpm": one.speed * _RPM,
                "line": one.line.name,
                "order": one.line.order,
                "frequency_hz": one.eigenvalue.imag / _HERTZ,
                "damping_ratio": one.damping_ratio,
                "branch": one.branch,
                "kind": one.kind,
                "where": one.where,
                "teeth": one.teeth,
                "margin": one.speed / operation - 1.0,
            }
            for one in campbell.crossings
        ],
        "unsettled": list(campbell.unsettled),
    }
