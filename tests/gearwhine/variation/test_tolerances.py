"""Tolerances of ISO 1328-1 by its equations worked by hand, and zones of ISO 286-1 as handbooks print them."""

import numpy as np
import pytest

from gearwhine.coupling.gears import Gear
from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.accuracy import flank_tolerances, random_pitch_deviations
from gearwhine.numerics.tolerance_zones import ToleranceZoneError, limit_deviations


def _gear() -> Gear:
    """Reference diameter 100 mm, module 4 mm, face 25 mm."""
    return Gear("wheel", 25, 4e-3, np.radians(20.0), 25e-3)


def test_tolerances_of_class_5_by_hand() -> None:
    """Sums such as 0.1 + 1.6 + 5 and 0.2 + 5.5 + 2.8 + 12, in µm."""
    found = flank_tolerances(_gear(), 5)
    by_hand = {
        "single_pitch": 6.7,
        "cumulative_pitch": 20.5,
        "profile_slope": 5.7,
        "profile_form": 7.2,
        "helix_slope": 6.25,
        "helix_form": 6.95,
        "runout": 18.45,
    }
    for name, value in by_hand.items():
        assert 1e6 * getattr(found, name) == pytest.approx(value, rel=1e-12)


def test_two_classes_double_every_tolerance() -> None:
    coarse, fine = flank_tolerances(_gear(), 9), flank_tolerances(_gear(), 7)
    for name in ("single_pitch", "cumulative_pitch", "profile_slope", "helix_form", "runout"):
        assert getattr(coarse, name) == pytest.approx(2.0 * getattr(fine, name), rel=1e-12)


def test_other_classes_and_gears_beyond_the_standard_are_refused() -> None:
    with pytest.raises(GearError, match="of at least 1 and of at most 11"):
        flank_tolerances(_gear(), 12)
    with pytest.raises(GearError, match=r"normal module is 0\.25; expected 0\.5 to 70 mm"):
        flank_tolerances(Gear("small", 25, 0.25e-3, np.radians(20.0), 5e-3), 5)


def test_random_pitches_are_within_the_class_and_close_over_the_turn() -> None:
    tolerances, ranges, steps = flank_tolerances(_gear(), 7), [], []
    for seed in range(300):
        places = np.array(random_pitch_deviations(tolerances, 25, seed))
        step = np.diff(places, append=places[:1])
        assert abs(places.mean()) < 1e-18
        assert np.abs(step).max() <= tolerances.single_pitch * (1.0 + 1e-12)
        assert np.ptp(places) <= tolerances.cumulative_pitch * (1.0 + 1e-12)
        ranges.append(np.ptp(places))
        steps.append(step)
    # Neither all small, nor all at the tolerance.
    assert 0.3 < np.median(ranges) / tolerances.cumulative_pitch < 0.9
    assert np.std(steps) / tolerances.single_pitch == pytest.approx(1.0 / 3.0, rel=0.1)
    # The step that closes the turn is like the others.
    of_each = np.std(steps, axis=0)
    assert of_each[-1] == pytest.approx(of_each.mean(), rel=0.15)
    assert random_pitch_deviations(tolerances, 25, 3) == random_pitch_deviations(tolerances, 25, 3)


@pytest.mark.parametrize("teeth", [23, 61, 400])
def test_rejected_gears_leave_no_heap_at_a_pitch_tolerance(teeth: int) -> None:
    gear = Gear("wheel", teeth, 2.25e-3, np.radians(20.0), 24e-3)
    tolerances = flank_tolerances(gear, 8)
    places = np.array([random_pitch_deviations(tolerances, teeth, seed) for seed in range(400)])
    total = np.ptp(places, axis=1) / tolerances.cumulative_pitch
    single = np.abs(np.diff(places, axis=1, append=places[:, :1])).max(axis=1) / tolerances.single_pitch
    for largest in (total, single):
        assert largest.max() <= 1.0
        # All values differ, and F_p thins out towards its limit.
        assert len(np.unique(largest.round(9))) == 400
    counts, _ = np.histogram(total, np.linspace(0.0, 1.0, 11))
    assert counts[-1] < counts[-2] < counts[-3] < counts[-4]
    assert 0.45 < np.median(total) < 0.7


@pytest.mark.parametrize(
    ("zone", "millimetres", "low", "high"),
    [
        ("H7", 52, 0, 30),
        ("H8", 500, 0, 97),
        ("h6", 30, -13, 0),
        ("g6", 30, -20, -7),
        ("f7", 40, -50, -25),
        ("e8", 100, -126, -72),
        ("js6", 30, -6.5, 6.5),
        ("k6", 30, 2, 15),
        ("k6", 40, 2, 18),
        ("m5", 40, 9, 20),
        ("n6", 40, 17, 33),
        ("p6", 40, 26, 42),
        ("F8", 40, 25, 64),
        ("G7", 40, 9, 34),
        ("K7", 52, -21, 9),
        ("K8", 40, -27, 12),
        ("M7", 62, -30, 0),
        ("M6", 300, -41, -9),
        ("N7", 52, -39, -9),
        ("N9", 40, -62, 0),
        ("P7", 52, -51, -21),
        ("P8", 40, -65, -26),
        ("P9", 40, -88, -26),
        ("JS7", 40, -12.5, 12.5),
        ("k8", 40, 0, 39),
        ("j5", 52, -7, 6),
        ("j6", 100, -9, 13),
        ("j7", 40, -10, 15),
        ("J6", 62, -6, 13),
        ("J7", 52, -12, 18),
        ("K4", 30, -6, 0),
        ("N5", 52, -28, -15),
        ("H3", 52, 0, 5),
        ("k3", 52, 0, 5),
        ("c11", 40, -280, -120),
        ("d9", 40, -142, -80),
        ("r6", 65, 41, 60),
        ("r6", 75, 43, 62),
        ("R7", 75, -62, -32),
        ("s6", 50, 43, 59),
        ("S7", 50, -59, -34),
        ("t6", 30, 41, 54),
        ("u6", 20, 41, 54),
        ("u6", 30, 48, 61),
    ],
)
def test_zones_as_handbooks_print_them(zone: str, millimetres: float, low: float, high: float) -> None:
    found = limit_deviations(zone, 1e-3 * millimetres)
    assert (1e6 * found[0], 1e6 * found[1]) == pytest.approx((low, high))


@pytest.mark.parametrize(
    ("zone", "length"),
    [("z9", 0.05), ("H2", 0.05), ("j8", 0.05), ("t6", 0.024), ("Js7", 0.05), ("7H", 0.05), ("H7", 0.6)],
)
def test_other_zones_are_refused(zone: str, length: float) -> None:
    with pytest.raises(ToleranceZoneError, match="expected"):
        limit_deviations(zone, length)
