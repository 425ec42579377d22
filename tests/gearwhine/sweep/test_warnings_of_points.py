"""Warnings of a sweep: those of its points, each once."""

from types import SimpleNamespace
from typing import Any

from gearwhine.coupling.linear.carriers.frozen_directions import FROZEN_CARRIER
from gearwhine.numerics.result_warnings import warning
from gearwhine.sweep.collect import _warnings
from gearwhine.sweep.solution import PointResult


def point(*warnings: Any) -> Any:
    motion: Any = None
    return SimpleNamespace(outcome=PointResult({"warnings": list(warnings)}, motion))


def frozen(turning: list[str], hertz: float) -> Any:
    return warning(FROZEN_CARRIER, f"frozen at {hertz} Hz", turning=turning, turning_hz=hertz)


def test_carriers_that_are_frozen_at_every_speed_are_warned_of_once() -> None:
    other = warning("mesh", "coarse")
    points = [point(frozen(["planet"], hertz), other) for hertz in (10.0, 12.0, 14.0)]
    points.append(point(frozen(["planet", "second planet"], 14.0)))
    points.append(SimpleNamespace(outcome="no motion"))
    told = _warnings(points)
    assert [one["message"] for one in told] == [
        "frozen at 10.0 Hz (the first of 3 points)",
        "coarse",
        "frozen at 14.0 Hz",
    ]
    assert told[0]["turning_hz"] == 10.0
    assert _warnings(points[:1])[0]["message"] == "frozen at 10.0 Hz"
