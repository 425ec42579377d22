"""Shafts of a machine, each alone in its bearings on rigid seats."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearwhine.coupling.machine_description import Machine
from gearwhine.coupling.statics.operating_point import linearised_about
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.numerics.speed_ranges import campbell_speeds, response_speeds
from gearwhine.rotors import Bearing
from gearwhine.rotors.analyses.solved_rotor import RotorSettings, SolvedRotor, solve_rotor, table_range
from gearwhine.rotors.analyses.statics import StaticForce
from gearwhine.rotors.rolling_bearings import RollingState, rolling_equilibrium

BearingsUnderLoad = tuple[tuple[Bearing, ...], dict[str, RollingState]]


def solve_shafts(
    machine: Machine, speeds: Sequence[float] = (), progress: Progress = silent, **settings: Any
) -> tuple[SolvedRotor, ...]:
    """Solve every shaft of a machine alone, with its gears as discs, in its bearings on rigid seats.

    A planet turns on pins that stand still, at its speed relative to the carrier.

    Parameters
    ----------
    machine : Machine
        Its speed is that of operation; its gravity, forces, unbalances and bows load the shafts.
    speeds : sequence of float
        Signed speeds of the first driver's shaft at which whirl modes are solved, and over which the Campbell diagrams
        and responses go [rad/s]; by default the speed of operation, and up to 1.5 times that.
    progress : callable
    **settings
        Attributes of :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings` for all shafts, such as
        ``mode_count``, ``orders`` or ``stiffness_map``.

    Raises
    ------
    gearwhine.rotors.RotorError
        Where a shaft cannot be solved as it stands.
    gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError
        Where bearings get their stiffness from their load, and the machine has no operating point.
    gearwhine.rotors.IncompleteModesError
        Where modes fail their certificate.
    """
    bearings = bearings_on_rigid_seats(machine)
    solved = []
    for shaft in machine.shafts:
        progress(f"rotor {shaft.name}")
        held, rolling = bearings[shaft.name]
        chosen = replace(shaft_settings(machine, shaft.name, held, speeds), **settings)
        turning = {one.bearing.name: machine.bearing_speed(one) for one in machine.bearings if one.rotor == shaft.name}
        rotor = machine.rotor(shaft.name)
        solved.append(solve_rotor(rotor, held, chosen, rolling=rolling, bearing_speeds=turning, progress=progress))
    return tuple(solved)


def shaft_settings(
    machine: Machine, name: str, bearings: Sequence[Bearing], speeds: Sequence[float] = ()
) -> RotorSettings:
    """Return the loads of a shaft of a machine, and the speeds of its analyses; see :func:`solve_shafts`."""
    shaft, ratio = machine.shaft(name), machine.ratio_on_seats(name)
    operation = ratio * machine.speed
    whirl = tuple(ratio * speed for speed in speeds)
    diagram = whirl or campbell_speeds(operation, table_range(bearings))
    settings = RotorSettings(
        operation=operation,
        whirl_speeds=whirl,
        diagram_speeds=sorted(set(diagram)),
        response_speeds=response_speeds(sorted(set(diagram))),
        forces=[StaticForce(one.at, *one.force) for one in machine.forces if one.rotor == name],
        unbalances=shaft.unbalances,
        bow=shaft.bow,
    )
    return settings if machine.gravity is None else replace(settings, gravity=machine.gravity)


def planet_warnings(carriers: Mapping[str, str]) -> list[ResultWarning]:
    """Warn of what a planet alone leaves out; ``carriers`` has the carrier of each."""
    warnings = []
    for carrier in dict.fromkeys(carriers.values()):
        planets = [name for name, of in carriers.items() if of == carrier]
        message = (
            f"{', '.join(planets)}: {'each' if len(planets) > 1 else 'it is'} alone on a pin that stands still, as if "
            f'carrier "{carrier}" did: speeds and critical speeds are those on the pin; the carrier\'s compliance, the '
            "force of circling with it and Coriolis terms are left out, and of the carrier alone the planets; modes "
            "of the machine have all of them (system)"
        )
        warnings.append(warning("planets alone", message, planets=planets, carrier=carrier))
    return warnings


def held_speeds(machine: Machine) -> tuple[float, float]:
    """Return the range of speeds of the first driver's shaft, without sense, that the tables of all bearings hold.

    Zero and infinity for bearings without tables [rad/s].
    """
    low, high = 0.0, math.inf
    for name, ratio in machine.train.ratios.items():
        least, most = table_range([one.bearing for one in machine.bearings if one.rotor == name])
        if ratio:
            low, high = max(low, least / abs(float(ratio))), min(high, most / abs(float(ratio)))
    return low, high


def bearings_on_rigid_seats(machine: Machine) -> dict[str, BearingsUnderLoad]:
    """Bearings of each shaft and the states of the rolling ones; where their stiffness follows from it, under load.

    The operating point is that of the machine on rigid seats, solved only if a bearing needs it.

    Raises
    ------
    gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError
        Where a bearing needs its load, and the machine has no operating point.
    """
    grounded = replace(machine, housing=None, bearings=[replace(one, seat=None) for one in machine.bearings])
    found: dict[str, BearingsUnderLoad] = {}
    if any(one.needs_load for one in machine.bearings):
        found = bearings_under_load(grounded)
    for shaft in machine.shafts:
        mounted = [one for one in machine.bearings if one.rotor == shaft.name]
        states = {}
        for one in mounted:
            if one.rolling is not None and one.design_load is not None and not one.needs_load:
                # The shaft in line with its seat, as where the stiffness is made for a load that is given.
                loads = [*one.design_load, 0.0, 0.0]
                states[one.bearing.name] = rolling_equilibrium(one.rolling, loads, held={"rx": 0.0, "ry": 0.0})
        bearings, under_load = found.get(shaft.name, (tuple(one.bearing for one in mounted), {}))
        found[shaft.name] = bearings, states | under_load
    return found


def bearings_under_load(machine: Machine) -> dict[str, BearingsUnderLoad]:
    """Bearings of each shaft linearised about the machine's operating point, and the states of those that need it."""
    point = machine.operating_point()
    found = {}
    for shaft in machine.shafts:
        loads = [load for load in point.bearings if load.mounted.rotor == shaft.name]
        states = {load.name: load.rolling for load in loads if load.mounted.needs_load and load.rolling is not None}
        found[shaft.name] = tuple(linearised_about([load]).bearing for load in loads), states
    return found
