"""Starting values of rotors whose planes the gyroscopic moment alone ties, against the whole eigenproblem."""

import numpy as np
import pytest

from gearwhine.rotors import Bearing, Disc, Pedestal, Rotor, Segment, ShaftMaterial, solve_whirl
from gearwhine.rotors.whirl.completeness import NO_OSCILLATION
from gearwhine.rotors.whirl.eigenvalues import refine_each
from gearwhine.rotors.whirl.equations import whirl_equations_in_runs
from gearwhine.rotors.whirl.modal_projection import Pencil, pencils
from gearwhine.rotors.whirl.planar_basis import planar_basis

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
    (one,) = pencils(ROTOR, held, planar_basis(ROTOR, held, None, LOWEST))
    return one


def lowest(values: np.ndarray) -> np.ndarray:
    """The lowest oscillating values of every row, by their imaginary parts."""
    return np.array([np.sort_complex(1j * row[row.imag > 0.0].conj())[:LOWEST] for row in values])


def by_whole_systems(one: Pencil) -> np.ndarray:
    """All eigenvalues of the systems of first order."""
    return np.linalg.eigvals(one.still + SPEEDS[:, None, None] * one.turning)


@pytest.mark.parametrize(
    ("damping", "tolerance", "on_pedestal"),
    [(0.0, 1e-9, False), (0.0, 1e-9, True), (30.0, 3e-7, False), (300.0, 3e-4, False), (3.0, 3e-9, True)],
)
def test_values_agree_with_the_whole_eigenproblem_to_the_third_order_of_damping(
    damping: float, tolerance: float, on_pedestal: bool
) -> None:
    one = pencil(bearings(damping, on_pedestal=on_pedestal))
    assert one.planes is not None
    values, mixed = one.planes.eigenvalues(SPEEDS)
    assert not mixed.any()
    np.testing.assert_allclose(lowest(values), lowest(by_whole_systems(one)), rtol=tolerance)


@pytest.mark.parametrize(
    ("damping", "on_pedestal", "expected"),
    [
        (1e4, False, [True, True, True, True]),
        (300.0, True, [True, True, True, True]),
        (1e4, True, [True, True, True, True]),
        (360.0, False, [False, True, True, False]),
    ],
)
def test_speeds_at_which_damping_mixes_too_much_are_left_to_the_whole_eigenproblem(
    damping: float, on_pedestal: bool, expected: list[bool]
) -> None:
    one = pencil(bearings(damping, on_pedestal=on_pedestal))
    assert one.planes is not None
    light, mixed = one.planes.eigenvalues(SPEEDS)
    assert mixed.tolist() == expected
    np.testing.assert_array_equal(
        one.eigenvalues(SPEEDS), np.where(mixed[:, None], by_whole_systems(one), light), strict=True
    )


@pytest.mark.parametrize("damping", [3.0, 300.0, 1e4])
def test_whirl_on_a_damped_pedestal_is_what_starts_of_the_whole_eigenproblem_lead_to(damping: float) -> None:
    held = bearings(damping, on_pedestal=True)
    one = pencil(held)
    modes = solve_whirl(ROTOR, held, SPEEDS[2], count=LOWEST)
    assert modes.certificate.complete
    starts = by_whole_systems(one)[2]
    starts = starts[starts.imag > NO_OSCILLATION * np.abs(starts)]
    chain = whirl_equations_in_runs(ROTOR, held, one.blocks, 2.0 * modes.certificate.limit)
    roots = refine_each(chain, starts, np.full(starts.size, SPEEDS[2])).eigenvalues
    lost = np.abs(roots / modes.eigenvalues[:, None] - 1.0).min(axis=1)
    np.testing.assert_allclose(lost, 0.0, atol=1e-12)


def test_cross_coupled_bearings_have_no_such_form() -> None:
    assert pencil(bearings(300.0, cross=1e5)).planes is None
