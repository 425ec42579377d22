"""Whirl at speed against the finite-element reference: every eigenvalue, for bearings of all kinds.

Rotors are drawn around Friswell's (two discs on a shaft between bearings); bearings have direct and cross terms of
stiffness and damping, tilting terms, and stand on the ground or on pedestals. The reference's own error in these
eigenvalues is 1e-12.
"""

import numpy as np
import numpy.typing as npt
import pytest
from finite_element_whirl import spatial_matrices
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial, solve_whirl

CLOSE = 1e-10
COUNT = 8
# No shrinking: a case that fails is short as drawn.
SOME = settings(
    max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), phases=[Phase.explicit, Phase.generate]
)
STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda value: float(f"{value:.3g}"))


@st.composite
def friswell_like(draw: st.DrawFn) -> Rotor:
    spans = [Segment(draw(numbers(0.1, 0.6)), draw(numbers(0.03, 0.09)), 0.0, STEEL) for _ in range(4)]
    joints = np.cumsum([span.length for span in spans]).tolist()
    discs = [
        Disc.from_dimensions(at, draw(numbers(0.02, 0.1)), draw(numbers(0.1, 0.4)), 0.03, 7810.0) for at in joints[:3:2]
    ]
    return Rotor("drawn", spans, [*discs, Disc(joints[-1], draw(numbers(1.0, 20.0)), draw(numbers(0.0, 0.2)), 0.1)])


@st.composite
def bearing_sets(draw: st.DrawFn, rotor: Rotor, kind: str) -> list[Bearing]:
    bearings = []
    # Where shapes are not alike at both, and never at an end alone.
    for name, at in (("left", 0.0), ("right", float(rotor.joints[3]))):
        stiffness = np.diag([draw(numbers(2e5, 5e7)), draw(numbers(2e5, 5e7))])
        damping = np.zeros((2, 2))
        if kind != "undamped":
            damping = np.diag([draw(numbers(0.0, 3e3)), draw(numbers(0.0, 3e3))])
            stiffness = stiffness + np.array([[0.0, draw(numbers(-1e5, 1e5))], [draw(numbers(-1e5, 1e5)), 0.0]])
            damping = damping + draw(numbers(-200.0, 200.0)) * np.array([[0.0, 1.0], [1.0, 0.0]])
        pedestal = None
        if kind == "pedestals":
            pedestal = Pedestal(
                np.diag([draw(numbers(1e6, 1e8)), draw(numbers(1e6, 1e8))]),
                draw(numbers(0.0, 1e3)) * np.eye(2),
                draw(numbers(0.5, 50.0)),
            )
        if kind == "tilting":
            stiffness, damping = (_spatial(matrix) for matrix in (stiffness, damping))
            stiffness[3, 3], stiffness[4, 4] = draw(numbers(1e3, 1e5)), draw(numbers(1e3, 1e5))
            stiffness[0, 4] = stiffness[4, 0] = draw(numbers(-5e3, 5e3))
            stiffness[1, 3] = stiffness[3, 1] = draw(numbers(-5e3, 5e3))
            damping[3, 3] = damping[4, 4] = draw(numbers(0.0, 20.0))
        if kind == "thrust":
            # As of a loaded ball bearing: radial, axial and tilting all coupled, positive definite.
            stiffness, damping = (_spatial(matrix) for matrix in (stiffness, damping))
            lever = np.eye(5)
            lever[2, 0], lever[0, 4], lever[2, 4], lever[1, 3] = (draw(numbers(0.02, 0.2)) for _ in range(4))
            stiffness = stiffness + lever.T @ np.diag([0.0, 0.0, draw(numbers(1e5, 1e7)), 2e4, 2e4]) @ lever
        bearings.append(Bearing(name, at, stiffness, damping, pedestal=pedestal))
    return bearings


def _spatial(radial: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    whole = np.zeros((5, 5))
    whole[:2, :2] = radial
    return whole


def assert_same(found: npt.NDArray[np.complex128], reference: npt.NDArray[np.complex128]) -> None:
    """Assert that ours are the lowest of the reference's, each once, to `CLOSE` of its size."""
    distance = np.abs(found[:, None] - reference) / np.abs(reference)
    rows, columns = linear_sum_assignment(distance)
    assert distance[rows, columns].max() < CLOSE, f"{found} against {reference[: found.size + 2]}"
    lower = np.abs(reference) < np.abs(found[-1]) * (1.0 - 10.0 * CLOSE)
    assert set(np.flatnonzero(lower)) <= set(columns), f"{found} leave out some of {reference[lower]}"


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["undamped", "crossed", "tilting", "thrust", "pedestals"])
def test_every_eigenvalue_at_speed(kind: str) -> None:
    @SOME
    @given(st.data(), numbers(-1500.0, 1500.0))
    def holds(data: st.DataObject, speed: float) -> None:
        rotor = data.draw(friswell_like())
        bearings = data.draw(bearing_sets(rotor, kind))
        found = solve_whirl(rotor, bearings, speed, count=COUNT).eigenvalues
        assert found.size == COUNT
        matrices = spatial_matrices(rotor, bearings, 1.5 * float(np.abs(found).max()), axial=kind == "thrust")
        reference = matrices.eigenvalues(speed)
        assert_same(found, reference)

    holds()
