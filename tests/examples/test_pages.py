"""The documentation's Python and case fragments hold, its links lead somewhere, and it shows the worked examples' code.

Commands of the pages run in `tests/end_to_end/test_pages_with_commands.py`.
"""

import ast
import importlib
import re
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

import gearwhine as gw
from gearwhine.case import Case
from gearwhine.from_case import mesh
from gearwhine.output.quantity import Fields, Quantity
from gearwhine.results.operating_point import LOAD

pytestmark = pytest.mark.usefixtures("unrendered")

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "scripts" / "examples"
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "benchmarks/README.md")),
    *sorted(path for path in (ROOT / "docs").rglob("*.md") if path.relative_to(ROOT / "docs").parts[0] != "gallery"),
]


def blocks(page: str, language: str = "python") -> list[str]:
    return re.findall(
        rf"^```{language}\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )


def body(example: str) -> str:
    """The code of an example below its docstring."""
    text = (EXAMPLES / example).read_text(encoding="utf-8")
    after = ast.parse(text).body[1].lineno
    return "".join(text.splitlines(keepends=True)[after - 1 :])


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub and MyST make them."""
    found: set[str] = set()
    for heading in re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE):
        text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        found.add(re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-"))
    return found


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_the_first_pages_show_the_first_example(page: str) -> None:
    assert blocks(page) == [body("first_steps.py")]


def test_every_example_is_short_and_listed() -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    for path in sorted(EXAMPLES.glob("*.py")):
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 40, path.name
        assert f"(../scripts/examples/{path.name})" in page


def test_the_page_lists_every_variable_of_an_operating_point() -> None:
    def named(fields: Fields, along: tuple[str, ...] = ()) -> Iterator[str]:
        for field in fields:
            if isinstance(field, Quantity):
                dimensions = (*along, *field.dimensions)
                if dimensions and field.name not in ("", *dimensions):
                    yield field.name
            else:
                yield from named(field.fields, (*along, *filter(None, (getattr(field, "dimension", ""),))))

    section = (ROOT / "docs" / "python.md").read_text(encoding="utf-8").partition("| variable | dimensions |")[2]
    rows = section.partition("\n\n")[0].splitlines()[2:]
    assert {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])} == set(named(LOAD))


def test_the_front_door_has_every_object_of_the_page() -> None:
    table = (ROOT / "docs" / "python.md").read_text(encoding="utf-8").partition("| object | from |")[2]
    rows = table.partition("\n\n")[0].splitlines()[2:]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    assert len(named) > 30
    assert {name for name in named if not hasattr(gw, name) or name not in gw.__all__} == set()


def test_links_of_the_pages_lead_to_files_and_headings() -> None:
    for page in PAGES:
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
        links = re.findall(r"(?<!`)\]\(([^)#:\s]*)(?:#([^)\s]*))?\)", text)
        for target, anchor in links:
            leads = (page.parent / target) if target else page
            assert leads.is_file(), f"{page.name}: {target}"
            assert not anchor or leads.suffix != ".md" or anchor in anchors(leads), f"{page.name}: {target}#{anchor}"


def test_every_page_is_in_the_index_and_its_tree() -> None:
    """The table that GitHub shows, and the tree that the site's sidebar is made of."""
    index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    tree = "\n".join(re.findall(r"^```\{toctree\}\n(.*?)^```$", index, re.MULTILINE | re.DOTALL))
    for page in PAGES:
        name = page.relative_to(ROOT / "docs").as_posix() if page.is_relative_to(ROOT / "docs") else None
        if name == "index.md":
            continue
        link, place = (name, name) if name else (f"../{page.relative_to(ROOT)}", f"/{page.relative_to(ROOT)}")
        assert f"({link})" in index, link
        assert re.search(rf"(^|<){re.escape(place.removesuffix('.md'))}>?$", tree, re.MULTILINE), place


@pytest.fixture(scope="module")
def of_the_site() -> Iterator[Callable[[str], Any]]:
    """Modules of the site by name."""
    sys.path.insert(0, str(ROOT / "docs" / "site"))
    try:
        yield importlib.import_module
    finally:
        sys.path.remove(str(ROOT / "docs" / "site"))


def test_pages_of_the_site_have_keys_options_and_published_values(of_the_site: Any) -> None:
    filled = of_the_site("generated_pages").FILLED
    pages = {name: fill((ROOT / f"{name}.md").read_text(encoding="utf-8")) for name, fill in filled.items()}
    assert not [name for name, text in pages.items() if re.search("<!-- (keys|commands|values)", text)]
    assert "| `youngs_modulus` | elastic modulus | Pa |" in pages["docs/case-file"]
    assert "* `--over-torque" in pages["docs/commands"]
    # As many values of each source as the page says in the tree.
    validation = pages["docs/validation"]
    numbers = re.findall(r"^\| (.*) \| (\d+) \| \d+ % \|$", validation, re.MULTILINE)
    assert len(numbers) >= 45
    for source, number in numbers:
        section = re.split(r"^#", validation.split(f"### {source}\n")[1], maxsplit=1, flags=re.MULTILINE)[0]
        assert len(re.findall(r"^\| ", section, re.MULTILINE)) - 1 == int(number), source


def test_every_public_name_has_a_page_of_the_reference(of_the_site: Any) -> None:
    """Of the pages that the site makes: those of each room's own docstring and of what its `__init__` imports."""
    python_pages = of_the_site("python_pages")
    names_of = {package: python_pages.public_names(package) for package in python_pages.packages(ROOT)}
    home_of = python_pages.homes(names_of)
    for room in python_pages.ROOMS:
        init = (ROOT / room.replace(".", "/") / "__init__.py").read_text(encoding="utf-8")
        imported = set(re.findall(r"^(?:    )?from \S+ import \w+ as (\w+)$", init, re.MULTILINE))
        assert imported
        assert imported <= set(names_of[room]), room
    assert home_of["gearwhine", "Housing"] == "gearwhine.housing"
    assert home_of["gearwhine", "Study"] == "gearwhine"
    for (package, name), home in home_of.items():
        value = getattr(importlib.import_module(home), name)
        assert value is getattr(importlib.import_module(package), name)
        assert not callable(value) or value.__doc__, f"{package}.{name}"


@pytest.mark.parametrize("page", [page for page in PAGES if "```toml" in page.read_text(encoding="utf-8")], ids=str)
def test_fragments_of_cases_are_of_a_case(page: Path) -> None:
    """Nothing is wrong with a fragment but what it leaves out: other keys, and files."""
    for block in blocks(page.relative_to(ROOT).as_posix(), "toml"):
        try:
            Case.model_validate(tomllib.loads(block), context={"folder": ROOT / "gearwhine" / "cases"})
        except ValidationError as error:
            wrong = [one for one in error.errors() if one["type"] != "missing" and "existing file" not in one["msg"]]
            left_out = [one for one in wrong if "such as speed" in one["msg"] or one["msg"].startswith("exactly one")]
            assert [one for one in wrong if one not in left_out] == [], block


def test_the_reducer_of_the_tutorial_is_the_bundled_one() -> None:
    case = (ROOT / "gearwhine" / "cases" / "two-stage-reducer.toml").read_text(encoding="utf-8")
    found = blocks("docs/tutorials/reducer.md", "toml")
    assert len(found) >= 9
    assert [block for block in found if block.strip() not in case] == []


@pytest.mark.slow
@pytest.mark.usefixtures("few_reliefs_tried")
def test_the_page_on_python_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    mesh_box = mesh.mesh_box
    monkeypatch.setattr(mesh, "mesh_box", lambda box, size, **how: mesh_box(box, max(size, 0.05), **how))
    names: dict[str, Any] = {"__name__": "__main__"}
    for block in blocks("docs/python.md"):
        exec(compile(block, "docs/python.md", "exec"), names)  # noqa: S102 - the page is ours
    assert (tmp_path / "results" / "results.nc").is_file()
    assert names["machine"].mesh_frequencies[0] == pytest.approx(28 * 5500 / 60)
    # Torque over base radius, of 28 teeth at module 3.175 mm and 20 degrees.
    mean = 71.77 / (3.175e-3 * 28 / 2 * np.cos(np.radians(20.0)))
    assert float(names["force"].mean()) == pytest.approx(mean, rel=5e-3)


@pytest.mark.slow
def test_the_variant_of_the_reducer_is_drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(ROOT / "scripts")
    (block,) = blocks("docs/two-stage-reducer.md")
    exec(compile(block, "docs/two-stage-reducer.md", "exec"), {})  # noqa: S102 - the page is ours
    assert (tmp_path / "two-stage-reducer.step").stat().st_size > 100_000


def test_programs_of_all_pages_are_run() -> None:
    """Those of the first pages are an example, and tutorials and how-to pages run as a whole."""
    here = {
        "README.md",
        "docs/index.md",
        "docs/python.md",
        "docs/report.md",
        "docs/sound.md",
        "docs/two-stage-reducer.md",
    }
    for page in PAGES:
        name = page.relative_to(ROOT).as_posix()
        if "```python" in page.read_text(encoding="utf-8"):
            assert name in here or name.split("/")[1] in ("tutorials", "how-to"), name


@pytest.mark.slow
def test_the_page_on_the_report_runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = blocks("docs/report.md")
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(block, "docs/report.md", "exec"), names)  # noqa: S102 - the page is ours
    assert names["page"] == Path("out", "report.html")
    assert "<h2 id=" in names["page"].read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_page_on_sound_runs() -> None:
    """Efficiencies of a box whose modes have wavelengths in air about as long as itself."""
    (block,) = blocks("docs/sound.md")
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(block, "docs/sound.md", "exec"), names)  # noqa: S102 - the page is ours
    efficiency = names["efficiency"].values
    assert len(efficiency) == len(names["sound"].document["modes"]) >= 3
    assert np.all((efficiency > 0.5) & (efficiency < 2.0))


def test_files_that_contributing_names_exist() -> None:
    """A path in the tables of the tree is that of a file or folder."""
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    places = re.findall(r"`([\w./-]+/[\w.-]+)`", page)
    assert len(places) >= 40
    assert not [place for place in places if not (ROOT / place).exists() and not place.startswith(".venv")]


def test_names_of_the_glossary_exist() -> None:
    """Every row names a module and something in it."""
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| ") and not line.startswith("| term")]
    assert len(rows) >= 60
    for row in rows:
        module, _, name = row.split("`")[1].rpartition(".")
        assert hasattr(importlib.import_module(module), name), row
