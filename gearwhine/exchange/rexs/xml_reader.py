"""Reader of REXS files in XML, by expat, without document types, entities and external references.

The parser is fed piece by piece. A document type is refused where it begins, so that no entity is ever declared, and
nothing outside the file is read. Elements that the schema does not have are passed over with all that they hold.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from gearwhine.exchange.rexs.coded_values import decoded, rows_of
from gearwhine.exchange.rexs.errors import RexsError, wrong
from gearwhine.exchange.rexs.model import Attribute, Component, LoadCase, Relation, RexsModel, checked_model

DEEPEST = 16
"""Elements within each other beyond which a file is refused; the schema has eight."""
MOST_ELEMENTS = 1_000_000
"""Elements beyond which a file is refused: they bound the memory and time of reading."""
_PIECE = 1 << 16

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


def read_xml(content: bytes) -> RexsModel:
    """Read a REXS file in XML.

    Raises
    ------
    RexsError
        Where it is no XML, has a document type, is not as the schema has it, or contradicts itself.
    """
    reader = _Reader()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.characters
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
    return reader.model()


def _refuse_document_type(name: str, *_: object) -> None:
    raise wrong("the file", "no document type, with which entities come", f"<!DOCTYPE {name}>")


def _refuse_entity(*_: object) -> int:
    raise wrong("the file", "no reference to what stands outside")


@dataclass
class _Reader:
    """What has been read, and where the parser stands."""

    path: list[str] = field(default_factory=list)
    passed: int = 0
    elements: int = 0
    heading: dict[str, str] = field(default_factory=dict)
    components: list[Component] = field(default_factory=list)
    relations: list[Relation] = field(default_factory=list)
    spectra: list[list[LoadCase]] = field(default_factory=list)

    # What is open.
    component: Component = field(default_factory=lambda: Component(0, "", ""))
    attributes: dict[str, Attribute] = field(default_factory=dict)
    attribute: tuple[str, str] = ("", "")
    value: Any = None
    text: list[str] = field(default_factory=list)
    rows: list[Any] = field(default_factory=list)
    cells: list[str] = field(default_factory=list)
    array: dict[str, str] = field(default_factory=dict)
    relation: Relation = field(default_factory=lambda: Relation(0, "", (), 0))
    refs: list[tuple[str, int]] = field(default_factory=list)
    cases: list[LoadCase] = field(default_factory=list)
    case_number: int = 0
    case_components: list[Component] = field(default_factory=list)

    def start(self, name: str, attributes: dict[str, str]) -> None:
        name = name.rpartition(":")[2]
        self.elements += 1
        if self.elements > MOST_ELEMENTS:
            raise wrong("the file", f"at most {MOST_ELEMENTS} elements")
        if len(self.path) + self.passed >= DEEPEST:
            raise wrong("the file", f"elements at most {DEEPEST} deep")
        if self.passed or name not in _KNOWN.get(self.path[-1] if self.path else "", ()):
            if not self.path:
                raise wrong("the file", "a REXS model, an element <model>", f"<{name}>")
            self.passed += 1
            return
        self.path.append(name)
        begin = getattr(self, f"_start_{name}", None)
        if begin is not None:
            begin(attributes)

    def end(self, name: str) -> None:
        if self.passed:
            self.passed -= 1
            return
        finish = getattr(self, f"_end_{self.path[-1]}", None)
        self.path.pop()
        if finish is not None:
            finish()

    def characters(self, text: str) -> None:
        if not self.passed and self.path and self.path[-1] in ("attribute", "c", "array", "matrix"):
            self.text.append(text)

    def _taken(self) -> str:
        text = "".join(self.text)
        self.text.clear()
        return text

    def _start_model(self, attributes: dict[str, str]) -> None:
        self.heading = attributes

    def _start_relation(self, attributes: dict[str, str]) -> None:
        number = _id_of(attributes, "relation")
        order = _id_of(attributes, f"relation {number}", "order") if attributes.get("order") else 0
        self.relation = Relation(number, attributes.get("type", ""), (), order)
        self.refs = []

    def _start_ref(self, attributes: dict[str, str]) -> None:
        self.refs.append((attributes.get("role", ""), _id_of(attributes, self.relation.label)))

    def _end_relation(self) -> None:
        relation = self.relation
        self.relations.append(Relation(relation.number, relation.kind, tuple(self.refs), relation.order))

    def _start_component(self, attributes: dict[str, str]) -> None:
        number = _id_of(attributes, "component")
        self.component = Component(number, attributes.get("type", "component"), attributes.get("name", "").strip())
        self.attributes = {}

    def _end_component(self) -> None:
        component = self.component.changed(self.attributes)
        (self.case_components if "load_case" in self.path else self.components).append(component)

    def _start_attribute(self, attributes: dict[str, str]) -> None:
        self.attribute = attributes.get("id", ""), attributes.get("unit", "")
        self.value = None
        self.text.clear()

    def _end_attribute(self) -> None:
        name, unit = self.attribute
        text = self._taken()
        value = self.value if self.value is not None else text if text.strip() else None
        self.attributes[name] = Attribute(value, unit.strip())

    def _start_array(self, attributes: dict[str, str]) -> None:
        self.text.clear()
        self.array, self.cells = attributes, []

    def _end_array(self) -> None:
        value: Any = tuple(self.cells)
        if self.array.get("code"):
            value = decoded(self.array["code"], self._taken(), self._place)
        self.text.clear()
        if self.path[-1] == "array_of_arrays":
            self.rows.append(value)
        else:
            self.value = value

    def _start_array_of_arrays(self, attributes: dict[str, str]) -> None:
        self.rows = []

    def _end_array_of_arrays(self) -> None:
        self.value = tuple(self.rows)

    def _start_matrix(self, attributes: dict[str, str]) -> None:
        self.text.clear()
        self.array, self.rows = attributes, []

    def _end_matrix(self) -> None:
        self.value = tuple(self.rows)
        if self.array.get("code"):
            numbers = decoded(self.array["code"], self._taken(), self._place)
            self.value = rows_of(numbers, self.array.get("rows"), self.array.get("columns"), self._place)
        self.text.clear()

    def _start_r(self, attributes: dict[str, str]) -> None:
        self.cells = []

    def _end_r(self) -> None:
        self.rows.append(tuple(self.cells))

    def _start_c(self, attributes: dict[str, str]) -> None:
        self.text.clear()

    def _end_c(self) -> None:
        self.cells.append(self._taken())

    def _start_load_spectrum(self, attributes: dict[str, str]) -> None:
        self.cases = []

    def _end_load_spectrum(self) -> None:
        self.spectra.append(self.cases)

    def _start_load_case(self, attributes: dict[str, str]) -> None:
        self.case_number, self.case_components = _id_of(attributes, "load_case"), []

    def _end_load_case(self) -> None:
        self.cases.append(LoadCase(self.case_number, tuple(self.case_components)))

    @property
    def _place(self) -> str:
        return f"{self.component.label}: {self.attribute[0]}"

    def model(self) -> RexsModel:
        heading = self.heading
        origin = tuple(heading.get(key, "").strip()[:200] for key in ("applicationId", "applicationVersion", "date"))
        return checked_model(
            heading.get("version", "").strip(),
            (origin[0], origin[1], origin[2]),
            self.components,
            self.relations,
            self.spectra,
        )


def _id_of(attributes: dict[str, str], place: str, key: str = "id") -> int:
    """Return the number of an element."""
    text = attributes.get(key, "").strip()
    if not text.removeprefix("-").isdecimal() or not text.isascii() or len(text) > 18:
        raise wrong(f"{place}: {key}", "a whole number", text)
    return int(text)
