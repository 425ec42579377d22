"""The lumped mass model: the classical Myklestad–Prohl chain of massless fields and point masses."""

import numpy as np
import numpy.typing as npt

from .shaft import Rotor, station_index

FloatArray = npt.NDArray[np.float64]


def station_inertias(rotor: Rotor, stations: FloatArray) -> FloatArray:
    """Inertias that sit at the stations themselves.

    Discs always do. In the lumped model each segment also gives half of its mass, of its polar inertia
    and of its diametral inertia about its own centre, I_p/2 + m l²/12, to each of its ends; in the
    seven-station table of the RAPPID example this rule gives the printed 0.020568 kg·m² at a plain
    station and 0.010284 kg·m² at an end.

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
    if rotor.mass_model == "lumped":
        for segment, left, right in zip(rotor.segments, rotor.joints[:-1], rotor.joints[1:], strict=True):
            half = 0.5 * np.array([segment.mass, segment.diametral_inertia, segment.polar_inertia])
            inertias[station_index(stations, left)] += half
            inertias[station_index(stations, right)] += half
    return inertias
