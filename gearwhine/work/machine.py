"""What the commands on rotors, gears and the machine do: stages, then files, then the document that is printed."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gearwhine.case import Case, swept_keys
from gearwhine.doubtful import add_warnings, joined, warning
from gearwhine.progress import Progress
from gearwhine.stages import (
    gear_analysis,
    gear_documents,
    gear_torques,
    housing_documents,
    relief_aims,
    rotor_documents,
)
from gearwhine.stages import gears as gear_stage
from gearwhine.stages import machine as machine_stage
from gearwhine.stages import rotors as rotor_stage
from gearwhine.stages import steady as steady_stage
from gearwhine.stages import system as system_stage
from gearwhine.stages.instability import machine_warnings, unstable_modes_warnings
from gearwhine.stages.system_documents import system_document
from gearwhine.stages.uncertainty import add_uncertainty
from gearwhine.work.results_folder import kept_in


def rotors_case(case: Case, folder: Path | None, progress: Progress, *, write_ross: bool = False) -> dict[str, Any]:
    """The rotors; with a folder, also as a results file and pictures, and where asked as files that ROSS loads."""
    from gearwhine import figures, results

    rotors = rotor_stage.solve_rotors(case, progress)
    document = rotor_documents.rotors_document(rotors)

    def write(place: Path) -> None:
        results.write(place / "results.nc", case, None, rotors, (), None, None)
        figures.draw_rotors(place, case, rotors, progress)
        if write_ross:
            remarks = rotor_stage.write_ross_files(place, rotors)
            add_warnings(document, [warning("ross", remark) for remark in remarks])

    return kept_in("rotors", document, case, folder, write)


def gears_case(case: Case, folder: Path | None, progress: Progress) -> dict[str, Any]:
    """The gear pairs, over torques too; with a folder, also as a results file and pictures."""
    solved = gear_stage.solve_gears(case, progress)
    aims = relief_aims.relief_aims(case, solved, progress, folder=folder)
    pairs = gear_torques.over_torques(gear_analysis.analyse_pairs(case, solved), progress, aims)

    def write(place: Path) -> None:
        from gearwhine import figures, results

        results.write(place / "results.nc", case, None, (), pairs, None, None)
        figures.draw_gear_pairs(place, pairs, progress)

    return kept_in("gears", gear_documents.gears_document(pairs), case, folder, write)


def system_case(
    case: Case,
    folder: Path | None,
    progress: Progress,
    *,
    mesh_phase: float | None = None,
    over_speed: bool = False,
    sidebands: int = 0,
    fresh: bool = False,
) -> dict[str, Any]:
    """The coupled modes, over speed too where the case sweeps or it is asked for; with a folder, also as pictures."""
    housing, pairs, machine = machine_stage.solve_machine(case, progress, folder=folder, fresh=fresh)
    swept = case.sweep is not None and len(case.sweep.speeds) > 1
    solved = system_stage.solve_system(
        case, machine, housing, progress, mesh_phase=mesh_phase, over_speed=over_speed or swept, sidebands=sidebands
    )
    document = system_document(case, solved, housing)
    add_warnings(document, unstable_modes_warnings(solved.stability))
    error = machine_stage.basis_error(case, machine, housing, pairs, progress)
    add_uncertainty(document, error, document["trusted_below_hz"])

    def write(place: Path) -> None:
        from gearwhine import figures, results

        progress("writing results")
        results.write(place / "results.nc", case, housing, (), (), solved, None)
        figures.draw_system(place, case, solved)

    return kept_in("system", joined(document, housing_documents.origin_document(housing)), case, folder, write, housing)


def steady_case(
    case: Case,
    folder: Path | None,
    progress: Progress,
    *,
    over_speed: bool = False,
    downwards: bool = False,
    points: int = 100,
    exact: bool = False,
    fresh: bool = False,
) -> dict[str, Any]:
    """The motion that repeats at the speed of operation, and its branch over speed; with a folder, also as pictures."""
    housing, pairs, machine = machine_stage.solve_machine(case, progress, folder=folder, fresh=fresh)
    solved = steady_stage.solve_steady(
        case, machine, housing, progress, over_speed=over_speed, downwards=downwards, points=points, exact=exact
    )
    document = steady_stage.steady_document(case, solved)
    add_warnings(document, machine_warnings(machine))
    error = machine_stage.basis_error(case, machine, housing, pairs, progress)
    add_uncertainty(document, error, document["trusted_below_hz"])

    def write(place: Path) -> None:
        from gearwhine import figures, results

        progress("writing results")
        results.write(place / "results.nc", case, housing, (), (), None, None, steady=solved)
        figures.draw_steady(place, case, solved)

    return kept_in("steady", joined(document, housing_documents.origin_document(housing)), case, folder, write, housing)


def sweep_case(
    case: Case,
    source: tuple[str, Sequence[str]],
    over: Sequence[str],
    folder: Path,
    progress: Progress,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
) -> dict[str, Any]:
    """The transient at every point of a sweep, gathered in one file and drawn.

    ``source`` is what the case was read from: the name, and the changes by ``--set``.
    """
    start = time.perf_counter()
    keys = swept_keys(case, over)
    from gearwhine import sweep

    points = sweep.sweep_points(*source, keys)
    count = workers or sweep.default_workers()
    swept = sweep.conduct_sweep(points, folder, progress, workers=count, scheduler=scheduler, fresh=fresh)
    dataset = sweep.gathered(case, keys, swept)
    document = {"title": case.title} | sweep.sweep_document(keys, swept)
    document["workers"] = count if scheduler is None else None

    def write(place: Path) -> None:
        from gearwhine.figures import draw_sweep

        progress("writing results")
        dataset.to_netcdf(place / "sweep.nc", engine="h5netcdf")
        draw_sweep(place, case.title, dataset)
        document["seconds"] = {"total": time.perf_counter() - start}

    return kept_in("sweep", document, case, folder, write)
