"""Modes by SLEPc and MUMPS on two ranks of MPI against dense algebra, and refusals where they are missing."""

import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg, sparse

from gearwhine.housing import HousingError, solve_modes
from gearwhine.housing.errors import FactorizationError, IncompleteModesError
from gearwhine.housing.fem.linear_algebra import SymmetricMatrix
from gearwhine.housing.fem.matrices import Additions, FreeSystem, Matrices, NodeBlocks
from gearwhine.housing.fem.slepc import COMMAND, SlepcRanks, SlepcUnavailableError
from gearwhine.meshes import Mesh

_DEBIAN = (
    Path("/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real"),
    Path("/usr/lib/slepcdir/slepc3.18/x86_64-linux-gnu-real"),
)


def chain(size: int) -> tuple[SymmetricMatrix, SymmetricMatrix, np.ndarray]:
    """Springs and masses in a line, free at one end, and their eigenvalues 4 sin²((2k - 1) π / (4 n + 2))."""
    entries = sparse.diags_array([-np.ones(size - 1), 2.0 * np.ones(size), -np.ones(size - 1)], offsets=[-1, 0, 1])
    whole = sparse.csr_array(entries).toarray()
    whole[-1, -1] = 1.0
    stiffness = SymmetricMatrix.of(sparse.csr_array(whole))
    is_diagonal = np.zeros(len(stiffness.values))
    is_diagonal[stiffness.pointer[:-1]] = 1.0
    values = 4.0 * np.sin((2.0 * np.arange(1, size + 1) - 1.0) * np.pi / (4.0 * size + 2.0)) ** 2
    return stiffness, SymmetricMatrix(stiffness.pointer, stiffness.rows, is_diagonal), values


@pytest.fixture(scope="module")
def two_ranks() -> Iterator[None]:
    """Two ranks of the Python that has SLEPc: this one, that of ``GEARWHINE_SLEPC``, or Debian's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OMPI_ALLOW_RUN_AS_ROOT", "1")
        patch.setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        if COMMAND not in os.environ:
            start = "mpiexec --oversubscribe -n 2"
            if all(folder.is_dir() for folder in _DEBIAN):
                patch.setenv("PETSC_DIR", str(_DEBIAN[0]))
                patch.setenv("SLEPC_DIR", str(_DEBIAN[1]))
                patch.setenv(COMMAND, f"{start} /usr/bin/python3")
            else:
                patch.setenv(COMMAND, f"{start} {sys.executable}")
        try:
            ranks = SlepcRanks(*chain(10)[:2])
        except SlepcUnavailableError as error:
            pytest.skip(str(error))
        assert ranks.ranks == 2
        del ranks
        yield


@pytest.mark.usefixtures("two_ranks")
def test_inertia_modes_and_solutions_of_a_chain() -> None:
    """On both sides of a shift, and after a factor at another one."""
    stiffness, mass, values = chain(50)
    ranks = SlepcRanks(stiffness, mass)
    shift = 0.5 * (values[7] + values[8])
    factor = ranks.factor(shift)
    assert factor.negative == 8
    assert factor.fill >= 99
    assert ranks.factor(-0.01).negative == 0
    for above, expected in ((True, values[:8]), (False, values[8:16])):
        found, vectors = ranks.modes(shift, 8, above=above, seed=0)
        np.testing.assert_allclose(found, expected, rtol=1e-11)
        np.testing.assert_allclose(vectors.T @ vectors, np.eye(8), atol=1e-10)
        np.testing.assert_allclose(stiffness @ vectors, vectors * found, atol=1e-10)
    assert ranks.factor(3.0).negative == np.count_nonzero(values < 3.0)
    right = np.random.default_rng(1).standard_normal((50, 3))
    exact = np.linalg.solve(stiffness.full().toarray() - shift * np.eye(50), right)
    np.testing.assert_allclose(factor.solve(right), exact, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(factor.solve(right[:, 0]), exact[:, 0], rtol=1e-9, atol=1e-9)
    assert len(ranks.peak_memory()) == 2
    assert min(ranks.peak_memory()) > 1e7


@pytest.mark.usefixtures("two_ranks")
@pytest.mark.slow
@pytest.mark.parametrize("by_number", [False, True])
def test_modes_of_a_free_cube_have_the_same_certificate(cube: tuple[Mesh, Matrices], by_number: bool) -> None:
    """Rigid, double and triple modes, by a limit and by a number."""
    _, matrices = cube
    values = linalg.eigh(matrices.stiffness.toarray(), matrices.mass.toarray(), eigvals_only=True)
    count = next(place for place in range(12, 60) if values[place] > 1.001 * values[place - 1])
    limit = np.sqrt(0.5 * (values[count - 1] + values[count]))
    modes = solve_modes(matrices, solver="slepc", **({"count": count} if by_number else {"frequency_limit": limit}))
    assert modes.backend == "mumps"
    assert modes.certificate.complete
    assert modes.certificate.expected == modes.certificate.found == count
    np.testing.assert_array_equal(modes.frequencies[:6], 0.0)
    np.testing.assert_allclose(modes.frequencies[6:] ** 2, values[6:count], rtol=1e-10)


@pytest.mark.usefixtures("two_ranks")
@pytest.mark.slow
def test_static_compliance_at_ports_by_solutions_of_the_ranks(beam: tuple[Mesh, Matrices]) -> None:
    held = beam[1].held(np.arange(12))
    port = sparse.csr_array(sparse.eye_array(2, held.stiffness.shape[0], k=300, format="csr"))
    modes = solve_modes(held, count=6, solver="slepc", ports=port)
    free = np.setdiff1d(np.arange(held.stiffness.shape[0]), held.fixed)
    loads = port[:, free].toarray()
    exact = loads @ np.linalg.solve(held.stiffness[free][:, free].toarray(), loads.T)
    every = modes.project_all(port)
    assert modes.residual_modes is not None
    squared = np.concatenate([modes.frequencies, modes.residual_modes.frequencies]) ** 2
    np.testing.assert_allclose(every.T @ (every / squared[:, None]), exact, rtol=1e-8, atol=1e-8 * np.abs(exact).max())


@pytest.mark.usefixtures("two_ranks")
def test_what_the_ranks_cannot_do_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More modes than there are, and ranks that have ended; nothing is left in the folder."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    stiffness, mass, values = chain(12)
    ranks = SlepcRanks(stiffness, mass)
    assert list(tmp_path.iterdir())
    with pytest.raises(IncompleteModesError, match=r"SLEPc converged to \d+ of 13 modes"):
        ranks.modes(0.5 * (values[3] + values[4]), 13, above=True, seed=0)
    del ranks
    # Ranks that answer once and end: an mpiexec that is killed may take its caller along.
    once = tmp_path / "once.py"
    once.write_text("print('{\"ranks\": 2}')")
    monkeypatch.setenv(COMMAND, f"{sys.executable} {once}")
    ended = SlepcRanks(stiffness, mass)
    with pytest.raises(FactorizationError, match="the ranks of SLEPc ended with code 0"):
        ended.factor(0.1)
    del ended
    once.unlink()
    assert not list(tmp_path.iterdir())


def test_a_mass_on_the_pattern_of_the_stiffness(box_matrices: Matrices) -> None:
    """With a mass attached to two nodes that share an element."""
    first, second = 0, int(box_matrices.neighbors[1])
    block = 5.0 * np.eye(3) + 1.0
    nodes = np.array([first, first, second, second]), np.array([first, second, first, second])
    attached = NodeBlocks(*nodes, np.array([2.0 * block, block, block, 2.0 * block]))
    loaded = box_matrices.plus(Additions(mass=attached))
    system = FreeSystem(loaded.held(np.arange(30, 60)))
    stiffness, mass = system.assembled_pair()
    vectors = np.random.default_rng(2).standard_normal((system.size, 2))
    assert mass.rows is stiffness.rows
    np.testing.assert_allclose(stiffness @ vectors, system.stiffness @ vectors, rtol=1e-12, atol=1e-3)
    np.testing.assert_allclose(mass @ vectors, system.mass @ vectors, rtol=1e-12, atol=1e-15)


def test_a_command_that_is_missing_or_has_no_slepc_is_named(
    cube: tuple[Mesh, Matrices], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(COMMAND, "no-such-mpiexec -n 2 python")
    with pytest.raises(SlepcUnavailableError, match=r"petsc4py and slepc4py.*GEARWHINE_SLEPC.*'no-such-mpiexec -n 2"):
        solve_modes(cube[1], count=3, solver="slepc")
    python = shutil.which("python3") or sys.executable
    monkeypatch.setenv(COMMAND, f"{python} -S")
    with pytest.raises(SlepcUnavailableError, match=r"gearwhine\[slepc\].*fails: .*ModuleNotFoundError"):
        solve_modes(cube[1], count=3, solver="slepc")


def test_a_factorisation_of_another_kind_is_refused(cube: tuple[Mesh, Matrices]) -> None:
    with pytest.raises(HousingError, match="'slepc' has a factorisation of its own, in double precision"):
        solve_modes(cube[1], count=3, solver="slepc", precision="single")
