"""Responses at the limit among the residual attachments, against dense solves at single frequencies."""

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg, sparse

from gearwhine.housing import HousingError, ModeSet, Seat, Support, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.modes.natural_modes import ModeSetExtension
from gearwhine.housing.modes.residual_modes import leading_residual_modes
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

LIMIT = 2.0 * np.pi * 6000.0


@pytest.fixture(scope="module")
def clamped(beam: tuple[Mesh, Matrices]) -> npt.NDArray[np.int64]:
    return fixed_freedoms(beam[0], [Support("root", surface="bottom", fixed=(True, True, True))])


@pytest.fixture(scope="module")
def port(beam: tuple[Mesh, Matrices]) -> sparse.csr_array:
    """The five motions of the far end that a bearing can load."""
    return sparse.csr_array(seat_matrix(beam[0], Seat("top", (0.025, 0.03, 0.3)))[:5])


@pytest.fixture(scope="module")
def solved(beam: tuple[Mesh, Matrices], clamped: npt.NDArray[np.int64], port: sparse.csr_array) -> dict[int, ModeSet]:
    """By orders of response."""
    return {
        orders: solve_modes(beam[1].held(clamped), frequency_limit=LIMIT, ports=port, port_orders=orders)
        for orders in (1, 2, 3)
    }


def test_progress_names_the_steps_of_the_reduction(
    beam: tuple[Mesh, Matrices], clamped: npt.NDArray[np.int64], port: sparse.csr_array
) -> None:
    said: list[str] = []
    solve_modes(beam[1].held(clamped), frequency_limit=LIMIT, ports=port, port_orders=3, progress=said.append)
    work = "attaching the static response at the ports"
    steps = ["orthonormal shapes", "proof"]
    begin = said.index(work)
    sweeps = [f"{work}: sweep {number}" for number in range(1, len(said) - begin - len(steps))]
    assert sweeps
    assert said[begin + 1 :] == [*sweeps, *(f"{work}: {step}" for step in steps)]


def dense(beam: tuple[Mesh, Matrices], fixed: npt.NDArray[np.int64], port: sparse.csr_array, w: float) -> FloatArray:
    """Motions of all nodes by unit loads on the port at a circular frequency, shape (3 n_nodes, 5)."""
    matrices = beam[1]
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), fixed)
    dynamic = (matrices.stiffness - w**2 * matrices.mass).toarray()[np.ix_(free, free)]
    found = np.zeros((3 * matrices.n_nodes, port.shape[0]))
    found[free] = linalg.solve(dynamic, port.toarray().T[free], assume_a="sym")
    return found


def reduced(modes: ModeSet, port: sparse.csr_array, w: float) -> FloatArray:
    """The same by modes and attachments."""
    assert modes.residual_modes is not None
    squared = np.concatenate([modes.frequencies, modes.residual_modes.frequencies]) ** 2
    shapes = np.concatenate([modes.shapes, modes.residual_modes.shapes]).reshape(len(squared), -1)
    return np.asarray((shapes.T / (squared - w**2)) @ modes.project_all(port))


def errors(
    beam: tuple[Mesh, Matrices], clamped: npt.NDArray[np.int64], port: sparse.csr_array, modes: ModeSet, w: float
) -> FloatArray:
    exact = dense(beam, clamped, port, w)
    return np.asarray(np.linalg.norm(reduced(modes, port, w) - exact, axis=0) / np.linalg.norm(exact, axis=0))


@pytest.mark.parametrize("orders", [2, 3])
def test_receptances_are_exact_at_rest_and_at_the_limit(
    beam: tuple[Mesh, Matrices],
    clamped: npt.NDArray[np.int64],
    port: sparse.csr_array,
    solved: dict[int, ModeSet],
    orders: int,
) -> None:
    """At every node, not at the ports alone; with the static response only, the limit is far off."""
    assert errors(beam, clamped, port, solved[orders], 0.0).max() < 1e-8
    assert errors(beam, clamped, port, solved[orders], LIMIT).max() < 1e-6
    assert errors(beam, clamped, port, solved[1], LIMIT).max() > 0.01


def test_every_order_brings_the_band_nearer(
    beam: tuple[Mesh, Matrices], clamped: npt.NDArray[np.int64], port: sparse.csr_array, solved: dict[int, ModeSet]
) -> None:
    band = LIMIT * np.array([0.31, 0.53, 0.77, 0.94])
    worst = {n: max(errors(beam, clamped, port, modes, w).max() for w in band) for n, modes in solved.items()}
    assert worst[2] < 0.1 * worst[1]
    assert worst[3] < 0.3 * worst[2]


@pytest.mark.parametrize("orders", [1, 2])
def test_fewer_orders_are_part_of_more(port: sparse.csr_array, solved: dict[int, ModeSet], orders: int) -> None:
    """The smaller set taken out of the larger one is the one that is found by itself."""
    whole, alone = solved[3].residual_modes, solved[orders].residual_modes
    assert whole is not None
    assert alone is not None
    fewer, mixture = leading_residual_modes(whole, port, LIMIT**2, orders)
    np.testing.assert_allclose(fewer.frequencies, alone.frequencies, rtol=1e-6)
    np.testing.assert_allclose(np.abs(fewer.project(port)), np.abs(alone.project(port)), rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(mixture.T @ mixture, np.eye(len(fewer.frequencies)), atol=1e-10)
    np.testing.assert_allclose(mixture.T @ whole.project(port), fewer.project(port), rtol=1e-9, atol=1e-9)


def test_no_order_at_all_is_refused(port: sparse.csr_array, solved: dict[int, ModeSet]) -> None:
    attached = solved[1].residual_modes
    assert attached is not None
    with pytest.raises(HousingError, match="0 orders of response; expected 1 or more"):
        leading_residual_modes(attached, port, LIMIT**2, 0)


def test_harmonic_responses_are_exact_at_their_frequencies(
    beam: tuple[Mesh, Matrices], clamped: npt.NDArray[np.int64], port: sparse.csr_array, solved: dict[int, ModeSet]
) -> None:
    """Of loads at any nodes, at every node, against dense solves; where nothing is missing, nothing joins."""
    matrices, modes = beam[1].held(clamped), solved[1]
    loads = sparse.csr_array(np.random.default_rng(4).normal(size=(3, port.shape[1])))
    places = LIMIT * np.array([0.4, 0.93])
    extension = ModeSetExtension(matrices, modes)
    given = [(w, loads.toarray().T * (1.0, 1e-6, 0.0)) for w in places]
    found = extension.with_harmonic_responses(modes, given)
    for w in places:
        assert errors(beam, clamped, loads, modes, w)[:2].min() > 1e-3
        assert errors(beam, clamped, loads, found, w)[:2].max() < 2e-6
        # What the residual modes had stays.
        assert errors(beam, clamped, port, found, 0.0).max() < 1e-8
    assert modes.residual_modes is not None
    assert found.residual_modes is not None
    assert len(found.residual_modes.frequencies) == len(modes.residual_modes.frequencies) + 4
    again = extension.with_harmonic_responses(found, given)
    assert again.residual_modes is not None
    assert len(again.residual_modes.frequencies) == len(found.residual_modes.frequencies)
    with pytest.raises(HousingError, match="below the limit"):
        extension.with_harmonic_responses(modes, [(LIMIT, loads.toarray().T)])
