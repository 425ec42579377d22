"""The page itself: one HTML file with its pictures inside, without scripts, that prints as it reads."""

import base64
import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from gearwhine import __version__
from gearwhine.case import CaseError, Problem
from gearwhine.output import SUMMARY
from gearwhine.report.sections import Section, sections_of
from gearwhine.report.tables import Table

_LARGEST_PICTURE = 8 << 20  # bytes: a larger file is no picture of ours
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #202428; max-width: 64rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin-bottom: 0; }
h2 { font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #e4e7ea; }
p { margin: .4rem 0; } .note { color: #6a7178; } table { border-collapse: collapse; margin: .8rem 0; }
caption { text-align: left; color: #6a7178; padding: .2rem 0; }
th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid #e4e7ea; }
td { font-variant-numeric: tabular-nums; }
th { font-weight: 600; vertical-align: bottom; } th.text, td.text { text-align: left; }
figure { margin: 1rem 0; break-inside: avoid; } figcaption { color: #6a7178; font-size: .9rem; }
img { max-width: 100%; } pre { background: #f5f6f7; padding: .8rem; overflow-x: auto; font-size: .85rem; }
"""


def report_page(folder: Path) -> str:
    """The results in a folder as HTML.

    Raises
    ------
    CaseError
        Where the folder holds no results, or their summary cannot be read.
    """
    document = _summary(folder)
    pictures = sorted(path for path in folder.glob("*.png") if _is_picture(path))
    sections = sections_of(document)
    shown: set[Path] = set()
    parts = []
    for section in sections:
        own = [path for path in pictures if path not in shown and path.name.startswith(section.pictures)]
        shown.update(own)
        parts.append(_section(section, own))
    if others := [path for path in pictures if path not in shown]:
        parts.append(_section(Section("Further pictures"), others))
    if warnings := document.get("warnings"):
        messages = [str(entry.get("message", entry)) for entry in warnings if isinstance(entry, Mapping)]
        parts.insert(0, _section(Section("Warnings", tuple(messages)), []))
    title = str(document.get("title") or folder.name)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head><body>\n'
        f"<h1>{escape(title)}</h1>\n"
        f'<p class="note">gearwhine {escape(__version__)}; amplitudes are peaks unless they say rms.</p>\n'
        + "".join(parts)
        + _case(folder)
        + "</body></html>\n"
    )


def _summary(folder: Path) -> Mapping[str, Any]:
    expected = f"a results folder with {SUMMARY}: run a command on the case with -o first"
    try:
        document = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise CaseError([Problem("report", str(folder), expected)]) from None
    except ValueError as error:
        raise CaseError([Problem("report", str(folder / SUMMARY), f"{expected}; this one is damaged")]) from error
    if not isinstance(document, Mapping):
        raise CaseError([Problem("report", str(folder / SUMMARY), f"{expected}; this one is not a command's")])
    return document


def _is_picture(path: Path) -> bool:
    return path.is_file() and not path.is_symlink() and path.stat().st_size <= _LARGEST_PICTURE


def _section(section: Section, pictures: Sequence[Path]) -> str:
    sentences = "".join(f"<p>{escape(sentence)}</p>\n" for sentence in section.sentences)
    tables = "".join(_table(table) for table in section.tables)
    return f"<h2>{escape(section.title)}</h2>\n{sentences}{tables}{_figures(pictures)}"


def _table(table: Table) -> str:
    columns, rows = table.filled()
    # A column is text where none of its values is a number.
    words = [not any(_is_number(row[place]) for row in rows) for place in range(len(columns))]
    head = _row("th", [column.heading for column in columns], words)
    body = "".join(_row("td", row, words) for row in rows)
    caption = f"<caption>{escape(table.caption)}</caption>" if table.caption else ""
    return f"<table>{caption}<thead>{head}</thead><tbody>{body}</tbody></table>\n"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


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
    return f"<h2>Case</h2>\n<details><summary>as it was resolved</summary><pre>{escape(text)}</pre></details>\n"
