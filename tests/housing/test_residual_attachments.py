"""Residual attachments against dense solves of the whole stiffness, grounded and free."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import linalg, sparse

from gearwhine.housing import (
    HousingError,
    ModeSet,
    Seat,
    Support,
    attach_fixtures,
    solve_modes,
)
from gearwhine.housing.errors import ReductionError
from gearwhine.housing.fem.matrices import Matrices
from gearwhine.housing.model.seats import seat_matrix
from gearwhine.housing.model.supports import fixed_freedoms
from gearwhine.housing.modes.natural_modes import ModeSetExtension
from gearwhine.housing.modes.residual_modes import residual_attachment_modes
from gearwhine.meshes import Mesh
from gearwhine.numerics.arrays import FloatArray, IntArray

LIMIT = 2 * np.pi * 6000.0


@pytest.fixture(scope="module")
def clamped(beam: tuple[Mesh, Matrices]) -> IntArray:
    return fixed_freedoms(beam[0], [Support("root", surface="bottom", fixed=(True, True, True))])


@pytest.fixture(scope="module")
def port(beam: tuple[Mesh, Matrices]) -> sparse.csr_array:
    """Six motions of the far end, and the side motion of one node half way."""
    mesh = beam[0]
    row = np.zeros((1, 3 * len(mesh.points)))
    row[0, 3 * int(np.argmin(np.linalg.norm(mesh.points - [0.05, 0.03, 0.15], axis=1)))] = 1.0
    end = seat_matrix(mesh, Seat("top", (0.025, 0.03, 0.3)))
    return sparse.csr_array(sparse.vstack([end, sparse.csr_array(row)], format="csr"))


@pytest.fixture(scope="module")
def grounded(beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array) -> ModeSet:
    return solve_modes(beam[1].held(clamped), frequency_limit=LIMIT, ports=port)


def with_residual_modes(
    matrices: Matrices, modes: ModeSet, ports: sparse.csr_array | Sequence[sparse.csr_array]
) -> ModeSet:
    """The natural modes of a set, and residual modes of ports alone."""
    return ModeSetExtension(matrices, modes).with_ports(replace(modes, residual_modes=None), ports, orders=1)


def static(matrices: Matrices, fixed: IntArray, port: sparse.csr_array) -> FloatArray:
    """Displacements of all nodes under unit loads on the port by dense algebra, shape (3 n_nodes, r)."""
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), fixed)
    full = np.zeros((3 * matrices.n_nodes, port.shape[0]))
    stiffness = matrices.stiffness.toarray()[np.ix_(free, free)]
    full[free] = linalg.solve(stiffness, port.toarray().T[free], assume_a="pos")
    return full


def relief(matrices: Matrices, rigid: FloatArray, port: sparse.csr_array) -> FloatArray:
    """Elastic displacements of a free body under unit loads balanced by its inertia, by a bordered dense solve."""
    stiffness, mass = matrices.stiffness.toarray(), matrices.mass.toarray()
    moved = mass @ rigid.T
    loads = port.toarray().T
    loads = loads - moved @ linalg.solve(rigid @ moved, rigid @ loads)
    scale = np.abs(stiffness).max() / np.abs(moved).max(axis=0)
    border = moved * scale
    bordered = np.block([[stiffness, border], [border.T, np.zeros((6, 6))]])
    return np.asarray(linalg.solve(bordered, np.vstack([loads, np.zeros((6, loads.shape[1]))]))[: len(stiffness)])


def recovered(modes: ModeSet, port: sparse.csr_array) -> FloatArray:
    """Displacements of all nodes under unit loads on the port by elastic modes and attachments."""
    assert modes.residual_modes is not None
    elastic = modes.frequencies > 0.0
    total = np.zeros((port.shape[1], port.shape[0]))
    for frequencies, shapes in (
        (modes.frequencies[elastic], modes.shapes[elastic]),
        (modes.residual_modes.frequencies, modes.residual_modes.shapes),
    ):
        flat = shapes.reshape(len(shapes), -1)
        total += (flat.T / frequencies**2) @ (port @ flat.T).T
    return total


def worst(found: FloatArray, exact: FloatArray) -> float:
    size = np.sqrt(exact.diagonal())
    return float(np.abs((found - exact) / np.outer(size, size)).max())


def test_grounded_compliance_is_the_dense_solution(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, grounded: ModeSet
) -> None:
    exact = static(beam[1], clamped, port)
    attached = grounded.residual_modes
    assert attached is not None
    assert worst(attached.proof.compliance, port @ exact) < 1e-10
    assert worst(port @ recovered(grounded, port), port @ exact) < 1e-10
    assert attached.proof.error < 1e-10
    # Without attachments the modes lack what the proof says they lack.
    own = grounded.project(port)
    modal = (own.T / grounded.frequencies**2) @ own
    lacking = 1.0 - modal.diagonal() / (port @ exact).diagonal()
    np.testing.assert_allclose(attached.proof.missing_parts, lacking, atol=1e-10)
    assert lacking.max() > 0.01


def test_the_whole_displacement_field_is_exact(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, grounded: ModeSet
) -> None:
    exact = static(beam[1], clamped, port)
    np.testing.assert_allclose(recovered(grounded, port), exact, atol=1e-8 * np.abs(exact).max(axis=0).max())
    for column, whole in zip(recovered(grounded, port).T, exact.T, strict=True):
        assert np.linalg.norm(column - whole) < 1e-8 * np.linalg.norm(whole)


def test_free_compliance_is_inertia_relief(
    beam: tuple[Mesh, Matrices], port: sparse.csr_array, rigid_fields: Callable[[FloatArray], FloatArray]
) -> None:
    mesh, matrices = beam
    modes = solve_modes(matrices, frequency_limit=LIMIT, ports=port)
    assert (modes.frequencies[:6] == 0.0).all()
    exact = relief(matrices, rigid_fields(mesh.points), port)
    assert modes.residual_modes is not None
    assert worst(modes.residual_modes.proof.compliance, port @ exact) < 1e-10
    assert worst(port @ recovered(modes, port), port @ exact) < 1e-10


def test_modes_and_attachments_are_one_orthonormal_basis(
    beam: tuple[Mesh, Matrices], grounded: ModeSet, clamped: IntArray
) -> None:
    attached = grounded.residual_modes
    assert attached is not None
    basis = np.vstack([part.shapes.reshape(len(part.shapes), -1) for part in (grounded, attached)])
    squared = np.concatenate([grounded.frequencies, attached.frequencies]) ** 2
    np.testing.assert_allclose(basis @ (beam[1].mass @ basis.T), np.eye(len(basis)), atol=1e-11)
    stiffness = basis @ (beam[1].stiffness @ basis.T)
    np.testing.assert_allclose(stiffness / np.sqrt(np.outer(squared, squared)), np.eye(len(basis)), atol=1e-8)
    assert not basis[:, clamped].any()
    assert (np.diff(attached.frequencies) >= 0.0).all()
    # Rayleigh: nothing in the complement of the kept modes vibrates slower than the first discarded one.
    assert attached.frequencies[0] > grounded.certificate.limit


def test_soft_mounts_do_not_hide_the_local_compliance(
    beam: tuple[Mesh, Matrices], port: sparse.csr_array, rigid_fields: Callable[[FloatArray], FloatArray]
) -> None:
    """On mounts of some 10 Hz the ports are as compliant as those of the free body, to the order (ω / ω_elastic)²."""
    mesh, matrices = beam
    soft = attach_fixtures(matrices, mesh, [Support("mount", surface="bottom", stiffness=(3e4, 3e4, 3e4))])
    modes = solve_modes(soft, frequency_limit=LIMIT, ports=port)
    assert 0.0 < modes.frequencies_hz[0] < 50.0
    assert modes.residual_modes is not None
    exact = port @ relief(matrices, rigid_fields(mesh.points), port)
    assert worst(modes.residual_modes.proof.compliance, exact) < 1e-3
    assert modes.residual_modes.proof.error < 1e-10


def test_a_port_given_twice_brings_nothing_new(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, grounded: ModeSet
) -> None:
    twice = with_residual_modes(beam[1].held(clamped), grounded, [port, port[:2]])
    assert twice.residual_modes is not None
    assert grounded.residual_modes is not None
    np.testing.assert_allclose(twice.residual_modes.frequencies, grounded.residual_modes.frequencies, rtol=1e-6)
    assert twice.residual_modes.proof.compliance.shape == (9, 9)


def test_a_port_on_the_fixed_patch_does_not_move(
    beam: tuple[Mesh, Matrices], clamped: IntArray, grounded: ModeSet
) -> None:
    held = seat_matrix(beam[0], Seat("bottom", (0.025, 0.03, 0.0)))
    modes = with_residual_modes(beam[1].held(clamped), grounded, held)
    assert modes.residual_modes is not None
    assert modes.residual_modes.shapes.shape == (0, len(beam[0].points), 3)
    assert not modes.residual_modes.proof.compliance.any()
    assert not modes.residual_modes.proof.missing_parts.any()
    assert modes.residual_modes.project(held).shape == (0, 6)


def test_all_the_modes_lack_nothing(beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array) -> None:
    arrays = dense(beam[1], clamped, port)
    stiffness, mass, solve, shift, values, vectors, ports, free = arrays
    attached, _ = residual_attachment_modes(
        stiffness, mass, solve, values, vectors, ports, shift=shift, floor=-shift, free=free, n_nodes=beam[1].n_nodes
    )
    assert len(attached.frequencies) == 0
    assert attached.proof.missing_parts.max() == 0.0
    assert attached.proof.error < 1e-10


@settings(max_examples=10, deadline=None)
@given(count=st.integers(0, 60), power=st.floats(-4.0, 1.5))
def test_any_number_of_modes_and_any_shift_below_give_the_same_compliance(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, count: int, power: float
) -> None:
    compare_with_direct_solution(*dense(beam[1], clamped, port, shift=-(10.0**power)), cut=count)


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(count=st.integers(1, 60), part=st.floats(0.05, 0.95))
def test_a_shift_between_kept_and_discarded_modes_does_as_well(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, count: int, part: float
) -> None:
    """As a factor at the limit of the modes has it, however near to the first mode beyond."""
    values = dense(beam[1], clamped, port)[4]
    shift = (1.0 - part) * values[count - 1] + part * values[count]
    compare_with_direct_solution(*dense(beam[1], clamped, port, shift=float(shift / values[0])), cut=count)


@pytest.mark.parametrize("count", [3, 8, 20])
def test_loads_together_take_fewer_sweeps_than_the_slowest_alone(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, count: int
) -> None:
    """With the shift just below a discarded mode, whose direction all the loads then share."""
    ends = dense(beam[1], clamped, port)[4]
    shift = 0.02 * ends[count - 1] + 0.98 * ends[count]
    stiffness, mass, solve, place, values, vectors, ports, free = dense(
        beam[1], clamped, port, shift=float(shift / ends[0])
    )

    def sweeps(rows: sparse.csr_array) -> int:
        attached, _ = residual_attachment_modes(
            stiffness,
            mass,
            solve,
            values[:count],
            vectors[:, :count],
            rows,
            shift=place,
            floor=1e-3 * float(values[0]),
            free=free,
            n_nodes=beam[1].n_nodes,
        )
        return attached.proof.sweeps

    alone = [sweeps(sparse.csr_array(ports[[row]])) for row in range(ports.shape[0])]
    assert sweeps(ports) < max(alone)


def compare_with_direct_solution(
    stiffness: sparse.csr_array,
    mass: sparse.csr_array,
    solve: Callable[[FloatArray], FloatArray],
    shift: float,
    values: FloatArray,
    vectors: FloatArray,
    ports: sparse.csr_array,
    free: IntArray,
    *,
    cut: int,
) -> FloatArray:
    """The first ``cut`` modes with attachments against P K⁻¹ Pᵀ, refined with residuals of extended precision.

    The modes as the attachments leave them are returned.
    """
    n_nodes = int(free.max()) // 3 + 1
    attached, turned = residual_attachment_modes(
        stiffness,
        mass,
        solve,
        values[:cut],
        vectors[:, :cut],
        ports,
        shift=shift,
        floor=1e-3 * float(values[0]),
        free=free,
        n_nodes=n_nodes,
    )
    whole, loads = stiffness.toarray(), ports.T.toarray()
    factor = linalg.cho_factor(whole)
    moved = linalg.cho_solve(factor, loads).astype(np.longdouble)
    for _ in range(3):
        left = loads - whole.astype(np.longdouble) @ moved
        moved += linalg.cho_solve(factor, left.astype(np.float64))
    error = worst(attached.proof.compliance, np.asarray(loads.T @ moved, dtype=np.float64))
    assert error < 1e-10
    # The bound is one, but for the rounding of its own products with K: a tenth of what a proof may leave.
    assert error < attached.proof.error + 1e-11
    return turned


def test_rough_solutions_of_later_sweeps_leave_the_responses_exact_at_rest_and_at_the_shift(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array
) -> None:
    """Off by 2 % at every degree of freedom, as a factor in single precision is by less."""
    ends = dense(beam[1], clamped, port)[4]
    stiffness, mass, solve, shift, values, vectors, ports, free = dense(
        beam[1], clamped, port, shift=float(0.5 * (ends[7] + ends[8]) / ends[0])
    )
    scale = 1.0 + 0.02 * np.random.default_rng(4).uniform(-1.0, 1.0, (len(free), 1))
    attached, turned = residual_attachment_modes(
        stiffness,
        mass,
        solve,
        values[:8],
        vectors[:, :8],
        ports,
        shift=shift,
        floor=1e-3 * float(values[0]),
        free=free,
        n_nodes=beam[1].n_nodes,
        orders=2,
        solve_approximately=lambda right: scale * solve(scale * right),
    )
    shapes = np.vstack([turned.T, attached.shapes.reshape(len(attached.shapes), -1)[:, free]])
    motions = (ports @ shapes.T).T
    squared = np.concatenate([values[:8], attached.frequencies**2])
    for place in (0.0, shift):
        exact = ports @ linalg.solve(stiffness.toarray() - place * mass.toarray(), ports.T.toarray())
        found = motions.T @ (motions / (squared - place)[:, None])
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-8 * np.abs(exact).max())


@pytest.mark.parametrize("part", [1e-10, 1e-9, 6e-9])
def test_modes_as_inexact_as_their_certificate_allows_are_turned_to_the_exact_compliance(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, part: float
) -> None:
    """The lowest mode with a little of the discarded ones, which couples it with the attachments."""
    stiffness, mass, solve, shift, values, vectors, ports, free = dense(beam[1], clamped, port)
    inexact = vectors.copy()
    inexact[:, 0] += part * vectors[:, 8:20].sum(axis=1) / np.sqrt(12.0)
    turned = compare_with_direct_solution(stiffness, mass, solve, shift, values, inexact, ports, free, cut=8)
    np.testing.assert_allclose(turned.T @ (mass @ turned), np.eye(8), atol=1e-12)
    before, after = (np.linalg.norm(ports @ (some[:, 0] - vectors[:, 0])) for some in (inexact, turned))
    # By the lowest eigenvalue over the first discarded one, but for rounding.
    assert after < before * values[0] / values[8] + 1e-12 * np.linalg.norm(ports @ vectors[:, 0])


def test_modes_less_exact_than_their_certificate_allows_are_refused(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array
) -> None:
    """Or modes of another housing would be bent into this one's."""
    stiffness, mass, solve, shift, values, vectors, ports, free = dense(beam[1], clamped, port)
    inexact = vectors.copy()
    inexact[:, 0] += 1e-6 * vectors[:, 8:20].sum(axis=1)
    with pytest.raises(ReductionError, match="miss the static compliance at the ports by"):
        compare_with_direct_solution(stiffness, mass, solve, shift, values, inexact, ports, free, cut=8)


def test_modes_that_are_not_the_housings_fail_the_proof(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array, grounded: ModeSet
) -> None:
    wrong = replace(grounded, frequencies=grounded.frequencies * (1.0 + 1e-7))
    with pytest.raises(ReductionError, match="miss the static compliance at the ports by"):
        with_residual_modes(beam[1].held(clamped), wrong, port)
    bent = grounded.shapes.copy()
    bent[0] += 1e-3 * bent[1]
    with pytest.raises(ReductionError, match=r"overlap by|not its own"):
        with_residual_modes(beam[1].held(clamped), replace(grounded, shapes=bent), port)


def test_arrays_that_do_not_fit_are_refused(
    beam: tuple[Mesh, Matrices], clamped: IntArray, port: sparse.csr_array
) -> None:
    stiffness, mass, solve, shift, values, vectors, ports, free = dense(beam[1], clamped, port)
    places = {"floor": 1.0, "free": free, "n_nodes": beam[1].n_nodes}
    with pytest.raises(HousingError, match="expected"):
        residual_attachment_modes(stiffness, mass, solve, values, vectors, port, shift=shift, **places)
    with pytest.raises(HousingError, match="below zero or above every kept mode"):
        residual_attachment_modes(stiffness, mass, solve, values, vectors, ports, shift=float(values[3]), **places)


def dense(
    matrices: Matrices, fixed: IntArray, port: sparse.csr_array, *, shift: float = -1.0
) -> tuple[
    sparse.csr_array,
    sparse.csr_array,
    Callable[[FloatArray], FloatArray],
    float,
    FloatArray,
    FloatArray,
    sparse.csr_array,
    IntArray,
]:
    """What residual_attachment_modes takes, all modes by dense algebra; the shift in parts of the lowest eigenvalue."""
    free = np.setdiff1d(np.arange(3 * matrices.n_nodes), fixed)
    stiffness, mass = (sparse.csr_array(part[free][:, free]) for part in (matrices.stiffness, matrices.mass))
    values, vectors = linalg.eigh(stiffness.toarray(), mass.toarray())
    sigma = shift * float(values[0])
    factor = linalg.lu_factor((stiffness - sigma * mass).toarray())
    return stiffness, mass, lambda b: linalg.lu_solve(factor, b), sigma, values, vectors, port[:, free], free
