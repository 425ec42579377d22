"""Machine of a case with its solved housing: reduced housing, gear pairs at the operating point, coupled system."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from gearwhine.case import Case, require
from gearwhine.coupling import CoupledMachine, Machine
from gearwhine.coupling.errors import CouplingError, EquilibriumNotFoundError
from gearwhine.coupling.gears import GearError
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair
from gearwhine.coupling.linear.frequency_response import BasisError
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.machine.components import HousingComponent, SensorPlace, housing_component
from gearwhine.coupling.machine.excitation import Run
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.coupling.time.recording import TransientPlan
from gearwhine.from_case.gear_pairs import solve_gears
from gearwhine.from_case.machine import describe_machine
from gearwhine.housing import ModeSet
from gearwhine.housing.housing import RESPONSE_ORDERS
from gearwhine.housing.modes.residual_modes import leading_residual_modes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors import EquilibriumError, RotorError
from gearwhine.solve.housing_modes import SolvedHousing, base_participation

FloatArray = npt.NDArray[np.float64]

NO_OPERATING_POINT = (CouplingError, EquilibriumNotFoundError, EquilibriumError, GearError, RotorError)
"""Errors of a machine whose equilibrium is not found."""

_MORE_MODES = 2.0  # limit factor of the shafts' modes in the basis for comparison, which gives the error


@dataclass(frozen=True)
class ReducedHousing:
    """Solved housing reduced to the quantities that a machine needs: kilobytes, without mesh and shapes.

    Attributes
    ----------
    component : HousingComponent
    frequencies_hz : ndarray, shape (n_modes,)
        Natural frequencies of its modes [Hz].
    warnings : tuple of dict
        Warnings about the housing, as in the documents.
    coarser : HousingComponent or None
        The component with fewer residual modes; the difference estimates the truncation error.
    """

    component: HousingComponent
    frequencies_hz: FloatArray
    warnings: tuple[dict[str, Any], ...] = ()
    coarser: HousingComponent | None = None


def reduce_housing(case: Case, solved: SolvedHousing, progress: Progress = silent) -> ReducedHousing:
    """Reduce a solved housing to the quantities that a machine needs."""
    component, coarser = _housing_components(case, solved, progress)
    return ReducedHousing(component, solved.modes.frequencies_hz, tuple(solved.warnings), coarser)


@dataclass(frozen=True, eq=False)
class LoadedMachine:
    """Machine about its operating point: its parts, its gear pairs under load, and the coupled system.

    Attributes
    ----------
    machine : Machine
        Bearings and flanks that are left to the operating point are those of it.
    pairs : tuple of LoadedGearPair
    coupled : CoupledMachine
        Assembled for its run.
    run : SpeedRun, FreeRun or None
        None at constant speed.
    housing : ReducedHousing or None
    """

    machine: Machine
    pairs: tuple[LoadedGearPair, ...]
    coupled: CoupledMachine
    run: Run | None
    housing: ReducedHousing | None

    def basis_error(self, progress: Progress = silent) -> BasisError | None:
        """Estimate the modal truncation error by a machine of other residual attachments and more shaft modes.

        None where there is no housing, and so no sensor.
        """
        if self.housing is None or self.housing.coarser is None or not self.housing.component.sensors:
            return None
        progress("comparing with another modal basis")
        other = replace(self.machine, housing=self.housing.coarser)
        components = other.rotor_components(limit_factor=_MORE_MODES)
        return BasisError(self.coupled, other.assemble(self.pairs, components, self.run))

    @property
    def mechanisms(self) -> LineMechanisms:
        """What excites the lines of its sensors."""
        return LineMechanisms(self.coupled)


def described_machine(case: Case, housing: ReducedHousing | None) -> Machine:
    """Describe the machine of a case in its solved housing, or on rigid seats."""
    return describe_machine(case, None if housing is None else housing.component, grounded=housing is None)


def load_machine(
    machine: Machine,
    point: OperatingPoint | None,
    housing: ReducedHousing | None = None,
    run: Run | None = None,
    progress: Progress = silent,
) -> LoadedMachine:
    """Assemble a machine about its operating point.

    Parameters
    ----------
    machine : Machine
    point : OperatingPoint or None
        None where nothing loads the machine, or where it is not found: flanks are aligned then.
    housing : ReducedHousing, optional
        Of the machine.
    run : SpeedRun or FreeRun, optional
    progress : callable

    Raises
    ------
    gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine, or a bearing is left to an operating point that is not there.
    gearwhine.coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    about = machine.linearised(point)
    pairs = about.loaded_pairs(progress)
    coupled = about.assemble(pairs, about.rotor_components(progress=progress), run)
    return LoadedMachine(about, pairs, coupled, run, housing)


def solve_pairs(
    case: Case, housing: SolvedHousing | ReducedHousing | None, progress: Progress = silent
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
        return solve_gears(case, progress), None
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    machine, point = described_machine(case, housing), None
    if any(pair.misalignment is None for pair in machine.gear_pairs):
        progress("misalignment of the flanks at the operating point")
        try:
            point = machine.operating_point()
        except NO_OPERATING_POINT:
            if case.needs_operating_point:
                raise
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


def run_of(case: Case) -> Run | None:
    """Return the run of a case's transient; None at constant speed."""
    run = None if case.transient is None else case.transient.run
    return None if run is None else run.build()


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
        sensor_places={name: SensorPlace(port.position, port.direction) for name, port in solved.sensors.items()},
        participation=participation,
    )
