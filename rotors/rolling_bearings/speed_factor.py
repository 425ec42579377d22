"""Speed factor n d_m of rolling bearings, beyond which the centrifugal force of their elements matters."""

import math
from collections.abc import Iterable, Mapping

from gearwhine.numerics.result_warnings import ResultWarning, warning
from gearwhine.rotors.rolling_bearings.rolling_bearing import RollingBearing

FASTEST = 5e5
"""Speed factor n d_m of a rolling bearing [mm/min] beyond which the centrifugal force of its elements is warned of.

At it a ball of a 6308 (65 mm, 15 mm) is thrown outwards with 44 N, which is 3 % of the load of the most loaded one
where the bearing carries a twentieth of its dynamic rating.
"""


def centrifugal_warnings(
    bearings: Iterable[tuple[str, RollingBearing, float]], largest: Mapping[str, float] | None = None
) -> list[ResultWarning]:
    """Warn of rolling bearings whose elements' centrifugal force, which their equilibrium leaves out, matters.

    Parameters
    ----------
    bearings : iterable of (str, RollingBearing, float)
        Name, elements and shaft speed of each bearing [rad/s].
    largest : mapping of str to float, optional
        Load of the most loaded element on the outer ring by bearing, where it is known [N].
    """
    warnings = []
    for name, bearing, speed in bearings:
        row = max(bearing.rows, key=lambda candidate: candidate.pitch_diameter)
        rpm = abs(speed) * 60.0 / (2.0 * math.pi)
        factor = rpm * 1e3 * row.pitch_diameter
        if factor <= FASTEST:
            continue
        force, load = row.centrifugal_force(speed), (largest or {}).get(name)
        beside = "" if load is None else f", beside {load:.3g} N on the most loaded one"
        warnings.append(
            warning(
                "bearing speed",
                f'bearing "{name}": n·d_m = {factor:.3g} mm/min ({rpm:.5g} rpm, pitch circle '
                f"{1e3 * row.pitch_diameter:.4g} mm), above {FASTEST:.0f}: its elements are thrown on the outer ring "
                f"with {force:.3g} N each{beside}; the equilibrium leaves that out, so pressure and life of the outer "
                "ring are too favourable, and contact angles and stiffness are those at low speed",
                bearing=name,
                speed_factor_mm_per_min=factor,
                centrifugal_force_n=force,
            )
        )
    return warnings
