"""Names of the directions of view of pictures, which the command line reads without loading a renderer."""

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
