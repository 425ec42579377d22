"""Bearings and gears at their places in a machine: a bearing between rotor and seat, and a mesh of two gears."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import atan2

import numpy as np

from gearwhine.coupling.errors import CouplingError
from gearwhine.coupling.gears import Gear, GearPairGeometry, ToothContact
from gearwhine.coupling.gears.contact.face_slices import FaceSlices
from gearwhine.coupling.gears.geometry.pair import pair_label
from gearwhine.coupling.machine.bearing_laws import BearingLaw, GapLaw, RollingLaw
from gearwhine.coupling.machine.face_compliance import FaceCompliance
from gearwhine.coupling.machine.mesh_kinematics import LineOfAction, line_of_action
from gearwhine.numerics.arrays import FloatArray
from gearwhine.numerics.findings import Finding, Instance, Number, Numbers, Rule, Text, attribute_findings, refuse
from gearwhine.numerics.own_copies import keep_arrays, keep_tuples
from gearwhine.rotors import Bearing
from gearwhine.rotors.rolling_bearings import NO_SLIP, ROLLING_DAMPING_TIME, BearingDamage, CageSlip, RollingBearing


@dataclass(frozen=True)
class MountedBearing:
    """A bearing between a rotor and a seat of the housing; where ``seat`` is None, its pedestal or the ground.

    With a ``law``, motion follows it in place of the bearing's stiffness, which linear analyses use. With
    ``rolling``, the machine's static equilibrium is that of the bearing's elements; a ``bearing`` without stiffness
    gets its stiffness from there.

    Attributes
    ----------
    bearing : gearwhine.rotors.Bearing
    rotor : str
    seat : str or None
        None or "ground", the word of a case, for the ground; kept as None.
    law : BearingLaw or None
    rolling : RollingBearing or None
    offset : ndarray, shape (5,), or None
        Force of the linear law at zero deflection [N, N m]: force at the operating point less K times the deflection.
    damping_time : float
        Damping over stiffness of a bearing whose stiffness follows from its load [s], beside the damping that the
        bearing has.
    design_load : tuple of float or None
        Force of the shaft along x, y, z for which its stiffness is made [N]; None where that depends on no load, or is
        still to follow from it.
    seat_error : tuple of float or None
        Error of the place of its seat: position of the bore along x and y [m], and rotation of its axis about x and y
        [rad]. Not beside a nonlinear ``law``.
    """

    bearing: Bearing
    rotor: str
    seat: str | None
    law: BearingLaw | None = None
    rolling: RollingBearing | None = None
    offset: FloatArray | None = field(default=None, compare=False)
    damping_time: float = 0.0
    design_load: Sequence[float] | None = None
    seat_error: Sequence[float] | None = None

    def __post_init__(self) -> None:
        """Keep own copies, and check that parts and places are such."""
        if self.seat == "ground":
            object.__setattr__(self, "seat", None)
        keep_arrays(self, "offset")
        keep_tuples(self, "design_load", "seat_error")
        refuse(attribute_findings(("bearing", ""), self, bearing=Instance(Bearing, "a bearing")), CouplingError)
        rules: dict[str, Rule] = {
            "rotor": Text(),
            "seat": Text(optional=True),
            "law": Instance((RollingLaw, GapLaw), "a law of a bearing, or None", optional=True),
            "rolling": Instance(RollingBearing, "a rolling bearing, or None", optional=True),
            "damping_time": Number(at_least=0.0, at_most=1e-2, unit="s"),
        }
        if self.offset is not None:
            rules["offset"] = Numbers(5)
        if self.seat_error is not None:
            rules["seat_error"] = Numbers(4)
        part = ("bearing", self.bearing.name)
        refuse(attribute_findings(part, self, **rules), CouplingError)
        if self.law is not None and self.seat_error is not None:
            expected = "None of a bearing with a nonlinear law, which is about the nominal place of its seat"
            refuse([Finding(part, "seat_error", self.seat_error, expected)], CouplingError)

    @classmethod
    def from_elements(
        cls,
        name: str,
        at: float,
        rotor: str,
        seat: str | None,
        rolling: RollingBearing,
        *,
        damping: float | None = None,
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
            Such as that of :func:`gearwhine.rotors.rolling_bearings.catalogue_bearing`.
        damping : float, optional
            Along x and y [N s/m]. By default `gearwhine.rotors.rolling_bearings.ROLLING_DAMPING_TIME` times the
            stiffness.

        Raises
        ------
        gearwhine.rotors.RotorError
            For a place or a damping that no bearing has.
        """
        across = 0.0 if damping is None else damping
        return cls(
            Bearing(name, at, np.zeros((5, 5)), np.diag([across, across, 0.0, 0.0, 0.0])),
            rotor,
            seat,
            rolling=rolling,
            damping_time=ROLLING_DAMPING_TIME if damping is None else 0.0,
        )

    @property
    def elements(self) -> RollingBearing | None:
        """The rolling bearing by its elements; None for a bearing that is described by its stiffness."""
        if self.rolling is None and isinstance(self.law, RollingLaw):
            return self.law.state.bearing
        return self.rolling

    @property
    def seat_displacement(self) -> FloatArray:
        """Displacement of its seat by the error of its place, along x, y, z and about x, y [m, rad], (5,)."""
        x, y, rx, ry = self.seat_error or (0.0, 0.0, 0.0, 0.0)
        return np.array([x, y, 0.0, rx, ry])

    @property
    def spalls(self) -> tuple[BearingDamage, ...]:
        """Damage of its raceways, elements and cage."""
        return self.law.spalls if isinstance(self.law, RollingLaw) else ()

    @property
    def slip(self) -> CageSlip:
        """Slip of its cage."""
        return self.law.slip if isinstance(self.law, RollingLaw) else NO_SLIP

    @property
    def needs_load(self) -> bool:
        """Whether the stiffness is still to follow from the load at the operating point."""
        return self.elements is not None and not np.any(self.bearing.stiffness)


@dataclass(frozen=True)
class MountedGear:
    """Place of a gear: its rotor, its middle from the rotor's left end, and the axis in the x-y plane [m].

    Attributes
    ----------
    name, rotor : str
    at : float
    axis : tuple of float
    carried : tuple of float, optional
        Ends of the length of the rotor that moves with the gear's body, from the rotor's left end [m]: the body is
        rigid beyond. By default the gear moves with the section in the middle of the common face.
    missing : FaceCompliance, optional
        What the rotor's modes lack of its compliance over the common face; none by default.
    rim_seat : str, optional
        Seat of the housing whose bore the rim of a ring gear follows as it deforms; by default the rim moves as one
        body with its rotor.
    """

    name: str
    rotor: str
    at: float
    axis: tuple[float, float]
    carried: tuple[float, float] | None = None
    missing: FaceCompliance | None = None
    rim_seat: str | None = None

    def compliance(self, gear: Gear) -> FloatArray:
        """Compliance over mean approach, slope and tilt that the rotor's modes lack under this gear, (3, 3)."""
        return np.zeros((3, 3)) if self.missing is None else self.missing.along_action(gear.base_radius)


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
    faces : FaceSlices, optional
        Slices by which flanks that carry evenly resist tilting, see
        :mod:`gearwhine.coupling.machine.mesh_face`. By default those of ``contact``; where it has none
        either, the mesh acts in the middle of its face alone.
    carrier : str, optional
        Rotor with which the axes of planets among the two turn; None where both axes stand still.
    """

    driver: MountedGear
    driven: MountedGear
    geometry: GearPairGeometry
    contact: ToothContact
    backlash: float | None = None
    friction: float = 0.0
    behind_rims: float = 0.0
    faces: FaceSlices | None = None
    carrier: str | None = None

    @property
    def name(self) -> str:
        """Names of both gears."""
        return f"{self.driver.name} -> {self.driven.name}"

    @property
    def centre_line_angle(self) -> float:
        """Angle from x of the line from the driver's centre to the driven gear's, of an internal pair back [rad]."""
        x, y = self._centre_line
        if self.geometry.is_internal:
            x, y = -x, -y
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
