"""Pictures over speed: Campbell diagram, critical-speed map, unbalance response."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine import rotors
from gearwhine.figures import ProbeResponse, draw_campbell, draw_critical_map, draw_unbalance_response
from gearwhine.figures.rotors.critical_speed_map import map_intersections
from gearwhine.figures.rotors.responses import phase_lag
from gearwhine.rotors import Campbell

RPM = 60.0 / (2.0 * math.pi)
SPEEDS = np.linspace(0.0, 400.0, 21)


def drawn(axes: Axes, label: str) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in axes.get_lines() if line.get_label() == label]


def texts(figure: Figure) -> set[str]:
    return {text.get_text() for axes in figure.axes for text in axes.texts}


def diagram(
    speeds: np.ndarray, frequencies: np.ndarray, directions: np.ndarray, ratios: np.ndarray, axial: float = 0.0
) -> Campbell:
    """What a rotor's whirl over speed would be, made up; |λ| and ζ are those given."""
    values = frequencies * (-ratios + 1j * np.sqrt(1.0 - ratios**2))
    nothing: Any = None
    proved = np.zeros(speeds.size, dtype=bool)
    return Campbell(speeds, values, directions, np.full(values.shape, axial), proved, nothing, ())


def branches() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A backward and a forward branch of made-up slopes, and one whose sense changes halfway."""
    frequencies = np.column_stack([200.0 - 0.1 * SPEEDS, 200.0 + 0.1 * SPEEDS, np.full_like(SPEEDS, 500.0)])
    directions = np.column_stack([-np.ones(21), np.ones(21), np.where(SPEEDS < 199.0, -1.0, 1.0)])
    return frequencies, directions, np.zeros((21, 3))


def test_campbell_lines_hold_the_branches_in_their_senses() -> None:
    figure = draw_campbell("t", diagram(SPEEDS, *branches()), orders=(1.0, 2.0), operating_speed=-300.0)
    (axes,) = figure.axes  # without damping there is no second panel
    lines = [line for line in axes.get_lines() if line.get_label() == "branch"]
    rpm, hertz = (np.array(data) for data in lines[0].get_data())
    assert rpm == pytest.approx(RPM * SPEEDS)
    assert hertz == pytest.approx((200.0 - 0.1 * SPEEDS) / (2.0 * math.pi))
    backward, forward = lines[0].get_color(), lines[1].get_color()
    # The third is backward, a step of neither, and forward, and leaves no gap.
    assert [line.get_color() for line in lines[2:]][::2] == [backward, forward]
    assert np.unique(np.concatenate([line.get_xdata() for line in lines[2:]])) == pytest.approx(RPM * SPEEDS)
    ((_, twice),) = drawn(axes, "2×")
    assert twice[-1] == pytest.approx(2.0 * 400.0 / (2.0 * math.pi))
    along = draw_campbell("t", diagram(SPEEDS, *branches(), axial=0.95))  # of no whirl at all
    assert len({line.get_color() for line in along.axes[0].get_lines() if line.get_label() == "branch"}) == 1
    ((at, _),) = drawn(axes, "operation")
    assert at[0] == pytest.approx(300.0 * RPM)
    assert axes.get_xlabel() == "speed of rotation [rpm]"
    assert axes.get_ylabel() == "whirl frequency [Hz]"


def test_campbell_of_a_rotor_that_turns_the_other_way_is_the_same_picture() -> None:
    frequencies, directions, ratios = branches()
    one = draw_campbell("t", diagram(SPEEDS, frequencies, directions, ratios))
    other = draw_campbell("t", diagram(-SPEEDS[::-1], frequencies[::-1], -directions[::-1], ratios[::-1]))
    for here, there in zip(one.axes[0].get_lines(), other.axes[0].get_lines(), strict=True):
        assert here.get_color() == there.get_color()
        assert np.array(here.get_data()) == pytest.approx(np.array(there.get_data()))


def test_campbell_marks_critical_speeds_on_the_line_of_once_per_turn() -> None:
    figure = draw_campbell(
        "t", diagram(SPEEDS, *branches()), critical_speeds=[180.0, 222.0, 900.0], critical_directions=[-1.0, 1.0, 1.0]
    )
    marks = drawn(figure.axes[0], "critical")
    assert np.array(marks)[:, :, 0] == pytest.approx(np.array([[s * RPM, s / (2 * math.pi)] for s in (180.0, 222.0)]))
    assert {f"{180.0 * RPM:.4g}", f"{222.0 * RPM:.4g}"} <= texts(figure)  # and none beyond the axis
    low = draw_campbell(
        "t",
        diagram(SPEEDS, *branches()),
        critical_speeds=[180.0, 222.0],
        critical_directions=[-1.0, 1.0],
        frequency_limit=200.0,
    )
    assert [mark[0][0] for mark in drawn(low.axes[0], "critical")] == [pytest.approx(180.0 * RPM)]


def test_campbell_shows_the_decrement_and_where_stability_ends() -> None:
    frequencies, directions, _ = branches()
    ratios = np.column_stack([np.full(21, 0.05), 0.03 - 1e-4 * SPEEDS, np.full(21, 0.02)])
    made_up = replace(diagram(SPEEDS, frequencies, directions, ratios), onset=(300.0, 1))
    figure = draw_campbell("t", made_up)
    upper, lower = figure.axes
    assert upper.get_xlim() == lower.get_xlim()
    assert lower.get_ylabel() == "log. decrement [1]"
    decrement = drawn(lower, "branch")[1][1]
    # Definition: the logarithm of the ratio of successive amplitudes of e^{λt}.
    assert decrement[0] == pytest.approx(2.0 * math.pi * 0.03 / math.sqrt(1.0 - 0.03**2))
    assert f"unstable above {300.0 * RPM:.4g}" in texts(figure)


def test_campbell_leaves_gaps_where_a_branch_is_not_known() -> None:
    frequencies, directions, ratios = branches()
    frequencies[5, 0] = np.nan
    frequencies[:, 2] = np.nan
    (axes,) = draw_campbell("t", diagram(SPEEDS, frequencies, directions, ratios)).axes
    lines = drawn(axes, "branch")
    assert len(lines) == 2
    assert np.isnan(lines[0][1]).sum() == 1


@pytest.mark.parametrize("count", [0, 1])
def test_campbell_refuses_what_is_no_curve(count: int) -> None:
    with pytest.raises(ValueError, match="two or more speeds"):
        draw_campbell("t", diagram(SPEEDS[:count], *(array[:count] for array in branches())))


def test_forty_branches_and_forty_critical_speeds() -> None:
    values = 50.0 + 10.0 * np.arange(40)
    frequencies = np.tile(values, (21, 1))
    figure = draw_campbell(
        "t", diagram(SPEEDS, frequencies, np.ones((21, 40)), np.zeros((21, 40))),
        critical_speeds=values, critical_directions=np.ones(40), frequency_limit=500.0,
    )  # fmt: skip
    (axes,) = figure.axes
    assert len(drawn(axes, "branch")) == 40
    extents = [text.get_window_extent() for text in axes.texts if text.get_text() != "1×"]
    assert len(extents) > 20
    assert not any(a.overlaps(b) for place, a in enumerate(extents) for b in extents[:place])


def test_critical_map_with_the_bearings_own_stiffness() -> None:
    springs = np.geomspace(1e5, 1e9, 41)
    mass = 10.0
    # A rigid rotor on two springs: ω = √(2 k / m), a straight line on logarithmic axes.
    critical = np.sqrt(2.0 * springs / mass)[:, None]
    table = np.array([np.diag([4e6, 8e6]), np.diag([4e6, 8e6])])
    bearings = [
        rotors.Bearing.isotropic("left", 0.0, 1e6),
        rotors.Bearing.isotropic("right", 1.0, 1e6),
        rotors.Bearing("film", 0.5, table, np.zeros((2, 2)), speeds=np.array([1.0, 1e6])),
    ]
    figure = draw_critical_map("t", springs, critical, bearings=bearings, operating_speed=500.0)
    (axes,) = figure.axes
    assert axes.get_xscale() == axes.get_yscale() == "log"
    ((x, y),) = drawn(axes, "critical speed")
    assert x == pytest.approx(springs)
    assert y == pytest.approx(RPM * critical[:, 0])
    # Bearings alike are one line.
    values = {f"{RPM * math.sqrt(2.0 * k / mass):.0f}" for k in (1e6, 4e6, 8e6)}
    assert texts(figure) == {"left, right: k_xx = k_yy", "film: k_xx", "film: k_yy", "1"} | values
    met = sorted(point[:, 0].tolist() for point in drawn(axes, "meeting"))
    assert np.array(met) == pytest.approx(
        np.array([[k, RPM * math.sqrt(2.0 * k / mass)] for k in (1e6, 4e6, 8e6)]), rel=1e-9
    )
    ((_, operation),) = drawn(axes, "operation")
    assert operation[0] == pytest.approx(500.0 * RPM)


def test_two_stiffnesses_are_a_critical_map_and_one_is_none() -> None:
    (axes,) = draw_critical_map("t", [1e6, 4e6], [[100.0], [200.0]]).axes
    ((x, y),) = drawn(axes, "critical speed")
    assert (x, y) == (pytest.approx([1e6, 4e6]), pytest.approx([100.0 * RPM, 200.0 * RPM]))
    with pytest.raises(ValueError, match="two or more"):
        draw_critical_map("t", [1e6], [[100.0]])


def test_meetings_with_a_stiffness_that_grows_with_speed() -> None:
    springs = np.geomspace(1e4, 1e8, 9)
    turning = np.geomspace(1.0, 1e4, 50)
    # Critical at √k, the bearing has 1e3 Ω: they meet at k = 1e6.
    (met,) = map_intersections(springs, np.sqrt(springs)[:, None], turning, 1e3 * turning)
    assert met == pytest.approx((1e6, 1e3))


def test_meetings_up_to_the_end_of_a_table() -> None:
    """Critical speeds √k and a bearing's table 3e7 / Ω: they meet at k³ = 9e14, between the last point and its end."""
    springs = np.geomspace(1e4, 1e6, 8)
    stiffness = 9e14 ** (1.0 / 3.0)
    end = 1.02 * np.sqrt(stiffness)
    assert not ((np.sqrt(springs) > np.sqrt(stiffness)) & (np.sqrt(springs) < end)).any()
    turning = np.geomspace(50.0, end, 40)
    (met,) = map_intersections(springs, np.sqrt(springs)[:, None], turning, 3e7 / turning)
    assert met == pytest.approx((stiffness, np.sqrt(stiffness)), rel=1e-9)
    short = np.geomspace(50.0, 0.98 * np.sqrt(stiffness), 40)
    assert map_intersections(springs, np.sqrt(springs)[:, None], short, 3e7 / short) == []


def test_the_map_marks_where_operation_is_critical_and_writes_what_its_marks_are() -> None:
    springs = np.geomspace(1e4, 1e6, 9)
    bearing = rotors.Bearing.isotropic("one", 0.0, 1e5)
    figure = draw_critical_map(
        "t", springs, np.sqrt(springs)[:, None] * [1.0, 3.0], bearings=[bearing], operating_speed=500.0
    )
    (axes,) = figure.axes
    reached = [line for line in axes.lines if line.get_label() == "operation is critical"]
    # 500 rad/s is √k at 2.5e5 N/m, and 3 √k at a ninth of it.
    assert sorted(float(line.get_xdata()[0]) for line in reached) == pytest.approx([2.5e5 / 9.0, 2.5e5], rel=1e-9)
    written = {text.get_text() for text in axes.texts}
    assert {f"{RPM * factor * 1e5**0.5:.0f}" for factor in (1.0, 3.0)} <= written
    assert {"1", "2"} <= written


def test_critical_map_of_a_free_rotor_leaves_rigid_motions_out() -> None:
    springs = np.array([1e5, 1e6])
    (axes,) = draw_critical_map("t", springs, np.array([[0.0, 100.0], [np.nan, 200.0]])).axes
    assert [np.isfinite(line[1]).sum() for line in drawn(axes, "critical speed")] == [0, 2]
    with pytest.raises(ValueError, match="ascending positive"):
        draw_critical_map("t", springs[::-1], np.ones((2, 1)))


def jeffcott(speeds: np.ndarray, natural: float, ratio: float, eccentricity: float) -> np.ndarray:
    turns = speeds / natural
    return eccentricity * turns**2 / (1.0 - turns**2 + 2j * ratio * turns)


def test_unbalance_response_of_a_jeffcott_rotor() -> None:
    speeds = np.linspace(1.0, 300.0, 300)
    response = jeffcott(speeds, 100.0, 0.05, 1e-5)
    probe = ProbeResponse("disc, $45°$", response, np.abs(response))
    figure = draw_unbalance_response(
        "t", speeds, [probe], critical_speeds=[100.0, 900.0], operating_range=(250.0, 280.0)
    )
    upper, lower = figure.axes
    curve = next(line for line in upper.get_lines() if line.get_label() == r"disc, \$45°\$")
    rpm, size = (np.array(data) for data in curve.get_data())
    # At resonance e / 2ζ, twice that peak to peak; a quarter turn behind.
    assert size[np.argmin(np.abs(rpm - 100.0 * RPM))] == pytest.approx(2e6 * 1e-5 / 0.1)
    assert lower.get_lines()[-1].get_ydata()[99] == pytest.approx(90.0)
    assert [line[0][0] for line in drawn(upper, "critical speed")] == pytest.approx([100.0 * RPM])
    assert f"{100.0 * RPM:.4g}" in texts(figure)
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("amplitude [µm peak to peak]", "phase lag [°]")
    assert len(figure.legends[0].get_lines()) == 1
    logarithmic = draw_unbalance_response("t", speeds, [probe], operating_range=(250.0, 250.0), logarithmic=True)
    assert logarithmic.axes[0].get_yscale() == "log"


def test_phase_goes_on_through_two_resonances() -> None:
    speeds = np.linspace(1.0, 600.0, 2000)
    both = jeffcott(speeds, 100.0, 0.02, 1e-5) - jeffcott(speeds, 400.0, 0.02, 1e-5)
    lag = phase_lag(both)
    assert np.abs(np.diff(lag)).max() < 30.0
    assert lag[0] == pytest.approx(0.0, abs=1.0)
    assert lag[-1] == pytest.approx(360.0, abs=15.0)
    assert np.isnan(phase_lag(np.zeros(3, dtype=complex))).all()


def test_unbalance_response_without_probes_or_motion() -> None:
    assert len(draw_unbalance_response("t", SPEEDS, []).axes) == 2
    still = ProbeResponse("still", np.zeros(21, dtype=complex))
    assert len(draw_unbalance_response("t", SPEEDS, [still], logarithmic=True).axes) == 2
    with pytest.raises(ValueError, match="do not fit the probes"):
        draw_unbalance_response("t", SPEEDS, [ProbeResponse("short", np.zeros(3, dtype=complex))])


def test_the_branches_that_are_drawn_stay_themselves_where_they_cross() -> None:
    """On isotropic bearings a whirl is circular, so that a branch keeps its sense through every crossing."""
    steel = rotors.ShaftMaterial(211e9, 81.2e9, 7810.0)
    discs = [rotors.Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0), rotors.Disc(1.0, 51.5, 0.8, 0.42)]
    rotor = rotors.Rotor("two discs", [rotors.Segment(1.5, 0.05, 0.0, steel)], discs)
    bearings = [rotors.Bearing.isotropic("left", 0.0, 1e6), rotors.Bearing.isotropic("right", 1.5, 1e6)]
    diagram = rotors.campbell(rotor, bearings, np.linspace(50.0, 2000.0, 40), count=8)
    known = np.isfinite(diagram.frequencies)
    assert (known.sum(axis=1) >= 8).all()
    whole = known.all(axis=0)
    assert (np.diff(np.argsort(diagram.frequencies[:, whole], axis=1), axis=0) != 0).any()  # some do cross
    for sense, seen in zip(diagram.direction.T, known.T, strict=True):
        assert (np.abs(sense[seen]) > 0.999).all()
        assert len(set(np.sign(sense[seen]))) == 1
