"""Machine of a case: reduced housing, operating point, gear pairs there, and plan of the motion over time."""

from dataclasses import replace

from gearwhine.case import Case, Transient
from gearwhine.case.model import lacking
from gearwhine.case.parts import Parts
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.loaded_machine import point_of_flanks
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.analyses.run_up import OrderTracking
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.load_analysis.load_warnings import find_load
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad
from gearwhine.coupling.machine.components import HousingComponent, component_of_housing
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.from_case.machine import aligned_by_default, describe_machine, solve_gears
from gearwhine.housing import HousingModes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning


def reduce_housing(case: Case, solved: HousingModes, *, with_coarser: bool = True) -> HousingComponent:
    """Reduce a solved housing to the quantities that the case's machine needs: kilobytes, without mesh and shapes.

    Without the coarser one the error of its basis cannot be estimated.
    """
    operation = case.operation
    participates = operation is not None and (operation.base is not None or operation.gravity is not None)
    component = component_of_housing(solved, participates=participates, with_coarser=with_coarser)
    return replace(component, displacement_field=None)


def load_of_case(
    parts: Parts, machine: Machine, progress: Progress = silent
) -> tuple[SolvedLoad | None, list[ResultWarning]]:
    """Find the operating point of a case's machine beside another analysis, and its warnings.

    See :func:`gearwhine.coupling.load_analysis.load_warnings.find_load`; the point is None where nothing loads it, too.
    """
    if not parts.is_loaded:
        return None, []
    return find_load(
        machine, progress, is_needed=parts.needs_operating_point, aligned_by_default=aligned_by_default(parts)
    )


def solve_pairs(
    case: Case, housing: HousingModes | HousingComponent | None, progress: Progress = silent
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
    if case.transient is None:
        raise lacking(case, "transient", command="run")
    return case.transient.build()


def tracking_of(transient: Transient | None) -> OrderTracking:
    """Return the windows of the order cuts of a transient's run."""
    run = None if transient is None else transient.run
    return OrderTracking() if run is None else run.orders.build()


def run_of(transient: Transient | None) -> Run | None:
    """Return the run of a transient; None at constant speed."""
    run = None if transient is None else transient.run
    return None if run is None else run.build()
