"""Acoustics of a case, `[acoustics]`: method and medium, radiating surface, floor and microphones.

Attributes are named as the keys of the case file and are in SI; frequencies are in Hz.
"""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import Field, model_validator

from gearwhine.case import units
from gearwhine.case.fields import (
    MOST_ENTRIES,
    Density,
    Length,
    Name,
    Point,
    PositiveFrequency,
    PositiveLength,
    Quantity,
    Table,
    Whole,
    wrong,
)

SpeedOfSound = Annotated[float, Quantity(units.VELOCITY, above=0.0)]


_OF_THE_BOX = re.compile("box [1-9]")  # names of microphones


class Microphone(Table):
    """`[[acoustics.microphone]]`: a point in the air at which the sound pressure is wanted."""

    name: Name
    """Name of the microphone; `box 1` to `box 9` are those of `microphone_box`."""
    position: Point
    """Its position, in the frame of the housing."""


class Acoustics(Table):
    """`[acoustics]`: how the sound that the housing radiates is found.

    An empty table takes boundary elements in free air, with triangles for the housing's highest frequency.
    """

    method: Literal["boundary-elements", "rayleigh", "erp"] = "boundary-elements"
    """`boundary-elements`: the exterior Helmholtz equation over the whole outer surface. `rayleigh`: the flat `faces`,
    each in an infinite baffle. `erp`: the equivalent radiated power, an estimate with a radiation efficiency of 1."""
    density: Density = 1.204
    """Density of the air. Default: at 20 °C and 101.325 kPa."""
    speed_of_sound: SpeedOfSound = 343.2
    """Speed of sound. Default: in air at 20 °C."""
    mesh_size: PositiveLength | None = None
    """Edge of the triangles of the radiating surface. Default: a sixth of the wavelength at `highest_frequency`."""
    highest_frequency: PositiveFrequency | None = None
    """Highest frequency of the sound. Default: the frequency below which the housing's modes are complete."""
    close_holes: PositiveLength | None = None
    """Diameter of the largest hole of the housing that is capped. Default: a tenth more than the widest seat."""
    floor: Length | None = None
    """Height y of a hard floor, which mirrors the sound. The housing stands on it or above it; soles in it do not
    radiate. Default: none."""
    still: tuple[Name, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Surfaces that do not radiate, such as the soles of feet on a bench: names of surfaces of the housing."""
    faces: tuple[Name, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Flat faces that radiate, for the method `rayleigh`: names of surfaces of the housing such as `top`."""
    microphone: tuple[Microphone, ...] = Field(default=(), max_length=MOST_ENTRIES)
    """Microphones, `[[acoustics.microphone]]`."""
    microphone_box: PositiveLength | None = None
    """Distance of nine microphones on a box around the housing, which stands on the `floor` (ISO 3744)."""
    lines: Annotated[int, Whole(1, 400)] = 40
    """Number of spectral lines that are solved at most: those with most power by an estimate."""

    @model_validator(mode="after")
    def _complete(self) -> Acoustics:
        if self.method == "rayleigh" and not self.faces:
            raise wrong("flat faces that radiate, such as faces = ['top'], for the method 'rayleigh'", "faces")
        if self.method != "rayleigh" and self.faces:
            raise wrong(f"no 'faces': the method {self.method!r} takes the whole surface", "faces")
        listens = bool(self.microphone) or self.microphone_box is not None
        place = "microphone" if self.microphone else "microphone_box"
        for number, one in enumerate(self.microphone):
            if _OF_THE_BOX.fullmatch(one.name):
                expected = "another name: 'box 1' to 'box 9' are the microphones of 'microphone_box'"
                raise wrong(expected, "microphone", number, "name")
        if listens and (self.method == "erp" or len(self.faces) > 1):
            raise wrong("no microphones: they need boundary elements, or 'rayleigh' with one face", place)
        if self.microphone_box is not None and (self.floor is None or self.method != "boundary-elements"):
            expected = "boundary elements and a 'floor' for the box of microphones: ISO 3744 measures over a hard plane"
            raise wrong(expected, "microphone_box")
        if self.method != "boundary-elements" and self.floor is not None:
            raise wrong(f"no floor: the method {self.method!r} does not know one", "floor")
        if self.mesh_size is not None and self.method == "rayleigh":
            raise wrong("no mesh size: 'rayleigh' takes the elements of the housing", "mesh_size")
        return self
