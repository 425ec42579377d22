"""Machine of a case in its housing or on rigid seats, and its bearings and gear pairs where there is no machine."""

from dataclasses import replace

from gearwhine.case import Case
from gearwhine.case.model import lacking
from gearwhine.case.parts import Parts
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment, taken_misalignments
from gearwhine.coupling.analyses.shafts_alone import BearingsUnderLoad, bearings_under_load
from gearwhine.coupling.gears import GearPairGeometry
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.coupling.gears.geometry.pitch_deviations import has_different_teeth
from gearwhine.coupling.gears.loaded.gear_pair import LoadedGearPair, load_gear_pair
from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.coupling.statics.operating_point import OperatingPoint
from gearwhine.housing import HousingModes
from gearwhine.numerics.progress import Progress, silent


def describe_machine(case: Case, housing: HousingModes | HousingComponent | None = None) -> Machine:
    """Return the machine of a case: its shafts, gears, bearings and gear pairs, in a housing or on rigid seats.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError, gearwhine.coupling.CouplingError, gearwhine.coupling.gears.GearError
        Where the parts do not make a machine.
    """
    machine = case.parts.machine
    if machine is None:
        raise lacking(case, "rotor", "operation", command="system")
    if housing is None:
        return machine
    parts = case.parts
    return replace(
        machine,
        shafts=parts.shafts,
        bearings=parts.bearings,
        torque_supports=parts.torque_supports,
        housing=housing,
    )


def rotor_bearings(parts: Parts) -> dict[str, BearingsUnderLoad]:
    """Bearings of each rotor and the states of the rolling ones, linearised about the operating point on rigid seats.

    The operating point is solved only if the load of a bearing is left to it.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError, gearwhine.coupling.EquilibriumNotFoundError,
    gearwhine.rotors.EquilibriumError
        Where a bearing cannot exist with its load or geometry, or the machine has no operating point.
    """
    on = {bearing.name: bearing.rotor for bearing in parts.bearing}
    built: dict[str, BearingsUnderLoad] = {
        rotor.name: (
            parts.bearings_on(rotor.name),
            {name: state for name, state in parts.rolling_states.items() if on[name] == rotor.name},
        )
        for rotor in parts.rotor
    }
    if parts.machine is None or not any(parts.finds_load(bearing) for bearing in parts.bearing):
        return built
    under_load = bearings_under_load(parts.machine)
    return {name: (under_load[name][0], states | under_load[name][1]) for name, (_, states) in built.items()}


def solve_gears(parts: Parts, progress: Progress = silent) -> tuple[LoadedGearPair, ...]:
    """Solve every gear pair of a case, flanks whose misalignment the case leaves out as aligned ones.

    Raises
    ------
    CaseError, gearwhine.coupling.gears.GearError
        Where one cannot be solved as it stands.
    """
    solved = []
    of_pairs = parts.gear_pair, parts.gear_pairs, _numbered_geometries(parts), parts.pair_torques, parts.mesh_speeds
    for entry, pair, geometry, torque, speed in zip(*of_pairs, strict=True):
        progress(f"gear pair {entry.driver} -> {entry.driven}")
        loaded = load_gear_pair(
            pair,
            geometry,
            torque=torque,
            inertias=parts.rotating_inertias(entry),
            speed=speed,
        )
        solved.append(loaded)
    return tuple(solved)


def _numbered_geometries(parts: Parts) -> tuple[GearPairGeometry, ...]:
    """Return the geometries of all pairs; teeth that differ, of gears with several mates, by the machine's numbers."""
    named = [name for pair in parts.gear_pair for name in (pair.driver, pair.driven)]
    several = [gear for name, gear in parts.gears.items() if named.count(name) > 1 and has_different_teeth(gear)]
    if not several or parts.machine is None:
        return parts.pair_geometries
    return parts.machine.pair_geometries


def aligned_by_default(parts: Parts) -> tuple[str, ...]:
    """Return the labels of the pairs whose misalignment the case leaves out, and no operating point has."""
    return tuple(
        pair_label(pair.driver, pair.driven)
        for pair in parts.gear_pair
        if pair.misalignment is None and not parts.finds_misalignment(pair)
    )


def misalignments_of_case(
    parts: Parts, point: OperatingPoint | None, *, is_sought: bool = True
) -> tuple[TakenMisalignment, ...]:
    """Misalignment of every gear pair of a case, as the library's `taken_misalignments` has it of a machine."""
    return taken_misalignments(parts.gear_pairs, point, aligned_by_default(parts), is_sought=is_sought)
