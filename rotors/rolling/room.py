"""Check that the elements of a row fit on the pitch circle."""

import math

from rotors.errors import require, require_count, require_finite


def require_space(what: str, count: int, diameter: float, pitch_diameter: float) -> None:
    """Raise `RotorError` unless three or more elements fit side by side on the pitch circle; diameters in m."""
    require_count(f"count of {what}s", count)
    require(count >= 3, f"count of {what}s", count, "three or more")
    require_finite(f"{what} diameter", diameter, positive=True)
    require_finite("pitch diameter", pitch_diameter, positive=True)
    room = pitch_diameter * math.sin(math.pi / count)
    require(diameter < room, f"{what} diameter", diameter, f"less than {room:g} m, the room that {count} {what}s have")
