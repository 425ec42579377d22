"""Boxes that cannot be built are refused, by name, before gmsh is asked."""

from typing import Any

import pytest

from gearwhine.meshes import Bore, Boss, BoxGeometry, Feet, GeometryError, WallThickness, mesh_box

WALL = WallThickness.uniform(0.02)
SIZE = (0.20, 0.16, 0.24)
FRONT, BACK = 0.12, -0.12


def _box(**changes: Any) -> BoxGeometry:
    return BoxGeometry(**({"size": SIZE, "wall": WALL} | changes))


def _bore(name: str = "a", x: float = 0.0, y: float = 0.08, z: float = FRONT, **more: Any) -> Bore:
    return Bore(name, (x, y, z), more.pop("diameter", 0.04), more.pop("boss", None))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"size": (0.04, 0.16, 0.24)},
            "wall: expected left and right walls.* inside the 40 mm of the box along x",
        ),
        ({"size": (0.20, 0.03, 0.24)}, "bottom and top walls that leave room inside the 30 mm of the box along y"),
        ({"size": (0.20, 0.16, -0.24)}, "along z: size -0.24 m"),
        ({"size": (float("nan"), 0.16, 0.24)}, "along x: size nan m"),
        ({"wall": WallThickness(0.02, 0.02, 0.0, 0.02, 0.02, 0.02)}, "along y.*must be positive"),
        (
            {"feet": Feet((0.11, 0.02, 0.05))},
            r"feet.size\[0\]: expected feet of less.* along x, 100 mm",
        ),
        (
            {"feet": Feet((0.05, 0.02, 0.13))},
            r"feet.size\[2\]: expected feet of less.* along z, 120 mm",
        ),
        ({"feet": Feet((0.10, 0.02, 0.05))}, "less than half the base"),
        ({"feet": Feet((0.05, 0.00, 0.05))}, "positive sizes"),
        ({"bores": (_bore(z=0.0),)}, r"bores\[0\].center\[2\]: expected z in the back wall, -120 mm to -100 mm"),
        ({"bores": (_bore(z=0.13),)}, "or in the front wall, 100 mm to 120 mm"),
        (
            {"bores": (_bore(x=0.09),)},
            r"bores\[0\].diameter: expected a bore within .*x = 90 mm.*reaches 10 mm beyond",
        ),
        ({"bores": (_bore(y=0.01),)}, "y = 10 mm it reaches 10 mm beyond the edge"),
        ({"bores": (_bore(y=0.15),)}, "y = 150 mm it reaches 10 mm beyond the edge"),
        (
            {"bores": (_bore(x=0.07, boss=Boss(0.08, 0.01)),)},
            r"boss.diameter: .*a boss within.*reaches 10 mm",
        ),
        ({"bores": (_bore(diameter=0.0),)}, "diameter 0.0 m must be positive"),
        ({"bores": (_bore(boss=Boss(0.04, 0.01)),)}, "more than the bore's 0.04 m"),
        ({"bores": (_bore(boss=Boss(0.06, 0.0)),)}, "needs a positive length"),
        ({"bores": (_bore(), _bore(x=0.05))}, "two seats are named 'a'"),
        (
            {"bores": (_bore(), _bore("b", x=0.039))},
            "clear of seat .a.*by 1 mm: centres 39 mm apart",
        ),
        (
            {"bores": (_bore(boss=Boss(0.07, 0.01)), _bore("b", x=0.05))},
            "by 5 mm: centres 50 mm apart, 55 mm needed",
        ),
        ({"bores": (_bore("left"),)}, "another name than that of a face or foot"),
        ({"bores": (_bore("foot-1"),)}, "another name than that of a face or foot"),
    ],
)
def test_bad_geometry_is_named(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        _box(**changes)


def test_bores_opposite_each_other_are_no_neighbours() -> None:
    geometry = _box(bores=(_bore("a", z=FRONT), _bore("b", z=BACK)))
    assert [geometry.end_wall(bore) for bore in geometry.bores] == ["front", "back"]
    assert geometry.bore_span(geometry.bores[0]) == pytest.approx((0.10, 0.12))
    assert geometry.bore_span(geometry.bores[1]) == pytest.approx((-0.12, -0.10))


def test_a_center_anywhere_in_the_thickness_of_the_wall_will_do() -> None:
    for z in (0.10, 0.11, 0.12):
        assert _box(bores=(_bore(z=z),)).end_wall(_bore(z=z)) == "front"


def test_boss_lengthens_the_seat_outward() -> None:
    bore = _bore(z=BACK, boss=Boss(0.06, 0.015))
    assert _box(bores=(bore,)).bore_span(bore) == pytest.approx((-0.135, -0.10))


def test_a_bore_that_the_side_wall_fills_cannot_be_meshed() -> None:
    with pytest.raises(GeometryError, match="no face of the finished shape makes up a"):
        mesh_box(_box(bores=(_bore(x=0.085, diameter=0.028),)), 0.05)


@pytest.mark.parametrize(("size", "order"), [(0.0, 2), (-0.01, 2), (0.05, 3)])
def test_bad_mesh_sizes_and_orders_are_named(size: float, order: int) -> None:
    with pytest.raises(GeometryError, match=f"mesh size {size} m must be positive and order {order}"):
        mesh_box(_box(), size, order=order)
