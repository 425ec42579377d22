r"""Band of a sensor's line by damping: its level with all damping halved and doubled, from the same modes.

At resonance a line goes as one over the damping, and damping is the least known number of a machine. So the linear
model of a line is solved thrice about the mean load,

    (K + iω C_s - ω² I) q = f,      C_s = s (C + Cᵀ)/2 + (C - Cᵀ)/2,      s = 1/2, 1, 2,

with the load f of all that excites the machine at the line (:mod:`gearwhine.coupling.linear.line_mechanisms`), or,
where nothing does, unit loads along every line of action. It is the same for all s but for the force by the mesh
stiffness that varies, which follows the motion. The skew part of C is gyroscopic: it does no work and stays.
The band are the levels for s = 1/2 and s = 2 over that for s = 1 [dB]; 0 lies within. Between resonances it is narrow,
since mass or stiffness holds the motion there; near one it reaches from -6 to +6 dB.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearwhine.coupling.assembly import CoupledMachine
from gearwhine.coupling.errors import ModesError
from gearwhine.coupling.linear.carriers.turning_response import TurningResponse
from gearwhine.coupling.linear.eigenpairs import Eigenpairs, quadratic_eigenpairs
from gearwhine.coupling.linear.frequency_response import excitations
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.modal_superposition import SUM_RULE, superposed
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, StiffnessForce
from gearwhine.coupling.statics.mean_mesh import linear_matrices
from gearwhine.numerics.arrays import ComplexArray, FloatArray

SCALES = (0.5, 1.0, 2.0)
"""Factors of all damping."""
_WIDEST = 60.0  # largest part of a band [dB], of an undamped mode


@dataclass(frozen=True)
class DampingBand:
    """Bands of the sensors' lines of a machine about its mean load.

    Attributes
    ----------
    mechanisms : LineMechanisms
        Loads that excite lines.
    """

    mechanisms: LineMechanisms

    @property
    def machine(self) -> CoupledMachine:
        """The machine."""
        return self.mechanisms.machine

    def at(self, frequencies: Sequence[float] | FloatArray, within: float = 0.0) -> dict[str, FloatArray]:
        """Band of each sensor's line at frequencies.

        Parameters
        ----------
        frequencies : ndarray, shape (f,)
            ω > 0 [rad/s].
        within : float
            Distance up to which an excitation is at a line [rad/s].

        Returns
        -------
        dict of str to ndarray, shape (f, 2)
            Parts of the band below and above the line [dB], at most 0 and at least 0, by name of the sensor.
        """
        w = np.asarray(frequencies, dtype=np.float64)
        if not w.size or not self.machine.sensor_rows:
            return {name: np.zeros((w.size, 2)) for name in self.machine.sensor_rows}
        rows = np.array(list(self.machine.sensor_rows.values()))
        if self.machine.system.turns:
            levels = np.array([self._turning_levels(number, w, within, rows) for number in range(len(SCALES))])
        else:
            levels = np.array(
                [self._levels(number, w, self._loads(number, w, within), rows) for number in range(len(SCALES))]
            )
        tiny = np.finfo(np.float64).tiny
        change = 20.0 * np.log10(np.maximum(levels, tiny) / np.maximum(levels[SCALES.index(1.0)], tiny))
        change = np.clip(change, -_WIDEST, _WIDEST)
        bands = np.stack([change.min(axis=0), change.max(axis=0)], axis=-1)
        return {name: bands[:, number] for number, name in enumerate(self.machine.sensor_rows)}

    def _loads(self, scale: int, w: FloatArray, within: float) -> list[list[ComplexArray]]:
        """Return the loads on the machine with damping by a scale, by frequency and group."""
        driven = [self.mechanisms.loads(frequency, within, self._forces[scale]) for frequency in w.tolist()]
        return [[np.sum([*by_mechanism.values()], axis=0) for _, by_mechanism in groups] for groups in driven]

    def _levels(self, scale: int, w: FloatArray, loads: list[list[ComplexArray]], rows: FloatArray) -> FloatArray:
        """Size of the motion along each sensor with damping by a scale, shape (f, sensors)."""
        sizes = np.linalg.norm(self._motion(scale, excitations(self.machine)[None], w, rows), axis=1)
        for number, of_line in enumerate(loads):
            if of_line:
                sizes[number] = np.linalg.norm(self._motion(scale, np.array([of_line]), w[[number]], rows)[0], axis=0)
        return np.asarray(sizes)

    def _turning_levels(self, scale: int, w: FloatArray, within: float, rows: FloatArray) -> FloatArray:
        """Size of the motion along each sensor of a machine whose directions turn, shape (f, sensors)."""
        model = self._scaled_turning[scale]
        units = [model.force_along(n, 1.0) for n, tooth in enumerate(self.machine.system.contacts) if tooth.loaded]
        sizes = np.zeros((len(w), len(rows)))
        for number, frequency in enumerate(w.tolist()):
            driven = self.mechanisms.turning_motions(model, frequency, within)
            motions = [np.sum([*by_mechanism.values()], axis=0) for _, by_mechanism in driven]
            if not driven and units:
                motions = list(model.respond(frequency, [(unit, {}) for unit in units], [model.still])[model.still])
            if motions:
                sizes[number] = np.linalg.norm(np.array(motions) @ rows.T, axis=0)
        return sizes

    @cached_property
    def _scaled_turning(self) -> list[TurningResponse]:
        """Harmonic balances with damping by each scale."""
        system, contact = self.machine.system, self.mechanisms.model.contact
        models = []
        for scale in SCALES:
            parts = [replace(one, damping=scaled_damping(one.damping, scale)) for one in system.components]
            linear = [replace(one, damping=scaled_damping(one.damping, scale)) for one in system.linear]
            scaled = replace(system, components=tuple(parts), linear=tuple(linear))
            models.append(TurningResponse(scaled, replace(contact, damping=scale * contact.damping)))
        return models

    def _motion(self, scale: int, loads: FloatArray | ComplexArray, w: FloatArray, rows: FloatArray) -> ComplexArray:
        """Motion along the sensors under loads (1, i, n), shape (f, i, sensors)."""
        pairs, (stiffness, damping) = self._solved[scale]
        if pairs is not None:
            return superposed(pairs, loads, w, rows)
        moved = np.empty((w.size, loads.shape[1], len(rows)), dtype=np.complex128)
        for number, frequency in enumerate(w.tolist()):
            dynamic = stiffness + 1j * frequency * damping - frequency**2 * np.eye(len(stiffness))
            moved[number] = (rows @ np.linalg.solve(dynamic, loads[0].T)).T
        return moved

    @cached_property
    def _forces(self) -> list[dict[int, StiffnessForce]]:
        """Forces by the mesh stiffness that varies with damping by each scale, by contact."""
        return [self.mechanisms.stiffness_forces(DampedMachine(*matrices)) for _, matrices in self._solved]

    @cached_property
    def _solved(self) -> list[tuple[Eigenpairs | None, tuple[FloatArray, FloatArray]]]:
        """Eigenpairs with damping by each scale, None where they fail their proof, and the matrices."""
        stiffness, damping = linear_matrices(self.machine.system, self.mechanisms.model.contact)
        solved = []
        for scale in SCALES:
            scaled = (stiffness, scaled_damping(damping, scale))
            try:
                pairs = quadratic_eigenpairs(*scaled)
            except ModesError:
                pairs = None
            solved.append((pairs if pairs is not None and pairs.sum_rule <= SUM_RULE else None, scaled))
        return solved


def scaled_damping(damping: FloatArray, scale: float) -> FloatArray:
    """Scale the symmetric part of a damping matrix; its skew part is gyroscopic."""
    return np.asarray(0.5 * (scale + 1.0) * damping + 0.5 * (scale - 1.0) * damping.T)
