"""Validation errors of pydantic as findings in the case file's terms."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gearwhine.case.fields import Quantity, Table, Whole
from gearwhine.case.model import Case
from gearwhine.case.over_speed import OverSpeed
from gearwhine.case.problems import NOTHING, Finding, Location, did_you_mean

_PLAIN_WORDS = {
    "string_type": "text",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "dict_type": "a table",
    "tuple_type": "a list",
    "list_type": "a list",
    "bool_type": "true or false",
}


def findings_of(error: ValidationError) -> Iterator[Finding]:
    """Yield a finding for each error that validating a document as a `Case` has met."""
    for detail in error.errors(include_url=False):
        if detail["type"] == "default_factory_not_called":
            continue  # a default that follows from a key which is itself at fault
        context = detail.get("ctx", {})
        # Steps that begin with "~" tell which form of a key was meant; they are not in the file.
        steps = [step for step in detail["loc"] if not str(step).startswith("~") and step != "[key]"]
        location = (*steps, *context.get("at", ()))
        if detail["type"] == "missing":
            yield Finding(location, _describe(_meaning_of(location)[1], location), NOTHING)
        elif detail["type"] == "extra_forbidden":
            yield Finding(location, _unknown_key(str(location[-1]), _meaning_of(location[:-1])[0]))
        else:
            yield Finding(location, _expected(detail, context), note=context.get("note", ""))


def _expected(detail: ErrorDetails, context: dict[str, Any]) -> str:
    """Say what pydantic expected where it found something else."""
    kind = detail["type"]
    if kind == "case":
        return str(context["expected"])
    if kind == "literal_error":
        return f"one of {context['expected']}"
    if kind == "too_short":
        return f"at least {context['min_length']} entries (there are {context['actual_length']})"
    if kind == "too_long":
        return f"at most {context['max_length']} entries"
    if kind == "string_too_long":
        return f"text of at most {context['max_length']} characters"
    return _PLAIN_WORDS.get(kind, detail["msg"].removeprefix("Input should be "))


def _unknown_key(key: str, tables: tuple[type[Table], ...]) -> str:
    """Say what could stand instead of a key that is not known."""
    if any(key in table.later for table in tables):
        return "no such key yet: it comes in a later version"
    known = sorted({info.alias or name for table in tables for name, info in table.model_fields.items()})
    if key in known:  # of another of the forms that this table may have
        return "no such key beside those here: it belongs to another form of this table"
    return "no such key" + (did_you_mean(key, known) or f" (known here: {', '.join(known)})")


def _meaning_of(location: Location) -> tuple[tuple[type[Table], ...], tuple[Any, ...]]:
    """Return the tables that may stand at a location, and the types and rules of its last key."""
    tables: tuple[type[Table], ...] = (Case,)
    meaning: tuple[Any, ...] = ()
    for step in location:
        for table in tables:
            field = next((f for n, f in table.model_fields.items() if (f.alias or n) == step), None)
            if field is not None:
                meaning = (*field.metadata, *_parts(field.annotation))
                tables = tuple(part for part in meaning if isinstance(part, type) and issubclass(part, Table))
                break
    return tables, meaning


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield every type, rule and literal within an annotation, outside in."""
    yield annotation if get_origin(annotation) is None else get_origin(annotation)
    if get_origin(annotation) is Literal:
        yield get_args(annotation)
        return
    for part in get_args(annotation):
        yield from _parts(part)


def _describe(meaning: tuple[Any, ...], location: Location) -> str:
    """Say what kind of value belongs where there is none."""
    inside_list = bool(location) and isinstance(location[-1], int)
    for part in meaning:
        if isinstance(part, (Quantity, OverSpeed, Whole)):
            return part.expected
        if part is tuple and not inside_list:
            return "a list"
        if isinstance(part, type) and issubclass(part, Table):
            return f"a table with {', '.join(info.alias or name for name, info in part.model_fields.items())}"
        if isinstance(part, tuple):
            return f"one of {', '.join(repr(choice) for choice in part)}"
    return "a name or text"
