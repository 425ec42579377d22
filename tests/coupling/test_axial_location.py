"""Axial location of shafts: O and X arrangement, thrust carried one way only, springs and offsets as preload."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from own_statics import STEEL, one_stage
from own_statics import linear_bearing as made_bearing
from scipy.optimize import brentq

from gearwhine.coupling import Machine, MountedBearing
from gearwhine.coupling.description.axial_location import AxialLocation, AxialSupport
from gearwhine.coupling.errors import EquilibriumNotFoundError
from gearwhine.rotors.rolling_bearings import (
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    Row,
    SphericalRollerRow,
    TaperedRollerRow,
    paired,
    spherical_groove,
    standing_rows,
)

TAPERED = TaperedRollerRow(15, 8e-3, 12e-3, 55e-3, angle=0.25)
ANGULAR = BallRow(13, 8.1e-3, 38.5e-3, math.radians(25.0))
BALLS = {"count": 9, "ball_diameter": 8e-3, "pitch_diameter": 40e-3}
BOTH = {1, -1}


def on_rows(
    directions: Sequence[int], row: Row = TAPERED, *, offset: float = 0.0, springs: Sequence[float] = (0.0,) * 4
) -> Machine:
    """One stage on single rows, one at each end of both shafts, whose gears have rims and do not stiffen the shafts."""
    machine = one_stage()
    gears = [replace(one, gear=replace(one.gear, rim_thickness=4e-3, web_thickness=5e-3)) for one in machine.gears]
    bearings = [
        MountedBearing(
            made_bearing(one.bearing.name, one.bearing.at, np.zeros((5, 5))),
            one.rotor,
            None,
            rolling=RollingBearing([replace(row, direction=direction, axial_offset=offset)], spring, one.bearing.name),
        )
        for one, direction, spring in zip(machine.bearings, directions, springs, strict=True)
    ]
    return replace(machine, gears=gears, bearings=bearings)


@pytest.mark.parametrize(
    ("rows", "senses"),
    [
        ([BallRow(**BALLS)], BOTH),
        ([replace(ANGULAR, direction=-1)], {-1}),
        ([FourPointRow(**BALLS, contact_angle=0.6)], BOTH),
        ([RollerRow(12, 8e-3, 9e-3, 45e-3)], set()),
        ([RollerRow(12, 8e-3, 9e-3, 45e-3, flanges="one", flange_stiffness=1e7, direction=-1)], {-1}),
        ([RollerRow(12, 8e-3, 9e-3, 45e-3, flanges="both", flange_stiffness=1e7)], BOTH),
        ([TAPERED], {1}),
        (standing_rows("spherical-roller", SphericalRollerRow(14, 8e-3, 9e-3, 55e-3, angle=0.2), 20e-3), BOTH),
        (paired(ANGULAR, "tandem", 15e-3).rows, {1}),
        (paired(ANGULAR, "face to face", 15e-3).rows, BOTH),
    ],
)
def test_rows_carry_thrust_by_their_type(rows: Sequence[Row], senses: set[int]) -> None:
    assert RollingBearing(rows).thrust_senses == senses


@pytest.mark.parametrize(
    ("directions", "arrangement"), [((1, -1), "O"), ((-1, 1), "X"), ((1, 1), None), ((-1, -1), None)]
)
def test_two_rows_are_back_to_back_or_face_to_face(directions: tuple[int, int], arrangement: str | None) -> None:
    first, _ = on_rows((*directions, 1, -1)).axial_locations
    assert (first.shaft, first.arrangement, first.is_located) == ("in", arrangement, arrangement is not None)
    for sense in (1, -1):
        expected = [name for name, one in zip(("in 0.016", "in 0.164"), directions, strict=True) if one == sense]
        assert list(first.carrying(sense)) == expected


def test_pairs_in_one_bearing_have_the_arrangement_of_their_rows() -> None:
    def arrangement(bearing: RollingBearing) -> str | None:
        return AxialSupport("pair", 0.0, bearing.thrust_senses, bearing).arrangement

    assert arrangement(paired(ANGULAR, "back to back", 15e-3)) == "O"
    assert arrangement(paired(ANGULAR, "face to face", 15e-3)) == "X"
    assert arrangement(paired(ANGULAR, "tandem", 15e-3)) is None
    assert arrangement(RollingBearing([TAPERED])) is None
    aligning = BallRow(**BALLS, contact_angle=0.17, inner_groove=0.53, outer_groove=spherical_groove(8e-3, 40e-3, 0.17))
    assert arrangement(RollingBearing(standing_rows("self-aligning-ball", aligning, 20e-3))) is None


def test_a_shaft_with_a_bearing_for_both_senses_has_no_arrangement() -> None:
    plus, minus = frozenset((1,)), frozenset((-1,))
    location = AxialLocation("in", [AxialSupport("b", 0.2, plus | minus), AxialSupport("a", 0.1, plus)])
    assert location.arrangement is None
    assert location.is_located
    assert location.carrying(1) == ("a", "b")
    assert location.warnings == ()
    between = [AxialSupport(name, at, one) for name, at, one in (("a", 0.0, plus), ("b", 0.1, minus), ("c", 0.2, plus))]
    assert AxialLocation("in", between).arrangement is None


def test_rows_that_carry_one_way_are_named() -> None:
    machine = on_rows((1, 1, -1, -1))
    told, other = machine.warnings
    assert told.startswith(
        "shaft 'in' is located one way only: 'in 0.016' and 'in 0.164' both carry its thrust towards +z, and no bearing"
        " carries it towards -z; turn one round (`carries`)"
    )
    assert "'out 0.01' and 'out 0.154' both carry its thrust towards -z" in other
    with pytest.raises(EquilibriumNotFoundError, match=r"may leave a shaft loose; shaft 'in' is located one way only"):
        replace(machine, torque=-machine.torque).operating_point()


def test_springs_against_each_other_press_nothing_and_are_named() -> None:
    """Both springs push the same shaft: their sum is what moves it, and opposed rows do not feel each other."""
    machine = on_rows((1, -1, 1, -1), springs=(300.0, -300.0, 300.0, -200.0))
    equal, unequal = machine.warnings
    assert "300 N towards +z and 300 N towards -z cancel and press no element" in equal
    assert "300 N towards +z and 200 N towards -z leave 100 N" in unequal
    assert all("`axial_offset`" in text for text in machine.warnings)
    pressed = [thrust for one in machine.preload_point().bearings for thrust in row_thrusts(one.rolling)]
    # All but the elastic compression of the shaft between both.
    assert pressed[:2] == pytest.approx([0.0, 0.0], abs=1.0)
    assert pressed[2:] == pytest.approx([100.0, 0.0], abs=1e-6)
    (alone,) = on_rows((1, -1, 1, -1), springs=(300.0, 0.0, 0.0, 0.0)).warnings
    assert "the `preload` of 'in 0.016' is a spring's force on the shaft, 300 N towards +z" in alone
    assert "in 'in 0.164' as well" in alone


def row_thrusts(state: object) -> tuple[float, ...]:
    thrusts = getattr(state, "row_thrusts", ())
    assert isinstance(thrusts, tuple)
    return thrusts


@pytest.mark.parametrize("directions", [(1, -1, 1, -1), (-1, 1, -1, 1)])
@pytest.mark.parametrize("row", [TAPERED, ANGULAR], ids=["tapered", "angular"])
def test_offsets_preload_the_rows_by_their_springs_in_series_with_the_shaft(
    directions: Sequence[int], row: Row
) -> None:
    """F = f(e - F / 2k) of both rows alike: f the closed form of a centred row, k the shaft's rod between them."""
    offset = 12e-6
    machine = on_rows(directions, row, offset=offset)
    assert machine.warnings == ()
    assert replace(machine, torque=0.0).operating_point().pairs == ()
    point = machine.preload_point()
    assert point.residual <= 1e-9
    modulus = STEEL.youngs_modulus
    spans = {"in": [(0.044, 0.03), (0.104, 0.04)], "out": [(0.04, 0.035), (0.104, 0.05)]}
    for shaft, pieces in spans.items():
        yielding = sum(length / (modulus * math.pi / 4.0 * diameter**2) for length, diameter in pieces)
        # Back to back the preload compresses the shaft, face to face it stretches it: both take off the offsets.
        expected = brentq(lambda f, c=yielding: f - row.axial_force(offset - 0.5 * c * f), 0.0, 1e5, xtol=1e-9)
        held = [one for one in point.bearings if one.mounted.rotor == shaft]
        for one, direction in zip(held, directions[:2], strict=True):
            assert one.force[2] == pytest.approx(direction * expected, rel=1e-8)
            assert row_thrusts(one.rolling) == pytest.approx([expected], rel=1e-8)


def test_the_preload_within_a_pair_is_that_asked_for() -> None:
    """It leaves no force on the shaft, and without torque and weight it is all there is."""
    machine = on_rows((1, -1, 1, -1))
    pair = paired(ANGULAR, "back to back", 18e-3, preload=300.0)
    roller = RollingBearing([RollerRow(12, 8e-3, 9e-3, 45e-3)])
    held = [replace(one, rolling=roller if number % 2 else pair) for number, one in enumerate(machine.bearings)]
    point = replace(machine, bearings=held).preload_point()
    assert point.residual <= 1e-9
    for one in point.bearings[::2]:
        assert one.force == pytest.approx(np.zeros(5), abs=1e-6)
        assert row_thrusts(one.rolling) == pytest.approx([300.0, 300.0], rel=1e-9)
