"""Options that count: a number that is not whole is refused, not rounded."""

import pytest

from gearwhine.cli import run_command


@pytest.mark.parametrize(
    "arguments",
    [["vary", "helical-pair", "-n", "2.5"], ["sweep", "helical-pair", "--workers", "1.5"]],
)
def test_a_number_that_is_not_whole_is_refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(arguments) == 2
    assert f"expected a whole number, got {arguments[-1]!r}" in capsys.readouterr().err
