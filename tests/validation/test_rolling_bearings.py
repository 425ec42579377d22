"""Rolling bearings against published figures.

- ISO 16281 ball bearing, as MASTA's documentation works it: 7 balls of 11.5 mm on 43.5 mm, grooves .52 and .53,
  E 210 GPa, ν .3, no clearance; 1000 N radially displace it by 15.110 µm, axially by 133.54 µm.
- Krämer's formula with Friswell et al. (2010): 8 balls of 30 mm, 500 N, 30°: 1.00906e8 N/m.
- Static and dynamic load ratings of common sizes as bearing makers print them.
- ISO 281:2007, f_c of balls (table 2, single-row grooves and self-aligning) and of rollers (table 7) over γ.
- Half a loaded circle of a row with a contact angle: F_a = 1.260 F_r tan α and Q_max = 4.08 F_r/(Z cos α) of line
  contact, 1.216 and 4.37 of point contact (NSK, Technical Report CAT. No. E728g, section 5.1).
- Stiffness of ball and roller bearings by the closed sums of Lim and Singh (Journal of Sound and Vibration 139, 1990,
  pages 179-199), with their load-deflection constants replaced by Hertz's and Palmgren's here.
- An opposed row of a preloaded pair is free at 2^n times the preload, n the exponent of the contacts: 2.83 for balls
  (Harris and Kotzalas 2006, Essential Concepts, chapter 8; Palmgren 1959).
- Hertz's elliptic contact: a*, b*, δ* against F(ρ) in the table of Harris and Kotzalas (2006, chapter 6), whose last
  digits are its own.
"""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from rotors.rolling_bearings import (
    BallRow,
    RollerRow,
    RollingBearing,
    TaperedRollerRow,
    catalogue_row,
    dynamic_rating,
    kramer_ball_stiffness,
    paired,
    point_contact,
    rolling_equilibrium,
    rolling_state,
    spherical_groove,
    static_rating,
)

FloatArray = npt.NDArray[np.float64]


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
        ("tapered-roller", 25, 52, 16.25, 15, 33.7e3),
        ("tapered-roller", 30, 62, 17.25, 15, 48.0e3),
        ("tapered-roller", 30, 72, 20.75, 13, 60.1e3),
        ("spherical-roller", 40, 80, 23, 17, 90.0e3),
        ("spherical-roller", 50, 90, 23, 19, 108.0e3),
        ("spherical-roller", 60, 110, 28, 19, 166.0e3),
    ],
)
def test_estimated_insides_have_the_printed_static_rating(
    kind: str, bore: float, outer: float, width: float, elements: int, rating: float
) -> None:
    row = catalogue_row(kind, bore / 1e3, outer / 1e3, width / 1e3)  # type: ignore[arg-type]
    assert row.count == elements
    assert row.estimated
    rows = 2 if kind == "spherical-roller" else 1
    assert rows * static_rating(row) == pytest.approx(rating, rel=0.10)


@pytest.mark.parametrize(
    ("kind", "bore", "outer", "width", "dynamic"),
    [
        ("deep-groove", 25, 52, 15, 14.0e3),
        ("deep-groove", 40, 80, 18, 30.7e3),
        ("cylindrical-roller", 40, 80, 18, 53.9e3),
        ("tapered-roller", 25, 52, 16.25, 31.5e3),
        ("tapered-roller", 30, 62, 17.25, 43.5e3),
        ("tapered-roller", 30, 72, 20.75, 59.6e3),
    ],
)
def test_estimated_insides_have_the_printed_dynamic_rating(
    kind: str, bore: float, outer: float, width: float, dynamic: float
) -> None:
    row = catalogue_row(kind, bore / 1e3, outer / 1e3, width / 1e3)  # type: ignore[arg-type]
    assert dynamic_rating(row) == pytest.approx(dynamic, rel=0.10)


@pytest.mark.parametrize(
    ("gamma", "balls", "self_aligning", "rollers"),
    [
        (0.10, 55.5, 23.4, 84.2),
        (0.16, 59.6, 29.7, 88.5),
        (0.20, 59.9, 33.5, 88.7),
        (0.26, 58.2, 38.2, 86.4),
        (0.30, 56.0, 40.3, 83.8),
    ],
)
def test_factors_of_the_dynamic_rating(gamma: float, balls: float, self_aligning: float, rollers: float) -> None:
    row, size = BallRow(3, 10e-3, 10e-3 / gamma), 3.0 ** (2.0 / 3.0) * 10.0**1.8
    assert dynamic_rating(row) / (1.3 * size) == pytest.approx(balls, rel=2e-3)
    sphere = replace(row, inner_groove=0.53, outer_groove=spherical_groove(10e-3, 10e-3 / gamma, 0.0))
    assert dynamic_rating(sphere) / (1.3 * size) == pytest.approx(self_aligning, rel=2e-3)
    roller = RollerRow(3, 10e-3, 10e-3, 10e-3 / gamma)
    size = 10.0 ** (7.0 / 9.0) * 3.0**0.75 * 10.0 ** (29.0 / 27.0)
    assert dynamic_rating(roller) / (1.1 * size) == pytest.approx(rollers, rel=2e-3)


@pytest.mark.parametrize(("line", "thrust", "peak"), [(True, 1.260, 4.08), (False, 1.216, 4.37)])
def test_half_a_loaded_circle_of_a_row_with_a_contact_angle(line: bool, thrust: float, peak: float) -> None:
    """A radial displacement alone presses half of the elements; balls so little that their angle stays."""
    angle = math.radians(20.0)
    row = (
        TaperedRollerRow(240, 0.5e-3, 5e-3, 70e-3, angle=angle, profile="straight")
        if line
        else BallRow(240, 0.5e-3, 70e-3, angle)
    )
    state = rolling_state(RollingBearing([row]), [2e-6 if line else 1e-8, 0.0, 0.0, 0.0, 0.0])
    radial, axial = state.load[0], state.load[2]
    assert axial / (radial * math.tan(angle)) == pytest.approx(thrust, rel=2e-3)
    assert state.rows[0].outer_load.max() * 240 * math.cos(angle) / radial == pytest.approx(peak, rel=2e-3)


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


def test_ball_stiffness_by_the_sums_of_lim_and_singh() -> None:
    """k_xx, k_xz, k_zz, k_zθ and k_θθ with A_j the loaded distance of the groove centres, (δ_r*, δ_z*) its parts.

    The radial motion of the groove centres by a tilt, which they leave out, vanishes with the centres at z = 0.
    """
    angle = math.radians(40.0)
    row = BallRow(12, 10e-3, 60e-3, angle)
    radius, height = row.inner_groove_centre
    row = replace(row, position=-height)
    x, z, tilt = 12e-6, 30e-6, 2e-4
    state = rolling_state(RollingBearing([row]), [x, 0.0, z, 0.0, tilt])
    azimuths = 2.0 * np.pi * np.arange(12) / 12
    cosine, unloaded = np.cos(azimuths), row.groove_distance
    radial = unloaded * math.cos(angle) + x * cosine
    axial = unloaded * math.sin(angle) + z - radius * tilt * cosine
    distance = np.hypot(radial, axial)
    deep = distance - unloaded
    assert (deep > 0.0).all()
    common = row.stiffness * deep**1.5 / distance**3

    def along(part: FloatArray) -> FloatArray:
        return common * (1.5 * distance * part**2 / deep + distance**2 - part**2)

    mixed = common * radial * axial * (1.5 * distance / deep - 1.0)
    expected = {
        (0, 0): (along(radial) * cosine**2).sum(),
        (0, 2): (mixed * cosine).sum(),
        (2, 2): along(axial).sum(),
        (0, 4): -radius * (mixed * cosine**2).sum(),
        (2, 4): -radius * (along(axial) * cosine).sum(),
        (4, 4): radius**2 * (along(axial) * cosine**2).sum(),
    }
    for place, stiffness in expected.items():
        assert state.stiffness[place] == pytest.approx(stiffness, rel=1e-9)


def test_roller_stiffness_by_the_sums_of_lim_and_singh() -> None:
    """k_xx = n K cos² α Σ δ^{n−1} cos² ψ, k_xz = n K sin α cos α Σ δ^{n−1} cos ψ, k_zz = n K sin² α Σ δ^{n−1}."""
    angle, power = math.radians(16.0), 10.0 / 9.0
    row = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=angle, profile="straight")
    x, z = 10e-6, 25e-6
    state = rolling_state(RollingBearing([row]), [x, 0.0, z, 0.0, 0.0])
    cosine = np.cos(2.0 * np.pi * np.arange(15) / 15)
    deep = np.maximum(x * math.cos(angle) * cosine + z * math.sin(angle), 0.0)
    slope = power * row.stiffness * np.where(deep > 0.0, deep, 1.0) ** (power - 1.0) * (deep > 0.0)
    assert state.stiffness[0, 0] == pytest.approx(math.cos(angle) ** 2 * (slope * cosine**2).sum(), rel=1e-9)
    assert state.stiffness[0, 2] == pytest.approx(0.5 * math.sin(2.0 * angle) * (slope * cosine).sum(), rel=1e-9)
    assert state.stiffness[2, 2] == pytest.approx(math.sin(angle) ** 2 * slope.sum(), rel=1e-9)


@pytest.mark.parametrize("balls", [True, False])
def test_preloaded_pairs_lose_an_opposed_row_at_palmgrens_load(balls: bool) -> None:
    preload, held = 400.0, {"x": 0.0, "y": 0.0, "rx": 0.0, "ry": 0.0}
    if balls:
        # Open grooves, with which the contact angle stays.
        row: BallRow | TaperedRollerRow = BallRow(15, 10e-3, 60e-3, math.radians(25.0), 1.0, 1.0)
        free = 2.0**1.5 * preload
    else:
        row = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25, profile="straight")
        free = 2.0 ** (10.0 / 9.0) * preload
    pair = paired(row, "back to back", 20e-3, preload=preload)
    for factor, loaded in ((0.98, True), (1.02, False)):
        state = rolling_equilibrium(pair, [0.0, 0.0, factor * free, 0.0, 0.0], held=held)
        assert (state.rows[1].loaded > 0) == loaded
