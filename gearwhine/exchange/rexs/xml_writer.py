"""Writer of REXS models in XML, as :mod:`gearwhine.exchange.rexs.xml_reader` reads them.

Numbers are written with all their digits, so that they are read back as they were.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from gearwhine.exchange.rexs.model import Attribute, Component, RexsModel


def xml_text(model: RexsModel) -> str:
    """Return a model as XML."""
    heading = {
        "version": model.version,
        "applicationId": model.program,
        "applicationVersion": model.program_version,
        "date": model.date,
    }
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', _tag("model", heading), "<relations>"]
    for relation in model.relations:
        ordered = {"order": relation.order} if relation.order else {}
        lines.append(_tag("relation", {"id": relation.number, "type": relation.kind, **ordered}))
        for role, number in relation.roles:
            reference = {"id": number, "role": role, "hint": model.components[number].kind}
            lines.append(_tag("ref", reference, end="/"))
        lines.append("</relation>")
    lines += ["</relations>", "<components>", *_components(model.components.values()), "</components>"]
    if model.load_cases:
        lines.append(_tag("load_spectrum", {"id": 1}))
        for load_case in model.load_cases:
            lines += [_tag("load_case", {"id": load_case.number}), *_components(load_case.components), "</load_case>"]
        lines.append("</load_spectrum>")
    return "\n".join([*lines, "</model>"]) + "\n"


def _tag(name: str, attributes: Mapping[str, object], end: str = "") -> str:
    shown = "".join(f" {key}={quoteattr(str(value))}" for key, value in attributes.items())
    return f"<{name}{shown}{end}>"


def _components(components: Iterable[Component]) -> Iterator[str]:
    for component in components:
        named = {"name": component.name} if component.name else {}
        yield _tag("component", {"id": component.number, "type": component.kind, **named})
        for name, attribute in component.attributes.items():
            yield f"{_tag('attribute', {'id': name, 'unit': attribute.unit})}{_value(attribute)}</attribute>"
        yield "</component>"


def _value(attribute: Attribute) -> str:
    if isinstance(attribute.value, tuple) and attribute.value and isinstance(attribute.value[0], tuple):
        rows = ("".join(f"<c>{_text(entry)}</c>" for entry in row) for row in attribute.value)
        return "<matrix>" + "".join(f"<r>{row}</r>" for row in rows) + "</matrix>"
    if isinstance(attribute.value, tuple):
        cells = "".join(f"<c>{_text(entry)}</c>" for entry in attribute.value)
        return f"<array>{cells}</array>"
    return _text(attribute.value)


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, int | float) else escape(str(value))
