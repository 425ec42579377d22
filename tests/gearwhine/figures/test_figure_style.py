"""Style of all figures: heads as low as their notes, phases, numbers, logarithmic axes, labels beside a panel."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg

from gearwhine.figures.style import (
    FOOT,
    HEAD,
    LEFT,
    SHEET_WIDTH,
    Label,
    column_width,
    degree_axis,
    draw_column,
    log_axis,
    panel,
    plain,
    sheet,
    sheet_height,
)


@pytest.mark.parametrize("note", ["", "one line", "words " * 40])
def test_a_head_is_as_low_as_its_note_allows(note: str) -> None:
    figure = sheet(HEAD + 50.0 + FOOT, "Title", note)
    axes = panel(figure, FOOT, 50.0)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    lowest = min(text.get_window_extent().y0 for text in figure.texts)
    gap = (lowest - axes.get_window_extent().y1) / figure.dpi * 25.4
    assert 1.0 < gap < 4.5
    assert sheet_height(figure) <= HEAD + 50.0 + FOOT


@given(st.floats(-1080.0, 1080.0), st.floats(0.0, 1500.0))
def test_phases_have_ticks_of_45_degrees_or_multiples(low: float, span: float) -> None:
    axes = panel(sheet(80.0, "t"), FOOT, 40.0)
    axes.set_ylim(low, low + max(span, 1e-3))
    degree_axis(axes)
    first, last = axes.get_ylim()
    assert first <= low + 1e-5
    assert last >= low + span - 1e-5
    assert last - first >= 90.0
    ticks = [tick for tick in axes.get_yticks() if first <= tick <= last]
    assert 2 <= len(ticks) <= 9
    step = ticks[1] - ticks[0]
    assert step in (45.0, 90.0, 180.0, 360.0)
    assert np.mod(ticks, step) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (1000.0, 3, "1000"),
        (1234.5, 3, "1230"),
        (100.0, 2, "100"),
        (0.01, 2, "0.01"),
        (0.0, 3, "0"),
        (-17.16, 3, "-17.2"),
    ]
    + [(2.5e7, 3, "2.5e+07"), (3.2e-5, 2, "3.2e-05"), (999.6, 3, "1000")],
)
def test_numbers_are_without_powers_of_ten_where_they_can_be(value: float, digits: int, text: str) -> None:
    assert plain(value, digits) == text


@pytest.mark.parametrize(("low", "high"), [(0.4, 3.0), (1.0, 40.0), (2e-3, 9e-3)])
def test_a_logarithmic_axis_of_few_decades_has_plain_numbers(low: float, high: float) -> None:
    axes = panel(sheet(80.0, "t"), FOOT, 40.0)
    log_axis(axes, low, high)
    FigureCanvasAgg(axes.figure).draw()  # type: ignore[arg-type]
    shown = [
        text.get_text()
        for place, text in zip(axes.get_yticks(), axes.get_yticklabels(), strict=True)
        if low <= place <= high
    ]
    assert len(shown) >= 2
    assert [float(text) for text in shown] == pytest.approx([p for p in axes.get_yticks() if low <= p <= high])
    assert not any("10" in text.get_text() and "^" in text.get_text() for text in axes.get_yticklabels(minor=True))


def test_labels_beside_a_panel_do_not_touch_and_stay_on_the_sheet() -> None:
    """Seven orders that end almost at one height."""
    labels = [Label(f"{order}× pinion → wheel", 10.0, 1.0 + 1e-3 * order) for order in range(7)]
    figure = sheet(90.0, "t")
    axes = panel(figure, FOOT, 50.0, width=SHEET_WIDTH - LEFT - column_width(labels))
    axes.set(xlim=(0.0, 10.0), ylim=(0.0, 8.0))
    draw_column(axes, labels)
    FigureCanvasAgg(figure).draw()
    boxes = sorted((text.get_window_extent() for text in axes.texts), key=lambda box: box.y0)
    assert all(one.y1 < other.y0 + 1.0 for one, other in pairwise(boxes))
    assert max(box.x1 for box in boxes) < figure.get_window_extent().x1
    assert min(box.x0 for box in boxes) > axes.get_window_extent().x1
    # In the order of the heights that they name.
    rising = sorted(axes.texts, key=lambda text: text.get_position()[1])
    assert [text.get_text()[0] for text in rising] == list("0123456")
