"""The reference of the case file and of the commands against schema and commands: both pages are made from them."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError

from gearwhine.case import Case
from gearwhine.case.gears import Gear
from gearwhine.case.operation import Transient
from gearwhine.cli.command_line import app

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def pages() -> Any:
    """The program that writes both pages."""
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        import reference_pages
    finally:
        sys.path.remove(str(ROOT / "scripts"))
    return reference_pages


@pytest.fixture(scope="module")
def written(pages: Any) -> str:
    """The page of the case file with its tables."""
    return str(pages.case_file(pages.CASE_FILE.read_text(encoding="utf-8")))


def row(page: str, heading: str, key: str) -> list[str]:
    """Cells of a key's row in the section of a heading."""
    section = re.split(r"^#+ ", page.split(f"# {heading}\n", 1)[1], maxsplit=1, flags=re.MULTILINE)[0]
    line = next(line for line in section.splitlines() if line.startswith(f"| `{key}` |"))
    return [cell.strip() for cell in line.split(" | ")][1:]


def test_every_key_of_every_table_has_a_row_with_a_meaning(pages: Any, written: str) -> None:
    for heading, table in [("At the top", Case), *((one.heading, one.table) for one in pages.sections())]:
        for key, field in pages.keys_of(table).items():
            *_, default, meaning = row(written, heading, key)
            assert len(meaning.removesuffix("|").strip()) >= 5, (heading, key)
            assert (default == "**required**") == field.is_required(), (heading, key)


def test_every_command_has_a_section(pages: Any) -> None:
    page = pages.commands(pages.COMMANDS.read_text(encoding="utf-8"))
    named = set(re.findall(r"^## `gearwhine (\w+)`$", page, re.MULTILINE))
    assert named == {name for name in app if not name.startswith("-")}
    for option in ("--over-torque", "--sensitivity", "--held-back", "--write-ross", "--mesh-phase", "--workers"):
        assert f"`{option}" in page


def test_ranges_on_the_page_are_those_that_a_case_is_held_to(written: str) -> None:
    """Read from the page, just outside and just inside, through the reader of a case."""
    assert row(written, "`[transient]`", "tolerance")[:4] == ["number", "", "> 0, ≤ 0.1", "0.0005"]
    assert row(written, "`[[gear]]`", "helix_angle")[:4] == ["angle", "rad", "≥ -60 deg, ≤ 60 deg", "0"]
    assert row(written, "`[transient]`", "points_per_revolution")[:4] == ["whole number", "", "200 to 1 000 000", "200"]
    transient, gear = TypeAdapter(Transient), TypeAdapter(Gear)
    one = {"name": "g", "teeth": 20, "module": "2 mm", "face_width": "20 mm"}
    assert transient.validate_python({"revolutions": 2}).tolerance == 5e-4
    transient.validate_python({"revolutions": 2, "tolerance": 0.1, "points_per_revolution": 200})
    gear.validate_python(one | {"helix_angle": "60 deg"})
    for outside in ({"tolerance": 0.0}, {"tolerance": 0.1001}, {"points_per_revolution": 199}):
        with pytest.raises(ValidationError):
            transient.validate_python({"revolutions": 2} | outside)
    with pytest.raises(ValidationError):
        gear.validate_python(one | {"helix_angle": "60.1 deg"})
