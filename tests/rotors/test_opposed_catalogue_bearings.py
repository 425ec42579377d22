"""Bearings of a catalogue: two tapered rollers set against each other, and the same bearing of a case and of Python."""

import inspect
import math
from typing import Any

import pytest

import gearwhine as gw
from gearwhine.case.bearings import Catalogue, RollingCatalogue
from gearwhine.rotors.rolling_bearings import catalogue_bearing

SHAFT = gw.Shaft(gw.Rotor("shaft", [gw.Segment(0.175, 0.046, 0.0, gw.STEEL)]))


def machine(left: str, right: str, thrust: float = 0.0) -> gw.Machine:
    bearings = [
        gw.MountedBearing.from_elements(
            name,
            at,
            "shaft",
            None,
            catalogue_bearing("tapered-roller", 0.04, 0.068, 0.019, carries=carries),  # type: ignore[arg-type]
        )
        for name, at, carries in (("left", 0.01, left), ("right", 0.165, right))
    ]
    forces = [gw.ShaftForce("shaft", 0.08, (500.0, 0.0, thrust))]
    return gw.Machine([SHAFT], bearings, speed=100.0, forces=forces)


@pytest.mark.parametrize("thrust", [2000.0, -2000.0])
@pytest.mark.parametrize(("left", "right", "arrangement"), [("+z", "-z", "O"), ("-z", "+z", "X")])
def test_the_bearing_that_carries_that_way_takes_the_thrust(
    left: str, right: str, arrangement: str, thrust: float
) -> None:
    """Together they take all of it; the other one, pressed by its own radial load alone, pushes against it."""
    opposed = machine(left, right, thrust)
    (location,) = opposed.axial_locations
    assert location.arrangement == arrangement
    assert opposed.warnings == ()
    forces = {one.name: one.force[2] for one in opposed.operating_point().bearings}
    assert sum(forces.values()) == pytest.approx(thrust, rel=1e-6)
    taking = "left" if (left == "+z") == (thrust > 0.0) else "right"
    assert forces[taking] / thrust >= 1.0


def test_both_the_same_way_are_warned_of() -> None:
    (text,) = machine("+z", "+z").warnings
    assert "located one way only" in text
    with pytest.raises(gw.RotorError, match=r"carries is 'z'; expected '\+z' or '-z'"):
        machine("z", "+z")


SIZE = {"bore": 0.04, "outer_diameter": 0.08, "width": 0.02}
NAMES = {"type": "kind", "dynamic_rating": "dynamic", "static_rating": "static", "turning_ring": "outer_turns"}
"""Arguments of Python that are named otherwise than keys of a case."""
APART = {"catalogue", "law", "mounting", "flanges", "flange_stiffness", "axial_clearance"}
"""Keys that stand in Python with the mounting, `operating_clearance` and the rows."""


def test_python_has_every_key_of_a_catalogue_bearing() -> None:
    keys = {*Catalogue.model_fields, *RollingCatalogue.model_fields} - APART
    assert {NAMES.get(key, key) for key in keys} == {*inspect.signature(catalogue_bearing).parameters} - {"name"}


@pytest.mark.parametrize(
    "more",
    [
        {"dynamic_rating": 36e3},
        {"dynamic_rating": 36e3, "static_rating": 26e3, "carries": "-z", "preload": 90.0},
        {
            "arrangement": "back to back",
            "spacing": 0.03,
            "preload": 90.0,
            "static_rating": 52e3,
            "turning_ring": "outer",
        },
        {"arrangement": "tandem", "spacing": 0.03, "carries": "-z", "static_rating": 52e3},
        {"axial_offset": -3e-6, "carries": "-z", "turning_ring": "outer"},
    ],
)
def test_a_bearing_of_python_is_that_of_a_case(more: dict[str, Any]) -> None:
    catalogue = Catalogue.model_construct(type="angular-contact", **SIZE)
    case = RollingCatalogue.model_construct(catalogue=catalogue, **more).build("one")
    named = {NAMES.get(key, key): value for key, value in more.items()}
    if "outer_turns" in named:
        named["outer_turns"] = True
    assert catalogue_bearing("angular-contact", **SIZE, **named, name="bearing 'one'") == case


@pytest.mark.parametrize(("kind", "factor", "limit"), [("tapered-roller", 1.6, 0.37), ("spherical-roller", 2.4, 0.28)])
def test_the_angle_by_the_axial_factor_is_that_by_the_limit_e(kind: Any, factor: float, limit: float) -> None:
    """Y and e of a 30208 and Y1 and e of a 22208 are printed to two digits; tan α = e/1.5."""
    row = catalogue_bearing(kind, **SIZE, axial_factor=factor).rows[0]
    assert math.tan(row.contact_angle) == pytest.approx(limit / 1.5, rel=0.02)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"kind": "deep-groove", "axial_factor": 1.6}, "axial factor of a deep-groove bearing is 1.6; expected none"),
        ({"axial_factor": 1.6, "contact_angle": 0.2}, "axial factor is 1.6; expected none beside a contact angle"),
        ({"axial_factor": -1.0}, "axial factor"),
        ({"preload": -1.0}, "preload is -1.0"),
        ({"arrangement": "back to back"}, "spacing is None; expected the distance of the two rows"),
        ({"spacing": 0.03}, "spacing is 0.03; expected none of a single bearing"),
        ({"kind": "four-point", "arrangement": "tandem", "spacing": 0.03}, "expected 'single' of a four-point bearing"),
        ({"arrangement": "tandem", "spacing": 0.03, "axial_offset": 1e-6}, "axial offset is 1e-06; expected none"),
        ({"kind": "cylindrical-roller", "axial_offset": 1e-6}, "axial offset is 1e-06; expected none: its rollers"),
        ({"floating": True}, "floats, and its rows carry thrust one way only"),
    ],
)
def test_what_does_not_fit_a_catalogue_bearing_is_refused(more: dict[str, Any], message: str) -> None:
    with pytest.raises(gw.RotorError, match=message):
        catalogue_bearing(**({"kind": "tapered-roller"} | SIZE | more))
