"""A mesh moved to other dimensions against the dimensions themselves, and against a mesh made anew."""

from dataclasses import replace

import numpy as np
import pytest

from gearwhine.meshes import (
    Bore,
    Boss,
    BoxGeometry,
    BoxMorph,
    Feet,
    Fillets,
    Mesh,
    Rib,
    WallThickness,
    mesh_box,
    mesh_quality,
)
from gearwhine.meshes.box.morph import MorphError
from gearwhine.meshes.elements import facet_corners, facet_nodes

BEFORE = BoxGeometry(
    size=(0.20, 0.16, 0.24),
    wall=WallThickness.uniform(0.02),
    bores=(
        Bore("front-seat", (-0.03, 0.08, 0.12), 0.05, Boss(0.07, 0.01)),
        Bore("back-seat", (0.0, 0.08, -0.12), 0.05),
    ),
    feet=Feet((0.04, 0.02, 0.05)),
    ribs=(Rib("top", "x", 0.0, 0.015, 0.01),),
)
AFTER = BoxGeometry(
    size=(0.21, 0.15, 0.25),
    wall=WallThickness(left=0.024, right=0.015, bottom=0.025, top=0.012, back=0.018, front=0.026),
    bores=(
        Bore("front-seat", (-0.025, 0.085, 0.125), 0.055, Boss(0.08, 0.014)),
        Bore("back-seat", (0.004, 0.075, -0.125), 0.044),
    ),
    feet=Feet((0.05, 0.03, 0.04)),
    ribs=(Rib("top", "x", 0.01, 0.022, 0.014),),
)
EDGE = 0.03


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return mesh_box(BEFORE, EDGE)


@pytest.fixture(scope="module")
def moved(mesh: Mesh) -> Mesh:
    return BoxMorph(mesh, BEFORE).moved(AFTER)


def test_every_face_of_the_moved_mesh_lies_where_the_dimensions_say(moved: Mesh) -> None:
    (x, y, z), foot = AFTER.size, AFTER.feet
    assert foot is not None
    places = {
        "left": (0, -x / 2),
        "right": (0, x / 2),
        "top": (1, y),
        "bottom": (1, 0.0),
        "back": (2, -z / 2),
        "front": (2, z / 2),
        **{f"foot-{number}": (1, -foot.size[1]) for number in range(1, 5)},
    }
    for name, (axis, place) in places.items():
        nodes = facet_nodes(moved.surface(name))
        assert np.abs(moved.points[nodes, axis] - place).max() < 1e-12, name
    for number, ways in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        under = moved.points[facet_nodes(moved.surface(f"foot-{number}"))]
        for axis, way in zip((0, 2), ways, strict=True):
            assert np.ptp(under[:, axis]) == pytest.approx(foot.size[axis], abs=1e-12)
            assert (way * under[:, axis]).max() == pytest.approx(AFTER.size[axis] / 2, abs=1e-12)


@pytest.mark.parametrize("number", [0, 1])
def test_bores_stay_round(mesh: Mesh, moved: Mesh, number: int) -> None:
    """Nodes keep their angle and part of the radius: some middles lie within it, where gmsh left edges straight."""
    bore, before = AFTER.bores[number], BEFORE.bores[number]
    nodes = facet_nodes(moved.surface(bore.name))
    arms = (moved.points[nodes, :2] - bore.center[:2]) / bore.diameter
    assert np.abs(arms - (mesh.points[nodes, :2] - before.center[:2]) / before.diameter).max() < 1e-12
    corners = facet_corners(moved.surface(bore.name))
    radius = np.linalg.norm(moved.points[corners, :2] - bore.center[:2], axis=1)
    assert np.abs(radius - bore.diameter / 2).max() < 1e-12
    start, end = AFTER.bore_span(bore)
    assert moved.points[nodes, 2].min() == pytest.approx(start, abs=1e-12)
    assert moved.points[nodes, 2].max() == pytest.approx(end, abs=1e-12)


def test_the_moved_mesh_fills_what_a_new_one_does(moved: Mesh) -> None:
    new = mesh_box(AFTER, EDGE / 2)
    assert moved.element_volumes.sum() == pytest.approx(new.element_volumes.sum(), rel=1e-3)  # facets on the cylinders
    assert moved.element_volumes.min() > 0.0
    assert mesh_quality(moved).shape[0] > 0.05


def test_nothing_moves_where_nothing_changes(mesh: Mesh) -> None:
    assert np.abs(BoxMorph(mesh, BEFORE).displacement(BEFORE)).max() < 1e-15


def test_motions_add_up_as_the_dimensions_do(mesh: Mesh) -> None:
    morph = BoxMorph(mesh, BEFORE)

    def wall(top: float, left: float) -> BoxGeometry:
        return replace(BEFORE, wall=replace(BEFORE.wall, top=0.02 + top, left=0.02 + left))

    one, other = morph.displacement(wall(1e-3, 0.0)), morph.displacement(wall(0.0, -2e-3))
    assert np.abs(morph.displacement(wall(1e-3, -2e-3)) - one - other).max() < 1e-15
    assert np.abs(morph.displacement(wall(2e-3, 0.0)) - 2.0 * one).max() < 1e-15
    assert np.abs(one[:, 1]).max() == pytest.approx(1e-3)


def test_a_morph_goes_on_from_a_moved_mesh(moved: Mesh) -> None:
    back = BoxMorph(moved, AFTER).moved(BEFORE)
    assert back.element_volumes.sum() == pytest.approx(mesh_box(BEFORE, EDGE).element_volumes.sum(), rel=1e-3)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (replace(BEFORE, ribs=()), "other parts"),
        (replace(BEFORE, feet=None), "other parts"),
        (replace(BEFORE, fillets=Fillets(inside=0.004)), "rounded edges"),
        (replace(BEFORE, feet=Feet((0.04, 0.02, 0.05), bolt_patch=0.02)), "bolts"),
    ],
)
def test_what_a_mesh_cannot_follow_is_said(mesh: Mesh, other: BoxGeometry, said: str) -> None:
    with pytest.raises(MorphError, match=said):
        BoxMorph(mesh, BEFORE).displacement(other)
    if said != "other parts":
        with pytest.raises(MorphError, match=said):
            BoxMorph(mesh, other)


def test_a_mesh_is_not_turned_inside_out(mesh: Mesh) -> None:
    far = replace(BEFORE, wall=WallThickness.uniform(0.001), ribs=(Rib("top", "x", 0.1, 0.2, 0.001),))
    with pytest.raises(MorphError, match="so far"):
        BoxMorph(mesh, BEFORE).moved(far)


def test_a_mesh_of_another_geometry_is_refused(mesh: Mesh) -> None:
    with pytest.raises(MorphError, match="none that the box's dimensions place"):
        BoxMorph(mesh, AFTER)
