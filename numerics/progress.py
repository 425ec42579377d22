"""Progress of long work: what an analysis tells its caller while it works."""

from typing import Protocol


class Progress(Protocol):
    """Receives the present work in words, and its completed fraction (0 to 1) where that is known.

    Words after a colon are news of the same work: its clock goes on.
    """

    def __call__(self, message: str, fraction: float | None = None) -> None:
        """Report the present work and its completed fraction."""


def silent(message: str, fraction: float | None = None) -> None:
    """Say nothing."""
