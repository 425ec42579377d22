"""Undamped critical-speed map: forward critical speeds of a rotor over the stiffness of its bearings.

In isotropic bearings forward synchronous whirl is a planar problem: with Ω = ω the rotary inertia enters as
(I_d − I_p) ω², here a circular block of `rotors.spatial_chain` at λ = iω and Ω = ω. Every curve is exact, and at every
stiffness the number of its points is proved by the count of `rotors.whirl_count`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .bearing import Bearing
from .critical import certified_criticals
from .errors import RotorError, require, require_count
from .planar_basis import planar_basis
from .projection import ModalProjection
from .shaft import Rotor

FloatArray = npt.NDArray[np.float64]

DEFAULT_CRITICALS = 4


@dataclass(frozen=True)
class CriticalSpeedMap:
    """Critical speeds over bearing stiffness.

    Attributes
    ----------
    stiffnesses
        (s,): of every bearing, N/m.
    speeds
        (s, c): ascending, rad/s; NaN where a disc's polar inertia leaves fewer.
    direction
        1 of forward whirl, −1 of backward.
    """

    stiffnesses: FloatArray
    speeds: FloatArray
    direction: int = 1


def critical_speed_map(
    rotor: Rotor,
    bearings: Sequence[Bearing],
    stiffnesses: npt.ArrayLike,
    *,
    count: int = DEFAULT_CRITICALS,
    direction: int = 1,
) -> CriticalSpeedMap:
    """Undamped critical speeds with every bearing's stiffness replaced by each of some.

    Parameters
    ----------
    rotor, bearings
        The rotor, and where its bearings are; a bearing's own stiffness and damping do not matter.
    stiffnesses
        (s,): N/m, alike in all directions.
    count
        Number of critical speeds.
    direction
        1 for forward whirl, −1 for backward.

    Raises
    ------
    RotorError
        A stiffness that is not positive, no bearings, or another direction.
    IncompleteModesError
        A count and its roots do not agree.
    """
    values = np.atleast_1d(np.asarray(stiffnesses, dtype=np.float64))
    good = values.ndim == 1 and bool(np.isfinite(values).all() and (values > 0.0).all())
    require(good, "stiffnesses", values.tolist(), "positive numbers, N/m")
    require_count("count of critical speeds", count)
    require(direction in (1, -1), "direction", direction, "1 (forward) or -1 (backward)")
    if not bearings:
        raise RotorError(f"rotor {rotor.name!r} has no bearings; expected at least one to vary")
    rows = np.full((values.size, count), np.nan)
    for k, stiffness in enumerate(values.tolist()):
        held = [
            replace(b, stiffness=stiffness * np.eye(2), damping=np.zeros((2, 2)), speeds=None, pedestal=None)
            for b in bearings
        ]
        basis = planar_basis(rotor, held, None, 2 * count)
        one = ModalProjection.of(rotor, held, (direction,), basis)
        roots, _ = certified_criticals(rotor, held, [one], None, count)
        speeds = np.sort(roots.eigenvalues.imag)
        rows[k, : speeds.size] = speeds
    return CriticalSpeedMap(values, rows, direction)
