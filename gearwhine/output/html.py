"""Report of a results folder: one HTML page with its pictures inside, without scripts, that prints as it reads."""

import base64
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from html import escape
from pathlib import Path
from typing import Any

from gearwhine import __version__
from gearwhine.case import Case, CaseError, Problem, dump_case
from gearwhine.output.files import SUMMARY, file_contents
from gearwhine.output.sections import NOTHING, Document, Section, Table, is_number
from gearwhine.output.store import stored_results

_DIFFERENCES = 6  # keys of the case that are named
_REMARKS = "provenance."  # says where a value is from, and changes none
_LARGEST_PICTURE = 8 << 20  # bytes: a larger file is no picture of ours
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #202428; max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin-bottom: 0; }
h2 { font-size: 1.3rem; margin: 2.6rem 0 .4rem; border-bottom: 2px solid #202428; }
h3 { font-size: 1.1rem; margin-top: 1.8rem; border-bottom: 1px solid #e4e7ea; }
h4 { font-size: 1rem; margin: 1.2rem 0 .2rem; }
p { margin: .4rem 0; } .note { color: #6a7178; } .warning { color: #a33; }
table { border-collapse: collapse; margin: .8rem 0; }
caption { text-align: left; color: #6a7178; padding: .2rem 0; }
th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid #e4e7ea; }
td { font-variant-numeric: tabular-nums; }
th { font-weight: 600; vertical-align: bottom; } th.text, td.text { text-align: left; }
figure { margin: 1rem 0; break-inside: avoid; } figcaption { color: #6a7178; font-size: .9rem; }
img { max-width: 100%; } pre { background: #f5f6f7; padding: .8rem; overflow-x: auto; font-size: .85rem; }
"""


Chapters = Callable[[Document], Iterable[Section]]


def report_page(folder: Path, chapters: Chapters, case: Case | None = None) -> str:
    """Return all results in a folder as HTML, the newest first, each with its time and whether it fits the case.

    Parameters
    ----------
    folder
        The output folder of one command or several.
    chapters
        Makes the chapters of a command's document.
    case
        Against which the case of each result is held; without it the newest result's.

    Raises
    ------
    CaseError
        Where the folder holds no results, or a summary cannot be read.
    """
    results = _results(folder)
    present = _case_of(folder / results[0][0]) if case is None else tomllib.loads(dump_case(case))
    title = str(results[0][1].get("title") or (present or {}).get("title") or folder.name)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head><body>\n'
        f"<h1>{escape(title)}</h1>\n"
        f'<p class="note">gearwhine {escape(__version__)}; amplitudes are peaks unless they say rms.</p>\n'
        + "".join(_result(folder / own, document, present, chapters) for own, document in results)
        + "</body></html>\n"
    )


def _result(place: Path, document: Mapping[str, Any], present: Mapping[str, Any] | None, chapters: Chapters) -> str:
    """One command's results."""
    pictures = sorted(path for path in place.glob("*.png") if _is_picture(path))
    shown: set[Path] = set()
    parts = []
    for section in chapters(document):
        own = [path for path in pictures if path not in shown and path.name.startswith(section.pictures)]
        shown.update(own)
        parts.append(_section(section, own))
    if others := [path for path in pictures if path not in shown]:
        parts.append(_section(Section("Further pictures"), others))
    if warnings := document.get("warnings"):
        messages = [str(entry.get("message", entry)) for entry in warnings if isinstance(entry, Mapping)]
        parts.insert(0, _section(Section("Warnings", tuple(messages)), []))
    return _origin(place, document, present) + "".join(parts) + _case(place)


def _origin(place: Path, document: Mapping[str, Any], present: Mapping[str, Any] | None) -> str:
    """Return a result's command and time, and the differences of its case and input files from those of now."""
    command = document.get("command")
    heading = f"gearwhine {command}" if isinstance(command, str) else "Results"
    sentences = [f"Made {_moment(document.get('made_at'))}."] if document.get("made_at") else []
    for mismatch in (*_differences(_case_of(place), present), *_changed_files(document.get("input_files"))):
        sentences.append(f"Does not fit the case any more: {mismatch}.")
    told = "".join(
        f'<p class="{"warning" if sentence.startswith("Does not") else "note"}">{escape(sentence)}</p>\n'
        for sentence in sentences
    )
    return f"<h2>{escape(heading)}</h2>\n{told}"


def _moment(text: object) -> str:
    try:
        return datetime.fromisoformat(str(text)).strftime("on %Y-%m-%d at %H:%M:%S %Z").strip()
    except ValueError:
        return f"at {text}"


def _differences(made: Mapping[str, Any] | None, present: Mapping[str, Any] | None) -> list[str]:
    """Keys in which the case of a result differs from the present one, in one sentence."""
    if made is None or present is None:
        return []
    before, now = (
        {key: value for key, value in _entries(one) if not key.startswith(_REMARKS)} for one in (made, present)
    )
    keys = [key for key in dict.fromkeys([*before, *now]) if before.get(key) != now.get(key)]
    if not keys:
        return []
    listed = ", ".join(
        f"{key} was {before.get(key, 'absent')}, is {now.get(key, 'absent')}" for key in keys[:_DIFFERENCES]
    )
    more = len(keys) - _DIFFERENCES
    return [listed + (f", and {more} more keys" if more > 0 else "")]


def _entries(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Each number or text of a case with its path of keys; entries of lists by their names."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _entries(inner, f"{key}.{name}" if key else name)
    elif isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
        for place, one in enumerate(value):
            yield from _entries(one, f"{key}.{one.get('name', place)}")
    else:
        yield key, value


def _changed_files(files: object) -> list[str]:
    """Input files whose content is another now, or that are gone."""
    if not isinstance(files, Mapping):
        return []
    found = []
    for name, content in files.items():
        try:
            changed = file_contents([Path(name)])[str(Path(name))] != content
        except OSError:
            found.append(f"{name} cannot be read")
        else:
            if changed:
                found.append(f"{name} has changed")
    return found


def _results(folder: Path) -> list[tuple[Path, Mapping[str, Any]]]:
    expected = f"a results folder with {SUMMARY}, as `gearwhine run CASE -o {folder}` leaves it"
    found = stored_results(folder)
    if (folder / SUMMARY).exists() and not any(own == Path() for own, _ in found):
        raise CaseError([Problem("report", str(folder / SUMMARY), f"{expected}; this one is damaged")])
    if not found:
        raise CaseError([Problem("report", str(folder), expected)])
    return found


def _case_of(place: Path) -> Mapping[str, Any] | None:
    """Return the resolved case beside a result; None where it cannot be read."""
    try:
        return tomllib.loads((place / "case.toml").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def _is_picture(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and path.stat().st_size <= _LARGEST_PICTURE


def _section(section: Section, pictures: Sequence[Path], level: int = 3) -> str:
    heading = f"<h{level}>{escape(section.title + section.note)}</h{level}>\n" if section.title else ""
    content = "".join(
        _table(one) if isinstance(one, Table) else f"<p>{escape(one.strip())}</p>\n" for one in section.content
    )
    inner = "".join(_section(one, [], level + 1) for one in section.inner)
    return f"{heading}{content}{inner}{_figures(pictures)}"


def _table(table: Table) -> str:
    columns, rows = table.filled()
    # A column is text where none of its values is a number.
    words = [not any(is_number(row[place]) for row in rows) for place in range(len(columns))]
    head = _row("th", [column.heading for column in columns], words)
    body = "".join(_row("td", [text if text != NOTHING else "–" for text in row], words) for row in rows)
    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    return f"<table>{caption}<thead>{head}</thead><tbody>{body}</tbody></table>\n"


def _row(cell: str, texts: Iterable[str], words: Sequence[bool]) -> str:
    cells = (
        f"<{cell}{' class=' + chr(34) + 'text' + chr(34) if word else ''}>{escape(text)}</{cell}>"
        for text, word in zip(texts, words, strict=True)
    )
    return f"<tr>{''.join(cells)}</tr>\n"


def _figures(pictures: Sequence[Path]) -> str:
    parts = []
    for path in pictures:
        data = base64.b64encode(path.read_bytes()).decode("ascii")
        caption = escape(path.stem.replace("-", " "))
        image = f'<img alt="{caption}" src="data:image/png;base64,{data}">'
        parts.append(f"<figure>{image}<figcaption>{caption}</figcaption></figure>\n")
    return "".join(parts)


def _case(folder: Path) -> str:
    try:
        text = (folder / "case.toml").read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""
    return f"<h3>Case</h3>\n<details><summary>as it was resolved</summary><pre>{escape(text)}</pre></details>\n"
