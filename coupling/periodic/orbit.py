"""One pass over the period: from a state at t = 0 to that at its end, with the monodromy on the way."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from coupling.errors import PeriodicError
from coupling.kernel_arrays import Contacts
from coupling.periodic.arrays import Steps, Trace, empty_steps, empty_trace, first_elements
from coupling.periodic.collocation import ORDER
from coupling.periodic.element_work import element_work
from coupling.periodic.linear_part import LinearPart, real_rows
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_ROOM_FOR_CUTS = 400
_PER_CYCLE = 4  # coarsest elements in a mesh period or in the shortest cycle of a load
_SAME_TIME = 1e-9  # part of the period within which two events are one
_SAME_SIZE = 1e-11  # parts of the largest element by which elements of one size may differ
_LADDER = 1.1  # between the sizes of its rungs ...
_RUNGS = 100  # ... so down to a ten-thousandth of the largest


@dataclass(frozen=True, eq=False)
class Elements:
    """The period cut at every event of the teeth, and the stretches between into equal elements.

    Attributes
    ----------
    starts : ndarray, shape (e,)
        [s].
    sizes : ndarray, shape (e,)
        [s].
    slots : ndarray of int, shape (e,)
        Which size each has.
    steps : Steps
    """

    starts: FloatArray
    sizes: FloatArray
    slots: npt.NDArray[np.int64]
    steps: Steps


@dataclass(frozen=True, eq=False)
class Pass:
    """A period of motion from some state.

    Attributes
    ----------
    start, end : ndarray, shape (2 N,)
        States, see :class:`coupling.periodic.linear_part.LinearPart`.
    monodromy : ndarray, shape (2 N, 2 N)
        Of the end by the start; without columns where it was not asked for.
    trace : Trace
        Cut to the elements that it holds.
    switches : int
        How often a contact changed its branch.
    """

    start: FloatArray
    end: FloatArray
    monodromy: FloatArray
    trace: Trace
    switches: int

    @property
    def closure(self) -> FloatArray:
        """By which the end misses the start, shape (2 N,)."""
        return self.end - self.start


def event_times(system: CoupledSystem, period: float) -> FloatArray:
    """0, every time at which a pair of teeth comes or goes or a relief begins, and the period [s]."""
    inner = [contact.event_times(0.0, period) for contact in system.contacts]
    times: FloatArray = np.unique(np.concatenate([[0.0, period], *inner]))
    times = times[np.concatenate([[True], np.diff(times) > _SAME_TIME * period])]
    if period - times[-2] <= _SAME_TIME * period and len(times) > 2:
        times = np.delete(times, -2)
    times[-1] = period
    return times


def coarsest_element(system: CoupledSystem, period: float) -> float:
    """Size to begin with [s]."""
    rates = [abs(contact.rate) for contact in system.contacts]
    rates += [abs(load.frequency) / (2.0 * np.pi) for load in system.harmonic_loads]
    return min(period, 1.0 / max([*rates, 1.0 / period])) / _PER_CYCLE


def cut_period(part: LinearPart, period: float, largest: float) -> Elements:
    """Elements no larger than a size [s]."""
    bounds = event_times(part.system, period)
    lengths = np.diff(bounds)
    counts = np.maximum(np.ceil(lengths / largest - 1e-9), 1.0).astype(np.int64)
    size = np.repeat(lengths / counts, counts)
    within = np.arange(len(size)) - np.repeat(np.cumsum(counts) - counts, counts)
    # What rounding alone holds apart is one size.
    _, first, slots = np.unique(np.rint(size / (_SAME_SIZE * largest)), return_index=True, return_inverse=True)
    steps = element_sizes(part, size[first], float(size.max()))
    return Elements(np.repeat(bounds[:-1], counts) + within * size, size, slots.astype(np.int64), steps)


def element_sizes(part: LinearPart, values: FloatArray, largest: float, *, inner: bool = False) -> Steps:
    """Room for elements of some sizes, and for a ladder from the largest down."""
    reference = part.reference
    sizes = np.concatenate([values, largest / _LADDER ** np.arange(_RUNGS)])
    return empty_steps(sizes, len(values), reference.eigenvalue.size, ORDER, reference.stiffness.size, inner=inner)


def one_pass(
    part: LinearPart, contacts: Contacts, elements: Elements, start: FloatArray, *, varied: bool = True
) -> Pass:
    """March from a state through the period.

    Raises
    ------
    PeriodicError
        Where the teeth's forces are not found, or their contact chatters without end.
    """
    from coupling.periodic.kernels import NO_BALANCE, NO_ROOM, march

    z = part.amplitudes_of(start)
    modes = len(part.eigenvalues)
    columns = np.zeros((2 * modes, len(start) if varied else 0))
    if varied:
        columns[0::2], columns[1::2] = part.left.real, part.left.imag
    m, c = part.reference.eigenvalue.size, len(part.system.contacts)
    trace = empty_trace(len(elements.starts) + _ROOM_FOR_CUTS, m, ORDER, c)
    count, cuts, wrong = march(
        part.reference,
        contacts,
        elements.steps,
        elements.starts,
        elements.sizes,
        elements.slots,
        z,
        columns,
        modes,
        trace,
        element_work(m, ORDER, c, columns.shape[1]),
    )
    if wrong == NO_BALANCE:
        raise PeriodicError("the teeth's forces do not balance within an element of time; expected a law that grows")
    if wrong == NO_ROOM:
        raise PeriodicError(
            f"more than {_ROOM_FOR_CUTS} changes of contact in a period: the flanks chatter; give the mesh some damping"
        )
    rows = real_rows(part.right)
    end = rows @ z[: 2 * modes]
    if not np.all(np.isfinite(end)):
        raise PeriodicError("the motion grew beyond all bounds within a period; look for unstable coupled modes")
    # What is kept has no room to spare.
    kept = Trace._make(part.copy() for part in first_elements(trace, int(count)))
    return Pass(start, end, rows @ columns, kept, int(cuts))
