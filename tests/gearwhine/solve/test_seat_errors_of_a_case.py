"""Errors of the places of bores, as a case gives them."""

import math
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case import CaseError

ERROR = 2e-5


def _by_seats(**error: Any) -> float:
    changes = {f"bearing.input-right.seat_error.{key}": value for key, value in error.items()}
    pair = gw.load("helical-pair", changes).operating_point().document["gear_pairs"][0]
    return float(pair["misalignment_by_cause_rad"]["seats"])


def test_one_bore_off_its_place_turns_the_shaft_by_the_error_over_the_distance_of_the_bores() -> None:
    places = {one.bearing.name: one.bearing.at for one in gw.load("helical-pair").machine.bearings}
    apart = places["input-right"] - places["input-left"]
    # The plane of action is at an angle to both axes.
    found = math.hypot(_by_seats(x="20 um"), _by_seats(y="20 um"))
    assert found == pytest.approx(ERROR / apart, rel=1e-6)
    assert _by_seats() == 0.0


def test_a_bore_of_a_bearing_with_its_own_law_is_refused_by_its_key() -> None:
    stop = {"bearing.input-right.stiffness": {"stop": {"force": "1 N", "depth": "1 um"}}}
    with pytest.raises(CaseError, match=r"bearing.*seat_error.*none of a stop"):
        gw.load("helical-pair", stop | {"bearing.input-right.seat_error.x": "20 um"})


def test_a_bore_farther_off_than_any_workshop_leaves_it_is_warned_of() -> None:
    # Millimetres in place of micrometres.
    far = gw.load("helical-pair", {"bearing.input-right.seat_error": {"x": "3 mm", "y": "4 mm", "tilt_x": "1 mrad"}})
    (told,) = [one for one in far.check().warnings if "seat_error" in one]
    assert "it is 5 mm and 1 mrad off" in told
    near = gw.load("helical-pair", {"bearing.input-right.seat_error": {"x": "30 um"}})
    assert not [one for one in near.check().warnings if "seat_error" in one]
