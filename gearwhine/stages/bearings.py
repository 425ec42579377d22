"""The bearings of a case as the rotor room's own, rolling ones solved under their loads."""

import numpy as np
import numpy.typing as npt

import rotors as rotor_room
import rotors.rolling as rolling_room
from coupling import BearingLaw, GapLaw, RollingLaw
from gearwhine.case import (
    Bearing,
    Case,
    CaseError,
    MatrixDamping,
    MatrixStiffness,
    Pedestal,
    Problem,
    RadialDamping,
    RadialStiffness,
    RollingCatalogue,
    RollingGeometry,
    RollingStiffness,
    StopStiffness,
)
from gearwhine.case.problems import UNSAID
from gearwhine.case.shafts import PedestalDamping, PedestalStiffness

FloatArray = npt.NDArray[np.float64]


def build_bearings(case: Case, rotor: str) -> tuple[rotor_room.Bearing, ...]:
    """The bearings of one rotor, in the order of the file; first those of the rotor's own file.

    A bearing of the case takes the place of one of the same name in the rotor's file.

    Raises
    ------
    CaseError
        For a rolling bearing that its load or geometry does not let be.
    """
    saved = case.rotor_named(rotor).saved
    replaced = {given.name for given in case.bearing if given.rotor == rotor}
    of_file = tuple(bearing for bearing in (saved.bearings if saved else ()) if bearing.name not in replaced)
    return of_file + tuple(_bearing(case, index) for index, given in enumerate(case.bearing) if given.rotor == rotor)


def rolling_state(case: Case, index: int) -> rolling_room.RollingState | None:
    """A bearing's equilibrium under its load, with the shaft in line with its seat; None where it does not roll.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    given = case.bearing[index]
    if not isinstance(given.stiffness, RollingStiffness):
        return None
    load = (0.0, 0.0, 0.0) if given.load is None else (given.load.x, given.load.y, given.load.z)
    try:
        bearing = _rolling_bearing(given.name, given.stiffness.rolling)
        return rolling_room.rolling_equilibrium(bearing, [*load, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    except (rotor_room.RotorError, rotor_room.EquilibriumError) as error:
        raise _refused(given, index, error) from error


def bearing_law(case: Case, index: int) -> BearingLaw | None:
    """The law by which a bearing moves where that is not the linear one of its stiffness.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    given = case.bearing[index].stiffness
    if isinstance(given, StopStiffness):
        return _gap_law(given)
    if isinstance(given, RollingStiffness) and given.rolling.law == "nonlinear":
        state = rolling_state(case, index)
        assert state is not None
        return RollingLaw(state)
    return None


def rolling_states(case: Case, rotor: str) -> dict[str, rolling_room.RollingState]:
    """The equilibria of one rotor's rolling bearings, by their names.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    states = {
        given.name: rolling_state(case, index) for index, given in enumerate(case.bearing) if given.rotor == rotor
    }
    return {name: state for name, state in states.items() if state is not None}


def _bearing(case: Case, index: int) -> rotor_room.Bearing:
    given = case.bearing[index]
    return rotor_room.Bearing(
        given.name,
        given.at,
        _stiffness(case, index),
        _matrix(given.damping),
        None if given.speeds is None else np.array(given.speeds),
        None if given.pedestal is None else _pedestal(given.pedestal),
    )


def _stiffness(case: Case, index: int) -> FloatArray:
    given = case.bearing[index]
    state = rolling_state(case, index)
    if isinstance(given.stiffness, StopStiffness):
        load = (0.0, 0.0) if given.load is None else (given.load.x, given.load.y)
        return _gap_law(given.stiffness).tangent(load)
    if state is None:
        assert not isinstance(given.stiffness, RollingStiffness)
        return _matrix(given.stiffness)
    try:
        return rolling_room.bearing_from(state, given.name, given.at).stiffness
    except rotor_room.EquilibriumError as error:
        raise _refused(given, index, error) from error


def _gap_law(given: StopStiffness) -> GapLaw:
    stop = given.stop
    return GapLaw(stop.force, stop.depth, stop.exponent, stop.gap)


def _matrix(given: RadialStiffness | RadialDamping | MatrixStiffness | MatrixDamping) -> FloatArray:
    """The matrix over x, y or over all five motions; with lists in it one for each speed, (s, 2, 2)."""
    return _radial(given) if isinstance(given, RadialStiffness | RadialDamping) else np.array(given.matrix)


def _radial(given: RadialStiffness | RadialDamping | PedestalStiffness | PedestalDamping) -> FloatArray:
    """The matrix over x, y, (2, 2), or with lists in it one for each speed, (s, 2, 2)."""
    entries = np.broadcast_arrays(given.xx, given.xy, given.yx, given.yy)
    return np.stack(entries, axis=-1).reshape(*entries[0].shape, 2, 2)


def _pedestal(given: Pedestal) -> rotor_room.Pedestal:
    return rotor_room.Pedestal(_radial(given.stiffness), _radial(given.damping), given.mass)


def _rolling_bearing(name: str, given: RollingGeometry | RollingCatalogue) -> rolling_room.RollingBearing:
    row = _row(given)
    sense = 1 if given.carries == "+z" else -1
    label = f"bearing {name!r}"
    if isinstance(row, rolling_room.RollerRow):
        return rolling_room.RollingBearing([row], name=label)
    if given.arrangement == "single":
        return rolling_room.RollingBearing([row.facing(sense)], sense * given.preload, label)
    assert given.spacing is not None
    if given.arrangement == "tandem":
        pair = rolling_room.paired(row, "tandem", given.spacing)
        rows = [one.facing(sense) for one in pair.rows if isinstance(one, rolling_room.BallRow)]
        return rolling_room.RollingBearing(rows, sense * given.preload, label)
    return rolling_room.paired(row, given.arrangement, given.spacing, preload=given.preload, name=label)


def _row(given: RollingGeometry | RollingCatalogue) -> rolling_room.BallRow | rolling_room.RollerRow:
    if isinstance(given, RollingCatalogue):
        printed = given.catalogue
        return rolling_room.catalogue_row(
            printed.type,
            printed.bore,
            printed.outer_diameter,
            printed.width,
            contact_angle=printed.contact_angle,
            clearance=given.clearance,
        )
    if given.element == "roller":
        assert given.element_length is not None
        return rolling_room.RollerRow(
            given.count,
            given.element_diameter,
            given.element_length,
            given.pitch_diameter,
            clearance=given.clearance,
            profile=given.profile,
        )
    return rolling_room.BallRow(
        given.count,
        given.element_diameter,
        given.pitch_diameter,
        given.contact_angle,
        given.inner_groove,
        given.outer_groove,
        given.clearance,
    )


def _refused(given: Bearing, index: int, error: Exception) -> CaseError:
    expected = f"a bearing that its elements hold under its load; {error}"
    key, label = f"bearing[{index}].stiffness.rolling", f'bearing "{given.name}"'
    return CaseError([Problem(key, UNSAID, expected, label=label)])
