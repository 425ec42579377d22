"""Drops of rolling elements into spalls against bodies drawn point by point, tones, and refusals."""

import math

import numpy as np
import pytest

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import RotorError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    RollerRow,
    RollingBearing,
    RollingSpall,
    TaperedRollerRow,
    characteristic_frequencies,
    spall_contacts,
)

BALLS = BallRow(9, 12e-3, 60e-3)
BEARING = RollingBearing([BALLS], name="drive end")
BALL, INNER, OUTER = 6e-3, 24e-3, 36e-3
TURN = np.linspace(-math.pi, math.pi, 100_001)


def _outline(radius: float, half: float, floor: float, at: float) -> tuple[FloatArray, FloatArray]:
    """Points of a circle about the origin, of the radius ``floor`` within a half angle about the angle ``at``."""
    inside = np.abs(np.angle(np.exp(1j * (TURN - at)))) < half
    angles = np.concatenate([TURN, [at - half, at + half]])
    radii = np.concatenate([np.where(inside, floor, radius), [radius, radius]])
    return radii * np.cos(angles), radii * np.sin(angles)


def _dropped(on: str, ring: str, half: float, depth: float, angle: float) -> float:
    """How much closer than sound ones two drawn bodies come along x, where no point of one is inside the other."""
    if on == "outer":
        x, y = _outline(OUTER, half, OUTER + depth, angle)
        facing = (x > 0.0) & (np.abs(y) < BALL)
        farthest = x[facing] - np.sqrt(BALL**2 - y[facing] ** 2)
        return float(farthest.min()) - (OUTER - BALL)
    if on == "element" and ring == "outer":
        x, y = _outline(BALL, half, BALL - depth, angle)
        farthest = np.sqrt(OUTER**2 - y[x > 0.0] ** 2) - x[x > 0.0]
        return float(farthest.min()) - (OUTER - BALL)
    damaged, other = (INNER, BALL) if on == "inner" else (BALL, INNER)
    x, y = _outline(damaged, half, damaged - depth, angle)
    facing = (x > 0.0) & (np.abs(y) < other)
    nearest = x[facing] + np.sqrt(other**2 - y[facing] ** 2)
    return damaged + other - float(nearest.max())


@pytest.mark.parametrize("on", ["inner", "outer", "element"])
@pytest.mark.parametrize("depth", [30e-6, 1e-3])
def test_a_ball_drops_as_bodies_drawn_point_by_point(on: str, depth: float) -> None:
    """The bodies touch on an edge of the spall, or on its floor, which is round as the sound body is."""
    spall = RollingSpall(on, 3e-3, depth)  # type: ignore[arg-type]
    contacts = spall_contacts(spall, BEARING, 100.0)
    for contact, ring in zip(contacts, (on,) if len(contacts) == 1 else ("inner", "outer"), strict=True):
        radius = {"inner": INNER, "outer": OUTER, "element": BALL}[on]
        assert contact.half == pytest.approx(1.5e-3 / radius, rel=1e-12)
        for place in (-0.8, -0.3, 0.0, 0.55, 0.99, 1.01, 2.0):
            expected = _dropped(on, ring, contact.half, depth, place * contact.half)
            assert contact.drop(place * contact.half) == pytest.approx(expected, abs=1e-11), (ring, place)


def test_an_element_falls_no_deeper_than_the_floor_of_a_long_spall() -> None:
    """Over a spall longer than the ball is thick no edge carries in the middle."""
    (contact,) = spall_contacts(RollingSpall("outer", 14e-3, 2e-3), BEARING, 100.0)
    assert contact.drop(0.0) == 2e-3
    assert contact.drop(2.0 * math.pi) == 2e-3


def test_a_raceway_at_an_angle_is_a_cone_of_its_radius_over_the_cosine() -> None:
    """A tapered roller on the outer raceway: the plane of rolling cuts the cone in a curve of radius R / cos α."""
    row = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25)
    (contact,) = spall_contacts(RollingSpall("outer", 2e-3, 1e-3), RollingBearing([row]), 100.0)
    cosine = math.cos(row.contact_angle)
    radius = (27.5e-3 + 4e-3 * cosine) / cosine
    # Chord of the spall on a curve of that radius, bridged by a circle of the roller's radius inside of it.
    chord = radius * math.sin(1e-3 / radius)
    free = (4e-3 - math.sqrt(16e-6 - chord**2)) - (radius - math.sqrt(radius**2 - chord**2))
    assert contact.drop(0.0) == pytest.approx(free, rel=1e-9)


@pytest.mark.parametrize(
    ("on", "turns", "tone"),
    [("outer", "inner", "outer_pass"), ("inner", "inner", "inner_pass"), ("inner", "outer", "inner_pass")],
)
def test_a_raceway_is_struck_as_often_as_elements_pass_it(on: str, turns: str, tone: str) -> None:
    """The spall's place against the elements, by its rate and the cage's, returns after the time between strikes."""
    row = BallRow(9, 12e-3, 60e-3, outer_turns=turns == "outer")
    (contact,) = spall_contacts(RollingSpall(on, 2e-3, 1e-4), RollingBearing([row]), 100.0)  # type: ignore[arg-type]
    inner, outer = (0.0, 100.0) if turns == "outer" else (100.0, 0.0)
    known = getattr(characteristic_frequencies(row, inner, outer_speed=outer), tone)
    assert 9 * abs(row.cage_speed(100.0) - contact.rate) == pytest.approx(known, rel=1e-12)
    assert RollingSpall(on, 2e-3, 1e-4).tone(row, 100.0) == pytest.approx(known, rel=1e-12)  # type: ignore[arg-type]


def test_an_element_strikes_both_raceways_once_in_a_turn_of_its_own() -> None:
    """Half a turn lies between them."""
    spall = RollingSpall("element", 2e-3, 1e-4, azimuth=0.4, element=3)
    one, other = spall_contacts(spall, BEARING, -100.0)
    spin = characteristic_frequencies(BALLS, 100.0).spin
    assert (one.element, other.element) == (3, 3)
    assert one.rate == other.rate == pytest.approx(spin, rel=1e-12)
    assert other.azimuth - one.azimuth == pytest.approx(math.pi)
    assert spall.tone(BALLS, 100.0) == pytest.approx(2.0 * spin, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"on": "cage"}, "'outer', 'inner' or 'element'"),
        ({"length": 0.0}, "length of a spall"),
        ({"depth": math.nan}, "depth of a spall"),
        ({"azimuth": math.inf}, "azimuth"),
        ({"width": -1e-3}, "width of a spall"),
        ({"row": -1}, "row of a spall"),
        ({"row": 1}, "row of a spall of drive end is 1; expected one of 1"),
        ({"element": 9}, "element of a spall of drive end is 9; expected one of 9"),
        ({"length": 0.06}, "a quarter of the circumference"),
        ({"width": 1e-3}, "none under balls"),
    ],
)
def test_a_spall_that_there_cannot_be_is_refused(changes: dict[str, object], said: str) -> None:
    """The message names the attribute, its value and what was expected."""
    with pytest.raises(RotorError, match=said):
        spall_contacts(RollingSpall(**{"on": "outer", "length": 2e-3, "depth": 1e-4} | changes), BEARING, 100.0)  # type: ignore[arg-type]


def test_a_spall_under_rollers_has_a_width() -> None:
    """As a share of the rollers' length, all of it at most."""
    rollers = RollingBearing([RollerRow(13, 9e-3, 9e-3, 50e-3)])
    for width, share in ((3e-3, 1.0 / 3.0), (20e-3, 1.0), (None, 1.0)):
        (contact,) = spall_contacts(RollingSpall("inner", 2e-3, 1e-4, width=width), rollers, 100.0)
        assert contact.share == pytest.approx(share, rel=1e-12)
