"""Sweep figures: levels of sensors and of the sound over the swept key, and a waterfall for each sensor."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gearwhine.coupling.signals.spectrum import from_decibels, rms_of_peak
from gearwhine.figures.spectra import draw_waterfall
from gearwhine.figures.style import (
    FOOT,
    HEAD,
    INK,
    LABEL,
    LEFT,
    NOTE,
    PANEL_WIDTH,
    SERIES,
    legend_below,
    legend_height,
    log_axis,
    name_in_legend,
    name_lowest,
    panel,
    panel_pair,
    panel_title,
    sheet,
    stacked,
)
from gearwhine.numerics.arrays import FloatArray
from gearwhine.output import file_stems
from gearwhine.output.quantity import shown_product
from gearwhine.output.sections import arrowed, rms_of_band

if TYPE_CHECKING:
    import xarray as xr

_MOST_WATERFALLS = 12  # largest number of waterfalls of a grid over several keys
_RANGE_OF_COLOURS = 40.0  # range of levels below the highest that the colours distinguish [dB]
_MARKS = 30  # number of points up to which each is marked
_LEVELS, _LEVELS_GAP = 36.0, 8.0  # height of a sensor's panel, and gap with a title between two [mm of paper]
_FORCES, _FORCES_GAP = 42.0, 8.0  # height of a gear pair's panels, and gap with a title between two [mm of paper]
_LINES, _SCALE = 50.0, 17.0  # height of the panel of loudest lines, and width of its colour scale [mm of paper]
_FIRST = 5.0  # height of the first panel's title [mm of paper]
_COLUMNS = 3  # columns of the names of lines
_HARMONICS = 3  # mesh harmonics that have a line of their own
_CIRCLES = "; circles: peaks that the points pass by, an estimate"
_ORDERS = 6  # multiples of a mesh frequency that are drawn among the loudest lines


def draw_sweep(title: str, dataset: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """Draw a gathered sweep: yields the name of each figure, such as ``sweep-rms``, and the figure.

    Levels stand over the speed, or over the first key where the speed is not swept. Each combination of the other keys
    has a line of its own, and a waterfall of its own up to twelve pictures in all.
    """
    if not bool(dataset["done"].any()):
        return
    swept = [str(name) for name in dataset["done"].dims]
    along = "speed" if "speed" in swept else swept[0]
    other_keys = [name for name in swept if name != along]
    places = [
        dict(zip(other_keys, place, strict=True)) for place in product(*(range(dataset.sizes[n]) for n in other_keys))
    ]
    if "sensor_rms" in dataset:
        yield "sweep-rms", _sensor_levels(title, dataset, along, places)
        yield from _waterfalls(title, dataset, along, places)
    if "mesh_force_mean" in dataset:
        yield "sweep-mesh-force", _mesh_forces(title, dataset, along, places)
    if "sound_power_level" in dataset:
        yield "sweep-sound", _sound_levels(title, dataset, along, places)


def _sensor_levels(title: str, dataset: xr.Dataset, along: str, places: list[dict[str, int]]) -> Figure:
    sensors = [str(name) for name in dataset["sensor"].values]
    foot = FOOT + _legend_height(places)
    # In a grid over several keys the peaks of several lines would stand beside each other.
    missed = {sensor: _missed_peaks(dataset, along, sensor) for sensor in sensors if len(places) == 1}
    circles = _CIRCLES if any(len(speeds) for speeds, _ in missed.values()) else ""
    heading, note = f"Acceleration over {_key(dataset, along)}", f"{title}{circles}"
    figure, panels = stacked(len(sensors), _LEVELS, _LEVELS_GAP, heading, note, first=_FIRST, foot=foot)
    limits = dataset["trusted_limit"].values.ravel().tolist() if "trusted_limit" in dataset else []
    rms = rms_of_band(limit for limit in limits if not np.isnan(limit))
    for sensor, axes in zip(sensors, panels, strict=True):
        _draw_lines(axes, dataset["sensor_rms"].sel(sensor=sensor), along, places)
        speeds, peaks = missed.get(sensor, (np.empty(0), np.empty(0)))
        peaks = np.asarray(rms_of_peak(from_decibels(peaks)))
        _mark_missed_peaks(axes, speeds, peaks)
        levels = np.concatenate([dataset["sensor_rms"].sel(sensor=sensor).values.ravel(), peaks])
        levels = levels[np.isfinite(levels) & (levels > 0.0)]
        if levels.size:
            log_axis(axes, 0.8 * float(levels.min()), 1.25 * float(levels.max()))
        axes.set_ylabel(f"{rms} [m/s²]")
        panel_title(axes, sensor)
    _name_values(panels[-1].xaxis, dataset, along)
    name_lowest(panels, _axis_label(dataset, along))
    _name_lines(figure, dataset, places)
    return figure


def _mesh_forces(title: str, dataset: xr.Dataset, along: str, places: list[dict[str, int]]) -> Figure:
    contacts = [str(name) for name in dataset["contact"].values]
    below, count = _legend_height(places), len(contacts)
    height = HEAD + _FIRST + count * _FORCES + (count - 1) * _FORCES_GAP + FOOT + below
    parts = float(dataset["contact_loss"].max()) > 0.0
    note = f"{title}; solid: largest, dashed: mean" + ("" if parts else "; the teeth never part")
    figure = sheet(height, f"Gear-mesh force over {_key(dataset, along)}", note)
    for number, contact in enumerate(reversed(contacts)):
        bottom = FOOT + below + number * (_FORCES + _FORCES_GAP)
        panels = list(panel_pair(figure, bottom, _FORCES) if parts else (panel(figure, bottom, _FORCES),))
        left = panels[0]
        _draw_lines(left, dataset["mesh_force_peak"].sel(contact=contact), along, places)
        _draw_lines(left, dataset["mesh_force_mean"].sel(contact=contact), along, places, dashed=True)
        left.set_ylabel("mesh force [N]")
        left.set_ylim(0.0, 1.08 * float(dataset["mesh_force_peak"].sel(contact=contact).max()) or 1.0)
        panel_title(left, contact)
        if parts:
            right = panels[1]
            _draw_lines(right, 100.0 * dataset["contact_loss"].sel(contact=contact), along, places)
            right.set_ylabel("time apart [%]")
            right.set_ylim(0.0, max(1.08 * 100.0 * float(dataset["contact_loss"].sel(contact=contact).max()), 1.0))
        for axes in panels:
            if number:
                axes.tick_params(labelbottom=False)
            else:
                axes.set_xlabel(_axis_label(dataset, along))
                _name_values(axes.xaxis, dataset, along)
    _name_lines(figure, dataset, places)
    return figure


def _sound_levels(title: str, dataset: xr.Dataset, along: str, places: list[dict[str, int]]) -> Figure:
    """Draw the sound power level over the sweep; of one swept key also mesh harmonics and the loudest lines."""
    alone = len(places) == 1
    harmonics = _loudest_harmonics(dataset) if alone else []
    below = legend_height(1 + len(harmonics), _COLUMNS) if harmonics else _legend_height(places)
    lower = FOOT + below
    upper = lower + (_LINES + _FORCES_GAP if alone else 0.0)
    circles = _CIRCLES if alone and len(_missed_peaks(dataset, along, "sound")[0]) else ""
    note = f"{title}; sound power levels re 1 pW, solid: A-weighted, dashed: unweighted{circles}"
    figure = sheet(HEAD + _FIRST + upper + _FORCES, f"Sound over {_key(dataset, along)}", note)
    # Both have one width, with room for the scale of colours.
    width = PANEL_WIDTH - _SCALE if alone else PANEL_WIDTH
    axes = panel(figure, upper, _FORCES, width=width)
    _draw_lines(axes, dataset["sound_power_level_a"], along, places)
    _draw_lines(axes, dataset["sound_power_level"], along, places, dashed=True)
    at, order = _numbers(dataset, along), np.argsort(_numbers(dataset, along))
    for name, color in zip(harmonics, SERIES[1:], strict=False):
        level = dataset["mesh_harmonic_level"].sel(mesh_harmonic=name).values
        axes.plot(at[order], level[order], color=color, lw=0.9, ls=(0, (4, 3)), marker=".", ms=2.5)
    speeds, peaks = _missed_peaks(dataset, along, "sound") if alone else (np.empty(0), np.empty(0))
    _mark_missed_peaks(axes, speeds, peaks)
    axes.set_ylabel("sound power level [dB]")
    if alone:
        panel_title(axes, "all lines, and mesh harmonics" if harmonics else "all lines")
        axes.tick_params(labelbottom=False)
        limits = axes.get_xlim()
        axes = panel(figure, lower, _LINES, width=width)
        bar = panel(figure, lower, _LINES, left=LEFT + width + 3.0, width=3.0)
        _draw_loudest(axes, bar, dataset, along)
        axes.set_xlim(*limits)
    axes.set_xlabel(_axis_label(dataset, along))
    _name_values(axes.xaxis, dataset, along)
    if harmonics:
        names = ["all lines", *map(arrowed, harmonics)]
        handles = [
            Line2D([], [], color=c, lw=1.2, label=name_in_legend(name, 48))
            for c, name in zip(SERIES, names, strict=False)
        ]
        legend_below(figure, handles, _COLUMNS)
    _name_lines(figure, dataset, places)
    return figure


def _missed_peaks(dataset: xr.Dataset, along: str, output: str) -> tuple[FloatArray, FloatArray]:
    """Speeds [rpm] and estimated levels [dB] of the peaks of an output between the points."""
    if along != "speed" or "missed_peak_speed" not in dataset or dataset["speed"].attrs.get("units") != "rpm":
        return np.empty(0), np.empty(0)
    of_output = dataset["missed_peak_output"].values == output
    sign = np.sign(float(dataset["speed"].values[0]))
    return sign * dataset["missed_peak_speed"].values[of_output], dataset["missed_peak_level"].values[of_output]


def _mark_missed_peaks(axes: Any, speeds: FloatArray, values: FloatArray) -> None:
    if len(speeds):
        axes.plot(speeds, values, ls="", marker="o", ms=4.0, mfc="none", mec=INK, mew=0.7, zorder=4)


def _loudest_harmonics(dataset: xr.Dataset) -> list[str]:
    """Return the names of the mesh harmonics that are loudest anywhere, the loudest first."""
    if "mesh_harmonic_level" not in dataset:
        return []
    levels = dataset["mesh_harmonic_level"]
    highest = levels.max(dim=[name for name in levels.dims if name != "mesh_harmonic"]).values
    finite = np.flatnonzero(np.isfinite(highest))
    ranked = finite[np.argsort(-highest[finite], kind="stable")][:_HARMONICS]
    return [str(name) for name in dataset["mesh_harmonic"].values[ranked]]


def _draw_loudest(axes: Any, bar: Any, dataset: xr.Dataset, along: str) -> None:
    """Draw the frequencies of each point's loudest lines, coloured by their levels, and the orders of the meshes."""
    levels = dataset["sound_line_level"].transpose(along, "sound_line").values
    frequencies = dataset["sound_line_frequency"].transpose(along, "sound_line").values
    at = np.broadcast_to(_numbers(dataset, along)[:, None], levels.shape)
    # The quiet ones first, below the loud ones.
    order = np.argsort(levels, axis=None)[: int(np.isfinite(levels).sum())]
    color = levels.ravel()[order]
    low = max(float(color.min()), float(color.max()) - _RANGE_OF_COLOURS)
    points = axes.scatter(
        at.ravel()[order], frequencies.ravel()[order], c=color, cmap="viridis_r", vmin=low, s=12.0, lw=0.0, zorder=3
    )
    axes.figure.colorbar(points, cax=bar)
    bar.set_ylabel("sound power level [dB]", size=LABEL, color=INK)
    bar.yaxis.set_label_coords(3.6, 0.5)
    axes.set_ylabel("frequency [Hz]")
    highest = 1.06 * float(np.nanmax(frequencies))
    axes.set_ylim(0.0, highest)
    panel_title(axes, "loudest lines of each point")
    if along == "speed" and "mesh_frequency" in dataset:
        _draw_mesh_orders(axes, dataset, highest)


def _draw_mesh_orders(axes: Any, dataset: xr.Dataset, highest: float) -> None:
    """Draw the low multiples of each mesh frequency over the speed up to a frequency [Hz], numbered where they end."""
    speeds = _numbers(dataset, "speed")
    fastest = int(np.argmax(np.abs(speeds)))
    sense = float(np.sign(speeds[fastest]))
    drawn_orders = set[float]()
    for contact in dataset["contact"].values:
        mesh = dataset["mesh_frequency"].sel(contact=contact).transpose("speed").values
        for number in range(1, _ORDERS + 1):
            order = round(number * float(mesh[fastest] / np.abs(speeds[fastest])), 9)
            end = min(float(np.abs(speeds[fastest])), highest / order if order > 0.0 else 0.0)
            if not order > 0.0 or order in drawn_orders or end <= np.abs(speeds).min():
                continue
            drawn_orders.add(order)
            axes.plot([0.0, sense * end], [0.0, order * end], color=INK, lw=0.6, ls=(0, (4, 3)), alpha=0.5, zorder=1)
            axes.annotate(
                f"{number}×",
                (sense * end, order * end),
                xytext=(-2.0 * sense, -2.0),
                textcoords="offset points",
                ha="left" if sense < 0.0 else "right",
                va="top",
                size=NOTE,
                color=INK,
            )


def _waterfalls(
    title: str, dataset: xr.Dataset, along: str, places: list[dict[str, int]]
) -> Iterator[tuple[str, Figure]]:
    """Draw a waterfall for each sensor and each combination of the other keys that has a spectrum."""
    pictures = []
    for sensor, place in product([str(name) for name in dataset["sensor"].values], places):
        data = dataset.isel(place).transpose(along, ...)
        spectra = data["sensor_spectrum"].sel(sensor=sensor).transpose(along, "order").values
        if np.isfinite(spectra).any():
            pictures.append((sensor, place, data, spectra))
    pictures = pictures[:_MOST_WATERFALLS]
    names = [" ".join([sensor, *_described(dataset, place)]) for sensor, place, *_ in pictures]
    for stem, (sensor, place, data, spectra) in zip(file_stems(names, "waterfall-"), pictures, strict=True):
        figure = draw_waterfall(
            f"{sensor}: spectra over {_key(dataset, along)}",
            _numbers(data, along),
            data["frequency"].transpose(along, "order").values,
            spectra,
            value_name=_axis_label(dataset, along),
            unit="m/s²",
            note="; ".join([title, *_described(dataset, place)]),
            mesh_names=[str(contact) for contact in data["contact"].values] if "contact" in data else (),
            mesh_frequencies=data["mesh_frequency"].transpose(along, "contact").values if "contact" in data else (),
            housing_frequencies=(
                data["housing_frequency"].transpose(along, "housing_mode").values if "housing_mode" in data else ()
            ),
        )
        _name_values(figure.axes[0].yaxis, data, along)
        yield stem, figure


def _draw_lines(
    axes: Any, levels: xr.DataArray, along: str, places: list[dict[str, int]], *, dashed: bool = False
) -> None:
    at = _numbers(levels, along)
    order = np.argsort(at)
    for number, place in enumerate(places):
        values = levels.isel(place).values
        style = {"ls": (0, (4, 3)), "lw": 0.9} if dashed else {"ls": "-", "lw": 1.2}
        mark = "o" if len(at) <= _MARKS and not dashed else None
        axes.plot(at[order], values[order], color=SERIES[number % len(SERIES)], marker=mark, ms=3.0, **style)


def _legend_height(places: list[dict[str, int]]) -> float:
    """Height of the names of the lines [mm]; none where there is one line."""
    return legend_height(min(len(places), len(SERIES)), _COLUMNS) if len(places) > 1 else 0.0


def _name_lines(figure: Figure, dataset: xr.Dataset, places: list[dict[str, int]]) -> None:
    """Name the lines at the foot where there are several."""
    if len(places) > 1:
        _name_series(figure, [", ".join(_described(dataset, place)) for place in places[: len(SERIES)]])


def _name_series(figure: Figure, names: list[str]) -> None:
    handles = [
        Line2D([], [], color=color, lw=1.2, label=name_in_legend(name, 48))
        for color, name in zip(SERIES, names, strict=False)
    ]
    legend_below(figure, handles, _COLUMNS)


def _numbers(data: xr.Dataset | xr.DataArray, along: str) -> Any:
    """Return the swept values; where they are words, their positions."""
    values = data[along].values
    return values.astype(np.float64) if values.dtype.kind in "fiu" else np.arange(len(values), dtype=np.float64)


def _name_values(axis: Any, data: xr.Dataset, along: str) -> None:
    """Write words in place of numbers where the swept values are words."""
    values = data[along].values
    if values.dtype.kind not in "fiu":
        axis.set_ticks(range(len(values)), [str(value) for value in values])


def _axis_label(dataset: xr.Dataset, along: str) -> str:
    unit, name = _unit(dataset, along), _key(dataset, along)
    return f"{name} [{shown_product(unit)}]" if unit not in ("", "1") else name


def _unit(dataset: xr.Dataset, along: str) -> str:
    """Return the unit of a swept key as it is printed."""
    return str(dataset[along].attrs.get("units", "")).replace("*", "·").replace("um", "µm")


def _key(dataset: xr.Dataset, along: str) -> str:
    """Return the swept key in words."""
    return "speed" if along == "speed" else str(dataset[along].attrs.get("long_name", along))


def _described(dataset: xr.Dataset, place: dict[str, int]) -> list[str]:
    """Return a combination of the other keys in words."""
    texts = []
    for name, index in place.items():
        value, unit = dataset[name].values[index], _unit(dataset, name)
        last = dataset[name].attrs.get("long_name", name).rpartition(".")[2]
        value_text = f"{value:g}" if dataset[name].dtype.kind in "fiu" else str(value)
        texts.append(f"{last} {value_text}{f' {unit}' if unit not in ('', '1') else ''}")
    return texts
