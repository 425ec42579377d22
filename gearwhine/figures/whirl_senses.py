"""Forward and backward whirl in figures: colours, lines and words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.lines import Line2D

from gearwhine.figures.style import BLUE, RED, SERIES
from rotors import MOSTLY_AXIAL

FloatArray = npt.NDArray[np.float64]

# Below this part of a circular whirl the sense is no longer that of the mode as a whole.
PLANAR = 0.05


@dataclass(frozen=True)
class Sense:
    """Sense of whirl: its name, colour and line style."""

    name: str
    color: str
    line: Any


FORWARD = Sense("forward", BLUE, "-")
BACKWARD = Sense("backward", RED, (0, (5, 2)))
MIXED = Sense("planar or mixed", "#6b747c", (0, (6, 2, 1.2, 2)))
AXIAL = Sense("along the axis", SERIES[3], (0, (1.2, 1.8)))


def sense_of(direction: float, axial_share: float = 0.0) -> Sense:
    """The sense for a whirl direction from −1 (circular backward) to 1 (circular forward), unless mostly axial."""
    if axial_share > MOSTLY_AXIAL:
        return AXIAL
    if abs(direction) < PLANAR:
        return MIXED
    return FORWARD if direction > 0.0 else BACKWARD


def with_rotation(directions: npt.ArrayLike, speeds: npt.ArrayLike) -> FloatArray:
    """Directions about +z, (s, ...), as directions in the sense of rotation at speeds (s,); at rest as they are."""
    values, turning = np.asarray(directions, dtype=np.float64), np.asarray(speeds, dtype=np.float64)
    sign = np.where(turning < 0.0, -1.0, 1.0)
    # A run-up against +z begins at rest, and the sense of its rest is that of its run.
    if bool((turning <= 0.0).all()) and bool((turning < 0.0).any()):
        sign = -np.ones_like(turning)
    return np.asarray(values * sign.reshape(-1, *(1,) * (values.ndim - 1)))


def legend_lines(senses: Sequence[Sense], *, solid: bool = False) -> list[Line2D]:
    """A line for each sense that occurs, in the order forward, backward, mixed, axial; ``solid`` for colour alone."""
    return [
        Line2D([], [], color=sense.color, ls="-" if solid else sense.line, lw=1.3, label=sense.name)
        for sense in (FORWARD, BACKWARD, MIXED, AXIAL)
        if sense in senses
    ]
