"""Pins of planets: a massless beam clamped in the walls of the carrier, or springs, under the planet's bearings.

A pin has the exact static stiffness K of a free Timoshenko beam between its nodes, the stations of the planet's
bearings and the walls that clamp it (:mod:`gearwhine.rotors.analyses.static_stiffness`). The walls move with the
carrier, the stations s are coordinates of their own, on which the planet's bearings sit:

    f = K [u_s; u_w],        u_w the motions of the carrier's sections at the walls, by rigid arms.

Two walls that the carrier's shaft joins wind up against each other under the torque; the pin then tilts, and with it
the planet. A load in the middle between two walls bends it by F L³ / 192 E I + F L / 4 κ G A. Where only its stiffness
is known the pin is rigid, on springs at one place of the carrier.

The mass of a pin belongs to the carrier. Its coordinates have so little that they respond statically.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Number, Numbers, Rule, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_tuples
from gearwhine.rotors import Rotor, Segment, ShaftMaterial
from gearwhine.rotors.analyses.static_stiffness import static_shaft

_SAME_PLACE = 1e-6
"""Distance of a bearing from a wall below which it sits in it, and is moved off it by as much [m]."""
_RIGID = 1e3
"""Stiffness of a rigid pin along the axis, over that of its springs across it."""
_STIFF = (1e11, 1e11, 1e11, 1e8, 1e8)
"""Stiffness of a pin that stands for a rigid one [N/m, N m/rad]."""
_INERTIA = (1e-5, 1e-5, 1e-5, 1e-9, 1e-9)
"""Inertia of a pin's coordinates [kg, kg m²]: a hundredth of a gram, on which no pin vibrates below 100 kHz."""


@dataclass(frozen=True)
class PinBeam:
    """Pin of a planet as a beam.

    Attributes
    ----------
    walls : tuple of float
        z of the carrier's walls that clamp it [m]: two, or one of a pin that is clamped at one end.
    diameter, bore : float
        Diameters [m].
    material : ShaftMaterial
    """

    walls: Sequence[float]
    diameter: float
    material: ShaftMaterial
    bore: float = 0.0

    def __post_init__(self) -> None:
        """Check the walls and the diameters."""
        keep_tuples(self, "walls")
        part = ("pin", "")
        rules: dict[str, Rule] = {
            "diameter": Number(above=0.0, unit="m"),
            "bore": Number(at_least=0.0, unit="m"),
            "walls": Numbers(),
        }
        refuse(attribute_findings(part, self, **rules), CouplingError)
        if not self.walls or len(set(self.walls)) < len(self.walls):
            raise CouplingError(f"pin: walls are {list(self.walls)}; expected one place along z or more, each once")
        if self.bore >= self.diameter:
            raise CouplingError(f"pin: bore is {self.bore!r} m; expected less than the diameter, {self.diameter!r} m")

    def mounted(self, bearings: Sequence[float]) -> "MountedPin":
        """Return the pin under bearings at places along z [m]."""
        ends = min(*bearings, *self.walls) - _SAME_PLACE, max(*bearings, *self.walls) + _SAME_PLACE
        stations = [_beside(at, self.walls) for at in dict.fromkeys(bearings)]
        nodes = np.array([*stations, *self.walls])
        beam = Rotor("pin", [Segment(ends[1] - ends[0], self.diameter, self.bore, self.material)], [])
        exact = static_shaft(beam, (nodes - ends[0]).tolist())
        # Nodes of the beam are in the order of their places, and turn about z as well.
        order = [6 * exact.node(float(at - ends[0])) + axis for at in nodes for axis in range(5)]
        stiffness = exact.stiffness[np.ix_(order, order)]
        return MountedPin(tuple(dict.fromkeys(bearings)), tuple(self.walls), stiffness)


@dataclass(frozen=True)
class PinSprings:
    """Rigid pin of a planet on springs in its carrier.

    Attributes
    ----------
    at : float
        z of the springs [m].
    radial : float
        Force over displacement across the axis [N/m].
    tilt : float
        Moment over rotation about an axis across [N m/rad].
    """

    at: float
    radial: float
    tilt: float

    def __post_init__(self) -> None:
        """Check the place and the stiffness."""
        rules: dict[str, Rule] = {
            "at": Number(unit="m"),
            "radial": Number(above=0.0, unit="N/m"),
            "tilt": Number(above=0.0, unit="N m/rad"),
        }
        refuse(attribute_findings(("pin", ""), self, **rules), CouplingError)

    def mounted(self, bearings: Sequence[float]) -> "MountedPin":
        """Return the pin under bearings at places along z [m]."""
        stations = tuple(dict.fromkeys(bearings))
        springs = np.diag([self.radial, self.radial, _RIGID * self.radial, self.tilt, self.tilt])
        # The body's motion is that of its middle: all stations follow it by rigid arms.
        arms = np.vstack([rigid_motion(at - self.at) for at in stations])
        whole = np.block([[springs, -springs], [-springs, springs]])
        return MountedPin(stations, (self.at,), whole, arms)


Pin = PinBeam | PinSprings


def stiff_pin(bearings: Sequence[float]) -> "MountedPin":
    """Return a pin that takes each bearing along as one body with the carrier at its place along z [m]."""
    stations = tuple(dict.fromkeys(bearings))
    springs = np.diag(np.tile(_STIFF, len(stations)))
    return MountedPin(stations, stations, np.block([[springs, -springs], [-springs, springs]]))


@dataclass(frozen=True, eq=False)
class MountedPin:
    """A pin with the bearings on it.

    Attributes
    ----------
    stations, walls : tuple of float
        z of the s bearings and of the w walls [m].
    stiffness : ndarray, shape (n + 5 w, n + 5 w)
        Over the pin's n coordinates, then x, y, z and the rotations about x and y of each wall.
    arms : ndarray, shape (5 s, n), optional
        Motion of the stations by the coordinates; by default these are their motions.
    displacement : ndarray, shape (5,), optional
        Displacement of the whole pin from its place in the walls [m, rad].
    """

    stations: tuple[float, ...]
    walls: tuple[float, ...]
    stiffness: FloatArray
    arms: FloatArray | None = None
    displacement: FloatArray | None = None

    @property
    def offset(self) -> FloatArray | None:
        """Force of the displacement over coordinates and walls, in addition to the stiffness' own; None without one."""
        if self.displacement is None:
            return None
        moved = np.concatenate([self.rigid_motions @ self.displacement, np.zeros(5 * len(self.walls))])
        return np.asarray(-self.stiffness @ moved)

    @property
    def size(self) -> int:
        """Number n of coordinates."""
        return len(self.stiffness) - 5 * len(self.walls)

    def motions(self, z: float) -> FloatArray:
        """Motion x, y, z and rotations about x and y of the seat of a bearing by the coordinates, (5, n)."""
        number = int(np.argmin(np.abs(np.subtract(self.stations, z))))
        rows = np.eye(self.size) if self.arms is None else self.arms
        return rows[5 * number : 5 * number + 5]

    @property
    def middle(self) -> float:
        """Z of the middle of the coordinates' places [m]."""
        return float(np.mean(self.stations if self.arms is None else self.walls))

    @property
    def rigid_motions(self) -> FloatArray:
        """Coordinates of the motions of the pin as one body by x, y, z and rotations about x and y, (n, 5)."""
        places = self.stations if self.arms is None else self.walls
        return np.vstack([rigid_motion(at - self.middle) for at in places])

    @property
    def scale(self) -> FloatArray:
        """Root of the inertia of each coordinate, (n,) [√kg, √kg m]."""
        return np.asarray(np.sqrt(np.tile(_INERTIA, self.size // 5)))


def rigid_motion(along: float) -> FloatArray:
    """Motion x, y, z and rotations about x and y of a rigid shaft at a distance from a place by that there, (5, 5)."""
    rows = np.eye(5)
    rows[0, 4], rows[1, 3] = along, -along
    return rows


def _beside(at: float, walls: Sequence[float]) -> float:
    """Return a place, off a wall that it stands in towards the other walls."""
    near = min(walls, key=lambda wall: abs(wall - at))
    if abs(near - at) >= _SAME_PLACE:
        return at
    return near + math.copysign(_SAME_PLACE, float(np.mean(walls)) - near)
