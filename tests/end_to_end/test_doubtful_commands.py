"""What commands refuse, or warn of, where a case can be solved but means nothing."""

import pytest

from gearwhine.cli import run_command

RADIAL = 'bearing.{}.stiffness={{ xx = "2e8 N/m", yy = "2e8 N/m" }}'
UNDAMPED = 'bearing.{}.damping={{ xx = "800 N*s/m", yy = "800 N*s/m" }}'


@pytest.mark.parametrize("command", ["check", "system", "run", "steady"])
def test_thrust_that_no_bearing_carries_is_refused_by_every_command(
    command: str, capsys: pytest.CaptureFixture[str], tmp_path
) -> None:  # type: ignore[no-untyped-def]
    changes = [part for text in (RADIAL, UNDAMPED) for i in (0, 2) for part in ("--set", text.format(i))]
    assert run_command([command, "helical-pair", "-q", "-o", str(tmp_path / "out"), *changes]) == 2
    told = capsys.readouterr().err
    assert "'pinion' push it along its axis with 1125 N" in told
    assert "'wheel' push it along its axis with 1125 N" in told
    assert "Traceback" not in told


def test_check_refuses_a_load_that_the_rolling_bearing_cannot_carry(
    capsys: pytest.CaptureFixture[str],
) -> None:
    changes = [
        'bearing.0.stiffness={ rolling = { catalogue = { type = "deep-groove", bore = "35 mm", '
        'outer_diameter = "72 mm", width = "17 mm" } } }',
        'bearing.0.load={ x = "90 kN", y = 0 }',
    ]
    settings = [part for change in changes for part in ("--set", change)]
    told = []
    for command in ("rotors", "check"):
        assert run_command([command, "spur-pair", "-q", *settings]) == 2
        told.append(capsys.readouterr().err)
    assert told[0] == told[1]
