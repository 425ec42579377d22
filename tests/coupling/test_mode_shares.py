"""Shares of modes by hand: springs in series, dashpots, cross-coupled bearings, negative stiffness."""

import numpy as np
import numpy.typing as npt
import pytest

from gearwhine.coupling import CoupledSystem, CouplingError, coupled_modes, stability
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.linear.complex_modes import Part, mode_shares
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector, LinearConnector
from gearwhine.coupling.statics.mean_mesh import (
    ContactState,
    contact_at,
    linear_matrices,
    mean_contact,
    time_of_phase,
    unloaded_contact,
)


def mass(name: str, n: int = 1, kind: str = "rotor") -> Component:
    """Free, n unit masses."""
    return Component(name, (kind,) * n, *np.zeros((3, n, n)))


def spring(name: str, directions: npt.ArrayLike, stiffness: npt.ArrayLike, damping: npt.ArrayLike) -> LinearConnector:
    k, c = np.atleast_2d(np.array(stiffness, dtype=float)), np.atleast_2d(np.array(damping, dtype=float))
    return LinearConnector(name, np.array(directions, dtype=float).reshape(-1, len(k)), k, c)


def test_chain_of_two() -> None:
    """Two unit masses, wall -k- one -k- two: the golden ratio's shapes, and energies from them."""
    k, c = 7.0, 0.01
    system = CoupledSystem(
        (mass("one"), mass("two")),
        (0.0, 0.0),
        (spring("wall", [1.0, 0.0], k, 0.0), spring("between", [1.0, -1.0], k, c)),
    )
    modes = coupled_modes(system)
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    # Undamped shapes (1, φ) and (φ, -1); the dashpot changes them in second order.
    for i, shape in enumerate(np.array([[1.0, golden], [golden, -1.0]])):
        square = shape**2 / (shape @ shape)
        np.testing.assert_allclose(modes.shares.kinetic[i], square, atol=1e-4)
        strain = k * np.array([shape[0] ** 2, (shape[0] - shape[1]) ** 2])
        np.testing.assert_allclose(modes.shares.strain[i], [0.0, 0.0, *strain / strain.sum()], atol=1e-4)
        omega = np.sqrt(strain.sum() / (shape @ shape))
        ratio = 0.5 * c * (shape[0] - shape[1]) ** 2 / (shape @ shape) / omega
        np.testing.assert_allclose(modes.shares.damping[i], [0.0, 0.0, 0.0, ratio], atol=1e-6)
    names = [("component", "one"), ("component", "two"), ("connector", "wall"), ("connector", "between")]
    assert modes.shares.parts == tuple(Part(kind, name) for kind, name in names)  # type: ignore[arg-type]
    assert modes.where == ("two", "one")


@pytest.mark.parametrize("cross", [40.0, -40.0])
def test_cross_coupling_feeds(cross: float) -> None:
    """A mass on k with cross terms ±κ and a dashpot c elsewhere: λ² + cλ + k = ±iκ, and who does what to it."""
    k, c = 1e4, 0.2
    system = CoupledSystem(
        (mass("shaft", 2),),
        (0.0,),
        (
            spring("seal", np.eye(2), [[k, cross], [-cross, k]], np.zeros((2, 2))),
            spring("damper", np.eye(2), np.zeros((2, 2)), c * np.eye(2)),
        ),
    )
    roots = np.concatenate([np.roots([1.0, c, k - 1j * s * cross]) for s in (1.0, -1.0)])
    modes = coupled_modes(system)
    expected = roots[roots.imag > 0.0]
    np.testing.assert_allclose(np.sort_complex(modes.eigenvalues), np.sort_complex(expected), rtol=1e-11)
    verdict = stability(modes)
    assert not verdict.stable
    (growing,) = verdict.growing
    assert growing.eigenvalue == pytest.approx(complex(expected[np.argmax(expected.real)]), rel=1e-11)
    (feeder,) = growing.feeders
    assert feeder[0] == Part("connector", "seal")
    # q circles, so by hand: σ (|λ|² + k) = -|λ|² c + ω κ.
    value = growing.eigenvalue
    share = -value.imag * abs(cross) / (abs(value) ** 2 + k) / abs(value)
    assert feeder[1] == pytest.approx(share, rel=1e-9)
    assert growing.damping_ratio == pytest.approx(modes.shares.damping[growing.mode].sum(), rel=1e-9)
    assert growing.doubling_time == pytest.approx(np.log(2.0) / value.real)


def test_negative_stiffness_runs_off() -> None:
    """A magnet of -3 N/m beside a spring of 2: λ² + 0.4 λ - 1 = 0; the dashpot slows it, and feeds nothing."""
    magnet, held = spring("magnet", [1.0], -3.0, 0.0), spring("spring", [1.0], 2.0, 0.4)
    modes = coupled_modes(CoupledSystem((mass("rotor"),), (0.0,), (magnet, held)))
    (growing,) = stability(modes).growing
    assert growing.eigenvalue == pytest.approx(max(np.roots([1.0, 0.4, -1.0])), rel=1e-13)
    assert growing.eigenvalue.imag == 0.0
    assert [part.name for part, _ in growing.feeders] == ["magnet"]


def test_lossless_is_stable_and_free_is_rigid() -> None:
    modes = coupled_modes(CoupledSystem((mass("one"), mass("two")), (0.0, 0.0), (spring("k", [1.0, -1.0], 9.0, 0.0),)))
    assert modes.kinds == ("rigid", "rotor")
    assert stability(modes).stable
    assert stability(modes).least_damped == 1
    assert not modes.shares.strain[0].any()
    assert not modes.shares.damping[0].any()


@pytest.mark.parametrize(("stiffness", "stable"), [(-1e-28, True), (-1e-10, False)])
def test_what_rounding_makes_of_a_free_motion_is_no_growth(stiffness: float, stable: bool) -> None:
    """λ² = 1e-28 beside λ² = -9: a real eigenvalue grows at its full ratio however small it is."""
    held, magnet = spring("spring", [1.0, 0.0], 9.0, 0.0), spring("magnet", [0.0, 1.0], stiffness, 0.0)
    modes = coupled_modes(CoupledSystem((mass("one"), mass("two")), (0.0, 0.0), (held, magnet)))
    assert stability(modes).stable is stable


def geared(load: float, backlash: float | None = None, relief: float = 0.0) -> CoupledSystem:
    """Two inertias in torsion on base radii of 1: pairs of 100 N/m, one and a half of them on average."""
    ratio = 1.5
    law = ToothContact(
        ratio,
        piecewise.constant(100.0, ratio),
        piecewise.polyline(np.array([0.0, ratio]), np.array([relief, 0.0])),
        0.3,
    )
    drive = ContactConnector("mesh", np.array([1.0, 1.0]), law, 0.0, 10.0, np.empty((0, 3)))
    contacts = [drive]
    if backlash is not None:
        contacts.append(
            ContactConnector("back", -drive.direction, law, 0.0, -10.0, drive.errors, backlash, loaded=False)
        )
    return CoupledSystem(
        (mass("one", kind="torsion"), mass("two", kind="torsion")),
        (1.0, -1.0),
        contacts=tuple(contacts),
        load=load * np.ones(2),
    )


def test_contact_of_an_instant() -> None:
    """Two pairs in the first half of the period, one in the second; the mean of both; frequencies √(2 k)."""
    system = geared(2.0, backlash=1.0)
    np.testing.assert_allclose(mean_contact(system).stiffness, [150.0, 0.0])
    for phase, stiffness in ((0.25, 200.0), (0.75, 100.0)):
        state = contact_at(system, time_of_phase(system, phase))
        np.testing.assert_allclose(state.stiffness, [stiffness, 0.0], rtol=1e-9)
        np.testing.assert_allclose(state.damping, [0.3, 0.0])
        modes = coupled_modes(system, state)
        assert modes.kinds == ("rigid", "mesh")
        assert modes.where[1] == "mesh"
        assert abs(modes.eigenvalues[1]) == pytest.approx(np.sqrt(2.0 * stiffness), rel=1e-9)
        assert modes.damping_ratios[1] == pytest.approx(0.3 / np.sqrt(2.0 * stiffness), rel=1e-9)


def test_relief_that_the_load_does_not_close() -> None:
    """At phase 0.25 pairs stand at 0.25 and 1.25 of their path; with 1 N and 0.06 m of relief one of them is open."""
    state = contact_at(geared(1.0, relief=0.06), 0.025)
    np.testing.assert_allclose(state.stiffness, [100.0], rtol=1e-9)
    np.testing.assert_allclose(contact_at(geared(20.0, relief=0.06), 0.025).stiffness, [200.0], rtol=1e-9)


def test_states_and_phases_that_do_not_fit() -> None:
    system = geared(1.0)
    assert time_of_phase(system, 0.3) == pytest.approx(0.03)
    with pytest.raises(CouplingError, match="contact number 1 of 1"):
        time_of_phase(system, 0.3, contact=1)
    with pytest.raises(CouplingError, match="expected \\(1,\\) both"):
        linear_matrices(system, mean_contact(geared(1.0, backlash=1.0)))


def test_modes_stand_on_the_mesh_under_its_load() -> None:
    """A relief of 0.06 m at the end that enters, linear to none at the other: no second pair by 1 N.

    At phase p < 1/2 the pairs stand at p and 1 + p, their reliefs differ by 0.04: 1 N presses one spring of 100 N/m by
    0.01 and the other never, so the mean stiffness is 100. 20 N close both, and 150 N/m are what no load shows too.
    """
    light, heavy, none = (geared(load, relief=0.06) for load in (1.0, 20.0, 0.0))
    assert mean_contact(light).stiffness == pytest.approx([100.0], rel=1e-9)
    assert mean_contact(light).force == pytest.approx([1.0], rel=1e-9)
    assert mean_contact(heavy).stiffness == pytest.approx([150.0], rel=1e-9)
    assert mean_contact(none).stiffness == pytest.approx([150.0], rel=1e-9)
    assert mean_contact(none).force == pytest.approx([0.0], abs=0.0)
    assert unloaded_contact(light).stiffness == pytest.approx([150.0], rel=1e-9)
    assert abs(coupled_modes(light).eigenvalues[1]) == pytest.approx(np.sqrt(2.0 * 100.0), rel=1e-9)


def test_two_meshes_share_a_torque_by_their_mean_curves() -> None:
    """Two meshes side by side on one pair of inertias, one of them relieved by 0.02 m all over.

    F = 100 (δ - 0.02) + 100 δ from δ = 0.02 m on: of 6 N the relieved one carries 2 and the other 4. Of 1 N it carries
    none, and is apart.
    """

    def mesh(name: str, gap: float) -> ContactConnector:
        law = ToothContact(1.0, piecewise.constant(100.0, 1.0), piecewise.constant(gap, 1.0))
        return ContactConnector(name, np.array([1.0, 1.0]), law, 0.0, 10.0, np.empty((0, 3)))

    def shared(load: float) -> ContactState:
        inertias = (mass("one", kind="torsion"), mass("two", kind="torsion"))
        contacts = (mesh("near", 0.0), mesh("far", 0.02))
        return mean_contact(CoupledSystem(inertias, (1.0, -1.0), contacts=contacts, load=load * np.ones(2)))

    assert shared(6.0).force == pytest.approx([4.0, 2.0], rel=1e-6)
    assert shared(6.0).stiffness == pytest.approx([100.0, 100.0], rel=1e-9)
    assert shared(1.0).force == pytest.approx([1.0, 0.0], rel=1e-6)
    assert shared(1.0).stiffness == pytest.approx([100.0, 0.0], rel=1e-9)


def test_shares_of_equal_modes_do_not_depend_on_their_basis() -> None:
    """Two alike masses on alike springs, loosely tied: any turn of the two shapes is as good, and tells the same."""
    system = CoupledSystem(
        (mass("one"), mass("two"), mass("three")),
        (0.0, 0.0, 0.0),
        (
            spring("first", [1.0, 0.0, 0.0], 4.0, 0.01),
            spring("second", [0.0, 1.0, 0.0], 4.0, 0.01),
            spring("third", [0.0, 0.0, 1.0], 9.0, 0.02),
            spring("tie", [1.0, -1.0, 0.0], 4e-12, 0.0),
        ),
    )
    modes = coupled_modes(system)
    expected = np.array([[0.5, 0.5, 0.0], [0.5, 0.5, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(modes.shares.kinetic, expected, atol=1e-12)
    for angle in (0.3, 1.1, 2.5):
        turn = np.eye(3)
        turn[:2, :2] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
        turned = mode_shares(system, mean_contact(system), modes.eigenvalues, turn @ modes.shapes)
        np.testing.assert_allclose(turned.kinetic, modes.shares.kinetic, atol=1e-12)
        np.testing.assert_allclose(turned.strain, modes.shares.strain, atol=1e-12)
        np.testing.assert_allclose(turned.damping, modes.shares.damping, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_of_parts_that_have_as_much_the_first_is_named(sign: float) -> None:
    """Two masses tied to each other alike: both modes move both, and rounding must not choose between them."""
    tied = CoupledSystem(
        (mass("one"), mass("two")),
        (0.0, 0.0),
        (
            spring("left", [1.0, 0.0], 3.0 * (1.0 + sign * 1e-13), 0.0),
            spring("right", [0.0, 1.0], 3.0, 0.0),
            spring("between", [1.0, -1.0], 0.1, 0.0),
        ),
    )
    assert coupled_modes(tied).where == ("one", "one")


def test_modes_that_can_be_told_apart_keep_their_own_shares() -> None:
    """Springs that differ by 1e-7, ten times what makes a group: each mode is of its own mass."""
    apart = CoupledSystem(
        (mass("one"), mass("two")),
        (0.0, 0.0),
        (spring("left", [1.0, 0.0], 3.0, 0.0), spring("right", [0.0, 1.0], 3.0 * (1.0 + 1e-7), 0.0)),
    )
    modes = coupled_modes(apart)
    np.testing.assert_allclose(modes.shares.kinetic, np.eye(2), atol=1e-6)
    assert modes.where == ("one", "two")
