"""An interruption that Python drops, in the callback of a weak reference, comes again and is no traceback."""

import signal
import time
import weakref

import pytest

from gearwhine import cli


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

    before = signal.getsignal(signal.SIGTERM)
    monkeypatch.setattr(cli, "app", work)
    begin = time.perf_counter()
    try:
        assert cli.run_command([]) == 130
    finally:
        signal.signal(signal.SIGTERM, before)
    assert time.perf_counter() - begin < 9.0
    assert capsys.readouterr().err == "gearwhine: interrupted; the output folder holds no half-written file\n"
