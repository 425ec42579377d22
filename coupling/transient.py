"""The transient: from static equilibrium through a time span, with events, error control and an energy balance.

Time is cut at every event (a pair of teeth entering or leaving contact), so no step crosses a jump of the mesh
stiffness. The stretches between are cut into equal steps. The local error of Newmark's method is that of its
period: one oscillation of circular frequency w advances by (w h)²/12 too little for each radian it turns. Its
mean over what is moving is measured by the second difference of the acceleration,

    error = |a₁ - 2 a₀ + a₋₁| / (12 |a|),

and stretches are repeated with finer steps until it is below the tolerance. Residual coordinates of the housing have
no part in this measure: they stand for static compliance, and their own frequencies are not meant to be followed. The
stiffest of them are not marched at all, see :mod:`coupling.condensation`.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from coupling.condensation import condensed, highest_frequency
from coupling.errors import CouplingError, TransientError
from coupling.statics import static_equilibrium
from coupling.step import KernelArrays, StepCache, cut, empty_samples, kernel_arrays
from coupling.system import CoupledSystem

FloatArray = npt.NDArray[np.float64]

_POINTS_PER_PERIOD = 6  # of the highest coordinate; what moves much gets more, by the tolerance
_SEGMENTS_PER_CHUNK = 24  # stretches between two looks at the error
_STEPS_PER_SEGMENT = 64  # where no event cuts the time
_SAME_TIME = 1e-6  # part of the coarsest step within which two events are one
_FINEST_LEVEL = 24  # 4096 times finer than the coarsest step
_ROUNDING = 1e-9  # part of the energy held that a balance cannot speak of
ENERGY_BOUND = 1e-2
_RUNAWAY = 1e4  # times the motion at rest: beyond, the machine is unstable, not lively


@dataclass(frozen=True)
class TransientSettings:
    """How far and how finely to march.

    Attributes
    ----------
    duration : float
        [s], from static equilibrium at t = 0.
    record_from : float
        Samples and contact figures start here [s].
    sample_interval : float
        [s]; outputs are written at this even spacing whatever the steps.
    largest_step : float
        [s].
    tolerance : float
        Of the error measure above.
    beta, gamma : float
        Newmark's parameters; 1/4 and 1/2 are the only pair that neither gains nor loses energy.
    """

    duration: float
    record_from: float
    sample_interval: float
    largest_step: float
    tolerance: float = 1e-4
    beta: float = 0.25
    gamma: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.record_from < self.duration < np.inf:
            raise CouplingError(f"recording from {self.record_from} s of {self.duration} s; expected a part of it")
        for what in ("sample_interval", "largest_step", "tolerance", "beta"):
            value = getattr(self, what)
            if not 0.0 < value < np.inf:
                raise CouplingError(f"{what} of {value}; expected a positive number")


@dataclass(frozen=True)
class TransientOutputs:
    """Rows to record: each a linear combination of the n coordinates.

    Attributes
    ----------
    displacement, velocity, acceleration : ndarray, shapes (k, n)
        What is taken of the coordinates, of their rates, and of their accelerations.
    """

    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class EnergyBalance:
    """Where the energy went [J].

    Attributes
    ----------
    change : float
        Of kinetic energy, springs and teeth together.
    loads : float
        Work of the loads.
    lost : float
        To damping.
    teeth : float
        Work of the turning teeth on the contacts: their stiffness and shape change under load.
    scale : float
        The largest of these, of the swing of the energy held, and of the kinetic energy at any step.
    """

    change: float
    loads: float
    lost: float
    teeth: float
    scale: float

    @property
    def error(self) -> float:
        """What does not add up, as a part of the scale."""
        return abs(self.change - self.loads + self.lost - self.teeth) / self.scale if self.scale > 0.0 else 0.0


@dataclass(frozen=True)
class TransientResult:
    """Histories at even spacing, and the proof of them; s samples, c contacts.

    Attributes
    ----------
    times : ndarray, shape (s,)
        [s].
    displacement, velocity, acceleration : ndarray, shapes (s, k)
        The rows asked for.
    compression : ndarray, shape (s, c)
        δ of each contact [m].
    force : ndarray, shape (s, c)
        [N].
    mean_force, peak_force : ndarray, shape (c,)
        Over the recorded span, from every step [N].
    contact_loss : ndarray, shape (c,)
        Part of the recorded span in which the flanks were apart.
    energy : EnergyBalance
        Over the whole span.
    steps, rejected : int
        Steps taken and steps repeated.
    smallest_step : float
        [s].
    error : float
        Largest of the accepted error measures.
    seconds : float
        Time taken by the stepping, compilation apart [s].
    """

    times: FloatArray
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    compression: FloatArray
    force: FloatArray
    mean_force: FloatArray
    peak_force: FloatArray
    contact_loss: FloatArray
    energy: EnergyBalance
    steps: int
    rejected: int
    smallest_step: float
    error: float
    seconds: float


def simulate(
    system: CoupledSystem,
    settings: TransientSettings,
    outputs: TransientOutputs,
    *,
    initial: tuple[FloatArray, FloatArray] | None = None,
    progress: Callable[[float], None] = lambda fraction: None,
) -> TransientResult:
    """March the coupled system through time.

    Parameters
    ----------
    system : CoupledSystem
    settings : TransientSettings
    outputs : TransientOutputs
    initial : tuple of ndarray, optional
        Coordinates and rates at t = 0, shape (n,) each; by default static equilibrium at rest.
    progress : callable
        Told the finished part of the span, from 0 to 1.

    Raises
    ------
    TransientError
        Where the motion diverges, the step would have to be absurdly small, or the energies do not balance.
    """
    from coupling.contact_kernels import contact_energy
    from coupling.newmark import march

    followed = condensed(system)
    if followed.system is not system:
        system, rows = followed.system, (outputs.displacement, outputs.velocity, outputs.acceleration)
        outputs = TransientOutputs(*(row @ followed.recovery for row in rows))
        initial = None if initial is None else (initial[0][followed.kept], initial[1][followed.kept])
    arrays = kernel_arrays(system, outputs, settings.beta, settings.gamma)
    cache = StepCache(system, settings.beta, settings.gamma)
    q, v = initial or (static_equilibrium(system), np.zeros(system.size))
    samples = empty_samples(system, outputs, settings)
    base = min(settings.largest_step, _resolving_step(system))
    bounds = _boundaries(system, settings, base)
    # An event may stand for the start of the record, when rounding alone holds the two apart.
    first_record = int(np.searchsorted(bounds, settings.record_from - _SAME_TIME * base))
    # Forces too small to see: below this an acceleration is rounding, and its curvature means nothing.
    quiet = (1e-9 * float(np.linalg.norm(system.stiffness @ q) + np.linalg.norm(system.load))) ** 2

    state = _State(q.astype(np.float64), v.astype(np.float64), 0, 0.0, np.zeros(4), np.zeros((len(system.contacts), 3)))
    # Compiled before the clock starts.
    march(*state.copy().arguments(arrays, cache.matrices(), cut(cache, bounds[:1], 1.0), samples))
    state.stored = contact_energy(arrays.contacts, state.q, state.v, 1e-7 * float(bounds[1] - bounds[0]))
    start_energy = highest = _spring_energy(system, state.q, state.v) + state.stored
    lowest = start_energy
    position, level, steps, rejected, unsettled = 0, 0, 0, 0, 0
    worst, smallest = 0.0, base

    # Nothing that stays together moves so much further than its loads press it.
    rest = np.abs(state.q).max() + np.abs(_resting(system)).max() + float(np.linalg.norm(state.v)) * settings.duration
    bound = _RUNAWAY * float(rest) if rest > 0.0 else np.inf

    clock = time.perf_counter()
    while position < len(bounds) - 1:
        last = min(position + _SEGMENTS_PER_CHUNK, len(bounds) - 1)
        if position < first_record < last:
            last = first_record
        segments = cut(cache, bounds[position : last + 1], base * 2.0 ** (-0.5 * level))
        trial = state.copy()
        if position == first_record:
            trial.contact_totals[:] = 0.0
        trial.sample, trial.stored, curvature, acceleration, open_steps = march(
            *trial.arguments(arrays, cache.matrices(), segments, samples)
        )
        n_steps = int(segments.steps.sum())
        if not np.isfinite(curvature) or not float(np.abs(trial.q).max()) < bound:
            raise TransientError(
                f"the motion diverged after t = {bounds[position]:.6g} s; the linear part may be unstable: look for "
                "negative damping ratios among the coupled modes"
            )
        error = float(np.sqrt(curvature / (acceleration + quiet * n_steps + 1e-300))) / 12.0
        if error > settings.tolerance:
            rejected += n_steps
            level += max(1, int(np.ceil(np.log2(error / settings.tolerance))))
            if level > _FINEST_LEVEL:
                raise TransientError(
                    f"after t = {bounds[position]:.6g} s the tolerance {settings.tolerance:g} asks for steps below "
                    f"{base * 2.0 ** (-0.5 * _FINEST_LEVEL):.1e} s; raise the tolerance or keep fewer high modes"
                )
            continue
        state, position = trial, last
        energy = _spring_energy(system, state.q, state.v) + state.stored
        highest, lowest = max(highest, energy), min(lowest, energy)
        steps, unsettled, worst = steps + n_steps, unsettled + open_steps, max(worst, error)
        smallest = min(smallest, float(((segments.end - segments.start) / segments.steps).min()))
        if error < settings.tolerance / 3.0 and level > 0:
            level -= 1
        progress(float(bounds[position] / settings.duration))
    seconds = time.perf_counter() - clock

    # What rounding can do to the energy held is beyond any balance.
    held = max(highest - lowest, _ROUNDING * max(abs(highest), abs(lowest)))
    balance = _balance(energy - start_energy, state.totals, held)
    if balance.error > ENERGY_BOUND or unsettled > 0.01 * steps:
        raise TransientError(
            f"the energies do not balance: {100 * balance.error:.2g} % is missing, and {unsettled} of {steps} steps "
            "left the teeth's forces unsettled; lower the tolerance"
        )
    span = settings.duration - settings.record_from
    return TransientResult(
        times=settings.record_from + settings.sample_interval * np.arange(len(samples.force), dtype=np.float64),
        displacement=samples.displacement,
        velocity=samples.velocity,
        acceleration=samples.acceleration,
        compression=samples.compression,
        force=samples.force,
        mean_force=state.contact_totals[:, 0] / span,
        peak_force=state.contact_totals[:, 2],
        contact_loss=state.contact_totals[:, 1] / span,
        energy=balance,
        steps=steps,
        rejected=rejected,
        smallest_step=smallest,
        error=worst,
        seconds=seconds,
    )


@dataclass
class _State:
    """Where the march stands; a chunk works on a copy and replaces it when accepted."""

    q: FloatArray
    v: FloatArray
    sample: int
    stored: float
    totals: FloatArray
    contact_totals: FloatArray

    def copy(self) -> "_State":
        return _State(
            self.q.copy(), self.v.copy(), self.sample, self.stored, self.totals.copy(), self.contact_totals.copy()
        )

    def arguments(self, arrays: KernelArrays, matrices: Any, segments: Any, samples: Any) -> tuple[Any, ...]:
        head = (self.q, self.v, arrays.dynamics, arrays.contacts, matrices, segments, arrays.outputs, samples)
        return (*head, self.sample, self.stored, self.totals, self.contact_totals)


def _resting(system: CoupledSystem) -> FloatArray:
    """Coordinates that the harmonic loads' amplitudes would hold if they stood still, shape (n,)."""
    loads = sum((np.abs(load.amplitude) for load in system.harmonic_loads), np.zeros(system.size))
    stiffness = np.abs(np.diag(system.mean_stiffness()))
    return np.asarray(loads / np.where(stiffness > 0.0, stiffness, np.inf))


def _spring_energy(system: CoupledSystem, q: FloatArray, v: FloatArray) -> float:
    """Kinetic energy and that of all springs but the teeth [J]."""
    return float(0.5 * v @ v + 0.5 * q @ system.stiffness @ q)


def _balance(change: float, totals: FloatArray, held: float) -> EnergyBalance:
    loads, lost, teeth, motion = (float(value) for value in totals)
    # Free vibration swaps its energy between motion and springs without any of it coming or going.
    return EnergyBalance(change, loads, lost, teeth, scale=max(abs(loads), abs(lost), abs(teeth), held, motion))


def _resolving_step(system: CoupledSystem) -> float:
    """The step that gives the highest natural frequency its least number of points a period [s]."""
    highest = highest_frequency(system)
    return 2.0 * np.pi / (highest * _POINTS_PER_PERIOD) if highest > 0.0 else np.inf


def _boundaries(system: CoupledSystem, settings: TransientSettings, base: float) -> FloatArray:
    """0, the events, the start of the record and the end, with long stretches cut evenly [s]."""
    fixed = [np.array([0.0, settings.record_from, settings.duration])]
    events = [contact.event_times(0.0, settings.duration) for contact in system.contacts]
    times: FloatArray = np.unique(np.concatenate(fixed + events))
    # Events that rounding alone holds apart are one.
    times = times[np.concatenate([[True], np.diff(times) > _SAME_TIME * base])]
    times[-1] = settings.duration
    pieces = np.maximum(np.ceil(np.diff(times) / (_STEPS_PER_SEGMENT * base)), 1.0).astype(np.int64)
    if pieces.max() == 1:
        return times
    cuts = [start + (end - start) * np.arange(n) / n for start, end, n in zip(times, times[1:], pieces, strict=False)]
    return np.concatenate([*cuts, times[-1:]])
