"""Runout: transmission error of gears that are eccentric on their shafts."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from coupling.gears.geometry import Gear

FloatArray = npt.NDArray[np.float64]


def runout_error(
    driver: Gear,
    driven: Gear,
    line_of_action_angle: float,
    driver_angle: npt.ArrayLike,
    driven_angle: npt.ArrayLike,
) -> FloatArray:
    """Error ``e_err`` in the compression ``s (R_k th_k + R_i th_i) + e . (u_k - u_i) - e_err``.

    A centre that circles with eccentricity ``eps`` moves the gear by ``eps (cos, sin)(theta + phase)`` on top of
    its shaft's motion ``u``, so ``e_err = -e . (eps_k - eps_i)``.  First order in the eccentricities: the
    pressure angle is held.

    Parameters
    ----------
    driver, driven : Gear
        Their `eccentricity` [m] and `eccentricity_phase` [rad] are used.
    line_of_action_angle : float
        Angle of e from x [rad], `GearPairGeometry.line_of_action_angle`.
    driver_angle, driven_angle : array_like, shape (n,)
        Rotations of the two gears, counter-clockwise positive [rad].

    Returns
    -------
    ndarray, shape (n,)
        [m].
    """
    components = [
        gear.eccentricity * np.cos(np.asarray(angle, dtype=np.float64) + gear.eccentricity_phase - line_of_action_angle)
        for gear, angle in ((driver, driver_angle), (driven, driven_angle))
    ]
    return np.asarray(components[1] - components[0], dtype=np.float64)
