"""Rotors, gears and bearings of a case as library objects, with the materials that their entries name.

Rolling bearings are linearised about their equilibrium under load.
"""

import numpy as np
import numpy.typing as npt

from coupling import RollingLaw, ShaftGear
from coupling.gears import Gear
from coupling.machine.connectors import BearingLaw
from coupling.machine.parts import rotor_with_gears
from gearwhine.case import Bearing, Case, CaseError, Problem, RollingStiffness, StopStiffness
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor
from gearwhine.case.errors import UNSAID
from rotors import Bearing as RotorBearing
from rotors import EquilibriumError, Rotor, RotorError
from rotors import rolling_bearings as rolling

FloatArray = npt.NDArray[np.float64]


def build_gear(case: Case, given: GivenGear) -> Gear:
    """Build a gear of the case; see :meth:`gearwhine.case.Gear.build`."""
    return given.build(case.material_of_gear(given))


def gear_inertia(case: Case, given: GivenGear) -> tuple[float, float, float]:
    """Mass [kg], polar and diametral inertia [kg m²] of a gear of the case: as given, or from the geometry."""
    return given.inertia(case.material_of_gear(given))


def shaft_gears(case: Case, rotor: str) -> list[ShaftGear]:
    """Build the gears on a rotor of the case, in the order of the file."""
    return [
        ShaftGear(build_gear(case, gear), rotor, gear.at, gear_inertia(case, gear), gear.stiffens_shaft)
        for gear in case.gear
        if gear.rotor == rotor and gear.at is not None
    ]


def build_rotor(case: Case, given: GivenRotor) -> Rotor:
    """Build a rotor of the case, its gears on it as discs that stiffen it."""
    return rotor_with_gears(given.build(case.material), shaft_gears(case, given.name))


def build_bearings(case: Case, rotor: str) -> tuple[RotorBearing, ...]:
    """Build the bearings of one rotor, in the order of the file; first those of the rotor's own file.

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


def rolling_state(case: Case, index: int) -> rolling.RollingState | None:
    """Solve a bearing's equilibrium under the load of the case, its shaft in line with its seat; None for others.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    given = case.bearing[index]
    if not isinstance(given.stiffness, RollingStiffness) or case.finds_load(given):
        return None
    load = (0.0, 0.0, 0.0) if given.load is None else (given.load.x, given.load.y, given.load.z)
    try:
        bearing = given.stiffness.rolling.build(given.name)
        return rolling.rolling_equilibrium(bearing, [*load, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    except (RotorError, EquilibriumError) as error:
        raise _refused(given, index, error) from error


def bearing_law(case: Case, index: int) -> BearingLaw | None:
    """Return the force law of a bearing whose force is not linear in its stiffness; None for a linear one.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    given = case.bearing[index].stiffness
    if isinstance(given, StopStiffness):
        return given.stop.build()
    if isinstance(given, RollingStiffness) and given.rolling.law == "nonlinear":
        # One whose load is left to the operating point waits for it undeflected.
        state = rolling_state(case, index)
        return RollingLaw(rolling.rolling_state(_elements(case, index), np.zeros(5)) if state is None else state)
    return None


def rolling_elements(case: Case, index: int) -> rolling.RollingBearing | None:
    """Build a rolling bearing by its elements; None for other bearings.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    return _elements(case, index) if isinstance(case.bearing[index].stiffness, RollingStiffness) else None


def _elements(case: Case, index: int) -> rolling.RollingBearing:
    given = case.bearing[index]
    assert isinstance(given.stiffness, RollingStiffness)
    try:
        return given.stiffness.rolling.build(given.name)
    except RotorError as error:
        raise _refused(given, index, error) from error


def rolling_states(case: Case, rotor: str) -> dict[str, rolling.RollingState]:
    """Solve the equilibria of one rotor's rolling bearings, by their names.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    states = {
        given.name: rolling_state(case, index) for index, given in enumerate(case.bearing) if given.rotor == rotor
    }
    return {name: state for name, state in states.items() if state is not None}


def _bearing(case: Case, index: int) -> RotorBearing:
    given = case.bearing[index]
    return RotorBearing(
        given.name,
        given.at,
        _stiffness(case, index),
        given.damping.build(),
        None if given.speeds is None else np.array(given.speeds),
        None if given.pedestal is None else given.pedestal.build(),
    )


def _stiffness(case: Case, index: int) -> FloatArray:
    given = case.bearing[index]
    if isinstance(given.stiffness, StopStiffness):
        load = (0.0, 0.0) if given.load is None else (given.load.x, given.load.y)
        return given.stiffness.stop.build().tangent(load)
    if not isinstance(given.stiffness, RollingStiffness):
        return given.stiffness.build()
    if case.finds_load(given):
        return np.zeros((5, 5))
    state = rolling_state(case, index)
    assert state is not None
    try:
        return rolling.linearised_bearing(state, given.name, given.at).stiffness
    except EquilibriumError as error:
        raise _refused(given, index, error) from error


def _refused(given: Bearing, index: int, error: Exception) -> CaseError:
    expected = f"a bearing that its elements hold under its load; {error}"
    key, label = f"bearing[{index}].stiffness.rolling", f'bearing "{given.name}"'
    return CaseError([Problem(key, UNSAID, expected, label=label)])
