"""Rolling bearings against published figures.

- ISO 16281 ball bearing, as MASTA's documentation works it: 7 balls of 11.5 mm on 43.5 mm, grooves .52 and .53,
  E 210 GPa, ν .3, no clearance; 1000 N radially displace it by 15.110 µm, axially by 133.54 µm.
- Krämer's formula with Friswell et al. (2010): 8 balls of 30 mm, 500 N, 30°: 1.00906e8 N/m.
- Static load ratings C₀ of the sizes 6205, 6208, 6305, NU 205, NU 208 and NU 210 as bearing makers print them.
- Hertz's elliptic contact: a*, b*, δ* against F(ρ) in the table of Harris and Kotzalas (2006, chapter 6), whose last
  digits are its own.
"""

import math

import numpy as np
import pytest

from rotors.rolling_bearings import (
    BallRow,
    RollingBearing,
    catalogue_row,
    kramer_ball_stiffness,
    point_contact,
    rolling_equilibrium,
    static_rating,
)


@pytest.mark.parametrize(("direction", "micrometres"), [(0, 15.110), (2, 133.54)])
def test_ball_bearing_of_iso_16281(direction: int, micrometres: float) -> None:
    bearing = RollingBearing([BallRow(7, 11.5e-3, 43.5e-3, inner_groove=0.52, outer_groove=0.53)])
    state = rolling_equilibrium(bearing, 1000.0 * np.eye(5)[direction])
    assert 1e6 * state.displacement[direction] == pytest.approx(micrometres, rel=1e-4)


def test_kramers_formula() -> None:
    assert kramer_ball_stiffness(8, 0.03, 500.0, math.radians(30.0)) == pytest.approx(1.00906e8, rel=1e-5)


@pytest.mark.parametrize(
    ("kind", "bore", "outer", "width", "elements", "rating"),
    [
        ("deep-groove", 25, 52, 15, 9, 7.8e3),
        ("deep-groove", 40, 80, 18, 9, 19.0e3),
        ("deep-groove", 25, 62, 17, 7, 11.6e3),
        ("cylindrical-roller", 25, 52, 15, 13, 27.0e3),
        ("cylindrical-roller", 40, 80, 18, 14, 53.0e3),
        ("cylindrical-roller", 50, 90, 20, 16, 69.5e3),
    ],
)
def test_estimated_insides_have_the_printed_static_rating(
    kind: str, bore: float, outer: float, width: float, elements: int, rating: float
) -> None:
    row = catalogue_row(kind, bore / 1e3, outer / 1e3, width / 1e3)  # type: ignore[arg-type]
    assert row.count == elements
    assert static_rating(row) == pytest.approx(rating, rel=0.10)


@pytest.mark.parametrize(
    ("difference", "a_star", "b_star", "delta_star"),
    [
        (0.0, 1.0, 1.0, 1.0),
        (0.1075, 1.0760, 0.9318, 0.9974),
        (0.3204, 1.2623, 0.8114, 0.9761),
        (0.4795, 1.4556, 0.7278, 0.9429),
        (0.5916, 1.6440, 0.6687, 0.9077),
        (0.6716, 1.8258, 0.6245, 0.8733),
        (0.7332, 2.0110, 0.5881, 0.8394),
    ],
)
def test_hertz_against_harris_table(difference: float, a_star: float, b_star: float, delta_star: float) -> None:
    """With Σρ = 2 and E* = 3/4 the table's three numbers are a, b and δ under 1 N but for the scale it prints."""
    contact = point_contact(1.0 - difference, 1.0 + difference, 0.75)
    # a = a* [3 Q / (2 Σρ E*)]^{1/3} = a*, likewise b; δ = δ* [..]^{2/3} Σρ/2 = δ*.
    assert contact.semi_major == pytest.approx(a_star, rel=1e-3)
    assert contact.semi_minor == pytest.approx(b_star, rel=1e-3)
    assert contact.stiffness ** (-2.0 / 3.0) == pytest.approx(delta_star, rel=1e-3)
