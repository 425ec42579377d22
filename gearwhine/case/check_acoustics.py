"""Checks of `[acoustics]`: choices that do not fit the method, each of them a finding of its own."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gearwhine.case.acoustics import Acoustics
from gearwhine.case.errors import NOTHING, Finding
from gearwhine.case.model import Draft

_OF_THE_BOX = re.compile("box [1-9]")  # names of microphones


def check_acoustics(draft: Draft) -> Iterator[Finding]:
    """Yield choices that the method of the sound does not know, and names that the microphones of the box have."""
    given = draft.acoustics
    if given is None:
        return
    for number, one in enumerate(given.microphone):
        if _OF_THE_BOX.fullmatch(one.name):
            expected = "another name: 'box 1' to 'box 9' are the microphones of 'microphone_box'"
            yield Finding(("acoustics", "microphone", number, "name"), expected)
    if given.method == "rayleigh":
        yield from _rayleigh(given)
        return
    if given.faces:
        yield _finding("faces", f"no 'faces': the method {given.method!r} takes the whole surface")
    if given.method == "erp":
        if given.floor is not None:
            yield _finding("floor", "no floor: the method 'erp' is an estimate without a sound field to mirror")
        for key in ("microphone", "microphone_box"):
            if getattr(given, key):
                expected = "no microphones: the method 'erp' gives no sound pressure; boundary elements do"
                yield _finding(key, expected)
    elif given.microphone_box is not None and given.floor is None:
        expected = (
            "a 'floor' such as '-20 mm', the height of the soles, for the box of microphones: ISO 3744 measures over a "
            "hard plane"
        )
        yield _finding("floor", expected, missing=True)


def _rayleigh(given: Acoustics) -> Iterator[Finding]:
    """Yield what Rayleigh's integral over flat faces does not take."""
    if not given.faces:
        expected = "flat faces that radiate, such as faces = ['top'], for the method 'rayleigh'"
        yield _finding("faces", expected, missing=True)
    if given.floor is not None:
        yield _finding("floor", "no floor: with the method 'rayleigh' each face lies in a baffle, its own hard plane")
    if given.mesh_size is not None:
        yield _finding("mesh_size", "no mesh size: 'rayleigh' takes the elements of the housing")
    if given.microphone_box is not None:
        expected = (
            "no box of microphones with the method 'rayleigh': ISO 3744 measures on all sides of a housing on a floor, "
            "and a face in its baffle sounds to one side alone; take boundary elements and a 'floor', or single "
            "[[acoustics.microphone]]s in front of one face"
        )
        yield _finding("microphone_box", expected)
    if given.microphone and len(given.faces) > 1:
        expected = (
            f"no microphones with {len(given.faces)} faces, of which each has a baffle of its own; take one face, or "
            "boundary elements"
        )
        yield _finding("microphone", expected)


def _finding(key: str, expected: str, *, missing: bool = False) -> Finding:
    return Finding(("acoustics", key), expected, NOTHING) if missing else Finding(("acoustics", key), expected)
