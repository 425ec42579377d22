"""Radiation of a case's housing, by which the sound power of any motion of it is known without a further solution."""

from typing import TYPE_CHECKING

import numpy as np

from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing import HousingModes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solve.acoustics import refused_by_key

if TYPE_CHECKING:
    from gearwhine.coupling.sweep.line_sound import RadiatedPower


def radiated_power_of(
    acoustics: Acoustics, housing: HousingModes, progress: Progress = silent
) -> "tuple[RadiatedPower, HousingModes]":
    """Return the radiation of a housing as `[acoustics]` of a case says, and the housing whose record holds it.

    Raises
    ------
    CaseError, gearwhine.housing.HousingError
        Where the housing cannot be wrapped as the acoustics say, or a solution fails its proofs.
    """
    # The acoustics' kernels are for this analysis alone.
    from gearwhine.coupling.sound.motion_lines import AUDIBLE
    from gearwhine.coupling.sound.solution import build_radiation
    from gearwhine.coupling.sweep.line_sound import RadiatedPower
    from gearwhine.solve.kept_radiation import kept_radiation

    field = housing.displacement_field
    limit = acoustics.limit_hz(field)
    with refused_by_key(acoustics):
        radiation = build_radiation(acoustics, field, progress)
    if acoustics.method == "erp":
        return RadiatedPower(radiation, None, AUDIBLE, limit), housing
    # With its microphones it is the table of a sweep.
    positions, _ = acoustics.microphones(housing.mesh.bounds)
    places = np.array(list(positions.values())).reshape(-1, 3)
    table, housing = kept_radiation(acoustics, housing, radiation, places, (AUDIBLE, limit), progress)
    return RadiatedPower(radiation, table, AUDIBLE, limit), housing
