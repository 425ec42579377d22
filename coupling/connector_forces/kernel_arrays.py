"""Plain arrays of the coupled system for the time-stepping kernels, by name.

n coordinates, c contacts, r connector directions, h harmonic loads; :mod:`gearwhine.coupling.time.step_matrices` fills
them from a coupled system. Nonlinear laws act along k directions: those of the contacts, then those of b nonlinear
bearings, e in all, then two for each contact with friction. Where directions turn, e includes those of the linear
connectors that turn, and all k directions are sums of m constant columns: :class:`Turning`; otherwise m is k.

Rolling-bearing and gap laws are plain arrays too.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import astuple, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.machine.bearing_laws import BearingLaw, GapLaw, RollingLaw
from gearwhine.coupling.machine.connectors import NonlinearConnector
from gearwhine.numerics.arrays import FloatArray, IntArray
from gearwhine.rotors.rolling_bearings import BallRow, CageFault, pressed_azimuth, spall_contacts

BY_TIME, BY_TURNING, BY_UNBALANCE = 0, 1, 2
BALLS, ROLLERS, GAP = 0, 1, 2

# Entries of a step's powers: of the loads, of the losses, of the rotation, of friction; twice the kinetic energy.
BY_LOADS, BY_DAMPING, BY_ROTATION, BY_FRICTION, TWICE_KINETIC = 0, 1, 2, 3, 4
# Entries of the totals: work of the loads, energy lost to damping, work of the rotation; largest kinetic energy; energy
# that friction takes from the nominal rotation.
LOAD_WORK, DAMPING_LOSS, ROTATION_WORK, LARGEST_KINETIC, FRICTION_LOSS = 0, 1, 2, 3, 4
# Columns of the contacts' totals: ∫ force dt, time apart, largest force, time of the last touch.
IMPULSE, APART, PEAK, LAST_TOUCH = 0, 1, 2, 3
# Entries of the bearings' scratch row 0: stored energy, and its slope over the nominal time.
BEARING_ENERGY, BEARING_POWER = (0, 0), (0, 1)

_SHAPE = 7
_NO_SLICES = np.zeros((0, 2))


class _Row(NamedTuple):
    """Row of a law, before it is put with others: see the fields of `Bearings`."""

    kind: int
    elements: int
    shape: tuple[float, ...]
    cage: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slices: FloatArray = _NO_SLICES
    spalls: Sequence[tuple[float, ...]] = ()
    slip_step: float = 0.0
    slipped: FloatArray = np.zeros(1)
    spacing: FloatArray = np.zeros(0)


class Dynamics(NamedTuple):
    """The linear system: diagonal but for the gyroscopic blocks and the few directions of its connectors."""

    stiffness: FloatArray  # (n,) diagonal of the components' K
    damping: FloatArray  # (n,) diagonal of the components' C
    block_start: IntArray  # (g,) first coordinate of each block of gyroscopic and Coriolis terms
    block_size: IntArray  # (g,)
    gyroscopic: FloatArray  # (g, b, b) Gᵀ at nominal speed, padded, as are those that follow
    angular: FloatArray  # (g, b, b) Aᵀ
    circulatory: FloatArray  # (g, b, b) Nᵀ
    centripetal: FloatArray  # (g, b, b) Zᵀ
    has_frames: bool  # whether coordinates are in frames that turn: whether there are N and Z
    connectors: FloatArray  # (r, n) Uᵀ, orthonormal: the connectors add U K_t Uᵀ to K and U C_t Uᵀ to C
    connector_speed_ratios: FloatArray  # (t,) speeds over the nominal one at which K_t and C_t are tabulated
    connector_stiffness: FloatArray  # (t, r, r) K_t
    connector_damping: FloatArray  # (t, r, r) C_t
    has_skew: bool  # whether K_t is not symmetric
    constant: FloatArray  # (n,) F at the nominal speeds
    centrifugal: FloatArray  # (n,) the part of F that is proportional to s'²
    acceleration_load: FloatArray  # (n,) load of an angular acceleration s'' of one
    frequency: FloatArray  # (h,) w [rad/s]
    circling: FloatArray  # (h,) Ω [rad/s], at which an eccentric mass circles in space
    follows: IntArray  # (h,) whether the load follows time, rotation or speed: a code such as BY_TIME
    cosine: FloatArray  # (h, n) Re F_w
    sine: FloatArray  # (h, n) Im F_w
    timed_times: FloatArray  # (k, l) [s], padded
    timed_values: FloatArray  # (k, l)
    timed_sizes: IntArray  # (k,)
    timed_rows: FloatArray  # (k, n)
    resolved: FloatArray  # (n,) 1 for coordinates in the error measure, else 0
    beta: float
    gamma: float


class StepMatrices(NamedTuple):
    """Matrices of Newmark's step for each of m step sizes."""

    size: FloatArray  # (m,) h [s]
    base: FloatArray  # (m, n) inverse of the diagonal of S
    blocks: FloatArray  # (m, g, b, b) inverses of its gyroscopic blocks, transposed
    position: FloatArray  # (m, g, b, b) P = s'' A + s' N + s'² Z, transposed
    connector_stiffness: FloatArray  # (m, r, r) K_t
    connector_damping: FloatArray  # (m, r, r) C_t
    connectors: FloatArray  # (m, r, n) (B U)ᵀ, B the inverse without connectors
    connector_flexibility: FloatArray  # (m, r, r) Uᵀ B U
    woodbury: FloatArray  # (m, r, r) (I + E Uᵀ B U)⁻¹ E, E = γ h C_t + β h² K_t
    contact: FloatArray  # (m, k, n) Wᵀ = (S⁻¹ D)ᵀ, D the columns where directions turn
    contact_connectors: FloatArray  # (m, k, r) (Uᵀ W)ᵀ
    flexibility: FloatArray  # (m, k, k) Dᵀ W


class Contacts(NamedTuple):
    """The tooth contacts, padded to common lengths."""

    direction: FloatArray  # (k, n) Dᵀ, those of bearings and friction included; (m, n) their columns where they turn
    spans: IntArray  # (m, 2) first coordinate of each row of ``direction`` that is not zero, and the one after its last
    law: FloatArray  # numbers of all laws, one after another: `gearwhine.coupling.gears.contact.lookup_tables`
    law_at: IntArray  # (c,) offset of the law of each contact
    shares_at: IntArray  # (c,) offset of the friction law of each contact; -1 where lines of contact slide as one
    phase: FloatArray  # (c,)
    mesh_frequency: FloatArray  # (c,)
    errors: FloatArray  # (c, harmonics, 3): amplitude, frequency, phase
    clearance: FloatArray  # (c,)
    friction_row: IntArray  # (c,) first of the two directions along which friction acts; -1: none
    friction: FloatArray  # (c, 3) coefficient with the sense of sliding; pitch point and end of the path
    sliding: FloatArray  # (c, 2) W_a and W_b: sliding by the nominal rotation


class Turning(NamedTuple):
    """Directions that turn, D(s) = V M(s), by the e entries of M; all arrays are empty where none does.

    The entries of one rate of turning follow each other; an entry that stands still has any rate. b linear connectors
    and bearings have laws that are tabulated over speed.
    """

    rates: FloatArray  # (w,) rates of turning at nominal speed [rad/s]
    first_of_rate: IntArray  # (w + 1,) first entry of each rate
    direction: IntArray  # (e,)
    column: IntArray  # (e,)
    constant: FloatArray  # (e,) c, a and b of c + a cos w s + b sin w s
    cosine: FloatArray  # (e,)
    sine: FloatArray  # (e,)
    speed_ratios: FloatArray  # (t,) speeds over the nominal one of the tables of linear laws; empty without any
    linear: FloatArray  # (t, b, 5, 5) `Bearings.linear` at these speeds
    damping: FloatArray  # (t, b, 5, 5) `Bearings.damping`


class Bearings(NamedTuple):
    """Nonlinear bearings, their rows of rolling elements one after another (w).

    A linear connector whose directions turn is one without rows, in which ``linear`` is its stiffness times -1.
    """

    axis: IntArray  # (e,) axis of each direction: x, y, z and the rotations about x and y
    first: IntArray  # (b + 1,) first direction of each
    linear: FloatArray  # (b, 5, 5) stiffness that is in the linear connectors already, in the leading d by d
    damping: FloatArray  # (b, 5, 5) damping of linear connectors that turn; (0, 5, 5) without any
    fixed: FloatArray  # (b, 5) displacement along axes without a direction
    preload: FloatArray  # (b,) preload by a spring along z [N]
    floating: npt.NDArray[np.bool_]  # (b,) whether the outer ring slides along z, from its place in ``fixed``
    first_row: IntArray  # (b + 1,)
    kind: IntArray  # (w,) BALLS, ROLLERS or GAP
    elements: IntArray  # (w,) number of rolling elements
    shape: FloatArray  # (w, 7) geometry and stiffness, by the kind
    cage: FloatArray  # (w, 3) azimuth of the first element, rate by the time rolled, and that of the seat
    slip_step: FloatArray  # (w,) nominal time between the passing of elements; 0 of a cage whose slip does not scatter
    slipped: FloatArray  # (w, n + 1) time rolled at these beyond the nominal one, which returns after the last
    spacing: FloatArray  # (w, z) azimuth by which each element is ahead of its place
    slices: FloatArray  # (w, slices, 2) place and gap of the slices of rollers
    first_spall: IntArray  # (w + 1,)
    spalls: FloatArray  # (f, 9) contacts with the spalls of the rows: `gearwhine.rotors.rolling_bearings.SpallContact`


class Segments(NamedTuple):
    """Stretches of time between events, each cut into equal steps."""

    start: FloatArray  # (s,)
    end: FloatArray  # (s,)
    steps: IntArray  # (s,)
    slot: IntArray  # (s,) slot of the step matrices
    nominal_time: FloatArray  # (s, 3) s, s' and s'' at the start


class Scratch(NamedTuple):
    """Scratch arrays, w the gyroscopic blocks' width and e + c the number of deflections; zeros at the start."""

    a: FloatArray  # (n,) accelerations at the step's start
    before: FloatArray  # (n,) accelerations at the start of the previous step
    a_end: FloatArray  # (n,) accelerations at the step's end: first without, then with the forces of the laws
    q_predicted: FloatArray  # (n,) q*
    v_predicted: FloatArray  # (n,) v*
    load: FloatArray  # (n,)
    unbalanced: FloatArray  # (n,) loads less the resistance to q* and v*
    x: FloatArray  # (n,) coordinates at a sample
    y: FloatArray  # (n,)
    tq: FloatArray  # (r,) tq to ta_end: projections Uᵀ of q, v, a, q*, v* and a at the step's end
    tv: FloatArray  # (r,)
    ta: FloatArray  # (r,)
    tq_predicted: FloatArray  # (r,)
    tv_predicted: FloatArray  # (r,)
    ta_end: FloatArray  # (r,)
    connector_force: FloatArray  # (r,)
    response: FloatArray  # (r,)
    correction: FloatArray  # (r,) correction of the connectors' forces by their accelerations
    dq: FloatArray  # (m,) dq to dv_free: projections Dᵀ of q, v, a, q*, v*, and q and v without the laws' forces
    dv: FloatArray  # (m,)
    da: FloatArray  # (m,)
    da_before: FloatArray  # (m,) at the step's start
    dq_predicted: FloatArray  # (m,)
    dv_predicted: FloatArray  # (m,)
    dq_free: FloatArray  # (m,)
    dv_free: FloatArray  # (m,)
    dq_carried: FloatArray  # (m,) projections of the displacement that turning directions move past
    along_q: FloatArray  # (k,) displacements along directions that turn, rates (`dv` where none does), s' D'ᵀ q
    along_v: FloatArray  # (k,)
    carried: FloatArray  # (k,)
    mix: FloatArray  # (e,) entries of M, and their rates; the same at a sample
    mix_rate: FloatArray  # (e,)
    sample_mix: FloatArray  # (e,)
    sample_mix_rate: FloatArray  # (e,)
    mixed: FloatArray  # (k, m) flexibility between columns and directions that turn, and its transpose
    mixed_across: FloatArray  # (m, k)
    flexibility: FloatArray  # (k, k) flexibility of directions that turn
    pushed: FloatArray  # (m,) forces of the laws along the columns of directions that turn
    push: FloatArray  # (k,) forces of the laws
    push_before: FloatArray  # (k,) those at the start of the last step, and their change in the step before it
    push_change: FloatArray  # (k,)
    delta: FloatArray  # (e + c,) deflections, their rates, and both without the laws' forces
    rate: FloatArray  # (e + c,)
    delta_free: FloatArray  # (e + c,)
    rate_free: FloatArray  # (e + c,)
    slip: FloatArray  # (e + c,) rates of the runout errors
    delta_before: FloatArray  # (e + c,) at the step's start: compressions of the teeth, their rates and laws
    rate_before: FloatArray  # (e + c,)
    laws_before: FloatArray  # (c, 6)
    laws: FloatArray  # (c, 6)
    spare: FloatArray  # (c, 6)
    drag: FloatArray  # (c, 4) slopes of friction
    jacobian: FloatArray  # (e + c, e + c)
    residual: FloatArray  # (e + c, 1)
    yielded: FloatArray  # (e + c,) flexibility times the forces of the laws
    stiffest: FloatArray  # (1,): `gearwhine.coupling.connector_forces.contact_kernels._stiffest`
    tangents: FloatArray  # (b, 5, 5) of bearings
    bearing_work: FloatArray  # (8, 5): `gearwhine.coupling.connector_forces.bearing_kernels.evaluate_bearings`
    powers: FloatArray  # (5,): `gearwhine.coupling.time.newmark.evaluate_powers`
    powers_before: FloatArray  # (5,)
    position_force: FloatArray  # (n,) -P q at the last end of a step, and the coordinates at its start
    q_before: FloatArray  # (n,)
    block: FloatArray  # (w,)


class Outputs(NamedTuple):
    """Rows that are written at each sample."""

    displacement: FloatArray  # (k0, n)
    velocity: FloatArray  # (k1, n)
    acceleration: FloatArray  # (k2, n)
    displacement_spans: IntArray  # (k0, 2) first coordinate of each row, and the one after its last; likewise below
    velocity_spans: IntArray  # (k1, 2)
    acceleration_spans: IntArray  # (k2, 2)


class Samples(NamedTuple):
    """Arrays of the samples: sample i is of the time first + i * interval, in row i - offset."""

    first: float
    interval: float
    offset: int
    displacement: FloatArray  # (samples, k0)
    velocity: FloatArray  # (samples, k1)
    acceleration: FloatArray  # (samples, k2)
    compression: FloatArray  # (samples, c)
    force: FloatArray  # (samples, c)


def spans(rows: FloatArray) -> IntArray:
    """First number that is not zero in each row, and the one after its last, shape (k, 2); zeros of a zero row."""
    moving = rows != 0.0
    width = rows.shape[1]
    last = np.where(moving.any(axis=1), width - np.argmax(moving[:, ::-1], axis=1), 0) if width else np.zeros(len(rows))
    first = np.argmax(moving, axis=1) if width else last
    return np.column_stack([first, last]).astype(np.int64)


def bearing_arrays(connectors: Sequence[NonlinearConnector]) -> Bearings:
    """Arrays of the laws of nonlinear bearings.

    See :class:`gearwhine.coupling.connector_forces.kernel_arrays.Bearings`.
    """
    b = len(connectors)
    linear, fixed, preload = np.zeros((b, 5, 5)), np.zeros((b, 5)), np.zeros(b)
    floating = np.zeros(b, dtype=np.bool_)
    rows: list[_Row] = []
    first, first_row = [0], [0]
    for number, connector in enumerate(connectors):
        d = len(connector.axes)
        linear[number, :d, :d] = connector.stiffness
        fixed[number] = connector.law.reference
        if isinstance(connector.law, RollingLaw):
            preload[number] = connector.law.state.bearing.axial_preload
            floating[number] = connector.law.state.bearing.floating
        rows += _rows(connector.law, connector.name, connector.speed, connector.holder_speed)
        first.append(first[-1] + d)
        first_row.append(len(rows))
    shape = np.zeros((len(rows), _SHAPE))
    slices = np.zeros((len(rows), max((len(row.slices) for row in rows), default=0), 2))
    slipped = np.zeros((len(rows), max((len(row.slipped) for row in rows), default=1)))
    spacing = np.zeros((len(rows), max((len(row.spacing) for row in rows), default=0)))
    for at, row in enumerate(rows):
        shape[at, : len(row.shape)] = row.shape
        slices[at, : len(row.slices)] = row.slices
        slipped[at, : len(row.slipped)] = row.slipped
        spacing[at, : len(row.spacing)] = row.spacing
    return Bearings(
        axis=np.array([axis for connector in connectors for axis in connector.axes], dtype=np.int64),
        first=np.array(first, dtype=np.int64),
        linear=linear,
        damping=np.zeros((0, 5, 5)),
        fixed=fixed,
        preload=preload,
        floating=floating,
        first_row=np.array(first_row, dtype=np.int64),
        kind=np.array([row.kind for row in rows], dtype=np.int64),
        elements=np.array([row.elements for row in rows], dtype=np.int64),
        shape=shape,
        cage=np.array([row.cage for row in rows], dtype=np.float64).reshape(-1, 3),
        slip_step=np.array([row.slip_step for row in rows], dtype=np.float64),
        slipped=slipped,
        spacing=spacing,
        slices=slices,
        first_spall=np.cumsum([0, *(len(row.spalls) for row in rows)]),
        spalls=np.array([spall for row in rows for spall in row.spalls], dtype=np.float64).reshape(-1, 9),
    )


def _rows(law: BearingLaw, name: str, speed: float, holder_speed: float) -> Iterator[_Row]:
    """Yield the rows of a law."""
    if isinstance(law, GapLaw):
        yield _Row(GAP, 0, (law.force, law.depth, law.exponent, law.gap))
        return
    bearing, rolling = law.state.bearing, 1.0 - law.slip.mean
    for number, row in enumerate(bearing.rows):
        rate = rolling * row.cage_speed(speed)
        step = 2.0 * math.pi / (row.count * abs(rate)) if law.slip.scatter > 0.0 and rate != 0.0 else 0.0
        spacing, spalls = np.zeros(row.count), list[tuple[float, ...]]()
        for fault in law.spalls:
            if fault.row != number:
                continue
            if isinstance(fault, CageFault):
                spacing[fault.element] += fault.shift(bearing)
                continue
            for one in spall_contacts(fault, bearing, speed):
                # Raceways turn with what holds their ring; an element spins by the speed between the rings.
                turned = one.rate + holder_speed if one.element < 0 else rolling * one.rate
                spalls.append(tuple(map(float, astuple(replace(one, rate=turned)))))
        if isinstance(row, BallRow):
            kind, shape, slices = BALLS, _ball_shape(row), _NO_SLICES
        else:
            cosine, sine = math.cos(row.contact_angle), row.direction * math.sin(row.contact_angle)
            kind, shape = ROLLERS, (row.free_approach, row.stiffness / row.slices, float(row.slices), cosine, sine)
            slices = np.column_stack([row.tilt_arms, 2.0 * row.slice_drops])
        cage = pressed_azimuth(row, law.cage_angle), rate, holder_speed
        yield _Row(
            kind, row.count, shape, cage, slices, spalls, step, step * law.slip.deviations(name, number), spacing
        )


def _ball_shape(row: BallRow) -> tuple[float, ...]:
    """Return A, v₀, |v₀|² - A², inner centres (radius, place), K; see `rotors.rolling_bearings.element_contacts`."""
    return row.groove_distance, *row.groove_offset, row.groove_excess, *row.inner_groove_centre, row.stiffness
