"""Figures of the sound: power of lines and third octaves, radiating faces, directivity, efficiency of the modes."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from gearwhine.case import Case

if TYPE_CHECKING:
    from gearwhine.solve.sound import SolvedSound


def draw_sound(case: Case, solved: "SolvedSound") -> Iterator[tuple[str, Figure]]:
    """Draw the figures of a case's sound, each with its name."""
    yield from ()
