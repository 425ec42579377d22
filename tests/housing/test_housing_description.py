"""A housing described whole: its supports cannot be left out, and a mesh that is none is refused."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearwhine.housing import Housing, HousingError, Joint, LumpedMass, Material, Patch, Seat, Sensor, Support
from gearwhine.housing.model.bushings import Bushing
from gearwhine.housing.model.cover_bolts import cover_joints
from gearwhine.housing.model.seats import bearing_port
from gearwhine.meshes import BoxGeometry, ElementBlock, Mesh, mesh_box, write_mesh
from gearwhine.meshes.box import Bore, Cover, CoverBolts, WallThickness

STEEL = Material(207e9, 0.3, 7850.0)
FOOT = Support("floor", surface="bottom", fixed=(True, True, True))
BOX = BoxGeometry(
    (0.2, 0.15, 0.18),
    WallThickness(0.02, 0.02, 0.02, 0.02, 0.02, 0.02),
    (Bore("front bearing", (0.0, 0.075, 0.09), 0.05), Bore("back bearing", (0.0, 0.075, -0.09), 0.05)),
)


@pytest.fixture(scope="module")
def box() -> Housing:
    sensors = [Sensor("top", (0.0, 0.15, 0.0))]
    return Housing.from_box(BOX, 0.06, STEEL, fixtures=[FOOT], sensors=sensors, damping_ratio=0.02)


def test_a_housing_of_a_mesh_file_is_that_of_its_mesh_in_its_unit(box: Housing, tmp_path: Path) -> None:
    write_mesh(box.mesh, tmp_path / "box.msh")
    support = replace(FOOT, surface="bottom")
    read = Housing.from_mesh_file(tmp_path / "box.msh", STEEL, seats=box.seats, fixtures=[support], damping_ratio=0.02)
    expected = box.modes(count=2).frequencies_hz
    np.testing.assert_allclose(read.modes(count=2).frequencies_hz, expected, rtol=1e-9)
    small = Housing.from_mesh_file(tmp_path / "box.msh", STEEL, unit=1e-3, fixtures=[support])
    np.testing.assert_allclose(small.modes(count=1).frequencies_hz, 1e3 * expected[:1], rtol=1e-6)


def test_a_clamped_housing_cannot_come_out_free(box: Housing) -> None:
    """Without its support the same solid has six rigid modes; described with it, none is lost on the way."""
    free = replace(box, fixtures=()).modes(count=8)
    assert (free.frequencies_hz[:6] == 0.0).all()
    assert free.frequencies_hz[6] > 100.0
    held = box.modes(count=2)
    assert (held.frequencies_hz > 100.0).all()
    assert held.modes.certificate.complete
    assert held.health.ok


def test_modes_carry_what_a_machine_takes_of_them(box: Housing) -> None:
    found = box.modes(count=3, bearings={"near the front": ("front bearing", 0.01)})
    n = len(found.frequencies_hz) + len(found.modes.residual_modes.frequencies if found.modes.residual_modes else ())
    assert set(found.seat_motions) == {"front bearing", "back bearing"}
    assert found.seat_motions["front bearing"].shape == (n, 6)
    assert found.sensor_motions["top"].shape == (n,)
    assert found.damping_ratios == pytest.approx([0.02] * 3)
    # What is fixed moves with the ground: Σ (φᵀ M R)² → the whole mass from below, as modes are added.
    mass = box.matrices().total_mass
    captured = float((found.participation[:3, 0] ** 2).sum())
    assert 0.0 < captured < mass


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"seats": [Seat("a", (0, 0, 0)), Seat("a", (0, 0, 0))]},
            "seat 'a': .*expected each name once; it is given 2 times",
        ),
        ({"fixtures": [FOOT, FOOT]}, "fixture 'floor': .*it is given 2 times"),
        ({"sensors": [Sensor("s", (0, 0, 0))] * 3}, "sensor 's': .*it is given 3 times"),
        ({"materials": {"rib": STEEL}}, "materials is 'rib'; expected a volume of the mesh, one of 'housing'"),
        ({"damping_ratio": 1.5}, "damping_ratio is 1.5"),
    ],
)
def test_what_is_no_housing_is_refused(box: Housing, changes: dict[str, Sequence[object]], words: str) -> None:
    with pytest.raises(HousingError, match=words):
        replace(box, **changes)


def test_a_fixture_without_a_place_is_refused_before_the_eigensolver(box: Housing) -> None:
    lost = Support("nowhere", box=((1.0, 1.0, 1.0), (2.0, 2.0, 2.0)), fixed=(True, True, True))
    with pytest.raises(ValueError, match=r"no surface|no facet"):
        replace(box, fixtures=[lost]).modes(count=1)
    with pytest.raises(HousingError, match="bearing 'x': no seat 'y' in the housing; expected one of 'front bearing'"):
        box.modes(count=1, bearings={"x": ("y", 0.0)})


def two_bodies() -> Mesh:
    one = mesh_box(BoxGeometry((0.1, 0.1, 0.1), WallThickness(*[0.02] * 6)), 0.05, order=1)
    shift = np.array([0.2, 0.0, 0.0])
    blocks = [ElementBlock(block.kind, np.vstack([block.nodes, block.nodes + len(one.points)])) for block in one.blocks]
    return Mesh(np.vstack([one.points, one.points + shift]), tuple(blocks))


def test_loose_bodies_are_refused_unless_a_joint_connects_them() -> None:
    mesh = two_bodies()
    with pytest.raises(HousingError, match="disconnected: the mesh falls into 2 bodies"):
        Housing(mesh, STEEL).modes(count=1)
    ends = (
        Patch(circle=((0.05, 0.05, 0.0), (1.0, 0.0, 0.0), 0.08)),
        Patch(circle=((0.15, 0.05, 0.0), (-1.0, 0.0, 0.0), 0.08)),
    )
    stiff = Bushing((1e9,) * 3 + (1e6,) * 3, (0.0,) * 6)
    joined = Housing(mesh, STEEL, fixtures=[Joint("bolt", *ends, stiff)])
    found = joined.modes(count=7)
    assert (found.frequencies_hz[:6] == 0.0).all()  # one free body, not two
    assert found.frequencies_hz[6] > 0.0
    further = Mesh(
        np.vstack([mesh.points, two_bodies().points + [0.0, 0.0, 0.5]]),
        (*mesh.blocks, *(ElementBlock(block.kind, block.nodes + len(mesh.points)) for block in mesh.blocks)),
    )
    with pytest.raises(
        HousingError, match=r"falls into 3 bodies that share no node and no joint: .* 25 % of the volume"
    ):
        Housing(further, STEEL, fixtures=[Joint("bolt", *ends, stiff)]).modes(count=1)


def test_lumped_masses_count_once(box: Housing) -> None:
    heavier = replace(box, fixtures=[FOOT, LumpedMass("motor", 5.0, position=(0.0, 0.15, 0.0))])
    assert heavier.matrices().total_mass == pytest.approx(box.matrices().total_mass + 5.0, rel=1e-9)
    assert heavier.modes(count=1).frequencies_hz[0] < box.modes(count=1).frequencies_hz[0]


def test_a_bearing_off_the_middle_of_its_seat_moves_with_the_seat_as_a_rigid_body(box: Housing) -> None:
    arm, turn = 0.012, np.array([0.3, -0.7, 0.0])
    seat = box.seats[0]
    field = np.cross(turn, box.mesh.points - seat.center).ravel()
    moved = bearing_port(box.seat_ports()[seat.name], arm) @ field
    assert moved == pytest.approx([*np.cross(turn, [0.0, 0.0, arm]), *turn[:2]], abs=1e-9)


def test_modes_below_a_limit_are_all_below_it_and_none_is_left_out(box: Housing) -> None:
    first = box.modes(count=4).frequencies_hz
    limit = 0.5 * (first[1] + first[2])
    assert box.modes(below_hz=limit).frequencies_hz == pytest.approx(first[:2], rel=1e-9)


def test_rigid_modes_take_part_with_the_whole_mass_and_what_is_fastened_to_it(box: Housing) -> None:
    """Σ (φᵀ M R)² over the six modes of a free body: its mass along each axis, its inertia about each."""
    fastened = LumpedMass("motor", 5.0, position=(0.0, 0.15, 0.0))
    free = replace(box, fixtures=[fastened])
    captured = (free.modes(count=7).participation[:6] ** 2).sum(axis=0)
    bare = (replace(box, fixtures=()).modes(count=7).participation[:6] ** 2).sum(axis=0)
    assert captured[:3] == pytest.approx([free.matrices().total_mass] * 3, rel=1e-6)
    # m (y² + z²), m (x² + z²), m (x² + y²) of a point near (0, 0.15, 0).
    assert (captured - bare)[3:] == pytest.approx([5.0 * 0.15**2, 0.0, 5.0 * 0.15**2], rel=0.05, abs=5.0 * 0.02**2)


def test_the_clamped_parts_of_a_cover_are_the_housing_s_and_the_bolts_their_own() -> None:
    """Both springs add; the cone of pressure is wider than the bolt, so that the parts' modulus counts for more."""
    soft, stiff = Material(70e9, 0.3, 2700.0), Material(210e9, 0.3, 7850.0)
    box = replace(BOX, cover=Cover("top", bolts=CoverBolts(0.006, (3, 3))))
    one, other = (cover_joints(box, parts, own)[0].bushing.stiffness for parts, own in ((stiff, soft), (soft, stiff)))
    assert max(one) > 1.1 * max(other)
