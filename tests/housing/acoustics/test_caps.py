"""What closes the holes of a housing on its radiating surface: its area, and its motion with the rim or at rest."""

import numpy as np
import pytest

from gearwhine.housing.acoustics.radiation import wrapped
from gearwhine.housing.acoustics.surface_velocity import surface_velocity
from gearwhine.meshes import BoxGeometry, Mesh, mesh_box
from gearwhine.meshes.box import Bore, WallThickness

DIAMETER = 0.05


@pytest.fixture(scope="module")
def box() -> Mesh:
    """A box with a hole in its front wall."""
    bore = Bore("hole", (0.01, 0.05, 0.04), DIAMETER)
    return mesh_box(BoxGeometry((0.12, 0.1, 0.08), WallThickness(*[0.01] * 6), (bore,)), 0.02)


@pytest.mark.parametrize("edge", [0.025, 0.015])
def test_caps_have_the_area_of_the_holes(box: Mesh, edge: float) -> None:
    """Between the circle and the polygon with a side for every 20 mm of the rim, on triangles of any size."""
    area = surface_velocity(box, wrapped(box, edge, 1.1 * DIAMETER, None)).cap_area
    assert area == pytest.approx(0.97 * np.pi * DIAMETER**2 / 4.0, rel=0.05)


def test_caps_move_with_their_rim_or_rest(box: Mesh) -> None:
    """Of a housing that moves as a whole along z nothing but the caps differs, by their area times the velocity."""
    surface = wrapped(box, 0.012, 1.1 * DIAMETER, None)
    along = np.tile([0.0, 0.0, 1.0], len(box.points))
    flow = []
    for resting in (False, True):
        velocity = surface_velocity(box, surface, resting_caps=resting)
        normal = velocity.transfer() @ along
        flow.append(surface.areas @ normal.reshape(-1, 3).mean(axis=1))
    moving, resting_flow = flow
    # Whatever moves as a whole displaces nothing.
    assert moving == pytest.approx(0.0, abs=2e-3 * surface.area)
    assert moving - resting_flow == pytest.approx(velocity.cap_area, rel=0.1)
