"""Machine of a case with its solved housing: reduced housing, gear pairs at the operating point, coupled system."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from gearwhine.case import Case, require
from gearwhine.coupling import CoupledMachine
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.linear.frequency_response import BasisError
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.machine.base_motion import BaseMotion
from gearwhine.coupling.machine.components import HousingComponent, housing_component
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.time.histories import Histories
from gearwhine.from_case.driving import driving
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.from_case.machine import describe_machine, gravity, require_machine
from gearwhine.housing import ModeSet
from gearwhine.housing.housing import RESPONSE_ORDERS
from gearwhine.housing.modes.residual_modes import leading_residual_modes
from gearwhine.progress import Progress, silent
from gearwhine.rotors import EquilibriumError, RotorError
from gearwhine.solve.housing_modes import SolvedHousing, base_participation, solve_housing

FloatArray = npt.NDArray[np.float64]

NO_OPERATING_POINT = (CouplingError, EquilibriumNotFoundError, EquilibriumError, GearError, RotorError)
"""Errors of a machine whose equilibrium is not found."""

_MORE_MODES = 2.0  # limit factor of the shafts' modes in the basis for comparison, which gives the error


@dataclass(frozen=True)
class SensorPlace:
    """Sensor position [m] and the unit vector of its direction, shapes (3,)."""

    position: FloatArray
    direction: FloatArray


@dataclass(frozen=True)
class ReducedHousing:
    """Solved housing reduced to the quantities that a machine needs: kilobytes, without mesh and shapes.

    Attributes
    ----------
    component : HousingComponent
    frequencies_hz : ndarray, shape (n_modes,)
        Natural frequencies of its modes [Hz].
    trusted_limit_hz : float
        Frequency below which they are complete [Hz].
    warnings : tuple of dict
        Warnings about the housing, as in the documents.
    sensors : mapping of str to SensorPlace
    coarser : HousingComponent or None
        The component with fewer residual modes; the difference estimates the truncation error.
    """

    component: HousingComponent
    frequencies_hz: FloatArray
    trusted_limit_hz: float
    warnings: tuple[dict[str, Any], ...] = ()
    sensors: Mapping[str, SensorPlace] = field(default_factory=dict)
    coarser: HousingComponent | None = None


def reduce_housing(case: Case, solved: SolvedHousing, progress: Progress = silent) -> ReducedHousing:
    """Reduce a solved housing to the quantities that a machine needs."""
    component, coarser = _housing_components(case, solved, progress)
    return ReducedHousing(
        component,
        solved.modes.frequencies_hz,
        solved.trusted_limit_hz,
        tuple(solved.warnings),
        {name: SensorPlace(port.position, port.direction) for name, port in solved.sensors.items()},
        coarser,
    )


def build_machine(
    case: Case,
    housing: SolvedHousing | ReducedHousing | None,
    pairs: tuple[LoadedGearPair, ...],
    progress: Progress = silent,
    *,
    point: OperatingPoint | None = None,
    limit_factor: float = 1.0,
) -> CoupledMachine:
    """Assemble the machine of a case at its operating speed.

    ``point`` is its operating point where that is known already. ``limit_factor`` multiplies the frequency, or the
    number, up to which modes of the shafts are retained.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine.
    gearwhine.coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    machine = describe_machine(case, None if housing is None else housing.component)
    if any(mounted.needs_load for mounted in machine.bearings):
        if point is None:
            progress("static equilibrium of the machine under its mean load")
        machine = machine.at_operating_point(point, gravity=gravity(case))
    components = machine.rotor_components(limit_factor=limit_factor, progress=progress)
    return machine.assemble(pairs, components, driving(case, components))


def solve_machine(
    case: Case,
    progress: Progress = silent,
    *,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    point: OperatingPoint | None = None,
) -> tuple[SolvedHousing | None, tuple[LoadedGearPair, ...], CoupledMachine]:
    """Solve the housing and the gears of the case, and assemble the machine.

    ``housing`` and ``point`` are its housing and its operating point where they are solved already; ``folder`` and
    ``fresh`` are those of :func:`gearwhine.solve.housing_modes.solve_housing`.
    """
    require(case, "rotor", "operation", command="system")
    require_machine(case)
    if housing is None and case.housing is not None:
        housing = solve_housing(case, progress, folder=folder, fresh=fresh)
    pairs = solve_pairs(case, housing, progress, point=point)
    return housing, pairs, build_machine(case, housing, pairs, progress, point=point)


def solve_pairs(
    case: Case,
    housing: SolvedHousing | ReducedHousing | None,
    progress: Progress = silent,
    *,
    point: OperatingPoint | None = None,
) -> tuple[LoadedGearPair, ...]:
    """Solve the gear pairs of a case; none for one without.

    The gap of flanks whose misalignment is to be found is that of the operating point, on rigid seats where there is no
    housing; ``point`` is that point where it is known already.

    Raises
    ------
    CaseError, gearwhine.coupling.gears.GearError, gearwhine.coupling.CouplingError,
    gearwhine.coupling.EquilibriumNotFoundError
        Where a pair cannot be solved as it stands, or the machine has no operating point.
    """
    if not case.gear_pair:
        return ()
    point = point or point_of_pairs(case, housing, progress)
    unaligned = [pair_label(pair.driver, pair.driven) for pair in case.gear_pair if case.finds_misalignment(pair)]
    return solve_gears(case, progress, {} if point is None else point.flank_gaps(unaligned))


def point_of_pairs(
    case: Case, housing: SolvedHousing | ReducedHousing | None, progress: Progress = silent
) -> OperatingPoint | None:
    """Solve the operating point that gives gear pairs their misalignment, on rigid seats where there is no housing.

    None where no pair is left to it, and where the machine has none and only misalignments that the case leaves out
    would follow from it.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError
        Where the machine has no operating point, and bearings or flanks are left to it explicitly.
    """
    if not any(case.finds_misalignment(pair) for pair in case.gear_pair):
        return None
    progress("misalignment of the flanks at the operating point")
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    component = None if housing is None else housing.component
    machine = describe_machine(case, component, grounded=component is None)
    try:
        return machine.operating_point(gravity(case))
    except NO_OPERATING_POINT:
        if case.needs_operating_point:
            raise
        return None


def basis_error(
    case: Case,
    machine: CoupledMachine,
    housing: SolvedHousing | ReducedHousing | None,
    pairs: tuple[LoadedGearPair, ...],
    progress: Progress = silent,
    *,
    point: OperatingPoint | None = None,
) -> BasisError | None:
    """Estimate the modal truncation error: compare with a machine of other residual attachments and more shaft modes.

    ``point`` is the operating point about which both are linearised, where it is known already. None where there is no
    housing, and so no sensor.
    """
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    if housing is None or housing.coarser is None or not housing.component.sensors:
        return None
    progress("comparing with another modal basis")
    coarser = replace(housing, component=housing.coarser)
    return BasisError(machine, build_machine(case, coarser, pairs, point=point, limit_factor=_MORE_MODES))


def full_housing_component(case: Case, solved: SolvedHousing, progress: Progress = silent) -> HousingComponent:
    """Return the housing with all its residual modes."""
    participation = _participation(case, solved, progress)
    return _housing_component(case, solved, solved.modes, solved.damping_matrix, participation)


def _participation(case: Case, solved: SolvedHousing, progress: Progress) -> FloatArray | None:
    """Return the participation in the motions of the ground, where base motion or weight needs it."""
    assert case.operation is not None
    if case.operation.base is None and case.operation.gravity is None:
        return None
    progress("taking the housing's mass for the motion of its base and its weight")
    return base_participation(case, solved.mesh, solved.modes)


def _housing_components(
    case: Case, solved: SolvedHousing, progress: Progress
) -> tuple[HousingComponent, HousingComponent | None]:
    """Return the housing with all its attachments, and with those of one order of response less."""
    participation = _participation(case, solved, progress)
    component = _housing_component(case, solved, solved.modes, solved.damping_matrix, participation)
    attached = solved.modes.residual_modes
    if attached is None or not solved.loaded:
        return component, None
    ports = sparse.csr_array(sparse.vstack(list(solved.loaded.values()), format="csr"))
    fewer, mixture = leading_residual_modes(attached, ports, solved.modes.certificate.limit**2, RESPONSE_ORDERS - 1)
    transformation = linalg.block_diag(np.eye(len(solved.modes.frequencies)), mixture)
    return component, _housing_component(
        case,
        solved,
        replace(solved.modes, residual_modes=fewer),
        None if solved.damping_matrix is None else transformation.T @ solved.damping_matrix @ transformation,
        None if participation is None else transformation.T @ participation,
    )


def _housing_component(
    case: Case, solved: SolvedHousing, modes: ModeSet, damping: FloatArray | None, participation: FloatArray | None
) -> HousingComponent:
    assert case.housing is not None
    return housing_component(
        modes,
        solved.damping_ratios,
        seats={name: modes.project_all(port) for name, port in solved.seat_ports.items()},
        seat_z={seat.name: seat.center[2] for seat in case.housing.seat},
        seat_axes={seat.name: seat.center[:2] for seat in case.housing.seat},
        damping_matrix=damping,
        sensors={name: modes.project_all(port.matrix)[:, 0] for name, port in solved.sensors.items()},
        participation=participation,
    )


def in_space(relative: Histories, housing: SolvedHousing | ReducedHousing | None, base: BaseMotion | None) -> Histories:
    """Return histories as accelerometers show them: motion in space, not relative to a moving base."""
    if base is None or housing is None:
        return relative
    absolute = {
        name: relative.sensor_acceleration[name] + base.acceleration_at(port.position, port.direction, relative.times)
        for name, port in housing.sensors.items()
    }
    return replace(relative, sensor_acceleration=absolute)


def line_mechanisms(machine: CoupledMachine, housing: SolvedHousing | ReducedHousing | None) -> LineMechanisms:
    """Return what excites the lines of a machine's sensors, which show motion in space."""
    base = machine.loads.base
    if base is None or housing is None:
        return LineMechanisms(machine)
    return LineMechanisms(
        machine, {name: base.row_at(port.position, port.direction) for name, port in housing.sensors.items()}
    )
