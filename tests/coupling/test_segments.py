"""Periods marched in segments: their condensed corrections, and unstable motions that one shot would lose."""

import numpy as np
import pytest

from gearwhine.coupling import CoupledSystem, CouplingError, PeriodicError
from gearwhine.coupling.gears import ToothContact
from gearwhine.coupling.gears import piecewise_cubic as piecewise
from gearwhine.coupling.machine.components import Component
from gearwhine.coupling.machine.connectors import ContactConnector
from gearwhine.coupling.periodic import periodic_response, response_curve
from gearwhine.coupling.periodic.branch import Branch, interpolation
from gearwhine.coupling.periodic.orbit import bordered_correction, correction, integrate_period, product
from gearwhine.coupling.periodic.shooting import problem
from gearwhine.numerics.arrays import FloatArray

WAVING = ToothContact(
    1.0,
    piecewise.tabulated(lambda s: 1.0 + 0.3 * np.cos(2.0 * np.pi * s), 1.0, tolerance=1e-7),
    piecewise.constant(0.0, 1.0),
)
CYCLES = 28


def runout(speed: float, size: float = 1e-4) -> CoupledSystem:
    """x'' + 0.1 x' + k(t) g(x) = 1, and a runout error once in 28 mesh periods."""
    mass = Component("mass", ("torsion",), np.zeros((1, 1)), np.full((1, 1), 0.1), np.zeros((1, 1)))
    errors = np.array([[size, speed / CYCLES, 0.4]])
    teeth = ContactConnector("teeth", np.ones(1), WAVING, 0.0, speed / (2.0 * np.pi), errors)
    return CoupledSystem((mass,), (0.0,), contacts=(teeth,), load=np.ones(1))


def drawn(seed: int, count: int, size: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    pieces = rng.normal(size=(count, size, size)) / np.sqrt(size)
    return pieces, *rng.normal(size=(3, count, size))


def cyclic(pieces: FloatArray) -> FloatArray:
    """The whole system of A_k d_k - d_{k+1}."""
    count, size = pieces.shape[:2]
    matrix = np.zeros((count, size, count, size))
    for k, piece in enumerate(pieces):
        matrix[k, :, k] += piece
        matrix[k, :, (k + 1) % count] -= np.eye(size)
    return matrix.reshape(count * size, count * size)


@pytest.mark.parametrize(("seed", "count", "size"), [(1, 1, 4), (2, 2, 3), (3, 7, 6)])
def test_condensed_corrections_are_those_of_the_whole_system(seed: int, count: int, size: int) -> None:
    pieces, misses, by_speed, along = drawn(seed, count, size)
    matrix = cyclic(pieces)
    exact = np.linalg.solve(matrix, -misses.ravel()).reshape(count, size)
    for least in (False, True):
        found = correction(pieces, misses, product(pieces), least=least)
        np.testing.assert_allclose(found, exact, atol=1e-10 * np.abs(exact).max())
    bordered = np.block([[matrix, by_speed.reshape(-1, 1)], [along.reshape(1, -1), np.full((1, 1), 0.3)]])
    whole = np.linalg.solve(bordered, np.append(-misses.ravel(), 0.7))
    moves, change = bordered_correction(pieces, product(pieces), misses, by_speed, along, 0.3, 0.7)
    np.testing.assert_allclose(np.append(moves.ravel(), change), whole, atol=1e-10 * np.abs(whole).max())


def test_at_a_fold_the_bordered_correction_is_regular() -> None:
    """A monodromy with the multiplier 1, and a direction across what it leaves."""
    pieces = np.array([np.diag([2.0, 0.5]), np.diag([0.5, 0.5])])
    zero = np.zeros((2, 2))
    by_speed, along = np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
    moves, change = bordered_correction(pieces, product(pieces), zero, by_speed, along, 0.0, 1.0)
    assert change == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(moves, [[1.0, 0.0], [2.0, 0.0]], atol=1e-15)
    with pytest.raises(np.linalg.LinAlgError):
        correction(pieces, by_speed, product(pieces))


def test_interpolation_is_exact_for_polynomials() -> None:
    at = np.array([0.1, 0.4, 0.5, 0.9])
    for power in range(4):
        assert interpolation(at, 1.3) @ at**power == pytest.approx(1.3**power, rel=1e-12)


def test_segments_make_the_same_pass_as_one() -> None:
    """The pieces' product is the monodromy of the whole, and segments that begin where others end miss nothing."""
    system = runout(0.5, 0.2)
    ready = problem(system)
    assert ready.segments == CYCLES
    elements = ready.elements(2)
    begin = ready.part.state(np.array([1.3]), np.array([0.2]))
    through = integrate_period(ready.part, ready.contacts, elements, begin)
    assert np.abs(through.misses[:-1]).max() == 0.0
    again = integrate_period(ready.part, ready.contacts, elements, through.starts)
    np.testing.assert_allclose(again.end, through.end, rtol=1e-12)
    reach = 1e-6
    for column, unit in enumerate(np.eye(2)):
        ends = [
            integrate_period(ready.part, ready.contacts, elements, begin + sign * reach * unit, varied=False).end
            for sign in (1.0, -1.0)
        ]
        np.testing.assert_allclose(through.monodromy[:, column], (ends[0] - ends[1]) / (2.0 * reach), atol=1e-7)


@pytest.mark.slow
def test_an_unstable_motion_of_many_mesh_periods_is_followed() -> None:
    """A weak runout leaves the branch where it was; its multipliers are those of one mesh period to the 28th power."""
    once = response_curve(lambda speed: runout(speed, 0.0), 0.6, 0.9, points=20)
    often = response_curve(runout, 0.6, 0.9, points=20)
    assert often.ending == "end"
    assert [event.kind for event in often.folds] == ["fold", "fold"]
    assert [fold.speed for fold in often.folds] == pytest.approx([fold.speed for fold in once.folds], rel=1e-4)
    alone, middle = once.at(0.78)[1], often.at(0.78)[1]
    assert middle.period == pytest.approx(CYCLES * alone.period, rel=1e-12)
    growth = alone.floquet.largest**CYCLES
    assert growth > 1e4
    assert middle.floquet.largest == pytest.approx(growth, rel=1e-2)
    assert middle.residual < 1e-9
    assert middle.rms_compression[0] == pytest.approx(alone.rms_compression[0], rel=1e-3)
    assert max(response.residual for response in often.responses) < 1e-9


def test_the_tangent_is_the_difference_of_neighbours_whatever_the_elements_are_now() -> None:
    """Misses of other elements differ by more than a tiny change of the speed makes them."""
    speed, reach = 0.7, 1e-4
    branch = Branch(runout, 1, 0.3, 1, 1e-6, 1.0)
    point = branch.first(periodic_response(runout(speed)), speed)
    branch.level = 0
    states, pace = point.tangent
    sides = [branch_states(speed + sign * reach) for sign in (1.0, -1.0)]
    slope = (sides[0] - sides[1]) / (2.0 * reach)
    np.testing.assert_allclose(states / (0.3 * pace), slope, atol=1e-4 * np.abs(slope).max())


def branch_states(speed: float) -> FloatArray:
    """At all nodes, rates in the mesh's."""
    response = periodic_response(runout(speed))
    q, v = response.at_nodes(CYCLES)
    return np.concatenate([q, v / speed], axis=1)


def test_a_motion_starts_from_all_nodes_or_one() -> None:
    system = runout(0.5, 0.2)
    known = periodic_response(system)
    nodes = known.at_nodes(CYCLES)
    for start in (nodes, (nodes[0][0], nodes[1][0]), known):
        found = periodic_response(system, start=start)
        np.testing.assert_allclose(found.displacement, known.displacement, rtol=1e-9)
    with pytest.raises(CouplingError, match="to start from"):
        periodic_response(system, start=(nodes[0][:3], nodes[1][:3]))


@pytest.mark.parametrize(("points", "tries", "ending"), [(6, 1000, "points"), (1000, 6, "tries")])
def test_a_branch_that_is_left_says_so(points: int, tries: int, ending: str) -> None:
    curve = response_curve(lambda speed: runout(speed, 0.0), 0.6, 0.9, points=40, most_points=points, most_tries=tries)
    assert curve.ending == ending
    assert 2 <= len(curve.speeds) <= 7
    assert curve.speeds[-1] < 0.9
    assert "Nothing was followed" in curve.account
    assert f"{curve.speeds[-1]:.6g} and 0.9" in curve.account


def test_what_was_followed_before_a_branch_is_lost_is_kept() -> None:
    """Beyond some speed there is no machine of which a motion could be found."""

    def ending(speed: float) -> CoupledSystem:
        if speed > 0.68:
            raise PeriodicError("no machine")
        return runout(speed, 0.0)

    curve = response_curve(ending, 0.6, 0.9, points=20)
    assert curve.ending == "lost"
    assert 0.66 < curve.speeds[-1] <= 0.68
    assert "no next motion" in curve.account
    with pytest.raises(PeriodicError, match="where it begins"):
        response_curve(lambda speed: runout(speed, 0.0) if speed == 0.6 else ending(1.0), 0.6, 0.9, points=20)
