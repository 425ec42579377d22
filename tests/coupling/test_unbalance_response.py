"""A turning rotor without gears: unbalance, gyroscopic whirl, and bearings that drive it unstable."""

import numpy as np
import pytest

from gearwhine.coupling import (
    CoupledMachine,
    MachineLoads,
    MountedBearing,
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


@pytest.mark.parametrize("speed", [-SPEED, 0.0, 2.0 * SPEED])
def test_agrees_with_the_rotors_room(speed: float) -> None:
    stiffness, damping = np.array([[1e6, 2e5], [-1e5, 8e5]]), np.array([[300.0, 10.0], [20.0, 200.0]])
    bearings = [Bearing(name, at, stiffness, damping) for name, at in (("left", 0.0), ("right", LENGTH))]
    alone = solve_whirl(SHAFT, bearings, speed, count=6)
    modes = coupled_modes(machine(stiffness, damping, speed, count=12).system)
    values = modes.eigenvalues[(np.abs(modes.eigenvalues) > 1.0) & (modes.eigenvalues.imag > 0.0)][:6]
    np.testing.assert_allclose(values, alone.eigenvalues, rtol=2e-5)


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
