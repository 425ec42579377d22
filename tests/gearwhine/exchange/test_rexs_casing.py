"""Reduced stiffness of the casing in a REXS file: read with the unit, under load beside springs, refused by name."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rexs_files import POINTS, RexsFile, _at, add_reduced_casing, helical_stage

import gearwhine as gw
from gearwhine.case import CaseError
from gearwhine.cli.command_line import run_command
from gearwhine.exchange.rexs import RexsError, case_of, read_content, read_rexs
from gearwhine.exchange.rexs.reduced_casing import casing_of, casing_stiffness

ALONG_U, ALONG_V, ALONG_W, TILT = 4e5, 2e5, 1e5, 5e8
"""Springs at each reduction point [N/mm], and about each axis [N mm/rad]."""
TURNED = {
    "support_vector": ([0.0, 0.0, 0.0], "mm"),
    "u_axis_vector": ([0.0, 1.0, 0.0], "mm"),
    "w_axis_vector": ([1.0, 0.0, 0.0], "mm"),
    "reference_component_for_position": (1, "none"),
}
"""Axes of a group: u is v of the gear unit, w is its u, and v its w."""


def springs(order: tuple[float, float, float] = (ALONG_U, ALONG_V, ALONG_W)) -> list[list[float]]:
    """Springs to the ground at each point, in the order of the group's axes."""
    return np.diag(([*order] + [TILT] * 3) * len(POINTS)).tolist()  # type: ignore[no-any-return]


def on_springs(place: Any = None, matrix: list[list[float]] | None = None, **more: Any) -> RexsFile:
    file = helical_stage()
    add_reduced_casing(file, springs() if matrix is None else matrix, place or _at(0.0), **more)
    return file


@pytest.mark.parametrize(
    ("place", "order"), [(None, (ALONG_U, ALONG_V, ALONG_W)), (TURNED, (ALONG_V, ALONG_W, ALONG_U))]
)
def test_the_load_moves_each_seat_by_its_springs(tmp_path: Path, place: Any, order: tuple[float, float, float]) -> None:
    """Seats move by force over stiffness: x, y, z are v, w, u of the gear unit, whatever the axes of the group."""
    (tmp_path / "unit.rexs").write_bytes(on_springs(place, springs(order)).xml())
    bearings = gw.load(tmp_path / "unit.rexs").operating_point().document["bearings"]
    assert {one["seat"] for one in bearings} == {f"{name} seat" for name in POINTS}
    stiffness = 1e3 * np.array([ALONG_V, ALONG_W, ALONG_U])
    for bearing in bearings:
        expected = np.array(bearing["force_n"]) / stiffness
        np.testing.assert_allclose(bearing["seat_displacement_m"][:3], expected, rtol=1e-6, atol=1e-13)
    assert max(abs(force) for bearing in bearings for force in bearing["force_n"]) > 300.0


def test_the_case_names_the_file_and_what_is_assumed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "unit.rexs").write_bytes(on_springs().xml())
    monkeypatch.chdir(tmp_path)
    assert run_command(["import", "files/unit.rexs", "-o", "made/unit.toml"]) == 0
    text = (tmp_path / "made" / "unit.toml").read_text("utf-8")
    assert 'stiffness = "../files/unit.rexs"' in text
    assert "a matrix in N, mm and rad, since the schema states no unit" in text
    checked = gw.load("made/unit.toml").check()
    assert len(checked.document["reduced_housing"]["seats"]) == 4
    assert any("follows its loads without resonances of its own" in one for one in checked.warnings)


def test_the_stiffness_is_written_as_it_was_read(tmp_path: Path) -> None:
    """A matrix with couplings, of a group whose axes are turned, comes back along the axes of the gear unit."""
    draw = np.random.default_rng(3).normal(size=(24, 24))
    matrix = np.array(springs()) + 2e3 * (draw @ draw.T)
    (tmp_path / "unit.rexs").write_bytes(on_springs(TURNED, matrix.tolist()).xml())
    study = gw.load(tmp_path / "unit.rexs")
    study.export_rexs(tmp_path / "back.rexs")
    first, second = (casing_stiffness(read_rexs(tmp_path / name)) for name in ("unit.rexs", "back.rexs"))
    one, other = (casing_of(read_rexs(tmp_path / name)) for name in ("unit.rexs", "back.rexs"))
    assert one is not None
    assert other is not None
    names = [point.name.removeprefix("at ") for point in one.points]
    rows = [6 * names.index(point.name.removesuffix(" seat")) + axis for point in other.points for axis in range(6)]
    size = np.sqrt(np.diag(second.values))
    np.testing.assert_allclose(
        first.values[np.ix_(rows, rows)] / np.outer(size, size), second.values / np.outer(size, size), atol=1e-9
    )
    again = gw.load(tmp_path / "back.rexs").case
    assert again.reduced_housing is not None
    assert study.case.reduced_housing is not None
    places = {seat.name: seat.center for seat in study.case.reduced_housing.seat}
    for seat in again.reduced_housing.seat:
        np.testing.assert_allclose(seat.center, places[seat.name], atol=1e-12)
    ordered = [relation.order for relation in read_rexs(tmp_path / "back.rexs").of_relation("ordered_assembly")]
    assert ordered[-4:] == [1, 2, 3, 4] or ordered[:4] == [1, 2, 3, 4]


@pytest.mark.slow
def test_the_load_is_the_same_on_the_static_stiffness_of_a_solved_housing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seats of the box and of its stiffness in a file move alike, where modes of OUT give the stiffness."""
    monkeypatch.chdir(tmp_path)
    coarse = ["--set", "housing.box.mesh_size=40 mm"]
    assert run_command(["load", "small-gearbox", "-o", "out", *coarse]) == 0
    assert run_command(["export", "small-gearbox", "--rexs", "unit.rexs", "-o", "out", *coarse]) == 0
    ours = gw.load("small-gearbox", {"housing.box.mesh_size": "40 mm"}).operating_point().document["bearings"]
    theirs = gw.load("unit.rexs").operating_point().document["bearings"]
    moved = {bearing["name"]: np.array(bearing["seat_displacement_m"][:3]) for bearing in ours}
    largest = max(np.abs(one).max() for one in moved.values())
    for bearing in theirs:
        assert bearing["seat"] == f"{bearing['name']} seat"
        np.testing.assert_allclose(bearing["seat_displacement_m"][:3], moved[bearing["name"]], atol=1e-4 * largest)


@pytest.mark.slow
def test_a_run_ends_on_a_static_housing(tmp_path: Path) -> None:
    (tmp_path / "unit.rexs").write_bytes(on_springs().xml())
    study = gw.load(tmp_path / "unit.rexs", {"transient.revolutions": 3.0, "transient.discard": 1.0})
    assert study.run().document["sensors"] == []


@pytest.mark.parametrize("where", ["no boundary", "no points", "another shaft"])
def test_what_has_no_use_is_left_out(where: str) -> None:
    more = {"matrix_with_inertial_environment_boundary": (False, "none")} if where == "no boundary" else {}
    file = on_springs(**more)
    if where == "no points":
        file.relations = [one for one in file.relations if one["type"] != "ordered_assembly"]
    if where == "another shaft":
        points = [one["id"] for one in file.components if one["type"] == "reduction_point"]
        file.relations = [one for one in file.relations if ("origin", points[0]) not in one["roles"]]
        file.relations = [
            one for one in file.relations if not any(("origin", point) in one["roles"] for point in points)
        ]
    made = case_of(read_content(file.xml()), "unit.rexs")
    assert "housing" not in made.document
    assert {one["seat"] for one in made.document["bearing"]} == {"ground"}
    (note,) = (one for one in made.notes if "assembly_group" in one.about)
    assert note.kind == "left out"
    unused = "no reduction point refers to a bearing"
    reason = unused if where == "another shaft" else "no reduced stiffness of the casing against the ground"
    assert note.text.startswith(reason)


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (springs()[:-1], "expected a matrix of 24 x 24 numbers, six for each of 4 reduction points"),
        ([row[:-1] for row in springs()], "expected a matrix of 24 x 24 numbers"),
        ([["many", *row[1:]] for row in springs()], "expected finite numbers, got .*many"),
    ],
)
def test_another_matrix_is_refused(matrix: Any, words: str) -> None:
    with pytest.raises(RexsError, match=f"reduced_static_stiffness_matrix: {words}"):
        case_of(read_content(on_springs(matrix=matrix).xml()), "unit.rexs")


def test_a_case_on_a_file_without_a_casing_is_refused_by_its_key(tmp_path: Path) -> None:
    (tmp_path / "unit.rexs").write_bytes(on_springs().xml())
    study = gw.load(tmp_path / "unit.rexs")
    (tmp_path / "other.rexs").write_bytes(helical_stage().xml())
    with pytest.raises(CaseError, match=r"housing.reduced.stiffness: .* an assembly_group that has reduction"):
        study.changed({"housing.reduced.stiffness": str(tmp_path / "other.rexs")}).check()
