"""Units of speed: rpm and rad/s; units of quantities in case files are those of :mod:`gearwhine.case.units`."""

import math


def rpm(value: float) -> float:
    """Revolutions a minute as an angular speed [rad/s]."""
    return value * math.pi / 30.0


def to_rpm(speed: float) -> float:
    """Angular speed [rad/s] in revolutions a minute."""
    return speed * 30.0 / math.pi
