"""Arrangement of a machine's parts: bearings in their seats and over their speeds, pedestals.

The case reader calls the same rules before there is a machine.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from gearwhine.coupling.description.gear_train import LARGEST_OFFSET
from gearwhine.numerics.findings import Finding, Part, in_mm

_BORE_ERROR = 1e-3
"""Offset of a seat below which it is one of manufacture [m]."""
_SPEED_ROUNDING = 1e-9
"""Relative rounding of printed speeds."""
_RPM = 30.0 / math.pi


@dataclass(frozen=True)
class SeatPlace:
    """Name, centre x, y, z [m] of a seat, and the distance along z within which a bearing sits in it, where known."""

    name: str
    center: tuple[float, float, float]
    reach: float | None = None


def seat_findings(
    part: Part, rotor: str, axis: Sequence[float], start: float, at: float, seat: SeatPlace
) -> Iterator[Finding]:
    """Yield findings where a rotor's axis or a bearing's place along it misses the seat.

    Parameters
    ----------
    part : Part
        The bearing.
    rotor : str
    axis : sequence of float
        x and y of the rotor's axis [m].
    start, at : float
        z of the rotor's left end, and the bearing's distance from there [m].
    seat : SeatPlace
    """
    offset = math.hypot(axis[0] - seat.center[0], axis[1] - seat.center[1])
    if offset > LARGEST_OFFSET:
        expected = (
            f'a seat on the axis of rotor "{rotor}"; the seat\'s centre is {in_mm(offset)} off it '
            f"(axis at {in_mm(axis[0])}, {in_mm(axis[1])}; centre at {in_mm(seat.center[0])}, {in_mm(seat.center[1])})"
        )
        if offset < _BORE_ERROR:
            expected += "; what a bore out of place does to the flanks is errors.helix.slope of a gear"
        yield Finding(part, "seat", seat.name, expected)
    z = start + at
    if seat.reach is not None and abs(z - seat.center[2]) > seat.reach:
        expected = (
            f'a station within {in_mm(seat.reach)} of seat "{seat.name}" along z (this one is at z = {in_mm(z)}, '
            f"the seat at {in_mm(seat.center[2])})"
        )
        yield Finding(part, "at", at, expected)


def pedestal_finding(part: Part, seat: str, pedestal: object) -> Finding:
    """Return the finding of a pedestal under a bearing in a seat."""
    expected = f'no pedestal under a bearing in seat "{seat}", which moves with the housing'
    return Finding(part, "pedestal", pedestal, expected)


def table_findings_of_speeds(
    part: Part, rotor: str, speeds: Sequence[float], needed: Sequence[float]
) -> Iterator[Finding]:
    """Yield a bearing's table over speeds that does not hold all speeds at which its rotor turns [rad/s]."""
    if needed and (
        min(needed) < speeds[0] * (1.0 - _SPEED_ROUNDING) or max(needed) > speeds[-1] * (1.0 + _SPEED_ROUNDING)
    ):
        expected = (
            f'a table that holds the speeds of rotor "{rotor}", {min(needed) * _RPM:.6g} to '
            f"{max(needed) * _RPM:.6g} rpm (it goes from {speeds[0] * _RPM:.6g} to {speeds[-1] * _RPM:.6g} rpm)"
        )
        yield Finding(part, "speeds", speeds, expected)


POWER_FROM_THE_DRIVER = "power to flow from driver to driven, in the frame of planets' carrier; swap the two names"
BACKLASH_OF_A_BRAKE = (
    "a backlash: the torque is negative, so the driven gear drives by the back flanks, which never meet without one; "
    "standard gears at their standard distance have none: give their tooth_thinning, or the backlash of the pair"
)


_FREE_FALLS = (0.1, 30.0)
"""Accelerations of free fall, from small moons to Jupiter [m/s²]."""


def gravity_findings(gravity: Sequence[float]) -> Iterator[Finding]:
    """Yield an acceleration of free fall [m/s²] that no place has."""
    size = math.hypot(*gravity)
    if size and not _FREE_FALLS[0] <= size <= _FREE_FALLS[1]:
        expected = "a free fall of 0.1 to 30 m/s^2 (on earth 9.81)"
        yield Finding(("machine", ""), "gravity", tuple(gravity), expected, "warning")


def output_elsewhere(first: str) -> str:
    """Return what is expected of an output on the rotor of the first driver."""
    return f'a rotor other than "{first}", where the torque comes in'


def pin_findings(
    part: Part, carrier: str | None, pin_error: tuple[float, float], pin: float | None, bores: Sequence[float]
) -> Iterator[Finding]:
    """Yield a pin of a shaft that is no planet, and one that is thicker than the bore around it.

    ``pin`` is its diameter, 0 where only its stiffness is known, and None of a rigid pin [m]; ``bores`` are those of
    the shaft's segments.
    """
    if carrier is None and any(pin_error):
        yield Finding(part, "pin_error", pin_error, "(0, 0) of a shaft without a carrier; a place of its own is `axis`")
    if carrier is None and pin is not None:
        yield Finding(part, "pin", None, "none of a shaft without a carrier, in whose walls it would be")
    if pin is not None and any(bores) and pin >= max(bores):
        yield Finding(part, "pin", None, f"a pin thinner than the bore of the planet around it, {in_mm(max(bores))}")
