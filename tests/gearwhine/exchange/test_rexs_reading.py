"""REXS files in XML, JSON and archives: one content, units, and refusals of what is hostile or contradicts itself."""

import io
import struct
import time
import zipfile
from pathlib import Path

import pytest
from rexs_files import RexsFile, archive, helical_stage, planetary_stage

from gearwhine.case.units import si_amount
from gearwhine.exchange.file_names import LARGEST_MODEL, bare_name, is_rexs_file
from gearwhine.exchange.rexs import RexsError, RexsModel, read_content, read_rexs
from gearwhine.exchange.rexs.coded_values import rows_of
from gearwhine.exchange.rexs.json_reader import DEEPEST as DEEPEST_JSON
from gearwhine.exchange.rexs.model import Attribute, Component
from gearwhine.exchange.rexs.units import UNITS, unit_named


def refusal(content: bytes) -> str:
    with pytest.raises(RexsError) as caught:
        read_content(content)
    return str(caught.value)


def numbers_of(model: RexsModel) -> dict[tuple[int, str], object]:
    """Every attribute of a model, numbers as numbers."""

    def plain(value: object) -> object:
        if isinstance(value, tuple | list):
            return tuple(plain(one) for one in value)
        if isinstance(value, str):
            try:
                return float(value)
            except ValueError:
                return {"true": True, "false": False}.get(value, value)
        return value

    return {
        (one.number, name): (plain(attribute.value), attribute.unit)
        for one in model.components.values()
        for name, attribute in one.attributes.items()
    }


@pytest.mark.parametrize("file", [helical_stage(), planetary_stage()], ids=["helical", "planetary"])
def test_xml_json_coded_lists_and_archives_hold_the_same(file: RexsFile) -> None:
    first = read_content(file.xml())
    assert len(first.components) == len(file.components)
    assert [one.kind for one in first.relations] == [one["type"] for one in file.relations]
    assert len(first.load_cases) == len(file.load_cases)
    contents = (file.json(), file.xml(coded=True), file.json(coded=True), file.zip(), file.zip("inner/unit.rexsj"))
    for content in contents:
        other = read_content(content)
        assert numbers_of(other) == numbers_of(first)
        assert other.relations == first.relations
        assert other.origin == first.origin == f"REXS {file.version}, written by Test 1.2 on 2024-05-06"
        for one, twin in zip(other.load_cases, first.load_cases, strict=True):
            assert [c.number for c in one.components] == [c.number for c in twin.components]


def test_a_file_is_read_from_disk_whatever_its_ending(tmp_path: Path) -> None:
    path = tmp_path / "unit.rexs"
    path.write_bytes(helical_stage().zip())
    assert len(read_rexs(path).components) == len(helical_stage().components)
    assert is_rexs_file(path)
    assert is_rexs_file("UNIT.REXSZ")
    assert not is_rexs_file("unit.toml")
    names = {"a/unit v1.2.rexs": "unit v1.2", "unit.rexs.zip": "unit", "UNIT.REXSJ": "UNIT", ".rexs": "unit"}
    assert {name: bare_name(name) for name in names} == names


@pytest.mark.parametrize(
    ("rexs", "own"),
    [
        ("mm", "mm"),
        ("mum", "um"),
        ("deg", "deg"),
        ("°", "deg"),
        ("kN", "kN"),
        ("N mm / rad", "N*mm/rad"),
        ("N / mm", "N/mm"),
        ("MPa", "MPa"),
        ("N / mm^2", "N/mm^2"),
        ("kg / dm^3", "kg/dm^3"),
        ("1 / min", "rpm"),
        ("kW", "kW"),
        ("N / (mm mum)", "N/mm/um"),
        ("mm^2 / s", "mm^2/s"),
        ("h", "h"),
        ("mg", "mg"),
    ],
)
def test_units_of_the_schema_are_those_of_the_unit_registry(rexs: str, own: str) -> None:
    assert UNITS[rexs].factor == pytest.approx(si_amount(f"1 {own}"), rel=1e-12)


def test_temperatures_have_an_offset_and_blanks_do_not_matter() -> None:
    oil = Component(1, "lubricant", "", {"temperature": Attribute("20", "C")})
    assert oil.number_of("temperature", "K") == pytest.approx(293.15)
    assert unit_named("N mm/rad") == UNITS["N mm / rad"]
    assert unit_named("furlong") is None


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        ("2,5", "mm", "a finite number"),
        ("nan", "mm", "a finite number"),
        ("1e999", "mm", "a finite number"),
        ("1_0", "mm", "a finite number"),
        (float("inf"), "mm", "a finite number"),
        (10**400, "mm", "a finite number"),
        (True, "mm", "a finite number"),
        ("2.5", "kg", "a unit of the schema for m"),
        ("2.5", "furlong", "a unit of the schema for m"),
        ("2.5", "none", "a value with a unit"),
    ],
)
def test_a_value_that_is_no_length_is_refused_by_component_and_attribute(value: object, unit: str, said: str) -> None:
    shaft = Component(7, "shaft_section", "journal", {"length": Attribute(value, unit)})
    with pytest.raises(RexsError, match=said) as caught:
        shaft.number_of("length", "m")
    assert 'shaft_section 7 "journal": length' in str(caught.value)


BOMB = b"""<?xml version="1.0"?>
<!DOCTYPE model [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<model version="1.4"><components><component id="1" type="shaft" name="&b;"/></components></model>"""
OUTSIDE = b"""<?xml version="1.0"?>
<!DOCTYPE model SYSTEM "file:///etc/passwd"><model version="1.4"/>"""


@pytest.mark.parametrize("content", [BOMB, OUTSIDE], ids=["bomb", "outside"])
def test_document_types_are_refused_before_any_entity_is_read(content: bytes) -> None:
    assert "expected no document type" in refusal(content)


def test_deep_files_are_refused() -> None:
    depth = 100_000
    started = time.perf_counter()
    deep = b"<model>" + b"<a>" * depth + b"</a>" * depth + b"</model>"
    assert "elements at most 16 deep" in refusal(deep)
    inner = b'{"model": ' + b"[" * depth + b"]" * depth + b"}"
    assert f"at most {DEEPEST_JSON} deep" in refusal(inner)
    assert time.perf_counter() - started < 5.0


def test_brackets_in_texts_are_not_counted_as_depth() -> None:
    file = helical_stage()
    file.components[0]["name"] = '[[[[[[{{{{"\\' * 20
    assert read_content(file.json()).components[1].name.startswith("[[[[")


def test_zip_bombs_are_refused_at_the_limit_not_unpacked() -> None:
    # A thousand to one: as large as the limit allows and one byte more.
    bomb = archive({"unit.rexs": b" " * (LARGEST_MODEL + 1)})
    assert len(bomb) < LARGEST_MODEL / 500
    assert f"at most {LARGEST_MODEL // 10**6} MB" in refusal(bomb)


def test_an_archive_that_lies_about_its_sizes_is_refused() -> None:
    content = bytearray(helical_stage().zip())
    directory = content.rindex(b"PK\x01\x02")
    first = content.index(b"PK\x01\x02")
    assert first < directory
    struct.pack_into("<I", content, first + 24, 10)  # uncompressed size of the model in the directory
    assert "a whole zip archive" in refusal(bytes(content)) or "XML" in refusal(bytes(content))


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"readme.txt": b"none"}, "one file that ends in .rexs or .rexsj, got 'none'"),
        ({"a.rexs": b"<model/>", "b.rexs": b"<model/>"}, "got 'a.rexs, b.rexs'"),
        ({f"{n}.txt": b"" for n in range(1001)}, "at most 1000 files"),
    ],
    ids=["none", "two", "many"],
)
def test_archives_without_one_model_are_refused(members: dict[str, bytes], said: str) -> None:
    assert said in refusal(archive(members))


def test_names_in_an_archive_lead_nowhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    content = archive({"../../outside.rexs": helical_stage().xml(), "../evil.txt": b"x", "__MACOSX/._unit.rexs": b"x"})
    assert len(read_content(content).components) == len(helical_stage().components)
    assert list(tmp_path.iterdir()) == []
    assert not (tmp_path.parent / "evil.txt").exists()


def test_a_damaged_or_locked_archive_is_refused() -> None:
    whole = helical_stage().zip()
    assert "a whole zip archive" in refusal(whole[: len(whole) // 2])
    content = bytearray(whole)
    content[whole.index(b"PK\x03\x04") + 60] ^= 0xFF
    assert "a whole zip archive" in refusal(bytes(content))
    locked = io.BytesIO(whole)
    with zipfile.ZipFile(locked) as file:
        offset = file.infolist()[0].header_offset
    content = bytearray(whole)
    content[offset + 6] |= 1
    content[whole.index(b"PK\x01\x02") + 8] |= 1
    assert "a file without a password" in refusal(bytes(content))


def test_a_file_beyond_the_limit_is_refused() -> None:
    assert f"at most {LARGEST_MODEL // 10**6} MB" in refusal(b"<model>" + b" " * LARGEST_MODEL)


@pytest.mark.parametrize("version", ["", "0.9", "1.8", "2.1.0", "latest"])
def test_other_versions_of_the_schema_are_refused(version: str) -> None:
    file = helical_stage()
    file.version = version
    assert "model: version: expected a version of the REXS schema" in refusal(file.xml())


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0"])
def test_every_version_of_the_schema_is_read(version: str) -> None:
    file = helical_stage()
    file.version = version
    assert read_content(file.json()).version == version


def test_references_that_lead_nowhere_are_refused_each() -> None:
    file = helical_stage()
    file.relate("assembly", assembly=1, part=900)
    file.relate("side", assembly=901, inner_part=4, outer_part=2)
    said = refusal(file.xml())
    assert "(assembly): part: expected the number of a component, got '900'" in said
    assert "(side): assembly: expected the number of a component, got '901'" in said


def test_assemblies_within_themselves_are_refused() -> None:
    file = helical_stage()
    shaft, section = file.number("input"), file.number("input") + 1
    file.relate("assembly", assembly=section, part=shaft)
    assert "an assembly that is no part of itself" in refusal(file.xml())


def test_a_circle_of_several_assemblies_below_a_sound_one_is_found() -> None:
    file = helical_stage()
    wheel, flank, relief = (file.number(name) for name in ("wheel", "relief", "oil"))
    for whole, part in ((wheel, flank), (flank, relief), (relief, wheel)):
        file.relate("ordered_assembly", assembly=whole, part=part)
    said = refusal(file.json())
    assert 'cylindrical_gear 12 "wheel": expected an assembly that is no part of itself' in said


def test_files_of_more_parts_than_the_limits_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearwhine.exchange.rexs.xml_reader.MOST_ELEMENTS", 100)
    monkeypatch.setattr("gearwhine.exchange.rexs.json_reader.MOST_MARKS", 100)
    assert "at most 100 elements" in refusal(helical_stage().xml())
    assert "at most 100 quotes and brackets" in refusal(helical_stage().json())


@pytest.mark.slow
@pytest.mark.parametrize(
    "relation",
    [
        b'<relation id="1" type="assembly"><ref id="1" role="assembly"/><ref id="%d" role="part"/></relation>',
        b'<relation id="1" type="assembly"><ref id="%d" role="part"/><ref id="%d" role="assembly"/></relation>',
    ],
    ids=["wide", "deep"],
)
def test_many_relations_take_seconds(relation: bytes) -> None:
    """Sixty thousand parts of one assembly, and a chain of as many assemblies."""
    count = 60_000
    parts = b"".join(b'<component id="%d" type="shaft"/>' % number for number in range(1, count + 2))
    numbers = relation.count(b"%d")
    joined = b"".join(relation % tuple(number + place for place in range(numbers)) for number in range(2, count))
    started = time.perf_counter()
    model = read_content(
        b'<model version="1.4"><components>%s</components><relations>%s</relations></model>' % (parts, joined)
    )
    assert len(model.parts_of(1 if numbers == 1 else 5, "shaft")) == (count - 2 if numbers == 1 else 1)
    assert time.perf_counter() - started < 10.0


def test_a_number_twice_and_a_load_case_of_nothing_are_refused() -> None:
    file = helical_stage()
    file.components[5]["id"] = 1
    assert "a number that no other component has" in refusal(file.json())
    file = helical_stage()
    text = file.xml().replace(b'<load_case id="2">', b'<load_case id="2"><component id="777" type="shaft"/>')
    assert "load_case 2: shaft 777" in refusal(text)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "the file is empty"),
        (b"  \n", "the file is empty"),
        (b"hello", "line 1: expected XML"),
        (b"<html/>", "a REXS model, an element <model>, got '<html>'"),
        (b"{", "JSON"),
        (b"{}", "an object 'model'"),
        (b'{"model": []}', "an object 'model'"),
        (b'{"model": {"version": "1.4", "components": 3}}', "components: expected a list"),
        (b'{"model": {"version": "1.4", "components": [3]}}', "components[0]: expected an object"),
        (b'{"model": {"version": "1.4", "components": [{"id": "a"}]}}', "components: id: expected a whole number"),
        (b'{"model": {"version": "1.4", "components": [{"id": ' + b"9" * 5000 + b"}]}}", "a computer number can hold"),
        (b'<?xml version="1.0" encoding="utf-99"?><model version="1.4"/>', "XML"),
        (
            b"<model version='1.4'><components><component id='x'/></components></model>",
            "component: id: expected a whole",
        ),
    ],
)
def test_what_is_no_model_is_refused_by_its_place(content: bytes, said: str) -> None:
    assert said in refusal(content)


def test_a_cut_file_is_refused_at_its_last_line() -> None:
    whole = helical_stage().xml()
    for share in (0.1, 0.5, 0.99):
        assert "expected XML (" in refusal(whole[: int(share * len(whole))])
    assert "expected JSON" in refusal(helical_stage().json()[:-2])


@pytest.mark.parametrize(
    ("code", "text", "said"),
    [
        ("float16", "AAAA", "a code among float32, float64, int32"),
        ("float64", "AAAA", "8 bytes each"),
        ("float64", "not base64!", "base64 of numbers"),
    ],
)
def test_coded_lists_that_are_none_are_refused(code: str, text: str, said: str) -> None:
    content = (
        f'<model version="1.4"><components><component id="3" type="shaft"><attribute id="support_vector" unit="mm">'
        f'<array code="{code}">{text}</array></attribute></component></components></model>'
    )
    assert said in refusal(content.encode())


def test_elements_of_others_are_passed_over() -> None:
    text = (
        helical_stage()
        .xml()
        .replace(
            b"<components>",
            b"<extension><component id='1'><attribute id='x'>1</attribute></component></extension><components>",
        )
    )
    assert numbers_of(read_content(text)) == numbers_of(read_content(helical_stage().xml()))


def test_a_matrix_is_read_by_its_rows() -> None:
    content = (
        b'<model version="1.4"><components><component id="1" type="assembly_group">'
        b'<attribute id="reduced_static_stiffness_matrix" unit="none"><matrix><r><c>1</c><c>2</c></r>'
        b"<r><c>3</c><c>4</c></r></matrix></attribute></component></components></model>"
    )
    value = read_content(content).components[1].attributes["reduced_static_stiffness_matrix"].value
    assert value == (("1", "2"), ("3", "4"))


def test_a_coded_matrix_has_the_rows_that_are_stated_or_is_square() -> None:
    numbers = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert rows_of(numbers, "2", "3", "here") == ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    assert rows_of(numbers[:4], None, None, "here") == ((1.0, 2.0), (3.0, 4.0))
    with pytest.raises(RexsError, match="2 x 2 numbers"):
        rows_of(numbers, 2, 2, "here")
