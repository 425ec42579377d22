"""Machine of a case: shafts, bearings, gears and the reduced housing, assembled into one coupled system."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from coupling import BaseMotion, CoupledMachine, Machine, MountedBearing, Output, Shaft, ShaftGear
from coupling.gears.loaded.gear_pair import LoadedGearPair
from coupling.linear.frequency_response import BasisError
from coupling.machine.components import HousingComponent, housing_component
from gearwhine.case import Case, RollingStiffness, Rotor, require
from gearwhine.from_case.driving import driving
from gearwhine.from_case.gear_pairs import build_pair, solve_gears
from gearwhine.from_case.rotors import bearing_law, build_bearings, build_gear, gear_inertia
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing, base_participation, solve_housing
from housing import ModeSet
from housing.model.housing import RESPONSE_ORDERS
from housing.modes.residual_modes import leading_residual_modes

FloatArray = npt.NDArray[np.float64]

_HERTZ = 2.0 * np.pi

# Shafts keep every bending mode up to this frequency, or several times the housing's limit where that is higher;
# what lies above answers statically, through attachment vectors at bearings and gears.
_LATERAL_LIMIT_HZ = 8000.0
_LIMIT_FACTOR = 2.5
_REACH = 2.0  # of the shafts' modes in the basis that tells the error of the first


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
    reach: float = 1.0,
) -> CoupledMachine:
    """Assemble the machine of a case at its operating speed.

    ``reach`` multiplies the frequency, or the number, up to which modes of the shafts are retained.

    Raises
    ------
    CaseError, rotors.RotorError, coupling.CouplingError
        Where the parts do not make a machine.
    coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    machine = describe_machine(case, None if housing is None else housing.component)
    components = machine.rotor_components(reach=reach, progress=progress)
    return machine.assemble(pairs, components, driving(case, components))


def require_machine(case: Case) -> None:
    """Refuse a case whose parts do not make a machine, before anything is solved.

    Raises
    ------
    CaseError, rotors.RotorError, coupling.CouplingError, coupling.gears.GearError
        As :func:`describe_machine`; thrust that nothing carries is among the reasons.
    """
    if case.gear_pair and case.rotor and case.operation is not None:
        describe_machine(case, None, grounded=True)


def describe_machine(case: Case, housing: HousingComponent | None = None, *, grounded: bool = False) -> Machine:
    """Build the library's description of a machine: the shafts, gears, bearings and gear pairs of a case.

    ``grounded`` puts every bearing on the ground: the machine is looked at before its housing is solved.

    Raises
    ------
    CaseError, rotors.RotorError, coupling.CouplingError, coupling.gears.GearError
        Where the parts do not make a machine.
    """
    require(case, "rotor", "operation", command="system")
    operation = case.operation
    assert operation is not None
    bearings = []
    for given in case.rotor:
        laws = {entry.name: bearing_law(case, n) for n, entry in enumerate(case.bearing) if entry.rotor == given.name}
        # Those of the rotor's own file stand on the ground.
        seats = {entry.name: entry.seat for entry in case.bearing if entry.rotor == given.name and not entry.grounded}
        rolling = {
            entry.name: entry.stiffness.rolling.build(entry.name)
            for entry in case.bearing
            if entry.rotor == given.name and isinstance(entry.stiffness, RollingStiffness)
        }
        bearings += [
            MountedBearing(
                bearing,
                given.name,
                None if grounded else seats.get(bearing.name),
                laws.get(bearing.name),
                rolling.get(bearing.name),
            )
            for bearing in build_bearings(case, given.name)
        ]
    return Machine(
        shafts=[_shaft(case, given) for given in case.rotor],
        bearings=bearings,
        gears=[
            ShaftGear(build_gear(case, gear), gear.rotor, gear.at, gear_inertia(case, gear))
            for gear in case.gear
            if gear.rotor is not None and gear.at is not None
        ],
        gear_pairs=[build_pair(given, number) for number, given in enumerate(case.gear_pair)],
        speed=operation.speed,
        torque=operation.torque,
        outputs=[Output(output.rotor, output.torque, output.at) for output in operation.output],
        housing=housing,
        torque_at=operation.at or 0.0,
    )


def _shaft(case: Case, given: Rotor) -> Shaft:
    limit, count = _retained_modes(case, given.name)
    return Shaft(
        given.build(case.material),
        given.axis,
        given.start,
        given.damping_ratio,
        given.build_unbalance(),
        given.build_bow(),
        limit,
        count,
    )


def solve_machine(
    case: Case,
    progress: Progress = silent,
    *,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
) -> tuple[SolvedHousing | None, tuple[LoadedGearPair, ...], CoupledMachine]:
    """Solve the housing and the gears of the case, and assemble the machine.

    ``housing`` is one that is solved already; ``folder`` and ``fresh`` are those of
    :func:`gearwhine.solve.housing_modes.solve_housing`.
    """
    require(case, "rotor", "operation", command="system")
    require_machine(case)
    pairs = solve_gears(case, progress) if case.gear_pair else ()
    if housing is None and case.housing is not None:
        housing = solve_housing(case, progress, folder=folder, fresh=fresh)
    return housing, pairs, build_machine(case, housing, pairs, progress)


def _retained_modes(case: Case, rotor: str) -> tuple[float | None, int | None]:
    """Retained modes of a rotor: a frequency limit [rad/s], or a number of each kind."""
    given = case.rotor_named(rotor)
    if given.modes is not None:
        return None, given.modes
    if given.frequency_limit is not None:
        return _HERTZ * given.frequency_limit, None
    limit = (case.housing.frequency_limit or 0.0) if case.housing else 0.0
    return _HERTZ * max(_LATERAL_LIMIT_HZ, _LIMIT_FACTOR * limit), None


def base_motion(case: Case) -> BaseMotion | None:
    """Motion of the ground of a case, if it moves."""
    base = None if case.operation is None else case.operation.base
    return None if base is None else base.build()


def basis_error(
    case: Case,
    machine: CoupledMachine,
    housing: SolvedHousing | ReducedHousing | None,
    pairs: tuple[LoadedGearPair, ...],
    progress: Progress = silent,
) -> BasisError | None:
    """Estimate the modal truncation error: compare with a machine of other residual attachments and more shaft modes.

    None where there is no housing, and so no sensor.
    """
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    if housing is None or housing.coarser is None or not housing.component.sensors:
        return None
    progress("comparing with another modal basis")
    other = replace(housing, component=housing.coarser)
    return BasisError(machine, build_machine(case, other, pairs, reach=_REACH))


def _housing_components(
    case: Case, solved: SolvedHousing, progress: Progress
) -> tuple[HousingComponent, HousingComponent | None]:
    """Return the housing with all its attachments, and with those of one order of response less."""
    assert case.operation is not None
    participation = None
    if case.operation.base is not None or case.operation.gravity is not None:
        progress("taking the housing's mass for the motion of its base and its weight")
        participation = base_participation(case, solved.mesh, solved.modes)
    component = _housing_component(case, solved, solved.modes, solved.damping_matrix, participation)
    attached = solved.modes.residual_modes
    if attached is None or not solved.loaded:
        return component, None
    ports = sparse.csr_array(sparse.vstack(list(solved.loaded.values()), format="csr"))
    fewer, mixture = leading_residual_modes(attached, ports, solved.modes.certificate.limit**2, RESPONSE_ORDERS - 1)
    taken = linalg.block_diag(np.eye(len(solved.modes.frequencies)), mixture)
    return component, _housing_component(
        case,
        solved,
        replace(solved.modes, residual_modes=fewer),
        None if solved.damping_matrix is None else taken.T @ solved.damping_matrix @ taken,
        None if participation is None else taken.T @ participation,
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
