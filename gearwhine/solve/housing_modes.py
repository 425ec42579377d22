"""Housing modes of a case: its description is solved, or its modes are read from the mode cache of a results folder.

The mode cache is a file in the results folder that is read again while the housing is unchanged. Modes are identified
by the content of what they were solved from: the whole ``[housing]`` of the case but for the keys that do not enter the
modes, the materials it names, the places of the bearings for which the modes have attachments, the content of its
files, and the versions of the code and the source of what solves them.
A new key of the housing therefore counts until it is listed as one that changes no mode.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from gearwhine.case import Case
from gearwhine.from_case.fixtures import build_fixtures, check_places
from gearwhine.from_case.given_housing import GivenHousing, given_housing
from gearwhine.from_case.housing import describe_housing, refused_by_key
from gearwhine.from_case.mesh import box_mesh_size, build_mesh
from gearwhine.from_case.mesh_health import allowed_defects, noted_on_failure
from gearwhine.housing import Housing as DescribedHousing
from gearwhine.housing import HousingModes, read_modes, write_modes
from gearwhine.housing.errors import ModeFileError
from gearwhine.housing.mesh_refinement import refined_modes
from gearwhine.housing.model_warnings import defect_warnings
from gearwhine.housing.storage.mode_file import ModeRecord, with_sensors
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.meshes import Mesh, MeshDefect
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import warning
from gearwhine.output.files import MODE_CACHE_FILE


def read_mode_cache(folder: Path, inputs: Mapping[str, Any]) -> tuple[ModeRecord | None, str | None]:
    """Read the cached modes of these inputs, or None; and a warning where the file cannot be used."""
    path = folder / MODE_CACHE_FILE
    if not path.exists():
        return None, None
    try:
        record = read_modes(path)
    except ModeFileError as error:
        return None, f"{error}; the modes are solved again"
    return (record if record.key == content_key(inputs) else None), None


def solve_housing(
    case: Case,
    progress: Progress = silent,
    *,
    command: str = "modes",
    folder: Path | None = None,
    fresh: bool = False,
    before: Callable[[Mesh], None] | None = None,
) -> HousingModes:
    """Mesh the housing and solve its certified modes, or read them from the mode cache.

    Parameters
    ----------
    case : Case
    progress : callable
        Receives the next step in words.
    command : str
        Command that needs the modes, for messages.
    folder : path, optional
        A results folder; modes of the same housing cached there are read in place of solving.
    fresh : bool
        Whether to solve the modes even where they are cached.
    before : callable, optional
        Check of the rest of a case on the mesh, made before the modes are solved.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the case cannot be solved as it stands.
    gearwhine.housing.IncompleteModesError, gearwhine.housing.ReductionError, gearwhine.housing.HealthError
        Where the modes fail their certificate, their static compliance its proof, or the model its checks.
    """
    given = given_housing(case, command)
    folder = None if fresh else folder
    if given.table.accuracy is not None:
        inputs = given.cache_inputs()
        if folder is None or read_mode_cache(folder, inputs)[0] is None:
            return _refined(given, given.table.accuracy, inputs, progress, before)
    return _solve_on_one_mesh(given, progress, folder, before)


def _refined(
    given: GivenHousing,
    accuracy: float,
    inputs: dict[str, Any],
    progress: Progress,
    before: Callable[[Mesh], None] | None,
) -> HousingModes:
    """Solve the housing on finer and finer meshes, until every mode's estimated error is within the accuracy."""
    table = given.table
    size = None
    if table.box is not None:
        size = box_mesh_size(table.box, given.materials[table.material], table.frequency_limit)

    def solve(size: float | None) -> HousingModes:
        # Without a size the mesher takes a coarse one by the walls' thickness.
        trial = given if size is None else replace(given, table=table.meshed_by(size))
        return _solve_on_one_mesh(trial, progress, None, before)

    with refused_by_key(table):
        solved = refined_modes(solve, accuracy, size, progress)
    return replace(solved, record=replace(solved.record, inputs=inputs))


def _solve_on_one_mesh(
    given: GivenHousing, progress: Progress, folder: Path | None, before: Callable[[Mesh], None] | None
) -> HousingModes:
    """Mesh the housing and solve its modes, or read them from the mode cache; see :func:`solve_housing`."""
    begin, table = time.perf_counter(), given.table
    remarks: list[str] = []
    mesh = None
    if table.mesh is not None:
        mesh = build_mesh(table, given.materials, given.files, remarks.append)
    inputs = given.cache_inputs(mesh)
    record, spoilt = (None, None) if folder is None else read_mode_cache(folder, inputs)
    defects: tuple[MeshDefect, ...] = ()
    if record is not None and folder is not None:
        mesh, warnings = record.mesh, list(record.notes["warnings"])
        progress(f"modes read from {folder / MODE_CACHE_FILE} (unchanged housing)")
    else:
        if mesh is None:
            progress("meshing the housing")
            mesh = build_mesh(table, given.materials, given.files, remarks.append)
        warnings = [warning("geometry", remark) for remark in remarks]
        defects = allowed_defects(table, build_fixtures(table, given.materials), mesh)
    meshed = time.perf_counter() - begin
    with noted_on_failure([*warnings, *defect_warnings(defects)]):
        # Places come before the modes: their errors appear before the long work.
        check_places(table, mesh)
        if before is not None:
            before(mesh)
        described = describe_housing(table, given.materials, mesh, given.up)
        with refused_by_key(table):
            if record is None:
                solved = _solve_modes(given, described, defects, progress)
            else:
                solved = _of_record(given, described, record)
    of_reading = {"mesh": 0.0, "assembly": 0.0, "factorisation": 0.0, "eigensolver": 0.0, "reading": meshed}
    seconds = {"mesh": meshed, **solved.seconds} if record is None else of_reading
    seconds["total"] = time.perf_counter() - begin
    solved = replace(solved, seconds=seconds, file_warnings=[] if spoilt is None else [warning("modes file", spoilt)])
    if record is not None and folder is not None:
        return replace(solved, source=folder / MODE_CACHE_FILE, source_holds=record.sensors == solved.record.sensors)
    warnings += solved.record.notes["warnings"]
    notes = {**solved.record.notes, "seconds": seconds, "warnings": warnings}
    # Regions take the place of the file's volumes in the description; the file of modes keeps the mesh itself.
    return replace(solved, record=replace(solved.record, mesh=mesh, inputs=inputs, notes=notes))


def _solve_modes(
    given: GivenHousing, described: DescribedHousing, defects: tuple[MeshDefect, ...], progress: Progress
) -> HousingModes:
    """Solve the modes of a housing as its table asks for them."""
    table = given.table
    return described.modes(
        below_hz=table.frequency_limit,
        count=table.modes,
        bearings=given.bearings,
        solver=table.solver,
        defects=defects,
        progress=progress,
    )


def _of_record(given: GivenHousing, described: DescribedHousing, record: ModeRecord) -> HousingModes:
    """Return the housing with modes that are solved, and its own sensors."""
    record = with_sensors(record, described.sensor_ports().values())
    return HousingModes(described, record, given.bearings)


def with_modes_of(case: Case, solved: HousingModes, command: str = "modes") -> HousingModes | None:
    """Return the housing of a case with modes that are solved, and its own damping and sensors; None if it has others.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        As :func:`solve_housing`.
    """
    given = given_housing(case, command)
    if content_key(given.cache_inputs(solved.mesh)) != solved.record.key:
        return None
    described = describe_housing(given.table, given.materials, solved.mesh, given.up)
    with refused_by_key(given.table):
        return _of_record(given, described, solved.record)


def kept_housing(case: Case, folder: Path | None, progress: Progress = silent) -> HousingModes | None:
    """Return the housing of a case from the modes that a results folder keeps; None where it keeps none of it.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        As :func:`solve_housing`.
    """
    if folder is None or case.housing is None or not (folder / MODE_CACHE_FILE).exists():
        return None
    given = given_housing(case)
    mesh = None if given.table.mesh is None else build_mesh(given.table, given.materials, given.files)
    record, _ = read_mode_cache(folder, given.cache_inputs(mesh))
    return None if record is None else solve_housing(case, progress, folder=folder)


def write_mode_cache(place: Path, solved: HousingModes) -> None:
    """Write a solved housing's modes, unless the file that they were read from holds them, sensors and all."""
    if not solved.source_holds:
        write_modes(place / MODE_CACHE_FILE, solved.record)
