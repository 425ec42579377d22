r"""Lines between the mesh harmonics, of what differs between teeth: pitch deviations, runout and damage.

The transmission error of a mesh whose teeth differ repeats after H mesh periods, the hunting period, with amplitudes
e_k at k / H times the mesh frequency; between mesh harmonics, k no multiple of H, they are of what differs. Runout has
harmonics of its own, at the turns of its gear. The machine linear about its mean load answers k e d, to runout
(k + i omega c) e d. The lines are many, 1674 of each mesh harmonic with 27 and 62 teeth, so that their motion is that
of the modes of the damped machine,

    q(omega) = sum_m r_m l_m / (i omega - lambda_m),

lambda, r the eigenvalues and right eigenvectors of the state matrix and l what they have of d. The highest line is
solved directly, too; where the two differ, as with eigenvectors that are nearly one, all lines are solved so.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import linalg

from gearwhine.coupling.gears.loaded.transmission_error import phasors_between
from gearwhine.coupling.linear.mesh_harmonics import MeshHarmonicModel
from gearwhine.numerics.arrays import FloatArray

ComplexArray = npt.NDArray[np.complex128]

_ALIKE_DIGITS = 9  # digits of the order of lines that are one
_AT_ONCE = 2000  # frequencies whose motions are summed together
_AGREES = 1e-6  # of the highest line by modes and directly


@dataclass(frozen=True, eq=False)
class UnequalTeeth:
    """Excitation of a machine by what differs between the teeth of its meshes, at nominal speed.

    Attributes
    ----------
    frequency : ndarray, shape (l,)
        Ascending [rad/s].
    contact : ndarray of int, shape (l,)
        Number of the contact in the system.
    error : ndarray of complex, shape (l,)
        Amplitude e at t = 0 [m].
    damped : ndarray of bool, shape (l,)
        Whether the damping of the mesh passes it on, too, as of runout.
    """

    frequency: FloatArray
    contact: npt.NDArray[np.int64]
    error: ComplexArray
    damped: npt.NDArray[np.bool_]


def unequal_teeth(model: MeshHarmonicModel, limit: float) -> UnequalTeeth:
    """Return the lines between mesh harmonics up to a limit at nominal speed [rad/s]."""
    found = [part for number in model.loaded for part in _of_contact(model, number, limit)]
    if not found:
        none = np.empty(0)
        return UnequalTeeth(none, none.astype(np.int64), none.astype(np.complex128), none.astype(np.bool_))
    frequency = np.concatenate([part[0] for part in found])
    order = np.argsort(frequency, kind="stable")
    contact = np.concatenate([np.full(part[0].size, part[1]) for part in found])
    damped = np.concatenate([np.full(part[0].size, part[3]) for part in found])
    return UnequalTeeth(
        frequency[order], contact[order], np.concatenate([part[2] for part in found])[order], damped[order]
    )


def _of_contact(
    model: MeshHarmonicModel, number: int, limit: float
) -> Iterator[tuple[FloatArray, int, ComplexArray, bool]]:
    contact, mesh = model.machine.system.contacts[number], model.meshes[number]
    periods, rate = contact.contact.hunting_period, 2.0 * np.pi * abs(contact.mesh_frequency)
    sense = np.sign(contact.mesh_frequency)
    if periods > 1:
        orders = np.arange(1, int(limit / rate * periods * (1.0 + 1e-9)) + 1)
        orders = orders[orders % periods != 0]
        error = phasors_between(mesh.phases, mesh.transmission_error, orders)
        error = error if sense > 0.0 else error.conj()
        yield (
            orders / periods * rate,
            number,
            error * np.exp(2j * np.pi * sense * orders / periods * contact.phase),
            False,
        )
    rows = contact.errors[(contact.errors[:, 0] != 0.0) & (np.abs(contact.errors[:, 1]) <= limit * (1.0 + 1e-9))]
    rows = rows[rows[:, 1] != 0.0]
    if rows.size:
        yield np.abs(rows[:, 1]), number, rows[:, 0] * np.exp(1j * rows[:, 2] * np.sign(rows[:, 1])), True


def unequal_teeth_rms(
    model: MeshHarmonicModel,
    teeth: UnequalTeeth,
    rows: FloatArray,
    ratio: float,
    stiffness: FloatArray,
    damping: FloatArray,
    limit: float,
) -> FloatArray:
    """Root mean square of the accelerations along rows by these lines together, shape (o,) [m/s²].

    Parameters
    ----------
    model : MeshHarmonicModel
    teeth : UnequalTeeth
    rows : ndarray, shape (o, n)
        Rows of the motions at sensors.
    ratio : float
        Speed over the nominal one.
    stiffness, damping : ndarray, shape (n, n)
        Of the machine linear about its mean load at that speed.
    limit : float
        Highest frequency [rad/s].
    """
    within = ratio * teeth.frequency <= limit * (1.0 + 1e-9)
    if not np.any(within):
        return np.zeros(len(rows))
    frequency, contact, error = ratio * teeth.frequency[within], teeth.contact[within], teeth.error[within]
    state = model.contact
    law = state.stiffness[contact] + 1j * np.where(teeth.damped[within], frequency * state.damping[contact], 0.0)
    _, line = np.unique(np.round(frequency / abs(ratio * model.machine.speed), _ALIKE_DIGITS), return_inverse=True)
    directions = {number: model.machine.system.contacts[number].direction for number in np.unique(contact).tolist()}
    loads: ComplexArray = law * error
    size, count = stiffness.shape[0], int(line.max()) + 1

    def directly(place: int) -> ComplexArray:
        """Accelerations of one line along the rows, of all contacts that have it."""
        of_line = np.flatnonzero(line == place).tolist()
        w = float(frequency[of_line[0]])
        load = sum(loads[at] * directions[int(contact[at])] for at in of_line)
        dynamic = stiffness + 1j * w * damping - w**2 * np.eye(size)
        return np.asarray(-(w**2) * (rows @ linalg.solve(dynamic, load)))

    try:
        lines = _by_modes(rows, stiffness, damping, frequency, contact, loads, line, directions)
        highest = int(np.argmax(np.sum(np.abs(lines) ** 2, axis=0)))
        known = directly(highest)
        agrees = bool(np.linalg.norm(lines[:, highest] - known) <= _AGREES * np.linalg.norm(known))
    except np.linalg.LinAlgError:
        agrees = False
    if not agrees:
        lines = np.stack([directly(place) for place in range(count)], axis=1)
    return np.asarray(np.sqrt(0.5 * np.sum(np.abs(lines) ** 2, axis=1)))


def _by_modes(
    rows: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    frequency: FloatArray,
    contact: npt.NDArray[np.int64],
    loads: ComplexArray,
    line: npt.NDArray[np.int64],
    directions: Mapping[int, FloatArray],
) -> ComplexArray:
    """Accelerations along rows by the modes of the damped machine, shape (o, lines)."""
    size = stiffness.shape[0]
    first = np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]])
    values, vectors = linalg.eig(first)
    motions = rows @ vectors[:size]
    lines = np.zeros((len(rows), int(line.max()) + 1), dtype=np.complex128)
    for number, direction in directions.items():
        # An ill-conditioned solution is found out by the line that is solved directly.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", linalg.LinAlgWarning)
            share = linalg.solve(vectors, np.concatenate([np.zeros(size), direction]))
        of_it = np.flatnonzero(contact == number)
        for begin in range(0, of_it.size, _AT_ONCE):
            some = of_it[begin : begin + _AT_ONCE]
            answer = (motions * share) @ (1.0 / (1j * frequency[some] - values[:, None]))
            np.add.at(lines.T, line[some], (-(frequency[some] ** 2) * loads[some] * answer).T)
    return lines
