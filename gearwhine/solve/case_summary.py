"""Summary of a case before anything is solved: parts that cannot be built are refused, the rest is arithmetic."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from gearwhine.case import Case, GearPair, Housing, Rotor, force_origins, mesh_frequencies, pair_torques, rotor_speeds
from gearwhine.case.checks.whole_case import axial_locations
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.gear_pairs import TakenMisalignment, geometry_warnings
from gearwhine.coupling.analyses.operation_warnings import operation_warnings
from gearwhine.coupling.description.axial_location import AxialLocation
from gearwhine.coupling.gears import GearPairGeometry
from gearwhine.from_case import mesh_health
from gearwhine.from_case.gear_pairs import (
    build_pair,
    misalignments_of_case,
    pair_geometries,
)
from gearwhine.from_case.machine import require_machine
from gearwhine.from_case.mesh import build_mesh, material_of
from gearwhine.from_case.mesh_health import MeshPreview
from gearwhine.from_case.parametric_housing import fitted_case
from gearwhine.from_case.rotors import build_bearings, build_rotor
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.rotors import Rotor as BuiltRotor
from gearwhine.rotors.rolling_bearings.speed_factor import centrifugal_warnings
from gearwhine.solve.acoustics import acoustics_of, check_before_modes
from gearwhine.solve.comparison import require_comparable
from gearwhine.solve.machine import described_machine
from gearwhine.solve.part_fits import fit_warnings


@dataclass(frozen=True)
class CheckedRotor:
    """Rotor of a checked case.

    Attributes
    ----------
    given : Rotor
        Table of the rotor in the case.
    built : gearwhine.rotors.Rotor
    speed : float or None
        Speed in operation [rad/s]; None without an operation.
    """

    given: Rotor
    built: BuiltRotor
    speed: float | None


@dataclass(frozen=True)
class CheckedPair:
    """Gear pair of a checked case.

    Attributes
    ----------
    given : GearPair
    geometry : gearwhine.coupling.gears.GearPairGeometry
    misalignment : TakenMisalignment
    mesh_frequency : float or None
        Mesh frequency [Hz]; None without an operation.
    torque : float or None
        Torque on the driver [N m]; None without an operation.
    force_origin : str
        See :func:`gearwhine.case.force_origins`.
    """

    given: GearPair
    geometry: GearPairGeometry
    misalignment: TakenMisalignment
    mesh_frequency: float | None
    torque: float | None
    force_origin: str

    @property
    def mean_force(self) -> float | None:
        """Force along the line of action, F = T / r_b of the driver [N]."""
        return None if self.torque is None else abs(self.torque) / self.geometry.driver.base_radius


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
    machine : Machine or None
        Machine of the case on rigid seats; None without rotors and an operation.
    warnings : list of dict
        Warnings, as in the documents.
    """

    case: Case
    mesh: MeshPreview | None
    rotors: tuple[CheckedRotor, ...]
    pairs: tuple[CheckedPair, ...]
    locations: tuple[AxialLocation, ...]
    machine: Machine | None
    warnings: list[dict[str, Any]]


def check_case(case: Case, progress: Progress = silent) -> CheckedCase:
    """Build all of a case but the housing's matrices, and read the file of its geometry.

    Raises
    ------
    CaseError
        Where a part of it cannot be built, or its housing's mesh is wrong.
    """
    require_machine(case)
    require_comparable(case)
    for rotor in case.rotor:
        # A load that a rolling bearing cannot carry is refused here as by the commands that solve it.
        build_bearings(case, rotor.name)
    if case.update is not None:
        fitted_case(case)
    mesh: MeshPreview | None = None
    warnings: list[dict[str, Any]] = []
    if case.housing is not None:
        for name in {case.housing.material, *(region.material for region in case.housing.region)}:
            material_of(case.material, name)
        mesh, warnings = mesh_health.preview_mesh(case.housing, case.material, case.input_files, progress)
        warnings += _checked_acoustics(case, case.housing, mesh)
    rotors, pairs = checked_rotors(case), tuple(checked_pairs(case))
    for pair in pairs:
        warnings += geometry_warnings(build_pair(case, pair.given), pair.geometry)
    warnings += fit_warnings(
        case, {rotor.given.name: rotor.built for rotor in rotors}, None if mesh is None else mesh.mesh
    )
    machine = described_machine(case, None) if case.rotor and case.operation is not None else None
    if machine is not None:
        warnings += operation_warnings(machine)
    locations = axial_locations(case)
    speeds = {rotor.given.name: rotor.speed for rotor in rotors if rotor.speed is not None}
    warnings += centrifugal_warnings(
        (bearing.name, bearing.rolling, speeds[location.shaft])
        for location in locations
        for bearing in location.bearings
        if bearing.rolling is not None and location.shaft in speeds
    )
    if case.measured is not None and case.measured.survey is not None:
        warnings += [warning("measured", f"{case.measured.file}: {remark}") for remark in case.measured.survey.remarks]
    return CheckedCase(case, mesh, rotors, pairs, locations, machine, warnings)


def _checked_acoustics(case: Case, housing: Housing, preview: MeshPreview) -> list[dict[str, Any]]:
    """Return warnings about the acoustics of a case.

    Raises
    ------
    CaseError
        With everything that is wrong with its radiating surface and microphones.
    """
    if (refuse := check_before_modes(case)) is None:
        return []
    from gearwhine.coupling.sound.acoustics_checks import acoustics_warnings

    mesh = preview.mesh or build_mesh(housing, case.material, case.input_files, order=1)
    refuse(mesh)
    return acoustics_warnings(acoustics_of(case), mesh.bounds, housing.frequency_limit)


def checked_rotors(case: Case) -> tuple[CheckedRotor, ...]:
    """Build the rotors of a case, each with its speed."""
    speeds = rotor_speeds(case) if case.operation is not None else {}
    return tuple(CheckedRotor(entry, build_rotor(case, entry), speeds.get(entry.name)) for entry in case.rotor)


def checked_pairs(case: Case) -> Iterator[CheckedPair]:
    """Build the gear pairs of a case one by one, each with its mesh frequency and torque."""
    number = len(case.gear_pair)
    frequencies = mesh_frequencies(case) if case.operation is not None else (None,) * number
    torques = pair_torques(case) if case.operation is not None else (None,) * number
    misalignments = misalignments_of_case(case, None, is_sought=False)
    origins = force_origins(case)
    for row in zip(case.gear_pair, pair_geometries(case), misalignments, frequencies, torques, origins, strict=True):
        pair = CheckedPair(*row)
        build_pair(case, pair.given).require_sound_faults(pair.geometry)
        yield pair
