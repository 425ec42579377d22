"""Rotors, gears and bearings of a case as library objects, with the materials that their entries name.

Rolling bearings are linearised about their equilibrium under load.
"""

import numpy as np
import numpy.typing as npt

from gearwhine.case import Bearing, Case, CaseError, Problem, RollingStiffness, StopStiffness
from gearwhine.case import Gear as GivenGear
from gearwhine.case import Rotor as GivenRotor
from gearwhine.case.bearings import MatrixDamping, RadialDamping
from gearwhine.case.errors import UNSAID
from gearwhine.coupling import RollingLaw, ShaftGear
from gearwhine.coupling.description.parts import rotor_with_gears
from gearwhine.coupling.gears import Gear
from gearwhine.coupling.machine.bearing_laws import BearingLaw
from gearwhine.rotors import Bearing as RotorBearing
from gearwhine.rotors import EquilibriumError, Rotor, RotorError
from gearwhine.rotors import rolling_bearings as rolling

FloatArray = npt.NDArray[np.float64]


def build_gear(case: Case, entry: GivenGear) -> Gear:
    """Build a gear of the case; see :meth:`gearwhine.case.Gear.build`."""
    return entry.build(case.material_of_gear(entry))


def shaft_gears(case: Case, rotor: str) -> list[ShaftGear]:
    """Build the gears on a rotor of the case, in the order of the file."""
    return [
        ShaftGear(
            build_gear(case, gear),
            rotor,
            gear.at,
            gear.given_inertia,
            stiffens_shaft=gear.stiffens_shaft and gear.face_width is not None,
        )
        for gear in case.gear
        if gear.rotor == rotor and gear.at is not None
    ]


def build_rotor(case: Case, entry: GivenRotor) -> Rotor:
    """Build a rotor of the case, its gears on it as discs that stiffen it."""
    return rotor_with_gears(entry.build(case.material), shaft_gears(case, entry.name))


def build_bearings(case: Case, rotor: str) -> tuple[RotorBearing, ...]:
    """Build the bearings of one rotor, in the order of the file; first those of the rotor's own file.

    A bearing of the case takes the place of one of the same name in the rotor's file.

    Raises
    ------
    CaseError
        For a rolling bearing that cannot exist with its load or geometry.
    """
    saved = case.rotor_named(rotor).saved
    replaced = {entry.name for entry in case.bearing if entry.rotor == rotor}
    of_file = tuple(bearing for bearing in (saved.bearings if saved else ()) if bearing.name not in replaced)
    return of_file + tuple(_bearing(case, index) for index, entry in enumerate(case.bearing) if entry.rotor == rotor)


def rolling_state(case: Case, index: int) -> rolling.RollingState | None:
    """Solve a bearing's equilibrium under the load of the case, its shaft in line with its seat; None for others.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    entry = case.bearing[index]
    if not isinstance(entry.stiffness, RollingStiffness) or case.finds_load(entry):
        return None
    load = _given_load(entry)
    try:
        bearing = entry.stiffness.rolling.build(entry.name)
        return rolling.rolling_equilibrium(bearing, [*load, 0.0, 0.0], held={"rx": 0.0, "ry": 0.0})
    except (RotorError, EquilibriumError) as error:
        raise _refused(entry, index, error) from error


def bearing_law(case: Case, index: int) -> BearingLaw | None:
    """Return the force law of a bearing whose force is not linear in its stiffness; None for a linear one.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    stiffness = case.bearing[index].stiffness
    if isinstance(stiffness, StopStiffness):
        return stiffness.stop.build()
    if isinstance(stiffness, RollingStiffness) and stiffness.rolling.law == "nonlinear":
        # A bearing whose load is left to the operating point is undeflected until then.
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
    entry = case.bearing[index]
    assert isinstance(entry.stiffness, RollingStiffness)
    try:
        return entry.stiffness.rolling.build(entry.name)
    except RotorError as error:
        raise _refused(entry, index, error) from error


def rolling_states(case: Case, rotor: str) -> dict[str, rolling.RollingState]:
    """Solve the equilibria of one rotor's rolling bearings, by their names.

    Raises
    ------
    CaseError
        As `build_bearings`.
    """
    states = {
        entry.name: rolling_state(case, index) for index, entry in enumerate(case.bearing) if entry.rotor == rotor
    }
    return {name: state for name, state in states.items() if state is not None}


def _bearing(case: Case, index: int) -> RotorBearing:
    entry = case.bearing[index]
    stiffness = _stiffness(case, index)
    damping = entry.damping_time * stiffness
    if isinstance(entry.damping, RadialDamping | MatrixDamping):
        damping = entry.damping.build()
    return RotorBearing(
        entry.name,
        entry.at,
        stiffness,
        damping,
        None if entry.speeds is None else np.array(entry.speeds),
        None if entry.pedestal is None else entry.pedestal.build(),
    )


def design_load(case: Case, entry: Bearing) -> tuple[float, float, float] | None:
    """Force along x, y, z for which a bearing's stiffness is made [N]; None where it depends on none, or is found."""
    if not isinstance(entry.stiffness, RollingStiffness | StopStiffness) or case.finds_load(entry):
        return None
    return _given_load(entry)


def _given_load(entry: Bearing) -> tuple[float, float, float]:
    return (0.0, 0.0, 0.0) if entry.load is None else (entry.load.x, entry.load.y, entry.load.z)


def _stiffness(case: Case, index: int) -> FloatArray:
    entry = case.bearing[index]
    if isinstance(entry.stiffness, StopStiffness):
        return entry.stiffness.stop.build().tangent(_given_load(entry)[:2])
    if not isinstance(entry.stiffness, RollingStiffness):
        return entry.stiffness.build()
    if case.finds_load(entry):
        return np.zeros((5, 5))
    state = rolling_state(case, index)
    assert state is not None
    try:
        return rolling.linearised_bearing(state, entry.name, entry.at).stiffness
    except EquilibriumError as error:
        raise _refused(entry, index, error) from error


def _refused(entry: Bearing, index: int, error: Exception) -> CaseError:
    expected = f"a bearing that its elements hold under its load; {error}"
    key, label = f"bearing[{index}].stiffness.rolling", f'bearing "{entry.name}"'
    return CaseError([Problem(key, UNSAID, expected, label=label)])
