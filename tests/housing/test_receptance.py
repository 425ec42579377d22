"""Receptance against direct solves of the dynamic stiffness, its reciprocity, and the selection of modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import spsolve

from gearwhine.housing import HousingError, ModeSet, Seat, Sensor, Support, receptance, solve_modes
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix, sensor_port
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.modes.receptance import residues, select_modes
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray

LIMIT = 2 * np.pi * 9000.0


@pytest.fixture(scope="module")
def ports(beam: tuple[Mesh, Matrices]) -> tuple[sparse.csr_array, sparse.csr_array]:
    """The x and y motion of the far end, and a sensor on a side."""
    end = seat_matrix(beam[0], Seat("top", (0.025, 0.03, 0.3)))[:2]
    return end, sensor_port(beam[0], Sensor("side", (0.05, 0.04, 0.17))).matrix


@pytest.fixture(scope="module")
def modes(beam: tuple[Mesh, Matrices], ports: tuple[sparse.csr_array, sparse.csr_array]) -> ModeSet:
    fixed = fixed_freedoms(beam[0], [Support("root", surface="bottom", fixed=(True, True, True))])
    both = sparse.csr_array(sparse.vstack(list(ports), format="csr"))
    return solve_modes(beam[1].held(fixed), frequency_limit=LIMIT, ports=both)


def direct(beam: tuple[Mesh, Matrices], port_a: sparse.csr_array, port_b: sparse.csr_array, w: float) -> FloatArray:
    """Undamped receptance from a solve with all degrees of freedom of the clamped beam."""
    mesh, matrices = beam
    fixed = fixed_freedoms(mesh, [Support("root", surface="bottom", fixed=(True, True, True))])
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), fixed)
    dynamic = sparse.csc_matrix((matrices.stiffness - w**2 * matrices.mass)[free][:, free])
    motion = spsolve(dynamic, sparse.csc_matrix(port_a[:, free].T)).reshape(len(free), -1)
    return np.asarray((port_b[:, free] @ motion).toarray() if sparse.issparse(motion) else port_b[:, free] @ motion)


def test_receptance_is_the_direct_solution(
    beam: tuple[Mesh, Matrices], ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    """Exact at rest; within the kept band to the order of (w / first discarded ω)⁴, and far better than modes alone."""
    undamped = np.zeros(len(modes.frequencies))
    bare = replace(modes, residual_modes=None)
    for part, allowed in ((0.0, 1e-10), (0.1, 1e-4), (0.3, 1e-2)):
        w = part * LIMIT
        exact = direct(beam, ports[0], ports[0], w)
        size = np.abs(exact).max()
        with_attachments = receptance(modes, undamped, ports[0], ports[0], np.array([w]))[0]
        alone = receptance(bare, undamped, ports[0], ports[0], np.array([w]))[0]
        assert np.abs(with_attachments - exact).max() < allowed * size
        assert np.abs(alone - exact).max() > 10 * np.abs(with_attachments - exact).max()


def test_reciprocity(ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet) -> None:
    ratios = np.linspace(0.005, 0.03, len(modes.frequencies))
    grid = np.linspace(0.0, 1.2 * LIMIT, 50)
    there = receptance(modes, ratios, *ports, grid)
    back = receptance(modes, ratios, *reversed(ports), grid)
    assert there.shape == (50, 1, 2)
    np.testing.assert_allclose(there, back.transpose(0, 2, 1), rtol=1e-10)


def test_at_resonance_the_residue_stands_over_the_damping(
    ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    """H = A / (2 i ζ ω²) of the resonant mode as the damping vanishes."""
    ratios = np.full(len(modes.frequencies), 1e-7)
    carrier = residues(modes, *ports)[1]
    peak = receptance(modes, ratios, *ports, modes.frequencies[1:2])[0]
    np.testing.assert_allclose(peak, carrier / (2j * 1e-7 * modes.frequencies[1] ** 2), atol=1e-3 * np.abs(peak).max())


def test_selection_states_the_error_that_is_left(
    ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    ratios = np.full(len(modes.frequencies), 0.01)
    band = (2 * np.pi * 200.0, 2 * np.pi * 8000.0)
    selection = select_modes(modes, ratios, *ports, band, tolerance=0.02)
    assert 0 < selection.count < len(modes.frequencies)
    assert sorted(selection.ranking) == list(range(len(modes.frequencies)))
    assert (np.diff(selection.strength) <= 0.0).all()
    assert selection.error_left[-1] == 0.0
    # A mode set that holds only these modes, on another grid of frequencies.
    kept = selection.kept
    fewer = replace(modes, frequencies=modes.frequencies[kept], shapes=modes.shapes[kept])
    grid = np.linspace(*band, 5001)
    whole = receptance(modes, ratios, *ports, grid)
    left = np.linalg.norm(whole - receptance(fewer, ratios[kept], *ports, grid), axis=(1, 2)).max()
    left /= np.linalg.norm(whole, axis=(1, 2)).max()
    assert left <= 0.02
    assert left == pytest.approx(selection.error_left[selection.count], rel=0.02)
    without_last = selection.error_left[selection.count - 1]
    assert without_last > 0.02


def test_a_motion_that_symmetry_forbids_needs_no_such_mode(
    beam: tuple[Mesh, Matrices], ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet
) -> None:
    """The block is its own mirror image in x and in y: bending in the y-z plane moves nothing along x."""
    x = ports[0][:1]
    ratios = np.full(len(modes.frequencies), 0.01)
    selection = select_modes(modes, ratios, x, x, (0.0, LIMIT), tolerance=1e-6)
    moved = modes.project(ports[0])
    across = np.flatnonzero(np.abs(moved[:, 1]) > 100 * np.abs(moved[:, 0]))
    assert across.size
    assert not set(across) & set(selection.kept)


def test_what_cannot_be_asked(ports: tuple[sparse.csr_array, sparse.csr_array], modes: ModeSet) -> None:
    ratios = np.full(len(modes.frequencies), 0.01)
    with pytest.raises(HousingError, match="expected as many"):
        receptance(modes, ratios[1:], *ports, np.array([1.0]))
    with pytest.raises(HousingError, match="infinite at"):
        receptance(modes, 0.0 * ratios, *ports, modes.frequencies[:1])
    with pytest.raises(HousingError, match="expected 0 <= from < to"):
        select_modes(modes, ratios, *ports, (2.0, 1.0), 0.1)
    with pytest.raises(HousingError, match="above 0"):
        select_modes(modes, ratios, *ports, (1.0, 2.0), 0.0)
