"""Interruptions at awkward moments: where Python drops them, and within an import, which is let finish."""

import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from pathlib import Path

import pytest

from gearwhine.cli import command_line
from gearwhine.interruption import cleared_at_the_end, each_from_thread, in_thread, uninterrupted


@pytest.fixture(autouse=True)
def heeded() -> Iterator[None]:
    """A shell has what it starts in the background ignore Ctrl-C, and so does a command then; here it must not."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


class Mortal:
    """What a weak reference can be to."""


def test_an_interruption_in_a_callback_ends_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def work(*_: object, **__: object) -> None:
        one = Mortal()
        watched = weakref.ref(one, lambda _: signal.raise_signal(signal.SIGTERM))
        del one
        assert watched() is None
        time.sleep(10.0)

    monkeypatch.setattr(command_line, "app", work)
    begin = time.perf_counter()
    assert command_line.run_command([]) == 130
    assert time.perf_counter() - begin < 9.0
    assert capsys.readouterr().err == "gearwhine: interrupted; the output folder holds no half-written file\n"


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_an_import_is_not_cut_short(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, how: signal.Signals) -> None:
    (tmp_path / "slow_to_begin.py").write_text(
        f"import signal, time\nsignal.raise_signal({int(how)})\ntime.sleep(0.2)\nwhole = True\n"
    )
    monkeypatch.syspath_prepend(tmp_path)

    def work(*_: object, **__: object) -> None:
        import slow_to_begin

        assert slow_to_begin.whole
        time.sleep(10.0)

    monkeypatch.setattr(command_line, "app", work)
    begin = time.perf_counter()
    assert command_line.run_command([]) == 130
    assert time.perf_counter() - begin < 9.0
    assert sys.modules.pop("slow_to_begin").whole


@pytest.mark.parametrize("answer", [RuntimeError("a kernel failed"), BrokenPipeError(), ValueError("a wrong number")])
def test_an_error_that_a_library_makes_of_an_interruption_is_the_interruption(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], answer: Exception
) -> None:
    def work(*_: object, **__: object) -> None:
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            raise answer from None

    monkeypatch.setattr(command_line, "app", work)
    assert command_line.run_command([]) == 130
    assert capsys.readouterr().err == "gearwhine: interrupted; the output folder holds no half-written file\n"


def test_what_falls_apart_by_an_interruption_is_not_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class HalfBuilt:
        def __init__(self) -> None:
            signal.raise_signal(signal.SIGINT)
            self.handle = 0

        def __del__(self) -> None:
            del self.handle

    monkeypatch.setattr(command_line, "app", lambda *_, **__: HalfBuilt())
    assert command_line.run_command([]) == 130
    assert "Traceback" not in capsys.readouterr().err


def test_the_handlers_are_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def handlers() -> list[object]:
        return [signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM), sys.unraisablehook]

    before, within = handlers(), []
    monkeypatch.setattr(command_line, "app", lambda *_, **__: within.extend(handlers()))
    assert command_line.run_command([]) == 0
    assert handlers() == before
    assert not set(within) & set(before)


def test_what_is_held_back_strikes_at_the_end_of_the_block() -> None:
    done = []

    def work() -> None:
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)
            done.append("inside")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done == ["inside"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_what_is_worked_out_aside_is_waited_for_where_an_interruption_is_safe() -> None:
    """The thread at work never sees one: it gives back its lock, however often the one that waits is interrupted."""
    lock, told = threading.Lock(), threading.Event()

    def items() -> Iterator[int]:
        with lock:
            told.wait(20.0)
            yield 1

    found = each_from_thread(items())
    timer = threading.Timer(0.1, signal.pthread_kill, (threading.get_ident(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        next(found)
    told.set()
    assert lock.acquire(timeout=10.0)


def test_results_and_errors_come_from_aside() -> None:
    assert list(each_from_thread(iter([1, None, 3]))) == [1, None, 3]
    assert in_thread(lambda: None) is None
    with pytest.raises(ZeroDivisionError):
        in_thread(lambda: 1 / 0)


# Compiled code that takes minutes without a step of Python, and lets other threads run.
DEAF = """
import hashlib, subprocess, sys
from pathlib import Path
import numpy as np
from gearwhine.cli import command_line
from gearwhine.drawing_process import _Running, one_process
from gearwhine.output import staging
from gearwhine.output.checkpoints import stored_record

def work(*_, **__):
    kept, empty = stored_record(Path("kept"), 16 * "a"), stored_record(Path("empty"), 16 * "b")
    with kept as blocks, empty, one_process() as drawing:
        blocks.append({"time": np.arange(3.0)})
        piped, line = subprocess.PIPE, [sys.executable, "-c", "input()"]
        child = subprocess.Popen(line, stdin=piped, stdout=piped, stderr=subprocess.DEVNULL)
        drawing._running = _Running(child, child.stdin, child.stdout, child.stdin)
        with staging(Path("new")) as place:
            (place / "half.json").write_text("{")
            print(child.pid, flush=True)
            WORK

command_line.app = work
sys.exit(command_line.run_command([], is_process=True))
"""


LETS_THREADS_RUN = 'hashlib.pbkdf2_hmac("sha256", b"deaf", b"deaf", 2_000_000_000)'


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_compiled_code_that_takes_no_signal_is_ended(tmp_path: Path, how: signal.Signals) -> None:
    """Nothing half-written stays, blocks of a motion do, and no process goes on."""
    deaf = DEAF.replace("WORK", LETS_THREADS_RUN)
    process = subprocess.Popen(
        [sys.executable, "-c", deaf], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    child = Path("/proc", process.stdout.readline().strip())
    time.sleep(0.5)  # until the compiled code is at work
    process.send_signal(how)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 130, errors
    first, second = errors.splitlines()
    assert first == "gearwhine: interrupted; the output folder holds no half-written file"
    assert second.startswith("gearwhine: what was marched so far is kept in kept/.resume-")
    assert second.endswith(": the same command goes on from there, --fresh does not")
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["block-00000000.npz"]
    assert {path.name for path in tmp_path.iterdir()} == {"kept"}
    limit = time.monotonic() + 20.0
    while child.exists() and child.joinpath("stat").read_text(encoding="utf-8").split()[2] != "Z":
        assert time.monotonic() < limit, "the child lives on"
        time.sleep(0.05)


def test_compiled_code_that_lets_no_thread_run_is_killed(tmp_path: Path) -> None:
    """A sum in one call takes hours, in which no thread runs."""
    deaf = DEAF.replace("WORK", "sum(range(10**13))")
    process = subprocess.Popen(
        [sys.executable, "-c", deaf], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.5)  # until the compiled code is at work
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == -signal.SIGKILL
    assert errors == "gearwhine: interrupted; the output folder holds no half-written file\n"
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["block-00000000.npz"]
    assert not (tmp_path / "new").exists()


def test_an_interruption_that_unwinds_in_time_ends_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The wakeup of signals is given back, and what clears away at the end is forgotten."""
    unwound: list[str] = []

    def clear() -> None:
        unwound.append("by the thread")

    def work(*_: object, **__: object) -> None:
        with cleared_at_the_end(clear):
            try:
                signal.raise_signal(signal.SIGTERM)
                time.sleep(10.0)
            finally:
                unwound.append("by itself")

    before = signal.set_wakeup_fd(-1)
    signal.set_wakeup_fd(before)
    threads = threading.active_count()
    monkeypatch.setattr(command_line, "app", work)
    assert command_line.run_command([], is_process=True) == 130
    assert capsys.readouterr().err == "gearwhine: interrupted; the output folder holds no half-written file\n"
    assert unwound == ["by itself"]
    assert threading.active_count() == threads
    assert signal.set_wakeup_fd(before) == before
