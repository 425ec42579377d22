"""Pictures of the coupled system: its Campbell diagram and transmissibility, from made-up curves."""

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from gearwhine.coupling.linear.campbell import SystemCampbell, SystemCrossing
from gearwhine.coupling.linear.excitation_orders import ExcitationLine
from gearwhine.coupling.linear.frequency_response import FrequencyResponse
from gearwhine.coupling.linear.lines_over_speed import LinesOverSpeed
from gearwhine.figures.machine.system import (
    KIND_COLORS,
    draw_order_lines,
    draw_system_campbell,
    draw_transmissibility,
)

RPM = 60.0 / (2.0 * math.pi)
SPEEDS = np.linspace(0.0, 100.0, 11)
MESH = ExcitationLine("1× pinion -> wheel", "mesh", 20.0)
SHAFT = ExcitationLine("1× input", "shaft", 1.0)


def diagram() -> SystemCampbell:
    """A housing mode at 800 rad/s and a bending mode that is called torsion from the sixth speed on, then ends."""
    bending = np.where(np.arange(11) < 9, 1000.0 + 2.0 * SPEEDS, np.nan)
    values = np.column_stack([-8.0 + 800.0j * np.ones(11), -5.0 + 1j * bending])
    values[9:, 1] = complex(np.nan, np.nan)
    kinds = np.array([["housing", "rotor"]] * 5 + [["housing", "torsion"]] * 4 + [["housing", ""]] * 2)
    crossings = (
        SystemCrossing(40.0, MESH, -8.0 + 800.0j, 0, "housing", "housing", 0.0),
        SystemCrossing(55.0, MESH, -5.0 + 1100.0j, 1, "torsion", "input", 0.4),
    )
    lines = (SHAFT, MESH)
    nothing = np.zeros((11, 2))
    return SystemCampbell(SPEEDS, values, kinds, kinds, nothing, nothing, lines, crossings, (), 1500.0)


def labelled(figure: Figure, label: str) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in figure.axes[0].get_lines() if line.get_label() == label]


def test_branches_take_the_colours_of_what_moves() -> None:
    figure = draw_system_campbell("t", diagram(), operating_speed=-50.0)
    lines = [line for line in figure.axes[0].get_lines() if line.get_label() == "branch"]
    assert [line.get_color() for line in lines] == [KIND_COLORS[kind] for kind in ("housing", "rotor", "torsion")]
    speeds, hertz = (np.array(data) for data in lines[0].get_data())
    assert speeds == pytest.approx(RPM * SPEEDS)
    assert hertz == pytest.approx(800.0 / (2.0 * math.pi))
    ((at, _),) = labelled(figure, "operation")
    assert at[0] == pytest.approx(50.0 * RPM)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["rotor", "housing", "torsion", "operation"]


def test_orders_have_their_slopes_and_crossings_their_marks() -> None:
    figure = draw_system_campbell("t", diagram())
    ((speeds, hertz),) = labelled(figure, MESH.name)
    assert hertz[-1] / speeds[-1] == pytest.approx(20.0 / 60.0)
    marks = [mark for mark in figure.axes[0].collections if mark.get_label() == "crossing"]
    places = np.array([np.ravel(mark.get_offsets()) for mark in marks])
    expected = np.array([[40.0 * RPM, 800.0 / (2.0 * math.pi)], [55.0 * RPM, 1100.0 / (2.0 * math.pi)]])
    assert places == pytest.approx(expected)
    # More strain in the teeth makes a larger mark.
    assert marks[1].get_sizes()[0] > marks[0].get_sizes()[0]
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert {"1× pinion → wheel", SHAFT.name} <= texts


def test_lines_of_one_order_have_one_name_and_what_is_not_solved_no_mark() -> None:
    second = ExcitationLine("1× wheel -> other", "mesh", MESH.order)
    exponents = np.full((11, 2), complex(np.nan, np.nan))
    exponents[3, 1] = -5.0 + 1020.0j
    observed = np.full((11, 2), np.nan)
    observed[3, 1] = 1220.0
    turned = replace(diagram(), lines=(SHAFT, MESH, second), exponents=exponents, observed=observed)
    figure = draw_system_campbell("t", turned)
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert "1× pinion → wheel and 1 more" in texts
    assert not any("other" in text for text in texts)
    for label, hertz in (("turning", 1020.0 / (2.0 * math.pi)), ("observed", 1220.0 / (2.0 * math.pi))):
        ((at, marks),) = labelled(figure, label)
        assert marks[~np.isnan(marks)] == pytest.approx([hertz])
        assert at[~np.isnan(marks)] == pytest.approx([SPEEDS[3] * RPM])


def test_the_legend_of_every_kind_lies_below_the_diagram() -> None:
    kinds = np.array([list(KIND_COLORS)] * 11)
    count = len(KIND_COLORS)
    values = -5.0 + 1j * np.tile(100.0 * np.arange(1, count + 1), (11, 1))
    nothing = np.zeros((11, count))
    every = SystemCampbell(SPEEDS, values, kinds, kinds, nothing, nothing, (SHAFT, MESH), (), (), 1500.0)
    figure = draw_system_campbell("t", every, operating_speed=50.0)
    (key,) = figure.legends
    assert [text.get_text() for text in key.get_texts()] == [*KIND_COLORS, "operation"]
    place, sheet = key.get_window_extent(), figure.bbox
    assert place.y1 < figure.axes[0].get_tightbbox().y0  # type: ignore[union-attr]
    assert sheet.x0 <= place.x0 < place.x1 <= sheet.x1
    assert sheet.y0 <= place.y0


def response(*, sensors: bool) -> FrequencyResponse:
    w = 2.0 * math.pi * np.linspace(10.0, 1000.0, 50)
    force = (3e6 + 4e6j) * np.ones(50)
    return FrequencyResponse(
        "transmission error of m",
        "m",
        w,
        np.zeros((50, 1), dtype=complex),
        {"top": 1e6 * w.astype(complex)} if sensors else {},
        {"left": np.column_stack([force, 0.0 * force])},
        {"m": force},
    )


def test_a_panel_for_each_kind_of_answer() -> None:
    figure = draw_transmissibility("t", response(sensors=True), mesh_frequencies=[300.0])
    sensors, bearings, mesh = figure.axes
    assert [axes.get_ylabel().split(" [")[0] for axes in (mesh, bearings, sensors)] == [
        "mesh force",
        "bearing force",
        "acceleration",
    ]
    # By a micrometre: 5e6 N/m are 5 N/µm.
    assert np.array(mesh.get_lines()[0].get_ydata()) == pytest.approx(5.0)
    marked = [line.get_xdata()[0] for line in mesh.get_lines() if line.get_label() == "mesh frequency"]
    assert marked == pytest.approx([300.0, 600.0, 900.0])
    assert len(draw_transmissibility("t", response(sensors=False)).axes) == 2


def test_the_highest_mesh_harmonics_over_speed_and_all_together() -> None:
    speeds, orders = np.linspace(-50.0, -100.0, 6), np.arange(1.0, 9.0)
    amplitudes = np.add.outer([1.0, 2.0], np.outer(1e-3 * speeds**2, 1.0 / orders))
    amplitudes[:, -1] = np.nan  # above the limit
    amplitudes[:, 3:, 1] = np.nan
    causes = tuple(f"{order:.0f}× pinion -> wheel" for order in orders)
    nothing = np.zeros((6, 8, 0), dtype=complex)
    over = LinesOverSpeed(speeds, orders, causes, ("top", "side"), amplitudes, np.zeros((2, 6)), nothing, ())
    figure = draw_order_lines(over, operating_speed=-80.0)
    top, side = figure.axes
    for place, axes in enumerate((top, side)):
        together, *lines, operation = axes.get_lines()
        assert np.asarray(together.get_xdata()) == pytest.approx(-RPM * speeds[:-1])
        expected = np.sqrt(np.nansum(amplitudes[place, :-1] ** 2, axis=1))
        assert np.asarray(together.get_ydata()) == pytest.approx(expected)
        # The six highest of eight.
        for number, line in enumerate(lines):
            assert line.get_ydata() == pytest.approx(amplitudes[place, :, number], nan_ok=True)
        assert len(lines) == 6
        assert operation.get_xdata() == pytest.approx([80.0 * RPM] * 2)
    assert top.get_title(loc="left") == "top"
    (legend,) = figure.legends
    names = [text.get_text() for text in legend.get_texts()]
    assert names == [*(f"{order}× pinion → wheel" for order in range(1, 7)), "all together, rms × √2", "operation"]
