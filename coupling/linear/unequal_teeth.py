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

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy import linalg

from gearwhine.coupling.linear.parametric_stiffness import Cause, VaryingMesh, harmonic_compressions
from gearwhine.coupling.statics.mean_mesh import ContactState
from gearwhine.numerics.arrays import ComplexArray, FloatArray

_ALIKE_DIGITS = 9  # digits of the frequency of lines that are one
_FEW = 25  # frequencies below which a solution at each is less work than the modes
_AT_ONCE = 2000  # frequencies whose motions are summed together
_AGREES = 1e-6  # of the highest answer by modes and directly
_WITHIN = 1e-9  # part of a limit


@dataclass(frozen=True, eq=False)
class DampedMachine:
    """A linear machine at one speed.

    Attributes
    ----------
    stiffness, damping : ndarray, shape (n, n)
    mass : ndarray, shape (n, n), optional
        By default unit modal masses.
    """

    stiffness: FloatArray
    damping: FloatArray
    mass: FloatArray | None = None

    def motion(self, w: float, load: FloatArray | ComplexArray, *, transposed: bool = False) -> ComplexArray:
        """Motion by a harmonic load (n,) at a frequency [rad/s], or that of the transposed dynamic stiffness."""
        key = round(w, 6)
        if key not in self._factors:
            if len(self._factors) >= _FEW:
                self._factors.clear()
            dynamic = np.empty(self.stiffness.shape, dtype=np.complex128, order="F")
            dynamic.real, dynamic.imag = self.stiffness, w * self.damping
            if self.mass is None:
                dynamic[np.diag_indices_from(dynamic)] -= w**2
            else:
                dynamic -= w**2 * self.mass
            # What scipy's functions do beside LAPACK's takes as long as a machine of a hundred coordinates.
            self._factors[key] = linalg.lapack.zgetrf(dynamic, overwrite_a=True)[:2]
        return np.asarray(linalg.lapack.zgetrs(*self._factors[key], load, trans=int(transposed))[0])

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
        if frequencies.size > _FEW and self.mass is None:
            with suppress(np.linalg.LinAlgError):
                found = self._by_modes(outputs, direction, frequencies)
                highest = int(np.argmax(np.max(np.abs(found), axis=0)))
                known = outputs @ self.motion(float(frequencies[highest]), direction)
                if np.max(np.abs(found[:, highest] - known)) <= _AGREES * np.max(np.abs(known)):
                    return found
        directly = [outputs @ self.motion(w, direction) for w in frequencies.tolist()]
        return np.reshape(np.array(directly, dtype=np.complex128), (-1, len(outputs))).T

    def _by_modes(self, outputs: FloatArray, direction: FloatArray, frequencies: FloatArray) -> ComplexArray:
        values, vectors, share = self._modes_driven_along(direction)
        motions = (outputs @ vectors[: len(self.stiffness)]) * share
        found = np.empty((len(outputs), frequencies.size), dtype=np.complex128)
        for first in range(0, frequencies.size, _AT_ONCE):
            part = frequencies[first : first + _AT_ONCE]
            # m/(iω - λ) with its conjugate; of a real λ the half of both.
            gains = 1.0 / ((np.abs(values) ** 2)[:, None] - part**2 - 2.0j * np.multiply.outer(values.real, part))
            by_mode = 1j * part * (motions.real @ gains) - (motions * values.conj()).real @ gains
            found[:, first : first + _AT_ONCE] = 2.0 * by_mode
        return found

    def _modes_driven_along(self, direction: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Eigenvalues of Im λ >= 0, their right eigenvectors in columns, and the share of each in a velocity.

        With a conjugate for each λ, real ones twice by halves, the velocity is the real part of twice their sum.
        """
        values, packed = self._modes
        size = len(self.stiffness)
        share = np.linalg.solve(packed, np.concatenate([np.zeros(size), direction]))
        upper, paired = np.flatnonzero(values.imag >= 0.0), values.imag > 0.0
        vectors, shares = packed[:, upper].astype(np.complex128), 0.5 * share[upper].astype(np.complex128)
        above = paired[upper]
        vectors[:, above] += 1j * packed[:, upper[above] + 1]
        shares[above] -= 0.5j * share[upper[above] + 1]
        return values[upper], vectors, shares

    @cached_property
    def _modes(self) -> tuple[ComplexArray, FloatArray]:
        """Eigenvalues (2 n,) and right eigenvectors (2 n, 2 n) of the state matrix, conjugate ones by real columns.

        The columns of λ and its conjugate, which follows it, are the real and the imaginary part of λ's vector.
        """
        size = len(self.stiffness)
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-self.stiffness, -self.damping]])
        work = int(linalg.lapack.dgeev_lwork(2 * size, compute_vl=0)[0])
        real, imaginary, _, vectors, info = linalg.lapack.dgeev(state, compute_vl=0, lwork=work, overwrite_a=1)
        if info != 0:
            raise np.linalg.LinAlgError("the eigenvalues of a damped machine do not converge")
        return np.asarray(real + 1j * imaginary), np.asarray(vectors)

    @cached_property
    def _factors(self) -> dict[float, Any]:
        """LU factors of the dynamic stiffness at the last frequencies."""
        return {}


@dataclass(frozen=True, eq=False)
class StiffnessForce:
    """Force -g of a mesh by its stiffness that varies, along its line of action.

    Attributes
    ----------
    mesh : VaryingMesh
    amplitudes : ndarray of complex, shape (r, 2 J + 1)
        Two-sided, at the orders of the mesh at t = 0 [N].
    compression : ndarray of complex, shape (2 J + 1,)
        u of the mesh harmonics, two-sided [m].
    """

    mesh: VaryingMesh
    amplitudes: ComplexArray
    compression: ComplexArray

    def harmonic(self, harmonic: int) -> complex:
        """Amplitude at a mesh harmonic, by e^{iωt} with ω > 0 [N]; 0 beyond those that are known."""
        known = harmonic <= self.mesh.reach
        return 2.0 * complex(self.amplitudes[0, self.mesh.reach + harmonic]) if known else 0.0j

    @cached_property
    def lines(self) -> tuple[FloatArray, ComplexArray]:
        """Orders of the mesh frequency, ascending, and the amplitudes there by e^{iωt} with ω > 0 [N]."""
        orders, kept = self.mesh.orders, self.mesh.one_sided
        order, amplitude = np.abs(orders[kept]), 2.0 * self.amplitudes[kept]
        amplitude = np.where(orders[kept] < 0.0, amplitude.conj(), amplitude)
        ascending = np.argsort(order, kind="stable")
        return order[ascending], amplitude[ascending]


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


class _Solved(NamedTuple):
    """A mesh with the motions along rows by a unit load along it (o, r, 2 J + 1), and two-sided forces on it [N]."""

    mesh: VaryingMesh
    answer: ComplexArray
    load: ComplexArray
    change: ComplexArray
    compression: ComplexArray


def stiffness_forces(
    meshes: Sequence[VaryingMesh],
    state: ContactState,
    directions: FloatArray,
    machine: DampedMachine,
    motions: Mapping[Cause, ComplexArray],
) -> dict[int, StiffnessForce]:
    """Solve the forces of meshes by their varying stiffness, by contact; parameters as of `lines_of_meshes`."""
    none = np.empty((0, len(directions)))
    solved = _solved(meshes, state, directions, none, machine, motions, 1.0)
    return {one.mesh.number: StiffnessForce(one.mesh, one.change, one.compression) for one in solved}


def lines_of_meshes(
    meshes: Sequence[VaryingMesh],
    state: ContactState,
    directions: FloatArray,
    rows: FloatArray,
    machine: DampedMachine,
    motions: Mapping[Cause, ComplexArray],
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
    motions : mapping of (int, int) to ndarray of complex, shape (n,)
        Motion at mesh harmonics with the mean stiffness, by all that drives it, by contact and harmonic.
    ratio : float
        Speed over the nominal one.
    limit : float
        Highest frequency of the lines between mesh harmonics [rad/s].
    """
    by_stiffness = dict[Cause, ComplexArray]()
    frequencies, between = [np.empty(0)], [np.empty((len(rows), 0), dtype=np.complex128)]
    for mesh, answer, load, change, _ in _solved(meshes, state, directions, rows, machine, motions, ratio):
        w = ratio * mesh.rate * mesh.orders
        for harmonic in range(1, mesh.reach + 1):
            at = 0, mesh.reach + harmonic
            by_stiffness[mesh.number, harmonic] = -2.0 * w[at] ** 2 * answer[:, *at] * change[at]
        lines = -2.0 * w[1:] ** 2 * answer[:, 1:] * (load + change)[1:]
        kept = (np.abs(w[1:]) <= limit * (1.0 + _WITHIN)) & mesh.one_sided[1:]
        frequencies.append(np.abs(w[1:])[kept])
        between.append(np.where(w[1:] < 0.0, lines.conj(), lines)[:, kept])
    every, parts = np.concatenate(frequencies), np.concatenate(between, axis=1)
    alike = np.round(every / max((mesh.rate for mesh in meshes), default=1.0), _ALIKE_DIGITS)
    _, first, line = np.unique(alike, return_index=True, return_inverse=True)
    together = np.zeros((len(first), len(rows)), dtype=np.complex128)
    np.add.at(together, line, parts.T)
    return LinesOfMeshes(by_stiffness, every[first], together.T)


def _solved(
    meshes: Sequence[VaryingMesh],
    state: ContactState,
    directions: FloatArray,
    rows: FloatArray,
    machine: DampedMachine,
    motions: Mapping[Cause, ComplexArray],
    ratio: float,
) -> list[_Solved]:
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
        for (number, harmonic), motion in motions.items():
            if number == mesh.number and harmonic <= mesh.reach:
                moved[mesh.reach + harmonic] = 0.5 * (along[:, place] @ motion)
                moved[mesh.reach - harmonic] = moved[mesh.reach + harmonic].conj()
        answers.append(answer)
        loads.append(load)
        compressions.append(moved - mesh.error[0])
    solved = []
    rates = np.array([mesh.rate for mesh in meshes])
    for rate in np.unique(np.round(rates, 6)).tolist():
        group = np.flatnonzero(np.round(rates, 6) == rate).tolist()
        receptance = [[answers[column][sensors + row, 0] for column in group] for row in group]
        pressed = harmonic_compressions([meshes[n] for n in group], [compressions[n] for n in group], receptance)
        for number, compression in zip(group, pressed, strict=True):
            mesh, answer, load = meshes[number], answers[number], loads[number]
            change = mesh.forces(compression, load, answer[sensors + number])
            solved.append(_Solved(mesh, answer[:sensors], load, change, compression))
    return solved
