"""Dynamic stiffness that few directions couple against the product with itself: Z (Z⁻¹ f) = f."""

import numpy as np
import pytest

from gearwhine.coupling.linear.dynamic_stiffness import DynamicStiffness

SIZE = 12


@pytest.mark.parametrize("directions", [0, 2, SIZE])
@pytest.mark.parametrize("w", [3.0, 3.0 - 0.2j, 5.0])
def test_solution_under_loads_gives_the_loads(directions: int, w: complex) -> None:
    """Also at 5 rad/s, where a coordinate without connectors is at its undamped resonance; and unsymmetric."""
    rng = np.random.default_rng(3)
    diagonals = np.array([np.linspace(1.0, 40.0, SIZE), np.full(SIZE, 0.1)])
    diagonals[:, 4] = 25.0, 0.0
    along = rng.normal(size=(SIZE, directions))
    stiffness, damping = (
        np.diag(diagonal) + along @ rng.normal(size=(directions, directions)) @ along.T for diagonal in diagonals
    )
    loads = rng.normal(size=(SIZE, 3))
    if directions == 0 and w == 5.0:
        with pytest.raises(np.linalg.LinAlgError):
            DynamicStiffness(stiffness, damping, diagonals).solve(w, loads)
        return
    moved = DynamicStiffness(stiffness, damping, diagonals).solve(w, loads)
    dynamic = stiffness + 1j * w * damping - w**2 * np.eye(SIZE)
    assert np.abs(dynamic @ moved - loads).max() < 1e-10
