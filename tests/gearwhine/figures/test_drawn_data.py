"""What figures of a motion and of made-up curves draw: the data, their order and units, names beside their own."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, NamedTuple, cast

import numpy as np
import pytest
from coupled_cases import coupled
from lopsided_case import PAIRS, lopsided
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from gearwhine.case import load_case
from gearwhine.coupling.analyses.modes_and_responses import solve_system
from gearwhine.coupling.analyses.signature import SolvedSignature, solve_signature
from gearwhine.coupling.analyses.steady_state import SolvedSteady, SteadyMotion
from gearwhine.coupling.analyses.transient import SolvedTransient, solve_transient
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.gears.loaded.transmission_error import along_one_pair
from gearwhine.coupling.linear.frequency_response import FrequencyResponse
from gearwhine.coupling.periodic.superposition import ExcitationGroup
from gearwhine.figures import draw_campbell, draw_transient
from gearwhine.figures.gears.contact import draw_contact_path
from gearwhine.figures.gears.transmission_error import draw_harris_map, draw_transmission_error
from gearwhine.figures.machine.operating_point import draw_over_torque
from gearwhine.figures.machine.steady_state import _motion_sheet
from gearwhine.figures.machine.system import draw_transmissibility
from gearwhine.figures.machine.transient import draw_sensor_spectra
from gearwhine.figures.style import BLUE, GREY
from gearwhine.from_case.machine import solve_gears
from gearwhine.rotors import Campbell
from gearwhine.solve.housing_modes import solve_housing
from gearwhine.solve.machine import plan_of


class Drawn(NamedTuple):
    """A motion, its lines, and the figures of it by their files' names."""

    solved: SolvedTransient
    signature: SolvedSignature
    figures: dict[str, Figure]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Drawn:
    folder = tmp_path_factory.mktemp("lopsided")
    path = folder / "lopsided.toml"
    transient = "[transient]\nrevolutions = 4\ndiscard = 2\npoints_per_revolution = 200\ntolerance = 5e-3\n"
    path.write_text(lopsided(more=transient), encoding="utf-8")
    case = load_case(str(path)).case
    housing = solve_housing(case)
    machine = coupled(case, housing)
    solved = solve_transient(machine, plan_of(case))
    modes = solve_system(machine).modes
    signature = solve_signature(solved, modes, housing.modes.frequencies_hz)
    figures = {f"{name}.png": figure for name, figure in draw_transient(case.title, solved, signature, housing, None)}
    return Drawn(solved, signature, figures)


def panels(figure: Figure) -> list[Axes]:
    """From the top, each place once: a second axis beside one is left out."""
    found: dict[tuple[float, float], Axes] = {}
    for axes in figure.axes:
        place = axes.get_position()
        found.setdefault((-round(place.y0, 6), round(place.x0, 6)), axes)
    return [found[place] for place in sorted(found)]


def heights(axes: Axes) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and amplitudes of the lines of a spectrum: one path broken between them, or a curve where many."""
    lines = [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata(), dtype=float)) for line in axes.get_lines()]
    broken = [line for line in lines if np.isnan(line[1]).any()]
    if not broken:
        return max(lines, key=lambda line: line[0].size)
    ((frequencies, amplitudes),) = broken
    return frequencies[1::3], amplitudes[1::3]


def test_each_sensor_s_spectrum_stands_in_its_own_panel(drawn: Drawn) -> None:
    figure = drawn.figures["spectrum.png"]
    assert "3000 rpm, 45 N·m" in "".join(text.get_text() for text in figure.texts)
    shown = panels(figure)
    assert len(shown) == 2
    (row,) = (axes for axes in figure.axes if axes.texts)  # of names, above all panels
    leaders = [line for line in row.get_lines() if line.get_linewidth() == 0.5]
    named = {
        round(float(row.transData.inverted().transform(line.get_transform().transform(line.get_xydata()[0]))[0]), 6)
        for line in leaders
    }
    assert len(named) == len(row.texts)
    # Names begin with their frequency, to the hertz.
    said = sorted(float(text.get_text().split(" Hz ")[0]) for text in row.texts)
    assert said == pytest.approx(sorted(named), abs=0.51)
    for axes, (name, spectrum) in zip(shown, drawn.solved.sensor_spectra.items(), strict=True):
        assert axes.get_title(loc="left") == name
        frequencies, amplitude = heights(axes)
        inside = (spectrum.frequencies > 0.0) & (spectrum.frequencies <= drawn.solved.trusted_limit)
        assert frequencies == pytest.approx(spectrum.frequencies[inside])
        top = spectrum.amplitude[inside].max()
        assert amplitude == pytest.approx(np.maximum(spectrum.amplitude[inside], 1e-5 * top))
        (beside,) = (one for one in figure.axes if one not in (axes, row) and one.bbox.bounds == axes.bbox.bounds)
        assert beside.get_ylabel() == "level [dB]"
        low, high = axes.get_ylim()
        assert beside.get_ylim() == pytest.approx([20.0 * np.log10(a / np.sqrt(2.0) / 1e-6) for a in (low, high)])
        assert axes.get_ylabel() == "acceleration [m/s²]"
        marked = {
            round(float(np.asarray(line.get_xdata())[0]), 3)
            for line in axes.get_lines()
            if line.get_linestyle() == "--" and len(np.asarray(line.get_xdata())) == 2
        }
        assert {round(n * 1150.0, 3) for n in (1, 2)} <= marked
        (triangles,) = (line for line in axes.get_lines() if line.get_marker() == "^")
        modes = drawn.solved.machine.housing.frequencies_hz  # type: ignore[union-attr]
        assert np.asarray(triangles.get_xdata()) == pytest.approx(modes[modes <= drawn.solved.trusted_limit])
        assert modes[0] < drawn.solved.trusted_limit
        # A dot stands on each leading line, whose frequency has a name above.
        (dots,) = (line for line in axes.get_lines() if line.get_marker() == "o")
        told = drawn.signature.lines[name][: len(dots.get_xydata())]
        assert dots.get_xydata() == pytest.approx(np.array([[line.frequency, abs(line.value)] for line in told]))
        # A tone of two sensors has one name.
        assert all(min(abs(line.frequency - place) for place in named) < 0.1 * spectrum.spacing for line in told)
    assert shown[-1].get_xlabel() == "frequency [Hz]"


def test_a_line_of_two_sensors_is_named_once_where_their_spectra_round_it_to_two_hertz(drawn: Drawn) -> None:
    first, second = drawn.signature.lines
    lines = drawn.signature.lines[first][:3]
    rounded = [np.floor(line.frequency) + 0.5 for line in lines]
    near = {
        first: tuple(replace(line, frequency=at - 0.1) for line, at in zip(lines, rounded, strict=True)),
        second: tuple(replace(line, frequency=at + 0.1) for line, at in zip(lines, rounded, strict=True)),
    }
    figure = draw_sensor_spectra("Names", drawn.solved, near, marked=np.zeros(0))
    (row,) = (axes for axes in figure.axes if axes.texts)
    assert len(row.texts) == len(lines)


def test_each_pair_s_force_stands_in_its_own_row(drawn: Drawn) -> None:
    figure = drawn.figures["mesh-force.png"]
    assert any(text.get_text().endswith("3000 rpm, 45 N·m") for text in figure.texts)
    figure.canvas.draw()
    rows = figure.axes
    times = drawn.solved.histories.times
    for number, (pair, hertz) in enumerate(zip(PAIRS, (1150.0, 1150.0 * 21 / 47), strict=True)):
        name = " -> ".join(pair)
        left, right = rows[2 * number : 2 * number + 2]
        assert left.get_title(loc="left") == f"{' → '.join(pair)}: six mesh periods"
        (line,) = left.get_lines()
        x, y = (np.asarray(data) for data in line.get_data())
        assert x[0] == 0.0
        assert x[-1] == pytest.approx(6e3 / hertz, abs=1e3 * (times[1] - times[0]))
        assert (left.get_xlabel(), left.get_ylabel()) == ("time [ms]", "mesh force [N]")
        # The curve goes through the samples, and has 40 points to a mesh period or more.
        force = drawn.solved.histories.mesh_force[name]
        factor = round((times[1] - times[0]) / (1e-3 * (x[1] - x[0])))
        assert x[1] - x[0] <= 1e3 / hertz / 40.0
        np.testing.assert_allclose(y[::factor], force[: len(y[::factor])], rtol=1e-9)
        frequencies, amplitude = heights(right)
        spectrum = drawn.solved.force_spectra[name]
        assert amplitude.max() == pytest.approx(
            spectrum.amplitude[1:][spectrum.frequencies[1:] <= frequencies[-1]].max()
        )


def test_orbits_show_x_across_and_y_up(drawn: Drawn) -> None:
    figure = drawn.figures["orbits.png"]
    names = list(drawn.solved.histories.gear_motion)
    for column, name in enumerate(names):
        above, below = figure.axes[column], figure.axes[column + len(names)]
        motion = 1e6 * drawn.solved.histories.gear_motion[name][:, :2]
        assert above.get_title(loc="left") == name
        orbit = np.asarray(above.get_lines()[-1].get_xydata())
        # All samples, and points between them where a mesh period has few.
        factor = (len(orbit) - 1) // (len(motion) - 1)
        np.testing.assert_allclose(orbit[::factor], motion, rtol=1e-9)
        mean = orbit.mean(axis=0)
        np.testing.assert_allclose(mean, motion.mean(axis=0), atol=1e-3 * np.ptp(motion))
        np.testing.assert_allclose(below.get_lines()[0].get_xydata(), orbit - mean, atol=1e-9)
        # The arrow goes from where the gear stands without load.
        (arrow,) = (text for text in above.texts if getattr(text, "arrow_patch", None) is not None)
        np.testing.assert_allclose(arrow.xy, mean)
        assert arrow.get_position() == (0.0, 0.0)


def test_bars_of_a_line_stand_under_its_name_the_largest_on_top(drawn: Drawn) -> None:
    figure = drawn.figures["contributions.png"]
    headings = [text for text in figure.texts if " m/s² peak, " in text.get_text()]
    expected = [(name, line) for name, lines in drawn.signature.lines.items() for line in lines[:3]]
    assert len(headings) == len(expected)
    for text, (name, line) in zip(sorted(headings, key=lambda text: -text.get_position()[1]), expected, strict=True):
        assert text.get_text().startswith(f"{name}: {line.frequency:.0f} Hz, {abs(line.value):.3g} m/s² peak")
        (left, *_) = sorted(
            (axes for axes in figure.axes if axes.get_position().y1 < text.get_position()[1]),
            key=lambda axes: (-axes.get_position().y0, axes.get_position().x0),
        )
        bars = left.patches
        largest = sorted(line.modes, key=lambda part: -abs(part.share))[:6]
        assert [bar.get_width() for bar in bars][:6] == pytest.approx([100.0 * part.share for part in largest])
        low, high = left.get_ylim()
        assert low > high  # the first bar is the uppermost


def test_bearing_forces_over_frequency_are_of_both_directions() -> None:
    w = 2.0 * np.pi * np.linspace(10.0, 1000.0, 50)
    load = np.zeros((50, 5), dtype=complex)
    load[:, 0], load[:, 1] = 3e6, 4e6j
    error, flat = "transmission error of m", np.ones(50, dtype=complex)
    response = FrequencyResponse(
        error, "m", w, np.zeros((50, 1), dtype=complex), {"top": 2e6 * flat}, {"left": load}, {"m": 7e6 * flat}
    )
    shown = {axes.get_ylabel(): axes for axes in draw_transmissibility("t", response).axes}
    assert list(shown) == ["acceleration [m/s²/µm]", "bearing force [N/µm]", "mesh force [N/µm]"]
    for label, value in zip(shown, (2.0, 5.0, 7.0), strict=True):
        assert np.asarray(shown[label].get_lines()[0].get_ydata()) == pytest.approx(value)
    tops = [axes.get_position().y0 for axes in shown.values()]
    assert tops == sorted(tops)


def test_forward_critical_speeds_are_filled_and_backward_ones_open() -> None:
    speeds = np.linspace(0.0, 400.0, 21)
    frequencies = np.column_stack([200.0 - 0.1 * speeds, 200.0 + 0.1 * speeds])
    directions = np.column_stack([-np.ones(21), np.ones(21)])
    nothing: Any = None
    figure = draw_campbell(
        "t",
        Campbell(speeds, 1j * frequencies, directions, 0.0 * directions, speeds < 0.0, nothing, ()),
        critical_speeds=[180.0, 222.0],
        critical_directions=[-1, 1],
    )
    backward, forward = (line for line in figure.axes[0].get_lines() if line.get_label() == "critical")
    assert backward.get_markerfacecolor() == "white"
    assert forward.get_markerfacecolor() == forward.get_color() != "white"


def test_the_quietest_torque_and_the_one_of_operation_are_marked() -> None:
    phases = np.linspace(0.0, 1.0, 50, endpoint=False)
    sizes = np.array([3.0, 1.0, 2.0, 4.0])
    forces = np.array([1000.0, 2000.0, 3000.0, 4000.0])
    harris: Any = SimpleNamespace(
        forces=forces,
        phases=phases,
        transmission_error=1e-6 * sizes[:, None] * np.cos(2.0 * np.pi * phases) / 2.0,
        peak_to_peak=1e-6 * sizes,
    )
    figure = draw_harris_map("h", harris, 0.02, torque=50.0)
    lower = figure.axes[1]
    (quiet,) = (line for line in lower.get_lines() if line.get_label() == "_quietest")
    assert [float(np.ravel(part)[0]) for part in quiet.get_data()] == pytest.approx([40.0, 1.0])
    assert any("quietest of these torques: 40 N·m with 1.000 µm" in text.get_text() for text in figure.texts)
    # Halfway between 40 and 60 N·m.
    assert "1.500 µm" in [text.get_text() for text in lower.texts]


def test_each_pair_s_curve_over_torque_stands_in_the_panel_of_its_quantity() -> None:
    """Two pairs that carry and an idle one, at three torques of a brake; every value is of its own."""
    torques = (-30.0, -60.0, -90.0)

    def pair(name: str, size: float, torque: float, force: float = 100.0) -> Any:
        gears = SimpleNamespace(driver=SimpleNamespace(name=name), driven=SimpleNamespace(name=f"{name} wheel"))
        errors = 1e-6 * size * torque * np.array([0.0, 0.25, 1.0])
        given = {"mean_stiffness": 2e6 * size * torque, "k_h_beta": 3.0 * size * torque}
        given |= {"transmission_error": errors, "misalignment": 4e-6 * size * torque}
        return SimpleNamespace(pair=gears, force=force, **given)

    def pairs(torque: float) -> Any:
        given = pair("first", 1.0, torque), pair("idle", 10.0, torque, 0.0), pair("second", 7.0, torque)
        return SimpleNamespace(pairs=given)

    over_torque = {torque: pairs(torque) for torque in torques}
    solved: Any = SimpleNamespace(
        over_torque=over_torque, point=over_torque[-60.0], machine=SimpleNamespace(torque=-60.0)
    )
    figure = draw_over_torque("r", solved)
    panels = {axes.get_ylabel(): axes for axes in figure.axes}
    sizes = {"TE p-p [µm]": -1.0, "stiffness [N/µm]": 2.0, "K_Hβ": 3.0, "misalignment [µrad]": 4.0}
    assert panels.keys() == sizes.keys()
    for label, axes in panels.items():
        first, second, operation, *_ = axes.get_lines()
        for curve, name, size in ((first, "first → first wheel", 1.0), (second, "second → second wheel", 7.0)):
            assert str(curve.get_label()).replace("\N{NO-BREAK SPACE}", " ") == name
            assert curve.get_xdata() == pytest.approx(torques)
            assert curve.get_ydata() == pytest.approx([sizes[label] * size * torque for torque in torques])
        assert first.get_color() != second.get_color()
        assert list(operation.get_xdata()) == [-60.0, -60.0]
        assert axes.get_xlim() == (-90.0, 0.0)
    assert [axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()] == ["torque of the first driver [N·m]"]
    assert len(figure.legends[0].get_texts()) == 2


def test_bars_with_and_without_load_have_the_curves_colours() -> None:
    phases = np.linspace(0.0, 1.0, 50, endpoint=False)
    loaded: Any = SimpleNamespace(phases=phases, transmission_error=1e-6 * np.cos(2 * np.pi * phases), force=100.0)
    harmonics = {"unloaded": np.array([1e-6, 2e-6]), "loaded": np.array([3e-6, 4e-6])}
    upper, bars = draw_transmission_error(
        "t", phases, 0.5e-6 * np.cos(2 * np.pi * phases), harmonics, loaded=loaded
    ).axes
    colours = {line.get_label(): line.get_color() for line in upper.get_lines()}
    assert colours["without load"] == GREY
    assert colours["under 100 N"] == BLUE
    for container, colour, values in zip(bars.containers, (GREY, BLUE), ([1.0, 2.0], [3.0, 4.0]), strict=True):
        assert [bar.get_height() for bar in container] == pytest.approx(values)
        assert {tuple(bar.get_facecolor()) for bar in container} == {to_rgba(colour)}
    # The two bars of a harmonic stand on either side of its number.
    middles = np.array([[bar.get_x() + 0.5 * bar.get_width() for bar in container] for container in bars.containers])
    np.testing.assert_allclose(middles.mean(axis=0), [1.0, 2.0])
    assert (middles[0] < middles[1]).all()
    # Bars of nothing take no room beside the others.
    harmonics["unloaded"] = np.array([1e-18, 0.0])
    _, bars = draw_transmission_error("t", phases, 0.0 * phases, harmonics, loaded=loaded).axes
    (container,) = bars.containers
    assert [bar.get_x() + 0.5 * bar.get_width() for bar in container] == pytest.approx([1.0, 2.0])


def test_the_driver_slides_backwards_where_it_begins() -> None:
    case = load_case("spur-pair").case
    (pair,) = solve_gears(case.parts)
    mesh = pair.static
    pressure = mesh_pressure(pair.geometry, pair.contact, mesh)
    figure = draw_contact_path("p", pair.geometry, pair.contact, along_one_pair(pair.contact, mesh), pressure)
    _, press, sliding = figure.axes
    curves = {line.get_label(): np.asarray(line.get_ydata(), dtype=float) for line in sliding.get_lines()}
    driver, driven = (curve[np.isfinite(curve)] for curve in (curves["driver"], curves["driven gear"]))
    assert driver[0] < 0.0 < driver[-1]
    assert driven[0] > 0.0 > driven[-1]
    # A curve along the path, not from phase to phase of the period.
    (line,) = (line for line in press.get_lines() if line.get_label() == "_pressure")
    rolls, values = (np.asarray(data, dtype=float) for data in line.get_data())
    present = pair.contact.pairs(mesh.phases).present
    for number in (5, 40, 90):
        row = int(np.flatnonzero(present[number])[0])
        roll = np.degrees(pair.geometry.driver_roll_angle(mesh.positions[number, row]))
        nearest = values[np.abs(rolls - roll) < 1e-9]
        assert np.nanmin(np.abs(nearest - 1e-6 * pressure[number, row])) < 1e-6


def test_the_force_of_superposed_motions_is_drawn_as_their_sum_pair_by_pair() -> None:
    """F = mean + a cos(2π 100 t) + b cos(2π 30 t + 1) of each pair; motions of 1/100 and 1/30 s both have the mean."""
    parts = {"first": (500.0, 40.0, 9.0), "second": (800.0, 70.0, 20.0)}  # mean, a, b

    def steady(name: str, hertz: float, phase: float, number: int) -> Any:
        times = np.arange(512) / 512 / hertz
        force = {
            pair: given[0] + given[number] * np.cos(2.0 * np.pi * hertz * times + phase)
            for pair, given in parts.items()
        }
        response: Any = SimpleNamespace(period=1.0 / hertz, stable=True)
        histories: Any = SimpleNamespace(times=times, mesh_force=force)
        return SteadyMotion(1.0, response, histories, 1e4, excitation=name, group=ExcitationGroup(weight=1))

    contacts = [SimpleNamespace(name=name, mesh_frequency=rate) for name, rate in (("first", 100.0), ("second", -30.0))]
    machine: Any = SimpleNamespace(
        system=SimpleNamespace(contacts=contacts),
        loaded_contacts=(0, 1),
        meshes=contacts,
        speed=100.0,
        input_torque=45.0,
    )
    motions = (steady("mesh first", 100.0, 0.0, 1), steady("mesh second", 30.0, 1.0, 2))
    figure = _motion_sheet("m", SolvedSteady(machine, motions, superposed=cast(Any, object())))
    shown = panels(figure)
    assert [axes.get_title(loc="left").partition(":")[0] for axes in shown] == [
        "first",
        "its lines",
        "second",
        "its lines",
    ]
    for (mean, fast, slow), rate, left, right in zip(
        parts.values(), (100.0, 30.0), shown[::2], shown[1::2], strict=True
    ):
        (curve,) = left.get_lines()
        times, force = 1e-3 * np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert times[-1] * rate == pytest.approx(round(times[-1] * rate))  # whole mesh periods
        expected = mean + fast * np.cos(2.0 * np.pi * 100.0 * times) + slow * np.cos(2.0 * np.pi * 30.0 * times + 1.0)
        np.testing.assert_allclose(force, expected, atol=1e-3 * fast)
        tops = [float(np.nanmax(np.asarray(line.get_ydata(), dtype=float))) for line in right.get_lines()]
        assert sorted(tops)[-2:] == pytest.approx([slow, fast], rel=1e-6)
    names = [text.get_text().replace("\N{NO-BREAK SPACE}", " ") for text in figure.legends[0].get_texts()]
    assert names == ["mesh first", "mesh second"]
