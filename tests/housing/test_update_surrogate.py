"""The surrogate against spring-mass systems solved anew, and its slopes against differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import linalg

from gearwhine.housing import HousingError
from gearwhine.housing.updating import ModalState, Surrogate
from gearwhine.housing.updating.sensitivities import ModalSensitivities
from gearwhine.numerics.arrays import FloatArray

N, P = 9, 3
SPAN = np.random.default_rng(11)
STIFFNESS = [1e4 * (b @ b.T) for b in SPAN.normal(size=(P, N, N))]
MASS = [0.2 * (b @ b.T) + np.eye(N) for b in SPAN.normal(size=(P, N, 2))]
SEATS, SKIN, DOFS = (SPAN.normal(size=shape) for shape in ((2, 2, N), (5, N), (7, N)))


def solved(z: FloatArray) -> tuple[ModalState, FloatArray]:
    """K and M are sums of parts that go with exp(z): a system of any number of springs and masses."""
    stiffness = sum(np.exp(value) * part for value, part in zip(z, STIFFNESS, strict=True))
    mass = sum(np.exp(0.3 * value) * part for value, part in zip(z, MASS, strict=True))
    values, vectors = linalg.eigh(stiffness, mass)
    return state_of(np.sqrt(values), vectors), vectors


def state_of(frequencies: FloatArray, vectors: FloatArray) -> ModalState:
    return ModalState(frequencies, np.einsum("sin,nm->msi", SEATS, vectors), vectors.T @ SKIN.T, vectors.T @ DOFS.T)


def surrogate_about(z: FloatArray) -> Surrogate:
    state, vectors = solved(z)
    parts = zip(z, STIFFNESS, MASS, strict=True)
    pairs = [
        (np.exp(v) * vectors.T @ k @ vectors, 0.3 * np.exp(0.3 * v) * vectors.T @ m @ vectors) for v, k, m in parts
    ]
    stiffness, mass = (np.array(part) for part in zip(*pairs, strict=True))
    return Surrogate.about(z, state, ModalSensitivities(stiffness, mass))


@given(st.lists(st.floats(-1.0, 1.0), min_size=P, max_size=P), st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_it_errs_by_the_square_of_the_step(center: list[float], seed: int) -> None:
    z = np.array(center)
    surrogate, way = surrogate_about(z), np.random.default_rng(seed).normal(size=P)
    errors = []
    for step in (1e-2, 5e-3):
        near = surrogate.at(z + step * way).state
        errors.append(np.abs(np.log(near.frequencies / solved(z + step * way)[0].frequencies)).max())
    assert errors[0] < 0.02
    assert errors[1] < 0.4 * errors[0] or errors[0] < 1e-9


def test_shapes_go_as_those_of_systems_solved_anew() -> None:
    """Slopes of the motions where shapes are measured, by differences of systems whose λ are up to 16 times apart."""
    z, step = np.array([0.05, -0.08, 0.03]), 1e-4
    near = surrogate_about(z).at(z)
    assert near.state.frequencies[-1] > 4.0 * near.state.frequencies[0]
    assert near.state.measured is not None
    slopes = near.measured_slopes(np.arange(N))
    for number, way in enumerate(np.eye(P)):
        shapes = []
        for state in (solved(z + sign * step * way)[0] for sign in (1.0, -1.0)):
            assert state.measured is not None
            shapes.append(state.measured * np.sign((state.measured * near.state.measured).sum(axis=1))[:, None])
        difference = (shapes[0] - shapes[1]) / (2.0 * step)
        assert np.abs(slopes[number] - difference).max() < 1e-5 * np.abs(difference).max()


def test_modes_of_one_frequency_have_the_slopes_of_their_mixture() -> None:
    """Two springs of λ = 1 that a parameter couples by 0.1 e: ln λ go by ±0.1, at λ together and 1e-9 apart alike."""
    for apart in (0.0, 1e-9):
        state = ModalState(np.array([1.0, 1.0 + apart]), np.zeros((2, 1, 2)), np.eye(2))
        coupled = ModalSensitivities(np.array([[[0.0, 0.1], [0.1, 0.0]]]), np.zeros((1, 2, 2)))
        far = Surrogate.about(np.zeros(1), state, coupled).at(np.ones(1)).state
        assert 2.0 * np.log(far.frequencies) == pytest.approx([-0.1, 0.1], rel=1e-6)


def test_at_the_design_it_is_the_design() -> None:
    z = np.array([0.2, -0.1, 0.4])
    state, near = solved(z)[0], surrogate_about(z).at(z).state
    assert near.frequencies == pytest.approx(state.frequencies, rel=1e-12)
    assert near.dominance.acceleration == pytest.approx(state.dominance.acceleration, rel=1e-9)


def test_a_power_law_goes_exactly_through_any_step() -> None:
    """All stiffness with e^z: every ω with e^(z/2), however far, and shapes not at all."""
    state, _ = solved(np.zeros(P))
    values = state.frequencies**2
    surrogate = Surrogate.about(np.zeros(1), state, ModalSensitivities(np.diag(values)[None], np.zeros((1, N, N))))
    far = surrogate.at(np.array([3.0])).state
    assert far.frequencies == pytest.approx(state.frequencies * np.exp(1.5), rel=1e-12)
    assert np.abs(far.skin) == pytest.approx(np.abs(state.skin), rel=1e-9)


def test_shapes_go_through_a_crossing() -> None:
    """Two uncoupled modes exchange their order: the motion goes with the mode, not with its number."""
    state = ModalState(np.array([1.0, 1.1]), np.zeros((2, 1, 2)), np.array([[1.0, 0.0], [0.0, 1.0]]))
    rates = np.zeros((1, 2, 2))
    rates[0, 0, 0] = 1.0  # the first goes up with e^(z/2)
    near = Surrogate(np.zeros(1), state, rates, np.zeros((1, 2, 2))).at(np.array([1.0])).state
    assert near.frequencies == pytest.approx([1.1, np.exp(0.5)])
    assert np.abs(near.skin) == pytest.approx(np.array([[0.0, 1.0], [1.0, 0.0]]))


def test_slopes_of_frequencies_and_shapes_are_those_of_differences() -> None:
    surrogate = surrogate_about(np.zeros(P))
    z = np.array([0.05, -0.08, 0.03])
    near, modes = surrogate.at(z), np.array([0, 2, 5])
    slopes = near.measured_slopes(modes)
    assert near.state.measured is not None
    for number, way in enumerate(np.eye(P)):
        either = [surrogate.at(z + step * way).state for step in (1e-5, -1e-5)]
        difference = np.log(either[0].frequencies / either[1].frequencies) / 2e-5
        assert near.slopes[number] == pytest.approx(difference, abs=1e-7)
        shapes = []
        for state in either:
            assert state.measured is not None
            shapes.append(state.measured * np.sign((state.measured * near.state.measured).sum(axis=1))[:, None])
        difference = (shapes[0] - shapes[1]) / 2e-5
        assert np.abs(slopes[number] - difference[modes]).max() < 1e-6 * np.abs(difference).max()


def test_rigid_modes_are_none_of_a_state() -> None:
    with pytest.raises(HousingError, match="of elastic modes"):
        ModalState(np.array([0.0, 100.0, 200.0]), np.zeros((3, 1, 2)), np.ones((3, 3)))


def test_modes_are_numbered_and_counted_behind_the_rigid_ones() -> None:
    state = ModalState(np.array([100.0, 200.0]), np.zeros((2, 1, 2)), np.ones((2, 3)), n_rigid=6)
    near = Surrogate(np.zeros(1), state, np.zeros((1, 2, 2)), np.zeros((1, 2, 2))).at(np.ones(1)).state
    assert [near.number(mode) for mode in (0, 1)] == [7, 8]
    assert [near.n_below(limit) for limit in (1.0, 150.0, 300.0)] == [6, 7, 8]


def test_slopes_of_strengths_are_those_of_differences() -> None:
    surrogate = surrogate_about(np.zeros(P))
    z = np.array([0.05, -0.08, 0.03])
    modes = np.array([1, 3, 8])
    slopes = surrogate.at(z).strength_slopes(modes)
    for number, way in enumerate(np.eye(P)):
        above, below = (surrogate.at(z + step * way).state.dominance for step in (1e-5, -1e-5))
        measures = ((above.acceleration, below.acceleration), (above.velocity, below.velocity))
        measures += ((above.absolute, below.absolute),)
        for measure, (one, other) in enumerate(measures):
            difference = np.log(one / other)[modes] / 2e-5
            assert slopes[measure, number] == pytest.approx(difference, rel=1e-5, abs=1e-6)
