"""What a case means before anything is solved: ratios, frequencies, loads, sizes."""

from typing import Any

import numpy as np

from gearwhine.case import (
    Bearing,
    Case,
    CouplingSegment,
    Joint,
    Mount,
    Operation,
    Transient,
    amounts,
    applied_torques,
    campbell_speeds,
    response_speeds,
    rotor_speeds,
)
from gearwhine.progress import Progress, silent
from gearwhine.results.gears import geometry_document
from gearwhine.stages import mesh_health
from gearwhine.stages.bearings import build_bearings
from gearwhine.stages.build import build_rotor
from gearwhine.stages.gear_shapes import doubts, pairs_document
from gearwhine.stages.gears import backlash_doubts, build_pair, pair_geometries
from gearwhine.stages.geometry import material_of
from gearwhine.stages.machine import require_machine
from gearwhine.stages.measured import measured_document
from gearwhine.stages.update_keys import fitted_case

_RPM = 60.0 / (2.0 * np.pi)


def check_document(case: Case, progress: Progress = silent) -> dict[str, Any]:
    """Everything that follows from the case by arithmetic alone, and what the file of its geometry holds."""
    require_machine(case)
    for rotor in case.rotor:
        # A load that a rolling bearing cannot carry is refused here as by the commands that solve it.
        build_bearings(case, rotor.name)
    document: dict[str, Any] = {"title": case.title}
    if case.update is not None:
        fitted_case(case)
    if case.housing is not None:
        for name in {case.housing.material, *(region.material for region in case.housing.region)}:
            material_of(case, name)
        foreseen, warnings = mesh_health.foresee(case, progress)
        document["housing"] = _housing(case) | foreseen
        document["warnings"] = warnings
    if case.rotor:
        document["rotors"] = _rotors(case)
        document["rotor_analysis"] = _analysis(case)
    if bearings := _bearings(case):
        document["bearings"] = bearings
    if case.gear_pair:
        _add_gears(case, document)
    if case.operation is not None:
        document["operation"] = {
            "speed_rpm": case.operation.speed * _RPM,
            "torque_n_m": case.operation.torque,
            "torques": [
                {"rotor": torque.shaft, "at_m": torque.at, "torque_n_m": torque.torque}
                for torque in applied_torques(case)
            ],
        }
        document["operation"] |= _lines(case.operation)
    if case.transient is not None:
        document["transient"] = _transient(case.transient)
    if case.sweep is not None:
        document["sweep"] = {"speeds": len(case.sweep.speeds)}
    if case.measured is not None:
        document["measured"] = measured_document(case)
        if remarks := document["measured"].get("remarks"):
            found = [mesh_health.doubt("measured", f"{document['measured']['file']}: {remark}") for remark in remarks]
            document["warnings"] = [*document.get("warnings", ()), *found]
    if case.provenance:
        document["provenance"] = dict(case.provenance)
    return document


def _lines(operation: Operation) -> dict[str, Any]:
    """Torque over speed, as the free speed of a run follows it; gravity, and what of the base moves."""
    document: dict[str, Any] = {}
    if operation.gravity is not None:
        document["gravity_m_per_s2"] = list(operation.gravity)
    if operation.base is not None:
        document["base"] = {
            "point_m": list(operation.base.point),
            "harmonics_hz": [one.frequency for one in operation.base.harmonic],
            "over_time": operation.base.over_time is not None,
        }
    return document | {
        key: {"speed_rpm": [speed * _RPM for speed in line.speed], "torque_n_m": list(line.torque)}
        for key, line in (("motor", operation.motor), ("load", operation.load))
        if line is not None
    }


def _transient(given: Transient) -> dict[str, Any]:
    if given.run is None:
        assert given.revolutions is not None
        recorded = given.revolutions - given.discard
        return {
            "revolutions": given.revolutions,
            "recorded_revolutions": recorded,
            "tolerance": given.tolerance,
        }
    times, speeds = given.run.line
    return {
        "run": {
            "seconds": given.run.duration,
            "free": given.run.free,
            "times_s": list(times),
            "speeds_rpm": [speed * _RPM for speed in speeds],
        },
        "discarded_revolutions": given.discard,
        "tolerance": given.tolerance,
    }


def _housing(case: Case) -> dict[str, Any]:
    housing = case.housing
    assert housing is not None
    return {
        "geometry": "box" if housing.box else "mesh" if housing.mesh else "cad",
        "material": housing.material,
        "frequency_limit_hz": housing.frequency_limit,
        "modes": housing.modes,
        "seats": [seat.name for seat in housing.seat],
        "supports": [support.name for support in housing.support],
        "mounts": [_bushing(mount) for mount in housing.mount],
        "joints": [_bushing(joint) | _ends(joint) for joint in housing.joint],
        "masses": [{"name": mass.name, "mass_kg": mass.mass} for mass in housing.mass],
        "sensors": [sensor.name for sensor in housing.sensor],
        "regions": [f"{region.name} of {region.material}" for region in housing.region],
    }


def _ends(joint: Joint) -> dict[str, Any]:
    """What a joint ties."""
    if joint.surfaces is not None:
        return {"surfaces": list(joint.surfaces)}
    return {"diameter_m": joint.diameter, "center_m": joint.center}


def _bushing(given: Mount | Joint) -> dict[str, Any]:
    """Springs and dashpots by motion, those that are not zero; each key with its unit."""
    document: dict[str, Any] = {"name": given.name}
    for key, turning_unit, unit in (("stiffness", "n_m_per_rad", "n_per_m"), ("damping", "n_m_s_per_rad", "n_s_per_m")):
        table = getattr(given, key)
        if table is None:
            continue
        for motion, amount in zip(type(table).model_fields, amounts(table), strict=True):
            if amount:
                turning = motion in ("rx", "ry", "rz", "tilting", "torsional")
                document.setdefault(f"{key}_{turning_unit if turning else unit}", {})[motion] = amount
    return document


def _bearings(case: Case) -> list[dict[str, Any]]:
    """Every bearing and where it stands, those of the rotors' own files on the ground."""
    own = {(bearing.rotor, bearing.name) for bearing in case.bearing}
    return [_bearing(bearing) for bearing in case.bearing] + [
        {"name": bearing.name, "rotor": rotor.name, "seat": "ground"}
        for rotor in case.rotor
        for bearing in (rotor.saved.bearings if rotor.saved else ())
        if (rotor.name, bearing.name) not in own
    ]


def _rotors(case: Case) -> list[dict[str, Any]]:
    speeds = rotor_speeds(case) if case.operation is not None else {}
    rows = []
    for given in case.rotor:
        rotor = build_rotor(case, given)
        speed = speeds.get(given.name)
        rows.append(
            {
                "name": given.name,
                "length_m": rotor.length,
                "segments": len(rotor.segments),
                "couplings": sum(isinstance(segment, CouplingSegment) for segment in given.segments),
                "mass_kg": rotor.mass,
                "polar_inertia_kg_m2": rotor.polar_inertia,
                "speed_rpm": None if speed is None else speed * _RPM,
                "mass_model": given.mass,
            }
        )
    return rows


def _bearing(bearing: Bearing) -> dict[str, Any]:
    table = None if bearing.speeds is None else [speed * _RPM for speed in (bearing.speeds[0], bearing.speeds[-1])]
    return {
        "name": bearing.name,
        "rotor": bearing.rotor,
        "seat": bearing.seat,
        "table_rpm": table,
        "pedestal_kg": None if bearing.pedestal is None else bearing.pedestal.mass,
    }


def _analysis(case: Case) -> list[dict[str, Any]]:
    """At which speeds `gearwhine rotors` looks at each rotor, where it does."""
    rows = []
    for rotor in case.rotor:
        row: dict[str, Any] = {"rotor": rotor.name}
        response = response_speeds(case, rotor.name) if rotor.unbalance or rotor.bow else ()
        for key, speeds in (("campbell_rpm", campbell_speeds(case, rotor.name)), ("response_rpm", response)):
            row[key] = [min(speeds) * _RPM, max(speeds) * _RPM, len(speeds)] if speeds else None
        torsion = None if case.rotor_analysis is None else case.rotor_analysis.torsional_response
        row["torques"] = 0 if torsion is None else sum(torque.rotor == rotor.name for torque in torsion.torques)
        rows.append(row)
    return rows


def _add_gears(case: Case, document: dict[str, Any]) -> None:
    """Add the gear pairs, and warnings of their teeth to those there are."""
    document["gear_pairs"] = pairs_document(case)
    for pair, geometry, row in zip(case.gear_pair, pair_geometries(case), document["gear_pairs"], strict=True):
        build_pair(pair).require_sound_faults(geometry)
        row["stiffness_model"] = row.pop("model")
        row["geometry"] = geometry_document(geometry)
        if found := [*doubts(geometry), *backlash_doubts(pair, geometry)]:
            document["warnings"] = [*document.get("warnings", ()), *found]
