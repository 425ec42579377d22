"""The rotors of a case, each alone: modes at rest, whirl at speed, critical speeds, weight, unbalance and bow."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

import rotors as room
from gearwhine.case import Case, RollingStiffness, RotorAnalysis, campbell_speeds, require, table_range, whirl_speeds
from gearwhine.output import file_stems
from gearwhine.progress import Progress, silent
from gearwhine.stages.bearings import build_bearings, rolling_states
from gearwhine.stages.build import build_rotor
from gearwhine.stages.rotor_loads import SolvedResponse, SolvedWeight, solve_response, solve_weight
from gearwhine.stages.torsion import SolvedTorsion, solve_torsion
from rotors.rolling import RollingState
from rotors.rolling.life import rated_revolutions

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Bearings = tuple[room.Bearing, ...]
Crossings = tuple[room.Crossing, ...] | str

_PLACES = 101  # along a rotor, of its shapes


@dataclass(frozen=True)
class SolvedRotor:
    """What is known of one rotor on grounded bearings.

    Attributes
    ----------
    rotor : rotors.Rotor
        With its gears as discs.
    bearings, resting : tuple of rotors.Bearing
        As given, with their tables over speed; and as they hold the rotor at rest.
    rest_speed : float or None
        The speed of their tables that stands for rest, the lowest that all of them hold [rad/s]; None without tables.
    rest : rotors.RestFrequencies
    axial : ndarray, shape (a,)
        Natural frequencies at rest of motions along the axis, ascending [rad/s]; none where no bearing holds it.
    lateral : rotors.LateralModes
        In one plane at averaged support stiffness.
    torsional : rotors.TorsionalModes
    whirl : tuple of rotors.WhirlModes
        At the speed of operation, then at those of the sweep.
    campbell : rotors.Campbell or None
        None without speeds.
    crossings : tuple of rotors.Crossing or str
        Damped critical speeds of whirl within the Campbell diagram, of once a revolution; or why they are not known.
    orders : mapping of float to (tuple of rotors.Crossing or str)
        The same of each other multiple of the speed that the case asks for.
    critical : rotors.CriticalSpeeds
        Undamped, of whirl alone; with tables, within the speeds that they hold.
    operation : float or None
        Speed of operation [rad/s].
    weight : SolvedWeight or str
        Deflection under gravity at operation, else at rest; or why there is none.
    response : SolvedResponse or None
        To unbalance and bow; None where there is neither.
    torsion : SolvedTorsion or None
        Response to torques that swing; None where none does.
    stiffness_map : rotors.CriticalSpeedMap or None
        Where the case asks for it.
    rolling : mapping of str to rotors.rolling.RollingState
        What its rolling bearings carry, by their names.
    lives : mapping of str to float
        Basic rating life of those whose dynamic rating the case gives, as far as it is defined [revolutions].
    """

    rotor: room.Rotor
    bearings: Bearings
    resting: Bearings
    rest_speed: float | None
    rest: room.RestFrequencies
    axial: FloatArray
    lateral: room.LateralModes
    torsional: room.TorsionalModes
    whirl: tuple[room.WhirlModes, ...]
    campbell: room.Campbell | None
    crossings: Crossings
    orders: Mapping[float, Crossings]
    critical: room.CriticalSpeeds
    operation: float | None
    weight: SolvedWeight | str
    response: SolvedResponse | None
    torsion: SolvedTorsion | None
    stiffness_map: room.CriticalSpeedMap | None
    rolling: Mapping[str, RollingState]
    lives: Mapping[str, float]

    @property
    def lateral_at_rest(self) -> npt.NDArray[np.bool_]:
        """Which of the frequencies at rest are of motions across the axis for the most part."""
        return np.asarray(self.rest.axial_share <= room.MOSTLY_AXIAL)

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
        couplings = [part for part in self.rotor.segments if isinstance(part, room.Coupling)]
        return any(part.lateral_damping > 0.0 or part.tilt_damping > 0.0 for part in couplings)


def _largest_over_cycle(x: ComplexArray, y: ComplexArray) -> FloatArray:
    return room.orbit_of(x, y, np.ones(1)).major


def solve_rotors(case: Case, progress: Progress = silent) -> tuple[SolvedRotor, ...]:
    """Every rotor of the case, alone on grounded bearings.

    Raises
    ------
    CaseError, rotors.RotorError
        Where the case has no rotors, or one cannot be solved as it stands.
    """
    require(case, "rotor", command="rotors")
    analysis = case.rotor_analysis or RotorAnalysis()
    solved = []
    for given in case.rotor:
        progress(f"rotor {given.name}")
        rotor, bearings = build_rotor(case, given), build_bearings(case, given.name)
        lowest, _ = table_range(case, given.name)
        resting = tuple(bearing.at_speed(lowest) for bearing in bearings)
        speeds = whirl_speeds(case, given.name)
        operation = speeds[0] if case.operation is not None else None
        reference = lowest if operation is None else operation
        weight = solve_weight(analysis, rotor, bearings, reference)
        progress(f"rotor {given.name}: whirl over speed")
        diagram = campbell_speeds(case, given.name)
        solver = room.WhirlSolver(rotor, bearings)
        campbell = room.campbell(rotor, bearings, diagram, count=analysis.modes, solver=solver) if diagram else None
        held = not isinstance(weight, str)
        rest = room.rest_frequencies(rotor, resting, count=analysis.modes)
        torsional = room.solve_torsional_modes(rotor)
        rolling = rolling_states(case, given.name)
        solved.append(
            SolvedRotor(
                rotor=rotor,
                bearings=bearings,
                resting=resting,
                rest_speed=lowest if any(bearing.speeds is not None for bearing in bearings) else None,
                rest=rest,
                axial=_axial_frequencies(rotor, resting, rest),
                lateral=room.solve_lateral_modes(rotor, [bearing.mean_support for bearing in resting]),
                torsional=torsional,
                whirl=tuple(solver.modes(speed, count=analysis.modes) for speed in speeds),
                campbell=campbell,
                crossings=() if campbell is None else _crossings(campbell),
                orders={}
                if campbell is None
                else {order: _crossings(campbell, order) for order in sorted(set(analysis.orders) - {1.0})},
                critical=room.critical_speeds(rotor, bearings, count=analysis.modes).lateral,
                operation=operation,
                weight=weight,
                response=solve_response(case, analysis, given, rotor, bearings, operation, held=held),
                torsion=solve_torsion(analysis, given, rotor, torsional),
                stiffness_map=_stiffness_map(analysis, rotor, bearings),
                rolling=rolling,
                lives=_rated_lives(case, rolling),
            )
        )
    return tuple(solved)


def _rated_lives(case: Case, states: Mapping[str, RollingState]) -> dict[str, float]:
    """Basic rating lives in revolutions."""
    ratings = {
        bearing.name: bearing.stiffness.rolling.dynamic_rating
        for bearing in case.bearing
        if isinstance(bearing.stiffness, RollingStiffness)
    }
    lives = {
        name: rated_revolutions(state, rating)
        for name, state in states.items()
        if (rating := ratings.get(name)) is not None
    }
    return {name: life for name, life in lives.items() if life is not None}


def _axial_frequencies(rotor: room.Rotor, resting: Bearings, rest: room.RestFrequencies) -> FloatArray:
    """Natural frequencies along the axis: of those at rest where bearings tie it to the planes, else the rod's own."""
    along = rest.axial_share > room.MOSTLY_AXIAL
    if along.any():
        return rest.frequencies[along]
    springs = [room.AxisSpring(bearing.at, float(bearing.spatial_stiffness[2, 2])) for bearing in resting]
    springs = [spring for spring in springs if spring.stiffness > 0.0]
    # As high as the bending that is listed beside it.
    limit = float(rest.frequencies.max(initial=0.0))
    if not springs or not limit:
        return np.zeros(0)
    return room.solve_axial_modes(rotor, springs, frequency_limit=limit).frequencies


def _stiffness_map(analysis: RotorAnalysis, rotor: room.Rotor, bearings: Bearings) -> room.CriticalSpeedMap | None:
    """Critical speeds over the stiffness of all bearings, where the case asks for them and there are any."""
    wanted = analysis.stiffness_map
    if wanted is None or not bearings:
        return None
    direction = 1 if wanted.whirl == "forward" else -1
    return room.critical_speed_map(rotor, bearings, wanted.stiffnesses, count=wanted.modes, direction=direction)


def _crossings(campbell: room.Campbell, order: float = 1.0) -> Crossings:
    """Damped critical speeds; a diagram of few speeds may not separate them, which is no reason to show nothing.

    Motions that are for the most part along the axis are left out: no unbalance drives them.
    """
    try:
        return tuple(one for one in campbell.crossings(order) if one.axial_share <= room.MOSTLY_AXIAL)
    except room.IncompleteModesError as error:
        return str(error)


def write_ross_files(folder: Path, solved: tuple[SolvedRotor, ...]) -> tuple[str, ...]:
    """Write every rotor as ``<name>.ross.toml``, and return what ROSS has no place for."""
    remarks: list[str] = []
    for one, stem in zip(solved, file_stems([one.rotor.name for one in solved]), strict=True):
        remarks += room.write_ross(folder / f"{stem}.ross.toml", one.rotor, one.bearings)
    return tuple(remarks)
