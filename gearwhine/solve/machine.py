"""Machine of a case with its solved housing: reduced housing, gear pairs at the operating point, coupled system."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from gearwhine.case import Case, require
from gearwhine.coupling.analyses.loaded_machine import point_of_flanks
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.run_up import OrderTracking
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.machine.components import HousingComponent, SensorPlace, housing_component
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.from_case.machine import describe_machine, solve_gears
from gearwhine.housing import ModeSet
from gearwhine.housing.housing import RESPONSE_ORDERS
from gearwhine.housing.modes.residual_modes import leading_residual_modes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing, base_participation

FloatArray = npt.NDArray[np.float64]


def reduce_housing(case: Case, solved: SolvedHousing, progress: Progress = silent) -> HousingComponent:
    """Reduce a solved housing to the quantities that a machine needs: kilobytes, without mesh and shapes."""
    component, coarser = _housing_components(case, solved, progress)
    return replace(component, coarser=coarser, warnings=tuple(solved.warnings))


def solve_pairs(
    case: Case, housing: SolvedHousing | HousingComponent | None, progress: Progress = silent
) -> tuple[tuple[LoadedGearPair, ...], OperatingPoint | None]:
    """Solve the gear pairs of a case, and the operating point of which flanks have their misalignment.

    The point is that in the housing, or on rigid seats without one. It is None where the misalignment of no pair is
    left to it, and where the machine has none and only misalignments that the case leaves out would follow from it.

    Raises
    ------
    CaseError, gearwhine.coupling.gears.GearError, gearwhine.coupling.CouplingError,
    gearwhine.coupling.EquilibriumNotFoundError
        Where a pair cannot be solved as it stands, or flanks or bearings are left explicitly to an operating point that
        the machine does not have.
    """
    if not case.rotor or case.operation is None:
        return solve_gears(case.parts, progress), None
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    machine = describe_machine(case, housing)
    point = point_of_flanks(machine, progress, is_needed=case.parts.needs_operating_point)
    return machine.with_flanks_of(point).loaded_pairs(progress), point


def plan_of(case: Case) -> TransientPlan:
    """Return the plan of a case's transient.

    Raises
    ------
    CaseError
        Where the case has none.
    """
    require(case, "transient", command="run")
    assert case.transient is not None
    return case.transient.build()


def tracking_of(case: Case) -> OrderTracking:
    """Return the windows of the order cuts of a case's run."""
    run = None if case.transient is None else case.transient.run
    return OrderTracking() if run is None else run.orders.build()


def run_of(case: Case) -> Run | None:
    """Return the run of a case's transient; None at constant speed."""
    run = None if case.transient is None else case.transient.run
    return None if run is None else run.build()


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
        sensor_places={name: SensorPlace(port.position, port.direction) for name, port in solved.sensors.items()},
        participation=participation,
    )
