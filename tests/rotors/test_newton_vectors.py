"""Vectors of exact roots are those of the roots, wherever the iteration began."""

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Disc, Rotor, Segment, ShaftMaterial, solve_whirl
from gearwhine.rotors.whirl.eigenvalues import random_vectors, refine_alone

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
ROTOR = Rotor("rotor", [Segment(1.5, 0.05, 0.0, STEEL)], [Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, STEEL.density)])
BEARINGS = [Bearing(name, at, np.diag([1e6, 8e5]), 300.0 * np.eye(2)) for name, at in (("a", 0.0), ("b", 1.5))]
# So near a root does the iteration begin, as a part of it: the last step then has any length there is.
DISTANCES = np.logspace(-3.0, -13.0, 81)


@pytest.mark.parametrize("mode", range(6))
def test_vectors_do_not_depend_on_where_the_iteration_began(mode: int) -> None:
    whirl = solve_whirl(ROTOR, BEARINGS, 400.0, count=6).roots
    (chain,) = whirl.equation_sets
    starts = whirl.eigenvalues[mode] * (1.0 + DISTANCES * np.exp(1j))
    found = refine_alone(chain, starts, random_vectors(starts.size, chain.pattern.order), whirl.speed)
    np.testing.assert_allclose(found.eigenvalues, whirl.eigenvalues[mode], rtol=1e-13)
    best = found.solutions[-1]
    along = found.solutions @ best.conj()
    rest = np.linalg.norm(found.solutions - along[:, None] * best, axis=1)
    np.testing.assert_allclose(rest, 0.0, atol=2e-12)
