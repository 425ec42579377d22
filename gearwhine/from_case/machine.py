"""Description of the machine of a case: its shafts, bearings, gears, gear pairs and operation."""

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, Rotor, require
from gearwhine.coupling import Machine, MountedBearing, Shaft
from gearwhine.coupling.analyses.shafts_alone import BearingsUnderLoad, bearings_under_load
from gearwhine.coupling.description.parts import LATERAL_LIMIT_HZ
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.from_case.gear_pairs import build_pair
from gearwhine.from_case.rotors import (
    bearing_law,
    build_bearings,
    design_load,
    rolling_elements,
    rolling_states,
    shaft_gears,
)
from gearwhine.housing import HousingModes

FloatArray = npt.NDArray[np.float64]

_TWO_PI = 2.0 * np.pi

# Shafts keep every bending mode up to LATERAL_LIMIT_HZ, or several times the housing's limit where that is higher;
# further modes respond statically, through attachment vectors at bearings and gears.
_HOUSING_FACTOR = 2.5


def require_machine(case: Case) -> None:
    """Refuse a case whose parts do not make a machine, before anything is solved.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
        As :func:`describe_machine`; thrust that nothing carries is among the reasons.
    """
    if case.gear_pair and case.rotor and case.operation is not None:
        describe_machine(case, None, grounded=True)


def describe_machine(
    case: Case, housing: HousingModes | HousingComponent | None = None, *, grounded: bool = False
) -> Machine:
    """Build the library's description of a machine: the shafts, gears, bearings and gear pairs of a case.

    ``grounded`` puts every bearing on the ground: the machine is looked at before its housing is solved.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
        Where the parts do not make a machine.
    """
    require(case, "rotor", "operation", command="system")
    operation = case.operation
    assert operation is not None
    bearings = []
    for rotor in case.rotor:
        own_bearings = [(n, entry) for n, entry in enumerate(case.bearing) if entry.rotor == rotor.name]
        laws = {entry.name: bearing_law(case, n) for n, entry in own_bearings}
        elements = {entry.name: rolling_elements(case, n) for n, entry in own_bearings}
        damping_times = {entry.name: entry.damping_time for _, entry in own_bearings}
        design_loads = {entry.name: design_load(case, entry) for _, entry in own_bearings}
        # Bearings of the rotor's own file stand on the ground.
        seats = {entry.name: entry.seat for _, entry in own_bearings if not entry.grounded}
        bearings += [
            MountedBearing(
                bearing,
                rotor.name,
                None if grounded else seats.get(bearing.name),
                laws.get(bearing.name),
                elements.get(bearing.name),
                damping_time=damping_times.get(bearing.name, 0.0),
                design_load=design_loads.get(bearing.name),
            )
            for bearing in build_bearings(case, rotor.name)
        ]
    return Machine(
        shafts=[build_shaft(case, rotor) for rotor in case.rotor],
        bearings=bearings,
        gears=[gear for rotor in case.rotor for gear in shaft_gears(case, rotor.name)],
        gear_pairs=[build_pair(case, pair, number) for number, pair in enumerate(case.gear_pair)],
        speed=operation.speed,
        torque=operation.torque,
        outputs=[output.build() for output in operation.output],
        housing=housing,
        torque_at=operation.at or 0.0,
        forces=[force.build() for force in operation.force],
        torque_over_time=None if operation.over_time is None else operation.over_time.build(),
        ripple=[ripple.build() for ripple in operation.ripple],
        motor=None if operation.motor is None else operation.motor.build(),
        load=None if operation.load is None else operation.load.build(),
        base=None if operation.base is None else operation.base.build(),
        gravity=operation.gravity,
    )


def build_shaft(case: Case, rotor: Rotor) -> Shaft:
    """Build a rotor of the case, without its gears, as a shaft of the machine."""
    limit, count = _retained_modes(case, rotor.name)
    return Shaft(
        rotor.build(case.material),
        rotor.axis,
        rotor.start,
        rotor.damping_ratio,
        rotor.build_unbalance(),
        rotor.build_bow(),
        limit,
        count,
    )


def rotor_bearings(case: Case) -> dict[str, BearingsUnderLoad]:
    """Bearings of each rotor and the states of the rolling ones, linearised about the operating point on rigid seats.

    The operating point is solved only if the load of a bearing is left to it.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError,
    gearwhine.rotors.EquilibriumError
        Where a bearing cannot exist with its load or geometry, or the machine has no operating point.
    """
    built = {rotor.name: (build_bearings(case, rotor.name), rolling_states(case, rotor.name)) for rotor in case.rotor}
    if not any(case.finds_load(bearing) for bearing in case.bearing):
        return built
    under_load = bearings_under_load(describe_machine(case, grounded=True))
    return {name: (under_load[name][0], states | under_load[name][1]) for name, (_, states) in built.items()}


def _retained_modes(case: Case, rotor: str) -> tuple[float | None, int | None]:
    """Retained modes of a rotor: a frequency limit [rad/s], or a number of each kind."""
    table = case.rotor_named(rotor)
    if table.modes is not None:
        return None, table.modes
    if table.frequency_limit is not None:
        return _TWO_PI * table.frequency_limit, None
    limit = (case.housing.frequency_limit or 0.0) if case.housing else 0.0
    return _TWO_PI * max(LATERAL_LIMIT_HZ, _HOUSING_FACTOR * limit), None
