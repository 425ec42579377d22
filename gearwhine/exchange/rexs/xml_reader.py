"""Reader of REXS files in XML, by expat, without document types, entities and external references.

The parser is fed piece by piece. A document type is refused where it begins, so that no entity is ever declared, and
nothing outside the file is read. Elements that the schema does not have are passed over with all that they hold.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NoReturn
from xml.parsers import expat

from gearwhine.exchange.rexs.coded_values import decoded, rows_of
from gearwhine.exchange.rexs.errors import RexsError, wrong
from gearwhine.exchange.rexs.model import Attribute, Component, LoadCase, Relation, RexsModel, checked_model

DEEPEST = 16
"""Elements within each other beyond which a file is refused; the schema has eight."""
MOST_ELEMENTS = 1_000_000
"""Elements beyond which a file is refused: they bound the memory and time of reading."""
_PIECE = 1 << 16
_ORIGIN = ("applicationId", "applicationVersion", "date")

_KNOWN = {
    "": {"model"},
    "model": {"relations", "components", "load_spectrum"},
    "relations": {"relation"},
    "relation": {"ref"},
    "components": {"component"},
    "component": {"attribute"},
    "load_spectrum": {"load_case"},
    "load_case": {"component"},
    "attribute": {"array", "matrix", "array_of_arrays"},
    "array": {"c"},
    "matrix": {"r"},
    "r": {"c"},
    "array_of_arrays": {"array"},
}
"""Elements that may stand in each; others are passed over."""


@dataclass
class _Element:
    """An element: its name, its attributes, the known elements in it, and the pieces of its own text."""

    name: str
    attributes: dict[str, str]
    inner: list[_Element] = field(default_factory=list)
    pieces: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        return "".join(self.pieces)


def read_xml(content: bytes) -> RexsModel:
    """Read a REXS file in XML.

    Raises
    ------
    RexsError
        Where it is no XML, has a document type, is not as the schema has it, or contradicts itself.
    """
    tree = _Tree()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = tree.start
    parser.EndElementHandler = tree.end
    parser.CharacterDataHandler = tree.characters
    parser.StartDoctypeDeclHandler = _refuse_document_type
    parser.ExternalEntityRefHandler = _refuse_entity
    try:
        for start in range(0, len(content), _PIECE):
            parser.Parse(content[start : start + _PIECE], False)
        parser.Parse(b"", True)
    except expat.ExpatError as error:
        raise wrong(
            f"line {error.lineno}", f"XML ({expat.errors.messages.get(error.code, 'not well formed')})"
        ) from None
    except RexsError:
        raise
    except (ValueError, LookupError) as error:  # an encoding that Python does not know
        raise wrong("the file", f"XML in UTF-8 ({error})") from None
    (model,) = tree.root.inner
    texts = {key: model.attributes.get(key, "").strip() for key in ("version", *_ORIGIN)}
    program, program_version, date = (texts[key][:200] for key in _ORIGIN)
    return checked_model(
        texts["version"],
        (program, program_version, date),
        [_component(one) for part in model.inner if part.name == "components" for one in part.inner],
        [_relation(one) for part in model.inner if part.name == "relations" for one in part.inner],
        [[_load_case(one) for one in part.inner] for part in model.inner if part.name == "load_spectrum"],
    )


def _refuse_document_type(name: str, *_: object) -> NoReturn:
    raise wrong("the file", "no document type, with which entities come", f"<!DOCTYPE {name}>")


def _refuse_entity(*_: object) -> NoReturn:
    raise wrong("the file", "no reference to what stands outside")


@dataclass
class _Tree:
    """Known elements of a file, as the parser comes by them."""

    root: _Element = field(default_factory=lambda: _Element("", {}))
    path: list[_Element] = field(default_factory=list)
    passed: int = 0
    elements: int = 0

    def start(self, name: str, attributes: dict[str, str]) -> None:
        name = name.rpartition(":")[2]
        self.elements += 1
        if self.elements > MOST_ELEMENTS:
            raise wrong("the file", f"at most {MOST_ELEMENTS} elements")
        if len(self.path) + self.passed >= DEEPEST:
            raise wrong("the file", f"elements at most {DEEPEST} deep")
        around = self.path[-1] if self.path else self.root
        if self.passed or name not in _KNOWN.get(around.name, ()):
            if not self.path:
                raise wrong("the file", "a REXS model, an element <model>", f"<{name}>")
            self.passed += 1
            return
        self.path.append(_Element(name, attributes))
        around.inner.append(self.path[-1])

    def end(self, name: str) -> None:
        if self.passed:
            self.passed -= 1
        else:
            self.path.pop()

    def characters(self, text: str) -> None:
        if not self.passed and self.path and self.path[-1].name in ("attribute", "c", "array", "matrix"):
            self.path[-1].pieces.append(text)


def _relation(element: _Element) -> Relation:
    attributes = element.attributes
    number = _id_of(attributes, "relation")
    order = _id_of(attributes, f"relation {number}", "order") if attributes.get("order") else 0
    relation = Relation(number, attributes.get("type", ""), (), order)
    roles = [(ref.attributes.get("role", ""), _id_of(ref.attributes, relation.label)) for ref in element.inner]
    return replace(relation, roles=tuple(roles))


def _load_case(element: _Element) -> LoadCase:
    return LoadCase(_id_of(element.attributes, "load_case"), tuple(map(_component, element.inner)))


def _component(element: _Element) -> Component:
    number, kind = _id_of(element.attributes, "component"), element.attributes.get("type", "component")
    component = Component(number, kind, element.attributes.get("name", "").strip())
    attributes = {}
    for one in element.inner:
        name = one.attributes.get("id", "")
        attributes[name] = Attribute(_value(one, f"{component.label}: {name}"), one.attributes.get("unit", "").strip())
    return component.changed(attributes)


def _value(attribute: _Element, place: str) -> Any:
    """Return the value of an attribute: its text, or what the last array or matrix in it holds."""
    if not attribute.inner:
        return attribute.text if attribute.text.strip() else None
    held = attribute.inner[-1]
    if held.name == "array":
        return _array(held, place)
    if held.name == "array_of_arrays":
        return tuple(_array(one, place) for one in held.inner)
    if code := held.attributes.get("code"):
        numbers = decoded(code, held.text, place)
        return rows_of(numbers, held.attributes.get("rows"), held.attributes.get("columns"), place)
    return tuple(tuple(cell.text for cell in row.inner) for row in held.inner)


def _array(element: _Element, place: str) -> Any:
    if code := element.attributes.get("code"):
        return decoded(code, element.text, place)
    return tuple(cell.text for cell in element.inner)


def _id_of(attributes: dict[str, str], place: str, key: str = "id") -> int:
    """Return the number of an element."""
    text = attributes.get(key, "").strip()
    if not text.removeprefix("-").isdecimal() or not text.isascii() or len(text) > 18:
        raise wrong(f"{place}: {key}", "a whole number", text)
    return int(text)
