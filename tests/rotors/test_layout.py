"""Places of unknowns and equations of whirl, and what is filled in once for all."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial
from gearwhine.rotors.whirl.circular_coordinates import coupled_motions
from gearwhine.rotors.whirl.equations import WhirlEquations, whirl_equations

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISCS = [Disc.from_dimensions(at, 0.07, 0.28, 0.05, STEEL.density) for at in (0.5, 1.0)]
PLAIN = Rotor("plain", [Segment(1.5, 0.05, 0.0, STEEL)], DISCS)
ALIKE, UNLIKE = 2e6 * np.eye(2), np.diag([2e6, 1e6])
SPATIAL = np.diag([2e6, 1e6, 5e6, 3e3, 3e3])
SPATIAL[2, 4] = SPATIAL[4, 2] = 1e4
KINDS = {"one sense alone": ALIKE, "both senses": UNLIKE, "along the axis too": SPATIAL}
AT, SPEED = np.array([-3.0 + 400.0j]), np.array([300.0 + 0.0j])


def chains_of(stiffness: np.ndarray, pedestal: Pedestal | None) -> list[WhirlEquations]:
    """Two bearings at one place among them, for every set of tied motions."""
    bearings = [Bearing(name, at, stiffness, 1e-4 * stiffness) for name, at in (("a", 0.0), ("b", 1.2), ("c", 1.2))]
    bearings.append(Bearing("d", 1.5, stiffness, 1e-4 * stiffness, pedestal=pedestal))
    return [whirl_equations(PLAIN, bearings, blocks, 3e3).in_runs() for blocks in coupled_motions(bearings)]


def dense(chain: WhirlEquations) -> np.ndarray:
    pattern, matrix = chain.pattern, np.zeros((chain.pattern.order,) * 2, dtype=np.complex128)
    np.add.at(matrix, (pattern.rows, pattern.columns), chain.values(AT, SPEED, chain.force_scale(AT))[0])
    return matrix


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("pedestal", [None, Pedestal(ALIKE, 50.0 * np.eye(2), 3.0)])
def test_every_place_is_taken_once(kind: str, pedestal: Pedestal | None) -> None:
    for chain in chains_of(KINDS[kind], pedestal):
        layout = chain.layout
        columns = [
            layout.displacements,
            layout.forces,
            *(place for tie in layout.bearings for place in (tie.forces, tie.feet)),
        ]
        rows = [layout.continuity, layout.balances]
        rows += [place for tie in layout.bearings for place in (tie.force_rows, tie.foot_rows)]
        for places in (columns, rows):
            taken = np.sort(np.concatenate([one.ravel() for one in places]))
            np.testing.assert_array_equal(taken, np.arange(layout.order))
        # A node's equations hold what is at it and at its left neighbour.
        matrix = dense(chain)
        assert np.abs(matrix).max(axis=0).min() > 0.0
        for node, balance in enumerate(layout.balances):
            far = np.delete(layout.displacements, [max(node - 1, 0), node], axis=0)
            assert not matrix[np.ix_(balance, far.ravel())].any()


@pytest.mark.parametrize("kind", KINDS)
def test_the_determinant_is_that_of_any_other_order(kind: str) -> None:
    for chain in chains_of(KINDS[kind], None):
        logarithm = chain.shooting_matrix.log_determinants(AT, SPEED, chain.force_scale(AT))[0]
        sign, size = np.linalg.slogdet(dense(chain))
        assert logarithm.real == pytest.approx(size, rel=1e-12)
        assert np.exp(1j * logarithm.imag) == pytest.approx(sign, abs=1e-11)


def test_no_row_reaches_further_than_from_one_state_to_the_next() -> None:
    (chain,) = chains_of(UNLIKE, None)
    n, ties = chain.layout.displacements.shape[1], [tie.forces.size + tie.feet.size for tie in chain.layout.bearings]
    # From the first of a sense's four unknowns to the last of them at the next node, with the other sense and the ties
    # between, two of which stand at one node.
    widest = 2 * n + ties[1] + ties[2] + 3
    for row in dense(chain) != 0.0:
        places = np.flatnonzero(row)
        assert places[-1] - places[0] <= widest


def test_equal_runs_are_multiplied_once_and_no_others() -> None:
    bearings = [Bearing("left", 0.0, UNLIKE, 0.0 * UNLIKE), Bearing("right", 1.5, UNLIKE, 0.0 * UNLIKE)]
    steps = [Segment(0.25, 0.05 + 0.01 * (number // 2 == 1), 0.0, STEEL) for number in range(6)]
    for rotor, expected in ((PLAIN, [0, 0, 0]), (Rotor("stepped", steps, DISCS), [0, 1, 0])):
        chain = whirl_equations(rotor, bearings, (1, -1), 1e3).in_runs()
        *runs, like = chain.shooting_matrix.beams
        np.testing.assert_array_equal(like, expected)
        apart = replace(chain.shooting_matrix, beams=(*runs, np.arange(like.size)))
        scale = chain.force_scale(AT)
        np.testing.assert_array_equal(chain.values(AT, SPEED, scale), apart.values(AT, SPEED, scale))
