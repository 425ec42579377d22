"""Tables of keys of docs/case-file.md and options of docs/commands.md, from the case's schema and the commands.

Meanings are the texts below the keys in `gearwhine/case`; types, units, ranges and defaults are those that the keys are
validated by. Prose stands in the pages; `<!-- keys: ... -->` and `<!-- commands -->` are where tables and options go.
`make docs` fills them in on the site; this program writes both pages, filled in, to the folder `build/reference`.
"""

import ast
import inspect
import re
import sys
import types
import typing
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import StrictBool
from pydantic.fields import FieldInfo

from gearwhine.case import Case, bearings, fields, measured, rotors
from gearwhine.case.fields import OverSpeed, Quantity, Table, Whole
from gearwhine.case.model import KEY_OF_FORM
from gearwhine.cli.command_line import app

ROOT = Path(__file__).resolve().parents[1]
CASE_FILE = ROOT / "docs" / "case-file.md"
COMMANDS = ROOT / "docs" / "commands.md"
OUT = ROOT / "build" / "reference"

_MARKED = re.compile(r"<!-- keys: (\S+) -->")
_HEAD = "| key | value | unit | range | default | meaning |\n|---|---|---|---|---|---|"


# The schema ------------------------------------------------------------------------------------------------------


def tables_in(annotation: Any) -> Iterator[type[Table]]:
    """Every table within an annotation."""
    if inspect.isclass(annotation) and issubclass(annotation, Table):
        yield annotation
    for part in get_args(annotation):
        yield from tables_in(part)


def keys_of(table: type[Table]) -> dict[str, FieldInfo]:
    """Keys of a table as a case file has them, its own before inherited ones."""
    own = vars(table).get("__annotations__", {})
    hidden = {*table.later, *KEY_OF_FORM}
    keys = {field.alias or name: field for name, field in table.model_fields.items() if name not in hidden}
    return dict(sorted(keys.items(), key=lambda item: (item[1].alias or item[0]) not in own and item[0] not in own))


def meanings(table: type[Table]) -> dict[str, str]:
    """Text below each key of a table, inherited ones too."""
    found: dict[str, str] = {}
    for cls in reversed(table.__mro__):
        if not issubclass(cls, Table):
            continue
        body = ast.parse(inspect.getsource(cls)).body[0].body
        for line, text in pairwise(body):
            if isinstance(line, ast.AnnAssign) and isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant):
                alias = table.model_fields[line.target.id].alias if line.target.id in table.model_fields else None
                found[alias or line.target.id] = " ".join(str(text.value.value).split())
    return found


def annotations(table: type[Table]) -> dict[str, Any]:
    """Type of each key with all that `Annotated` says of it."""
    found = {}
    for name, field in table.model_fields.items():
        owner = next(cls for cls in table.__mro__ if name in vars(cls).get("__annotations__", {}))
        # Not `get_type_hints`, which also evaluates private attributes, whose types are known to mypy alone.
        found[field.alias or name] = eval(owner.__annotations__[name], vars(sys.modules[owner.__module__]))  # noqa: S307
    return found


class Section(typing.NamedTuple):
    """A table of the case: where it first stands, its class, and whether other tables may stand there."""

    path: str
    heading: str
    table: type[Table]
    parent: str


def sections() -> list[Section]:
    """Every table of a case once, in the order of the schema."""
    found: list[Section] = []

    def walk(table: type[Table], path: str, form: str = "") -> None:
        for key, hint in annotations(table).items():
            inner = list(tables_in(hint))
            for one in inner:
                if any(section.table is one for section in found):
                    continue
                others = [other for other in inner if other is not one]
                place = f"{path}.{KEY_OF_FORM.get(key, key)}".lstrip(".")
                of_form = f" with `{next(iter(keys_of(one)))}`" if key in KEY_OF_FORM else form
                heading = _heading(place, hint, one, others)
                heading += of_form * any(section.heading == heading for section in found)
                found.append(Section(place, heading, one, path))
                walk(one, place, of_form)

    walk(Case, "")
    return found


def _heading(path: str, hint: Any, table: type[Table], others: list[type[Table]]) -> str:
    if _is_mapping(hint):
        return f"`[{path}.NAME]`"
    shown = f"`[[{path}]]`" if _is_list(hint, table) else f"`[{path}]`"
    if not others:
        return shown
    taken = {key for other in others for key in keys_of(other)}
    own = [key for key in keys_of(table) if key not in taken] or list(keys_of(table))
    return f"{shown} with `{own[0]}`"


def _plain(hint: Any) -> Any:
    """A type without `Annotated` and without None."""
    while get_origin(hint) is Annotated:
        hint = get_args(hint)[0]
    if get_origin(hint) in (typing.Union, types.UnionType):
        rest = [part for part in get_args(hint) if part is not type(None)]
        if len(rest) == 1:
            return _plain(rest[0])
    return hint


def _is_mapping(hint: Any) -> bool:
    return get_origin(_plain(hint)) is dict


def _is_list(hint: Any, table: type[Table]) -> bool:
    plain = _plain(hint)
    if get_origin(plain) is tuple:
        return True
    return get_origin(plain) in (typing.Union, types.UnionType) and any(
        _is_list(part, table) for part in get_args(plain) if table in tables_in(part)
    )


# One key ---------------------------------------------------------------------------------------------------------


class Value(typing.NamedTuple):
    """What a key takes: words for its type, its SI unit and its range."""

    kind: str
    unit: str = ""
    range: str = ""


_NAMED: dict[Any, str] = {
    fields.Direction: '"x", "y", "z" or a vector',
    fields.Vector: "vector",
    rotors.ShearCoefficient: '"cowper", "hutchinson" or a number',
    measured.Amount: "quantity or number",
    measured.KeyPath: "key path",
    bearings.MatrixRows: "5 × 5 × stiffness or damping",
    StrictBool: "true or false",
    bool: "true or false",
    str: "text",
    int: "whole number",
    float: "number",
}


def value_of(hint: Any, link: dict[type[Table], str]) -> Value:
    """Describe the value of a key."""
    for known, words in _NAMED.items():
        if hint == known:
            return Value(words)
    if inspect.isclass(hint) and issubclass(hint, Table):
        return Value(f"[table](#{link[hint]})")
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Annotated:
        for rule in parts[1:]:
            for known, words in ((fields.CaseFile, "file"), (fields.Name, "name")):
                if rule == get_args(known)[1]:
                    return Value(words)
            if isinstance(rule, Quantity):
                return _quantity(rule)
            if isinstance(rule, OverSpeed):
                one = _quantity(rule.each)
                return one._replace(kind=f"{one.kind}, or a list of them")
            if isinstance(rule, Whole):
                return Value("whole number", "", f"{rule.at_least} to {_digits(rule.at_most)}")
        return value_of(parts[0], link)
    if origin is Literal:
        return Value(
            " or ".join(f'"{part}"' for part in parts) if len(parts) < 3 else ", ".join(f'"{part}"' for part in parts)
        )
    if origin in (typing.Union, types.UnionType):
        values = [value_of(part, link) for part in parts if part is not type(None)]
        kinds = list(dict.fromkeys(value.kind for value in values))
        # Forms of one table need one word.
        return Value(" or ".join(kinds), *(next((v[i] for v in values if v[i]), "") for i in (1, 2)))
    if origin is tuple:
        first = value_of(parts[0], link)
        if parts[-1] is Ellipsis:
            return first._replace(kind=f"list of {first.kind}")
        return first._replace(kind=f"{len(parts)} × {first.kind}")
    if origin is dict:
        inner = value_of(parts[1], link)
        return inner._replace(kind=f"table of {inner.kind}")
    raise TypeError(f"no words for {hint}")


def _quantity(rule: Quantity) -> Value:
    name = rule.dimension.name.removeprefix("an ").removeprefix("a ")
    limits = []
    for word, limit in ((">", rule.above), ("≥", rule.at_least), ("<", rule.below), ("≤", rule.at_most)):
        if limit is not None:
            limits.append(f"{word} {rule.write(limit) if rule.dimension.unit and limit != 0.0 else f'{limit:g}'}")
    kind = name if type(rule) is Quantity else f'{name} or "found"'
    return Value("number" if name == "plain number" else kind, rule.dimension.unit, ", ".join(limits))


def _digits(number: int) -> str:
    return f"{number:,}".replace(",", " ") if number < 2**31 - 1 else "2³¹ - 1"


def default_of(field: FieldInfo, hint: Any, meaning: str) -> tuple[str, str]:
    """Default of a key, and its meaning without the sentence that says so."""
    text, _, said = meaning.partition(" Default: ")
    if said:
        return said.rstrip("."), text
    if field.is_required():
        return "**required**", text
    value = field.default
    if value in (None, (), "") or field.default_factory is not None:
        return "–", text
    if isinstance(value, Table) or value == {}:
        return "–", text
    return _written(value, hint), text


def _written(value: Any, hint: Any) -> str:
    rule = _rule(hint)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple):
        return f"[{', '.join(f'{one:g}' for one in value)}]"
    if rule is not None and value != 0.0:
        return str(rule.write(value)) if rule.dimension.unit else f"{value:g}"
    return f"{value:g}"


def _rule(hint: Any) -> Quantity | None:
    if get_origin(hint) is Annotated:
        for rule in get_args(hint)[1:]:
            if isinstance(rule, Quantity):
                return rule
    return next((found for part in get_args(hint) if (found := _rule(part)) is not None), None)


# The page --------------------------------------------------------------------------------------------------------


def slug(heading: str) -> str:
    """Anchor of a heading, as GitHub and MyST make it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def case_tables() -> dict[str, str]:
    """Markdown of each section by the path of its table, the top's under ``case``."""
    all_sections = sections()
    link = {section.table: slug(section.heading) for section in all_sections}
    found = {"case": _rows(Case, link)}
    for section in all_sections:
        level = "##" + "#" * section.path.count(".")
        heading = f"{level[:4]} {section.heading}\n\n{_prose(section.table)}\n\n"
        found[section.path] = found.get(section.path, "") + heading + _rows(section.table, link) + "\n\n"
    return {path: text.rstrip() for path, text in found.items()}


def _prose(table: type[Table]) -> str:
    """Docstring of a table, without the key path that the heading has."""
    text = inspect.getdoc(table) or ""
    text = re.sub(r"^`\[+[\w.]+\]+`: ", "", text)
    paragraphs = [" ".join(paragraph.split()) for paragraph in text.split("\n\n")]
    return "\n\n".join(paragraph[0].upper() + paragraph[1:] for paragraph in paragraphs)


def _rows(table: type[Table], link: dict[type[Table], str]) -> str:
    hints, words = annotations(table), meanings(table)
    lines = [_HEAD]
    for key, field in keys_of(table).items():
        default, meaning = default_of(field, hints[key], words[key])
        value = value_of(hints[key], link)
        cells = (f"`{key}`", value.kind, value.unit, value.range, default, meaning)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def case_file(page: str) -> str:
    """The page of the case file with tables for its marks."""
    tables = case_tables()
    marked = _MARKED.findall(page)
    missing = set(tables) - {path for path in tables for mark in marked if path == mark or path.startswith(f"{mark}.")}
    if missing:
        raise SystemExit(f"{CASE_FILE.name} has no mark for {sorted(missing)}")

    def fill(match: re.Match[str]) -> str:
        mark = match[1]
        deeper = [other for other in marked if other.startswith(f"{mark}.")]
        parts = [
            text
            for path, text in tables.items()
            if path == mark
            or (path.startswith(f"{mark}.") and not any(path == d or path.startswith(f"{d}.") for d in deeper))
        ]
        return "\n\n".join(parts)

    return _MARKED.sub(fill, page)


def commands(page: str) -> str:
    """The page of the commands with a section for each, from their parameters, in place of its mark."""
    text = app.generate_docs(output_format="markdown", heading_level=1)
    text = text[text.index("## gearwhine ") :]
    # A name in angle brackets is no HTML; the first argument has no option of its own in practice.
    text = re.sub(r"<(\w+)>", r"\\<\1\\>", text).replace("```console", "```text")
    text = re.sub(r"\*\*(Parameters|Arguments)\*\*:\n\n| \*\[default: (False|\[\])\]\*", "", text)
    # Where this runs as `python -m pytest`, cyclopts shows that as part of the usage.
    text = re.sub(r"^(gearwhine \w+) -m \S+ ", r"\1 ", text, flags=re.MULTILINE)
    text = text.replace("`CASE, --case`", "`CASE`")
    text = re.sub(r"^## gearwhine (\w+)$", r"## `gearwhine \1`", text, flags=re.MULTILINE).rstrip()
    return page.replace("<!-- commands -->", text)


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    for page, filled in ((CASE_FILE, case_file), (COMMANDS, commands)):
        (OUT / page.name).write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
        print(OUT / page.name)


if __name__ == "__main__":
    sys.exit(main())
