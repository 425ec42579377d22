"""Record of exponential collocation: states, samples and energy balance, from the trace of its elements."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from coupling.kernel_arrays import Contacts, Samples
from coupling.march_run import Checkpoint
from coupling.periodic.arrays import FreeMotion, Powers, Steps, Trace, powers_room
from coupling.periodic.collocation import ORDER
from coupling.periodic.element_work import element_work
from coupling.periodic.linear_part import LinearPart
from coupling.settings import TransientOutputs

FloatArray = npt.NDArray[np.float64]


class CollocationRecord:
    """Output rows over the amplitudes; n coordinates, M amplitudes."""

    def __init__(self, part: LinearPart, outputs: TransientOutputs, contacts: Contacts) -> None:
        self.part, self.contacts, system = part, contacts, part.system
        modes, count = len(part.eigenvalues), len(part.reference.eigenvalue)
        # Loads are amplitudes too, as the reference's own response is: constant ones last, harmonic ones at its
        # frequencies.
        load = np.zeros((system.size, 2 * count))
        load[:, count - 1] = system.load
        for one in system.harmonic_loads:
            if one.frequency == 0.0:
                load[:, count - 1] += one.amplitude.real
                continue
            column = modes + int(np.searchsorted(part.frequencies, one.frequency))
            load[:, column] += one.amplitude.real
            load[:, count + column] -= one.amplitude.imag
        self._constant = load[:, count - 1]
        moving = load - system.stiffness @ part.displacement_rows - system.damping @ part.velocity_rows
        self._displacement = outputs.displacement @ part.displacement_rows, outputs.displacement @ part.rigid
        self._velocity = outputs.velocity @ part.velocity_rows, outputs.velocity @ part.rigid
        self._acceleration = outputs.acceleration @ moving, outputs.acceleration @ system.contact_directions
        self._powers = self._rows_of_powers(load)
        self._room = powers_room(2 * count + part.rigid.shape[1], system.size, ORDER)

    def _rows_of_powers(self, load: FloatArray) -> Powers:
        part, system = self.part, self.part.system
        # In the principal directions of the damping matrix the squares of the rates give the loss.
        loss, directions = np.linalg.eigh(0.5 * (system.damping + system.damping.T))
        forces = system.stiffness @ part.displacement_rows
        skew = (system.stiffness - system.stiffness.T) @ part.displacement_rows
        if np.abs(skew).max(initial=0.0) <= 1e-12 * np.abs(forces).max(initial=0.0):
            skew = skew[:, :0]
        riding = np.flatnonzero(np.any(load, axis=0))
        rows = np.hstack([part.velocity_rows, part.rigid]), skew, load[:, riding]
        rate, skew, pushing = (np.ascontiguousarray(row.T @ directions) for row in rows)
        return Powers(rate, loss, skew, riding, pushing)

    def free_motion(self, state: Checkpoint) -> FreeMotion:
        """Rigid-body motion from a state on."""
        rigid = self.part.rigid
        q, v = self.part.own_response(state.time)
        return FreeMotion(
            np.array([state.time]), rigid.T @ (state.q - q), rigid.T @ (state.v - v), rigid.T @ self._constant
        )

    def motion(self, z: FloatArray, free: FreeMotion, time: float) -> tuple[FloatArray, FloatArray]:
        """Coordinates and their rates at a time, shape (n,) each."""
        place, rate = free.at(np.array([time]))
        rigid = self.part.rigid
        return self.part.displacement_rows @ z + rigid @ place[0], self.part.velocity_rows @ z + rigid @ rate[0]

    def write(self, trace: Trace, free: FreeMotion, times: FloatArray, samples: Samples, first: int) -> None:
        """Write the samples at ascending times of a trace, from number ``first`` on."""
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
        """The state with the work, the losses and the contact figures of a trace added."""
        from coupling.record_kernels import add_contacts, add_powers

        totals, figures = state.totals.copy(), state.contact_totals.copy()
        excess = trace.excess.reshape(len(trace.start), ORDER * trace.excess.shape[2])
        add_powers(steps, trace, excess, self._powers, free, self._room, totals)
        stored = add_contacts(trace, self.contacts, state.stored, self._room.weights[0], totals, figures)
        return replace(state, totals=totals, stored=float(stored), contact_totals=figures)

    def contact_figures(self, before: Checkpoint, trace: Trace) -> FloatArray:
        """Impulse, time apart, largest force and last touch, shape (c, 4), with those of a trace added."""
        from coupling.record_kernels import add_contacts

        figures = before.contact_totals.copy()
        add_contacts(trace, self.contacts, before.stored, self._room.weights[0], before.totals.copy(), figures)
        return figures
