r"""Periodic motion of a machine with turning carriers: periods are integrated until the motion repeats.

Planets that circle with a carrier give the machine coefficients with the period of the carrier's turn, also between the
teeth's events, so that shooting (:mod:`gearwhine.coupling.periodic.shooting`), whose linear part is constant, has
nothing to start from. A period is integrated by Newmark's method instead, x(T) = Φ(x(0)), and Φ(x) = x is solved by
Anderson's iteration: with f = Φ(x) - x and the differences of the last iterates

    x_{k+1} = Φ(x_k) - Σ γ_i (Φ(x_{i+1}) - Φ(x_i)),    γ the least of |f_k - Σ γ_i (f_{i+1} - f_i)|,

which is a secant method in the few motions that last longer than a period; all others die out by themselves. Steps are
the same in all periods, so that Φ is smooth. Motions that nothing resists, such as the rotation of the train, have
neither a place nor a mean rate of their own: both are taken out of every state.

Such a search converges to an unstable motion too. What becomes of disturbances, also of those that the search never
meets, say the leading multipliers (:mod:`gearwhine.coupling.periodic.leading_multipliers`).

- D. G. Anderson, Iterative procedures for nonlinear integral equations, *J. ACM* 12, 547, 1965.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.kernel_arrays import APART, IMPULSE, PEAK, Samples
from gearwhine.coupling.errors import PeriodicError, TransientError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.driving_frequencies import driving_frequencies, least_sampling_rate
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.periodic.leading_multipliers import Product, leading_multipliers
from gearwhine.coupling.periodic.response import FloquetMultipliers, Stability
from gearwhine.coupling.periodic.shooting import common_period
from gearwhine.coupling.statics.mean_mesh import linear_matrices, mean_contact
from gearwhine.coupling.time.condensation import Condensed, condensed, with_static_attachments
from gearwhine.coupling.time.integration import Checkpoint, Integration
from gearwhine.coupling.time.newmark_stepper import NewmarkStepper
from gearwhine.coupling.time.settings import MotionRecord, TransientOutputs, TransientSettings
from gearwhine.coupling.time.step_matrices import empty_samples

FloatArray = npt.NDArray[np.float64]

CLOSURE = 1e-4
"""Largest closure error of a settled motion, over the size of its vibration."""

STEP_TOLERANCE = 5e-4
"""Local error of the time integration that sets its steps."""

_MOST_PERIODS = 60
_REMEMBERED = 12  # differences of iterates that the acceleration takes
_INDEPENDENT = 1e-8  # least singular value of differences of length one that count as independent
_DISTURBANCE = 1e-3  # size of a disturbance over that of the vibration
_LONG_STEPS = 4.0  # steps with which disturbances are sought, over those of the motion
_LEAST_RATIO = 1.5  # of these steps, where a natural frequency bounds both
_UNCOUPLED = 1e-9  # coupling that is rounding, over its scale
_SEED = 20
_MOST_CYCLES = 2000  # cycles of the fastest excitation in a period that is integrated
_LEAST_STEPS, _LEAST_SAMPLES, _PER_CYCLE = 64, 512, 32.0  # in a period; samples in a cycle of the fastest excitation
_NO_LIMIT = 1e9  # tolerance of steps that are kept
_ALL_AT_ONCE = 1 << 24  # samples in a block


def circles(system: CoupledSystem) -> bool:
    """Whether a carrier turns: directions turn with it, or coordinates stand in its frame."""
    return bool(system.turning_names) or any(part.frame is not None for part in system.components)


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A periodic motion that the machine settles in; n coordinates, c contacts.

    Attributes
    ----------
    system : CoupledSystem
    period : float
        Period [s].
    displacement, velocity : ndarray, shape (n,)
        Displacements and rates at t = 0.
    floquet : FloquetMultipliers
        Multipliers of the disturbances that last longest, each with its error.
    residual : float
        Closure error of the period, over the size of the vibration.
    error : float
        Change of the state after a period by steps half as long, over the size of the vibration.
    elements : int
        Steps in the period.
    newton_steps : int
        Periods that were integrated to find it.
    mean_force, peak_force : ndarray, shape (c,)
        Mean and largest force of each contact over the period [N].
    mean_compression, rms_compression : ndarray, shape (c,)
        Mean compression of each contact, and its root mean square about the mean [m].
    contact_loss : ndarray, shape (c,)
        Part of the period in which the flanks are apart.
    """

    system: CoupledSystem
    period: float
    displacement: FloatArray
    velocity: FloatArray
    floquet: FloquetMultipliers
    residual: float
    error: float
    elements: int
    newton_steps: int
    mean_force: FloatArray
    peak_force: FloatArray
    mean_compression: FloatArray
    rms_compression: FloatArray
    contact_loss: FloatArray
    turn: "PeriodMap" = field(repr=False)
    start: tuple[FloatArray, FloatArray] = field(repr=False)

    @property
    def switches(self) -> None:
        """Changes of a contact law's branch, which the steps of a time integration do not count."""
        return

    @property
    def stable(self) -> bool:
        """Whether no small disturbance grows, beyond the error of the largest multiplier."""
        return self.floquet.stable

    @property
    def stability(self) -> Stability:
        """``stable``, ``unstable``, or ``not decided`` where the largest multiplier is one within its error."""
        return self.floquet.stability

    def record(self, outputs: TransientOutputs, samples: int) -> MotionRecord:
        """Rows of coordinates, rates and accelerations over the period, and the contacts.

        Parameters
        ----------
        outputs : TransientOutputs
            Output rows, as for a transient.
        samples : int
            Number of samples at even spacing.
        """
        recovery = self.turn.followed.recovery
        rows = (outputs.displacement, outputs.velocity, outputs.acceleration)
        turn = replace(self.turn, outputs=TransientOutputs(*(row @ recovery for row in rows)), samples=samples)
        _, found = turn(*self.start)
        return MotionRecord(
            times=self.period * np.arange(samples) / samples,
            displacement=found.displacement,
            velocity=found.velocity,
            acceleration=found.acceleration,
            compression=found.compression,
            force=found.force,
        )


@dataclass(frozen=True, eq=False)
class PeriodMap:
    """State after a period by the state at its start, of the condensed system of m coordinates.

    Attributes
    ----------
    followed : Condensed
    period : float
        Period [s].
    step : float
        Largest step [s].
    outputs : TransientOutputs
        Recorded rows over the m coordinates.
    samples : int
        Samples in the period.
    tolerance : float
        Local error above which steps are made shorter.
    """

    followed: Condensed
    period: float
    step: float
    outputs: TransientOutputs
    samples: int
    tolerance: float = _NO_LIMIT

    @cached_property
    def _run(self) -> Integration:
        interval = self.period / self.samples
        settings = TransientSettings(self.period, 0.0, interval, self.step, tolerance=self.tolerance)
        profile = SpeedProfile.steady()
        stepper = NewmarkStepper(self.followed.system, settings, self.outputs, profile)
        return Integration(stepper, settings, profile, _ALL_AT_ONCE)

    def begin(self) -> Checkpoint:
        """Return static equilibrium, in which free motions coast under harmonic loads."""
        return self._run.start(None)

    def __call__(
        self, displacement: FloatArray | None = None, velocity: FloatArray | None = None
    ) -> tuple[Checkpoint, Samples]:
        """Integrate from a state, by default static equilibrium; the state after the period, and the samples."""
        run = self._run
        state = run.start(None if displacement is None or velocity is None else (displacement, velocity))
        samples = empty_samples(run.arrays, 0.0, self.period / self.samples, 0, self.samples)
        for number in range(len(run.ends) - 1):
            state = run.through(number, state, samples, lambda _: None)
        return state, samples


class _States:
    """States as vectors (q, v / w), without motions that nothing resists; w is the fastest excitation's [rad/s]."""

    def __init__(self, system: CoupledSystem, period: float, rate_unit: float) -> None:
        self.rigid, self.period, self.unit = system.rigid_body_motions[0], period, rate_unit

    def joined(self, displacement: FloatArray, velocity: FloatArray) -> FloatArray:
        """State of a motion."""
        return np.concatenate([displacement, velocity / self.unit])

    def parted(self, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Motion of a state."""
        half = len(state) // 2
        return state[:half].copy(), self.unit * state[half:]

    def vibration(self, samples: Samples) -> float:
        """Size of the vibration over a period, in the norm of states."""
        ranges = [np.ptp(samples.displacement, axis=0), np.ptp(samples.velocity, axis=0) / self.unit]
        return 0.5 * float(np.linalg.norm(np.concatenate(ranges))) or 1e-300

    def held(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """State after a period without the place of free motions, and without their mean rate over the period."""
        (first, _), (last, rates) = self.parted(before), self.parted(after)
        drift = self.rigid.T @ (last - first) / self.period
        return self.joined(last - self.rigid @ (self.rigid.T @ last), rates - self.rigid @ drift)


def settled_response(
    system: CoupledSystem,
    *,
    closure: float = CLOSURE,
    step_tolerance: float = STEP_TOLERANCE,
    near: SettledMotion | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> SettledMotion:
    """Find the periodic motion in which a machine with turning carriers settles.

    Parameters
    ----------
    system : CoupledSystem
    closure : float
        Largest closure error, over the size of the vibration.
    step_tolerance : float
        Local error of a step, relative, that sets the step.
    near : SettledMotion, optional
        Motion of the same machine at a speed nearby, from which the search begins with as many steps a period; by
        default static equilibrium.
    progress : callable
        Called with an estimate of the finished part, from 0 to 1.

    Raises
    ------
    CouplingError
        Where the excitations and the turns of the carriers have no common period.
    PeriodicError
        Where that is too long, bearings are nonlinear, or the motion does not settle.
    """
    followed = condensed(with_static_attachments(system))
    period, fastest = _period(system)
    size = followed.system.size
    outputs = TransientOutputs(np.eye(size), np.eye(size), np.zeros((0, size)))
    samples = max(_LEAST_SAMPLES, int(np.ceil(period * max(least_sampling_rate(system)[0], _PER_CYCLE * fastest))))
    first = PeriodMap(followed, period, period / _LEAST_STEPS, outputs, samples, tolerance=step_tolerance)
    states = _States(followed.system, period, 2.0 * np.pi * fastest)
    if near is None or near.turn.followed.system.size != size:
        begin = first.begin()
        end, _ = first()
        turn = replace(first, step=end.smallest, tolerance=_NO_LIMIT)
        at = states.joined(begin.q, begin.v)
    else:
        slower = period / near.period
        turn = replace(first, step=near.turn.step * slower, tolerance=_NO_LIMIT)
        at = states.joined(near.start[0], near.start[1] / slower)
    at, sought = states.held(at, at), list[tuple[FloatArray, FloatArray]]()
    while True:
        try:
            end, found = turn(*states.parted(at))
        except TransientError as error:
            raise PeriodicError(f"no motion that repeats was found: {error}") from error
        after = states.held(at, states.joined(end.q, end.v))
        sought.append((at, after))
        scale = states.vibration(found)
        residual = float(np.linalg.norm(after - at)) / scale
        if residual <= closure:
            break
        progress(min(0.99, max(0.0, float(np.log(residual) / np.log(closure)))))
        if len(sought) == _MOST_PERIODS:
            raise PeriodicError(
                f"the motion does not repeat after {_MOST_PERIODS} periods of {period:.4g} s: it closes to "
                f"{residual:.1e} of its vibration, expected {closure:.0e}; it may be one of several periods, or "
                "chaotic: integrate in time (`run`)"
            )
        at = _next(sought[-_REMEMBERED - 1 :])
    finer, _ = replace(turn, step=0.5 * turn.step)(*states.parted(at))
    refined = states.held(at, states.joined(finer.q, finer.v))
    start = states.parted(at)
    return SettledMotion(
        system=system,
        period=period,
        displacement=followed.recovery @ start[0],
        velocity=followed.recovery @ start[1],
        floquet=_multipliers(_Monodromy(turn, states, at, found), progress),
        residual=residual,
        error=float(np.linalg.norm(refined - after)) / scale,
        elements=end.steps,
        newton_steps=len(sought),
        mean_force=end.contact_totals[:, IMPULSE] / period,
        peak_force=end.contact_totals[:, PEAK],
        mean_compression=found.compression.mean(axis=0),
        rms_compression=found.compression.std(axis=0),
        contact_loss=end.contact_totals[:, APART] / period,
        turn=turn,
        start=start,
    )


def _period(system: CoupledSystem) -> tuple[float, float]:
    """Return the common period of excitations and turns [s], and the highest of their frequencies [Hz]."""
    if system.nonlinear:
        raise PeriodicError(
            "the periodic response does not know nonlinear bearings, whose rolling elements pass at rates of their "
            "own; take them linear, or integrate in time until the motion is steady (`run`)"
        )
    period = common_period(system)
    fastest = max([*driving_frequencies(system).values(), 1.0 / period])
    if period * fastest > _MOST_CYCLES:
        raise PeriodicError(
            f"the excitations and the turns of the carriers repeat together after {period:.4g} s, "
            f"{period * fastest:.0f} cycles of the fastest one; expected at most {_MOST_CYCLES}: leave out runout, "
            "unbalance or pitch errors of single shafts, or integrate in time (`run`)"
        )
    return period, fastest


def _differences(sought: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Differences of neighbouring states, in columns of length one, and those of the states after a period."""
    before, after = (np.diff(np.array(states), axis=0).T for states in zip(*sought, strict=True))
    lengths = np.linalg.norm(before, axis=0)
    lengths[lengths == 0.0] = 1.0
    return before / lengths, after / lengths


def _next(sought: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
    """Next state of Anderson's iteration."""
    at, after = sought[-1]
    if len(sought) == 1:
        return after
    before, moved = _differences(sought)
    factors = np.linalg.lstsq(moved - before, after - at, rcond=_INDEPENDENT)[0]
    return np.asarray(after - moved @ factors)


class _Monodromy:
    """Products of the monodromy of a periodic motion, in coordinates whose length is that of energy.

    With the modes φ of the system about its mean load and their frequencies ω a state is (√(ω² + ω_T²) φᵀq, φᵀv), ω_T
    the frequency of the period.
    """

    def __init__(self, turn: PeriodMap, states: _States, at: FloatArray, found: Samples) -> None:
        system = turn.followed.system
        stiffness = linear_matrices(system, mean_contact(system))[0]
        squares, self.modes = np.linalg.eigh(0.5 * (stiffness + stiffness.T))
        self.weights = np.sqrt(np.maximum(squares, 0.0) + (2.0 * np.pi / turn.period) ** 2)
        self.states, self.at = states, at
        ranges = np.ptp(found.displacement, axis=0), np.ptp(found.velocity, axis=0)
        self.size = _DISTURBANCE * 0.5 * float(np.linalg.norm(self._energetic(*ranges))) or _DISTURBANCE
        nothing = np.zeros((0, system.size))
        # Samples have events of their own, so that a state after a period is a smooth function of the one before.
        self.turn = replace(turn, outputs=TransientOutputs(nothing, nothing, nothing))

    def product(self, step: float) -> tuple[Product, int]:
        """Product by differences of motions with a largest step [s], and the number of steps in a period."""
        turn = replace(self.turn, step=step)

        def after(state: FloatArray) -> tuple[FloatArray, int]:
            end, _ = turn(*self.states.parted(state))
            return self._in_energy(self.states.held(state, self.states.joined(end.q, end.v))), end.steps

        undisturbed, steps = after(self.at)

        def product(disturbance: FloatArray, sense: float) -> FloatArray:
            size = sense * self.size
            return (after(self.at + size * self._in_states(disturbance))[0] - undisturbed) / size

        return product, steps

    def random(self) -> FloatArray:
        """Disturbance with a part of all others that meet anything, of about the same energy."""
        both = np.random.default_rng(_SEED).standard_normal(2 * len(self.weights))
        displacement, velocity = self.states.parted(self._in_states(both))
        alone = _uncoupled(self.turn.followed.system)
        displacement[alone] = velocity[alone] = 0.0
        state = self.states.joined(displacement, velocity)
        return self._in_energy(self.states.held(state, state))

    def _energetic(self, displacement: FloatArray, velocity: FloatArray) -> FloatArray:
        return np.concatenate([self.weights * (self.modes.T @ displacement), self.modes.T @ velocity])

    def _in_energy(self, state: FloatArray) -> FloatArray:
        return self._energetic(*self.states.parted(state))

    def _in_states(self, energetic: FloatArray) -> FloatArray:
        displacement, velocity = np.split(energetic, 2)
        return self.states.joined(self.modes @ (displacement / self.weights), self.modes @ velocity)


def _uncoupled(system: CoupledSystem) -> npt.NDArray[np.bool_]:
    """Whether each coordinate is alone, as residual modes of shafts that no force moves: undamped, its motion stays."""
    stiffness = system.mean_stiffness
    sizes = np.sqrt(np.abs(np.diag(stiffness)))
    scaled = np.abs(stiffness) / np.maximum(np.outer(sizes, sizes), 1e-300)
    beside = [scaled, np.abs(system.damping) / max(float(np.abs(system.damping).max(initial=0.0)), 1e-300)]
    turning = [one.turning for one in system.linear] + [one.turning for one in system.contacts]
    ways = [way for parts in turning for part in parts for way in (part.cosine, part.sine)]
    moved = [np.abs(np.reshape(way, (system.size, -1))) for way in ways]
    coupled = np.any([np.max(matrix - np.diag(np.diag(matrix)), axis=1) > _UNCOUPLED for matrix in beside], axis=0)
    for directions in moved:
        coupled |= np.any(directions > _UNCOUPLED * directions.max(initial=0.0), axis=1)
    return np.asarray(~coupled)


def _multipliers(monodromy: _Monodromy, progress: Callable[[float], None]) -> FloquetMultipliers:
    """Leading multipliers of a periodic motion."""
    step = monodromy.turn.step
    (coarse, few), (fine, many) = monodromy.product(_LONG_STEPS * step), monodromy.product(step)
    found = leading_multipliers(
        monodromy.random(), coarse, fine, ratio=max(many / few, _LEAST_RATIO), progress=progress
    )
    return FloquetMultipliers(found.values, monodromy.turn.period, found.errors)
