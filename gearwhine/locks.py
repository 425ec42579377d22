"""Locks on folders, for runs that share a results folder."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def exclusive_lock(folder: Path) -> Iterator[None]:
    """Make a folder where it is missing and hold its lock; waits for another run that holds it.

    The lock is on the folder itself: it leaves no file behind, and the system lets go of it when a process dies. Where
    a file system knows no locks the work goes on without.
    """
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        try:
            handle = os.open(folder, os.O_RDONLY)
        except FileNotFoundError:  # another run has just removed it, empty
            continue
        try:
            _take(handle, wait=True)
            if folder.exists() and os.path.samestat(os.fstat(handle), folder.stat()):
                yield
                return
        finally:
            os.close(handle)


@contextmanager
def held_lock(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder that is this run's own, so that others see that it is in use."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        _take(handle, wait=False)
        yield
    finally:
        os.close(handle)


def is_locked(folder: Path) -> bool:
    """Whether a living process holds a folder's lock, or the lock cannot be read."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return True
    try:
        return not _take(handle, wait=False)
    finally:
        os.close(handle)


def _take(handle: int, *, wait: bool) -> bool:
    """Take a lock; False where another process has it or there are no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError:
        return False
    return True
