"""Checks of `[acoustics]`: choices that do not fit the method, each of them a finding of its own."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gearwhine.case.acoustics import Acoustics
from gearwhine.case.errors import NOTHING, Finding
from gearwhine.case.model import Draft

_OF_THE_BOX = re.compile("box [1-9]")  # names of microphones


def check_acoustics(draft: Draft) -> Iterator[Finding]:
    """Yield choices that do not fit the method of the sound, and names of microphones that those of the box have."""
    acoustics = draft.acoustics
    if acoustics is None:
        return
    for number, microphone in enumerate(acoustics.microphone):
        if _OF_THE_BOX.fullmatch(microphone.name):
            expected = "another name: 'box 1' to 'box 9' are the microphones of 'microphone_box'"
            yield Finding(("acoustics", "microphone", number, "name"), expected)
    if acoustics.method == "rayleigh":
        yield from _rayleigh(acoustics)
        return
    if acoustics.faces:
        yield _finding("faces", f"no 'faces': the method {acoustics.method!r} takes the whole surface")
    if acoustics.method == "erp":
        if acoustics.floor is not None:
            yield _finding("floor", "no floor: the method 'erp' is an estimate without a sound field to mirror")
        for key in ("microphone", "microphone_box"):
            if getattr(acoustics, key):
                expected = "no microphones: the method 'erp' gives no sound pressure; boundary elements do"
                yield _finding(key, expected)
    elif acoustics.microphone_box is not None and acoustics.floor is None:
        expected = (
            "a 'floor' such as '-20 mm', the height of the soles, for the box of microphones: ISO 3744 measures over a "
            "hard plane"
        )
        yield _finding("floor", expected, missing=True)


def _rayleigh(acoustics: Acoustics) -> Iterator[Finding]:
    """Yield choices that do not fit Rayleigh's integral over flat faces."""
    if not acoustics.faces:
        expected = "flat faces that radiate, such as faces = ['top'], for the method 'rayleigh'"
        yield _finding("faces", expected, missing=True)
    if acoustics.floor is not None:
        yield _finding("floor", "no floor: with the method 'rayleigh' each face lies in a baffle, its own hard plane")
    if acoustics.caps != "move":
        yield _finding("caps", "no caps: 'rayleigh' has the flat faces alone")
    if acoustics.mesh_size is not None:
        yield _finding("mesh_size", "no mesh size: 'rayleigh' takes the elements of the housing")
    if acoustics.microphone_box is not None:
        expected = (
            "no box of microphones with the method 'rayleigh': ISO 3744 measures on all sides of a housing on a floor, "
            "and a face in its baffle sounds to one side alone; take boundary elements and a 'floor', or single "
            "[[acoustics.microphone]]s in front of one face"
        )
        yield _finding("microphone_box", expected)
    if acoustics.microphone and len(acoustics.faces) > 1:
        expected = (
            f"no microphones with {len(acoustics.faces)} faces, of which each has a baffle of its own; take one face, "
            "or boundary elements"
        )
        yield _finding("microphone", expected)


def _finding(key: str, expected: str, *, missing: bool = False) -> Finding:
    return Finding(("acoustics", key), expected, NOTHING) if missing else Finding(("acoustics", key), expected)
