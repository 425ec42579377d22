r"""Rolling-bearing law, compiled: forces and tangent stiffness by the ring's deflections and the cage angle.

The laws of a ball at the azimuth ψ and of a roller's slice are those of
:mod:`gearwhine.rotors.rolling_bearings.element_contacts` and :mod:`gearwhine.rotors.rolling_bearings.roller_slices`,
without inertia. Added is the slope of the energy over ψ, by which the rotating cage does work on the balls: with the
ball's forces (f_r, f_z) in its plane and its motions (m_r, m_z) by the ring's,

    ∂U/∂ψ = f_r ∂m_r/∂ψ + f_z ∂m_z/∂ψ.

Over a spall an element drops by d (:mod:`gearwhine.rotors.rolling_bearings.spalls`): its approach is as much less, and
the energy changes by -Q d' more, Q the element's load.

The outer ring of a floating bearing takes the place along z at which the elements have no axial force; forces and
tangent are condensed over it, see :mod:`gearwhine.rotors.rolling_bearings.equilibrium`. As the energy is least there,
its slope over ψ is that at the place held.

A gap of radius g around the shaft pushes with F ((r - g) / depth)^n against the radius r.

Importing this module imports numba.
"""

import math

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.connector_forces.kernel_arrays import BALLS, BEARING_ENERGY, BEARING_POWER, ROLLERS, Bearings
from gearwhine.numerics.compiled import counted, inner, uncounted

FloatArray = npt.NDArray[np.float64]

# Step of a floating ring along z at which its iteration ends [m], and the largest number of steps.
_SEATED = 1e-14
_SEATING_STEPS = 100


@inner()
def _rolled(bearings: Bearings, row: int, nominal_time: float) -> tuple[float, float]:
    """Time for which a cage has rolled, and its rate by the nominal time: 1 but for the scatter of its slip."""
    step = bearings.slip_step[row]
    if step == 0.0:
        return nominal_time, 1.0
    passes = bearings.slipped.shape[1] - 1
    place = nominal_time / step
    number = math.floor(place)
    rounds = math.floor(number / passes)
    within = int(number - rounds * passes)
    before, after = bearings.slipped[row, within], bearings.slipped[row, within + 1]
    beyond = rounds * bearings.slipped[row, passes] + before + (place - number) * (after - before)
    return nominal_time + beyond, 1.0 + (after - before) / step


@inner()
def _drop(
    bearings: Bearings,
    row: int,
    element: int,
    azimuth: float,
    cage_rate: float,
    nominal_time: float,
    rolled: float,
    rolling: float,
    place: float,
) -> tuple[float, float]:
    """Drop of an element at an azimuth into the spalls of its row [m], and its rate by the nominal time [m/s].

    ``place`` is that of a slice of a roller over half its length, from the middle.
    """
    total, rate = 0.0, 0.0
    for number in range(bearings.first_spall[row], bearings.first_spall[row + 1]):
        spall = bearings.spalls[number]
        if spall[0] < 0.0:
            angle, turning = azimuth - spall[1] - spall[2] * nominal_time, cage_rate - spall[2]
        elif spall[0] == element:
            angle, turning = spall[1] + spall[2] * rolled, spall[2] * rolling
        else:
            continue
        angle -= 2.0 * math.pi * math.floor(0.5 * angle / math.pi + 0.5)
        inside = spall[3] - abs(angle)
        if inside <= 0.0 or abs(place) > spall[8]:
            continue
        damaged, other, slope, deep, steep = spall[4], spall[5], spall[6], spall[7], 0.0
        edge = slope * inside
        across = damaged * math.sin(edge)
        if abs(across) < abs(other):
            root = math.copysign(math.sqrt(other * other - across * across), other)
            on_edge = 2.0 * damaged * math.sin(0.5 * edge) ** 2 + across * across / (other + root)
            if on_edge < deep:
                deep, steep = on_edge, across * (1.0 + damaged * math.cos(edge) / root)
        total += deep
        rate -= (slope if angle > 0.0 else -slope) * steep * turning
    return total, rate


@inner()
def _balls(
    bearings: Bearings, row: int, nominal_time: float, q: FloatArray, force: FloatArray, tangent: FloatArray
) -> tuple[float, float]:
    """Add the forces and tangent of a row of balls; returns its energy [J] and its slope by the nominal time [J/s]."""
    shape, count, cage = bearings.shape[row], bearings.elements[row], bearings.cage[row]
    rolled, rolling = _rolled(bearings, row, nominal_time)
    angle, cage_rate = cage[0] + cage[1] * rolled + cage[2] * nominal_time, cage[1] * rolling + cage[2]
    distance, start_r, start_z, before = shape[0], shape[1], shape[2], shape[3]
    reach, place, stiffness = shape[4], shape[5], shape[6]
    energy, slope = 0.0, 0.0
    for ball in range(count):
        azimuth = angle + 2.0 * math.pi * ball / count + bearings.spacing[row, ball]
        c, s = math.cos(azimuth), math.sin(azimuth)
        tilt, swing = q[4] * c - q[3] * s, -q[4] * s - q[3] * c
        moved_r, moved_z = q[0] * c + q[1] * s + place * tilt, q[2] - reach * tilt
        v_r, v_z = start_r + moved_r, start_z + moved_z
        length = math.sqrt(v_r * v_r + v_z * v_z)
        # |v|² - A² by its terms: |v| - A itself would lose the digits that A has and the approach has not.
        excess = before + 2.0 * (moved_r * start_r + moved_z * start_z) + moved_r * moved_r + moved_z * moved_z
        drop, drop_rate = _drop(bearings, row, ball, azimuth, cage_rate, nominal_time, rolled, rolling, 0.0)
        deep = excess / (length + distance) - drop
        if deep <= 0.0:
            continue
        n_r, n_z = v_r / length, v_z / length
        root = stiffness * math.sqrt(deep)
        load, steep = root * deep, 1.5 * root
        flat = load / length
        k_rr, k_rz = steep * n_r * n_r + flat * n_z * n_z, (steep - flat) * n_r * n_z
        k_zz = steep * n_z * n_z + flat * n_r * n_r
        f_r, f_z = load * n_r, load * n_z
        across, along = (c, s, 0.0, -place * s, place * c), (0.0, 0.0, 1.0, reach * s, -reach * c)
        for i in range(5):
            force[i] += f_r * across[i] + f_z * along[i]
            by_r, by_z = k_rr * across[i] + k_rz * along[i], k_rz * across[i] + k_zz * along[i]
            for j in range(5):
                tangent[i, j] += by_r * across[j] + by_z * along[j]
        energy += 0.4 * load * deep
        slope += cage_rate * (f_r * (q[1] * c - q[0] * s + place * swing) - f_z * reach * swing) - load * drop_rate
    return energy, slope


@inner()
def _rollers(
    bearings: Bearings, row: int, nominal_time: float, q: FloatArray, force: FloatArray, tangent: FloatArray
) -> tuple[float, float]:
    """Add the forces and tangent of a row of rollers in slices (n, 2): arm of the normal, gap of the profile."""
    shape, slices, count, cage = (
        bearings.shape[row],
        bearings.slices[row],
        bearings.elements[row],
        bearings.cage[row],
    )
    rolled, rolling = _rolled(bearings, row, nominal_time)
    angle, cage_rate = cage[0] + cage[1] * rolled + cage[2] * nominal_time, cage[1] * rolling + cage[2]
    free, stiffness, number, across, along = shape[0], shape[1], int(shape[2]), shape[3], shape[4]
    energy, slope = 0.0, 0.0
    for roller in range(count):
        azimuth = angle + 2.0 * math.pi * roller / count + bearings.spacing[row, roller]
        c, s = math.cos(azimuth), math.sin(azimuth)
        level, tilt = across * (q[0] * c + q[1] * s) + along * q[2] + free, q[4] * c - q[3] * s
        level_slope, tilt_slope = across * (q[1] * c - q[0] * s), -q[4] * s - q[3] * c
        load, moment, k, k_place, k_square = 0.0, 0.0, 0.0, 0.0, 0.0
        # All spalls are in the middle: where it has no drop no slice has one.
        dropped = _drop(bearings, row, roller, azimuth, cage_rate, nominal_time, rolled, rolling, 0.0)[0] > 0.0
        for slice_number in range(number):
            place, drop, drop_rate = slices[slice_number, 0], 0.0, 0.0
            if dropped:
                along_roller = (2.0 * slice_number + 1.0 - number) / number
                drop, drop_rate = _drop(
                    bearings, row, roller, azimuth, cage_rate, nominal_time, rolled, rolling, along_roller
                )
            deep = level + place * tilt - slices[slice_number, 1] - drop
            if deep <= 0.0:
                continue
            root = stiffness * deep ** (1.0 / 9.0)
            push, steep = root * deep, (10.0 / 9.0) * root
            load += push
            moment += push * place
            k += steep
            k_place += steep * place
            k_square += steep * place * place
            energy += (9.0 / 19.0) * push * deep
            slope -= push * drop_rate
        if k == 0.0:
            continue
        slope += cage_rate * (load * level_slope + moment * tilt_slope)
        # A roller feels its approach in the middle, by x, y and z, and its tilt, by the rotations.
        middle, turn = (across * c, across * s, along), (-s, c)
        for i in range(3):
            force[i] += load * middle[i]
            for j in range(3):
                tangent[i, j] += k * middle[i] * middle[j]
            for j in range(2):
                tangent[i, 3 + j] += k_place * middle[i] * turn[j]
                tangent[3 + j, i] += k_place * middle[i] * turn[j]
        for i in range(2):
            force[3 + i] += moment * turn[i]
            for j in range(2):
                tangent[3 + i, 3 + j] += k_square * turn[i] * turn[j]
    return energy, slope


@inner()
def _gap(shape: FloatArray, q: FloatArray, force: FloatArray, tangent: FloatArray) -> float:
    """Add the force and tangent of a closed gap; returns its energy [J]."""
    unit, depth, exponent, gap = shape[0], shape[1], shape[2], shape[3]
    radius = math.sqrt(q[0] * q[0] + q[1] * q[1])
    deep = radius - gap
    if deep <= 0.0:
        if gap == 0.0 and exponent == 1.0:
            tangent[0, 0] += unit / depth
            tangent[1, 1] += unit / depth
        return 0.0
    push = unit * (deep / depth) ** exponent
    steep, flat = exponent * push / deep, push / radius
    n_x, n_y = q[0] / radius, q[1] / radius
    force[0] += push * n_x
    force[1] += push * n_y
    tangent[0, 0] += steep * n_x * n_x + flat * n_y * n_y
    tangent[0, 1] += (steep - flat) * n_x * n_y
    tangent[1, 0] += (steep - flat) * n_x * n_y
    tangent[1, 1] += steep * n_y * n_y + flat * n_x * n_x
    return float(push * deep / (exponent + 1.0))


@inner()
def _rows(
    bearings: Bearings, number: int, nominal_time: float, q: FloatArray, force: FloatArray, tangent: FloatArray
) -> tuple[float, float]:
    """Force and tangent of all rows, overwritten, with the ring held at q; returns energy [J] and its slope [J/s]."""
    for i in range(5):
        force[i] = 0.0
        for j in range(5):
            tangent[i, j] = 0.0
    energy, slope = 0.0, 0.0
    for row in range(bearings.first_row[number], bearings.first_row[number + 1]):
        kind = bearings.kind[row]
        if kind == BALLS:
            added, by_time = _balls(bearings, row, nominal_time, q, force, tangent)
        elif kind == ROLLERS:
            added, by_time = _rollers(bearings, row, nominal_time, q, force, tangent)
        else:
            added, by_time = _gap(bearings.shape[row], q, force, tangent), 0.0
        energy += added
        slope += by_time
    return energy, slope


@inner()
def _release(force: FloatArray, tangent: FloatArray) -> float:
    """Condense the free axis z out of force and tangent; returns the energy released by moving to the minimum [J]."""
    push, stiffness = force[2], tangent[2, 2]
    if stiffness > 0.0:
        for i in range(5):
            if i != 2:
                force[i] -= push / stiffness * tangent[i, 2]
                for j in range(5):
                    if j != 2:
                        tangent[i, j] -= tangent[i, 2] * tangent[2, j] / stiffness
    force[2] = 0.0
    for i in range(5):
        tangent[i, 2] = 0.0
        tangent[2, i] = 0.0
    return float(0.5 * push * push / stiffness) if stiffness > 0.0 else 0.0


@uncounted()
def bearing_force(
    bearings: Bearings, number: int, nominal_time: float, q: FloatArray, force: FloatArray, tangent: FloatArray
) -> tuple[float, float]:
    """Force (5,) of the shaft on a bearing displaced by q (5,), and its tangent (5, 5); both are overwritten.

    For a floating bearing, z in q is the start of the search for the ring's place along z, and becomes that place.

    Returns
    -------
    energy : float
        Energy [J].
    slope : float
        Derivative of the energy by the nominal time [J/s]: the power of the rotating cage at nominal speed.
    """
    energy, slope = _rows(bearings, number, nominal_time, q, force, tangent)
    if bearings.floating[number]:
        low, high = -math.inf, math.inf
        for _ in range(_SEATING_STEPS):
            stiffness = tangent[2, 2]
            if stiffness <= 0.0 or abs(force[2]) <= _SEATED * stiffness:
                break
            if force[2] > 0.0:
                high = q[2]
            else:
                low = q[2]
            place = q[2] - force[2] / stiffness
            q[2] = place if low < place < high else 0.5 * (low + high)
            energy, slope = _rows(bearings, number, nominal_time, q, force, tangent)
        return energy - _release(force, tangent), slope
    preload = bearings.preload[number]
    force[2] -= preload
    return energy - preload * q[2], slope


@inner()
def _linear_law(linear: FloatArray, delta: FloatArray, force: FloatArray, tangent: FloatArray) -> float:
    """Force -K δ (d,) of a law without rolling elements, and its tangent; returns its energy -½ δᵀ K δ [J]."""
    energy = 0.0
    for i in range(delta.size):
        value = 0.0
        for j in range(delta.size):
            value += linear[i, j] * delta[j]
            tangent[i, j] = -linear[i, j]
        force[i] = -value
        energy -= 0.5 * delta[i] * value
    return energy


@uncounted()
def evaluate_bearings(
    bearings: Bearings,
    offset: int,
    nominal_time: float,
    delta: FloatArray,
    force: FloatArray,
    tangents: FloatArray,
    room: FloatArray,
) -> None:
    """Nonlinear part f - K δ of every bearing's force at the deflections ``delta[offset:]``, and its tangent.

    Fills in the forces, the leading d by d of the tangents (b, 5, 5), and ``room`` (8, 5): in row 0 energy [J] and its
    slope [J/s]; the other rows are scratch for one bearing.
    """
    room[BEARING_ENERGY], room[BEARING_POWER] = 0.0, 0.0
    q, push, tangent = room[1], room[2], room[3:]
    for number in range(bearings.preload.size):
        first, end = bearings.first[number], bearings.first[number + 1]
        if bearings.first_row[number] == bearings.first_row[number + 1] and bearings.preload[number] == 0.0:
            energy = _linear_law(
                bearings.linear[number],
                delta[offset + first : offset + end],
                force[offset + first : offset + end],
                tangents[number],
            )
            room[BEARING_ENERGY] += energy
            continue
        for i in range(5):
            q[i] = bearings.fixed[number, i]
        for k in range(first, end):
            q[bearings.axis[k]] = delta[offset + k]
        energy, slope = bearing_force(bearings, number, nominal_time, q, push, tangent)
        for k in range(first, end):
            linear = 0.0
            for j in range(first, end):
                stiffness = bearings.linear[number, k - first, j - first]
                linear += stiffness * delta[offset + j]
                tangents[number, k - first, j - first] = tangent[bearings.axis[k], bearings.axis[j]] - stiffness
            force[offset + k] = push[bearings.axis[k]] - linear
            energy -= 0.5 * delta[offset + k] * linear
        room[BEARING_ENERGY] += energy
        room[BEARING_POWER] += slope


@counted()
def bearing_history(bearings: Bearings, number: int, nominal_time: FloatArray, deflection: FloatArray) -> FloatArray:
    """Force of the shaft on one bearing over time, shape (s, d), from its deflections (s, d)."""
    first, end = bearings.first[number], bearings.first[number + 1]
    q, push, tangent = np.zeros(5), np.zeros(5), np.zeros((5, 5))
    history = np.empty((nominal_time.size, end - first))
    for i in range(5):
        q[i] = bearings.fixed[number, i]
    for sample in range(nominal_time.size):
        for k in range(first, end):
            q[bearings.axis[k]] = deflection[sample, k - first]
        bearing_force(bearings, number, nominal_time[sample], q, push, tangent)
        for k in range(first, end):
            history[sample, k - first] = push[bearings.axis[k]]
    return history
