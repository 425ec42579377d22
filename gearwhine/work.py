"""What each command does: stages, then files, then the document that it prints."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from gearwhine.case import Case, CaseError, Problem, bundled_case, bundled_cases, dump_case, mesh_frequencies, require
from gearwhine.output import finite, json_text, staging
from gearwhine.progress import Progress
from gearwhine.stages import gears as gear_stage
from gearwhine.stages import geometry as geometry_stage
from gearwhine.stages import housing as housing_stage
from gearwhine.stages import machine as machine_stage
from gearwhine.stages import rotors as rotor_stage
from gearwhine.stages import transient as transient_stage

_MOST_MODES = 5000


def run_case(case: Case, folder: Path, progress: Progress) -> dict[str, Any]:
    """Everything that the case asks for, and the results folder."""
    from gearwhine import figures, results
    from housing import pictures

    if case.transient is not None:
        require(case, "rotor", "operation", command="run")
    if case.housing is not None:
        # Found out before the work, not after it.
        pictures.load_pyvista()
    start = time.perf_counter()
    seconds: dict[str, float] = {}
    document: dict[str, Any] = {"title": case.title}

    def timed(name: str, begin: float) -> None:
        seconds[name] = time.perf_counter() - begin

    begin = time.perf_counter()
    rotors = rotor_stage.solve_rotors(case, progress) if case.rotor else ()
    pairs = gear_stage.solve_gears(case, progress) if case.gear_pair else ()
    timed("rotors_and_gears", begin)
    begin = time.perf_counter()
    housing = housing_stage.solve_housing(case, progress) if case.housing else None
    timed("housing", begin)
    if rotors:
        document |= rotor_stage.rotors_document(rotors)
    if pairs:
        document |= gear_stage.gears_document(pairs)
    comparison = None
    if housing is not None:
        document["housing"] = housing_stage.modes_document(housing)
        document["warnings"] = list(housing.warnings)
        if case.measured is not None:
            comparison = housing_stage.compare_housing(case, housing)
            document["compare"] = housing_stage.comparison_document(comparison, housing)

    transient, system_modes = None, None
    if case.rotor and case.operation:
        begin = time.perf_counter()
        machine = machine_stage.build_machine(case, housing, pairs, progress)
        system_modes = machine_stage.coupled_modes(machine)
        document["system"] = machine_stage.system_document(case, machine, system_modes, housing)
        timed("system", begin)
        if case.transient is not None:
            begin = time.perf_counter()
            transient = transient_stage.solve_transient(
                case, machine, mesh_frequencies(case), progress, housing=housing
            )
            document |= transient_stage.transient_document(case, transient)
            timed("transient", begin)
            seconds["time_stepping"] = transient.result.seconds

    begin = time.perf_counter()
    with staging(folder) as place:
        progress("writing results")
        (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        results.write(place / "results.nc", case, housing, rotors, pairs, system_modes, transient)
        if pairs:
            figures.draw_gear_pairs(place, pairs)
        if transient is not None:
            figures.draw_transient(place, case, transient, housing, comparison)
        if housing is not None:
            _draw_modes(housing, comparison, "dominant", "iso", place, progress)
        timed("writing", begin)
        seconds["total"] = time.perf_counter() - start
        document |= {"seconds": seconds, "folder": str(folder), "files": [*_names(place), "summary.json"]}
        (place / "summary.json").write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    return document


def mesh_case(case: Case, folder: Path, suffix: str, progress: Progress) -> dict[str, Any]:
    """Mesh the housing and write the mesh file."""
    from meshes import mesh_quality, write_mesh

    progress("meshing the housing")
    warnings: list[str] = []
    mesh = geometry_stage.build_mesh(case, warnings.append)
    quality = mesh_quality(mesh)
    name = f"mesh.{suffix}"
    with staging(folder) as place:
        write_mesh(mesh, place / name)
    return {
        "mesh": {"nodes": len(mesh.points), "elements": mesh.n_elements, "dofs": 3 * len(mesh.points)},
        "order": mesh.order,
        "surfaces": {surface: sum(map(len, facets)) for surface, facets in sorted(mesh.surfaces.items())},
        "volume_m3": quality.volume,
        "edge_length_m": dict(zip(("min", "median", "max"), quality.edge_length, strict=True)),
        "shape_number": dict(zip(("min", "median"), quality.shape, strict=True)),
        "bores": geometry_stage.bores_document(mesh),
        "warnings": warnings,
        "folder": str(folder),
        "files": [name],
    }


def modes_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The housing's modes; with a folder, also as VTU and in a results file."""
    from gearwhine import results

    housing = housing_stage.solve_housing(case, progress)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, housing, (), (), None, None)
        results.write_shapes(place / "modes.vtu", housing)

    return _kept(housing_stage.modes_document(housing), case, folder, write)


def rotors_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The rotors; with a folder, also as a results file."""
    from gearwhine import results

    rotors = rotor_stage.solve_rotors(case, progress)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, None, rotors, (), None, None)

    return _kept(rotor_stage.rotors_document(rotors), case, folder, write)


def gears_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The gear pairs; with a folder, also as a results file and a picture."""
    from gearwhine import figures, results

    pairs = gear_stage.solve_gears(case, progress)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, None, (), pairs, None, None)
        figures.draw_gear_pairs(place, pairs)

    return _kept(gear_stage.gears_document(pairs), case, folder, write)


def system_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The coupled modes."""
    housing, _, machine = machine_stage.solve_machine(case, progress)
    modes = machine_stage.coupled_modes(machine)
    return _kept(machine_stage.system_document(case, machine, modes, housing), case, folder)


def compare_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """Model modes against measured ones."""
    require(case, "housing", "measured", command="compare")
    housing = housing_stage.solve_housing(case, progress)
    comparison = housing_stage.compare_housing(case, housing)
    return _kept(housing_stage.comparison_document(comparison, housing), case, folder)


def render_case(case: Case, folder: Path, which: str, view: str, progress: Progress) -> dict[str, Any]:
    """Pictures of mode shapes."""
    if which not in ("dominant", "all"):
        parse_numbers(which, None)
    from housing import pictures

    pictures.load_pyvista()
    housing = housing_stage.solve_housing(case, progress, command="render")
    comparison = None
    if case.measured is not None and housing.strengths is not None:
        comparison = housing_stage.compare_housing(case, housing)
    with staging(folder) as place:
        files = _draw_modes(housing, comparison, which, view, place, progress)
    return {"folder": str(folder), "files": files}


def list_examples() -> dict[str, Any]:
    """The bundled cases and their titles."""
    return {"examples": [{"name": name, "title": title} for name, title in bundled_cases().items()]}


def copy_example(name: str | None, folder: Path) -> dict[str, Any]:
    """Copy a bundled case into a folder; a file of that name there is left alone."""
    known = ", ".join(bundled_cases())
    source = bundled_case(name) if name is not None else None
    if source is None:
        raise CaseError([Problem("examples copy", name, f"one of: {known}")])
    target = folder / source.name
    if target.exists():
        raise CaseError([Problem("examples copy", str(target), "a place where no file of that name stands yet")])
    content = source.read_text(encoding="utf-8")
    with staging(folder) as place:
        (place / source.name).write_text(content, encoding="utf-8")
    return {"folder": str(folder), "files": [source.name]}


def parse_numbers(text: str, count: int | None) -> list[int]:
    """Mode numbers from text such as ``1,4-6``; ``count`` is how many modes there are, where that is known.

    Raises
    ------
    CaseError
        For anything else, or a mode that does not exist.
    """
    numbers: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        if not first.strip().isdecimal() or (last and not last.strip().isdecimal()):
            raise CaseError([Problem("--modes", text, "'dominant', 'all', or numbers such as '1,4,9' or '1-6'")])
        if int(last or first) > _MOST_MODES:
            raise CaseError([Problem("--modes", text, f"mode numbers of at most {_MOST_MODES}")])
        numbers += range(int(first), int(last or first) + 1)
    missing = [number for number in numbers if number < 1 or (count is not None and number > count)]
    if missing or not numbers:
        raise CaseError(
            [Problem("--modes", text, f"mode numbers from 1 to {count if count is not None else 'the last'}")]
        )
    return numbers


def _draw_modes(
    housing: housing_stage.SolvedHousing, comparison: Any, which: str, view: str, place: Path, progress: Progress
) -> list[str]:
    from housing import pictures

    count = len(housing.modes.frequencies)
    notes = {}
    if comparison is not None:
        notes = {
            pair.mode: f"measured {pair.measured / 6.283185307179586:.0f} Hz ({pair.error_percent:+.1f} %)"
            for pair in comparison.pairs
        }
    if which == "all":
        numbers = list(range(1, count + 1))
    elif which == "dominant":
        numbers = sorted(notes) if notes else housing_stage.strongest_modes(housing, 8)
    else:
        numbers = parse_numbers(which, count)
    files = pictures.render_modes(
        housing.mesh, housing.modes, numbers, place, notes=notes, view=view, progress=progress
    )
    if len(numbers) > 1:
        progress("drawing all on one sheet")
        sheet = place / "modes.png"
        files.append(pictures.render_gallery(housing.mesh, housing.modes, numbers, sheet, notes=notes, view=view))
    return [path.name for path in files]


def _kept(
    document: dict[str, Any],
    case: Case,
    folder: Path | None,
    write: Callable[[Path], None] = lambda place: None,
) -> dict[str, Any]:
    """The document; where a folder is given, also in it, with the resolved case and what ``write`` adds."""
    if folder is None:
        return document
    with staging(folder) as place:
        (place / "case.toml").write_text(dump_case(case), encoding="utf-8")
        write(place)
        document |= {"folder": str(folder), "files": [*_names(place), "summary.json"]}
        (place / "summary.json").write_text(json_text(finite(document)) + "\n", encoding="utf-8")
    return document


def _names(place: Path) -> list[str]:
    return sorted(str(path.relative_to(place)) for path in place.rglob("*") if path.is_file())
