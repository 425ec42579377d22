"""By what kept modes are known again: what changes them changes the key, and nothing else does."""

import ast
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import pytest
from case_housings import mesh_of

import gearwhine
from gearwhine.case import Case, Housing, case_document, load_case, parse_case
from gearwhine.from_case.given_housing import MODES_CODE, given_housing
from gearwhine.housing.modes import eigensolver
from gearwhine.housing.modes.eigensolver import arpack_modes
from gearwhine.housing.storage.netcdf import content_key
from gearwhine.meshes import write_mesh
from gearwhine.numerics.source_digest import _source_files, source_digest
from gearwhine.solve.housing_modes import solve_housing

CASE = "nasa-gear-noise-rig"


def key(case: Case) -> str:
    mesh = mesh_of(case) if case.housing is not None and case.housing.mesh is not None else None
    return content_key(given_housing(case).cache_inputs(mesh))


@pytest.fixture(scope="module")
def rig() -> str:
    return key(load_case(CASE).case)


@pytest.mark.slow
def test_both_eigensolvers_of_a_case_give_the_same_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def counted(*arguments: Any, **options: Any) -> Any:
        calls.append(options)
        return arpack_modes(*arguments, **options)

    monkeypatch.setattr(eigensolver, "arpack_modes", counted)
    coarse = ['housing.box.mesh_size="40 mm"', "housing.frequency_limit=", "housing.modes=6"]
    block = solve_housing(load_case("steel-box", coarse).case)
    assert not calls
    arpack = solve_housing(load_case("steel-box", [*coarse, 'housing.solver="eigsh"']).case)
    assert calls
    assert arpack.modes.frequencies == pytest.approx(block.modes.frequencies, rel=1e-9)


WITHOUT_EFFECT = [
    'title="Another title"',
    'notes="Other notes"',
    "housing.damping_ratio=0.02",
    'housing.sensor.0.position=["0 mm", "254 mm", "10 mm"]',
    'housing.sensor.0.name="elsewhere"',
    "housing.sensor=",
    'rotor.input.segments.0.length="81 mm"',
    'gear.driver.face_width="7 mm"',
    'operation.speed="1500 rpm"',
    "transient.tolerance=1e-3",
    'measured.frequencies=["700 Hz", "1000 Hz"]',
    "provenance=",
]


@pytest.mark.parametrize("change", WITHOUT_EFFECT)
def test_what_does_not_enter_the_modes_keeps_the_key(rig: str, change: str) -> None:
    assert key(load_case(CASE, [change]).case) == rig


WITH_EFFECT = [
    'housing.box.mesh_size="40 mm"',
    'housing.box.wall.top="6.4 mm"',
    'housing.box.size=["280 mm", "254 mm", "330 mm"]',
    'housing.seat.input-back.diameter="61 mm"',
    'housing.seat.input-back.boss.length="9.5 mm"',
    'housing.support.0.stiffness.x="5.4e8 N/m"',
    'housing.frequency_limit="3.3 kHz"',
    'material.steel.density="7851 kg/m^3"',
    "material.steel.poisson_ratio=0.31",
    'material.steel.youngs_modulus="207.0000001 GPa"',
]


def test_what_enters_the_modes_changes_the_key(rig: str) -> None:
    keys = [key(load_case(CASE, [change]).case) for change in WITH_EFFECT]
    assert len({rig, *keys}) == 1 + len(WITH_EFFECT)


def test_units_and_spelling_of_the_file_do_not_matter(rig: str) -> None:
    case = load_case(CASE).case
    assert key(parse_case(case_document(case))) == rig
    assert key(load_case(CASE, [f'housing.box.mesh_size="{1e6 * case.housing.box.mesh_size:.17g} um"']).case) == rig


def test_a_material_that_the_housing_does_not_name_does_not_matter(rig: str) -> None:
    document = case_document(load_case(CASE).case)
    document["material"]["brass"] = {"youngs_modulus": 1e11, "poisson_ratio": 0.34, "density": 8500.0}
    assert key(parse_case(document)) == rig


class LaterHousing(Housing):
    """A housing of some later version, which has one more key."""

    extra_stiffening: float = 0.0


def test_a_key_that_nobody_has_thought_of_counts(rig: str) -> None:
    case = load_case(CASE).case
    later = [
        case.model_copy(update={"housing": LaterHousing(**dict(case.housing), extra_stiffening=value)})
        for value in (1.0, 2.0)
    ]
    assert len({rig, *map(key, later)}) == 3


def of_mesh(file: Path, **changes: Any) -> Case:
    document: dict[str, Any] = {
        "material": {"steel": {"youngs_modulus": 207e9, "poisson_ratio": 0.3, "density": 7850.0}},
        "housing": {"material": "steel", "modes": 5, "mesh": {"file": str(file)} | changes},
    }
    return parse_case(document)


def test_a_mesh_file_counts_by_its_content(tmp_path: Path) -> None:
    """Its name, place and format do not matter; one number in it does, also in a file that it refers to."""
    mesh = mesh_of(load_case("steel-box", ['housing.box.mesh_size="60 mm"']).case)
    files = [tmp_path / "one.msh", tmp_path / "elsewhere" / "other.msh"]
    for file in files:
        write_mesh(mesh, file)
    assert key(of_mesh(files[0])) == key(of_mesh(files[1]))
    assert key(of_mesh(files[0])) != key(of_mesh(files[0], unit="mm"))
    bare = [tmp_path / "bare.med", tmp_path / "bare.xdmf"]
    for file in bare:
        write_mesh(replace(mesh, surfaces={}), file)  # formats list the facets of a surface in orders of their own
    assert key(of_mesh(bare[0])) == key(of_mesh(bare[1]))

    before, text = key(of_mesh(bare[1])), bare[1].read_bytes()
    moved = meshio.read(bare[1])
    moved.points[3, 0] += 1e-6
    meshio.write(bare[1], moved)  # the numbers are in bare.h5, beside the file that the case names
    assert bare[1].read_bytes() == text
    assert key(of_mesh(bare[1])) != before


def test_another_file_counts_by_its_bytes(tmp_path: Path) -> None:
    file, copy = tmp_path / "case.step", tmp_path / "copy.STEP"
    file.write_text("ISO-10303-21;", encoding="utf-8")
    copy.write_text("ISO-10303-21;", encoding="utf-8")
    document = case_document(load_case("steel-box").case)
    del document["housing"]["box"]
    document["housing"] |= {"cad": {"file": str(file), "mesh_size": "20 mm"}, "support": [], "seat": []}
    given = Housing.model_validate(document["housing"])
    case = load_case("steel-box").case

    def of_cad(path: Path) -> str:
        cad = given.cad.model_copy(update={"file": path})
        return content_key(
            given_housing(case.model_copy(update={"housing": given.model_copy(update={"cad": cad})})).cache_inputs()
        )

    assert of_cad(file) == of_cad(copy)
    copy.write_text("ISO-10303-21; ", encoding="utf-8")
    assert of_cad(file) != of_cad(copy)


def test_the_inputs_say_what_the_key_is_made_of() -> None:
    inputs = given_housing(load_case("steel-box").case).cache_inputs()
    assert set(inputs) == {"housing", "bearings", "attachment_orders", "material", "versions", "source"}
    assert inputs["housing"]["box"]["wall"] == "0.01 m"
    assert inputs["material"]["steel"]["density"] == "7850 kg/m^3"
    assert {"gearwhine", "gmsh", "scikit-fem", "scipy"} <= set(inputs["versions"])
    assert "damping_ratio" not in inputs["housing"]


# Imported by what solves the modes, and without a say in them: files, words, and what is laid on modes that are read.
WITHOUT_A_SAY = (
    "gearwhine.coupling",
    "gearwhine.exchange",  # what it makes is the case itself, by which modes are found
    "gearwhine.housing.measured",
    "gearwhine.output.files",
    "gearwhine.output.quantity",
    "gearwhine.progress",
    "gearwhine.rotors",
)
ROOT = Path(gearwhine.__file__).parents[1]


def imported(name: str, seen: dict[str, Path]) -> None:
    """Add a module and all of ours that it imports; a room's public face brings its neighbours, and is passed over."""
    place = ROOT / Path(*name.split("."))
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    if name in seen or not file.is_file() or name.split(".")[0] != "gearwhine":
        return
    if name in ("gearwhine", "gearwhine.housing") or name.startswith(WITHOUT_A_SAY):
        return
    seen[name] = file
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for inner in (node.module, *(f"{node.module}.{one.name}" for one in node.names)):
                imported(inner, seen)
        elif isinstance(node, ast.Import):
            for one in node.names:
                imported(one.name, seen)


def test_the_code_that_solves_the_modes_counts_and_no_other() -> None:
    seen: dict[str, Path] = {}
    imported("gearwhine.solve.housing_modes", seen)
    assert len(seen) > 50
    counted = {file for name in MODES_CODE for _, file in _source_files(name)}
    assert set(seen.values()) <= counted
    places = {file.relative_to(ROOT).parts[:2] for file in counted}
    assert places.isdisjoint({("gearwhine", room) for room in ("figures", "results", "output", "cli", "analyses")})
    assert ("housing", "pictures") not in places


def test_a_digest_of_code_follows_what_it_covers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    room = tmp_path / "some_room"
    for file in ("__init__.py", "sums.py", "figures/__init__.py", "figures/curve.py"):
        (room / file).parent.mkdir(exist_ok=True, parents=True)
        (room / file).write_text("", encoding="utf-8")

    def digests() -> tuple[str, ...]:
        source_digest.cache_clear()
        whole, one = source_digest("some_room"), source_digest("some_room.sums")
        return whole, one, source_digest("some_room", without=("some_room.figures",))

    before = digests()
    assert len(set(before)) == 3
    (room / "figures" / "curve.py").write_text("red = 1", encoding="utf-8")
    whole, *others = digests()
    assert whole != before[0]
    assert tuple(others) == before[1:]
    (room / "sums.py").write_text("two = 2", encoding="utf-8")
    assert all(now != then for now, then in zip(digests(), before, strict=True))
    with pytest.raises(ModuleNotFoundError, match="no package or module"):
        source_digest("some_room.products")
    source_digest.cache_clear()
