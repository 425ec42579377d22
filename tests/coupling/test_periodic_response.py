"""The periodic response: against closed forms, matrix exponentials, and the transient after it has settled."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from scipy.linalg import expm

from gearwhine.coupling import (
    CoupledMachine,
    CoupledSystem,
    CouplingError,
    GearMesh,
    MachineLoads,
    MountedBearing,
    MountedGear,
    Torque,
    TransientOutputs,
    TransientSettings,
    Unbalance,
    assemble_machine,
    simulate,
)
from gearwhine.coupling.gears import Gear, GearPairGeometry, SquareStiffness, ToothContact, tooth_contact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component, rotor_component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.periodic import PeriodicResponse, common_period, periodic_response
from gearwhine.coupling.time.histories import histories, transient_outputs
from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import (
    Bearing,
    Disc,
    ModalRotor,
    Rotor,
    Segment,
    ShaftMaterial,
    solve_lateral_modes,
    solve_torsional_modes,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

Errors = Sequence[tuple[float, float, float]]

SIZE = 4
DIRECTION = np.array([0.6, -0.3, 0.5, 0.2])
ROW = np.ones((1, 1))


def drawn(seed: int) -> tuple[FloatArray, FloatArray]:
    """Stiffness, and damping that is not proportional to it."""
    rng = np.random.default_rng(seed)
    root, loss = rng.normal(size=(2, SIZE, SIZE))
    return root @ root.T + 0.3 * np.eye(SIZE), 0.02 * loss @ loss.T + 0.01 * np.eye(SIZE)


def square(value: float, ratio: float, damping: float = 0.0, depth: float = 0.0) -> ToothContact:
    curves = piecewise.constant(value, ratio), piecewise.constant(0.0, ratio)
    return ToothContact(ratio, *curves, damping=damping, damping_depth=depth)


def body(
    stiffness: FloatArray,
    damping: FloatArray,
    contacts: Sequence[ContactConnector] = (),
    load: FloatArray | None = None,
    harmonic: Sequence[HarmonicLoad] = (),
    spin: float = 0.0,
) -> CoupledSystem:
    skew = np.triu(np.ones_like(stiffness), 1)
    part = Component("body", ("rotor",) * len(stiffness), stiffness, damping, skew - skew.T)
    force = np.zeros(len(stiffness)) if load is None else load
    return CoupledSystem((part,), (spin,), (), tuple(contacts), force, tuple(harmonic))


def tooth(contact: ToothContact, rate: float, phase: float = 0.0, errors: Errors = ()) -> ContactConnector:
    return ContactConnector("teeth", DIRECTION, contact, phase, rate, np.array(errors, dtype=float).reshape(-1, 3))


def one_mass(
    speed: float, contact: ToothContact, damping: float = 0.0, load: float = 1.0, errors: Errors = ()
) -> CoupledSystem:
    """x'' + 2ζ x' + k(t) g(x) = F: a unit mass that only the contact holds, the mesh at a circular frequency."""
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 2.0 * damping), np.zeros((1, 1)))
    rows = np.array(errors, dtype=float).reshape(-1, 3)
    teeth = ContactConnector("teeth", np.ones(1), contact, 0.0, speed / (2.0 * np.pi), rows)
    return CoupledSystem((mass,), (0.0,), contacts=(teeth,), load=np.array([load]))


def waving(depth: float, damping: float = 0.0, fade: float = 0.0) -> ToothContact:
    stiffness = piecewise.tabulated(lambda s: 1.0 + depth * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-7)
    return ToothContact(1.0, stiffness, piecewise.constant(0.0, 1.0), damping=damping, damping_depth=fade)


def rms(values: FloatArray) -> FloatArray:
    return np.sqrt((values**2).mean(axis=0))


def ordered(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    return np.sort_complex(np.round(values, 12))


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("spin", [0.0, 0.7])
def test_linear_machine_answers_by_its_receptance(seed: int, spin: float) -> None:
    """Without contacts: q = K⁻¹F + Σ Re((K + iwC - w²)⁻¹ F_w e^{iwt}), and the multipliers are those of e^{AT}."""
    stiffness, damping = drawn(seed)
    rng = np.random.default_rng(seed)
    loads = [HarmonicLoad(w, rng.normal(size=SIZE) + 1j * rng.normal(size=SIZE)) for w in (0.8, 2.0, -1.2)]
    system = body(stiffness, damping, load=rng.normal(size=SIZE), harmonic=loads, spin=spin)
    response = periodic_response(system)
    assert response.period == pytest.approx(2.0 * np.pi / 0.4, rel=1e-12)
    record = response.record(TransientOutputs(np.eye(SIZE), np.eye(SIZE), np.eye(SIZE)), 64)
    receptances = [
        np.linalg.inv(stiffness + 1j * one.frequency * system.damping - one.frequency**2 * np.eye(SIZE))
        for one in loads
    ]
    for derivative, found in enumerate((record.displacement, record.velocity, record.acceleration)):
        expected = np.zeros((64, SIZE))
        if derivative == 0:
            expected += np.linalg.solve(stiffness, system.load)
        for one, receptance in zip(loads, receptances, strict=True):
            turned = np.exp(1j * one.frequency * record.times)[:, None] * (1j * one.frequency) ** derivative
            expected += (turned * (receptance @ one.amplitude)).real
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())
    matrix = np.block([[np.zeros((SIZE, SIZE)), np.eye(SIZE)], [-stiffness, -system.damping]])
    exact = np.linalg.eigvals(expm(matrix * response.period))
    np.testing.assert_allclose(ordered(response.floquet.values), ordered(exact), atol=1e-10)


@pytest.mark.parametrize("ratio", [1.0 + 1e-9, 1.35, 1.63, 2.4])
@pytest.mark.parametrize("seed", [4, 5])
def test_rectangular_stiffness_against_matrix_exponentials(seed: int, ratio: float) -> None:
    """Teeth that stay closed: the machine is linear between events, and its period a product of exponentials."""
    stiffness, damping = drawn(seed)
    value, viscous, rate, phase = 2.0, 0.1, 0.41, 0.2
    system = body(stiffness, damping, [tooth(square(value, ratio, viscous), rate, phase)], 3.0 * DIRECTION)
    response = periodic_response(system)
    assert response.switches == 0
    period, whole = 1.0 / rate, np.floor(ratio)
    leaving = ratio - whole
    # From the phase at the start to the events, one by one, and back to the phase at the start.
    marks = np.unique([phase, 1.0, 1.0 + phase, leaving if leaving > phase else leaving + 1.0])
    product = np.eye(2 * SIZE + 1)
    for begin, end in pairwise(marks):
        touching = whole + ((0.5 * (begin + end)) % 1.0 < leaving)
        generator = np.zeros_like(product)
        generator[:SIZE, SIZE:-1] = np.eye(SIZE)
        generator[SIZE:-1, :SIZE] = -stiffness - touching * value * np.outer(DIRECTION, DIRECTION)
        generator[SIZE:-1, SIZE:-1] = -damping - viscous * np.outer(DIRECTION, DIRECTION)
        generator[SIZE:-1, -1] = system.load
        product = expm(generator * (end - begin) * period) @ product
    start = np.linalg.solve(np.eye(2 * SIZE) - product[:-1, :-1], product[:-1, -1])
    found = np.concatenate([response.displacement, response.velocity])
    np.testing.assert_allclose(found, start, atol=1e-10 * np.abs(start).max())
    exact = np.linalg.eigvals(product[:-1, :-1])
    np.testing.assert_allclose(ordered(response.floquet.values), ordered(exact), atol=1e-9)
    assert response.mean_force[0] > 0.0


def settled(system: CoupledSystem, response: PeriodicResponse, periods: int, steps: int) -> FloatArray:
    """Displacement of a one-mass system over its last period by the transient, 64 samples."""
    period = response.period
    march = TransientSettings((periods + 1) * period, periods * period, period / 64.0, period / steps, tolerance=1.0)
    start = (response.displacement * 1.01, response.velocity * 0.99)
    outputs = TransientOutputs(ROW, ROW, ROW)
    return simulate(system, march, outputs, initial=start).displacement[:, 0]


@pytest.mark.parametrize(("damping", "viscous", "fade"), [(0.05, 0.0, 0.0), (0.02, 0.06, 0.3)])
def test_both_motions_beside_a_fold_are_those_of_the_transient(damping: float, viscous: float, fade: float) -> None:
    """At one speed between the folds, 1e-5 in rms: teeth that stay closed, and teeth that part."""
    system = one_mass(0.78, waving(0.3, viscous, fade), damping)
    for response in both_motions(system):
        record = response.record(TransientOutputs(ROW, ROW, ROW), 64)
        marched = settled(system, response, 40, 1600)
        assert rms(marched - record.displacement[:, 0]) < 1e-5 * rms(record.displacement[:, 0])
        assert response.mean_force[0] == pytest.approx(1.0, rel=1e-8)


def both_motions(system: CoupledSystem) -> tuple[PeriodicResponse, PeriodicResponse]:
    """The one with closed teeth and the one that leaves them, both stable."""
    closed = periodic_response(system)
    parted = periodic_response(system, start=(np.array([3.8]), np.zeros(1)))
    assert closed.contact_loss[0] == 0.0 < 0.4 < parted.contact_loss[0]
    assert closed.stable
    assert parted.stable
    return closed, parted


@pytest.mark.parametrize(("viscous", "fade"), [(0.0, 0.0), (0.08, 0.0), (0.08, 0.4)])
def test_monodromy_over_losses_of_contact(viscous: float, fade: float) -> None:
    """Against differences of the whole march, forces that step at impact included; det M = e^{-∫ damping dt}."""
    from gearwhine.coupling.periodic.orbit import integrate_period
    from gearwhine.coupling.periodic.shooting import problem

    system = one_mass(0.78, waving(0.3, viscous, fade), 0.03)
    response = periodic_response(system, start=(np.array([3.8]), np.zeros(1)))
    assert response.switches >= 2
    ready = problem(system)
    elements = ready.elements(response.level)
    start = ready.part.state(response.displacement, response.velocity)
    exact = integrate_period(ready.part, ready.contacts, elements, start)
    reach = 1e-5
    for column, unit in enumerate(np.eye(2)):
        ends = [
            integrate_period(ready.part, ready.contacts, elements, start + sign * reach * unit, varied=False).end
            for sign in (1.0, -1.0)
        ]
        np.testing.assert_allclose(exact.monodromy[:, column], (ends[0] - ends[1]) / (2.0 * reach), atol=2e-7)
    if not viscous:
        shrinking = np.exp(-2.0 * 0.03 * response.period)
        assert np.prod(response.floquet.values) == pytest.approx(shrinking, rel=1e-9)
    np.testing.assert_allclose(
        np.exp(response.floquet.exponents * response.period), response.floquet.values, rtol=1e-12
    )


def test_runout_and_a_longer_period() -> None:
    """A runout once in 7 mesh periods; the same motion repeats after 14 as well."""
    errors = [(0.2, 0.5 / 7.0, 0.3)]
    system = one_mass(0.5, waving(0.2), 0.05, errors=errors)
    assert common_period(system) == pytest.approx(7.0 * 2.0 * np.pi / 0.5, rel=1e-12)
    once = periodic_response(system)
    assert once.mean_force[0] == pytest.approx(1.0, rel=1e-9)
    twice = periodic_response(system, period=2.0 * once.period)
    np.testing.assert_allclose(twice.displacement, once.displacement, rtol=1e-8)
    np.testing.assert_allclose(
        np.sort_complex(twice.floquet.values), np.sort_complex(once.floquet.values**2), atol=1e-9
    )
    assert twice.rms_compression[0] == pytest.approx(once.rms_compression[0], rel=1e-8)


STEEL = ShaftMaterial.from_poisson_ratio(207e9, 0.3, 7850.0)
PAIR = GearPairGeometry(
    Gear("pinion", 24, 3e-3, np.radians(20.0), 0.02), Gear("wheel", 36, 3e-3, np.radians(20.0), 0.02), 90.3e-3
)


def geared(torque: float, *, unbalance: float = 0.0, backlash: float | None = None) -> CoupledMachine:
    """Two shafts on four bearings to ground, with teeth of rectangular stiffness."""
    rotors, bearings, gears = [], [], []
    for name, disc, x in (("input", 2.0, 0.0), ("output", 5.0, PAIR.working_centre_distance)):
        shaft = Rotor(name, [Segment(0.1, 0.04, 0.0, STEEL)] * 3, [Disc(0.12, disc, 0.004 * disc, 0.0025 * disc)])
        lateral = add_attachment_modes(solve_lateral_modes(shaft, count=4), forces_at=[0.0, 0.12, 0.3])
        modal = ModalRotor(lateral, solve_torsional_modes(shaft, count=3))
        rotors.append(rotor_component(name, modal, start=0.0, damping_ratio=0.01))
        gears.append(MountedGear(f"{name} gear", name, 0.12, (x, 0.0)))
        for end, at in (("front", 0.0), ("back", 0.3)):
            bearing = Bearing(f"{name} {end}", at, 5e7 * np.eye(2), 4e3 * np.eye(2))
            bearings.append(MountedBearing(bearing, name, None))
    contact = tooth_contact(PAIR, SquareStiffness(1.3e8), 2e3)
    return assemble_machine(
        rotors,
        None,
        speeds={"input": 300.0, "output": -300.0 / PAIR.ratio},
        bearings=bearings,
        meshes=[GearMesh(gears[0], gears[1], PAIR, contact, backlash)],
        loads=MachineLoads(
            unbalances=[Unbalance("input", 0.2, unbalance, 0.4)],
            torques=[Torque("input", 0.0, torque), Torque("output", 0.3, torque * PAIR.ratio)],
        ),
    )


@pytest.mark.parametrize("backlash", [None, 40e-6])
def test_two_geared_shafts_move_as_the_transient_does(backlash: float | None) -> None:
    """A rolling train, its gyroscopic terms, the jumps of the stiffness: forces, motions, accelerations."""
    machine = geared(90.0, backlash=backlash)
    response = periodic_response(machine.system)
    period = 2.0 * np.pi / (300.0 * 24.0)
    assert response.period == pytest.approx(period, rel=1e-12)
    assert response.stable
    # The rolling train's two multipliers of one are left out: the train stands at a mean of nothing.
    assert len(response.floquet.values) == 2 * machine.system.size - 2
    assert response.mean_force[0] == pytest.approx(90.0 / PAIR.driver.base_radius, rel=1e-9)
    outputs = transient_outputs(machine)
    # Samples off the events.
    settle, samples = 30, 50
    march = TransientSettings((settle + 1) * period, settle * period, period / samples, period / 9000.0, tolerance=1.0)
    start = (response.displacement, response.velocity)
    marched = simulate(machine.system, march, outputs, initial=start)
    record = response.record(outputs, samples)
    for what in ("velocity", "force", "compression"):
        expected, found = getattr(marched, what), getattr(record, what)
        assert np.all(rms(found - expected)[rms(expected) > 0.0] < 1e-5 * rms(expected)[rms(expected) > 0.0])
    gears = histories(machine, record).gear_motion, histories(machine, marched).gear_motion
    for found, expected in zip(gears[0].values(), gears[1].values(), strict=True):
        alternating = [one - one.mean(axis=0) for one in (found, expected)]
        assert np.all(rms(alternating[0] - alternating[1]) < 1e-5 * rms(alternating[1]))


def test_unbalance_lengthens_the_period_to_a_revolution() -> None:
    """Unbalance and mesh together; the line at the shaft's speed is that of the mesh at its mean stiffness, nearly."""
    machine = geared(90.0, unbalance=3e-5)
    response = periodic_response(machine.system)
    assert response.period == pytest.approx(2.0 * np.pi / 300.0, rel=1e-12)
    record = response.record(transient_outputs(machine), 960)
    lines = np.fft.rfft(record.displacement[:, 0]) / 480.0
    system, w = machine.system, 300.0
    matrix = system.mean_stiffness + 1j * w * system.mean_damping - w**2 * np.eye(system.size)
    linear = transient_outputs(machine).displacement[0] @ np.linalg.solve(matrix, system.harmonic_loads[0].amplitude)
    assert abs(lines[1] - linear) < 2e-3 * abs(linear)
    # The teeth's lines stand at 24 times the speed, as they do without unbalance.
    mesh = periodic_response(geared(90.0).system).record(transient_outputs(machine), 40)
    assert abs(lines[24]) == pytest.approx(abs(np.fft.rfft(mesh.displacement[:, 0])[1]) / 20.0, rel=1e-2)


def test_frequencies_without_a_common_period() -> None:
    stiffness, damping = drawn(1)
    loads = [HarmonicLoad(w, np.ones(SIZE, dtype=complex)) for w in (1.0, np.sqrt(2.0))]
    with pytest.raises(CouplingError, match=r"harmonic load 2 .* have no common period"):
        periodic_response(body(stiffness, damping, harmonic=loads))
    with pytest.raises(CouplingError, match="expected a whole number"):
        periodic_response(body(stiffness, damping, harmonic=loads[:1]), period=5.0)
    with pytest.raises(CouplingError, match="nothing varies"):
        periodic_response(body(stiffness, damping))


@pytest.mark.parametrize(
    ("frequencies", "period"),
    [((3.0, 2.0), 1.0), ((0.75,), 4.0 / 3.0), ((36.0, 24.0, 60.0), 1.0 / 12.0), ((24.0, 1.0, 24.0 / 36.0), 3.0)],
)
def test_common_period(frequencies: tuple[float, ...], period: float) -> None:
    stiffness, damping = drawn(1)
    loads = [HarmonicLoad(2.0 * np.pi * f, np.ones(SIZE, dtype=complex)) for f in frequencies]
    assert common_period(body(stiffness, damping, harmonic=loads)) == pytest.approx(period, rel=1e-12)


def bad(**changes: object) -> Callable[[], PeriodicResponse]:
    return lambda: periodic_response(one_mass(0.5, waving(0.2), 0.05), **changes)  # type: ignore[arg-type]


def test_wrong_input() -> None:
    with pytest.raises(CouplingError, match="tolerance of 0"):
        bad(tolerance=0.0)()
    with pytest.raises(CouplingError, match=r"expected \(1,\)"):
        bad(start=(np.zeros(2), np.zeros(1)))()
    machine = geared(90.0)
    uneven = machine.system.load.copy()
    uneven[machine.rotors[0].size :] *= 0.9
    system = CoupledSystem(
        machine.system.components, machine.system.speeds, machine.system.linear, machine.system.contacts, uneven
    )
    with pytest.raises(CouplingError, match="do not balance"):
        periodic_response(system)
