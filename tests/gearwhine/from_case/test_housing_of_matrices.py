"""An imported gear unit on the matrices of its housing: nodes by free rigid motions, and two commands to a spectrum."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from reduced_frames import FRAME_COORDINATES, LENGTH, PLACES, frame, write_dmig
from rexs_files import POINTS, _at, add_reduced_casing, helical_stage

import gearwhine as gw
from gearwhine.cli.command_line import run_command
from gearwhine.housing import HousingError
from gearwhine.housing.reduced import LabelledMatrix
from gearwhine.housing.reduced.assignment import assign_nodes, free_positions

FloatArray = npt.NDArray[np.float64]

# x, y, z of the case are v, w, u of the gear unit [m]; its nodes come in another order than the bearings.
CENTERS = {name: np.array([v, w, u]) * 1e-3 for name, (u, v, w) in POINTS.items()}
NODES = {"NU 207": 3, "6205": 8, "rear": 11, "front": 40}


def rigid(center: FloatArray) -> FloatArray:
    """Six motions of a node by translations and rotations about the origin, (6, 6): the displacement is θ × r."""
    return np.block([[np.eye(3), np.cross(np.eye(3), center).T], [np.zeros((3, 3)), np.eye(3)]])


def free_housing() -> tuple[FloatArray, FloatArray]:
    """Mass and stiffness of four nodes of 10 kg in SI, springs between what is not a rigid motion of all."""
    stiffness = springs_between(np.array([CENTERS[name] for name in NODES]))
    return np.diag(np.tile([10.0] * 3 + [0.05] * 3, len(NODES))), stiffness


def in_millimetres(matrix: FloatArray) -> FloatArray:
    """A matrix of SI in N/mm, t and mm: energies in mJ, translations in mm."""
    length = np.tile([1e-3] * 3 + [1.0] * 3, len(matrix) // 6)
    return 1e3 * length[:, None] * matrix * length


def written(folder: Path, ground: float = 0.0) -> Path:
    mass, stiffness = free_housing()
    stiffness = stiffness + ground * np.diag(np.tile([1.0] * 3 + [1e-2] * 3, len(NODES)))
    coordinates = [(node, axis) for node in NODES.values() for axis in range(1, 7)]
    matrices = {"MAAX": in_millimetres(mass), "KAAX": in_millimetres(stiffness)}
    (folder / "unit.rexs").write_bytes(helical_stage().xml())
    return write_dmig(folder / "box.pch", matrices, coordinates)


def test_swapped_nodes_and_units_are_found_by_the_free_motions_of_a_frame() -> None:
    """The frame's bodies stand at 0 and at L along z: swapped, or in other units, its rotations would be strained."""
    for length, mass, units in ((1.0, 1.0, "SI"), (1e-3, 1e3, "mm-t-s")):
        read = dict(zip(("mass", "stiffness"), frame(length, mass), strict=True))
        labelled = {kind: LabelledMatrix(matrix, tuple(FRAME_COORDINATES)) for kind, matrix in read.items()}
        for places, nodes in (([*PLACES.values()], (101, 205)), ([*PLACES.values()][::-1], (205, 101))):
            found = assign_nodes(labelled, places)
            assert (found.nodes, found.units, found.is_proved) == (nodes, units, True)
        one = assign_nodes({kind: LabelledMatrix(matrix) for kind, matrix in read.items()}, [*PLACES.values()])
        assert (one.nodes, one.units, one.by_order) == ((1, 2), units, True)


def springs_between(positions: FloatArray) -> FloatArray:
    """Stiffness of springs that resist every motion of nodes but the rigid ones of all, (6 n, 6 n)."""
    motions = np.vstack([rigid(place) for place in positions])
    size = np.tile([1.0] * 3 + [0.05] * 3, len(positions))
    q, _ = np.linalg.qr(size[:, None] * motions)
    matrix = size[:, None] * (2e8 * (np.eye(len(motions)) - q @ q.T)) * size
    return 0.5 * (matrix + matrix.T)


def test_four_of_eleven_nodes_are_found_by_the_positions_that_free_motions_tell() -> None:
    """Feet and sensors among the nodes: eleven nodes have 7,920 orders of four. The file's origin is another one."""
    positions = np.random.default_rng(7).uniform(-0.3, 0.3, (11, 3))
    coordinates = tuple((10 * number, axis) for number in range(1, 12) for axis in range(1, 7))
    places = positions[[8, 2, 10, 5]] + [0.2, -0.1, 0.4]
    stiffness = springs_between(positions)
    np.testing.assert_allclose(free_positions(stiffness), positions - positions[0], atol=1e-9)
    for matrix, units in ((stiffness, "SI"), (in_millimetres(stiffness), "mm-t-s")):
        found = assign_nodes({"stiffness": LabelledMatrix(matrix, coordinates)}, [tuple(one) for one in places])
        assert (found.nodes, found.units, found.is_proved) == ((90, 30, 110, 60), units, True)
        assert set(found.others) == {10, 20, 40, 50, 70, 80, 100}
        for node, place in found.others.items():
            np.testing.assert_allclose(place, positions[node // 10 - 1] + [0.2, -0.1, 0.4], atol=1e-8)
    # A foot on a spring: nothing is free any more, and nothing tells the positions.
    held = stiffness.copy()
    held[0, 0] += 1e9
    assert free_positions(held) is None
    assert not assign_nodes({"stiffness": LabelledMatrix(held, coordinates)}, [tuple(one) for one in places]).is_proved


def test_what_is_held_proves_nothing_and_its_lever_tells_the_units() -> None:
    """Springs of k on an arm of a fifth of the length: moments over forces have its square, in mm or in m."""
    springs = np.diag(np.tile([1e8] * 3 + [1e8 * (0.2 * LENGTH) ** 2] * 3, 2))
    for matrix, units in ((springs, "SI"), (in_millimetres(springs), "mm-t-s")):
        found = assign_nodes({"stiffness": LabelledMatrix(matrix, tuple(FRAME_COORDINATES))}, [*PLACES.values()])
        assert (found.nodes, found.units, found.is_proved) == ((101, 205), units, False)
    few = {"stiffness": LabelledMatrix(springs, tuple(FRAME_COORDINATES))}
    with pytest.raises(HousingError, match="expected 3 nodes with six motions, one for each bearing; the file has 2"):
        assign_nodes(few, [*PLACES.values(), (1.0, 0.0, 0.0)])


def test_seats_stand_under_the_bearings_whatever_the_order_of_the_nodes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "unit.rexs", "--housing", "box.pch", "-o", "made/unit.toml"]) == 0
    assert "in mm-t-s: its rigid motions are free by them" in " ".join(capsys.readouterr().out.split())
    study = gw.load("made/unit.toml")
    table = study.case.reduced_housing
    assert table is not None
    nodes = {seat.name.removesuffix(" seat"): seat.node for seat in table.seat}
    assert nodes == NODES
    for seat in table.seat:
        np.testing.assert_allclose(seat.center, CENTERS[seat.name.removesuffix(" seat")], atol=1e-12)
    certificate = study.check().document["reduced_housing"]["certificate"]
    assert certificate["free_rigid_motions"] == 6
    assert certificate["mass_kg"] == pytest.approx(40.0)
    assert {bearing.seat for bearing in study.case.bearing} == {f"{name} seat" for name in POINTS}


def test_a_free_housing_is_held_softly_and_one_that_the_matrices_hold_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Equal springs k under equal bodies m: as a whole they move at √(k/m) along each axis, which is to be 50 Hz."""
    monkeypatch.chdir(tmp_path)
    for folder, ground, held in (("free", 0.0, 4), ("held", 1e8, 0)):
        (tmp_path / folder).mkdir()
        written(tmp_path / folder, ground)
        command = ["import", f"{folder}/unit.rexs", "--housing", f"{folder}/box.pch", "-o", f"{folder}/unit.toml"]
        assert run_command(command) == 0
        assert ("nothing holds it: springs at its seats" in capsys.readouterr().out) == bool(held)
        study = gw.load(f"{folder}/unit.toml")
        table = study.case.reduced_housing
        assert table is not None
        assert len(table.support) == held
        if held:
            frequencies = np.array(study.check().document["reduced_housing"]["frequencies_hz"][:6])
            # Two digits of the springs are 2.5 % of them at most.
            assert (np.abs(frequencies / 50.0 - 1.0) < 0.0125).sum() >= 3
            assert frequencies[0] > 25.0


def test_nodes_beside_the_seats_get_sensors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A node on the lid, 0.3 m above the first bearing, for the accelerometer that measures there."""
    lid = CENTERS["6205"] + [0.0, 0.3, 0.02]
    nodes = {**{f"{name}": node for name, node in NODES.items()}, "lid": 301}
    stiffness = springs_between(np.array([*(CENTERS[name] for name in NODES), lid]))
    mass = np.diag(np.tile([10.0] * 3 + [0.05] * 3, len(nodes)))
    coordinates = [(node, axis) for node in nodes.values() for axis in range(1, 7)]
    write_dmig(tmp_path / "box.pch", {"MAAX": mass, "KAAX": stiffness}, coordinates)
    (tmp_path / "unit.rexs").write_bytes(helical_stage().xml())
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "unit.rexs", "--housing", "box.pch"]) == 0
    assert "a sensor along y at each seat, and at 1 other node" in " ".join(capsys.readouterr().out.split())
    table = gw.load("unit.toml").case.reduced_housing
    assert table is not None
    (sensor,) = (one for one in table.sensor if one.node == 301)
    assert sensor.name == "at node 301"
    np.testing.assert_allclose(sensor.position, lid, atol=1e-7)
    assert gw.load("unit.toml").check().document["reduced_housing"]["certificate"]["free_rigid_motions"] == 6


def test_the_matrices_take_the_place_of_a_static_stiffness_in_the_file_of_the_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written(tmp_path)
    file = helical_stage()
    add_reduced_casing(file, np.diag([2e5, 2e5, 2e5, 1e8, 1e8, 1e8] * 4).tolist(), _at(0.0))
    (tmp_path / "unit.rexs").write_bytes(file.xml())
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "unit.rexs", "--housing", "box.pch"]) == 0
    assert "the schema states no unit" not in capsys.readouterr().out + (tmp_path / "unit.toml").read_text("utf-8")
    table = gw.load("unit.toml").case.reduced_housing
    assert table is not None
    assert table.reduced.stiffness.name == "box.pch"
    assert {seat.node for seat in table.seat} == set(NODES.values())


@pytest.mark.parametrize("given", [False, True])
def test_rows_of_an_external_superelement_are_named_by_its_punch_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], given: bool
) -> None:
    """What EXTSEOUT writes: matrices in one file, and the order of their rows beside them, a scalar point first."""
    mass, stiffness = free_housing()
    matrices = {"MAA": in_millimetres(mass), "KAA": in_millimetres(stiffness)}
    text = ""
    for name, matrix in matrices.items():
        whole = np.diag([3e-3 if name == "MAA" else 4e5, *np.zeros(24)])
        whole[1:, 1:] = matrix
        text += f"{25:8}{25:8}{6:8}{2:8}{name:<8}1P,3E23.16\n"
        for number, column in enumerate(whole, start=1):
            text += f"{number:8}{1:8}{25:8}\n" + "".join(f"{one:23.16E}\n" for one in column)
        text += f"{26:8}{1:8}{1:8}\n{1.0:23.16E}\n"
    (tmp_path / "se.op4").write_text(text)
    punch = tmp_path / ("rows.pch" if given else "se.pch")
    points = "".join(f"{node:8}  123456" for node in NODES.values())
    punch.write_text(f"BEGIN SUPER       75\nEXTRN{9001:11}       0{points[:48]}\n        {points[48:]}\n")
    (tmp_path / "unit.rexs").write_bytes(helical_stage().xml())
    monkeypatch.chdir(tmp_path)
    options = ["--mapping", "rows.pch"] if given else []
    assert run_command(["import", "unit.rexs", "--housing", "se.op4", *options, "-o", "made/unit.toml"]) == 0
    words = " ".join(capsys.readouterr().out.split())
    assert f"rows by {punch.name}; nodes" in words
    assert "in mm-t-s: its rigid motions are free by them" in words
    study = gw.load("made/unit.toml")
    table = study.case.reduced_housing
    assert table is not None
    assert table.reduced.mapping is not None
    assert {seat.name.removesuffix(" seat"): seat.node for seat in table.seat} == NODES
    assert study.check().document["reduced_housing"]["certificate"]["free_rigid_motions"] == 6


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--mass", "box.pch"], "--mass: expected --housing beside it"),
        (["--mapping", "box.pch"], "--mapping: expected --housing beside it"),
        (["--housing", "box.pch", "--mapping", "box.pch"], "box.pch has no card EXTRN"),
        (["--housing", "none.pch"], "--housing: expected matrices of a housing; none.pch: expected a readable file"),
        (["--housing", "unit.rexs"], "expected a file that ends in one of .mtx"),
        (["--housing", "small.npz"], "the order of the stiffness is 2"),
    ],
)
def test_refused_by_the_option(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    words: str,
) -> None:
    written(tmp_path)
    np.savez(tmp_path / "small.npz", k=np.eye(2))
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "unit.rexs", *arguments]) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "unit.toml").exists()


@pytest.mark.slow
def test_two_commands_from_the_files_to_the_spectrum_at_a_sensor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The lines of a sensor stand at multiples of the mesh frequency, that of 20 teeth on the input."""
    written(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "unit.rexs", "--housing", "box.pch"]) == 0
    capsys.readouterr()
    loose = ("--set", "transient.tolerance=5e-3")
    assert run_command(["run", "unit.toml", "-o", "out", "--json", "--no-pictures", *loose]) == 0
    operation = gw.load("unit.toml").case.operation
    assert operation is not None
    mesh = 20.0 * operation.speed / (2.0 * np.pi)
    document: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert [one["name"] for one in document["sensors"]] == [f"at {name}" for name in POINTS]
    for sensor in document["sensors"]:
        highest = sensor["peaks"][0]["frequency_hz"]
        assert round(highest / mesh) >= 1
        assert highest / mesh == pytest.approx(round(highest / mesh), abs=1e-2)
        assert sensor["peaks"][0]["amplitude_m_per_s2"] > 1e-3
