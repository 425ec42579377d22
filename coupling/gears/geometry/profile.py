"""Tooth profile: involute flank and trochoid of the root fillet; gear outlines for drawing.

Coordinates are the tooth's own: `height` along its axis from the gear's centre, `half_thickness` across.
Each curve has a parameter in which it is smooth, so that integrals over the tooth converge fast:

flank
    the angle ``tau`` between the flank's normal and the direction across the tooth, i.e. the angle of a
    load there.  With ``psi`` the half angle of the tooth on the base circle ``rb`` and roll angle
    ``tau + psi``:  half_thickness = rb ((tau + psi) cos(tau) - sin(tau)),
    height = rb ((tau + psi) sin(tau) + cos(tau)).
fillet
    the angle ``gamma`` between the rack's pitch line and the common normal of rack and gear, see
    :mod:`gearwhine.coupling.gears.geometry.rack`.  It runs from pi/2 (bottom of the space) to `Gear.fillet_end` (start
    of the involute), which is the transverse pressure angle but for undercut teeth.

The tooth of an internal gear, whose radii are negative, is at negative heights and points upward as an external one,
its root below its tip; it widens downward.  Directions and angles are those in which a tooth points, from root to tip:
the tooth itself of an internal gear stands on the other side of its centre.

All of it is in the transverse plane; tip relief, a few micrometres, is not drawn.

Gear outlines are whole gears as polygons, alone and placed in mesh. At phase p the pair of teeth with number 0 touches
at p base pitches along the path of contact. Seen from its gear's centre, a flank point of roll angle ``u`` is
``atan(u)`` beyond the tangent point of the line of action and ``psi - inv(atan(u))`` from its tooth's axis, psi half
the tooth's angle on the base circle; so the axis is ``u - psi`` beyond the tangent point. The tangent points are at the
working pressure angle w from the line of centres. With that line at ``zeta`` from x, and the driver rotating in the
sense s = +1 (counter-clockwise) or -1, of an internal driver the other way round, the axes of the two teeth stand at

    driver:  zeta + s (u_k - w - psi_k)          driven:  zeta + pi + s (u_i - w - psi_i).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearwhine.coupling.gears.errors import GearError
from gearwhine.coupling.gears.geometry.gear import Gear
from gearwhine.coupling.gears.geometry.pair import GearPairGeometry
from gearwhine.numerics.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class ProfilePoints:
    """Points of one side of a tooth, and the derivative of their height.

    Attributes
    ----------
    height, half_thickness : ndarray
        Coordinates along and across the tooth [m].
    height_rate : ndarray
        Derivative of `height` by the curve's parameter [m/rad].
    """

    height: FloatArray
    half_thickness: FloatArray
    height_rate: FloatArray

    @property
    def radius(self) -> FloatArray:
        """Distance from the gear's centre [m]."""
        return np.hypot(self.height, self.half_thickness)


def load_angle(gear: Gear, radius: FloatArray) -> FloatArray:
    """Angle of the flank's normal to the direction across the tooth, at `radius`.

    Parameters
    ----------
    gear : Gear
    radius : ndarray
        Radii on the involute [m].

    Returns
    -------
    ndarray
        ``tan(a) - psi`` with ``a`` the profile's pressure angle there [rad].
    """
    roll = np.sqrt(np.maximum(0.0, (radius / gear.base_radius) ** 2 - 1.0))
    return np.asarray(roll - gear.base_half_angle, dtype=np.float64)


def flank_points(gear: Gear, angle: FloatArray) -> ProfilePoints:
    """Flank of a tooth at load angles `angle` [rad], any shape."""
    rb = gear.base_radius
    roll = angle + gear.base_half_angle
    sine, cosine = np.sin(angle), np.cos(angle)
    return ProfilePoints(
        height=rb * (roll * sine + cosine),
        half_thickness=rb * (roll * cosine - sine),
        height_rate=rb * roll * cosine,
    )


def fillet_points(gear: Gear, gamma: FloatArray) -> ProfilePoints:
    """Root fillet of a tooth at `gamma` [rad], from pi/2 (root circle) down to `Gear.fillet_end`.

    An internal gear's is an arc (:mod:`gearwhine.coupling.gears.geometry.root_arc`).
    """
    if gear.is_internal:
        return ProfilePoints(*gear.root_arc.points(gamma))
    return ProfilePoints(*gear.rack_corner_arc.trochoid(gear.pitch_radius, gamma))


def root_half_angle(gear: Gear) -> float:
    """Half the angle a tooth spans on the root circle, where its fillet meets it, signed as the radii [rad]."""
    if gear.is_internal:
        return gear.root_arc.centre_angle
    return gear.rack_corner[1] / gear.pitch_radius


def tooth_side(gear: Gear, points: int) -> tuple[FloatArray, FloatArray]:
    """Half thickness and height [m] of one side of a tooth, from the root circle to the tip, (2 * points - 1,) each.

    `points` is the number of points on each curve, fillet and flank.
    """
    fillet = fillet_points(gear, np.linspace(math.pi / 2.0, gear.fillet_end, points))
    angles = load_angle(gear, np.array([gear.form_radius, gear.tip_radius]))
    flank = flank_points(gear, np.linspace(angles[0], angles[1], points))
    across = np.concatenate([fillet.half_thickness, flank.half_thickness[1:]])
    return across, np.concatenate([fillet.height, flank.height[1:]])


def tooth_outline(gear: Gear, points: int = 60) -> FloatArray:
    """Outline of one tooth about its own axis, root to tip to root.

    Parameters
    ----------
    gear : Gear
    points : int
        Points on each curve (fillet, flank) of a side.

    Returns
    -------
    ndarray, shape (4 * points - 2, 2)
        Coordinates across and along the tooth [m]; left side upward, then right side downward.

    See Also
    --------
    gearwhine.coupling.gears.geometry.profile.gear_outline : all teeth, at any rotation and place.
    """
    across, along = tooth_side(gear, points)
    left = np.column_stack([-across, along])
    right = np.column_stack([across, along])[::-1]
    return np.vstack([left, right])


def gear_outline(
    gear: Gear,
    rotation: float = 0.0,
    centre: tuple[float, float] = (0.0, 0.0),
    *,
    axial_position: float = 0.0,
    points: int = 30,
) -> FloatArray:
    """Outline of a whole gear: fillets, flanks, tips and root arcs of all teeth.

    Parameters
    ----------
    gear : Gear
    rotation : float
        Angle from x of the direction in which tooth 0 points [rad], in the plane z = 0.
    centre : tuple of float
        Position of the gear's centre [m].
    axial_position : float
        Place z of the transverse plane of a helical gear [m]: a right-hand tooth rotates by ``tan(beta) z / r``.
    points : int
        Points on each fillet and each flank, at least 2.

    Returns
    -------
    ndarray, shape (n, 2)
        x and y of the corners of a closed polygon [m], counter-clockwise; the first point is not repeated. Of an
        internal gear it is the inside of the ring.
    """
    if points < 2:
        raise GearError(f"gear {gear.name!r}: an outline needs at least 2 points on each curve, got {points!r}")
    tooth = _tooth_and_space(gear, points)
    twist = math.tan(gear.helix_angle) * axial_position / abs(gear.pitch_radius)
    angles = rotation + twist + 2.0 * math.pi * np.arange(gear.tooth_count) / gear.teeth
    rotated = tooth[None, :] * np.exp(1j * angles)[:, None]
    outline = rotated.ravel() + complex(*centre)
    if gear.is_internal:  # from a tooth to the next one it runs clockwise, as the signed pitch does
        outline = outline[::-1]
    return np.column_stack([outline.real, outline.imag])


def meshing_rotations(
    pair: GearPairGeometry, phase: float, *, centre_line_angle: float = 0.0, sense: int = 1
) -> tuple[float, float]:
    """Rotation angles of driver and driven gear at a phase, with their working flanks in contact.

    Parameters
    ----------
    pair : GearPairGeometry
    phase : float
        Phase in mesh periods: position along the path of contact at which the teeth 0 touch [base pitches].
    centre_line_angle : float
        Angle from x of the line of centres [rad]: from the driver's centre to the driven's, of an internal pair the
        other way round, since its centre distance is negative.
    sense : int
        +1 where the driver turns counter-clockwise, -1 where clockwise.

    Returns
    -------
    tuple of float
        Angles from x of the directions in which the two teeth 0 point [rad].
    """
    sense = pair.flank_sense(sense)
    angle = pair.working_pressure_angle
    driver = float(pair.driver_roll_angle(phase)) - angle - pair.driver.base_half_angle
    driven = float(pair.driven_roll_angle(phase)) - angle - pair.driven.base_half_angle
    return centre_line_angle + sense * driver, centre_line_angle + math.pi + sense * driven


def pair_outlines(
    pair: GearPairGeometry, phase: float, *, centre_line_angle: float = 0.0, sense: int = 1, points: int = 30
) -> tuple[FloatArray, FloatArray]:
    """Outlines of driver and driven gear in mesh, the driver's centre at the origin.

    Parameters
    ----------
    pair, phase, centre_line_angle, sense
        As in `meshing_rotations`.
    points : int
        Number of points, as in `gear_outline`.

    Returns
    -------
    tuple of ndarray, each of shape (n, 2)
        Closed polygons [m].
    """
    driver, driven = meshing_rotations(pair, phase, centre_line_angle=centre_line_angle, sense=sense)
    distance = pair.working_centre_distance
    other = (distance * math.cos(centre_line_angle), distance * math.sin(centre_line_angle))
    return (
        gear_outline(pair.driver, driver, points=points),
        gear_outline(pair.driven, driven, other, points=points),
    )


def _tooth_and_space(gear: Gear, points: int) -> npt.NDArray[np.complex128]:
    """Return the outline of the tooth on the x axis and of the space after it, in complex coordinates [m]."""
    across, along = tooth_side(gear, points)
    side = along + 1j * across
    arc = np.linspace(-1.0, 1.0, max(3, points // 4))[1:-1]
    tip = gear.tip_radius * np.exp(1j * gear.tip_half_angle * arc)
    middle = math.pi / gear.teeth
    space = gear.root_circle_radius * np.exp(1j * (middle + (middle - root_half_angle(gear)) * arc))
    return np.concatenate([side.conj(), tip, side[::-1], space])
