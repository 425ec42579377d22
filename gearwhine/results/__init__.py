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
        Document with its ``command``. Analyses that other commands include are ``housing``, ``compare``, ``load``,
        ``system`` and ``sound``; the rotors and gear pairs of a run stand beside its motion.
    """
    from gearwhine.results import (
        check,
        comparison,
        detection,
        gears,
        housing,
        modes,
        operating_point,
        optimisation,
        rotors,
        run,
        sound,
        steady_state,
        sweep,
        system,
        update,
        variation,
    )

    command = document.get("command")

    def if_command(key: str, *commands: str) -> Document:
        """Return the document where it is one of these commands' and holds the key."""
        return document if command in commands and key in document else {}

    def part(name: str) -> Document:
        included: Document = document.get(name) or {}
        return included

    if command == "check":
        return check.sections(document)
    chapters: tuple[tuple[Callable[[Document], Section], Document], ...] = (
        (housing.report, part("housing") or if_command("certificate", "modes")),
        (modes.report, if_command("reduced_housing", "modes")),
        (comparison.report, part("compare") or if_command("pairing", "compare")),
        (update.report, if_command("parameters", "update")),
        (rotors.report, if_command("rotors", "rotors", *_RUNS)),
        (gears.report, if_command("pairs", "gears", *_RUNS)),
        (operating_point.report, part("load") or if_command("gear_pairs", "load")),
        (system.report, part("system") or if_command("stability", "system")),
        (run.report, if_command("steps", *_RUNS)),
        (sound.report, part("sound") or if_command("total_db_a", "sound")),
        (sweep.report, if_command("points", "sweep")),
        (variation.report, if_command("quantities", "vary")),
        (detection.report, if_command("detectability", "detect")),
        (optimisation.report, if_command("designs", "optimise")),
        (housing.render_report, if_command("command", "render")),
        (steady_state.report, if_command("motions", "steady")),
    )
    return tuple(replace(chapter(shown), shows=shown) for chapter, shown in chapters if shown)
