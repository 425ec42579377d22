"""Choice of the eigensolver: scipy's eigsh and block Lanczos give the same certified modes, double ones included."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import sparse

from gearwhine.housing import Housing, HousingError, IncompleteModesError, Material, assemble, solve_modes
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.modes import eigensolver
from gearwhine.housing.modes.eigensolver import LoadResponses, Solver, arpack_modes, block_lanczos
from gearwhine.meshes import ElementBlock, Mesh

IN_ONE_PROCESS: tuple[Solver, ...] = ("lanczos", "eigsh")
SOLVERS = pytest.mark.parametrize("solver", IN_ONE_PROCESS)
SIDE, WALL, LENGTH, CELLS, SLICES = 0.1, 0.01, 0.3, 6, 6


@pytest.fixture(scope="module")
def square_tube(steel: Material) -> Matrices:
    """A free square tube of 8-node bricks, laid by hand so that the mesh has the four-fold symmetry too."""
    steps = np.linspace(-0.5 * SIDE, 0.5 * SIDE, CELLS + 1)
    steps[[1, -2]] = [-0.5 * SIDE + WALL, 0.5 * SIDE - WALL]
    cells = [(i, j) for i in range(CELLS) for j in range(CELLS) if {i, j} & {0, CELLS - 1}]
    numbers: dict[tuple[int, int, int], int] = {}
    nodes = []
    for k in range(SLICES):
        for i, j in cells:
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            nodes.append([numbers.setdefault((*place, z), len(numbers)) for z in (k, k + 1) for place in ring])
    places = np.array(list(numbers))
    points = np.column_stack([steps[places[:, 0]], steps[places[:, 1]], LENGTH / SLICES * places[:, 2]])
    return assemble(Mesh(points, (ElementBlock("hexahedron", np.array(nodes)),)), steel)


@SOLVERS
@pytest.mark.parametrize("asked", [{"count": 24}, {"frequency_limit": 2 * np.pi * 12000.0}])
def test_double_modes_of_a_square_tube_are_complete(
    square_tube: Matrices, solver: Solver, asked: dict[str, Any]
) -> None:
    modes = solve_modes(square_tube, solver=solver, **asked)
    assert modes.certificate.complete
    assert modes.certificate.expected == len(modes.frequencies)
    elastic = modes.frequencies[6:]
    double = np.flatnonzero(np.diff(elastic) < 1e-9 * elastic[1:])
    assert len(double) >= 3  # bending in x and in y is one frequency, by the symmetry of the square


@pytest.mark.parametrize("asked", [{"count": 24}, {"frequency_limit": 2 * np.pi * 12000.0}])
def test_both_solvers_give_the_same_modes(square_tube: Matrices, asked: dict[str, Any]) -> None:
    one, other = (solve_modes(square_tube, solver=solver, **asked) for solver in IN_ONE_PROCESS)
    np.testing.assert_allclose(one.frequencies, other.frequencies, rtol=1e-9)
    # Within a double mode any rotation will do, so spaces are compared: every mode lies in the span of the others'.
    first, second = (modes.shapes.reshape(len(modes.shapes), -1) for modes in (one, other))
    shared = first @ square_tube.mass @ second.T
    np.testing.assert_allclose(np.linalg.norm(shared, axis=1), 1.0, atol=1e-8)


def test_responses_to_loads_come_with_the_modes() -> None:
    """Masses on springs of their own: each load moves its mass alone, by a closed form at rest and at the shift."""
    rng = np.random.default_rng(2)
    mass = rng.uniform(0.5, 2.0, 500)
    stiffness = mass * np.linspace(1.0, 30.0, 500) ** 2
    shift, loads = 5.07**2, rng.standard_normal((500, 3))
    kept, dynamic = stiffness < shift * mass, (stiffness - shift * mass)[:, None]
    responses = LoadResponses(loads, 3)
    values, _ = block_lanczos(
        lambda right: right / dynamic,
        SymmetricMatrix.of(sparse.csr_array(sparse.diags_array(mass))),
        shift,
        int(kept.sum()),
        above=True,
        responses=responses,
    )
    np.testing.assert_allclose(values, (stiffness / mass)[kept], rtol=1e-10)
    static, at_shift, derivative = responses.found
    expected = np.where(kept[:, None], 0.0, loads / stiffness[:, None])
    assert np.linalg.norm(static - expected) < 1e-6 * np.linalg.norm(expected)
    np.testing.assert_allclose(at_shift, loads / dynamic, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(derivative, mass[:, None] * loads / dynamic**2, rtol=1e-9, atol=1e-12)


def test_modes_of_eigsh_repeat_to_the_last_bit(square_tube: Matrices) -> None:
    one, other = (solve_modes(square_tube, count=12, solver="eigsh") for _ in range(2))
    np.testing.assert_array_equal(one.frequencies, other.frequencies)
    np.testing.assert_array_equal(one.shapes, other.shapes)


def test_eigsh_that_does_not_converge_is_tried_again_and_then_refused(
    square_tube: Matrices, monkeypatch: pytest.MonkeyPatch
) -> None:
    from scipy.sparse.linalg import ArpackNoConvergence

    tried = []

    def stuck(*_: Any, ncv: int, **__: Any) -> tuple[Any, Any]:
        tried.append(ncv)
        raise ArpackNoConvergence("No convergence", np.empty(0), np.empty((0, 0)))

    monkeypatch.setattr(eigensolver, "eigsh", stuck)
    with pytest.raises(IncompleteModesError, match="eigsh did not converge to 44 modes"):
        solve_modes(square_tube, count=12, solver="eigsh")
    assert tried == sorted(set(tried))
    assert len(tried) == 3


def test_an_unknown_eigensolver_is_refused(square_tube: Matrices) -> None:
    with pytest.raises(HousingError, match="eigensolver 'arnoldi'; expected one of 'lanczos', 'eigsh'"):
        solve_modes(square_tube, count=3, solver="arnoldi")  # type: ignore[arg-type]


def test_a_housing_hands_the_choice_on(
    block: Callable[..., Mesh], steel: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    def counted(*arguments: Any, **options: Any) -> tuple[Any, Any]:
        calls.append(options)
        return arpack_modes(*arguments, **options)

    monkeypatch.setattr(eigensolver, "arpack_modes", counted)
    solid = Housing(block((0.10, 0.07, 0.05), (2, 1, 1)), steel)
    own = solid.modes(count=9)
    assert not calls
    other = solid.modes(count=9, solver="eigsh")
    assert calls
    np.testing.assert_allclose(own.frequencies_hz, other.frequencies_hz, rtol=1e-9)
