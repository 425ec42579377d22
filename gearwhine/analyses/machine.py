"""Analyses of rotors and gear pairs, and of the machine that they make with the housing."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.analyses import of_machine
from gearwhine.analyses.of_machine import MachineUnderLoad, RadiatingHousing
from gearwhine.analyses.result import Result
from gearwhine.case import Case, CaseError, CaseSource, Problem, require, swept_keys
from gearwhine.case.analysis_speeds import branch_speeds, diagram_speeds
from gearwhine.coupling.analyses.gear_pairs import PairAnalysis, solve_over_torques
from gearwhine.coupling.analyses.loaded_machine import load_machine
from gearwhine.coupling.analyses.modes_and_responses import MESH_HARMONICS, SolvedSystem
from gearwhine.coupling.analyses.shafts_alone import held_speeds
from gearwhine.coupling.analyses.steady_state import SolvedSteady
from gearwhine.coupling.description.excitation import Run
from gearwhine.coupling.gears.loaded.optimal_relief import ReliefAim
from gearwhine.from_case.machine import describe_machine, require_machine
from gearwhine.mode_pictures import draw_load_pictures
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.output.dataset import labelled, labels_of
from gearwhine.output.quantity import add_warnings, joined
from gearwhine.results.housing import origin_document
from gearwhine.results.operating_point import LOAD, LOAD_OPTIONS, LOAD_SAME, load_document
from gearwhine.rotors.analyses.solved_rotor import SolvedRotor
from gearwhine.solve.acoustics import acoustics_of, check_before_modes, refused_by_key, sound_left_out
from gearwhine.solve.damping import assumed_mesh_damping
from gearwhine.solve.gear_pairs import aims_at_sensor, analyse_pairs, relief_aims
from gearwhine.solve.housing_modes import SolvedHousing, kept_housing, solve_housing
from gearwhine.solve.machine import reduce_housing, run_of, solve_pairs
from gearwhine.solve.operating_point import (
    SolvedLoad,
    find_load,
    load_of_case,
    load_warnings,
    require_load,
    sensitivity_warnings,
)
from gearwhine.solve.rotors import solve_rotors, write_ross_files
from gearwhine.solve.sensitivity.ranking import solve_load_sensitivity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from gearwhine.coupling.sound.acoustics import Acoustics
    from gearwhine.coupling.sound.solution import SolvedSound
    from gearwhine.figures.rotors.assembly import RotorAssembly
    from gearwhine.sweep.run import SweptPoint


def rotors(
    case: Case, *, write_ross: bool = False, progress: Progress = silent, **settings: Any
) -> Result[tuple[SolvedRotor, ...]]:
    """Find lateral and torsional modes, whirl and critical speeds of each rotor.

    Parameters
    ----------
    case : Case
    write_ross : bool
        Whether the result writes each rotor with its bearings as a file that ROSS loads, too.
    progress : callable
    **settings
        Attributes of :class:`gearwhine.rotors.analyses.solved_rotor.RotorSettings` in place of those of the case.

    Raises
    ------
    CaseError, gearwhine.rotors.RotorError
        Where the case has no rotors, or one cannot be solved as it stands.
    gearwhine.rotors.IncompleteModesError
        Where modes fail their certificate.
    """
    solved = solve_rotors(case, progress, **settings)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        remarks = write_ross_files(place, solved) if write_ross else ()
        return {"warnings": [warning("ross", remark) for remark in remarks]}

    def assemblies() -> list["RotorAssembly"]:
        from gearwhine.figures.rotors import rotor_assembly

        return [rotor_assembly(case, one.rotor, one.bearings) for one in solved]

    return replace(of_machine.solved_rotors(solved, labels_of(case), assemblies), case=case, _files=files)


def gears(
    case: Case,
    *,
    aims: Sequence[ReliefAim] = (),
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    progress: Progress = silent,
) -> Result[tuple[PairAnalysis, ...]]:
    """Analyse each gear pair: geometry, mesh stiffness, transmission error, load sharing, pressure, best tip relief.

    Parameters
    ----------
    case : Case
    aims : sequence of ReliefAim, optional
        Objective of the best relief of each pair, in place of those of the case.
    housing : SolvedHousing, optional
        Housing where it is solved already. It is solved here for a tip relief whose aim names a sensor alone; without
        one a misalignment that is found is that of rigid seats, with a warning, and the best relief aims at no
        sensor.
    folder : path, optional
        Results folder, whose housing modes are read where it keeps them.
    progress : callable

    Raises
    ------
    CaseError, gearwhine.coupling.gears.GearError, gearwhine.coupling.CouplingError
        Where the case has no gear pairs, or one cannot be solved as it stands, or in the machine where a tip relief
        aims at a sensor.
    """
    require(case, "gear_pair", command="gears")
    if housing is None and case.housing is not None and case.rotor and case.operation is not None:
        if aims_at_sensor(case):
            housing = solve_housing(case, progress, folder=folder)
        elif case.housing.sensor or any(case.parts.finds_misalignment(pair) for pair in case.gear_pair):
            housing = kept_housing(case, folder, progress)
    loaded, point = solve_pairs(case, housing, progress)
    analysed = analyse_pairs(case, loaded, point)
    if aims:
        of_machine.require_aims(aims, len(analysed))
        analysed = tuple(replace(pair, aim_given=True) for pair in analysed)
    else:
        aims = relief_aims(case, loaded, progress, point=point, housing=housing, folder=folder)
    pairs = solve_over_torques(analysed, progress, aims)
    seats = None if point is None or case.housing is None else "rigid" if housing is None else "housing"
    return replace(of_machine.analysed_gears(pairs, labels_of(case), seats), case=case)


def operating_point(
    case: Case,
    *,
    over_torque: bool = False,
    sensitivity: bool = False,
    line: str | None = None,
    rigid_seats: bool = False,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[SolvedLoad]:
    """Find the static equilibrium of the machine: bearing loads, deflections, misalignment and load of the gear faces.

    Parameters
    ----------
    case : Case
    over_torque : bool
        Whether to solve for the equilibria from 10 to 150 % of the torque as well.
    sensitivity : bool
        Whether to rank walls, bearing stiffness and positions by their influence on gear pairs, on sensors' lines and,
        of a case with acoustics, on the sound power of the loudest lines.
    line : str, optional
        Line that is ranked and drawn: a sensor's name, also with its frequency, ``roof@1377``, or a line of the sound,
        ``sound@1377``; by default the highest, and the A-weighted sound power of the loudest together. It implies
        ``sensitivity``.
    rigid_seats : bool
        Whether to leave the housing out and hold the bearings in rigid seats, as in a case without one.
    housing, folder, fresh, progress
        As :func:`gearwhine.analyses.housing.modes`.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine, nothing loads it, or a load drives a motion that nothing holds.
    gearwhine.coupling.EquilibriumNotFoundError
        Where no equilibrium is found.
    """
    require_load(case)
    ranked = sensitivity or line is not None
    if rigid_seats:
        housing = None
    elif housing is None and case.housing is not None:
        refuse = check_before_modes(case) if ranked else None
        housing = solve_housing(case, progress, folder=folder, fresh=fresh, before=refuse)
    part = None if housing is None else reduce_housing(case, housing, progress)
    machine = describe_machine(case, part)
    solved = load_of_case(case, machine, progress, over_torque=over_torque, over_hunting_period=True)
    warnings = load_warnings(solved)
    if ranked:
        ranking = solve_load_sensitivity(case, machine, solved.point, housing, progress, line=line)
        solved, warnings = replace(solved, sensitivity=ranking), [*warnings, *sensitivity_warnings(ranking)]
    document = load_document(case.title, solved)
    add_warnings(document, warnings)

    def figures(progress: Progress) -> "Iterator[tuple[str, Figure]]":
        from gearwhine.figures import draw_load

        return draw_load(solved)

    def files(place: Path, *, pictures: bool) -> dict[str, Any]:
        return {"warnings": draw_load_pictures(housing, solved, place, progress)} if pictures else {}

    return Result(
        "load",
        case,
        solved,
        joined(document, {} if housing is None else origin_document(housing)),
        _arrays=lambda: labelled(labels_of(case), (LOAD, solved)),
        _figures=figures,
        _files=files,
        _housing=housing,
        _options=(LOAD_OPTIONS, LOAD_SAME),
    )


def loaded_case(
    case: Case, housing: SolvedHousing | None, run: Run | None, progress: Progress = silent
) -> MachineUnderLoad:
    """Find the operating point of a case in its solved housing, and assemble its machine about that.

    ``run`` is the course of speed and torques over time; without one, they are those of operation.
    """
    part = None if housing is None else reduce_housing(case, housing, progress)
    machine = describe_machine(case, part)
    load, warnings = find_load(case, machine, progress)
    loaded = load_machine(machine, None if load is None else load.point, run, progress)
    return MachineUnderLoad(case.title, loaded, load, warnings, case, housing)


def _housing_of(
    case: Case, housing: SolvedHousing | None, folder: Path | None, progress: Progress, *, fresh: bool
) -> SolvedHousing | None:
    """Return the solved housing of a case whose parts make a machine; None without one."""
    require_machine(case)
    if housing is None and case.housing is not None:
        return solve_housing(case, progress, folder=folder, fresh=fresh)
    return housing


def system(
    case: Case,
    *,
    mesh_phase: float | None = None,
    campbell: bool = False,
    sidebands: int = 0,
    mesh_harmonics: int = MESH_HARMONICS,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[SolvedSystem]:
    """Find the complex natural modes of the coupled machine, and what reaches bearings and sensors.

    Parameters
    ----------
    case : Case
    mesh_phase : float, optional
        Part of the mesh period of the first pair about whose stiffness to linearise; the mean by default.
    campbell : bool
        Whether to follow the modes over speed; a case with a `[sweep]` of speeds always does.
    sidebands : int
        Number of shaft-order sidebands drawn on each side of every mesh order.
    mesh_harmonics : int
        Number of harmonics of each mesh whose resonances over speed are listed and drawn; more than by default ask for
        the Campbell diagram.
    housing, folder, fresh, progress
        As :func:`gearwhine.analyses.housing.modes`.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine.
    gearwhine.coupling.ModesError
        Where the modes fail their certificate.
    """
    require(case, "rotor", "operation", command="system")
    if mesh_phase is not None:
        require(case, "gear_pair", command="system --mesh-phase")
    loaded = loaded_case(case, _housing_of(case, housing, folder, progress, fresh=fresh), run_of(case), progress)
    operation = case.operation
    assert operation is not None
    swept = case.sweep is not None and len(case.sweep.speeds) > 1
    over_speed = campbell or swept or sidebands > 0 or mesh_harmonics > MESH_HARMONICS
    return of_machine.system(
        loaded,
        mesh_phase=mesh_phase,
        over_speed=diagram_speeds(operation, case.sweep, held_speeds(loaded.loaded.machine)) if over_speed else (),
        sidebands=sidebands,
        mesh_harmonics=mesh_harmonics,
        progress=progress,
    )


def steady(
    case: Case,
    *,
    curve: bool = False,
    down: bool = False,
    points: int = 100,
    exact: bool = False,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> Result[SolvedSteady]:
    """Find the periodic motion at the speed of operation, its stability, and its branch over speed.

    Parameters
    ----------
    case : Case
        Its `[transient]` takes no part: of a run whose speed varies the motion is that at the speed and torque of
        operation.
    curve : bool
        Whether to follow the motion over speed.
    down : bool
        Whether to follow it from the highest speed downwards.
    points : int
        Number of points on a straight curve.
    exact : bool
        Whether to solve the common period of all excitations however long it is.
    housing, folder, fresh, progress
        As :func:`gearwhine.analyses.housing.modes`.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError
        Where the parts do not make a machine.
    gearwhine.coupling.PeriodicError
        Where no periodic motion is found.
    """
    require(case, "rotor", "operation", command="steady")
    assert case.operation is not None
    if case.operation.speed == 0.0:
        raise CaseError([Problem("operation.speed", 0.0, "a speed: what stands still has no motion that repeats")])
    solved_housing = _housing_of(case, housing, folder, progress, fresh=fresh)
    loaded = loaded_case(case, solved_housing, None, progress)
    held = held_speeds(loaded.loaded.machine)

    def with_assumed_damping(solved: SolvedSteady) -> SolvedSteady:
        return solved if solved.curve is None else replace(solved, assumed_damping=assumed_mesh_damping(case))

    return of_machine.steady(
        loaded,
        over_speed=branch_speeds(case.operation, case.sweep, held, downwards=down) if curve or down else None,
        points=points,
        exact=exact,
        change=with_assumed_damping,
        progress=progress,
    )


def sound(
    case: Case,
    *,
    acoustics: "Acoustics | None" = None,
    housing: SolvedHousing | None = None,
    folder: Path | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> "Result[SolvedSound]":
    """Find the sound that the housing radiates: of its modes, and of the lines of the steady motion.

    Parameters
    ----------
    case : Case
        Case with `[housing]`; without `[acoustics]` boundary elements in free air are taken. Without rotors and an
        operation the sound is that of the modes alone.
    acoustics : Acoustics, optional
        Method and medium, floor and microphones, in place of those of `[acoustics]`.
    housing, folder, fresh, progress
        As :func:`gearwhine.analyses.housing.modes`.

    Raises
    ------
    CaseError, gearwhine.coupling.CouplingError, gearwhine.coupling.PeriodicError
        Where the parts do not make a machine, no periodic motion is found, or the housing cannot be wrapped.
    gearwhine.housing.HousingError
        Where the power through the surface and in the far field differ by more than 10 %, or a known source inside is
        lost at a vertex of the surface.
    """
    # The checks of the surface are for this analysis alone.
    from gearwhine.coupling.sound.acoustics_checks import require_acoustics

    require(case, "housing", command="sound")
    refuse = check_before_modes(case) if acoustics is None else None
    if housing is None:
        housing = solve_housing(case, progress, folder=folder, fresh=fresh, before=refuse)
    elif refuse is not None:
        refuse(case, housing.mesh)
    field = housing.displacement_field
    if acoustics is not None:
        require_acoustics(acoustics, field.mesh, field.widest_bore, acoustics.limit_hz(field))
    acoustics = acoustics or acoustics_of(case)
    machine, warnings = None, list[ResultWarning]()
    if case.rotor and case.operation is not None:
        warnings = sound_left_out(case.model_copy(update={"transient": None}))
        if not warnings:
            require_machine(case)
            machine = loaded_case(case, housing, None, progress)
    radiating = RadiatingHousing(field, acoustics, labels_of(case), housing.up, case, housing)
    with refused_by_key(acoustics):
        return of_machine.sound(radiating, machine, warnings, progress)


def sweep(
    case: Case,
    source: CaseSource,
    over: Sequence[str],
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    fresh: bool = False,
    progress: Progress = silent,
) -> "Result[Sequence[SweptPoint]]":
    """Integrate the transient at every point of a sweep, in parallel.

    Parameters
    ----------
    case : Case
    source : CaseSource
        Content that the case is made of, from which the points are made, too.
    over : sequence of str
        Values of keys, such as ``operation.torque=10 N*m:100 N*m:10``; beside the speeds of `[sweep]`.
    folder : path
        Folder of the points; those that it holds already are not solved again.
    workers : int, optional
        Number of processes; as many as cores by default.
    scheduler : str, optional
        Address of a running Dask scheduler, whose workers are used instead.
    fresh : bool
        Whether to solve all points anew.
    progress : callable

    Raises
    ------
    CaseError
        Where a key cannot be swept.
    gearwhine.failures.WorkersError
        Where the processes do not start.
    """
    start = time.perf_counter()
    keys = swept_keys(case, over)
    from gearwhine.sweep import collected_sweep, missed_peaks, run_sweep, sweep_document, sweep_points
    from gearwhine.workers import default_workers

    points = sweep_points(source, keys)
    count = workers or default_workers()
    swept = run_sweep(points, folder, progress, workers=count, scheduler=scheduler, fresh=fresh)
    sound_warnings: list[dict[str, Any]] = []
    housing, radiated = None, None
    # The points need not have the housing and the acoustics of the case, even where all of them share one.
    sounding = next((point.case for point in points if point.case.acoustics and point.case.housing), None)
    if sounding is not None:
        from gearwhine.sweep.sound import add_sound

        sound_warnings, housing, radiated = add_sound(
            sounding, keys, swept, solve_housing(sounding, progress, folder=folder), progress
        )
    peaks = missed_peaks(keys, swept, radiated)
    dataset = collected_sweep(case, keys, swept, peaks)
    document = {"title": case.title} | sweep_document(keys, swept, peaks)
    add_warnings(document, sound_warnings)
    document["workers"] = count if scheduler is None else None
    document["seconds"] = {"total": time.perf_counter() - start}

    def figures(progress: Progress) -> "Iterator[tuple[str, Figure]]":
        from gearwhine.figures import draw_sweep

        return draw_sweep(case.title, dataset)

    return Result(
        "sweep",
        case,
        swept,
        document,
        _arrays=lambda: dataset,
        _figures=figures,
        _data_file="sweep.nc",
        _housing=housing,
        _started=start,
    )
