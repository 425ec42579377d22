"""Parallel work by local processes, for long tasks with small results."""

import tempfile
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gearwhine.interruption import each_from_thread, in_thread
from housing.updating import Each, serial_map


def default_workers() -> int:
    """As many as this process may use of the machine's cores."""
    from gearwhine.sweep.workers import default_workers as of_the_machine

    return of_the_machine()


@contextmanager
def in_parallel(workers: int) -> Iterator[Each]:
    """Pool of single-thread processes, which end with the block; one worker is this process.

    Raises
    ------
    WorkersError
        Where the processes do not start.
    """
    if workers < 2:
        yield serial_map
        return
    from gearwhine.sweep.workers import await_workers, connected

    with tempfile.TemporaryDirectory(prefix="gearwhine-") as place, connected(workers, None, Path(place)) as client:
        await_workers(client, workers)

        def each(work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterator[Any]:
            with warnings.catch_warnings():
                # Dask would rather have large tasks scattered first; ours are few and long.
                warnings.filterwarnings("ignore", message="Sending large graph")
                futures = in_thread(lambda: [client.submit(work, task, pure=False) for task in tasks])
            return each_from_thread(future.result() for future in futures)

        yield each
