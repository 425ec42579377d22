"""Two tapered rollers of a catalogue set against each other: arrangement, and the one that takes the thrust."""

import pytest

import gearwhine as gw
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
