"""Units at the door: everything inside the library is in SI and radians per second."""

import math


def rpm(value: float) -> float:
    """Revolutions a minute as an angular speed [rad/s]."""
    return value * math.pi / 30.0
