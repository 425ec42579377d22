"""The lumped mass model: the classical Myklestad–Prohl chain of massless fields and point masses."""

import numpy as np
import numpy.typing as npt

from .shaft import Rotor, station_index
from .shaft_coupling import Coupling

FloatArray = npt.NDArray[np.float64]


def station_inertias(rotor: Rotor, stations: FloatArray) -> FloatArray:
    """Inertias that sit at the stations themselves.

    Discs always do, and half of a coupling at each of its ends. In the lumped model each segment also gives its
    own to its two ends: mass in the shares that keep its centre of mass where it is, polar inertia in
    those that keep its centre, and the diametral inertia about its own centre of mass,
    I_p/2 + m l²/12 of a cylinder, as the mass. A cylinder is thus halved; in the seven-station table of the
    RAPPID example this rule gives the printed 0.020568 kg·m² at a plain station and 0.010284 kg·m² at an end.

    Parameters
    ----------
    rotor
        The rotor.
    stations
        Positions that hold at least its segment ends and discs, (s,), m.

    Returns
    -------
    (s, 3)
        Mass (kg), diametral and polar moment of inertia (kg·m²).
    """
    inertias = np.zeros((stations.size, 3))
    for disc in rotor.discs:
        inertias[station_index(stations, disc.at)] += disc.mass, disc.diametral_inertia, disc.polar_inertia
    # Joints are stations to the last digit.
    ends = np.searchsorted(stations, rotor.joints).tolist()
    for part, left, right in zip(rotor.segments, ends[:-1], ends[1:], strict=True):
        if rotor.mass_model == "lumped" or isinstance(part, Coupling):
            own = np.array([part.mass, part.diametral_inertia, part.polar_inertia])
            centres = np.array([part.mass_centre, part.mass_centre, part.polar_centre])
            to_right = own * (centres / part.length)
            inertias[left] += own - to_right
            inertias[right] += to_right
    return inertias
