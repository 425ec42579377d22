"""Rotors of a case, each alone on grounded bearings: its tables as settings of the rotor's analyses."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from gearwhine.case import Case, RotorAnalysis, TorsionalAnalysis, require, rotor_speeds
from gearwhine.case import Rotor as GivenRotor
from gearwhine.from_case.machine import rotor_bearings
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import file_stems
from gearwhine.rotors import AxisSpring, write_ross
from gearwhine.rotors.analyses.solved_rotor import (
    Probe,
    RotorSettings,
    SolvedRotor,
    StiffnessRange,
    TorsionalExcitation,
    solve_rotor,
)
from gearwhine.rotors.analyses.statics import StaticForce
from gearwhine.rotors.analyses.torsional_response import Torque, TorsionalDashpot

_TWO_PI = 2.0 * np.pi


def solve_rotors(case: Case, progress: Progress = silent, **chosen: Any) -> tuple[SolvedRotor, ...]:
    """Solve every rotor of the case, alone on grounded bearings; ``chosen`` settings take the place of the case's.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError
        Where the case has no rotors, or one cannot be solved as it stands.
    """
    require(case, "rotor", command="rotors")
    built = rotor_bearings(case.parts)
    solved = []
    for table, rotor in zip(case.rotor, case.parts.rotors, strict=True):
        progress(f"rotor {table.name}")
        bearings, rolling = built[table.name]
        settings = replace(rotor_settings(case, table), **chosen)
        speeds = case.parts.speeds
        turning = {
            one.name: speeds[one.rotor] - speeds.get(one.seat, 0.0)
            for one in case.bearing
            if one.rotor == table.name and one.rotor in speeds
        }
        solved.append(
            solve_rotor(rotor, bearings, settings, rolling=rolling, bearing_speeds=turning, progress=progress)
        )
    return tuple(solved)


def rotor_settings(case: Case, table: GivenRotor) -> RotorSettings:
    """Return loads, speeds and probes of a rotor: those of `[rotor_analysis]`, of `[operation]` and of `[sweep]`."""
    analysis, name = case.rotor_analysis or RotorAnalysis(), table.name
    speeds = rotor_speeds(case, name)
    runs = case.operation is not None
    forces = () if case.operation is None else case.operation.force
    stiffness_map = analysis.stiffness_map
    probes = analysis.unbalance_response.probes
    return RotorSettings(
        operation=speeds.whirl[0] if runs else None,
        whirl_speeds=speeds.whirl[1:] if runs else speeds.whirl,
        diagram_speeds=speeds.campbell,
        response_speeds=speeds.response,
        mode_count=analysis.modes,
        orders=analysis.orders,
        gravity=analysis.gravity,
        # Those of its gears are not among them.
        forces=[StaticForce(force.at, force.x, force.y, force.z) for force in forces if force.rotor == name],
        unbalances=table.build_unbalance(),
        bow=table.build_bow(),
        probes=[Probe(probe.name, probe.at, probe.angle) for probe in probes if probe.rotor == name]
        if probes
        else None,
        torsion=None
        if analysis.torsional_response is None
        else _torsional_excitation(analysis.torsional_response, table),
        stiffness_map=None
        if stiffness_map is None
        else StiffnessRange(stiffness_map.stiffnesses, stiffness_map.modes, stiffness_map.whirl),
    )


def _torsional_excitation(settings: TorsionalAnalysis, table: GivenRotor) -> TorsionalExcitation:
    """Return the torques on one rotor; none where those of the case are on others."""
    name = table.name
    springs = [spring for spring in settings.springs if spring.rotor == name]
    return TorsionalExcitation(
        [
            Torque(torque.at, torque.amplitude * np.exp(1j * torque.phase))
            for torque in settings.torques
            if torque.rotor == name
        ],
        table.damping_ratio if settings.damping_ratio is None else settings.damping_ratio,
        None if settings.frequency is None else [_TWO_PI * frequency for frequency in settings.frequency.frequencies],
        springs=[AxisSpring(spring.at, spring.stiffness) for spring in springs if spring.stiffness > 0.0],
        dashpots=[TorsionalDashpot(spring.at, spring.damping) for spring in springs if spring.damping > 0.0],
        probes=[Probe(probe.name, probe.at) for probe in settings.probes if probe.rotor == name]
        if settings.probes
        else None,
    )


def write_ross_files(folder: Path, solved: tuple[SolvedRotor, ...]) -> tuple[str, ...]:
    """Write every rotor as ``<name>.ross.toml``, and return remarks on parts that ROSS cannot hold."""
    remarks: list[str] = []
    for rotor, stem in zip(solved, file_stems([rotor.rotor.name for rotor in solved]), strict=True):
        remarks += write_ross(folder / f"{stem}.ross.toml", rotor.rotor, rotor.bearings)
    return tuple(remarks)
