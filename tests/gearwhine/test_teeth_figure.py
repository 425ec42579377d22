"""Teeth as they are drawn: the outlines of both gears, and contacts that lie on both."""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from coupling.gears import Gear, GearPairGeometry
from gearwhine.figures import draw_teeth, draw_teeth_of_pairs

ALPHA, HELIX = math.radians(20.0), math.radians(20.0)
PAIR = GearPairGeometry(
    Gear("pinion", 13, 3e-3, ALPHA, 15e-3, profile_shift=0.3, helix_angle=HELIX),
    Gear("wheel", 40, 3e-3, ALPHA, 15e-3, helix_angle=-HELIX),
)


def distance_to_outline(outline: np.ndarray, point: np.ndarray) -> float:
    """Least distance of a point from the sides of a polygon."""
    start, side = outline, np.roll(outline, -1, axis=0) - outline
    part = np.clip(np.sum((point - start) * side, axis=1) / np.sum(side**2, axis=1), 0.0, 1.0)
    return float(np.min(np.hypot(*(start + part[:, None] * side - point).T)))


@pytest.mark.parametrize("phase", [0.2, 0.7, -3.4, None])
def test_contacts_lie_on_both_outlines(phase: float | None) -> None:
    (axes,) = draw_teeth(PAIR, phase).axes
    outlines = {patch.get_label(): patch.get_xy() for patch in axes.patches}
    assert set(outlines) == {"driver", "driven"}
    (touching,) = [np.column_stack(line.get_data()) for line in axes.get_lines() if line.get_label() == "touching"]
    # In millimetres; between their points flanks are drawn as chords.
    for outline in outlines.values():
        assert [distance_to_outline(outline[:-1], point) < 1e-3 for point in touching] == [True] * len(touching)
    place = (PAIR.pitch_point_position if phase is None else phase) % 1.0
    assert len(touching) == 1 + (place + 1.0 <= PAIR.contact_ratio)


def test_the_scale_is_true_and_the_path_as_long_as_it_is() -> None:
    figure = draw_teeth(PAIR)
    (axes,) = figure.axes
    box = axes.get_window_extent()
    across, up = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    assert box.width / across == pytest.approx(box.height / up, rel=1e-9)
    (path,) = [np.array(line.get_data()) for line in axes.get_lines() if line.get_label() == "path of contact"]
    assert np.hypot(*np.diff(path)) == pytest.approx(1e3 * PAIR.path_length, rel=1e-9)


def test_each_pair_has_a_picture(tmp_path: Path) -> None:
    names = draw_teeth_of_pairs(tmp_path, [PAIR, PAIR])
    assert names == ["teeth-pinion-wheel.png", "teeth-pinion-wheel-2.png"]
    with Image.open(tmp_path / names[0]) as picture:
        assert picture.width / 200 * 25.4 == pytest.approx(160, abs=0.5)
