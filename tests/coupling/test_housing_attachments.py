"""A housing with residual attachments in the coupled system, against its whole finite-element model on its bearings."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg, sparse

from gearwhine.coupling import (
    CoupledSystem,
    CouplingError,
    TransientOutputs,
    TransientSettings,
    coupled_modes,
    simulate,
    static_equilibrium,
)
from gearwhine.coupling.machine.components import Component, HousingComponent, housing_component
from gearwhine.coupling.machine.connectors import LinearConnector
from gearwhine.coupling.machine.coupled_system import HarmonicLoad
from gearwhine.coupling.time.condensation import condensed
from gearwhine.housing import Material, ModeSet, Sensor, Support, assemble, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import sensor_port
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.meshes import BoxGeometry, Mesh, WallThickness, mesh_box
from gearwhine.numerics.arrays import FloatArray

BEARING = np.array([[2e8, 1e7], [1e7, 3e8]])
PULL = np.array([120.0, -70.0])


@pytest.fixture(scope="module")
def solid() -> tuple[Mesh, Matrices]:
    """A small closed box, stiff in a coarse way: what counts is that it is the same on both sides."""
    mesh = mesh_box(BoxGeometry(size=(0.2, 0.1, 0.15), wall=WallThickness.uniform(0.02)), 0.05, order=2)
    return mesh, assemble(mesh, Material(207e9, 0.3, 7850.0))


@pytest.fixture(scope="module")
def feet(solid: tuple[Mesh, Matrices]) -> npt.NDArray[np.int64]:
    corner = ((-0.11, -0.01, -0.08), (0.11, 0.001, 0.08))
    return fixed_freedoms(solid[0], [Support("base", box=corner, fixed=(True, True, True))])


@pytest.fixture(scope="module")
def ports(solid: tuple[Mesh, Matrices]) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Two motions of a point of the top, as a bearing would use them; a sensor on a side."""
    point = [sensor_port(solid[0], Sensor("seat", (0.03, 0.1, 0.02), axis)).matrix for axis in ((1, 0, 0), (0, 1, 0))]
    return sparse.vstack(point, format="csr"), sensor_port(solid[0], Sensor("side", (0.1, 0.06, 0.0))).matrix


@pytest.fixture(scope="module")
def modes(
    solid: tuple[Mesh, Matrices], feet: npt.NDArray[np.int64], ports: tuple[sparse.csr_array, sparse.csr_array]
) -> ModeSet:
    return solve_modes(solid[1].held(feet), frequency_limit=2 * np.pi * 5000.0, ports=ports[0])


def component(modes: ModeSet, ports: tuple[sparse.csr_array, sparse.csr_array]) -> HousingComponent:
    ratios = np.linspace(0.005, 0.01, len(modes.frequencies))
    seat = np.zeros((len(modes.project_all(ports[0])), 6))
    seat[:, :2] = modes.project_all(ports[0])
    sensor = modes.project_all(ports[1])[:, 0]
    return housing_component(modes, ratios, seats={"seat": seat}, seat_z={"seat": 0.0}, sensors={"side": sensor})


def on_bearing(housing: HousingComponent) -> CoupledSystem:
    """The housing's seat on a bearing to the ground, pulled."""
    directions = housing.seat_motions("seat", 0.0)[:2].T
    bearing = LinearConnector("bearing", directions, BEARING, np.zeros((2, 2)))
    return CoupledSystem((housing,), (0.0,), linear=(bearing,), load=directions @ PULL)


def whole_model(
    solid: tuple[Mesh, Matrices],
    feet: npt.NDArray[np.int64],
    ports: tuple[sparse.csr_array, sparse.csr_array],
) -> tuple[sparse.csc_matrix, npt.NDArray[np.int64]]:
    """Stiffness of all free degrees of freedom with the bearing, and which they are."""
    matrices = solid[1]
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), feet)
    whole = sparse.csr_array(matrices.stiffness + ports[0].T @ sparse.csr_array(BEARING) @ ports[0])
    return sparse.csc_matrix(whole[free][:, free]), free


def test_static_equilibrium_is_that_of_the_whole_model(
    solid: tuple[Mesh, Matrices],
    feet: npt.NDArray[np.int64],
    ports: tuple[sparse.csr_array, sparse.csr_array],
    modes: ModeSet,
) -> None:
    housing = component(modes, ports)
    q = static_equilibrium(on_bearing(housing))
    stiffness, free = whole_model(solid, feet, ports)
    exact = sparse.linalg.spsolve(stiffness, ports[0].T[free] @ PULL)
    np.testing.assert_allclose(housing.seats["seat"][:, :2].T @ q, ports[0][:, free] @ exact, rtol=1e-9)
    # The sensor is no port, and moves right all the same: the static field as a whole is exact.
    assert housing.sensors["side"] @ q == pytest.approx(float((ports[1][:, free] @ exact)[0]), rel=1e-7)
    bare = component(replace(modes, residual_modes=None), ports)
    without = bare.seats["seat"][:, :2].T @ static_equilibrium(on_bearing(bare))
    assert np.abs(without / (ports[0][:, free] @ exact) - 1.0).max() > 0.01


def test_coupled_frequencies_are_those_of_the_whole_model(
    solid: tuple[Mesh, Matrices],
    feet: npt.NDArray[np.int64],
    ports: tuple[sparse.csr_array, sparse.csr_array],
    modes: ModeSet,
) -> None:
    """The kept modes of housing and bearing: within 0.02 % with attachments, and many times worse without."""
    stiffness, free = whole_model(solid, feet, ports)
    mass = solid[1].mass[free][:, free].toarray()
    exact = np.sqrt(linalg.eigh(stiffness.toarray(), mass, eigvals_only=True, subset_by_index=[0, 1])) / (2 * np.pi)
    found = coupled_modes(on_bearing(component(modes, ports)))
    bare = coupled_modes(on_bearing(component(replace(modes, residual_modes=None), ports)))
    error = np.abs(found.frequencies_hz[:2] / exact - 1.0)
    assert error.max() < 2e-4
    assert np.abs(bare.frequencies_hz[:2] / exact - 1.0).max() > 10 * error.max()
    assert found.kinds[:2] == ("housing",) * 2
    assert "residual" in found.kinds


def test_coordinates_in_order_with_the_highest_damping(
    ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    housing = component(modes, ports)
    m = len(modes.frequencies)
    assert modes.residual_modes is not None
    assert housing.kinds == ("housing",) * m + ("residual",) * len(modes.residual_modes.frequencies)
    omega = modes.residual_modes.frequencies
    np.testing.assert_allclose(np.diag(housing.stiffness)[m:], omega**2)
    np.testing.assert_allclose(np.diag(housing.damping)[m:], 2 * 0.01 * omega)
    short = {"seat": modes.project_all(ports[0])[:m]}
    with pytest.raises(CouplingError, match="attachments included"):
        housing_component(modes, np.full(m, 0.01), seats=short, seat_z={"seat": 0.0}, sensors={})


def with_shaft(housing: HousingComponent, turning: float) -> CoupledSystem:
    """A rigid shaft of 3 kg in the bearing, pulled around by a turning force."""
    mass, zeros = 3.0, np.zeros((2, 2))
    shaft = Component("shaft", ("rotor",) * 2, zeros, zeros, zeros)
    seat = housing.seat_motions("seat", 0.0)[:2].T
    directions = np.vstack([np.eye(2) / np.sqrt(mass), -seat])
    bearing = LinearConnector("bearing", directions, BEARING, 2e-6 * BEARING)
    load = HarmonicLoad(turning, np.concatenate([[100.0, -100.0j], np.zeros(housing.size)]) / np.sqrt(mass))
    return CoupledSystem((shaft, housing), (0.0, 0.0), linear=(bearing,), harmonic_loads=(load,))


def stiffened(housing: HousingComponent, factor: float) -> HousingComponent:
    """Residual coordinates of the same compliance and ``factor`` times the frequency: motions grow alike."""
    scale = np.where(np.array(housing.kinds) == "residual", factor, 1.0)
    return replace(
        housing,
        stiffness=housing.stiffness * scale**2,
        damping=housing.damping * scale,
        seats={name: motion * scale[:, None] for name, motion in housing.seats.items()},
        sensors={name: motion * scale for name, motion in housing.sensors.items()},
    )


def steady_response(system: CoupledSystem, row: FloatArray, frequency: float) -> float:
    """Amplitude of a linear system's steady response, in the frequency domain."""
    dynamic = system.stiffness - frequency**2 * np.eye(system.size) + 1j * frequency * system.damping
    return float(abs(row @ np.linalg.solve(dynamic, system.harmonic_loads[0].amplitude)))


@pytest.mark.parametrize("factor", [0.2, 100.0])
def test_steps_are_not_refined_for_residual_coordinates(
    ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet, factor: float
) -> None:
    """As many steps as without attachments, marched or condensed; energies balance; the steady motion is right."""
    turning = 2 * np.pi * 600.0
    period = 2 * np.pi / turning
    settings = TransientSettings(300 * period, 299 * period, period / 64, period / 20, tolerance=2e-4)
    steps = []
    for given in (modes, replace(modes, residual_modes=None)):
        housing = stiffened(component(given, ports), factor)
        system = with_shaft(housing, turning)
        row = np.concatenate([np.zeros(2), housing.sensors["side"]])[None]
        result = simulate(system, settings, TransientOutputs(row, row, row))
        steps.append(result.steps)
        assert result.energy.error < 1e-3
        swing = 0.5 * np.ptp(result.displacement[:, 0])
        assert swing == pytest.approx(steady_response(system, row[0], turning), rel=0.01)
    assert steps[0] == pytest.approx(steps[1], rel=0.05)


def test_only_what_is_stiffer_than_all_others_is_condensed(
    ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    slow, fast = (with_shaft(stiffened(component(modes, ports), factor), 100.0) for factor in (0.2, 100.0))
    assert condensed(slow).system is slow
    less = condensed(fast)
    assert modes.residual_modes is not None
    assert less.system.size == fast.size - len(modes.residual_modes.frequencies)
    assert "residual" not in less.system.kinds
    # Loads on what is kept find the compliance of the whole.
    loads = np.zeros((fast.size, 2))
    loads[:2] = np.eye(2)
    exact = np.linalg.solve(fast.stiffness, loads)
    found = less.recovery @ np.linalg.solve(less.system.stiffness, less.recovery.T @ loads)
    np.testing.assert_allclose(found, exact, atol=1e-9 * np.abs(exact).max())
    # A coordinate that carries a load itself is not thrown away with it.
    pulled = replace(fast, load=np.ones(fast.size))
    assert condensed(pulled).system is pulled
