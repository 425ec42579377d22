"""Figures of the sound show levels, directions and places as they were solved."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from sounding_box import sound_of_lines, sound_of_modes

from gearwhine.coupling.sound.solution import SolvedSound
from gearwhine.figures import draw_sound, draw_sweep
from gearwhine.housing.acoustics.sound_levels import a_weighting
from gearwhine.mode_pictures import _intensity_shapes, _radiating_surface, draw_sound_pictures


@pytest.fixture(scope="module")
def solved() -> SolvedSound:
    return sound_of_lines()


@pytest.fixture(scope="module")
def figures(solved: SolvedSound) -> dict[str, Figure]:
    return dict(draw_sound(sound_of_modes().case.title, solved))


def test_there_are_figures_of_what_was_solved(figures: dict[str, Figure]) -> None:
    assert list(figures) == ["sound-power", "sound-directivity", "sound-efficiency"]
    assert [name for name, _ in sound_of_modes().figures()] == ["sound-efficiency"]


def test_lines_stand_at_their_levels(solved: SolvedSound, figures: dict[str, Figure]) -> None:
    above, below = figures["sound-power"].axes
    powers = {line.frequency_hz: line.sound.power for line in solved.lines}
    levels = {hertz: 10.0 * np.log10(power / 1e-12) for hertz, power in powers.items()}
    shown = {hertz: level for hertz, level in levels.items() if level >= max(levels.values()) - 60.0}
    drawn = {line.get_label(): np.asarray(line.get_xydata()) for line in above.lines}
    assert 92.0 not in shown  # a box does not radiate there
    assert dict(drawn["_lines"].tolist()) == pytest.approx(shown)
    estimates = dict(drawn["_estimates"].tolist())
    for line in solved.lines:
        if line.frequency_hz in shown:
            ratio = 10.0 ** (0.1 * (levels[line.frequency_hz] - estimates[line.frequency_hz]))
            assert ratio == pytest.approx(line.sound.radiation_efficiency)
    (stems,) = [one for one in above.collections if isinstance(one, LineCollection)]
    assert sorted(path.vertices[1][0] for path in stems.get_paths()) == sorted(shown)
    named = {text.get_text() for text in above.texts}
    assert "2300 Hz 3× pinion→wheel" in named
    # Those that nobody hears beside the others have no name.
    assert not any(text.startswith(("92 ", "520 ", "1000 ")) for text in named)
    assert (
        f"together {solved.total_db:.1f} dB or {solved.total_db_a:.1f} dB(A)"
        in figures["sound-power"].texts[1].get_text()
    )
    # Third octaves sum the powers of their lines: 1560 and 1645 Hz are in that of 1.6 kHz.
    bars = {round(patch.get_x() + 0.4): patch.get_y() + patch.get_height() for patch in below.patches}
    names = [text.get_text() for text in below.get_xticklabels()]
    together = 10.0 * np.log10((powers[1560.0] + powers[1645.0]) / 1e-12)
    place = names.index("1.6 k")
    assert bars[place] == pytest.approx(together)
    (weighted,) = [one for one in below.collections if isinstance(one, LineCollection)]
    heights = {round(path.vertices[:, 0].mean()): path.vertices[0, 1] for path in weighted.get_paths()}
    audible = sum(powers[hertz] * 10.0 ** (0.1 * float(a_weighting(hertz))) for hertz in (1560.0, 1645.0))
    assert heights[place] == pytest.approx(10.0 * np.log10(audible / 1e-12))


def test_directivity_is_the_far_field_in_its_directions(solved: SolvedSound, figures: dict[str, Figure]) -> None:
    """Held against the pressure a hundred metres off, at the angle where each plane's labels put its axis."""
    loudest = max(solved.lines, key=lambda line: line.sound.power)
    middle = loudest.sound.fields[0].surface.points.mean(axis=0)
    axis = {"+x": (1, 0, 0), "−x": (-1, 0, 0), "+y": (0, 1, 0), "−y": (0, -1, 0), "+z": (0, 0, 1), "−z": (0, 0, -1)}
    planes = []
    for axes in figures["sound-directivity"].axes:
        curve = np.asarray(axes.lines[0].get_xydata())
        bottom = axes.get_ylim()[0]
        labels = {text.get_text(): tick for text, tick in zip(axes.get_xticklabels(), axes.get_xticks(), strict=True)}
        planes.append({name for name in labels if name})
        for name, angle in labels.items():
            if name:
                pressure = loudest.sound.pressure_at(middle + 100.0 * np.array([axis[name]], dtype=float))
                level = 20.0 * np.log10(100.0 * abs(pressure[0]) / np.sqrt(2.0) / 20e-6)
                drawn = curve[np.argmin(np.abs(curve[:, 0] - angle)), 1]
                assert drawn == pytest.approx(max(level, bottom), abs=0.1), name
    assert planes == [{"+x", "−x", "+z", "−z"}, {"+x", "−x", "+y", "−y"}, {"+y", "−y", "+z", "−z"}]


def test_efficiencies_are_those_of_modes_and_lines(solved: SolvedSound, figures: dict[str, Figure]) -> None:
    (axes,) = figures["sound-efficiency"].axes
    drawn = {line.get_label(): np.asarray(line.get_xydata()) for line in axes.lines}
    assert drawn["_modes"] == pytest.approx(
        np.array([(mode.frequency_hz, mode.radiation_efficiency) for mode in solved.modes])
    )
    assert dict(drawn["_lines"].tolist()) == pytest.approx(
        {line.frequency_hz: line.sound.radiation_efficiency for line in solved.lines if line.frequency_hz > 92.0}
    )
    assert (axes.get_yscale(), drawn["_one"][:, 1].tolist()) == ("log", [1.0, 1.0])
    low, high = axes.get_ylim()
    assert low < drawn["_lines"][:, 1].min() < drawn["_modes"][:, 1].max() < high


def test_efficiencies_of_one_decade_have_plain_numbers(solved: SolvedSound) -> None:
    modes = tuple(replace(mode, radiation_efficiency=0.3) for mode in solved.modes)
    of_modes = replace(solved.of_modes, modes=modes)
    figures = dict(draw_sound(sound_of_modes().case.title, replace(solved, of_modes=of_modes, lines=())))
    axes = figures["sound-efficiency"].axes[0]
    low, high = axes.get_ylim()
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    shown = [text.get_text() for text in axes.get_yticklabels() if low <= text.get_position()[1] <= high]
    assert shown == ["0.1", "0.2", "0.5", "1"]


def test_intensities_are_drawn_where_they_are(solved: SolvedSound, tmp_path: Path) -> None:
    """The mean over the surface is the power over the area, at the loudest lines and over all."""
    shapes = {shape.name: shape for shape in _intensity_shapes(solved)}
    loudest = sorted(solved.lines, key=lambda line: -line.sound.power)[:3]
    assert list(shapes) == ["sound-faces-all", *(f"sound-faces-{line.frequency_hz:.1f}Hz" for line in loudest)]
    surface = _radiating_surface(solved)
    areas = solved.radiation.elements[0].surface.areas
    share = np.bincount(surface.triangles.ravel(), np.repeat(areas, 3) / 3.0, len(surface.rest))
    for line in loudest:
        shape = shapes[f"sound-faces-{line.frequency_hz:.1f}Hz"]
        assert (shape.title, shape.quantity) == (f"Sound intensity at {line.frequency_hz:.0f} Hz", "Intensity [mW/m²]")
        level = 10.0 * np.log10(line.sound.power / 1e-12)
        assert shape.note == f"{level:.1f} dB re 1 pW; red radiates, blue absorbs. 2 % lie beyond the scale."
        assert shape.values is not None
        assert 1e-3 * shape.values @ share == pytest.approx(line.sound.surface_power)
        assert not shape.at(0.0).any()
    every = shapes["sound-faces-all"]
    assert (every.title, every.note[:5]) == ("Sound intensity, all lines", f"{solved.total_db:.1f}")
    assert every.values is not None
    assert 1e-3 * every.values @ share == pytest.approx(sum(line.sound.surface_power for line in solved.lines))
    # Nothing radiates where no lines do, and nothing is drawn.
    assert draw_sound_pictures(replace(solved, lines=()), tmp_path, lambda message, part=None: None) == []
    assert not list(tmp_path.iterdir())


def test_an_estimate_has_neither_directivity_nor_efficiency(solved: SolvedSound) -> None:
    estimate = replace(solved.radiation, method="erp")
    lines = tuple(
        replace(line, sound=estimate.solve(line.frequency_hz, line.sound.coordinates)) for line in solved.lines
    )
    case = sound_of_modes().case
    figures = dict(draw_sound(case.title, replace(solved, radiation=estimate, lines=lines)))
    assert list(figures) == ["sound-power"]
    shapes = _intensity_shapes(replace(solved, radiation=estimate, lines=lines))
    assert all(shape.values is not None and shape.values.min() >= 0.0 for shape in shapes)
    assert all("red radiates, the estimate absorbs nowhere." in shape.note for shape in shapes)
    assert "ERP, an estimate" not in {text.get_text() for text in figures["sound-power"].legends[0].get_texts()}


def swept_sound() -> xr.Dataset:
    """Four speeds in no order; two lines each, one of which is missing once."""
    speeds = np.array([3000.0, 1000.0, 2000.0, 4000.0])
    return xr.Dataset(
        {
            "done": ("speed", np.ones(4, dtype=bool)),
            "sound_power_level": ("speed", np.array([70.0, 50.0, 80.0, 60.0])),
            "sound_power_level_a": ("speed", np.array([71.0, 45.0, 80.0, 61.0])),
            "sound_line_frequency": (("speed", "sound_line"), np.outer(speeds, [1.0, 0.5])),
            "sound_line_level": (
                ("speed", "sound_line"),
                np.array([[70.0, 20.0], [50.0, np.nan], [80.0, 60.0], [60.0, 30.0]]),
            ),
        },
        {"speed": ("speed", speeds, {"units": "rpm"})},
    )


def test_a_sweep_shows_levels_and_loudest_lines_over_speed() -> None:
    figures = dict(draw_sweep("t", swept_sound()))
    assert list(figures) == ["sweep-sound"]
    above, below, bar = figures["sweep-sound"].axes
    solid, dashed = (np.asarray(line.get_xydata()).tolist() for line in above.lines)
    assert solid == [[1000.0, 45.0], [2000.0, 80.0], [3000.0, 71.0], [4000.0, 61.0]]
    assert [level for _, level in dashed] == [50.0, 80.0, 70.0, 60.0]
    (points,) = below.collections
    found = dict(zip(map(tuple, np.asarray(points.get_offsets()).tolist()), points.get_array().tolist(), strict=True))
    assert found == {
        (3000.0, 3000.0): 70.0,
        (3000.0, 1500.0): 20.0,
        (1000.0, 1000.0): 50.0,
        (2000.0, 2000.0): 80.0,
        (2000.0, 1000.0): 60.0,
        (4000.0, 4000.0): 60.0,
        (4000.0, 2000.0): 30.0,
    }
    assert points.get_array().tolist() == sorted(found.values())  # quiet ones lie below loud ones
    assert (below.get_xlabel(), bar.get_ylabel()) == ("speed [rpm]", "sound power level [dB]")


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_sweep_shows_its_loudest_mesh_harmonics_and_the_orders_of_its_meshes(sense: float) -> None:
    dataset = swept_sound()
    speeds = dataset["speed"].values
    dataset = dataset.assign_coords(speed=("speed", sense * speeds, dataset["speed"].attrs))
    names = [f"{number}× a -> b" for number in (1, 2, 3, 4)]
    levels = np.array([[60.0, 70.0, 40.0, 50.0]] * 4)
    levels[3, 1] = np.nan
    dataset = dataset.assign(
        mesh_harmonic_level=(("speed", "mesh_harmonic"), levels),
        mesh_frequency=(("speed", "contact"), speeds[:, None] * 0.5),
    ).assign_coords(mesh_harmonic=names, contact=["a -> b"])
    figure = dict(draw_sweep("t", dataset))["sweep-sound"]
    above, below, _ = figure.axes
    second, first, fourth = (np.asarray(line.get_ydata()).tolist()[:: int(sense)] for line in above.lines[2:])
    assert second == [70.0, 70.0, 70.0, pytest.approx(np.nan, nan_ok=True)]
    assert (first, fourth) == ([60.0] * 4, [50.0] * 4)
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert told == ["all lines", "2× a → b", "1× a → b", "4× a → b"]
    # The panel ends a little above the highest line, 4000 Hz; steeper orders leave it before the last speed.
    ends = {text.get_text(): text.xy for text in below.texts}
    assert ends["1×"] == (sense * 4000.0, 2000.0)
    assert ends["2×"] == (sense * 4000.0, 4000.0)
    assert ends["3×"] == (pytest.approx(sense * 4240.0 / 1.5), pytest.approx(4240.0))
    assert set(ends) == {"1×", "2×", "3×", "4×", "5×", "6×"}


def test_a_sweep_marks_the_peaks_that_its_points_pass_by() -> None:
    dataset = swept_sound()
    dataset["speed"].attrs["units"] = "rpm"
    dataset = dataset.assign(
        missed_peak_speed=("missed_peak", [1500.0, 2500.0, 3500.0]),
        missed_peak_level=("missed_peak", [85.0, 117.0, 90.0]),
        missed_peak_output=("missed_peak", ["sound", "roof", "sound"]),
    )
    figure = dict(draw_sweep("t", dataset))["sweep-sound"]
    (circles,) = [line for line in figure.axes[0].lines if line.get_markerfacecolor() == "none"]
    assert np.asarray(circles.get_xydata()).tolist() == [[1500.0, 85.0], [3500.0, 90.0]]
    assert any("circles: peaks that the points pass by" in text.get_text() for text in figure.texts)
    # Of a sensor its rms: 117 dB re 1 µm/s².
    dataset = dataset.assign(
        sensor_rms=(("speed", "sensor"), np.ones((4, 1))),
        sensor_spectrum=(("speed", "sensor", "order"), np.full((4, 1, 2), np.nan)),
    ).assign_coords(sensor=["roof"], order=[0.0, 1.0])
    rms = dict(draw_sweep("t", dataset))["sweep-rms"]
    (circles,) = [line for line in rms.axes[0].lines if line.get_markerfacecolor() == "none"]
    assert np.asarray(circles.get_xydata()).tolist() == [[2500.0, pytest.approx(10.0 ** (-0.15))]]
    plain = dict(draw_sweep("t", swept_sound()))["sweep-sound"]
    assert not any("circles" in text.get_text() for text in plain.texts)


def test_a_grid_of_several_keys_has_a_level_for_each_combination() -> None:
    torques = xr.DataArray([10.0, 20.0], dims="torque", attrs={"units": "N m"})
    dataset = xr.concat([swept_sound(), swept_sound() + 1.0], torques)
    dataset["done"] = dataset["done"].astype(bool)
    dataset["speed"].attrs["units"] = "rpm"
    (axes,) = dict(draw_sweep("t", dataset))["sweep-sound"].axes
    solid = [np.asarray(line.get_ydata()) for line in axes.lines if line.get_linestyle() == "-"]
    assert [values.max() for values in solid if len(values)] == [80.0, 81.0]
