"""Reader of REXS files in JSON: the content of XML, each attribute with its value under the name of its type."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from gearwhine.exchange.rexs.coded_values import decoded, rows_of
from gearwhine.exchange.rexs.errors import wrong
from gearwhine.exchange.rexs.model import Attribute, Component, LoadCase, Relation, RexsModel, checked_model

DEEPEST = 32
"""Lists and objects within each other beyond which a file is refused; the schema has ten."""
MOST_MARKS = 8_000_000
"""Quotes and brackets beyond which a file is refused: they bound the memory of what is read."""


def read_json(content: bytes) -> RexsModel:
    """Read a REXS file in JSON.

    Raises
    ------
    RexsError
        Where it is no JSON, is not as the schema has it, or contradicts itself.
    """
    _require_shallow(content)
    try:
        document = json.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise wrong(f"byte {error.start}", "text in UTF-8") from None
    except json.JSONDecodeError as error:
        raise wrong(f"line {error.lineno}, column {error.colno}", f"JSON ({error.msg})") from None
    except (ValueError, RecursionError):  # a number of thousands of digits
        raise wrong("the file", "JSON with numbers that a computer number can hold") from None
    model = document.get("model") if isinstance(document, dict) else None
    if not isinstance(model, dict):
        raise wrong("the file", "a REXS model, an object 'model'")
    components = [_component(entry, "components") for entry in _objects(model.get("components"), "components")]
    relations = [_relation(entry) for entry in _objects(model.get("relations"), "relations")]
    origin = tuple(_text(model.get(key))[:200] for key in ("applicationId", "applicationVersion", "date"))
    spectra = [_spectrum(entry) for entry in _spectra(model.get("load_spectrum"))]
    return checked_model(_text(model.get("version")), (origin[0], origin[1], origin[2]), components, relations, spectra)


def _require_shallow(content: bytes) -> None:
    """Refuse brackets within each other deeper than the schema has them, before the parser follows them."""
    depth, in_text = 0, False
    marks = _marks(content)
    if len(marks) > MOST_MARKS:
        raise wrong("the file", f"at most {MOST_MARKS} quotes and brackets", len(marks))
    for piece in marks:
        if piece == 0x22:
            in_text = not in_text
        elif not in_text:
            depth += 1 if piece in b"[{" else -1
            if depth > DEEPEST:
                raise wrong("the file", f"lists and objects at most {DEEPEST} deep")


_OTHERS = bytes(sorted(set(range(256)) - set(b'"[]{}')))


def _marks(content: bytes) -> bytes:
    """Return the quotes and brackets of a text, without quotes that are escaped."""
    return content.replace(b"\\\\", b"").replace(b'\\"', b"").translate(None, _OTHERS)


def _text(value: object) -> str:
    return value.strip() if isinstance(value, str) else ""


def _objects(value: object, place: str) -> Iterator[dict[str, Any]]:
    """Yield the objects of a list."""
    if value is None:
        return
    if not isinstance(value, list):
        raise wrong(place, "a list", value)
    for index, entry in enumerate(value):
        if not isinstance(entry, dict):
            raise wrong(f"{place}[{index}]", "an object", entry)
        yield entry


def _spectra(value: object) -> Iterator[dict[str, Any]]:
    """Yield the load spectra: a file has one, or a list."""
    return _objects([value] if isinstance(value, dict) else value, "load_spectrum")


def _spectrum(entry: Mapping[str, Any]) -> list[LoadCase]:
    cases = []
    for case in _objects(entry.get("load_cases", entry.get("load_case")), "load_cases"):
        components = [
            _component(one, "load_cases") for one in _objects(case.get("components"), "load_cases: components")
        ]
        cases.append(LoadCase(_number(case, "load_cases"), tuple(components)))
    return cases


def _number(entry: Mapping[str, Any], place: str, key: str = "id") -> int:
    value = entry.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or abs(value) >= 10**18:
        raise wrong(f"{place}: {key}", "a whole number", value)
    return value


def _component(entry: Mapping[str, Any], place: str) -> Component:
    component = Component(_number(entry, place), _text(entry.get("type")) or "component", _text(entry.get("name")))
    attributes = {}
    for attribute in _objects(entry.get("attributes"), f"{component.label}: attributes"):
        name = _text(attribute.get("id"))
        attributes[name] = Attribute(_value(attribute, f"{component.label}: {name}"), _text(attribute.get("unit")))
    return component.changed(attributes)


def _relation(entry: Mapping[str, Any]) -> Relation:
    number = _number(entry, "relations")
    order = _number(entry, f"relation {number}", "order") if entry.get("order") is not None else 0
    roles = [
        (_text(ref.get("role")), _number(ref, f"relation {number}"))
        for ref in _objects(entry.get("refs"), f"relation {number}: refs")
    ]
    return Relation(number, _text(entry.get("type")), tuple(roles), order)


def _value(attribute: Mapping[str, Any], place: str) -> Any:
    """Return the value of an attribute, which stands under the name of its type."""
    for key, value in attribute.items():
        if key in ("id", "unit"):
            continue
        if key.endswith("_coded"):
            return _coded(key, value, place)
        if isinstance(value, list):
            return tuple(tuple(row) if isinstance(row, list) else row for row in value)
        return None if isinstance(value, dict) else value
    return None


def _coded(key: str, value: object, place: str) -> Any:
    if not isinstance(value, dict):
        raise wrong(place, "an object with 'code' and 'value'", value)
    numbers = decoded(_text(value.get("code")), _text(value.get("value")), place)
    return rows_of(numbers, value.get("rows"), value.get("columns"), place) if "matrix" in key else numbers
