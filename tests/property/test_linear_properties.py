"""Laws of the linear analyses on random systems: completeness, shares that add up, reciprocity, one response."""

from dataclasses import replace

import numpy as np
import scipy.linalg
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.coupling import CoupledSystem, coupled_modes, receptance, stability
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.statics.mean_mesh import linear_matrices, mean_contact
from gearwhine.numerics.arrays import FloatArray

patient = settings(deadline=None, max_examples=25)
FREQUENCIES = np.array([0.3, 1.1, 7.0])


def sized(largest: float) -> st.SearchStrategy[float]:
    """None or some: what is there counts, or rounding would decide what the motion of a free body is."""
    return st.just(0.0) | st.floats(0.05 * largest, largest) | st.floats(-largest, -0.05 * largest)


@st.composite
def systems(draw: st.DrawFn, *, symmetric: bool = False) -> CoupledSystem:
    """Two or three turning components, some free, with unsymmetric bearings between them and a mesh."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    parts = []
    for name in ("one", "two", "three")[: draw(st.integers(2, 3))]:
        n = draw(st.integers(1, 4))
        rank = draw(st.integers(0, n))
        root, loss, turn = rng.normal(size=(3, n, n))
        root[:, rank:] = 0.0
        loss = 0.05 * loss @ loss.T if draw(st.booleans()) else np.zeros((n, n))
        kind = draw(st.sampled_from(["rotor", "torsion", "housing"]))
        parts.append(Component(name, (kind,) * n, root @ root.T, loss, 0.5 * (turn - turn.T)))
    size = sum(part.size for part in parts)
    bearings = []
    for name in ("left", "right")[: draw(st.integers(0, 2))]:
        stiffness, damping = rng.normal(size=(2, 2, 2))
        stiffness, damping = stiffness @ stiffness.T, 0.1 * damping @ damping.T
        if not symmetric:
            stiffness = stiffness + draw(sized(0.5)) * np.array([[0.0, 1.0], [-1.0, 0.0]])
        bearings.append(LinearConnector(name, rng.normal(size=(size, 2)), stiffness, damping))
    law = ToothContact(
        1.0, piecewise.constant(3.0, 1.0), piecewise.constant(0.0, 1.0), draw(st.sampled_from([0.0, 0.1]))
    )
    mesh = ContactConnector("mesh", rng.normal(size=size), law, 0.0, 1.0, np.empty((0, 3)))
    speeds = tuple(draw(sized(2.0)) for _ in parts)
    return CoupledSystem(tuple(parts), speeds, tuple(bearings), (mesh,))


@patient
@given(systems())
def test_all_eigenvalues_are_those_of_another_linearisation(system: CoupledSystem) -> None:
    """QZ on the pencil with mass, which shares no step with ours; zeros counted, the others paired."""
    modes = coupled_modes(system)
    certificate = modes.certificate
    assert certificate.found == certificate.expected == 2 * system.size
    assert certificate.max_residual < 1e-9
    stiffness, damping = linear_matrices(system, mean_contact(system))
    n = system.size
    left = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness, -damping]])
    other = scipy.linalg.eigvals(left, np.eye(2 * n))
    for value in modes.pairs.values:
        # Roots near each other are as uncertain as a square root, or a cube root, of the precision.
        assert np.abs(other - value).min() < 1e-4 * max(1.0, abs(value))
    rigid = np.linalg.matrix_rank(stiffness, tol=1e-9)
    assert len(modes.pairs.rigid) == n - rigid
    for motion in modes.pairs.rigid:
        assert np.abs(stiffness @ motion).max() < 1e-10


@patient
@given(systems())
def test_shares_add_up(system: CoupledSystem) -> None:
    modes = coupled_modes(system)
    shares = modes.shares
    np.testing.assert_allclose(shares.kinetic.sum(axis=1), 1.0, rtol=1e-12)
    assert shares.kinetic.min() >= 0.0
    elastic = (np.array(modes.kinds) != "rigid") & (shares.stiffness > 1e-6)
    np.testing.assert_allclose(shares.strain[elastic].sum(axis=1), 1.0, rtol=1e-8)
    # The balance of power: each part's damping, and no other, makes up the decay.
    np.testing.assert_allclose(shares.damping[elastic].sum(axis=1), modes.damping_ratios[elastic], rtol=1e-7, atol=1e-9)
    for energy in modes.energy:
        assert abs(sum(share for kind, share in energy.items() if kind != "mesh") - 1.0) < 1e-12


@patient
@given(systems(symmetric=True))
def test_passive_systems_are_stable(system: CoupledSystem) -> None:
    """No circulation, no negative dashpot: whatever turns, nothing grows, and no part feeds."""
    modes = coupled_modes(system)
    assert stability(modes, 1e-7).stable
    assert modes.shares.damping.min() > -1e-9


@patient
@given(systems())
def test_growth_has_a_feeder(system: CoupledSystem) -> None:
    for growing in stability(coupled_modes(system), 1e-6).growing:
        assert growing.feeders
        assert {part.kind for part, _ in growing.feeders} == {"connector"}


@patient
@given(systems(symmetric=True), st.integers(0, 2**32 - 1))
def test_reciprocity_with_the_rotation_reversed(system: CoupledSystem, seed: int) -> None:
    rows = np.random.default_rng(seed).normal(size=(2, 2, system.size))
    reversed_system = replace(system, speeds=tuple(-speed for speed in system.speeds))
    one = receptance(system, rows[0], rows[1], FREQUENCIES)
    other = receptance(reversed_system, rows[1], rows[0], FREQUENCIES)
    np.testing.assert_allclose(one, other.transpose(0, 2, 1), rtol=0.0, atol=1e-8 * np.abs(one).max())


@patient
@given(systems(), st.integers(0, 2**32 - 1))
def test_modes_do_not_depend_on_the_coordinates(system: CoupledSystem, seed: int) -> None:
    """Coordinates turned inside each component: the same eigenvalues, the same shares."""
    rng = np.random.default_rng(seed)
    turns = [np.linalg.qr(rng.normal(size=(part.size, part.size)))[0] for part in system.components]
    whole = scipy.linalg.block_diag(*turns)

    def turned(matrix: FloatArray, turn: FloatArray) -> FloatArray:
        return np.asarray(turn @ matrix @ turn.T)

    other = replace(
        system,
        components=tuple(
            Component(p.name, p.kinds, turned(p.stiffness, t), turned(p.damping, t), turned(p.gyroscopic, t))
            for p, t in zip(system.components, turns, strict=True)
        ),
        linear=tuple(replace(each, directions=whole @ each.directions) for each in system.linear),
        contacts=tuple(replace(each, direction=whole @ each.direction) for each in system.contacts),
    )
    one, two = coupled_modes(system), coupled_modes(other)
    assume(max(one.certificate.sum_rule, two.certificate.sum_rule) < 1e-10)
    assert len(one.kinds) == len(two.kinds)
    values = one.pairs.values
    apart = np.abs(values[:, None] - values) + 1e3 * np.eye(len(values))
    assume(apart.min(initial=1.0) > 1e-2)
    size = np.abs(one.eigenvalues)
    assume(np.diff(size[size > 0.0]).min(initial=1.0) > 1e-4)
    np.testing.assert_allclose(two.eigenvalues, one.eigenvalues, rtol=0.0, atol=1e-8 * size.max(initial=1.0))
    elastic = (size > 0.0) & (one.shares.stiffness > 1e-6)
    np.testing.assert_allclose(two.shares.strain[elastic], one.shares.strain[elastic], atol=1e-6)
    np.testing.assert_allclose(two.shares.kinetic[elastic], one.shares.kinetic[elastic], atol=1e-6)
