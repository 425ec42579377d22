"""Checks of `[acoustics]`: choices that do not fit the method, each of them a finding of its own."""

from __future__ import annotations

from collections.abc import Iterator

from gearwhine.case.checks.keys_of_attributes import steps_of
from gearwhine.case.errors import LOOK_UP, NOTHING, Finding
from gearwhine.case.model import Draft


def check_acoustics(draft: Draft) -> Iterator[Finding]:
    """Yield choices that do not fit the method of the sound, and names of microphones that those of the box have."""
    if draft.acoustics is None:
        return
    from gearwhine.coupling.errors import AcousticsError

    try:
        draft.acoustics.build()
    except AcousticsError as error:
        # Names that are given twice are found with those of all tables.
        for finding in (finding for finding in error.findings if finding.part[0] == "acoustics"):
            place = ("acoustics", *steps_of(finding.attribute))
            yield Finding(place, finding.expected, NOTHING if finding.value is None else LOOK_UP)
