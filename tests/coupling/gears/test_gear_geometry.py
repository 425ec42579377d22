"""One gear: radii, angles, inertia, and the messages for teeth that cannot be."""

import math
from dataclasses import replace

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear, GearError, TipRelief
from gearwhine.coupling.gears.errors import PointedToothError, UndercutError
from gearwhine.coupling.gears.geometry.involute import inverse_involute, module_from_base_radius

ALPHA = math.radians(20.0)
NASA = Gear("pinion", 28, 3.175e-3, ALPHA, 6.35e-3)


def test_module_from_base_radius() -> None:
    assert module_from_base_radius(NASA.base_radius, 28, ALPHA) == pytest.approx(3.175e-3, rel=1e-14)
    with pytest.raises(GearError, match="base_radius must be above 0"):
        module_from_base_radius(0.0, 28, ALPHA)


def test_profile_shift_moves_tip_and_root_but_not_the_base() -> None:
    shifted = replace(NASA, profile_shift=0.3)
    assert shifted.tip_radius - NASA.tip_radius == pytest.approx(0.3 * 3.175e-3)
    assert shifted.root_circle_radius - NASA.root_circle_radius == pytest.approx(0.3 * 3.175e-3)
    assert shifted.base_radius == NASA.base_radius


def test_default_rack_corner_leaves_one_addendum_of_straight_flank() -> None:
    # Then the involute starts where the rack's flank ends, one module below the pitch line.
    expected = math.hypot(NASA.base_radius, NASA.pitch_radius * math.sin(ALPHA) - NASA.module / math.sin(ALPHA))
    assert NASA.form_radius == pytest.approx(expected, rel=1e-13)


def test_a_sharp_rack_corner_cuts_deeper_involutes() -> None:
    wheel = replace(NASA, teeth=60)
    assert replace(wheel, root_radius=0.0).form_radius < wheel.form_radius


def test_inertia_is_that_of_a_hollow_disc() -> None:
    gear = replace(NASA, bore=20e-3, density=7800.0)
    outer, inner, width = 44.45e-3, 10e-3, 6.35e-3
    full = 7800.0 * math.pi * outer**2 * width
    hole = 7800.0 * math.pi * inner**2 * width
    assert gear.mass == pytest.approx(full - hole, rel=1e-13)
    assert gear.polar_inertia == pytest.approx((full * outer**2 - hole * inner**2) / 2.0, rel=1e-13)
    thin = (full * (3 * outer**2 + width**2) - hole * (3 * inner**2 + width**2)) / 12.0
    assert gear.diametral_inertia == pytest.approx(thin, rel=1e-13)


@pytest.mark.parametrize("value", [-1e-9, math.nan, math.inf])
def test_inverse_involute_refuses(value: float) -> None:
    with pytest.raises(GearError, match="involute function"):
        inverse_involute(value)


@pytest.mark.parametrize(
    ("changes", "kind", "words"),
    [
        ({"tip_relief": 1e-5}, GearError, "tip_relief is 1e-05; expected a TipRelief, or None"),
        ({"teeth": np.int64(4)}, GearError, "teeth is 4; expected a whole number of at least 5"),
        ({"teeth": 4}, GearError, "teeth is 4; expected a whole number of at least 5"),
        ({"teeth": 28.0}, GearError, "teeth"),
        ({"teeth": True}, GearError, "teeth"),
        ({"module": 0.0}, GearError, "module is 0; expected a finite number above 0"),
        ({"module": math.nan}, GearError, "module is nan; expected a finite number"),
        ({"face_width": -1.0}, GearError, "face_width"),
        ({"module": 3.0}, GearError, "module is 3; expected .* 1 m"),
        ({"pressure_angle": 20.0}, GearError, "pressure_angle is 20; expected .* rad"),
        ({"poisson_ratio": 0.5}, GearError, "poisson_ratio"),
        ({"youngs_modulus": math.inf}, GearError, "youngs_modulus"),
        ({"bore": 90e-3}, GearError, "bore is 0.09; expected a bore smaller than the root circle"),
        ({"bore": -1e-3}, GearError, "bore is -0.001; expected a finite number of at least 0"),
        (
            {"root_radius": 2e-3},
            GearError,
            "root_radius is 0.002; expected at most 1.498 mm, which fits the rack's tip",
        ),
        ({"profile_shift": 1.3}, GearError, "profile_shift is 1.3; expected at most 1.25, with"),
        (
            {"addendum": 3.0, "dedendum": 1.25},
            PointedToothError,
            "addendum is 3; expected .* pointed below the tip circle",
        ),
        ({"dedendum": 3.0}, PointedToothError, "dedendum is 3; expected less: the rack's own teeth are pointed"),
        ({"teeth": 14}, UndercutError, "profile_shift is 0; expected 0.1812 or more"),
        ({"profile_shift": -0.9}, UndercutError, "undercut"),
        ({"tip_relief": TipRelief(2e-5, 1.0)}, GearError, "below the tip's roll angle of 31.38"),
        ({"eccentricity": -1e-6}, GearError, "eccentricity"),
    ],
)
def test_impossible_gears_say_what_is_wrong(changes: dict[str, object], kind: type, words: str) -> None:
    with pytest.raises(kind, match=words) as caught:
        replace(NASA, **changes)
    assert "'pinion'" in str(caught.value)


@pytest.mark.parametrize(("amount", "start"), [(-1e-6, 0.4), (1e-6, -0.1), (math.nan, 0.4)])
def test_tip_relief_refuses(amount: float, start: float) -> None:
    with pytest.raises(GearError, match="tip relief"):
        TipRelief(amount, start)
