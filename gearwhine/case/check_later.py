"""Checks for what a case may already say and only a later version will compute: refused rather than ignored."""

from __future__ import annotations

from collections.abc import Iterator

from gearwhine.case.draft import Draft
from gearwhine.case.problems import UNSAID, Finding


def check_later(draft: Draft) -> Iterator[Finding]:
    """Yield bows, sound or not."""
    for index, rotor in draft.raw_entries("rotor"):
        if rotor.get("bow"):
            yield Finding(("rotor", index, "bow"), "no points: residual bow comes in a later version", UNSAID)
