"""Loading a case, from a file or a bundled name, to a checked `Case`; all problems in one error.

Bundled cases are found by their names. Validation errors of pydantic become findings in the case file's terms.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.resources import files
from importlib.resources.abc import Traversable
from itertools import dropwhile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from gearwhine.case.checks.plausible import library_findings
from gearwhine.case.checks.whole_case import check, warnings_of, without_changed
from gearwhine.case.errors import NOTHING, UNSAID, CaseError, Finding, Location, Problem, problem_of
from gearwhine.case.fields import OverSpeed, Quantity, Table, Whole, meaning_of_field
from gearwhine.case.input_files import InputFiles
from gearwhine.case.model import KEY_OF_FORM, Case, case_document, draft_of_case, draft_of_document
from gearwhine.case.overrides import apply_overrides
from gearwhine.case.planetary import with_implied_pairs, with_planets
from gearwhine.exchange.file_names import LARGEST_MODEL, is_rexs_file
from gearwhine.numerics.names import did_you_mean

if TYPE_CHECKING:
    from gearwhine.exchange.rexs import ImportedCase

_SUFFIX = ".toml"


def bundled_cases() -> dict[str, str]:
    """Return the title of each bundled case by its name, in alphabetical order."""
    titles = {}
    for entry in sorted(_entries(), key=lambda entry: entry.name):
        title = tomllib.loads(entry.read_text(encoding="utf-8")).get("title", "")
        titles[entry.name.removesuffix(_SUFFIX)] = str(title)
    return titles


def bundled_case(name: str) -> Traversable | None:
    """Return the file of a bundled case; None where there is none of that name."""
    return next((entry for entry in _entries() if entry.name == name + _SUFFIX), None)


def bundled_files(name: str) -> tuple[Traversable, ...]:
    """Return the file of a bundled case and those that it reads, which have its name and other endings."""
    case = bundled_case(name)
    if case is None:
        return ()
    beside = [entry for entry in files("gearwhine.cases").iterdir() if entry.name.partition(".")[0] == name]
    return (case, *sorted((entry for entry in beside if entry.name != case.name), key=lambda entry: entry.name))


def bundled_names() -> tuple[str, ...]:
    """Return the names of the bundled cases, in alphabetical order, without reading them."""
    return tuple(sorted(entry.name.removesuffix(_SUFFIX) for entry in _entries()))


def _entries() -> list[Traversable]:
    return [entry for entry in files("gearwhine.cases").iterdir() if entry.name.endswith(_SUFFIX)]


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
    details = error.errors(include_url=False)
    for detail in details:
        if detail["type"] == "default_factory_not_called":
            continue  # a default that follows from a key which is itself at fault
        if detail["type"] == "too_short" and any(_is_inside(other["loc"], detail["loc"]) for other in details):
            continue  # entries that are themselves at fault are not counted
        context = detail.get("ctx", {})
        # Steps that begin with "~" tell which form of a key was meant; they are not in the file.
        steps = [step for step in detail["loc"] if not str(step).startswith("~") and step != "[key]"]
        location = (*steps, *context.get("at", ()))
        meaning, tables = _meaning_of(location)[1], _meaning_of(location[:-1])[0]
        if len(location) > 1:
            location = (KEY_OF_FORM.get(str(location[0]), location[0]), *location[1:])
        if detail["type"] == "missing":
            yield Finding(location, _describe(meaning, location), NOTHING)
        elif detail["type"] == "extra_forbidden":
            yield Finding(location, _unknown_key(str(location[-1]), tables))
        else:
            yield Finding(location, _expected(detail, context), note=context.get("note", ""))


def _is_inside(location: tuple[int | str, ...], outer: tuple[int | str, ...]) -> bool:
    """Whether a location is below another one."""
    return len(location) > len(outer) and location[: len(outer)] == outer


def _expected(detail: ErrorDetails, context: dict[str, Any]) -> str:
    """Return what pydantic expects at an error."""
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


_FIELD_WORDS = {
    "beta": "helix_angle",
    "crowning": "errors.helix.crowning",
    "end_relief": "errors.helix.end_relief",
    "helix": "helix_angle",
    "helix_crowning": "errors.helix.crowning",
    "helix_modification": "errors.helix",
    "lead": "errors.helix.slope",
    "lead_crowning": "errors.helix.crowning",
    "lead_modification": "errors.helix",
    "number_of_teeth": "teeth",
}
"""Words of the field for keys of a table, or of one in it; in that one the path begins later."""


def _unknown_key(key: str, tables: tuple[type[Table], ...]) -> str:
    """Return a hint on keys in place of an unknown one."""
    if any(key in table.later for table in tables):
        return "no such key yet: it comes in a later version"
    fields = {name: info for table in tables for name, info in table.model_fields.items() if name not in KEY_OF_FORM}
    keys = sorted({info.alias or name for name, info in fields.items()})
    if key in keys:  # of another of the forms that this table may have
        return "no such key beside those here: it belongs to another form of this table"
    path = dropwhile(lambda step: step not in keys, _FIELD_WORDS.get(key, "").split("."))
    if elsewhere := ".".join(path):
        return f"no such key; did you mean {elsewhere!r}?"
    return "no such key" + (did_you_mean(key, keys) or f" (known here: {', '.join(keys)})")


def _meaning_of(location: Location) -> tuple[tuple[type[Table], ...], tuple[Any, ...]]:
    """Return the tables that may stand at a location, and the types and rules of its last key."""
    tables: tuple[type[Table], ...] = (Case,)
    meaning: tuple[Any, ...] = ()
    for step in location:
        for table in tables:
            field = next((f for n, f in table.model_fields.items() if (f.alias or n) == step), None)
            if field is not None:
                meaning = tuple(meaning_of_field(field))
                tables = tuple(part for part in meaning if isinstance(part, type) and issubclass(part, Table))
                break
    return tables, meaning


def _describe(meaning: tuple[Any, ...], location: Location) -> str:
    """Return the kind of value that a missing key needs."""
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


DEEPEST = 32
"""Tables and lists within each other beyond which a case is refused."""

_DOTTED_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"[ \t]*+|'[^'\n]*+'[ \t]*+)\.(?:[ \t]*+(?=["']))?"""
_DEEP_KEY = re.compile(rf"(?:^|[\[{{,])[ \t]*+(?:{_DOTTED_PART}){{{DEEPEST}}}", re.MULTILINE)
"""A dotted key of more tables within each other than any case has."""

LARGEST_FILE = 20_000_000
"""Bytes beyond which a file is not taken for a case."""


@dataclass(frozen=True)
class LoadedCase:
    """A case as it is read.

    Attributes
    ----------
    case : Case
        Checked case, in SI.
    warnings : tuple of str
        Allowed but implausible choices, a sentence each.
    source : CaseSource
        Tables, changes and input files that the case is made of.
    """

    case: Case
    warnings: tuple[str, ...]
    source: CaseSource


@dataclass(frozen=True)
class CaseSource:
    """Content that a case is made of, as it was when it was read: later changes of files are not seen.

    Attributes
    ----------
    written : mapping
        The case as TOML gives it.
    folder : path
        Folder in which relative file names start.
    name : str
        Name of the file, for messages; empty for tables of Python.
    changes : tuple of str
        Changes of keys, see `apply_overrides`.
    files : InputFiles
        Input files that have been read.
    imported : ImportedCase, optional
        Gear unit of another program's file that `written` was made of.
    """

    written: Mapping[str, Any]
    folder: Path
    name: str = ""
    changes: tuple[str, ...] = ()
    files: InputFiles = field(default_factory=InputFiles)
    imported: ImportedCase | None = None

    @property
    def input_paths(self) -> list[Path]:
        """Every file that is read: the case, the files that it names, and those that are read with them."""
        from gearwhine.meshes.formats.companions import companion_files

        named = [Path(path) for path in self.files.contents]
        companions = [companion for path in named for companion in companion_files(path)]
        return [*([self.folder / self.name] if self.name else []), *named, *companions]

    def without(self, *tables: str) -> CaseSource:
        """Return the content without some tables, and without changes of them."""
        written = {key: table for key, table in self.written.items() if key not in tables}
        changes = tuple(text for text in self.changes if text.partition(".")[0] not in tables)
        return replace(self, written=written, changes=changes)

    def changed(self, changes: Sequence[str] = ()) -> LoadedCase:
        """Make the case with further changes, and check it.

        Raises
        ------
        CaseError
            With everything that is wrong.
        """
        case, overrides = self.changed_case(changes), (*self.changes, *changes)
        warnings = warnings_of(case) if self.imported is None else (self.imported.summary, *warnings_of(case))
        return LoadedCase(case, warnings, replace(self, changes=overrides, files=case.input_files))

    def changed_case(self, changes: Sequence[str] = ()) -> Case:
        """Make the case with further changes, and check it; its warnings are not looked for.

        Raises
        ------
        CaseError
            With everything that is wrong.
        """
        files = self.files.copy()
        document, sources = self._document(changes, files)
        return parse_case(document, folder=self.folder, source=self.name, sources=sources, files=files)

    @property
    def document(self) -> dict[str, Any]:
        """Tables of the case with the changes, its planets as they are written."""
        return self._document((), self.files.copy())[0]

    def _document(self, changes: Sequence[str], files: InputFiles) -> tuple[dict[str, Any], Mapping[Any, Any]]:
        """Return the tables with further changes, and by which change each key has its value."""
        written = dict(self.written)
        overrides = (*self.changes, *changes)
        if any(override.startswith("gear_pair") for override in overrides):
            written = with_implied_pairs(written)

        def resolved(document: dict[str, Any]) -> Mapping[str, Any]:
            try:
                return case_document(parse_case(document, folder=self.folder, files=files))
            except CaseError:  # a later change may correct it
                return document

        document, sources = apply_overrides(written, overrides, resolved)
        return without_changed(document, written, sources.keys()), sources


def load_case(source: str | os.PathLike[str], overrides: Sequence[str] = ()) -> LoadedCase:
    """Read and check a case.

    Parameters
    ----------
    source : str or path
        Case file, or name of a bundled case. A file of that name precedes a bundled case. A gear unit in a REXS file
        is imported.
    overrides : sequence of str
        Changes such as ``"housing.box.wall=10 mm"``, see `apply_overrides`; they remove `[provenance]` of the values
        that they change.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    path, content = _read(source)
    if is_rexs_file(path):
        imported = imported_case(path.name, content)
        return CaseSource(imported.document, path.parent, path.name, imported=imported).changed(overrides)
    return CaseSource(_as_case(_parse(content, path.name), path), path.parent, path.name).changed(overrides)


def imported_case(name: str, content: bytes, load_case: str = "") -> ImportedCase:
    """Return the gear unit of a REXS file as a case.

    Parameters
    ----------
    name : str
        Name of the file, for messages.
    content : bytes
    load_case : str
        Number of the load case; by default the first.

    Raises
    ------
    CaseError
        Where the file cannot be read, or has no gear unit that a case can hold.
    """
    from gearwhine.exchange.rexs import RexsError, case_of, read_content
    from gearwhine.exchange.rexs.errors import UNSAID as NO_VALUE

    try:
        return case_of(read_content(content), name, load_case)
    except RexsError as error:
        raise CaseError(
            Problem(one.place, UNSAID if one.value is NO_VALUE else one.value, one.expected, source=name)
            for one in error.problems
        ) from None


def read_rexs_file(source: str | os.PathLike[str]) -> tuple[str, bytes]:
    """Return name and content of a REXS file.

    Raises
    ------
    CaseError
        Where its name has none of the endings of such files, or it cannot be read.
    """
    from gearwhine.exchange.file_names import ENDINGS

    if not is_rexs_file(source):
        raise CaseError([Problem("the file", os.fspath(source), f"a REXS file, which ends in {', '.join(ENDINGS)}")])
    path, content = _read(source)
    return path.name, content


def parse_case(
    document: Mapping[str, Any],
    *,
    folder: str | os.PathLike[str] = ".",
    source: str = "",
    sources: Mapping[Location, str] | None = None,
    files: InputFiles | None = None,
) -> Case:
    """Validate and check nested tables and lists, as TOML gives them.

    Parameters
    ----------
    document : mapping
        The case as a dictionary.
    folder : path
        Folder in which relative file names start.
    source : str
        Name of the file, for messages.
    sources : mapping of location to str, optional
        Names of the sources of single values that are not from the file.
    files : InputFiles, optional
        Input files that have been read already; those of this case are added.

    Raises
    ------
    CaseError
        With everything that is wrong.
    """
    _check_depth(document, source)
    context = {"folder": Path(folder), "files": InputFiles() if files is None else files}
    findings: list[Finding] = []
    whole, copies = with_planets(document, context)
    try:
        case = Case.model_validate(whole, context=context)
        draft = draft_of_case(case, whole)
    except ValidationError as error:
        findings += findings_of(error)
        broken = frozenset(str(finding.location[0]) for finding in findings if finding.location)
        draft = draft_of_document(whole, broken, context)
    findings += check(draft)
    if not findings:
        findings += [finding for finding in library_findings(case) if not finding.warns]
    if findings:
        raise CaseError(_in_words(copies.as_written(findings), document, source, sources or {}))
    return case


def _in_words(
    findings: Iterable[Finding], document: object, source: str, sources: Mapping[Location, str]
) -> list[Problem]:
    """Return findings as problems, each once."""
    problems: dict[Problem, None] = {}
    for finding in findings:
        within = [place for place in sources if finding.location[: len(place)] == place]
        origin = sources[max(within, key=len)] if within else source
        problems[problem_of(finding, document, origin)] = None
    return list(problems)


def _read(source: str | os.PathLike[str]) -> tuple[Path, bytes]:
    """Return the place and content of a case file or bundled case."""
    name = os.fspath(source)
    path = Path(name)
    bundled = bundled_case(name) if isinstance(source, str) else None
    try:
        if bundled is not None and not path.is_file():
            return Path(str(bundled)), bundled.read_bytes()
        if path.is_dir():
            raise CaseError([Problem("case", name, "a case file; this is a folder")])
        largest = LARGEST_MODEL if is_rexs_file(path) else LARGEST_FILE
        if path.stat().st_size > largest:
            raise CaseError([Problem("case", name, f"a case file of at most {largest // 10**6} MB")])
        return path, path.read_bytes()
    except FileNotFoundError:
        names = bundled_names()
        expected = f"an existing file, or one of the bundled cases {', '.join(names)}{did_you_mean(name, names)}"
    except (OSError, ValueError) as error:
        if isinstance(error, CaseError):
            raise
        expected = f"a readable file ({getattr(error, 'strerror', None) or error})"
    raise CaseError([Problem("case", name, expected)])


def _parse(content: bytes, source: str) -> dict[str, Any]:
    """Parse TOML text; an error names its line and column."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise CaseError([Problem(f"line {line}", content[error.start], "text in UTF-8", source=source)]) from None
    try:
        if _DEEP_KEY.search(text):  # which the parser takes half a minute for
            raise _too_deep(source)
        document = tomllib.loads(text)
        _check_depth(document, source)
        return document
    except CaseError:
        raise
    except RecursionError:
        raise _too_deep(source) from None
    except ValueError as error:
        place, message = _place_of(str(error), text)
        raise CaseError([Problem(place, UNSAID, f"TOML ({message})", source=source)]) from None


def _as_case(document: dict[str, Any], path: Path) -> dict[str, Any]:
    """Return the document, or for a rotor saved by ROSS a case of that rotor alone."""
    if "ross_version" not in document:
        return document
    return {"title": f"{path.name}, a rotor saved by ROSS", "rotor": [{"name": path.stem, "file": path.name}]}


def _check_depth(document: object, source: str) -> None:
    """Raise where tables and lists stand in each other deeper than any case needs."""
    level = [document]
    for _ in range(DEEPEST):
        level = [
            inner
            for outer in level
            for inner in (outer.values() if isinstance(outer, Mapping) else outer if isinstance(outer, list) else ())
            if type(inner) not in (str, float, int, bool)
        ]
        if not level:
            return
    raise _too_deep(source)


def _too_deep(source: str) -> CaseError:
    return CaseError([Problem("case", UNSAID, f"tables and lists at most {DEEPEST} deep", source=source)])


def _place_of(message: str, text: str) -> tuple[str, str]:
    """Split a TOML error into its line and column, and its message."""
    match = re.search(r" \(at line (\d+), column (\d+)\)$", message)
    if match is not None:
        return f"line {match[1]}, column {match[2]}", message[: match.start()]
    lines = text.split("\n")
    return f"line {len(lines)}, column {len(lines[-1]) + 1}", message.removesuffix(" (at end of document)")
