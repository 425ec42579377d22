"""Rotors of a case, each alone: modes at rest, whirl at speed, critical speeds, static deflection and responses.

The response to unbalance and bow follows the speeds and probes of `[rotor_analysis]`, the torsional response to
alternating torques those of `[rotor_analysis.torsional_response]`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from gearwhine.case import (
    Case,
    Probe,
    RotorAnalysis,
    TorsionalAnalysis,
    TorsionProbe,
    campbell_speeds,
    require,
    response_speeds,
    table_range,
    whirl_speeds,
)
from gearwhine.case import Rotor as GivenRotor
from gearwhine.from_case.machine import rotor_bearings
from gearwhine.from_case.rotors import build_rotor
from gearwhine.numerics.progress import Progress, silent
from gearwhine.output import file_stems
from gearwhine.rotors import (
    AxisSpring,
    Bearing,
    Campbell,
    Coupling,
    IncompleteModesError,
    Rotor,
    RotorError,
    WhirlModes,
    WhirlSolver,
    critical_speeds,
    rest_frequencies,
    solve_axial_modes,
    solve_lateral_modes,
    solve_torsional_modes,
    static_deflection,
    torsional_response,
    unbalance_response,
    write_ross,
)
from gearwhine.rotors import campbell as rotor_campbell
from gearwhine.rotors.analyses.campbell import Crossing
from gearwhine.rotors.analyses.critical_speeds import CriticalSpeedMap, CriticalSpeeds, critical_speed_map
from gearwhine.rotors.analyses.harmonic_response import at_positive_frequency, orbit_of
from gearwhine.rotors.analyses.rest_frequencies import RestFrequencies
from gearwhine.rotors.analyses.statics import StaticDeflection, StaticForce
from gearwhine.rotors.analyses.torsional_response import Torque, TorsionalDashpot, TorsionalResponse
from gearwhine.rotors.analyses.unbalance import SynchronousResponse
from gearwhine.rotors.modes.lateral import LateralModes
from gearwhine.rotors.modes.torsional_and_axial import TorsionalModes
from gearwhine.rotors.rolling_bearings import RollingState
from gearwhine.rotors.rolling_bearings.rated_life import BearingLife
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_DEFLECTION_PLACES = 201  # places along a rotor at which its static deflection is given

_TWO_PI = 2.0 * np.pi
_STEPS = 400  # frequencies, where the case gives none
_MODES, _BEYOND = 3, 1.25  # number of the elastic mode that ends the frequencies, and factor on its frequency
_RIGID_ROTOR_FREQUENCY = 1000.0 * _TWO_PI  # highest frequency for a rotor that has no elastic mode [rad/s]
_TORQUE_PLACES = 201  # places along a rotor at which its torque is computed
Bearings = tuple[Bearing, ...]
Crossings = tuple[Crossing, ...] | str
_PLACES = 101  # places along a rotor at which its shapes are given


@dataclass(frozen=True)
class SolvedWeight:
    """A rotor in its bearings under gravity and constant forces.

    Attributes
    ----------
    forces : tuple of StaticForce
        Constant forces on the shaft.
    deflection : StaticDeflection
    speed : float
        Speed at which tables over speed are read [rad/s].
    places : ndarray, shape (p,)
        Places evenly along the shaft, and every station [m].
    displacement : ndarray, shape (2, p)
        Displacement along x and y [m].
    """

    forces: tuple[StaticForce, ...]
    deflection: StaticDeflection
    speed: float
    places: FloatArray
    displacement: FloatArray

    @property
    def largest(self) -> tuple[float, float]:
        """Largest deflection and its place along the shaft [m]."""
        sag = np.hypot(*self.displacement)
        lowest = int(sag.argmax())
        return float(sag[lowest]), float(self.places[lowest])


@dataclass(frozen=True)
class ProbeReading:
    """Response at a probe over the speeds.

    Attributes
    ----------
    probe : Probe
    speeds : ndarray, shape (b,)
        Speeds of the rotor [rad/s].
    amplitude : ndarray of complex, shape (b,)
        Reading Re(amplitude e^{i|Ω|t}) along the probe's angle, run-out included; t from where the mark passes x [m].
    major_axis : ndarray, shape (b,)
        Half the length of the orbit that is read there [m].
    """

    probe: Probe
    speeds: FloatArray
    amplitude: ComplexArray
    major_axis: FloatArray

    @property
    def phase_lag(self) -> FloatArray:
        """Phase lag of the reading behind the rotor's mark, from 0 to 2π, (b,) [rad]."""
        return np.asarray(np.mod(-np.angle(self.amplitude), 2.0 * np.pi))

    @property
    def largest(self) -> tuple[float, float]:
        """Largest reading [m] and its speed [rad/s]."""
        sizes = np.abs(self.amplitude)
        highest = int(sizes.argmax())
        return float(sizes[highest]), float(self.speeds[highest])


@dataclass(frozen=True)
class SolvedResponse:
    """Synchronous response to unbalance and bow.

    Attributes
    ----------
    response : SynchronousResponse
    readings, at_operation : tuple of ProbeReading
        Readings of every probe over the speeds of the response, and at the speed of operation; empty without operation.
    """

    response: SynchronousResponse
    readings: tuple[ProbeReading, ...]
    at_operation: tuple[ProbeReading, ...]


def solve_weight(
    analysis: RotorAnalysis,
    rotor: Rotor,
    bearings: tuple[Bearing, ...],
    speed: float,
    forces: tuple[StaticForce, ...] = (),
) -> SolvedWeight | str:
    """Deflection and bearing loads under gravity and constant forces, or why there are none.

    A free rotor falls, but may well whirl. ``speed`` [rad/s] is where tables over speed are read.
    """
    try:
        deflection = static_deflection(rotor, bearings, forces, gravity=analysis.gravity, speed=speed)
    except RotorError as error:
        return str(error)
    places = np.union1d(np.linspace(0.0, rotor.length, _DEFLECTION_PLACES), rotor.stations)
    return SolvedWeight(forces, deflection, speed, places, deflection.evaluate(places)[:2])


def solve_response(
    case: Case,
    analysis: RotorAnalysis,
    table: GivenRotor,
    rotor: Rotor,
    bearings: tuple[Bearing, ...],
    operation: float | None,
    *,
    held: bool,
) -> SolvedResponse | None:
    """Response to unbalance and bow over speed; None without either, or without a speed.

    A rotor that is not ``held`` has no answer at rest, which is left out.
    """
    speeds = [speed for speed in response_speeds(case, table.name) if speed or held]
    if not (table.unbalance or table.bow) or not speeds:
        return None
    unbalances, bow = table.build_unbalance(), table.build_bow()
    response = unbalance_response(rotor, bearings, unbalances, speeds, bow=bow)
    probes = _probes(case, analysis, table)
    at_operation: tuple[ProbeReading, ...] = ()
    if operation:
        once = unbalance_response(rotor, bearings, unbalances, [operation], bow=bow)
        at_operation = tuple(_read(once, probe) for probe in probes)
    return SolvedResponse(response, tuple(_read(response, probe) for probe in probes), at_operation)


def _read(response: SynchronousResponse, probe: Probe) -> ProbeReading:
    x, y = (part[:, 0] for part in response.reading([probe.at]))
    along = x * np.cos(probe.angle) + y * np.sin(probe.angle)
    reading = at_positive_frequency(along, response.frequencies)
    return ProbeReading(probe, response.speeds, reading, orbit_of(x, y, response.frequencies).major)


def _probes(case: Case, analysis: RotorAnalysis, table: GivenRotor) -> list[Probe]:
    """Return the probes of one rotor; where the case names none, one at each bearing and unbalance, along x."""
    chosen = analysis.unbalance_response.probes
    if chosen:
        return [probe for probe in chosen if probe.rotor == table.name]
    places = {bearing.at: bearing.name for bearing in case.bearing if bearing.rotor == table.name}
    for number, unbalance in enumerate(table.unbalance, start=1):
        places.setdefault(unbalance.at, f"unbalance {number}")
    return [Probe(name=name, rotor=table.name, at=at) for at, name in sorted(places.items())]


@dataclass(frozen=True)
class TorsionReading:
    """Torsional response at a probe over the frequencies, Re(amplitude e^{iωt}) each.

    Attributes
    ----------
    probe : TorsionProbe
    frequencies : ndarray, shape (b,)
        Frequencies [rad/s].
    angle, torque : ndarray of complex, shape (b,)
        Angle about the axis [rad], and torque in the shaft to the right of the probe, at the right end to its left
        [N m].
    """

    probe: TorsionProbe
    frequencies: FloatArray
    angle: ComplexArray
    torque: ComplexArray

    @property
    def largest_angle(self) -> tuple[float, float]:
        """Largest angle [rad] and its frequency [rad/s]."""
        return _largest(self.angle, self.frequencies)

    @property
    def largest_torque(self) -> tuple[float, float]:
        """Largest torque [N m] and its frequency [rad/s]."""
        return _largest(self.torque, self.frequencies)


def _largest(amplitude: ComplexArray, frequencies: FloatArray) -> tuple[float, float]:
    sizes = np.abs(amplitude)
    highest = int(sizes.argmax())
    return float(sizes[highest]), float(frequencies[highest])


@dataclass(frozen=True)
class SolvedTorsion:
    """Steady torsional response of one rotor.

    Attributes
    ----------
    response : TorsionalResponse
    readings : tuple of TorsionReading
    places : ndarray, shape (p,)
        Places along the shaft [m].
    largest_torque : ndarray, shape (p,)
        Largest torque in the shaft there over all frequencies, zero to peak [N m].
    worst_frequency : ndarray, shape (p,)
        Frequency of that torque [rad/s].
    """

    response: TorsionalResponse
    readings: tuple[TorsionReading, ...]
    places: FloatArray
    largest_torque: FloatArray
    worst_frequency: FloatArray

    @property
    def worst(self) -> tuple[float, float, float]:
        """Largest torque of the whole shaft [N m], its place [m] and its frequency [rad/s]."""
        place = int(self.largest_torque.argmax())
        return float(self.largest_torque[place]), float(self.places[place]), float(self.worst_frequency[place])


def solve_torsion(
    analysis: RotorAnalysis, table: GivenRotor, rotor: Rotor, modes: TorsionalModes
) -> SolvedTorsion | None:
    """Solve the torsional response of one rotor; None without a torque. ``modes`` are its own, free to turn."""
    settings = analysis.torsional_response
    torques = [] if settings is None else [torque for torque in settings.torques if torque.rotor == table.name]
    if settings is None or not torques:
        return None
    springs = [spring for spring in settings.springs if spring.rotor == table.name]
    ratio = table.damping_ratio if settings.damping_ratio is None else settings.damping_ratio
    response = torsional_response(
        rotor,
        [Torque(torque.at, torque.amplitude * np.exp(1j * torque.phase)) for torque in torques],
        _frequencies(settings, modes, damped=ratio > 0.0),
        springs=[AxisSpring(spring.at, spring.stiffness) for spring in springs if spring.stiffness > 0.0],
        dashpots=[TorsionalDashpot(spring.at, spring.damping) for spring in springs if spring.damping > 0.0],
        damping_ratio=ratio,
    )
    probes = _torsion_probes(settings, table, rotor)
    angles, carried = (read([probe.at for probe in probes]) for read in (response.angle, response.torque))
    places = np.union1d(np.linspace(0.0, rotor.length, _TORQUE_PLACES), rotor.stations)
    sizes = np.abs(response.torque(places))
    highest = sizes.argmax(axis=0)
    return SolvedTorsion(
        response,
        tuple(
            TorsionReading(probe, response.frequencies, angles[:, k], carried[:, k]) for k, probe in enumerate(probes)
        ),
        places,
        sizes.max(axis=0),
        response.frequencies[highest],
    )


def _frequencies(settings: TorsionalAnalysis, modes: TorsionalModes, *, damped: bool) -> FloatArray:
    """Return given frequencies, or even steps beyond the third elastic mode, with the modes' own where damped."""
    if settings.frequency is not None:
        return _TWO_PI * np.array(settings.frequency.frequencies)
    elastic = modes.frequencies[modes.frequencies > 0.0][:_MODES]
    highest = _BEYOND * float(elastic[-1]) if elastic.size else _RIGID_ROTOR_FREQUENCY
    steps = highest * np.arange(1, _STEPS + 1) / _STEPS
    return np.union1d(steps, elastic) if damped else steps


def _torsion_probes(settings: TorsionalAnalysis, table: GivenRotor, rotor: Rotor) -> list[TorsionProbe]:
    """Return the probes of one rotor; where the case names none, one at each torque and at either end."""
    if settings.probes:
        return [probe for probe in settings.probes if probe.rotor == table.name]
    places = {0.0: "left end", rotor.length: "right end"}
    for number, torque in enumerate((entry for entry in settings.torques if entry.rotor == table.name), start=1):
        places[torque.at] = f"torque {number}"
    return [TorsionProbe(name=name, rotor=table.name, at=at) for at, name in sorted(places.items())]


@dataclass(frozen=True)
class SolvedRotor:
    """A solved rotor on grounded bearings.

    Attributes
    ----------
    rotor : gearwhine.rotors.Rotor
        Rotor with its gears as discs.
    bearings, resting : tuple of gearwhine.rotors.Bearing
        Bearings with their tables over speed, and as they hold the rotor at rest.
    rest_speed : float or None
        Speed that stands for rest, the lowest that all their tables hold [rad/s]; None without tables.
    rest : RestFrequencies
    axial : ndarray, shape (a,)
        Natural frequencies at rest of motions along the axis, ascending [rad/s]; none where no bearing holds it.
    lateral : LateralModes
        Modes in one plane at averaged support stiffness.
    torsional : TorsionalModes
    whirl : tuple of gearwhine.rotors.WhirlModes
        Whirl modes at the speed of operation, then at those of the sweep.
    campbell : gearwhine.rotors.Campbell or None
        Campbell diagram; None without speeds.
    crossings : tuple of Crossing or str
        Damped critical speeds of whirl within the Campbell diagram, of once a revolution; or why they are not known.
    orders : mapping of float to (tuple of Crossing or str)
        Damped critical speeds of each other multiple of the speed that the case asks for.
    critical : CriticalSpeeds
        Undamped critical speeds of whirl; with tables, within the speeds that they hold.
    operation : float or None
        Speed of operation [rad/s].
    weight : SolvedWeight or str
        Deflection under gravity and constant forces at operation, else at rest; or why there is none.
    response : SolvedResponse or None
        Response to unbalance and bow; None where there is neither.
    torsion : SolvedTorsion or None
        Response to alternating torques; None without any.
    stiffness_map : CriticalSpeedMap or None
        Critical-speed map, where the case asks for it.
    rolling : mapping of str to gearwhine.rotors.rolling_bearings.RollingState
        States of its rolling bearings under load, by name.
    lives : mapping of str to BearingLife
        Ratings and lives of its rolling bearings, by name.
    """

    rotor: Rotor
    bearings: Bearings
    resting: Bearings
    rest_speed: float | None
    rest: RestFrequencies
    axial: FloatArray
    lateral: LateralModes
    torsional: TorsionalModes
    whirl: tuple[WhirlModes, ...]
    campbell: Campbell | None
    crossings: Crossings
    orders: Mapping[float, Crossings]
    critical: CriticalSpeeds
    operation: float | None
    weight: SolvedWeight | str
    response: SolvedResponse | None
    torsion: SolvedTorsion | None
    stiffness_map: CriticalSpeedMap | None
    rolling: Mapping[str, RollingState]
    lives: Mapping[str, BearingLife]

    @property
    def lateral_at_rest(self) -> npt.NDArray[np.bool_]:
        """Mask of the frequencies at rest whose motions are across the axis for the most part."""
        return np.asarray(self.rest.axial_share <= MOSTLY_AXIAL)

    @property
    def margins(self) -> FloatArray | None:
        """Distance of each critical speed from operation, as a part of that; None where nothing turns."""
        return None if not self.operation else self.critical.speeds / abs(self.operation) - 1.0

    @property
    def places(self) -> FloatArray:
        """Evenly along the shaft from its left end, for shapes [m]."""
        return np.linspace(0.0, self.rotor.length, _PLACES)

    @property
    def whirl_deflection(self) -> FloatArray | None:
        """Largest deflection over a cycle of each whirl mode at operation along :attr:`places` [m/√kg]."""
        return None if self.operation is None else _largest_over_cycle(*self.whirl[0].evaluate(self.places))

    @property
    def whirl_moment(self) -> FloatArray | None:
        """Largest bending moment over a cycle of each whirl mode at operation along :attr:`places` [N/√kg]."""
        return None if self.operation is None else _largest_over_cycle(*self.whirl[0].section_loads(self.places)[1])

    @property
    def damps_across(self) -> bool:
        """Whether a coupling damps motion across the axis, which it does in the turning shaft."""
        couplings = [part for part in self.rotor.segments if isinstance(part, Coupling)]
        return any(part.lateral_damping > 0.0 or part.tilt_damping > 0.0 for part in couplings)


def _largest_over_cycle(x: ComplexArray, y: ComplexArray) -> FloatArray:
    return orbit_of(x, y, np.ones(1)).major


def solve_rotors(case: Case, progress: Progress = silent) -> tuple[SolvedRotor, ...]:
    """Solve every rotor of the case, alone on grounded bearings.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError
        Where the case has no rotors, or one cannot be solved as it stands.
    """
    require(case, "rotor", command="rotors")
    analysis = case.rotor_analysis or RotorAnalysis()
    built = rotor_bearings(case)
    solved = []
    for table in case.rotor:
        progress(f"rotor {table.name}")
        rotor, (bearings, rolling) = build_rotor(case, table), built[table.name]
        lowest, _ = table_range(case, table.name)
        resting = tuple(bearing.at_speed(lowest) for bearing in bearings)
        speeds = whirl_speeds(case, table.name)
        operation = speeds[0] if case.operation is not None else None
        reference = lowest if operation is None else operation
        weight = solve_weight(analysis, rotor, bearings, reference, _constant_forces(case, table.name))
        progress(f"rotor {table.name}: whirl over speed")
        diagram = campbell_speeds(case, table.name)
        solver = WhirlSolver(rotor, bearings)
        campbell = rotor_campbell(rotor, bearings, diagram, count=analysis.modes, solver=solver) if diagram else None
        stands = not isinstance(weight, str)
        rest = rest_frequencies(rotor, resting, count=analysis.modes)
        torsional = solve_torsional_modes(rotor)
        solved.append(
            SolvedRotor(
                rotor=rotor,
                bearings=bearings,
                resting=resting,
                rest_speed=lowest if any(bearing.speeds is not None for bearing in bearings) else None,
                rest=rest,
                axial=_axial_frequencies(rotor, resting, rest),
                lateral=solve_lateral_modes(rotor, [bearing.mean_support for bearing in resting]),
                torsional=torsional,
                whirl=tuple(solver.modes(speed, count=analysis.modes) for speed in speeds),
                campbell=campbell,
                crossings=() if campbell is None else _crossings(campbell),
                orders={}
                if campbell is None
                else {order: _crossings(campbell, order) for order in sorted(set(analysis.orders) - {1.0})},
                critical=critical_speeds(rotor, bearings, count=analysis.modes).lateral,
                operation=operation,
                weight=weight,
                response=solve_response(case, analysis, table, rotor, bearings, operation, held=stands),
                torsion=solve_torsion(analysis, table, rotor, torsional),
                stiffness_map=_stiffness_map(analysis, rotor, bearings),
                rolling=rolling,
                lives={name: BearingLife(state, operation) for name, state in rolling.items()},
            )
        )
    return tuple(solved)


def _constant_forces(case: Case, rotor: str) -> tuple[StaticForce, ...]:
    """Return the constant forces of the operation on a rotor; those of its gears are not among them."""
    forces = () if case.operation is None else case.operation.force
    return tuple(StaticForce(force.at, force.x, force.y, force.z) for force in forces if force.rotor == rotor)


def _axial_frequencies(rotor: Rotor, resting: Bearings, rest: RestFrequencies) -> FloatArray:
    """Natural frequencies along the axis: of those at rest where bearings tie it to the planes, else the rod's own."""
    along = rest.axial_share > MOSTLY_AXIAL
    if along.any():
        return rest.frequencies[along]
    springs = [AxisSpring(bearing.at, float(bearing.spatial_stiffness[2, 2])) for bearing in resting]
    springs = [spring for spring in springs if spring.stiffness > 0.0]
    # Up to the highest bending frequency listed beside it.
    limit = float(rest.frequencies.max(initial=0.0))
    if not springs or not limit:
        return np.zeros(0)
    return solve_axial_modes(rotor, springs, frequency_limit=limit).frequencies


def _stiffness_map(analysis: RotorAnalysis, rotor: Rotor, bearings: Bearings) -> CriticalSpeedMap | None:
    """Critical speeds over the stiffness of all bearings, where the case asks for them and there are any."""
    settings = analysis.stiffness_map
    if settings is None or not bearings:
        return None
    direction = 1 if settings.whirl == "forward" else -1
    return critical_speed_map(rotor, bearings, settings.stiffnesses, count=settings.modes, direction=direction)


def _crossings(campbell: Campbell, order: float = 1.0) -> Crossings:
    """Damped critical speeds; a diagram of few speeds may not separate them, which is no reason to show nothing.

    Motions that are for the most part along the axis are left out: no unbalance drives them.
    """
    if campbell.speeds.size < 2:
        return "a Campbell diagram at one speed has no crossings; expected two or more different speeds"
    try:
        return tuple(crossing for crossing in campbell.crossings(order) if crossing.axial_share <= MOSTLY_AXIAL)
    except IncompleteModesError as error:
        return str(error)


def write_ross_files(folder: Path, solved: tuple[SolvedRotor, ...]) -> tuple[str, ...]:
    """Write every rotor as ``<name>.ross.toml``, and return remarks on parts that ROSS cannot hold."""
    remarks: list[str] = []
    for rotor, stem in zip(solved, file_stems([rotor.rotor.name for rotor in solved]), strict=True):
        remarks += write_ross(folder / f"{stem}.ross.toml", rotor.rotor, rotor.bearings)
    return tuple(remarks)
