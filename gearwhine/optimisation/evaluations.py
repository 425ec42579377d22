"""Designs as they are evaluated: what is on file is read, the others are solved here or by workers, and put on file."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

import numpy as np

from gearwhine.numerics.arrays import FloatArray
from gearwhine.solutions import Failure
from gearwhine.study_folder import StudyFolder
from gearwhine.variation.quantities import Evaluation
from gearwhine.variation.run import sent, solved_by_client
from gearwhine.variation.samples import Outcome, Record, Sampled
from gearwhine.workers import called, default_workers

if TYPE_CHECKING:
    from distributed import Client

_WORTH_WORKERS = 20.0  # time of all that may come below which workers are not started [s]


class Evaluations:
    """Evaluations at points of its design and scatter, each solved once and on file as it is found.

    Parameters
    ----------
    proposed : Sampled
    folder : StudyFolder

    Attributes
    ----------
    resumed : int
        Number of evaluations that were on file.
    """

    def __init__(self, proposed: Sampled, folder: StudyFolder) -> None:
        self._proposed, self._folder = proposed, folder
        self._record = Record(folder.path, proposed.key)
        if folder.fresh:
            self._record.file.unlink(missing_ok=True)
        # Gearboxes that failed before are tried again.
        self._on_file = {
            tuple(point): outcome for _, point, outcome in self._record.entries() if isinstance(outcome, Evaluation)
        }
        self._found = dict[tuple[float, ...], Outcome]()
        self.resumed = 0
        self._each = 0.0
        self._client: Client | None = None
        self._stack = ExitStack()

    @contextmanager
    def opened(self) -> Iterator[Evaluations]:
        """Yield the evaluations; workers that they call end with the block."""
        with self._stack:
            yield self
            self._record.remove_others()

    def of(self, points: FloatArray, to_come: int = 0) -> list[Outcome]:
        """Return the outcomes at points (n, d), and solve what is not known yet.

        Parameters
        ----------
        points : ndarray, shape (n, d)
        to_come : int
            Number of gearboxes that may be wanted later.
        """
        keys = [tuple(row) for row in points.tolist()]
        todo = list(dict.fromkeys(key for key in keys if key not in self._found))
        for key in todo:
            if key in self._on_file:
                self._found[key] = self._on_file[key]
                self.resumed += 1
        todo = [key for key in todo if key not in self._found]
        for solved in self._solved(todo, len(todo) + to_come):
            self._keep(solved)
        return [self._found[key] for key in keys]

    def _keep(self, solved: Sequence[tuple[tuple[float, ...], Outcome]]) -> None:
        begin = len(self._found)
        self._found |= dict(solved)
        rows = [(begin + number, outcome) for number, (_, outcome) in enumerate(solved)]
        places = {begin + number: np.array(key) for number, (key, _) in enumerate(solved)}
        self._record.append(rows, places)

    def _solved(
        self, todo: Sequence[tuple[float, ...]], to_come: int
    ) -> Iterator[list[tuple[tuple[float, ...], Outcome]]]:
        for number, key in enumerate(todo):
            is_worth = self._folder.workers is not None or self._each * to_come > _WORTH_WORKERS
            calls = self._folder.scheduler is not None or (self._folder.workers != 1 and is_worth)
            if self._client is not None or (self._each and calls and len(todo) - number > 1):
                yield from self._by_workers(todo[number:])
                return
            begin = time.perf_counter()
            outcome = self._proposed.solve(np.array(key))
            taken = time.perf_counter() - begin
            # The first one reads and compiles more than the others; slow ones have a housing of their own.
            self._each = taken if self._each == 0.0 else 0.5 * (self._each + taken)
            yield [(key, outcome)]

    def _by_workers(self, todo: Sequence[tuple[float, ...]]) -> Iterable[list[tuple[tuple[float, ...], Outcome]]]:
        client = self._connected()
        for solved in solved_by_client(client, self._everywhere, np.array(todo), [[n] for n in range(len(todo))]):
            yield [(todo[number], outcome) for number, outcome in solved]

    def _connected(self) -> Client:
        """Return the client of the workers, which are started at the first call."""
        if self._client is None:
            client = self._stack.enter_context(called(self._folder, self._folder.workers or default_workers()))
            self._everywhere, self._client = sent(client, self._proposed), client
        return self._client


def failure_of(outcomes: Sequence[Outcome]) -> Failure | None:
    """Return the first failure of the gearboxes of a design; None where all have a result."""
    return next((one for one in outcomes if isinstance(one, Failure)), None)
