"""Workers of a sweep: local processes, or those of a running Dask cluster."""

from __future__ import annotations

import logging
import multiprocessing
import os
import resource
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeVar

from gearwhine.case import CaseError, Problem
from gearwhine.failures import WorkersError
from gearwhine.interruption import in_thread, uninterrupted
from gearwhine.numerics.source_digest import source_digest
from gearwhine.output import staging
from gearwhine.output.files import PRESENTATION, ROOMS
from gearwhine.study_folder import StudyFolder

if TYPE_CHECKING:
    from distributed import Client, Future, LocalCluster, WorkerPlugin

Task = TypeVar("Task")

# Every worker is one thread: BLAS and factorisations with threads of their own on top cost more than they give.
_ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS"), "1"
)
_FIND_SCHEDULER = "10s"
# Longer than a process takes to start on the slowest machine; after it, a missing worker is an error.
_WORKERS_COME = 300.0  # seconds
# Whatever is still open after this time ends with this process.
_CLOSES = 10.0  # seconds
# Open files of this process: of the cluster, and of each worker. Dask waits for ever for workers that lack them.
_FILES, _FILES_OF_WORKER = 20, 12


def default_workers() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def code_digest() -> str:
    """SHA-256 of all our code that makes numbers: points and workers of other code are not used."""
    return source_digest(*ROOMS, "gearwhine", without=PRESENTATION)


class OtherCodeError(RuntimeError):
    """A worker runs another version of this code."""


def require_same_code(code: str) -> None:
    """Refuse work on a worker whose code is not that of the digest, the caller's: it could give other numbers.

    Raises
    ------
    OtherCodeError
    """
    if code_digest() != code:
        raise OtherCodeError(
            "the worker has another version of gearwhine than the command; install the same one on every worker"
        )


@contextmanager
def connected(
    workers: int, scheduler: str | None, place: Path, plugins: Sequence[WorkerPlugin] = ()
) -> Iterator[Client]:
    """Yield a client of the workers; those started here end with the block, whatever ends it.

    They are not waited for here, but by :func:`await_workers`. Workers of our own die with this process even where it
    is killed. A worker that dies is replaced, and its task is done again.

    Parameters
    ----------
    workers : int
        Number of processes to start.
    scheduler : str or None
        Address of a cluster that runs already, whose workers are used in place of our own.
    place : path
        Folder in which Dask stores files while it runs.
    plugins : sequence of WorkerPlugin
        Plugins of each worker of our own, as it starts.

    Raises
    ------
    CaseError
        Where no scheduler answers at the address.
    WorkersError
        Where the scheduler of our own processes does not start, or this process may not open the files for them.
    """
    import dask
    import distributed  # noqa: F401 - its own settings must be there before ours, or they go with them

    settings = {
        "distributed.nanny.pre-spawn-environ": _ONE_THREAD,
        # A worker is given a point when it has none: one in hand beside it would be missing elsewhere at the end.
        "distributed.scheduler.worker-saturation": 1.0,
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
        "distributed.worker.profile.enabled": False,
    }
    with (
        dask.config.set(settings),
        _environment_restored(),
        _main_module_unseen(),
        _quiet(),
        TemporaryDirectory(prefix="dask-", dir=place, ignore_cleanup_errors=True) as scratch,
        _own_processes(workers, scratch, plugins) if scheduler is None else _cluster_at(scheduler) as client,
    ):
        yield client


def await_workers(client: Client, workers: int) -> None:
    """Wait for a number of workers; an interruption takes effect outside the waiting call.

    Raises
    ------
    WorkersError
        Where the processes do not start.
    """
    try:
        in_thread(lambda: client.wait_for_workers(workers, timeout=_WORKERS_COME))
    except TimeoutError as error:
        raise WorkersError(f"the workers did not start: {error}") from error


@contextmanager
def called(folder: StudyFolder, workers: int) -> Iterator[Client]:
    """Yield a client of the workers of a study, once they are there; see :func:`connected`."""
    folder.progress(f"starting {workers} workers" if folder.scheduler is None else f"calling {folder.scheduler}")
    with staging(folder.path) as place, connected(workers, folder.scheduler, place) as client:
        if folder.scheduler is None:
            await_workers(client, workers)
        yield client


def as_they_end(client: Client, futures: dict[Future[Any], Task], kind: str) -> Iterator[tuple[Task, Any]]:
    """Yield the task of each future with its result, or the error in its place, as they come.

    Parameters
    ----------
    client : Client
    futures : dict
        Tasks by their futures, which is emptied.
    kind : str
        Kind of the tasks, in a word.

    Raises
    ------
    WorkersError
        Where all workers are lost; where those at one task died, the error stands in place of its result.
    """
    from distributed import KilledWorker, as_completed

    for future in as_completed(list(futures), loop=client.loop):
        task = futures.pop(future)
        error = future.exception() if future.status == "error" else None
        if isinstance(error, KilledWorker):
            died = f"the worker at this {kind} died again and again, perhaps for want of memory; try fewer --workers"
            yield task, WorkersError(died)
        elif error is not None:
            yield task, error
        elif future.cancelled():
            raise WorkersError(f"the workers were lost; run the study again to do the {kind}s that are missing")
        else:
            yield task, future.result()
        # Results need not stay in the workers' memory.
        future.release()


@contextmanager
def _own_processes(workers: int, scratch: str, plugins: Sequence[WorkerPlugin]) -> Iterator[Client]:
    from distributed import Client, LocalCluster

    _require_open_files(_FILES + workers * _FILES_OF_WORKER)
    earlier = set(multiprocessing.active_children())
    with ExitStack() as ended:
        try:
            with uninterrupted(), _without_ctrl_c():
                cluster = LocalCluster(
                    n_workers=0,
                    threads_per_worker=1,
                    processes=True,
                    # None: points hand back kilobytes, so nothing is to be spilled to disk.
                    memory_limit=0,
                    local_directory=scratch,
                    plugins=tuple(plugins),
                    silence_logs=logging.CRITICAL,
                    # No dashboard, and a port that nobody else has for what is left of its server.
                    dashboard_address="127.0.0.1:0",
                    scheduler_kwargs={"dashboard": False},
                )
                ended.callback(_end, cluster, earlier)
        except (OSError, RuntimeError, TimeoutError) as error:
            raise WorkersError(f"the workers did not start: {error}") from error
        with uninterrupted():
            client = Client(cluster, set_as_default=False)
            ended.callback(_close, client)
            # Now, not before: a client waits for the workers that the cluster is starting.
            cluster.scale(workers)
        yield client


def _require_open_files(more: int) -> None:
    """Raise the limit of open files where a number of further ones needs it and the system lets us.

    Raises
    ------
    WorkersError
        Where it does not.
    """
    needed = len(os.listdir("/dev/fd")) + more
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY or needed <= soft:
        return
    if hard != resource.RLIM_INFINITY and needed > hard:
        raise WorkersError(
            f"the workers need {needed} open files of this process, which may have {soft}: "
            "take fewer --workers, or raise the limit (ulimit -n)"
        )
    resource.setrlimit(resource.RLIMIT_NOFILE, (needed, hard))


def _close(client: Client) -> None:
    with uninterrupted(), suppress(TimeoutError):
        client.close(timeout=_CLOSES)


def _end(cluster: LocalCluster, earlier: set[BaseProcess]) -> None:
    """End a cluster of our own with its workers: all processes started from this one except earlier ones."""
    # Their results are back or not wanted, and waiting for them to end takes seconds. The cluster does not know of
    # workers that are still starting.
    with uninterrupted(), suppress(TimeoutError):
        for nanny in cluster.workers.values():
            nanny.auto_restart = False
        for process in set(multiprocessing.active_children()) - earlier:
            process.kill()
        cluster.close(timeout=_CLOSES)


@contextmanager
def _cluster_at(address: str) -> Iterator[Client]:
    from distributed import Client

    try:
        client = in_thread(lambda: Client(address, timeout=_FIND_SCHEDULER, set_as_default=False))
    except (OSError, ValueError, RuntimeError, TimeoutError) as error:
        expected = f"the address of a running Dask scheduler, such as tcp://host:8786 ({error})"
        raise CaseError([Problem("--scheduler", address, expected)]) from error
    try:
        yield client
    finally:
        _close(client)


@contextmanager
def _without_ctrl_c() -> Iterator[None]:
    """Start threads and processes that a Ctrl-C at the terminal does not reach: it is for this thread to unwind.

    A thread inherits its mask from the one that starts it, and a process from the thread that starts it, so the
    workers that replace others are spared too. A Ctrl-C meanwhile comes right after.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    # The first thread to start a process would start this, and take Ctrl-C again.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _environment_restored() -> Iterator[None]:
    """Undo what Dask puts in this process's environment for its workers to inherit."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def _main_module_unseen() -> Iterator[None]:
    """Start processes that do not import the caller's script, which would sweep again in each of them.

    A spawned process imports the file of the main module, and a script without ``if __name__ == "__main__"`` runs
    whole. The workers need only this package.
    """
    main = sys.modules["__main__"]
    hidden = {name: main.__dict__[name] for name in ("__file__", "__spec__") if name in main.__dict__}
    for name in hidden:
        setattr(main, name, None)
    try:
        yield
    finally:
        for name, value in hidden.items():
            setattr(main, name, value)


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's log: the sweep itself reports a dead worker."""
    loggers = [logging.getLogger(name) for name in ("distributed", "asyncio", "tornado", "bokeh")]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before, strict=True):
            logger.setLevel(level)
