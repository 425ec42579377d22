"""Pictures of signatures: what they show of signals whose content is known."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearwhine.coupling import SpeedProfile
from gearwhine.coupling.analyses.run_up import RunSignature
from gearwhine.coupling.analyses.signature import Contribution, TracedLine
from gearwhine.coupling.signals import LineName, order_map, resample_by_angle, spectrogram
from gearwhine.figures import save
from gearwhine.figures.gears.transmission_error import _name
from gearwhine.figures.machine.run_up import draw_order_slices, draw_run, draw_run_up_map
from gearwhine.figures.machine.transient import (
    between_samples,
    draw_contributions,
    draw_friction,
    draw_modal_coordinates,
    draw_orbits,
    outlined,
)


def test_run_up(tmp_path: Path) -> None:
    """Orders 1 and 28 through a resonance at 600 Hz: the slice of the latter is highest at 600/28 turns a second."""
    interval = 1e-4
    times = interval * np.arange(40_000)
    turning = SpeedProfile(np.array([0.0, 4.0]), np.array([0.5, 1.5]))
    turned, rates, _ = turning.at(times)
    hertz = 28.0 * 20.0 * rates
    swell = 1.0 / np.abs(600.0**2 - hertz**2 + 0.06j * 600.0 * hertz) * 600.0**2
    signal = swell * np.cos(2 * np.pi * 28.0 * 20.0 * turned) + 0.2 * np.cos(2 * np.pi * 20.0 * turned)
    orders = order_map(resample_by_angle(signal, times, turning, 20.0), turns=2, follow=[28.0, 1.0])
    figure = draw_order_slices("Run-up", orders, {"mesh": 28.0, "shaft": 1.0}, unit="m/s²")
    mesh, shaft = figure.axes[0].lines
    top = np.asarray(mesh.get_xdata())[np.argmax(mesh.get_ydata())]
    assert top == pytest.approx(60.0 * 600.0 / 28.0, rel=0.03)
    assert np.asarray(shaft.get_ydata()) == pytest.approx(20.0 * np.log10(0.2 / np.sqrt(2.0) / 1e-6), abs=0.5)
    save(figure, tmp_path / "orders.png")
    spectra = spectrogram(signal, interval, 1000, 2000, to_the_ends=True).up_to(1200.0)
    speeds = 60.0 * 20.0 * turning.at(spectra.times)[1]
    level_map = draw_run_up_map(
        "Run-up",
        spectra,
        speeds,
        unit="m/s²",
        note="cover",
        mesh_orders=[28.0],
        housing_frequencies=np.array([600.0]),
    )
    assert [text.get_text() for text in level_map.texts[:2]] == ["Run-up", "cover"]
    assert [axes.get_ylabel() for axes in level_map.axes if "dB" in axes.get_ylabel()] == ["level [dB re 1 µm/s²]"]
    save(level_map, tmp_path / "map.png")
    # Of 28 × 10 to 30 Hz the first two harmonics leave the panel at its top or right end, numbered there.
    labels = {text.get_text(): text for text in level_map.axes[0].texts}
    assert {"1×", "2×", "4×"} <= set(labels)
    axes = level_map.axes[0]
    (along,) = (text for text in level_map.texts if "Run-up" in text.get_text())
    for number in (2, 4):
        # A number at the right end stands where the order passes the end of the frequencies.
        _, height = axes.transAxes.inverted().transform(
            labels[f"{number}×"].get_transform().transform(labels[f"{number}×"].get_position())
        )
        rpm = axes.get_ylim()[0] + height * (axes.get_ylim()[1] - axes.get_ylim()[0])
        assert rpm == pytest.approx(60.0 * 1200.0 / (28.0 * number), rel=0.08), along
    assert level_map.axes[0].get_xlim()[1] == pytest.approx(1200.0)


def test_each_signal_of_a_run_has_its_map_and_orders_in_its_unit() -> None:
    """A run-down from 1800 to 600 rpm: 1 m/s² at order 28 of the sensor, 10 N at order 12 of the second pair."""
    times = 1e-4 * np.arange(40_000)
    turning = SpeedProfile(np.array([0.0, 4.0]), np.array([1.5, 0.5]))
    turns = 20.0 * turning.at(times)[0]
    of_sensor, of_pair = np.cos(2 * np.pi * 28.0 * turns), 10.0 * np.cos(2 * np.pi * 12.0 * turns)
    signals = {"top": of_sensor, "a -> b": of_pair}
    turned = {name: resample_by_angle(signal, times, turning, 20.0) for name, signal in signals.items()}
    orders = {name: order_map(one, turns=2, follow=[28.0, 12.0]) for name, one in turned.items()}
    complete = {
        order: np.where(orders["top"].speeds * order < 700.0, course, np.nan)
        for order, course in orders["top"].followed.items()
    }
    orders["top"] = replace(orders["top"], followed=complete)
    spectra = {
        name: spectrogram(signal, 1e-4, 1000, 2000, to_the_ends=True).up_to(1200.0) for name, signal in signals.items()
    }
    rates = turning.at(spectra["top"].times)[1]
    meshes = [
        SimpleNamespace(driver=SimpleNamespace(name=driver), driven=SimpleNamespace(name=driven))
        for driver, driven in (("p", "w"), ("a", "b"))
    ]
    contacts = [SimpleNamespace(mesh_frequency=frequency) for frequency in (560.0, -240.0, 560.0, -240.0)]
    housing = SimpleNamespace(frequencies_hz=np.array([450.0]))
    machine = SimpleNamespace(meshes=meshes, system=SimpleNamespace(contacts=contacts), housing=housing)
    solved: Any = SimpleNamespace(machine=machine, speed=-2.0 * np.pi * 20.0, free_run=False)
    run = RunSignature(
        {"top": "m/s²", "a -> b": "N"},
        spectra,
        60.0 * 20.0 * rates,
        {name: np.full(rates.size, size / np.sqrt(2.0)) for name, size in (("top", 1.0), ("a -> b", 10.0))},
        orders,
        {"1× p -> w": 28.0, "1× a -> b": 12.0},
        2,
        700.0,
    )
    figures = dict(draw_run("Gearbox", solved, run))
    assert list(figures) == ["run-up-map-top", "run-up-orders-top", "run-up-map-a-b", "run-up-orders-a-b"]
    for stem, title, order, unit, level in (("top", "top", 28, "m/s²", 117.0), ("a-b", "a → b", 12, "N", 137.0)):
        level_map, slices = figures[f"run-up-map-{stem}"], figures[f"run-up-orders-{stem}"]
        titles = [
            [text.get_text().replace("\N{NO-BREAK SPACE}", " ") for text in one.texts[:2]]
            for one in (level_map, slices)
        ]
        assert [heading for heading, _ in titles] == [f"{title}: level over frequency and speed", f"{title}: orders"]
        notes = [note for _, note in titles]
        assert all(note.startswith("Gearbox; run-down, spectra from 1") for note in notes)
        assert ["up to 700 Hz" in note for note in notes] == [False, stem == "top"]
        assert f"level [dB re 1 µ{unit}]" in [axes.get_ylabel() for axes in level_map.axes]
        (axes,) = slices.axes
        assert axes.get_ylabel() == f"level [dB re 1 µ{unit}]"
        curve, overall = axes.lines
        assert str(curve.get_label()).replace("\N{NO-BREAK SPACE}", " ") == f"1× {'p → w' if order == 28 else 'a → b'}"
        assert np.nanmedian(np.asarray(curve.get_ydata())) == pytest.approx(level, abs=0.3)
        assert np.asarray(overall.get_ydata()) == pytest.approx(level, abs=0.1)
        dashed = [np.asarray(one.get_xdata()) for one in level_map.axes[0].lines if one.get_linestyle() == "--"]
        for mesh in (28.0, 12.0):
            course = np.sort(20.0 * rates * mesh)
            assert any(one.shape == course.shape and np.allclose(np.sort(one), course) for one in dashed)


def test_an_order_below_the_axis_has_no_name_in_the_legend() -> None:
    """Five decades are shown: an order of a millionth of another is no line; what is not known of one is a gap."""
    times = 1e-4 * np.arange(40_000)
    turning = SpeedProfile(np.array([0.0, 4.0]), np.array([0.5, 1.5]))
    turns = 20.0 * turning.at(times)[0]
    signal = (
        np.cos(2 * np.pi * 28.0 * turns) + 1e-4 * np.cos(2 * np.pi * turns) + 1e-6 * np.cos(2 * np.pi * 9.0 * turns)
    )
    names = {"mesh": 28.0, "shaft": 1.0, "faint": 9.0, "beyond": 60.0}
    turned = resample_by_angle(signal, times, turning, 20.0)
    orders = order_map(turned, turns=2, follow=list(names.values()))
    followed = {
        order: np.where(orders.speeds * order < 500.0, course, np.nan) for order, course in orders.followed.items()
    }
    orders = replace(orders, followed=followed)
    figure = draw_order_slices("Run-up", orders, names, unit="m/s²")
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["mesh", "shaft"]
    mesh, _ = figure.axes[0].lines
    known = np.isfinite(np.asarray(mesh.get_ydata(), dtype=float))
    assert known.any()
    np.testing.assert_array_equal(known, 28.0 * orders.speeds < 500.0)
    nothing = replace(orders, followed={order: np.full_like(course, np.nan) for order, course in followed.items()})
    assert not draw_order_slices("Run-up", nothing, names, unit="m/s²").axes[0].lines


def test_orbits_stand_where_the_shaft_rests(tmp_path: Path) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    circle = 1e-6 * np.column_stack([30.0 + 2.0 * np.cos(angle), -10.0 + np.sin(angle), angle])
    figure = draw_orbits("$x", {"pinion": circle, "wheel": -circle})
    above, _, below, _ = figure.axes
    assert np.asarray(above.lines[-1].get_xdata()).mean() == pytest.approx(30.0)
    assert np.abs(np.asarray(below.lines[0].get_xdata())).max() == pytest.approx(2.0)
    assert above.get_title(loc="left") == "pinion"
    assert below.get_title(loc="left") == "mean 30.0, -10.0 µm\n± 2, 1 µm"
    save(figure, tmp_path / "orbits.png")


def test_a_run_that_settles_is_drawn_over_time(tmp_path: Path) -> None:
    """Spectra and windows at one speed would lie on each other over the speed."""
    times = 1e-4 * np.arange(40_000)
    turning = SpeedProfile(np.array([0.0, 1.0, 4.0]), np.array([0.5, 1.0, 1.0]))
    signal = np.cos(2 * np.pi * 28.0 * 20.0 * turning.at(times)[0])
    orders = order_map(resample_by_angle(signal, times, turning, 20.0), turns=2)
    figure = draw_order_slices("Free run", orders, {"mesh": 28.0}, unit="m/s²")
    (axes,) = figure.axes
    assert axes.get_xlabel() == "time [s]"
    np.testing.assert_allclose(np.asarray(axes.lines[0].get_xdata()), orders.times)
    spectra = spectrogram(signal, 1e-4, 1000, 2000, to_the_ends=True).up_to(1200.0)
    speeds = 60.0 * 20.0 * turning.at(spectra.times)[1]
    level_map = draw_run_up_map("Free run", spectra, speeds, unit="m/s²", mesh_orders=[28.0])
    axes = level_map.axes[0]
    assert axes.get_ylabel() == "time [s]"
    # The mesh order follows the speed, and stands still with it.
    (mesh,) = (line for line in axes.lines if line.get_linestyle() == "--" and line.get_xdata()[-1] == 560.0)
    np.testing.assert_allclose(mesh.get_xdata(), 28.0 / 60.0 * speeds)
    save(level_map, tmp_path / "map.png")


def test_bars_are_the_shares(tmp_path: Path) -> None:
    line = TracedLine(
        frequency=2567.0,
        value=2.0,
        named=LineName("mesh", "1× pinion -> wheel", 28.0, None),
        modes=tuple(Contribution(f"housing mode {i}", 2.0 * share, share, i) for i, share in enumerate([1.4, -0.4], 1)),
        bearings=(Contribution("front", 1.8, 0.9),),
        free=Contribution("free vibration", 0.2, 0.1),
    )
    figure = draw_contributions("$1", {"top": (line,)})
    widths = [[bar.get_width() for bar in axes.patches] for axes in figure.axes]
    assert widths[0] == pytest.approx([140.0, -40.0])
    assert widths[1] == pytest.approx([90.0, 10.0])
    assert [text.get_text() for text in figure.axes[0].texts] == ["140", "-40"]
    # Ranked by the shares that the bars show, whatever stands a quarter period beside them.
    beside = Contribution("beside", 5.0j, 0.0)
    figure = draw_contributions("$1", {"top": (replace(line, modes=(beside, *line.modes), bearings=(beside,) * 6),)})
    widths = [[bar.get_width() for bar in axes.patches] for axes in figure.axes]
    assert widths[0] == pytest.approx([140.0, -40.0, 0.0])
    assert widths[1] == pytest.approx([10.0, 0.0, 0.0, 0.0, 0.0, 0.0][: len(widths[1])])
    save(figure, tmp_path / "contributions.png")
    # Of many sensors the highest lines alone are drawn: the sheet stays a page.
    many = {f"sensor {number}": tuple(replace(line, value=10.0 * number + i) for i in range(3)) for number in range(20)}
    figure = draw_contributions("$1", many)
    assert figure.get_figheight() * 25.4 < 400.0
    drawn = {text.get_text().partition(":")[0] for text in figure.texts}
    assert {f"sensor {number}" for number in range(12, 20)} <= drawn
    assert "sensor 0" not in drawn


def test_every_pair_of_teeth_has_a_name_of_its_own() -> None:
    names = [_name(before) for before in range(-3, 4)]
    assert len(set(names)) == len(names)
    assert _name(-1) == "pair that follows"


def test_a_long_record_keeps_its_extremes_and_gains_no_frequency() -> None:
    """A wave of 7 samples to a period, of which every seventh would be a line that stands still."""
    times = np.arange(70_001) / 70_000.0
    wave = np.sin(2.0 * np.pi * 10_000.0 * times)
    wave[33_333] = 5.0
    at, drawn = outlined(times, wave, 6000)
    assert len(at) <= 6000
    assert (np.diff(at) > 0.0).all()
    assert drawn.max() == 5.0
    assert np.interp(at, times, wave) == pytest.approx(drawn)
    lows, highs = (pick(drawn[: len(drawn) // 20 * 20].reshape(-1, 20), axis=1) for pick in (np.min, np.max))
    assert lows.max() < -0.97
    assert highs.min() > 0.97
    np.testing.assert_array_equal(outlined(times[:100], wave[:100], 100)[1], wave[:100])


def test_a_curve_between_samples_is_the_signal_s_own() -> None:
    """Five samples to a period: the peaks lie between them, and straight lines would miss them by a tenth."""
    times = 1e-3 * np.arange(400)
    signal = 3.0 + np.cos(2.0 * np.pi * 199.0 * times) + 0.3 * np.sin(2.0 * np.pi * 97.0 * times)
    at, values = between_samples(times, signal, 0.03, 1.0 / 199.0)
    assert at[-1] == pytest.approx(0.03)
    assert np.diff(at).max() <= 1.0 / 199.0 / 40.0
    exact = 3.0 + np.cos(2.0 * np.pi * 199.0 * at) + 0.3 * np.sin(2.0 * np.pi * 97.0 * at)
    # Nothing is known before the first sample: the first period is less exact.
    assert values[at > 0.01] == pytest.approx(exact[at > 0.01], abs=0.02)
    assert np.interp(times[:31], at, values) == pytest.approx(signal[:31], abs=1e-9)


def test_modal_coordinates_are_told_with_their_fixed_part(tmp_path: Path) -> None:
    times = 1e-3 * np.arange(1000)
    wave = np.cos(2 * np.pi * 50.0 * times)
    named = {"input: torsion 1": 3.0 + np.sqrt(2.0) * wave, "input: torsion 2": 0.0 * wave, "input: bending 1, x": wave}
    figure = draw_modal_coordinates("A case", times, named, 200.0, "uniform")
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles == ["input: torsion over time", "peak amplitudes", "input: bending, x over time", "peak amplitudes"]
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert legend.get_texts()[0].get_text() == "mode 1: d.c. 3.00e+00, a.c. 1.0e+00 rms"
    save(figure, tmp_path / "modal.png")


def test_friction_of_each_pair_has_its_force_and_its_power() -> None:
    """Two pairs of other mesh frequencies, whose records are lines through time: six of their periods are drawn."""
    times = 2.0 + 1e-5 * np.arange(20_000)
    records = {
        name: np.column_stack([force * (times - 2.0), np.full(times.size, power)])
        for name, force, power in (("a -> b", 3.0, 40.0), ("c -> d", -5.0, 90.0))
    }
    histories: Any = SimpleNamespace(times=times, mesh_friction=records)
    figure = draw_friction("Friction", histories, {"c -> d": 100.0, "a -> b": 250.0}, note="Machine, 3000 rpm")
    assert [text.get_text() for text in figure.texts[:2]] == ["Friction", "Machine, 3000 rpm"]
    shown = {axes.get_title(loc="left"): axes for axes in figure.axes}
    for name, period, slope, power in (("a → b", 4.0, 3.0, 40.0), ("c → d", 10.0, -5.0, 90.0)):
        force = shown[f"{name}: across the line of action"]
        below = figure.axes[figure.axes.index(force) + 1]
        assert below.get_title(loc="left") == f"{power:g} W in the mean"
        assert (force.get_ylabel(), below.get_ylabel()) == ("friction force [N]", "power that friction takes [W]")
        assert force.get_xlabel() == below.get_xlabel() == "time [ms]"
        assert force.get_xlim() == below.get_xlim() == pytest.approx((0.0, 6.0 * period))
        at, values = force.lines[0].get_data()
        np.testing.assert_allclose(values, slope * 1e-3 * np.asarray(at), atol=1e-9)
        np.testing.assert_allclose(below.lines[0].get_ydata(), power)
