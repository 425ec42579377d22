"""Modal truncation error of frequency responses, estimated from two modal bases of one machine.

The error of a basis is estimated from another basis that differs from it by the part least well represented. Both are
coupled to the same bearings, teeth and loads, and excited alike: with the response H by the one and H' by the other at
a frequency w, the relative error of a sensor's line there is about

    u(w) = max(2 max |H'(v) - H(v)| / |H(v)|, 0.5 %),        v within 1.5 % of w,

the norms over all excitations that make lines. The difference of whole machines holds the shift of a resonance too,
which turns small errors into large ones. The neighbourhood covers lines at frequencies where the two curves cross by
chance; the factor of two covers directions in which the other basis is no better; and the least value covers errors
that both bases share, such as the one damping ratio of all modes above the limit.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.contact_state import mean_contact
from coupling.machine import CoupledMachine
from coupling.receptance import response

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_NEIGHBOURHOOD = np.linspace(-0.015, 0.015, 7)  # relative frequencies at which the two bases are compared
_SAFETY = 2.0
_LEAST = 0.005
_HIGHEST = 10.0  # errors beyond ten times the line carry no information


@dataclass(frozen=True)
class BasisError:
    """Modal truncation error of a machine, by the same machine on another basis.

    Attributes
    ----------
    machine : CoupledMachine
        On the basis whose error is estimated.
    other : CoupledMachine
        The same machine on another basis, its sensors, meshes and bearings in the same order.
    """

    machine: CoupledMachine
    other: CoupledMachine

    def at(self, frequencies: Sequence[float] | FloatArray) -> dict[str, FloatArray]:
        """Relative error of the motion of each sensor.

        Parameters
        ----------
        frequencies : ndarray, shape (f,)
            w > 0 [rad/s].

        Returns
        -------
        dict of str to ndarray, shape (f,)
            By name of the sensor; between 0.005 and 10.

        Raises
        ------
        CouplingError
            Where a frequency is 0.
        ModesError
            Where an undamped mode is driven at its own frequency.
        """
        asked = np.asarray(frequencies, dtype=np.float64)
        if not asked.size or not self.machine.sensor_rows:
            return {name: np.zeros(asked.size) for name in self.machine.sensor_rows}
        w = (asked[:, None] * (1.0 + _NEIGHBOURHOOD)).ravel()
        ours, others = _sensor_responses(self.machine, w), _sensor_responses(self.other, w)
        found = {}
        for name, motion in ours.items():
            size = np.linalg.norm(motion, axis=1)
            apart = np.linalg.norm(motion - others[name], axis=1)
            part = np.divide(apart, size, out=np.zeros_like(apart), where=size > 0.0)
            found[name] = np.clip(_SAFETY * part.reshape(asked.size, -1).max(axis=1), _LEAST, _HIGHEST)
        return found


def _sensor_responses(machine: CoupledMachine, frequencies: FloatArray) -> dict[str, ComplexArray]:
    """Motion along each sensor by each excitation, shape (f, e)."""
    state = mean_contact(machine.system)
    loads = np.broadcast_to(_excitations(machine), (len(frequencies), *_excitations(machine).shape))
    moved = response(machine.system, loads, frequencies, state)
    return {name: moved @ row for name, row in machine.sensor_rows.items()}


def _excitations(machine: CoupledMachine) -> FloatArray:
    """Unit loads of the excitations, shape (e, n): along each line of action; without gears, at each bearing."""
    drives = [contact.direction for contact in machine.system.contacts if contact.drives]
    if drives:
        return np.array(drives)
    across = [connector.directions[:, :2].T for connector in machine.system.linear[: len(machine.bearings)]]
    return np.concatenate(across) if across else np.zeros((0, machine.system.size))
