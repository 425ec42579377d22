"""Lines at mesh harmonics and their sidebands by a carrier: phasing, limits without turning, integration in time."""

from dataclasses import replace
from functools import cache, partial
from types import SimpleNamespace
from typing import cast

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import lstsq

from gearwhine.coupling import CoupledMachine, CouplingError
from gearwhine.coupling.analyses.modes_and_responses import SolvedSystem
from gearwhine.coupling.linear.carriers import turning_stiffness
from gearwhine.coupling.linear.damping_band import DampingBand
from gearwhine.coupling.linear.frequency_response import unbalance_responses
from gearwhine.coupling.linear.line_mechanisms import LineMechanisms
from gearwhine.coupling.linear.lines_over_speed import housing_rates, sensor_rms
from gearwhine.coupling.linear.mesh_harmonics import Force, MeshHarmonicModel, ResponseParts, sum_by_order
from gearwhine.coupling.machine.connectors import TurningPart
from gearwhine.coupling.machine.frames import orders_and_quarter_turn
from gearwhine.coupling.machine.loads import ShaftForce
from gearwhine.coupling.signals.line_names import line_names
from gearwhine.coupling.signals.spectrum import decibels
from gearwhine.coupling.statics.mean_mesh import equilibrium_over_turn
from gearwhine.coupling.sweep.resonances import PLACES_ABOUT_MODE, find_resonances
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.coupling.time.settings import TransientSettings
from gearwhine.coupling.time.transient import simulate
from gearwhine.results.mesh_lines import _carriers
from tests.machines.plane_planetary_set import MESH_STIFFNESS
from tests.machines.turning_set import RIPPLE, STRONG_RIPPLE, TEETH, turning_machine, turning_set, wave

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

ANISOTROPIC, ISOTROPIC = (900.0, 1300.0), (1000.0, 1000.0)  # natural frequencies of the housing along x and y [Hz]
LIMIT, HIGHER = 2.0 * np.pi * 2500.0, 2.0 * np.pi * 5000.0
RING = TEETH[0] + 2 * TEETH[1]
UNEQUAL = (0.0, 130.0, 240.0)
"""Angles of three planets [deg], multiples of 360/108 as their assembly needs, that are not equal."""


@cache
def lines(natural_hz: tuple[float, float], angles: tuple[float, ...] | None = None) -> tuple[ResponseParts, ...]:
    return MeshHarmonicModel(turning_machine(natural_hz, angles_deg=angles)).parts(LIMIT)


def carrier_turns(line: ResponseParts) -> int:
    """Signed turns of the carrier that a line is off its mesh harmonic."""
    (turns,) = {sideband.turns for sideband in line.sidebands}
    return int(dict(turns).get("carrier", 0.0))


def test_equal_planets_keep_every_third_line_by_their_phases() -> None:
    found = lines(ANISOTROPIC)
    assert {(line.causes[0][1], carrier_turns(line)) for line in found} >= {(1, -1), (1, 1), (2, -1), (2, 1)}
    for line in found:
        (harmonic,) = {harmonic for _, harmonic in line.causes}
        # Lines are at multiples n z_r + k of the carrier's speed, of which three planets keep multiples of three.
        order = harmonic * RING + carrier_turns(line)
        assert line.is_suppressed == (order % 3 != 0)
        assert line.phasing == pytest.approx(0.0 if line.is_suppressed else 1.0, abs=1e-10)
        assert line.kind == ("sideband" if line.is_suppressed else "planet pass")


def test_outermost_sidebands_fall_with_the_difference_of_the_supports() -> None:
    """Supports alike in x and y turn no line by more than ±1; a small difference hands parts of them on to ±3."""
    (alike,), *apart = (
        _carriers(cast("SolvedSystem", SimpleNamespace(machine=machine, lines=MeshHarmonicModel(machine).parts(LIMIT))))
        for by in (0.0, 5.0, 2.5)
        for machine in [turning_machine((1000.0 - by, 1000.0 + by), angles_deg=UNEQUAL)]
    )
    (more,), (less,) = apart
    assert alike["outermost_turns"] == 1.0
    assert more["outermost_turns"] == less["outermost_turns"] == 3.0 < more["turns"]
    assert 0.0 < less["outermost_share"] < 0.1
    assert more["outermost_share"] / less["outermost_share"] == pytest.approx(2.0, rel=0.05)


def test_planets_at_unequal_angles_suppress_no_line() -> None:
    machine = turning_machine(ANISOTROPIC, angles_deg=UNEQUAL)
    found = lines(ANISOTROPIC, UNEQUAL)
    carrier = machine.speeds["carrier"]
    assert not any(line.is_suppressed for line in found)
    assert {carrier_turns(line) for line in found} >= {-3, -1, 1, 3}
    for line in found:
        at = (line.causes[0][1] * RING + carrier_turns(line)) * carrier
        assert line.frequency == pytest.approx(at, rel=1e-12)
        off = carrier_turns(line)
        assert line.cause(machine).endswith(f" {'+' if off > 0 else '-'} {abs(off)}× carrier")
        assert line.kind == "sideband"
        assert line.ideal_phasing is None


def _in_carrier_frame(machine: CoupledMachine) -> tuple[FloatArray, FloatArray, slice]:
    """Stiffness and damping without the teeth, in the carrier's frame, written out anew; the housing's coordinates.

    All that stands still is alike all round: with q = e^{Jft} y of its coordinates, nothing turns.
    """
    system = machine.system
    carrier = machine.speeds["carrier"]
    size = system.size
    turn, standing = np.zeros((size, size)), np.zeros(size, dtype=bool)
    start = 0
    for part in system.components:
        own = slice(start, start + part.size)
        start = own.stop
        if part.name in ("ring", "housing"):
            orders, quarter = orders_and_quarter_turn(part)
            if part.name == "housing":
                quarter, orders = np.array([[0.0, -1.0], [1.0, 0.0]]), np.ones(2, dtype=int)
                housing = own
            turn[own, own] = orders[:, None] * quarter
            standing[own] = orders > 0
    stiffness = system.own_stiffness.copy()
    damping = system.own_damping + system.gyroscopic
    for connector in system.linear:
        if not connector.turning:
            stiffness += connector.directions @ connector.stiffness @ connector.directions.T
            damping += connector.directions @ connector.damping @ connector.directions.T
    # What stands still is seen from the carrier: Coriolis and centripetal terms, and dashpots that resist its turning.
    stiffness = stiffness + carrier * damping @ turn + carrier**2 * turn @ turn
    damping = damping + 2.0 * carrier * turn
    for connector in system.linear:
        if connector.turning:
            stiffness += connector.directions @ connector.stiffness @ connector.directions.T
            damping += connector.directions @ connector.damping @ connector.directions.T
    return stiffness, damping, housing


def _circular_parts(y: ComplexArray) -> dict[int, ComplexArray]:
    """Motion in the carrier's frame, (2,), by the turns of the carrier: e^{Jft} y is two circular parts."""
    quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
    return {sense: 0.5 * (y - 1j * sense * quarter @ y) for sense in (1, -1)}


def _as_by_time_invariant_equations(machine: CoupledMachine, harmonic: int) -> dict[int, ComplexArray]:
    """Housing's x and y with the mean mesh stiffness, by the turns of the carrier."""
    stiffness, damping, housing = _in_carrier_frame(machine)
    system, model = machine.system, MeshHarmonicModel(machine)
    load = np.zeros(system.size, dtype=np.complex128)
    for number, contact in enumerate(system.contacts):
        k, c = model.contact.stiffness[number], model.contact.damping[number]
        stiffness += k * np.outer(contact.direction, contact.direction)
        damping += c * np.outer(contact.direction, contact.direction)
        load += k * model._errors[number][harmonic - 1] * contact.direction
    w = harmonic * RING * machine.speeds["carrier"]
    return _circular_parts(np.linalg.solve(stiffness + 1j * w * damping - w**2 * np.eye(len(load)), load)[housing])


def _as_by_hills_equations(machine: CoupledMachine, highest: int = 7) -> dict[tuple[int, int], ComplexArray]:
    """Housing's x and y by harmonic and turns of the carrier, teeth as springs k(t) between bodies under load.

    No mean stiffness and no transmission error: M y'' + C y' + (K + Σ k(t) d dᵀ)(y + y_0) = d F, y_0 at rest under F.
    """
    stiffness, damping, housing = _in_carrier_frame(machine)
    system, model = machine.system, MeshHarmonicModel(machine)
    size, orders = system.size, np.arange(-highest, highest + 1)
    whole, load = (
        np.zeros((len(orders), size, len(orders), size), dtype=complex),
        np.zeros((len(orders), size), complex),
    )
    for place, order in enumerate(orders.tolist()):
        w = order * RING * machine.speeds["carrier"]
        whole[place, :, place] = stiffness + 1j * w * damping - w**2 * np.eye(size)
        for number, contact in enumerate(system.contacts):
            whole[place, :, place] += (
                1j * w * model.contact.damping[number] * np.outer(contact.direction, contact.direction)
            )
    time = np.arange(512) / 512.0
    for number, contact in enumerate(system.contacts):
        spring = MESH_STIFFNESS * (
            1.0 + STRONG_RIPPLE * wave((np.sign(contact.mesh_frequency) * time + contact.phase) % 1.0)
        )
        by_order = np.fft.fft(spring) / len(spring)
        at_rest = model._force(number) * np.mean(1.0 / spring)
        outer = np.outer(contact.direction, contact.direction)
        for row, order in enumerate(orders.tolist()):
            for column, other in enumerate(orders.tolist()):
                whole[row, :, column] += by_order[order - other] * outer
            pushed = by_order[order] * at_rest - (model._force(number) if order == 0 else 0.0)
            load[row] -= pushed * contact.direction
    # The train turns freely as a whole.
    flat = whole.reshape(len(orders) * size, -1)
    y = lstsq(flat, load.ravel(), cond=1e-14, lapack_driver="gelsy")[0].reshape(len(orders), size)
    return {
        (harmonic, turns): 2.0 * motion
        for harmonic in range(1, highest + 1)
        for turns, motion in _circular_parts(y[highest + harmonic, housing]).items()
    }


@pytest.mark.parametrize("angles", [None, UNEQUAL])
def test_isotropic_seat_gives_the_lines_of_hills_equations(angles: tuple[float, ...] | None) -> None:
    machine = turning_machine(ISOTROPIC, angles_deg=angles, ripple=STRONG_RIPPLE)
    rows = np.array([machine.sensor_rows[name] for name in "xy"])
    expected = _as_by_hills_equations(machine)
    found = [line for line in MeshHarmonicModel(machine).parts(HIGHER) if not line.is_suppressed]
    # Of five harmonics, those that three does not divide; planets at unequal angles have both sidebands of all five.
    assert len(found) == (4 if angles is None else 10)
    for line in found:
        harmonic = line.causes[0][1]
        motion = 0.2 * expected[harmonic, carrier_turns(line)]
        scale = max(np.abs(0.2 * expected[harmonic, turns]).max() for turns in (1, -1))
        # The transmission error is a polygon of 200 points.
        assert np.abs(rows @ line.motion - motion).max() < 2e-3 * scale


@pytest.mark.parametrize("angles", [None, UNEQUAL])
def test_isotropic_seat_gives_the_lines_of_time_invariant_equations(angles: tuple[float, ...] | None) -> None:
    machine = turning_machine(ISOTROPIC, angles_deg=angles)
    rows = np.array([machine.sensor_rows[name] for name in "xy"])
    found = MeshHarmonicModel(machine, stiffness_varies=False).parts(LIMIT)
    assert {abs(carrier_turns(line)) for line in found} == {1}
    scale = {h: max(float(np.abs(rows @ one.motion).max()) for one in found if one.causes[0][1] == h) for h in (1, 2)}
    shape = 0.2
    for line in found:
        harmonic = line.causes[0][1]
        expected = shape * _as_by_time_invariant_equations(machine, harmonic)[carrier_turns(line)]
        assert np.abs(rows @ line.motion - expected).max() < 1e-9 * scale[harmonic]


def test_motion_with_varying_stiffness_satisfies_the_equations_in_time() -> None:
    machine = turning_machine(ANISOTROPIC, angles_deg=UNEQUAL, ripple=STRONG_RIPPLE)
    system, model = machine.system, MeshHarmonicModel(machine)
    turning, meshes = model.turning.model, model.varying_harmonics
    forces, rate = model.turning_forces(turning), meshes[0].rate
    waves: list[tuple[float, ComplexArray]] = []
    for harmonic in range(meshes[0].reach + 1):
        part = 0.5 if harmonic == 0 else 1.0
        loads = [
            Force.along(system.contacts[number], part * amplitude, order).by_order(turning)
            for number, force in forces.items()
            for order, amplitude in force.at(harmonic).items()
        ]
        for number, mesh in meshes.items() if harmonic else ():
            error = 2.0 * mesh.error[0, mesh.reach + harmonic]
            loads.append(turning.force_along(number, model.contact.stiffness[number] * error))
        moved = turning.respond(harmonic * rate, [(sum_by_order(loads), {})])
        waves += [(harmonic * rate + turning.shift(order), motion[0]) for order, motion in moved.items()]
    rest = turning_stiffness.swings_at_rest(system, *equilibrium_over_turn(system), turning)
    for time in np.linspace(0.0, 2.0 * np.pi / machine.speeds["carrier"], 7):
        q, v, a = (
            np.sum([((1j * w) ** power * np.exp(1j * w * time) * motion).real for w, motion in waves], axis=0)
            for power in (0, 1, 2)
        )
        left = a + (system.own_damping + system.gyroscopic) @ v + system.own_stiffness @ q
        largest = 0.0
        laws = [(one.directions, one.stiffness, one.damping, one.turning, 0.0) for one in system.linear]
        for number, contact in enumerate(system.contacts):
            mesh, c = meshes[number], model.contact.damping[number]
            orders = np.arange(-2 * mesh.reach, 2 * mesh.reach + 1)
            varying = (mesh.stiffness[0] @ np.exp(1j * orders * rate * time)).real
            error = (mesh.error[0] @ np.exp(1j * mesh.orders[0] * rate * time)).real
            k = model.contact.stiffness[number] + varying
            # The loads of the planets swing at rest, as the housing yields more along x than along y.
            swing = sum((size * np.exp(1j * turning.shift(order) * time)).real for order, size in rest[number].items())
            through = k * error - varying * swing
            laws.append((contact.direction[:, None], np.array([[k]]), np.array([[c]]), contact.turning, through))
        for directions, stiffness, damping, turning_parts, through in laws:
            now = directions + sum(part.change(time) for part in turning_parts)
            step = 1e-7
            change = sum((part.change(time + step) - part.change(time - step) for part in turning_parts), 0.0)
            swept = np.transpose(change) @ q / (2.0 * step) if turning_parts else 0.0
            force = now @ (stiffness @ (now.T @ q) + damping @ (now.T @ v + swept) - through)
            left = left + force
            largest = max(largest, float(np.abs(force).max()))
        assert np.abs(left).max() < 2e-6 * largest


def test_carrier_that_hardly_turns_gives_the_lines_of_one_that_stands() -> None:
    machine = turning_machine(ANISOTROPIC)
    model = MeshHarmonicModel(machine)

    def slowed(parts: tuple[TurningPart, ...]) -> tuple[TurningPart, ...]:
        return tuple(replace(part, rate=1e-9 * part.rate) for part in parts)

    system = replace(
        machine.system,
        linear=tuple(replace(one, turning=slowed(one.turning)) for one in machine.system.linear),
        contacts=tuple(replace(one, turning=slowed(one.turning)) for one in machine.system.contacts),
    )
    slow = MeshHarmonicModel(replace(machine, system=system)).parts(LIMIT)
    frozen = model.frozen_responses(LIMIT)
    assert [line.frequency for line in slow] == pytest.approx([line.frequency for line in frozen], rel=1e-9)
    rows = np.array(list(machine.sensor_rows.values()))
    for line, still in zip(slow, frozen, strict=True):
        assert np.abs(rows @ (line.motion - still.motion)).max() < 1e-9 * np.abs(rows @ still.motion).max()


def test_parts_and_bands_of_sidebands_are_those_of_lines_and_of_a_machine_with_other_damping() -> None:
    turned = partial(turning_machine, ANISOTROPIC, angles_deg=UNEQUAL, ripple=STRONG_RIPPLE)
    machine = turned()
    mechanisms = LineMechanisms(machine)
    every = MeshHarmonicModel(machine).parts(LIMIT)
    size = [line.frequency**2 * np.linalg.norm(line.motion) for line in every]
    found = [line for line, own in zip(every, size, strict=True) if own > 2e-2 * max(size)]
    bands = DampingBand(mechanisms).at([line.frequency for line in found])
    changed = {scale: MeshHarmonicModel(turned(damping=scale)).parts(LIMIT) for scale in (0.5, 2.0)}
    for place, line in enumerate(found):
        parts = mechanisms.parts(line.frequency)
        for sensor, row in machine.sensor_rows.items():
            amplitude = line.frequency**2 * abs(row @ line.motion)
            assert parts[sensor].together == pytest.approx(amplitude, rel=1e-6)
            assert set(parts[sensor].amplitudes) <= {"transmission_error", "varying_stiffness"}
            varying = line.frequency**2 * abs(row @ line.parts["varying_stiffness"])
            assert parts[sensor].amplitudes["varying_stiffness"] == pytest.approx(varying, rel=1e-6)
            levels = [0.0]
            for scaled in changed.values():
                (same,) = (one for one in scaled if one.frequency == pytest.approx(line.frequency, rel=1e-9))
                levels.append(20.0 * np.log10(same.frequency**2 * abs(row @ same.motion) / amplitude))
            # A dashpot of standing parts is a stiffness too, seen from the carrier: the band leaves that as it is.
            assert bands[sensor][place] == pytest.approx([min(levels), max(levels)], abs=0.03)
    assert len(found) == 4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("angles", "ripple", "push"), [(None, RIPPLE, 0.0), (UNEQUAL, STRONG_RIPPLE, 0.0), (None, STRONG_RIPPLE, 4000.0)]
)
def test_lines_are_those_of_an_integration_in_time(
    angles: tuple[float, ...] | None, ripple: float, push: float
) -> None:
    """A push on the sun [N] swings the loads of planets as the carrier turns, and so what the stiffness does."""
    forces = [ShaftForce("sun", 0.05, (push, 0.0, 0.0))] if push else []
    machine = replace(turning_set(ANISOTROPIC, angles_deg=angles, ripple=ripple), forces=forces).assembled
    period, count = 2.0 * np.pi / machine.speeds["carrier"], 8192
    settings = TransientSettings(
        duration=4.0 * period, record_from=3.0 * period, sample_interval=period / count, largest_step=period / 16384
    )
    motion = histories(machine, simulate(machine.system, settings, transient_outputs(machine))).sensor_acceleration
    found = lines(ANISOTROPIC, angles) if ripple == RIPPLE else MeshHarmonicModel(machine).parts(HIGHER)
    checked = 0
    for sensor, row in machine.sensor_rows.items():
        spectrum = 2.0 * np.fft.rfft(motion[sensor]) / count
        by_line = {round(line.frequency * period / (2.0 * np.pi)): line for line in found}
        expected = {at: -(line.frequency**2) * complex(row @ line.motion) for at, line in by_line.items()}
        highest = max(map(abs, expected.values()))
        for at, amplitude in expected.items():
            if abs(amplitude) > 1e-2 * highest:
                assert abs(spectrum[at] - amplitude) < 0.005 * abs(amplitude)
                checked += 1
            elif by_line[at].is_suppressed and not push:
                assert abs(spectrum[at]) < 1e-6 * highest
        # Nothing else is as high: no line is missed.
        others = [at for at in range(RING // 2, int(2.5 * RING)) if at not in expected]
        assert np.abs(spectrum[others]).max() < 1e-3 * highest
    assert checked >= 4


@pytest.mark.slow
@pytest.mark.parametrize("rotor", ["planet 1", "carrier"])
def test_sidebands_of_an_unbalance_are_those_of_an_integration_in_time(rotor: str) -> None:
    machine = turning_machine(ANISOTROPIC, unbalanced=rotor)
    carrier = machine.speeds["carrier"]
    found = unbalance_responses(machine, [machine.speed], rotor=rotor)
    period = 2.0 * np.pi / carrier
    settings = TransientSettings(
        duration=9.0 * period, record_from=3.0 * period, sample_interval=period / 1024, largest_step=period / 8192
    )
    result = simulate(machine.system, settings, transient_outputs(machine))
    motion = histories(machine, result).sensor_acceleration
    # Frequencies that are not commensurate with the record: they are fitted, with what the planets' forces make.
    lines = {one.excitation: one.at_positive_frequencies() for one in found}
    passes = [n * carrier for n in range(1, 7)]
    rates = sorted({round(at, 9) for at in (*(float(one.frequencies[0]) for one in lines.values()), *passes)})
    waves = np.exp(1j * np.outer(result.times, rates))
    columns = np.concatenate([waves.real, -waves.imag, np.ones((len(waves), 1))], axis=1)
    for sensor, acceleration in motion.items():
        fitted = np.linalg.lstsq(columns, acceleration, rcond=None)[0]
        amplitudes = dict(zip(rates, fitted[: len(rates)] + 1j * fitted[len(rates) : 2 * len(rates)], strict=True))
        expected = dict.fromkeys(amplitudes, 0.0j)
        for one in lines.values():
            expected[round(float(one.frequencies[0]), 9)] += complex(one.sensor_acceleration[sensor][0])
        highest = max(map(abs, expected.values()))
        strong = [at for at, amplitude in expected.items() if abs(amplitude) > 0.02 * highest]
        for at in strong:
            assert abs(amplitudes[at] - expected[at]) < 0.01 * highest
    assert {one.frequencies[0] for one in found if one.excitation == f"unbalance of {rotor}"} == {machine.speeds[rotor]}
    assert len(found) == (2 if rotor == "planet 1" else 1)


def test_sweep_has_each_sideband_and_its_level_where_it_meets_a_mode() -> None:
    machine = turning_machine(ANISOTROPIC)
    resonances = find_resonances(machine, LIMIT / (2.0 * np.pi))
    assert resonances is not None
    orders = machine.speeds["carrier"] / machine.speed * np.array([RING + 1.0, 2.0 * RING - 1.0])
    kept = [int(np.argmin(np.abs(resonances.line_orders - order))) for order in orders]
    assert resonances.line_orders[kept] == pytest.approx(orders, rel=1e-9)
    assert resonances.lines[kept[0]] == "1× planets' meshes + 1× carrier"
    (mode,) = np.flatnonzero(np.abs(resonances.frequencies - 995.0) < 2.0)
    # The machine itself, at the speed at which the sideband has the frequency of the mode.
    speed = 2.0 * np.pi * float(resonances.frequencies[mode]) / orders[0]
    there = turning_machine(ANISOTROPIC, speed=speed)
    model = MeshHarmonicModel(there)
    (line,) = (one for one in model.parts(LIMIT) if one.frequency == pytest.approx(orders[0] * speed, rel=1e-9))
    for place, (sensor, row) in enumerate(there.sensor_rows.items()):
        expected = decibels(line.frequency**2 * abs(row @ line.motion))
        found = resonances.levels_near[place, kept[0], mode, len(PLACES_ABOUT_MODE) // 2]
        assert resonances.outputs[place] == sensor
        assert found == pytest.approx(expected, abs=0.2)
        assert found > resonances.line_levels[place, kept[0]] + 1.0


def test_far_sidebands_are_named_by_the_nearest_harmonic() -> None:
    """The mesh frequency is 83 turns of the carrier: 20 and 41 are nearest to the first harmonic, 42 to the second."""
    machine = turning_machine((900.0, 1300.0))
    turn = machine.speeds["carrier"] / (2.0 * np.pi)
    orders = [83 + 20, 83 - 20, 83 + 41, 83 + 42, 4 * 83 + 30, 20, 83 + 20.4]
    names = line_names(machine, [order * turn for order in orders], 1e-3 * turn)
    assert [(one.kind, one.name) for one in names[:5]] == [
        ("sideband", "1× planets' meshes + 20× carrier"),
        ("sideband", "1× planets' meshes - 20× carrier"),
        ("sideband", "1× planets' meshes + 41× carrier"),
        ("sideband", "2× planets' meshes - 41× carrier"),
        ("sideband", "4× planets' meshes + 30× carrier"),
    ]
    # Below half the mesh frequency, and between whole turns, there is no such line.
    assert [one.kind for one in names[5:]] == ["other", "other"]
    # Where turns cannot be told apart, none is named.
    (vague,) = line_names(machine, [103 * turn], 0.45 * turn)
    assert vague.kind == "other"


def test_level_has_the_power_of_what_differs_between_teeth() -> None:
    """Runout, beside the harmonic balance of each line: what carriers frozen all round leave out is below a dB."""
    even = turning_machine(ANISOTROPIC, angles_deg=UNEQUAL)
    rng, contacts = np.random.default_rng(0), []
    for contact in even.system.contacts:
        rate = 2.0 * np.pi * abs(contact.mesh_frequency)
        turns = [k * rate / teeth for teeth in TEETH for k in (3, 11, 17, 24, 33)]
        amplitudes, angles = rng.uniform(3e-7, 1e-6, len(turns)), rng.uniform(0.0, 2.0 * np.pi, len(turns))
        contacts.append(replace(contact, errors=np.column_stack([amplitudes, turns, angles])))
    machine = replace(even, system=replace(even.system, contacts=tuple(contacts)))
    model, rows = MeshHarmonicModel(machine), np.array(list(machine.sensor_rows.values()))
    by_line: dict[float, ComplexArray] = {}
    for rate in {round(rate, 6) for contact in contacts for rate in contact.errors[:, 1].tolist()}:
        loads = []
        for number, contact in enumerate(contacts):
            for amplitude, turns, angle in contact.errors[np.abs(contact.errors[:, 1] - rate) < 1e-3].tolist():
                law = model.contact.stiffness[number] + 1j * turns * model.contact.damping[number]
                loads.append(model.turning.model.force_along(number, law * amplitude * np.exp(1j * angle)))
        for order, motion in model.turning.respond(rate, [sum_by_order(loads)]).items():
            w = rate + model.turning.model.shift(order)
            moved = -(w**2) * (rows @ motion[0])
            by_line[round(abs(w), 3)] = by_line.get(round(abs(w), 3), 0.0) + (moved if w > 0.0 else moved.conj())
    power = [np.abs(moved) ** 2 for w, moved in by_line.items() if w <= LIMIT]
    power += [np.abs(line.frequency**2 * rows @ line.motion) ** 2 for line in model.parts(LIMIT)]
    expected = np.sqrt(0.5 * np.sum(power, axis=0))
    found = sensor_rms(machine, LIMIT)
    np.testing.assert_allclose(found, expected, rtol=0.12)
    assert np.all(found > 3.0 * sensor_rms(even, LIMIT))
    # The housing's coordinates are those of the sensors, but for the size of their shapes.
    frequency, rates = housing_rates(machine, LIMIT)
    of_rates = np.sqrt(0.5 * np.sum(np.abs(frequency[:, None] * rates) ** 2, axis=0))
    np.testing.assert_allclose(0.2 * of_rates, found, rtol=1e-9)


def test_stiffness_that_is_not_found_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(turning_stiffness, "_STEPS", 2)
    machine = turning_machine(ANISOTROPIC, ripple=STRONG_RIPPLE)
    with pytest.raises(CouplingError, match=r"varies at 917\.351 Hz: GMRES has not settled in 2 steps"):
        MeshHarmonicModel(machine).parts(LIMIT)
