"""Figures of a planetary set under load: places, balance of the drawn forces, and shares over a turn of the carrier."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.text import Annotation
from planetary_machines import MODULE, machine

from gearwhine.coupling.load_analysis.planetary_load import over_carrier_turn, planetary_load
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad, solve_load
from gearwhine.figures.machine.operating_point import forces_on_shafts
from gearwhine.figures.machine.planetary_sets import draw_carrier_turn, draw_planetary_set

TEETH = {"s": 24, "r": 84, "p 1": 30, "p 2": 30, "p 3": 30}


@cache
def solved() -> SolvedLoad:
    return solve_load(machine(pin_errors=[0.0, 20e-6, 0.0]))


@cache
def view() -> Axes:
    placed = solved().machine.placed_sets[0]
    figure = draw_planetary_set("stage", placed, planetary_load(solved().machine, placed, solved().point), solved())
    (axes,) = figure.axes
    return axes


def arrows(color_of: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Beginnings and directions of the arrows in red (0), green (1) or blue (2) [mm of the machine]."""
    found = []
    for patch in view().patches:
        if isinstance(patch, FancyArrowPatch) and int(np.argmax(patch.get_edgecolor()[:3])) == color_of:
            tail, tip = (np.array(place) for place in patch._posA_posB)  # type: ignore[attr-defined]
            found.append((tail, tip - tail))
    return found


def test_pitch_circles_stand_on_their_shafts() -> None:
    circles = [(np.array(one.center), one.radius) for one in view().patches if isinstance(one, Circle)]
    expected = [(1e3 * np.array(solved().machine.shaft(name).axis), 500.0 * MODULE * z) for name, z in TEETH.items()]
    assert len(circles) == len(expected)
    for axis, radius in expected:
        assert any(np.allclose(axis, middle) and radius == pytest.approx(own) for middle, own in circles)
    carrier, spokes = 1e3 * np.array(solved().machine.shaft("c").axis), view().get_lines()
    ends = [line.get_xydata() for line in spokes]
    assert all(np.allclose(points[0], carrier) for points in ends)
    np.testing.assert_allclose([points[1] for points in ends], [axis for axis, _ in expected[2:]])


def test_forces_drawn_on_a_carrier_are_in_balance() -> None:
    """Of unequal planets: pins 90 and 50 mm beyond the end of the shaft turn it by these arms, its bearings back."""
    drawn = forces_on_shafts(solved())["c"]
    largest = max(abs(part) for one in drawn for part in one.force)
    turned = np.zeros(2)
    for one in drawn:
        # Moments about x and y of all that acts, about the left end.
        turned += np.array(one.moment) + one.at * np.array([-one.force[1], one.force[0]])
    assert sum(np.array(one.force) for one in drawn) == pytest.approx(np.zeros(2), abs=1e-9 * largest)
    assert turned == pytest.approx(np.zeros(2), abs=1e-9 * largest)
    assert max(abs(part) for one in drawn for part in one.moment) > 0.01 * largest


def test_drawn_forces_of_each_planet_are_in_balance() -> None:
    """Both meshes and the planet's circling, m r w^2, press it on its pin, all to the scale of the longest arrow."""
    meshes, pins = arrows(2), arrows(0)
    assert (len(meshes), len(pins)) == (6, 3)
    (scale,) = [float(one.get_text().split()[2]) for one in view().texts if "longest arrow" in one.get_text()]
    newton = scale / max(float(np.hypot(*arrow)) for _, arrow in [*meshes, *pins])
    made, carrier = solved().machine, np.array(solved().machine.shaft("c").axis)
    for number in (1, 2, 3):
        shaft = made.shaft(f"p {number}")
        axis = np.array(shaft.axis)
        (pin,) = [arrow for tail, arrow in pins if np.allclose(tail, 1e3 * axis)]
        reach = 500.0 * MODULE * TEETH[shaft.name]
        own = [arrow for tail, arrow in meshes if np.hypot(*(tail - 1e3 * axis)) == pytest.approx(reach, rel=1e-6)]
        assert len(own) == 2
        circling = float(made.rotor(shaft.name).mass) * made.speeds["c"] ** 2 * (axis - carrier)
        assert newton * pin == pytest.approx(newton * np.sum(own, axis=0) + circling, abs=2e-4 * scale)


def test_labels_have_the_share_of_each_planet_and_the_note_that_of_the_most_loaded() -> None:
    words = [one.get_text() for one in view().texts if isinstance(one, Annotation) and "%" in one.get_text()]
    shares = {text.split("\n")[0]: float(text.split("\n")[1].removesuffix(" %")) for text in words}
    assert sum(shares.values()) == pytest.approx(100.0, abs=0.02)
    # The sun turns the planets ahead: a pin that stands ahead takes its planet away from the sun's teeth.
    assert shares["p 2"] < 100.0 / 3.0 < min(shares["p 1"], shares["p 3"])
    texts = [one.get_text() for one in view().figure.texts]
    (factor,) = [float(text.rpartition("= ")[2]) for text in texts if "K_γ" in text]
    assert factor == pytest.approx(3.0 * max(shares.values()) / 100.0, abs=1e-3)


def test_shares_over_a_turn_are_those_at_each_angle() -> None:
    heavy, angles = replace(solved().machine, gravity=(0.0, -9.81, 0.0)), np.radians([0.0, 90.0, 180.0, 270.0])
    (axes,) = draw_carrier_turn("turn", over_carrier_turn(heavy, "c", angles)).axes
    lines = {str(line.get_label()): np.array(line.get_data()) for line in axes.get_lines()}
    assert list(lines) == ["p 1", "p 2", "p 3"]
    at_rest = planetary_load(heavy, heavy.placed_sets[0], heavy.operating_point())
    for planet in at_rest.planets:
        degrees, shares = lines[planet.shaft]
        assert degrees.tolist() == [0.0, 90.0, 180.0, 270.0, 360.0]
        # Nothing but the carrier stands differently after a turn.
        assert (shares[0], shares[-1]) == pytest.approx((planet.load_share, planet.load_share), rel=1e-9)
        assert np.ptp(shares) > 1e-7
    assert np.sum([shares for _, shares in lines.values()], axis=0) == pytest.approx(np.ones(5), rel=1e-9)
