"""Inertia of rotating shafts: each about its own axis, and of planets about the axis of their carrier."""

from collections.abc import Mapping, Sequence

import numpy as np

from gearwhine.coupling.machine.base_motion import rotor_participation
from gearwhine.coupling.machine.components import RotorComponent
from gearwhine.numerics.arrays import FloatArray


def circling(planet: RotorComponent, axis: Sequence[float]) -> FloatArray:
    """Coordinates of a planet that circles about an axis by one radian without turning, times its inertia, (n,).

    By the rotation of its carrier its mass at the distance a moves by a; the square of this row is m a² [kg m²].

    Parameters
    ----------
    planet : RotorComponent
    axis : sequence of float
        x and y of the carrier's axis [m].
    """
    return np.asarray(rotor_participation(planet, (axis[0], axis[1], 0.0))[:, 5] - planet.turning)


def rotating_inertia(rotors: Sequence[RotorComponent], speeds: Mapping[str, float]) -> float:
    """Twice the kinetic energy of shafts at their speeds: Σ J Ω² + Σ m a² Ω_c² over planets [kg m² rad²/s²].

    Parameters
    ----------
    rotors : sequence of RotorComponent
        All rotors of the machine, of which those with a speed count.
    speeds : mapping of str to float
        Speed of each rotor of a train [rad/s], or its part of one.
    """
    axes = {rotor.name: rotor.axis for rotor in rotors}
    total = 0.0
    for rotor in rotors:
        if rotor.name not in speeds:
            continue
        total += float(rotor.turning @ rotor.turning) * speeds[rotor.name] ** 2
        if rotor.carrier is not None:
            row = circling(rotor, axes[rotor.carrier])
            total += float(row @ row) * speeds[rotor.carrier] ** 2
    return total
