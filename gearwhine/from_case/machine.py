"""Machine of a case: shafts, bearings, gears and the reduced housing, assembled into one coupled system.

Its excitation is the speed profile, torques over time, ripple, base motion and gravity.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import linalg, sparse

from coupling import BaseMotion, CoupledMachine, Machine, MountedBearing, Shaft, SpeedProfile, Torque
from coupling.gears.geometry.pair import pair_label
from coupling.gears.loaded.gear_pair import LoadedGearPair
from coupling.linear.frequency_response import BasisError
from coupling.machine.components import HousingComponent, RotorComponent, housing_component
from coupling.machine.description import LATERAL_LIMIT_HZ
from coupling.machine.loads import AnyTorque, Drive, TorqueHistory, TorqueSlope
from coupling.machine.parts import Driving
from coupling.statics.operating_point import OperatingPoint
from coupling.time.speed_profile import free_speed
from gearwhine.case import Case, Rotor, TorqueLine, applied_torques, require, speed_ratios
from gearwhine.from_case.gear_pairs import build_pair, solve_gears
from gearwhine.from_case.rotors import bearing_law, build_bearings, rolling_elements, rolling_states, shaft_gears
from gearwhine.progress import Progress, silent
from gearwhine.solve.housing_modes import SolvedHousing, base_participation, solve_housing
from housing import ModeSet
from housing.model.housing import RESPONSE_ORDERS
from housing.modes.residual_modes import leading_residual_modes
from rotors import Bearing
from rotors.rolling_bearings import RollingState

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi

# Shafts keep every bending mode up to LATERAL_LIMIT_HZ, or several times the housing's limit where that is higher; what
# lies above answers statically, through attachment vectors at bearings and gears.
_HOUSING_FACTOR = 2.5
_MORE_MODES = 2.0  # limit factor of the shafts' modes in the basis that tells the error of the first
_SLOPE_STEP = 1e-6  # part of the nominal speed to both sides of a corner of a torque line


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
    CaseError, rotors.RotorError, coupling.CouplingError
        Where the parts do not make a machine.
    coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    machine = describe_machine(case, None if housing is None else housing.component)
    if any(mounted.needs_load for mounted in machine.bearings):
        if point is None:
            progress("static equilibrium of the machine under its mean load")
        machine = machine.at_operating_point(point, gravity=_gravity(case))
    components = machine.rotor_components(limit_factor=limit_factor, progress=progress)
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
        own = [(n, entry) for n, entry in enumerate(case.bearing) if entry.rotor == given.name]
        laws = {entry.name: bearing_law(case, n) for n, entry in own}
        elements = {entry.name: rolling_elements(case, n) for n, entry in own}
        # Those of the rotor's own file stand on the ground.
        seats = {entry.name: entry.seat for _, entry in own if not entry.grounded}
        bearings += [
            MountedBearing(
                bearing,
                given.name,
                None if grounded else seats.get(bearing.name),
                laws.get(bearing.name),
                elements.get(bearing.name),
            )
            for bearing in build_bearings(case, given.name)
        ]
    return Machine(
        shafts=[_shaft(case, given) for given in case.rotor],
        bearings=bearings,
        gears=[gear for given in case.rotor for gear in shaft_gears(case, given.name)],
        gear_pairs=[build_pair(case, given, number) for number, given in enumerate(case.gear_pair)],
        speed=operation.speed,
        torque=operation.torque,
        outputs=[output.build() for output in operation.output],
        housing=housing,
        torque_at=operation.at or 0.0,
        forces=[force.build() for force in operation.force],
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
    CaseError, coupling.gears.GearError, coupling.CouplingError, coupling.EquilibriumNotFoundError
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

    None where no pair is left to it.

    Raises
    ------
    CaseError, coupling.CouplingError, coupling.EquilibriumNotFoundError
        Where the machine has no operating point.
    """
    if not any(case.finds_misalignment(pair) for pair in case.gear_pair):
        return None
    progress("misalignment of the flanks at the operating point")
    if isinstance(housing, SolvedHousing):
        housing = reduce_housing(case, housing, progress)
    component = None if housing is None else housing.component
    return describe_machine(case, component, grounded=component is None).operating_point(_gravity(case))


def rotor_bearings(case: Case) -> dict[str, tuple[tuple[Bearing, ...], dict[str, RollingState]]]:
    """Bearings of each rotor and the states of the rolling ones, linearised about the operating point on rigid seats.

    Where no bearing's load is left to the operating point the case gives them all.

    Raises
    ------
    CaseError, coupling.CouplingError, coupling.EquilibriumNotFoundError, rotors.EquilibriumError
        Where a bearing's load or geometry does not let it be, or the machine has no operating point.
    """
    given = {one.name: (build_bearings(case, one.name), rolling_states(case, one.name)) for one in case.rotor}
    if not any(case.finds_load(bearing) for bearing in case.bearing):
        return given
    point = describe_machine(case, grounded=True).operating_point(_gravity(case))
    found = {}
    for name, (_, states) in given.items():
        own = [one for one in point.bearings if one.mounted.rotor == name]
        open_loads = {one.name: one.rolling for one in own if one.mounted.needs_load and one.rolling is not None}
        found[name] = tuple(one.linearised.bearing for one in own), states | open_loads
    return found


def _gravity(case: Case) -> tuple[float, ...] | None:
    return None if case.operation is None else case.operation.gravity


def _retained_modes(case: Case, rotor: str) -> tuple[float | None, int | None]:
    """Retained modes of a rotor: a frequency limit [rad/s], or a number of each kind."""
    given = case.rotor_named(rotor)
    if given.modes is not None:
        return None, given.modes
    if given.frequency_limit is not None:
        return _TWO_PI * given.frequency_limit, None
    limit = (case.housing.frequency_limit or 0.0) if case.housing else 0.0
    return _TWO_PI * max(LATERAL_LIMIT_HZ, _HOUSING_FACTOR * limit), None


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
    other = replace(housing, component=housing.coarser)
    return BasisError(machine, build_machine(case, other, pairs, point=point, limit_factor=_MORE_MODES))


def full_housing_component(case: Case, solved: SolvedHousing, progress: Progress = silent) -> HousingComponent:
    """Return the housing with all its residual modes."""
    participation = _participation(case, solved, progress)
    return _housing_component(case, solved, solved.modes, solved.damping_matrix, participation)


def _participation(case: Case, solved: SolvedHousing, progress: Progress) -> FloatArray | None:
    """Participation in the motions of the ground, where its motion or weight asks for it."""
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


@dataclass(frozen=True)
class CaseDriving(Driving):
    """Excitation of the machine of a case.

    Attributes
    ----------
    turning : SpeedProfile or None
        Speed over time; None where it is the nominal one all along.
    """

    turning: SpeedProfile | None = None


def driving(case: Case, rotors: Sequence[RotorComponent]) -> CaseDriving:
    """Speed profile, torques, base motion and gravity of a case with an operation.

    Raises
    ------
    coupling.TransientError
        Where a free speed cannot start or stalls.
    """
    operation = case.operation
    assert operation is not None
    nominal = abs(operation.speed)
    run = None if case.transient is None else case.transient.run
    shares = applied_torques(case, 1.0)
    turning = None
    if run is not None and run.free:
        assert operation.motor is not None
        motor, load = operation.motor, operation.load
        turning = free_speed(
            lambda speed: _torque(motor, speed),
            lambda speed: operation.torque if load is None else _torque(load, speed),
            train_inertia(case, rotors),
            start=run.line[1][0],
            duration=run.duration,
            nominal=nominal,
        )
    elif run is not None:
        times, speeds = (np.array(part) for part in run.line)
        turning = SpeedProfile(times, speeds / nominal)
    torques: list[AnyTorque] = []
    if turning is not None and run is not None and run.free and operation.load is not None:
        values = np.array([_torque(operation.load, rate * nominal) for rate in turning.rates])
        torques += [_history(share, turning.times, values) for share in shares]
    else:
        torques += applied_torques(case)
    if run is not None and run.free:
        torques += _slopes(case, shares)
    torques += _variations(case, shares)
    drives = [Drive(shares[0].rotor, shares[0].at)] if shares else []
    # The nominal speed is among those at which the machine is assembled.
    rates = np.array([1.0, *(() if turning is None else turning.rates)])
    return CaseDriving(
        torques,
        drives,
        (float(rates.min()), float(rates.max())),
        None if operation.base is None else operation.base.build(),
        operation.gravity,
        turning,
    )


def train_inertia(case: Case, rotors: Sequence[RotorComponent]) -> float:
    """Polar inertia of the train, reduced to the first driver's rotor [kg m²]."""
    ratios = speed_ratios(case)
    shares = applied_torques(case, 1.0)
    rotating = set(ratios) if case.gear_pair else {shares[0].rotor}
    inertias = {rotor.name: float(np.sum(rotor.turning**2)) for rotor in rotors}
    first = float(ratios[shares[0].rotor])
    return sum(inertias[name] * (float(ratios[name]) / first) ** 2 for name in inertias if name in rotating)


def _torque(line: TorqueLine, speed: float) -> float:
    return float(np.interp(speed, line.speed, line.torque))


def _history(share: Torque, times: FloatArray, values: FloatArray) -> TorqueHistory:
    return TorqueHistory(share.rotor, share.at, times, share.value * values)


def _slopes(case: Case, shares: Sequence[Torque]) -> Iterator[TorqueSlope]:
    """Slopes of the motor's and the load's torques over the deviation of a shaft from its nominal rotation.

    A line's torque T(ω) at the first driver stands for ±T share on a rotor of r times the speed, which changes by
    ±T' share / |r| with the rotor's own speed: the motor's with the turning, the load's against it.
    """
    operation = case.operation
    assert operation is not None
    ratios = speed_ratios(case)
    first = abs(float(ratios[shares[0].rotor]))
    for number, share in enumerate(shares):
        line = operation.load if number else operation.motor
        if line is None:
            continue
        rates, slopes = _slope_table(line, abs(operation.speed))
        sense = 1.0 if number == 0 else -1.0
        factor = sense * abs(share.value) * first / abs(float(ratios[share.rotor]))
        name = f"load on {share.rotor}, {number}" if number else "motor"
        yield TorqueSlope(name, share.rotor, share.at, rates, factor * slopes)


def _slope_table(line: TorqueLine, nominal: float) -> tuple[FloatArray, FloatArray]:
    """dT/dω of a line of straight pieces, level beyond its ends, on both sides of every corner."""
    corners = np.array(line.speed) / nominal
    steps = np.concatenate([[0.0], np.diff(line.torque) / np.diff(line.speed), [0.0]])
    hair = min(_SLOPE_STEP, 0.25 * float(np.diff(corners).min()))
    return np.column_stack([corners - hair, corners + hair]).ravel(), np.repeat(steps, 2)[1:-1]


def _variations(case: Case, shares: Sequence[Torque]) -> Iterator[AnyTorque]:
    """Histories added to the torques and ripple about them, each in the sense of its torque."""
    operation = case.operation
    assert operation is not None
    if shares:
        entering, leaving = shares[0], shares[1:]
    else:
        turning = math.copysign(1.0, operation.speed)
        entering, leaving = Torque(case.rotor[0].name, operation.at or 0.0, turning), ()
    own = [output.over_time for output in operation.output]
    if operation.over_time is not None:
        yield operation.over_time.build(entering.rotor, entering.at, math.copysign(1.0, entering.value))
        if not any(own):
            yield from (operation.over_time.build(share.rotor, share.at, share.value) for share in leaving)
    yield from (ripple.build(entering.rotor, entering.at, entering.value) for ripple in operation.ripple)
    for output, share in zip(operation.output, leaving, strict=False):
        if output.over_time is not None:
            yield output.over_time.build(share.rotor, share.at, math.copysign(1.0, share.value))
        yield from (ripple.build(share.rotor, share.at, share.value) for ripple in output.ripple)
