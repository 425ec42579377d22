r"""The time-stepping kernels: Newmark-β in modal coordinates with tooth contacts, compiled.

Importing this module imports numba.

One step of size h from (q, v, a), with the mass the identity and the contacts' directions D:

    q* = q + h v + (1/2 - β) h² a,            v* = v + (1 - γ) h a,
    S a₁ = F(t₁) - K q* - C v* - D f,         S = I + γ h C + β h² K,
    q₁ = q* + β h² a₁,                        v₁ = v* + γ h a₁.

S depends on h alone, so with P = S⁻¹ [K C], W = S⁻¹ D and H = Dᵀ W known for each step size,

    a₁ = S⁻¹ F - P [q*; v*] - W f

and only the few contact forces f remain unknown: their compressions

    δ = δ* - β h² H f(δ, δ'),    δ' = δ'* - γ h H f(δ, δ'),

δ* and δ'* being those without contact, are found by Newton's method on a system as small as the number of
contacts. With β = 1/4, γ = 1/2 the step is of second order, unconditionally stable, and keeps the energy of an
undamped linear system.
"""

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from coupling.contact_kernels import compression_of, contact_state, law_of, settle
from coupling.kernel_arrays import Contacts, Dynamics, Outputs, Samples, Segments, StepMatrices

FloatArray = npt.NDArray[np.float64]

# Contacts are evaluated this part of a segment inside its ends, so that a pair that enters or leaves exactly
# there counts on one side only.
_INSIDE = 1e-7


@njit(cache=True, nogil=True)
def march(
    q: FloatArray,
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    matrices: StepMatrices,
    segments: Segments,
    outputs: Outputs,
    samples: Samples,
    next_sample: int,
    stored: float,
    totals: FloatArray,
    contact_totals: FloatArray,
) -> tuple[int, float, float, float, int]:
    """Carry the state through some segments; q and v are replaced by those at the end.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
        State, in and out.
    next_sample : int
        Number of the first sample not yet written.
    stored : float
        Energy in the teeth just before the first segment [J].
    totals : ndarray, shape (4,)
        Work of the loads, energy lost to damping, work of the turning teeth on the contacts (added to), and the
        largest kinetic energy [J].
    contact_totals : ndarray, shape (c, 3)
        For each contact ∫ force dt [N s], time apart [s] (both added to) and the largest force [N].

    Returns
    -------
    next_sample : int
    stored : float
        Energy in the teeth at the end [J].
    curvature : float
        Σ |a₁ - 2 a + a₋₁|² over the steps that have two before them, of the coordinates to be resolved.
    acceleration : float
        Σ |a₁|² over the same steps and coordinates.
    unsettled : int
        Steps whose contact forces Newton's method left unsettled.
    """
    n, c = q.size, contacts.phase.size
    a, before, after = np.zeros(n), np.zeros(n), np.zeros(n)
    start = np.zeros(2 * n)  # q* and v*
    q1, v1 = np.zeros(n), np.zeros(n)
    force, force1 = np.zeros(c), np.zeros(c)
    delta, rate = np.zeros(c), np.zeros(c)
    powers, powers1 = np.zeros(3), np.zeros(3)
    curvature, acceleration, unsettled = 0.0, 0.0, 0
    beta, gamma = dynamics.beta, dynamics.gamma
    resolved = dynamics.resolved

    for segment in range(segments.start.size):
        t0, t1, count = segments.start[segment], segments.end[segment], segments.steps[segment]
        kind = segments.kind[segment]
        h = (t1 - t0) / count
        inside = _INSIDE * (t1 - t0)
        # The teeth change at the event: forces, powers and energy start afresh from the new set of pairs.
        for i in range(c):
            delta[i], rate[i] = compression_of(contacts, i, q, v, t0 + inside)
        fresh = contact_state(contacts, t0 + inside, delta, rate, force)
        totals[2] += fresh - stored
        stored = fresh
        _acceleration(dynamics, contacts, q, v, t0, force, a)
        _powers(dynamics, contacts, q, v, t0 + inside, delta, rate, force, powers)

        for step in range(count):
            t = t0 + step * h
            time = t0 + (step + 1) * h
            seen = time - inside if step == count - 1 else time
            for i in range(n):
                start[i] = q[i] + h * v[i] + (0.5 - beta) * h * h * a[i]
                start[n + i] = v[i] + (1.0 - gamma) * h * a[i]
                after[i] = matrices.constant[kind, i]
            for w in range(dynamics.frequency.size):
                cosine, sine = math.cos(dynamics.frequency[w] * time), math.sin(dynamics.frequency[w] * time)
                for i in range(n):
                    after[i] += cosine * matrices.cosine[kind, w, i] - sine * matrices.sine[kind, w, i]
            for j in range(2 * n):
                value = start[j]
                for i in range(n):
                    after[i] -= matrices.propagator[kind, j, i] * value
            for i in range(n):
                q1[i] = start[i] + beta * h * h * after[i]
                v1[i] = start[n + i] + gamma * h * after[i]
            settled = settle(contacts, q1, v1, seen, matrices.flexibility[kind], beta * h * h, gamma * h, force1)
            if not settled:
                unsettled += 1
            for k in range(c):
                for i in range(n):
                    after[i] -= matrices.contact[kind, k, i] * force1[k]
            for i in range(n):
                q1[i] = start[i] + beta * h * h * after[i]
                v1[i] = start[n + i] + gamma * h * after[i]

            for k in range(c):
                delta[k], rate[k] = compression_of(contacts, k, q1, v1, seen)
            stored = contact_state(contacts, seen, delta, rate, force1)
            _powers(dynamics, contacts, q1, v1, seen, delta, rate, force1, powers1)
            for k in range(3):
                totals[k] += 0.5 * h * (powers[k] + powers1[k])
                powers[k] = powers1[k]
            kinetic = 0.0
            for i in range(n):
                kinetic += 0.5 * v1[i] * v1[i]
            totals[3] = max(totals[3], kinetic)
            for k in range(c):
                contact_totals[k, 0] += 0.5 * h * (force[k] + force1[k])
                if force1[k] == 0.0:
                    contact_totals[k, 1] += h
                contact_totals[k, 2] = max(contact_totals[k, 2], force1[k])
                force[k] = force1[k]

            if step > 0:
                for i in resolved:
                    second = after[i] - 2.0 * a[i] + before[i]
                    curvature += second * second
                    acceleration += after[i] * after[i]
            next_sample = _sample(contacts, outputs, samples, next_sample, t, h, q, v, a, q1, v1, after)
            for i in range(n):
                before[i], a[i], q[i], v[i] = a[i], after[i], q1[i], v1[i]
    return next_sample, stored, curvature, acceleration, unsettled


@njit(cache=True, nogil=True)
def _acceleration(
    dynamics: Dynamics,
    contacts: Contacts,
    q: FloatArray,
    v: FloatArray,
    time: float,
    force: FloatArray,
    out: FloatArray,
) -> None:
    """The acceleration that satisfies the equation of motion."""
    n = q.size
    for i in range(n):
        out[i] = dynamics.constant[i]
    for w in range(dynamics.frequency.size):
        cosine, sine = math.cos(dynamics.frequency[w] * time), math.sin(dynamics.frequency[w] * time)
        for i in range(n):
            out[i] += cosine * dynamics.cosine[w, i] - sine * dynamics.sine[w, i]
    for j in range(n):
        for i in range(n):
            out[i] -= dynamics.stiffness[j, i] * q[j] + dynamics.damping[j, i] * v[j]
    for k in range(force.size):
        for i in range(n):
            out[i] -= contacts.direction[k, i] * force[k]


@njit(cache=True, nogil=True)
def _powers(
    dynamics: Dynamics,
    contacts: Contacts,
    q: FloatArray,
    v: FloatArray,
    time: float,
    delta: FloatArray,
    rate: FloatArray,
    force: FloatArray,
    out: FloatArray,
) -> None:
    """Power of the loads, power lost, power of the turning teeth [W].

    With the teeth's energy U(p, δ), δ = dᵀq - e: the turning teeth give ∂U/∂p p' - f e', and the damping takes
    v C v + c δ'². Together with the loads they change the energy of motion, springs and teeth.
    """
    n = q.size
    out[:] = 0.0
    for i in range(n):
        out[0] += dynamics.constant[i] * v[i]
        out[1] += dynamics.loss_diagonal[i] * v[i] * v[i]
    for w in range(dynamics.frequency.size):
        cosine, sine = math.cos(dynamics.frequency[w] * time), math.sin(dynamics.frequency[w] * time)
        for i in range(n):
            out[0] += (cosine * dynamics.cosine[w, i] - sine * dynamics.sine[w, i]) * v[i]
    for r in range(dynamics.loss_weights.size):
        value = 0.0
        for i in range(n):
            value += dynamics.loss_rows[r, i] * v[i]
        out[1] += dynamics.loss_weights[r] * value * value
    if dynamics.has_skew:
        for j in range(n):
            for i in range(n):
                out[1] += v[i] * dynamics.skew[j, i] * q[j]
    for k in range(force.size):
        law = law_of(contacts, k, time, delta[k], rate[k])
        error_rate = rate[k]
        for i in range(n):
            error_rate -= contacts.direction[k, i] * v[i]
        # δ' = d v - e', so what is left of δ' is -e'.
        out[2] += law[4] * contacts.rate[k] + force[k] * error_rate
        out[1] += law[2] * rate[k] * rate[k]


@njit(cache=True, nogil=True)
def _sample(
    contacts: Contacts,
    outputs: Outputs,
    samples: Samples,
    number: int,
    t: float,
    h: float,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
) -> int:
    """Write the samples that fall into the step from t to t + h.

    Displacement and velocity by cubic Hermite interpolation, acceleration linear: errors below the step's own.
    """
    n = q.size
    x, y = np.empty(n), np.empty(n)
    while number < samples.force.shape[0]:
        time = samples.first + number * samples.interval
        if time > t + h:
            break
        s = max((time - t) / h, 0.0)
        old, slope_old = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2 * h
        new, slope_new = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0) * h
        for i in range(n):
            x[i] = old * q[i] + slope_old * v[i] + new * q1[i] + slope_new * v1[i]
            y[i] = old * v[i] + slope_old * a[i] + new * v1[i] + slope_new * a1[i]
        for k in range(contacts.phase.size):
            delta, rate = compression_of(contacts, k, x, y, time)
            samples.compression[number, k] = delta
            samples.force[number, k] = law_of(contacts, k, time, delta, rate)[0]
        for k in range(outputs.displacement.shape[0]):
            samples.displacement[number, k] = np.sum(outputs.displacement[k] * x)
        for k in range(outputs.velocity.shape[0]):
            samples.velocity[number, k] = np.sum(outputs.velocity[k] * y)
        for i in range(n):
            x[i] = (1.0 - s) * a[i] + s * a1[i]
        for k in range(outputs.acceleration.shape[0]):
            samples.acceleration[number, k] = np.sum(outputs.acceleration[k] * x)
        number += 1
    return number
