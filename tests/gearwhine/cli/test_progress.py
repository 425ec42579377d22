"""Progress in lines, what it says where kernels are compiled, and work on two threads under it."""

import io
import logging
import threading
import time
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import LoadedCase
from gearwhine.cli.common import Common, on_case
from gearwhine.numerics import compiled
from gearwhine.numerics.progress import Progress, in_order
from gearwhine.progress import shown


def test_compilation_is_news_of_the_present_work(capsys: pytest.CaptureFixture[str]) -> None:
    logger = logging.getLogger(compiled.__name__)
    before = (logger.level, list(logger.handlers))
    with shown(quiet=False) as progress:
        for work in ("rotor input", "rotor input: whirl over speed", "modes"):
            progress(work)
            logger.info("compiling one")
            logger.info("compiling another")
    assert (logger.level, logger.handlers) == before
    said = [line.partition("] ")[2] for line in capsys.readouterr().err.splitlines()]
    news = ": compiling kernels, the first time only"
    expected = ["rotor input", "rotor input" + news, "rotor input: whirl over speed", "rotor input" + news]
    assert said == [*expected, "modes", "modes" + news]


def test_a_live_line_keeps_its_times_beside_long_words(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    said = Terminal()
    monkeypatch.setattr("sys.stderr", said)
    for name, value in (("COLUMNS", "80"), ("NO_COLOR", "1"), ("TERM", "xterm")):
        monkeypatch.setenv(name, value)
    with shown(quiet=False) as progress:
        progress("motion of the triangles with the housing's modes: " + 5 * "round after round ", 0.5)
    (line, *_) = [line for line in said.getvalue().splitlines() if "motion of" in line]
    assert "0:00:00" in line
    assert "…" in line


@pytest.mark.parametrize("quiet", [True, False])
def test_quiet_is_quiet_whatever_is_printed(quiet: bool, capsys: pytest.CaptureFixture[str]) -> None:
    def work(_: LoadedCase, progress: Progress) -> dict[str, Any]:
        progress("modes")
        logging.getLogger(compiled.__name__).info("compiling one")
        return {}

    on_case("friswell-rotor", Common(quiet=quiet, json=not quiet), work, lambda _: None, "rotors")
    written = capsys.readouterr()
    assert (written.err == "", written.out == "") == (quiet, quiet)
    assert ("modes" in written.err) is not quiet


def test_work_on_two_threads_is_handed_back_in_order() -> None:
    """The first item ends last, on another thread than the second."""
    said: list[tuple[str, float | None]] = []
    second, threads = threading.Event(), set()

    def solve(number: int) -> int:
        threads.add(threading.get_ident())
        if number == 1:
            second.set()
        elif number == 0:
            assert second.wait(10.0)
            time.sleep(0.01)
        return number * number

    assert in_order(solve, range(4), "squares", lambda what, part=None: said.append((what, part))) == (0, 1, 4, 9)
    assert said == [("squares", 0.0), ("squares", 0.25), ("squares", 0.5), ("squares", 0.75), ("squares", 1.0)]
    assert len(threads) == 2
    assert in_order(solve, (), "squares") == ()


def test_an_error_in_a_thread_is_that_of_the_work() -> None:
    with pytest.raises(ZeroDivisionError):
        in_order(lambda number: 1 // number, [1, 0, 1], "quotients")


def test_lines_are_printed_where_the_words_change(capsys: pytest.CaptureFixture[str]) -> None:
    for part in range(301):
        gw.print_progress("responses to the errors of the meshes", part / 300)
    gw.print_progress("comparing with another modal basis")
    written = capsys.readouterr()
    lines = written.err.splitlines()
    assert not written.out
    assert [line.partition("] ")[2] for line in lines if "meshes" in line][-1].endswith(" 100 %")
    assert "comparing with another modal basis" in lines[-1]
    assert len(lines) <= 5
