"""Basic rating life of a rolling bearing by ISO 281: 90 % of like bearings reach it.

L₁₀ = (C/P)^p million revolutions with the dynamic rating C, the equivalent load P and p = 3 for balls or 10/3 for
rollers. P = X F_r + Y F_a of the radial and the axial load; where F_a/F_r is at most e, the axial load does not count.
Holds for steady loads up to half of C, without the moments; X, Y and e of one row are those of ISO 281:2007, table 3,
between whose entries one interpolates.
"""

import numpy as np

from rotors.errors import require_finite
from rotors.rolling_bearings.equilibrium import RollingState
from rotors.rolling_bearings.roller_rows import RollerRow
from rotors.rolling_bearings.rows import BallRow

_MILLION = 1e6
# Deep-groove balls: relative axial load F_a / (Z D_w²) [Pa], e, and Y; X is the same for all.
_RELATIVE_LOAD = 1e6 * np.array([0.172, 0.345, 0.689, 1.03, 1.38, 2.07, 3.45, 5.17, 6.89])
_DEEP_GROOVE_E = np.array([0.19, 0.22, 0.26, 0.28, 0.30, 0.34, 0.38, 0.42, 0.44])
_DEEP_GROOVE_Y = np.array([2.30, 1.99, 1.71, 1.55, 1.45, 1.31, 1.15, 1.04, 1.00])
_DEEP_GROOVE_X = 0.56
# Angular-contact balls: contact angle [rad], e, X and Y.
_ANGLE = np.radians([20.0, 25.0, 30.0, 35.0, 40.0, 45.0])
_ANGULAR_E = np.array([0.57, 0.68, 0.80, 0.95, 1.14, 1.34])
_ANGULAR_X = np.array([0.43, 0.41, 0.39, 0.37, 0.35, 0.33])
_ANGULAR_Y = np.array([1.00, 0.87, 0.76, 0.66, 0.57, 0.50])


def equivalent_load(state: RollingState) -> float | None:
    """Equivalent dynamic load P of a bearing under its load [N].

    None where the table has no factors: bearings of several rows, balls at contact angles between 0° and 20° or
    beyond 45°, and deep-groove balls under more axial load than it lists.
    """
    if len(state.bearing.rows) != 1:
        return None
    (row,) = state.bearing.rows
    radial = float(np.hypot(*state.load[:2]))
    axial = abs(float(state.load[2]) + state.bearing.axial_preload)
    if isinstance(row, RollerRow):
        return radial
    factors = _factors(row, axial)
    if factors is None:
        return None
    e, x, y = factors
    return radial if axial <= e * radial else x * radial + y * axial


def rated_revolutions(state: RollingState, dynamic_rating: float) -> float | None:
    """Return the basic rating life L₁₀ of a bearing under its load, in revolutions.

    Parameters
    ----------
    state
        The bearing in equilibrium under its load.
    dynamic_rating
        C, as its maker prints it [N].

    Returns
    -------
    float or None
        Infinite without load; None where the equivalent load is not defined (:func:`equivalent_load`).

    Raises
    ------
    RotorError
        A rating that is not positive and finite.
    """
    require_finite("dynamic rating", dynamic_rating, positive=True)
    load = equivalent_load(state)
    if load is None:
        return None
    exponent = 10.0 / 3.0 if isinstance(state.bearing.rows[0], RollerRow) else 3.0
    return float("inf") if load == 0.0 else _MILLION * float((dynamic_rating / load) ** exponent)


def _factors(row: BallRow, axial: float) -> tuple[float, float, float] | None:
    """e, X and Y of a row of balls."""
    angle = row.contact_angle
    if angle == 0.0:
        relative = axial / (row.count * row.element_diameter**2)
        if relative > _RELATIVE_LOAD[-1]:
            return None
        e, y = (float(np.interp(relative, _RELATIVE_LOAD, of)) for of in (_DEEP_GROOVE_E, _DEEP_GROOVE_Y))
        return e, _DEEP_GROOVE_X, y
    if not _ANGLE[0] - 1e-9 <= angle <= _ANGLE[-1] + 1e-9:
        return None
    e, x, y = (float(np.interp(angle, _ANGLE, of)) for of in (_ANGULAR_E, _ANGULAR_X, _ANGULAR_Y))
    return e, x, y
