"""Parts of the surface by where they lie: on boxes, whose bores are known by name, and on bricks laid round an axis."""

import math

import numpy as np
import pytest

from gearwhine.meshes import (
    Bore,
    Boss,
    BoxGeometry,
    ElementBlock,
    Fillets,
    GeometryError,
    Mesh,
    WallThickness,
    box_facets,
    cylinder_facets,
    find_bores,
    mesh_box,
    plane_facets,
    with_bore,
)
from gearwhine.meshes.elements import Facets, facet_nodes


def _ring(
    sectors: int,
    radii: tuple[float, ...] = (0.03, 0.04),
    length: float = 0.05,
    *,
    begin: float = 0.0,
    arc: float = math.tau,
) -> Mesh:
    """Bricks round the z axis: a tube, or a part of one."""
    closed = arc == math.tau
    angles = begin + arc * np.arange(sectors + (0 if closed else 1)) / sectors
    heights = np.array([0.0, length])
    grid = np.array([[[(r * math.cos(a), r * math.sin(a), z) for z in heights] for r in radii] for a in angles])
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    cells = []
    for i in range(sectors):
        k = (i + 1) % len(angles)
        for j in range(len(radii) - 1):
            cells.append([number[i, j, 0], number[i, j + 1, 0], number[k, j + 1, 0], number[k, j, 0],
                          number[i, j, 1], number[i, j + 1, 1], number[k, j + 1, 1], number[k, j, 1]])  # fmt: skip
    return Mesh(grid.reshape(-1, 3), (ElementBlock("hexahedron", np.array(cells)),))


def _as_set(facets: Facets) -> set[tuple[int, ...]]:
    return {tuple(sorted(facet)) for block in facets for facet in block.nodes.tolist()}


def test_bores_of_a_box_are_the_surfaces_of_their_names(geometry: BoxGeometry, straight: Mesh, curved: Mesh) -> None:
    for mesh in (straight, curved):
        for bore in geometry.bores:
            found = cylinder_facets(mesh, bore.center, bore.diameter)
            assert _as_set(found) == _as_set(mesh.surface(bore.name)), bore.name


def test_all_bores_are_found_with_their_places(geometry: BoxGeometry, straight: Mesh, curved: Mesh) -> None:
    expected = []
    for bore in geometry.bores:
        begin, end = geometry.bore_span(bore)
        expected.append((bore.diameter, (*bore.center[:2], (begin + end) / 2), end - begin))
    expected.sort(key=lambda one: (-one[0], one[1]))  # the widest first, then by place
    for mesh in (straight, curved):
        found = find_bores(mesh)
        assert len(found) == len(expected)
        for bore, (diameter, center, length) in zip(found, expected, strict=True):
            assert bore.diameter == pytest.approx(diameter, abs=1e-8)
            assert bore.center == pytest.approx(center, abs=1e-8)
            assert bore.length == pytest.approx(length, abs=1e-8)
            assert bore.roundness == 1.0


def test_fillets_are_no_bores() -> None:
    geometry = BoxGeometry(
        (0.2, 0.16, 0.24),
        WallThickness.uniform(0.012),
        (Bore("a", (0.0, 0.08, 0.12), 0.05),),
        fillets=Fillets(inside=0.02, outside=0.008),
    )
    (bore,) = find_bores(mesh_box(geometry, 0.015, order=1))
    assert bore.diameter == pytest.approx(0.05)


def test_the_outside_of_a_boss_of_the_same_diameter_is_not_taken() -> None:
    geometry = BoxGeometry(
        (0.2, 0.16, 0.24),
        WallThickness.uniform(0.012),
        (Bore("a", (0.0, 0.08, 0.12), 0.05, Boss(0.07, 0.02)), Bore("b", (0.0, 0.08, -0.12), 0.07)),
    )
    mesh = mesh_box(geometry, 0.02, order=1)
    # Both cylinders of 70 mm lie on one axis; near the boss there is none to be found, at the bore there is.
    with pytest.raises(GeometryError, match=r"no bore of 70 mm .*70 mm at \(0, 80, -114\) mm"):
        cylinder_facets(mesh, (0.0, 0.08, 0.13), 0.07)
    assert _as_set(cylinder_facets(mesh, (0.0, 0.08, -0.13), 0.07)) == _as_set(mesh.surface("b"))


@pytest.mark.parametrize("sectors", [6, 7, 12, 40])
def test_coarse_rings_of_bricks_have_their_bore(sectors: int) -> None:
    mesh = _ring(sectors)
    (bore,) = find_bores(mesh)
    assert (bore.diameter, bore.length, bore.roundness) == pytest.approx((0.06, 0.05, 1.0))
    assert bore.center == pytest.approx((0.0, 0.0, 0.025), abs=1e-12)
    found = cylinder_facets(mesh, (0.0, 0.0, 0.0), 0.06)
    assert sum(map(len, found)) == sectors
    nodes = mesh.points[facet_nodes(found)]
    np.testing.assert_allclose(np.hypot(nodes[:, 0], nodes[:, 1]), 0.03)


def test_bores_along_any_axis(straight: Mesh, geometry: BoxGeometry) -> None:
    rng = np.random.default_rng(7)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    shift = np.array([0.3, -2.0, 1.0])
    turned = Mesh(straight.points @ turn.T + shift, straight.blocks, straight.surfaces)
    assert find_bores(turned) == () or len(find_bores(turned)) < len(geometry.bores)
    bores = find_bores(turned, axis=3.0 * turn[:, 2])
    assert [bore.diameter for bore in bores] == pytest.approx([0.04, 0.04, 0.03])
    first = geometry.bores[0]
    found = cylinder_facets(turned, turn @ np.array(first.center) + shift, first.diameter, axis=-turn[:, 2])
    assert _as_set(found) == _as_set(straight.surface(first.name))


def _two_halves(gap: float) -> Mesh:
    """A bore split at its axis, its halves as far apart as a joint that shares no nodes."""
    upper, lower = _ring(8, arc=math.pi), _ring(8, begin=math.pi, arc=math.pi)
    points = np.concatenate([upper.points + [0.0, gap / 2, 0.0], lower.points - [0.0, gap / 2, 0.0]])
    nodes = np.concatenate([upper.blocks[0].nodes, lower.blocks[0].nodes + len(upper.points)])
    return Mesh(points, (ElementBlock("hexahedron", nodes),))


def test_the_halves_of_a_split_bore_are_one_seat() -> None:
    mesh = _two_halves(1e-5)
    assert sum(map(len, cylinder_facets(mesh, (0.0, 0.0, 0.02), 0.06))) == 16
    (bore,) = find_bores(mesh)
    assert bore.roundness > 0.99


def test_half_a_bore_is_one_and_a_third_is_none() -> None:
    half = _ring(8, arc=math.pi)
    assert find_bores(half)[0].roundness == pytest.approx(0.5, abs=0.005)
    assert sum(map(len, cylinder_facets(half, (0.0, 0.0, 0.0), 0.06))) == 8
    third = _ring(8, arc=math.tau / 3)
    assert find_bores(third) == ()
    with pytest.raises(GeometryError, match="the mesh has no bore along"):
        cylinder_facets(third, (0.0, 0.0, 0.0), 0.06)


def _recess(profile: list[complex]) -> Mesh:
    """One brick behind each side of a polygon in the plane, 50 mm deep."""
    inside = np.array(profile)
    flat = np.concatenate([inside, inside.mean() + 1.5 * (inside - inside.mean())])
    heights = np.zeros(len(flat)), np.full(len(flat), 0.05)
    points = np.concatenate([np.column_stack([flat.real, flat.imag, z]) for z in heights])
    first = np.arange(len(profile))
    side = np.column_stack([first, first + len(first), np.roll(first, -1) + len(first), np.roll(first, -1)])
    return Mesh(points, (ElementBlock("hexahedron", np.column_stack([side, side + len(flat)])),))


def _arc(begin: float, end: float, sides: int, radius: float = 0.03) -> list[complex]:
    return list(radius * np.exp(1j * np.linspace(begin, end, sides + 1)))


@pytest.mark.parametrize("cut", [3e-3, 6e-3, 10e-3, 14e-3])
def test_a_square_recess_with_cut_corners_is_no_bore(cut: float) -> None:
    """Its eight corners lie on one circle."""
    corner = [0.03 + 1j * (0.03 - cut), 0.03 - cut + 0.03j]
    assert find_bores(_recess([1j**quarter * one for quarter in range(4) for one in corner])) == ()


@pytest.mark.parametrize("sides", [2, 3, 5])
def test_the_round_ends_of_a_slot_are_no_bores(sides: int) -> None:
    right, left = _arc(-0.5 * math.pi, 0.5 * math.pi, sides), _arc(0.5 * math.pi, 1.5 * math.pi, sides)
    for length in (1e-3, 5e-3):
        assert find_bores(_recess([one + length for one in right] + [one - length for one in left])) == ()


@pytest.mark.parametrize("sides", [5, 8])
def test_a_flat_is_no_part_of_its_bore_and_closes_a_half_one(sides: int) -> None:
    """A chord at 2/3 of the radius leaves 1 - arccos(2/3)/π of the circle."""
    begin = math.acos(2.0 / 3.0)
    (bore,) = find_bores(_recess(_arc(begin, math.tau - begin, sides)))
    assert bore.roundness == pytest.approx(1.0 - begin / math.pi, abs=0.004)
    assert bore.diameter == pytest.approx(0.06)
    assert find_bores(_recess(_arc(0.5 * math.pi, 1.5 * math.pi, sides))) == ()


def _of_second_order(mesh: Mesh, *, round_outside: bool, round_inside: bool) -> Mesh:
    """Bricks of 20 nodes, whose middle nodes lie on the inner or the outer circle or on their chords."""
    kind = ElementBlock("hexahedron20", np.arange(20)[None]).of
    points, nodes = list(mesh.points), [list(element) for element in mesh.blocks[0].nodes]
    least = np.hypot(*mesh.points[:, :2].T).min()
    for element in nodes:
        for place in kind.places[8:]:
            ends = [element[c] for c in range(8) if np.sum(np.abs(np.subtract(kind.places[c], place)) > 1e-9) == 1]
            middle = mesh.points[ends].mean(axis=0)
            radii = np.hypot(*mesh.points[ends, :2].T)
            inside = bool(radii.max() < 1.1 * least)
            if np.ptp(radii) < 1e-9 and (round_inside if inside else round_outside):
                middle[:2] *= radii[0] / np.hypot(*middle[:2])
            element.append(len(points))
            points.append(middle)
    return Mesh(np.array(points), (ElementBlock("hexahedron20", np.array(nodes)),))


@pytest.mark.parametrize("sides", [5, 6, 8])
def test_equal_walls_are_no_bore_where_the_mesh_is_curved(sides: int) -> None:
    """Only the middle nodes of their edges tell them from a coarse circle."""
    walls = _recess(_arc(0.0, math.tau, sides)[:-1])
    (bore,) = find_bores(_of_second_order(walls, round_outside=True, round_inside=True))
    assert bore.diameter == pytest.approx(0.06)
    assert find_bores(_of_second_order(walls, round_outside=True, round_inside=False)) == ()
    assert len(find_bores(_of_second_order(walls, round_outside=False, round_inside=False))) == 1


def test_of_two_bores_on_one_axis_the_nearest_is_taken() -> None:
    near, far = _ring(9), _ring(9)
    points = np.concatenate([near.points, far.points + [0.0, 0.0, 0.2]])
    nodes = np.concatenate([near.blocks[0].nodes, far.blocks[0].nodes + len(near.points)])
    mesh = Mesh(points, (ElementBlock("hexahedron", nodes),))
    for z, begin in ((0.1, 0.0), (0.14, 0.2), (0.25, 0.2)):
        found = mesh.points[facet_nodes(cylinder_facets(mesh, (0.0, 0.0, z), 0.06))]
        assert found[:, 2].min() == pytest.approx(begin)
    assert len(find_bores(mesh)) == 2


def test_a_part_of_a_bore_by_its_length() -> None:
    lower, upper = _ring(9), _ring(9)
    # One tube of two layers that share the nodes between them.
    on_top = {tuple(np.round(point, 9)): number for number, point in enumerate(lower.points) if point[2] > 0.04}
    points = list(lower.points)
    number = []
    for point in upper.points + [0.0, 0.0, 0.05]:
        key = tuple(np.round(point, 9))
        if key not in on_top:
            on_top[key] = len(points)
            points.append(point)
        number.append(on_top[key])
    nodes = np.concatenate([lower.blocks[0].nodes, np.array(number)[upper.blocks[0].nodes]])
    mesh = Mesh(np.array(points), (ElementBlock("hexahedron", nodes),))
    assert sum(map(len, cylinder_facets(mesh, (0.0, 0.0, 0.025), 0.06))) == 18
    assert sum(map(len, cylinder_facets(mesh, (0.0, 0.0, 0.025), 0.06, length=0.05))) == 9


@pytest.mark.parametrize(
    ("center", "diameter"), [((-0.035, 0.08, 0.12), 0.042), ((-0.030, 0.08, 0.12), 0.04), ((0.0, 0.0, 0.0), 0.04)]
)
def test_a_bore_that_is_not_there_is_answered_with_those_that_are(
    straight: Mesh, center: tuple[float, float, float], diameter: float
) -> None:
    with pytest.raises(GeometryError) as caught:
        cylinder_facets(straight, center, diameter)
    message = str(caught.value)
    assert message.startswith(f"no bore of {1e3 * diameter:g} mm around (")
    assert "40 mm at (-35, 80, 113) mm, 14 mm long" in message
    assert "30 mm at (45, 80, -113.5) mm, 13 mm long" in message
    if center[2] > 0:  # nearest first
        assert "bores found: 40 mm at (-35, 80, 113)" in message


def test_a_center_and_diameter_within_tolerance_will_do(straight: Mesh, geometry: BoxGeometry) -> None:
    bore = geometry.bores[0]
    found = cylinder_facets(straight, np.array(bore.center) + [1e-4, 1e-4, 0.0], bore.diameter + 2e-4)
    assert _as_set(found) == _as_set(straight.surface(bore.name))


def test_a_surface_of_the_name_goes_before_the_bore(straight: Mesh) -> None:
    assert with_bore(straight, "top", (9.0, 9.0, 9.0), 1.0) is straight
    named = with_bore(straight, "drive side", (-0.035, 0.08, 0.12), 0.04)
    assert _as_set(named.surface("drive side")) == _as_set(straight.surface("input-front"))
    assert set(named.surfaces) == {*straight.surfaces, "drive side"}


@pytest.mark.parametrize(
    ("name", "point", "normal"), [("top", (9.0, 0.16, -3.0), (0, 2, 0)), ("left", (-0.1, 0, 0), (1, 0, 0))]
)
def test_a_plane_takes_the_face_that_lies_on_it(
    straight: Mesh, name: str, point: tuple[float, float, float], normal: tuple[float, float, float]
) -> None:
    assert _as_set(plane_facets(straight, point, normal)) == _as_set(straight.surface(name))


def test_a_plane_takes_all_feet_at_once(straight: Mesh) -> None:
    feet = set[tuple[int, ...]]().union(*(_as_set(straight.surface(f"foot-{number}")) for number in range(1, 5)))
    assert _as_set(plane_facets(straight, (0.0, -0.02, 0.0), (0.0, 1.0, 0.0))) == feet


def test_planes_and_boxes_without_surface_say_what_there_is(straight: Mesh) -> None:
    with pytest.raises(GeometryError, match=r"spans -0\.02 to 0\.16 m along it, and the nearest .* lies at -0\.02 m"):
        plane_facets(straight, (0.0, -0.021, 0.0), (0.0, 1.0, 0.0))
    with pytest.raises(GeometryError, match="has no direction"):
        plane_facets(straight, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(GeometryError, match=r"no facet of the surface lies in the box"):
        box_facets(straight, (1.0, 1.0, 1.0), (2.0, 2.0, 2.0))
    with pytest.raises(GeometryError, match="must be positive"):
        cylinder_facets(straight, (0.0, 0.0, 0.0), 0.0)


def test_a_box_takes_the_facets_whose_corners_are_in_it(straight: Mesh) -> None:
    found = box_facets(straight, (-0.1001, -0.0201, -0.1201), (-0.0699, -0.0199, -0.0799))
    assert _as_set(found) == _as_set(straight.surface("foot-1"))
