"""Running a varied case: samples on file are read, the others are solved here or by workers."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gearwhine.failures import WorkersError
from gearwhine.interruption import each_from_thread, in_thread
from gearwhine.numerics.arrays import FloatArray
from gearwhine.solutions import Failure, StudyProgress
from gearwhine.study_folder import StudyFolder
from gearwhine.variation.cost import cost_of_study
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.samples import FOLDER, Outcome, Record, Sampled, solve_samples
from gearwhine.workers import as_they_end, called, code_digest, default_workers

if TYPE_CHECKING:
    from distributed import Client, Future


_WORTH_WORKERS = 20.0  # time of all samples below which workers, which take seconds to start, are not called [s]
_BATCH_TIME = 3.0  # time of the samples that a worker is given at once, which the death of a worker may cost [s]
_LARGEST_BATCH = 200


@dataclass(frozen=True, eq=False)
class Solved:
    """Samples of a varied case, in the order of their points.

    Attributes
    ----------
    outcomes : tuple of Evaluation or Failure
    resumed : int
        Number of samples that an earlier run had found.
    """

    outcomes: tuple[Outcome, ...]
    resumed: int


def run_samples(varied: Sampled, points: FloatArray, folder: StudyFolder, place: str = FOLDER) -> Solved:
    """Solve every sample that the folder does not hold yet; each is on file soon after it is found.

    Parameters
    ----------
    varied : Sampled
    points : ndarray, shape (n, d)
        Points of the unit cube.
    folder : StudyFolder
    place : str
        Folder of the record within the results folder.

    Raises
    ------
    CaseError, WorkersError
        Where there are no workers.
    """
    record = Record(folder.path, varied.key, place)
    if folder.fresh:
        record.file.unlink(missing_ok=True)
    # Samples that failed before are tried again.
    found = {number: outcome for number, outcome in record.read(points).items() if isinstance(outcome, Evaluation)}
    todo = [number for number in range(len(points)) if number not in found]
    outcomes: dict[int, Outcome] = dict(found)
    resumed = len(points) - len(todo)
    reached = StudyProgress(folder.progress, "gearboxes", len(points), resumed)
    if todo:
        # The first one is timed, with what is compiled and read once behind it.
        first = todo[0]
        begin = time.perf_counter()
        outcome = varied.solve(points[first])
        each = time.perf_counter() - begin
        outcomes[first] = outcome
        record.append([(first, outcome)], points)
        rest = todo[1:]
        workers = folder.workers or default_workers()
        if isinstance(outcome, Evaluation) and folder.scheduler is None:
            taken = each * len(rest) / workers
            if text := cost_of_study(outcome, taken, len(points), "gearboxes", "variation"):
                folder.progress(f"{text}\n")
        is_short = folder.workers is None and each * len(rest) < _WORTH_WORKERS
        alone = not rest or (folder.scheduler is None and (folder.workers == 1 or is_short))
        size = max(1, min(_LARGEST_BATCH, int(_BATCH_TIME / max(each, 1e-3)), -(-len(rest) // (4 * workers))))
        batches = [rest[begin : begin + size] for begin in range(0, len(rest), size)]
        solved_batches: Iterable[list[tuple[int, Outcome]]]
        if alone:
            solved_batches = ([(number, varied.solve(points[number])) for number in batch] for batch in batches)
        else:
            solved_batches = _solved_by_workers(varied, points, batches, folder, workers)
        failed = int(isinstance(outcome, Failure))
        for solved in solved_batches:
            record.append(solved, points)
            outcomes |= dict(solved)
            failed += sum(isinstance(outcome, Failure) for _, outcome in solved)
            reached.report(len(outcomes), f", {failed} failed" if failed else "")
    record.remove_others()
    return Solved(tuple(outcomes[number] for number in range(len(points))), resumed)


def _solved_by_workers(
    varied: Sampled, points: FloatArray, batches: Sequence[Sequence[int]], folder: StudyFolder, workers: int
) -> Iterator[list[tuple[int, Outcome]]]:
    """Yield each batch as workers have solved it."""
    with called(folder, min(workers, len(batches))) as client:
        yield from solved_by_client(client, sent(client, varied), points, batches)


def sent(client: Client, varied: Sampled) -> Future[Any]:
    """Return gearboxes as every worker has them."""
    return in_thread(lambda: client.scatter(varied, broadcast=True, hash=False))


def solved_by_client(
    client: Client, everywhere: Future[Any], points: FloatArray, batches: Sequence[Sequence[int]]
) -> Iterator[list[tuple[int, Outcome]]]:
    """Yield the outcomes of each batch of numbers of points (n, d), as workers have solved it."""
    code = code_digest()

    def submitted() -> dict[Future[Any], Sequence[int]]:
        # A key stays that of one task for as long as the client lives, which may be asked for other points later.
        return {
            client.submit(
                solve_samples,
                everywhere,
                [(number, points[number]) for number in batch],
                code,
                key=f"{batch[0]}-{points[batch[0]].tolist()}",
            ): batch
            for batch in batches
        }

    yield from each_from_thread(_outcomes_as_they_end(client, in_thread(submitted)))


def _outcomes_as_they_end(
    client: Client, futures: dict[Future[Any], Sequence[int]]
) -> Iterator[list[tuple[int, Outcome]]]:
    """Yield the outcomes of each batch as it comes."""
    for batch, outcomes in as_they_end(client, futures, "sample"):
        if isinstance(outcomes, WorkersError):
            yield [(number, Failure(str(outcomes))) for number in batch]
        elif isinstance(outcomes, BaseException):
            raise outcomes
        else:
            yield outcomes
