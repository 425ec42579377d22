"""Results by analysis: each module declares the quantities of one, and the sections that terminal and report show."""

from collections.abc import Callable
from typing import Any

from gearwhine.output.sections import Document, Section
from gearwhine.results.housing import write_shapes

__all__ = ["chapters_of", "write_shapes"]


def chapters_of(document: Document) -> tuple[Section, ...]:
    """Return the chapters of a command's document in the report, leaving out empty ones."""
    from gearwhine.results import (
        check,
        comparison,
        gears,
        housing,
        operating_point,
        rotors,
        run,
        sound,
        sweep,
        system,
        update,
    )
    from gearwhine.results import steady_state as steady

    if document.get("command") == "check":
        return check.sections(document)
    load = document.get("load", document if "gear_pairs" in document and "seats" in document else {})
    modes = document.get("housing", document if "certificate" in document and "mesh" in document else {})
    makers: tuple[tuple[Callable[[Document], Section], Any], ...] = (
        (housing.report, modes),
        (comparison.report, document.get("compare", document if "pairing" in document else {})),
        (update.report, document if "parameters" in document else {}),
        (rotors.report, document if document.get("rotors") else {}),
        (gears.report, document if any("contact_ratio" in pair for pair in document.get("pairs", ())) else {}),
        (operating_point.report, load),
        (system.report, document.get("system", document if "stability" in document else {})),
        (run.report, document if "steps" in document else {}),
        (sound.report, document.get("sound", document if "total_db_a" in document else {})),
        (sweep.report, document if "points" in document and "axes" in document else {}),
        (housing.render_report, document if document.get("command") == "render" else {}),
        (steady.report, document if "motions" in document else {}),
    )
    return tuple(make(given) for make, given in makers if given)
