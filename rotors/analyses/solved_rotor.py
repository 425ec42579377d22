"""Rotor alone: modes at rest, whirl at speed, critical speeds, static deflection and responses, by one call.

Which of them, and at which speeds, frequencies and probes, stands in :class:`RotorSettings`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.findings import (
    Choice,
    Instance,
    Number,
    Numbers,
    Rule,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples
from gearwhine.numerics.progress import Progress, silent
from gearwhine.rotors.analyses.campbell import Campbell, Crossing, campbell
from gearwhine.rotors.analyses.critical_speeds import (
    CriticalSpeedMap,
    CriticalSpeeds,
    critical_speed_map,
    critical_speeds,
)
from gearwhine.rotors.analyses.harmonic_response import at_positive_frequency, orbit_of
from gearwhine.rotors.analyses.rest_frequencies import RestFrequencies, rest_frequencies
from gearwhine.rotors.analyses.statics import STANDARD_GRAVITY, StaticDeflection, StaticForce, static_deflection
from gearwhine.rotors.analyses.torsional_response import (
    Torque,
    TorsionalDashpot,
    TorsionalResponse,
    torsional_response,
)
from gearwhine.rotors.analyses.unbalance import SynchronousResponse, unbalance_response
from gearwhine.rotors.errors import IncompleteModesError, RotorError
from gearwhine.rotors.model.bearing import AxisSpring, Bearing
from gearwhine.rotors.model.loads import Bow, Unbalance
from gearwhine.rotors.model.segment import Coupling
from gearwhine.rotors.model.shaft import Rotor
from gearwhine.rotors.modes.lateral import LateralModes, solve_lateral_modes
from gearwhine.rotors.modes.torsional_and_axial import TorsionalModes, solve_axial_modes, solve_torsional_modes
from gearwhine.rotors.rolling_bearings import RollingState
from gearwhine.rotors.rolling_bearings.rated_life import BearingLife
from gearwhine.rotors.whirl.whirl_modes import MOSTLY_AXIAL, WhirlModes, WhirlSolver

_DEFLECTION_PLACES = 201  # places along a rotor at which its static deflection is given

_STEPS = 400  # frequencies, where none are given
_MODES, _BEYOND = 3, 1.25  # number of the elastic mode that ends the frequencies, and factor on its frequency
_RIGID_ROTOR_FREQUENCY = 2000.0 * np.pi  # highest frequency for a rotor that has no elastic mode [rad/s]
_TORQUE_PLACES = 201  # places along a rotor at which its torque is computed
Bearings = tuple[Bearing, ...]
Crossings = tuple[Crossing, ...] | str
_PLACES = 101  # places along a rotor at which its shapes are given


@dataclass(frozen=True)
class Probe:
    """A station of a rotor at which a response is read.

    Attributes
    ----------
    name : str
    at : float
        Position from the rotor's left end [m].
    angle : float
        Direction in which a displacement is measured, from x [rad].
    """

    name: str
    at: float
    angle: float = 0.0

    def __post_init__(self) -> None:
        """Check that position and angle are finite."""
        rules: dict[str, Rule] = {"at": Number(at_least=0.0, unit="m"), "angle": Number(unit="rad")}
        refuse(attribute_findings(("probe", self.name), self, **rules), RotorError)


@dataclass(frozen=True)
class TorsionalExcitation:
    """Torques that swing a rotor about its axis, and what it is held by then.

    Attributes
    ----------
    torques : sequence of Torque
    damping_ratio : float
        Damping ratio of the shaft.
    frequencies : sequence of float, optional
        Frequencies of the torques [rad/s]; by default up to 1.25 times the third elastic mode, in 400 steps and, where
        the shaft is damped, at the modes.
    springs : sequence of AxisSpring
        Springs between shaft and ground [N m/rad].
    dashpots : sequence of TorsionalDashpot
    probes : sequence of Probe, optional
        Stations at which angle and torque are read; by default one at each torque and one at either end.
    """

    torques: Sequence[Torque]
    damping_ratio: float = 0.0
    frequencies: Sequence[float] | None = None
    springs: Sequence[AxisSpring] = ()
    dashpots: Sequence[TorsionalDashpot] = ()
    probes: Sequence[Probe] | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check the torques."""
        keep_tuples(self, "torques", "springs", "dashpots")
        part = ("torsional excitation", "")
        kinds = kind_findings(part, self, torques=Torque, springs=AxisSpring, dashpots=TorsionalDashpot)
        refuse([*kinds], RotorError)


@dataclass(frozen=True)
class StiffnessRange:
    """Bearing stiffnesses of a map of critical speeds.

    Attributes
    ----------
    stiffnesses : sequence of float
        Stiffness of every bearing, alike in all directions [N/m].
    count : int
        Number of critical speeds at each.
    whirl : str
        Direction of whirl, ``"forward"`` or ``"backward"``.
    """

    stiffnesses: Sequence[float]
    count: int = 4
    whirl: str = "forward"

    def __post_init__(self) -> None:
        """Keep own copies, and check them."""
        keep_tuples(self, "stiffnesses")
        rules: dict[str, Rule] = {
            "stiffnesses": Numbers(each=Number(above=0.0, unit="N/m")),
            "count": Number(at_least=1, whole=True),
            "whirl": Choice(("forward", "backward")),
        }
        refuse(attribute_findings(("stiffness range", ""), self, **rules), RotorError)


@dataclass(frozen=True)
class RotorSettings:
    """Loads of a rotor, and the speeds and probes of its analyses. Speeds are signed, those of the rotor [rad/s].

    Attributes
    ----------
    operation : float or None
        Speed of operation [rad/s]; None for a rotor without one.
    whirl_speeds : sequence of float
        Further speeds at which the whirl modes are solved.
    diagram_speeds : sequence of float
        Speeds of the Campbell diagram, ascending; none draws no diagram.
    response_speeds : sequence of float
        Speeds of the response to unbalance and bow.
    mode_count : int, optional
        Number of lateral modes; by default 12, or all of a small lumped rotor.
    orders : sequence of float
        Multiples of the speed, beside 1, at which the Campbell diagram has critical speeds.
    gravity : sequence of float
        Acceleration along x, y, z of the static deflection [m/s²].
    forces : sequence of StaticForce
        Constant forces.
    unbalances : sequence of Unbalance
    bow : Bow, optional
    probes : sequence of Probe, optional
        Probes of the response; by default one at each bearing and each unbalance, along x.
    torsion : TorsionalExcitation, optional
    stiffness_map : StiffnessRange, optional
    """

    operation: float | None = None
    whirl_speeds: Sequence[float] = ()
    diagram_speeds: Sequence[float] = ()
    response_speeds: Sequence[float] = ()
    mode_count: int | None = None
    orders: Sequence[float] = ()
    gravity: Sequence[float] = STANDARD_GRAVITY
    forces: Sequence[StaticForce] = ()
    unbalances: Sequence[Unbalance] = ()
    bow: Bow | None = None
    probes: Sequence[Probe] | None = None
    torsion: TorsionalExcitation | None = None
    stiffness_map: StiffnessRange | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check every number."""
        kinds = {"forces": StaticForce, "unbalances": Unbalance}
        keep_tuples(self, "whirl_speeds", "diagram_speeds", "response_speeds", "orders", "gravity", *kinds)
        speed = Number(unit="rad/s")
        rules: dict[str, Rule] = {
            "operation": Number(unit="rad/s", optional=True),
            "whirl_speeds": Numbers(each=speed),
            "diagram_speeds": Numbers(each=speed),
            "response_speeds": Numbers(each=speed),
            "mode_count": Number(at_least=1, whole=True, optional=True),
            "orders": Numbers(each=Number(above=0.0)),
            "gravity": Numbers(3, Number(unit="m/s²")),
            "bow": Instance(Bow, "a bow, or None", optional=True),
            "torsion": Instance(TorsionalExcitation, "a torsional excitation, or None", optional=True),
            "stiffness_map": Instance(StiffnessRange, "a range of stiffnesses, or None", optional=True),
        }
        part = ("rotor settings", "")
        refuse([*attribute_findings(part, self, **rules), *kind_findings(part, self, **kinds)], RotorError)


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
        Places from the rotor's left end, evenly along the shaft, and every station [m].
    displacement : ndarray, shape (2, p)
        Deflection of the shaft under its weight along x and y [m].
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
    rotor : str
        Name of the rotor.
    probe : Probe
    speeds : ndarray, shape (b,)
        Speeds of the rotor [rad/s].
    amplitude : ndarray of complex, shape (b,)
        Reading Re(amplitude e^{i|Ω|t}) along the probe's angle, run-out included; t from where the mark passes x [m].
    major_axis : ndarray, shape (b,)
        Half the length of the orbit that is read there [m].
    """

    rotor: str
    probe: Probe
    speeds: FloatArray
    amplitude: ComplexArray
    major_axis: FloatArray

    @property
    def label(self) -> str:
        """Names of rotor and probe."""
        return f"{self.rotor}: {self.probe.name}"

    @property
    def size(self) -> FloatArray:
        """Reading of the probe, zero to peak [m], shape (b,)."""
        return np.asarray(np.abs(self.amplitude))

    @property
    def phase_lag(self) -> FloatArray:
        """Phase lag of the reading behind the rotor's mark, from 0 to 2π [rad], shape (b,)."""
        return np.asarray(np.mod(-np.angle(self.amplitude), 2.0 * np.pi))

    @property
    def largest(self) -> tuple[float, float]:
        """Largest reading [m] and its speed [rad/s]."""
        highest = int(self.size.argmax())
        return float(self.size[highest]), float(self.speeds[highest])


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


def _solve_weight(rotor: Rotor, bearings: Bearings, settings: RotorSettings, speed: float) -> SolvedWeight | str:
    """Deflection and bearing loads under gravity and constant forces, or why there are none.

    A free rotor falls, but may well whirl. ``speed`` [rad/s] is where tables over speed are read.
    """
    try:
        deflection = static_deflection(rotor, bearings, settings.forces, gravity=settings.gravity, speed=speed)
    except RotorError as error:
        return str(error)
    places = np.union1d(np.linspace(0.0, rotor.length, _DEFLECTION_PLACES), rotor.stations)
    return SolvedWeight(tuple(settings.forces), deflection, speed, places, deflection.evaluate(places)[:2])


def _solve_response(rotor: Rotor, bearings: Bearings, settings: RotorSettings, *, held: bool) -> SolvedResponse | None:
    """Response to unbalance and bow over speed; None without either, or without a speed.

    A rotor that is not ``held`` has no answer at rest, which is left out.
    """
    speeds = [speed for speed in settings.response_speeds if speed or held]
    if not (settings.unbalances or settings.bow is not None) or not speeds:
        return None
    response = unbalance_response(rotor, bearings, settings.unbalances, speeds, bow=settings.bow)
    probes = _probes(bearings, settings)
    at_operation: tuple[ProbeReading, ...] = ()
    if settings.operation:
        once = unbalance_response(rotor, bearings, settings.unbalances, [settings.operation], bow=settings.bow)
        at_operation = tuple(_read(rotor.name, once, probe) for probe in probes)
    return SolvedResponse(response, tuple(_read(rotor.name, response, probe) for probe in probes), at_operation)


def _read(rotor: str, response: SynchronousResponse, probe: Probe) -> ProbeReading:
    x, y = (part[:, 0] for part in response.reading([probe.at]))
    along = x * np.cos(probe.angle) + y * np.sin(probe.angle)
    reading = at_positive_frequency(along, response.frequencies)
    return ProbeReading(rotor, probe, response.speeds, reading, orbit_of(x, y, response.frequencies).major)


def _probes(bearings: Bearings, settings: RotorSettings) -> Sequence[Probe]:
    """Return the probes of the response; where none are named, one at each bearing and unbalance, along x."""
    if settings.probes is not None:
        return settings.probes
    places = {bearing.at: bearing.name for bearing in bearings}
    for number, unbalance in enumerate(settings.unbalances, start=1):
        places.setdefault(unbalance.at, f"unbalance {number}")
    return [Probe(name, at) for at, name in sorted(places.items())]


@dataclass(frozen=True)
class TorsionReading:
    """Torsional response at a probe over the frequencies, Re(amplitude e^{iωt}) each.

    Attributes
    ----------
    rotor : str
        Name of the rotor.
    probe : Probe
    frequencies : ndarray, shape (b,)
        Frequencies of the torques [rad/s].
    angle, torque : ndarray of complex, shape (b,)
        Angle about the axis [rad], and torque in the shaft to the right of the probe, at the right end to its left
        [N m].
    """

    rotor: str
    probe: Probe
    frequencies: FloatArray
    angle: ComplexArray
    torque: ComplexArray

    @property
    def label(self) -> str:
        """Names of rotor and probe."""
        return f"{self.rotor}: {self.probe.name}"

    @property
    def angle_size(self) -> FloatArray:
        """Angle about the axis, zero to peak [rad], shape (b,)."""
        return np.asarray(np.abs(self.angle))

    @property
    def angle_phase(self) -> FloatArray:
        """Phase of the angle [rad], shape (b,)."""
        return np.asarray(np.angle(self.angle))

    @property
    def torque_size(self) -> FloatArray:
        """Torque in the shaft, zero to peak [N m], shape (b,)."""
        return np.asarray(np.abs(self.torque))

    @property
    def torque_phase(self) -> FloatArray:
        """Phase of the torque in the shaft [rad], shape (b,)."""
        return np.asarray(np.angle(self.torque))

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


def _solve_torsion(rotor: Rotor, excitation: TorsionalExcitation | None, modes: TorsionalModes) -> SolvedTorsion | None:
    """Solve the torsional response of a rotor; None without a torque. ``modes`` are its own, free to turn."""
    if excitation is None or not excitation.torques:
        return None
    response = torsional_response(
        rotor,
        excitation.torques,
        _frequencies(excitation, modes),
        springs=excitation.springs,
        dashpots=excitation.dashpots,
        damping_ratio=excitation.damping_ratio,
    )
    probes = _torsion_probes(rotor, excitation)
    angles, carried = (read([probe.at for probe in probes]) for read in (response.angle, response.torque))
    places = np.union1d(np.linspace(0.0, rotor.length, _TORQUE_PLACES), rotor.stations)
    sizes = np.abs(response.torque(places))
    highest = sizes.argmax(axis=0)
    return SolvedTorsion(
        response,
        tuple(
            TorsionReading(rotor.name, probe, response.frequencies, angles[:, k], carried[:, k])
            for k, probe in enumerate(probes)
        ),
        places,
        sizes.max(axis=0),
        response.frequencies[highest],
    )


def _frequencies(excitation: TorsionalExcitation, modes: TorsionalModes) -> FloatArray:
    """Return given frequencies, or even steps beyond the third elastic mode, with the modes' own where damped."""
    if excitation.frequencies is not None:
        return np.array(excitation.frequencies)
    elastic = modes.frequencies[modes.frequencies > 0.0][:_MODES]
    highest = _BEYOND * float(elastic[-1]) if elastic.size else _RIGID_ROTOR_FREQUENCY
    steps = highest * np.arange(1, _STEPS + 1) / _STEPS
    return np.union1d(steps, elastic) if excitation.damping_ratio > 0.0 else steps


def _torsion_probes(rotor: Rotor, excitation: TorsionalExcitation) -> Sequence[Probe]:
    """Return the probes of the torsion; where none are named, one at each torque and at either end."""
    if excitation.probes is not None:
        return excitation.probes
    places = {0.0: "left end", rotor.length: "right end"}
    for number, torque in enumerate(excitation.torques, start=1):
        places[torque.at] = f"torque {number}"
    return [Probe(name, at) for at, name in sorted(places.items())]


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
        Modes in one plane on supports whose stiffness is the mean of both planes'.
    torsional : TorsionalModes
    whirl : tuple of gearwhine.rotors.WhirlModes
        Whirl modes at the speed of operation, then at those of the sweep.
    campbell : gearwhine.rotors.Campbell or None
        Campbell diagram; None without speeds.
    crossings : tuple of Crossing or str
        Damped critical speeds of whirl within the Campbell diagram, of once a revolution; or why they are not known.
    orders : mapping of float to (tuple of Crossing or str)
        Damped critical speeds of each other multiple of the speed that is asked for.
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
        Critical-speed map, where it is asked for.
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
        """Distances from the rotor's left end, evenly along the shaft, for shapes [m]."""
        return np.linspace(0.0, self.rotor.length, _PLACES)

    @property
    def rest_shapes(self) -> FloatArray:
        """Shapes of the modes at rest along x, y and z at :attr:`places`, of unit norm in mass [1/√kg]."""
        return self.rest.evaluate(self.places)

    @property
    def lateral_shapes(self) -> FloatArray:
        """Orthonormal lateral mode shapes at :attr:`places` [1/√kg]."""
        return self.lateral.evaluate(self.places)[0]

    @property
    def torsional_shapes(self) -> FloatArray:
        """Orthonormal torsional mode shapes at :attr:`places` [1/(√kg m)]."""
        return self.torsional.evaluate(self.places)

    @property
    def bending_frequencies(self) -> FloatArray:
        """Natural frequencies of bending at rest, both planes [rad/s]."""
        return np.asarray(self.rest.frequencies[self.lateral_at_rest])

    @property
    def bending_axial_share(self) -> FloatArray:
        """Share of the kinetic energy along the axis in each of them."""
        return np.asarray(self.rest.axial_share[self.lateral_at_rest])

    @property
    def whirl_deflection(self) -> FloatArray | None:
        """Largest deflection over a cycle of the whirl modes at operation, of unit norm in mass [m/√kg]."""
        return None if self.operation is None else _largest_over_cycle(*self.whirl[0].evaluate(self.places))

    @property
    def whirl_moment(self) -> FloatArray | None:
        """Largest bending moment over a cycle of the whirl modes at operation, of unit norm in mass [N/√kg]."""
        return None if self.operation is None else _largest_over_cycle(*self.whirl[0].section_loads(self.places)[1])

    @property
    def damps_across(self) -> bool:
        """Whether a coupling damps motion across the axis, which it does in the turning shaft."""
        couplings = [part for part in self.rotor.segments if isinstance(part, Coupling)]
        return any(part.lateral_damping > 0.0 or part.tilt_damping > 0.0 for part in couplings)


def _largest_over_cycle(x: ComplexArray, y: ComplexArray) -> FloatArray:
    return orbit_of(x, y, np.ones(1)).major


def solve_rotor(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    settings: RotorSettings | None = None,
    *,
    rolling: Mapping[str, RollingState] | None = None,
    bearing_speeds: Mapping[str, float] | None = None,
    progress: Progress = silent,
) -> SolvedRotor:
    """Solve a rotor alone in its bearings, which stand on the ground or on their pedestals.

    Parameters
    ----------
    rotor : Rotor
        Rotor with its gears as discs.
    bearings : sequence of Bearing
    settings : RotorSettings, optional
    rolling : mapping of str to RollingState, optional
        States of its rolling bearings under load, by name, for their lives.
    bearing_speeds : mapping of str to float, optional
        Speed of the rotor against what holds a bearing, by name [rad/s]; by default that of operation.
    progress : callable

    Raises
    ------
    RotorError
        Where it cannot be solved as it stands.
    gearwhine.rotors.IncompleteModesError
        Where modes fail their certificate.
    """
    settings, bearings, rolling = settings or RotorSettings(), tuple(bearings), rolling or {}
    in_seats = bearing_speeds or {}
    count, operation, diagram = settings.mode_count, settings.operation, settings.diagram_speeds
    lowest, _ = table_range(bearings)
    resting = tuple(bearing.at_speed(lowest) for bearing in bearings)
    speeds = (*(() if operation is None else (operation,)), *settings.whirl_speeds)
    weight = _solve_weight(rotor, bearings, settings, lowest if operation is None else operation)
    progress(f"rotor {rotor.name}: whirl over speed")
    solver = WhirlSolver(rotor, bearings)
    over_speed = campbell(rotor, bearings, diagram, count=count, solver=solver) if diagram else None
    rest = rest_frequencies(rotor, resting, count=count)
    torsional = solve_torsional_modes(rotor)
    return SolvedRotor(
        rotor=rotor,
        bearings=bearings,
        resting=resting,
        rest_speed=lowest if any(bearing.speeds is not None for bearing in bearings) else None,
        rest=rest,
        axial=_axial_frequencies(rotor, resting, rest),
        lateral=solve_lateral_modes(rotor, [bearing.mean_support for bearing in resting]),
        torsional=torsional,
        whirl=tuple(solver.modes(speed, count=count) for speed in speeds),
        campbell=over_speed,
        crossings=() if over_speed is None else _crossings(over_speed),
        orders={}
        if over_speed is None
        else {order: _crossings(over_speed, order) for order in sorted(set(settings.orders) - {1.0})},
        critical=critical_speeds(rotor, bearings, count=count).lateral,
        operation=operation,
        weight=weight,
        response=_solve_response(rotor, bearings, settings, held=not isinstance(weight, str)),
        torsion=_solve_torsion(rotor, settings.torsion, torsional),
        stiffness_map=_stiffness_map(rotor, bearings, settings.stiffness_map),
        rolling=rolling,
        lives={name: BearingLife(state, in_seats.get(name, operation)) for name, state in rolling.items()},
    )


def table_range(bearings: Sequence[Bearing]) -> tuple[float, float]:
    """Return the lowest and the highest speed, without sense, that the tables of all bearings hold [rad/s].

    Zero and infinity for bearings without tables.
    """
    tables = [bearing.speeds for bearing in bearings if bearing.speeds is not None]
    lowest = max((float(table[0]) for table in tables), default=0.0)
    return lowest, min((float(table[-1]) for table in tables), default=np.inf)


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


def _stiffness_map(rotor: Rotor, bearings: Bearings, settings: StiffnessRange | None) -> CriticalSpeedMap | None:
    """Critical speeds over the stiffness of all bearings, where they are asked for and there are any."""
    if settings is None or not bearings:
        return None
    direction = 1 if settings.whirl == "forward" else -1
    return critical_speed_map(rotor, bearings, settings.stiffnesses, count=settings.count, direction=direction)


def _crossings(diagram: Campbell, order: float = 1.0) -> Crossings:
    """Damped critical speeds; a diagram of few speeds may not separate them, which is no reason to show nothing.

    Motions that are for the most part along the axis are left out: no unbalance drives them.
    """
    if diagram.speeds.size < 2:
        return "a Campbell diagram at one speed has no crossings; expected two or more different speeds"
    try:
        return tuple(crossing for crossing in diagram.crossings(order) if crossing.axial_share <= MOSTLY_AXIAL)
    except IncompleteModesError as error:
        return str(error)
