"""Results by analysis: each module declares the quantities of one, and the sections that terminal and report show."""

from collections.abc import Callable
from dataclasses import replace

from gearwhine.output.sections import Document, Section
from gearwhine.results.housing import write_shapes

__all__ = ["chapters_of", "write_shapes"]

_RUNS = ("run", "simulate")


def chapters_of(document: Document) -> tuple[Section, ...]:
    """Return the chapters of a command's document in the report, leaving out those without results.

    Parameters
    ----------
    document : Document
        With its ``command``. Analyses that other commands include stand under ``housing``, ``compare``, ``load``,
        ``system`` and ``sound``; the rotors and gear pairs of a run stand beside its motion.
    """
    from gearwhine.results import (
        check,
        comparison,
        gears,
        housing,
        operating_point,
        rotors,
        run,
        sound,
        steady_state,
        sweep,
        system,
        update,
    )

    command = document.get("command")

    def own(key: str, *commands: str) -> Document:
        """Return the document where it is one of these commands' and holds the key."""
        return document if command in commands and key in document else {}

    def part(name: str) -> Document:
        included: Document = document.get(name) or {}
        return included

    if command == "check":
        return check.sections(document)
    chapters: tuple[tuple[Callable[[Document], Section], Document], ...] = (
        (housing.report, part("housing") or own("certificate", "modes")),
        (comparison.report, part("compare") or own("pairing", "compare")),
        (update.report, own("parameters", "update")),
        (rotors.report, own("rotors", "rotors", *_RUNS)),
        (gears.report, own("pairs", "gears", *_RUNS)),
        (operating_point.report, part("load") or own("gear_pairs", "load")),
        (system.report, part("system") or own("stability", "system")),
        (run.report, own("steps", *_RUNS)),
        (sound.report, part("sound") or own("total_db_a", "sound")),
        (sweep.report, own("points", "sweep")),
        (housing.render_report, own("command", "render")),
        (steady_state.report, own("motions", "steady")),
    )
    return tuple(replace(chapter(shown), shows=shown) for chapter, shown in chapters if shown)
