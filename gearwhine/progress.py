"""Progress of long work: a live line on a terminal, plain lines where there is none, nothing when quiet."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


class Progress(Protocol):
    """Told in words what happens now, and how much of it is done (0 to 1) where that is known.

    Words after a colon are news of the same work: its clock goes on.
    """

    def __call__(self, message: str, fraction: float | None = None) -> None: ...


def silent(message: str, fraction: float | None = None) -> None:
    """Say nothing."""


@contextmanager
def shown(*, quiet: bool) -> Iterator[Progress]:
    """Progress on standard error for the time of a command."""
    if quiet:
        yield silent
    elif sys.stderr.isatty():
        with _live() as progress:
            yield progress
    else:
        yield _lines()


@contextmanager
def _live() -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None)
        current = [""]

        def progress(message: str, fraction: float | None = None) -> None:
            if _work(message) != _work(current[0]):
                bar.reset(task, total=None if fraction is None else 1.0)
            if message != current[0]:
                current[0] = message
                bar.update(task, description=message)
            if fraction is not None:
                bar.update(task, total=1.0, completed=fraction)

        yield progress


def _lines() -> Progress:
    start = time.perf_counter()
    last, told = "", 0

    def progress(message: str, fraction: float | None = None) -> None:
        nonlocal last, told
        tenths = 0 if fraction is None else int(10 * fraction)
        news = message != last and _work(message) == _work(last)
        if message != last:
            last, told = message, 0
        elif tenths <= told or tenths % 5:
            return
        told = tenths
        part = "" if not tenths or news else f" {10 * tenths} %"
        sys.stderr.write(f"[{time.perf_counter() - start:6.1f} s] {message}{part}\n")
        sys.stderr.flush()

    return progress


def _work(message: str) -> str:
    """What a message is about, without its news."""
    return message.partition(":")[0]
