"""Harris map: transmission error over a mesh period for a range of loads (S. L. Harris, Proc. IMechE 172, 1958).

Without load the transmission error is the profile modification itself; under load the deflection of the teeth takes it
up. The curve is flat near the design load of the modification, and rises below and above it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.gears.errors import GearError
from coupling.gears.static import LoadedMesh, loaded_transmission_error, mesh_period_phases
from coupling.gears.tooth_contact import ToothContact

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HarrisMap:
    """Static transmission error for f loads at n phases of a mesh period.

    Attributes
    ----------
    forces : ndarray, shape (f,)
        Along the line of action [N].
    phases : ndarray, shape (n,)
        Mesh periods.
    transmission_error : ndarray, shape (f, n)
        [m].
    """

    forces: FloatArray
    phases: FloatArray
    transmission_error: FloatArray

    @property
    def peak_to_peak(self) -> FloatArray:
        """Largest less smallest transmission error at each load [m], (f,)."""
        return np.asarray(np.ptp(self.transmission_error, axis=1))

    @property
    def quietest(self) -> float:
        """Load with the least peak-to-peak transmission error of those given [N]."""
        return float(self.forces[int(self.peak_to_peak.argmin())])


def harris_map(contact: ToothContact, forces: npt.ArrayLike, phases: npt.ArrayLike | None = None) -> HarrisMap:
    """Compute the static transmission error over the mesh period at every load (Harris map).

    Parameters
    ----------
    contact : ToothContact
    forces : array_like, shape (f,)
        [N], at least 0.
    phases : array_like, shape (n,), or None
        Mesh periods; None for `mesh_period_phases` of 200 points.

    Raises
    ------
    GearError
        Without a load, or with a negative one.
    """
    loads = np.atleast_1d(np.asarray(forces, dtype=np.float64))
    if loads.size == 0:
        raise GearError("Harris map: at least one load is needed")
    at = mesh_period_phases(contact, 200) if phases is None else np.atleast_1d(np.asarray(phases, dtype=np.float64))
    states = contact.pairs(at)
    errors = [loaded_transmission_error(contact, float(load), at, states=states).transmission_error for load in loads]
    return HarrisMap(loads, at, np.array(errors))


def transmission_error_harmonics(mesh: LoadedMesh, count: int = 8) -> FloatArray:
    """Amplitudes of the first harmonics of the mesh frequency in the transmission error [m], (count,).

    Exact for the polygon through the points of one mesh period: a curve with a step has the harmonics of a step.

    Raises
    ------
    GearError
        Where the phases do not lie in one mesh period, ascending.
    """
    phases, values = mesh.phases, mesh.transmission_error
    if phases[-1] - phases[0] >= 1.0 or np.any(np.diff(phases) <= 0.0):
        raise GearError("harmonics: phases of one mesh period are needed, ascending and without its end")
    x = np.append(phases, phases[0] + 1.0)
    y = np.append(values, values[0])
    w = 2.0 * np.pi * np.arange(1, count + 1)[:, None]
    phasor = np.exp(-1j * w * x)
    # Integral of a straight segment times e^{-iwx}, by parts.
    slope = np.diff(y) / np.diff(x)
    integral = ((y * phasor)[:, :-1] - (y * phasor)[:, 1:]) / (1j * w) + slope * (phasor[:, 1:] - phasor[:, :-1]) / w**2
    return np.asarray(2.0 * np.abs(integral.sum(axis=1)))
