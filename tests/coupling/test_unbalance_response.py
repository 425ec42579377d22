"""A turning rotor without gears: unbalance, gyroscopic whirl, and bearings that drive it unstable."""

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    MachineLoads,
    MountedBearing,
    TransientError,
    TransientOutputs,
    TransientSettings,
    Unbalance,
    assemble_machine,
    coupled_modes,
    simulate,
)
from gearwhine.coupling.machine.components import rotor_component
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
    solve_whirl,
)
from gearwhine.rotors.modes.residual_modes import add_attachment_modes

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
# Friswell, Penny, Garvey & Lees, example 5.9.1.
SHAFT = Rotor(
    "shaft",
    [Segment(0.5, 0.05, 0.0, STEEL)] * 3,
    [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0), Disc.from_dimensions(1.0, 0.07, 0.35, 0.05, 7810.0)],
)
LENGTH = 1.5
DISCS_AT = (0.5, 1.0)
SPEED = 4000.0 * 2.0 * np.pi / 60.0
UNBALANCE = Unbalance("shaft", 1.0, 1e-4, 0.6)


def machine(
    stiffness: FloatArray, damping: FloatArray, speed: float, *, count: int = 4, free: bool = False
) -> CoupledMachine:
    """The shaft on two equal grounded bearings, on a small basis."""
    bearings = [Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", LENGTH))]
    supports = [] if free else [bearing.mean_support for bearing in bearings]
    lateral = solve_lateral_modes(SHAFT, supports, count=count)
    if not free:
        lateral = add_attachment_modes(lateral, forces_at=[0.0, LENGTH], moments_at=DISCS_AT)
    rotor = rotor_component("shaft", ModalRotor(lateral, solve_torsional_modes(SHAFT, count=1)), start=0.0)
    mounted = [] if free else [MountedBearing(bearing, "shaft", None) for bearing in bearings]
    return assemble_machine(
        [rotor], None, speeds={"shaft": speed}, bearings=mounted, loads=MachineLoads(unbalances=[UNBALANCE])
    )


def disc_rows(parts: CoupledMachine) -> FloatArray:
    """x and y of the second disc."""
    return np.array([parts.rotors[0].direction(1.0, axis) for axis in (0, 1)])


def oscillating(parts: CoupledMachine, count: int) -> FloatArray:
    modes = coupled_modes(parts.system)
    return np.asarray(np.abs(modes.eigenvalues[np.abs(modes.eigenvalues) > 1.0])[:count])


def test_whirl_frequencies_published() -> None:
    """Example 5.9.1 at 4000 rpm [rad/s], through the coupled system."""
    found = oscillating(machine(1e6 * np.eye(2), np.zeros((2, 2)), SPEED, count=12), 5)
    np.testing.assert_allclose(found, [85.39, 87.80, 251.78, 294.71, 600.18], rtol=5e-4)
    anisotropic = oscillating(machine(np.diag([1e6, 8e5]), np.zeros((2, 2)), SPEED, count=12), 5)
    np.testing.assert_allclose(anisotropic, [82.33, 86.86, 239.64, 287.25, 583.49], rtol=5e-4)


@pytest.mark.parametrize("speed", [-SPEED, 0.0, 2.0 * SPEED])
def test_agrees_with_the_rotors_room(speed: float) -> None:
    stiffness, damping = np.array([[1e6, 2e5], [-1e5, 8e5]]), np.array([[300.0, 10.0], [20.0, 200.0]])
    bearings = [Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", LENGTH))]
    alone = solve_whirl(SHAFT, bearings, speed, count=6)
    modes = coupled_modes(machine(stiffness, damping, speed, count=12).system)
    values = modes.eigenvalues[(np.abs(modes.eigenvalues) > 1.0) & (modes.eigenvalues.imag > 0.0)][:6]
    np.testing.assert_allclose(values, alone.eigenvalues, rtol=2e-5)


@pytest.mark.parametrize("sense", [1, -1])
def test_forward_whirl_rises(sense: int) -> None:
    """A forward mode turns with the shaft and stiffens; a backward one softens."""
    at_rest = oscillating(machine(1e6 * np.eye(2), np.zeros((2, 2)), 0.0), 4)
    parts = machine(1e6 * np.eye(2), np.zeros((2, 2)), sense * SPEED)
    modes = coupled_modes(parts.system)
    elastic = np.flatnonzero(np.abs(modes.eigenvalues) > 1.0)[:4]
    for i, number in enumerate(elastic):
        x, y = disc_rows(parts) @ modes.shapes[number]
        # Counter-clockwise, cos and sin: y lags x by a quarter turn.
        counter_clockwise = np.imag(x * np.conj(y)) > 0.0
        forward = counter_clockwise == (sense > 0)
        assert (modes.eigenvalues[number].imag > at_rest[i - i % 2]) == forward
        assert forward == bool(i % 2)


@pytest.mark.parametrize("sense", [1, -1])
def test_free_rigid_rotor_precesses(sense: int) -> None:
    """A free body of revolution: its axis circles at Ω I_p / I_d, with the rotation."""
    parts = machine(np.zeros((2, 2)), np.zeros((2, 2)), sense * SPEED, count=2, free=True)
    axial = SHAFT.polar_inertia
    centre = SHAFT.centre_of_mass
    diametral = sum(
        part.diametral_inertia + part.mass * (start + 0.5 * part.length - centre) ** 2
        for part, start in zip(SHAFT.segments, (0.0, 0.5, 1.0), strict=True)
    ) + sum(disc.diametral_inertia + disc.mass * (disc.at - centre) ** 2 for disc in SHAFT.discs)
    modes = coupled_modes(parts.system)
    (precession,) = np.flatnonzero(np.abs(modes.eigenvalues) > 1.0)
    assert modes.eigenvalues[precession] == pytest.approx(1j * SPEED * axial / diametral, rel=1e-6)
    x, y = disc_rows(parts) @ modes.shapes[precession]
    assert np.sign(np.imag(x * np.conj(y))) == sense


@pytest.mark.parametrize("speed", [60.0, 200.0, -200.0])
def test_unbalance_in_the_steady_state(speed: float) -> None:
    """The march against (K - Ω² + iΩC) q = F, F being the rotating force written out at the disc."""
    stiffness, damping = np.diag([1e6, 7e5]), np.diag([3e3, 2e3])
    parts = machine(stiffness, damping, speed, count=3)
    system, rows = parts.system, disc_rows(parts)
    # Re of (1, -i) e^{i(Ωt + phase)}: x cos, y sin.
    force = UNBALANCE.moment * speed**2 * np.exp(1j * UNBALANCE.phase) * (rows[0] - 1j * rows[1])
    receptance = system.stiffness - speed**2 * np.eye(system.size) + 1j * speed * system.damping
    # The free rotation has no stiffness and no load.
    response = rows @ np.linalg.solve(receptance, force)
    period = 2.0 * np.pi / abs(speed)
    slowest = -np.max(coupled_modes(system).eigenvalues[1:].real)
    settle = period * np.ceil(9.0 / slowest / period)
    settings = TransientSettings(settle + 2.0 * period, settle, period / 64.0, period / 100.0, tolerance=1e-4)
    result = simulate(system, settings, TransientOutputs(rows, rows, rows))
    turning = np.exp(1j * speed * result.times)
    size = np.abs(response).max()
    for signal, factor in (
        (result.displacement, 1.0),
        (result.velocity, 1j * speed),
        (result.acceleration, -(speed**2)),
    ):
        expected = (factor * response[None, :] * turning[:, None]).real
        np.testing.assert_allclose(signal, expected, rtol=0.0, atol=4e-3 * abs(factor) * size)
    # The orbit's area per cycle, ∮ x dy, is positive counter-clockwise; below the first critical speed it follows
    # the shaft.
    x, y = result.displacement[:64].T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    assert np.sign(area) == np.sign(np.imag(response[0] * np.conj(response[1])) * speed)
    if abs(speed) == 60.0:
        assert np.sign(area) == np.sign(speed)


CROSS = 1e5


def rigid_on_cross_coupling(cross: float) -> CoupledMachine:
    """A stiff symmetric rotor: λ² = -(k ∓ i k_c) 2/m in translation."""
    stiffness = np.array([[1e6, cross], [-cross, 1e6]])
    shaft = Rotor("stiff", [Segment(0.1, 0.1, 0.0, STEEL)] * 2)
    bearings = [Bearing(name, at, stiffness, np.zeros((2, 2))) for name, at in (("left", 0.0), ("right", 0.2))]
    lateral = solve_lateral_modes(shaft, [bearing.mean_support for bearing in bearings], count=2)
    rotor = rotor_component("stiff", ModalRotor(lateral, solve_torsional_modes(shaft, count=1)), start=0.0)
    mounted = [MountedBearing(bearing, "stiff", None) for bearing in bearings]
    return assemble_machine([rotor], None, speeds={"stiff": 0.0}, bearings=mounted)


@pytest.mark.parametrize("cross", [CROSS, -CROSS])
def test_cross_coupling_is_unstable(cross: float) -> None:
    parts = rigid_on_cross_coupling(cross)
    mass = STEEL.density * np.pi / 4.0 * 0.1**2 * 0.2
    root = np.sqrt(-(1e6 - 1j * CROSS) * 2.0 / mass + 0.0j)
    modes = coupled_modes(parts.system)
    first = modes.eigenvalues[np.abs(modes.eigenvalues) > 1.0][:2]
    # The shaft is stiff, not rigid: 1 % of its first bending frequency's square.
    np.testing.assert_allclose(np.sort(first.real), [-abs(root.real), abs(root.real)], rtol=2e-2)
    assert modes.damping_ratios.min() == pytest.approx(-0.5 * CROSS / 1e6, rel=2e-2)
    assert coupled_modes(rigid_on_cross_coupling(0.0).system).damping_ratios.min() > -1e-6

    # It grows as its eigenvalue says, and the balance counts what the bearings put in.
    growth, whirl = float(first.real.max()), float(abs(first[0].imag))
    direction = 1.0 if cross > 0.0 else -1.0
    middle = np.array([parts.rotors[0].direction(0.1, axis) for axis in (0, 1)])
    span = 2.0 * np.pi / whirl * 12.0
    settings = TransientSettings(span, 0.0, 2.0 * np.pi / whirl / 64.0, 2.0 * np.pi / whirl / 100.0, tolerance=1e-4)
    velocity = middle[0] / np.linalg.norm(middle[0])
    start = (np.zeros(parts.system.size), velocity)
    result = simulate(parts.system, settings, TransientOutputs(middle, middle, middle), initial=start)
    radius = np.linalg.norm(result.displacement, axis=1)
    half = len(radius) // 2
    assert np.log(radius[-1] / radius[half]) / (result.times[-1] - result.times[half]) == pytest.approx(
        growth, rel=2e-2
    )
    x, y = result.displacement[half:].T
    assert np.sign(np.sum(x[:-1] * y[1:] - y[:-1] * x[1:])) == direction
    assert result.energy.lost < 0.0
    assert result.energy.loads == result.energy.teeth == 0.0
    assert result.energy.change == pytest.approx(-result.energy.lost, rel=1e-2)
    assert result.energy.change > 10.0 * 0.5 * velocity @ velocity


def test_divergence_says_what_to_look_for() -> None:
    parts = rigid_on_cross_coupling(5e5)
    start = (np.zeros(parts.system.size), np.ones(parts.system.size))
    rows = np.zeros((0, parts.system.size))
    settings = TransientSettings(40.0, 39.0, 1.0, 1e-3, tolerance=1e-2)
    with pytest.raises(TransientError, match=r"diverged after t = .* negative damping ratios among the coupled modes"):
        simulate(parts.system, settings, TransientOutputs(rows, rows, rows), initial=start)
