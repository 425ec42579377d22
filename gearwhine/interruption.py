"""Interruption by Ctrl-C or SIGTERM: both raise KeyboardInterrupt where that is safe."""

import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from types import FrameType
from typing import TypeVar

T = TypeVar("T")

_NUMBERS = (signal.SIGINT, signal.SIGTERM)

_AGAIN = 0.05
"""Delay after which a deferred interruption is raised again [s]."""

_IMPORTING = "<frozen importlib._bootstrap>"


@contextmanager
def interruptible() -> Iterator[None]:
    """Let SIGINT and SIGTERM raise KeyboardInterrupt in the main thread, so that staged files are cleared away.

    Elsewhere than in the main thread nothing is changed, nor is a SIGINT that the parent process told to ignore.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in _NUMBERS}
    hook = sys.unraisablehook
    _raised.clear()
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, _interrupt)
    sys.unraisablehook = _unraisable
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Defer interruptions of the main thread until the block ends.

    For calls of libraries with threads of their own: an interruption that strikes between the taking of a lock and the
    block that gives it back leaves those threads waiting for ever.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[int] = []
    before = {number: signal.getsignal(number) for number in _NUMBERS}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, lambda late, _: waiting.append(late))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if waiting:
            signal.raise_signal(waiting[0])


def each_from_thread(items: Iterable[T]) -> Iterator[T]:
    """Yield the items of an iterable, which are computed on a thread of their own without interruptions.

    The thread that takes the items waits for them where an interruption is safe. An iterable that is left before its
    end goes on until it ends by itself.
    """
    queue: SimpleQueue[tuple[list[T], BaseException | None]] = SimpleQueue()

    def work() -> None:
        try:
            for item in items:
                queue.put(([item], None))
        except BaseException as error:
            queue.put(([], error))
        else:
            queue.put(([], None))

    with uninterrupted():
        threading.Thread(target=work, daemon=True).start()
    while True:
        batch, error = queue.get()
        if error is not None:
            raise error
        if not batch:
            return
        yield batch[0]


def in_thread(work: Callable[[], T]) -> T:
    """Return the result of a call on a thread of its own; see :func:`each_from_thread`."""
    (result,) = each_from_thread(work() for _ in range(1))
    return result


_raised: list[int] = []
"""Interruptions raised so far; objects that are half built at one raise further errors."""


def was_interrupted() -> bool:
    """Return whether an interruption was raised since :func:`interruptible` was entered last."""
    return bool(_raised)


def _interrupt(number: int, frame: FrameType | None) -> None:
    # A library's own initialisation in C need not survive an exception: VTK's crashes. Imports are let finish.
    if _importing(frame):
        _interrupt_again()
    else:
        _raised.append(number)
        raise KeyboardInterrupt


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == _IMPORTING:
            return True
        frame = frame.f_back
    return False


def _unraisable(trouble: "sys.UnraisableHookArgs") -> None:
    """Interrupt again where Python drops an interruption, as in the callback of a weak reference; report all else.

    After an interruption nothing is reported: its own sentence is enough.
    """
    if issubclass(trouble.exc_type, KeyboardInterrupt):
        _interrupt_again()
    elif not _raised:
        sys.__unraisablehook__(trouble)


def _interrupt_again() -> None:
    # A signal to the thread itself: it ends a wait as well.
    again = threading.Timer(_AGAIN, signal.pthread_kill, (threading.main_thread().ident, signal.SIGTERM))
    again.daemon = True
    again.start()
