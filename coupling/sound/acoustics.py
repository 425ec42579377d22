"""Acoustics of a housing: method and medium, radiating surface, floor and microphones."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gearwhine.coupling.errors import AcousticsError
from gearwhine.housing.acoustics.medium import AIR, HardPlane, Medium
from gearwhine.housing.acoustics.sound_levels import measurement_box
from gearwhine.housing.modes.housing_field import HousingField
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import (
    Choice,
    Finding,
    Instance,
    Number,
    Numbers,
    Part,
    Rule,
    Text,
    attribute_findings,
    kind_findings,
    refuse,
)
from gearwhine.numerics.own_copies import keep_tuples

MOST_LINES = 400
"""Largest number of spectral lines that are solved."""

_PART: Part = ("acoustics", "")
_OF_THE_BOX = re.compile("box [1-9]")  # names of microphones
_TRIANGLES_PER_WAVELENGTH = 6.0
_GASES = (0.05, 20.0)
"""Densities of gases around a housing [kg/m³]: a fluid as heavy as a liquid loads the housing, which is left out."""
_SOUND = (100.0, 1400.0)
"""Speeds of sound in gases [m/s]."""
_HOLES = 1.1  # diameter of holes that are closed by default, over that of the widest seat


@dataclass(frozen=True)
class Microphone:
    """Point in the air at which the sound pressure is wanted.

    Attributes
    ----------
    name : str
        Name; ``box 1`` to ``box 9`` are those of :attr:`Acoustics.microphone_box`.
    position : tuple of float
        Position in the frame of the housing [m].

    Raises
    ------
    AcousticsError
        Where it has no name or is no point.
    """

    name: str
    position: tuple[float, float, float]

    def __post_init__(self) -> None:
        """Check name and position."""
        part = ("microphone", str(self.name))
        refuse(attribute_findings(part, self, name=Text(), position=Numbers(3)), AcousticsError)
        keep_tuples(self, "position")


@dataclass(frozen=True)
class Acoustics:
    """Settings of the sound that a housing radiates.

    Attributes
    ----------
    method : {"boundary-elements", "rayleigh", "erp"}
        ``boundary-elements``: the exterior Helmholtz equation over the whole outer surface. ``rayleigh``: the flat
        ``faces``, each in an infinite baffle. ``erp``: the equivalent radiated power, an estimate with a radiation
        efficiency of 1.
    density : float
        Density of the air [kg/m³]; by default at 20 °C and 101.325 kPa.
    speed_of_sound : float
        Speed of sound [m/s]; by default in air at 20 °C.
    mesh_size : float, optional
        Edge of the triangles of the radiating surface [m]; by default a sixth of the wavelength at
        ``highest_frequency``.
    highest_frequency : float, optional
        Highest frequency of the sound [Hz]; by default the frequency below which the housing's modes are complete.
    close_holes : float, optional
        Diameter of the largest hole of the housing that is capped [m]; by default a tenth more than the widest seat.
    caps : {"move", "rest"}
        Motion of what closes holes: with the rim, as covers, seals and the outer rings of bearings do, or none.
    floor : float, optional
        Height y of a hard floor, which mirrors the sound [m]. The housing stands on it or above it.
    still : tuple of str
        Surfaces that do not radiate, by their names in the mesh.
    faces : tuple of str
        Flat faces that radiate, for the method ``rayleigh``, by their names in the mesh.
    microphone : tuple of Microphone
    microphone_box : float, optional
        Distance of nine microphones on a box around the housing, which stands on the ``floor`` (ISO 3744) [m].
    lines : int
        Number of spectral lines that are solved at most: those with most power by an estimate.

    Raises
    ------
    AcousticsError
        Where a number is out of its range, a name is given twice, or a choice does not fit the method.
    """

    method: Literal["boundary-elements", "rayleigh", "erp"] = "boundary-elements"
    density: float = AIR.density
    speed_of_sound: float = AIR.speed_of_sound
    mesh_size: float | None = None
    highest_frequency: float | None = None
    close_holes: float | None = None
    caps: Literal["move", "rest"] = "move"
    floor: float | None = None
    still: tuple[str, ...] = ()
    faces: tuple[str, ...] = ()
    microphone: tuple[Microphone, ...] = ()
    microphone_box: float | None = None
    lines: int = 40

    def __post_init__(self) -> None:
        """Keep own copies; check every choice."""
        keep_tuples(self, "still", "faces", "microphone")
        positive = {name: Number(above=0.0) for name in ("density", "speed_of_sound")}
        lengths = ("mesh_size", "highest_frequency", "close_holes", "microphone_box")
        positive |= {name: Number(above=0.0, optional=True) for name in lengths}
        rules: dict[str, Rule] = {
            "method": Choice(("boundary-elements", "rayleigh", "erp")),
            **positive,
            "caps": Choice(("move", "rest")),
            "floor": Number(optional=True, unit="m"),
            "lines": Number(at_least=1, at_most=MOST_LINES, whole=True),
            "still": Instance(tuple, "a list of names of surfaces"),
            "faces": Instance(tuple, "a list of names of surfaces"),
            "microphone": Instance(tuple, "a list of microphones"),
        }
        refuse(attribute_findings(_PART, self, **rules), AcousticsError)
        refuse(kind_findings(_PART, self, still=str, faces=str, microphone=Microphone), AcousticsError)
        refuse(self._choice_findings(), AcousticsError)

    @property
    def findings(self) -> Iterator[Finding]:
        """Density and speed of sound that no gas has."""
        if not _GASES[0] <= self.density <= _GASES[1]:
            expected = "a density of 0.05 to 20 kg/m^3, of a gas (air: 1.204): a liquid's mass on the walls is left out"
            yield Finding(_PART, "density", self.density, expected, "warning")
        if not _SOUND[0] <= self.speed_of_sound <= _SOUND[1]:
            expected = "a speed of sound of 100 to 1400 m/s, of a gas (air: 343)"
            yield Finding(_PART, "speed_of_sound", self.speed_of_sound, expected, "warning")

    @property
    def medium(self) -> Medium:
        """The air around the housing."""
        return Medium(self.density, self.speed_of_sound)

    @property
    def floor_plane(self) -> HardPlane | None:
        """The floor as a plane that mirrors the sound."""
        if self.floor is None:
            return None
        return HardPlane(np.array([0.0, self.floor, 0.0]), np.array([0.0, 1.0, 0.0]))

    def edge(self, limit_hz: float) -> float:
        """Return the edge of the triangles for a highest frequency [Hz] of the sound [m]."""
        return self.mesh_size or self.speed_of_sound / (_TRIANGLES_PER_WAVELENGTH * limit_hz)

    def closed_holes(self, edge: float, widest_bore: float | None) -> float:
        """Return the diameter of the largest hole that is closed [m].

        Parameters
        ----------
        edge : float
            Edge of the triangles [m].
        widest_bore : float or None
            Diameter of the housing's widest seat [m].
        """
        return self.close_holes or _HOLES * (edge if widest_bore is None else widest_bore)

    def limit_hz(self, housing: HousingField) -> float:
        """Return the highest frequency of the sound of a housing [Hz]: as given, else where the modes are complete."""
        return self.highest_frequency or housing.complete_below_hz

    def estimated_below_hz(self, housing: HousingField) -> float:
        """Return the frequency up to which lines are estimated [Hz]: at least where the modes are complete."""
        return max(self.limit_hz(housing), housing.complete_below_hz)

    def microphones(self, bounds: FloatArray) -> tuple[dict[str, FloatArray], float | None]:
        """Return positions of the microphones [m], and the area of the box that the last nine stand on [m²].

        Parameters
        ----------
        bounds : ndarray, shape (2, 3)
            Lowest and highest corner of the housing [m].
        """
        positions = {microphone.name: np.array(microphone.position) for microphone in self.microphone}
        if self.microphone_box is None or self.floor is None:
            return positions, None
        low, high = (np.array(corner) for corner in bounds)
        low[1] = self.floor
        on_box, area = measurement_box(low, high, self.microphone_box)
        return positions | {f"box {number}": place for number, place in enumerate(on_box, start=1)}, area

    def _choice_findings(self) -> Iterator[Finding]:
        """Yield choices that do not fit the method, and names that other microphones have."""
        names = [microphone.name for microphone in self.microphone]
        for number, name in enumerate(names):
            if _OF_THE_BOX.fullmatch(name):
                expected = "another name: 'box 1' to 'box 9' are the microphones of 'microphone_box'"
                yield Finding(_PART, f"microphone.{number}.name", name, expected)
            elif name in names[:number]:
                expected = f"each name once; it is given {names.count(name)} times"
                yield Finding(("microphone", name), "name", name, expected)
        if self.method == "rayleigh":
            yield from self._rayleigh_findings()
            return
        if self.faces:
            yield self._unfit("faces", f"no 'faces': the method {self.method!r} takes the whole surface")
        if self.method == "erp":
            if self.floor is not None:
                yield self._unfit("floor", "no floor: the method 'erp' is an estimate without a sound field to mirror")
            for attribute in ("microphone", "microphone_box"):
                if getattr(self, attribute):
                    expected = "no microphones: the method 'erp' gives no sound pressure; boundary elements do"
                    yield self._unfit(attribute, expected)
        elif self.microphone_box is not None and self.floor is None:
            expected = (
                "a 'floor' such as '-20 mm', the height of the soles, for the box of microphones: ISO 3744 measures "
                "over a hard plane"
            )
            yield Finding(_PART, "floor", None, expected)

    def _rayleigh_findings(self) -> Iterator[Finding]:
        """Yield choices that do not fit Rayleigh's integral over flat faces."""
        if not self.faces:
            expected = "flat faces that radiate, such as faces = ['top'], for the method 'rayleigh'"
            yield Finding(_PART, "faces", None, expected)
        if self.floor is not None:
            expected = "no floor: with the method 'rayleigh' each face lies in a baffle, its own hard plane"
            yield self._unfit("floor", expected)
        if self.caps != "move":
            yield self._unfit("caps", "no caps: 'rayleigh' has the flat faces alone")
        if self.mesh_size is not None:
            yield self._unfit("mesh_size", "no mesh size: 'rayleigh' takes the elements of the housing")
        if self.microphone_box is not None:
            expected = (
                "no box of microphones with the method 'rayleigh': ISO 3744 measures on all sides of a housing on a "
                "floor, and a face in its baffle sounds to one side alone; take boundary elements and a 'floor', or "
                "single [[acoustics.microphone]]s in front of one face"
            )
            yield self._unfit("microphone_box", expected)
        if self.microphone and len(self.faces) > 1:
            expected = (
                f"no microphones with {len(self.faces)} faces, of which each has a baffle of its own; take one face, "
                "or boundary elements"
            )
            yield self._unfit("microphone", expected)

    def _unfit(self, attribute: str, expected: str) -> Finding:
        return Finding(_PART, attribute, getattr(self, attribute), expected)
