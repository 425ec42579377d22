"""Newmark step matrices: the coupled system as arrays for the kernels, and the matrices of each step size.

`stored_energy` at the start of a time integration is in plain Python, as it is evaluated once.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gearwhine.coupling.connector_forces.kernel_arrays import (
    BEARING_ENERGY,
    BY_TIME,
    BY_TURNING,
    BY_UNBALANCE,
    Bearings,
    Contacts,
    Dynamics,
    Outputs,
    Samples,
    Scratch,
    Segments,
    StepMatrices,
    Turning,
    bearing_arrays,
    spans,
)
from gearwhine.coupling.machine.connectors import SpeedTable
from gearwhine.coupling.machine.coupled_system import CoupledSystem, HarmonicLoad
from gearwhine.coupling.machine.speed_profile import SpeedProfile
from gearwhine.coupling.time.condensation import common_span
from gearwhine.coupling.time.settings import TransientOutputs
from gearwhine.coupling.time.turning_directions import mixing, turning_arrays, turning_laws, with_own_laws
from gearwhine.numerics.arrays import FloatArray, IntArray

_WIDTH = 16  # number of rows of a vectorised loop
_FOLLOWS = {"time": BY_TIME, "turning": BY_TURNING, "unbalance": BY_UNBALANCE}


class KernelArrays(NamedTuple):
    """Arrays that stay the same through a time integration."""

    dynamics: Dynamics
    contacts: Contacts
    turning: Turning
    bearings: Bearings
    outputs: Outputs


def kernel_arrays(system: CoupledSystem, outputs: TransientOutputs, beta: float, gamma: float) -> KernelArrays:
    """Arrays of the system and of its output rows."""
    output_rows = outputs.displacement, outputs.velocity, outputs.acceleration
    # Rows are writable: a kernel is compiled anew for rows that are not.
    displacement, velocity, acceleration = (np.require(rows, requirements=("C", "W")) for rows in output_rows)
    contacts = contact_arrays(system)
    turning, columns, bearings = turning_arrays(system, bearing_arrays(system.nonlinear))
    if columns is not None:
        contacts = contacts._replace(direction=columns, spans=spans(columns))
    written = Outputs(displacement, velocity, acceleration, spans(displacement), spans(velocity), spans(acceleration))
    return KernelArrays(_dynamics(system, beta, gamma), contacts, turning, bearings, written)


def empty_samples(arrays: KernelArrays, first: float, interval: float, offset: int, count: int) -> Samples:
    """Zero arrays for some samples."""
    rows, contacts = arrays.outputs, arrays.contacts.phase.size
    return Samples(
        first=first,
        interval=interval,
        offset=offset,
        displacement=np.zeros((count, len(rows.displacement))),
        velocity=np.zeros((count, len(rows.velocity))),
        acceleration=np.zeros((count, len(rows.acceleration))),
        compression=np.zeros((count, contacts)),
        force=np.zeros((count, contacts)),
    )


def scratch_room(arrays: KernelArrays) -> Scratch:
    """Scratch arrays of the kernel."""
    r, n = arrays.dynamics.connectors.shape
    c, m, e = arrays.contacts.phase.size, len(arrays.contacts.direction), arrays.turning.direction.size
    # Directions that stand still are their own columns.
    k = int(arrays.turning.direction.max()) + 1 if e else m
    u, b = c + arrays.bearings.axis.size, arrays.bearings.preload.size
    turned = k if e else 0
    shapes: dict[str, tuple[int, ...]] = {
        "laws": (c, 6),
        "laws_before": (c, 6),
        "spare": (c, 6),
        "drag": (c, 4),
        "jacobian": (u, u),
        "residual": (u, 1),
        "stiffest": (1,),
        "tangents": (b, 5, 5),
        "bearing_work": (8, 5),
        "powers": (5,),
        "powers_before": (5,),
        "block": (arrays.dynamics.gyroscopic.shape[2],),
        "mixed": (turned, m),
        "mixed_across": (m if e else 0, turned),
        "flexibility": (turned, turned),
        "pushed": (m if e else 0,),
    }
    shapes |= dict.fromkeys(("mix", "mix_rate", "sample_mix", "sample_mix_rate"), (e,))
    shapes |= dict.fromkeys(("along_q", "along_v", "carried"), (turned,))
    shapes |= dict.fromkeys(
        (
            "a",
            "before",
            "a_end",
            "q_predicted",
            "v_predicted",
            "load",
            "unbalanced",
            "x",
            "y",
            "position_force",
            "q_before",
        ),
        (n,),
    )
    shapes |= dict.fromkeys(
        ("tq", "tv", "ta", "tq_predicted", "tv_predicted", "ta_end", "connector_force", "response", "correction"), (r,)
    )
    shapes |= dict.fromkeys(
        ("dq", "dv", "da", "da_before", "dq_predicted", "dv_predicted", "dq_free", "dv_free", "dq_carried"), (m,)
    )
    shapes |= dict.fromkeys(("push", "push_before", "push_change"), (k,))
    of_deflections = "delta", "rate", "delta_free", "rate_free", "slip", "delta_before", "rate_before", "yielded"
    shapes |= dict.fromkeys(of_deflections, (u,))
    room = {name: np.zeros(shape) for name, shape in shapes.items()}
    if not e:
        room["along_v"] = room["dv"]
    return Scratch(**room)


class StepCache:
    """Cache of the matrices of each step size, see :mod:`gearwhine.coupling.time.step_kernels`.

    At steady speed few sizes occur: the stretches between events repeat with the mesh period. Sizes that agree to nine
    digits are one. Where the speed varies no size occurs twice, and each stretch has its own. Mesh periods without a
    common multiple give ever new sizes: beyond a limit the cache is cleared, which changes no result, as a size is
    rebuilt just as it was.
    """

    _ROOM = 8
    _MOST_BYTES = 32 << 20

    def __init__(self, arrays: KernelArrays, profile: SpeedProfile) -> None:
        self._arrays, self._steady, self._rate = arrays, profile.is_steady, float(profile.speed_ratios[0])
        self._kinds: dict[float, int] = {}
        self.matrices = _room_for_steps(arrays, self._ROOM)

    def make_room(self, count: int) -> None:
        """Clear the cache where ``count`` new sizes might find no room; slots are valid until then."""
        most = self._MOST_BYTES // sum(array[:1].nbytes for array in self.matrices)
        if len(self._kinds) + count > max(most, 2 * count):
            self._kinds.clear()

    def kinds(self, sizes: FloatArray, speeds: FloatArray, accelerations: FloatArray) -> IntArray:
        """Slots of some step sizes [s], at speeds s' and angular accelerations s'' that count where they vary."""
        if not self._steady:
            self._build(range(len(sizes)), sizes, speeds, accelerations)
            return np.arange(len(sizes), dtype=np.int64)
        keys = [float(f"{size:.9e}") for size in sizes]
        fresh = [key for key in dict.fromkeys(keys) if key not in self._kinds]
        slots = range(len(self._kinds), len(self._kinds) + len(fresh))
        self._build(slots, np.array(fresh), np.ones(len(fresh)), np.zeros(len(fresh)))
        self._kinds.update(zip(fresh, slots, strict=True))
        return np.array([self._kinds[key] for key in keys], dtype=np.int64)

    def _build(self, slots: range, sizes: FloatArray, speeds: FloatArray, accelerations: FloatArray) -> None:
        from gearwhine.coupling.time.step_kernels import build_steps

        room = len(self.matrices.size)
        if slots.stop > room:
            larger = _room_for_steps(self._arrays, max(slots.stop, 2 * room))
            for old, new in zip(self.matrices, larger, strict=True):
                new[:room] = old
            self.matrices = larger
        into = np.arange(slots.start, slots.stop, dtype=np.int64)
        build_steps(self._arrays.dynamics, self._arrays.contacts, sizes, speeds, accelerations, into, self.matrices)


def cut(cache: StepCache, profile: SpeedProfile, bounds: FloatArray, step: float) -> Segments:
    """Stretches between bounds, each cut into at least two equal steps no longer than ``step`` [s]."""
    start, end = bounds[:-1], bounds[1:]
    counts = np.maximum(np.ceil((end - start) / step - 1e-9), 2).astype(np.int64)
    cache.make_room(len(counts))
    nominal_time = np.column_stack(profile.at(start)).reshape(-1, 3)
    middle = nominal_time[:, 1] + 0.5 * nominal_time[:, 2] * (end - start)
    kinds = cache.kinds((end - start) / counts, middle, np.ascontiguousarray(nominal_time[:, 2]))
    return Segments(np.ascontiguousarray(start), np.ascontiguousarray(end), counts, kinds, nominal_time)


def _room_for_steps(arrays: KernelArrays, m: int) -> StepMatrices:
    r, n = arrays.dynamics.connectors.shape
    k = len(arrays.contacts.direction)
    g, b = arrays.dynamics.gyroscopic.shape[:2]
    return StepMatrices(
        size=np.zeros(m),
        base=np.zeros((m, n)),
        blocks=np.zeros((m, g, b, b)),
        position=np.zeros((m, g, b, b)),
        connector_stiffness=np.zeros((m, r, r)),
        connector_damping=np.zeros((m, r, r)),
        connectors=np.zeros((m, r, n)),
        connector_flexibility=np.zeros((m, r, r)),
        woodbury=np.zeros((m, r, r)),
        contact=np.zeros((m, k, n)),
        contact_connectors=np.zeros((m, k, r)),
        flexibility=np.zeros((m, k, k)),
    )


def _dynamics(system: CoupledSystem, beta: float, gamma: float) -> Dynamics:
    n = system.size
    starts, sizes, blocks = _rotating_blocks(system)
    # Components are mostly diagonal; their other terms join those of the connectors.
    resting = replace(system, components=tuple(replace(one, frame=None) for one in system.components))
    whole = resting.own_stiffness, resting.own_damping
    diagonals = [matrix.diagonal().copy() for matrix in whole]
    beside = [matrix - np.diag(diagonal) for matrix, diagonal in zip(whole, diagonals, strict=True)]
    # Connectors that turn are laws of their own.
    standing = replace(system, linear=tuple(one for one in system.linear if not one.turning))
    ratios = standing.connector_speed_ratios
    matrices = [
        component + connector
        for ratio in ratios
        for component, connector in zip(beside, standing.connector_matrices(float(ratio)), strict=True)
    ]
    directions, cores = common_span(matrices)
    connector_stiffness, connector_damping = np.array(cores[0::2]), np.array(cores[1::2])
    skew = np.abs(connector_stiffness - connector_stiffness.transpose(0, 2, 1)).max(initial=0.0)
    harmonic = _loads_of_one_frequency(system.harmonic_loads)
    amplitudes = np.array([load.amplitude for load in harmonic], dtype=np.complex128).reshape(-1, n)
    longest = max((len(load.times) for load in system.timed_loads), default=0)
    times, values = np.zeros((len(system.timed_loads), longest)), np.zeros((len(system.timed_loads), longest))
    for row, load in enumerate(system.timed_loads):
        times[row, : len(load.times)], values[row, : len(load.times)] = load.times, load.values
    return Dynamics(
        stiffness=diagonals[0],
        damping=diagonals[1],
        block_start=starts,
        block_size=sizes,
        gyroscopic=blocks[0],
        angular=blocks[1],
        circulatory=blocks[2],
        centripetal=blocks[3],
        has_frames=any(component.frame is not None for component in system.components),
        connectors=np.ascontiguousarray(directions.T),
        connector_speed_ratios=ratios,
        connector_stiffness=connector_stiffness,
        connector_damping=connector_damping,
        has_skew=bool(skew > 1e-12 * np.abs(connector_stiffness).max(initial=0.0)),
        constant=system.load,
        centrifugal=system.centrifugal_load,
        acceleration_load=system.acceleration_load,
        frequency=np.array([load.frequency for load in harmonic], dtype=np.float64),
        circling=np.array(
            [load.frequency if load.circling is None else load.circling for load in harmonic], dtype=np.float64
        ),
        follows=np.array([_FOLLOWS[load.follows] for load in harmonic], dtype=np.int64),
        cosine=np.ascontiguousarray(amplitudes.real),
        sine=np.ascontiguousarray(amplitudes.imag),
        timed_times=times,
        timed_values=values,
        timed_sizes=np.array([len(load.times) for load in system.timed_loads], dtype=np.int64),
        timed_rows=np.array([load.direction for load in system.timed_loads], dtype=np.float64).reshape(-1, n),
        resolved=system.resolved.astype(np.float64),
        beta=beta,
        gamma=gamma,
    )


def _loads_of_one_frequency(loads: Sequence[HarmonicLoad]) -> list[HarmonicLoad]:
    """Add up the loads that follow each other exactly: frames split one load into many of the same few frequencies."""
    together: dict[tuple[float, str, float | None], HarmonicLoad] = {}
    for load in loads:
        key = load.frequency, load.follows, load.circling
        before = together.get(key)
        together[key] = load if before is None else replace(before, amplitude=before.amplitude + load.amplitude)
    return list(together.values())


def _rotating_blocks(system: CoupledSystem) -> tuple[IntArray, IntArray, FloatArray]:
    """First coordinate, size and transposed matrices (4, g, b, b) of each component's terms of rotation.

    At nominal speed: gyroscopic with Coriolis terms G, A of the angular acceleration, N and Z of the frame.
    """
    placed = []
    start = 0
    for component, speed in zip(system.components, system.speeds, strict=True):
        own, frame = speed * component.gyroscopic, component.frame
        none = np.zeros_like(own)
        terms = [own, own, none, none]
        if frame is not None:
            terms = [own + frame.coriolis, own + frame.angular, frame.circulatory, frame.centripetal]
        touched = np.flatnonzero(np.any([np.any(term != 0.0, axis=0) for term in terms], axis=0))
        if touched.size:
            among = slice(touched[0], touched[-1] + 1)
            placed.append((start + int(touched[0]), [term[among, among].T for term in terms]))
        start += component.size
    largest = -(-max((len(terms[0]) for _, terms in placed), default=0) // _WIDTH) * _WIDTH
    blocks = np.zeros((4, len(placed), largest, largest))
    for number, (_, terms) in enumerate(placed):
        for block, term in zip(blocks, terms, strict=True):
            block[number, : len(term), : len(term)] = term
    return (
        np.array([first for first, _ in placed], dtype=np.int64),
        np.array([len(terms[0]) for _, terms in placed], dtype=np.int64),
        blocks,
    )


def contact_arrays(system: CoupledSystem) -> Contacts:
    """Arrays of the tooth contacts."""
    c = len(system.contacts)
    harmonics = max((len(contact.errors) for contact in system.contacts), default=0)
    errors = np.zeros((c, harmonics, 3))
    for k, contact in enumerate(system.contacts):
        errors[k, : len(contact.errors)] = contact.errors
    rows = [system.contact_directions.T, *(connector.directions.T for connector in system.nonlinear)]
    rows += [connector.directions.T for connector in turning_laws(system)]
    numbers = [contact.contact.kernel_arguments[0] for contact in system.contacts]
    law_at = np.cumsum([0, *map(len, numbers)])[:-1]
    friction_row, shares_at = np.full(c, -1, dtype=np.int64), np.full(c, -1, dtype=np.int64)
    friction, sliding = np.zeros((c, 3)), np.zeros((c, 2))
    for k, contact in enumerate(system.contacts):
        if contact.sliding is not None:
            law, sliding[k] = contact.sliding.friction, contact.sliding.nominal
            sense = float(np.sign(sliding[k, 1]))
            friction[k] = sense * law.coefficient, law.pitch_point, law.path_end
            friction_row[k] = sum(map(len, rows))
            rows.append(contact.sliding.directions.T)
            if law.shares.size:
                shares_at[k] = sum(map(len, numbers))
                numbers.append(law.shares)
    directions = np.ascontiguousarray(np.concatenate(rows))
    return Contacts(
        direction=directions,
        spans=spans(directions),
        law=np.concatenate([np.zeros(0), *numbers]),
        law_at=law_at.astype(np.int64),
        shares_at=shares_at,
        phase=np.array([contact.phase for contact in system.contacts], dtype=np.float64),
        mesh_frequency=np.array([contact.mesh_frequency for contact in system.contacts], dtype=np.float64),
        errors=errors,
        clearance=np.array([contact.clearance for contact in system.contacts], dtype=np.float64),
        friction_row=friction_row,
        friction=friction,
        sliding=sliding,
    )


def stored_energy(
    dynamics: Dynamics,
    contacts: Contacts,
    turning: Turning,
    bearings: Bearings,
    q: FloatArray,
    v: FloatArray,
    nominal_time: float,
    rate: float,
) -> float:
    """Energy in teeth, nonlinear bearings and connectors that turn or change with the speed [J], as in the kernel.

    Parameters
    ----------
    q, v : ndarray, shape (n,)
    nominal_time : float
        Nominal time s [s].
    rate : float
        Relative speed s'.
    """
    energy = _of_connectors(dynamics, q, rate) if dynamics.connector_speed_ratios.size > 1 else 0.0
    c = contacts.phase.size
    delta, moved = contacts.direction @ q, contacts.direction[:c] @ v
    if turning.rates.size > 0:
        from gearwhine.coupling.connector_forces.turning_kernels import set_laws_at_speed

        mix, mix_rate = mixing(turning, nominal_time)
        delta, moved = delta @ mix, ((contacts.direction @ v) @ mix + rate * (delta @ mix_rate))[:c]
        if turning.speed_ratios.size > 0:
            bearings = with_own_laws(bearings)
            set_laws_at_speed(turning, bearings, rate)
    amplitude, w, phase = np.moveaxis(contacts.errors, 2, 0)
    angle = w * nominal_time + phase
    delta[:c] -= contacts.clearance + (amplitude * np.cos(angle)).sum(axis=1)
    moved += (amplitude * w * rate * np.sin(angle)).sum(axis=1)
    if c > 0:
        energy += _of_teeth(contacts, delta, moved, nominal_time)
    if bearings.axis.size > 0:
        energy += _of_bearings(bearings, c, delta, nominal_time)
    return float(energy)


def _of_connectors(dynamics: Dynamics, q: FloatArray, rate: float) -> float:
    """½ qᵀ U K_t Uᵀ q, K_t linear between the speeds at which it is given."""
    law = SpeedTable(dynamics.connector_speed_ratios, dynamics.connector_stiffness, dynamics.connector_damping)
    deflection = dynamics.connectors @ q
    return float(0.5 * deflection @ law.at(rate)[0] @ deflection)


def _of_teeth(contacts: Contacts, delta: FloatArray, moved: FloatArray, nominal_time: float) -> float:
    from gearwhine.coupling.gears.contact.tooth_force_kernels import tooth_force

    energy = 0.0
    for k, at in enumerate(contacts.law_at):
        phase = contacts.phase[k] + contacts.mesh_frequency[k] * nominal_time
        energy += tooth_force(phase, delta[k], moved[k], contacts.law, at)[3]
    return energy


def _of_bearings(bearings: Bearings, first: int, delta: FloatArray, nominal_time: float) -> float:
    """Energy of the nonlinear part of the bearings' forces."""
    from gearwhine.coupling.connector_forces.bearing_kernels import evaluate_bearings

    tangents, room = np.zeros((bearings.preload.size, 5, 5)), np.zeros((8, 5))
    evaluate_bearings(bearings, first, nominal_time, delta, np.zeros_like(delta), tangents, room)
    return float(room[BEARING_ENERGY])
