"""Matrices on the free degrees of freedom against the same rows and columns cut from the whole ones."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from gearwhine.housing import HousingError, LumpedMass, Material, Patch, assemble, attach_fixtures
from gearwhine.housing.fem import linear_algebra as symmetric
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.housing.fem.matrices import FreeMass, FreeSystem, Matrices
from gearwhine.meshes import Mesh


@pytest.fixture(scope="module", params=["bare", "with a mass"])
def matrices(request: pytest.FixtureRequest, block: Callable[..., Mesh], steel: Material) -> Matrices:
    mesh = block((0.05, 0.06, 0.1), (1, 1, 2))
    bare = assemble(mesh, steel)
    if request.param == "bare":
        return bare
    motor = LumpedMass("motor", 1.5, patch=Patch("top"), offset=(0.02, 0.0, 0.01))
    return attach_fixtures(bare, mesh, [motor])


@settings(max_examples=25, deadline=None)
@given(data=st.data(), shift=st.sampled_from([0.0, -1e7, 3e9]))
def test_any_degrees_of_freedom_may_be_fixed(matrices: Matrices, data: st.DataObject, shift: float) -> None:
    """Whole nodes, single components, or none."""
    order = 3 * matrices.n_nodes
    fixed = np.array(sorted(data.draw(st.sets(st.integers(0, order - 1), max_size=order - 1))), dtype=np.int64)
    if data.draw(st.booleans()):
        fixed = np.unique(3 * (fixed // 3)[:, None] + np.arange(3)).ravel()
    free = np.setdiff1d(np.arange(order), fixed)
    if not len(free):
        return
    system = FreeSystem(matrices.held(fixed), by_blocks=False)
    by_blocks = FreeSystem(matrices.held(fixed), by_blocks=True, threads=data.draw(st.integers(1, 3)))
    by_threads = FreeMass(matrices, free, data.draw(st.integers(2, 3)), least=1)
    np.testing.assert_array_equal(system.free, free)
    stiffness, mass = (whole.toarray()[np.ix_(free, free)] for whole in (matrices.stiffness, matrices.mass))
    np.testing.assert_array_equal(system.shifted(0.0).full().toarray(), stiffness)
    shifted = stiffness - shift * mass
    np.testing.assert_allclose(system.shifted(shift).full().toarray(), shifted, atol=1e-15 * np.abs(shifted).max())
    np.testing.assert_array_equal(system.shifted(shift).lower.indices, system.shifted(0.0).lower.indices)
    vectors = np.random.default_rng(len(free)).standard_normal((len(free), 11))
    np.testing.assert_array_equal(by_threads @ vectors, system.mass @ vectors)
    by_blocks.forget_pattern()
    for found, expected in (
        (system.mass, mass),
        (system.stiffness, stiffness),
        (system.shifted(shift), shifted),
        (by_blocks.stiffness, stiffness),
        (by_blocks.shifted(shift), shifted),
    ):
        scale = (np.abs(mass) if expected is mass else np.abs(stiffness) + abs(shift) * np.abs(mass)) @ np.abs(vectors)
        assert (np.abs(found @ vectors - expected @ vectors) <= 1e-14 * scale).all()
        assert (np.abs(found @ vectors[:, 0] - expected @ vectors[:, 0]) <= 1e-14 * scale[:, 0]).all()
    whole = system.expand(vectors).reshape(11, -1)
    np.testing.assert_array_equal(whole[:, free], vectors.T)
    assert not whole[:, fixed].any()


def test_the_floor_is_clear_of_rounding_and_small_beside_the_limit(matrices: Matrices) -> None:
    system = FreeSystem(matrices)
    rounding = np.finfo(float).eps * (matrices.stiffness.diagonal() / matrices.mass.diagonal()).max()
    assert system.floor() > 1e6 * rounding
    assert system.floor(1e6) == pytest.approx(0.0036e12)


def test_nothing_left_free_is_refused(matrices: Matrices) -> None:
    with pytest.raises(HousingError, match="every degree of freedom is fixed"):
        FreeSystem(matrices.held(np.arange(3 * matrices.n_nodes)))


def test_a_symmetric_matrix_is_its_lower_triangle() -> None:
    rng = np.random.default_rng(1)
    dense = rng.standard_normal((6, 6)) * (rng.random((6, 6)) < 0.5)
    dense = dense + dense.T + 6.0 * np.eye(6)
    matrix = SymmetricMatrix.of(sparse.csr_array(dense))
    assert matrix.shape == (6, 6)
    np.testing.assert_array_equal(matrix.diagonal(), dense.diagonal())
    np.testing.assert_array_equal(matrix.lower.toarray(), np.tril(dense))
    np.testing.assert_array_equal(matrix.full().toarray(), dense)
    vectors = rng.standard_normal((6, 2))
    np.testing.assert_allclose(matrix @ vectors, dense @ vectors, rtol=1e-13)


def test_two_threads_multiply_as_one_does() -> None:
    """A matrix large enough that the second thread is started."""
    n = 3000
    rng = np.random.default_rng(2)
    diagonals = [rng.standard_normal(n - offset) for offset in range(20)]
    lower = sparse.csc_array(sparse.diags_array(diagonals, offsets=[-offset for offset in range(20)]))
    whole = sparse.csr_array(lower + sparse.tril(lower, k=-1).T)
    one, two = SymmetricMatrix.of(whole), replace(SymmetricMatrix.of(whole), threads=2)
    vectors = rng.standard_normal((n, 100))
    assert vectors.size * len(one.values) > symmetric._WORTH_A_THREAD * n
    np.testing.assert_array_equal(two @ vectors, one @ vectors)
    np.testing.assert_allclose(two @ vectors, whole @ vectors, rtol=1e-10, atol=1e-12)


def test_threads_are_kept() -> None:
    """Two tasks that wait for each other run at once, a hundred times, on no more threads than a pool has (32)."""
    threads = set()
    for _ in range(100):
        meeting = threading.Barrier(2, timeout=60.0)

        def meet(number: int, meeting: threading.Barrier = meeting) -> int:
            meeting.wait()
            threads.add(threading.current_thread())
            return number

        assert symmetric.at_once([partial(meet, 7), partial(meet, 8)]) == [7, 8]
    assert threading.current_thread() in threads
    assert 2 <= len(threads) <= 33


@pytest.mark.parametrize("failing", [0, 1])
def test_an_error_is_raised_when_every_task_has_ended(failing: int) -> None:
    ended = []

    def work(number: int) -> None:
        if number == failing:
            raise ValueError("in a task")
        time.sleep(0.05)
        ended.append(number)

    with pytest.raises(ValueError, match="in a task"):
        symmetric.at_once([partial(work, 0), partial(work, 1)])
    assert ended == [1 - failing]


@pytest.mark.parametrize("threads", [2, 3, 4])
def test_block_vectors_by_threads_as_by_one(threads: int) -> None:
    rows = symmetric._ROWS_WORTH_A_THREAD + 3
    rng = np.random.default_rng(4)
    left, right, mixture = rng.standard_normal((rows, 3)), rng.standard_normal((rows, 2)), rng.standard_normal((3, 2))
    one, several = symmetric.BlockAlgebra(rows, 1), symmetric.BlockAlgebra(rows, threads)
    np.testing.assert_array_equal(several.products(left, right), one.products(left, right))
    np.testing.assert_allclose(several.products(left, right), left.T @ right, rtol=1e-10, atol=1e-9)
    np.testing.assert_array_equal(several.combined(left, mixture), one.combined(left, mixture))
    rest = right.copy()
    several.subtract(rest, left, mixture)
    np.testing.assert_allclose(rest, right - left @ mixture, rtol=1e-12, atol=1e-12)
