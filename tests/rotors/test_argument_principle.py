"""Roots divided out of the determinant before its turns are counted: the count is the same whatever is divided out."""

import numpy as np
import pytest

from gearwhine.numerics.arrays import ComplexArray
from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_lateral_modes,
    solve_whirl,
)
from gearwhine.rotors.whirl.argument_principle import count_by_argument_principle
from gearwhine.rotors.whirl.completeness import oscillating
from gearwhine.rotors.whirl.eigenvalues import constant_speed
from gearwhine.rotors.whirl.equations import whirl_equations

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISC = Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0)
SPEED = 400.0
LIMIT = 3000.0
BEARINGS = [
    Bearing("left", 0.0, np.array([[1e6, 2e5], [-2e5, 8e5]]), np.diag([300.0, 200.0])),
    Bearing("right", 1.5, np.diag([1e6, 8e5]), np.diag([300.0, 200.0])),
]


def shaft(parts: int) -> Rotor:
    return Rotor("shaft", [Segment(1.5 / parts, 0.05, 0.0, STEEL)] * parts, [DISC])


@pytest.mark.parametrize(
    "wrong",
    [
        np.array([200.0 + 900.0j]),
        np.array([-1.0 + 85.0j, -1.0 + 85.0j, -3.0 + 1500.0j]),
        np.array([-50.0 + 3010.0j, -50.0 + 2990.0j]),
        np.array([1e-7 + 2999.9999j, -400.0 + 1e-3j]),
    ],
    ids=["one", "twice the same", "on both sides of the edge", "next to the edge"],
)
def test_count_does_not_depend_on_what_is_divided_out(wrong: ComplexArray) -> None:
    # Every root inside, known or not, is counted once: by the argument principle, with nothing divided out.
    chain, sector, speed = whirl_equations(shaft(1), BEARINGS, (1, -1), 4000.0), oscillating(1e-2, LIMIT), SPEED
    modes = solve_whirl(shaft(1), BEARINGS, speed, frequency_limit=LIMIT)
    plain = count_by_argument_principle(chain, sector, constant_speed(speed))
    assert plain.count == modes.eigenvalues.size >= 8
    for known in (wrong, np.append(modes.eigenvalues, wrong), np.append(modes.eigenvalues[::2], wrong)):
        assert count_by_argument_principle(chain, sector, constant_speed(speed), known).count == plain.count


def test_roots_left_out_are_found_from_what_is_left() -> None:
    chain, sector = whirl_equations(shaft(1), BEARINGS, (1, -1), 4000.0), oscillating(1e-2, LIMIT)
    whole = solve_whirl(shaft(1), BEARINGS, SPEED, frequency_limit=LIMIT).eigenvalues
    known = np.delete(whole, [1, 4])
    winding = count_by_argument_principle(chain, sector, constant_speed(SPEED), known)
    assert winding.count - known.size == 2
    found = winding.missing(2)
    # Power sums by a rule of fourth order on few samples: good enough to start from, each nearest to its own.
    for root in whole[[1, 4]]:
        assert np.abs(found - root).min() < 0.3 * abs(root)


def test_all_roots_known_need_few_samples() -> None:
    chain, sector = whirl_equations(shaft(1), BEARINGS, (1, -1), 4000.0), oscillating(1e-2, LIMIT)
    known = solve_whirl(shaft(1), BEARINGS, SPEED, frequency_limit=2.0 * LIMIT).eigenvalues
    speed = constant_speed(SPEED)
    assert (
        count_by_argument_principle(chain, sector, speed, known).samples
        < 0.4 * count_by_argument_principle(chain, sector, speed).samples
    )


def test_equal_segments_are_one_piece_and_answer_as_before() -> None:
    one, many = shaft(1), shaft(60)
    assert whirl_equations(many, BEARINGS, (1, -1), 500.0).bending.lengths.size < 10
    same = [solve_whirl(rotor, BEARINGS, SPEED, count=8).eigenvalues for rotor in (one, many)]
    np.testing.assert_allclose(same[0], same[1], rtol=1e-12)
    undamped = [Bearing(b.name, b.at, np.diag(np.diag(b.stiffness)), np.zeros((2, 2))) for b in BEARINGS]
    at_rest = [rest_frequencies(rotor, undamped, count=8).frequencies for rotor in (one, many)]
    np.testing.assert_allclose(at_rest[0], at_rest[1], rtol=1e-12)
    supports = [bearing.mean_support for bearing in undamped]
    modes = solve_lateral_modes(many, supports, count=4)
    # Every joint is a station still, and the energy is told by segment.
    np.testing.assert_array_equal(modes.stations, many.stations)
    whole = solve_lateral_modes(one, supports, count=4)
    expected = np.abs(whole.evaluate(many.stations)[0])
    np.testing.assert_allclose(np.abs(modes.displacement), expected, rtol=0.0, atol=1e-10 * expected.max())
    segments, springs = modes.strain_energy_shares(many.joints)
    assert segments.shape == (4, 60)
    np.testing.assert_allclose(segments.sum(axis=1) + springs.sum(axis=1), 1.0, rtol=1e-9)
    np.testing.assert_allclose(segments.sum(axis=1), whole.strain_energy_shares(one.joints)[0][:, 0], rtol=1e-9)
