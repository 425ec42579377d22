"""Component of a housing that another program has reduced to matrices with interface nodes."""

import numpy as np

from gearwhine.coupling.machine.components import HousingComponent, SensorPlace
from gearwhine.housing.reduced import ReducedHousing


def component_of_reduced_housing(housing: ReducedHousing, *, name: str = "housing") -> HousingComponent:
    """Make the component of a reduced housing in its own modes, all of them kept.

    Modes above the frequency limit are of the kind ``residual``: their static response counts, their own frequencies
    are those of no housing. The same holds of coordinates without mass.
    """
    modes = housing.modes
    frequencies = modes.all_frequencies
    n, motions = len(frequencies), housing.participation_motions
    return HousingComponent(
        name=name,
        kinds=("housing",) * modes.known + ("residual",) * (n - modes.known),
        stiffness=np.diag(frequencies**2),
        damping=housing.damping_matrix(),
        gyroscopic=np.zeros((n, n)),
        seats=housing.seat_motions(),
        seat_z={seat.name: seat.center[2] for seat in housing.seats},
        sensors=housing.sensor_motions(),
        participation=None if motions is None else modes.vectors.T @ housing.matrices.mass @ motions,
        seat_axes={seat.name: seat.center[:2] for seat in housing.seats},
        sensor_places={
            sensor.name: SensorPlace(np.array(sensor.position), np.array(sensor.direction))
            for sensor in housing.sensors
        },
        complete_below=housing.limit,
        warnings=tuple(housing.warnings),
    )
