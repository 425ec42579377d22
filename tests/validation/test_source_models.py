"""Friswell's rotor twice: by the source's own elements, to its printed digits, and converged.

A number printed for a coarse mesh proves little of an exact model. So the source's six two-node elements stand here,
built in the finite-element reference of `tests/rotors`: what they printed comes out, which proves the model understood;
the same model with elements refined to 1e-12 is what the package must find (Friswell, Penny, Garvey & Lees, Dynamics of
Rotating Machines, 2010, examples 5.9.1 and 5.9.2).
"""

import numpy as np
import pytest
from finite_element_whirl import spatial_matrices

from gearwhine.rotors import (
    Bearing,
    Disc,
    Rotor,
    Segment,
    ShaftMaterial,
    rest_frequencies,
    solve_whirl,
)

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISCS = [Disc.from_dimensions(at, 0.07, diameter, 0.05, 7810.0) for at, diameter in ((0.5, 0.28), (1.0, 0.35))]
FRISWELL = Rotor("Friswell 5.9.1", [Segment(0.25, 0.05, 0.0, STEEL)] * 6, DISCS)
TURN = 2.0 * np.pi / 60.0
# A frequency so low that no span is cut.
UNCUT = 1.0


def at_ends(k_xx: float, k_yy: float) -> list[Bearing]:
    stiffness = np.diag([k_xx, k_yy])
    return [Bearing(name, z, stiffness, np.zeros((2, 2))) for name, z in (("left", 0.0), ("right", 1.5))]


@pytest.mark.parametrize(
    ("k_yy", "speed", "printed"),
    [
        # 716.786 by the source's own element, which it printed as 716.78: cut off, not rounded.
        (1e6, 0.0, [86.66, 86.66, 274.31, 274.31, 716.786]),
        (1e6, 4000.0, [85.39, 87.80, 251.78, 294.71, 600.18]),
        (8e5, 0.0, [82.65, 86.66, 254.52, 274.31]),
        (8e5, 4000.0, [82.33, 86.86, 239.64, 287.25, 583.49]),
    ],
)
def test_friswell_by_six_of_his_elements_and_converged(k_yy: float, speed: float, printed: list[float]) -> None:
    bearings, count = at_ends(1e6, k_yy), len(printed)
    source = spatial_matrices(FRISWELL, bearings, UNCUT, two_node=True).eigenvalues(speed * TURN).imag
    np.testing.assert_allclose(source[:count], printed, rtol=0.0, atol=0.00501)
    converged = spatial_matrices(FRISWELL, bearings, 2e3).eigenvalues(speed * TURN).imag
    # Elements err upward at rest: six of them by up to 3e-4 in the third pair.
    if speed == 0.0:
        assert (converged[:count] < source[:count]).all()
        found = rest_frequencies(FRISWELL, bearings, count=count).frequencies
        np.testing.assert_allclose(found[:count], converged[:count], rtol=1e-11)
    found = solve_whirl(FRISWELL, bearings, speed * TURN, count=count).damped_frequencies
    np.testing.assert_allclose(found, converged[:count], rtol=1e-11)
