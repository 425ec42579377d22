"""Input files of a case are read once: what changes in them later is not seen, or refused, and never mixed in."""

import json
import pickle
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from case_housings import mesh_of

import gearwhine as gw
from gearwhine.case import Case, CaseError, UpdateParameter, bundled_files, case_document, load_case, parse_case
from gearwhine.cli import run_command
from gearwhine.from_case.parametric_housing import fitted_case
from gearwhine.meshes import Mesh, write_mesh
from gearwhine.rotors import Bearing, Rotor, Segment, ShaftMaterial, write_ross

STEEL = {"youngs_modulus": 207e9, "poisson_ratio": 0.3, "density": 7850.0}
CHANGED = "the file as it was when the case was read; it has changed since"


def write_rotor(path: Path, length: float = 0.4, damping: float = 100.0) -> None:
    bearings = [Bearing(end, at, np.diag([1e8, 1e8]), damping * np.eye(2)) for end, at in (("a", 0.0), ("b", length))]
    segment = Segment(length, 0.03, 0.0, ShaftMaterial(207e9, 80e9, 7850.0))
    assert write_ross(path, Rotor("fan", [segment]), bearings) == ()


def digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()


def of_rotor(folder: Path) -> gw.CaseStudy:
    return gw.build(folder, rotor=[{"name": "shaft", "file": "fan.toml"}], operation={"speed": "3000 rpm"})


def test_an_option_of_other_input_files_is_not_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A Campbell diagram stays beside new modes of the same rotor; of bearings without damping none is left."""
    case = tmp_path / "case.toml"
    case.write_text('[[rotor]]\nname = "shaft"\nfile = "fan.toml"\n[operation]\nspeed = "3000 rpm"\n', encoding="utf-8")
    out = tmp_path / "out"

    def campbell(*options: str) -> Any:
        assert run_command(["system", str(case), "-q", "-o", str(out), *options]) == 0
        capsys.readouterr()
        return json.loads((out / "summary.json").read_text(encoding="utf-8")).get("campbell")

    write_rotor(tmp_path / "fan.toml")
    first = campbell("--campbell")
    assert first is not None
    assert campbell() == first
    # A comment changes no number: the results are the same, and the file is another one all the same.
    with (tmp_path / "fan.toml").open("a", encoding="utf-8") as file:
        file.write("# read again\n")
    assert campbell() is None


def test_a_changed_study_is_of_the_case_that_was_read(tmp_path: Path) -> None:
    """Three studies of one file that is rewritten between them, and of the shaft that it names."""
    file, lengths = tmp_path / "case.toml", (0.3, 0.4, 0.5)
    studies = []
    for number, length in enumerate(lengths):
        write_rotor(tmp_path / "fan.toml", length)
        file.write_text(f'title = "{number}"\n[[rotor]]\nname = "shaft"\nfile = "fan.toml"\n', encoding="utf-8")
        studies.append(gw.load(file))
    changed = [study.changed({"rotor.shaft.damping_ratio": 0.01}) for study in studies]
    assert [study.case.title for study in changed] == ["0", "1", "2"]
    assert [study.case.rotor[0].length for study in changed] == pytest.approx(lengths)
    twice = changed[0].changed({"notes": "again"})
    assert (twice.case.rotor[0].length, twice.case.rotor[0].damping_ratio) == (pytest.approx(0.3), 0.01)
    file.unlink()
    (tmp_path / "fan.toml").unlink()
    assert studies[1].changed({}).case == studies[1].case


def test_a_copy_of_a_case_has_the_files_of_its_tables_as_they_were_read(tmp_path: Path) -> None:
    write_rotor(tmp_path / "fan.toml")
    case, read = of_rotor(tmp_path).case, digest(tmp_path / "fan.toml")
    write_rotor(tmp_path / "fan.toml", 0.6)
    kept, without = case.model_copy(update={"title": "again"}), case.model_copy(update={"rotor": ()})
    assert kept.input_files.contents[str(tmp_path / "fan.toml")]["sha256"] == read
    assert not without.input_files.contents


def test_a_file_named_by_a_change_is_read_then(tmp_path: Path) -> None:
    """Also where another change of the same study has named it before, with other content."""
    write_rotor(tmp_path / "fan.toml")
    study, lengths = of_rotor(tmp_path), (0.2, 0.6)
    for length in lengths:
        write_rotor(tmp_path / "other.toml", length)
        changed = study.changed({"rotor.shaft.file": "other.toml"})
        assert changed.case.rotor[0].length == pytest.approx(length)
        assert [*changed.case.input_files.contents] == [str(tmp_path / "other.toml")]
    assert [*study.case.input_files.contents] == [str(tmp_path / "fan.toml")]


def test_results_are_written_with_the_digest_of_what_was_read(tmp_path: Path) -> None:
    file, out = tmp_path / "fan.toml", tmp_path / "out"
    write_rotor(file)
    read = digest(file)
    study = of_rotor(tmp_path)
    write_rotor(file, 0.5)
    study.rotors().write(out, pictures=False)
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert summary["input_files"] == {str(file): {"sha256": read, "ending": ".toml"}}
    assert summary["rotors"][0]["mass_kg"] == pytest.approx(7850.0 * np.pi / 4.0 * 0.03**2 * 0.4)
    assert run_command(["report", str(out), "-q"]) == 0
    assert "fan.toml has changed" in (out / "report.html").read_text(encoding="utf-8")


def test_a_case_takes_its_files_along(tmp_path: Path) -> None:
    """To a worker; and to the cases of other values, whose files are not read again."""
    write_rotor(tmp_path / "fan.toml")
    read = digest(tmp_path / "fan.toml")
    rotor = [{"name": "shaft", "file": str(tmp_path / "fan.toml")}]
    case = parse_case(case_document(load_case("steel-box").case) | {"rotor": rotor})
    write_rotor(tmp_path / "fan.toml", 0.5)
    top = UpdateParameter(name="top", keys=("housing.box.wall.top",), range=("5 mm", "20 mm"))
    cases = [pickle.loads(pickle.dumps(case)), fitted_case(case, parameters=[top]).at([0.012])]  # noqa: S301 - its own
    for other in cases:
        assert other.rotor[0].length == pytest.approx(0.4)
        assert other.input_files.contents[str(tmp_path / "fan.toml")]["sha256"] == read
    assert cases[0] == case
    assert parse_case(case_document(case)) != case


@pytest.fixture(scope="module")
def box() -> Mesh:
    return mesh_of(load_case("steel-box", ["housing.box.mesh_size=120 mm"]).case)


def of_mesh(folder: Path) -> gw.CaseStudy:
    housing = {"material": "steel", "modes": 8, "damping_ratio": 0.01, "mesh": {"file": "box.msh"}}
    return gw.build(folder, material={"steel": STEEL}, housing=housing)


def test_a_mesh_that_is_replaced_is_not_taken_for_the_one_that_was_solved(box: Mesh, tmp_path: Path) -> None:
    """A free body 10 % larger all over has frequencies lower by 1.1."""
    file = tmp_path / "box.msh"
    write_mesh(box, file)
    study, read = of_mesh(tmp_path), digest(file)
    result = study.modes()
    elastic = result.dataset["housing_frequency"].values[6:]
    unsolved = of_mesh(tmp_path)
    write_mesh(replace(box, points=1.1 * box.points), file)
    result.write(tmp_path / "out", pictures=False)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["input_files"][str(file)]["sha256"] == read != digest(file)

    changed = study.changed({"title": "changed"})
    assert changed.housing is study.housing
    with pytest.raises(CaseError, match=rf"housing\.mesh\.file: expected {CHANGED}"):
        unsolved.modes()
    with pytest.raises(CaseError, match=CHANGED):
        unsolved.changed({"title": "changed"}).modes()
    fresh = of_mesh(tmp_path).modes().dataset["housing_frequency"].values[6:]
    np.testing.assert_allclose(1.1 * fresh, elastic, rtol=1e-6)


def test_a_solid_that_is_replaced_is_refused_before_it_is_meshed(tmp_path: Path) -> None:
    file = tmp_path / "box.step"
    file.write_text("ISO-10303-21;\n", encoding="utf-8")
    housing = {"material": "steel", "modes": 8, "damping_ratio": 0.01, "cad": {"file": "box.step", "mesh_size": 0.02}}
    study = gw.build(tmp_path, material={"steel": STEEL}, housing=housing)
    file.write_text("", encoding="utf-8")
    with pytest.raises(CaseError, match=rf"housing\.cad\.file: expected {CHANGED}"):
        study.mesh()


def test_a_file_that_changes_while_it_is_read_is_refused(tmp_path: Path) -> None:
    """Else its content would have another one's digest."""
    file = tmp_path / "table.csv"
    file.write_text("0, 3e8\n1, 3e8\n", encoding="utf-8")
    files = with_table(file).input_files

    def reader(path: Path) -> str:
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("3e8", "4e8"), encoding="utf-8")
        return text

    with pytest.raises(ValueError, match=CHANGED):
        files.read(file, reader)
    file.unlink()
    with pytest.raises(ValueError, match=CHANGED):
        files.read(file, reader)


def with_table(file: Path) -> Case:
    changes = [f'gear_pair.0.stiffness={{ model = "table", file = "{file}" }}']
    return load_case("spur-pair", changes).case


def test_a_table_of_stiffness_is_the_one_that_was_read(tmp_path: Path) -> None:

    file = tmp_path / "table.csv"
    file.write_text("0, 3e8\n1, 3e8\n", encoding="utf-8")
    case, late = with_table(file), with_table(file)
    given = case.parts.gear_pairs[0].stiffness
    file.write_text("0, 4e8\n1, 4e8\n", encoding="utf-8")
    again = case.parts.gear_pairs[0].stiffness
    for table in (given, again):
        assert table.stiffness.tolist() == [3e8, 3e8]  # type: ignore[union-attr]
    with pytest.raises(CaseError, match=rf"gear_pair\[0\]\.stiffness\.file: expected {CHANGED}"):
        late.parts.gear_pairs[0]
    fresh = with_table(file)
    assert fresh.parts.gear_pairs[0].stiffness.stiffness.tolist() == [4e8, 4e8]  # type: ignore[union-attr]


def test_a_bundled_case_comes_with_the_files_that_it_reads() -> None:
    for name, ends in (("planetary-stage", ["toml", "step"]), ("spur-pair", ["toml"]), ("no-such-case", [])):
        assert [file.name for file in bundled_files(name)] == [f"{name}.{end}" for end in ends]
