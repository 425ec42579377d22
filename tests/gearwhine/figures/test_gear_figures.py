"""Pictures of gear pairs: what is drawn is what was computed, to scale where a scale is claimed."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from gearwhine.case import load_case
from gearwhine.coupling.gears import (
    Gear,
    GearPairGeometry,
    HelixDeviation,
    LoadedMesh,
    PotentialEnergyStiffness,
    TipRelief,
    ToothContact,
    harris_map,
    loaded_transmission_error,
    tooth_contact,
)
from gearwhine.coupling.gears.contact.face_slices import face_slices
from gearwhine.coupling.gears.loaded.contact_pressure import mesh_pressure
from gearwhine.coupling.gears.loaded.transmission_error import along_one_pair
from gearwhine.figures import draw_gear_pairs, save, save_all
from gearwhine.figures.gears.contact import draw_contact_path, draw_contact_pattern, over_flank
from gearwhine.figures.gears.teeth import _ring, draw_flank_charts, draw_tooth_pair, has_charts
from gearwhine.figures.gears.transmission_error import draw_harris_map, draw_mesh_stiffness, draw_transmission_error
from gearwhine.from_case.machine import solve_gears
from gearwhine.solve.gear_pairs import analyse_pairs

pytestmark = [pytest.mark.rendered, pytest.mark.usefixtures("few_reliefs_tried")]

ANGLE = math.radians(20.0)
FORCE = 1700.0


def gear(name: str, teeth: int = 28, *, helix: float = 0.0, **more: Any) -> Gear:
    return replace(Gear(name, teeth, 3.175e-3, ANGLE, 10e-3, helix_angle=helix), **more)


RELIEF = TipRelief(20e-6, start_roll_angle=math.radians(24.0))
PAIR = GearPairGeometry(gear("pinion", tip_relief=RELIEF), gear("wheel", 40))


@cache
def contact(*, corners: bool = False) -> ToothContact:
    return tooth_contact(PAIR, PotentialEnergyStiffness(), corner_contact=corners)


@cache
def mesh(*, corners: bool = False) -> LoadedMesh:
    return loaded_transmission_error(contact(corners=corners), FORCE)


def lines(axes: Axes, label: str) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in axes.get_lines() if line.get_label() == label]


def note(figure: Figure) -> str:
    return figure.texts[1].get_text()


def test_teeth_are_drawn_to_scale_and_touch_on_the_line_of_action(tmp_path: Path) -> None:
    figure = draw_tooth_pair(PAIR, 0.3)
    (axes,) = figure.axes
    along, across = axes.transData.transform((1.0, 1.0)) - axes.transData.transform((0.0, 0.0))
    assert along == pytest.approx(across)
    # The path of contact is as long as the theory's, and inclined by the working pressure angle.
    ((x, y),) = lines(axes, "_path of contact")
    assert math.hypot(x[1] - x[0], y[1] - y[0]) == pytest.approx(1e3 * PAIR.path_length)
    assert (y[1] - y[0]) / (x[1] - x[0]) == pytest.approx(-math.tan(ANGLE))
    # Where the figure says that teeth touch, both outlines pass.
    ((x, y),) = lines(axes, "_contact")
    assert len(x) == 2
    outlines = [patch.get_xy() for patch in axes.patches if patch.get_label() == "_outline"]
    assert len(outlines) == 2
    for outline in outlines:
        closed = np.vstack([outline, outline[:1]])
        for point in zip(x, y, strict=True):
            assert _distance(np.array(point), closed) < 2e-3  # mm: chords of sixty to a flank
    assert {"pinion, 28 teeth", "wheel, 40 teeth"} <= {text.get_text() for text in axes.texts}
    with Image.open(tmp_path / save(figure, tmp_path / "teeth.png")) as image:
        assert image.size[0] == pytest.approx(160.0 / 25.4 * 200.0, abs=1.0)


def _distance(point: np.ndarray, polygon: np.ndarray) -> float:
    """From a point to the nearest side."""
    start, side = polygon[:-1], np.diff(polygon, axis=0)
    long = np.einsum("ij,ij->i", side, side)
    part = np.clip(np.einsum("ij,ij->i", point - start, side) / np.where(long > 0.0, long, 1.0), 0.0, 1.0)
    return float(np.linalg.norm(start + part[:, None] * side - point, axis=1).min())


def test_as_many_contacts_as_the_contact_ratio_says() -> None:
    (axes,) = draw_tooth_pair(PAIR, 0.99).axes
    assert lines(axes, "_contact")[0].shape[1] == 1
    # Unless told otherwise, the phase with most pairs.
    (axes,) = draw_tooth_pair(PAIR).axes
    assert lines(axes, "_contact")[0].shape[1] == 2
    assert "transverse section" not in note(draw_tooth_pair(PAIR))
    helical = GearPairGeometry(gear("a", helix=0.2), gear("b", helix=-0.2))
    assert "transverse section" in note(draw_tooth_pair(helical))


@pytest.mark.parametrize("corners", [False, True])
def test_stiffness_and_shares(corners: bool) -> None:
    figure = draw_mesh_stiffness("s", contact(corners=corners), mesh(corners=corners))
    upper, lower = figure.axes
    ((phases, stiffness),) = lines(upper, "pairs that touch under the load")
    np.testing.assert_allclose(stiffness, 1e-6 * mesh(corners=corners).tangent_stiffness)
    shares = [np.array(line.get_ydata()) for line in lower.get_lines() if not line.get_label().startswith("_")]
    np.testing.assert_allclose(np.nansum(shares, axis=0), 100.0)
    assert phases.size == shares[0].size
    names = {line.get_label() for line in lower.get_lines()}
    assert ("pair that follows" in names) is corners


def test_without_load_there_is_one_panel() -> None:
    idle = loaded_transmission_error(contact(), 0.0)
    figure = draw_mesh_stiffness("s", contact(), idle)
    (axes,) = figure.axes
    assert axes.get_xlabel() == "mesh period"
    assert "without load" in note(figure)


def test_transmission_error_is_drawn_about_its_mean() -> None:
    unloaded = contact().pairs(mesh().phases).deviation.min(axis=1)
    harmonics = {"unloaded": np.full(8, 1e-6), "loaded": np.arange(8, 0, -1) * 1e-7}
    upper, bars = draw_transmission_error("t", mesh().phases, unloaded, harmonics, loaded=mesh()).axes
    ((_, curve),) = lines(upper, f"under {FORCE:.4g} N")
    assert np.ptp(curve) == pytest.approx(1e6 * mesh().peak_to_peak_transmission_error)
    assert abs(np.mean(curve)) < 0.2 * np.ptp(curve)
    heights = [bar.get_height() for bar in bars.patches]
    assert heights == pytest.approx([1.0] * 8 + [0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1])
    assert "0.8" in {text.get_text() for text in bars.texts}
    alone = draw_transmission_error("t", mesh().phases, unloaded, {"unloaded": np.zeros(8)})
    assert "under" not in note(alone)


def test_a_harris_map_has_a_curve_for_each_torque() -> None:
    harris = harris_map(contact(), FORCE * np.linspace(0.2, 2.0, 10))
    radius = PAIR.driver.base_radius
    figure = draw_harris_map("h", harris, radius, torque=FORCE * radius)
    upper, lower, bar = figure.axes
    assert len(lines(upper, "_torque")) == 10
    ((_, curve),) = lines(upper, "_operation")
    np.testing.assert_allclose(curve, 1e6 * harris.transmission_error[4])
    ((torques, swing),) = lines(lower, "_peak to peak")
    np.testing.assert_allclose(torques, harris.forces * radius)
    np.testing.assert_allclose(swing, 1e6 * np.ptp(harris.transmission_error, axis=1))
    assert bar.get_ylim() == pytest.approx((torques[0], torques[-1]))
    assert not lines(draw_harris_map("h", harris, radius, torque=1e6).axes[0], "_operation")
    with pytest.raises(ValueError, match="two or more loads"):
        draw_harris_map("h", harris_map(contact(), [FORCE]), radius)


def test_along_the_path(tmp_path: Path) -> None:
    law = contact(corners=True)
    pressure = mesh_pressure(PAIR, law, mesh(corners=True))
    figure = draw_contact_path("p", PAIR, law, along_one_pair(law, mesh(corners=True)), pressure)
    share, press, sliding = figure.axes
    ((rolls, shares),) = lines(share, "_share")
    assert (np.diff(rolls) >= 0.0).all()
    assert shares.max() <= 100.0 + 1e-9
    ((_, drawn),) = lines(press, "_pressure")
    assert np.nanmax(drawn) == pytest.approx(1e-6 * np.nanmax(pressure))
    # Both flanks roll without sliding at the pitch point.
    pitch = math.degrees(math.tan(PAIR.working_pressure_angle))
    for name in ("driver", "driven gear"):
        ((x, y),) = lines(sliding, name)
        assert float(np.interp(pitch, x, y)) == pytest.approx(0.0, abs=1e-4)
    assert "corners" in note(figure)
    assert [text.get_text() for text in share.texts] == list("ABCDE")
    assert len(draw_contact_path("p", PAIR, contact(), along_one_pair(contact(), mesh())).axes) == 2
    assert (tmp_path / save(figure, tmp_path / "path.png")).stat().st_size > 20_000


def test_flank_charts_show_each_kind_of_deviation_that_there_is() -> None:
    figure = draw_flank_charts("f", PAIR)
    left, right = figure.axes
    ((roll, deviation),) = lines(left, "_profile")
    assert deviation[-1] == pytest.approx(-20.0)
    assert float(np.interp(24.0, roll, deviation)) == pytest.approx(0.0, abs=0.1)
    assert not np.any(lines(right, "_profile")[0][1])
    assert left.get_ylim() == right.get_ylim()

    crowned = gear("a", helix_deviation=HelixDeviation(crowning=5e-6), pitch_deviations=(1e-6,) + (0.0,) * 27)
    pair = GearPairGeometry(crowned, gear("b"))
    helix, other, pitch, _ = draw_flank_charts("f", pair).axes
    ((z, deviation),) = lines(helix, "_helix")
    assert (z[0], z[-1]) == pytest.approx((-5.0, 5.0))
    assert deviation[[0, -1]] == pytest.approx([-5.0, -5.0])
    assert not np.any(lines(other, "_helix")[0][1])
    assert [bar.get_height() for bar in pitch.patches][:2] == pytest.approx([1.0, 0.0])

    best = TipRelief(12e-6, length=3e-3)
    perfect = GearPairGeometry(gear("a"), gear("b"))
    assert not has_charts(perfect)
    ((_, relieved),) = lines(draw_flank_charts("f", perfect, best).axes[1], "_best")
    assert relieved[-1] == pytest.approx(-12.0)
    with pytest.raises(ValueError, match="no chart"):
        draw_flank_charts("f", perfect)


def test_the_contact_pattern_holds_the_load() -> None:
    """Summed over the pairs at one phase the map's loads give the mesh force back."""
    crowned = gear("a", helix=0.25, helix_deviation=HelixDeviation(crowning=8e-6))
    pair = GearPairGeometry(crowned, gear("b", helix=-0.25))
    faces = face_slices(pair, count=15)
    helical = tooth_contact(pair, PotentialEnergyStiffness(), faces=faces)
    static = loaded_transmission_error(helical, FORCE)
    figure = draw_contact_pattern("c", pair, helical, static)
    assert len(figure.axes) == 4
    for axes in figure.axes[::2]:  # beside each its colours
        (drawn,) = axes.collections
        assert drawn.get_array().shape[0] == 15
        assert float(drawn.get_array().max()) > 0.0
    assert static.line_loads is not None
    peak = 1e-3 * static.line_loads.max()
    assert f"peak line load of a tooth pair {peak:.4g} N/mm" in note(figure)
    assert f"{1e3 * peak * faces.face_width * pair.contact_ratio / FORCE:.3g} times the even load" in note(figure)
    # A helical pair touches along lines that lie across the map.
    assert all(np.ptp(x) > 0.0 for x, _ in lines(figure.axes[0], "_contact line"))

    places = np.linspace(0.0, pair.contact_ratio, 400)
    present = helical.pairs(static.phases).present
    loads = over_flank(static.line_loads, static.positions, present, faces.shift, places)
    carried = 0.0
    for before in range(-1, 3):
        at = 0.37 + before + faces.shift
        carried += sum(float(np.interp(s, places, row, 0.0, 0.0)) for s, row in zip(at, loads, strict=True))
    assert carried * faces.width == pytest.approx(FORCE, rel=2e-2)
    with pytest.raises(ValueError, match="same all over the face"):
        draw_contact_pattern("c", PAIR, contact(), mesh())


def test_every_pair_has_its_files(tmp_path: Path) -> None:
    """Odd names are no paths and no formulas; what one has not is not drawn."""
    case = load_case("spur-pair").case
    (solved,) = solve_gears(case.parts)
    idle = replace(solved, static=loaded_transmission_error(solved.contact, 0.0))
    pairs = [
        replace(pair, solved=replace(one, pair=replace(one.pair, driver=name, driven="ö ö")))
        for name, one in (("a/$b$", solved), ("A/$B$", idle))
        for pair in analyse_pairs(case, (one,))
    ]
    said: list[str] = []

    def progress(message: str, fraction: float | None = None) -> None:
        said.append(message)

    files = save_all(draw_gear_pairs(pairs, progress), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(files)
    kinds = [name.rpartition("-")[2] for name in files]
    assert kinds == ["teeth.png", "stiffness.png", "error.png", "path.png", "flanks.png"] + [
        "teeth.png",
        "stiffness.png",
        "error.png",
        "flanks.png",
    ]
    assert said == ["drawing gear pair a/$b$ → ö ö", "drawing gear pair A/$B$ → ö ö"]


@pytest.mark.parametrize("place", [(0.0, -50.0), (30.0, 40.0)])
def test_the_outline_of_a_ring_encloses_its_rim_alone(place: tuple[float, float]) -> None:
    """Area within the outline, by its sides: π R² less the inside, which is passed the other way round."""
    centre, around = np.array(place), np.linspace(0.0, 2.0 * math.pi, 2000, endpoint=False)
    inside = centre + 60.0 * np.column_stack([np.cos(around), np.sin(around)])
    outline = _ring(inside, centre, 80.0)
    x, y = outline.T
    # The way in is straight across the rim.
    assert np.linalg.norm(np.diff(outline, axis=0), axis=1).max() == pytest.approx(20.0, rel=1e-3)
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    assert area == pytest.approx(math.pi * (80.0**2 - 60.0**2), rel=5e-3)
