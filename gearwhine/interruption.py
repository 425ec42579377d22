"""Ctrl-C and a polite kill: both unwind the work as a KeyboardInterrupt, wherever that is safe."""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_AGAIN = 0.05
"""After how long an interruption that had to wait comes again [s]."""

_IMPORTING = "<frozen importlib._bootstrap>"


@contextmanager
def interruptible() -> Iterator[None]:
    """Let SIGINT and SIGTERM raise KeyboardInterrupt in the main thread, so that staged files are cleared away.

    Elsewhere than in the main thread nothing is changed, nor is a SIGINT that the parent process told to ignore.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
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


_raised: list[int] = []
"""Interruptions raised so far: what is half built when one strikes falls apart with troubles of its own."""


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
    """Interrupt again where Python drops an interruption, as in the callback of a weak reference; tell all else.

    After an interruption nothing is told: its own sentence is enough.
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
