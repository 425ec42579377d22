"""Elements of the files that are written against a description of the REXS schema of files, version 1.7.

The description states what the public schema (``rexs-file.xsd`` of fva-net/rexs-api-java, Apache-2.0) demands of what
is written: elements in their order, attributes with their types, unique numbers, references that lead on.
"""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from rexs_files import _at, add_reduced_casing, helical_stage

from gearwhine.case import load_case, parse_case
from gearwhine.coupling.machine.reduced_component import component_of_reduced_housing
from gearwhine.exchange.rexs import case_of, read_content
from gearwhine.exchange.rexs.reduced_casing import casing_stiffness
from gearwhine.from_case.rexs import rexs_of
from gearwhine.housing.reduced import NodeSeat, ReducedHousing, reduced_matrices

BUNDLED = ("spur-pair", "small-gearbox", "three-stage", "nasa-gear-noise-rig", "planetary-stage")

NUMBER, TEXT, ORDER = r"[+-]?\d+", r".*", r"[1-9]\d*"
ELEMENTS: dict[str, tuple[dict[str, str], dict[str, str], tuple[str, ...]]] = {
    "model": (
        dict.fromkeys(("version", "applicationId", "applicationVersion", "date"), TEXT),
        {},
        ("relations", "components", "load_spectrum"),
    ),
    "relations": ({}, {}, ("relation",)),
    "relation": ({"id": NUMBER, "type": r"\w+"}, {"order": ORDER}, ("ref",)),
    "ref": ({"id": NUMBER, "role": r"\w+"}, {"hint": TEXT}, ()),
    "components": ({}, {}, ("component",)),
    "component": ({"id": NUMBER, "type": r"\w+"}, {"name": TEXT}, ("attribute",)),
    "attribute": ({"id": r"\w+"}, {"unit": TEXT}, ("array", "matrix")),
    "array": ({}, {}, ("c",)),
    "matrix": ({}, {}, ("r",)),
    "r": ({}, {}, ("c",)),
    "c": ({}, {}, ()),
    "load_spectrum": ({"id": NUMBER}, {}, ("load_case",)),
    "load_case": ({"id": NUMBER}, {}, ("component",)),
}
"""Required and optional attributes of each element by a pattern, and its children in their order."""
ORDERED = ("manufacturing_step", "ordered_assembly")
"""Relations that have an order, from 1."""
PARTS_IN_ORDER = ("rolling_bearing_row", "rolling_element", "reduction_point")
"""Components that are parts by an ordered assembly alone, in the database of the schema."""


def broken(text: str) -> list[str]:
    """What of a file the description does not allow."""
    root = ET.fromstring(text)
    found = [] if root.tag == "model" else [f"{root.tag} as the root"]
    for element in root.iter():
        required, optional, children = ELEMENTS[element.tag]
        lacking = required.keys() - element.attrib.keys()
        found += [f"{element.tag} without {name}" for name in lacking]
        for name, value in element.attrib.items():
            pattern = (required | optional).get(name)
            if pattern is None or not re.fullmatch(pattern, value):
                found.append(f"{element.tag}: {name}={value!r}")
        places = [children.index(child.tag) if child.tag in children else -1 for child in element]
        if -1 in places or places != sorted(places):
            found.append(f"children of {element.tag}: {[child.tag for child in element][:10]}")
    numbers = [one.get("id") for one in root.findall("components/component")]
    for kind in (numbers, [one.get("id") for one in root.findall("relations/relation")]):
        if len(set(kind)) < len(kind):
            found.append("a number twice")
    references = [*root.findall("relations/relation/ref"), *root.findall("load_spectrum/load_case/component")]
    found += [f"a reference to {one.get('id')}" for one in references if one.get("id") not in set(numbers)]
    kinds = {one.get("id"): one.get("type") for one in root.findall("components/component")}
    for relation in root.findall("relations/relation"):
        parts = [kinds.get(one.get("id")) for one in relation if one.get("role") == "part"]
        if any((part in PARTS_IN_ORDER) != (relation.get("type") == "ordered_assembly") for part in parts):
            found.append(f"{parts} by the relation {relation.get('type')}")
        if (relation.get("type") in ORDERED) != (relation.get("order") is not None):
            found.append(f"order of {relation.get('type')}")
    return found


@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_cases_are_written_as_the_schema_has_it(name: str) -> None:
    assert broken(rexs_of(load_case(name).case).xml) == []


def test_a_casing_with_a_load_case_is_written_as_the_schema_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file = helical_stage()
    add_reduced_casing(file, np.diag([2e5, 2e5, 2e5, 1e8, 1e8, 1e8] * 4).tolist(), _at(0.0))
    (tmp_path / "unit.rexs").write_bytes(file.xml())
    model = read_content(file.xml())
    case = parse_case(case_of(model, "unit.rexs").document)
    assert case.reduced_housing is not None
    seats = [NodeSeat(seat.name, seat.node, seat.center) for seat in case.reduced_housing.seat]
    matrices = reduced_matrices({"stiffness": casing_stiffness(model)}, units="mm-t-s")
    housing = component_of_reduced_housing(ReducedHousing(matrices, seats, limit=1e4))
    bearings = [
        {"name": bearing.name, "force_n": [1.0, 2.0, 3.0], "moment_n_m": [0.1, 0.2]} for bearing in case.bearing
    ]
    text = rexs_of(case, {"bearings": bearings, "seats": "housing"}, housing).xml
    assert "<matrix>" in text
    assert "<load_case" in text
    assert broken(text) == []


def test_what_the_schema_does_not_allow_is_seen() -> None:
    text = rexs_of(load_case("spur-pair").case).xml
    for before, after in (
        ('<component id="1"', '<component id="2"'),
        (' type="gear_unit"', ""),
        ('role="part"', 'role="part" sort="1"'),
        ("<components>", '<components><ref id="1" role="part"/>'),
    ):
        assert before in text
        assert broken(text.replace(before, after, 1)), before
