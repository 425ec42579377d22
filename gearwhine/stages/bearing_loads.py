"""Bearing loads of a run beside the loads that the bearings' stiffness was computed for."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from gearwhine.case import Case, RollingStiffness, StopStiffness
from gearwhine.doubtful import warning

FloatArray = npt.NDArray[np.float64]

_DIFFERENCE = 0.1  # part of the larger of both forces by which they may differ without a word
_ROUNDING = 1e-6  # part of the load below which a component is none


def bearing_load_warnings(case: Case, mean_force: Mapping[str, FloatArray]) -> list[dict[str, Any]]:
    """Warn of bearings whose stiffness was made for another load than the mean force of the shaft on them.

    The stiffness of rolling bearings and stops depends on the load that the case gives. Radial forces are compared as
    vectors, since elements are pressed where the load points; the axial ones beside them. A difference counts against
    the resultant load: of a bearing's small component nobody need hear.

    Parameters
    ----------
    mean_force
        x, y, z of the mean force on each bearing [N], shape (3,) each.
    """
    found = []
    for given in case.bearing:
        if not isinstance(given.stiffness, RollingStiffness | StopStiffness) or given.name not in mean_force:
            continue
        load = given.load
        assumed = np.zeros(3) if load is None else np.array([load.x, load.y, load.z])
        actual = np.asarray(mean_force[given.name], dtype=np.float64)
        scale = max(float(np.linalg.norm(assumed)), float(np.linalg.norm(actual)))
        radial = float(np.hypot(*(actual - assumed)[:2]))
        axial = abs(float(actual[2] - assumed[2]))
        if max(radial, axial) <= _DIFFERENCE * scale:
            continue
        # What rounding leaves in a direction without load would be typed in as a load.
        actual = np.where(np.abs(actual) > _ROUNDING * scale, actual, 0.0)
        sizes = [(float(np.hypot(*force[:2])), float(force[2])) for force in (assumed, actual)]
        found.append(
            warning(
                "bearing load",
                f'bearing "{given.name}": its stiffness was made for a load of {sizes[0][0]:.4g} N radial and '
                f"{sizes[0][1]:.4g} N axial, the run finds {sizes[1][0]:.4g} N radial and {sizes[1][1]:.4g} N axial; "
                f"give it the load {{ x = {actual[0]:.4g}, y = {actual[1]:.4g}, z = {actual[2]:.4g} }} N",
                bearing=given.name,
                assumed_force_n=assumed.tolist(),
                mean_force_n=actual.tolist(),
            )
        )
    return found
