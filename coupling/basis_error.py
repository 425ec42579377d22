"""The error that the modal basis leaves in responses, told by two bases of one machine.

The error of a basis is estimated from another basis that differs from it by the part least well represented. Both are
coupled to the same bearings, teeth and loads, and driven alike: with the response H by the one and H' by the other at a
frequency w, the relative error of a sensor's line there is about

    u(w) = max(2 max |H'(v) - H(v)| / |H(v)|, 0.5 %),        v within 1.5 % of w,

the norms over all excitations that make lines. The difference of whole machines holds the shift of a resonance too,
which is what makes large errors of small ones. The neighbourhood is for lines that sit where the two curves happen to
cross; the factor of two is for directions in which the other basis is no better; and the least value for what both
bases have in common, such as the one damping ratio that stands for all modes above the limit.
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

_NEIGHBOURHOOD = np.linspace(-0.015, 0.015, 7)  # parts of a frequency at which the two bases are compared
_SAFETY = 2.0
_LEAST = 0.005
_HIGHEST = 10.0  # an error of ten times the line says all there is to say


@dataclass(frozen=True)
class BasisError:
    """Two bases of one machine.

    Attributes
    ----------
    machine : CoupledMachine
        On the basis whose error is asked for.
    other : CoupledMachine
        The same machine on another basis, its sensors, meshes and bearings in the same order.
    """

    machine: CoupledMachine
    other: CoupledMachine

    def at(self, frequencies: Sequence[float] | FloatArray) -> dict[str, FloatArray]:
        """Relative error of each sensor's motion at these frequencies.

        Parameters
        ----------
        frequencies : ndarray, shape (f,)
            w > 0 [rad/s].

        Returns
        -------
        dict of str to ndarray, shape (f,)
            By sensor; between 0.005 and 10.

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
    """Loads that make lines, shape (e, n): along each line of action; without gears, of each shaft on its bearings."""
    drives = [contact.direction for contact in machine.system.contacts if contact.drives]
    if drives:
        return np.array(drives)
    across = [connector.directions[:, :2].T for connector in machine.system.linear[: len(machine.bearings)]]
    return np.concatenate(across) if across else np.zeros((0, machine.system.size))
