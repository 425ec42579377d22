"""Warm-up of the workers: a small point that each one solves as it starts.

Reading the code and loading what numba has compiled takes seconds, which the first point would take longer otherwise.
Importing this module imports Dask.
"""

from typing import Any

from distributed import Worker, WorkerPlugin

from gearwhine.case import Case, load_case
from gearwhine.workers import code_digest

_BRIEF_TRANSIENT = ("transient.revolutions=1", "transient.discard=0", "transient.tolerance=1e-2")


class WarmUp(WorkerPlugin):
    """Lets a worker integrate a pair of gears for a moment before its first point."""

    name = "rehearsal"

    def __init__(self) -> None:
        self.case = load_case("spur-pair", _BRIEF_TRANSIENT).case

    def setup(self, worker: Worker) -> None:
        """Queue the warm-up where points are solved: they wait for it, but the worker's communication does not."""
        worker.executors["default"].submit(_rehearse, self.case)


def _rehearse(case: Case) -> Any:
    # The import is here, not in the thread that talks to the scheduler. The points report its failures.
    from gearwhine.sweep.solution import solve_point

    return solve_point(case, None, code_digest())
