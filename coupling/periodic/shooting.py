"""Shooting method: periodic motion of a coupled system by Newton's method on the state after a period.

A motion is periodic where the state x(T) after the period is the state x(0) at its start. With the monodromy
M = ∂x(T)/∂x(0), which :mod:`gearwhine.coupling.collocation.integration_kernels` integrates exactly, switches of contact
included, Newton's step solves

    (M - I) Δ = x(0) - x(T).

A period of many mesh periods is integrated in segments, each from a state of its own, and all of them are corrected at
once; see :mod:`gearwhine.coupling.periodic.orbit`.

While the same teeth touch the machine is linear with coefficients that vary in time, and one step is enough. Unstable
motions are found as well as stable ones.

The period is the common period of all excitations of the machine (`common_period`).
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from math import lcm

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.linear_part import LinearPart, linear_part
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.coupling.errors import CouplingError, PeriodicError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import driving_frequencies
from gearwhine.coupling.periodic.orbit import Elements, PeriodMotion, coarsest_element, cut_period, integrate_period
from gearwhine.coupling.periodic.response import BranchMotion, PeriodicResponse, multipliers
from gearwhine.coupling.time.condensation import Condensed, condensed
from gearwhine.coupling.time.step_matrices import contact_arrays

_FREQUENCY_RATIO_TOLERANCE = 1e-9  # relative tolerance of a frequency ratio
_LARGEST_NUMBER = 2000  # largest number in a frequency ratio: no gear has more teeth
_WHOLE_CYCLES_TOLERANCE = 1e-6  # tolerance of a whole number of cycles in a given period
FloatArray = npt.NDArray[np.float64]

_NEWTON_STEPS = 25
_SHORTEST_STEP = 1.0 / 64.0
_MOST_SEGMENTS = 32
_CLOSURE_ROUNDING = 1e-11  # closure error of a closed motion, relative
_FINEST = 12  # largest number of halvings of the coarsest element
_FINER = 3  # number of halvings of the elements that the search tries
_ROUNDS = 6  # rounds of time integration before the search fails
_FIRST_ROUNDS = 2  # number of them before finer elements, and the search from damped teeth
_PERIODS = 8  # periods of the first round, doubled in every further one
_TURNED, _WATCHED = 16, 32  # periods before and while the growth of a disturbance is measured
_CHAOTIC = 1.02  # growth in a period beyond which a motion is called chaotic
_LARGEST_DAMPING_FACTOR = 64.0  # largest damping of the teeth over their own
_LOSS_FACTOR = 1e-3  # least loss factor, at the fastest mesh frequency, that takes the place of the teeth's own
_LONGEST_STRIDE, _SHORTEST_STRIDE = 0.7, 0.02  # largest and least change of the damping's logarithm in one step


def common_period(system: CoupledSystem, period: float | None = None) -> float:
    """Return the common period: the shortest time in which every driving frequency makes whole cycles [s].

    The rates at which directions turn with planet carriers are among them.

    Parameters
    ----------
    system : CoupledSystem
    period : float, optional
        A multiple of it, which is checked: subharmonic motions repeat after several periods.

    Raises
    ------
    CouplingError
        Where the frequencies have no common period, nothing varies, or the given period is not one.
    """
    frequencies = driving_frequencies(system)
    for rate in system.turning_rates:
        frequencies[f"the turn of a carrier, {len(frequencies) + 1}"] = abs(rate) / (2.0 * np.pi)
    if period is not None:
        if not 0.0 < period < np.inf:
            raise CouplingError(f"a period of {period} s; expected a positive number")
        for source, frequency in frequencies.items():
            cycles = frequency * period
            if round(cycles) < 1 or abs(cycles - round(cycles)) > _WHOLE_CYCLES_TOLERANCE:
                raise CouplingError(
                    f"{source} at {frequency:.9g} Hz makes {cycles:.9g} cycles in the period of {period:.9g} s; "
                    "expected a whole number"
                )
        return period
    if not frequencies:
        raise CouplingError(
            "nothing varies with time, so no period is given by the machine; static_equilibrium says where it rests, "
            "or give the period of a motion that you look for"
        )
    first = next(iter(frequencies))
    ratios = []
    for source, frequency in frequencies.items():
        exact = frequency / frequencies[first]
        ratio = Fraction(exact).limit_denominator(_LARGEST_NUMBER)
        if (
            ratio == 0
            or abs(float(ratio) / exact - 1.0) > _FREQUENCY_RATIO_TOLERANCE
            or ratio.numerator > _LARGEST_NUMBER**2
        ):
            raise CouplingError(
                f"{source} at {frequency:.9g} Hz and {first} at {frequencies[first]:.9g} Hz have no common period: "
                f"their ratio {exact:.12g} is no fraction of whole numbers up to {_LARGEST_NUMBER}; the motion does "
                "not repeat, leave one of them out or integrate in time"
            )
        ratios.append(ratio)
    # Number of cycles of the first frequency in which all make whole cycles.
    return lcm(*(ratio.denominator for ratio in ratios)) / frequencies[first] / _common_factor(ratios)


def _common_factor(ratios: list[Fraction]) -> int:
    """Return the least common multiple: the number of times that all repeat within a common period."""
    cycles = lcm(*(ratio.denominator for ratio in ratios))
    return int(np.gcd.reduce([int(ratio * cycles) for ratio in ratios]))


@dataclass(frozen=True, eq=False)
class Problem:
    """Shooting problem: a system prepared for the search of its periodic motion.

    Attributes
    ----------
    system : CoupledSystem
        System as given.
    recovery : ndarray, shape (n, k)
        Coordinates of the system from the condensed coordinates.
    kept : ndarray of int, shape (k,)
        Numbers of the condensed coordinates.
    period : float
        Period [s].
    part : LinearPart
        Linear part of the condensed system.
    contacts : Contacts
        Contacts as arrays for the kernels.
    segments : int
        Number of segments of equal length in the period.
    """

    system: CoupledSystem
    recovery: FloatArray
    kept: npt.NDArray[np.int64]
    period: float
    part: LinearPart
    contacts: Contacts
    segments: int

    @property
    def nodes(self) -> FloatArray:
        """Starts of the segments, shape (K,) [s]."""
        return np.asarray(self.period * np.arange(self.segments) / self.segments)

    def elements(self, level: int) -> Elements:
        """Elements of the period, the coarsest ones halved ``level`` times."""
        largest = coarsest_element(self.system, self.period) / 2.0**level
        return cut_period(self.part, self.period, largest, self.segments)

    def scale(self, state: FloatArray) -> float:
        """Size of a motion, in the units of a state."""
        response = np.linalg.norm(self.part.mean) + np.abs(self.part.amplitudes).sum()
        return float(np.linalg.norm(state) + response) or 1e-300


def problem(system: CoupledSystem, period: float | None = None, like: Problem | None = None) -> Problem:
    """Shooting problem of a system: its period, linear part and contacts.

    Unchanged parts are taken from ``like``, the same machine at another speed.

    Raises
    ------
    PeriodicError
        Where the system has laws that the method does not know.
    """
    if system.turning_names:
        raise PeriodicError(
            f"shooting does not know directions that turn, those of {', '.join(system.turning_names)}; "
            "settled_response finds the motion in which such a machine settles (`steady`)"
        )
    if not system.is_smooth:
        nonlinearity = "nonlinear bearings" if system.nonlinear else "friction between its teeth"
        raise PeriodicError(
            f"the periodic response does not know {nonlinearity}; expected a system without: leave that out, or "
            "integrate in time until the motion is steady"
        )
    length = common_period(system, period)
    followed = _followed(system)
    # Rates are relative to the fastest excitation, so that a long period does not give them more weight.
    fastest = max([*driving_frequencies(system).values(), 1.0 / length])
    part = linear_part(followed.system, 2.0 * np.pi * fastest, None if like is None else like.part)
    contacts = contact_arrays(followed.system)
    return Problem(system, followed.recovery, followed.kept, length, part, contacts, _segments(system, length))


def _segments(system: CoupledSystem, period: float) -> int:
    """Count the segments of multiple shooting: one mesh period each, or several where the period has many."""
    cycles = round(period * max([abs(contact.mesh_frequency) for contact in system.contacts], default=0.0))
    return max(1, math.ceil(cycles / math.ceil(cycles / _MOST_SEGMENTS))) if cycles else 1


def _followed(system: CoupledSystem) -> Condensed:
    """Condense the system, as in the transient; see :mod:`gearwhine.coupling.time.condensation`."""
    if system.resolved.all():
        return Condensed(system, np.arange(system.size), np.eye(system.size))
    return condensed(system)


def periodic_response(
    system: CoupledSystem,
    *,
    period: float | None = None,
    start: tuple[FloatArray, FloatArray] | PeriodicResponse | None = None,
    tolerance: float = 1e-8,
) -> PeriodicResponse:
    """Periodic motion of a system with the period of its excitation.

    Parameters
    ----------
    system : CoupledSystem
        System at constant speed.
    period : float, optional
        Period [s]; by default the shortest common one of mesh phases, runout errors and harmonic loads. A multiple
        finds subharmonic motions too.
    start : tuple of ndarray, or PeriodicResponse, optional
        Start of the search: displacements and rates at t = 0, shape (n,) each, or at the starts of all segments of the
        period, shape (K, n); or a motion of a neighbouring system. Where contact is lost several motions may exist, and
        the start selects one. By default the response at the mean mesh stiffness.
    tolerance : float
        Relative tolerance of state and monodromy: elements are halved until another halving changes neither by more.

    Returns
    -------
    PeriodicResponse

    Raises
    ------
    CouplingError
        Where the excitation has no common period, or the loads do not balance.
    PeriodicError
        Where no periodic motion is found, or the tolerance is not met.
    """
    if not 0.0 < tolerance < 1.0:
        raise CouplingError(f"a tolerance of {tolerance}; expected a small positive number")
    ready = problem(system, period)
    level = 0 if not isinstance(start, PeriodicResponse) else max(start.level - 1, 0)
    state = np.zeros((ready.segments, ready.part.states)) if start is None else _states(ready, start)
    motion, level, steps = _search(ready, level, state)
    return refined(ready, motion, level, tolerance, steps)


def _states(ready: Problem, start: tuple[FloatArray, FloatArray] | PeriodicResponse) -> FloatArray:
    """Start states: at t = 0, shape (2 N,), or at all nodes, shape (K, 2 N)."""
    size = ready.system.size
    if isinstance(start, PeriodicResponse):
        if start.system.size != size:
            raise CouplingError(f"a motion of {start.system.size} coordinates to start from; expected {size}")
        start = start.at_nodes(ready.segments)
    q, v = np.asarray(start[0]), np.asarray(start[1])
    for label, states in (("displacements", q), ("rates", v)):
        if states.shape not in ((size,), (ready.segments, size)):
            raise CouplingError(
                f"{label} of shape {states.shape} to start from; expected ({size},) or ({ready.segments}, {size})"
            )
    if q.ndim == 1 or v.ndim == 1:
        return ready.part.state(q[ready.kept], v[ready.kept])
    rows = zip(q[:, ready.kept], v[:, ready.kept], ready.nodes, strict=True)
    return np.array([ready.part.state(*row) for row in rows])


def response_near(
    system: CoupledSystem, period: float | None, start: tuple[FloatArray, FloatArray], level: int, tolerance: float
) -> PeriodicResponse:
    """Solve for the periodic motion near states at the starts of all segments, unstable ones too, at an element level.

    Raises
    ------
    PeriodicError
        Where Newton's method alone does not find it: time integration would depart from an unstable motion.
    """
    ready = problem(system, period)
    closed = close(ready, ready.elements(level), _states(ready, start))
    if closed is None:
        raise PeriodicError("no motion is found next to where it was looked for; take points that are closer together")
    return refined(ready, closed[0], level, tolerance, closed[1], near=True)


def integrated_again(system: CoupledSystem, period: float | None, stored: BranchMotion) -> PeriodicResponse:
    """Integrate the whole motion again from the starts of its segments."""
    ready = problem(system, period)
    states = _states(ready, (stored.displacements, stored.velocities))
    motion = integrate_period(ready.part, ready.contacts, ready.elements(stored.level), states)
    return response_of(ready, motion, stored.level, stored.error, stored.newton_steps)


def refined(
    ready: Problem, motion: PeriodMotion, level: int, tolerance: float, steps: int, *, near: bool = False
) -> PeriodicResponse:
    """Halve the elements until neither state nor monodromy changes by more than the tolerance.

    A motion that must stay ``near`` is not searched by time integration.
    """
    while level < _FINEST:
        finer = close(ready, ready.elements(level + 1), motion.starts)
        if finer is None and near:
            raise PeriodicError("elements half as large find no motion near that of the larger ones")
        if finer is None:
            better, level, more = _search(ready, level + 1, motion.starts)
        else:
            better, level, more = finer[0], level + 1, finer[1]
        steps += more
        # Rounding sets a floor to what a halving can show.
        moved = float(np.linalg.norm(better.starts - motion.starts, axis=1).max()) / ready.scale(better.start)
        monodromy_change = float(np.abs(better.monodromy - motion.monodromy).max(initial=0.0))
        monodromy_change /= max(float(np.abs(better.monodromy).max(initial=0.0)), 1.0)
        error = max(moved, monodromy_change)
        motion = better
        if error <= tolerance:
            return response_of(ready, motion, level, error, steps)
    raise PeriodicError(
        f"elements of {ready.period / len(motion.trace.start):.1e} s still change the motion by {error:.1e}, more than "
        f"the tolerance {tolerance:g}; raise it, or look for contact that grazes"
    )


def response_of(ready: Problem, motion: PeriodMotion, level: int, error: float, steps: int) -> PeriodicResponse:
    """Response of a closed motion, with its proof."""
    q, v = ready.part.motion(motion.start)
    return PeriodicResponse(
        system=ready.system,
        period=ready.period,
        displacement=ready.recovery @ q,
        velocity=ready.recovery @ v,
        floquet=multipliers(motion.turn, ready.period),
        residual=motion.missing / ready.scale(motion.start),
        error=error,
        elements=len(motion.trace.start),
        switches=motion.switches,
        level=level,
        newton_steps=steps,
        part=ready.part,
        recovery=ready.recovery,
        contacts=ready.contacts,
        trace=motion.trace,
    )


def close(ready: Problem, elements: Elements, state: FloatArray) -> tuple[PeriodMotion, int] | None:
    """Newton's method on the closure error, with step halving; None where it stagnates."""
    motion = integrate_period(ready.part, ready.contacts, elements, state)
    best = motion.missing
    for step in range(_NEWTON_STEPS):
        if best <= _CLOSURE_ROUNDING * ready.scale(motion.start):
            return motion, step
        move = motion.correction(least=True)
        part = 1.0
        while True:
            trial = integrate_period(ready.part, ready.contacts, elements, motion.starts + part * move)
            missing = trial.missing
            if missing < (1.0 - 0.1 * part) * best:
                break
            part *= 0.5
            if part < _SHORTEST_STEP:
                # The rest may be rounding, which no step removes.
                return (motion, step) if best <= 1e3 * _CLOSURE_ROUNDING * ready.scale(motion.start) else None
        motion, best = trial, missing
    return None


def _search(ready: Problem, level: int, state: FloatArray) -> tuple[PeriodMotion, int, int]:
    """Search for a closed motion; returns it, the level of its elements, and the number of Newton steps.

    Newton's method comes first. Where it stagnates, it is repeated

    - after some periods of time integration, which lead to a stable motion;
    - with finer elements: over elements that are long for the vibration of the teeth, the end of a period jumps as its
      start changes, and no motion may close at all;
    - on the way from heavily damped teeth to the teeth as they are, which leads to an unstable motion too;
    - after more periods of time integration.
    """
    elements = ready.elements(level)
    closed = close(ready, elements, state)
    nearer = state if state.ndim == 1 else state[0]
    damped: DampedMotion | None = None
    for turn in range(_ROUNDS):
        if closed is not None:
            return closed[0], level, closed[1]
        if turn == _FIRST_ROUNDS:
            for _ in range(_FINER):
                level += 1
                elements = ready.elements(level)
                closed = close(ready, elements, state)
                if closed is not None:
                    return closed[0], level, closed[1]
            damped = _from_damped_teeth(ready, level, state)
            if damped is not None and damped.factor == 1.0:
                return damped.motion, level, damped.steps
        for _ in range(_PERIODS * 2**turn):
            nearer = integrate_period(ready.part, ready.contacts, elements, nearer, varied=False).end
        closed = close(ready, elements, nearer)
    if closed is not None:
        return closed[0], level, closed[1]
    raise PeriodicError(_why_none(ready, elements, nearer, damped))


def _why_none(ready: Problem, elements: Elements, state: FloatArray, damped: "DampedMotion | None") -> str:
    """Message that no motion is found, with the evidence: growth of a disturbance, and a motion of damped teeth."""
    text = (
        f"no motion of period {ready.period:.6g} s found, not even after {_PERIODS * (2**_ROUNDS - 1)} periods in time"
    )
    growth = _growth(ready, elements, state)
    if growth > _CHAOTIC:
        text += f": it is chaotic, a disturbance grows by a factor of {growth:.3g} a period"
    else:
        text += ": it may repeat after several periods (give a multiple as period), or the start is far from one"
    if damped is not None:
        floquet = multipliers(damped.motion.turn, ready.period)
        text += (
            f"; with {damped.factor:.3g} times the damping of the teeth there is "
            f"{'a stable one' if floquet.stable else f'an unstable one (Floquet multiplier {floquet.largest:.4g})'}"
        )
    return text + "; start from a neighbouring speed or from the end of a transient"


def _growth(ready: Problem, elements: Elements, state: FloatArray) -> float:
    """Mean growth of a disturbance in a period of time integration: the exponential of the largest Lyapunov exponent.

    The first periods turn the disturbance to the direction that grows most, and do not count.
    """
    along, total = np.ones(ready.part.states), 0.0
    for number in range(-_TURNED, _WATCHED):
        motion = integrate_period(ready.part, ready.contacts, elements, state)
        state, along = motion.end, motion.turn @ along
        length = float(np.linalg.norm(along))
        along = along / length
        total += math.log(length) if number >= 0 else 0.0
    return math.exp(total / _WATCHED)


@dataclass(frozen=True, eq=False)
class DampedMotion:
    """Closed motion with more damping of the teeth.

    Attributes
    ----------
    motion : PeriodMotion
    factor : float
        Damping over the teeth's own, 1 where they are as they are.
    steps : int
        Number of Newton steps on the way.
    """

    motion: PeriodMotion
    factor: float
    steps: int


def _from_damped_teeth(ready: Problem, level: int, state: FloatArray) -> DampedMotion | None:
    """Follow the motion from heavily damped teeth, which hardly part, as far as possible to the teeth as they are.

    None where there is none even with heavy damping.
    """
    fastest = 2.0 * np.pi * max([abs(one.mesh_frequency) for one in ready.system.contacts], default=0.0)
    # Teeth without damping of their own have none to multiply.
    least = ready.part.reference.stiffness * (_LOSS_FACTOR / fastest if fastest else 0.0)
    way = last = math.log(_LARGEST_DAMPING_FACTOR)
    stride, steps, starts = _LONGEST_STRIDE, 0, state
    found: DampedMotion | None = None
    while True:
        try:
            other = _with_damping(ready, math.expm1(way) * least, math.expm1(way)) if way else ready
            closed = close(other, other.elements(level), starts)
        except PeriodicError:
            closed = None
        if closed is not None:
            steps += closed[1]
            found, starts = DampedMotion(closed[0], math.exp(way), steps), closed[0].starts
            stride = min(1.5 * stride, _LONGEST_STRIDE)
            if way == 0.0:
                return found
        else:
            way, stride = way + last, 0.5 * stride
            if found is None or stride < _SHORTEST_STRIDE:
                return found
        last = min(stride, way)
        way -= last


def _with_damping(ready: Problem, least: FloatArray, part: float) -> Problem:
    """Shooting problem with the damping of each contact raised by a part of its own, or by ``least`` [N s/m], (c,)."""
    contacts = tuple(
        replace(one, contact=replace(one.contact, damping=one.contact.damping + max(part * one.contact.damping, added)))
        for one, added in zip(ready.system.contacts, least.tolist(), strict=True)
    )
    return problem(replace(ready.system, contacts=contacts), ready.period, ready)
