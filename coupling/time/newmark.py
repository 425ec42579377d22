r"""Newmark's method (Newmark-β): the time step in modal coordinates with tooth contacts, compiled.

One step of size h from (q, v, a), with the mass the identity and the contacts' directions D:

    q* = q + h v + (1/2 - β) h² a,            v* = v + (1 - γ) h a,
    S a₁ = F(t₁) - (K + P) q* - (C + s' G) v* - D f,
    q₁ = q* + β h² a₁,                        v₁ = v* + γ h a₁,

S and P as in :mod:`gearwhine.coupling.time.step_kernels`, where K and C are diagonal but for the connectors'
directions U. With W = S⁻¹ D and H = Dᵀ W only the few forces f of teeth and nonlinear bearings remain unknown: their
deflections

    δ = δ* - β h² H f(δ, δ'),    δ' = δ'* - γ h H f(δ, δ'),

δ* and δ'* being those without them, are found by Newton's method on a system as small as their number. Friction acts
along directions of its own, columns of D whose deflections no law needs. The projections Uᵀq and Dᵀq follow the same
recurrence as q.

Where connectors turn, D = V M(s) with constant columns V, which take the place of D in all but δ: only the few entries
of M follow the rotation (:mod:`gearwhine.coupling.connector_forces.turning_kernels`). With H = Mᵀ Vᵀ S⁻¹ V M and the
rate δ' = Dᵀ v + s' D'ᵀ q, in whose last term q is extrapolated with the last acceleration, q* + β h² a, the equations
for δ are those above. The error, β h² s' D'ᵀ (a₁ - a) c along a force c δ', is of third order, and adds up to nothing
over steps. s is the nominal time of :class:`gearwhine.coupling.SpeedProfile`, α = s'' the angular acceleration.
With β = 1/4, γ = 1/2 the step is of second order, unconditionally stable, and keeps the energy of an undamped linear
system.

The step evaluates the loads at its end, adds to the energy balance (powers of loads, losses and rotation, and stored
energy) and interpolates the output rows at the samples within it.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.contact_kernels import (
    DAMPING,
    ENERGY,
    FORCE,
    energy_at,
    evaluate_forces,
    evaluate_tangents,
    flank_gap,
    solve_contact_forces,
)
from gearwhine.coupling.connector_forces.dense_kernels import SUMS, add_rows, project, project_spans
from gearwhine.coupling.connector_forces.kernel_arrays import (
    APART,
    BEARING_ENERGY,
    BEARING_POWER,
    BY_DAMPING,
    BY_FRICTION,
    BY_LOADS,
    BY_ROTATION,
    BY_TIME,
    BY_UNBALANCE,
    DAMPING_LOSS,
    FRICTION_LOSS,
    IMPULSE,
    LARGEST_KINETIC,
    LAST_TOUCH,
    LOAD_WORK,
    PEAK,
    ROTATION_WORK,
    TWICE_KINETIC,
    Bearings,
    Contacts,
    Dynamics,
    Outputs,
    Samples,
    Scratch,
    Segments,
    StepMatrices,
    Turning,
)
from gearwhine.coupling.connector_forces.turning_kernels import (
    mix_columns,
    push_columns,
    set_laws_at_speed,
    turn_directions,
    turned_flexibility,
)
from gearwhine.coupling.time.step_kernels import add_gyroscopic, apply_base
from gearwhine.numerics.compiled import inner, uncounted

FloatArray = npt.NDArray[np.float64]


@inner(forceinline=True)
def load_at(dynamics: Dynamics, time: float, nominal_time: float, speed: float, alpha: float, out: FloatArray) -> None:
    """All loads at a time."""
    n, gained = out.size, speed * speed - 1.0
    for i in range(n):
        out[i] = dynamics.constant[i] + gained * dynamics.centrifugal[i] + alpha * dynamics.acceleration_load[i]
    for w in range(dynamics.frequency.size):
        frequency, follows = dynamics.frequency[w], dynamics.follows[w]
        angle = frequency * (time if follows == BY_TIME else nominal_time)
        cosine, sine = math.cos(angle), math.sin(angle)
        if follows == BY_UNBALANCE:
            # (s'² - i s''/Ω) e^{iws}: inertia force of an eccentric mass, by differentiating twice.
            square, side = speed * speed, alpha / dynamics.circling[w]
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


@inner(fastmath=SUMS, forceinline=True)
def stored_in(dynamics: Dynamics, stiffness: FloatArray, scratch: Scratch) -> float:
    """Energy in the teeth, in the nonlinear part of bearings, and in connectors that change with the speed [J].

    ``stiffness`` (r, r) is K_t.
    """
    energy, tq = scratch.bearing_work[BEARING_ENERGY], scratch.tq
    if dynamics.connector_speed_ratios.size > 1:
        for i in range(tq.size):
            for j in range(tq.size):
                energy += 0.5 * tq[i] * stiffness[i, j] * tq[j]
    for k in range(scratch.laws.shape[0]):
        energy += scratch.laws[k, ENERGY]
    return float(energy)


@inner(fastmath=SUMS, forceinline=True)
def evaluate_powers(
    dynamics: Dynamics,
    contacts: Contacts,
    stiffness: FloatArray,
    damping: FloatArray,
    speed: float,
    v: FloatArray,
    scratch: Scratch,
) -> None:
    """Powers of the loads, of the losses, of the rotation, and of friction from the nominal rotation [W].

    The last entry is twice the kinetic energy [J]. With the teeth's energy U(p, δ), δ = dᵀq - e: the rotating teeth
    give ∂U/∂p p' - f e', of which :func:`_work_on_teeth` adds the first, and the damping takes v C v + c δ'².
    Directions that turn give f s' D'ᵀq, as if e' were less by s' D'ᵀq; :func:`_add_turning` adds that of the bearings.
    Together with the loads they change the energy of motion, springs and teeth. ``stiffness`` and ``damping`` (r, r)
    are K_t and C_t.
    """
    tq, tv, laws = scratch.tq, scratch.tv, scratch.laws
    by_loads, by_damping, square = 0.0, 0.0, 0.0
    for i in range(v.size):
        by_loads += scratch.load[i] * v[i]
        by_damping += dynamics.damping[i] * v[i] * v[i]
        square += v[i] * v[i]
    for i in range(tv.size):
        for j in range(tv.size):
            by_damping += tv[i] * damping[i, j] * tv[j]
    if dynamics.has_skew:
        for i in range(tv.size):
            for j in range(tv.size):
                by_damping += 0.5 * tv[i] * (stiffness[i, j] - stiffness[j, i]) * tq[j]
    by_rotation = scratch.bearing_work[BEARING_POWER] * speed
    for k in range(laws.shape[0]):
        by_rotation -= laws[k, FORCE] * scratch.slip[k]
        by_damping += laws[k, DAMPING] * scratch.rate[k] * scratch.rate[k]
    powers = scratch.powers
    powers[BY_LOADS], powers[BY_DAMPING], powers[BY_ROTATION] = by_loads, by_damping, by_rotation
    powers[BY_FRICTION], powers[TWICE_KINETIC] = 0.0, square
    if scratch.push.size > scratch.delta.size:
        _add_friction(contacts, speed, scratch)


@inner()
def _add_turning(contacts: Contacts, bearings: Bearings, scratch: Scratch) -> None:
    """Add the powers of bearings that turn, and of the damping of linear ones [W].

    K δ does the work of ½ δᵀ K δ, and with the skew part of K takes ½ δ'ᵀ (K - Kᵀ) δ.
    """
    c, delta, rate, push, powers = contacts.phase.size, scratch.delta, scratch.rate, scratch.push, scratch.powers
    for k in range(c, delta.size):
        powers[BY_ROTATION] -= push[k] * scratch.slip[k]
    for number in range(bearings.damping.shape[0]):
        first, end = bearings.first[number], bearings.first[number + 1]
        for i in range(end - first):
            for j in range(end - first):
                lost = bearings.damping[number, i, j] * rate[c + first + j]
                lost -= 0.5 * (bearings.linear[number, i, j] - bearings.linear[number, j, i]) * delta[c + first + j]
                powers[BY_DAMPING] += rate[c + first + i] * lost


@inner()
def _add_friction(contacts: Contacts, speed: float, scratch: Scratch) -> None:
    """Add the powers of friction: from the nominal rotation, and to the coordinates [W].

    The flanks slide by W s' in the nominal rotation and by w' beside it, and f (W s' + w') turns to heat. f W s', which
    is Σ μ F_j |w_j| and never negative, comes from the drive of the machine. f w' is small, and excites the coordinates
    as often as it brakes them.
    """
    push, dv, powers = scratch.push, scratch.along_v, scratch.powers
    for k in range(contacts.friction_row.size):
        row = contacts.friction_row[k]
        if row >= 0:
            powers[BY_ROTATION] -= push[row] * dv[row] + push[row + 1] * dv[row + 1]
            sliding = push[row] * contacts.sliding[k, 0] + push[row + 1] * contacts.sliding[k, 1]
            powers[BY_FRICTION] += sliding * speed


@inner()
def _work_on_teeth(contacts: Contacts, nominal_time0: float, nominal_time: float, scratch: Scratch) -> float:
    """Work that the rotation does on the teeth in a step [J]: ∫ ∂U/∂p dp between two nominal times.

    It is the change of their energy with the phase alone, in the mean of that at the first compression and that at the
    last. ∂U/∂p jumps and ripples as the slices of helical teeth meet the corners of the profiles, often in one step:
    quadrature of it adds up errors that depend on where the steps fall, and that smaller steps need not make smaller.
    """
    laws, before, delta, rate, work = scratch.laws, scratch.laws_before, scratch.delta, scratch.rate, 0.0
    for k in range(contacts.phase.size):
        delta0, rate0 = scratch.delta_before[k], scratch.rate_before[k]
        work += energy_at(contacts, k, nominal_time, delta0, laws, delta[k], rate[k]) - before[k, ENERGY]
        work += laws[k, ENERGY] - energy_at(contacts, k, nominal_time0, delta[k], before, delta0, rate0)
    return 0.5 * work


@inner(forceinline=True)
def _keep_teeth(contacts: Contacts, scratch: Scratch) -> None:
    """Keep compressions, rates and laws of the teeth for the end of the next step."""
    for k in range(contacts.phase.size):
        scratch.delta_before[k], scratch.rate_before[k] = scratch.delta[k], scratch.rate[k]
        for column in range(ENERGY + 1):
            scratch.laws_before[k, column] = scratch.laws[k, column]


@inner()
def write_samples(
    contacts: Contacts,
    turning: Turning,
    outputs: Outputs,
    samples: Samples,
    number: int,
    t: float,
    h: float,
    nominal_time0: float,
    speed0: float,
    alpha: float,
    q: FloatArray,
    v: FloatArray,
    displaced: float,
    moved: float,
    scratch: Scratch,
) -> int:
    """Write the samples that fall into the step from t to t + h.

    Displacement and velocity are cubic Hermite interpolants, acceleration is linear: errors are below the step's own.
    """
    q_predicted, v_predicted, a, a1, x, y = (
        scratch.q_predicted,
        scratch.v_predicted,
        scratch.a,
        scratch.a_end,
        scratch.x,
        scratch.y,
    )
    laws, rates, n = scratch.spare, scratch.delta_free, q.size
    while number - samples.offset < samples.force.shape[0]:
        time = samples.first + number * samples.interval
        if time > t + h:
            break
        row = number - samples.offset
        s = max((time - t) / h, 0.0)
        old, slope_old = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2 * h
        new, slope_new = s * s * (3.0 - 2.0 * s), s * s * (s - 1.0) * h
        for i in range(n):
            q1, v1 = q_predicted[i] + displaced * a1[i], v_predicted[i] + moved * a1[i]
            x[i] = old * q[i] + slope_old * v[i] + new * q1 + slope_new * v1
            y[i] = old * v[i] + slope_old * a[i] + new * v1 + slope_new * a1[i]
        project_spans(outputs.displacement, outputs.displacement_spans, x, samples.displacement[row])
        project_spans(outputs.velocity, outputs.velocity_spans, y, samples.velocity[row])
        if contacts.phase.size > 0:
            after = s * h
            speed = speed0 + alpha * after
            nominal_time = nominal_time0 + after * (speed0 + 0.5 * alpha * after)
            # The projections on the directions are interpolated as the coordinates are.
            for k in range(scratch.dq.size):
                q1 = scratch.dq_predicted[k] + displaced * scratch.da[k]
                v1 = scratch.dv_predicted[k] + moved * scratch.da[k]
                scratch.dq_free[k] = old * scratch.dq[k] + slope_old * scratch.dv[k] + new * q1 + slope_new * v1
                a0, a_last = scratch.da_before[k], scratch.da[k]
                scratch.dv_free[k] = old * scratch.dv[k] + slope_old * a0 + new * v1 + slope_new * a_last
            compression = samples.compression[row]
            if turning.rates.size > 0:
                _deflections_of_sample(turning, nominal_time, speed, compression, scratch)
            else:
                for k in range(compression.size):
                    compression[k], rates[k] = scratch.dq_free[k], scratch.dv_free[k]
            for k in range(contacts.phase.size):
                gone, slip = flank_gap(contacts.clearance, contacts.errors, k, nominal_time, speed)
                compression[k] -= gone
                evaluate_tangents(contacts, k, nominal_time, compression[k], rates[k] - slip, laws)
                samples.force[row, k] = laws[k, FORCE]
        for i in range(n):
            x[i] = (1.0 - s) * a[i] + s * a1[i]
        project_spans(outputs.acceleration, outputs.acceleration_spans, x, samples.acceleration[row])
        number += 1
    return number


@inner()
def _deflections_of_sample(
    turning: Turning, nominal_time: float, speed: float, compression: FloatArray, scratch: Scratch
) -> None:
    """Compression of the contacts (c,) at the sample in ``scratch``, and its rate into its ``delta_free``, by D(s)."""
    mix, mix_rate, carried = scratch.sample_mix, scratch.sample_mix_rate, scratch.carried
    turn_directions(turning, nominal_time, speed, mix, mix_rate)
    mix_columns(turning, mix, scratch.dq_free, compression)
    mix_columns(turning, mix, scratch.dv_free, scratch.delta_free)
    mix_columns(turning, mix_rate, scratch.dq_free, carried)
    for k in range(compression.size):
        scratch.delta_free[k] += carried[k]


# Contacts are evaluated by this part of a segment inside its ends, so that a pair that enters or leaves exactly
# there counts on one side only.
INSIDE = 1e-7


@uncounted()
def newmark_steps(
    q: FloatArray,
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    turning: Turning,
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
    """Newmark's method through some segments; q and v are replaced by those at the end.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
        State at the start, replaced by that at the end.
    next_sample : int
        Number of the first sample not yet written.
    stored : float
        Energy just before the first segment in the teeth, in the nonlinear part of bearings, and in the connectors
        where they change with the speed [J].
    totals : ndarray, shape (5,)
        Work of the loads, energy lost to damping, work of the rotation on contacts, bearings and connectors (added to),
        the largest kinetic energy, and the energy that friction takes from the nominal rotation (added to) [J].
    contact_totals : ndarray, shape (c, 4)
        For each contact ∫ force dt [N s], time apart [s] (both added to), the largest force [N], and when the flanks
        last touched [s].

    Returns
    -------
    next_sample : int
    stored : float
        Stored energy at the end [J].
    curvature : float
        Σ |a₁ - 2 a + a₋₁|² over the steps that have two before them, of the coordinates to be resolved.
    acceleration : float
        Σ |a₁|² over the same steps and coordinates.
    unsettled : int
        Steps whose contact forces did not converge in Newton's iteration.
    """
    curvature, acceleration, unsettled = 0.0, 0.0, 0
    for segment in range(segments.start.size):
        t0, t1, count = segments.start[segment], segments.end[segment], segments.steps[segment]
        nominal_time0, speed0, alpha = (
            segments.nominal_time[segment, 0],
            segments.nominal_time[segment, 1],
            segments.nominal_time[segment, 2],
        )
        slot, h, inside = segments.slot[segment], (t1 - t0) / count, INSIDE * (t1 - t0)
        speed = speed0 + alpha * inside
        nominal_time = nominal_time0 + inside * (speed0 + 0.5 * alpha * inside)
        middle_speed = speed0 + 0.5 * alpha * (t1 - t0)
        positioned = dynamics.has_frames or alpha != 0.0
        load_at(dynamics, t0, nominal_time0, speed0, alpha, scratch.load)
        if turning.speed_ratios.size > 0:
            set_laws_at_speed(turning, bearings, middle_speed)
        fresh = _start_segment(
            q, v, dynamics, contacts, turning, bearings, matrices, slot, nominal_time, speed, middle_speed,
            positioned, scratch,
        )  # fmt: skip
        totals[ROTATION_WORK] += fresh - stored
        stored, evaluated = fresh, nominal_time
        for step in range(count):
            t, after = t0 + step * h, (step + 1) * h
            speed = speed0 + alpha * after
            nominal_time = nominal_time0 + after * (speed0 + 0.5 * alpha * after)
            load_at(dynamics, t0 + after, nominal_time, speed, alpha, scratch.load)
            _predict(q, v, dynamics, h, scratch)
            _accelerations_without_contact(dynamics, matrices, slot, h, positioned, scratch)
            if step == count - 1:
                # The teeth are last evaluated just inside the segment.
                speed = speed0 + alpha * (after - inside)
                nominal_time = nominal_time0 + (after - inside) * (speed0 + 0.5 * alpha * (after - inside))
            if not _contact_response(
                dynamics, contacts, turning, bearings, matrices, slot, h, nominal_time, speed, scratch
            ):
                unsettled += 1
            if samples.first + next_sample * samples.interval <= t + h:
                before = step * h
                next_sample = write_samples(
                    contacts, turning, outputs, samples, next_sample, t, h,
                    nominal_time0 + before * (speed0 + 0.5 * alpha * before), speed0 + alpha * before, alpha,
                    q, v, dynamics.beta * h * h, dynamics.gamma * h, scratch,
                )  # fmt: skip
            if step > 0:
                curved, size = _curvature(dynamics.resolved, scratch.before, scratch.a, scratch.a_end)
                curvature += curved
                acceleration += size
            if positioned:
                for i in range(q.size):
                    scratch.q_before[i] = q[i]
            _correct(q, v, dynamics, h, scratch)
            if positioned:
                totals[ROTATION_WORK] += _position_work(q, dynamics, matrices, slot, scratch)
            stored = _accumulate(
                v, dynamics, contacts, turning, bearings, matrices, slot, t, h, evaluated, nominal_time, speed, totals,
                contact_totals, scratch,
            )  # fmt: skip
            evaluated = nominal_time
    return next_sample, stored, curvature, acceleration, unsettled


@inner(forceinline=True)
def _start_segment(
    q: FloatArray,
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    turning: Turning,
    bearings: Bearings,
    matrices: StepMatrices,
    slot: int,
    nominal_time: float,
    speed: float,
    middle_speed: float,
    positioned: bool,
    scratch: Scratch,
) -> float:
    """Accelerations and powers just inside a segment with given loads; returns the energy in teeth and connectors.

    The touching pairs change at the event: forces, powers and energy start anew from the new set of pairs.
    """
    a, dq, dv, push = scratch.a, scratch.dq, scratch.dv, scratch.push
    project(dynamics.connectors, q, scratch.tq)
    project(dynamics.connectors, v, scratch.tv)
    project_spans(contacts.direction, contacts.spans, q, dq)
    project_spans(contacts.direction, contacts.spans, v, dv)
    _deflections(contacts, turning, nominal_time, speed, dq, dv, dq, scratch.delta, scratch.rate, scratch)
    evaluate_forces(contacts, bearings, nominal_time, scratch)
    for j in range(push.size):
        scratch.push_before[j], scratch.push_change[j] = push[j], 0.0
    for i in range(a.size):
        a[i] = scratch.load[i] - dynamics.stiffness[i] * q[i] - dynamics.damping[i] * v[i]
    blocks, first, size, work = dynamics.gyroscopic, dynamics.block_start, dynamics.block_size, scratch.block
    add_gyroscopic(blocks, first, size, -middle_speed, v, a, work)
    if positioned:
        _evaluate_position_force(q, dynamics, matrices, slot, scratch)
        for i in range(a.size):
            a[i] += scratch.position_force[i]
    _connector_forces(matrices, slot, scratch.tq, scratch.tv, scratch)
    add_rows(dynamics.connectors, scratch.connector_force, -1.0, a)
    pushed = push
    if turning.rates.size > 0:
        push_columns(turning, scratch.mix, push, scratch.pushed)
        pushed = scratch.pushed
    add_rows(contacts.direction, pushed, -1.0, a)
    project(dynamics.connectors, a, scratch.ta)
    project_spans(contacts.direction, contacts.spans, a, scratch.da)
    evaluate_powers(
        dynamics, contacts, matrices.connector_stiffness[slot], matrices.connector_damping[slot], speed, v, scratch
    )
    if turning.rates.size > 0:
        _add_turning(contacts, bearings, scratch)
    for k in range(scratch.powers.size):
        scratch.powers_before[k] = scratch.powers[k]
    _keep_teeth(contacts, scratch)
    return stored_in(dynamics, matrices.connector_stiffness[slot], scratch)


@inner(forceinline=True)
def _deflections(
    contacts: Contacts,
    turning: Turning,
    nominal_time: float,
    speed: float,
    dq: FloatArray,
    dv: FloatArray,
    dq_carried: FloatArray,
    delta: FloatArray,
    rate: FloatArray,
    scratch: Scratch,
) -> None:
    """Deflections and rates of the laws (e + c,), by projections of displacements and rates on their columns.

    Rates of bearings are those of directions that turn alone; no other law of a bearing has damping. ``dq_carried``
    (m,) are the projections of the displacements that directions that turn move past.
    """
    c, along_q, along_v = contacts.phase.size, dq, dv
    if turning.rates.size > 0:
        turn_directions(turning, nominal_time, speed, scratch.mix, scratch.mix_rate)
        mix_columns(turning, scratch.mix, dq, scratch.along_q)
        mix_columns(turning, scratch.mix, dv, scratch.along_v)
        mix_columns(turning, scratch.mix_rate, dq_carried, scratch.carried)
        along_q, along_v = scratch.along_q, scratch.along_v
    for k in range(c):
        gone, scratch.slip[k] = flank_gap(contacts.clearance, contacts.errors, k, nominal_time, speed)
        delta[k], rate[k] = along_q[k] - gone, along_v[k] - scratch.slip[k]
    for k in range(c, delta.size):
        delta[k] = along_q[k]
    if turning.rates.size > 0:
        for k in range(delta.size):
            scratch.slip[k] = (scratch.slip[k] if k < c else 0.0) - scratch.carried[k]
            rate[k] = along_v[k] - scratch.slip[k]


@inner()
def _evaluate_position_force(
    q: FloatArray, dynamics: Dynamics, matrices: StepMatrices, slot: int, scratch: Scratch
) -> None:
    """Evaluate -P q: centrifugal and circulatory forces, and that of a drive on a tilted shaft that accelerates."""
    force = scratch.position_force
    for i in range(force.size):
        force[i] = 0.0
    first, size = dynamics.block_start, dynamics.block_size
    add_gyroscopic(matrices.position[slot], first, size, -1.0, q, force, scratch.block)


@inner()
def _position_work(q: FloatArray, dynamics: Dynamics, matrices: StepMatrices, slot: int, scratch: Scratch) -> float:
    """Work of the forces -P q in a step [J], in the mean of both ends: it is exact for their symmetric part."""
    before, work = scratch.q_before, 0.0
    for i in range(q.size):
        work += (q[i] - before[i]) * scratch.position_force[i]
    _evaluate_position_force(q, dynamics, matrices, slot, scratch)
    for i in range(q.size):
        work += (q[i] - before[i]) * scratch.position_force[i]
    return 0.5 * work


@inner(forceinline=True)
def _connector_forces(matrices: StepMatrices, slot: int, tq: FloatArray, tv: FloatArray, scratch: Scratch) -> None:
    """Evaluate connector forces at displacements and rates along the connectors: K_t Uᵀq + C_t Uᵀv."""
    project(matrices.connector_stiffness[slot], tq, scratch.connector_force)
    project(matrices.connector_damping[slot], tv, scratch.response)
    for j in range(tq.size):
        scratch.connector_force[j] += scratch.response[j]


@inner(forceinline=True)
def _predict(q: FloatArray, v: FloatArray, dynamics: Dynamics, h: float, scratch: Scratch) -> None:
    """Predictor q* and v*, and its projections on the directions of connectors and laws."""
    old, new = (0.5 - dynamics.beta) * h * h, (1.0 - dynamics.gamma) * h
    q_predicted, v_predicted, a = scratch.q_predicted, scratch.v_predicted, scratch.a
    for i in range(q.size):
        q_predicted[i] = q[i] + h * v[i] + old * a[i]
        v_predicted[i] = v[i] + new * a[i]
    for j in range(scratch.tq.size):
        scratch.tq_predicted[j] = scratch.tq[j] + h * scratch.tv[j] + old * scratch.ta[j]
        scratch.tv_predicted[j] = scratch.tv[j] + new * scratch.ta[j]
    for k in range(scratch.dq.size):
        scratch.dq_predicted[k] = scratch.dq[k] + h * scratch.dv[k] + old * scratch.da[k]
        scratch.dv_predicted[k] = scratch.dv[k] + new * scratch.da[k]


@inner(forceinline=True)
def _accelerations_without_contact(
    dynamics: Dynamics, matrices: StepMatrices, slot: int, h: float, positioned: bool, scratch: Scratch
) -> None:
    """Accelerations without the forces of the laws, into ``a_end``, and their projections on the connectors."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    per_moved, ratio = 1.0 / moved, displaced / moved
    q_predicted, v_predicted, unbalanced, a_end = (
        scratch.q_predicted,
        scratch.v_predicted,
        scratch.unbalanced,
        scratch.a_end,
    )
    for i in range(q_predicted.size):
        unbalanced[i] = scratch.load[i] - dynamics.stiffness[i] * q_predicted[i] - dynamics.damping[i] * v_predicted[i]
    first, size, work = dynamics.block_start, dynamics.block_size, scratch.block
    # With D the diagonal of S₀ = D + γ h s' G + β h² P, S₀ (a + v*/γh) = r + D v*/γh + s' G v* + β/γ h P v*: the
    # gyroscopic part comes without a product of its own, as r has -s' G v*, and that of P with one, P (q* - β/γ h v*).
    if positioned:
        shifted = scratch.x
        for i in range(shifted.size):
            shifted[i] = q_predicted[i] - ratio * v_predicted[i]
        add_gyroscopic(matrices.position[slot], first, size, -1.0, shifted, unbalanced, work)
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        part, rates, stiffness, damping = (
            unbalanced[among],
            v_predicted[among],
            dynamics.stiffness[among],
            dynamics.damping[among],
        )
        for i in range(part.size):
            part[i] += rates[i] * (per_moved + damping[i] + ratio * stiffness[i])
    apply_base(matrices.base[slot], matrices.blocks[slot], first, size, unbalanced, a_end, work)
    for g in range(first.size):
        among = slice(first[g], first[g] + size[g])
        part, rates = a_end[among], v_predicted[among]
        for i in range(part.size):
            part[i] -= rates[i] * per_moved

    # a = B (r - U y) - B U woodbury (Uᵀ B (r - U y)), y the connectors' forces.
    ta_end, connector_force, response = scratch.ta_end, scratch.connector_force, scratch.response
    flexibility = matrices.connector_flexibility[slot]
    project(dynamics.connectors, a_end, ta_end)
    _connector_forces(matrices, slot, scratch.tq_predicted, scratch.tv_predicted, scratch)
    project(flexibility, connector_force, response)
    for j in range(ta_end.size):
        response[j] = ta_end[j] - response[j]
    project(matrices.woodbury[slot], response, scratch.correction)
    for j in range(ta_end.size):
        connector_force[j] += scratch.correction[j]
    add_rows(matrices.connectors[slot], connector_force, -1.0, a_end)
    project(flexibility, connector_force, response)
    for j in range(ta_end.size):
        ta_end[j] -= response[j]


@inner(forceinline=True)
def _contact_response(
    dynamics: Dynamics,
    contacts: Contacts,
    turning: Turning,
    bearings: Bearings,
    matrices: StepMatrices,
    slot: int,
    h: float,
    nominal_time: float,
    speed: float,
    scratch: Scratch,
) -> bool:
    """Solve for the contact forces by Newton's iteration, with the accelerations; return whether it converged."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    a_end, da, delta, rate = scratch.a_end, scratch.da, scratch.delta_free, scratch.rate_free
    if delta.size == 0:
        return True
    of_columns, turns = matrices.flexibility[slot], turning.rates.size > 0
    for j in range(da.size):
        scratch.da_before[j] = da[j]
    if turns:
        for j in range(da.size):
            scratch.dq_carried[j] = scratch.dq_predicted[j] + displaced * da[j]
    project_spans(contacts.direction, contacts.spans, a_end, da)
    for j in range(da.size):
        scratch.dq_free[j] = scratch.dq_predicted[j] + displaced * da[j]
        scratch.dv_free[j] = scratch.dv_predicted[j] + moved * da[j]
    _deflections(
        contacts, turning, nominal_time, speed, scratch.dq_free, scratch.dv_free, scratch.dq_carried, delta, rate,
        scratch,
    )  # fmt: skip
    flexibility, pushed = of_columns, scratch.push
    if turns:
        turned_flexibility(turning, scratch.mix, of_columns, scratch.mixed, scratch.mixed_across, scratch.flexibility)
        flexibility, pushed = scratch.flexibility, scratch.pushed
    converged = solve_contact_forces(contacts, bearings, nominal_time, flexibility, displaced, moved, scratch)
    if turns:
        push_columns(turning, scratch.mix, scratch.push, pushed)
    add_rows(matrices.contact[slot], pushed, -1.0, a_end)
    add_rows(matrices.contact_connectors[slot], pushed, -1.0, scratch.ta_end)
    if turns:
        project(of_columns, pushed, scratch.dq_free)
        for j in range(da.size):
            da[j] -= scratch.dq_free[j]
        return converged
    for j in range(da.size):
        for k in range(pushed.size):
            da[j] -= of_columns[j, k] * pushed[k]
    return converged


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
def _correct(q: FloatArray, v: FloatArray, dynamics: Dynamics, h: float, scratch: Scratch) -> None:
    """Corrector: the state at the step's end, and its projections on the directions of connectors and laws."""
    displaced, moved = dynamics.beta * h * h, dynamics.gamma * h
    a, before, a_end, q_predicted, v_predicted = (
        scratch.a,
        scratch.before,
        scratch.a_end,
        scratch.q_predicted,
        scratch.v_predicted,
    )
    for i in range(q.size):
        before[i], a[i] = a[i], a_end[i]
        q[i], v[i] = q_predicted[i] + displaced * a_end[i], v_predicted[i] + moved * a_end[i]
    for j in range(scratch.ta.size):
        value = scratch.ta_end[j]
        scratch.ta[j] = value
        scratch.tq[j], scratch.tv[j] = (
            scratch.tq_predicted[j] + displaced * value,
            scratch.tv_predicted[j] + moved * value,
        )
    for k in range(scratch.da.size):
        value = scratch.da[k]
        scratch.dq[k], scratch.dv[k] = (
            scratch.dq_predicted[k] + displaced * value,
            scratch.dv_predicted[k] + moved * value,
        )


@inner(forceinline=True)
def _accumulate(
    v: FloatArray,
    dynamics: Dynamics,
    contacts: Contacts,
    turning: Turning,
    bearings: Bearings,
    matrices: StepMatrices,
    slot: int,
    t: float,
    h: float,
    nominal_time0: float,
    nominal_time: float,
    speed: float,
    totals: FloatArray,
    contact_totals: FloatArray,
    scratch: Scratch,
) -> float:
    """Add a step's work, losses and contact figures; returns the energy in teeth and connectors at its end.

    The teeth were last evaluated at the nominal times ``nominal_time0``, before the step, and ``nominal_time``.
    """
    powers, powers_before = scratch.powers, scratch.powers_before
    if turning.rates.size > 0:
        mix_columns(turning, scratch.mix, scratch.dv, scratch.along_v)
    evaluate_powers(
        dynamics, contacts, matrices.connector_stiffness[slot], matrices.connector_damping[slot], speed, v, scratch
    )
    if turning.rates.size > 0:
        _add_turning(contacts, bearings, scratch)
    totals[LOAD_WORK] += 0.5 * h * (powers_before[BY_LOADS] + powers[BY_LOADS])
    totals[DAMPING_LOSS] += 0.5 * h * (powers_before[BY_DAMPING] + powers[BY_DAMPING])
    totals[ROTATION_WORK] += 0.5 * h * (powers_before[BY_ROTATION] + powers[BY_ROTATION])
    totals[ROTATION_WORK] += _work_on_teeth(contacts, nominal_time0, nominal_time, scratch)
    totals[FRICTION_LOSS] += 0.5 * h * (powers_before[BY_FRICTION] + powers[BY_FRICTION])
    totals[LARGEST_KINETIC] = max(totals[LARGEST_KINETIC], 0.5 * powers[TWICE_KINETIC])
    for k in range(powers.size):
        powers_before[k] = powers[k]
    for k in range(contacts.phase.size):
        force = scratch.laws[k, FORCE]
        contact_totals[k, IMPULSE] += 0.5 * h * (scratch.laws_before[k, FORCE] + force)
        if force == 0.0:
            contact_totals[k, APART] += h
        else:
            contact_totals[k, LAST_TOUCH] = t + h
        contact_totals[k, PEAK] = max(contact_totals[k, PEAK], force)
    _keep_teeth(contacts, scratch)
    return stored_in(dynamics, matrices.connector_stiffness[slot], scratch)
