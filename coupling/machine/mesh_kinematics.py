"""Mesh kinematics: line of action of a gear pair, and compression of the mesh by the motions of its two gears.

With e the unit vector in the x-y plane along which the driver pushes, s its sense of rotation, u = (x, y) and θ the
motions and rotations of driver k and driven gear i, and R their base radii, the flanks approach each other by

    δ = s (R_k θ_k + R_i θ_i) + e (u_k - u_i) + h (w_k - w_i),        h = -s tan β_b.

h is the axial part of the force over its transverse part: a driver of base helix angle β_b, positive for a right-hand
helix, that moves along z leaves the contact as if it had turned back by z tan β_b / R_k. R of an internal gear is
negative (ISO 21771): an internal driver that turns clockwise pushes along s = 1, and h = -s tan β_b |R_k| / R_k. w is
the axial motion where the teeth touch: at the pitch point, at r from a gear's centre, w = z + φ_x r_y - φ_y r_x with
the tilts φ. By virtual work the force of the teeth has its axial part and its tilting moment from the same rows.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearwhine.coupling.gears import GearPairGeometry
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True)
class FlankMotion:
    """Parts of a mesh's compression δ by the motion of one of its gears.

    Rows of motions are along x, y, z and about x and y, shape (5 or more, n): motions by each of n coordinates. Parts
    are of shape (n,).

    Attributes
    ----------
    push : tuple of float
        Unit vector e along which the driver pushes.
    axial_part : float
        Axial part h of the force over its transverse part.
    sense : int
        Sense s along which the driver pushes, 1 or -1: that of its rotation, of an internal driver the opposite.
    side : float
        1 for the driver, -1 for the driven gear.
    base_radius : float
        Base radius R, negative of an internal gear [m].
    arm : tuple of float
        Position r of the pitch point from the gear's centre along x and y [m].
    """

    push: tuple[float, float]
    axial_part: float
    sense: int
    side: float
    base_radius: float
    arm: tuple[float, float]

    def across(self, motions: FloatArray) -> FloatArray:
        """Part of a motion across the shaft, ± e u."""
        return np.asarray(self.side * (self.push[0] * motions[0] + self.push[1] * motions[1]))

    def tilting(self, motions: FloatArray) -> FloatArray:
        """Part of the tilts, for each metre along z from the section that moves to the place where the teeth touch."""
        # A tilt about y moves what is further along z to +x, one about x to -y.
        return np.asarray(self.side * (self.push[0] * motions[4] - self.push[1] * motions[3]))

    def turning(self, rotation: FloatArray) -> FloatArray:
        """Part of a rotation about z, shape (n,): s R θ."""
        return np.asarray(self.sense * self.base_radius * rotation)

    def axial(self, motions: FloatArray) -> FloatArray:
        """Part of a motion along the shaft and of the tilts at the pitch point, ± h w."""
        x, y = self.arm
        return self.along(motions[2] + y * motions[3] - x * motions[4])

    def along(self, motion: FloatArray) -> FloatArray:
        """Part of the axial motion of the place where the teeth touch, ± h w."""
        return np.asarray(self.side * self.axial_part * motion)


@dataclass(frozen=True)
class LineOfAction:
    """Line of action of one side of the teeth of a gear pair.

    Attributes
    ----------
    angle : float
        Angle of e from x [rad].
    axial : float
        Axial part h of the force on the driven gear over its transverse part.
    sense : int
        Sense s of rotation by which the driver closes these flanks: 1 counter-clockwise, -1 clockwise; of an internal
        driver the other way round.
    driver, driven : FlankMotion
        Parts of the compression by the motions of both gears.
    """

    angle: float
    axial: float
    sense: int
    driver: FlankMotion
    driven: FlankMotion

    @property
    def push(self) -> tuple[float, float]:
        """Unit vector e in the x-y plane along which the driver pushes the driven gear."""
        return self.driver.push


def line_of_action(geometry: GearPairGeometry, centre_line: Sequence[float], sense: int) -> LineOfAction:
    """Line of action of a gear pair in the machine.

    Parameters
    ----------
    geometry : GearPairGeometry
    centre_line : (x, y)
        Vector from the driver's centre to the driven gear's [m]; zeros leave the pitch point on the axes.
    sense : int
        Sense of rotation by which the driver closes the flanks: 1 counter-clockwise, -1 clockwise.

    Notes
    -----
    The line of centres is the vector to the driven gear over the signed centre distance, so that of an internal pair
    points from the driven gear's centre to the driver's.
    """
    x, y = (float(part) for part in centre_line)
    if geometry.is_internal:  # unit vectors are over the signed distance
        x, y = -x, -y
    distance = math.hypot(x, y)
    towards = (x / distance, y / distance) if distance > 0.0 else (0.0, 0.0)
    angle = geometry.line_of_action_angle(math.atan2(y, x), sense)
    push = (math.cos(angle), math.sin(angle))
    axial = -sense * math.tan(geometry.driver.base_helix_angle)
    flank_sense = geometry.flank_sense(sense)
    sides = ((geometry.driver, 1.0), (geometry.driven, -1.0))
    flanks = []
    for (gear, side), radius in zip(sides, geometry.working_pitch_radii, strict=True):
        arm = (side * radius * towards[0], side * radius * towards[1])
        flanks.append(FlankMotion(push, axial, flank_sense, side, gear.base_radius, arm))
    return LineOfAction(angle, axial, flank_sense, flanks[0], flanks[1])
