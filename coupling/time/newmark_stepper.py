"""Newmark's method as a stepper: chunks of steps by the compiled kernel, and their local error.

The local error of Newmark's method is that of its period: one oscillation of circular frequency w advances by
(w h)²/12 too little for each radian. Its mean over the moving coordinates is measured by the second difference of the
acceleration,

    error = |a₁ - 2 a₀ + a₋₁| / (12 |a|).

Residual coordinates of the housing have no part in this measure: they stand for static compliance, and their own
frequencies are not meant to be followed. The stiffest of them are condensed, see
:mod:`gearwhine.coupling.time.condensation`.
"""

from dataclasses import replace

import numpy as np

from gearwhine.coupling.connector_forces.kernel_arrays import LAST_TOUCH, Samples, Segments
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.time.integration import Attempt, Checkpoint, timed_amplitude
from gearwhine.coupling.time.settings import TransientOutputs, TransientSettings
from gearwhine.coupling.time.step_matrices import StepCache, cut, kernel_arrays, scratch_room
from gearwhine.coupling.time.turning_directions import with_own_laws
from gearwhine.numerics.arrays import FloatArray

_SEGMENTS_PER_CHUNK = 48  # number of stretches between two checks of the error
_GROW_TO = 0.85  # part of the tolerance up to which steps grow


class NewmarkStepper:
    """Newmark's method, a :class:`gearwhine.coupling.time.integration.Stepper`.

    Its kernel is :mod:`gearwhine.coupling.time.newmark`.
    """

    steps_in_one = 1
    order = 2.0
    levels = 8  # a coarser ladder would hold steps far below the tolerance
    too_fine = "steps below {step:.1e} s; raise the tolerance or lower the frequency limit of a shaft"

    def __init__(
        self, system: CoupledSystem, settings: TransientSettings, outputs: TransientOutputs, profile: SpeedProfile
    ) -> None:
        self.system, self._profile = system, profile
        self.arrays = kernel_arrays(system, outputs, settings.beta, settings.gamma)
        self.grow_to = _GROW_TO * settings.tolerance
        self._cache = StepCache(self.arrays, profile)
        self._pushing = np.linalg.norm(system.load) + np.linalg.norm(timed_amplitude(system))
        self._quiet = 0.0

    def begin_block(self, state: Checkpoint, bounds: FloatArray, samples: Samples, *, compiles: bool) -> None:
        """Prepare for a block."""
        if compiles:
            self._run(state, cut(self._cache, self._profile, bounds[:1], 1.0), samples)
        # Below this an acceleration is rounding, and its curvature means nothing.
        self._quiet = (1e-9 * float(np.linalg.norm(self.system.stiffness @ state.q) + self._pushing)) ** 2

    def chunk(self, bounds: FloatArray, step: float) -> int:
        """Return the number of stretches between ``bounds`` to attempt at once."""
        return min(_SEGMENTS_PER_CHUNK, len(bounds) - 1)

    def attempt(self, state: Checkpoint, bounds: FloatArray, step: float, samples: Samples) -> Attempt:
        """Step through the stretches between ``bounds``, at least two steps each."""
        segments = cut(self._cache, self._profile, bounds, step)
        self._after, curvature, acceleration = self._run(state, segments, samples)
        steps, error = int(segments.steps.sum()), np.inf
        if np.isfinite(curvature):
            error = float(np.sqrt(curvature / (acceleration + self._quiet * steps + 1e-300))) / 12.0
        smallest = float(((segments.end - segments.start) / segments.steps).min())
        return Attempt(self._after.q, self._after.v, error, steps, smallest)

    def accept(self, state: Checkpoint, done: float, samples: Samples) -> Checkpoint:
        """Return the state after the last attempt: the kernel has counted work and contacts and written the samples."""
        return self._after

    def last_touch(self, state: Checkpoint, begin: float, done: float) -> tuple[FloatArray, float]:
        """Last touches up to the start of the chunk that diverged."""
        return state.contact_totals[:, LAST_TOUCH], begin

    def _run(self, state: Checkpoint, segments: Segments, samples: Samples) -> tuple[Checkpoint, float, float]:
        """Run the kernel on copies of the arrays that it changes."""
        from gearwhine.coupling.time.newmark import newmark_steps

        q, v, totals, contacts = (part.copy() for part in (state.q, state.v, state.totals, state.contact_totals))
        arrays = self.arrays
        bearings = with_own_laws(arrays.bearings) if arrays.turning.speed_ratios.size > 0 else arrays.bearings
        head = (
            q, v, arrays.dynamics, arrays.contacts, arrays.turning, bearings, self._cache.matrices, segments,
            arrays.outputs,
        )  # fmt: skip
        sample, stored, curvature, acceleration, unsettled = newmark_steps(
            *head, samples, state.sample, state.stored, totals, contacts, scratch_room(arrays)
        )
        moved = replace(state, q=q, v=v, totals=totals, contact_totals=contacts, sample=sample, stored=stored)
        return replace(moved, unsettled=state.unsettled + unsettled), curvature, acceleration
