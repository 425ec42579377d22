"""Result of a sweep: the transients of its points, collected over the swept keys, with their sound."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gearwhine.analyses.origin import Origin
from gearwhine.analyses.result import Result
from gearwhine.case import CaseSource, SweptKey
from gearwhine.coupling import Machine
from gearwhine.coupling.analyses.recording import TransientPlan
from gearwhine.coupling.sweep.missed_peaks import RadiatedLevel
from gearwhine.numerics.progress import Progress, silent
from gearwhine.numerics.result_warnings import ResultWarning
from gearwhine.output.quantity import add_warnings
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.study_folder import StudyFolder
from gearwhine.sweep import collected_sweep, missed_peaks, run_sweep, sweep_document, sweep_points
from gearwhine.sweep.grid import AnyPoint, SweptPoint
from gearwhine.sweep.machine_sweep import sweep_speeds
from gearwhine.sweep.points import GridPoint, Point
from gearwhine.workers import default_workers

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def solve_sweep(
    origin: Origin, source: CaseSource, keys: Sequence[SweptKey], folder: StudyFolder
) -> Result[Sequence[SweptPoint[Point]]]:
    """Integrate the transient at every point of a sweep, in parallel.

    Parameters
    ----------
    origin : Origin
        Origin of the result, without a housing.
    source : CaseSource
        Content that the case is made of, from which the points are made, too.
    keys : sequence of SweptKey
    folder : StudyFolder

    Raises
    ------
    gearwhine.failures.WorkersError
        Where the processes do not start.
    """
    start = time.perf_counter()
    points = sweep_points(source, keys)
    workers = folder.workers or default_workers()
    swept = run_sweep(points, replace(folder, workers=workers))
    sound_warnings: list[dict[str, Any]] = []
    housing, radiated = None, None
    # The points need not have the housing and the acoustics of the case, even where all of them share one.
    sounding = next((point.case for point in points if point.case.acoustics and point.case.housing), None)
    if sounding is not None:
        from gearwhine.sweep.sound import add_sound

        solved = solve_housing(sounding, folder.progress, folder=folder.path)
        sound_warnings, housing, radiated = add_sound(sounding, keys, swept, solved, folder.progress)
    started = workers if folder.scheduler is None else None
    return _result(replace(origin, housing=housing), keys, swept, start, radiated, sound_warnings, started)


def solve_speed_sweep(
    machine: Machine,
    speeds: Sequence[float],
    plan: TransientPlan,
    origin: Origin,
    warnings: Sequence[ResultWarning] = (),
    progress: Progress = silent,
) -> Result[Sequence[SweptPoint[GridPoint]]]:
    """Integrate the motion of a machine of Python at each of several speeds, in this process.

    ``warnings`` are those of what is left out; the other parameters are those of
    :func:`gearwhine.sweep.machine_sweep.sweep_speeds`.
    """
    start = time.perf_counter()
    keys, swept = sweep_speeds(machine, speeds, plan, progress)
    return _result(origin, keys, swept, start, warnings=warnings)


def _result(
    origin: Origin,
    keys: Sequence[SweptKey],
    swept: Sequence[SweptPoint[AnyPoint]],
    start: float,
    radiated: RadiatedLevel | None = None,
    warnings: Sequence[ResultWarning] = (),
    workers: int | None = None,
) -> Result[Sequence[SweptPoint[AnyPoint]]]:
    """Return the result of solved points, with the peaks between them."""
    peaks = missed_peaks(keys, swept, radiated)
    dataset = collected_sweep(origin.case, keys, swept, peaks, origin.title)
    document = sweep_document(keys, swept, peaks)
    add_warnings(document, warnings)
    document["workers"] = workers

    def figures(progress: Progress) -> Iterator[tuple[str, Figure]]:
        from gearwhine.figures import draw_sweep

        return draw_sweep(origin.title, dataset)

    return origin.study_result("sweep", swept, document, lambda: dataset, figures, start)
