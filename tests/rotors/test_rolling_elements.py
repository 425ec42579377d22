"""Energy of a bearing's elements over the inner ring's displacement: its slopes, and energies found another way."""

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy import optimize

from rotors import RotorError
from rotors.numerics.trust_region import Local, minimise
from rotors.rolling_bearings import (
    BallRow,
    RollerRow,
    RollingBearing,
    RollingElements,
    paired,
    rolling_equilibrium,
    rolling_state,
)

FloatArray = npt.NDArray[np.float64]

ANGULAR = BallRow(13, 8.1e-3, 38.5e-3, math.radians(25.0))
ROLLERS = RollerRow(14, 11e-3, 11e-3, 60e-3, clearance=5e-6)
PLACE = np.array([8e-6, -12e-6, 15e-6, 2e-4, -1e-4])


def differences(elements: RollingElements, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slopes of the energy (5,) and of the gradient (5, 5) by central differences."""
    slope, tangent = np.empty(5), np.empty((5, 5))
    for i, step in enumerate((1e-8, 1e-8, 1e-8, 1e-6, 1e-6)):
        ahead, behind = (elements.at(place + sign * step * np.eye(5)[i]) for sign in (1.0, -1.0))
        slope[i] = (ahead.value - behind.value) / (2.0 * step)
        tangent[i] = (ahead.gradient - behind.gradient) / (2.0 * step)
    return slope, tangent


BEARINGS = {
    "deep groove": (RollingBearing([BallRow(7, 11.5e-3, 43.5e-3, clearance=5e-6)]), 0.0),
    "spring": (RollingBearing([ANGULAR], axial_preload=200.0), 0.0),
    "in motion": (RollingBearing([ANGULAR], axial_preload=200.0), 900.0),
    "paired": (paired(ANGULAR, "back to back", 15e-3, preload=150.0), 0.0),
    "rollers": (RollingBearing([ROLLERS]), 0.0),
}


@pytest.mark.parametrize("kind", BEARINGS)
def test_force_and_tangent_are_slopes_of_the_energy(kind: str) -> None:
    elements = RollingElements(*BEARINGS[kind], cage_angle=0.2)
    slope, tangent = differences(elements, PLACE)
    here = elements.at(PLACE)
    size = np.array([1.0, 1.0, 1.0, *[elements.bearing.reach] * 2])
    np.testing.assert_allclose(here.gradient / size, slope / size, atol=1e-5 * np.abs(slope / size).max())
    even = np.outer(size, size)
    np.testing.assert_allclose(here.hessian / even, tangent / even, atol=1e-4 * np.abs(tangent / even).max())
    np.testing.assert_array_equal(here.hessian, here.hessian.T)


def test_energy_of_a_thrown_ball_is_the_least_over_its_place() -> None:
    """⅖ K_i (|v − p| − A_i)^{5/2} + ⅖ K_o (|p| − A_o)^{5/2} − F_c p_r, minimised over the ball's centre p."""
    speed, row = 1500.0, ANGULAR
    thrown = row.centrifugal_force(speed)
    arms = (row.inner_groove - 0.5) * row.ball_diameter, (row.outer_groove - 0.5) * row.ball_diameter
    radius = 0.5 * row.pitch_diameter + arms[0] * math.cos(row.contact_angle)
    height = arms[0] * math.sin(row.contact_angle)
    x, y, z, rx, ry = PLACE
    total = 0.0
    for ball in range(row.count):
        c, s = math.cos(2.0 * math.pi * ball / row.count), math.sin(2.0 * math.pi * ball / row.count)
        v = sum(arms) * np.array([math.cos(row.contact_angle), math.sin(row.contact_angle)])
        v = v + [x * c + y * s + height * (ry * c - rx * s), z - radius * (ry * c - rx * s)]

        def energy(p: FloatArray, v: FloatArray = v) -> float:
            inside, outside = (
                contact.stiffness * max(float(np.linalg.norm(along)) - arm, 0.0) ** 2.5
                for contact, along, arm in zip(
                    (row.inner_contact, row.outer_contact), (v - 1e-3 * p, 1e-3 * p), arms, strict=True
                )
            )
            return 1e3 * (0.4 * (inside + outside) - thrown * 1e-3 * float(p[0]))

        start = 1e3 * v * arms[1] / sum(arms)
        found = optimize.minimize(energy, start, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14})
        total += found.fun * 1e-3
    assert RollingElements(RollingBearing([row]), speed).at(PLACE).value == pytest.approx(total, rel=1e-8)


def test_a_machine_that_adds_bearings_to_a_spring_finds_its_rest() -> None:
    """A rigid shaft on two bearings 0.2 m apart: minimum of the energies' sum, and the moment balance of its load."""
    bearings = [RollingElements(RollingBearing([replace(ANGULAR, direction=sign)], sign * 300.0)) for sign in (1, -1)]
    maps = []
    for place in (-0.1, 0.1):
        motion = np.eye(5)
        motion[0, 4], motion[1, 3] = place, -place
        maps.append(motion)
    load = np.array([0.0, -2000.0, 400.0, 30.0, 0.0])
    size = np.array([1.0, 1.0, 1.0, 10.0, 10.0])

    def potential(lengths: FloatArray) -> Local:
        q = lengths * size
        parts = [(motion, elements.at(motion @ q)) for motion, elements in zip(maps, bearings, strict=True)]
        return Local(
            value=sum(part.value for _, part in parts) - float(load @ q),
            gradient=size * (sum(motion.T @ part.gradient for motion, part in parts) - load),
            hessian=np.outer(size, size) * sum(motion.T @ part.hessian @ motion for motion, part in parts),
            noise=sum(part.noise for _, part in parts) + abs(float(load @ q)),
            force=sum(part.force for _, part in parts) + 2430.0,
        )

    found = minimise(potential, np.zeros(5), 1e-5, 1e-13)
    q = found.place * size
    states = [rolling_state(one.bearing, motion @ q) for one, motion in zip(bearings, maps, strict=True)]
    np.testing.assert_allclose(states[0].load[:3] + states[1].load[:3], load[:3], atol=1e-8 * 2000.0)
    moment = states[0].load[3] + states[1].load[3] - 0.1 * (states[1].load[1] - states[0].load[1])
    assert moment == pytest.approx(30.0, abs=1e-7 * 200.0)


@pytest.mark.parametrize("kind", BEARINGS)
def test_a_state_at_an_equilibrium_s_displacement_is_that_equilibrium(kind: str) -> None:
    bearing, speed = BEARINGS[kind]
    load = np.array([700.0, -300.0, 250.0 * bearing.has_axial_stiffness, 1.0, -0.5])
    expected = rolling_equilibrium(bearing, load, speed=speed)
    state = rolling_state(bearing, expected.displacement, speed=speed)
    assert state.residual == 0.0
    np.testing.assert_allclose(state.load, load, atol=1e-9 * np.abs(load).sum())
    np.testing.assert_array_equal(state.stiffness, expected.stiffness)
    assert state.loaded == expected.loaded


def test_a_displacement_is_five_finite_numbers() -> None:
    with pytest.raises(RotorError, match=r"displacement of .* expected five finite numbers"):
        rolling_state(RollingBearing([ANGULAR]), [0.0, math.nan, 0.0, 0.0, 0.0])
    with pytest.raises(RotorError, match="speed is nan"):
        RollingElements(RollingBearing([ANGULAR]), math.nan)
