"""Progress of long work: a live line on a terminal, plain lines elsewhere, nothing when quiet."""

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from gearwhine.numerics.progress import Progress, silent

_OFTEN = 30.0  # seconds between reports of long work
_WORTH_SAYING = 5.0  # least time left that is shown [s]
_BESIDE = 30  # terminal columns of spinner, bar and times beside the words of a live line


@contextmanager
def shown(*, quiet: bool) -> Iterator[Progress]:
    """Progress on standard error for the time of a command."""
    if quiet:
        yield silent
    elif sys.stderr.isatty():
        with _live() as progress, _with_compilation(progress) as combined:
            yield combined
    else:
        with _with_compilation(_lines()) as combined:
            yield combined


_COMPILER = "gearwhine.numerics.compiled"  # named, not imported: with numba it takes longer than many a command
_COMPILING = "compiling kernels, the first time only"


@contextmanager
def _with_compilation(progress: Progress) -> Iterator[Progress]:
    """Report also, as news of the present work, that kernels are compiled, which may take a minute."""
    work = "starting"

    def both(message: str, fraction: float | None = None) -> None:
        nonlocal work
        work = _work(message)
        progress(message, fraction)

    class News(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            progress(f"{work}: {_COMPILING}")

    news, logger = News(), logging.getLogger(_COMPILER)
    level = logger.level
    logger.addHandler(news)
    logger.setLevel(logging.INFO)
    try:
        yield both
    finally:
        logger.setLevel(level)
        logger.removeHandler(news)


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
            if message.endswith("\n"):
                bar.console.print(message.rstrip(), markup=False, highlight=False)
                return
            if _work(message) != _work(current[0]):
                bar.reset(task, total=None if fraction is None else 1.0)
            if message != current[0]:
                current[0] = message
                room = max(bar.console.width - _BESIDE, _BESIDE)
                bar.update(task, description=message if len(message) <= room else f"{message[: room - 1]}…")
            if fraction is not None:
                bar.update(task, total=1.0, completed=fraction)

        yield progress


def _lines() -> Progress:
    start = time.perf_counter()
    last, printed, reported = "", 0, start
    begun = (start, 0.0)

    def progress(message: str, fraction: float | None = None) -> None:
        nonlocal last, printed, reported, begun
        message = message.rstrip()
        tenths = 0 if fraction is None else int(10 * fraction)
        now = time.perf_counter()
        news = message != last and _work(message) == _work(last)
        if message != last:
            if not news:
                # Work that goes on from where it was left does not begin at 0.
                begun = (now, fraction or 0.0)
            last, printed = message, 0
        elif (tenths <= printed or tenths % 5) and (fraction is None or now - reported < _OFTEN):
            return
        printed, reported = tenths, now
        part = ""
        if fraction is not None and fraction >= 0.005 and not news:
            part = f" {100 * fraction:.0f} %{_time_left(begun, now, fraction)}"
        sys.stderr.write(f"[{time.perf_counter() - start:6.1f} s] {message}{part}\n")
        sys.stderr.flush()

    return progress


_printed = _lines()


def print_progress(message: str, fraction: float | None = None) -> None:
    """Print the present work on standard error: a line where the words change, and of long work each half a minute.

    It is meant for ``study.progress = gw.print_progress``. The times are those since its import.
    """
    _printed(message, fraction)


def _time_left(begun: tuple[float, float], now: float, fraction: float) -> str:
    """Estimated time left; empty where it is short."""
    passed, done = now - begun[0], fraction - begun[1]
    if done <= 0.0 or (left := passed * (1.0 - fraction) / done) < _WORTH_SAYING:
        return ""
    minutes, seconds = divmod(round(left), 60)
    return f", {minutes // 60}:{minutes % 60:02d}:{seconds:02d} left"


def _work(message: str) -> str:
    """Subject of a message, without its news."""
    return message.partition(":")[0]
