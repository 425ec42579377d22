"""Results by analysis: each module declares the quantities of one, and the sections that terminal and report show."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import Any

from gearwhine.commands import COMMANDS, INCLUDED
from gearwhine.output.sections import Document, Section
from gearwhine.results.housing import write_shapes

__all__ = ["chapters_of", "composer", "write_shapes"]


def composer(place: str) -> Callable[[Document], Any]:
    """Return a function that composes sections, by its module in this package and its name: ``"sweep.report"``."""
    module, function = place.split(".")
    return getattr(import_module(f"gearwhine.results.{module}"), function)  # type: ignore[no-any-return]


def chapters_of(document: Document) -> tuple[Section, ...]:
    """Return the chapters of a command's document in the report, leaving out those without results.

    Parameters
    ----------
    document : Document
        Document with its ``command``, by default ``run``.
    """
    command = COMMANDS.get(str(document.get("command", "run")))
    if command is None:
        return ()
    if command.name == "check":
        summary: tuple[Section, ...] = composer("check.sections")(document)
        return summary
    held = [(key, place) for key, place in command.chapters if key in document]
    chapters = ((place, document[key] if key in INCLUDED else document) for key, place in held)
    return tuple(replace(composer(place)(shown), shows=shown) for place, shown in chapters if shown)
