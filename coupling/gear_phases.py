"""Mesh phases of gear pairs that share gears.

Each gear is fitted to its shaft so that the first pair it belongs to begins a mesh period at t = 0. The phase of
every further pair of the same gear follows from the gear's teeth: as gears roll without slip, tooth 0 of driver and
driven gear lie at angles that are linear in the pair's phase (`coupling.gears.meshing_rotations`), and an angle that is
known already gives the phase. Gears that close a loop must fit: where teeth would clash, they cannot be assembled.
"""

import math
from collections.abc import Sequence

from coupling.errors import CouplingError
from coupling.gears import GearPairGeometry, meshing_rotations

_MISFIT = 1e-3  # of a pitch: larger misfits are no rounding of the axes


def mesh_phases(
    drivers: Sequence[str],
    drivens: Sequence[str],
    geometries: Sequence[GearPairGeometry],
    centre_lines: Sequence[float],
    senses: Sequence[int],
) -> list[float]:
    """Phase of each pair at t = 0 [mesh periods].

    Parameters
    ----------
    drivers, drivens : sequence of str
        The gears' names, pair by pair.
    geometries : sequence of GearPairGeometry
    centre_lines : sequence of float
        Angle from x of the line from the driver's centre to the driven gear's [rad].
    senses : sequence of int
        +1 where the driver turns counter-clockwise, -1 where clockwise.

    Raises
    ------
    CouplingError
        Where a loop of gears cannot be assembled.
    """
    turned: dict[str, float] = {}
    phases = []
    for driver, driven, pair, line, sense in zip(drivers, drivens, geometries, centre_lines, senses, strict=True):
        at_zero = meshing_rotations(pair, 0.0, centre_line_angle=line, sense=sense)
        pitches = sense * 2.0 * math.pi / pair.driver.teeth, -sense * 2.0 * math.pi / pair.driven.teeth
        if driver in turned:
            phase = (turned[driver] - at_zero[0]) / pitches[0]
        elif driven in turned:
            phase = (turned[driven] - at_zero[1]) / pitches[1]
        else:
            phase = 0.0
        for gear, zero, pitch in zip((driver, driven), at_zero, pitches, strict=True):
            stands = zero + phase * pitch
            # A whole number of pitches is the same place.
            misfit = (turned.setdefault(gear, stands) - stands) / pitch
            if abs(misfit - round(misfit)) > _MISFIT:
                raise CouplingError(
                    f"{driver} -> {driven}: the gears form a loop that cannot be assembled: teeth of {gear} would "
                    f"stand {abs(misfit - round(misfit)):.3f} pitches beside the gaps that they belong in; move an "
                    "axis, or change a number of teeth"
                )
        phases.append(phase)
    return phases
