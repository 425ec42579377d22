"""Progress in lines, and what it says where kernels are compiled."""

import logging

import pytest

from gearwhine.progress import shown
from rotors.numerics import compiled


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


def test_quiet_is_quiet(capsys: pytest.CaptureFixture[str]) -> None:
    with shown(quiet=True) as progress:
        progress("modes")
        logging.getLogger(compiled.__name__).info("compiling one")
    assert capsys.readouterr().err == ""
