"""Figures of a sweep over three speeds that do not ascend: each panel and each line has its own made-up numbers."""

import re
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gearwhine.figures.machine.sweep import draw_sweep

SPEEDS = np.array([4500.0, 3000.0, 6000.0])  # rpm
RISING = np.argsort(SPEEDS)
RMS = {"top": np.array([2.0, 5.0, 3.0]), "wall": np.array([0.4, 0.1, 0.9])}
PEAK = {"a -> b": np.array([900.0, 700.0, 800.0]), "c -> d": np.array([1900.0, 1500.0, 1700.0])}
MEAN = {"a -> b": np.array([500.0, 510.0, 520.0]), "c -> d": np.array([1100.0, 1120.0, 1140.0])}
LOSS = {"a -> b": np.array([0.0, 0.02, 0.05]), "c -> d": np.array([0.01, 0.0, 0.3])}
TEETH = {"a -> b": 23.0, "c -> d": 9.0}
LEVEL, LEVEL_A = np.array([80.0, 84.0, 91.0]), np.array([77.0, 79.0, 90.0])
HARMONICS = {"1× c -> d": np.array([60.0, 62.0, 61.0]), "2× a -> b": np.array([70.0, 83.0, 75.0])}


def over_speed(dimension: str, values: dict[str, npt.NDArray[np.float64]]) -> Any:
    return (dimension, "speed"), np.array(list(values.values()))


@pytest.fixture(scope="module")
def figures() -> dict[str, Figure]:
    orders = np.array([0.0, 9.0, 23.0, 46.0])
    turns = SPEEDS / 60.0
    spectra = np.array([[0.0, 0.2, 1.0, 0.5], [0.0, 0.6, 0.3, 0.1]])
    data = xr.Dataset(
        {
            "done": ("speed", np.ones(3, dtype=bool)),
            "sensor_rms": over_speed("sensor", RMS),
            "sensor_spectrum": (("speed", "sensor", "order"), np.multiply.outer(1.0 + np.arange(3), spectra)),
            "frequency": (("speed", "order"), np.outer(turns, orders)),
            "mesh_force_peak": over_speed("contact", PEAK),
            "mesh_force_mean": over_speed("contact", MEAN),
            "contact_loss": over_speed("contact", LOSS),
            "mesh_frequency": (("contact", "speed"), np.outer(list(TEETH.values()), turns)),
            "sound_power_level": ("speed", LEVEL),
            "sound_power_level_a": ("speed", LEVEL_A),
            "mesh_harmonic_level": over_speed("mesh_harmonic", HARMONICS),
            "sound_line_level": (("sound_line", "speed"), np.array([LEVEL - 1.0, LEVEL - 9.0])),
            "sound_line_frequency": (("sound_line", "speed"), np.array([23.0 * turns, 9.0 * turns])),
        },
        {
            "speed": ("speed", SPEEDS, {"units": "rpm", "long_name": "operation.speed"}),
            "sensor": list(RMS),
            "contact": list(PEAK),
            "mesh_harmonic": list(HARMONICS),
            "order": orders,
        },
    )
    return dict(draw_sweep("Made-up machine", data))


def panels(figure: Figure) -> dict[str, list[Axes]]:
    """By their titles at the left, those beside one under its title too."""
    found: dict[str, list[Axes]] = {}
    title = ""
    for axes in figure.axes:
        title = axes.get_title(loc="left") or title
        found.setdefault(title, []).append(axes)
    return found


def curves(axes: Axes, style: str) -> list[npt.NDArray[np.float64]]:
    return [np.array(line.get_data()) for line in axes.get_lines() if line.get_linestyle() == style]


def held(found: npt.NDArray[np.float64], values: npt.NDArray[np.float64]) -> None:
    np.testing.assert_allclose(found, [SPEEDS[RISING], values[RISING]])


def head(figure: Figure) -> list[str]:
    """Title and note of a sheet."""
    return [text.get_text() for text in figure.texts[:2]]


def test_each_sensor_has_a_panel_of_its_own_levels(figures: dict[str, Figure]) -> None:
    title, note = head(figures["sweep-rms"])
    assert title.startswith("Acceleration over ")
    assert note == "Made-up machine"
    shown = panels(figures["sweep-rms"])
    assert set(shown) == set(RMS)
    for name, (axes,) in shown.items():
        (curve,) = curves(axes, "-")
        held(curve, RMS[name])
        assert (axes.get_ylabel(), axes.get_yscale()) == ("rms [m/s²]", "log")
    lowest = min(figures["sweep-rms"].axes, key=lambda axes: axes.get_position().y0)
    assert "[rpm]" in lowest.get_xlabel()


def test_each_pair_has_its_largest_and_mean_force_and_its_part_of_the_time(figures: dict[str, Figure]) -> None:
    _, note = head(figures["sweep-mesh-force"])
    assert note == "Made-up machine; solid: largest, dashed: mean"
    shown = panels(figures["sweep-mesh-force"])
    assert set(shown) == {name.replace("->", "→") for name in PEAK}
    for name, (left, right) in zip(PEAK, (shown[one.replace("->", "→")] for one in PEAK), strict=True):
        (largest,), (mean,), (apart,) = curves(left, "-"), curves(left, "--"), curves(right, "-")
        held(largest, PEAK[name])
        held(mean, MEAN[name])
        held(apart, 100.0 * LOSS[name])
        assert (left.get_ylabel(), right.get_ylabel()) == ("mesh force [N]", "time apart [%]")
        assert left.get_ylim()[1] > PEAK[name].max()
        assert right.get_ylim()[1] > 100.0 * LOSS[name].max()


def test_the_solid_level_is_the_weighted_one(figures: dict[str, Figure]) -> None:
    """A-weighted totals are solid, unweighted ones dashed, as the note says; below, lines at their frequencies."""
    title, note = head(figures["sweep-sound"])
    assert title.startswith("Sound over ")
    assert note == "Made-up machine; sound power levels re 1 pW, solid: A-weighted, dashed: unweighted"
    upper, lower, bar = figures["sweep-sound"].axes
    (weighted,), (total, *harmonics) = curves(upper, "-"), curves(upper, "--")
    held(weighted, LEVEL_A)
    held(total, LEVEL)
    (legend,) = figures["sweep-sound"].legends
    named = {text.get_text(): handle for text, handle in zip(legend.get_texts(), legend.legend_handles, strict=True)}
    # The harmonic that is loudest anywhere is the first.
    assert list(named) == ["all lines", "2× a → b", "1× c → d"]
    for curve, (name, values) in zip(harmonics, reversed(HARMONICS.items()), strict=True):
        held(curve, values)
        (line,) = [one for one in upper.get_lines() if np.array_equal(np.array(one.get_data()), curve)]
        assert line.get_color() == named[name.replace("->", "→")].get_color()
    (points,) = lower.collections
    found = {
        (float(x), round(float(y), 6)): float(c)
        for (x, y), c in zip(points.get_offsets(), points.get_array(), strict=True)
    }
    expected = {
        (rpm, round(order * rpm / 60.0, 6)): level - below
        for rpm, level in zip(SPEEDS, LEVEL, strict=True)
        for order, below in ((23.0, 1.0), (9.0, 9.0))
    }
    assert found == expected
    assert (upper.get_ylabel(), lower.get_ylabel(), bar.get_ylabel()) == (
        "sound power level [dB]",
        "frequency [Hz]",
        "sound power level [dB]",
    )
    slopes = {
        round(float(np.diff(line.get_ydata())[0] / np.diff(line.get_xdata())[0]), 9) for line in lower.get_lines()
    }
    assert {round(order / 60.0, 9) for order in TEETH.values()} <= slopes


def test_each_sensor_has_a_waterfall_of_its_own_spectra(figures: dict[str, Figure]) -> None:
    # The third point has three times the amplitudes of the first.
    for name, highest in (("top", "3"), ("wall", "1.8")):
        figure = figures[f"waterfall-{name}"]
        title, note = head(figure)
        assert title.startswith(f"{name}: spectra over ")
        assert re.fullmatch(rf"Made-up machine; each row \S+ to {highest} m/s² peak, logarithmic", note)
        axes = figure.axes[0]
        assert "[rpm]" in axes.get_ylabel()
        assert axes.get_xlabel() == "frequency [Hz]"
        assert axes.get_xlim()[1] == pytest.approx(46.0 * 100.0, rel=0.1)
