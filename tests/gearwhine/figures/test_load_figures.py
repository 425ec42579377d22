"""Figures of the operating point show the forces, deflections and loads that were found."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation

import gearwhine as gw
from gearwhine.analyses.result import Result
from gearwhine.coupling.load_analysis.solved_load import SolvedLoad

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def loaded() -> Result[SolvedLoad]:
    """The helical pair over torque."""
    return gw.load("helical-pair").operating_point(over_torque=True)


@pytest.fixture(scope="module")
def figures(loaded: Result[SolvedLoad]) -> dict[str, Figure]:
    return dict(loaded.figures())


def test_there_is_one_figure_of_each_shaft_pair_and_cause(figures: dict[str, Figure]) -> None:
    assert list(figures) == [
        "load-shaft-input",
        "load-shaft-output",
        "load-misalignment",
        "load-face-pinion-wheel",
        "load-pattern-pinion-wheel",
        "load-over-torque",
    ]


def test_shafts_show_their_forces_and_deflection(loaded: Result[SolvedLoad], figures: dict[str, Figure]) -> None:
    figure, (shaft, _) = figures["load-shaft-input"], loaded.solved.shafts
    for plane, axes in enumerate(figure.axes):
        told = {text.get_text() for text in axes.texts if isinstance(text, Annotation) and text.get_text()}
        forces = [abs(one.force[plane]) for one in loaded.solved.point.bearings if one.mounted.rotor == "input"]
        assert {f"{force:.4g} N" for force in (*forces, sum(forces))} == told
        # The wheel pushes the pinion down and towards it, along -y and -x; the bearings hold it.
        arrows = {one.xy[0]: one.xy[1] - one.xyann[1] for one in axes.texts if not one.get_text()}  # type: ignore[attr-defined]
        assert {at: np.sign(length) for at, length in arrows.items()} == {20.0: 1.0, 220.0: 1.0, 120.0: -1.0}
        assert -arrows[120.0] > max(arrows[20.0], arrows[220.0])
        (line,) = [line for line in axes.lines if line.get_label() == "deflection"]
        drawn = np.asarray(line.get_ydata())
        factor = drawn[np.abs(drawn).argmax()] / (1e3 * shaft.motion[plane][np.abs(drawn).argmax()])
        assert factor == pytest.approx(200.0)
        assert drawn == pytest.approx(200e3 * shaft.motion[plane])
        # Both directions have one scale.
        box, (low, high), (left, right) = axes.get_window_extent(), axes.get_ylim(), axes.get_xlim()
        assert box.height / (high - low) == pytest.approx(box.width / (right - left), rel=1e-9)
    assert "deflections 200 times as large as lengths" in figure.texts[1].get_text()


def test_rows_below_a_shaft_show_thrust_and_moments(loaded: Result[SolvedLoad], figures: dict[str, Figure]) -> None:
    """The free body is complete: drawn numbers and senses balance in either plane, moments about the left end."""
    figure, point = figures["load-shaft-input"], loaded.solved.point
    (pinion, _) = point.gear_forces(0)
    assert "below them thrusts and moments" in figure.texts[1].get_text()
    drawn = 0
    for plane, axes in enumerate(figure.axes):
        numbers = [text.get_text() for text in axes.texts if not isinstance(text, Annotation)]
        # The left bearing holds what the pinion is pushed with, which are the two thrusts.
        thrust = f"{abs(pinion[2]):.4g} N"
        assert numbers.count(thrust) == 2
        arrows = [patch for patch in axes.patches if patch.get_label() == "_thrust"]
        ways = {}
        for arrow in arrows:
            (tail, _), (tip, _) = arrow._posA_posB  # type: ignore[attr-defined]
            ways[round(0.5 * (tail + tip))] = np.sign(tip - tail)
        assert ways == {20: -np.sign(pinion[2]), 120: np.sign(pinion[2])}
        # From z towards x a moment is about +y, from z towards y about -x.
        turning = pinion[4] if plane == 0 else -pinion[3]
        # Where the thrust does not tilt the shaft, across the line of centres, there is none to see.
        seen = abs(turning) > 0.02 * np.abs(pinion[3:5]).max()
        assert (f"{abs(turning):.3g} N·m" in numbers) is bool(seen)
        if not seen:
            continue
        drawn += 1
        arcs = [np.asarray(line.get_xydata()) for line in axes.lines if line.get_label() == "_arc"]
        (arc,) = [one for one in arcs if abs(one[:, 0].mean() - 120.0) < 3.0]
        # Along the arc to its head, counter-clockwise where positive.
        chords = np.array([arc[arc.shape[0] // 2] - arc[0], arc[-1] - arc[0]])
        assert np.sign(np.linalg.det(chords)) == np.sign(turning)
    assert drawn == 1


def test_a_shaft_without_thrust_and_moments_has_no_rows() -> None:
    figure = dict(gw.load("spur-pair").operating_point().figures())["load-shaft-input"]
    assert "below" not in figure.texts[1].get_text()
    for axes in figure.axes:
        assert not [patch for patch in axes.patches if patch.get_label() in ("_thrust", "_moment")]


def test_faces_show_gap_and_load(loaded: Result[SolvedLoad], figures: dict[str, Figure]) -> None:
    (pair,) = loaded.solved.point.pairs
    upper, lower = figures["load-face-pinion-wheel"].axes
    lines = {line.get_label(): np.asarray(line.get_ydata()) for line in (*upper.lines, *lower.lines)}
    assert lines["mean"] == pytest.approx(1e-3 * pair.line_load)
    assert lines["even"] == pytest.approx(1e-3 * pair.force / 25e-3)
    # Crowned by 6 µm at the ends, of which the middles of the outermost slices have 60 of 61 parts.
    crown = 6.0 * (pair.z / 12.5e-3) ** 2
    assert lines["with modifications"] - lines["by deflection"] == pytest.approx(
        crown - (crown + 1e6 * pair.gap).min() + 1e6 * pair.gap.min(), abs=1e-6
    )
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("gap before the load [µm]", "line load, all tooth pairs [N/mm]")
    (band,) = [one for one in lower.collections if isinstance(one, PolyCollection)]
    heights = band.get_paths()[0].vertices[:, 1]
    assert heights.max() == pytest.approx(1e-3 * pair.fine.line_load.max())


def test_bars_of_the_causes_add_up(loaded: Result[SolvedLoad], figures: dict[str, Figure]) -> None:
    (pair,) = loaded.solved.point.pairs
    (axes,) = figures["load-misalignment"].axes
    widths = [patch.get_width() for patch in axes.patches]
    assert widths == pytest.approx([1e6 * part for part in pair.misalignment_by_cause.values()])
    (line,) = [line for line in axes.lines if line.get_label() == "_sum"]
    assert np.asarray(line.get_xdata()) == pytest.approx(sum(widths))
    ends = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in axes.patches]
    assert min(map(min, ends)) == pytest.approx(sum(width for width in widths if width < 0.0))
    assert max(map(max, ends)) == pytest.approx(sum(width for width in widths if width > 0.0))
    assert axes.get_xlabel() == "misalignment [µrad]"
    low, high = axes.get_xlim()
    assert all(low < end < high for bar in axes.patches for end in (bar.get_x(), bar.get_x() + bar.get_width()))
    # Causes that there are, and no others: this machine has no housing.
    (legend,) = figures["load-misalignment"].legends
    assert [text.get_text() for text in legend.get_texts()] == ["shafts", "bearings", "bodies", "sum"]
