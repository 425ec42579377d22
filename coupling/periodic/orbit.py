"""One pass over the period: from a state at t = 0 to that at its end, with the monodromy on the way."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.errors import PeriodicError
from coupling.periodic.arrays import Steps, Trace, empty_steps, empty_trace, first_elements
from coupling.periodic.collocation import ORDER
from coupling.periodic.linear_part import LinearPart
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_ROOM_FOR_CUTS = 400
_PER_CYCLE = 4  # coarsest elements in a mesh period or in the shortest cycle of a load
_SAME_TIME = 1e-9  # part of the period within which two events are one
_SAME_SIZE = 11  # digits to which elements of one size agree
_LAWS = (4, 16, 64)  # numbers of contacts that kernels are compiled for


@dataclass(frozen=True, eq=False)
class Elements:
    """The period cut at every event of the teeth, and the stretches between into equal elements.

    Attributes
    ----------
    starts : ndarray, shape (e,)
        [s].
    slots : ndarray of int, shape (e,)
        Which size each has.
    steps : Steps
    """

    starts: FloatArray
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
    from coupling.periodic.kernels import fill_steps

    bounds = event_times(part.system, period)
    lengths = np.diff(bounds)
    counts = np.maximum(np.ceil(lengths / largest - 1e-9), 1.0).astype(np.int64)
    starts = [a + (b - a) * np.arange(n) / n for a, b, n in zip(bounds[:-1], bounds[1:], counts, strict=True)]
    sizes: dict[str, int] = {}
    values: list[float] = []
    slots = []
    for size, count in zip(lengths / counts, counts, strict=True):
        key = f"{size:.{_SAME_SIZE}e}"
        if key not in sizes:
            sizes[key] = len(values)
            values.append(float(size))
        slots += [sizes[key]] * int(count)
    reference = part.reference
    m, c = reference.eigenvalue.size, reference.stiffness.size
    steps = empty_steps(len(values) + 2, m, ORDER, c)
    fill_steps(reference, np.array(values), steps)
    return Elements(np.concatenate(starts), np.array(slots, dtype=np.int64), steps)


def laws_of(system: CoupledSystem) -> tuple[Any, ...]:
    """The contacts' laws as the kernels take them: at least one, repeated up to a number they are compiled for."""
    from coupling.gears import ToothContact, piecewise

    contacts = [contact.contact for contact in system.contacts]
    if len(contacts) > _LAWS[-1]:
        raise PeriodicError(f"{len(contacts)} tooth contacts; the periodic response takes up to {_LAWS[-1]}")
    room = next(number for number in _LAWS if len(contacts) <= number)
    none = ToothContact(1.0, piecewise.constant(1.0, 1.0), piecewise.constant(0.0, 1.0))
    laws = [_plain(contact.kernel_arguments) for contact in contacts]
    return tuple(laws + [_plain(none.kernel_arguments)] * (room - len(laws)))


def one_pass(
    part: LinearPart, laws: tuple[Any, ...], elements: Elements, start: FloatArray, *, varied: bool = True
) -> Pass:
    """March from a state through the period.

    Raises
    ------
    PeriodicError
        Where the teeth's forces are not found, or their contact chatters without end.
    """
    from coupling.periodic.kernels import NO_BALANCE, NO_ROOM, march

    z = np.ascontiguousarray(part.left @ start)
    columns = part.left if varied else part.left[:, :0]
    real, imag = np.ascontiguousarray(columns.real), np.ascontiguousarray(columns.imag)
    trace = empty_trace(len(elements.starts) + _ROOM_FOR_CUTS, z.size, ORDER, len(part.system.contacts))
    count, cuts, wrong = march(
        part.reference, laws, elements.steps, elements.starts, elements.slots, z, real, imag, trace
    )
    if wrong == NO_BALANCE:
        raise PeriodicError("the teeth's forces do not balance within an element of time; expected a law that grows")
    if wrong == NO_ROOM:
        raise PeriodicError(
            f"more than {_ROOM_FOR_CUTS} changes of contact in a period: the flanks chatter; give the mesh some damping"
        )
    end = (part.right @ z).real
    if not np.all(np.isfinite(end)):
        raise PeriodicError("the motion grew beyond all bounds within a period; look for unstable coupled modes")
    monodromy = part.right.real @ real - part.right.imag @ imag
    return Pass(start, end, monodromy, first_elements(trace, int(count)), int(cuts))


def _plain(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Arrays in one order of memory, so that all laws have one type."""
    return tuple(np.array(one, order="C") if isinstance(one, np.ndarray) else one for one in arguments)
