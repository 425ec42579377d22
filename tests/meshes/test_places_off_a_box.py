"""Places off the surface of a box: how far, and from which face."""

import pytest

from gearwhine.meshes.box.surface_points import point_off_surface

SIZE = (0.2, 0.15, 0.3)  # m, the bottom at y = 0, the others about the origin
WALLS = dict.fromkeys(("left", "bottom", "back", "right", "top", "front"), 0.01)


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ((-0.07, 0.07, 0.0), "in its cavity, 30 mm from the left face"),
        ((0.06, 0.07, 0.0), "in its cavity, 40 mm from the right face"),
        ((0.0, 0.02, 0.0), "in its cavity, 20 mm from the bottom face"),
        ((0.0, 0.125, 0.0), "in its cavity, 25 mm from the top face"),
        ((0.0, 0.07, -0.1), "in its cavity, 50 mm from the back face"),
        ((0.0, 0.07, 0.115), "in its cavity, 35 mm from the front face"),
        ((-0.13, 0.19, 0.0), "this one is 50 mm outside"),  # by 30 mm and 40 mm
        ((0.0, 0.145, 0.1), ""),  # in the top wall
        ((-0.109, 0.07, 0.0), ""),  # no farther off than the wall is thick
        ((0.03, 0.06, 0.146), 'in the bore of seat "rear", 25 mm from its rim'),
    ],
)
def test_a_place_off_the_surface_is_told_with_its_distance(place: tuple[float, float, float], said: str) -> None:
    bores = [("rear", (0.0, 0.02, 0.145), 0.15)]
    found = point_off_surface(place, SIZE, WALLS, stands_out=0.0, furnished=False, bores=bores)
    assert found.endswith(said)
    assert bool(found) is bool(said)
