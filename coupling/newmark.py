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

import math

import numpy as np
import numpy.typing as npt

from coupling.contact_kernels import (
    DAMPING,
    ENERGY,
    FORCE,
    PHASE_SLOPE,
    deviation_of,
    settle,
    take_forces,
    take_law,
)
from coupling.kernel_arrays import (
    BY_TIME,
    BY_UNBALANCE,
    Bearings,
    Contacts,
    Dynamics,
    Outputs,
    Samples,
    Scratch,
    Segments,
    StepMatrices,
)
from coupling.step_kernels import add_gyroscopic, apply_base, project
from rotors.compiled import inner, uncounted

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

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
    r, n = dynamics.ties.shape
    c, directions = contacts.phase.size, contacts.direction.shape[0]
    u = c + bearings.axis.size
    rows = scratch.coordinates
    a, before, free, pushed, q0, v0 = rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]
    load, x, y = rows[6], rows[7], rows[8]
    # What the ties see of q, v and a, and what the laws do.
    rows = scratch.ties
    tq, tv, ta, tq0, tv0 = rows[0], rows[1], rows[2], rows[3], rows[4]
    tie_push, seen_by_ties, response = rows[5], rows[6], rows[7]
    rows = scratch.directions
    dq, dv, da, dq0, dv0, push = rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]
    rows = scratch.deflections
    delta, rate, delta_free, rate_free, slip, force_before = rows[0], rows[1], rows[2], rows[3], rows[4], rows[5]
    laws, spare, jacobian, residual = scratch.laws[0], scratch.laws[1], scratch.jacobian, scratch.residual
    drag, tangents, work, teeth = scratch.drag, scratch.tangents, scratch.block, contacts.direction[:c]
    powers, powers_before, held = scratch.powers[0], scratch.powers[1], scratch.held
    curvature, acceleration, unsettled = 0.0, 0.0, 0
    beta, gamma = dynamics.beta, dynamics.gamma
    # Taken out of their tuples here, once.
    gyroscopic, first, size = dynamics.gyroscopic, dynamics.block_start, dynamics.block_size
    changing, has_skew = dynamics.tie_rates.size > 1, dynamics.has_skew

    for segment in range(segments.start.size):
        t0, t1, count = segments.start[segment], segments.end[segment], segments.steps[segment]
        turned0, speed0, swing = segments.turned[segment, 0], segments.turned[segment, 1], segments.turned[segment, 2]
        h = (t1 - t0) / count
        inside = INSIDE * (t1 - t0)
        slot = segments.kind[segment]
        middle_speed = speed0 + 0.5 * swing * (t1 - t0)
        stiffness, damping = matrices.tie_stiffness[slot], matrices.tie_damping[slot]
        between, link = matrices.between[slot], matrices.link[slot]

        # The teeth change at the event: forces, powers and energy start afresh from the new set of pairs.
        project(dynamics.ties, q, tq)
        project(dynamics.ties, v, tv)
        project(contacts.direction, q, dq)
        project(contacts.direction, v, dv)
        speed = speed0 + swing * inside
        turned = turned0 + inside * (speed0 + 0.5 * swing * inside)
        for k in range(c):
            gone, slip[k] = deviation_of(contacts.clearance, contacts.errors, k, turned, speed)
            delta[k], rate[k] = dq[k] - gone, dv[k] - slip[k]
        for k in range(c, u):
            delta[k] = dq[k]
        take_forces(contacts, bearings, turned, delta, rate, laws, push, drag, tangents, held)
        fresh = _stored(changing, stiffness, tq, laws) + held[0, 0]
        totals[2] += fresh - stored
        stored = fresh
        _load_at(dynamics, t0, turned0, speed0, swing, load)
        for i in range(n):
            a[i] = load[i] - dynamics.stiffness[i] * q[i] - dynamics.damping[i] * v[i]
        add_gyroscopic(gyroscopic, first, size, -middle_speed, v, a, work)
        if swing != 0.0:
            # The drive that speeds a tilted shaft up works on it: counted among the loads.
            add_gyroscopic(gyroscopic, first, size, -swing, q, load, work)
            add_gyroscopic(gyroscopic, first, size, -swing, q, a, work)
        for j in range(r):
            tie_push[j] = 0.0
            for k in range(r):
                tie_push[j] += stiffness[j, k] * tq[k] + damping[j, k] * tv[k]
        for i in range(n):
            for j in range(r):
                a[i] -= dynamics.ties[j, i] * tie_push[j]
            for k in range(directions):
                a[i] -= contacts.direction[k, i] * push[k]
        project(dynamics.ties, a, ta)
        project(contacts.direction, a, da)
        _powers(
            dynamics.damping,
            contacts.rate,
            damping,
            stiffness,
            has_skew,
            speed,
            v,
            load,
            tq,
            tv,
            rate,
            slip,
            laws,
            powers_before,
        )
        if directions > u:
            _friction_power(contacts.friction_row, contacts.sliding, speed, dv, push, powers_before)
        powers_before[2] += held[0, 1] * speed
        for k in range(c):
            force_before[k] = laws[k, FORCE]

        for step in range(count):
            t = t0 + step * h
            after = (step + 1) * h
            speed_before = speed0 + swing * step * h
            turned_before = turned0 + step * h * (speed0 + 0.5 * swing * step * h)
            speed = speed0 + swing * after
            turned = turned0 + after * (speed0 + 0.5 * swing * after)
            _load_at(dynamics, t0 + after, turned, speed, swing, load)
            old, new = (0.5 - beta) * h * h, (1.0 - gamma) * h
            for i in range(n):
                q0[i] = q[i] + h * v[i] + old * a[i]
                v0[i] = v[i] + new * a[i]
                pushed[i] = load[i] - dynamics.stiffness[i] * q0[i] - dynamics.damping[i] * v0[i]
            for j in range(r):
                tq0[j] = tq[j] + h * tv[j] + old * ta[j]
                tv0[j] = tv[j] + new * ta[j]
            for k in range(directions):
                dq0[k] = dq[k] + h * dv[k] + old * da[k]
                dv0[k] = dv[k] + new * da[k]
            if swing != 0.0:
                add_gyroscopic(gyroscopic, first, size, -swing, q0, pushed, work)
                add_gyroscopic(gyroscopic, first, size, beta / gamma * h * swing, v0, pushed, work)
            # With D the diagonal of S₀ = D + (γ h s' + β h² s'') G, S₀ (a + v*/γh) = r + D v*/γh + β/γ h s'' G v* has
            # no term s' G v*: most of the gyroscopic part comes without a product of its own.
            for g in range(first.size):
                for i in range(first[g], first[g] + size[g]):
                    pushed[i] += v0[i] / (gamma * h * matrices.base[slot, i])
            apply_base(matrices.base, matrices.blocks, first, size, slot, pushed, free, work)
            for g in range(first.size):
                for i in range(first[g], first[g] + size[g]):
                    free[i] -= v0[i] / (gamma * h)

            # a = B (r - U y) - B U link (Uᵀ B (r - U y)), y what the ties push.
            project(dynamics.ties, free, seen_by_ties)
            for j in range(r):
                tie_push[j] = 0.0
                for k in range(r):
                    tie_push[j] += stiffness[j, k] * tq0[k] + damping[j, k] * tv0[k]
            for j in range(r):
                response[j] = seen_by_ties[j]
                for k in range(r):
                    response[j] -= between[j, k] * tie_push[k]
            for j in range(r):
                for k in range(r):
                    tie_push[j] += link[j, k] * response[k]
            for j in range(r):
                value = tie_push[j]
                for i in range(n):
                    free[i] -= matrices.ties[slot, j, i] * value
                for k in range(r):
                    seen_by_ties[k] -= between[k, j] * value

            displaced, moved = beta * h * h, gamma * h
            if u > 0:
                # The last look at the teeth is just inside the segment.
                if step == count - 1:
                    speed = speed0 + swing * (after - inside)
                    turned = turned0 + (after - inside) * (speed0 + 0.5 * swing * (after - inside))
                project(contacts.direction, free, da)
                for k in range(c):
                    gone, slip[k] = deviation_of(contacts.clearance, contacts.errors, k, turned, speed)
                    delta_free[k] = dq0[k] + displaced * da[k] - gone
                    rate_free[k] = dv0[k] + moved * da[k] - slip[k]
                for k in range(c, u):
                    delta_free[k] = dq0[k] + displaced * da[k]
                settled = settle(
                    contacts,
                    bearings,
                    turned,
                    delta_free,
                    rate_free,
                    matrices.flexibility[slot],
                    displaced,
                    moved,
                    delta,
                    rate,
                    laws,
                    push,
                    drag,
                    tangents,
                    held,
                    jacobian,
                    residual,
                )
                if not settled:
                    unsettled += 1
                for k in range(directions):
                    force = push[k]
                    if force != 0.0:
                        for i in range(n):
                            free[i] -= matrices.contact[slot, k, i] * force
                        for j in range(r):
                            seen_by_ties[j] -= matrices.contact_ties[slot, k, j] * force
                        for j in range(directions):
                            da[j] -= matrices.flexibility[slot, j, k] * force

            if samples.first + next_sample * samples.interval <= t + h:
                next_sample = _sample(
                contacts, teeth, outputs, samples, next_sample, t, h, turned_before, speed_before, swing,
                q, v, a, q0, v0, free, displaced, moved, x, y, spare, delta_free,
            )  # fmt: skip
            kinetic = 0.0
            if step > 0:
                for i in range(n):
                    second = free[i] - 2.0 * a[i] + before[i]
                    curvature += dynamics.resolved[i] * second * second
                    acceleration += dynamics.resolved[i] * free[i] * free[i]
            for i in range(n):
                before[i], a[i] = a[i], free[i]
                q[i], v[i] = q0[i] + displaced * free[i], v0[i] + moved * free[i]
                kinetic += v[i] * v[i]
            for j in range(r):
                ta[j] = seen_by_ties[j]
                tq[j], tv[j] = tq0[j] + displaced * ta[j], tv0[j] + moved * ta[j]
            for k in range(directions):
                dq[k], dv[k] = dq0[k] + displaced * da[k], dv0[k] + moved * da[k]

            if swing != 0.0:
                add_gyroscopic(gyroscopic, first, size, -swing, q, load, work)
            stored = _stored(changing, stiffness, tq, laws) + held[0, 0]
            _powers(
                dynamics.damping,
                contacts.rate,
                damping,
                stiffness,
                has_skew,
                speed,
                v,
                load,
                tq,
                tv,
                rate,
                slip,
                laws,
                powers,
            )
            if directions > u:
                _friction_power(contacts.friction_row, contacts.sliding, speed, dv, push, powers)
            powers[2] += held[0, 1] * speed
            totals[4] += 0.5 * h * (powers_before[3] + powers[3])
            powers_before[3] = powers[3]
            for k in range(3):
                totals[k] += 0.5 * h * (powers_before[k] + powers[k])
                powers_before[k] = powers[k]
            totals[3] = max(totals[3], 0.5 * kinetic)
            for k in range(c):
                force = laws[k, FORCE]
                contact_totals[k, IMPULSE] += 0.5 * h * (force_before[k] + force)
                if force == 0.0:
                    contact_totals[k, APART] += h
                else:
                    contact_totals[k, LAST_TOUCH] = t + h
                contact_totals[k, PEAK] = max(contact_totals[k, PEAK], force)
                force_before[k] = force
    return next_sample, stored, curvature, acceleration, unsettled


@inner()
def _stored(changing: bool, stiffness: FloatArray, tq: FloatArray, laws: FloatArray) -> float:
    """Energy in the teeth, and in the ties where they change with the speed."""
    energy = 0.0
    if changing:
        for i in range(tq.size):
            for j in range(tq.size):
                energy += 0.5 * tq[i] * stiffness[i, j] * tq[j]
    for k in range(laws.shape[0]):
        energy += laws[k, ENERGY]
    return energy


@inner()
def _load_at(dynamics: Dynamics, time: float, turned: float, speed: float, swing: float, out: FloatArray) -> None:
    """All loads at a time."""
    n = out.size
    for i in range(n):
        out[i] = dynamics.constant[i] + swing * dynamics.swing[i]
    for w in range(dynamics.frequency.size):
        frequency, follows = dynamics.frequency[w], dynamics.follows[w]
        angle = frequency * (time if follows == BY_TIME else turned)
        cosine, sine = math.cos(angle), math.sin(angle)
        if follows == BY_UNBALANCE:
            # (s'² - i s''/w) e^{iws}: what an eccentric mass feels, by differentiating twice.
            square, side = speed * speed, swing / frequency
            cosine, sine = square * cosine + side * sine, square * sine - side * cosine
        for i in range(n):
            out[i] += cosine * dynamics.cosine[w, i] - sine * dynamics.sine[w, i]
    for m in range(dynamics.timed_sizes.size):
        last = dynamics.timed_sizes[m] - 1
        low, high = 0, last
        while high - low > 1:
            middle = (low + high) // 2
            if dynamics.timed_times[m, middle] <= time:
                low = middle
            else:
                high = middle
        begin, end = dynamics.timed_times[m, low], dynamics.timed_times[m, high]
        part = min(max((time - begin) / (end - begin), 0.0), 1.0) if end > begin else 0.0
        value = dynamics.timed_values[m, low] + part * (dynamics.timed_values[m, high] - dynamics.timed_values[m, low])
        for i in range(n):
            out[i] += value * dynamics.timed_rows[m, i]


@inner()
def _powers(
    component_damping: FloatArray,
    phase_rate: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    has_skew: bool,
    speed: float,
    v: FloatArray,
    load: FloatArray,
    tq: FloatArray,
    tv: FloatArray,
    rate: FloatArray,
    slip: FloatArray,
    laws: FloatArray,
    out: FloatArray,
) -> None:
    """Power of the loads, power lost, power of the turning teeth [W].

    With the teeth's energy U(p, δ), δ = dᵀq - e: the turning teeth give ∂U/∂p p' - f e', and the damping takes
    v C v + c δ'². Together with the loads they change the energy of motion, springs and teeth.
    """
    n, r = v.size, tv.size
    given, lost, turning = 0.0, 0.0, 0.0
    for i in range(n):
        given += load[i] * v[i]
        lost += component_damping[i] * v[i] * v[i]
    for i in range(r):
        for j in range(r):
            lost += tv[i] * damping[i, j] * tv[j]
    if has_skew:
        for i in range(r):
            for j in range(r):
                lost += 0.5 * tv[i] * (stiffness[i, j] - stiffness[j, i]) * tq[j]
    for k in range(laws.shape[0]):
        turning += laws[k, PHASE_SLOPE] * phase_rate[k] * speed - laws[k, FORCE] * slip[k]
        lost += laws[k, DAMPING] * rate[k] * rate[k]
    out[0], out[1], out[2] = given, lost, turning


@inner()
def _friction_power(
    friction_row: IntArray, sliding: FloatArray, speed: float, dv: FloatArray, push: FloatArray, out: FloatArray
) -> None:
    """Power that friction takes from the nominal rotation, into out[3], and gives to the coordinates, into out[2] [W].

    The flanks slide by W s' in the nominal rotation and by w' beside it, and f (W s' + w') turns to heat. The former,
    Σ μ F_j |w_j| and never negative, comes from whatever turns the machine. The latter is small, and shakes the
    coordinates as often as it brakes them.
    """
    out[3] = 0.0
    for k in range(friction_row.size):
        row = friction_row[k]
        if row >= 0:
            out[2] -= push[row] * dv[row] + push[row + 1] * dv[row + 1]
            out[3] += (push[row] * sliding[k, 0] + push[row + 1] * sliding[k, 1]) * speed


@inner()
def _sample(
    contacts: Contacts,
    teeth: FloatArray,
    outputs: Outputs,
    samples: Samples,
    number: int,
    t: float,
    h: float,
    turned0: float,
    speed0: float,
    swing: float,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    q0: FloatArray,
    v0: FloatArray,
    a1: FloatArray,
    displaced: float,
    moved: float,
    x: FloatArray,
    y: FloatArray,
    laws: FloatArray,
    work: FloatArray,
) -> int:
    """Write the samples that fall into the step from t to t + h.

    Displacement and velocity by cubic Hermite interpolation, acceleration linear: errors below the step's own.
    """
    n = q.size
    while number - samples.offset < samples.force.shape[0]:
        time = samples.first + number * samples.interval
        if time > t + h:
            break
        row = number - samples.offset
        s = max((time - t) / h, 0.0)
        old, slope_old = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2 * h
        new, slope_new = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0) * h
        for i in range(n):
            q1, v1 = q0[i] + displaced * a1[i], v0[i] + moved * a1[i]
            x[i] = old * q[i] + slope_old * v[i] + new * q1 + slope_new * v1
            y[i] = old * v[i] + slope_old * a[i] + new * v1 + slope_new * a1[i]
        project(outputs.displacement, x, samples.displacement[row])
        project(outputs.velocity, y, samples.velocity[row])
        if contacts.phase.size > 0:
            after = s * h
            speed = speed0 + swing * after
            turned = turned0 + after * (speed0 + 0.5 * swing * after)
            project(teeth, x, samples.compression[row])
            project(teeth, y, work)
            for k in range(contacts.phase.size):
                gone, slip = deviation_of(contacts.clearance, contacts.errors, k, turned, speed)
                samples.compression[row, k] -= gone
                take_law(contacts, k, turned, samples.compression[row, k], work[k] - slip, laws, k)
                samples.force[row, k] = laws[k, FORCE]
        for i in range(n):
            x[i] = (1.0 - s) * a[i] + s * a1[i]
        project(outputs.acceleration, x, samples.acceleration[row])
        number += 1
    return number
