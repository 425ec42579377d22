r"""Lines of meshes in a machine about its mean load: mesh harmonics, and between them what differs between teeth.

The transmission error of a mesh whose teeth differ, by pitch deviations or damage, repeats after H mesh periods, the
hunting period, with amplitudes e_k at k/H times the mesh frequency; runout has harmonics of its own, at the turns of
its gear. The machine answers (k + i ω c) e d, the second term to runout alone, less the changes of the mesh force by
the stiffness that varies (:mod:`gearwhine.coupling.linear.parametric_stiffness`). The lines are many, 1674 of each mesh
harmonic with 27 and 62 teeth, so that their motion is that of the modes of the damped machine,

    q(ω) = Σ_m r_m l_m / (i ω − λ_m),

λ, r the eigenvalues and right eigenvectors of the state matrix and l what they have of d. The highest answer is solved
directly, too; where the two differ, as with eigenvectors that are nearly one, all are solved so.
"""

import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import linalg

from gearwhine.coupling.linear.mesh_harmonics import Cause
from gearwhine.coupling.linear.parametric_stiffness import VaryingMesh, harmonic_compressions
from gearwhine.coupling.statics.mean_mesh import ContactState
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_ALIKE_DIGITS = 9  # digits of the frequency of lines that are one
_FEW = 25  # frequencies below which a solution at each is less work than the modes
_AT_ONCE = 2000  # frequencies whose motions are summed together
_AGREES = 1e-6  # of the highest answer by modes and directly
_WITHIN = 1e-9  # part of a limit


@dataclass(frozen=True, eq=False)
class DampedMachine:
    """A linear machine of unit modal masses at one speed.

    Attributes
    ----------
    stiffness, damping : ndarray, shape (n, n)
    """

    stiffness: FloatArray
    damping: FloatArray

    def motion(self, w: float, load: FloatArray | ComplexArray) -> ComplexArray:
        """Motion by a harmonic load (n,) at a frequency [rad/s]."""
        key = round(w, 6)
        if key not in self._factors:
            if len(self._factors) >= _FEW:
                self._factors.clear()
            dynamic = self.stiffness + 1j * w * self.damping
            dynamic[np.diag_indices_from(dynamic)] -= w**2
            self._factors[key] = linalg.lu_factor(dynamic, overwrite_a=True, check_finite=False)
        return np.asarray(linalg.lu_solve(self._factors[key], load, check_finite=False))

    def answers(self, outputs: FloatArray, direction: FloatArray, frequency: FloatArray) -> ComplexArray:
        """Motions along rows (o, n) by a unit load along a direction (n,), shape (o, *frequency.shape).

        Those at frequencies of 0 are 0 [rad/s].
        """
        frequencies, places = np.unique(frequency, return_inverse=True)
        found = np.zeros((len(outputs), frequencies.size), dtype=np.complex128)
        first = int(np.searchsorted(frequencies, 0.0, side="right"))
        found[:, first:] = self._answers(outputs, direction, frequencies[first:])
        return np.asarray(found[:, places.ravel()].reshape(-1, *frequency.shape))

    def _answers(self, outputs: FloatArray, direction: FloatArray, frequencies: FloatArray) -> ComplexArray:
        if frequencies.size > _FEW:
            with suppress(np.linalg.LinAlgError):
                found = self._by_modes(outputs, direction, frequencies)
                highest = int(np.argmax(np.max(np.abs(found), axis=0)))
                known = outputs @ self.motion(float(frequencies[highest]), direction)
                if np.max(np.abs(found[:, highest] - known)) <= _AGREES * np.max(np.abs(known)):
                    return found
        directly = [outputs @ self.motion(w, direction) for w in frequencies.tolist()]
        return np.reshape(np.array(directly, dtype=np.complex128), (-1, len(outputs))).T

    def _by_modes(self, outputs: FloatArray, direction: FloatArray, frequencies: FloatArray) -> ComplexArray:
        values, vectors = self._modes
        size = len(self.stiffness)
        # An ill-conditioned solution is found out by the answer that is solved directly.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", linalg.LinAlgWarning)
            share = linalg.solve(vectors, np.concatenate([np.zeros(size), direction]))
        motions = (outputs @ vectors[:size]) * share
        parts = np.array_split(frequencies, -(-frequencies.size // _AT_ONCE))
        return np.concatenate([motions @ (1.0 / (1j * part - values[:, None])) for part in parts], axis=1)

    @cached_property
    def _modes(self) -> tuple[ComplexArray, ComplexArray]:
        """Eigenvalues (2 n,) and right eigenvectors (2 n, 2 n) of the state matrix."""
        size = len(self.stiffness)
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-self.stiffness, -self.damping]])
        values, vectors = linalg.eig(state)
        return np.asarray(values), np.asarray(vectors)

    @cached_property
    def _factors(self) -> dict[float, Any]:
        """LU factors of the dynamic stiffness at the last frequencies."""
        return {}


@dataclass(frozen=True, eq=False)
class LinesOfMeshes:
    """Accelerations along some rows by all that varies with the phase of the meshes, at one speed.

    Attributes
    ----------
    by_stiffness : dict of (int, int) to ndarray of complex, shape (o,)
        Part of a mesh harmonic by the stiffness that varies, by contact and harmonic [m/s²].
    frequency : ndarray, shape (l,)
        Of the lines between the mesh harmonics, ascending [rad/s].
    between : ndarray of complex, shape (o, l)
        Their accelerations at t = 0 [m/s²].
    """

    by_stiffness: dict[Cause, ComplexArray]
    frequency: FloatArray
    between: ComplexArray


def lines_of_meshes(
    meshes: Sequence[VaryingMesh],
    state: ContactState,
    directions: FloatArray,
    rows: FloatArray,
    machine: DampedMachine,
    harmonics: Mapping[Cause, ComplexArray],
    *,
    ratio: float = 1.0,
    limit: float = np.inf,
) -> LinesOfMeshes:
    """Solve the lines of meshes along rows.

    Parameters
    ----------
    meshes : sequence of VaryingMesh
    state : ContactState
        About the mean load.
    directions : ndarray, shape (n, c)
        Of all contacts of the system.
    rows : ndarray, shape (o, n)
        Rows of the motions at sensors.
    machine : DampedMachine
        Linear about its mean load, at this speed.
    harmonics : mapping of (int, int) to ndarray of complex, shape (n,)
        Motion at mesh harmonics with the mean stiffness, by all that drives it, by contact and harmonic.
    ratio : float
        Speed over the nominal one.
    limit : float
        Highest frequency of the lines between mesh harmonics [rad/s].
    """
    along = directions[:, [mesh.number for mesh in meshes]]
    outputs, sensors = np.vstack([rows, along.T]), len(rows)
    answers, compressions, loads = list[ComplexArray](), list[ComplexArray](), list[ComplexArray]()
    for place, mesh in enumerate(meshes):
        w, k = ratio * mesh.rate * mesh.orders, float(state.stiffness[mesh.number])
        answer = machine.answers(outputs, along[:, place], np.abs(w))
        answer = np.where(w < 0.0, answer.conj(), answer)
        # A free train turns until its mesh carries the mean force again.
        answer[:, 0, mesh.reach] = 0.0
        answer[sensors + place, 0, mesh.reach] = 1.0 / k
        load = mesh.loads(k, float(state.damping[mesh.number]), ratio)
        moved = answer[sensors + place, 0] * load[0]
        for (number, harmonic), motion in harmonics.items():
            if number == mesh.number and harmonic <= mesh.reach:
                moved[mesh.reach + harmonic] = 0.5 * (along[:, place] @ motion)
                moved[mesh.reach - harmonic] = moved[mesh.reach + harmonic].conj()
        answers.append(answer)
        loads.append(load)
        compressions.append(moved - mesh.error[0])
    by_stiffness = dict[Cause, ComplexArray]()
    frequencies, between = list[FloatArray](), list[ComplexArray]()
    rates = np.array([mesh.rate for mesh in meshes])
    for rate in np.unique(np.round(rates, 6)).tolist():
        group = np.flatnonzero(np.round(rates, 6) == rate).tolist()
        receptance = [[answers[column][sensors + row, 0] for column in group] for row in group]
        pressed = harmonic_compressions([meshes[n] for n in group], [compressions[n] for n in group], receptance)
        for number, compression in zip(group, pressed, strict=True):
            mesh, answer = meshes[number], answers[number]
            w, force = ratio * mesh.rate * mesh.orders, mesh.coupling[0] @ compression
            for harmonic in range(1, mesh.reach + 1):
                at = mesh.reach + harmonic
                by_stiffness[mesh.number, harmonic] = 2.0 * w[0, at] ** 2 * answer[:sensors, 0, at] * force[at]
            further = mesh.forces_between(compression, loads[number], answer[sensors + number])
            lines = -2.0 * w[1:] ** 2 * answer[:sensors, 1:] * further
            # At half a mesh frequency a set holds each line and its conjugate.
            kept = (np.abs(w[1:]) <= limit * (1.0 + _WITHIN)) & ((w[1:] > 0.0) | (mesh.fractions[1:, None] < 0.5))
            frequencies.append(np.abs(w[1:])[kept])
            between.append(np.where(w[1:] < 0.0, lines.conj(), lines)[:, kept])
    every, parts = (
        np.concatenate([np.empty(0), *frequencies]),
        np.concatenate([np.empty((sensors, 0)), *between], axis=1),
    )
    alike = np.round(every / rates.max(initial=1.0), _ALIKE_DIGITS)
    _, first, line = np.unique(alike, return_index=True, return_inverse=True)
    together = np.zeros((len(first), sensors), dtype=np.complex128)
    np.add.at(together, line, parts.T)
    return LinesOfMeshes(by_stiffness, every[first], together.T)
