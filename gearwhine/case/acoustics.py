"""Acoustics of a case, `[acoustics]`: method and medium, radiating surface, floor and microphones.

Attributes are named as the keys of the case file and are in SI; frequencies are in Hz.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

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
)

if TYPE_CHECKING:
    from gearwhine.coupling.sound.acoustics import Acoustics as BuiltAcoustics

SpeedOfSound = Annotated[float, Quantity(units.VELOCITY, above=0.0)]


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
    caps: Literal["move", "rest"] = "move"
    """Motion of what closes holes: `move` with the rim, as covers, seals and the outer rings of bearings do, which are
    fastened to it or pressed in; or `rest`, for the method `boundary-elements` or `erp`."""
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
    in_run: bool | None = None
    """Whether `run` finds the sound of its motion, too; the command `sound` always finds that of the steady motion.
    Default: `true` for `rayleigh` and `erp`, `false` for `boundary-elements`, which take minutes."""

    def build(self) -> BuiltAcoustics:
        """Build the settings of the sound.

        Raises
        ------
        gearwhine.coupling.errors.AcousticsError
            Where a choice does not fit the method.
        """
        from gearwhine.coupling.sound.acoustics import Acoustics as BuiltAcoustics
        from gearwhine.coupling.sound.acoustics import Microphone as BuiltMicrophone

        settings = {key: getattr(self, key) for key in type(self).model_fields if key not in ("microphone", "in_run")}
        places = tuple(BuiltMicrophone(one.name, one.position) for one in self.microphone)
        return BuiltAcoustics(microphone=places, **settings)
