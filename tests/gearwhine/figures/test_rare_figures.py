"""Figures that few results have: envelopes, torsion, lines beside turning carriers, designs over speed, fronts."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from gearwhine.figures.machine.condition import draw_envelopes
from gearwhine.figures.machine.system import LINE_COLORS, draw_sensor_lines
from gearwhine.figures.optimisation import _over_speed, draw_optimisation
from gearwhine.figures.rotors.responses import TorsionalReading, draw_torsional_response
from gearwhine.optimisation.verification import Motion, Verification


def _legend(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_envelopes_have_the_tones_of_the_bearings_and_their_multiples() -> None:
    """The higher tone first; multiples up to the third, and a tenth more than the highest of these is shown."""
    hertz = np.arange(0.0, 1001.0)
    values = np.where(hertz == 90.0, 7.0, 0.5)
    values[0] = 99.0  # the mean
    tones = [
        SimpleNamespace(tone="inner race", frequency_hz=90.25, amplitudes={"top": 2.0, "side": None}),
        SimpleNamespace(tone="cage", frequency_hz=10.0, amplitudes={"top": 0.5, "side": 3.0}),
    ]
    condition: Any = SimpleNamespace(
        envelopes={"top": values, "side": np.zeros_like(hertz)}, tones=tones, limit_hz=4000.0, envelope_hz=hertz
    )
    figure = draw_envelopes("rig", condition)
    assert [text.get_text().replace("\n", " ") for text in figure.texts[:2]] == [
        "Envelope spectra",
        "rig; squared envelope of 2000 to 4000 Hz over its mean; dotted: multiples of the bearings' tones, "
        "which a damaged part raises",
    ]
    assert _legend(figure) == ["cage, 10.0 Hz", "inner race, 90.2 Hz"]
    above, below = figure.axes
    *marks, curve = above.lines
    assert [mark.get_xdata()[0] for mark in marks] == [10.0, 20.0, 30.0, 90.25, 180.5, 270.75]
    assert len({mark.get_color() for mark in marks}) == 2
    assert [mark.get_linestyle() for mark in marks] == [":"] * 6
    drawn = dict(np.asarray(curve.get_xydata()).tolist())
    assert (min(drawn), max(drawn), drawn[90.0], drawn[91.0]) == (1.0, 297.0, 7.0, 0.5)
    assert (above.get_xlim(), above.get_ylim()) == ((0.0, pytest.approx(1.1 * 270.75)), (0.0, pytest.approx(7.7)))
    assert [axes.get_title(loc="left") for axes in (above, below)] == ["top", "side"]
    assert (below.get_xlabel(), below.get_ylabel()) == ("modulation frequency [Hz]", "line / mean")


def test_torsion_has_angle_and_torque_at_each_place() -> None:
    omega = 2.0 * np.pi * np.array([10.0, 20.0, 40.0])
    readings = [
        TorsionalReading("flange", np.array([1e-3, 4e-3, 2e-3]), np.array([5.0, 50.0, 8.0])),
        TorsionalReading("end", np.array([2e-3, 1e-3, 3e-3]), np.zeros(3)),
    ]
    figure = draw_torsional_response(
        "Torsion", omega, readings, natural_frequencies=2.0 * np.pi * np.array([5.0, 21.25])
    )
    assert figure.texts[1].get_text() == (
        "zero to peak; torque in the shaft to the right of each place; above: natural frequencies in Hz, free to turn"
    )
    angle, torque = figure.axes
    assert [line.get_label() for line in angle.lines[:3]] == ["natural frequency", "flange", "end"]
    assert [line.get_label() for line in torque.lines] == ["natural frequency", "flange"]  # zero has no logarithm
    assert angle.lines[0].get_xdata() == pytest.approx([21.25, 21.25])
    np.testing.assert_allclose(angle.lines[1].get_xydata(), np.transpose([[10.0, 20.0, 40.0], readings[0].angle]))
    np.testing.assert_allclose(torque.lines[1].get_ydata(), [5.0, 50.0, 8.0])
    assert (angle.get_xlim(), torque.get_xlim()) == (pytest.approx((10.0, 40.0)), pytest.approx((10.0, 40.0)))
    assert (angle.get_ylim()[1], torque.get_ylim()[1]) == pytest.approx((8e-3, 100.0))
    assert (angle.get_yscale(), angle.get_ylabel(), torque.get_ylabel()) == ("log", "angle [rad]", "torque [N·m]")
    assert torque.get_xlabel() == "frequency [Hz]"
    assert _legend(figure) == ["flange", "end"]
    assert any(text.get_text() == "21.25" for text in angle.texts)
    plain = draw_torsional_response("Torsion", omega, readings)
    assert plain.texts[1].get_text() == "zero to peak; torque in the shaft to the right of each place"
    for wrong in (omega[::-1], omega[:2], omega[:1]):
        with pytest.raises(ValueError, match="not two or more ascending ones, or do not fit"):
            draw_torsional_response("Torsion", wrong, readings)


def test_lines_beside_harmonics_have_their_kind_and_the_turns_that_they_are_off() -> None:
    """Accelerations ω² |s q| of a sensor; the name of a line that leans into a higher one's is left out."""

    def line(hertz: float, kind: str, harmonic: int, turns: float, acceleration: float) -> Any:
        omega = 2.0 * np.pi * hertz
        motion = np.array([0.5j * acceleration / omega**2, 9.0])
        sideband = SimpleNamespace(turns=(("carrier", turns),) if turns else ())
        return SimpleNamespace(
            frequency=omega, kind=kind, motion=motion, causes=((0, harmonic),), sidebands=(sideband,)
        )

    lines = [
        line(1000.0, "mesh harmonic", 1, 0.0, 8.0),
        line(1025.0, "sideband", 1, 3.0, 4.0),
        line(975.0, "sideband", 1, -3.0, 5.0),
        line(1030.0, "sideband", 1, 4.0, 2.0),  # in the name of the one 3 turns above
        line(2000.0, "planet pass", 2, 0.0, 1.0),
        line(1500.0, "sideband", 2, -9.0, 1e-4),  # below four decades
    ]
    machine: Any = SimpleNamespace(sensor_rows={"roof": np.array([2.0, 0.0])})
    figure = draw_sensor_lines(machine, lines)
    (axes,) = figure.axes
    stems = {one.get_label(): one for one in axes.collections if isinstance(one, LineCollection)}
    drawn = {
        kind: {round(path.vertices[1][0]): path.vertices[1][1] for path in one.get_paths()}
        for kind, one in stems.items()
    }
    assert drawn == {
        "mesh harmonic": {1000: pytest.approx(8.0)},
        "planet pass": {2000: pytest.approx(1.0)},
        "sideband": {1025: pytest.approx(4.0), 975: pytest.approx(5.0), 1030: pytest.approx(2.0)},
    }
    for kind, one in stems.items():
        assert tuple(one.get_color()[0]) == to_rgba(LINE_COLORS[kind])
    names = {text.get_text(): text for text in axes.texts}
    assert set(names) == {"1", "1 +3", "1 -3", "2"}
    assert [names[name].get_ha() for name in ("1", "1 +3", "1 -3")] == ["center", "left", "right"]
    assert names["1 -3"].get_rotation() == 300.0
    assert (axes.get_ylim(), axes.get_xlim()) == (
        (pytest.approx(8e-4), pytest.approx(80.0)),
        pytest.approx((877.5, 2200.0)),
    )
    assert (axes.get_yscale(), axes.get_ylabel(), axes.get_xlabel()) == ("log", "roof [m/s²]", "frequency [Hz]")
    assert figure.texts[1].get_text().startswith("peak amplitudes, linear response about the mean load")


def _design(*aims: float) -> Any:
    return SimpleNamespace(aims=np.array(aims), failure=None, merit=(0.0, float(sum(aims))))


def test_designs_over_speed_and_the_front_of_two_aims() -> None:
    """Two of four designs are within the limits and on the front, of aims that are to be least."""
    speeds = 2.0 * np.pi * np.array([10.0, 20.0])
    start = Motion({}, {}, {}, {}, speeds, {"roof": np.array([80.0, 90.0]), "foot": np.array([60.0, 50.0])})
    chosen = Motion({}, {}, {}, {}, speeds, {"roof": np.array([70.0, 75.0]), "foot": np.array([61.0, 51.0])})
    aims = [SimpleNamespace(name=name, sign=1.0, quantity=name) for name in ("mass_kg", "misalignment_rad")]
    optimised: Any = SimpleNamespace(
        chosen={1: "best of all"},
        goals=SimpleNamespace(count=2, aims=aims, limits=()),
        designs=[_design(3.0, 1e-6), _design(1.0, 3e-6), _design(9.0, 9e-6), _design(2.0, 0.5e-6)],
        within=[0, 1, 3],
        front=[3, 1],
        start=_design(5.0, 4e-6),
        verification=Verification((100.0,), start, (chosen,)),
    )
    drawn = draw_optimisation("rig", optimised)
    figures = {}
    for name, figure in drawn:
        figures[name] = figure
        if name == "optimise-front":
            break
    (axes,) = figures["optimise-front"].axes
    beyond, within, front, steps, ring, at_start = (np.asarray(line.get_xydata()).tolist() for line in axes.lines)
    assert beyond == [[9.0, 9.0]]
    assert within == [[3.0, 1.0], [1.0, 3.0], [2.0, 0.5]]
    assert front == steps == [[1.0, 3.0], [2.0, 0.5]]  # ascending along the first aim, in µrad
    assert (ring, at_start) == ([[1.0, 3.0]], [[5.0, 4.0]])
    assert axes.lines[3].get_drawstyle() == "steps-post"
    assert "front, ring: proposed" in figures["optimise-front"].texts[1].get_text()
    above, below = figures["optimise-convergence"].axes
    assert above.lines[2].get_ydata() == pytest.approx([3.0, 1.0, 1.0, 1.0])  # the least so far
    assert below.lines[2].get_ydata() == pytest.approx([1.0, 1.0, 1.0, 0.5])
    assert [axes.lines[3].get_ydata()[0] for axes in (above, below)] == pytest.approx([5.0, 4.0])
    figure = _over_speed("rig; ", ["best of all"], optimised.verification, start)
    assert [text.get_text() for text in figure.texts[:2]] == [
        "Levels over the speed range",
        "rig; lines of the teeth by the linear machine under load.",
    ]
    roof, foot = figure.axes
    np.testing.assert_allclose(roof.lines[0].get_xydata(), [[600.0, 80.0], [1200.0, 90.0]])
    np.testing.assert_allclose(foot.lines[1].get_ydata(), [61.0, 51.0])
    assert _legend(figure) == ["start", "best of all"]
    assert (roof.get_title(loc="left"), roof.get_ylabel()) == ("roof", "level [dB re 1 µm/s²]")
    assert foot.get_xlabel() == "speed [rpm]"
    assert cast(Any, roof.lines[0].get_color()) != roof.lines[1].get_color()
