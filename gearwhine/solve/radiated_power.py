"""Radiation of a housing, by which the sound power of any motion of it is known without a further solution."""

from typing import TYPE_CHECKING, Any

import numpy as np

from gearwhine.coupling import Machine
from gearwhine.coupling.sound.acoustics import Acoustics
from gearwhine.housing import HousingModes
from gearwhine.numerics.progress import Progress, silent
from gearwhine.solve.acoustics import refused_by_key

if TYPE_CHECKING:
    from gearwhine.coupling.sweep.line_sound import RadiatedPower


def radiated_power_of(
    acoustics: Acoustics, housing: HousingModes, progress: Progress = silent
) -> "tuple[RadiatedPower, HousingModes]":
    """Return the radiation of a housing, and the housing whose record holds it.

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


class Radiations:
    """Radiation of the housings of machines, solved once for each.

    Parameters
    ----------
    acoustics : Acoustics, optional
        By default boundary elements in free air.
    progress : callable
    """

    def __init__(self, acoustics: Acoustics | None = None, progress: Progress = silent) -> None:
        self.acoustics, self._progress = acoustics or Acoustics(), progress
        self._found = list["tuple[HousingModes, RadiatedPower]"]()

    def __getstate__(self) -> dict[str, Any]:
        """Return what goes to a worker, which is silent."""
        return self.__dict__ | {"_progress": silent}

    def of(self, machine: Machine) -> "RadiatedPower | None":
        """Return the radiation of a machine's housing; None of a machine without the modes of one."""
        housing = machine.housing
        if not isinstance(housing, HousingModes):
            return None
        found = next((radiated for other, radiated in self._found if other is housing), None)
        if found is None:
            found = radiated_power_of(self.acoustics, housing, self._progress)[0]
            self._found.append((housing, found))
        return found
