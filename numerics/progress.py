"""Progress of long work: what an analysis tells its caller while it works; work on two threads."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, TypeVar

Item = TypeVar("Item")
Solution = TypeVar("Solution")

_THREADS = 2


class Progress(Protocol):
    """Receives the present work in words, and its completed fraction (0 to 1) where that is known.

    Words after a colon are news of the same work: its clock goes on. A message with a line break at its end is a note,
    which stays on a live terminal as the work goes on.
    """

    def __call__(self, message: str, fraction: float | None = None) -> None:
        """Report the present work and its completed fraction."""


def silent(message: str, fraction: float | None = None) -> None:
    """Say nothing."""


def in_order(
    solve: Callable[[Item], Solution], items: Sequence[Item], message: str, progress: Progress = silent
) -> tuple[Solution, ...]:
    """Solve for each item on two threads under the progress; the results are in the order of the items.

    Parameters
    ----------
    solve : callable
        Solution of one item; it releases the interpreter in its long work.
    items : sequence
    message : str
        The work in words.
    progress : callable
    """
    results: list[Solution] = []
    if items:
        progress(message, 0.0)
    with ThreadPoolExecutor(_THREADS) as pool:
        for result in pool.map(solve, items):
            results.append(result)
            progress(message, len(results) / len(items))
    return tuple(results)
