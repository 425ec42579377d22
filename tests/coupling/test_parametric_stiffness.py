"""Lines of meshes whose stiffness varies, against the periodic motion by time integration of the same equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gearwhine.coupling.gears import Gear, GearPairGeometry, SquareStiffness, tooth_contact
from gearwhine.coupling.gears.loaded.transmission_error import loaded_transmission_error
from gearwhine.coupling.linear.parametric_stiffness import VaryingMesh, _secant
from gearwhine.coupling.linear.unequal_teeth import DampedMachine, LinesOfMeshes, lines_of_meshes
from gearwhine.coupling.statics.mean_mesh import ContactState
from gearwhine.numerics.arrays import ComplexArray, FloatArray

# Three gears in a row, the first on a spring, the last free to turn; its meshes have one frequency.
MASSES = np.array([1.0, 0.7, 1.3])
DIRECTIONS = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]]).T / np.sqrt(MASSES)[:, None]
GROUND = np.diag([0.6, 0.0, 0.0])
DAMPING = np.diag([0.08, 0.02, 0.02]) + 0.05 * DIRECTIONS @ DIRECTIONS.T
ROWS = np.array([[1.0, 0.3, 0.0], [0.0, 0.5, -1.0]])
MEAN = np.array([1.1, 0.9])
RATE, PERIODS, REACH = 0.9, 3, 12

HARMONIC_STIFFNESS = {1: 0.16 + 0.05j, 2: -0.06j, 3: 0.02}
HARMONIC_ERROR = {1: 1.0, 2: 0.3 - 0.4j, 4: 0.1j}
STIFFNESS_BETWEEN = {1: 0.2j, 2: 0.1 + 0.1j, 4: -0.15, 5: 0.05j}  # at thirds of the mesh frequency
ERROR_BETWEEN = {1: 0.7, 2: -0.2j, 4: 0.4, 7: 0.2 + 0.1j}


def curve(amplitudes: dict[int, complex], phase: float) -> float:
    """Σ x_n e^{i n φ} with its conjugates."""
    return float(sum(2.0 * np.real(value * np.exp(1j * n * phase)) for n, value in amplitudes.items()))


def integrated(meshes: list[int], size: float) -> ComplexArray:
    """Two-sided amplitudes of the accelerations along rows at thirds of the mesh frequency: q'' + C q' + K(t) q = f(t).

    The motion that repeats after three mesh periods begins where the next three end.
    """
    period = 2.0 * np.pi * PERIODS / RATE

    def slope(time: float, state: FloatArray, driven: bool) -> FloatArray:
        place, rate = state[:3], state[3:]
        force = -GROUND @ place - DAMPING @ rate
        for mesh in range(2):
            d, k, e = DIRECTIONS[:, mesh], MEAN[mesh], 0.0
            if mesh in meshes:
                phase = RATE * time - 0.4 * mesh
                k += curve(HARMONIC_STIFFNESS, phase) + size * curve(STIFFNESS_BETWEEN, phase / PERIODS)
                e = curve(HARMONIC_ERROR, phase) + size * curve(ERROR_BETWEEN, phase / PERIODS)
            force = force - d * k * (d @ place - e * driven)
        return np.concatenate([rate, force])

    def after(state: FloatArray, driven: bool, count: int = 1) -> FloatArray:
        times = np.arange(1, count + 1) * period / count
        return solve_ivp(slope, (0.0, period), state, "DOP853", times, args=(driven,), rtol=1e-11, atol=1e-12).y

    monodromy = np.column_stack([after(column, False)[:, -1] for column in np.eye(6)])
    start = np.linalg.solve(np.eye(6) - monodromy, after(np.zeros(6), True)[:, -1])
    count = 240
    states = after(start, True, count)
    times = np.arange(1, count + 1) * period / count
    moved = [slope(time, state, True)[3:] for time, state in zip(times.tolist(), states.T, strict=True)]
    lines = np.fft.rfft(ROWS @ np.array(moved).T, axis=1) / count
    return np.asarray(lines * np.exp(-2j * np.pi * np.arange(lines.shape[1]) / count))


def solved(meshes: list[int], size: float) -> tuple[LinesOfMeshes, dict[int, ComplexArray]]:
    """Lines of these meshes, and the accelerations of harmonics with their mean stiffness."""
    varying = []
    for mesh in meshes:
        error = np.zeros((2, 2 * REACH + 1), dtype=np.complex128)
        stiffness = np.zeros((2, 4 * REACH + 1), dtype=np.complex128)
        for of, reach, harmonics_of, between in (
            (error, REACH, HARMONIC_ERROR, ERROR_BETWEEN),
            (stiffness, 2 * REACH, HARMONIC_STIFFNESS, STIFFNESS_BETWEEN),
        ):
            for n, value in harmonics_of.items():
                of[0, reach + n] = value * np.exp(-0.4j * mesh * n)
                of[0, reach - n] = of[0, reach + n].conj()
            for n, value in between.items():
                turned = size * value * np.exp(-0.4j * mesh * n / PERIODS)
                # Those at 2/3 are the conjugates of those at -2/3, of the set of 1/3.
                order, one = (n, turned) if n % PERIODS == 1 else (-n, np.conj(turned))
                of[1, order // PERIODS + reach] = one
        varying.append(VaryingMesh(mesh, RATE, np.array([0.0, 1.0 / 3.0]), error, stiffness, np.array([False, False])))
    stiffness = GROUND + (DIRECTIONS * MEAN) @ DIRECTIONS.T
    machine = DampedMachine(stiffness, DAMPING)
    harmonics = {}
    for harmonic in range(1, REACH + 1):
        motion = np.zeros(3, dtype=np.complex128)
        for mesh in varying:
            load = 2.0 * MEAN[mesh.number] * mesh.error[0, REACH + harmonic]
            motion += load * machine.motion(harmonic * RATE, DIRECTIONS[:, mesh.number])
        harmonics |= {(mesh.number, harmonic): motion for mesh in varying}
    state = ContactState(MEAN, np.zeros(2))
    found = lines_of_meshes(varying, state, DIRECTIONS, ROWS, machine, harmonics)
    constant = {h: -((h * RATE) ** 2) * (ROWS @ harmonics[meshes[0], h]) for h in range(1, REACH + 1)}
    return found, constant


@pytest.mark.parametrize("meshes", [[0], [1], [0, 1]])
def test_mesh_harmonics_are_those_of_the_periodic_motion(meshes: list[int]) -> None:
    """Of one mesh, and of two of one frequency, each of which changes the other's lines."""
    known = integrated(meshes, 0.0)
    found, constant = solved(meshes, 0.0)
    for harmonic in range(1, 5):
        changed = constant[harmonic] + sum(found.by_stiffness[mesh, harmonic] for mesh in meshes)
        np.testing.assert_allclose(changed, 2.0 * known[:, PERIODS * harmonic], rtol=1e-6, atol=1e-7)
        assert np.max(np.abs(constant[harmonic] / changed - 1.0)) > 0.05


@pytest.mark.parametrize("mesh", [0, 1])
def test_lines_between_differ_from_the_motion_by_the_square_of_the_errors(mesh: int) -> None:
    """What the change of stiffness by pitch does to lines that pitch makes is of second order, and left out."""
    differences = []
    for size in (2e-2, 2e-3):
        known, found = integrated([mesh], size), solved([mesh], size)[0]
        orders = np.round(found.frequency / RATE * PERIODS).astype(int)
        chosen = orders < 15
        np.testing.assert_array_equal(orders[chosen], [1, 2, 4, 5, 7, 8, 10, 11, 13, 14])
        expected = 2.0 * known[:, orders[chosen]]
        differences.append(np.linalg.norm(found.between[:, chosen] - expected) / np.linalg.norm(expected))
    assert differences[1] < 2e-3
    assert differences[1] == pytest.approx(0.1 * differences[0], rel=0.2)


@pytest.mark.parametrize("pitch", [0.0, 1e-12])
def test_the_stiffness_at_each_phase_is_that_of_the_pairs_in_touch(pitch: float) -> None:
    """Teeth of one stiffness 2e8 N/m each: one pair or two; teeth that differ by a pm are solved another way."""
    gears = [
        Gear(
            str(teeth),
            teeth,
            4e-3,
            np.radians(20.0),
            12e-3,
            pitch_deviations=(pitch, *[0.0] * (teeth - 1)) if pitch else (),
        )
        for teeth in (20, 23)
    ]
    law = tooth_contact(GearPairGeometry(*gears), SquareStiffness(2e8))
    phases = np.arange(0.05, 1.0, 0.1)
    assert (law.hunting_period == 1) is (pitch == 0.0)
    mesh = loaded_transmission_error(law, 2000.0, phases)
    stiffness = _secant(law, mesh)
    np.testing.assert_allclose(stiffness, 2e8 * (mesh.pair_forces > 0.0).sum(axis=1), rtol=1e-3)
    assert set(np.round(stiffness / 2e8)) == {1.0, 2.0}
