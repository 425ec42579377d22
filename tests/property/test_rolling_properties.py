"""What holds of every rolling bearing: it finds its equilibrium or says why not, and its stiffness is a tangent."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearwhine.numerics.arrays import FloatArray
from gearwhine.rotors import EquilibriumError
from gearwhine.rotors.rolling_bearings import (
    COORDINATES,
    BallRow,
    FourPointRow,
    RollerRow,
    RollingBearing,
    SphericalRollerRow,
    TaperedRollerRow,
    rolling_equilibrium,
    rolling_state,
)

SIGN = st.sampled_from([-1.0, 0.0, 1.0])


def logarithmic(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers even in their logarithm, between powers of ten."""
    return st.floats(low, high).map(lambda power: float(10.0**power))


@st.composite
def ball_rows(draw: st.DrawFn, most: int = 14) -> BallRow:
    diameter, count = draw(logarithmic(-3.0, -1.4)), draw(st.integers(3, most))
    pitch = diameter / math.sin(math.pi / count) * draw(st.floats(1.05, 2.0))
    return BallRow(
        count,
        diameter,
        pitch,
        contact_angle=draw(st.sampled_from([0.0, 0.2, 0.45, 0.7, 1.2])),
        inner_groove=0.5 + draw(logarithmic(-2.3, -1.0)),
        outer_groove=0.5 + draw(logarithmic(-2.3, -1.0)),
        clearance=diameter * draw(SIGN) * draw(logarithmic(-6.0, -2.4)),
    )


@st.composite
def bearings(draw: st.DrawFn) -> RollingBearing:
    kind = draw(st.sampled_from(["one", "two", "rollers", "tapered", "spherical", "four-point"]))
    row = draw(ball_rows())
    if kind in ("tapered", "spherical"):
        length, angle = row.ball_diameter * draw(st.floats(0.8, 2.5)), draw(st.floats(0.1, 0.6))
        size = (row.count, row.ball_diameter, length, row.pitch_diameter, row.clearance)
        rollers = TaperedRollerRow(*size, angle=angle) if kind == "tapered" else SphericalRollerRow(*size, angle=angle)
        spacing = 0.0 if kind == "spherical" else row.ball_diameter * draw(st.floats(2.0, 3.0))
        sides = ((-1.0, 1), (1.0, -1))
        return RollingBearing([replace(rollers, position=s * spacing, direction=d) for s, d in sides])
    if kind == "four-point":
        given = {one.name: getattr(row, one.name) for one in fields(BallRow)}
        return RollingBearing([FourPointRow(**given | {"contact_angle": draw(st.floats(0.2, 0.9))})])
    if kind == "rollers":
        length = row.ball_diameter * draw(st.floats(0.8, 4.0))
        profile = draw(st.sampled_from(["straight", "logarithmic"]))
        size = (row.count, row.ball_diameter, length, row.pitch_diameter)
        return RollingBearing([RollerRow(*size, clearance=row.clearance, profile=profile)])
    preload = draw(SIGN) * draw(logarithmic(-6.0, -3.5)) * 1e10 * row.ball_diameter**2
    if kind == "one":
        return RollingBearing([row], axial_preload=preload)
    offset, half = row.ball_diameter * draw(logarithmic(-5.0, -3.0)), row.ball_diameter * draw(st.floats(0.5, 1.5))
    directions = draw(st.sampled_from([(1, -1), (-1, 1), (1, 1)]))
    rows = [
        replace(row, position=side * half, direction=direction, axial_offset=offset)
        for side, direction in zip((-1.0, 1.0), directions, strict=True)
    ]
    return RollingBearing(rows, axial_preload=preload)


@st.composite
def loads(draw: st.DrawFn, bearing: RollingBearing) -> FloatArray:
    """Up to ten times a common load, in any of five directions."""
    diameter = min(row.element_diameter for row in bearing.rows)
    force = np.array([draw(SIGN) * draw(logarithmic(-3.0, 1.0)) * 1e7 * diameter**2 for _ in range(5)])
    force[3:] *= bearing.reach
    force[2] *= bearing.has_axial_stiffness
    force[3:] *= not isinstance(bearing.rows[0], SphericalRollerRow)
    return force


@settings(max_examples=12, deadline=None)
@given(st.data())
def test_equilibrium_is_found_or_it_is_said_why_not(data: st.DataObject) -> None:
    """For every load, clearance, preload, tilt and speed: the elements' forces, summed here, balance the load."""
    bearing = data.draw(bearings())
    load = data.draw(loads(bearing))
    held = {
        name: data.draw(SIGN) * data.draw(logarithmic(-6.0, -2.5))
        for name in data.draw(st.sets(st.sampled_from(COORDINATES[3:])))
    }
    speed = data.draw(SIGN) * data.draw(logarithmic(-2.0, 3.0)) if bearing.has_axial_stiffness else 0.0
    try:
        state = rolling_equilibrium(bearing, load, held=held, speed=speed)
    except EquilibriumError as error:
        if "beyond its groove" not in str(error) and "of their diameter" not in str(error):
            raise
        return
    total, size = np.zeros(3), 0.0
    for row, elements in zip(bearing.rows, state.rows, strict=True):
        radial = elements.inner_load * np.cos(elements.inner_angle)
        axial = elements.inner_load * np.sin(elements.inner_angle)
        if isinstance(row, TaperedRollerRow) and elements.rib_load is not None:
            radial = radial - elements.rib_load * math.sin(row.contact_angle - row.roller_angle)
            axial = axial + elements.rib_load * math.cos(row.contact_angle - row.roller_angle)
        total += [
            float((radial * np.cos(elements.azimuths)).sum()),
            float((radial * np.sin(elements.azimuths)).sum()),
            float(row.direction * axial.sum()),
        ]
        size += float(elements.inner_load.sum())
    expected = load[:3] + np.array([0.0, 0.0, bearing.axial_preload])
    moments = float(np.abs(load[3:]).sum()) / bearing.reach
    np.testing.assert_allclose(total, expected, rtol=0.0, atol=1e-9 * (size + np.abs(expected).sum() + moments) + 1e-9)
    values = np.linalg.eigvalsh(state.even_stiffness)
    np.testing.assert_array_equal(state.stiffness, state.stiffness.T)
    assert values[0] >= -1e-9 * max(values[-1], 1.0)


@settings(max_examples=12, deadline=None)
@given(ball_rows(most=8), st.floats(0.0, 2.0 * math.pi), st.booleans(), logarithmic(-4.0, -2.6))
def test_stiffness_is_the_derivative_of_the_reaction(row: BallRow, angle: float, turning: bool, depth: float) -> None:
    """By central differences, at a place where no ball is about to touch or leave."""
    bearing = RollingBearing([row])
    speed = 300.0 if turning else 0.0
    shift = depth * row.ball_diameter
    push = max(row.clearance, 0.0)
    place = np.array([(shift + push) * math.cos(angle), (shift + push) * math.sin(angle), shift, 0.0, 0.0])
    place[3:] = 0.2 * shift / bearing.reach
    try:
        state = rolling_state(bearing, place, speed=speed)
    except EquilibriumError:
        assume(False)
    elements = state.rows[0]
    deep = (elements.inner_load[elements.inner_load > 0.0] / row.stiffness) ** (2.0 / 3.0)
    assume(deep.size > 0 and deep.min() > 0.02 * shift)
    step = 2e-4 * float(deep.min())
    tangent = np.empty((5, 5))
    for i in range(5):
        change = np.zeros(5)
        change[i] = step / (1.0 if i < 3 else bearing.reach)
        # Fourth order, so that the step can stay well above rounding.
        shares = [
            weight * rolling_state(bearing, place + times * change, speed=speed).reaction
            for times, weight in ((2, -1), (1, 8), (-1, -8), (-2, 1))
        ]
        tangent[:, i] = np.sum(shares, axis=0) / (12.0 * change[i])
    size = np.array([1.0, 1.0, 1.0, bearing.reach, bearing.reach])
    even = tangent / np.outer(size, size)
    assert np.abs(even - state.even_stiffness).max() <= 1e-6 * np.abs(state.even_stiffness).max()


@settings(max_examples=12, deadline=None)
@given(st.data())
def test_a_turn_by_one_element_turns_the_answer(data: st.DataObject) -> None:
    bearing = data.draw(bearings())
    load = data.draw(loads(bearing))
    angle = 2.0 * math.pi / bearing.rows[0].count
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.eye(5)
    turn[:2, :2] = turn[3:, 3:] = [[cosine, -sine], [sine, cosine]]
    try:
        state = rolling_equilibrium(bearing, load)
    except EquilibriumError:
        with pytest.raises(EquilibriumError):
            rolling_equilibrium(bearing, turn @ load)
        return
    turned = rolling_equilibrium(bearing, turn @ load)
    assume(not state.loose)
    size = np.array([1.0, 1.0, 1.0, bearing.reach, bearing.reach])
    # How far the residual lets either stray is the flattest direction's.
    slack = 1e-8 * max(np.abs(state.displacement * size).max(), 1e-3 * bearing.rows[0].element_diameter)
    assert np.abs((turned.displacement - turn @ state.displacement) * size).max() <= slack
    np.testing.assert_allclose(
        turned.reaction / size, (turn @ state.reaction) / size, rtol=1e-6, atol=1e-7 * np.abs(load / size).max() + 1e-9
    )
