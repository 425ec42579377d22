r"""Multiple shooting: period map segment by segment, monodromy of each segment, and Newton correction of all starts.

A period of many mesh periods is integrated segment by segment, each from a state of its own. With the pieces
A_k = ∂(end of segment k) / ∂(its start) and the closure errors r_k = end of k - start of k + 1, the corrections d_k
of the starts and a change p of the speed have

    d_{k+1} = A_k d_k + r_k + s_k p,        d_K = d_0,

s_k the derivative of the closure errors by speed. Over the period that is d_K = M d_0 + R + S p with the monodromy
M = A_{K-1} ... A_0. An unstable disturbance grows over one segment only before it is corrected, so motions are found
from which an integration over the whole period would depart at once.

- U. M. Ascher, R. M. M. Mattheij, R. D. Russell, *Numerical Solution of Boundary Value Problems for Ordinary
  Differential Equations*, 1988, chapter 4.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.arrays import (
    ORDER,
    Steps,
    Trace,
    element_work,
    empty_steps,
    empty_trace,
    first_elements,
)
from gearwhine.coupling.collocation.linear_part import LinearPart, real_rows
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.coupling.errors import PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem

FloatArray = npt.NDArray[np.float64]


def product(pieces: FloatArray) -> FloatArray:
    """Multiply the monodromy matrices of successive segments, shape (K, 2 N, 2 N), to that of all, shape (2 N, 2 N)."""
    whole = pieces[0]
    for piece in pieces[1:]:
        whole = piece @ whole
    return np.asarray(whole)


def carried(pieces: FloatArray, first: FloatArray, sources: FloatArray) -> FloatArray:
    """d_0 ... d_K of d_{k+1} = A_k d_k + source k, shape (K + 1, 2 N)."""
    states = np.empty((len(pieces) + 1, len(first)))
    states[0] = first
    for k, (piece, source) in enumerate(zip(pieces, sources, strict=True)):
        states[k + 1] = piece @ states[k] + source
    return states


def correction(pieces: FloatArray, misses: FloatArray, monodromy: FloatArray, *, least: bool = False) -> FloatArray:
    """Newton correction that closes a motion at its speed, shape (K, 2 N).

    With ``least``, it is the smallest correction where a multiplier is 1.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where a multiplier is 1, without ``least``.
    """
    zero = np.zeros(misses.shape[1])
    rest = carried(pieces, zero, misses)[-1]
    matrix = monodromy - np.eye(len(zero))
    first = np.linalg.lstsq(matrix, -rest, rcond=1e-14)[0] if least else np.linalg.solve(matrix, -rest)
    return carried(pieces, first, misses)[:-1]


def bordered_correction(
    pieces: FloatArray,
    monodromy: FloatArray,
    misses: FloatArray,
    by_speed: FloatArray,
    along: FloatArray,
    along_speed: float,
    behind: float,
) -> tuple[FloatArray, float]:
    """Newton correction that closes a motion and moves it along a direction.

    Parameters
    ----------
    pieces : ndarray, shape (K, 2 N, 2 N)
    monodromy : ndarray, shape (2 N, 2 N)
        Product of the pieces.
    misses, by_speed : ndarray, shape (K, 2 N)
        Closure errors r and their derivative s by speed.
    along : ndarray, shape (K, 2 N)
    along_speed : float
        Components of the direction along the states and the speed.
    behind : float
        Required growth of Σ along · d + along_speed p.

    Returns
    -------
    corrections : ndarray, shape (K, 2 N)
    change : float
        Change of the speed.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the bordered system is singular.
    """
    size = misses.shape[1]
    zero = np.zeros(size)
    rest, change = carried(pieces, zero, misses), carried(pieces, zero, by_speed)
    row = np.zeros(size)
    for piece, direction in zip(pieces[::-1], along[::-1], strict=True):
        row = direction + row @ piece
    matrix = np.zeros((size + 1, size + 1))
    matrix[:size, :size] = monodromy - np.eye(size)
    matrix[:size, size] = change[-1]
    matrix[size, :size], matrix[size, size] = row, float(np.sum(along * change[:-1])) + along_speed
    right = np.append(-rest[-1], behind - float(np.sum(along * rest[:-1])))
    # Growth over the period would swamp the row of the direction.
    scale = np.abs(matrix).max(axis=1)
    solution = np.linalg.solve(matrix / scale[:, None], right / scale)
    move = float(solution[size])
    return carried(pieces, solution[:size], misses + move * by_speed)[:-1], move


_ROOM_FOR_CUTS = 400  # least number of cuts that the first attempt has room for
_MOST_CUTS = 41  # cuts of one element for which there is room, above the kernel's largest number
_PER_CYCLE = 4  # number of coarsest elements in a mesh period or in the shortest cycle of a load
_SAME_TIME = 1e-9  # part of the period within which two events are one
_SAME_SIZE = 1e-11  # parts of the largest element by which elements of one size may differ


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of a period: cut at every tooth event, with equal elements between.

    Attributes
    ----------
    starts : ndarray, shape (e,)
        Starts of the elements [s].
    sizes : ndarray, shape (e,)
        Sizes of the elements [s].
    slots : ndarray of int, shape (e,)
        Slot of each element's size.
    steps : Steps
    nodes : ndarray of int, shape (K + 1,)
        First element of each segment, and e.
    """

    starts: FloatArray
    sizes: FloatArray
    slots: npt.NDArray[np.int64]
    steps: Steps
    nodes: npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class PeriodMotion:
    """Motion over one period, segment by segment, with its sensitivities.

    Attributes
    ----------
    part : LinearPart
    starts, ends : ndarray, shape (K, 2 N)
        States, see :class:`gearwhine.coupling.collocation.linear_part.LinearPart`.
    pieces : ndarray, shape (K, 2 N, 2 N)
        Derivative of each end by its start, both in amplitudes (:attr:`LinearPart.to_amplitudes`); shape (0, 2 N, 2 N)
        without disturbances.
    trace : Trace
        Trace, trimmed to its elements.
    switches : int
        Number of changes of the branch of a contact law.
    """

    part: LinearPart
    starts: FloatArray
    ends: FloatArray
    pieces: FloatArray
    trace: Trace
    switches: int

    @property
    def start(self) -> FloatArray:
        """State at t = 0, shape (2 N,)."""
        return np.asarray(self.starts[0])

    @property
    def end(self) -> FloatArray:
        """State after the period, shape (2 N,)."""
        return np.asarray(self.ends[-1])

    @cached_property
    def turn(self) -> FloatArray:
        """Monodromy of amplitudes, with the same eigenvalues, shape (2 N, 2 N)."""
        return product(self.pieces)

    @cached_property
    def monodromy(self) -> FloatArray:
        """Monodromy: derivative of the end by the start, shape (2 N, 2 N)."""
        return np.asarray(self.part.from_amplitudes @ self.turn @ self.part.to_amplitudes)

    @cached_property
    def misses(self) -> FloatArray:
        """Closure errors: each end less the next start, the last end less the first start, shape (K, 2 N)."""
        return self.ends - np.roll(self.starts, -1, axis=0)

    @property
    def missing(self) -> float:
        """Norm of the closure errors; infinite where an unstable motion leaves none of their squares finite."""
        with np.errstate(over="ignore"):
            return float(np.linalg.norm(self.misses))

    def correction(self, misses: FloatArray | None = None, *, least: bool = False) -> FloatArray:
        """Newton correction that closes this motion, or one nearby with other closure errors, shape (K, 2 N).

        See :func:`gearwhine.coupling.periodic.orbit.correction`.
        """
        missing = (self.misses if misses is None else misses) @ self.part.to_amplitudes.T
        return np.asarray(correction(self.pieces, missing, self.turn, least=least) @ self.part.from_amplitudes.T)

    def bordered_correction(
        self, misses: FloatArray, by_speed: FloatArray, along: FloatArray, along_speed: float, behind: float
    ) -> tuple[FloatArray, float]:
        """Newton correction along a direction, see :func:`gearwhine.coupling.periodic.orbit.bordered_correction`."""
        forth, back = self.part.to_amplitudes.T, self.part.from_amplitudes
        moves, change = bordered_correction(
            self.pieces, self.turn, misses @ forth, by_speed @ forth, along @ back, along_speed, behind
        )
        return np.asarray(moves @ back.T), change


def event_times(system: CoupledSystem, nodes: FloatArray) -> FloatArray:
    """Return times at which a pair of teeth enters or leaves contact or a relief begins, and the nodes [s].

    The last node is the period. An event next to a node is that node.
    """
    period = float(nodes[-1])
    times: FloatArray = np.unique(
        np.concatenate([contact.event_times(0.0, period) for contact in system.contacts] + [[]])
    )
    after = np.clip(np.searchsorted(nodes, times), 1, len(nodes) - 1)
    apart = np.minimum(np.abs(times - nodes[after - 1]), np.abs(times - nodes[after]))
    times = times[apart > _SAME_TIME * period]
    times = times[np.diff(times, prepend=-period) > _SAME_TIME * period]
    return np.sort(np.concatenate([nodes, times]))


def coarsest_element(system: CoupledSystem, period: float) -> float:
    """Coarsest size of an element [s]."""
    rates = [abs(contact.mesh_frequency) for contact in system.contacts]
    rates += [abs(load.frequency) / (2.0 * np.pi) for load in system.harmonic_loads]
    return min(period, 1.0 / max([*rates, 1.0 / period])) / _PER_CYCLE


def cut_period(part: LinearPart, period: float, largest: float, segments: int = 1) -> Elements:
    """Elements no larger than a size [s], in as many segments of equal length."""
    marks = period * np.arange(segments + 1) / segments
    marks[-1] = period
    bounds = event_times(part.system, marks)
    lengths = np.diff(bounds)
    counts = np.maximum(np.ceil(lengths / largest - 1e-9), 1.0).astype(np.int64)
    size = np.repeat(lengths / counts, counts)
    within = np.arange(len(size)) - np.repeat(np.cumsum(counts) - counts, counts)
    # Sizes that differ by rounding are one.
    _, first, slots = np.unique(np.rint(size / (_SAME_SIZE * largest)), return_index=True, return_inverse=True)
    steps = empty_steps(part.reference, size[first], float(size.max()))
    nodes = np.concatenate([[0], np.cumsum(counts)])[np.searchsorted(bounds, marks)]
    return Elements(np.repeat(bounds[:-1], counts) + within * size, size, slots.astype(np.int64), steps, nodes)


def integrate_period(
    part: LinearPart, contacts: Contacts, elements: Elements, start: FloatArray, *, varied: bool = True
) -> PeriodMotion:
    """Integrate over the period from a state at t = 0, shape (2 N,), or each segment from its own, shape (K, 2 N).

    Raises
    ------
    PeriodicError
        Where the contact forces do not converge, or the motion grows beyond all bounds.
    """
    room = max(_ROOM_FOR_CUTS, len(elements.starts))
    while True:
        motion = _pass_within(part, contacts, elements, start, room, varied=varied)
        if motion is not None:
            return motion
        # Long periods with many teeth and slices of their faces change branches often, which is no fault.
        room *= 4


def _pass_within(
    part: LinearPart, contacts: Contacts, elements: Elements, start: FloatArray, room: int, *, varied: bool
) -> PeriodMotion | None:
    """Integrate with room for a limited number of changes of contact; None where there are more."""
    from gearwhine.coupling.collocation.integration_kernels import NO_ROOM, integrate_elements

    modes, count = len(part.eigenvalues), len(elements.nodes) - 1
    m, c = part.reference.eigenvalue.size, len(part.system.contacts)
    size = start.shape[-1]
    starts, ends = np.empty((count, size)), np.empty((count, size))
    pieces = np.empty((count if varied else 0, size, size))
    trace = empty_trace(len(elements.starts) + room, m, ORDER, c)
    # One disturbance of each amplitude; real eigenvalues have no imaginary part.
    upper = np.concatenate([np.arange(modes), m + np.flatnonzero(part.eigenvalues.imag > 0.0)])
    begun = np.eye(2 * m)[upper if varied else []]
    columns = np.empty_like(begun)
    work, rows = element_work(m, ORDER, c, varied=varied), real_rows(part.right)
    moving = np.concatenate([np.arange(modes), m + np.arange(modes)])
    stored = switches = 0
    times = elements.starts[elements.nodes[:-1]]
    amplitudes = part.amplitudes_of(start, times) if start.ndim == 2 else None
    for k in range(count):
        starts[k] = start[k] if start.ndim == 2 else start if k == 0 else ends[k - 1]
        elements_of_segment = slice(elements.nodes[k], elements.nodes[k + 1])
        z = part.amplitudes_of(starts[k], float(times[k])) if amplitudes is None else amplitudes[k]
        columns[:] = begun
        length, cuts, wrong = integrate_elements(
            part.reference,
            contacts,
            elements.steps,
            elements.starts[elements_of_segment],
            elements.sizes[elements_of_segment],
            elements.slots[elements_of_segment],
            z,
            columns,
            modes,
            trace,
            stored,
            work,
        )
        if wrong == NO_ROOM and room < _MOST_CUTS * len(elements.starts):
            return None
        if wrong:
            _refuse(wrong, room)
        ends[k] = rows @ z[moving]
        if varied:
            pieces[k] = columns.T[upper]
        stored = int(length)
        switches += int(cuts)
    if not np.all(np.isfinite(ends)):
        raise PeriodicError("the motion grew beyond all bounds within a period; look for unstable coupled modes")
    # The result has no room to spare.
    trimmed = Trace._make(values.copy() for values in first_elements(trace, stored))
    return PeriodMotion(part, starts, ends, pieces, trimmed, switches)


def _refuse(wrong: int, room: int) -> None:
    from gearwhine.coupling.collocation.integration_kernels import NO_BALANCE, NO_ROOM

    if wrong == NO_BALANCE:
        raise PeriodicError("the teeth's forces do not balance within an element of time; expected a law that grows")
    assert wrong == NO_ROOM
    raise PeriodicError(
        f"more than {room} changes of contact in a period: the flanks chatter; give the mesh some damping"
    )
