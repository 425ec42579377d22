"""Starting values of rotors whose planes the gyroscopic moment alone ties, against the whole eigenproblem."""

import numpy as np
import pytest

from rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial
from rotors.projection import Pencil, basis_for, pencils

STEEL = ShaftMaterial(211e9, 81.2e9, 7810.0)
DISCS = [Disc.from_dimensions(at, 0.07, diameter, 0.05, STEEL.density) for at, diameter in ((0.5, 0.28), (1.0, 0.35))]
ROTOR = Rotor("rotor", [Segment(1.5, 0.05, 0.0, STEEL)], DISCS)
SPEEDS = np.array([0.0, 90.0, 420.0, -900.0])
LOWEST = 8


def bearings(damping: float, cross: float = 0.0, on_pedestal: bool = False) -> list[Bearing]:
    """Two bearings, stiffer in x than in y; cross-coupled and on a pedestal if asked, which is damped likewise."""
    pedestal = Pedestal(np.diag([3e7, 2e7]), damping * np.eye(2), 20.0) if on_pedestal else None
    stiffness = np.array([[1e6, cross], [-cross, 8e5]])
    dashpots = damping * np.diag([1.0, 2.0 / 3.0])
    return [Bearing("left", 0.0, stiffness, dashpots, pedestal=pedestal), Bearing("right", 1.5, stiffness, dashpots)]


def pencil(held: list[Bearing]) -> Pencil:
    (one,) = pencils(ROTOR, held, basis_for(ROTOR, held, None, LOWEST, None))
    return one


def lowest(values: np.ndarray) -> np.ndarray:
    """The lowest oscillating values of every row, by their imaginary parts."""
    return np.array([np.sort_complex(1j * row[row.imag > 0.0].conj())[:LOWEST] for row in values])


@pytest.mark.parametrize(
    ("damping", "tolerance", "on_pedestal"),
    [(0.0, 1e-9, False), (0.0, 1e-9, True), (30.0, 3e-7, False), (300.0, 3e-4, False)],
)
def test_values_agree_with_the_whole_eigenproblem_to_the_third_order_of_damping(
    damping: float, tolerance: float, on_pedestal: bool
) -> None:
    one = pencil(bearings(damping, on_pedestal=on_pedestal))
    assert one.planes is not None
    values, mixed = one.planes.eigenvalues(SPEEDS)
    assert not mixed.any()
    whole = np.linalg.eigvals(one.still + SPEEDS[:, None, None] * one.turning)
    np.testing.assert_allclose(lowest(values), lowest(whole), rtol=tolerance)


def test_strong_damping_is_left_to_the_whole_eigenproblem() -> None:
    one = pencil(bearings(1e4))
    assert one.planes is not None
    assert one.planes.eigenvalues(SPEEDS)[1].all()
    whole = np.linalg.eigvals(one.still + SPEEDS[:, None, None] * one.turning)
    np.testing.assert_array_equal(one.eigenvalues(SPEEDS), whole)


def test_cross_coupled_bearings_have_no_such_form() -> None:
    assert pencil(bearings(300.0, cross=1e5)).planes is None
