"""The best indicator of a sensor, and its curve in the picture: detections made by hand, whose order is known."""

import io

import numpy as np
import pytest
from rich.console import Console

from gearwhine.detection.detectability import Detectability, DetectionResult, Monitor, detectability
from gearwhine.figures.detection import draw_detection
from gearwhine.numerics.detection_probability import Detection, Share, hit_miss
from gearwhine.output.sections import Table
from gearwhine.output.terminal import show_section
from gearwhine.results.detection import detection_document, sections

SIZES = (0.4e-3, 0.8e-3, 1.2e-3, 1.6e-3, 2e-3)
SAMPLES = np.repeat(SIZES, 8)


def _part(
    indicator: str, hits: tuple[int, ...], a90: float | None, a90_95: float | None, step: float = 0.01
) -> Detectability:
    """An indicator of eight gearboxes of each size with these hits, and the sizes that its curve is said to have."""
    healthy = 1.0 + step * np.arange(20.0)
    responses = np.concatenate([np.repeat([9.0, 0.5], [hit, 8 - hit]) for hit in hits])
    found = detectability("roof", indicator, healthy, SAMPLES, responses, 0.01, "log-normal")
    shares = tuple(Share(size, hit, 8) for size, hit in zip(SIZES, hits, strict=True))
    detection = Detection("signal response", hit_miss(SAMPLES, responses > 2.0), shares, a90, a90_95)
    assert found.threshold is not None
    return Detectability("roof", indicator, healthy, SAMPLES, responses, found.threshold, detection)


def _result(*parts: Detectability) -> DetectionResult:
    monitor = Monitor(("roof",), tuple(one.indicator for one in parts), 0.05, 100, 0.01, "log-normal", 1)
    written = {size: f"{1e3 * size:g} mm" for size in SIZES}
    return DetectionResult("gear.pinion.fault.depth", "pinion", written, monitor, False, 7.0, 3e3, parts, {}, 7, 0)


LATE = _part("sideband_index", (0, 1, 8, 8, 8), 1.05e-3, 1.09e-3)
EARLY = _part("na4", (0, 8, 8, 8, 8), 0.74e-3, 1.22e-3)
EQUAL = _part("change_rms", (0, 8, 8, 8, 8), 0.74e-3, 1.22e-3)
SURER = _part("fm0", (0, 8, 8, 8, 8), 0.74e-3, 1.1e-3)
# 1 of 8 at 0.8 mm: at most 52.7 % by Clopper and Pearson, where the curve says more than 90 %.
AGAINST_ITS_HITS = _part("rms", (0, 1, 8, 8, 8), 0.6e-3, 0.7e-3)


@pytest.mark.parametrize(
    ("parts", "best"),
    [
        ((LATE, EARLY), "na4"),  # the smaller a90, though its a90/95 is larger
        ((LATE, EARLY, SURER), "fm0"),  # of equal a90 the smaller a90/95
        ((AGAINST_ITS_HITS, EARLY), "na4"),  # a curve that the hits contradict comes last
        ((AGAINST_ITS_HITS,), "rms"),
    ],
)
def test_the_best_indicator_sees_the_smallest_fault(parts: tuple[Detectability, ...], best: str) -> None:
    found = _result(*parts).best["roof"]
    assert found is not None
    assert found.indicator == best


def test_the_criterion_and_a_contradiction_are_said_and_equal_indicators_named() -> None:
    content = sections(detection_document(_result(AGAINST_ITS_HITS, EARLY, EQUAL)))[0].content
    (table,) = [one for one in content if isinstance(one, Table) and one.caption.startswith("Best indicator")]
    assert "smallest a90, of equal ones the smallest a90/95" in table.caption
    columns, ((*row,),) = table.filled()
    named = dict(zip([column.heading for column in columns], row, strict=True))
    assert named["indicator"] == "NA4"
    assert "Others that see as small a fault at roof as NA4: change rms." in map(str, content)
    assert any("Hits contradict the fitted curve of rms at roof" in str(one) for one in content)


def test_a_bound_that_the_hits_leave_open_is_explained_and_thresholds_show_their_interval() -> None:
    """Of 28 gearboxes that are all found the probability may be below 0.9: 0.9²⁸ = 0.052, 0.9²⁹ = 0.047."""
    assert 0.9**28 > 0.05 > 0.9**29
    open_bound = _part("na4", (0, 8, 8, 8, 8), 0.74e-3, None, 1e-6)
    content = sections(detection_document(_result(open_bound, SURER)))[0].content
    (said,) = [str(one) for one in content if str(one).startswith("Without a90/95")]
    assert "NA4 at roof. " in said
    assert "29 of 29" in said
    content = sections(detection_document(_result(open_bound)))[0].content
    (table,) = [one for one in content if isinstance(one, Table) and one.caption.startswith("Best indicator")]
    columns, ((*row,),) = table.filled()
    cell = dict(zip([column.heading for column in columns], row, strict=True))["threshold (95 %)"]
    value, low, high = (float(text.strip("()")) for text in str(cell).replace("to ", "").split())
    assert low < value < high


def test_healthy_values_that_the_fitted_distribution_does_not_have_are_warned_of() -> None:
    """Evenly spaced ones may be of a log-normal distribution; half of them a hundred times as large are of none."""
    healthy = (1.0 + 0.01 * np.arange(20.0)) * np.repeat([1.0, 100.0], 10)
    two = detectability("roof", "rms", healthy, SAMPLES, np.full(40, 9.0), 0.01, "log-normal")
    document = detection_document(_result(EARLY, two))
    (told,) = [one for one in document["warnings"] if one["name"] == "distribution of healthy values"]
    assert told["parts"] == 1
    assert "values of rms at roof are not" in told["message"]
    assert detection_document(_result(EARLY))["warnings"] == []


def test_the_picture_draws_the_indicator_of_its_heading_and_tells_equal_curves_apart() -> None:
    found = _result(LATE, _part("rms", (0, 0, 0, 0, 8), 1.9e-3, None), EARLY, EQUAL)
    figure = dict(draw_detection("By hand", found))["detection-probability"]
    (axes,) = figure.axes
    assert axes.get_title(loc="left").startswith("roof: NA4")
    lines = {line.get_label(): line for line in axes.lines if str(line.get_label()) in ("na4", "change_rms")}
    assert set(lines) == {"na4", "change_rms"}
    # Dashes of one colour lie in the gaps of the other.
    patterns = {name: line._unscaled_dash_pattern for name, line in lines.items()}
    assert patterns["na4"][1] == patterns["change_rms"][1]
    assert patterns["na4"][0] != patterns["change_rms"][0]
    # The band is of the heading's indicator.
    assert [tuple(one.get_facecolor()[0][:3]) for one in axes.collections] == [
        pytest.approx(tuple(int(lines["na4"].get_color()[at : at + 2], 16) / 255.0 for at in (1, 3, 5)))
    ]


def test_values_over_decades_are_drawn_over_a_logarithmic_axis() -> None:
    far = _part("na4", (0, 8, 8, 8, 8), 0.74e-3, 1.22e-3)
    far.responses[:] = np.repeat([1.0, 1e2, 1e4, 1e6, 5e7], 8)
    figures = dict(draw_detection("By hand", _result(far, EQUAL)))
    assert figures["detection-responses-1"].axes[0].get_yscale() == "log"
    assert figures["detection-responses-2"].axes[0].get_yscale() == "linear"


def test_the_tables_of_a_study_stand_in_rows_at_80_columns_and_a_fault_that_none_finds_is_said() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=80, color_system=None)
    for section in sections(detection_document(_result(LATE, EARLY))):
        show_section(console, section)
    assert isinstance(console.file, io.StringIO)
    lines = [line.split() for line in console.file.getvalue().splitlines()]
    assert [line[0] for line in lines if line and line[0] in ("sensor", "indicator", "roof")] == [
        "indicator",
        "sensor",
        "roof",
        "sensor",
        "roof",
    ]
    content = sections(detection_document(_result(_part("rms", (0, 0, 0, 0, 0), None, None))))[0].content
    assert any(str(one).startswith("No indicator at roof finds any of these sizes") for one in content)
