"""Bearings and gears at their places in a machine: a bearing between rotor and seat, and a mesh of two gears."""

from dataclasses import dataclass, field
from math import atan2

import numpy as np
import numpy.typing as npt

from coupling.gears import GearPairGeometry, ToothContact
from coupling.gears.geometry.pair import pair_label
from coupling.machine.bearing_laws import BearingLaw, RollingLaw
from coupling.machine.mesh_kinematics import LineOfAction, line_of_action
from housing.own_copies import keep_arrays
from rotors import Bearing
from rotors.rolling_bearings import RollingBearing

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class MountedBearing:
    """A bearing between a rotor and a seat of the housing; where ``seat`` is None, its pedestal or the ground.

    With a ``law``, motion follows it in place of the bearing's stiffness, which linear analyses use. With
    ``rolling``, the machine's static equilibrium is that of the bearing's elements; a ``bearing`` without stiffness
    gets its stiffness from there.

    Attributes
    ----------
    bearing : rotors.Bearing
    rotor : str
    seat : str or None
        None for the ground.
    law : BearingLaw or None
    rolling : RollingBearing or None
    offset : ndarray, shape (5,), or None
        Force of the linear law at zero deflection [N, N m]: force at the operating point less K times the deflection.
    """

    bearing: Bearing
    rotor: str
    seat: str | None
    law: BearingLaw | None = None
    rolling: RollingBearing | None = None
    offset: FloatArray | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        """Keep own copies."""
        keep_arrays(self, "offset")

    @classmethod
    def from_elements(
        cls, name: str, at: float, rotor: str, seat: str | None, rolling: RollingBearing, *, damping: float = 0.0
    ) -> "MountedBearing":
        """Mount a rolling bearing whose stiffness follows from its load at the machine's operating point.

        Parameters
        ----------
        name : str
        at : float
            Distance from the rotor's left end [m].
        rotor : str
        seat : str or None
            None for the ground.
        rolling : RollingBearing
            Such as that of :func:`rotors.rolling_bearings.catalogue_bearing`.
        damping : float
            Along x and y [N s/m].

        Raises
        ------
        rotors.RotorError
            For a place or a damping that no bearing has.
        """
        return cls(
            Bearing(name, at, np.zeros((5, 5)), np.diag([damping, damping, 0.0, 0.0, 0.0])),
            rotor,
            seat,
            rolling=rolling,
        )

    @property
    def elements(self) -> RollingBearing | None:
        """The rolling bearing by its elements; None for a bearing that is described by its stiffness."""
        if self.rolling is None and isinstance(self.law, RollingLaw):
            return self.law.state.bearing
        return self.rolling

    @property
    def needs_load(self) -> bool:
        """Whether the stiffness is still to follow from the load at the operating point."""
        return self.elements is not None and not np.any(self.bearing.stiffness)


@dataclass(frozen=True)
class MountedGear:
    """Place of a gear: its rotor, its middle from the rotor's left end, and the axis in the x-y plane [m]."""

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
        Contact law between the rims of the gears.
    backlash : float, optional
        Gap between the back flanks along their line of action [m]; None where they can never meet.
    friction : float
        Coefficient of friction between the teeth, from 0 to 0.5.
    behind_rims : float
        Compliance of the rims on their hubs along the line of action [m/N], in series with the contact.
    """

    driver: MountedGear
    driven: MountedGear
    geometry: GearPairGeometry
    contact: ToothContact
    backlash: float | None = None
    friction: float = 0.0
    behind_rims: float = 0.0

    @property
    def name(self) -> str:
        """Names of both gears."""
        return f"{self.driver.name} -> {self.driven.name}"

    @property
    def centre_line_angle(self) -> float:
        """Angle from x of the line from the driver's centre to the driven gear's [rad]."""
        x, y = self._centre_line
        return atan2(y, x)

    @property
    def _centre_line(self) -> tuple[float, float]:
        return self.driven.axis[0] - self.driver.axis[0], self.driven.axis[1] - self.driver.axis[1]

    def line_of_action(self, sense: int) -> LineOfAction:
        """Line of action of the flanks that the driver closes by a rotation of this sense, 1 or -1."""
        return line_of_action(self.geometry, self._centre_line, sense)

    @property
    def stations(self) -> tuple[float, float]:
        """Where the mesh force acts on both rotors: the middle of the common face from their left ends [m]."""
        driver, driven = self.geometry.common_middles
        return self.driver.at + driver, self.driven.at + driven

    @property
    def label(self) -> str:
        """The pair's name in messages."""
        return pair_label(self.driver.name, self.driven.name)
