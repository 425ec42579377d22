r"""The time-stepping kernel: Newmark-β in modal coordinates with tooth contacts, compiled.

Importing this module imports numba.

One step of size h from (q, v, a), with the mass the identity and the contacts' directions D:

    q* = q + h v + (1/2 - β) h² a,            v* = v + (1 - γ) h a,
    S a₁ = F(t₁) - K q* - (C + s' G) v* - s'' G q* - D f,
    q₁ = q* + β h² a₁,                        v₁ = v* + γ h a₁,

S as in :mod:`coupling.step_kernels`, where K and C are diagonal but for the ties U. With W = S⁻¹ D and H = Dᵀ W only
the few forces f of teeth and nonlinear bearings remain unknown: their deflections

    δ = δ* - β h² H f(δ, δ'),    δ' = δ'* - γ h H f(δ, δ'),

δ* and δ'* being those without them, are found by Newton's method on a system as small as their number. Friction acts
along directions of its own, columns of D whose deflections no law asks for. What ties and laws see of the motion, Uᵀq
and Dᵀq, is carried along by the same recurrence as q. With β = 1/4, γ = 1/2 the step is of second order,
unconditionally stable, and keeps the energy of an undamped linear system.
"""

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import FORCE, deviation_of, settle, take_forces
from coupling.kernel_arrays import Bearings, Contacts, Dynamics, Outputs, Samples, Scratch, Segments, StepMatrices
from coupling.load_kernels import load_at
from coupling.power_kernels import stored_in, take_powers
from coupling.row_kernels import SUMS, add_rows, project
from coupling.sample_kernels import write_samples
from coupling.step_kernels import add_gyroscopic, apply_base
from rotors.compiled import inner, uncounted

FloatArray = npt.NDArray[np.float64]

# Contacts are evaluated this part of a segment inside its ends, so that a pair that enters or leaves exactly
# there counts on one side only.
INSIDE = 1e-7

# Columns of the contacts' totals.
IMPULSE, APART, PEAK, LAST_TOUCH = 0, 1, 2, 3


@uncounted()
def march(
    q: FloatArray,
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    bearings: Bearings,
    matrices: StepMatrices,
    segments: Segments,
    outputs: Outputs,
    samples: Samples,
    next_sample: int,
    stored: float,
    totals: FloatArray,
    contact_totals: FloatArray,
    scratch: Scratch,
) -> tuple[int, float, float, float, int]:
    """Carry the state through some segments; q and v are replaced by those at the end.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
        State, in and out.
    next_sample : int
        Number of the first sample not yet written.
    stored : float
        Energy just before the first segment in the teeth, in what nonlinear bearings hold beside linear ones, and in
        the ties where they change with the speed [J].
    totals : ndarray, shape (5,)
        Work of the loads, energy lost to damping, work of what turns on contacts, bearings and ties (added to), the
        largest kinetic energy, and what friction takes from the nominal rotation (added to) [J].
    contact_totals : ndarray, shape (c, 4)
        For each contact ∫ force dt [N s], time apart [s] (both added to), the largest force [N], and when the flanks
        last touched [s].

    Returns
    -------
    next_sample : int
    stored : float
        The same at the end [J].
    curvature : float
        Σ |a₁ - 2 a + a₋₁|² over the steps that have two before them, of the coordinates to be resolved.
    acceleration : float
        Σ |a₁|² over the same steps and coordinates.
    unsettled : int
        Steps whose contact forces Newton's method left unsettled.
    """
    curvature, acceleration, unsettled = 0.0, 0.0, 0
    for segment in range(segments.start.size):
        t0, t1, count = segments.start[segment], segments.end[segment], segments.steps[segment]
        turned0, speed0, swing = segments.turned[segment, 0], segments.turned[segment, 1], segments.turned[segment, 2]
        slot, h, inside = segments.kind[segment], (t1 - t0) / count, INSIDE * (t1 - t0)
        speed = speed0 + swing * inside
        turned = turned0 + inside * (speed0 + 0.5 * swing * inside)
        load_at(dynamics, t0, turned0, speed0, swing, scratch.load)
        fresh = _begin(
            q, v, dynamics, contacts, bearings, matrices, slot, turned, speed, speed0 + 0.5 * swing * (t1 - t0), swing,
            scratch,
        )  # fmt: skip
        totals[2] += fresh - stored
        stored = fresh
        for step in range(count):
            t, after = t0 + step * h, (step + 1) * h
            speed = speed0 + swing * after
            turned = turned0 + after * (speed0 + 0.5 * swing * after)
            load_at(dynamics, t0 + after, turned, speed, swing, scratch.load)
            _predict(q, v, dynamics, h, scratch)
            _answer(dynamics, matrices, slot, h, swing, scratch)
            if step == count - 1:
                # The last look at the teeth is just inside the segment.
                speed = speed0 + swing * (after - inside)
                turned = turned0 + (after - inside) * (speed0 + 0.5 * swing * (after - inside))
            if not _press(dynamics, contacts, bearings, matrices, slot, h, turned, speed, scratch):
                unsettled += 1
            if samples.first + next_sample * samples.interval <= t + h:
                before = step * h
                next_sample = write_samples(
                    contacts, outputs, samples, next_sample, t, h, turned0 + before * (speed0 + 0.5 * swing * before),
                    speed0 + swing * before, swing, q, v, dynamics.beta * h * h, dynamics.gamma * h, scratch,
                )  # fmt: skip
            if step > 0:
                curved, size = _curvature(dynamics.resolved, scratch.before, scratch.a, scratch.free)
                curvature += curved
                acceleration += size
            _accept(q, v, dynamics, h, scratch)
            if swing != 0.0:
                _swing_load(q, dynamics, swing, scratch)
            stored = _account(v, dynamics, contacts, matrices, slot, t, h, speed, totals, contact_totals, scratch)
    return next_sample, stored, curvature, acceleration, unsettled


@inner(forceinline=True)
def _begin(
    q: FloatArray,
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    bearings: Bearings,
    matrices: StepMatrices,
    slot: int,
    turned: float,
    speed: float,
    middle_speed: float,
    swing: float,
    scratch: Scratch,
) -> float:
    """Accelerations, powers and energy just inside a segment, whose loads are given; returns what teeth and ties hold.

    The teeth change at the event: forces, powers and energy start afresh from the new set of pairs.
    """
    a, dq, dv, delta, rate = scratch.a, scratch.dq, scratch.dv, scratch.delta, scratch.rate
    c, push = contacts.phase.size, scratch.push
    project(dynamics.ties, q, scratch.tq)
    project(dynamics.ties, v, scratch.tv)
    project(contacts.direction, q, dq)
    project(contacts.direction, v, dv)
    for k in range(c):
        gone, scratch.slip[k] = deviation_of(contacts.clearance, contacts.errors, k, turned, speed)
        delta[k], rate[k] = dq[k] - gone, dv[k] - scratch.slip[k]
    for k in range(c, delta.size):
        delta[k] = dq[k]
    laws = scratch.laws
    take_forces(contacts, bearings, turned, delta, rate, laws, push, scratch.drag, scratch.tangents, scratch.held)
    for i in range(a.size):
        a[i] = scratch.load[i] - dynamics.stiffness[i] * q[i] - dynamics.damping[i] * v[i]
    blocks, first, size, work = dynamics.gyroscopic, dynamics.block_start, dynamics.block_size, scratch.block
    add_gyroscopic(blocks, first, size, -middle_speed, v, a, work)
    if swing != 0.0:
        add_gyroscopic(blocks, first, size, -swing, q, a, work)
        _swing_load(q, dynamics, swing, scratch)
    _push_ties(matrices, slot, scratch.tq, scratch.tv, scratch)
    add_rows(dynamics.ties, scratch.tie_push, -1.0, a)
    add_rows(contacts.direction, push, -1.0, a)
    project(dynamics.ties, a, scratch.ta)
    project(contacts.direction, a, scratch.da)
    take_powers(dynamics, contacts, matrices.tie_stiffness[slot], matrices.tie_damping[slot], speed, v, scratch)
    for k in range(scratch.powers.size):
        scratch.powers_before[k] = scratch.powers[k]
    for k in range(c):
        scratch.force_before[k] = laws[k, FORCE]
    return stored_in(dynamics, matrices.tie_stiffness[slot], scratch)


@inner()
def _swing_load(q: FloatArray, dynamics: Dynamics, swing: float, scratch: Scratch) -> None:
    """The drive that speeds a tilted shaft up works on it: counted among the loads."""
    first, size = dynamics.block_start, dynamics.block_size
    add_gyroscopic(dynamics.gyroscopic, first, size, -swing, q, scratch.load, scratch.block)


@inner(forceinline=True)
def _push_ties(matrices: StepMatrices, slot: int, tq: FloatArray, tv: FloatArray, scratch: Scratch) -> None:
    """What the ties push at displacements and rates along them: K_t Uᵀq + C_t Uᵀv."""
    project(matrices.tie_stiffness[slot], tq, scratch.tie_push)
    project(matrices.tie_damping[slot], tv, scratch.response)
    for j in range(tq.size):
        scratch.tie_push[j] += scratch.response[j]


@inner(forceinline=True)
def _predict(q: FloatArray, v: FloatArray, dynamics: Dynamics, h: float, scratch: Scratch) -> None:
    """q* and v*, and what ties and laws see of them."""
    old, new = (0.5 - dynamics.beta) * h * h, (1.0 - dynamics.gamma) * h
    q0, v0, a = scratch.q0, scratch.v0, scratch.a
    for i in range(q.size):
        q0[i] = q[i] + h * v[i] + old * a[i]
        v0[i] = v[i] + new * a[i]
    for j in range(scratch.tq.size):
        scratch.tq0[j] = scratch.tq[j] + h * scratch.tv[j] + old * scratch.ta[j]
        scratch.tv0[j] = scratch.tv[j] + new * scratch.ta[j]
    for k in range(scratch.dq.size):
        scratch.dq0[k] = scratch.dq[k] + h * scratch.dv[k] + old * scratch.da[k]
        scratch.dv0[k] = scratch.dv[k] + new * scratch.da[k]


@inner(forceinline=True)
def _answer(dynamics: Dynamics, matrices: StepMatrices, slot: int, h: float, swing: float, scratch: Scratch) -> None:
    """Accelerations without the forces of the laws, into ``free``, and what the ties see of them."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    per_moved, ratio = 1.0 / moved, displaced / moved
    q0, v0, pushed, free = scratch.q0, scratch.v0, scratch.pushed, scratch.free
    for i in range(q0.size):
        pushed[i] = scratch.load[i] - dynamics.stiffness[i] * q0[i] - dynamics.damping[i] * v0[i]
    blocks, first, size, work = dynamics.gyroscopic, dynamics.block_start, dynamics.block_size, scratch.block
    if swing != 0.0:
        add_gyroscopic(blocks, first, size, -swing, q0, pushed, work)
        add_gyroscopic(blocks, first, size, ratio * swing, v0, pushed, work)
    # With D the diagonal of S₀ = D + (γ h s' + β h² s'') G, S₀ (a + v*/γh) = r + D v*/γh + β/γ h s'' G v* has
    # no term s' G v*: most of the gyroscopic part comes without a product of its own.
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        part, rates, stiffness, damping = pushed[among], v0[among], dynamics.stiffness[among], dynamics.damping[among]
        for i in range(part.size):
            part[i] += rates[i] * (per_moved + damping[i] + ratio * stiffness[i])
    apply_base(matrices.base[slot], matrices.blocks[slot], first, size, pushed, free, work)
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        part, rates = free[among], v0[among]
        for i in range(part.size):
            part[i] -= rates[i] * per_moved

    # a = B (r - U y) - B U link (Uᵀ B (r - U y)), y what the ties push.
    seen, tie_push, response = scratch.seen, scratch.tie_push, scratch.response
    between = matrices.between[slot]
    project(dynamics.ties, free, seen)
    _push_ties(matrices, slot, scratch.tq0, scratch.tv0, scratch)
    project(between, tie_push, response)
    for j in range(seen.size):
        response[j] = seen[j] - response[j]
    project(matrices.link[slot], response, scratch.linked)
    for j in range(seen.size):
        tie_push[j] += scratch.linked[j]
    add_rows(matrices.ties[slot], tie_push, -1.0, free)
    project(between, tie_push, response)
    for j in range(seen.size):
        seen[j] -= response[j]


@inner(forceinline=True)
def _press(
    dynamics: Dynamics,
    contacts: Contacts,
    bearings: Bearings,
    matrices: StepMatrices,
    slot: int,
    h: float,
    turned: float,
    speed: float,
    scratch: Scratch,
) -> bool:
    """The forces of the laws, and the accelerations with them; whether Newton's method found them."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    free, da, push, delta, rate = scratch.free, scratch.da, scratch.push, scratch.delta_free, scratch.rate_free
    if delta.size == 0:
        return True
    c, flexibility = contacts.phase.size, matrices.flexibility[slot]
    project(contacts.direction, free, da)
    for k in range(c):
        gone, scratch.slip[k] = deviation_of(contacts.clearance, contacts.errors, k, turned, speed)
        delta[k] = scratch.dq0[k] + displaced * da[k] - gone
        rate[k] = scratch.dv0[k] + moved * da[k] - scratch.slip[k]
    for k in range(c, delta.size):
        delta[k] = scratch.dq0[k] + displaced * da[k]
    settled = settle(
        contacts,
        bearings,
        turned,
        delta,
        rate,
        flexibility,
        displaced,
        moved,
        scratch.delta,
        scratch.rate,
        scratch.laws,
        push,
        scratch.drag,
        scratch.tangents,
        scratch.held,
        scratch.jacobian,
        scratch.residual,
    )
    add_rows(matrices.contact[slot], push, -1.0, free)
    add_rows(matrices.contact_ties[slot], push, -1.0, scratch.seen)
    for j in range(da.size):
        for k in range(push.size):
            da[j] -= flexibility[j, k] * push[k]
    return settled


@inner(fastmath=SUMS, forceinline=True)
def _curvature(resolved: FloatArray, before: FloatArray, a: FloatArray, a1: FloatArray) -> tuple[float, float]:
    """|a₁ - 2 a + a₋₁|² and |a₁|² of the coordinates to be resolved."""
    curvature, acceleration = 0.0, 0.0
    for i in range(a.size):
        second = a1[i] - 2.0 * a[i] + before[i]
        curvature += resolved[i] * second * second
        acceleration += resolved[i] * a1[i] * a1[i]
    return curvature, acceleration


@inner(forceinline=True)
def _accept(q: FloatArray, v: FloatArray, dynamics: Dynamics, h: float, scratch: Scratch) -> None:
    """The state at the step's end, and what ties and laws see of it."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    a, before, free, q0, v0 = scratch.a, scratch.before, scratch.free, scratch.q0, scratch.v0
    for i in range(q.size):
        before[i], a[i] = a[i], free[i]
        q[i], v[i] = q0[i] + displaced * free[i], v0[i] + moved * free[i]
    for j in range(scratch.ta.size):
        value = scratch.seen[j]
        scratch.ta[j] = value
        scratch.tq[j], scratch.tv[j] = scratch.tq0[j] + displaced * value, scratch.tv0[j] + moved * value
    for k in range(scratch.da.size):
        value = scratch.da[k]
        scratch.dq[k], scratch.dv[k] = scratch.dq0[k] + displaced * value, scratch.dv0[k] + moved * value


@inner(forceinline=True)
def _account(
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    matrices: StepMatrices,
    slot: int,
    t: float,
    h: float,
    speed: float,
    totals: FloatArray,
    contact_totals: FloatArray,
    scratch: Scratch,
) -> float:
    """Add a step's work and losses, and the contacts' figures; returns what teeth and ties hold at its end."""
    powers, powers_before = scratch.powers, scratch.powers_before
    take_powers(dynamics, contacts, matrices.tie_stiffness[slot], matrices.tie_damping[slot], speed, v, scratch)
    for k in range(3):
        totals[k] += 0.5 * h * (powers_before[k] + powers[k])
    totals[4] += 0.5 * h * (powers_before[3] + powers[3])
    totals[3] = max(totals[3], 0.5 * powers[4])
    for k in range(powers.size):
        powers_before[k] = powers[k]
    for k in range(contacts.phase.size):
        force = scratch.laws[k, FORCE]
        contact_totals[k, IMPULSE] += 0.5 * h * (scratch.force_before[k] + force)
        if force == 0.0:
            contact_totals[k, APART] += h
        else:
            contact_totals[k, LAST_TOUCH] = t + h
        contact_totals[k, PEAK] = max(contact_totals[k, PEAK], force)
        scratch.force_before[k] = force
    return stored_in(dynamics, matrices.tie_stiffness[slot], scratch)
