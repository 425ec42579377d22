"""Interruption by Ctrl-C or SIGTERM: both raise KeyboardInterrupt where that is safe.

Python runs a signal's handler between two steps of the main thread. Compiled code, such as a factorisation, a product
of large matrices or the compiler of the kernels, may last for a minute without one. A command therefore has a thread
that the system itself wakes at a signal (:func:`ended_when_deaf`): where the exception has not unwound the command
within two seconds, that thread clears away what is half-written and ends the process. Where that code keeps threads
from running, too, a small process beside does that.
"""

import os
import select
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import SimpleQueue
from types import FrameType
from typing import TypeVar

T = TypeVar("T")

_NUMBERS = (signal.SIGINT, signal.SIGTERM)

INTERRUPTED = 130
"""Exit code of an interrupted command."""

_PATIENCE = 2.0
"""Time in which an interruption is to unwind a command, before its process is ended [s]."""

_GUARDS_PATIENCE = 2.5
"""Time after which a guard kills the process [s]."""

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
def ended_when_deaf(say: Callable[[list[str]], None]) -> Iterator[None]:
    """End the process with exit code 130 where an interruption does not unwind this block within two seconds.

    Whatever :func:`cleared_at_the_end` names is cleared away first, and further processes are killed. For a command
    that is a process of its own: the code that the main thread is in never returns. Where that code keeps even other
    threads from running, as a factorisation does, a guard, which is forked here, removes the folders named and kills
    the process.

    Parameters
    ----------
    say : callable
        Says that the command was interrupted; called with the notes of what was cleared away.
    """
    global _told
    heard, wake = os.pipe()  # from the system's handler to the guard
    relayed, relay = os.pipe()  # from the guard to the thread
    told, _told = os.pipe()  # from the command to the guard
    guard = os.fork()
    if guard == 0:
        for end in (wake, relayed, _told):
            os.close(end)
        try:
            _guard(os.getppid(), heard, relay, told, say)
        finally:
            os._exit(0)
    for end in (heard, relay, told):
        os.close(end)
    os.set_blocking(wake, False)
    before = signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    left = threading.Event()
    watch = threading.Thread(target=_end_when_deaf, args=(relayed, left, say), name="interruption", daemon=True)
    watch.start()
    try:
        yield
    finally:
        left.set()
        signal.set_wakeup_fd(before)
        os.close(wake)
        os.close(_told)
        _told = None
        os.waitpid(guard, 0)
        watch.join()
        os.close(relayed)


def _end_when_deaf(relayed: int, left: threading.Event, say: Callable[[list[str]], None]) -> None:
    while number := os.read(relayed, 1):
        if number[0] in _NUMBERS and not left.wait(_PATIENCE):
            notes = []
            for clear in reversed(_clearances):
                with suppress(Exception):
                    notes.append(clear())
            # Workers, where there are any: the module takes time to import.
            if (multiprocessing := sys.modules.get("multiprocessing")) is not None:
                for process in multiprocessing.active_children():
                    process.kill()
            say([note for note in notes if note])
            os._exit(INTERRUPTED)


def _guard(command: int, heard: int, relay: int, told: int, say: Callable[[list[str]], None]) -> None:
    """Relay signals to the thread, and kill the command where that does not end it; until the command ends."""
    for number in _NUMBERS:
        signal.signal(number, signal.SIG_IGN)
    texts: bytes = b""
    limit: float | None = None
    while True:
        wait = None if limit is None else max(limit - time.monotonic(), 0.0)
        ready = select.select([heard, told], [], [], wait)[0]
        if told in ready:
            if not (text := os.read(told, 4096)):
                return
            texts += text
        if heard in ready and (signalled := os.read(heard, 1)):
            os.write(relay, signalled)
            if signalled[0] in _NUMBERS and limit is None:
                limit = time.monotonic() + _GUARDS_PATIENCE
        if not ready:
            os.kill(command, signal.SIGKILL)
            folders: dict[str, None] = {}
            for line in texts.decode().splitlines():
                folders[line[1:]] = None
                if line[0] == "-":
                    del folders[line[1:]]
            for folder in folders:
                shutil.rmtree(folder, ignore_errors=True)
                with suppress(OSError):  # of other results
                    Path(folder).parent.rmdir()
            say([])
            return


_clearances: list[Callable[[], str | None]] = []
_told: int | None = None
"""Pipe to the guard of this process, which takes folders in lines, with + as they come and - as they go."""


@contextmanager
def cleared_at_the_end(clear: Callable[[], str | None], folder: Path | None = None) -> Iterator[None]:
    """Call a function where the process is ended within this block; the block itself clears away in all other cases.

    Parameters
    ----------
    clear : callable
        Clears away what is half-written, or ends a process; called without arguments from another thread. The text that
        it returns is said to the user.
    folder : Path, optional
        Folder of half-written files, which goes where no thread of the process can run. Where its parent is empty then,
        it goes, too.
    """
    _clearances.append(clear)
    _tell_guard("+", folder)
    try:
        yield
    finally:
        _clearances.remove(clear)
        _tell_guard("-", folder)


def _tell_guard(sign: str, folder: Path | None) -> None:
    if _told is not None and folder is not None:
        with suppress(OSError):  # the guard was killed
            os.write(_told, f"{sign}{folder.absolute()}\n".encode())


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
