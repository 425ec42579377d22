"""Mounted bearings and gears: their places in the machine, and gear pairs in mesh."""

from dataclasses import dataclass
from math import atan2

from coupling.bearing_law import BearingLaw
from coupling.gears import GearPairGeometry, ToothContact
from rotors import Bearing


@dataclass(frozen=True)
class MountedBearing:
    """A bearing between a rotor and a seat of the housing, or the ground where ``seat`` is None.

    With a ``law`` of its own, motion follows that in place of the bearing's stiffness, which linear analyses take.
    """

    bearing: Bearing
    rotor: str
    seat: str | None
    law: BearingLaw | None = None


@dataclass(frozen=True)
class MountedGear:
    """Place of a gear: its rotor, the distance from the rotor's left end and the axis in the x-y plane [m]."""

    name: str
    rotor: str
    at: float
    axis: tuple[float, float]


@dataclass(frozen=True)
class GearMesh:
    """A driver and a driven gear with the law of their contact.

    Attributes
    ----------
    driver, driven : MountedGear
    geometry : GearPairGeometry
    contact : ToothContact
    backlash : float, optional
        Gap between the back flanks along their line of action [m]; None where they can never meet.
    friction : float
        Coefficient of friction between the teeth, from 0 to 0.5.
    """

    driver: MountedGear
    driven: MountedGear
    geometry: GearPairGeometry
    contact: ToothContact
    backlash: float | None = None
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Names of both gears."""
        return f"{self.driver.name} -> {self.driven.name}"

    @property
    def centre_line_angle(self) -> float:
        """Angle from x of the line from the driver's centre to the driven gear's [rad]."""
        return atan2(self.driven.axis[1] - self.driver.axis[1], self.driven.axis[0] - self.driver.axis[0])

    @property
    def label(self) -> str:
        """The pair's name in messages."""
        return f"gear pair {self.driver.name!r} -> {self.driven.name!r}"
