"""Names that options take, which the command line reads without loading a renderer or the gears."""

from typing import Literal

View = Literal[
    "auto",
    "iso",
    "front",
    "back",
    "left",
    "right",
    "top",
    "iso-left",
    "iso-back",
    "iso-back-left",
    "iso-below",
    "iso-left-below",
    "iso-back-below",
    "iso-opposite",
]
"""Directions of view, see :mod:`gearwhine.housing.pictures.views`."""

GearPart = Literal["harris-map", "relief"]
"""What the analysis of gear pairs may be without: Harris maps, the search for the best tip relief."""

ModeFormat = Literal["png", "glb", "gif", "mp4"]
"""Formats of drawn modes: pictures, animated models, films."""
