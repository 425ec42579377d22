"""Warnings of a command: results that are formally right and physically questionable.

Every document has a list ``warnings`` of entries with a ``name``, a ``message`` and the figures that belong to it. The
command prints the messages on standard error, the report shows them first.
"""

from collections.abc import Iterable, Mapping
from typing import Any

Document = dict[str, Any]


def warning(name: str, message: str, **figures: Any) -> Document:
    """One entry of a document's ``warnings``; ``figures`` have their units in their keys."""
    return {"name": name, "message": message} | figures


def add_warnings(document: Document, found: Iterable[Mapping[str, Any]] = ()) -> None:
    """Append warnings to those that a document has; a message that it has already is not repeated."""
    listed = list(document.get("warnings", ()))
    messages = {entry["message"] for entry in listed}
    for entry in found:
        if entry["message"] not in messages:
            listed.append(dict(entry))
            messages.add(entry["message"])
    document["warnings"] = listed


def joined(*documents: Mapping[str, Any]) -> Document:
    """Merge documents: the keys of later ones win, the warnings of all are joined."""
    whole: Document = {}
    for document in documents:
        found = document.get("warnings", ())
        add_warnings(whole, found)
        whole |= {key: value for key, value in document.items() if key != "warnings"}
    return whole
