"""Clearance under fits and heat against the radial equation of elastic rings solved for all parts at once."""

import math

import numpy as np
import pytest

from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import RingFit, operating_clearance, thermal_offset

BEARING = {"bore": 45e-3, "inner_raceway": 54e-3, "outer_raceway": 76e-3, "outer_diameter": 85e-3}
STEEL_ALPHA = 11.7e-6


def shrunk_parts(
    inside: tuple[float, float, float, float, float, float],
    around: tuple[float, float, float, float, float, float],
    gap: float,
) -> tuple[float, float, float]:
    """Growth of the inside part's inner surface and the around part's outer one, and the pressure between.

    Each part is (b, c, E, ν, α, ΔT) with u = A r + B/r, σ_r = E/(1 − ν²) [(1 + ν) A − (1 − ν) B/r²] − E α ΔT/(1 − ν):
    four constants from free surfaces, one pressure and u_around − u_inside = I/2 in the fit.
    """
    rows, right = np.zeros((4, 4)), np.zeros(4)

    def stress(part: tuple[float, ...], r: float) -> tuple[list[float], float]:
        _, _, e, nu, alpha, rise = part
        scale = e / (1.0 - nu**2)
        bore_free = part[0] == 0.0
        second = 0.0 if bore_free and r == 0.0 else -scale * (1.0 - nu) / r**2
        return [scale * (1.0 + nu), second], -e * alpha * rise / (1.0 - nu)

    # A solid shaft has no B; a hollow one has a free bore.
    if inside[0] == 0.0:
        rows[0, 1] = 1.0
    else:
        rows[0, :2], shift = stress(inside, inside[0])
        right[0] = -shift
    rows[1, 2:], shift = stress(around, around[1])
    right[1] = -shift
    first, shift_first = stress(inside, inside[1])
    second, shift_second = stress(around, around[0])
    rows[2] = [*first, -second[0], -second[1]]
    right[2] = shift_second - shift_first
    r = around[0]
    rows[3] = [-r, -1.0 / r, r, 1.0 / r]
    right[3] = 0.5 * gap
    scale = np.array([1.0, 1e-4, 1.0, 1e-4])
    a, b, c, d = np.linalg.solve(rows * scale, right) * scale
    pressure = -(first[0] * a + first[1] * b + shift_first)
    low = 0.0 if inside[0] == 0.0 else a * inside[0] + b / inside[0]
    return low, c * around[1] + d / around[1], pressure


@pytest.mark.parametrize("hollow", [0.0, 20e-3])
def test_inner_ring_on_a_warm_shaft(hollow: float) -> None:
    fit = RingFit(40e-6, hollow, 4e-6, 200e9, 0.28, 12.5e-6, 60.0)
    found = operating_clearance(30e-6, **BEARING, shaft=fit, inner_rise=45.0, outer_rise=45.0)
    shaft = (hollow / 2, 22.5e-3, 200e9, 0.28, 12.5e-6, 60.0)
    ring = (22.5e-3, 27e-3, 210e9, 0.3, STEEL_ALPHA, 45.0)
    _, outer, pressure = shrunk_parts(shaft, ring, 36e-6)
    assert found.inner_pressure == pytest.approx(pressure, rel=1e-9)
    # Of the raceway's growth the ring's own heat is in the other term.
    free = 27e-3 * STEEL_ALPHA * 45.0
    assert found.by_inner_fit == pytest.approx(-2.0 * (outer - free), rel=1e-9)
    # All parts of the bearing equally warm: its clearance grows as they do, from nothing but itself.
    assert found.by_heat == pytest.approx(0.0, abs=1e-18)
    assert found.clearance == pytest.approx(30e-6 + found.by_inner_fit, rel=1e-12)


def test_outer_ring_in_a_housing_of_aluminium() -> None:
    fit = RingFit(50e-6, 0.12, 0.0, 70e9, 0.33, 23e-6, 20.0)
    found = operating_clearance(30e-6, **BEARING, housing=fit, outer_rise=30.0)
    ring = (38e-3, 42.5e-3, 210e9, 0.3, STEEL_ALPHA, 30.0)
    housing = (42.5e-3, 60e-3, 70e9, 0.33, 23e-6, 20.0)
    inner, _, pressure = shrunk_parts(ring, housing, 50e-6)
    assert found.outer_pressure == pytest.approx(pressure, rel=1e-9)
    assert found.by_outer_fit == pytest.approx(2.0 * (inner - 38e-3 * STEEL_ALPHA * 30.0), rel=1e-9)
    # Balls of the mean temperature: 76 mm · 30 K − 22 mm · 15 K.
    assert found.by_heat == pytest.approx(STEEL_ALPHA * (76e-3 * 30.0 - 22e-3 * 15.0), rel=1e-12)


def test_a_fit_that_opens_carries_nothing() -> None:
    cold = RingFit(10e-6, math.inf, 0.0, 70e9, 0.33, 23e-6, 80.0)
    found = operating_clearance(10e-6, **BEARING, housing=cold, outer_rise=60.0, inner_rise=60.0)
    assert found.outer_pressure == 0.0
    assert found.by_outer_fit == 0.0


def test_a_warm_shaft_presses_rows_face_to_face() -> None:
    """0.2 m of steel 30 K above its housing: 70 µm."""
    assert thermal_offset(0.2, 50.0, 20.0) == pytest.approx(0.2 * 11.7e-6 * 30.0)
    assert thermal_offset(0.2, 50.0, 50.0, housing_expansion=23e-6) < 0.0


def test_wrong_sizes_are_named() -> None:
    with pytest.raises(RotorError, match="ascending"):
        operating_clearance(0.0, 45e-3, 40e-3, 76e-3, 85e-3)
    with pytest.raises(RotorError, match=r"bore of the shaft is 0.05; expected less than 0.045 m"):
        operating_clearance(0.0, **BEARING, shaft=RingFit(free_diameter=50e-3))
    with pytest.raises(RotorError, match=r"outer diameter of the housing is 0.08; expected more than 0.085 m"):
        operating_clearance(0.0, **BEARING, housing=RingFit(free_diameter=80e-3))
    with pytest.raises(RotorError, match="modulus of a fit's partner is -1"):
        RingFit(modulus=-1.0)
