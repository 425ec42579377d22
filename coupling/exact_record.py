"""What an exact march leaves behind: states, samples and the figures of its proof, from the trace of its elements."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts, Samples
from coupling.marching import Checkpoint
from coupling.periodic.arrays import Steps, Trace
from coupling.periodic.collocation import ORDER, PLACES, weights_to
from coupling.periodic.element_work import element_work
from coupling.periodic.linear_part import LinearPart
from coupling.settings import TransientOutputs

FloatArray = npt.NDArray[np.float64]


class FreeMotion(NamedTuple):
    """Motions that nothing resists, beside the reference's own: uniformly accelerated from a time on."""

    time: float  # [s]
    place: FloatArray  # (r,)
    rate: FloatArray  # (r,)
    acceleration: FloatArray  # (r,)

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and rates, shapes (t, r)."""
        after = (times - self.time)[:, None]
        return (
            self.place + after * (self.rate + 0.5 * self.acceleration * after),
            self.rate + self.acceleration * after,
        )


class Record:
    """Rows that turn amplitudes into what is recorded; n coordinates, M amplitudes."""

    def __init__(self, part: LinearPart, outputs: TransientOutputs, contacts: Contacts) -> None:
        self.part, self.contacts, system = part, contacts, part.system
        modes = len(part.eigenvalues)
        # Loads ride along as the reference's own response does: constant ones last, harmonic ones at its frequencies.
        self.load = np.zeros((system.size, 2 * len(part.reference.eigenvalue)))
        self.load[:, -2] = system.load
        for one in system.harmonic_loads:
            if one.frequency == 0.0:
                self.load[:, -2] += one.amplitude.real
                continue
            column = 2 * (modes + int(np.searchsorted(part.frequencies, one.frequency)))
            self.load[:, column] += one.amplitude.real
            self.load[:, column + 1] -= one.amplitude.imag
        moving = self.load - system.stiffness @ part.displacement_rows - system.damping @ part.velocity_rows
        self._displacement = outputs.displacement @ part.displacement_rows, outputs.displacement @ part.rigid
        self._velocity = outputs.velocity @ part.velocity_rows, outputs.velocity @ part.rigid
        self._acceleration = outputs.acceleration @ moving, outputs.acceleration @ system.contact_directions
        # Powers are taken in the principal directions of what damps: the squares of the rates there give the loss.
        self._loss, directions = np.linalg.eigh(0.5 * (system.damping + system.damping.T))
        self._principal = directions.T @ part.velocity_rows, directions.T @ part.rigid
        self._pushing = directions.T @ self.load[:, 2 * modes :]
        skew = directions.T @ (system.stiffness - system.stiffness.T) @ part.displacement_rows
        self._skew = skew if np.abs(skew).max(initial=0.0) > 1e-12 * np.abs(moving).max(initial=0.0) else None

    def free_motion(self, state: Checkpoint) -> FreeMotion:
        """From a state on."""
        rigid = self.part.rigid
        q, v = self.part.own_response(state.time)
        return FreeMotion(state.time, rigid.T @ (state.q - q), rigid.T @ (state.v - v), rigid.T @ self.load[:, -2])

    def motion(self, z: FloatArray, free: FreeMotion, time: float) -> tuple[FloatArray, FloatArray]:
        """All coordinates and rates at a time, shape (n,) each."""
        place, rate = free.at(np.array([time]))
        rigid = self.part.rigid
        return self.part.displacement_rows @ z + rigid @ place[0], self.part.velocity_rows @ z + rigid @ rate[0]

    def write(self, trace: Trace, free: FreeMotion, times: FloatArray, samples: Samples, first: int) -> None:
        """Samples at ascending times of a trace, from a number on."""
        from coupling.periodic.dense import amplitudes_at, forces_at

        reference = self.part.reference
        rows = slice(first - samples.offset, first - samples.offset + len(times))
        z = amplitudes_at(reference, trace, times)
        place, rate = free.at(times)
        samples.displacement[rows] = z @ self._displacement[0].T + place @ self._displacement[1].T
        samples.velocity[rows] = z @ self._velocity[0].T + rate @ self._velocity[1].T
        delta, slip = z @ reference.displacement.T, z @ reference.rate.T
        force = np.zeros_like(delta)
        forces_at(self.contacts, times, delta, slip, element_work(0, 0, delta.shape[1]), force)
        samples.compression[rows], samples.force[rows] = delta, force
        samples.acceleration[rows] = z @ self._acceleration[0].T - force @ self._acceleration[1].T

    def add(self, state: Checkpoint, trace: Trace, steps: Steps, free: FreeMotion) -> Checkpoint:
        """The state with the work, the losses and the contacts' figures of a trace added."""
        from coupling.periodic.dense import amplitudes_within

        h = trace.size / trace.part
        weights = weights_to(trace.part) * h[:, None]
        times = trace.start[:, None] + h[:, None] * PLACES
        power = self._powers(amplitudes_within(steps, trace), times.ravel(), free)
        given, lost, kinetic = (values.reshape(weights.shape) for values in power)
        turning = self._turning(trace, times)
        # What the teeth held jumps where pairs come and go.
        held = np.concatenate([[state.stored], trace.energy[:, 1]])
        totals = state.totals + [
            np.sum(weights * given),
            np.sum(weights * (lost + trace.loss.sum(axis=2))),
            np.sum(weights * turning) + np.sum(trace.energy[:, 0] - held[:-1]),
            0.0,
            0.0,
        ]
        totals[3] = max(state.totals[3], float(kinetic.max(initial=0.0)))
        contact_totals = self.contact_figures(state.contact_totals, trace)
        return replace(state, totals=totals, stored=float(held[-1]), contact_totals=contact_totals)

    def _powers(self, z: FloatArray, times: FloatArray, free: FreeMotion) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of the loads, lost without the teeth's, and the kinetic energy, shape (t,) each."""
        v = z @ self._principal[0].T + free.at(times)[1] @ self._principal[1].T
        square = v * v
        lost = square @ self._loss
        if self._skew is not None:
            lost += 0.5 * np.einsum("ti,ti->t", v, z @ self._skew.T)
        given = np.einsum("ti,ti->t", z[:, -self._pushing.shape[1] :] @ self._pushing.T, v)
        return given, lost, 0.5 * square.sum(axis=1)

    def _turning(self, trace: Trace, times: FloatArray) -> FloatArray:
        """Power of the turning teeth on the contacts [W], shape (e, s): ∂U/∂p p' - f e'."""
        total = np.zeros_like(times)
        for k, contact in enumerate(self.part.system.contacts):
            total += contact.rate * trace.turning[:, :, k]
            for amplitude, frequency, phase in contact.errors:
                slip = -amplitude * frequency * np.sin(frequency * times + phase)
                total -= trace.force[:, :, k] * slip
        return total

    @staticmethod
    def contact_figures(before: FloatArray, trace: Trace) -> FloatArray:
        """Impulse, time apart, largest force and last touch, shape (c, 4), with those of a trace."""
        figures = before.copy()
        weights = weights_to(trace.part) * (trace.size / trace.part)[:, None]
        figures[:, 0] += np.einsum("es,esc->c", weights, trace.force)
        # Flanks that touch without a force, where the damping would pull, count as apart; switches bound such elements.
        touching = np.any(trace.force > 0.0, axis=1)
        figures[:, 1] += trace.size @ ~touching
        peaks = trace.force.reshape(len(weights) * ORDER, len(figures))
        figures[:, 2] = np.maximum(figures[:, 2], peaks.max(axis=0, initial=0.0))
        ends = np.where(touching, (trace.start + trace.size)[:, None], 0.0)
        figures[:, 3] = np.where(touching.any(axis=0), ends.max(axis=0, initial=0.0), figures[:, 3])
        return figures
