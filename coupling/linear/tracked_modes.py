"""Natural modes of one machine found again in another by the modal assurance criterion (MAC) of their motions.

The coordinates of two machines need not agree: other walls and shafts have other modes as coordinates. So shapes are
compared by motions that every one of them has, of sections along the shafts, of seats and of sensors. Each motion u_s
has the weight √m_s of an equal part of its body's mass, a rotation that of its polar inertia, so that Σ |u_s|² stands
for the kinetic energy:

    MAC = |Σ u_s* v_s|² / (Σ |u_s|² Σ |v_s|²)                    (Allemang and Brown, 1st IMAC, 1982)

Pairs are those of the largest sum of MAC. Modes of nearly one frequency, as of round shafts in alike bearings, are any
basis of the motions that they span: a mode is found again where those of nearly its frequency together have it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.linear.complex_modes import coupled_modes
from gearwhine.numerics.arrays import ComplexArray, FloatArray
from gearwhine.numerics.branch_following import paired_modes

_SECTIONS = 5  # of a shaft, from end to end
_FOUND = 0.5  # MAC from which a mode is found again
_ONE_FREQUENCY = 0.01  # relative difference of frequencies within which modes are judged together
_JUMP = 1.0  # relative change of a frequency that costs as much as no likeness
_SEEN = 1e-3  # root of the part of its energy below which a mode moves none of the places, and is not found again
_LOCAL = ("rigid", "residual")  # kinds of modes without a natural frequency


@dataclass(frozen=True, eq=False)
class ObservedModes:
    """Oscillating modes, ascending in frequency, by the motions of places that machines have in common.

    Attributes
    ----------
    frequencies : ndarray, shape (m,)
        Natural frequencies |λ| [rad/s].
    motions : ndarray of complex, shape (m, s)
        Motions times the root of their mass or inertia, of unit norm; less of a mode that moves none of the places.
    """

    frequencies: FloatArray
    motions: ComplexArray

    def found_in(self, other: "ObservedModes") -> FloatArray:
        """Frequencies of these modes in another machine [rad/s], NaN of one that is not found, shape (m,)."""
        likeness = np.abs(self.motions.conj() @ other.motions.T) ** 2
        jump = np.abs(other.frequencies / self.frequencies[:, None] - 1.0)
        partner = paired_modes(jump, likeness, jump_scale=_JUMP, most_jumps=1.0, longest_jump=np.inf)
        gaps = np.abs(other.frequencies / other.frequencies[:, None] - 1.0)
        together = likeness @ (gaps <= _ONE_FREQUENCY)
        rows = np.arange(len(partner))
        found = (partner >= 0) & (together[rows, partner] >= _FOUND)
        return np.where(found, other.frequencies[partner], np.nan)


def observed_modes(machine: CoupledMachine, masses: Mapping[str, float]) -> ObservedModes:
    """Return the oscillating modes of a machine by its motions; carriers stand as they do at the beginning.

    Parameters
    ----------
    machine : CoupledMachine
    masses : mapping of str to float
        Mass of each rotor [kg].
    """
    modes = coupled_modes(machine.system)
    swings = [n for n, kind in enumerate(modes.kinds) if kind not in _LOCAL and modes.eigenvalues[n].imag > 0.0]
    motions = modes.shapes[swings] @ _places(machine, masses).T
    motions /= np.maximum(np.linalg.norm(motions, axis=1, keepdims=True), _SEEN)
    return ObservedModes(np.abs(modes.eigenvalues[swings]), motions)


def _places(machine: CoupledMachine, masses: Mapping[str, float]) -> FloatArray:
    """Motions of the observed places by the coordinates, each times the root of its mass or inertia, shape (s, n)."""
    rows = []
    for rotor in machine.rotors:
        for at in np.linspace(0.0, float(rotor.modal.lateral.stations[-1]), _SECTIONS).tolist():
            moved = np.sqrt(masses[rotor.name]) * rotor.motions(at)[:3]
            turned = np.linalg.norm(rotor.turning) * rotor.rotation(at)
            rows.append(machine.rows(rotor.name, np.vstack([moved, turned]) / np.sqrt(_SECTIONS)))
    if (housing := machine.housing) is not None:
        places = [*(seat.T[:3] for seat in housing.seats.values()), *(row[None] for row in housing.sensors.values())]
        mass = sum(masses.values()) if housing.mass is None else housing.mass
        rows += [np.sqrt(mass / len(places)) * machine.rows(housing.name, place) for place in places]
    return np.vstack(rows)
