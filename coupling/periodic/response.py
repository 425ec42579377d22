"""Periodic response: the motion over one period, its Floquet multipliers, and its record of coordinates and contacts.

The Floquet multipliers, eigenvalues of the monodromy, decide the stability of a periodic motion: it is stable where all
are within the unit circle.

`BranchMotion` is the summary of a periodic motion on a branch: its figures, and the states at the starts of its
segments.
"""

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.collocation.arrays import MONOMIALS, ORDER, Trace, element_work, weights_to
from gearwhine.coupling.collocation.linear_part import LinearPart
from gearwhine.coupling.connector_forces.kernel_arrays import Contacts
from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.machine.coupled_system import CoupledSystem
from gearwhine.coupling.time.settings import MotionRecord, TransientOutputs

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Loss = Literal["fold", "period doubling", "Neimark-Sacker"]
Stability = Literal["stable", "unstable", "not decided"]

STABLE_WITHIN = 1e-7
"""Tolerance of a stable multiplier beyond one, for the rounding of an undamped motion."""


@dataclass(frozen=True, eq=False)
class FloquetMultipliers:
    """Eigenvalues of the monodromy, the largest first.

    Attributes
    ----------
    values : ndarray of complex, shape (2 N,)
        A disturbance along the eigenvector number i is multiplied by values[i] every period.
    period : float
        Period [s].
    errors : ndarray, shape (2 N,), optional
        Estimated error of each modulus, where they come from an iteration (then there may be fewer); by default of a
        monodromy that is known to rounding.
    """

    values: ComplexArray
    period: float
    errors: FloatArray | None = None

    @property
    def exponents(self) -> ComplexArray:
        """ln(multiplier) / period [1/s], the frequency within half the driving one; -inf for a multiplier of zero."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.values.astype(np.complex128)) / self.period)

    @property
    def largest(self) -> float:
        """Largest modulus; 0 for a system without states."""
        return float(np.abs(self.values).max(initial=0.0))

    @property
    def largest_error(self) -> float | None:
        """Estimated error of the largest modulus; None for a monodromy that is known to rounding."""
        return None if self.errors is None else float(self.errors[np.argmax(np.abs(self.values))])

    @property
    def stability(self) -> Stability:
        """``stable`` where no disturbance grows, ``unstable`` where one does, ``not decided`` within the errors."""
        if self.growing:
            return "unstable"
        if self.errors is None or np.all(np.abs(self.values) + self.errors < 1.0):
            return "stable"
        return "not decided"

    @property
    def stable(self) -> bool:
        """Whether no disturbance grows."""
        return self.stability == "stable"

    @property
    def growing(self) -> int:
        """Number of multipliers outside the unit circle, beyond their errors."""
        errors = STABLE_WITHIN if self.errors is None else self.errors
        return int(np.count_nonzero(np.abs(self.values) - errors > 1.0))

    @property
    def leaving(self) -> Loss | None:
        """Kind of instability, by the place where the largest multiplier left the unit circle; None if none did.

        At +1 the motion has a fold and jumps; at -1 a motion of twice the period replaces it; a pair elsewhere brings a
        second frequency (Neimark and Sacker).
        """
        if not self.growing:
            return None
        worst = self.values[np.argmax(np.abs(self.values))]
        if abs(worst.imag) > 1e-9 * abs(worst):
            return "Neimark-Sacker"
        return "fold" if worst.real > 0.0 else "period doubling"


def multipliers(monodromy: FloatArray, period: float) -> FloquetMultipliers:
    """Eigenvalues of a monodromy matrix."""
    values = np.linalg.eigvals(monodromy).astype(np.complex128)
    return FloquetMultipliers(values[np.argsort(-np.abs(values), kind="stable")], period)


_LOOKS = 16  # number of evaluations in each element for the peak
_MAY_MISS = 0.02  # largest error of the peak of a force's polynomial, relative to its range in an element


@dataclass(frozen=True, eq=False)
class PeriodicResponse:
    """A periodic motion; n coordinates, c contacts.

    Attributes
    ----------
    system : CoupledSystem
    period : float
        Period [s].
    displacement, velocity : ndarray, shape (n,)
        Displacements and rates at t = 0. Rigid-body motions have a mean of zero.
    floquet : FloquetMultipliers
        Stability.
    residual : float
        Closure error of the period and of its segments, relative to the motion.
    error : float
        Change of state or monodromy by the last halving of the elements, relative; the error of the present elements is
        much smaller.
    elements, switches : int
        Number of elements in the period, and of changes of a contact law's branch between events.
    level : int
        Number of halvings of the coarsest element.
    newton_steps : int
    """

    system: CoupledSystem
    period: float
    displacement: FloatArray
    velocity: FloatArray
    floquet: FloquetMultipliers
    residual: float
    error: float
    elements: int
    switches: int
    level: int
    newton_steps: int
    part: LinearPart = field(repr=False)
    recovery: FloatArray = field(repr=False)
    contacts: Contacts = field(repr=False)
    trace: Trace = field(repr=False)

    @property
    def stable(self) -> bool:
        """Whether no small disturbance grows."""
        return self.floquet.stable

    @property
    def stability(self) -> Stability:
        """``stable``, ``unstable`` or ``not decided``."""
        return self.floquet.stability

    @cached_property
    def mean_force(self) -> FloatArray:
        """Mean force of each contact over the period [N], shape (c,)."""
        return self._mean(self.trace.force)

    @cached_property
    def mean_compression(self) -> FloatArray:
        """Mean compression of each contact over the period [m], shape (c,)."""
        return self._mean(self.trace.compression)

    @cached_property
    def rms_compression(self) -> FloatArray:
        """Root mean square of the compression about its mean [m], shape (c,)."""
        return np.sqrt(self._mean((self.trace.compression - self.mean_compression) ** 2))

    @property
    def contact_loss(self) -> FloatArray:
        """Part of the period in which the flanks are apart, shape (c,)."""
        return np.asarray(self.trace.size @ self.trace.apart / self.period)

    @cached_property
    def peak_force(self) -> FloatArray:
        """Largest force of each contact [N], shape (c,)."""
        trace = self.trace
        elements = _near_peaks(trace)
        inner = (np.arange(_LOOKS) + 0.5) / _LOOKS
        times = (trace.start[elements, None] + trace.size[elements, None] * inner).ravel()
        _, force = self._contacts(times, self._amplitudes(times))
        return np.asarray(np.maximum(force.max(axis=0, initial=0.0), trace.force.max(axis=(0, 1))))

    def record(self, outputs: TransientOutputs, samples: int) -> MotionRecord:
        """Rows of coordinates, rates and accelerations over the period, and the contacts.

        Parameters
        ----------
        outputs : TransientOutputs
            Output rows, as for a transient.
        samples : int
            Number of samples at even spacing; spectral lines up to half of it are exact but for aliasing from above.
        """
        if samples < 1:
            raise CouplingError(f"{samples} samples of a period; expected at least one")
        times = self.period * np.arange(samples, dtype=np.float64) / samples
        amplitudes = self._amplitudes(times)
        part = self.part
        q, v = amplitudes @ part.displacement_rows.T, amplitudes @ part.velocity_rows.T
        compression, force = self._contacts(times, amplitudes)
        system = part.system
        a = system.load - q @ system.stiffness.T - v @ system.damping.T - force @ system.contact_directions.T
        for load in system.harmonic_loads:
            a = a + (np.exp(1j * load.frequency * times)[:, None] * load.amplitude).real
        return MotionRecord(
            times=times,
            displacement=q @ (outputs.displacement @ self.recovery).T,
            velocity=v @ (outputs.velocity @ self.recovery).T,
            acceleration=a @ (outputs.acceleration @ self.recovery).T,
            compression=compression,
            force=force,
        )

    def at_nodes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Displacements and rates at ``count`` evenly spaced times from t = 0 on, shape (count, n) each."""
        amplitudes = self._amplitudes(self.period * np.arange(count) / count)
        q, v = (
            amplitudes @ rows.T @ self.recovery.T for rows in (self.part.displacement_rows, self.part.velocity_rows)
        )
        return q, v

    def contacts_at(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Compression [m], its rate [m/s] and the force [N] of each contact, shape (t, c) each.

        Parameters
        ----------
        times : ndarray, shape (t,)
            Times within the period, in any order [s].
        """
        order = np.argsort(times, kind="stable")
        amplitudes = np.empty((len(times), 2 * len(self.part.reference.eigenvalue)))
        amplitudes[order] = self._amplitudes(np.ascontiguousarray(times[order]))
        compression, force = self._contacts(times, amplitudes)
        return compression, amplitudes @ self.part.reference.rate.T, force

    def _mean(self, values: FloatArray) -> FloatArray:
        weights = weights_to(self.trace.part) * (self.trace.size / self.trace.part)[:, None]
        return np.asarray(np.einsum("es,esc->c", weights, values) / self.period)

    def _amplitudes(self, times: FloatArray) -> FloatArray:
        from gearwhine.coupling.collocation.integration_kernels import amplitudes_at

        return np.asarray(amplitudes_at(self.part.reference, self.trace, times))

    def _contacts(self, times: FloatArray, amplitudes: FloatArray) -> tuple[FloatArray, FloatArray]:
        from gearwhine.coupling.collocation.integration_kernels import forces_at

        reference = self.part.reference
        delta, rate = amplitudes @ reference.displacement.T, amplitudes @ reference.rate.T
        force = np.zeros_like(delta)
        work = element_work(len(reference.eigenvalue), ORDER, len(reference.stiffness))
        forces_at(self.contacts, times, delta, rate, work, force)
        return delta, force


def _near_peaks(trace: Trace) -> npt.NDArray[np.int64]:
    """Elements that may hold the largest force of any contact: by the polynomials through its values at the places."""
    top, bottom = trace.force.max(axis=1), trace.force.min(axis=1)
    # Between and beside the places a force varies no more than among them; a constant force has no peak.
    near = np.flatnonzero(np.any(2.0 * top - bottom > top.max(axis=0), axis=1))
    inner = (np.arange(_LOOKS) + 0.5) / _LOOKS
    powers = (trace.part[near, None] * inner)[:, :, None] ** np.arange(ORDER)
    along = (powers @ MONOMIALS.T) @ trace.force[near]
    highest = np.maximum(along.max(axis=1), top[near])
    reach = highest + _MAY_MISS * (highest - bottom[near])
    return near[np.any(reach > np.maximum(top.max(axis=0), highest.max(axis=0, initial=0.0)), axis=1)]


@dataclass(frozen=True, eq=False)
class BranchMotion:
    """Summary of a :class:`gearwhine.coupling.periodic.PeriodicResponse`; n coordinates, c contacts, K segments.

    The whole motion takes a hundred times the memory; :meth:`gearwhine.coupling.periodic.ResponseCurve.motion` computes
    it again.

    Attributes
    ----------
    period, floquet, residual, error, elements, switches, level, newton_steps
        See :class:`PeriodicResponse`.
    displacements, velocities : ndarray, shape (K, n)
        Displacements and rates at the starts of the segments, the first at t = 0.
    mean_force, peak_force : ndarray, shape (c,)
        Mean and largest force of each contact over the period [N].
    mean_compression, rms_compression : ndarray, shape (c,)
        Mean compression of each contact, and its root mean square about the mean [m].
    contact_loss : ndarray, shape (c,)
        Part of the period in which the flanks are apart.
    """

    period: float
    floquet: FloquetMultipliers
    residual: float
    error: float
    elements: int
    switches: int
    level: int
    newton_steps: int
    displacements: FloatArray = field(repr=False)
    velocities: FloatArray = field(repr=False)
    mean_force: FloatArray
    peak_force: FloatArray
    mean_compression: FloatArray
    rms_compression: FloatArray
    contact_loss: FloatArray

    @property
    def stable(self) -> bool:
        """Whether no small disturbance grows."""
        return self.floquet.stable

    @property
    def displacement(self) -> FloatArray:
        """At t = 0, shape (n,)."""
        return np.asarray(self.displacements[0])

    @property
    def velocity(self) -> FloatArray:
        """At t = 0, shape (n,)."""
        return np.asarray(self.velocities[0])


def motion_summary(response: PeriodicResponse, segments: int) -> BranchMotion:
    """Summary of a response, with states at the starts of ``segments`` equal segments."""
    displacements, velocities = response.at_nodes(segments)
    kept = {one.name: getattr(response, one.name) for one in fields(BranchMotion) if hasattr(response, one.name)}
    return BranchMotion(**kept, displacements=displacements, velocities=velocities)
