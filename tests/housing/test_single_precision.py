"""Factors in single precision: inertia, solutions and modes against dense algebra in double, and wrong ones refused."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg, sparse

from gearwhine.housing import Material, assemble, solve_modes
from gearwhine.housing.errors import FactorizationError
from gearwhine.housing.fem import factorization, memory
from gearwhine.housing.fem.factorization import Factorizer, RslabSolver, UnprovedInertiaError
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.housing.fem.matrices import FreeSystem, Matrices
from gearwhine.housing.modes.certificate import CertifiedSearch
from gearwhine.housing.modes.davidson import davidson_modes
from gearwhine.meshes import Mesh

pytest.importorskip("rslab")


def dense_values(matrices: Matrices) -> np.ndarray:
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), matrices.fixed)
    stiffness, mass = (whole[free][:, free].toarray() for whole in (matrices.stiffness, matrices.mass))
    return linalg.eigh(stiffness, mass, eigvals_only=True)


def test_inertia_and_solutions_are_those_of_dense_algebra_in_double(cube: tuple[Mesh, Matrices]) -> None:
    _, matrices = cube
    values = dense_values(matrices)
    gaps = np.flatnonzero(np.diff(values) > 1e-3 * values[1:])
    factorizer = Factorizer(precision="single")
    right = np.random.default_rng(3).standard_normal((195, 5))
    for gap in gaps[gaps >= 5][::8]:
        shift = 0.5 * (values[gap] + values[gap + 1])
        matrix = matrices.shifted(shift)
        factor = factorizer.factor(matrix)
        assert factor.precision == "single"
        assert factor.negative == gap + 1
        expected = np.linalg.solve(matrix.toarray(), right)
        rough = factor.solve_approximately(right)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(factor.solve(right), expected, rtol=0.0, atol=1e-9 * scale)
        np.testing.assert_allclose(factor.solve(right[:, 0]), expected[:, 0], rtol=0.0, atol=1e-9 * scale)
        assert 1e-8 * scale < np.abs(rough - expected).max() < 1e-1 * scale


def test_solutions_of_forces_that_single_precision_has_not(cube: tuple[Mesh, Matrices]) -> None:
    """1e-60 N is nought in single precision."""
    matrix = cube[1].shifted(-1e9)
    right = np.random.default_rng(3).standard_normal(195)
    factor = Factorizer(precision="single").factor(matrix)
    np.testing.assert_allclose(1e60 * factor.solve(1e-60 * right), factor.solve(right), rtol=1e-9)
    assert not factor.solve(np.zeros((195, 2))).any()


@pytest.mark.parametrize("solver", ["lanczos", "eigsh"])
def test_modes_of_a_free_cube_with_double_and_triple_ones(cube: tuple[Mesh, Matrices], solver: str) -> None:
    """By a limit above the modes, and by a number with the shift below them."""
    _, matrices = cube
    values = dense_values(matrices)
    count = next(place for place in range(30, 60) if values[place] > 1.001 * values[place - 1])
    limit = np.sqrt(0.5 * (values[count - 1] + values[count]))
    assert np.sum(np.diff(values[6:count]) < 1e-9 * values[6 : count - 1]) >= 8
    for asked in ({"frequency_limit": limit}, {"count": count}):
        modes = solve_modes(matrices, precision="single", solver=solver, **asked)
        assert modes.backend == "rslab, single precision"
        assert modes.certificate.complete
        assert modes.certificate.expected == modes.certificate.found == count
        np.testing.assert_array_equal(modes.frequencies[:6], 0.0)
        np.testing.assert_allclose(modes.frequencies[6:] ** 2, values[6:count], rtol=1e-10)


def test_the_search_below_a_limit_gives_up_the_ordering_and_a_later_factor_finds_it_again(
    cube: tuple[Mesh, Matrices], monkeypatch: pytest.MonkeyPatch
) -> None:
    orderings: list[int] = []
    order = RslabSolver.order
    monkeypatch.setattr(RslabSolver, "order", lambda self, matrix: (orderings.append(1), order(self, matrix))[1])
    system = FreeSystem(cube[1])
    values = dense_values(cube[1])
    last = 6 + int(np.argmax(np.diff(values[6:30])))
    limit = np.sqrt(0.5 * (values[last] + values[last + 1]))
    factorizer = Factorizer(precision="single")
    found = CertifiedSearch(system, factorizer, system.floor(limit)).below(limit, lambda line: None)
    assert found.certificate.found == last + 1
    assert len(orderings) == 1
    counts = [factorizer.factor(system.shifted(shift)).negative for shift in (limit**2, 0.5 * values[6])]
    assert counts == [last + 1, 6]
    assert len(orderings) == 2


def test_modes_are_as_accurate_as_those_of_a_factor_in_double(box_matrices: Matrices) -> None:
    held = box_matrices.held(np.arange(30))
    limit = 2.0 * np.pi * 4000.0
    single, double = (solve_modes(held, frequency_limit=limit, precision=one) for one in ("single", "double"))
    assert single.certificate.max_residual < 1e-8
    assert double.backend == "rslab"
    np.testing.assert_allclose(single.frequencies, double.frequencies, rtol=1e-11)
    mac = np.abs(
        single.shapes.reshape(len(single.shapes), -1) @ (held.mass @ double.shapes.reshape(len(double.shapes), -1).T)
    )
    np.testing.assert_allclose(mac, np.eye(len(mac)), atol=1e-6)


def test_static_compliance_at_ports_holds_its_proof(box_matrices: Matrices) -> None:
    held = box_matrices.held(np.arange(30))
    port = sparse.csr_array(sparse.eye_array(3, held.stiffness.shape[0], k=300, format="csr"))
    modes = solve_modes(held, frequency_limit=2.0 * np.pi * 4000.0, precision="single", ports=port, port_orders=2)
    free = np.setdiff1d(np.arange(held.stiffness.shape[0]), held.fixed)
    inverse = sparse.linalg.splu(sparse.csc_array(held.stiffness[free][:, free]))
    loads = port[:, free].toarray()
    exact = loads @ inverse.solve(loads.T)
    every = modes.project_all(port)
    squared = np.concatenate([modes.frequencies, modes.residual_modes.frequencies]) ** 2
    np.testing.assert_allclose(every.T @ (every / squared[:, None]), exact, rtol=1e-8, atol=1e-8 * np.abs(exact).max())


def nearly_singular(rng: np.random.Generator, least: float) -> np.ndarray:
    """A full matrix of order 60 with 20 negative eigenvalues, the magnitudes from ``least`` to 1."""
    turn = np.linalg.qr(rng.standard_normal((60, 60)))[0]
    values = np.geomspace(least, 1.0, 60)
    values[::3] *= -1.0
    matrix = (turn * values) @ turn.T
    return 0.5 * (matrix + matrix.T)


def test_a_wrong_inertia_is_never_proved() -> None:
    """Eigenvalues far below the rounding of single precision: many counts are wrong there, and double's are told."""
    wrong = refused = proved = 0
    for seed in range(40):
        for least in (1e-10, 1e-6):
            matrix = SymmetricMatrix.of(sparse.csr_array(nearly_singular(np.random.default_rng(seed), least)))
            raw = RslabSolver(1).factor(matrix, "single").negative
            said: list[str] = []
            factor = Factorizer(precision="single", threads=1, progress=said.append).factor(matrix)
            assert factor.negative == 20
            assert (factor.precision == "double") == bool(said)
            wrong += raw != 20
            refused += factor.precision == "double"
            proved += factor.precision == "single"
            assert factor.precision == "double" or raw == 20
            assert all("is not proved" in one and one.endswith("factoring in double precision") for one in said)
    assert wrong >= 10
    assert refused >= 40
    assert proved >= 20


@pytest.mark.parametrize(("along", "passes"), [(1e-3, True), (0.9, False), (1.0, False), (1.001, False), (-1.5, False)])
def test_the_proof_follows_the_eigenvalues_of_the_refinement(along: float, passes: bool) -> None:
    """Of A = F (I - G), G has one eigenvalue that is not small; where this is above 1, A has another inertia than F."""
    rng = np.random.default_rng(5)
    turn = np.linalg.qr(rng.standard_normal((300, 300)))[0]
    values = rng.uniform(1.0, 2.0, 300)
    shares = np.full(300, 1e-4)
    shares[7] = along
    matrix = SymmetricMatrix.of(sparse.csr_array((turn * (values * (1.0 - shares))) @ turn.T))
    inverse = (turn / values) @ turn.T
    factor = Factorizer(precision="single", threads=1).factor(SymmetricMatrix.of(sparse.csr_array(np.diag(values))))

    class Exact:
        fill, negative = 0, 0

        def solve(self, right: np.ndarray) -> np.ndarray:
            return inverse @ right

    stub = replace(factor, _factor=Exact(), _matrix=matrix)
    if passes:
        factorization._prove_inertia(stub, matrix)
    else:
        with pytest.raises(UnprovedInertiaError, match="order 300 is not proved by its factor in single precision"):
            factorization._prove_inertia(stub, matrix)
    if along > 0.99:
        with pytest.raises(FactorizationError, match="refinement of solutions from a factor in single precision stops"):
            stub.solve(rng.standard_normal(300))


def test_a_limit_beside_a_mode_is_counted_in_double(cube: tuple[Mesh, Matrices]) -> None:
    """One part in 1e10 above a single mode: single precision cannot tell the sides."""
    _, matrices = cube
    values = dense_values(matrices)
    gaps = np.diff(values)[7:40]
    place = 8 + int(np.argmax(np.minimum(gaps[:-1], gaps[1:]) / values[8:40]))
    said: list[str] = []
    modes = solve_modes(
        matrices, frequency_limit=np.sqrt(values[place] * (1.0 + 1e-8)), precision="single", progress=said.append
    )
    assert modes.certificate.found == place + 1
    assert modes.backend == "rslab"
    assert any("not proved by its factor in single precision" in one for one in said)


def test_thin_walls_and_materials_far_apart(block: Callable[..., Mesh]) -> None:
    """A sheet of a hundredth of its width, and half of it a million times softer: the same count as in double."""
    sheet = block((0.3, 0.3, 0.003), (3, 3, 1))
    soft, steel = Material(2e5, 0.3, 2000.0), Material(2e11, 0.3, 7850.0)
    for material in (steel, soft):
        matrices = assemble(sheet, material)
        values = dense_values(matrices)
        limit = np.sqrt(0.5 * (values[11] + values[12]))
        modes = solve_modes(matrices, frequency_limit=limit, precision="single")
        assert modes.certificate.expected == 12
        np.testing.assert_allclose(modes.frequencies[6:] ** 2, values[6:12], rtol=1e-7)
    stiff, weak = assemble(sheet, steel), assemble(sheet, soft)
    stitched = replace(stiff, blocks=stiff.blocks.copy(), node_mass=stiff.node_mass.copy())
    half = stiff.rows > stiff.n_nodes // 2
    stitched.blocks[half], stitched.node_mass[half] = weak.blocks[half], weak.node_mass[half]
    shifts = -np.geomspace(1e2, 1e8, 5)
    for shift in shifts:
        double, single = (Factorizer(precision=one).factor(stitched.shifted(shift)) for one in ("double", "single"))
        assert double.negative == single.negative


def test_the_available_memory_chooses_and_it_is_told(box_matrices: Matrices, monkeypatch: pytest.MonkeyPatch) -> None:
    matrix = SymmetricMatrix.of(box_matrices.shifted(-1e8))
    needs = {one: RslabSolver(2).memory(matrix, one) for one in ("single", "double")}
    beside = 8.0 * 200 * matrix.shape[0]
    assert 0.4 < needs["single"] / needs["double"] < 0.75

    def factored(available: float) -> tuple[str, list[str]]:
        for module in (factorization, memory):
            monkeypatch.setattr(module, "available_memory", lambda: available)
        said: list[str] = []
        return Factorizer(progress=said.append).factor(matrix).precision, said

    assert factored(1.01 * (needs["double"] + beside)) == ("double", [])
    precision, said = factored(0.99 * (needs["double"] + beside))
    assert precision == "single"
    assert len(said) == 1
    assert said[0].startswith("factoring in single precision, with proofs and refinement in double: a factor in double")
    assert f"{(needs['double'] + beside) / 1e9:.2g} GB of memory" in said[0]
    with pytest.raises(MemoryError, match=r"in single precision needs .* a larger mesh_size needs less"):
        factored(0.99 * needs["single"])


def test_what_single_precision_cannot_prove_and_double_has_no_memory_for(monkeypatch: pytest.MonkeyPatch) -> None:
    matrix = SymmetricMatrix.of(sparse.csr_array(nearly_singular(np.random.default_rng(0), 1e-10)))
    solver = RslabSolver(1)
    available = 0.5 * (solver.memory(matrix, "single") + solver.memory(matrix, "double"))
    monkeypatch.setattr(memory, "available_memory", lambda: available)
    with pytest.raises(MemoryError, match=r"not proved .*in double precision needs .*or move the limit a little"):
        Factorizer(precision="single", threads=1).factor(matrix)


def test_precisions_that_are_not_there_are_named() -> None:
    with pytest.raises(FactorizationError, match="precision 'half'; expected one of 'double', 'single'"):
        Factorizer(precision="half")  # type: ignore[arg-type]
    with pytest.raises(FactorizationError, match="superlu factors in double precision only; single needs rslab"):
        Factorizer(backend="superlu", precision="single")


@pytest.mark.parametrize("spoilt", [0.0, 3000.0])
def test_modes_of_a_chain_from_an_inverse_of_another_chain(spoilt: float) -> None:
    """Λ = 2 - 2 cos kπ/(n+1) of a chain of unit springs and masses, with the inverse of one on springs to the ground.

    These are random, of 3000 times the lowest eigenvalue; the steps then fill the space more than once.
    """
    n, count = 1500, 12
    exact = 2.0 - 2.0 * np.cos(np.arange(1, n + 1) * np.pi / (n + 1))
    chain = sparse.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n), format="csr")
    shift = 0.5 * (exact[count - 1] + exact[count])
    ground = spoilt * exact[0] * np.random.default_rng(1).standard_normal(n)
    banded = np.stack([np.r_[0.0, -np.ones(n - 1)], 2.0 - shift + ground, np.r_[-np.ones(n - 1), 0.0]])
    widths: list[int] = []

    def solve(right: np.ndarray) -> np.ndarray:
        widths.append(right.shape[1])
        return linalg.solve_banded((1, 1), banded, right)

    values, vectors = davidson_modes(
        n, lambda motions: (chain @ motions, np.float64(motions)), solve, count, floor=exact[0], tolerance=1e-9
    )
    np.testing.assert_allclose(values, exact[:count], rtol=1e-9)
    residuals = np.linalg.norm(chain @ vectors - vectors * values, axis=0)
    assert (residuals < 1.001e-9 * (values + values[-1] + exact[0])).all()
    places = np.arange(1, n + 1)[:, None] * np.arange(1, count + 1) * np.pi / (n + 1)
    shapes = np.sqrt(2.0 / (n + 1)) * np.sin(places)
    np.testing.assert_allclose(np.abs(shapes.T @ vectors), np.eye(count), atol=1e-6)
    assert sum(widths) > (4 * count + 9 * widths[0] if spoilt else 0)
