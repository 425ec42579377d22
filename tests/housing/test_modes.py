"""Modes against dense eigenvalues, their certificate, and what the certificate catches."""

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import pytest
from scipy import linalg, sparse

from gearwhine.housing import (
    HousingError,
    IncompleteModesError,
    Material,
    ModeSet,
    Support,
    assemble,
    attach_fixtures,
    solve_modes,
)
from gearwhine.housing.errors import FactorizationError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import Seat, seat_matrix
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.modes import eigensolver
from gearwhine.housing.modes.certificate import NOT_COUNTED
from gearwhine.housing.modes.eigensolver import block_lanczos
from gearwhine.meshes import BoxGeometry, Mesh, WallThickness, mesh_box

BACKENDS = pytest.mark.parametrize("backend", ["rslab", "superlu"])


@pytest.fixture(scope="module")
def cube_values(cube: tuple[Mesh, Matrices]) -> npt.NDArray[np.float64]:
    """All 195 eigenvalues by dense algebra, rigid-body ones set to zero [rad/s]."""
    values = linalg.eigh(cube[1].stiffness.toarray(), cube[1].mass.toarray(), eigvals_only=True)
    values[:6] = 0.0
    return np.asarray(np.sqrt(values))


@pytest.fixture(scope="module")
def box_modes(box_matrices: Matrices) -> ModeSet:
    return solve_modes(box_matrices, frequency_limit=2 * np.pi * 6000.0)


@pytest.fixture(scope="module")
def small_matrices(straight_box: Mesh, steel: Material) -> Matrices:
    """Of the same box by elements with four nodes: few degrees of freedom, for what solvers do that are spoiled."""
    return assemble(straight_box, steel)


@pytest.fixture(scope="module")
def thin_matrices(steel: Material) -> Matrices:
    return assemble(mesh_box(BoxGeometry((0.3, 0.3, 0.33), WallThickness.uniform(0.01)), 0.06), steel)


@BACKENDS
def test_free_cube_keeps_its_double_and_triple_modes(
    cube: tuple[Mesh, Matrices], cube_values: npt.NDArray[np.float64], backend: Literal["rslab", "superlu"]
) -> None:
    gap = 25 + int(np.argmax(np.diff(cube_values[25:35])))
    limit = 0.5 * (cube_values[gap] + cube_values[gap + 1])
    modes = solve_modes(cube[1], frequency_limit=limit, backend=backend)
    expected = cube_values[cube_values < limit]
    np.testing.assert_allclose(modes.frequencies[6:], expected[6:], rtol=1e-9)
    assert (modes.frequencies[:6] == 0.0).all()
    groups = np.split(expected[6:], np.flatnonzero(np.diff(expected[6:]) > 1e-6 * limit) + 1)
    sizes = {len(group) for group in groups}
    assert {2, 3} <= sizes <= {1, 2, 3}  # the irreducible representations of the cube's group
    assert modes.backend == backend
    assert modes.certificate.complete
    assert modes.certificate.expected == modes.certificate.found == len(expected)
    assert modes.certificate.limit == limit


@pytest.mark.parametrize("count", [1, 2, 5, 6, 7, 8, 9, 10, 11, 12, 20])
def test_a_number_of_modes_is_never_cut_within_a_multiple_mode(
    cube: tuple[Mesh, Matrices], cube_values: npt.NDArray[np.float64], count: int
) -> None:
    modes = solve_modes(cube[1], count=count)
    following = cube_values[count:]
    extra = np.flatnonzero(following**2 - cube_values[count - 1] ** 2 > 1e-5 * cube_values[count] ** 2)[0]
    assert len(modes.frequencies) == count + extra
    np.testing.assert_allclose(modes.frequencies, cube_values[: count + extra], rtol=1e-8, atol=0.0)
    assert modes.certificate.complete


def test_a_draft_has_the_same_modes_without_their_proof(box_matrices: Matrices, box_modes: ModeSet) -> None:
    modes = solve_modes(box_matrices, count=len(box_modes.frequencies), draft=True)
    np.testing.assert_allclose(modes.frequencies, box_modes.frequencies, rtol=1e-7)
    half = len(modes.frequencies) // 2
    np.testing.assert_allclose(modes.frequencies[:half], box_modes.frequencies[:half], rtol=1e-10)
    assert modes.certificate.expected == NOT_COUNTED
    assert not modes.certificate.complete
    ports = sparse.csr_array(np.eye(1, 3 * modes.shapes.shape[1]))
    for wrong in ({"count": 6, "ports": ports}, {"frequency_limit": 1e4}):
        with pytest.raises(HousingError, match="a draft is of a number of modes"):
            solve_modes(box_matrices, draft=True, **wrong)


@BACKENDS
def test_clamped_and_sprung_blocks_match_dense_eigenvalues(
    block: Callable[..., Mesh], steel: Material, backend: Literal["rslab", "superlu"]
) -> None:
    mesh = block((0.10, 0.07, 0.05), (2, 1, 1))
    supports = [
        Support("base", surface="bottom", fixed=(True, False, True)),
        Support("cover", surface="top", stiffness=(1e8, 2e8, 0.0)),
    ]
    matrices = attach_fixtures(assemble(mesh, steel), mesh, supports)
    fixed = fixed_freedoms(mesh, supports)
    free = np.setdiff1d(np.arange(3 * len(mesh.points)), fixed)
    stiffness, mass = (m.toarray()[np.ix_(free, free)] for m in (matrices.stiffness, matrices.mass))
    expected = np.sqrt(linalg.eigh(stiffness, mass, eigvals_only=True))
    modes = solve_modes(matrices, frequency_limit=0.5 * (expected[14] + expected[15]), backend=backend)
    np.testing.assert_allclose(modes.frequencies, expected[:15], rtol=1e-9)
    assert np.abs(modes.shapes.reshape(15, -1)[:, fixed]).max() == 0.0


def test_modes_are_orthonormal_and_solve_the_problem(box_matrices: Matrices, box_modes: ModeSet) -> None:
    shapes = box_modes.shapes.reshape(len(box_modes.shapes), -1)
    count = len(shapes)
    np.testing.assert_allclose(shapes @ box_matrices.mass @ shapes.T, np.eye(count), atol=1e-10)
    values = box_modes.frequencies**2
    np.testing.assert_allclose(shapes @ box_matrices.stiffness @ shapes.T, np.diag(values), atol=1e-8 * values.max())
    inertia = box_matrices.mass @ shapes.T
    error = box_matrices.stiffness @ shapes.T - inertia * values
    assert (np.linalg.norm(error, axis=0) < 1e-8 * values[-1] * np.linalg.norm(inertia, axis=0)).all()
    assert (np.diff(box_modes.frequencies) >= 0.0).all()


@pytest.mark.parametrize(
    "asked", [{"frequency_limit": 2 * np.pi * 300.0}, {"frequency_limit": 2 * np.pi * 30.0}, {"count": 3}]
)
def test_rigid_modes_of_a_thin_box_are_certified_far_below_its_first_elastic_mode(
    thin_matrices: Matrices, asked: dict[str, Any]
) -> None:
    """The rounding of K, far larger than any wanted eigenvalue here, must neither hide the modes nor pass for one."""
    modes = solve_modes(thin_matrices, **asked)
    assert modes.frequencies.tolist() == [0.0] * 6
    assert modes.certificate.complete


def test_the_same_matrices_give_the_same_modes_bit_for_bit(box_matrices: Matrices, box_modes: ModeSet) -> None:
    again = solve_modes(box_matrices, frequency_limit=2 * np.pi * 6000.0)
    assert np.array_equal(again.frequencies, box_modes.frequencies)
    assert np.array_equal(again.shapes, box_modes.shapes)


def test_modes_project_on_ports(box: Mesh, box_modes: ModeSet) -> None:
    port = seat_matrix(box, Seat("front-seat", (-0.03, 0.08, 0.115)))
    motion = box_modes.project(port)
    assert motion.shape == (len(box_modes.frequencies), 6)
    np.testing.assert_allclose(motion[7], port @ box_modes.shapes[7].ravel(), rtol=1e-12)
    np.testing.assert_allclose(box_modes.frequencies_hz * 2 * np.pi, box_modes.frequencies)


def _solver_that(change: Callable[[Any, Any], tuple[Any, Any]]) -> Callable[..., tuple[Any, Any]]:
    """The Lanczos solver, whose result is spoiled before it is handed on."""
    honest = block_lanczos

    def solver(*arguments: Any, **options: Any) -> tuple[Any, Any]:
        return change(*honest(*arguments, **options))

    return solver


@pytest.mark.parametrize("asked", [{"frequency_limit": 2 * np.pi * 9000.0}, {"count": 12}])
def test_certificate_catches_a_solver_that_misses_a_mode(
    small_matrices: Matrices, monkeypatch: pytest.MonkeyPatch, asked: dict[str, Any]
) -> None:
    spoiled = _solver_that(lambda values, vectors: (np.delete(values, 7), np.delete(vectors, 7, axis=1)))
    monkeypatch.setattr(eigensolver, "block_lanczos", spoiled)
    with pytest.raises(IncompleteModesError, match=r"modes found below .* Hz where the inertia demands"):
        solve_modes(small_matrices, **asked)


def test_certificate_catches_a_solver_that_finds_one_mode_twice_and_misses_another(
    small_matrices: Matrices, monkeypatch: pytest.MonkeyPatch
) -> None:
    def repeat(values: Any, vectors: Any) -> tuple[Any, Any]:
        values[8], vectors[:, 8] = values[7], vectors[:, 7]
        return values, vectors

    monkeypatch.setattr(eigensolver, "block_lanczos", _solver_that(repeat))
    with pytest.raises(IncompleteModesError, match=r"largest overlap 1\.0e\+00"):
        solve_modes(small_matrices, frequency_limit=2 * np.pi * 9000.0)


def test_certificate_catches_a_mode_that_is_not_one(small_matrices: Matrices, monkeypatch: pytest.MonkeyPatch) -> None:
    def blur(values: Any, vectors: Any) -> tuple[Any, Any]:
        vectors[:, 8] += 1e-4 * vectors[:, 9]
        return values, vectors

    monkeypatch.setattr(eigensolver, "block_lanczos", _solver_that(blur))
    with pytest.raises(IncompleteModesError, match="largest residual"):
        solve_modes(small_matrices, frequency_limit=2 * np.pi * 9000.0)


def test_a_search_that_succeeds_the_second_time_is_enough(
    box_matrices: Matrices, box_modes: ModeSet, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    def once(values: Any, vectors: Any) -> tuple[Any, Any]:
        calls.append(len(values))
        return (values[:-1], vectors[:, :-1]) if len(calls) == 1 else (values, vectors)

    monkeypatch.setattr(eigensolver, "block_lanczos", _solver_that(once))
    modes = solve_modes(box_matrices, frequency_limit=2 * np.pi * 6000.0)
    assert len(calls) == 2
    np.testing.assert_allclose(modes.frequencies, box_modes.frequencies, rtol=1e-10)


def test_a_limit_between_two_modes_splits_them_and_one_upon_a_mode_is_refused(
    small_matrices: Matrices,
) -> None:
    last = float(solve_modes(small_matrices, frequency_limit=2 * np.pi * 9000.0).frequencies[8])
    assert len(solve_modes(small_matrices, frequency_limit=last * (1 + 1e-9)).frequencies) == 9
    assert len(solve_modes(small_matrices, frequency_limit=last * (1 - 1e-9)).frequencies) == 8
    with pytest.raises((FactorizationError, IncompleteModesError), match=r"another shift|move the limit"):
        solve_modes(small_matrices, frequency_limit=last)


def test_requests_for_nothing_and_for_everything_are_refused(
    cube: tuple[Mesh, Matrices], cube_values: npt.NDArray[np.float64], steel: Material, block: Callable[..., Mesh]
) -> None:
    _, matrices = cube
    with pytest.raises(HousingError, match="one of the two"):
        solve_modes(matrices)
    with pytest.raises(HousingError, match="one of the two"):
        solve_modes(matrices, count=3, frequency_limit=1.0)
    for count in (0, -1, 194, 1000):
        with pytest.raises(HousingError, match=f"{count} modes asked of 195 degrees of freedom: give 1 to 193"):
            solve_modes(matrices, count=count)
    for limit in (0.0, -5.0):
        with pytest.raises(HousingError, match="must be positive"):
            solve_modes(matrices, frequency_limit=limit)
    with pytest.raises(HousingError, match="every mode of the mesh lies below"):
        solve_modes(matrices, frequency_limit=1.1 * cube_values[-1])
    with pytest.raises(HousingError, match="every degree of freedom is fixed"):
        solve_modes(matrices.held(np.arange(195)), count=1)
    mesh = block((0.1, 0.1, 0.1))
    fixed = fixed_freedoms(mesh, [Support("base", surface="bottom", fixed=(True, True, True))])
    with pytest.raises(HousingError, match="no mode below 1 Hz; raise the limit"):
        solve_modes(assemble(mesh, steel).held(fixed), frequency_limit=2 * np.pi)


def test_a_stiffness_that_is_not_one_is_refused(
    cube: tuple[Mesh, Matrices], cube_values: npt.NDArray[np.float64]
) -> None:
    matrices = cube[1]
    wrong = Matrices(matrices.pointer, matrices.neighbors, -matrices.blocks, matrices.node_mass)
    with pytest.raises((FactorizationError, HousingError), match=r"not positive semidefinite|every mode"):
        solve_modes(wrong, frequency_limit=float(cube_values[10]))


def test_progress_is_told_in_words(cube: tuple[Mesh, Matrices], cube_values: npt.NDArray[np.float64]) -> None:
    told: list[str] = []
    modes = solve_modes(cube[1], frequency_limit=float(1.01 * cube_values[6]), progress=told.append)
    assert told[0] == "counting the modes below the limit"
    assert len(told) == 2
    assert set(modes.seconds) == {"factorisation", "eigensolver"}
