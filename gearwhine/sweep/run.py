"""Running a sweep: points on file are read, the others are solved by the workers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearwhine.coupling.machine.components import HousingComponent
from gearwhine.failures import WorkersError
from gearwhine.housing import HousingModes
from gearwhine.interruption import each_from_thread, in_thread
from gearwhine.output import staging
from gearwhine.solutions import Failure, StudyProgress
from gearwhine.solve.acoustics import check_before_modes
from gearwhine.solve.housing_modes import solve_housing, write_mode_cache
from gearwhine.solve.machine import reduce_housing
from gearwhine.study_folder import StudyFolder
from gearwhine.sweep.grid import SweptPoint
from gearwhine.sweep.points import Point
from gearwhine.sweep.solution import (
    PointResult,
    outdated_points,
    read_point,
    solve_point,
    solve_point_housing,
    write_point,
)
from gearwhine.workers import as_they_end, await_workers, code_digest, connected, default_workers

if TYPE_CHECKING:
    from distributed import Client, Future

Outcome = PointResult | Failure


def run_sweep(points: Sequence[Point], study: StudyFolder) -> tuple[SweptPoint[Point], ...]:
    """Solve every point that the folder does not hold yet; each is written there as it ends.

    Points that failed before are tried again. Where all points share the housing's modes, these are solved here and
    cached; where the sweep changes them, they are solved by the workers.

    Parameters
    ----------
    points : sequence of Point
        Points of :func:`gearwhine.sweep.sweep_points`.
    study : StudyFolder

    Raises
    ------
    CaseError, WorkersError, gearwhine.housing.HousingError, gearwhine.housing.IncompleteModesError, ...
        Where the housing that all points share cannot be solved, or there are no workers.
    """
    folder, progress, scheduler = study.path, study.progress, study.scheduler
    outcomes: dict[int, Outcome] = {}
    if not study.fresh:
        stored = ((number, read_point(folder, point)) for number, point in enumerate(points) if not point.refusal)
        outcomes = {number: outcome for number, outcome in stored if isinstance(outcome, PointResult)}
    resumed = frozenset(outcomes)
    outcomes |= {number: Failure(point.refusal) for number, point in enumerate(points) if point.refusal}
    todo = [number for number in range(len(points)) if number not in outcomes]
    if todo:
        from gearwhine.sweep.warm_up import WarmUp

        workers = min(study.workers or default_workers(), len(todo))
        with staging(folder) as place:
            progress(f"starting {workers} workers" if scheduler is None else f"calling {scheduler}")
            with connected(workers, scheduler, place, [WarmUp()]) as client:
                # Long points go first, lest all wait for them at the end.
                todo.sort(key=lambda number: -points[number].duration)
                shared, uncached = _shared_housings([points[number] for number in todo], study)
                if scheduler is None:
                    await_workers(client, workers)
                reached = StudyProgress(progress, "points", len(points), len(outcomes))
                reached.report(len(outcomes))
                futures = in_thread(lambda: _submitted(client, {number: points[number] for number in todo}, shared))
                # The cache is written now, since the points need not wait for it.
                _cache(uncached, folder)
                _preload_writers()
                ended = each_from_thread(_outcomes_as_they_end(client, futures))
                for number, outcome in ended:
                    outcomes[number] = outcome
                    write_point(folder, place, points[number], outcome)
                    reached.report(len(outcomes))
    for path in outdated_points(folder, tuple(point for point in points if not point.refusal)):
        path.unlink(missing_ok=True)
    return tuple(SweptPoint(point, outcomes[number], number in resumed) for number, point in enumerate(points))


def _shared_housings(
    points: Sequence[Point], study: StudyFolder
) -> tuple[dict[str | None, HousingComponent], HousingModes | None]:
    """Solve the housings that points share, by key; none where their modes differ or they have no housing.

    Return as well the solution that is still to be cached.
    """
    housings: dict[str | None, HousingComponent] = {}
    solved = None
    if len({point.modes_key for point in points}) > 1 or points[0].modes_key is None:
        return housings, solved
    for point in points:
        if point.housing_key in housings:
            continue
        # The next housing reads the modes that this one caches.
        _cache(solved, study.path)
        solved = solve_housing(
            point.case,
            study.progress,
            command="sweep",
            folder=study.path,
            fresh=study.fresh and not housings,
            before=check_before_modes(point.case.acoustics, point.case.housing),
        )
        housings[point.housing_key] = reduce_housing(point.case, solved)
    return housings, solved


def _cache(solved: HousingModes | None, folder: Path) -> None:
    if solved is not None:
        with staging(folder) as place:
            write_mode_cache(place, solved)


def _preload_writers() -> None:
    """Import modules that take seconds and are used only once there are results."""
    import xarray  # noqa: F401

    from gearwhine import figures  # noqa: F401


def _submitted(
    client: Client, points: dict[int, Point], shared: dict[str | None, HousingComponent]
) -> dict[Future[Any], int]:
    """Submit every point to the workers, and before it its housing where that is not shared."""
    code = code_digest()
    housings: dict[str | None, Any] = dict(shared)
    futures = {}
    for number, point in points.items():
        key = point.housing_key
        if key is not None and key not in housings:
            housings[key] = client.submit(solve_point_housing, point.case, code, key=f"housing-{key}", pure=False)
        housing = None if key is None else housings[key]
        future = client.submit(solve_point, point.case, housing, code, key=f"point-{number}-{point.key}", pure=False)
        futures[future] = number
    return futures


def _outcomes_as_they_end(client: Client, futures: dict[Future[Any], int]) -> Iterator[tuple[int, Outcome]]:
    """Yield each point's number and outcome as it comes."""
    for number, outcome in as_they_end(client, futures, "point"):
        if isinstance(outcome, WorkersError):
            yield number, Failure(str(outcome))
        elif isinstance(outcome, BaseException):
            yield number, Failure(f"unexpected {type(outcome).__name__}: {outcome}")
        else:
            yield number, outcome
