"""The bearings of a case as the rotor room's own, rolling ones solved under their loads."""

from typing import Any

import numpy as np
import numpy.typing as npt

import rotors as rotor_room
import rotors.rolling as rolling_room
from gearwhine.case import (
    Bearing,
    Case,
    CaseError,
    Problem,
    RadialDamping,
    RadialStiffness,
    RollingCatalogue,
    RollingGeometry,
    RollingStiffness,
)
from gearwhine.case.problems import UNSAID

FloatArray = npt.NDArray[np.float64]


def build_bearings(case: Case, rotor: str) -> tuple[rotor_room.Bearing, ...]:
    """The bearings of one rotor, in the order of the file.

    Raises
    ------
    CaseError
        For a rolling bearing that its load or geometry does not let be.
    """
    return tuple(_bearing(case, index) for index, given in enumerate(case.bearing) if given.rotor == rotor)


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


def rolling_document(case: Case, rotor: str) -> list[dict[str, Any]]:
    """The rolling bearings of one rotor as the command's JSON."""
    states = [(given, rolling_state(case, index)) for index, given in enumerate(case.bearing) if given.rotor == rotor]
    return [
        {
            "name": given.name,
            "load_n": state.load[:3].tolist(),
            "displacement_m": state.displacement[:3].tolist(),
            "stiffness": state.stiffness.tolist(),
            "elements": sum(row.count for row in state.bearing.rows),
            "loaded_elements": state.loaded,
            "peak_pressure_pa": state.peak_pressure,
            "residual": state.residual,
        }
        for given, state in states
        if state is not None
    ]


def _bearing(case: Case, index: int) -> rotor_room.Bearing:
    given = case.bearing[index]
    damping = _damping(given)
    state = rolling_state(case, index)
    if state is not None:
        try:
            return rolling_room.bearing_from(state, given.name, given.at, damping=damping)
        except rotor_room.EquilibriumError as error:
            raise _refused(given, index, error) from error
    return rotor_room.Bearing(given.name, given.at, _stiffness(given), damping)


def _stiffness(given: Bearing) -> FloatArray:
    assert not isinstance(given.stiffness, RollingStiffness)
    if isinstance(given.stiffness, RadialStiffness):
        return np.array([[given.stiffness.xx, given.stiffness.xy], [given.stiffness.yx, given.stiffness.yy]])
    return np.array(given.stiffness.matrix)


def _damping(given: Bearing) -> FloatArray:
    if isinstance(given.damping, RadialDamping):
        return np.array([[given.damping.xx, given.damping.xy], [given.damping.yx, given.damping.yy]])
    return np.array(given.damping.matrix)


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
