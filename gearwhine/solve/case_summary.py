"""Summary of a case, or of a machine of Python, before anything is solved: what cannot be built is refused."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from gearwhine.case import Case
from gearwhine.case.parts import Parts
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment, geometry_warnings, taken_misalignments
from gearwhine.coupling.analyses.operation_warnings import operation_warnings
from gearwhine.coupling.description.axial_location import AxialLocation
from gearwhine.coupling.description.fault_rates import (
    ToothFaultRate,
    planet_pass_rate,
    same_teeth_rates,
    tooth_fault_rates,
)
from gearwhine.coupling.description.planetary import PlacedSet, SetMember, part_of_period
from gearwhine.coupling.gears import GearPairGeometry
from gearwhine.exchange.rexs import ImportedCase
from gearwhine.from_case import mesh_health
from gearwhine.from_case.machine import describe_machine, misalignments_of_case
from gearwhine.from_case.mesh import build_mesh, material_of
from gearwhine.from_case.mesh_health import MeshPreview
from gearwhine.from_case.parametric_housing import fitted_case
from gearwhine.from_case.reduced_housing import build_reduced_housing, reduced_component
from gearwhine.housing.reduced import ReducedHousing
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.rotors import Rotor
from gearwhine.rotors.rolling_bearings import CharacteristicFrequencies, frequencies_in_seat
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings
from gearwhine.settings import Settings
from gearwhine.solve.acoustics import acoustics_of, check_before_modes
from gearwhine.solve.comparison import require_comparable
from gearwhine.solve.part_fits import fit_warnings


@dataclass(frozen=True)
class CheckedRotor:
    """Rotor of a checked machine.

    Attributes
    ----------
    built : gearwhine.rotors.Rotor
    speed : float or None
        Speed in operation [rad/s]; None without an operation.
    """

    built: Rotor
    speed: float | None


@dataclass(frozen=True)
class CheckedPair:
    """Gear pair of a checked machine.

    Attributes
    ----------
    stiffness_model : str
    geometry : gearwhine.coupling.gears.GearPairGeometry
    misalignment : TakenMisalignment
    mesh_frequency : float or None
        Mesh frequency [Hz]; None without an operation.
    torque : float or None
        Torque on the driver [N m]; None without an operation.
    force_origin : str
        See :attr:`gearwhine.coupling.description.gear_train.GearTrain.force_origins`.
    given_backlash : float or None
        Backlash that acts in place of that of centre distance and tooth thickness [m]; None where none is given.
    """

    stiffness_model: str
    geometry: GearPairGeometry
    misalignment: TakenMisalignment
    mesh_frequency: float | None
    torque: float | None
    force_origin: str
    given_backlash: float | None

    @property
    def backlash(self) -> float:
        """Gap of the back flanks along their line of action [m]: the one that is given, else that of the geometry."""
        return self.geometry.backlash if self.given_backlash is None else self.given_backlash

    @property
    def mean_force(self) -> float | None:
        """Force along the line of action, F = T / r_b of the driver [N]."""
        return None if self.torque is None else abs(self.torque / self.geometry.driver.base_radius)


@dataclass(frozen=True)
class CheckedSet:
    """Planetary set of a checked machine.

    Attributes
    ----------
    placed : PlacedSet
    members : tuple of SetMember
        Sun, ring, carrier and planets in operation; empty without one.
    phases : tuple of float or None
        Phase of each mesh of the set over that of its first [mesh periods]; None without an operation.
    faults : tuple of ToothFaultRate
        Rates of a tooth fault on each gear in operation.
    planet_pass : float or None
        Rate at which the planets pass a point of the housing [rad/s].
    same_teeth : tuple of float or None
        Rate at which the same teeth of each mesh meet again [rad/s].
    planet_bearings : mapping of str to CharacteristicFrequencies
        Characteristic frequencies of the planets' rolling bearings, of the first row, turning on the carrier.
    """

    placed: PlacedSet
    members: tuple[SetMember, ...] = ()
    phases: tuple[float, ...] | None = None
    faults: tuple[ToothFaultRate, ...] = ()
    planet_pass: float | None = None
    same_teeth: tuple[float, ...] | None = None
    planet_bearings: Mapping[str, CharacteristicFrequencies] = field(default_factory=dict)


@dataclass(frozen=True)
class CheckedCase:
    """A case that can be built.

    Attributes
    ----------
    case : Case
    mesh : MeshPreview or None
        Mesh of the housing.
    rotors : tuple of CheckedRotor
    pairs : tuple of CheckedPair
    locations : tuple of gearwhine.coupling.description.axial_location.AxialLocation
        Axial location of each rotor.
    sets : tuple of CheckedSet
        Planetary sets.
    machine : Machine or None
        Machine of the case on rigid seats; None without rotors and an operation.
    warnings : list of dict
        Warnings, as in the documents.
    imported : ImportedCase or None
        Gear unit of another program's file that the case was made of.
    reduced : ReducedHousing or None
        Housing of reduced matrices.
    """

    case: Case
    mesh: MeshPreview | None
    rotors: tuple[CheckedRotor, ...]
    pairs: tuple[CheckedPair, ...]
    locations: tuple[AxialLocation, ...]
    sets: tuple[CheckedSet, ...]
    machine: Machine | None
    warnings: list[dict[str, Any]]
    imported: ImportedCase | None = None
    reduced: ReducedHousing | None = None


@dataclass(frozen=True)
class CheckedMachine:
    """A machine of Python; the attributes are those of :class:`CheckedCase`, and the settings."""

    machine: Machine
    settings: Settings
    rotors: tuple[CheckedRotor, ...]
    pairs: tuple[CheckedPair, ...]
    locations: tuple[AxialLocation, ...]
    sets: tuple[CheckedSet, ...]
    warnings: list[dict[str, Any]]


def check_machine(machine: Machine, settings: Settings) -> CheckedMachine:
    """Summarise a machine of Python, which its constructor has checked.

    Raises
    ------
    gearwhine.coupling.gears.GearError
        Where a fault is not one of its gear.
    """
    rows = zip(
        (getattr(pair.stiffness, "name", str(pair.stiffness)) for pair in machine.gear_pairs),
        machine.pair_geometries,
        taken_misalignments(machine.gear_pairs, None, is_sought=False),
        machine.mesh_frequencies,
        machine.pair_torques,
        machine.train.force_origins,
        (pair.backlash for pair in machine.gear_pairs),
        strict=True,
    )
    rotors = tuple(CheckedRotor(machine.rotor(shaft.name), machine.speeds[shaft.name]) for shaft in machine.shafts)
    pairs = tuple(CheckedPair(*row) for row in rows)
    warnings: list[dict[str, Any]] = []
    for built, geometry in zip(machine.gear_pairs, machine.pair_geometries, strict=True):
        built.require_sound_faults(geometry)
        warnings += geometry_warnings(built, geometry)
    warnings += _machine_warnings(machine)
    sets = tuple(checked_sets(machine.placed_sets, machine))
    return CheckedMachine(machine, settings, rotors, pairs, machine.axial_locations, sets, warnings)


def _machine_warnings(machine: Machine) -> list[dict[str, Any]]:
    """Return warnings of a machine's operation and of the speeds of its rolling bearings."""
    speeds = (
        (mounted.bearing.name, mounted.rolling, machine.bearing_speed(mounted))
        for mounted in machine.bearings
        if mounted.rolling is not None
    )
    return [*operation_warnings(machine), *centrifugal_warnings(speeds)]


def check_case(case: Case, progress: Progress = silent, imported: ImportedCase | None = None) -> CheckedCase:
    """Build all of a case but the housing's matrices, and read the file of its geometry.

    Parameters
    ----------
    case : Case
    progress : callable
    imported : ImportedCase, optional
        Gear unit of another program's file that the case was made of.

    Raises
    ------
    CaseError
        Where a part of it cannot be built, or its housing's mesh is wrong.
    """
    parts = case.parts
    machine = parts.machine
    require_comparable(case.measured, case.housing)
    _ = parts.bearings  # a load that a rolling bearing cannot carry is refused here as by the commands that solve it
    if case.update is not None:
        fitted_case(case)
    mesh: MeshPreview | None = None
    warnings: list[dict[str, Any]] = []
    if case.housing is not None:
        for name in {case.housing.material, *(region.material for region in case.housing.region)}:
            material_of(case.material, name)
        mesh, warnings = mesh_health.preview_mesh(case.housing, case.material, case.input_files, progress)
        if (refuse := check_before_modes(case.acoustics, case.housing)) is not None:
            from gearwhine.coupling.sound.acoustics_checks import acoustics_warnings

            surface = mesh.mesh or build_mesh(case.housing, case.material, case.input_files, order=1)
            refuse(surface)
            warnings += acoustics_warnings(acoustics_of(case), surface.bounds, case.housing.frequency_limit)
    reduced = None if case.reduced_housing is None else build_reduced_housing(case.reduced_housing, case.input_files)
    if reduced is not None:
        component = reduced_component(case.reduced_housing, case.input_files)
        if machine is not None:
            describe_machine(case, component)
        warnings += reduced.result_warnings
    rotors, pairs = checked_rotors(parts), tuple(checked_pairs(parts))
    for built, geometry in zip(parts.gear_pairs, parts.pair_geometries, strict=True):
        warnings += geometry_warnings(built, geometry)
    warnings += fit_warnings(parts, case.housing, None if mesh is None else mesh.mesh)
    if machine is not None:
        warnings += _machine_warnings(machine)
    if case.measured is not None and case.measured.survey is not None:
        warnings += [
            warning("measured", f"{case.measured.file_names}: {remark}") for remark in case.measured.survey.remarks
        ]
    sets = tuple(checked_sets(parts.placed_sets, machine))
    return CheckedCase(case, mesh, rotors, pairs, parts.axial_locations, sets, machine, warnings, imported, reduced)


def checked_rotors(parts: Parts) -> tuple[CheckedRotor, ...]:
    """Build the rotors of a case, each with its speed."""
    return tuple(CheckedRotor(rotor, parts.speeds.get(rotor.name)) for rotor in parts.rotors)


def checked_sets(sets: Iterable[PlacedSet], machine: Machine | None) -> Iterator[CheckedSet]:
    """Yield planetary sets, with members and phases where there is a machine in operation."""
    for placed in sets:
        if machine is None:
            yield CheckedSet(placed)
            continue
        phases, speeds = [machine.mesh_phases[mesh.number] for mesh in placed.meshes], machine.speeds
        yield CheckedSet(
            placed,
            machine.members_of(placed),
            tuple(part_of_period(one - phases[0]) for one in phases),
            tooth_fault_rates(placed, speeds),
            planet_pass_rate(placed, speeds),
            same_teeth_rates(placed, speeds),
            {
                mounted.bearing.name: frequencies_in_seat(mounted.rolling.rows[0], machine.bearing_speed(mounted))
                for mounted in machine.bearings
                if mounted.rotor in placed.planet_shafts and mounted.rolling is not None
            },
        )


def checked_pairs(parts: Parts) -> Iterator[CheckedPair]:
    """Build the gear pairs of a case one by one, each with its mesh frequency and torque."""
    unknown = (None,) * len(parts.gear_pair)
    rows = zip(
        (pair.stiffness.model for pair in parts.gear_pair),
        parts.pair_geometries,
        misalignments_of_case(parts, None, is_sought=False),
        unknown if parts.operation is None else parts.mesh_frequencies,
        unknown if parts.operation is None else parts.pair_torques,
        parts.train.force_origins,
        (pair.backlash for pair in parts.gear_pair),
        strict=True,
    )
    for built, row in zip(parts.gear_pairs, rows, strict=True):
        pair = CheckedPair(*row)
        built.require_sound_faults(pair.geometry)
        yield pair
