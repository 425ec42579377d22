"""Pictures of rotors: the artists of each figure hold the data that went in, at the scale that they claim."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from gearwhine import rotors
from gearwhine.figures import RotorAssembly, draw_lateral_modes, draw_shaft, save
from gearwhine.figures.rotors.assembly import DrawnGear, DrawnProbe, DrawnUnbalance
from gearwhine.figures.rotors.mode_shapes import (
    draw_rest_modes,
    draw_static_deflection,
    draw_torsional_modes,
    draw_whirl_modes,
    local_direction,
)
from gearwhine.figures.style import Label, arrange, draw_row, legend, panel, sheet, spread

pytestmark = pytest.mark.rendered

STEEL = rotors.ShaftMaterial(211e9, 81.2e9, 7810.0)
ALUMINIUM = rotors.ShaftMaterial(70e9, 26e9, 2700.0)
BEARINGS = (rotors.Bearing.isotropic("left", 0.0, 1e6), rotors.Bearing.isotropic("right", 1.5, 1e6))
ROTOR = rotors.Rotor(
    "two discs",
    [rotors.Segment(0.5, 0.05, 0.0, STEEL)] * 3,
    [
        rotors.Disc.from_dimensions(0.5, 0.07, 0.28, 0.05, 7810.0),
        rotors.Disc.from_dimensions(1.0, 0.07, 0.35, 0.05, 7810.0),
    ],
)
TWO_DISCS = RotorAssembly(ROTOR, BEARINGS)


def boxes(axes: Axes, label: str) -> list[tuple[float, float, float, float]]:
    """Left, bottom, width and height of the patches of a label, in data coordinates."""
    found = [patch for patch in axes.patches if patch.get_label() == label]
    extents = [patch.get_path().get_extents(patch.get_patch_transform()) for patch in found]
    return [(extent.x0, extent.y0, extent.width, extent.height) for extent in extents]


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def lines(axes: Axes, label: str) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in axes.get_lines() if line.get_label() == label]


def written(figure: Figure, folder: Path) -> tuple[int, int]:
    """Size of the picture that a figure becomes, pixels."""
    with Image.open(folder / save(figure, folder / "picture.png")) as image:
        return image.size


def test_a_shaft_is_drawn_to_scale(tmp_path: Path) -> None:
    figure = draw_shaft(TWO_DISCS)
    (axes,) = figure.axes
    # Sizes of Friswell's discs come back from their inertias: 70 mm by 280 and 350 mm.
    assert np.array(boxes(axes, "disc")) == pytest.approx(
        np.array([[465.0, -140.0, 70.0, 280.0], [965.0, -175.0, 70.0, 350.0]])
    )
    assert np.array(boxes(axes, "segment")) == pytest.approx(
        np.array([[0.0, -25.0, 500.0, 50.0], [500.0, -25.0, 500.0, 50.0], [1000.0, -25.0, 500.0, 50.0]])
    )
    one_mm_along, one_mm_across = axes.transData.transform((1.0, 1.0)) - axes.transData.transform((0.0, 0.0))
    assert one_mm_along == pytest.approx(one_mm_across)
    assert axes.get_xlabel() == "z from the left end [mm]"
    assert axes.get_ylabel() == "diameter [mm]"
    # 160 mm at 200 points per inch.
    assert written(figure, tmp_path)[0] == pytest.approx(160 / 25.4 * 200, abs=1)


def test_the_centre_line_ends_beyond_what_reaches_beyond_the_shaft() -> None:
    """A disc of 70 mm at the left end of 1.5 m, and a gear of 50 mm at the right one."""
    rotor = rotors.Rotor("r", ROTOR.segments, [rotors.Disc.from_dimensions(0.0, 0.07, 0.28, 0.05, 7810.0)])
    assembly = RotorAssembly(rotor, BEARINGS, gears=[DrawnGear("pinion", 1.5, 0.05, 0.11, 0.1, 0.09, teeth=28)])
    assert assembly.reach == pytest.approx((-0.035, 1.525))
    assert TWO_DISCS.reach == (0.0, 1.5)
    (axes,) = draw_shaft(assembly).figure.axes
    (line,) = lines(axes, "centre line")
    left, right = line[0, 0] + 35.0, line[0, 1] - 1525.0
    assert left < 0.0 < right == pytest.approx(-left)


def test_everything_on_a_shaft_has_its_sign_and_its_name() -> None:
    wheel = rotors.Disc(0.2, 5.0, 0.02, 0.012)
    rotor = rotors.Rotor(
        "rich",
        [
            rotors.Segment(0.1, 0.04, 0.01, STEEL, right_outer_diameter=0.06, right_inner_diameter=0.02),
            rotors.Segment(0.2, 0.06, 0.02, STEEL),
            rotors.Coupling(0.06, 1e7, 1e4, 1e4, 1e7, mass=2.0, axial_force=4e3),
            rotors.Segment(0.3, 0.05, 0.0, ALUMINIUM, axial_force=-5e3),
        ],
        [wheel, rotors.Disc(0.6, 3.0)],
    )
    pedestal = rotors.Pedestal(1e7 * np.eye(2), np.zeros((2, 2)), 4.0)
    figure = draw_shaft(
        RotorAssembly(
            rotor,
            [
                rotors.Bearing.isotropic("ball", 0.05, 1e8),
                rotors.Bearing("stand", 0.28, 1e8 * np.eye(2), np.zeros((2, 2)), pedestal=pedestal),
                rotors.Bearing.isotropic("housed", 0.5, 1e8),
            ],
            gears=[DrawnGear("pinion", 0.2, 0.03, 0.11, 0.1, 0.09, teeth=28, disc=wheel)],
            unbalances=[DrawnUnbalance(0.25, 2e-5, math.pi / 2)],
            probes=[DrawnProbe("X1", 0.16, math.pi / 4)],
            rolling={"ball"},
            seats={"housed": "front wall"},
            materials={STEEL: "steel", ALUMINIUM: "aluminium"},
        )
    )
    (axes,) = figure.axes
    counts = {patch.get_label(): 0 for patch in axes.patches}
    for patch in axes.patches:
        counts[patch.get_label()] += 1
    # The gear stands for its disc, so that no disc is drawn; a rolling bearing is two squares.
    assert {name: counts.get(name, 0) for name in ("gear", "disc", "point mass", "coupling", "rolling")} == {
        "gear": 1, "disc": 0, "point mass": 1, "coupling": 1, "rolling": 2,
    }  # fmt: skip
    assert {name: counts.get(name, 0) for name in ("bearing", "seat", "pedestal", "unbalance", "probe")} == {
        "bearing": 2, "seat": 1, "pedestal": 1, "unbalance": 1, "probe": 1,
    }  # fmt: skip
    assert boxes(axes, "gear")[0] == pytest.approx((185.0, -55.0, 30.0, 110.0))
    assert [line[1, 0] for line in lines(axes, "pitch line")] == pytest.approx([-50.0, 50.0])
    assert set(texts(figure)) == {
        "pinion, 28 teeth", "3 kg", "coupling, tension 4 kN", "compression 5 kN", "20 g·mm at 90°", "X1, 45°",
        "ball", "stand", "housed",
    }  # fmt: skip
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["steel", "aluminium"]
    cone = next(patch for patch in axes.patches if patch.get_label() == "segment").get_xy()
    assert np.ptp(cone[cone[:, 0] == 0.0][:, 1]) == pytest.approx(40.0)
    assert np.ptp(cone[cone[:, 0] == 100.0][:, 1]) == pytest.approx(60.0)


@pytest.mark.parametrize("name", ["$x^$", "轴 №1", "a" * 100, r"\frac{", "%s {0}"])
def test_odd_names_are_drawn_as_they_are(name: str, tmp_path: Path) -> None:
    rotor = rotors.Rotor(name, [rotors.Segment(1.0, 0.05, 0.0, STEEL)], [rotors.Disc(0.5, 1.0)])
    assembly = RotorAssembly(rotor, [rotors.Bearing.isotropic(name, 0.2, 1e6)])
    assert min(written(draw_shaft(assembly), tmp_path)) > 100
    modes = rotors.solve_lateral_modes(rotor, [bearing.mean_support for bearing in assembly.bearings], count=3)
    assert min(written(draw_lateral_modes(assembly, modes), tmp_path)) > 100


def test_a_slender_shaft_says_how_much_its_diameters_are_stretched() -> None:
    figure = draw_shaft(RotorAssembly(rotors.Rotor("wire", [rotors.Segment(2.0, 0.001, 0.0, STEEL)])))
    (axes,) = figure.axes
    ((_, _, length, height),) = boxes(axes, "segment")
    stretch = round(height)  # of one millimetre
    assert length == pytest.approx(2000.0)
    assert any(f"diameters {stretch} times as large as lengths" in text.get_text() for text in figure.texts)
    axes.figure.canvas.draw()
    assert max(float(label.get_text()) for label in axes.get_yticklabels()) == pytest.approx(1.0)


def test_labels_do_not_touch_however_many_there_are() -> None:
    for count in (3, 30, 90):
        discs = [rotors.Disc(0.4 + 0.2 * place / count, 1.0 + place) for place in range(count)]
        figure = draw_shaft(RotorAssembly(rotors.Rotor("x", [rotors.Segment(1.0, 0.05, 0.0, STEEL)], discs)))
        extents = [text.get_window_extent() for text in figure.axes[0].texts]
        assert not any(a.overlaps(b) for place, a in enumerate(extents) for b in extents[:place])
        left_out = count - len(extents)
        assert (left_out > 0) == any(f"{left_out} labels left out" in text.get_text() for text in figure.texts)


@given(
    st.lists(st.floats(-5.0, 105.0), min_size=1, max_size=12).map(sorted),
    st.lists(st.floats(0.1, 6.0), min_size=12, max_size=12),
)
def test_spread_places_keep_their_order_and_their_distance(centres: list[float], widths: list[float]) -> None:
    wide = np.array(widths[: len(centres)])
    places = spread(centres, wide, 0.0, 100.0, 1.0)
    assert (np.diff(places) >= 0.5 * (wide[1:] + wide[:-1]) + 1.0 - 1e-9).all()
    assert places[0] - 0.5 * wide[0] >= -1e-9
    assert places[-1] + 0.5 * wide[-1] <= 100.0 + 1e-9
    # One that has room where it belongs stays there.
    alone = np.array([50.0])
    assert spread(alone, wide[:1], 0.0, 100.0, 1.0) == pytest.approx(alone)


def test_lateral_modes_hold_the_shapes() -> None:
    modes = rotors.solve_lateral_modes(ROTOR, [bearing.mean_support for bearing in BEARINGS], count=4)
    figure = draw_lateral_modes(TWO_DISCS, modes)
    outline, axes = figure.axes
    assert outline.get_xlim() == axes.get_xlim()
    assert len(lines(axes, "bearing")) == 2
    for number in range(4):
        ((z, drawn),) = lines(axes, f"mode {number + 1}")
        shape = modes.evaluate(z / 1e3)[0][number]
        assert np.abs(drawn + number).max() == pytest.approx(0.42)
        assert (drawn + number) * np.abs(shape).max() == pytest.approx(0.42 * shape, abs=1e-9)
    # Friswell's printed values to four digits; the exact third pair is below his.
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert [name.splitlines()[1] for name in names[:2]] == [f"{w / (2 * math.pi):.4g} Hz" for w in (86.66, 274.31)]


def test_modes_at_rest_are_those_of_the_table() -> None:
    """On bearings that are stiffer across: each mode in its plane, by its own frequency."""
    bearings = [rotors.Bearing(one.name, one.at, np.diag([1e6, 4e6]), np.zeros((2, 2))) for one in BEARINGS]
    rest = rotors.rest_frequencies(ROTOR, bearings, count=4)
    _, axes = draw_rest_modes(RotorAssembly(ROTOR, bearings), rest).axes
    names = [label.get_text().splitlines()[1] for label in axes.get_yticklabels()]
    assert names == [f"{w / (2 * math.pi):.4g} Hz" for w in rest.frequencies]
    for plane, stiffness in (("x", 1e6), ("y", 4e6)):
        alone = rotors.solve_lateral_modes(
            ROTOR, [rotors.RadialSupport(one.at, stiffness) for one in BEARINGS], count=2
        )
        for number, frequency in enumerate(alone.frequencies):
            (place,) = np.flatnonzero(np.isclose(rest.frequencies, frequency, rtol=1e-9)) + 1
            ((z, drawn),) = lines(axes, f"mode {place} {plane}")
            shape = alone.evaluate(z / 1e3)[0][number]
            assert drawn + place - 1 == pytest.approx(0.42 * shape / np.abs(shape).max(), abs=1e-6)


def test_forty_modes_of_a_free_shaft_without_anything(tmp_path: Path) -> None:
    rotor = rotors.Rotor("bare", [rotors.Segment(1.0, 0.02, 0.0, STEEL)])
    modes = rotors.solve_lateral_modes(rotor, count=40)
    figure = draw_lateral_modes(RotorAssembly(rotor), modes)
    labels = figure.axes[1].get_yticklabels()
    assert len(labels) == 40
    assert labels[0].get_text().endswith("rigid")
    extents = [label.get_window_extent() for label in labels]
    assert all(above.y0 >= below.y1 for above, below in pairwise(extents))
    assert written(figure, tmp_path)[1] > 2000
    few = draw_lateral_modes(RotorAssembly(rotor), modes, most=3)
    assert len(few.axes[1].get_yticklabels()) == 3
    assert any("the lowest 3 of 40" in text.get_text() for text in few.texts)


def test_torsional_modes_hold_the_angles() -> None:
    modes = rotors.solve_torsional_modes(ROTOR, count=3)
    _, axes = draw_torsional_modes(TWO_DISCS, modes).axes
    ((z, drawn),) = lines(axes, "mode 2")
    angle = modes.evaluate(z / 1e3)[1]
    assert (drawn + 1.0) * np.abs(angle).max() == pytest.approx(0.42 * angle, abs=1e-9)
    assert not lines(axes, "bearing")  # which hold no torsion


@pytest.mark.parametrize("speed", [400.0, -400.0])
def test_whirl_orbits_are_circles_in_their_senses(speed: float) -> None:
    whirl = rotors.solve_whirl(ROTOR, BEARINGS, speed, count=4)
    figure = draw_whirl_modes(TWO_DISCS, whirl)
    _, axes = figure.axes
    assert len(axes.get_yticks()) == 4
    orbits = [line for line in axes.get_lines() if line.get_label() == "orbit"]
    # Backward before forward: gyroscopic moments lower the one and raise the other.
    colors = [line.get_color() for line in orbits]
    per_mode = len(orbits) // 4
    first, second = set(colors[:per_mode]), set(colors[per_mode : 2 * per_mode])
    named = {line.get_color(): line.get_label() for line in figure.legends[0].get_lines()}
    assert [named[color] for color in (*first, *second)] == ["backward", "forward"]


def test_a_mode_along_the_axis_is_drawn_by_arrows_as_long_as_its_motion() -> None:
    """A thrust bearing that is tied to tilt: the shaft moves along its axis as a rigid body, all of it alike."""
    stiffness = np.diag([1e8, 1e8, 1e7, 1e5, 1e5])
    stiffness[2, 4] = stiffness[4, 2] = 1e4
    bearings = [
        rotors.Bearing("left", 0.0, stiffness, np.zeros((5, 5))),
        rotors.Bearing.isotropic("right", ROTOR.length, 1e8),
    ]
    whirl = rotors.solve_whirl(ROTOR, bearings, 100.0, count=4)
    (number,) = np.flatnonzero(whirl.axial_share > 0.9)[:1]
    motion = whirl.evaluate_axial(np.linspace(0.0, ROTOR.length, 13))[number]
    assert np.abs(motion).min() > 0.8 * np.abs(motion).max()
    figure = draw_whirl_modes(RotorAssembly(ROTOR, bearings), whirl, most=int(number) + 1)
    _, axes = figure.axes
    assert len(axes.get_yticks()) == number + 1
    level = axes.get_yticks()[number]
    arrows = [one for one in axes.texts if getattr(one, "arrow_patch", None) is not None and one.xy[1] == level]
    assert len(arrows) == 13
    lengths = np.array([one.xy[0] - one.get_position()[0] for one in arrows])
    expected = np.real(motion / motion[np.abs(motion).argmax()])
    assert lengths / np.abs(lengths).max() == pytest.approx(expected, abs=1e-6)
    assert "along the axis" in [line.get_label() for line in figure.legends[0].get_lines()]
    # Without such a bearing no motion is axial.
    assert not rotors.solve_whirl(ROTOR, BEARINGS, 100.0, count=2).evaluate_axial([0.0, 0.1]).any()


def test_a_mode_in_a_plane_is_never_seen_edgewise() -> None:
    """Bearings soft in one direction: whatever it is, the orbits of each mode reach up or down from the shaft."""
    for angle in np.radians([0.0, 40.0, 90.0, 135.0, 161.0]):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        radial = turn @ np.diag([1e6, 1e9]) @ turn.T
        bearings = [
            rotors.Bearing(name, at, radial, np.zeros((2, 2))) for name, at in (("a", 0.0), ("b", ROTOR.length))
        ]
        whirl = rotors.solve_whirl(ROTOR, bearings, 1.0, count=1)
        _, axes = draw_whirl_modes(RotorAssembly(ROTOR, bearings), whirl).axes
        orbits = [np.asarray(line.get_ydata()) for line in axes.get_lines() if line.get_label() == "orbit"]
        up = max(np.ptp(orbit) for orbit in orbits) / 2.0
        assert up > 0.3 * 8.5, np.degrees(angle)


def test_local_direction_of_known_orbits() -> None:
    x = np.array([1.0, 1.0, 1.0, 0.0, 0.0 + 2.0j], dtype=complex)
    y = np.array([-1.0j, 1.0j, 1.0, 0.0, 2.0], dtype=complex)
    # y a quarter turn behind x is counter-clockwise; in step it is a line.
    assert local_direction(x, y) == pytest.approx([1.0, -1.0, 0.0, 0.0, 1.0])


def test_static_deflection_and_its_loads() -> None:
    z = np.linspace(0.0, 1.5, 31)
    sag = -1e-4 * np.sin(np.pi * z / 1.5)
    figure = draw_static_deflection(TWO_DISCS, z, np.column_stack([0.0 * sag, sag]), [[0.0, 480.0], [0.0, -120.0]])
    _, axes = figure.axes
    ((places, drawn),) = lines(axes, "y")
    assert places == pytest.approx(1e3 * z)
    assert drawn == pytest.approx(1e6 * sag)
    assert not lines(axes, "x")  # nothing moves there
    assert {"480 N", "120 N"} <= set(texts(figure))
    drawn_arrows = [note for note in axes.texts if note.arrow_patch is not None]
    for note, bearing in zip(drawn_arrows, TWO_DISCS.bearings, strict=True):
        assert (note.xy[0], note.xyann[0]) == pytest.approx((1e3 * bearing.at, 1e3 * bearing.at))
        (size,) = [one for one in axes.texts if one.arrow_patch is None and one.xy == note.xyann]
        assert size.get_text() in ("480 N", "120 N")
    arrows = [(note.xy[1], note.xyann[1]) for note in drawn_arrows]
    (up_tip, up_tail), (down_tip, down_tail) = arrows
    assert (down_tail - down_tip) / (up_tip - up_tail) == pytest.approx(120.0 / 480.0)
    with pytest.raises(ValueError, match="bearing loads"):
        draw_static_deflection(TWO_DISCS, z, np.zeros((31, 2)), [[0.0, 1.0]])


def test_a_legend_of_many_lines_leaves_the_title_free() -> None:
    figure = sheet(100.0, "Rotor intermediate: Campbell diagram")
    names = ("forward", "backward", "planar or mixed", "along the axis", "operation")
    legend(figure, [Line2D([], [], label=name) for name in names])
    FigureCanvasAgg(figure).draw()
    title, (key,) = figure.texts[0].get_window_extent(), figure.legends
    assert key.get_window_extent().x0 > title.x1


def test_a_label_has_room_for_a_line_of_two_gears() -> None:
    text = "2028 Hz 20× pinion 2 -> wheel 2"
    figure = sheet(100.0, "Spectrum")
    axes = panel(figure, 20.0, 30.0)
    draw_row(axes, arrange([Label(text, 0.5, 0.5)], [50.0], 100.0), 32.0)
    assert [drawn.get_text() for drawn in axes.texts] == [text]
